//! Newton steps on one level: residual, preconditioner and linear solve.
//!
//! A step solves `(V/dt dQ/dW + dR/dW) dW = -R` by GCG (formulation.md, section 3). The product with dR/dW is a
//! difference of residuals of the scheme itself (second order), so a step without the time term is Newton's; the
//! preconditioner is BILU(0) of the analytic first-order Jacobian, in single precision.

mod equations;
mod linear;

use std::time::Instant;

use dip_krylov::{Gcg, GcgOutcome, GcgSettings, Multilevel, vector};
use rayon::prelude::*;

use crate::error::FlowError;
use crate::gas::{Diatomic, Perfect, State, VARIABLES};
use crate::jacobian::spectral_radii;

pub use equations::Equations;
use equations::with_gas;
use linear::{Precondition, Product, shapes};

/// Equations with what a Newton step needs besides.
#[derive(Debug)]
pub struct Solver {
    /// The equations. Its field is that of `unknowns` after every call.
    pub equations: Equations,
    /// Primitive variables of every cell, `[cell][variable]`.
    pub unknowns: Vec<f64>,
    /// Residual of `unknowns`.
    pub residual: Vec<f64>,
    /// The last step's direction.
    pub step: Vec<f64>,
    /// V/dt at CFL one.
    radii: Vec<f64>,
    /// V/dt.
    time: Vec<f64>,
    /// Time derivative of an unsteady flow; none while marching to a steady one.
    pub inertia: Option<Inertia>,
    preconditioner: Option<Multilevel<f32>>,
    gcg: Gcg<f32>,
    rhs: Vec<f64>,
    unweighted: Vec<f64>,
    /// Where its time has gone so far.
    pub seconds: SolverSeconds,
}

/// Wall-clock seconds of a solver's work.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolverSeconds {
    /// Residuals, those in products with the operator included.
    pub residual: f64,
    /// First-order Jacobians.
    pub jacobian: f64,
    /// Their factorizations.
    pub factorization: f64,
    /// GCG without the residuals in its products: preconditioning, orthogonalization, updates.
    pub gcg: f64,
}

/// Backward difference in time of a cell's contents: `rate Q(W) + source`, the rate being a0 V/dt.
#[derive(Clone, Debug, Default)]
pub struct Inertia {
    /// a0 V/dt, `[cell]`.
    pub rate: Vec<f64>,
    /// What earlier time levels contribute, `[cell][variable]`.
    pub source: Vec<f64>,
    /// Part of V/dtau = spectral radius / pseudo CFL number that is added to the diagonal; 0 for Newton steps.
    pub damping: f64,
    /// Weight of every cell's equations in norms and inner products, `[cell]`: one over a0 V/dt + spectral radius, so that a
    /// residual is the change of the flow it would cause. Unweighted, the small cells at a wall would hardly count, and
    /// what a loose tolerance leaves would gather there.
    pub weight: Vec<f64>,
}

impl Solver {
    /// A solver that starts from the equations' field.
    #[must_use]
    pub fn new(mut equations: Equations) -> Self {
        let n = equations.len();
        let mut unknowns = vec![0.0; n];
        equations.field.store(&equations.level, &mut unknowns);
        let mut residual = vec![0.0; n];
        equations.residual(&mut residual);
        let cells = equations.level.cell_count;
        Self {
            equations,
            unknowns,
            residual,
            step: vec![0.0; n],
            radii: vec![0.0; cells],
            time: vec![0.0; cells],
            inertia: None,
            preconditioner: None,
            gcg: Gcg::new(),
            rhs: vec![0.0; n],
            unweighted: Vec::new(),
            seconds: SolverSeconds::default(),
        }
    }

    /// Replaces the flow and evaluates its residual.
    pub fn set(&mut self, unknowns: &[f64]) {
        self.unknowns.copy_from_slice(unknowns);
        self.evaluate();
    }

    /// Recomputes field and residual of `unknowns`.
    pub fn evaluate(&mut self) {
        let begin = Instant::now();
        self.equations.field.load(&self.equations.level, &self.unknowns);
        self.equations.residual(&mut self.residual);
        self.seconds.residual += begin.elapsed().as_secs_f64();
    }

    /// Euclidean norm of the residual.
    #[must_use]
    pub fn norm(&self) -> f64 {
        vector::norm(&self.residual)
    }

