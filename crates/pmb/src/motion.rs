//! Prescribed motion: where the nodes of a grid are at a given time.
//!
//! A motion is a list of coordinates (an angle, a distance, a generalized coordinate), each with a shape, what a unit of
//! it does to the grid, and a law, its value as a function of time. Time is in units of grid length over free-stream
//! speed, angles are in radians, distances in the grid's unit.

use dip_grid::vector::{add, cross, dot, scale, sub};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::moving::{BlockNodes, Nodes};

/// A harmonic term `amplitude sin(omega t + phase)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Harmonic {
    /// Amplitude, in the coordinate's unit.
    pub amplitude: f64,
    /// Angular frequency, radians a unit of time.
    pub omega: f64,
    /// Phase at time zero, radians.
    pub phase: f64,
}

/// A coordinate as a function of time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Law {
    /// `mean + sum of terms`, from time zero on.
    Harmonic {
        /// Mean value, which is also the value before time zero.
        mean: f64,
        /// Terms.
        terms: Vec<Harmonic>,
    },
    /// A smooth pulse that is over after `duration`: `mean + amplitude exp(1 - 1/(1 - s^2))`, s from -1 to 1, all of whose
    /// derivatives vanish at both ends.
    Pulse {
        /// Value before and after.
        mean: f64,
        /// Height.
        amplitude: f64,
        /// Duration.
        duration: f64,
    },
    /// From one value to another in `duration`, with continuous first and second derivatives:
    /// `from + (to - from) (10 s^3 - 15 s^4 + 6 s^5)`.
    Ramp {
        /// Value before.
        from: f64,
        /// Value after.
        to: f64,
        /// Duration.
        duration: f64,
    },
}

impl Law {
    /// Value before the motion begins: that of the steady flow it starts from.
    #[must_use]
    pub fn start(&self) -> f64 {
        match self {
            Self::Harmonic { mean, .. } | Self::Pulse { mean, .. } => *mean,
            Self::Ramp { from, .. } => *from,
        }
    }

    /// Value and rate of change at a time.
    #[must_use]
    pub fn at(&self, time: f64) -> [f64; 2] {
        match self {
            Self::Harmonic { mean, terms } => terms.iter().fold([*mean, 0.0], |[value, rate], h| {
                let (sin, cos) = (h.omega * time + h.phase).sin_cos();
                [value + h.amplitude * sin, rate + h.amplitude * h.omega * cos]
            }),
            Self::Pulse {
                mean,
                amplitude,
                duration,
            } => {
                let s = 2.0 * time / duration - 1.0;
                let rest = 1.0 - s * s;
                if rest <= 1e-9 {
                    return [*mean, 0.0];
                }
                let bump = amplitude * (1.0 - 1.0 / rest).exp();
                [mean + bump, -bump * 2.0 * s / (rest * rest) * 2.0 / duration]
            }
            Self::Ramp { from, to, duration } => {
                let s = (time / duration).clamp(0.0, 1.0);
                let part = s * s * s * (10.0 + s * (6.0 * s - 15.0));
                let slope = 30.0 * s * s * (1.0 - s) * (1.0 - s) / duration;
                [from + (to - from) * part, (to - from) * slope]
            }
        }
    }
}

/// What a unit of a coordinate does to the grid.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Rotation in radians about an axis through `point`, right-handed about the unit vector `axis` (nose up about +y with x aft and
    /// z up).
    Rotation {
        /// A point of the axis.
        point: [f64; 3],
        /// Unit vector along the axis.
        axis: [f64; 3],
    },
    /// Translation along `direction`, by its length for a unit.
    Translation {
        /// Displacement for a unit.
        direction: [f64; 3],
    },
    /// Displacement of every node for a unit: a structural mode, a deflected control surface.
    Field(Nodes),
}

/// One coordinate of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinate {
    /// Name, for messages and recordings.
    pub name: String,
    /// What it does.
    pub shape: Shape,
    /// Its value in time.
    pub law: Law,
    /// Blocks it moves; none means all. Ignored by fields, which say so themselves.
    pub blocks: Option<Vec<usize>>,
}

/// Nodes as a function of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Nodes with every coordinate at zero.
    pub rest: Nodes,
    /// Coordinates: fields are added up first, then rotations and translations follow in order.
    pub coordinates: Vec<Coordinate>,
}

impl Motion {
    /// Value and rate of every coordinate.
    #[must_use]
    pub fn state(&self, time: f64) -> Vec<[f64; 2]> {
        self.coordinates.iter().map(|c| c.law.at(time)).collect()
    }

    /// Moves `nodes` to where they are at a time.
    pub fn place(&self, time: f64, nodes: &mut Nodes) {
        let values: Vec<f64> = self.coordinates.iter().map(|c| c.law.at(time)[0]).collect();
        self.place_at(&values, nodes);
    }

    /// Moves `nodes` to where they are before the motion begins.
    pub fn place_start(&self, nodes: &mut Nodes) {
        let values: Vec<f64> = self.coordinates.iter().map(|c| c.law.start()).collect();
        self.place_at(&values, nodes);
    }

