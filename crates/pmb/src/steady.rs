//! A steady run: from free stream to convergence over a sequence of levels.
//!
//! On each level: some explicit steps (coarsest level only), then implicit steps with a local time step that grows as
//! the residual falls (pseudo-transient continuation: Kelley and Keyes 1998, SIAM J. Numer. Anal. 35; Mulder and van
//! Leer's law), which at large CFL number are Newton's. A step that leaves the physical range or makes the residual
//! explode is taken back and redone with a smaller CFL number.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use dip_grid::MultiBlock;
use dip_krylov::{GcgOutcome, GcgSettings, vector};
use serde::{Deserialize, Serialize};

use crate::error::FlowError;
use crate::level::Level;
use crate::loads::{Loads, WallGeometry, WallPatch, integrate};
use crate::observer::{Observer, Progress};
use crate::reconstruct::Reconstruction;
use crate::restart::Snapshot;
use crate::scheme::Scheme;
use crate::sequence::{Sequence, prolong};
use crate::settings::{FarField, SteadySettings};
use crate::solver::{Equations, Solver};
use crate::vortex::FarFieldVortex;

/// Why a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StopReason {
    /// The residual fell by the orders asked for.
    Converged,
    /// The residual is at the round-off of the fluxes it is the sum of, before the orders asked for.
    RoundOff,
    /// The number of steps allowed is used up; the flow is the last one.
    MaxSteps,
    /// Steps were rejected down to the least CFL number; the flow is the last good one.
    Stalled,
    /// Somebody asked to stop; the flow is the last one and the restart file goes on from it.
    Interrupted,
}

impl StopReason {
    /// True if the flow may be used without looking twice.
    #[must_use]
    pub fn is_converged(&self) -> bool {
        matches!(self, Self::Converged | Self::RoundOff)
    }
}

/// A finished run.
#[derive(Debug)]
pub struct SteadyResult {
    /// Why it ended.
    pub stop: StopReason,
    /// Forces and moments.
    pub loads: Loads,
    /// Pressure on the walls.
    pub walls: Vec<WallPatch>,
    /// Every step.
    pub history: Vec<Progress>,
    /// Orders by which the residual fell.
    pub orders: f64,
    /// The flow, its equations and residual on the finest level.
    pub solver: Solver,
    /// Constant of the limiter at the end: that of the settings unless it was raised.
    pub limiter_constant: f64,
    /// State to go on from.
    pub snapshot: Snapshot,
    /// Bytes of the large arrays a cell.
    pub bytes_per_cell: f64,
    /// True if the grid is two-dimensional.
    pub planar: bool,
}

/// Runs to convergence.
///
/// `cancel` may be set by another thread or a signal handler at any time: the run ends after the current step, having
/// written its restart file.
///
/// # Errors
/// Settings, grid, boundary conditions and files; a run that does not converge is not an error but a
/// [`StopReason`].
pub fn run(
    settings: &SteadySettings,
    grid: &MultiBlock,
    observer: &mut dyn Observer,
    cancel: &AtomicBool,
) -> Result<SteadyResult, FlowError> {
    settings.check()?;
    let finest = Level::new(grid)?;
    settings.boundaries(&finest)?;
    let sequence = Sequence::new(finest, settings.solver.levels);
    let resumed = if settings.resume {
        read_snapshot(settings, &sequence)?
    } else {
        None
    };
    let mut run = Run::new(settings, grid, sequence, resumed)?;
    let stop = run.march(observer, cancel)?;
    run.finish(stop)
}

/// The discrete equations that a run starts from, or goes on from where the settings say so, and their level (0 is the
/// finest): for the checks of [`crate::check`].
///
/// # Errors
/// Settings, grid, boundary conditions, and a restart file that does not fit them.
pub fn equations(settings: &SteadySettings, grid: &MultiBlock) -> Result<(Equations, usize), FlowError> {
    settings.check()?;
    let finest = Level::new(grid)?;
    settings.boundaries(&finest)?;
    let sequence = Sequence::new(finest, settings.solver.levels);
    let resumed = if settings.resume {
        read_snapshot(settings, &sequence)?
    } else {
        None
    };
    let level = resumed.as_ref().map_or(0, |s| s.level);
    let constant = resumed
        .as_ref()
        .map_or(settings.limiter_constant, |s| s.limiter_constant);
    let (mut solver, ..) = open_level(settings, grid, &sequence, level, constant)?;
    if let Some(s) = resumed {
        solver.set(&s.unknowns);
    }
    Ok((solver.equations, level))
}

