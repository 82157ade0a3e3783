//! From `[modes]` and `[spline]` to a table of modes and the motion of the boxes.

use super::structure;
use crate::exit::Stop;
use crate::stamp::Fingerprint;
use dip_case::file::{FlutterFile, ModesTable, SplineKind, SplineTable};
use dip_case::table::Table;
use dip_case::units::Frequency;
use dip_case::wing::Wing;
use dip_case::{CaseError, Document};
use dip_dlm::gaf::PointRule;
use dip_dlm::lattice::Lattice;
use dip_dlm::motion::BoxMotion;
use dip_dlm::spline::{self, BeamSpline, SplineSpec, Transfer};
use dip_modal::{ModeNode, Modes};
use nalgebra::Matrix3;
use std::path::Path;

/// Modes, and what is known of the structure besides.
#[derive(Debug)]
pub struct Structure {
    /// Modes.
    pub modes: Modes,
    /// Mass of the model, kg; none for modes from a file.
    pub mass_kg: Option<f64>,
    /// Nodes (places in the table of modes) of each element in order round it; empty for modes from a file.
    pub elements: Vec<Vec<usize>>,
    /// Shapes in the output are scaled to a largest displacement of 1.
    pub max_scale: bool,
}

/// Adds what the modes depend on.
pub fn fingerprint(document: &Document, table: &ModesTable, fingerprint: &mut Fingerprint) {
    if let Some(path) = &table.structure {
        match Document::read(&document.path(path), &[]) {
            Ok(structure) => structure::fingerprint(&structure, fingerprint),
            Err(_) => {
                fingerprint.file(document.path(path));
            }
        }
    }
    for path in table.file.iter().chain(&table.geometry) {
        fingerprint.file(document.path(path));
    }
}

/// The modes of a case.
///
/// # Errors
/// What is wrong in `[modes]`, or in the structure or the table that it names.
pub fn modes(document: &Document, file: &FlutterFile) -> Result<Structure, Stop> {
    let Some(table) = &file.modes else {
        let help = "add [modes] with structure = \"structure.toml\", or with file and frequencies";
        return Err(document.error("", "missing table [modes]", help).into());
    };
    let solved = from_table(document, table)?;
    let wing = Wing::read(&Document::read(&document.path(&file.wing), &[])?)?;
    check_on_wing(document, table, &wing, &solved.modes)?;
    Ok(solved)
}

/// The modes that a `[modes]` table names.
///
/// # Errors
/// What is wrong in it, or in the structure or the table that it names.
pub fn from_table(document: &Document, table: &ModesTable) -> Result<Structure, Stop> {
    let mut solved = match (&table.structure, &table.file) {
        (Some(path), None) => {
            for (key, given) in [
                ("generalized_masses", table.generalized_masses.is_some()),
                ("geometry", table.geometry.is_some()),
                ("length_unit", table.length_unit.is_some()),
                ("mass_unit", table.mass_unit.is_some()),
            ] {
                if given {
                    let message = format!("`{key}` beside `structure`: the structure gives it");
                    return Err(document.error(&format!("modes.{key}"), message, "leave it out").into());
                }
            }
            let mut solved = structure::modes(&Document::read(&document.path(path), &[])?)?;
            if let Some(measured) = &table.frequencies {
                replace_frequencies(document, table, measured, &mut solved.modes)?;
            }
            solved
        }
        (None, Some(path)) => {
            let path = document.path(path);
            let csv = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
            let modes = if csv {
                from_csv(document, table, &path)?
            } else {
                super::nastran_modes::read(document, table, &path)?
            };
            Structure {
                modes,
                mass_kg: None,
                elements: Vec::new(),
                max_scale: false,
            }
        }
        (Some(_), Some(_)) => {
            let help = "give only one of them";
            return Err(document
                .error("modes.file", "both a structure and a file of modes", help)
                .into());
        }
        (None, None) => {
            let help = "add structure = \"structure.toml\", or file = \"modes.csv\" with frequencies";
            return Err(document
                .error("modes", "neither a structure nor a file of modes", help)
                .into());
        }
    };
    if let Some(count) = table.count {
        let there = solved.modes.count();
        if count == 0 || count > there {
            let message = format!("{count} modes: there are {there}");
            return Err(document
                .error(
                    "modes.count",
                    message,
                    "give a smaller count, or more modes in the structure",
                )
                .into());
        }
        let modes = &mut solved.modes;
        modes.shapes.truncate(count);
        modes.omega_rad_s.truncate(count);
        modes.generalized_mass.truncate(count);
        modes.residual.truncate(count);
    }
    Ok(solved)
}

