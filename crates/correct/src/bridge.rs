//! From readings to reference pressures on the boxes, and whether the two belong together at all.

use crate::MismatchError;
use crate::SampleError;
use crate::apply::{RecordedPressures, References};
use crate::reading::{Reading, Source};
use crate::sample::{BoxMap, Rule, Wall, shape};
use dip_dlm::aic::Aerodynamics;
use dip_dlm::c64;
use dip_dlm::gaf::PointRule;
use dip_dlm::motion::{BoxMotion, RigidMotion};
use dip_record::{CoordinateKind, Recording};

/// One reading on the boxes.
#[derive(Clone, Debug)]
pub struct Mapped {
    /// The reading.
    pub reading: Reading,
    /// Its motion: a column of [`References::motion`].
    pub coordinate: usize,
    /// dCp `[box]` per unit of the motion.
    pub dcp: Vec<c64>,
    /// Higher harmonics of dCp `[harmonic - 2][box]`.
    pub higher: Vec<Vec<c64>>,
    /// Mean dCp `[box]`.
    pub mean: Vec<f64>,
    /// Largest difference of lift of a strip before and after mapping, over the largest lift of a strip.
    pub lift_error: f64,
    /// The same for the moment, over the largest lift times the semichord.
    pub moment_error: f64,
    /// Part of the projected wall that lies outside of the boxes.
    pub overhang: f64,
    /// Difference of the mean lifts of both half wings over their size, of a recording of the whole wing.
    pub asymmetry: Option<f64>,
    /// True where it is left out of the references because another reading stands for the same motion and frequency (a smaller
    /// amplitude, for the check of linearity).
    pub repeated: bool,
}

/// Checks that a recording and a lattice are of the same thing.
///
/// # Errors
/// Mach number, semichord, extents of wall and planform, or side that differ; shows both values.
pub fn check_match(
    recording: &Recording,
    label: &str,
    aerodynamics: &Aerodynamics,
    mach: f64,
) -> Result<(), MismatchError> {
    let refs = &recording.setup.references;
    let wrong = |what: &str, recorded: String, lattice: String, hint: String| {
        Err(MismatchError {
            label: label.to_owned(),
            what: what.to_owned(),
            recorded,
            lattice,
            hint,
        })
    };
    if (refs.mach - mach).abs() > 1e-3 {
        return wrong("Mach number", refs.mach.to_string(), mach.to_string(), String::new());
    }
    let (own, b) = (refs.reference_semichord_m, aerodynamics.semichord());
    if (own - b).abs() > 1e-3 * b {
        let ratio = own / b;
        let hint = if (ratio - 0.5).abs() < 0.01 {
            ": half instead of full reference length? b is half of the root chord, not a quarter"
        } else if (ratio - 2.0).abs() < 0.02 {
            ": full instead of half reference length? b is half of the root chord, not all of it"
        } else {
            ": give both the same root semichord"
        };
        return wrong("reference semichord b, m,", own.to_string(), b.to_string(), hint.into());
    }
    let Some([low, high]) = recording.setup.surface.extent_m() else {
        return wrong(
            "number of wall nodes",
            "0".into(),
            "more".into(),
            ": record dip.SurfaceGrid".into(),
        );
    };
    let mut extent = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for corner in aerodynamics.lattice().boxes().iter().flat_map(|b| b.corners) {
        for d in 0..3 {
            extent[0][d] = extent[0][d].min(corner[d]);
            extent[1][d] = extent[1][d].max(corner[d]);
        }
    }
    // Half a lattice says nothing about the other side, half a model neither.
    let half = refs.half_model || aerodynamics.lattice().symmetry_y != dip_dlm::lattice::PlaneSymmetry::None;
    for (d, name) in [(0, "x"), (1, "y")] {
        let size = extent[1][d] - extent[0][d];
        let ends = if d == 1 && half { 1..2 } else { 0..2 };
        for end in ends {
            let (wall, plan) = ([low, high][end][d], extent[end][d]);
            // A rounded tip or a blunt edge is some percent.
            if (wall - plan).abs() > 0.05 * size {
                let which = ["least", "largest"][end];
                let factor = wall / plan;
                let hint = if plan != 0.0 && (factor - 0.0254).abs() < 1e-3 || (factor - 39.37).abs() < 2.0 {
                    ": inches for metres?"
                } else {
                    ": another wing, unit or origin?"
                };
                return wrong(
                    &format!("{which} {name} of the wing, m,"),
                    format!("{wall:.5}"),
                    format!("{plan:.5}"),
                    hint.into(),
                );
            }
        }
    }
    Ok(())
}

