//! Which motion a recording has, and what it does to the boxes.

use super::BridgeError;
use crate::apply::References;
use crate::reading::Reading;
use dip_dlm::gaf::PointRule;
use dip_dlm::motion::{BoxMotion, RigidMotion};
use dip_record::CoordinateKind;

/// How much a recorded shape may differ from the case's mode of that number, root mean square of the displacement over that of
/// the mode, and still be it. The wall's shape and the boxes' come from the structure by different interpolations.
const SAME_SHAPE: f64 = 0.05;

/// What makes two coordinates the same motion.
#[derive(Clone, Debug)]
pub(super) enum CoordinateKey {
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
    pub(super) fn of(reading: &Reading, shape: Option<BoxMotion>, modes: &BoxMotion) -> Result<Self, BridgeError> {
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

    pub(super) fn same(&self, other: &Self) -> bool {
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
    pub(super) fn note(&self, reading: &Reading, modes: &BoxMotion) -> Option<String> {
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

/// Adds what the coordinate does to the boxes.
pub(super) fn push_motion(
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
