//! From structure to boxes: one matrix for displacements, its transpose for forces.
//!
//! A spline reads scalars of its nodes ([`Input`]: a displacement along a direction, or a rotation about one) and gives
//! displacement along the normal and streamwise slope at any point of its boxes. Because forces go back through the
//! transposed matrix, virtual work is the same on both sides whatever the spline; that rigid motions are reproduced (so that
//! forces and moments are kept) is checked when a [`Transfer`] is built.
//!
//! Structural freedoms are `[node][6]`: translations, then rotations, in the axes of the lattice.

mod beam;
mod dense;
mod error;
mod plate;
mod rigid;

pub use beam::BeamSpline;
pub use error::SplineError;

use crate::gaf::PointRule;
use crate::lattice::{Lattice, LatticeBox};
use crate::motion::BoxMotion;

/// How a spline interpolates.
#[derive(Clone, Debug, PartialEq)]
pub enum SplineKind {
    /// Harder and Desmarais' infinite plate: displacement along the boxes' normal over their plane (Nastran's SPLINE1).
    InfinitePlate {
        /// Attachment flexibility DZ (length squared, added to the kernel r^2 ln r^2 of each node as NASTRAN does): 0
        /// passes through the nodes, more smooths.
        flexibility: f64,
    },
    /// The three displacements as thin-plate fields (r^2 ln r^2) in space: boxes of several planes, nodes off the plane.
    ThinPlate {
        /// As for the infinite plate.
        flexibility: f64,
    },
    /// A beam with bending and torsion (Nastran's SPLINE2).
    Beam(BeamSpline),
    /// The boxes move rigidly with the spline's single node.
    Rigid,
}

/// Boxes, the nodes that move them, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineSpec {
    /// Indices of boxes.
    pub boxes: Vec<usize>,
    /// Indices of nodes.
    pub nodes: Vec<usize>,
    /// Interpolation.
    pub kind: SplineKind,
}

/// A scalar that a spline reads: the product of a node's six freedoms with these weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// Node index.
    pub node: usize,
    /// Weights of its three translations and three rotations.
    pub weights: [f64; 6],
}

/// One fitted spline: gives (h, dh/dx) rows over its inputs at any point.
trait Field {
    /// What it reads.
    fn inputs(&self) -> &[Input];
    /// Rows over the inputs of the displacement along the box's normal and of its streamwise slope.
    fn rows(&self, cell: &LatticeBox, point: [f64; 3], h: &mut [f64], slope: &mut [f64]);
    /// The rotation that the spline cannot follow, if any (unit vector): left out of the rigid check.
    fn free_rotation(&self) -> Option<[f64; 3]> {
        None
    }
}

/// One spline's matrices, [box of the spline][input].
#[derive(Clone, Debug, PartialEq)]
struct Part {
    boxes: Vec<usize>,
    inputs: Vec<Input>,
    slope: Vec<f64>,
    at_control: Vec<f64>,
    at_force: Vec<f64>,
}

/// The splines of a model: structural freedoms `[node][6]` to motion of boxes, and forces on boxes back to the nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Transfer {
    n_boxes: usize,
    n_nodes: usize,
    parts: Vec<Part>,
    rigid_error: f64,
}

impl Transfer {
    /// Builds and checks the splines. `nodes` are positions [node][x, y, z] in the lattice's axes and unit.
    ///
    /// Boxes without a spline do not move ([`Transfer::uncovered_boxes`]).
    ///
    /// # Errors
    /// See [`SplineError`].
    pub fn new(
        lattice: &Lattice,
        nodes: &[[f64; 3]],
        splines: &[SplineSpec],
        rule: PointRule,
    ) -> Result<Self, SplineError> {
        let mut owner = vec![usize::MAX; lattice.n_boxes()];
        let mut parts = Vec::with_capacity(splines.len());
        let mut rigid_error = 0.0_f64;
        for (index, spec) in splines.iter().enumerate() {
            check_indices(index, spec, lattice, nodes)?;
            for &b in &spec.boxes {
                if owner[b] != usize::MAX {
                    return Err(SplineError::Twice {
                        box_index: b,
                        first: owner[b],
                        second: index,
                    });
                }
                owner[b] = index;
            }
            let field = fit(index, spec, lattice, nodes)?;
            let part = tabulate(field.as_ref(), spec, lattice, rule);
            rigid_error = rigid_error.max(rigid::check_rigid(index, field.as_ref(), &part, lattice, nodes, rule)?);
            parts.push(part);
        }
        Ok(Self {
            n_boxes: lattice.n_boxes(),
            n_nodes: nodes.len(),
            parts,
            rigid_error,
        })
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.n_nodes
    }

