//! CAERO1 panels as a lattice, CAERO4 panels as strips, splines, and the generalized forces of a set of modes.
//!
//! Everything is in the axes of the aerodynamic coordinate system (AERO's ACSID), whose x axis is the flow's direction.

use std::collections::{BTreeMap, BTreeSet};

use dip_dlm::{
    ComplexMatrix,
    aic::Aerodynamics,
    gaf::{PointRule, generalized_force},
    kernel::Kernel,
    lattice::{Divisions, Lattice, PlaneSymmetry, Surface},
    motion::BoxMotion,
    spline::{BeamSpline, SplineKind, SplineSpec, Transfer},
};
use dip_modal::Modes;
use dip_nastran::{
    Location, Note, Severity,
    bulk::Bulk,
    cards::{
        aero::{Division, SplineBoxes, SplineUsage, SurfaceSplineMethod},
        control::MachK,
    },
    case_control::Subcase,
};
use nalgebra::Vector3;

use crate::{
    coordinate::{Frame, Geometry},
    error::{Result, SolveError, misfit, missing},
    strip::Strips,
};

/// Generalized aerodynamic forces at one Mach number and reduced frequency.
#[derive(Debug, Clone)]
pub struct GeneralizedForces {
    /// Mach number.
    pub mach: f64,
    /// Reduced frequency omega c / (2 V).
    pub k: f64,
    /// QHH: force on mode `row` is dynamic pressure times Q times amplitude of mode `column`.
    pub q: ComplexMatrix,
}

/// The aerodynamic model of a deck: what does not depend on modes.
pub struct AeroModel {
    frame: Frame,
    /// Half of AERO's reference chord.
    pub semichord: f64,
    /// AERO's reference density.
    pub density: f64,
    lattice: Option<Part>,
    strips: Option<(Part, Strips)>,
    /// Points of the splines, in the order of `Part::transfer`'s nodes.
    points: Vec<u32>,
    /// Symmetry about the planes y = 0 and z = 0, for the summary's heading.
    pub symmetry: [PlaneSymmetry; 2],
}

/// Boxes with their splines.
struct Part {
    lattice: Lattice,
    transfer: Transfer,
}

/// A spline before its boxes are known: which boxes, which points, how, and where it stands.
struct Request {
    name: String,
    at: Location,
    panel: u32,
    boxes: SplineBoxes,
    set: u32,
    kind: SplineKind,
    usage: SplineUsage,
}

impl AeroModel {
    /// Builds lattice, strips and splines.
    ///
    /// # Errors
    /// No AERO card, cards that name missing ones, panels and splines that cannot be.
    pub fn new(bulk: &Bulk, geometry: &Geometry, subcase: &Subcase, notes: &mut Vec<Note>) -> Result<Self> {
        let Some(aero) = &bulk.aero else {
            return Err(SolveError::Missing {
                what: "has no AERO card; flutter needs its reference chord and density".to_owned(),
            });
        };
        let frame = *geometry
            .frame(aero.coordinate)
            .ok_or_else(|| missing(&aero.at, "AERO".to_owned(), "coordinate system", aero.coordinate))?;
        let symmetry = [
            symmetry(aero.symmetry_xz, subcase, "AESYMXZ")?,
            symmetry(aero.symmetry_xy, subcase, "AESYMXY")?,
        ];
        if bulk.panels.is_empty() && bulk.strip_panels.is_empty() {
            return Err(SolveError::Missing {
                what: "has no aerodynamic panels (CAERO1 or CAERO4)".to_owned(),
            });
        }
        check_box_numbers(bulk)?;
        let requests = requests(bulk, geometry, &frame)?;
        let points: Vec<u32> = spline_points(bulk, &requests)?;
        let nodes: Vec<[f64; 3]> = points
            .iter()
            .map(|p| local(&frame, geometry.grid(*p).unwrap_or_default()))
            .collect();
        let mut taken = BTreeSet::new();
        let lattice = if bulk.panels.is_empty() {
            None
        } else {
            let lattice = panels(bulk, geometry, &frame, symmetry)?;
            for finding in lattice.check_geometry() {
                notes.push(Note {
                    at: aero.at.clone(),
                    card: "CAERO1".to_owned(),
                    severity: Severity::Warning,
                    text: finding.message,
                });
            }
            Some(part(bulk, lattice, &requests, &points, &nodes, &mut taken)?)
        };
        let strips = if bulk.strip_panels.is_empty() {
            None
        } else {
            let (lattice, strips) = Strips::new(bulk, geometry, &frame)?;
            Some((part(bulk, lattice, &requests, &points, &nodes, &mut taken)?, strips))
        };
        if let Some(unused) = requests.iter().enumerate().find(|(i, _)| !taken.contains(i)) {
            return Err(missing(
                &unused.1.at,
                unused.1.name.clone(),
                "CAERO1 or CAERO4",
                unused.1.panel,
            ));
        }
        for part in lattice.iter().chain(strips.iter().map(|s| &s.0)) {
            let loose = part.transfer.uncovered_boxes();
            if let Some(first) = loose.first() {
                notes.push(Note {
                    at: aero.at.clone(),
                    card: "splines".to_owned(),
                    severity: Severity::Warning,
                    text: format!(
                        "{} boxes (the first is {}) belong to no spline and do not move",
                        loose.len(),
                        part.lattice.boxes()[*first].id
                    ),
                });
            }
        }
        Ok(Self {
            frame,
            semichord: 0.5 * aero.reference_chord,
            density: aero.reference_density,
            lattice,
            strips,
            points,
            symmetry,
        })
    }

