//! NASA's neutral map file (.nmf): boundary conditions and one-to-one interfaces of a Plot3D grid.
//!
//! W. T. Jones, The Neutral Map File, NASA Langley GEOLAB (kept with the Turbulence Modeling Resource). Faces are
//! numbered 1, 2 = k min, max; 3, 4 = i; 5, 6 = j; a face's first and second direction are (i, j), (j, k) and (k, i);
//! nodes count from 1; a range that falls runs backwards. Two-dimensional files (KDIM 1) of some programs (Construct2D)
//! number their four sides 1, 2 = i min, max; 3, 4 = j, with the range along the side first.

use std::fmt::Write;

use crate::face::{Face, Window};
use crate::topology::{Condition, Interface, MultiBlock, Orientation, Patch, Side, Topology};

/// What is wrong with a neutral map file.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
#[error("{file}:{line}: {what}")]
pub struct NmfError {
    /// The file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// What is needed, what was got.
    pub what: String,
}

const FACES: [Face; 6] = [Face::KMin, Face::KMax, Face::IMin, Face::IMax, Face::JMin, Face::JMax];

/// A side as the file has it: window and, for its own first and second direction, whether they run backwards.
struct FileSide {
    side: Side,
    backwards: [bool; 2],
}

/// True if the file's first direction on `face` is our second (j faces: the file has (k, i), we (i, k)).
fn turned(face: Face) -> bool {
    face.axis() == 1
}

/// The condition for a type name of the file; `None` for others. Known are names of V2K, GridPro and FUN3D, the numbers of
/// CFL3D (NASA TM-1998-208444, chapter 6) and those of FUN3D (manual, table of boundary conditions). All far fields are one:
/// extrapolation there (`farfield_extr`) is what the characteristics make of a supersonic exit.
#[must_use]
pub fn condition(name: &str) -> Option<Condition> {
    let name = name.to_ascii_lowercase();
    if let Ok(number) = name.parse::<u32>() {
        return Some(match number {
            2004 | 2014 | 2024 | 4000 | 4100 => Condition::WallNoSlip,
            1005 | 3000 => Condition::WallSlip,
            1001 | 6661..=6663 => Condition::Symmetry,
            1000 | 1003 | 5000 | 5005 | 5050 => Condition::FarField,
            1002 => Condition::OutflowSupersonic,
            2002 | 5051 | 7012 => Condition::OutflowSubsonic,
            1008 | 2003 | 7011 => Condition::InflowSubsonic,
            7100 => Condition::InflowSupersonic,
            1011..=1013 => Condition::Collapsed,
            _ => return None,
        });
    }
    let starts = |list: &[&str]| list.iter().any(|s| name.starts_with(s));
    Some(
        if starts(&["viscous", "no_slip", "wall_viscous", "isothermal", "adiabatic"]) {
            Condition::WallNoSlip
        } else if starts(&["tangency", "inviscid", "slip"]) {
            Condition::WallSlip
        } else if starts(&["wall", "solid"]) {
            Condition::Wall
        } else if starts(&["symmetry", "sym"]) {
            Condition::Symmetry
        } else if starts(&["farfield_pbck"]) {
            Condition::OutflowSubsonic
        } else if starts(&["far", "freestream", "riemann"]) {
            Condition::FarField
        } else if starts(&[
            "extrapolate",
            "outflow_supersonic",
            "outflow-supersonic",
            "supersonic_outflow",
            "fixed_outflow",
        ]) {
            Condition::OutflowSupersonic
        } else if starts(&[
            "back_pressure",
            "backpressure",
            "outflow",
            "subsonic_outflow",
            "extrapolation_pressure",
        ]) {
            Condition::OutflowSubsonic
        } else if starts(&[
            "inflow_supersonic",
            "inflow-supersonic",
            "supersonic_inflow",
            "fixed_inflow",
        ]) {
            Condition::InflowSupersonic
        } else if starts(&["subsonic_inflow", "inflow", "freestream_inflow"]) {
            Condition::InflowSubsonic
        } else if starts(&["pole", "singular", "collapsed", "degenerate", "point", "axis"]) {
            Condition::Collapsed
        } else {
            return None;
        },
    )
}

