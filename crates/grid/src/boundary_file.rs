//! Boundary conditions and interfaces in a TOML file beside the grid.
//!
//! ```toml
//! [[patch]]
//! name = "wing"
//! block = 0                # counted from 0, as in all messages
//! face = "jmin"
//! window = [16, 80, 0, 18] # cells from, to (exclusive) along both directions of the face; the whole face if left out
//! condition = "wall"
//!
//! [[interface]]            # if left out, interfaces are found by their points
//! a = { block = 0, face = "imin" }
//! b = { block = 0, face = "imax" }
//! swap = false
//! reverse = [false, false]
//! translation = [1.0, 0.0, 0.0] # periodic: from a to b; or
//! # rotation = { centre = [0.0, 0.0, 0.0], axis = [1.0, 0.0, 0.0], angle_deg = 30.0 }
//!
//! [[periodic]]             # interfaces that are found by their points after a shift or a turn
//! rotation = { axis = [1.0, 0.0, 0.0], angle_deg = 30.0 }
//! ```

use std::fmt::Write;

use serde::Deserialize;

use crate::face::{Face, Window};
use crate::period::Period;
use crate::topology::{Condition, Interface, MultiBlock, Orientation, Patch, Side, Topology};

/// What is wrong with a boundary file.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
#[error("{file}: {what}")]
pub struct BoundaryError {
    /// The file.
    pub file: String,
    /// Where, what is needed, what was got.
    pub what: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    patch: Vec<PatchTable>,
    #[serde(default)]
    interface: Vec<InterfaceTable>,
    #[serde(default)]
    periodic: Vec<PeriodTable>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
struct RotationTable {
    #[serde(default)]
    centre: [f64; 3],
    axis: [f64; 3],
    angle_deg: f64,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
struct PeriodTable {
    translation: Option<[f64; 3]>,
    rotation: Option<RotationTable>,
}

impl PeriodTable {
    fn period(self) -> Result<Option<Period>, String> {
        let period = match (self.translation, self.rotation) {
            (None, None) => return Ok(None),
            (Some(way), None) => Period::Translation(way),
            (None, Some(turn)) => Period::Rotation {
                centre: turn.centre,
                axis: turn.axis,
                angle_deg: turn.angle_deg,
            },
            (Some(_), Some(_)) => return Err("either translation or rotation is needed, not both".into()),
        };
        period.fault().map_or(Ok(Some(period)), |fault| Err(fault.into()))
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PatchTable {
    name: String,
    block: usize,
    face: String,
    window: Option<[usize; 4]>,
    condition: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SideTable {
    block: usize,
    face: String,
    window: Option<[usize; 4]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct InterfaceTable {
    a: SideTable,
    b: SideTable,
    #[serde(default)]
    swap: bool,
    #[serde(default)]
    reverse: [bool; 2],
    translation: Option<[f64; 3]>,
    rotation: Option<RotationTable>,
}

/// Reads the topology of `grid` (whose blocks are known) from the text of a boundary file.
/// # Errors
/// TOML that is not understood (with its line), a block, face, condition or window that does not exist.
pub fn parse(file: &str, text: &str, grid: &MultiBlock) -> Result<Topology, BoundaryError> {
    parse_with_periods(file, text, grid).map(|(topology, _)| topology)
}

/// The same, with the periods by which further interfaces are to be found.
/// # Errors
/// As [`parse`]; a period that is none.
pub fn parse_with_periods(file: &str, text: &str, grid: &MultiBlock) -> Result<(Topology, Vec<Period>), BoundaryError> {
    let fail = |what: String| BoundaryError {
        file: file.to_owned(),
        what,
    };
    let tables: File = toml::from_str(text).map_err(|e| fail(e.to_string()))?;
    let mut topology = Topology::default();
    for (n, table) in tables.patch.iter().enumerate() {
        let place = format!("patch {} ({})", n + 1, table.name);
        let side = side(grid, table.block, &table.face, table.window).map_err(|e| fail(format!("{place}: {e}")))?;
        let condition = Condition::parse(&table.condition).ok_or_else(|| {
            let known: Vec<&str> = Condition::ALL.iter().map(|c| c.name()).collect();
            fail(format!(
                "{place}: unknown condition \"{}\"; known are {}",
                table.condition,
                known.join(", ")
            ))
        })?;
        topology.patches.push(Patch {
            name: table.name.clone(),
            block: side.block,
            face: side.face,
            window: side.window,
            condition,
        });
    }
    for (n, table) in tables.interface.iter().enumerate() {
        let place = format!("interface {}", n + 1);
        let read = |s: &SideTable| side(grid, s.block, &s.face, s.window).map_err(|e| fail(format!("{place}: {e}")));
        let orientation = Orientation {
            swap: table.swap,
            reverse: table.reverse,
        };
        let (a, b) = (read(&table.a)?, read(&table.b)?);
        if orientation.size(a.window.size()) != b.window.size() {
            let (sa, sb) = (a.window.size(), b.window.size());
            return Err(fail(format!(
                "{place}: {} x {} cells cannot lie on {} x {}{}",
                sa[0],
                sa[1],
                sb[0],
                sb[1],
                if table.swap { " with swap" } else { "" }
            )));
        }
        topology.interfaces.push(Interface {
            a,
            b,
            orientation,
            period: PeriodTable {
                translation: table.translation,
                rotation: table.rotation,
            }
            .period()
            .map_err(|e| fail(format!("{place}: {e}")))?,
        });
    }
    let mut periods = Vec::new();
    for (n, table) in tables.periodic.iter().enumerate() {
        let place = format!("periodic {}", n + 1);
        let period = table.period().map_err(|e| fail(format!("{place}: {e}")))?;
        periods.push(period.ok_or_else(|| fail(format!("{place}: a translation or a rotation is needed")))?);
    }
    Ok((topology, periods))
}

fn side(grid: &MultiBlock, block: usize, face: &str, window: Option<[usize; 4]>) -> Result<Side, String> {
    let Some(of) = grid.blocks.get(block) else {
        return Err(format!(
            "block {block} does not exist; the grid has {}, counted from 0",
            grid.blocks.len()
        ));
    };
    let Some(face) = Face::parse(face) else {
        return Err(format!(
            "unknown face \"{face}\"; known are imin, imax, jmin, jmax, kmin, kmax"
        ));
    };
    let cells = of.face_cells(face);
    let window = window.map_or(Window::full(cells), |[p0, p1, q0, q1]| Window::new([p0, q0], [p1, q1]));
    if (0..2).any(|d| window.lo[d] >= window.hi[d] || window.hi[d] > cells[d]) {
        return Err(format!(
            "window of {window} does not lie on {face} of block {block}, which has {} x {} cells",
            cells[0], cells[1]
        ));
    }
    Ok(Side { block, face, window })
}

/// The text of a boundary file for a topology.
#[must_use]
pub fn format(topology: &Topology) -> String {
    let mut out = String::from("# Blocks count from 0; windows are cells [from, to, from, to], ends exclusive.\n");
    let window = |w: Window| format!("[{}, {}, {}, {}]", w.lo[0], w.hi[0], w.lo[1], w.hi[1]);
    for patch in &topology.patches {
        let _ = writeln!(
            out,
            "\n[[patch]]\nname = {:?}\nblock = {}\nface = \"{}\"\nwindow = {}\ncondition = \"{}\"",
            patch.name,
            patch.block,
            patch.face,
            window(patch.window),
            patch.condition
        );
    }
    for interface in &topology.interfaces {
        let side = |s: Side| {
            format!(
                "{{ block = {}, face = \"{}\", window = {} }}",
                s.block,
                s.face,
                window(s.window)
            )
        };
        let Orientation { swap, reverse } = interface.orientation;
        let _ = writeln!(
            out,
            "\n[[interface]]\na = {}\nb = {}\nswap = {swap}\nreverse = [{}, {}]",
            side(interface.a),
            side(interface.b),
            reverse[0],
            reverse[1]
        );
        match interface.period {
            None => {}
            Some(Period::Translation(way)) => {
                let _ = writeln!(out, "translation = {way:?}");
            }
            Some(Period::Rotation {
                centre,
                axis,
                angle_deg,
            }) => {
                let _ = writeln!(
                    out,
                    "rotation = {{ centre = {centre:?}, axis = {axis:?}, angle_deg = {angle_deg:?} }}"
                );
            }
        }
    }
    out
}
