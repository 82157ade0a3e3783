//! Where the wall is at an instant.

use crate::motion::{CoordinateKind, MotionValue};
use crate::setup::Setup;
use crate::step::Step;

impl Setup {
    /// Nodes of the wall, `[patch][node][x, y, z]`, m, for values of the motion coordinates in their order: first the
    /// shapes of modes and control surfaces are added up, then rotations and translations follow in the order of the
    /// coordinates. A rotation is exact, not linearized.
    #[must_use]
    pub fn nodes_at(&self, motion: &[MotionValue]) -> Vec<Vec<[f64; 3]>> {
        let mut patches: Vec<Vec<[f64; 3]>> = self.surface.patches.iter().map(|p| p.nodes_m.clone()).collect();
        for (coordinate, now) in self.motion.iter().zip(motion) {
            for (nodes, shape) in patches.iter_mut().zip(&coordinate.shape_m) {
                for (node, displacement) in nodes.iter_mut().zip(shape) {
                    *node = moved(*node, *displacement, now.value);
                }
            }
        }
        for (coordinate, now) in self.motion.iter().zip(motion) {
            for node in patches.iter_mut().flatten() {
                *node = match coordinate.kind {
                    CoordinateKind::Pitch {
                        axis_point_m,
                        axis_direction,
                    } => rotated(*node, axis_point_m, axis_direction, now.value),
                    CoordinateKind::Plunge { direction } => moved(*node, direction, now.value),
                    CoordinateKind::Mode | CoordinateKind::Control { .. } => *node,
                };
            }
        }
        patches
    }
}

fn moved(point: [f64; 3], direction: [f64; 3], distance: f64) -> [f64; 3] {
    std::array::from_fn(|d| point[d] + distance * direction[d])
}

impl Step {
    /// Nodes of the wall at this step: as the run recorded them, or from the motion.
    #[must_use]
    pub fn nodes_m(&self, setup: &Setup) -> Vec<Vec<[f64; 3]>> {
        self.shape_m.clone().unwrap_or_else(|| setup.nodes_at(&self.motion))
    }
}

/// Rotation about an axis by the right-hand rule; formula of Rodrigues.
fn rotated(point: [f64; 3], axis_point: [f64; 3], axis: [f64; 3], angle_rad: f64) -> [f64; 3] {
    let (sin, cos) = angle_rad.sin_cos();
    let r: [f64; 3] = std::array::from_fn(|d| point[d] - axis_point[d]);
    let along = (0..3).map(|d| r[d] * axis[d]).sum::<f64>();
    let across = [
        axis[1] * r[2] - axis[2] * r[1],
        axis[2] * r[0] - axis[0] * r[2],
        axis[0] * r[1] - axis[1] * r[0],
    ];
    std::array::from_fn(|d| axis_point[d] + cos * r[d] + sin * across[d] + (1.0 - cos) * along * axis[d])
}
