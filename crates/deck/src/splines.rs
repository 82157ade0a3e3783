//! SPLINE cards tied to the boxes and points of a deck.

use std::collections::{BTreeMap, BTreeSet};

use dip_dlm::{
    gaf::PointRule,
    lattice::Lattice,
    spline::{BeamSpline, SplineError, SplineKind, SplineSpec, Transfer},
};
use dip_nastran::{
    Location,
    bulk::Bulk,
    cards::spline::{SplineBoxes, SplineUsage, SurfaceSplineMethod},
};

use crate::{
    aerodynamics::local,
    coordinate::{Frame, Geometry},
    error::{Result, SolveError, misfit, missing},
};

/// Boxes with their splines.
pub(crate) struct Part {
    pub lattice: Lattice,
    pub transfer: Transfer,
}

/// A spline before its boxes are known: which boxes, which points, how, and where it stands.
pub(crate) struct Request {
    pub name: String,
    pub at: Location,
    pub panel: u32,
    pub boxes: SplineBoxes,
    pub set: u32,
    pub kind: SplineKind,
    pub usage: SplineUsage,
}

/// All splines of the deck in a common form.
pub(crate) fn requests(bulk: &Bulk, geometry: &Geometry, frame: &Frame) -> Result<Vec<Request>> {
    let mut found = Vec::new();
    for spline in bulk.surface_splines.values() {
        found.push(Request {
            name: format!("SPLINE1 {}", spline.id),
            at: spline.at.clone(),
            panel: spline.panel,
            boxes: spline.boxes,
            set: spline.set,
            usage: spline.usage,
            kind: match spline.method {
                SurfaceSplineMethod::InfinitePlate => SplineKind::InfinitePlate { flexibility: spline.dz },
                SurfaceSplineMethod::ThinPlate => SplineKind::ThinPlate { flexibility: spline.dz },
                SurfaceSplineMethod::FinitePlate => {
                    return Err(misfit(
                        &spline.at,
                        format!("SPLINE1 {}", spline.id),
                        "the finite plate (FPS) is not supported; use IPS or TPS",
                    ));
                }
            },
        });
    }
    for spline in bulk.beam_splines.values() {
        let name = format!("SPLINE2 {}", spline.id);
        let system = geometry
            .frame(spline.coordinate)
            .ok_or_else(|| missing(&spline.at, name.clone(), "coordinate system", spline.coordinate))?;
        let axis = frame.axes.transpose() * system.axes.column(1);
        found.push(Request {
            name,
            at: spline.at.clone(),
            panel: spline.panel,
            boxes: spline.boxes,
            set: spline.set,
            usage: spline.usage,
            kind: SplineKind::Beam(BeamSpline {
                origin: local(frame, system.origin),
                direction: axis.into(),
                torsion_flexibility: spline.dtor,
                displacement_flexibility: spline.dz,
                bending_rotation_flexibility: (spline.dthx >= 0.0).then_some(spline.dthx),
                twist_rotation_flexibility: (spline.dthy >= 0.0).then_some(spline.dthy),
                twist_gradient: false,
            }),
        });
    }
    if found.is_empty() {
        return Err(SolveError::Missing {
            what: "has no splines; without SPLINE1 or SPLINE2 no box moves".to_owned(),
        });
    }
    found.sort_by_key(|r| r.at.line);
    for request in &found {
        if request.usage != SplineUsage::Both {
            return Err(misfit(
                &request.at,
                request.name.clone(),
                "carries forces or displacements alone (USAGE); only BOTH is supported",
            ));
        }
    }
    Ok(found)
}

/// Points of a spline: those of its SET1 that exist.
fn set_points(bulk: &Bulk, request: &Request) -> Result<Vec<u32>> {
    let set = bulk
        .point_sets
        .get(&request.set)
        .ok_or_else(|| missing(&request.at, request.name.clone(), "SET1", request.set))?;
    let mut points = Vec::new();
    for id in &set.ids {
        if bulk.grids.contains_key(id) {
            if !points.contains(id) {
                points.push(*id);
            }
        } else if !set.is_range {
            return Err(missing(&set.at, format!("SET1 {}", set.id), "GRID", *id));
        }
    }
    Ok(points)
}

/// Points of all splines, ascending.
pub(crate) fn spline_points(bulk: &Bulk, requests: &[Request]) -> Result<Vec<u32>> {
    let mut all = BTreeSet::new();
    for request in requests {
        all.extend(set_points(bulk, request)?);
    }
    Ok(all.into_iter().collect())
}

