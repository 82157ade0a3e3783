//! A march of flow and modal structure: the mean position first, then motion in time until somebody knows enough.
//!
//! [`mean::rigid`] solves the steady flow about the grid as it is, which does not depend on density and serves every run at one Mach
//! number; [`mean::deflected`] finds the position in which the structure holds the steady load; [`run`] marches from
//! there. How damping is read from the motion, and which density comes next, is not this crate's affair: an
//! [`MarchObserver`] says when to stop.

mod kept;
pub mod mean;
mod observe;
mod quasi_newton;
mod run;
mod settings;

pub use observe::{MarchObserver, MarchStep, Verdict};
pub use run::{MarchResult, MarchSeconds, MarchStop, run};
pub use settings::MarchSettings;

use dip_grid::MultiBlock;
use dip_modal::{GridModes, ModalEquations};

use crate::couple::Coupled;
use crate::error::FlowError;
use crate::moving::Nodes;

/// A structure that rides on a grid.
#[derive(Clone, Debug)]
pub struct Wing {
    /// Modal equations.
    pub equations: ModalEquations,
    /// Displacement of every node for a unit of each generalized coordinate, in the grid's unit, `[mode]`.
    pub shapes: Vec<Nodes>,
    /// Largest displacement of the wall for a unit of each generalized coordinate, in the grid's unit, `[mode]`.
    pub largest: Vec<f64>,
}

impl Wing {
    /// The structure of `equations` whose modes move the grid by `modes`.
    ///
    /// # Errors
    /// [`FlowError::Setting`] if the numbers of modes differ.
    pub fn new(equations: ModalEquations, modes: &GridModes, grid: &MultiBlock) -> Result<Self, FlowError> {
        if modes.count() != equations.count() {
            return Err(FlowError::Setting {
                key: "structure.modes",
                got: format!("{} equations, {} displacement fields", equations.count(), modes.count()),
                needed: "one displacement field for each equation is needed",
            });
        }
        let shapes = (0..modes.count())
            .map(|m| Nodes {
                blocks: (0..grid.blocks.len()).map(|b| modes.field(m, b).clone()).collect(),
            })
            .collect();
        let largest = (0..modes.count())
            .map(|m| {
                modes
                    .wall_shape(m)
                    .iter()
                    .map(nalgebra::Vector3::norm)
                    .fold(0.0, f64::max)
            })
            .collect();
        Ok(Self {
            equations,
            shapes,
            largest,
        })
    }

    /// A bound on the largest displacement of the wall for coordinates `q`, in the grid's unit.
    #[must_use]
    pub fn displacement(&self, q: &[f64]) -> f64 {
        q.iter().zip(&self.largest).map(|(q, l)| (q * l).abs()).sum()
    }

    /// `grid` with its nodes moved by the coordinates `q`.
    #[must_use]
    pub fn placed(&self, grid: &MultiBlock, q: &[f64]) -> MultiBlock {
        let rest = Nodes::of(grid);
        let mut nodes = rest.clone();
        Coupled::deform(&rest, &self.shapes, q, &mut nodes);
        let mut placed = grid.clone();
        nodes.write_to(&mut placed);
        placed
    }
}
