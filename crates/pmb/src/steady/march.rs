//! From level to level: when a level is done, when to stop, what to do about a limit cycle.
//!
//! On each level: some explicit steps (coarsest level only), then implicit steps until the residual has fallen far enough.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use dip_grid::MultiBlock;
use dip_krylov::GcgOutcome;

use super::{SteadyResult, StopReason, open_level};
use crate::error::FlowError;
use crate::loads::{WallGeometry, integrate};
use crate::observer::{Observer, Progress};
use crate::restart::Snapshot;
use crate::scheme::Scheme;
use crate::sequence::{Sequence, prolong};
use crate::settings::SteadySettings;
use crate::solver::Solver;
use crate::vortex::FarFieldVortex;

/// A CFL number that nothing reaches.
const NO_CEILING: f64 = 1e30;

/// A run on its way.
pub(super) struct Run<'a> {
    pub(super) settings: &'a SteadySettings,
    pub(super) sequence: Sequence,
    pub(super) walls: WallGeometry,
    pub(super) grid: &'a MultiBlock,
    pub(super) solver: Solver,
    pub(super) vortex: Option<FarFieldVortex>,
    pub(super) level: usize,
    pub(super) step: usize,
    pub(super) level_step: usize,
    pub(super) cfl: f64,
    /// CFL number above which the linear systems were out of reach.
    pub(super) ceiling: f64,
    /// Residual norm of the undisturbed stream on this level.
    pub(super) reference_norm: f64,
    pub(super) norm: f64,
    pub(super) last_norm: f64,
    pub(super) history: Vec<Progress>,
    /// Constant of the limiter: that of the settings, or raised because the shock's cells would not come to rest.
    pub(super) limiter_constant: f64,
    /// Most orders reached on this level, and the steps since.
    pub(super) best: f64,
    pub(super) since_best: usize,
    pub(super) began: Instant,
    /// Steps before the run was resumed: they took no time of this one.
    pub(super) steps_before: usize,
    pub(super) backup: Vec<f64>,
}

impl<'a> Run<'a> {
    pub(super) fn new(
        settings: &'a SteadySettings,
        grid: &'a MultiBlock,
        sequence: Sequence,
        resumed: Option<Snapshot>,
    ) -> Result<Self, FlowError> {
        let level = resumed.as_ref().map_or(sequence.levels.len() - 1, |s| s.level);
        let limiter_constant = resumed
            .as_ref()
            .map_or(settings.limiter_constant, |s| s.limiter_constant);
        let (solver, reference_norm, walls, vortex) = open_level(settings, grid, &sequence, level, limiter_constant)?;
        let mut run = Self {
            limiter_constant,
            ceiling: NO_CEILING,
            best: f64::NEG_INFINITY,
            since_best: 0,
            settings,
            sequence,
            walls,
            grid,
            norm: reference_norm,
            last_norm: reference_norm,
            solver,
            vortex,
            level,
            step: 0,
            level_step: 0,
            cfl: settings.solver.cfl_start,
            reference_norm,
            history: Vec::new(),
            began: Instant::now(),
            steps_before: 0,
            backup: Vec::new(),
        };
        if let Some(s) = resumed {
            run.solver.set(&s.unknowns);
            run.solver.equations.check()?;
            (run.step, run.level_step, run.cfl, run.last_norm) = (s.step, s.level_step, s.cfl, s.last_norm);
            run.ceiling = s.ceiling;
            (run.best, run.since_best) = (s.best.unwrap_or(f64::NEG_INFINITY), s.since_best);
            run.history = s.history;
            run.steps_before = run.step;
            run.update_vortex();
            run.norm = run.solver.norm();
        }
        Ok(run)
    }

    pub(super) fn orders(&self) -> f64 {
        (self.reference_norm / self.norm.max(1e-300)).log10()
    }

    /// Orders that are asked for on this level.
    pub(super) fn goal(&self) -> f64 {
        let s = &self.settings.solver;
        if self.level == 0 { s.orders } else { s.coarse_orders }
    }