/// Checks the axis of a pitch recording against the one that a case asks for (a point, m; y does not matter).
///
/// # Errors
/// Another axis; shows both.
pub fn check_axis(reading: &Reading, axis_point_m: [f64; 3], semichord_m: f64) -> Result<(), MismatchError> {
    let CoordinateKind::Pitch {
        axis_point_m: own,
        axis_direction,
    } = reading.kind
    else {
        return Ok(());
    };
    let far = [0, 2]
        .iter()
        .any(|d: &usize| (own[*d] - axis_point_m[*d]).abs() > 1e-3 * semichord_m);
    let across = axis_direction[1].abs() < 1.0 - 1e-6;
    if far || across {
        return Err(MismatchError {
            label: reading.label.clone(),
            what: "pitch axis (point, m; direction)".into(),
            recorded: format!("{own:?}; {axis_direction:?}"),
            lattice: format!("{axis_point_m:?}; [0.0, 1.0, 0.0]"),
            hint: ": correct the axis in the case, or record anew".into(),
        });
    }
    Ok(())
}

/// How much a recorded shape may differ from the case's mode of that number, root mean square of the displacement over that of
/// the mode, and still be it. The wall's shape and the boxes' come from the structure by different interpolations.
const SAME_SHAPE: f64 = 0.05;

/// What recordings of one Mach number give on the boxes.
#[derive(Clone, Debug)]
pub struct Assembled {
    /// Motions and pressures that corrections go by.
    pub references: References,
    /// The readings.
    pub mapped: Vec<Mapped>,
    /// What to know, in words.
    pub notes: Vec<String>,
}

/// Reference motions and pressures of all readings (with the recordings that they are from) at one Mach number. `modes` are
/// the structure's modes on the boxes. A recording of a mode that has the shape of the case's mode of the same number stands
/// for it; any other shape is a reference motion of its own, taken from the recorded displacements of the wall.
///
/// # Errors
/// A wall that does not cover the boxes, a mode without shape that the case does not have.
pub fn assemble(
    aerodynamics: &Aerodynamics,
    point_rule: PointRule,
    modes: &BoxMotion,
    recordings: &[(&Recording, Vec<Reading>)],
    rule: Rule,
) -> Result<Assembled, BridgeError> {
    let lattice = aerodynamics.lattice();
    let n = lattice.n_boxes();
    let mut references = References {
        motion: BoxMotion::empty(n),
        mode_of: Vec::new(),
        main: 0,
        pressures: Vec::new(),
    };
    let mut kinds: Vec<CoordinateKey> = Vec::new();
    let mut mapped: Vec<Mapped> = Vec::new();
    let mut notes: Vec<String> = Vec::new();
    for (recording, readings) in recordings {
        let half = recording.setup.references.half_model;
        let map = BoxMap::new(&Wall::recorded(&recording.setup.surface, half), lattice, rule)?;
        for reading in readings {
            let shape = recording
                .setup
                .motion
                .iter()
                .find(|c| c.name == reading.name)
                .and_then(|c| shape::box_motion(&recording.setup.surface, &c.shape_m, half, lattice, point_rule));
            let key = CoordinateKey::of(reading, shape, modes)?;
            let coordinate = match kinds.iter().position(|k| k.same(&key)) {
                Some(at) => at,
                None => {
                    notes.extend(key.note(reading, modes));
                    push_motion(&mut references, lattice, point_rule, modes, &key, &reading.label)?;
                    kinds.push(key);
                    kinds.len() - 1
                }
            };
            mapped.push(map_reading(aerodynamics, &map, recording, reading, coordinate));
        }
    }
    // The largest amplitude stands for its motion and frequency; harmonic recordings before pulses.
    let better = |a: &Mapped, b: &Mapped| {
        let rank = |m: &Mapped| u8::from(m.reading.source != Source::Pulse);
        (rank(a), a.reading.amplitude) >= (rank(b), b.reading.amplitude)
    };
    for i in 0..mapped.len() {
        for j in 0..i {
            let same = mapped[i].coordinate == mapped[j].coordinate
                && (mapped[i].reading.k - mapped[j].reading.k).abs() <= 1e-3 * mapped[i].reading.k;
            if same && !mapped[j].repeated && !mapped[i].repeated {
                let worse = if better(&mapped[j], &mapped[i]) { i } else { j };
                mapped[worse].repeated = true;
            }
        }
    }
    for m in mapped.iter().filter(|m| !m.repeated) {
        references.pressures.push(RecordedPressures {
            coordinate: m.coordinate,
            k: m.reading.k,
            dcp: m.dcp.clone(),
        });
    }
    references.main = kinds
        .iter()
        .position(|k| matches!(k, CoordinateKey::Pitch { .. }))
        .unwrap_or(0);
    Ok(Assembled {
        references,
        mapped,
        notes,
    })
}