    /// The lattice of the CAERO1 panels.
    pub fn lattice(&self) -> Option<&Lattice> {
        self.lattice.as_ref().map(|p| &p.lattice)
    }

    /// Generalized forces at all pairs of Mach number and reduced frequency, in their order.
    ///
    /// # Errors
    /// Mach numbers of one and above, a singular lattice, splines whose points are not in the structure.
    pub fn generalized_forces(&self, modes: &Modes, pairs: &[MachK]) -> Result<Vec<GeneralizedForces>> {
        let shapes = self.spline_motion(modes);
        let n = modes.count();
        let mut found: Vec<GeneralizedForces> = pairs
            .iter()
            .map(|p| GeneralizedForces {
                mach: p.mach,
                k: p.k,
                q: ComplexMatrix::zeros(n, n),
            })
            .collect();
        let motion = |part: &Part| -> Result<BoxMotion> {
            part.transfer.motion(&shapes).map_err(|e| SolveError::Missing {
                what: format!("has splines that do not fit: {e}"),
            })
        };
        if let Some(part) = &self.lattice {
            let aerodynamics = Aerodynamics::new(part.lattice.clone(), Kernel::NASTRAN, self.semichord)?;
            let motion = motion(part)?;
            // All reduced frequencies of a Mach number at once, since they share most of the work.
            let mut machs: Vec<f64> = Vec::new();
            for pair in pairs {
                if !machs.contains(&pair.mach) {
                    machs.push(pair.mach);
                }
            }
            for mach in machs {
                let places: Vec<usize> = (0..pairs.len()).filter(|i| pairs[*i].mach == mach).collect();
                let ks: Vec<f64> = places.iter().map(|i| pairs[*i].k).collect();
                for (place, pressures) in places.iter().zip(aerodynamics.pressures(mach, &ks, &motion)?) {
                    found[*place].q = generalized_force(&aerodynamics, &motion, &pressures)?;
                }
            }
        }
        if let Some((part, strips)) = &self.strips {
            let motion = motion(part)?;
            for entry in &mut found {
                strips.add_forces(&part.lattice, &motion, entry, self.semichord)?;
            }
        }
        Ok(found)
    }

    /// Mode shapes at the splines' points in aerodynamic axes, [mode][point * 6 + freedom].
    fn spline_motion(&self, modes: &Modes) -> Vec<Vec<f64>> {
        let places: BTreeMap<u32, usize> = modes.nodes.iter().enumerate().map(|(i, n)| (n.id, i)).collect();
        let turn = self.frame.axes.transpose();
        (0..modes.count())
            .map(|mode| {
                let mut shape = Vec::with_capacity(6 * self.points.len());
                for point in &self.points {
                    let (u, r) = match places.get(point) {
                        Some(node) => modes.motion(mode, *node),
                        None => (Vector3::zeros(), Vector3::zeros()),
                    };
                    shape.extend((turn * u).iter().chain((turn * r).iter()));
                }
                shape
            })
            .collect()
    }
}

/// A basic position in aerodynamic coordinates.
pub(crate) fn local(frame: &Frame, position: Vector3<f64>) -> [f64; 3] {
    (frame.axes.transpose() * (position - frame.origin)).into()
}

/// Symmetry from AERO, unless the case control section says otherwise.
fn symmetry(flag: i64, subcase: &Subcase, name: &str) -> Result<PlaneSymmetry> {
    if let Some(setting) = subcase.settings.get(name) {
        let word = setting.value.trim().to_uppercase();
        return match word.get(..2) {
            Some("SY") => Ok(PlaneSymmetry::Symmetric),
            Some("AN") => Ok(PlaneSymmetry::Antisymmetric),
            Some("AS") => Ok(PlaneSymmetry::None),
            _ => Err(misfit(
                &setting.at,
                name,
                "needed SYMMETRIC, ANTISYMMETRIC or ASYMMETRIC",
            )),
        };
    }
    Ok(match flag {
        1 => PlaneSymmetry::Symmetric,
        -1 => PlaneSymmetry::Antisymmetric,
        _ => PlaneSymmetry::None,
    })
}