    /// Largest relative error with which the six rigid motions are reproduced.
    pub fn rigid_error(&self) -> f64 {
        self.rigid_error
    }

    /// Boxes that no spline moves.
    pub fn uncovered_boxes(&self) -> Vec<usize> {
        let mut covered = vec![false; self.n_boxes];
        for b in self.parts.iter().flat_map(|p| &p.boxes) {
            covered[*b] = true;
        }
        (0..self.n_boxes).filter(|b| !covered[*b]).collect()
    }

    /// Motion of the boxes in modes given as [mode][node * 6 + freedom].
    ///
    /// # Errors
    /// A mode of the wrong length.
    pub fn motion<M: AsRef<[f64]>>(&self, modes: &[M]) -> Result<BoxMotion, SplineError> {
        let n = self.n_boxes;
        let mut motion = BoxMotion {
            n_boxes: n,
            n_modes: modes.len(),
            slope: vec![0.0; n * modes.len()],
            at_control: vec![0.0; n * modes.len()],
            at_force: vec![0.0; n * modes.len()],
        };
        for (m, mode) in modes.iter().enumerate() {
            let mode = mode.as_ref();
            if mode.len() != 6 * self.n_nodes {
                return Err(SplineError::Value {
                    spline: 0,
                    reason: format!("mode {m} needs 6 x {} freedoms, got {}", self.n_nodes, mode.len()),
                });
            }
            for part in &self.parts {
                let read: Vec<f64> = part.inputs.iter().map(|input| input.read(mode)).collect();
                let width = read.len();
                for (row, &b) in part.boxes.iter().enumerate() {
                    let dot = |matrix: &[f64]| -> f64 {
                        matrix[row * width..(row + 1) * width]
                            .iter()
                            .zip(&read)
                            .map(|(a, b)| a * b)
                            .sum()
                    };
                    motion.slope[m * n + b] = dot(&part.slope);
                    motion.at_control[m * n + b] = dot(&part.at_control);
                    motion.at_force[m * n + b] = dot(&part.at_force);
                }
            }
        }
        Ok(motion)
    }

    /// Forces and moments on the nodes, [node * 6 + freedom], from forces along the normals at the boxes' force points.
    ///
    /// # Errors
    /// Wrong number of forces.
    pub fn nodal_forces(&self, box_forces: &[f64]) -> Result<Vec<f64>, SplineError> {
        if box_forces.len() != self.n_boxes {
            return Err(SplineError::Value {
                spline: 0,
                reason: format!(
                    "one force per box is needed: {} boxes, got {}",
                    self.n_boxes,
                    box_forces.len()
                ),
            });
        }
        let mut forces = vec![0.0; 6 * self.n_nodes];
        for part in &self.parts {
            let width = part.inputs.len();
            for (row, &b) in part.boxes.iter().enumerate() {
                for (input, g) in part.inputs.iter().zip(&part.at_force[row * width..(row + 1) * width]) {
                    for (f, w) in forces[6 * input.node..6 * input.node + 6].iter_mut().zip(input.weights) {
                        *f += g * w * box_forces[b];
                    }
                }
            }
        }
        Ok(forces)
    }
}

impl Input {
    fn read(&self, freedoms: &[f64]) -> f64 {
        freedoms[6 * self.node..6 * self.node + 6]
            .iter()
            .zip(self.weights)
            .map(|(u, w)| u * w)
            .sum()
    }

    /// Displacement of a node along a direction.
    fn translation(node: usize, along: [f64; 3]) -> Self {
        Self {
            node,
            weights: [along[0], along[1], along[2], 0.0, 0.0, 0.0],
        }
    }