    pub(super) fn march(&mut self, observer: &mut dyn Observer, cancel: &AtomicBool) -> Result<StopReason, FlowError> {
        observer.message(&format!(
            "{} cells in {} blocks, levels of {:?} cells, {}",
            self.sequence.levels[0].cell_count,
            self.sequence.levels[0].blocks.len(),
            self.sequence.levels.iter().map(|l| l.cell_count).collect::<Vec<_>>(),
            if self.sequence.levels[0].planar {
                "two-dimensional"
            } else {
                "three-dimensional"
            },
        ));
        if !self.walls.has_wall() {
            observer.message("the grid has no wall: there are no forces, CL and CD are zero");
        }
        if self.reference_norm == 0.0 {
            return Ok(StopReason::RoundOff);
        }
        loop {
            let stop = self.on_level(observer, cancel)?;
            let finished = self.level == 0 || stop == StopReason::Interrupted;
            if finished {
                self.write_restart()?;
                return Ok(stop);
            }
            self.refine()?;
        }
    }

    /// Steps on the current level until it is done.
    fn on_level(&mut self, observer: &mut dyn Observer, cancel: &AtomicBool) -> Result<StopReason, FlowError> {
        let goal = self.goal();
        let most = if self.level == 0 {
            self.settings.solver.max_steps
        } else {
            60
        };
        if self.step == 0 && self.level_step == 0 {
            self.explicit_start();
        }
        loop {
            if self.orders() >= goal {
                return Ok(StopReason::Converged);
            }
            if self.is_round_off() {
                return Ok(StopReason::RoundOff);
            }
            if cancel.load(Ordering::Relaxed) {
                return Ok(StopReason::Interrupted);
            }
            if self.level_step >= most {
                return Ok(StopReason::MaxSteps);
            }
            let Some((outcome, part, cfl)) = self.take_step(observer)? else {
                return Ok(StopReason::Stalled);
            };
            self.report(observer, &outcome, part, cfl, goal);
            if self.is_stalled() {
                if self.level > 0 {
                    // A start for the next level is all that is wanted here.
                    return Ok(StopReason::MaxSteps);
                }
                self.raise_limiter_constant(observer);
            }
            let every = self.settings.checkpoint_steps;
            if every > 0 && self.step.is_multiple_of(every) {
                self.write_restart()?;
            }
        }
    }

    /// True if the best residual is many steps old: a limit cycle of the limiter.
    fn is_stalled(&mut self) -> bool {
        const PATIENCE: usize = 15;
        let orders = self.orders();
        if orders > self.best + 0.05 {
            self.best = orders;
            self.since_best = 0;
        } else {
            self.since_best += 1;
        }
        self.since_best >= PATIENCE
    }

    /// Doubles the limiter's constant, a few times at most: differences below it are then left alone, and the cells
    /// of a shock that switched to and fro come to rest. The flow changes by less than the discretization error; it is
    /// said all the same.
    fn raise_limiter_constant(&mut self, observer: &mut dyn Observer) {
        const MOST: f64 = 8.0;
        (self.best, self.since_best) = (f64::NEG_INFINITY, 0);
        if !self.settings.reconstruction.is_limited() || self.limiter_constant >= MOST * self.settings.limiter_constant
        {
            return;
        }
        self.limiter_constant *= 2.0;
        let s = self.settings;
        let level = &self.solver.equations.level;
        self.solver.equations.scheme = Scheme::new(
            s.flow.gamma,
            s.reconstruction,
            self.limiter_constant,
            level.cell_count,
            level.planar,
            s.flow.mach,
        );
        self.solver.evaluate();
        self.norm = self.solver.norm();
        self.last_norm = self.norm;
        self.cfl = 5.0 * s.solver.cfl_start;
        observer.message(&format!(
            "the residual has not fallen for a while: the limiter switches in cells that should rest; its constant is raised to {}",
            self.limiter_constant
        ));
    }

    /// First-order explicit steps smooth the impulsive start.
    fn explicit_start(&mut self) {
        for _ in 0..self.settings.solver.explicit_steps {
            self.solver.set_time_step(0.5);
            self.solver.explicit_step();
        }
        self.norm = self.solver.norm();
        self.last_norm = self.norm;
    }

    /// The residual is a sum of fluxes and cannot fall below their round-off: it is there when it is within a factor of 20
    /// of one unit of it (some ten operations lie between a cell's values and its flux) and the last step brought
    /// nothing.
    fn is_round_off(&self) -> bool {
        self.norm > 0.5 * self.last_norm && self.norm < 20.0 * self.solver.round_off()
    }