/// Dividing stations of a panel's edge.
pub(crate) fn divisions(bulk: &Bulk, division: Division, at: &Location, card: &str) -> Result<Divisions> {
    match division {
        Division::Equal(n) => Ok(Divisions::Equal(n as usize)),
        Division::List(id) => match bulk.real_lists.get(&id) {
            Some(list) => Ok(Divisions::Fractions(list.values.clone())),
            None => Err(missing(at, card.to_owned(), "AEFACT", id)),
        },
    }
}

/// Leading edges of a panel in aerodynamic coordinates.
pub(crate) fn edges(
    geometry: &Geometry,
    frame: &Frame,
    coordinate: u32,
    points: [[f64; 3]; 2],
    at: &Location,
    card: &str,
) -> Result<[[f64; 3]; 2]> {
    let system = geometry
        .frame(coordinate)
        .ok_or_else(|| missing(at, card.to_owned(), "coordinate system", coordinate))?;
    Ok(points.map(|p| local(frame, system.position(p))))
}

fn panels(bulk: &Bulk, geometry: &Geometry, frame: &Frame, symmetry: [PlaneSymmetry; 2]) -> Result<Lattice> {
    let mut surfaces = Vec::new();
    for panel in bulk.panels.values() {
        let card = format!("CAERO1 {}", panel.id);
        let property = bulk
            .panel_properties
            .get(&panel.property)
            .ok_or_else(|| missing(&panel.at, card.clone(), "PAERO1", panel.property))?;
        if let Some(body) = property.bodies.first() {
            return Err(misfit(
                &property.at,
                format!("PAERO1 {}", property.id),
                format!("names body {body}; slender bodies are not computed: clear the fields behind its number"),
            ));
        }
        let [point_1, point_4] = edges(
            geometry,
            frame,
            panel.coordinate,
            [panel.point_1, panel.point_4],
            &panel.at,
            &card,
        )?;
        let surface = Surface {
            name: card.clone(),
            first_box_id: panel.id,
            leading_edge_1: point_1,
            chord_1: panel.chord_12,
            leading_edge_2: point_4,
            chord_2: panel.chord_43,
            chordwise: divisions(bulk, panel.chordwise, &panel.at, &card)?,
            spanwise: divisions(bulk, panel.spanwise, &panel.at, &card)?,
            interference_group: panel.group,
        };
        let per_strip = surface.chordwise.count().checked_mul(surface.spanwise.count());
        if per_strip.is_none_or(|n| n > 100_000) {
            return Err(misfit(&panel.at, card, "has more than 100000 boxes"));
        }
        surfaces.push(surface);
    }
    Ok(Lattice::new(surfaces, symmetry[0])?.with_symmetry_z(symmetry[1]))
}

/// Boxes of all panels are numbered from the panel's number on; the numbers of two panels may not overlap.
fn check_box_numbers(bulk: &Bulk) -> Result<()> {
    let mut last: Option<(u64, String)> = None;
    for panel in bulk.panels.values() {
        let card = format!("CAERO1 {}", panel.id);
        let count = |d| divisions(bulk, d, &panel.at, &card).map(|d| d.count() as u64);
        let boxes = count(panel.spanwise)? * count(panel.chordwise)?;
        if let Some((end, other)) = &last
            && u64::from(panel.id) <= *end
        {
            return Err(misfit(
                &panel.at,
                card,
                format!("its boxes begin inside those of {other}, which end at {end}; renumber it"),
            ));
        }
        last = Some((u64::from(panel.id) + boxes.max(1) - 1, card));
    }
    Ok(())
}

/// All splines of the deck in a common form.
fn requests(bulk: &Bulk, geometry: &Geometry, frame: &Frame) -> Result<Vec<Request>> {
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
fn spline_points(bulk: &Bulk, requests: &[Request]) -> Result<Vec<u32>> {
    let mut all = BTreeSet::new();
    for request in requests {
        all.extend(set_points(bulk, request)?);
    }
    Ok(all.into_iter().collect())
}

/// The splines whose panels are in this lattice.
fn part(
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
fn spline_of(
    error: &dip_dlm::spline::SplineError,
    cards: &[(String, Location)],
    requests: &[Request],
) -> (String, Location) {
    use dip_dlm::spline::SplineError as E;
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
fn in_deck_numbers(error: &dip_dlm::spline::SplineError, points: &[u32], lattice: &Lattice) -> String {
    use dip_dlm::spline::SplineError as E;
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