/// The splines whose panels are in this lattice.
pub(crate) fn part(
    bulk: &Bulk,
    lattice: Lattice,
    requests: &[Request],
    points: &[u32],
    nodes: &[[f64; 3]],
    taken: &mut BTreeSet<usize>,
) -> Result<Part> {
    let by_number: BTreeMap<u32, usize> = lattice.boxes().iter().enumerate().map(|(i, b)| (b.id, i)).collect();
    let mut specs = Vec::new();
    let mut cards = Vec::new();
    for (index, request) in requests.iter().enumerate() {
        let owned = |range: &SplineBoxes| match range {
            SplineBoxes::Range(first, _) => by_number.contains_key(first),
            SplineBoxes::List(list) => bulk
                .box_lists
                .get(list)
                .is_some_and(|l| l.ids.iter().any(|b| by_number.contains_key(b))),
        };
        if let SplineBoxes::List(list) = request.boxes
            && !bulk.box_lists.contains_key(&list)
        {
            return Err(missing(&request.at, request.name.clone(), "AELIST", list));
        }
        if !owned(&request.boxes) {
            continue;
        }
        taken.insert(index);
        let boxes = match request.boxes {
            SplineBoxes::Range(first, last) => rectangle(&lattice, &by_number, request, first, last)?,
            SplineBoxes::List(list) => listed(bulk, &by_number, request, list)?,
        };
        let spline_nodes = set_points(bulk, request)?
            .iter()
            .filter_map(|p| points.binary_search(p).ok())
            .collect();
        specs.push(SplineSpec {
            boxes,
            nodes: spline_nodes,
            kind: request.kind.clone(),
        });
        cards.push((request.name.clone(), request.at.clone()));
    }
    let transfer = Transfer::new(&lattice, nodes, &specs, PointRule::MidChord).map_err(|error| {
        let (name, at) = spline_of(&error, &cards, requests);
        SolveError::Card {
            at,
            card: name,
            what: in_deck_numbers(&error, points, &lattice),
        }
    })?;
    Ok(Part { lattice, transfer })
}

/// The boxes between two opposite corners of a panel.
fn rectangle(
    lattice: &Lattice,
    by_number: &BTreeMap<u32, usize>,
    request: &Request,
    first: u32,
    last: u32,
) -> Result<Vec<usize>> {
    let (Some(&a), Some(&b)) = (by_number.get(&first), by_number.get(&last)) else {
        return Err(missing(&request.at, request.name.clone(), "box", last));
    };
    let (a, b) = (lattice.boxes()[a], lattice.boxes()[b]);
    if a.surface != b.surface || b.chord_index < a.chord_index || b.span_index < a.span_index {
        return Err(misfit(
            &request.at,
            request.name.clone(),
            format!("boxes {first} and {last} must be the first and the last corner of a rectangle on one panel"),
        ));
    }
    Ok(lattice
        .boxes()
        .iter()
        .enumerate()
        .filter(|(_, c)| {
            c.surface == a.surface
                && (a.chord_index..=b.chord_index).contains(&c.chord_index)
                && (a.span_index..=b.span_index).contains(&c.span_index)
        })
        .map(|(i, _)| i)
        .collect())
}

fn listed(bulk: &Bulk, by_number: &BTreeMap<u32, usize>, request: &Request, list: u32) -> Result<Vec<usize>> {
    let mut boxes = Vec::new();
    for id in bulk.box_lists.get(&list).map_or(&[][..], |l| &l.ids) {
        match by_number.get(id) {
            Some(b) => boxes.push(*b),
            None => return Err(missing(&request.at, request.name.clone(), "box", *id)),
        }
    }
    Ok(boxes)
}

/// The card of the spline that an error is about.
fn spline_of(error: &SplineError, cards: &[(String, Location)], requests: &[Request]) -> (String, Location) {
    use SplineError as E;
    let index = match error {
        E::Index { spline, .. }
        | E::TooFewNodes { spline, .. }
        | E::Coincident { spline, .. }
        | E::Collinear { spline }
        | E::Singular { spline, .. }
        | E::Normals { spline, .. }
        | E::Value { spline, .. }
        | E::Rigid { spline, .. } => *spline,
        E::Twice { second, .. } => *second,
    };
    cards
        .get(index)
        .cloned()
        .unwrap_or_else(|| (requests[0].name.clone(), requests[0].at.clone()))
}

/// The error in the deck's own numbers of points and boxes.
fn in_deck_numbers(error: &SplineError, points: &[u32], lattice: &Lattice) -> String {
    use SplineError as E;
    let point = |i: &usize| points.get(*i).copied().unwrap_or(0);
    let number = |i: &usize| lattice.boxes().get(*i).map_or(0, |b| b.id);
    match error {
        E::Coincident { a, b, .. } => {
            format!(
                "points {} and {} lie at the same place of the spline's plane; take one out of the set",
                point(a),
                point(b)
            )
        }
        E::Collinear { .. } => "all its points lie on one line; add points off the line or use SPLINE2".to_owned(),
        E::Twice { box_index, .. } => format!("box {} already belongs to another spline", number(box_index)),
        E::Normals { a, b, .. } => {
            format!(
                "boxes {} and {} have different normals; give each panel its own spline",
                number(a),
                number(b)
            )
        }
        E::TooFewNodes { needed, got, .. } => format!("needs {needed} points or more, got {got}"),
        E::Rigid {
            motion,
            box_index,
            error,
            ..
        } => format!(
            "a rigid {motion} of its points is not reproduced on box {} (relative error {error:.1e}); its points do not \
             determine the motion there",
            number(box_index)
        ),
        E::Singular { advice, .. } => format!("its points do not determine the interpolation: {advice}"),
        E::Value { reason, .. } => reason.clone(),
        E::Index { .. } => error.to_string(),
    }
}
