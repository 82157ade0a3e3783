//! Normal modes that a subcase asks for, and those of them that flutter uses.

use dip_modal::{ModeNode, Model, Modes, ModesRequest, NodeDof, Normalization};
use dip_nastran::{
    Note, Severity,
    bulk::Bulk,
    cards::control::{ModesRequest as DeckRequest, Normalization as DeckNormalization},
    case_control::Subcase,
    modes::ModeTable,
};

use crate::{
    coordinate::Geometry,
    error::{Result, SolveError, misfit, missing},
    residual,
    structure::selected,
};

/// Number of modes when the deck bounds them neither by number nor by frequency.
const UNBOUNDED: usize = 50;

/// Computes the modes of the subcase's METHOD.
///
/// # Errors
/// No METHOD, a structure that cannot be solved.
pub fn normal_modes(bulk: &Bulk, model: &Model, subcase: &Subcase, notes: &mut Vec<Note>) -> Result<Modes> {
    let Some((set, at)) = selected(subcase, "METHOD")? else {
        return Err(SolveError::Missing {
            what: "selects no modes; add METHOD = n to the case control section and EIGR or EIGRL n to the bulk data"
                .to_owned(),
        });
    };
    let request = bulk
        .modes_requests
        .get(&set)
        .ok_or_else(|| missing(&at, format!("METHOD = {set}"), "EIGR or EIGRL", set))?;
    let system = model.assemble()?;
    if !system.auto_supports.is_empty() {
        notes.push(Note {
            at: at.clone(),
            card: "AUTOSPC".to_owned(),
            severity: Severity::Ignored,
            text: format!(
                "{} degrees of freedom without stiffness are fixed",
                system.auto_supports.len()
            ),
        });
    }
    let size = system.analysis_size();
    // With the methods of Givens' kind ND alone decides; with Lanczos the range bounds the modes too.
    let lanczos = request.method == "LAN";
    let range = if lanczos || request.count.is_none() {
        request.range_hz
    } else {
        [None, None]
    };
    let modes = system.modes(&ModesRequest {
        count: count(request, range, size),
        max_freq_hz: range[1].filter(|f| *f > 0.0),
        normalization: normalization(request)?,
        ..ModesRequest::default()
    })?;
    let low = range[0].unwrap_or(f64::NEG_INFINITY);
    let first = if low > 0.0 {
        modes
            .omega_rad_s
            .iter()
            .filter(|w| **w < low * std::f64::consts::TAU)
            .count()
    } else {
        0
    };
    let mut modes = keep(&modes, first..modes.count());
    if modes.count() == 0 {
        return Err(misfit(
            &request.at,
            format!("EIGR {set}"),
            "finds no modes in its range of frequencies",
        ));
    }
    if wants_residuals(bulk, subcase, &modes)? {
        let text = if first > 0 || system.analysis_size() != system.size() {
            "residual vectors are not added to modes of a range from F1 on, nor to those of an analysis set; raise ND"
                .to_owned()
        } else {
            let computed = modes.count();
            let added = residual::append(model, &system, &mut modes)?;
            format!("{added} residual vectors of inertia loads (INRLOD) follow the {computed} computed modes")
        };
        notes.push(Note {
            at: request.at.clone(),
            card: format!("EIGR {set}"),
            severity: Severity::Warning,
            text,
        });
    }
    Ok(modes)
}

/// Whether residual vectors are to be added: RESVEC says so, or PARAM LMODES uses more modes than METHOD gives.
///
/// Nastran adds them by default since 2004; older results, and most published ones, are without.
fn wants_residuals(bulk: &Bulk, subcase: &Subcase, modes: &Modes) -> Result<bool> {
    if let Some(option) = subcase.text("RESVEC") {
        return Ok(!option.trim().to_uppercase().starts_with("NO"));
    }
    let used = match bulk.parameters.get("LMODES") {
        Some(p) => p.integer().map_err(|e| SolveError::Deck(e.into()))?,
        None => 0,
    };
    Ok(usize::try_from(used).is_ok_and(|n| n > modes.count()))
}

fn count(request: &DeckRequest, range: [Option<f64>; 2], size: usize) -> usize {
    match (request.count, range[1]) {
        // Modes below F1 are computed first and then left out.
        (Some(n), _) if range[0].is_some_and(|f| f > 0.0) => (n + UNBOUNDED).min(size),
        (Some(n), _) => n.min(size),
        (None, Some(f)) if f > 0.0 => size.min(2000),
        (None, _) => size.min(UNBOUNDED),
    }
    .max(1)
}