fn read_snapshot(settings: &SteadySettings, sequence: &Sequence) -> Result<Option<Snapshot>, FlowError> {
    let Some(path) = &settings.restart else { return Ok(None) };
    if !path.exists() {
        return Ok(None);
    }
    let snapshot = Snapshot::read(path)?;
    let wrong = |what: String| {
        Err(FlowError::Restart {
            path: path.display().to_string(),
            what,
        })
    };
    let cells: Vec<_> = sequence.levels[0].blocks.iter().map(|b| b.layout.cells).collect();
    if snapshot.cells != cells {
        return wrong(format!(
            "it is of another grid: blocks of {:?} cells, this grid has {cells:?}",
            snapshot.cells
        ));
    }
    if !snapshot.settings.is_same_flow(settings) {
        return wrong("flow, reference, scheme or boundary settings differ from those of the case".to_owned());
    }
    let level = sequence.levels.get(snapshot.level);
    match level {
        Some(level) if level.cell_count * 5 == snapshot.unknowns.len() => Ok(Some(snapshot)),
        _ => wrong(format!(
            "level {} with {} unknowns does not fit this grid",
            snapshot.level,
            snapshot.unknowns.len()
        )),
    }
}

/// CFL number whose time term the preconditioner keeps while that of the step grows beyond it.
///
/// Without a time term a diagonal block is nearly singular where a wave stands still (the shear and entropy waves in the
/// cells at a wall and a stagnation point), and BILU(0), which drops the fill that would balance it, amplifies
/// errors there from cell to cell. GCG must then take them out again: on the AGARD wing at Mach 0.678 the run needs 721
/// products with the time term of the step itself, 390 to 414 with that of CFL 50 to 500. At 500 the wing at Mach
/// 0.96 without incidence is still held up (1,187 products, 374 with 200).
const PRECONDITIONER_CFL: f64 = 200.0;

/// A CFL number that nothing reaches.
const NO_CEILING: f64 = 1e30;

struct Run<'a> {
    settings: &'a SteadySettings,
    sequence: Sequence,
    walls: WallGeometry,
    grid: &'a MultiBlock,
    solver: Solver,
    vortex: Option<FarFieldVortex>,
    level: usize,
    step: usize,
    level_step: usize,
    cfl: f64,
    /// CFL number above which the linear systems were out of reach.
    ceiling: f64,
    /// Residual norm of the undisturbed stream on this level.
    reference_norm: f64,
    norm: f64,
    last_norm: f64,
    history: Vec<Progress>,
    /// Constant of the limiter: that of the settings, or raised because the shock's cells would not come to rest.
    limiter_constant: f64,
    /// Most orders reached on this level, and the steps since.
    best: f64,
    since_best: usize,
    began: Instant,
    /// Steps before the run was resumed: they took no time of this one.
    steps_before: usize,
    backup: Vec<f64>,
}

