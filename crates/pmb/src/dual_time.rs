//! Time-accurate steps on a moving grid: backward differences in real time, each step solved by Newton's method.
//!
//! Jameson's dual time (AIAA 91-1596): at every real time step the equations
//! `(a0 Q V|n+1 + a1 Q V|n + a2 Q V|n-1 + a3 Q V|n-2)/dt + R(W|n+1) = 0` are a steady problem in a pseudo time (formulation.md,
//! section 3). The pseudo time step is infinite, which makes a pseudo step a Newton step, unless steps are rejected.
//! What the steady solver has is reused: the product with dR/dW by differences of the scheme itself, GCG, and the
//! preconditioner of the first-order Jacobian, which is kept over pseudo steps and real steps until GCG slows down.

mod kept;
mod old;

use dip_grid::MultiBlock;
use dip_krylov::{GcgSettings, team, vector};
use serde::{Deserialize, Serialize};

use crate::error::FlowError;
use crate::gas::VARIABLES;
use crate::moving::{Backward, MovingGrid, Nodes, Swept};
use crate::secant::Secants;
use crate::solver::{Inertia, Solver};
use old::OldLevels;

/// Backward difference in real time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimeScheme {
    /// First order: `(Q|n+1 - Q|n)/dt`.
    Bdf1,
    /// Second order: `(3 Q|n+1 - 4 Q|n + Q|n-1)/(2 dt)`; the first step is of first order.
    Bdf2,
    /// Second order with half the error of [`TimeScheme::Bdf2`], from four time levels (see
    /// [`Backward::second_optimized`]); the first step is of first order, the second one is BDF2's.
    Bdf2Opt,
}

/// How a real time step is solved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DualTimeSettings {
    /// Backward difference.
    pub scheme: TimeScheme,
    /// Real time step, in units of grid length over free-stream speed.
    pub dt: f64,
    /// Orders of magnitude by which the residual of a step must fall below that of the last time level's flow.
    pub orders: f64,
    /// Pseudo steps in a real step, at most.
    pub max_iterations: usize,
    /// Products with the operator in a pseudo step, at most.
    pub max_products: usize,
    /// Search directions kept by GCG.
    pub directions: usize,
    /// Changes of earlier steps kept for the first guess.
    pub secants: usize,
}

impl Default for DualTimeSettings {
    fn default() -> Self {
        Self {
            scheme: TimeScheme::Bdf2,
            dt: 0.1,
            orders: 2.5,
            max_iterations: 30,
            max_products: 40,
            directions: 40,
            secants: 10,
        }
    }
}

/// How a real step went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepOutcome {
    /// Orders by which the residual fell.
    pub orders: f64,
    /// Pseudo steps.
    pub iterations: usize,
    /// Products with the operator.
    pub products: usize,
    /// Preconditioners built.
    pub builds: usize,
    /// True if the orders asked for, or round-off, were reached.
    pub converged: bool,
}

/// When to build a new preconditioner: GCG's rate (orders a product) after the last one was built, and how many more
/// products than that were needed since.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Wear {
    built: bool,
    rate: f64,
    excess: f64,
}

/// Flow on a moving grid.
#[derive(Debug)]
pub struct DualTime {
    /// Equations, flow and linear solver at the new time level.
    pub solver: Solver,
    /// Nodes and swept volumes.
    pub grid: MovingGrid,
    /// Settings.
    pub settings: DualTimeSettings,
    /// Real steps taken or begun.
    pub step: usize,
    /// Flow at the time levels n, n-1 and n-2 while going to n+1.
    history: [Vec<f64>; 3],
    secants: Secants,
    /// Right-hand side at the beginning of the step.
    start_rhs: Vec<f64>,
    old_levels: OldLevels,
    backward: Backward,
    wear: Wear,
    /// Residual norm that orders are counted from.
    reference: f64,
    norm: f64,
    outcome: StepOutcome,
    backup: Vec<f64>,
    /// What the preconditioner in use was built from.
    built: Option<Built>,
}

/// All that a preconditioner follows from.
#[derive(Clone, Debug)]
struct Built {
    unknowns: Vec<f64>,
    now: Nodes,
    old: Nodes,
    swept_old: Vec<Swept>,
    swept_older: Vec<Swept>,
    backward: Backward,
    damping: f64,
}