    /// Round-off of the residual: unit round-off times the norm of what is summed up, radii times conservative size.
    #[must_use]
    pub fn round_off(&self) -> f64 {
        let weight = |cell: usize| self.inertia.as_ref().map_or(1.0, |i| i.weight[cell]);
        let sum: f64 = self
            .radii
            .iter()
            .zip(self.unknowns.chunks_exact(VARIABLES))
            .enumerate()
            .map(|(cell, (r, w))| {
                let size = weight(cell) * r * (w[0].abs() + w[4].abs());
                size * size
            })
            .sum();
        f64::EPSILON * sum.sqrt()
    }

    /// Local time steps of `cfl` for the current flow.
    pub fn set_time_step(&mut self, cfl: f64) {
        with_gas!(self.equations.scheme.gamma, gas => {
            spectral_radii(gas, &self.equations.level, &self.equations.field, &mut self.radii);
        });
        for (t, r) in self.time.iter_mut().zip(&self.radii) {
            *t = r / cfl;
        }
    }

    /// The diagonal of an unsteady step: `a0 V/dt`, and `damping` of V/dt at CFL one besides.
    fn set_unsteady_time(&mut self) {
        let Some(inertia) = &self.inertia else { return };
        if inertia.damping > 0.0 {
            with_gas!(self.equations.scheme.gamma, gas => {
                spectral_radii(gas, &self.equations.level, &self.equations.field, &mut self.radii);
            });
        }
        for ((t, rate), r) in self.time.iter_mut().zip(&inertia.rate).zip(&self.radii) {
            *t = rate + inertia.damping * r;
        }
    }

    /// Weights of an unsteady step's equations for the current flow, grid and rates.
    pub fn set_weights(&mut self) {
        let Some(inertia) = &mut self.inertia else { return };
        with_gas!(self.equations.scheme.gamma, gas => {
            spectral_radii(gas, &self.equations.level, &self.equations.field, &mut self.radii);
        });
        for ((weight, rate), r) in inertia.weight.iter_mut().zip(&inertia.rate).zip(&self.radii) {
            *weight = 1.0 / (rate + r);
        }
    }

    /// The right-hand side of the next linear system: minus the residual, with the time derivative where there is one.
    /// Returns its norm.
    pub fn balance(&mut self) -> f64 {
        let gamma = self.equations.scheme.gamma;
        match &self.inertia {
            None => {
                for (b, r) in self.rhs.iter_mut().zip(&self.residual) {
                    *b = -r;
                }
            }
            Some(inertia) => {
                const PIECE: usize = VARIABLES * 512;
                self.rhs
                    .par_chunks_mut(PIECE)
                    .zip(self.residual.par_chunks(PIECE))
                    .zip(inertia.source.par_chunks(PIECE))
                    .zip(self.unknowns.par_chunks(PIECE))
                    .zip(inertia.rate.par_chunks(PIECE / VARIABLES))
                    .zip(inertia.weight.par_chunks(PIECE / VARIABLES))
                    .for_each(|(((((b, r), s), w), rate), weight)| {
                        for (n, (rate, weight)) in rate.iter().zip(weight).enumerate() {
                            let c = n * VARIABLES..(n + 1) * VARIABLES;
                            let (b, r, s, w) = (&mut b[c.clone()], &r[c.clone()], &s[c.clone()], &w[c]);
                            let state: State<f64> = [w[0], w[1], w[2], w[3], w[4]];
                            let q = with_gas!(gamma, gas => crate::gas::conservative(gas, &state));
                            for v in 0..VARIABLES {
                                b[v] = -(r[v] + rate * q[v] + s[v]) * weight;
                            }
                        }
                    });
            }
        }
        vector::norm(&self.rhs)
    }

    /// The right-hand side of the last [`Solver::balance`], until the next solve.
    #[must_use]
    pub fn rhs(&self) -> &[f64] {
        &self.rhs
    }

    /// Assembles and factors the preconditioner for the current flow and time step.
    ///
    /// # Errors
    /// If a diagonal block is singular; the next call starts anew.
    pub fn build(&mut self) -> Result<(), FlowError> {
        self.set_unsteady_time();
        let mut preconditioner = match self.preconditioner.take() {
            Some(kept) => kept,
            None => Multilevel::new(shapes(&self.equations.level)),
        };
        let begin = Instant::now();
        self.equations
            .jacobian(&self.time, &mut preconditioner.finest_mut().blocks);
        self.seconds.jacobian += begin.elapsed().as_secs_f64();
        let begin = Instant::now();
        preconditioner.factor()?;
        self.seconds.factorization += begin.elapsed().as_secs_f64();
        self.preconditioner = Some(preconditioner);
        Ok(())
    }

