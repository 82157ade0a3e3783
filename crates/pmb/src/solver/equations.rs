//! The discrete equations on a level: residual and Jacobian of a flow.

use dip_krylov::BlockMatrix;

use crate::boundary::{Boundary, SideFlux, Sides, fill_ghosts, fill_sides};
use crate::error::FlowError;
use crate::field::Field;
use crate::gas::{Diatomic, Perfect, State, VARIABLES};
use crate::jacobian::{add_time, jacobian};
use crate::level::Level;
use crate::residual::residual_then;
use crate::scheme::Scheme;

/// Calls `$body` with `$gas` of a type made for its ratio of specific heats.
macro_rules! with_gas {
    ($gamma:expr, $gas:ident => $body:expr) => {
        if $gamma == 1.4 {
            let $gas = &Diatomic;
            $body
        } else {
            let $gas = &Perfect { gamma: $gamma };
            $body
        }
    };
}
pub(super) use with_gas;

/// The discrete equations on a level with the flow they are evaluated for.
#[derive(Clone, Debug)]
pub struct Equations {
    /// The grid.
    pub level: Level,
    /// The scheme.
    pub scheme: Scheme,
    /// Conditions, in the order of the level's patches.
    pub boundaries: Vec<Boundary>,
    /// The flow. Ghost cells are filled by [`Equations::residual`].
    pub field: Field,
    /// Boundary fluxes of the last residual.
    pub sides: Sides,
}

impl Equations {
    /// Uniform flow on a level.
    ///
    /// # Errors
    /// If there is not one boundary condition for each patch.
    pub fn new(level: Level, scheme: Scheme, boundaries: Vec<Boundary>, state: &State<f64>) -> Result<Self, FlowError> {
        if boundaries.len() != level.patches.len() {
            return Err(FlowError::Grid {
                what: format!(
                    "{} patches, but {} boundary conditions",
                    level.patches.len(),
                    boundaries.len()
                ),
            });
        }
        let field = Field::uniform(&level, state);
        let sides = SideFlux::of(&level);
        Ok(Self {
            level,
            scheme,
            boundaries,
            field,
            sides,
        })
    }

    /// Unknowns of the level.
    #[must_use]
    pub fn len(&self) -> usize {
        self.level.cell_count * VARIABLES
    }

    /// True if the level has no cell.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Fills ghost cells and boundary fluxes, and computes `out = R`, `[cell][variable]`.
    pub fn residual(&mut self, out: &mut [f64]) {
        let scheme = self.scheme;
        self.residual_with(&scheme, out);
    }

    /// The residual of another scheme for the same flow.
    pub fn residual_with(&mut self, scheme: &Scheme, out: &mut [f64]) {
        self.residual_then(scheme, out, &|_, _| ());
    }

    /// The residual of a scheme, and then `finish` for each piece of it: the number of its first cell and its values.
    pub fn residual_then(&mut self, scheme: &Scheme, out: &mut [f64], finish: &(impl Fn(usize, &mut [f64]) + Sync)) {
        with_gas!(scheme.gamma, gas => {
            let (level, boundaries) = (&self.level, &self.boundaries);
            self.field.exchange(level, |b, w| fill_ghosts(level, boundaries, scheme, b, w));
            fill_sides(gas, &self.level, &self.boundaries, scheme, &self.field, &mut self.sides);
            residual_then(gas, &self.level, scheme, &self.field, &self.sides, out, finish);
        });
    }

    /// dR/dW of the first-order scheme, one matrix a block, plus `time[cell] dQ/dW`. Ghost cells must be filled.
    pub fn jacobian(&self, time: &[f64], matrices: &mut [BlockMatrix<f32>]) {
        with_gas!(self.scheme.gamma, gas => {
            jacobian(gas, &self.level, &self.boundaries, &self.sides, &self.field, matrices);
            add_time(gas, &self.level, &self.field, time, matrices);
        });
    }

    /// The first cell that holds a value that is not finite, or a density or pressure that is not positive.
    ///
    /// # Errors
    /// [`FlowError::State`] names it.
    pub fn check(&self) -> Result<(), FlowError> {
        for (block, w) in self.level.blocks.iter().zip(&self.field.blocks) {
            let [ni, nj, nk] = block.layout.cells;
            for k in 0..nk {
                for j in 0..nj {
                    for i in 0..ni {
                        let s = crate::field::state_at(w, block.layout.size, block.layout.at(i, j, k));
                        const NAMES: [&str; VARIABLES] =
                            ["density", "x-velocity", "y-velocity", "z-velocity", "pressure"];
                        for (v, value) in s.into_iter().enumerate() {
                            let positive = matches!(v, 1..=3) || value > 0.0;
                            if !(value.is_finite() && positive) {
                                return Err(FlowError::State {
                                    block: block.name.clone(),
                                    ijk: [i, j, k],
                                    what: NAMES[v],
                                    value,
                                });
                            }
                        }
                    }
                }
            }
        }
        Ok(())
    }
}
