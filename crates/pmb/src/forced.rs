//! A run with prescribed motion: from the steady flow at the mean position through cycles of motion until successive ones
//! agree.

mod kept;

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use dip_grid::MultiBlock;
use serde::{Deserialize, Serialize};

use crate::dual_time::{DualTime, DualTimeSettings, StepOutcome};
use crate::error::FlowError;
use crate::loads::{Loads, WallGeometry, WallPatch, integrate};
use crate::motion::Motion;
use crate::moving::Nodes;
use crate::observer::Observer;
use crate::settings::{FarField, SteadySettings};
use crate::steady::{self, StopReason};

/// How long to go on, and how the flow is solved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ForcedSettings {
    /// Flow, reference quantities, scheme, and the steady solution that the run starts from.
    pub steady: SteadySettings,
    /// Real time steps.
    pub time: DualTimeSettings,
    /// Steps in a cycle; 0 where the motion has none (pulse, ramp).
    pub steps_per_cycle: usize,
    /// Steps at most.
    pub steps: usize,
    /// Ends when lift and moment of two successive cycles differ by less than this part of their amplitude (root mean
    /// square); 0 never.
    pub cycle_tolerance: f64,
    /// Restart file; the first one is written with step 0, so that a run can always be gone on with from there.
    pub restart: Option<PathBuf>,
    /// Go on from it, if it is there.
    pub resume: bool,
    /// Steps between restart files; 0 writes one at the end only.
    pub checkpoint_steps: usize,
}

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ForcedStop {
    /// Two successive cycles agree.
    Periodic,
    /// All steps asked for were taken.
    AllSteps,
    /// Somebody asked to stop.
    Interrupted,
}

/// A step as an observer sees it.
#[derive(Clone, Copy, Debug)]
pub struct ForcedStep<'a> {
    /// Number; 0 is the steady flow before the motion begins.
    pub number: usize,
    /// Time, grid length over free-stream speed.
    pub time: f64,
    /// Value and rate of every coordinate at that time.
    pub motion: &'a [[f64; 2]],
    /// Forces and moments, about the reference point at rest in space.
    pub loads: &'a Loads,
    /// Pressure on the walls where they are now.
    pub walls: &'a [WallPatch],
    /// Convergence of the step.
    pub outcome: &'a StepOutcome,
    /// Change from cycle to cycle after the last whole cycle (see [`ForcedSettings::cycle_tolerance`]); not a number before.
    pub cycle_change: f64,
    /// Wall-clock seconds since the unsteady run (or its last resumption) began.
    pub seconds: f64,
    /// Wall-clock seconds left if all steps are taken.
    pub seconds_left: f64,
}