    /// Solves for the step of the current flow, time step and preconditioner.
    ///
    /// # Errors
    /// If the linear solver breaks down, or [`Solver::build`] was not called.
    pub fn solve(&mut self, settings: &GcgSettings) -> Result<GcgOutcome, FlowError> {
        self.balance();
        self.set_unsteady_time();
        // A step of 1e-7 of the flow's own size: differences lose seven digits, the linear tolerance needs two or three.
        let size = 1e-7 * (1.0 + vector::norm(&self.unknowns));
        let mut product = Product {
            equations: &mut self.equations,
            unknowns: &self.unknowns,
            residual: &self.residual,
            time: &self.time,
            weight: self.inertia.as_ref().map(|i| i.weight.as_slice()),
            size,
            seconds: 0.0,
        };
        let Some(preconditioner) = &mut self.preconditioner else {
            return Err(FlowError::NotBuilt);
        };
        let mut precondition = Precondition {
            preconditioner,
            weight: self.inertia.as_ref().map(|i| i.weight.as_slice()),
            unweighted: &mut self.unweighted,
        };
        let begin = Instant::now();
        let outcome = self
            .gcg
            .solve(&mut product, &mut precondition, settings, &mut self.rhs, &mut self.step);
        self.seconds.residual += product.seconds;
        self.seconds.gcg += begin.elapsed().as_secs_f64() - product.seconds;
        // The products left a perturbed flow behind.
        self.equations.field.load(&self.equations.level, &self.unknowns);
        Ok(outcome?)
    }

    /// Largest part of the step that changes no density or pressure by more than `limit` of itself; at most one.
    #[must_use]
    pub fn admissible(&self, limit: f64) -> f64 {
        let worst = self
            .unknowns
            .par_chunks(VARIABLES * 512)
            .zip(self.step.par_chunks(VARIABLES * 512))
            .map(|(w, d)| {
                w.chunks_exact(VARIABLES)
                    .zip(d.chunks_exact(VARIABLES))
                    .fold(0.0_f64, |worst, (w, d)| {
                        let change = (d[0] / w[0]).abs().max((d[4] / w[4]).abs());
                        // NaN must not vanish in a maximum.
                        if change.is_nan() {
                            f64::INFINITY
                        } else {
                            worst.max(change)
                        }
                    })
            })
            .reduce(|| 0.0, f64::max);
        if worst > limit { limit / worst } else { 1.0 }
    }

    /// Moves the flow by `factor` times the step and evaluates the residual.
    pub fn advance(&mut self, factor: f64) {
        vector::add_scaled(&mut self.unknowns, factor, &self.step);
        self.evaluate();
    }

    /// One explicit step of first order in time with the local time step: dW = -(dQ/dW)^-1 dt/V R.
    pub fn explicit_step(&mut self) {
        let gamma = self.equations.scheme.gamma;
        for ((w, r), t) in self
            .unknowns
            .chunks_exact_mut(VARIABLES)
            .zip(self.residual.chunks_exact(VARIABLES))
            .zip(&self.time)
        {
            with_gas!(gamma, gas => {
                let state: State<f64> = [w[0], w[1], w[2], w[3], w[4]];
                let mut q = crate::gas::conservative(gas, &state);
                for (q, r) in q.iter_mut().zip(r) {
                    *q -= r / t;
                }
                w.copy_from_slice(&crate::gas::primitive(gas, &q));
            });
        }
        self.evaluate();
    }

    /// Bytes of the large arrays.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let e = &self.equations;
        let faces = |b: &crate::level::LevelBlock| -> usize {
            b.faces.iter().map(|f| 4 * f.area.len() + f.speed.len()).sum::<usize>() + b.volume.len()
        };
        let doubles = e.field.blocks.iter().map(Vec::len).sum::<usize>()
            + e.level.blocks.iter().map(faces).sum::<usize>()
            + self.unknowns.len()
            + self.residual.len()
            + self.step.len()
            + self.radii.len()
            + self.time.len()
            + self.rhs.len();
        8 * doubles + self.gcg.bytes() + self.preconditioner.as_ref().map_or(0, Multilevel::bytes)
    }
}
