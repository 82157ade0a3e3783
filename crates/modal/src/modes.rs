//! Normal modes as a table: nodes, shapes, frequencies, generalized masses.

use nalgebra::{Matrix3, Vector3};

use crate::dof::DOFS_PER_NODE;

/// A node of a table of modes.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeNode {
    /// Number.
    pub id: u32,
    /// Position in basic axes.
    pub position: Vector3<f64>,
    /// Displacement frame: columns are its axes in basic axes (see [`crate::Node::frame`]).
    pub frame: Matrix3<f64>,
}

/// Normal modes, lowest frequency first.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    /// Nodes.
    pub nodes: Vec<ModeNode>,
    /// Shapes `[mode][node][six degrees of freedom in the node's frame]`.
    pub shapes: Vec<Vec<[f64; DOFS_PER_NODE]>>,
    /// Circular frequency of each mode, rad/s; zero for rigid body modes.
    pub omega_rad_s: Vec<f64>,
    /// Generalized mass phi^T M phi of each mode.
    pub generalized_mass: Vec<f64>,
    /// Bound on the relative error of each (shifted) eigenvalue; empty for a table that was read.
    pub residual: Vec<f64>,
}

impl Modes {
    /// Number of modes.
    pub fn count(&self) -> usize {
        self.shapes.len()
    }

    /// Natural frequency of `mode`, Hz.
    pub fn freq_hz(&self, mode: usize) -> f64 {
        self.omega_rad_s[mode] / std::f64::consts::TAU
    }

    /// Generalized stiffness of `mode`, generalized mass times omega squared.
    pub fn generalized_stiffness(&self, mode: usize) -> f64 {
        self.generalized_mass[mode] * self.omega_rad_s[mode].powi(2)
    }

    /// Motion of `node` (a place in [`Modes::nodes`]) in `mode` in basic axes: displacement, rotation.
    pub fn motion(&self, mode: usize, node: usize) -> (Vector3<f64>, Vector3<f64>) {
        let s = &self.shapes[mode][node];
        let frame = &self.nodes[node].frame;
        (
            frame * Vector3::new(s[0], s[1], s[2]),
            frame * Vector3::new(s[3], s[4], s[5]),
        )
    }

    /// Displacement along the basic z axis, `[mode][node]`.
    pub fn heave(&self) -> Vec<Vec<f64>> {
        (0..self.count())
            .map(|m| (0..self.nodes.len()).map(|n| self.motion(m, n).0.z).collect())
            .collect()
    }
}