    pub(super) fn update_vortex(&mut self) {
        if let Some(vortex) = &self.vortex {
            let level = &self.solver.equations.level;
            let walls = self
                .walls
                .pressures(level, &self.solver.equations.sides, &self.settings.flow);
            let cl = integrate(&walls, &self.settings.flow, &self.settings.reference)
                .total
                .cl;
            vortex.set(
                &mut self.solver.equations.boundaries,
                &self.settings.flow,
                &self.settings.reference,
                cl,
            );
            self.solver.evaluate();
            self.norm = self.solver.norm();
        }
    }

    fn report(&mut self, observer: &mut dyn Observer, outcome: &GcgOutcome, part: f64, cfl: f64, goal: f64) {
        let equations = &self.solver.equations;
        let walls = self
            .walls
            .pressures(&equations.level, &equations.sides, &self.settings.flow);
        let loads = integrate(&walls, &self.settings.flow, &self.settings.reference).total;
        let orders = self.orders();
        let seconds = self.began.elapsed().as_secs_f64();
        // From the rate of the last steps on the finest level.
        let back = self.history.len().saturating_sub(5);
        let seconds_left = match self.history.get(back) {
            Some(old) if self.level == 0 && old.level == 0 && orders > old.orders && old.step > self.steps_before => {
                (goal - orders).max(0.0) * (seconds - old.seconds) / (orders - old.orders)
            }
            _ => f64::NAN,
        };
        let progress = Progress {
            level: self.level,
            step: self.step,
            cfl,
            orders,
            cl: loads.cl,
            cd: loads.cd,
            cm: loads.cm,
            products: outcome.iterations,
            linear_reduction: outcome.reduction,
            part,
            seconds,
            seconds_left: if seconds_left.is_finite() { seconds_left } else { -1.0 },
        };
        observer.progress(&progress);
        self.history.push(progress);
    }

    /// Carries the flow to the next finer level.
    fn refine(&mut self) -> Result<(), FlowError> {
        let fine = self.level - 1;
        let (mut solver, reference_norm, walls, vortex) = open_level(
            self.settings,
            self.grid,
            &self.sequence,
            fine,
            self.settings.limiter_constant,
        )?;
        self.limiter_constant = self.settings.limiter_constant;
        (self.best, self.since_best) = (f64::NEG_INFINITY, 0);
        self.ceiling = NO_CEILING;
        let start = prolong(
            &self.sequence.maps[fine],
            &self.sequence.levels[fine],
            &self.sequence.levels[self.level],
            &self.solver.equations.field,
        );
        solver.set(&start);
        self.solver = solver;
        self.walls = walls;
        self.vortex = vortex;
        self.level = fine;
        self.level_step = 0;
        self.reference_norm = reference_norm;
        self.update_vortex();
        self.norm = self.solver.norm();
        self.last_norm = self.norm;
        // The flow is nearly there: start well above the first CFL number, not at the coarse level's last.
        self.cfl = 5.0 * self.settings.solver.cfl_start;
        Ok(())
    }

    fn snapshot(&self) -> Snapshot {
        Snapshot {
            settings: self.settings.clone(),
            cells: self.sequence.levels[0].blocks.iter().map(|b| b.layout.cells).collect(),
            level: self.level,
            step: self.step,
            level_step: self.level_step,
            limiter_constant: self.limiter_constant,
            best: self.best.is_finite().then_some(self.best),
            since_best: self.since_best,
            cfl: self.cfl,
            ceiling: self.ceiling,
            last_norm: self.last_norm,
            history: self.history.clone(),
            unknowns: self.solver.unknowns.clone(),
        }
    }

    fn write_restart(&self) -> Result<(), FlowError> {
        match &self.settings.restart {
            Some(path) => self.snapshot().write(path),
            None => Ok(()),
        }
    }

    pub(super) fn finish(self, stop: StopReason) -> Result<SteadyResult, FlowError> {
        self.solver.equations.check()?;
        let snapshot = self.snapshot();
        let orders = self.orders();
        let equations = &self.solver.equations;
        let walls = self
            .walls
            .pressures(&equations.level, &equations.sides, &self.settings.flow);
        let loads = integrate(&walls, &self.settings.flow, &self.settings.reference);
        let cells = equations.level.cell_count as f64;
        let bytes_per_cell = self.solver.bytes() as f64 / cells;
        let planar = equations.level.planar;
        Ok(SteadyResult {
            stop,
            loads,
            walls,
            history: self.history,
            orders,
            limiter_constant: self.limiter_constant,
            solver: self.solver,
            snapshot,
            bytes_per_cell,
            planar,
        })
    }
}