/// Gives computed modes other frequencies, as those of a ground vibration test; shapes and generalized masses stay, stiffness follows.
fn replace_frequencies(
    document: &Document,
    table: &ModesTable,
    measured: &[Frequency],
    modes: &mut Modes,
) -> Result<(), Stop> {
    let wanted = table.count.unwrap_or_else(|| modes.count());
    if measured.len() != wanted {
        let message = format!("{} frequencies for the structure's {wanted} modes", measured.len());
        let help = "give one for each mode in order, or another modes.count; left out, the computed ones stay";
        return Err(document.error("modes.frequencies", message, help).into());
    }
    check_frequencies(document, measured)?;
    modes
        .omega_rad_s
        .iter_mut()
        .zip(measured)
        .for_each(|(own, f)| *own = f.0);
    Ok(())
}

fn check_frequencies(document: &Document, frequencies: &[Frequency]) -> Result<(), Stop> {
    match frequencies.iter().position(|f| f.0 < 0.0) {
        Some(i) => Err(document
            .error(
                &format!("modes.frequencies.{i}"),
                "a negative frequency",
                "needed zero or more",
            )
            .into()),
        None => Ok(()),
    }
}

/// Metres in the unit that a column name ends with: `x_in`, `x_m`.
fn length_unit(suffix: &str) -> Option<f64> {
    dip_case::units::parse::<dip_case::units::Length>(&format!("1 {suffix}")).ok()
}

/// Modes from a CSV table: `x_<unit>`, `y_<unit>`, `z_<unit>` (may be missing: 0), `phi1`, `phi2`, ...
fn from_csv(document: &Document, keys: &ModesTable, path: &Path) -> Result<Modes, Stop> {
    let table = Table::read(path)?;
    let shapes: Vec<String> = (1..)
        .map(|m| format!("phi{m}"))
        .take_while(|name| table.has(name))
        .collect();
    if shapes.is_empty() {
        // Names the columns that are there.
        table.numbers("phi1")?;
    }
    let coordinate = |axis: &str| -> Result<Option<Vec<f64>>, CaseError> {
        let name = table.header().iter().find_map(|h| {
            let unit = h.strip_prefix(axis)?.strip_prefix('_')?;
            length_unit(unit).map(|factor| (h.clone(), factor))
        });
        match name {
            Some((name, factor)) => Ok(Some(table.numbers(&name)?.iter().map(|v| v * factor).collect())),
            None => Ok(None),
        }
    };
    let missing = |axis: &str| {
        let message = format!(
            "{}: no column `{axis}_m` (or `{axis}_in`, `{axis}_mm`, `{axis}_ft`)",
            path.display()
        );
        CaseError::new(message, Some(format!("the columns are {}", table.header().join(", "))))
    };
    let x = coordinate("x")?.ok_or_else(|| missing("x"))?;
    let y = coordinate("y")?.ok_or_else(|| missing("y"))?;
    let z = coordinate("z")?.unwrap_or_else(|| vec![0.0; x.len()]);
    let Some(frequencies) = &keys.frequencies else {
        let help = format!(
            "the table has {} shapes: give as many frequencies, as in [\"9.6 Hz\", ...]",
            shapes.len()
        );
        return Err(document.error("modes", "missing key `frequencies`", help).into());
    };
    let wanted = keys.count.unwrap_or(shapes.len()).min(shapes.len());
    if frequencies.len() < wanted {
        let message = format!("{} frequencies for {wanted} shapes", frequencies.len());
        return Err(document
            .error(
                "modes.frequencies",
                message,
                "give one for each shape, or a smaller `count`",
            )
            .into());
    }
    check_frequencies(document, frequencies)?;
    let masses: Vec<f64> = match &keys.generalized_masses {
        Some(list) if list.len() < wanted => {
            let message = format!("{} generalized masses for {wanted} shapes", list.len());
            return Err(document
                .error("modes.generalized_masses", message, "give one for each shape")
                .into());
        }
        Some(list) => list.iter().map(|m| m.0).collect(),
        None => vec![1.0; wanted],
    };
    if let Some(i) = masses.iter().position(|m| m.is_nan() || *m <= 0.0) {
        let key = format!("modes.generalized_masses.{i}");
        return Err(document
            .error(&key, "a generalized mass that is not positive", "needed more than zero")
            .into());
    }
    let mut all = Vec::new();
    for name in shapes.iter().take(wanted) {
        all.push(
            table
                .numbers(name)?
                .iter()
                .map(|w| [0.0, 0.0, *w, 0.0, 0.0, 0.0])
                .collect(),
        );
    }
    let nodes = (0..x.len()).map(|n| ModeNode {
        id: u32::try_from(n + 1).unwrap_or(u32::MAX),
        position: [x[n], y[n], z[n]].into(),
        frame: Matrix3::identity(),
    });
    Ok(Modes {
        nodes: nodes.collect(),
        shapes: all,
        omega_rad_s: frequencies.iter().take(wanted).map(|f| f.0).collect(),
        generalized_mass: masses.into_iter().take(wanted).collect(),
        residual: Vec::new(),
    })
}