/// Listens to a run with prescribed motion; hears the steady start as an [`Observer`].
pub trait ForcedObserver: Observer {
    /// After every step.
    ///
    /// # Errors
    /// Anything that makes going on useless (a full disk); the run ends and its last restart file stays.
    fn step(&mut self, step: &ForcedStep<'_>) -> Result<(), String>;
    /// The steps before `number + 1` were done by a run that stopped; recordings go on after `number`.
    ///
    /// # Errors
    /// If what was kept of those steps cannot be found.
    fn resumed(&mut self, number: usize) -> Result<(), String>;
}

/// A finished run.
#[derive(Debug)]
pub struct ForcedResult {
    /// Why it ended.
    pub stop: ForcedStop,
    /// Why the steady start ended.
    pub steady_stop: Option<StopReason>,
    /// Steps taken in all.
    pub steps: usize,
    /// Steps that did not converge.
    pub not_converged: usize,
    /// Pseudo steps in all.
    pub iterations: usize,
    /// Products with the operator in all.
    pub products: usize,
    /// Preconditioners built in all.
    pub builds: usize,
    /// Lift, drag and moment coefficient after every step, the steady ones first.
    pub history: Vec<[f64; 3]>,
    /// Change from the last cycle but one to the last.
    pub cycle_change: f64,
    /// Wall-clock seconds of the steady start and of the unsteady part of this run.
    pub seconds: [f64; 2],
}

/// Runs a prescribed motion. `grid` is where every coordinate is zero and must be what [`Motion::rest`] was taken from.
///
/// # Errors
/// Settings, grid, files, an impossible flow, or an observer that cannot go on. Steps that do not converge are counted.
pub fn run(
    settings: &ForcedSettings,
    grid: &MultiBlock,
    motion: &Motion,
    observer: &mut dyn ForcedObserver,
    cancel: &AtomicBool,
) -> Result<ForcedResult, FlowError> {
    check(settings)?;
    let mut placed = grid.clone();
    let mut nodes = Nodes::of(grid);
    motion.place_start(&mut nodes);
    nodes.write_to(&mut placed);

    let begin = Instant::now();
    let kept = kept::read(settings, motion)?;
    let mut steady_stop = None;
    let (solver, walls, limiter_constant) = match &kept {
        Some((kept, _)) => {
            let (solver, walls) = steady::open(&settings.steady, &placed, kept.limiter_constant)?;
            (solver, walls, kept.limiter_constant)
        }
        None => {
            let result = steady::run(&settings.steady, &placed, observer, cancel)?;
            if result.stop == StopReason::Interrupted {
                return Ok(interrupted_before(result.stop, begin.elapsed().as_secs_f64()));
            }
            steady_stop = Some(result.stop.clone());
            let equations = &result.solver.equations;
            let walls = WallGeometry::merged(&placed, &equations.level, &equations.boundaries, &equations.level);
            (result.solver, walls, result.limiter_constant)
        }
    };
    let steady_seconds = begin.elapsed().as_secs_f64();
    let mut run = Run {
        settings,
        motion,
        walls,
        limiter_constant,
        flow: DualTime::new(solver, &placed, settings.time),
        history: Vec::new(),
        not_converged: 0,
        iterations: 0,
        products: 0,
        builds: 0,
        cycle_change: f64::NAN,
        began: Instant::now(),
        first: 0,
        steady_stop,
    };
    match kept {
        Some((kept, values)) => {
            run.flow
                .restore(&kept.state, &values)
                .map_err(|e| kept::named(e, settings))?;
            run.history = kept.history;
            run.steady_stop = kept.steady_stop;
            (run.not_converged, run.iterations) = (kept.not_converged, kept.iterations);
            (run.products, run.builds) = (kept.products, kept.builds);
            run.first = run.flow.step;
            run.cycle_change = run.change();
            observer
                .resumed(run.first)
                .map_err(|what| FlowError::Observer { what })?;
        }
        None => {
            let start = StepOutcome {
                converged: true,
                ..StepOutcome::default()
            };
            run.report(&start, observer)?;
            // From here on a killed run can be gone on with.
            run.write()?;
        }
    }
    let stop = run.march(observer, cancel)?;
    Ok(ForcedResult {
        stop,
        steady_stop: run.steady_stop,
        steps: run.flow.step,
        not_converged: run.not_converged,
        iterations: run.iterations,
        products: run.products,
        builds: run.builds,
        cycle_change: run.cycle_change,
        seconds: [steady_seconds, run.began.elapsed().as_secs_f64()],
        history: run.history,
    })
}

fn interrupted_before(stop: StopReason, seconds: f64) -> ForcedResult {
    ForcedResult {
        stop: ForcedStop::Interrupted,
        steady_stop: Some(stop),
        steps: 0,
        not_converged: 0,
        iterations: 0,
        products: 0,
        builds: 0,
        history: Vec::new(),
        cycle_change: f64::NAN,
        seconds: [seconds, 0.0],
    }
}

fn check(settings: &ForcedSettings) -> Result<(), FlowError> {
    let wrong = |key, got: String, needed| Err(FlowError::Setting { key, got, needed });
    if !(settings.time.dt > 0.0 && settings.time.dt.is_finite()) {
        return wrong(
            "time.dt",
            settings.time.dt.to_string(),
            "a positive time step is needed",
        );
    }
    if !(settings.time.orders > 0.0 && settings.time.orders <= 12.0) {
        return wrong(
            "time.orders",
            settings.time.orders.to_string(),
            "a number above 0 and up to 12 is needed",
        );
    }
    if settings.steps == 0 || settings.time.max_iterations == 0 || settings.time.max_products == 0 {
        return wrong(
            "steps, max_iterations, max_products",
            "0".to_owned(),
            "at least one of each is needed",
        );
    }
    if settings.steady.far_field == FarField::Vortex {
        return wrong(
            "far_field",
            "vortex".to_owned(),
            "an unsteady run needs `free-stream` or `characteristic`: the vortex of a changing lift is not a point vortex",
        );
    }
    Ok(())
}

struct Run<'a> {
    settings: &'a ForcedSettings,
    motion: &'a Motion,
    walls: WallGeometry,
    limiter_constant: f64,
    flow: DualTime,
    history: Vec<[f64; 3]>,
    not_converged: usize,
    iterations: usize,
    products: usize,
    builds: usize,
    cycle_change: f64,
    began: Instant,
    /// Steps that an earlier run took.
    first: usize,
    steady_stop: Option<StopReason>,
}