/// Why readings can't be put on the boxes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BridgeError {
    /// The wall.
    #[error(transparent)]
    Sample(#[from] SampleError),
    /// A motion that the lattice does not know.
    #[error("{label}: {what}")]
    Motion {
        /// Which recording.
        label: String,
        /// What is wrong and what to do.
        what: String,
    },
}

/// What makes two coordinates the same motion.
#[derive(Clone, Debug)]
enum CoordinateKey {
    Pitch {
        point: [f64; 3],
        direction: [f64; 3],
    },
    Plunge {
        direction: [f64; 3],
    },
    /// The case's mode, from 0.
    Mode(usize),
    /// A mode of another structure: number, from 0, and what it does to the boxes.
    Shape(usize, BoxMotion),
    Control {
        point: [f64; 3],
        direction: [f64; 3],
    },
}

/// Root mean square of the difference of two displacements, of one column each, over that of the second.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let apart: f64 = a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum();
    (apart / product(b, b).max(f64::MIN_POSITIVE)).sqrt()
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Displacement of the boxes in the case's mode.
fn displacement(modes: &BoxMotion, mode: usize) -> Option<&[f64]> {
    (mode < modes.n_modes).then(|| &modes.at_control[mode * modes.n_boxes..(mode + 1) * modes.n_boxes])
}

impl CoordinateKey {
    /// `shape` is what the recorded displacements of the wall do to the boxes, where there are any.
    fn of(reading: &Reading, shape: Option<BoxMotion>, modes: &BoxMotion) -> Result<Self, BridgeError> {
        Ok(match reading.kind {
            CoordinateKind::Pitch {
                axis_point_m,
                axis_direction,
            } => Self::Pitch {
                point: axis_point_m,
                direction: axis_direction,
            },
            CoordinateKind::Plunge { direction } => Self::Plunge { direction },
            CoordinateKind::Control {
                axis_point_m,
                axis_direction,
            } => Self::Control {
                point: axis_point_m,
                direction: axis_direction,
            },
            CoordinateKind::Mode => match reading.mode {
                Some(mode) if mode.number > 0 => {
                    let number = mode.number as usize - 1;
                    let own = displacement(modes, number);
                    match shape {
                        Some(shape) if own.is_none_or(|own| difference(&shape.at_control, own) > SAME_SHAPE) => {
                            Self::Shape(number, shape)
                        }
                        _ => Self::Mode(number),
                    }
                }
                _ => {
                    return Err(BridgeError::Motion {
                        label: reading.label.clone(),
                        what: format!("coordinate {} is a mode without its number", reading.name),
                    });
                }
            },
        })
    }

    fn same(&self, other: &Self) -> bool {
        let near = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(x, y)| (x - y).abs() <= 1e-9 * (1.0 + x.abs()));
        match (self, other) {
            (Self::Pitch { point, direction }, Self::Pitch { point: p, direction: d })
            | (Self::Control { point, direction }, Self::Control { point: p, direction: d }) => {
                near(point, p) && near(direction, d)
            }
            (Self::Plunge { direction }, Self::Plunge { direction: d }) => near(direction, d),
            (Self::Mode(a), Self::Mode(b)) => a == b,
            (Self::Shape(a, shape), Self::Shape(b, other)) => {
                a == b && difference(&other.at_control, &shape.at_control) <= SAME_SHAPE
            }
            _ => false,
        }
    }

    /// That a recording moves in a shape which the case does not have.
    fn note(&self, reading: &Reading, modes: &BoxMotion) -> Option<String> {
        let Self::Shape(number, shape) = self else {
            return None;
        };
        let why = match displacement(modes, *number) {
            Some(own) => {
                // Normalizations differ from one source of modes to the next: what is left beside the best multiple.
                let scale = product(&shape.at_control, own) / product(own, own).max(f64::MIN_POSITIVE);
                let scaled: Vec<f64> = own.iter().map(|h| scale * h).collect();
                format!(
                    "is {scale:.4} times the case's mode {} and {:.1} % of something else",
                    number + 1,
                    100.0 * difference(&scaled, &shape.at_control)
                )
            }
            None => format!(
                "is mode {} of a structure, the case has {} modes",
                number + 1,
                modes.n_modes
            ),
        };
        Some(format!(
            "{}: the recorded shape {why}; it is a reference motion of its own, with the downwash of the recorded wall",
            reading.label
        ))
    }
}