    /// Moves `nodes` to where they are with coordinates of the given values.
    pub fn place_at(&self, values: &[f64], nodes: &mut Nodes) {
        for (b, (to, rest)) in nodes.blocks.iter_mut().zip(&self.rest.blocks).enumerate() {
            for (to, rest) in to.iter_mut().zip(rest) {
                to.copy_from_slice(rest);
            }
            for (coordinate, value) in self.coordinates.iter().zip(values) {
                if let Shape::Field(field) = &coordinate.shape {
                    for (to, shape) in to.iter_mut().zip(&field.blocks[b]) {
                        add_scaled(to, *value, shape);
                    }
                }
            }
            for (coordinate, value) in self.coordinates.iter().zip(values) {
                if coordinate.blocks.as_ref().is_none_or(|list| list.contains(&b)) {
                    match &coordinate.shape {
                        Shape::Rotation { point, axis } => rotate(to, *point, *axis, *value),
                        Shape::Translation { direction } => translate(to, scale(*value, *direction)),
                        Shape::Field(_) => {}
                    }
                }
            }
        }
    }
}

/// Entries that one thread works on at a time.
const PIECE: usize = 4096;

/// `to += factor * shape`
fn add_scaled(to: &mut [f64], factor: f64, shape: &[f64]) {
    to.par_chunks_mut(PIECE)
        .zip(shape.par_chunks(PIECE))
        .for_each(|(to, shape)| {
            for (to, s) in to.iter_mut().zip(shape) {
                *to += factor * s;
            }
        });
}

fn translate(nodes: &mut BlockNodes, by: [f64; 3]) {
    for (c, by) in nodes.iter_mut().zip(by) {
        c.iter_mut().for_each(|x| *x += by);
    }
}

/// Rodrigues' rotation: `r cos + (a x r) sin + a (a.r) (1 - cos)`.
fn rotate(nodes: &mut BlockNodes, point: [f64; 3], axis: [f64; 3], angle: f64) {
    // Rows of the rotation matrix, from the images of the unit vectors.
    let (sin, cos) = angle.sin_cos();
    let image = |r: [f64; 3]| {
        add(
            add(scale(cos, r), scale(sin, cross(axis, r))),
            // 1 - cos without cancellation.
            scale(2.0 * (0.5 * angle).sin().powi(2) * dot(axis, r), axis),
        )
    };
    let columns = [image([1.0, 0.0, 0.0]), image([0.0, 1.0, 0.0]), image([0.0, 0.0, 1.0])];
    let [x, y, z] = nodes;
    x.par_chunks_mut(PIECE)
        .zip(y.par_chunks_mut(PIECE))
        .zip(z.par_chunks_mut(PIECE))
        .for_each(|((x, y), z)| {
            for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
                let r = sub([*x, *y, *z], point);
                let turned = [0, 1, 2].map(|d| columns[0][d] * r[0] + columns[1][d] * r[1] + columns[2][d] * r[2]);
                [*x, *y, *z] = add(point, turned);
            }
        });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_the_derivatives_of_values() {
        let laws = [
            Law::Harmonic {
                mean: 0.3,
                terms: vec![
                    Harmonic {
                        amplitude: 0.2,
                        omega: 1.3,
                        phase: 0.4,
                    },
                    Harmonic {
                        amplitude: 0.1,
                        omega: 2.9,
                        phase: -1.0,
                    },
                ],
            },
            Law::Pulse {
                mean: 0.1,
                amplitude: 0.5,
                duration: 3.0,
            },
            Law::Ramp {
                from: 0.2,
                to: -0.4,
                duration: 2.5,
            },
        ];
        for law in laws {
            for n in 0..40 {
                let (t, h) = (0.0913 * f64::from(n), 1e-5);
                let difference = (law.at(t + h)[0] - law.at(t - h)[0]) / (2.0 * h);
                assert!((difference - law.at(t)[1]).abs() < 1e-7, "{law:?} at {t}");
            }
        }
    }

    #[test]
    fn positive_rotation_about_y_is_nose_up() {
        let rest = Nodes {
            blocks: vec![[vec![-1.0], vec![0.0], vec![0.0]]],
        };
        let motion = Motion {
            coordinates: vec![Coordinate {
                name: "pitch".to_owned(),
                shape: Shape::Rotation {
                    point: [0.0; 3],
                    axis: [0.0, 1.0, 0.0],
                },
                law: Law::Ramp {
                    from: 0.0,
                    to: 0.5,
                    duration: 1.0,
                },
                blocks: None,
            }],
            rest: rest.clone(),
        };
        let mut nodes = rest;
        motion.place(1.0, &mut nodes);
        let [x, _, z] = &nodes.blocks[0];
        assert!((x[0] + 0.5_f64.cos()).abs() < 1e-15 && (z[0] - 0.5_f64.sin()).abs() < 1e-15);
    }
}