/// Reads the topology of `grid` (whose blocks are known) from the text of a neutral map file.
/// # Errors
/// Sizes that are not the grid's, a line that is not understood, an unknown type.
pub fn parse(file: &str, text: &str, grid: &MultiBlock) -> Result<Topology, NmfError> {
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(n, l)| (n + 1, l.split(['#', '!']).next().unwrap_or_default().trim()))
        .filter(|(_, l)| !l.is_empty());
    let fail = |line: usize, what: String| NmfError {
        file: file.to_owned(),
        line,
        what,
    };
    let (line, count) = lines.next().ok_or_else(|| fail(1, "the file is empty".into()))?;
    if count.parse() != Ok(grid.blocks.len()) {
        return Err(fail(
            line,
            format!("{count} blocks; the grid has {}", grid.blocks.len()),
        ));
    }
    let mut flat = true;
    for (n, block) in grid.blocks.iter().enumerate() {
        let (line, text) = lines
            .next()
            .ok_or_else(|| fail(line, format!("the size of block {} is missing", n + 1)))?;
        let numbers: Vec<usize> = text.split_whitespace().filter_map(|w| w.parse().ok()).collect();
        let [i, j, k] = block.nodes();
        // A 2-D file has one node across, our grid two.
        let fits = numbers.len() == 4 && numbers[1..3] == [i, j] && (numbers[3] == k || (numbers[3] == 1 && k == 2));
        flat &= numbers.last() == Some(&1);
        if !fits {
            return Err(fail(
                line,
                format!("\"{text}\"; block {} of the grid has {i} x {j} x {k} nodes", n + 1),
            ));
        }
    }
    let lines: Vec<(usize, &str)> = lines.collect();
    let sides_of_a_plane = flat && lines.iter().any(|(_, text)| is_side_of_a_plane(text));
    let mut topology = Topology::default();
    for (line, text) in lines {
        let fail = |what: String| fail(line, what);
        let (name, rest) = entry(text).ok_or_else(|| fail(format!("a type name is needed, got \"{text}\"")))?;
        let words: Vec<&str> = rest.split_whitespace().collect();
        let number = |n: usize| -> Result<usize, NmfError> {
            words.get(n).and_then(|w| w.parse().ok()).ok_or_else(|| {
                fail(format!(
                    "number {} after the type is missing or not a number: \"{text}\"",
                    n + 1
                ))
            })
        };
        let side = |from: usize| -> Result<FileSide, NmfError> {
            let mut v = [0; 6];
            for (n, value) in v.iter_mut().enumerate() {
                *value = number(from + n)?;
            }
            if sides_of_a_plane {
                // To the faces of three dimensions: i sides have the ranges (j, k) there too, j sides (k, i).
                v = match v {
                    [b, f @ 1..=2, s1, e1, s2, e2] => [b, f + 2, s1, e1, s2, e2],
                    [b, f @ 3..=4, s1, e1, s2, e2] => [b, f + 2, s2, e2, s1, e1],
                    [_, f, ..] => return Err(fail(format!("side {f} does not exist in a plane: 1 to 4 are needed"))),
                };
            }
            file_side(grid, v).map_err(fail)
        };
        let first = side(0)?;
        if name.eq_ignore_ascii_case("one_to_one") || name.eq_ignore_ascii_case("one-to-one") {
            let second = side(6)?;
            let swap = match words
                .get(12)
                .map(|w| w.trim_matches('\'').to_ascii_uppercase())
                .as_deref()
            {
                Some("TRUE" | "T" | ".TRUE.") => true,
                Some("FALSE" | "F" | ".FALSE.") | None => false,
                Some(other) => return Err(fail(format!("swap is TRUE or FALSE, not \"{other}\""))),
            };
            let interface = interface(&first, &second, swap);
            let (a, b) = (interface.a.window.size(), interface.b.window.size());
            if interface.orientation.size(a) != b {
                return Err(fail(format!(
                    "{} x {} cells cannot lie on {} x {}",
                    a[0], a[1], b[0], b[1]
                )));
            }
            topology.interfaces.push(interface);
            continue;
        }
        if name.eq_ignore_ascii_case("unprocessed") {
            continue;
        }
        if name.to_ascii_lowercase().starts_with("patched") {
            return Err(fail(
                "'patched': sides whose nodes do not coincide; only one_to_one is understood".into(),
            ));
        }
        let condition = condition(&name).ok_or_else(|| {
            fail(format!("unknown type '{name}': known are one_to_one, wall, viscous..., tangency, symmetry..., farfield..., inflow, outflow, back_pressure, extrapolate, pole..."))
        })?;
        let Side { block, face, window } = first.side;
        topology.patches.push(Patch {
            name: name.to_ascii_lowercase(),
            block,
            face,
            window,
            condition,
        });
    }
    Ok(topology)
}

/// True for an entry on side 1 or 2 whose second range is 1 to 1: a side of a plane; a face k has two ranges.
fn is_side_of_a_plane(text: &str) -> bool {
    let Some((_, rest)) = entry(text) else { return false };
    let words: Vec<&str> = rest.split_whitespace().take(6).collect();
    matches!(words[..], [_, "1" | "2", _, _, "1", "1"])
}

/// Type name (quoted or not) and the rest of a line.
fn entry(text: &str) -> Option<(String, &str)> {
    for quote in ['\'', '"'] {
        if let Some(rest) = text.strip_prefix(quote) {
            let (name, rest) = rest.split_once(quote)?;
            return Some((name.trim().to_owned(), rest));
        }
    }
    let (name, rest) = text.split_once(char::is_whitespace)?;
    // A number is a type if block, face and both ranges follow it; else the type was forgotten.
    let is_type = name.parse::<f64>().is_err() || rest.split_whitespace().count() == 6;
    is_type.then(|| (name.to_owned(), rest))
}

