//! Newton steps on one level: residual, preconditioner and linear solve.
//!
//! A step solves `(V/dt dQ/dW + dR/dW) dW = -R` by GCG (formulation.md, section 3). The product with dR/dW is a
//! difference of residuals of the scheme itself (second order), so a step without the time term is Newton's; the
//! preconditioner is BILU(0) of the analytic first-order Jacobian, in single precision.

use dip_krylov::{
    BlockMatrix, Gcg, GcgOutcome, GcgSettings, KrylovError, LevelShape, LinearOperator, Multilevel, Preconditioner,
    vector,
};
use rayon::prelude::*;

use crate::boundary::{Boundary, SideFlux, Sides, fill_ghosts, fill_sides};
use crate::error::FlowError;
use crate::field::Field;
use crate::gas::{Diatomic, Gas, Perfect, State, VARIABLES, conservative_gradient};
use crate::jacobian::{add_time, jacobian, spectral_radii};
use crate::level::Level;
use crate::residual::residual;
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
        with_gas!(scheme.gamma, gas => {
            self.field.exchange(&self.level);
            fill_ghosts(&self.level, &self.boundaries, scheme, &mut self.field);
            fill_sides(gas, &self.level, &self.boundaries, scheme, &self.field, &mut self.sides);
            residual(gas, &self.level, scheme, &self.field, &self.sides, out);
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
    perturbed: Vec<f64>,
    unweighted: Vec<f64>,
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
            perturbed: vec![0.0; n],
            unweighted: Vec::new(),
        }
    }

    /// Replaces the flow and evaluates its residual.
    pub fn set(&mut self, unknowns: &[f64]) {
        self.unknowns.copy_from_slice(unknowns);
        self.evaluate();
    }

    /// Recomputes field and residual of `unknowns`.
    pub fn evaluate(&mut self) {
        self.equations.field.load(&self.equations.level, &self.unknowns);
        self.equations.residual(&mut self.residual);
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
        self.equations
            .jacobian(&self.time, &mut preconditioner.finest_mut().blocks);
        preconditioner.factor()?;
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
            perturbed: &mut self.perturbed,
            size,
        };
        let Some(preconditioner) = &mut self.preconditioner else {
            return Err(FlowError::NotBuilt);
        };
        let mut precondition = Precondition {
            preconditioner,
            weight: self.inertia.as_ref().map(|i| i.weight.as_slice()),
            unweighted: &mut self.unweighted,
        };
        let outcome = self
            .gcg
            .solve(&mut product, &mut precondition, settings, &mut self.rhs, &mut self.step);
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
            + self.rhs.len()
            + self.perturbed.len();
        8 * doubles + self.gcg.bytes() + self.preconditioner.as_ref().map_or(0, Multilevel::bytes)
    }
}

/// `x -> V/dt dQ/dW x + (R(W + e x) - R(W))/e`
struct Product<'a> {
    equations: &'a mut Equations,
    unknowns: &'a [f64],
    residual: &'a [f64],
    time: &'a [f64],
    weight: Option<&'a [f64]>,
    perturbed: &'a mut [f64],
    size: f64,
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
        self.equations
            .field
            .combine(&self.equations.level, self.unknowns, step, x);
        self.equations.residual(self.perturbed);
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

struct Precondition<'a> {
    preconditioner: &'a mut Multilevel<f32>,
    weight: Option<&'a [f64]>,
    unweighted: &'a mut Vec<f64>,
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
fn shapes(level: &Level) -> Vec<LevelShape> {
    let shape = |level: &Level, parents: Vec<u32>| LevelShape {
        cells: level.blocks.iter().map(|b| b.layout.cells).collect(),
        couplings: level.couplings(),
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