fn normalization(request: &DeckRequest) -> Result<Normalization> {
    Ok(match request.normalization {
        DeckNormalization::Mass => Normalization::Mass,
        DeckNormalization::Max => Normalization::Maximum,
        DeckNormalization::Point(dof) => match dip_modal::Dof::from_index(dof.component) {
            Some(d) => Normalization::Point(NodeDof::new(dof.point, d)),
            None => {
                return Err(misfit(
                    &request.at,
                    format!("EIGR {}", request.id),
                    "needs a component from 0 to 6",
                ));
            }
        },
    })
}

/// The modes of a range.
fn keep(modes: &Modes, range: std::ops::Range<usize>) -> Modes {
    let part = |list: &[f64]| list.get(range.clone()).unwrap_or(&[]).to_vec();
    Modes {
        nodes: modes.nodes.clone(),
        shapes: modes.shapes.get(range.clone()).unwrap_or(&[]).to_vec(),
        omega_rad_s: part(&modes.omega_rad_s),
        generalized_mass: part(&modes.generalized_mass),
        residual: part(&modes.residual),
    }
}

/// Modes of a file as the deck's grid points have them: displacements in each point's system.
///
/// # Errors
/// Points that the deck does not have.
pub fn modes_of_file(bulk: &Bulk, geometry: &Geometry, table: &ModeTable) -> Result<Modes> {
    let mut nodes = Vec::with_capacity(table.points.len());
    for id in &table.points {
        let (position, frame) = match (bulk.grids.get(id), geometry.grid(*id)) {
            (Some(grid), Some(position)) => {
                let frame = geometry
                    .frame(grid.cd)
                    .ok_or_else(|| missing(&grid.at, format!("GRID {id}"), "coordinate system", grid.cd))?;
                (position, frame.directions(position))
            }
            _ if bulk.scalar_points.contains(id) => (nalgebra::Vector3::zeros(), nalgebra::Matrix3::identity()),
            _ => {
                return Err(SolveError::Missing {
                    what: format!(
                        "has no GRID {id}, which the mode file holds; deck and mode file must be of one model"
                    ),
                });
            }
        };
        nodes.push(ModeNode {
            id: *id,
            position,
            frame,
        });
    }
    let count = table.shapes.len().min(table.eigenvalues.len());
    let eigenvalues = &table.eigenvalues[..count];
    Ok(Modes {
        nodes,
        shapes: table.shapes[..count].to_vec(),
        omega_rad_s: eigenvalues.iter().map(|e| e.eigenvalue.max(0.0).sqrt()).collect(),
        // Punch files do not give it; modes are normalized by mass unless the deck asks otherwise.
        generalized_mass: eigenvalues.iter().map(|e| e.generalized_mass.unwrap_or(1.0)).collect(),
        residual: Vec::new(),
    })
}

/// The modes that flutter uses: PARAM LMODES, or LFREQ to HFREQ, or all.
///
/// # Errors
/// Parameters that are no numbers, or that leave nothing.
pub fn used(bulk: &Bulk, modes: &Modes) -> Result<Modes> {
    let deck = |e: dip_nastran::DeckError| SolveError::Deck(e.into());
    let real = |name: &str, default: f64| -> Result<f64> {
        bulk.parameters
            .get(name)
            .map_or(Ok(default), |p| p.real().map_err(deck))
    };
    let lmodes = match bulk.parameters.get("LMODES") {
        Some(p) => p.integer().map_err(deck)?,
        None => 0,
    };
    if lmodes > 0 {
        return Ok(keep(
            modes,
            0..modes.count().min(usize::try_from(lmodes).unwrap_or(usize::MAX)),
        ));
    }
    let (low, high) = (real("LFREQ", 0.0)?, real("HFREQ", 1e30)?);
    let from = (0..modes.count()).take_while(|m| modes.freq_hz(*m) < low).count();
    let to = (0..modes.count()).take_while(|m| modes.freq_hz(*m) <= high).count();
    if from >= to {
        return Err(SolveError::Missing {
            what: format!("uses no mode: none lies between PARAM LFREQ {low} and HFREQ {high} Hz"),
        });
    }
    Ok(keep(modes, from..to))
}