fn file_side(grid: &MultiBlock, [block, face, s1, e1, s2, e2]: [usize; 6]) -> Result<FileSide, String> {
    let Some(of) = block.checked_sub(1).and_then(|b| grid.blocks.get(b)) else {
        return Err(format!("block {block} does not exist"));
    };
    let Some(&face) = face.checked_sub(1).and_then(|f| FACES.get(f)) else {
        return Err(format!("face {face} does not exist: 1 to 6 are needed"));
    };
    let mut ranges = [[s1, e1], [s2, e2]];
    let cells = of.face_cells(face);
    let ours = |d: usize| if turned(face) { 1 - d } else { d };
    let mut window = Window { lo: [0; 2], hi: [0; 2] };
    let mut backwards = [false; 2];
    for d in 0..2 {
        let n = cells[ours(d)];
        // Across a 2-D grid the file says 1 to 1.
        if ranges[d] == [1, 1] && n == 1 {
            ranges[d] = [1, 2];
        }
        let [s, e] = ranges[d];
        let (lo, hi) = (s.min(e), s.max(e));
        if lo == 0 || lo == hi || hi > n + 1 {
            return Err(format!(
                "nodes {s} to {e} do not lie on {face} of block {block}, which has 1 to {}",
                n + 1
            ));
        }
        backwards[d] = s > e;
        window.lo[ours(d)] = lo - 1;
        window.hi[ours(d)] = hi - 1;
    }
    Ok(FileSide {
        side: Side {
            block: block - 1,
            face,
            window,
        },
        backwards,
    })
}

fn interface(a: &FileSide, b: &FileSide, swap: bool) -> Interface {
    // From our directions on a to the file's, across, and to ours on b.
    let to_file = |s: &FileSide| {
        let swap = turned(s.side.face);
        Orientation {
            swap,
            reverse: s.backwards,
        }
    };
    let across = Orientation {
        swap,
        reverse: [false, false],
    };
    let orientation = to_file(a).then(across).then(to_file(b).inverse());
    Interface {
        a: a.side,
        b: b.side,
        orientation,
        period: None,
    }
}

/// The text of a neutral map file for a grid. Periodic interfaces have no place in the format and are left out; the
/// number left out comes back too.
#[must_use]
pub fn format(grid: &MultiBlock) -> (String, usize) {
    let mut out = String::from("# Neutral map file\n# Block  IDIM  JDIM  KDIM\n");
    let _ = writeln!(out, "{}", grid.blocks.len());
    for (n, block) in grid.blocks.iter().enumerate() {
        let [i, j, k] = block.nodes();
        let _ = writeln!(out, "{} {i} {j} {k}", n + 1);
    }
    out.push_str("# Type  B1 F1  S1 E1  S2 E2  B2 F2  S1 E1  S2 E2  Swap\n");
    let numbers = |side: &Side, reverse: [bool; 2]| {
        let face = FACES.iter().position(|f| *f == side.face).unwrap_or(0) + 1;
        let range = |d: usize| {
            let ours = if turned(side.face) { 1 - d } else { d };
            let (lo, hi) = (side.window.lo[ours] + 1, side.window.hi[ours] + 1);
            if reverse[d] {
                format!("{hi} {lo}")
            } else {
                format!("{lo} {hi}")
            }
        };
        format!("{} {face}  {}  {}", side.block + 1, range(0), range(1))
    };
    for patch in &grid.topology.patches {
        let name = match patch.condition {
            Condition::Wall => "wall",
            Condition::WallSlip => "tangency",
            Condition::WallNoSlip => "viscous_solid",
            Condition::Symmetry => "symmetry",
            Condition::FarField => "farfield_riem",
            Condition::InflowSubsonic => "inflow",
            Condition::InflowSupersonic => "inflow_supersonic",
            Condition::OutflowSubsonic => "back_pressure",
            Condition::OutflowSupersonic => "extrapolate",
            Condition::Collapsed => "pole",
        };
        let _ = writeln!(out, "'{name}'  {}", numbers(&patch.side(), [false; 2]));
    }
    let mut left_out = 0;
    for interface in &grid.topology.interfaces {
        if interface.period.is_some() {
            left_out += 1;
            continue;
        }
        // In the file's directions on both sides: what is left is swap, and b's directions that run backwards.
        let into = |face: Face| Orientation {
            swap: turned(face),
            reverse: [false; 2],
        };
        let (fa, fb) = (into(interface.a.face), into(interface.b.face));
        let Orientation { swap, reverse } = fa.inverse().then(interface.orientation).then(fb);
        let word = if swap { "TRUE" } else { "FALSE" };
        let _ = writeln!(
            out,
            "'ONE_TO_ONE'  {}  {}  {word}",
            numbers(&interface.a, [false; 2]),
            numbers(&interface.b, reverse)
        );
    }
    (out, left_out)
}
