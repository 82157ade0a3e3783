//! CAERO1 panels as a lattice, CAERO4 panels as strips, splines, and the generalized forces of a set of modes.
//!
//! Everything is in the axes of the aerodynamic coordinate system (AERO's ACSID), whose x axis is the flow's direction.

use std::collections::{BTreeMap, BTreeSet};

use dip_dlm::{
    ComplexMatrix,
    aic::Aerodynamics,
    gaf::generalized_force,
    kernel::Kernel,
    lattice::{Divisions, Lattice, PlaneSymmetry, Surface},
    motion::BoxMotion,
};
use dip_modal::Modes;
use dip_nastran::{
    Location, Note, Severity,
    bulk::Bulk,
    cards::{aero::Division, control::MachK},
    case_control::Subcase,
};
use nalgebra::Vector3;

use crate::{
    coordinate::{Frame, Geometry},
    error::{Result, SolveError, misfit, missing},
    splines::{Part, part, requests, spline_points},
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