impl<'a> Run<'a> {
    fn new(
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

    fn orders(&self) -> f64 {
        (self.reference_norm / self.norm.max(1e-300)).log10()
    }

    fn march(&mut self, observer: &mut dyn Observer, cancel: &AtomicBool) -> Result<StopReason, FlowError> {
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
        let s = &self.settings.solver;
        let (goal, most) = if self.level == 0 {
            (s.orders, s.max_steps)
        } else {
            (s.coarse_orders, 60)
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
        if self.settings.reconstruction != Reconstruction::VanAlbada
            || self.limiter_constant >= MOST * self.settings.limiter_constant
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

    /// One accepted step, or `None` if none could be found. Returns the linear solve, the part taken and its CFL number.
    fn take_step(&mut self, observer: &mut dyn Observer) -> Result<Option<(GcgOutcome, f64, f64)>, FlowError> {
        const LEAST_CFL: f64 = 1e-2;
        self.backup.clear();
        self.backup.extend_from_slice(&self.solver.unknowns);
        loop {
            let cfl = self.cfl;
            let tried = self.try_step(cfl);
            let (why, outcome, part) = match tried {
                Ok((outcome, part)) => {
                    let new = self.solver.norm();
                    // Far from the solution waves travel and the residual may rise; near it a rise is a failure.
                    let allowed = if self.orders() < 1.0 { 4.0 } else { 1.5 };
                    if !(new.is_finite() && new <= allowed * self.norm) {
                        (
                            format!("the residual would grow by a factor of {:.1e}", new / self.norm),
                            outcome,
                            part,
                        )
                    } else if part < 0.05 {
                        (
                            format!("only {part:.1e} of the step keeps density and pressure positive"),
                            outcome,
                            part,
                        )
                    } else {
                        self.accept(new, part, &outcome);
                        return Ok(Some((outcome, part, cfl)));
                    }
                }
                Err(FlowError::Linear(e)) => (
                    e.to_string(),
                    GcgOutcome {
                        iterations: 0,
                        reduction: 1.0,
                        converged: false,
                    },
                    0.0,
                ),
                Err(e) => return Err(e),
            };
            let backup = std::mem::take(&mut self.backup);
            self.solver.set(&backup);
            self.backup = backup;
            self.cfl *= if part > 0.0 { 0.25 } else { 0.1 };
            observer.message(&format!(
                "step {} redone with CFL {:.3e}: {why}",
                self.step + 1,
                self.cfl
            ));
            let _ = outcome;
            if self.cfl < LEAST_CFL {
                return Ok(None);
            }
        }
    }

    fn try_step(&mut self, cfl: f64) -> Result<(GcgOutcome, f64), FlowError> {
        let s = &self.settings.solver;
        // The operator has the time term of the step; the preconditioner keeps that of a moderate CFL number.
        self.solver.set_time_step(cfl.min(PRECONDITIONER_CFL));
        self.solver.build()?;
        self.solver.set_time_step(cfl);
        // Tighter as Newton's method takes hold.
        let tolerance = if cfl < 1e3 {
            0.1
        } else {
            (self.norm / self.last_norm).powi(2).clamp(1e-2, 0.1)
        };
        // On coarser levels memory does not count: all directions are kept.
        let directions = if self.level > 0 { s.max_products } else { s.directions };
        let gcg = GcgSettings {
            tolerance,
            max_iterations: s.max_products,
            patience: 20,
            directions,
        };
        let outcome = self.solver.solve(&gcg)?;
        let part = self.solver.admissible(0.5);
        self.solver.advance(part);
        Ok((outcome, part))
    }

    fn accept(&mut self, new: f64, part: f64, outcome: &GcgOutcome) {
        let ratio = self.norm / new;
        let tried_cfl = self.cfl;
        let growth = self.settings.solver.cfl_growth;
        // A linear system that GCG can hardly reduce is too stiff: a smaller time step makes it easier and costs less.
        const HARD: usize = 30;
        let growth = if self.orders() < 4.0 && outcome.iterations > HARD {
            growth.min(1.5)
        } else {
            growth
        };
        let solvable = if outcome.reduction > 0.5 { 0.25 } else { 1.0 };
        self.cfl *= solvable
            * if part < 1.0 {
                part.max(0.5)
            } else {
                (1.5 * ratio).clamp(0.5, growth)
            };
        // Where one was met lies a ceiling, lifted a little by every step that goes well.
        if outcome.reduction > 0.5 {
            self.ceiling = 0.5 * tried_cfl;
        } else {
            self.ceiling *= 1.5;
        }
        self.cfl = self.cfl.min(self.ceiling).min(1e12);
        self.last_norm = self.norm;
        self.norm = new;
        self.step += 1;
        self.level_step += 1;
        self.update_vortex();
    }

    fn update_vortex(&mut self) {
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

    fn finish(self, stop: StopReason) -> Result<SteadyResult, FlowError> {
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

/// Undisturbed stream on the finest level of a grid, with the wall faces: what an unsteady run that goes on from its own
/// restart file needs of a steady one.
///
/// # Errors
/// Settings, grid and boundary conditions.
pub fn open(
    settings: &SteadySettings,
    grid: &MultiBlock,
    limiter_constant: f64,
) -> Result<(Solver, WallGeometry), FlowError> {
    settings.check()?;
    let sequence = Sequence::new(Level::new(grid)?, 1);
    let (solver, _, walls, _) = open_level(settings, grid, &sequence, 0, limiter_constant)?;
    Ok((solver, walls))
}

type Opened = (Solver, f64, WallGeometry, Option<FarFieldVortex>);

/// Solver, residual norm of the undisturbed stream and wall faces of a level.
fn open_level(
    settings: &SteadySettings,
    grid: &MultiBlock,
    sequence: &Sequence,
    n: usize,
    limiter_constant: f64,
) -> Result<Opened, FlowError> {
    let level = sequence.levels[n].clone();
    let boundaries = settings.boundaries(&level)?;
    // Face centres are needed on the finest level only; the moment of coarser ones is taken about the same faces.
    let walls = WallGeometry::merged(grid, &level, &boundaries, &sequence.levels[0]);
    let vortex = (settings.far_field == FarField::Vortex && level.planar)
        .then(|| FarFieldVortex::new(grid, &level, &sequence.levels[0], &boundaries));
    let scheme = Scheme::new(
        settings.flow.gamma,
        settings.reconstruction,
        limiter_constant,
        level.cell_count,
        level.planar,
        settings.flow.mach,
    );
    let solver = Solver::new(Equations::new(level, scheme, boundaries, &settings.flow.state())?);
    let reference = vector::norm(&solver.residual);
    Ok((solver, reference, walls, vortex))
}