/// Modes that lie elsewhere than the wing, or are of another size, are a mistake in units or files.
fn check_on_wing(document: &Document, table: &ModesTable, wing: &Wing, modes: &Modes) -> Result<(), Stop> {
    let key = if table.file.is_some() {
        "modes.file"
    } else {
        "modes.structure"
    };
    let extent = |points: &mut dyn Iterator<Item = f64>| {
        points.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
    };
    let corners: Vec<[f64; 3]> = wing
        .sections
        .iter()
        .flat_map(|s| [s.point(0.0), s.point(1.0)])
        .collect();
    for (axis, name) in [(1, "span (y)"), (0, "chord (x)")] {
        let (low, high) = extent(&mut modes.nodes.iter().map(|n| n.position[axis]));
        let (wing_low, wing_high) = extent(&mut corners.iter().map(|c| c[axis]));
        let size = wing_high - wing_low;
        if size <= 0.0 {
            continue;
        }
        let inside = low > wing_low - 0.5 * size && high < wing_high + 0.5 * size;
        if !inside || high - low < 0.25 * size {
            let what = table
                .file
                .as_ref()
                .or(table.structure.as_ref())
                .map(|p| p.display().to_string())
                .unwrap_or_default();
            let message = format!(
                "the modes of {what} do not match the wing: along the {name} their nodes go from {low:.4} to {high:.4} m, the wing from {wing_low:.4} to {wing_high:.4} m"
            );
            return Err(document
                .error(
                    key,
                    message,
                    "check the units of the node positions and which wing the file is of",
                )
                .into());
        }
    }
    Ok(())
}

