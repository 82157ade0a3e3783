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
    pub(super) perturbed: &'a mut [f64],
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
        self.equations.residual(self.perturbed);
        self.seconds += begin.elapsed().as_secs_f64();
        let inverse = 1.0 / step;
        let gamma = self.equations.scheme.gamma;
        const PIECE: usize = VARIABLES * 512;
        y.par_chunks_mut(PIECE)
            .zip(self.perturbed.par_chunks(PIECE))
            .zip(self.residual.par_chunks(PIECE))
            .zip(x.par_chunks(PIECE))
            .zip(self.unknowns.par_chunks(PIECE))
            .zip(self.time.par_chunks(PIECE / VARIABLES))
            .for_each(|(((((y, p), r), x), w), time)| {
                for (n, t) in time.iter().enumerate() {
                    let c = n * VARIABLES..(n + 1) * VARIABLES;
                    let (y, p, r, x, w) = (&mut y[c.clone()], &p[c.clone()], &r[c.clone()], &x[c.clone()], &w[c]);
                    let x: State<f64> = [0, 1, 2, 3, 4].map(|v| f64::from(x[v]));
                    let state: State<f64> = [w[0], w[1], w[2], w[3], w[4]];
                    let change = with_gas!(gamma, gas => time_change(gas, &state, &x));
                    for v in 0..VARIABLES {
                        y[v] = (p[v] - r[v]) * inverse + t * change[v];
                    }
                }
            });
        if let Some(weight) = self.weight {
            weigh(y, weight, |y, w| y * w);
        }
        Ok(())
    }
}

/// dQ/dW x
#[inline(always)]
fn time_change(gas: &impl Gas, w: &State<f64>, x: &State<f64>) -> State<f64> {
    let gradient = conservative_gradient(gas, w);
    gradient.map(|row| row.iter().zip(x).map(|(g, x)| g * x).sum())
}

/// Changes every equation of a cell by its weight.
fn weigh(values: &mut [f64], weight: &[f64], change: impl Fn(f64, f64) -> f64 + Sync) {
    const PIECE: usize = 512;
    values
        .par_chunks_mut(PIECE * VARIABLES)
        .zip(weight.par_chunks(PIECE))
        .for_each(|(values, weight)| {
            for (cell, weight) in values.chunks_exact_mut(VARIABLES).zip(weight) {
                cell.iter_mut().for_each(|v| *v = change(*v, *weight));
            }
        });
}

pub(super) struct Precondition<'a> {
    pub(super) preconditioner: &'a mut Multilevel<f32>,
    pub(super) weight: Option<&'a [f64]>,
    pub(super) unweighted: &'a mut Vec<f64>,
}

impl Preconditioner<f32> for Precondition<'_> {
    fn solve(&mut self, r: &[f64], z: &mut [f32]) {
        if let Some(weight) = self.weight {
            self.unweighted.clear();
            self.unweighted.extend_from_slice(r);
            weigh(self.unweighted, weight, |r, w| r / w);
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