impl DualTime {
    /// Goes on from a solver's flow (a steady one, as a rule) on `grid`, whose finest level the solver works on.
    #[must_use]
    pub fn new(mut solver: Solver, grid: &MultiBlock, settings: DualTimeSettings) -> Self {
        let moving = MovingGrid::new(grid, &solver.equations.level);
        let cells = solver.equations.level.cell_count;
        let w = solver.unknowns.clone();
        solver.inertia = Some(Inertia {
            rate: vec![0.0; cells],
            source: vec![0.0; w.len()],
            damping: 0.0,
            weight: vec![1.0; cells],
        });
        solver.set_time_step(1.0);
        Self {
            history: [w.clone(), w.clone(), w],
            secants: Secants::new(settings.secants),
            start_rhs: Vec::new(),
            solver,
            grid: moving,
            settings,
            step: 0,
            old_levels: OldLevels::zeros(cells),
            backward: Backward::first(settings.dt),
            wear: Wear::default(),
            reference: 0.0,
            norm: 0.0,
            outcome: StepOutcome::default(),
            backup: Vec::new(),
            built: None,
        }
    }

    /// Time of the newest level: steps times dt.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.step as f64 * self.settings.dt
    }

    /// A whole real step: `place` moves the nodes to where they are at the new time.
    ///
    /// # Errors
    /// A cell without volume or with an impossible flow. A step that does not converge is not an error: its outcome
    /// says so.
    pub fn advance(&mut self, place: impl FnOnce(&mut Nodes) + Send) -> Result<StepOutcome, FlowError> {
        team::awake(|| {
            self.begin_step();
            self.place(place)?;
            self.guess();
            while !self.is_converged() && self.outcome.iterations < self.settings.max_iterations {
                if !self.iterate()? {
                    break;
                }
            }
            self.finish_step()
        })
    }

    /// Moves on to the next time level: what was new is old.
    pub fn begin_step(&mut self) {
        self.history.rotate_right(1);
        self.history[0].copy_from_slice(&self.solver.unknowns);
        self.grid.begin_step();
        self.step += 1;
        self.backward = match self.settings.scheme {
            TimeScheme::Bdf2Opt if self.step > 2 => Backward::second_optimized(self.settings.dt),
            TimeScheme::Bdf2 | TimeScheme::Bdf2Opt if self.step > 1 => Backward::second(self.settings.dt),
            _ => Backward::first(self.settings.dt),
        };
        self.outcome = StepOutcome::default();
        self.set_old_levels();
    }

    /// Moves the nodes of the new time level and computes metrics, face speeds and what the old levels contribute. May be
    /// called again in a step, when the motion depends on the flow; the residual is then out of date until
    /// [`DualTime::guess`] or [`DualTime::evaluate`].
    ///
    /// # Errors
    /// [`FlowError::Volume`].
    pub fn place(&mut self, place: impl FnOnce(&mut Nodes)) -> Result<(), FlowError> {
        place(&mut self.grid.now);
        self.grid.update(&mut self.solver.equations.level, &self.backward)?;
        self.set_inertia();
        Ok(())
    }

    /// Starts the step from the old flow, changed by what the last steps teach where that brings the residual down.
    pub fn guess(&mut self) {
        self.solver.set_weights();
        self.evaluate();
        self.reference = self.norm;
        self.start_rhs.clear();
        self.start_rhs.extend_from_slice(self.solver.rhs());
        if self.is_converged() {
            return;
        }
        if !self.secants.apply(&self.start_rhs, &mut self.solver.unknowns) {
            return;
        }
        let positive = |w: &[f64]| w[0] > 0.0 && w[4] > 0.0;
        if self.solver.unknowns.chunks_exact(VARIABLES).all(positive) {
            self.evaluate();
        } else {
            self.norm = f64::INFINITY;
        }
        // Not a number counts as no better.
        if self.norm.partial_cmp(&self.reference) != Some(std::cmp::Ordering::Less) {
            self.solver.unknowns.copy_from_slice(&self.history[0]);
            self.evaluate();
        }
    }

    /// Computes the residual of the step, with the time derivative, for the current flow and nodes. Returns its norm.
    pub fn evaluate(&mut self) -> f64 {
        self.solver.evaluate();
        self.norm = self.solver.balance();
        self.norm
    }

    /// Orders by which the residual has fallen in this step.
    #[must_use]
    pub fn orders(&self) -> f64 {
        if self.reference > 0.0 {
            (self.reference / self.norm.max(f64::MIN_POSITIVE)).log10()
        } else {
            0.0
        }
    }

    /// True if the step has converged to the orders asked for, or to the round-off of its fluxes.
    #[must_use]
    pub fn is_converged(&self) -> bool {
        self.norm <= self.goal()
    }

    fn goal(&self) -> f64 {
        /// Fluxes of energy carry 3.5 p and the roundings of six faces: where nothing changes any more (after a pulse, at the
        /// end of a ramp) Newton steps were seen to stall at 13 times the estimate.
        const ROUNDINGS: f64 = 20.0;
        (self.reference * 10.0_f64.powf(-self.settings.orders)).max(ROUNDINGS * self.solver.round_off())
    }

    /// One pseudo step. Returns false if none could be found that brings the residual down.
    ///
    /// Where a shock has to run over several cells in a real step Newton's step overshoots; it is then taken back and redone
    /// with a finite pseudo time step, shorter and shorter until the residual stays below twice its last value. The pseudo time
    /// step grows again with every step that is kept, also one that leaves the residual where it was: while the shock
    /// travels the residual hardly falls, and a pseudo time step that waits for it to fall would never let it arrive.
    ///
    /// # Errors
    /// The linear solver's.
    pub fn iterate(&mut self) -> Result<bool, FlowError> {
        const WEAKEST: f64 = 10.0;
        const FIRST: f64 = 1e-3;
        const UP: f64 = 4.0;
        self.backup.clone_from(&self.solver.unknowns);
        loop {
            let before = self.norm;
            match self.try_iterate() {
                Ok(part) if self.norm.is_finite() && self.norm <= 2.0 * before && part > 0.05 => {
                    self.ease(before);
                    self.outcome.iterations += 1;
                    return Ok(true);
                }
                Ok(_) | Err(FlowError::Linear(_)) => {}
                Err(e) => return Err(e),
            }
            // Taken back and redone with a finite pseudo time step.
            self.solver.unknowns.copy_from_slice(&self.backup);
            self.evaluate();
            self.wear.built = false;
            let Some(inertia) = &mut self.solver.inertia else {
                return Ok(false);
            };
            if inertia.damping >= WEAKEST {
                return Ok(false);
            }
            inertia.damping = (inertia.damping * UP).max(FIRST);
        }
    }

    /// Lengthens the pseudo time step after a pseudo step that was kept.
    fn ease(&mut self, before: f64) {
        let Some(inertia) = self.solver.inertia.as_mut().filter(|i| i.damping > 0.0) else {
            return;
        };
        inertia.damping *= if self.norm < 0.7 * before { 0.25 } else { 0.5 };
        if inertia.damping < 1e-4 {
            inertia.damping = 0.0;
        }
        self.wear.built = false;
    }

    fn try_iterate(&mut self) -> Result<f64, FlowError> {
        /// What a new preconditioner costs, in products.
        const BUILD: f64 = 8.0;
        if !self.wear.built || self.wear.excess > BUILD {
            self.build()?;
        }
        let tolerance = (0.6 * self.goal() / self.norm).clamp(1e-3, 0.3);
        let gcg = GcgSettings {
            tolerance,
            max_iterations: self.settings.max_products,
            patience: 25,
            directions: self.settings.directions,
        };
        let outcome = self.solver.solve(&gcg)?;
        self.outcome.products += outcome.iterations;
        let rate = -outcome.reduction.max(1e-12).log10() / outcome.iterations.max(1) as f64;
        if self.wear.rate == 0.0 {
            self.wear.rate = rate;
        }
        // Products more than a fresh preconditioner would have needed.
        self.wear.excess += outcome.iterations as f64 * (1.0 - rate / self.wear.rate).max(0.0);
        let part = self.solver.admissible(0.5);
        vector::add_scaled(&mut self.solver.unknowns, part, &self.solver.step);
        self.evaluate();
        Ok(part)
    }

    fn build(&mut self) -> Result<(), FlowError> {
        self.solver.build()?;
        let built = Built {
            unknowns: self.solver.unknowns.clone(),
            now: self.grid.now.clone(),
            old: self.grid.old.clone(),
            swept_old: self.grid.swept_old.clone(),
            swept_older: self.grid.swept_older.clone(),
            backward: self.backward,
            damping: self.solver.inertia.as_ref().map_or(0.0, |i| i.damping),
        };
        self.built = Some(built);
        self.outcome.builds += 1;
        self.wear = Wear {
            built: true,
            rate: 0.0,
            excess: 0.0,
        };
        Ok(())
    }

    /// Ends the step: checks the flow and says how it went.
    ///
    /// # Errors
    /// [`FlowError::State`] names the first cell with an impossible value.
    pub fn finish_step(&mut self) -> Result<StepOutcome, FlowError> {
        self.outcome.orders = self.orders();
        self.outcome.converged = self.is_converged();
        self.solver.equations.check()?;
        if self.outcome.iterations > 0 || self.outcome.converged {
            self.secants.learn(
                [&self.history[0], &self.solver.unknowns],
                [&self.start_rhs, self.solver.rhs()],
            );
        }
        Ok(self.outcome)
    }
}