/// Motion of the boxes in every mode.
///
/// # Errors
/// Nodes that the spline can't use.
pub fn box_motion(
    document: &Document,
    table: &SplineTable,
    lattice: &Lattice,
    rule: PointRule,
    modes: &Modes,
) -> Result<BoxMotion, Stop> {
    let nodes: Vec<[f64; 3]> = modes.nodes.iter().map(|n| n.position.into()).collect();
    let mut specs = Vec::new();
    for (surface, own) in nodes_of_surfaces(lattice, &nodes).into_iter().enumerate() {
        let boxes: Vec<usize> = lattice.surface_boxes(surface).collect();
        let kind = match table.kind {
            // Surfaces without a structure of their own do not move.
            _ if own.is_empty() => continue,
            SplineKind::InfinitePlate => spline::SplineKind::InfinitePlate {
                flexibility: table.smoothing,
            },
            SplineKind::ThinPlate => spline::SplineKind::ThinPlate {
                flexibility: table.smoothing,
            },
            SplineKind::Beam => spline::SplineKind::Beam(beam(&nodes, &own, table.smoothing)),
            SplineKind::Rigid => spline::SplineKind::Rigid,
        };
        specs.push(SplineSpec {
            boxes,
            nodes: own,
            kind,
        });
    }
    let transfer = Transfer::new(lattice, &nodes, &specs, rule).map_err(|e| {
        document.error(
            "spline",
            e.to_string(),
            "choose another spline, or check the nodes of the modes",
        )
    })?;
    let freedoms: Vec<Vec<f64>> = (0..modes.count())
        .map(|m| {
            let motion = |n: usize| {
                let (u, r) = modes.motion(m, n);
                [u.x, u.y, u.z, r.x, r.y, r.z]
            };
            (0..nodes.len()).flat_map(motion).collect()
        })
        .collect();
    transfer.motion(&freedoms).map_err(|e| {
        document
            .error("spline", e.to_string(), "check the nodes of the modes")
            .into()
    })
}

/// Nodes that move each surface: its nearest ones; panels of one wing share theirs.
fn nodes_of_surfaces(lattice: &Lattice, nodes: &[[f64; 3]]) -> Vec<Vec<usize>> {
    let count = lattice.surfaces().len();
    let distance2 = |p: [f64; 3], q: [f64; 3]| (0..3).map(|d| (p[d] - q[d]).powi(2)).sum::<f64>();
    let nearest = |p: [f64; 3]| {
        let pairs = lattice.boxes().iter().map(|b| (distance2(p, b.mid_chord), b.surface));
        pairs.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |(_, s)| s)
    };
    let mut own = vec![Vec::new(); count];
    for (n, p) in nodes.iter().enumerate() {
        own[nearest(*p)].push(n);
    }
    // Neighbouring panels (an edge in common) form one body: a plate spline over all of its nodes stays smooth at the kink.
    let touches = |a: usize, b: usize| {
        let (p, q) = (&lattice.surfaces()[a], &lattice.surfaces()[b]);
        let scale = 1e-9 * (p.chord_1 + p.chord_2 + q.chord_1 + q.chord_2).powi(2);
        [p.leading_edge_1, p.leading_edge_2].iter().any(|e| {
            [q.leading_edge_1, q.leading_edge_2]
                .iter()
                .any(|f| distance2(*e, *f) < scale)
        })
    };
    let mut body: Vec<usize> = (0..count).collect();
    for a in 0..count {
        for b in 0..a {
            if touches(a, b) {
                let (from, to) = (body[a], body[b]);
                body.iter_mut().filter(|x| **x == from).for_each(|x| *x = to);
            }
        }
    }
    (0..count)
        .map(|s| {
            let mut all: Vec<usize> = (0..count)
                .filter(|o| body[*o] == body[s])
                .flat_map(|o| own[o].clone())
                .collect();
            all.sort_unstable();
            all
        })
        .collect()
}

/// A beam along the nodes: from the mean of the inboard ones to the mean of the outboard ones.
fn beam(nodes: &[[f64; 3]], own: &[usize], smoothing: f64) -> BeamSpline {
    let span = |n: &usize| nodes[*n][1].hypot(nodes[*n][2]);
    let mut sorted: Vec<usize> = own.to_vec();
    sorted.sort_by(|a, b| span(a).total_cmp(&span(b)));
    let mean = |list: &[usize]| -> [f64; 3] {
        std::array::from_fn(|d| list.iter().map(|&n| nodes[n][d]).sum::<f64>() / list.len().max(1) as f64)
    };
    let tenth = (sorted.len() / 10).max(1).min(sorted.len());
    let (origin, end) = (mean(&sorted[..tenth]), mean(&sorted[sorted.len() - tenth..]));
    BeamSpline {
        origin,
        direction: std::array::from_fn(|d| end[d] - origin[d]),
        torsion_flexibility: 1.0,
        displacement_flexibility: smoothing,
        bending_rotation_flexibility: None,
        twist_rotation_flexibility: None,
        twist_gradient: true,
    }
}