    /// Rotation of a node about a direction.
    fn rotation(node: usize, about: [f64; 3]) -> Self {
        Self {
            node,
            weights: [0.0, 0.0, 0.0, about[0], about[1], about[2]],
        }
    }
}

fn check_indices(spline: usize, spec: &SplineSpec, lattice: &Lattice, nodes: &[[f64; 3]]) -> Result<(), SplineError> {
    let find = |what, list: &[usize], count| {
        list.iter().find(|i| **i >= count).map_or(Ok(()), |&index| {
            Err(SplineError::Index {
                spline,
                what,
                index,
                count,
            })
        })
    };
    find("box", &spec.boxes, lattice.n_boxes())?;
    find("node", &spec.nodes, nodes.len())?;
    if spec.boxes.is_empty() {
        return Err(SplineError::Value {
            spline,
            reason: "it moves no boxes".into(),
        });
    }
    if let Some(n) = spec.nodes.iter().find(|n| nodes[**n].iter().any(|x| !x.is_finite())) {
        return Err(SplineError::Value {
            spline,
            reason: format!("node {n} has a coordinate that is not finite"),
        });
    }
    Ok(())
}

fn fit(spline: usize, spec: &SplineSpec, lattice: &Lattice, nodes: &[[f64; 3]]) -> Result<Box<dyn Field>, SplineError> {
    Ok(match &spec.kind {
        SplineKind::InfinitePlate { flexibility } => Box::new(plate::InfinitePlate::fit(
            spline,
            spec,
            common_plane(spline, spec, lattice)?,
            nodes,
            *flexibility,
        )?),
        SplineKind::ThinPlate { flexibility } => Box::new(plate::ThinPlate::fit(spline, spec, nodes, *flexibility)?),
        SplineKind::Beam(beam) => Box::new(beam::Beam::fit(
            spline,
            spec,
            common_plane(spline, spec, lattice)?,
            nodes,
            beam,
        )?),
        SplineKind::Rigid => Box::new(rigid::Rigid::fit(spline, spec, nodes)?),
    })
}

/// The plane of all boxes of a spline.
#[derive(Clone, Copy, Debug)]
struct Plane {
    normal: [f64; 3],
}

impl Plane {
    /// Unit vector across the stream in the plane: normal cross x.
    fn across(&self) -> [f64; 3] {
        [0.0, self.normal[2], -self.normal[1]]
    }
}

fn common_plane(spline: usize, spec: &SplineSpec, lattice: &Lattice) -> Result<Plane, SplineError> {
    let a = spec.boxes[0];
    let normal = lattice.boxes()[a].normal;
    for &b in &spec.boxes {
        if crate::lattice::distance(lattice.boxes()[b].normal, normal) > 1e-6 {
            return Err(SplineError::Normals { spline, a, b });
        }
    }
    Ok(Plane { normal })
}

fn tabulate(field: &dyn Field, spec: &SplineSpec, lattice: &Lattice, rule: PointRule) -> Part {
    let inputs = field.inputs().to_vec();
    let size = spec.boxes.len() * inputs.len();
    let mut part = Part {
        boxes: spec.boxes.clone(),
        slope: vec![0.0; size],
        at_control: vec![0.0; size],
        at_force: vec![0.0; size],
        inputs,
    };
    let width = part.inputs.len();
    let mut unused = vec![0.0; width];
    for (row, &index) in spec.boxes.iter().enumerate() {
        let cell = &lattice.boxes()[index];
        let at = row * width..(row + 1) * width;
        let (slope, control, force) = (
            &mut part.slope[at.clone()],
            &mut part.at_control[at.clone()],
            &mut part.at_force[at],
        );
        match rule {
            PointRule::ControlPoint => {
                field.rows(cell, cell.control_point, control, slope);
                field.rows(cell, cell.force_point, force, &mut unused);
            }
            PointRule::MidChord => {
                field.rows(cell, cell.mid_chord, control, slope);
                for ((c, f), s) in control.iter_mut().zip(force).zip(slope) {
                    let (mid, turn) = (*c, 0.25 * cell.chord * *s);
                    *c = mid + turn;
                    *f = mid - turn;
                }
            }
        }
    }
    part
}