fn push_motion(
    references: &mut References,
    lattice: &dip_dlm::lattice::Lattice,
    rule: PointRule,
    modes: &BoxMotion,
    key: &CoordinateKey,
    label: &str,
) -> Result<(), BridgeError> {
    let n = lattice.n_boxes();
    let mut mode_of = None;
    match key {
        CoordinateKey::Pitch { point, direction } => {
            let turn = RigidMotion {
                rotation: *direction,
                centre: *point,
                ..RigidMotion::default()
            };
            references.motion.push_rigid(lattice, rule, &turn);
        }
        CoordinateKey::Plunge { direction } => {
            let up = RigidMotion {
                translation: *direction,
                ..RigidMotion::default()
            };
            references.motion.push_rigid(lattice, rule, &up);
        }
        CoordinateKey::Mode(mode) => {
            if *mode >= modes.n_modes {
                return Err(BridgeError::Motion {
                    label: label.to_owned(),
                    what: format!("it moves mode {}, the case has {} modes", mode + 1, modes.n_modes),
                });
            }
            let of = |list: &[f64]| list[mode * n..(mode + 1) * n].to_vec();
            references.motion.append(&BoxMotion {
                n_boxes: n,
                n_modes: 1,
                slope: of(&modes.slope),
                at_control: of(&modes.at_control),
                at_force: of(&modes.at_force),
            });
            mode_of = Some(*mode);
        }
        CoordinateKey::Shape(_, shape) => references.motion.append(shape),
        CoordinateKey::Control { .. } => {
            let Some(control) = lattice.controls().first() else {
                return Err(BridgeError::Motion {
                    label: label.to_owned(),
                    what: "it moves a control surface, the case has none: add [[lattice.control_surface]]".into(),
                });
            };
            references.motion.push_control(lattice, rule, control);
        }
    }
    references.mode_of.push(mode_of);
    Ok(())
}

fn map_reading(
    aerodynamics: &Aerodynamics,
    map: &BoxMap,
    recording: &Recording,
    reading: &Reading,
    coordinate: usize,
) -> Mapped {
    let lattice = aerodynamics.lattice();
    let dcp = map.to_boxes(&reading.cp);
    let faces = map.strip_loads_of_faces(&reading.cp);
    let boxes = crate::sample::strip_loads_of_boxes(lattice, &dcp);
    let largest = |list: &[c64]| list.iter().fold(0.0_f64, |m, z| m.max(z.norm()));
    let away = |a: &[c64], b: &[c64]| a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).norm()));
    let lift = largest(&faces.lift_m2).max(f64::MIN_POSITIVE);
    let mean: Vec<c64> = reading.mean.iter().map(|p| c64::new(*p, 0.0)).collect();
    Mapped {
        coordinate,
        higher: reading.higher.iter().map(|h| map.to_boxes(h)).collect(),
        mean: map.to_boxes(&mean).iter().map(|z| z.re).collect(),
        lift_error: away(&faces.lift_m2, &boxes.lift_m2) / lift,
        moment_error: away(&faces.moment_m3, &boxes.moment_m3) / (lift * aerodynamics.semichord()),
        overhang: map.overhang(),
        asymmetry: asymmetry(recording, &reading.cp),
        dcp,
        reading: reading.clone(),
        repeated: false,
    }
}

/// |lift of y > 0 minus lift of y < 0| over the sum of their sizes; none for half a model.
fn asymmetry(recording: &Recording, cp: &[c64]) -> Option<f64> {
    if recording.setup.references.half_model {
        return None;
    }
    let mut lift = [c64::new(0.0, 0.0); 2];
    let faces = recording
        .setup
        .surface
        .patches
        .iter()
        .flat_map(|p| p.centroids_m.iter().zip(&p.areas_m2));
    for ((centroid, area), cp) in faces.zip(cp) {
        lift[usize::from(centroid[1] > 0.0)] -= cp * area[2];
    }
    let size = lift[0].norm() + lift[1].norm();
    (lift[0].norm() > 0.0 && lift[1].norm() > 0.0).then(|| (lift[0] - lift[1]).norm() / size)
}
