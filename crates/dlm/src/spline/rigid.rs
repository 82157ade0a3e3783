//! Rigid bodies: the spline of a box group that moves with one node, and the check that every spline carries rigid motions.

use super::{Field, Input, Part, SplineError, SplineSpec};
use crate::gaf::PointRule;
use crate::lattice::{Lattice, LatticeBox};
use crate::motion::{BoxMotion, RigidMotion};

/// Largest error of a rigid motion, relative to its size over the spline, that is put down to round-off.
const RIGID_TOLERANCE: f64 = 1e-6;

/// Moves the nodes in the six rigid ways and compares the boxes with the exact motion; returns the worst relative error.
pub(super) fn check_rigid(
    spline: usize,
    field: &dyn Field,
    part: &Part,
    lattice: &Lattice,
    nodes: &[[f64; 3]],
    rule: PointRule,
) -> Result<f64, SplineError> {
    const NAMES: [&str; 6] = [
        "translation along x",
        "translation along y",
        "translation along z",
        "rotation about x",
        "rotation about y",
        "rotation about z",
    ];
    let centre = lattice.boxes()[part.boxes[0]].mid_chord;
    let arms = part
        .inputs
        .iter()
        .map(|i| nodes[i.node])
        .chain(part.boxes.iter().map(|&b| lattice.boxes()[b].mid_chord));
    let size = arms.map(|p| crate::lattice::distance(p, centre)).fold(0.0, f64::max);
    let chord = part.boxes.iter().map(|&b| lattice.boxes()[b].chord).fold(0.0, f64::max);
    let size = size.max(chord);
    let mut worst = 0.0_f64;
    for (index, name) in NAMES.iter().enumerate() {
        let mut rigid = RigidMotion {
            centre,
            ..RigidMotion::default()
        };
        let scale = if index < 3 {
            rigid.translation[index] = 1.0;
            1.0
        } else {
            rigid.rotation[index - 3] = 1.0;
            if let Some(free) = field.free_rotation() {
                let along = free[index - 3];
                for (r, f) in rigid.rotation.iter_mut().zip(free) {
                    *r -= along * f;
                }
            }
            size
        };
        let freedoms: Vec<f64> = nodes
            .iter()
            .flat_map(|p| {
                let axis = |a: usize| {
                    let mut n = [0.0; 3];
                    n[a] = 1.0;
                    rigid.on(n, *p).0
                };
                [
                    axis(0),
                    axis(1),
                    axis(2),
                    rigid.rotation[0],
                    rigid.rotation[1],
                    rigid.rotation[2],
                ]
            })
            .collect();
        let read: Vec<f64> = part.inputs.iter().map(|i| i.read(&freedoms)).collect();
        let width = read.len();
        let mut exact = BoxMotion::empty(lattice.n_boxes());
        exact.push_rigid(lattice, rule, &rigid);
        for (row, &b) in part.boxes.iter().enumerate() {
            let dot = |matrix: &[f64]| -> f64 {
                matrix[row * width..(row + 1) * width]
                    .iter()
                    .zip(&read)
                    .map(|(a, b)| a * b)
                    .sum()
            };
            let error = ((dot(&part.slope) - exact.slope[b]).abs() * size)
                .max((dot(&part.at_control) - exact.at_control[b]).abs())
                .max((dot(&part.at_force) - exact.at_force[b]).abs())
                / scale;
            worst = worst.max(error);
            // A NaN is an error too.
            if error.is_nan() || error > RIGID_TOLERANCE {
                return Err(SplineError::Rigid {
                    spline,
                    motion: name,
                    box_index: b,
                    error,
                });
            }
        }
    }
    Ok(worst)
}

/// All boxes on one rigid body that moves with one node.
pub(super) struct Rigid {
    inputs: Vec<Input>,
    centre: [f64; 3],
}

impl Rigid {
    pub(super) fn fit(spline: usize, spec: &SplineSpec, nodes: &[[f64; 3]]) -> Result<Self, SplineError> {
        let [node] = spec.nodes[..] else {
            return Err(SplineError::Value {
                spline,
                reason: format!("a rigid spline needs one node, got {}", spec.nodes.len()),
            });
        };
        let unit = |i: usize| {
            let mut weights = [0.0; 6];
            weights[i] = 1.0;
            Input { node, weights }
        };
        Ok(Self {
            inputs: (0..6).map(unit).collect(),
            centre: nodes[node],
        })
    }
}

impl Field for Rigid {
    fn inputs(&self) -> &[Input] {
        &self.inputs
    }

    fn rows(&self, cell: &LatticeBox, point: [f64; 3], h: &mut [f64], slope: &mut [f64]) {
        for i in 0..6 {
            let mut rigid = RigidMotion {
                centre: self.centre,
                ..RigidMotion::default()
            };
            if i < 3 {
                rigid.translation[i] = 1.0;
            } else {
                rigid.rotation[i - 3] = 1.0;
            }
            (h[i], slope[i]) = rigid.on(cell.normal, point);
        }
    }
}
