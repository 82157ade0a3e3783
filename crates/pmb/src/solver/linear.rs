//! The linear system of a Newton step as GCG sees it: products with the operator by differences of residuals, the
//! preconditioner, and both with the weights of an unsteady step.

use std::time::Instant;

use dip_krylov::{KrylovError, LevelShape, LinearOperator, Multilevel, Preconditioner, vector};
use rayon::prelude::*;

use super::equations::{Equations, with_gas};
use crate::gas::{Diatomic, Gas, Perfect, State, VARIABLES, conservative_gradient};
use crate::level::Level;

/// `x -> V/dt dQ/dW x + (R(W + e x) - R(W))/e`
pub(super) struct Product<'a> {
    pub(super) equations: &'a mut Equations,
    pub(super) unknowns: &'a [f64],
    pub(super) residual: &'a [f64],
    pub(super) time: &'a [f64],
    pub(super) weight: Option<&'a [f64]>,
    pub(super) size: f64,
    /// Wall-clock seconds of the residuals.
    pub(super) seconds: f64,
}

impl LinearOperator<f32> for Product<'_> {
    fn apply(&mut self, x: &[f32], y: &mut [f64]) -> Result<(), KrylovError> {
        let length = vector::dot(x, x).sqrt();
        if !(length > 0.0 && length.is_finite()) {
            return Err(KrylovError::Breakdown {
                iteration: 0,
                norm_squared: length * length,
            });
        }
        let step = self.size / length;
        let begin = Instant::now();
        self.equations
            .field
            .combine(&self.equations.level, self.unknowns, step, x);
        let inverse = 1.0 / step;
        let scheme = self.equations.scheme;
        let (w, r) = (self.unknowns, self.residual);
        let (time, weight) = (self.time, self.weight);
        self.equations.residual_then(&scheme, y, &|first, y| {
            with_gas!(scheme.gamma, gas => for (n, y) in y.chunks_exact_mut(VARIABLES).enumerate() {
                let cell = first + n;
                let c = cell * VARIABLES..(cell + 1) * VARIABLES;
                let (r, x, w) = (&r[c.clone()], &x[c.clone()], &w[c]);
                let x: State<f64> = [0, 1, 2, 3, 4].map(|v| f64::from(x[v]));
                let state: State<f64> = [w[0], w[1], w[2], w[3], w[4]];
                let change = time_change(gas, &state, &x);
                for v in 0..VARIABLES {
                    y[v] = (y[v] - r[v]) * inverse + time[cell] * change[v];
                }
                if let Some(weight) = weight {
                    y.iter_mut().for_each(|y| *y *= weight[cell]);
                }
            });
        });
        self.seconds += begin.elapsed().as_secs_f64();
        Ok(())
    }
}

/// dQ/dW x
#[inline(always)]
fn time_change(gas: &impl Gas, w: &State<f64>, x: &State<f64>) -> State<f64> {
    let gradient = conservative_gradient(gas, w);
    gradient.map(|row| row.iter().zip(x).map(|(g, x)| g * x).sum())
}

pub(super) struct Precondition<'a> {
    pub(super) preconditioner: &'a mut Multilevel<f32>,
    pub(super) weight: Option<&'a [f64]>,
    pub(super) unweighted: &'a mut Vec<f64>,
}

impl Preconditioner<f32> for Precondition<'_> {
    fn solve(&mut self, r: &[f64], z: &mut [f32]) {
        if let Some(weight) = self.weight {
            const PIECE: usize = 512;
            self.unweighted.resize(r.len(), 0.0);
            self.unweighted
                .par_chunks_mut(PIECE * VARIABLES)
                .zip(r.par_chunks(PIECE * VARIABLES))
                .zip(weight.par_chunks(PIECE))
                .for_each(|((to, r), weight)| {
                    let cells = to.chunks_exact_mut(VARIABLES).zip(r.chunks_exact(VARIABLES));
                    for ((to, r), weight) in cells.zip(weight) {
                        to.iter_mut().zip(r).for_each(|(to, r)| *to = r / weight);
                    }
                });
            self.preconditioner.solve(self.unweighted, z);
        } else {
            self.preconditioner.solve(r, z);
        }
    }
}

/// Sizes and couplings of a level and of all that can be merged from it.
pub(super) fn shapes(level: &Level) -> Vec<LevelShape> {
    let shape = |level: &Level, parents: Vec<u32>| LevelShape {
        cells: level.blocks.iter().map(|b| b.layout.cells).collect(),
        couplings: level.couplings(),
        sweeps: level.sweeps.clone(),
        parents,
    };
    let mut out = Vec::new();
    let mut here = None;
    while let Some((coarse, map)) = here.as_ref().unwrap_or(level).coarser() {
        out.push(shape(here.as_ref().unwrap_or(level), map.parents));
        here = Some(coarse);
    }
    out.push(shape(here.as_ref().unwrap_or(level), Vec::new()));
    out
}