impl Run<'_> {
    fn march(&mut self, observer: &mut dyn ForcedObserver, cancel: &AtomicBool) -> Result<ForcedStop, FlowError> {
        loop {
            if self.is_periodic() {
                self.write()?;
                return Ok(ForcedStop::Periodic);
            }
            if self.flow.step >= self.settings.steps {
                self.write()?;
                return Ok(ForcedStop::AllSteps);
            }
            if cancel.load(Ordering::Relaxed) {
                self.write()?;
                return Ok(ForcedStop::Interrupted);
            }
            let time = (self.flow.step + 1) as f64 * self.settings.time.dt;
            let outcome = self.flow.advance(|nodes| self.motion.place(time, nodes))?;
            self.iterations += outcome.iterations;
            self.products += outcome.products;
            self.builds += outcome.builds;
            if !outcome.converged {
                self.not_converged += 1;
                observer.message(&format!(
                    "step {}: the residual fell by {:.2} orders, {:.2} were asked for",
                    self.flow.step, outcome.orders, self.settings.time.orders
                ));
            }
            // The last restart file stays if this fails: what the observer kept may not reach this step.
            self.report(&outcome, observer)?;
            let every = self.settings.checkpoint_steps;
            if every > 0 && self.flow.step.is_multiple_of(every) {
                self.write()?;
            }
        }
    }

    fn report(&mut self, outcome: &StepOutcome, observer: &mut dyn ForcedObserver) -> Result<(), FlowError> {
        let s = &self.settings.steady;
        let equations = &self.flow.solver.equations;
        self.walls.follow(&equations.level, &self.flow.grid.now);
        let walls = self.walls.pressures(&equations.level, &equations.sides, &s.flow);
        let loads = integrate(&walls, &s.flow, &s.reference);
        self.history.push([loads.total.cl, loads.total.cd, loads.total.cm]);
        self.cycle_change = self.change();
        let number = self.flow.step;
        let motion = if number == 0 {
            self.motion.coordinates.iter().map(|c| [c.law.start(), 0.0]).collect()
        } else {
            self.motion.state(self.flow.time())
        };
        let seconds = self.began.elapsed().as_secs_f64();
        let left = self.settings.steps.saturating_sub(number) as f64;
        let step = ForcedStep {
            number,
            time: self.flow.time(),
            motion: &motion,
            loads: &loads,
            walls: &walls,
            outcome,
            cycle_change: self.cycle_change,
            seconds,
            seconds_left: left * seconds / (number - self.first).max(1) as f64,
        };
        observer.step(&step).map_err(|what| FlowError::Observer { what })
    }

    /// Root mean square difference of lift and moment between the last two whole cycles, over the root mean square of
    /// their deviation from the mean; the larger of both coefficients.
    fn change(&self) -> f64 {
        let n = self.settings.steps_per_cycle;
        let steps = self.history.len().saturating_sub(1);
        if n == 0 || steps < 2 * n {
            return f64::NAN;
        }
        let end = 1 + steps / n * n;
        [0, 2].into_iter().fold(0.0, |worst: f64, c| {
            let last = self.history[end - n..end].iter().map(|h| h[c]);
            let before = self.history[end - 2 * n..end - n].iter().map(|h| h[c]);
            let mean = last.clone().sum::<f64>() / n as f64;
            let deviation: f64 = last.clone().map(|v| (v - mean).powi(2)).sum();
            let difference: f64 = last.zip(before).map(|(a, b)| (a - b).powi(2)).sum();
            worst.max((difference / deviation.max(f64::MIN_POSITIVE)).sqrt())
        })
    }

    fn is_periodic(&self) -> bool {
        let n = self.settings.steps_per_cycle;
        n > 0 && self.flow.step.is_multiple_of(n) && self.cycle_change < self.settings.cycle_tolerance
    }
}
