//! The march itself: steps, reports, restart file.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use dip_grid::MultiBlock;
use dip_modal::{Integrator, ModalState, StepScheme};
use serde::{Deserialize, Serialize};

use super::Wing;
use super::mean::MeanFlow;
use crate::couple::{Coupled, CoupledStep, Coupling, CouplingSeconds, Stream, Structure};
use crate::dual_time::{DualTimeSettings, StepOutcome};
use crate::error::FlowError;
use crate::loads::{Loads, WallPatch};
use crate::moving::Nodes;
use crate::observer::Observer;
use crate::restart::{doubles, put_doubles, read_checked, write_checked};
use crate::settings::SteadySettings;
use crate::steady;

const MAGIC: &[u8; 8] = b"DIPMAR01";

/// How flow and structure are marched.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MarchSettings {
    /// Flow, reference quantities and scheme.
    pub steady: SteadySettings,
    /// Real time steps of the flow; `dt` follows from `step_s` and the stream.
    pub time: DualTimeSettings,
    /// Length of a step, s.
    pub step_s: f64,
    /// Steps at most.
    pub steps: usize,
    /// The structure's step.
    pub scheme: StepScheme,
    /// Exchange within a step.
    pub coupling: Coupling,
    /// Change of the structure's state in the last exchange of a step.
    pub exchange_tolerance: f64,
    /// Rates of the generalized coordinates at the start `[mode]`, 1/s.
    pub start_rate_1_s: Vec<f64>,
    /// Largest displacement of the wall, in reference chords, beyond which the motion has run away.
    pub largest_displacement: f64,
    /// Restart file.
    pub restart: Option<PathBuf>,
    /// Go on from it, if it is there.
    pub resume: bool,
    /// Steps between restart files; 0 writes one at the end only.
    pub checkpoint_steps: usize,
}

/// What an observer wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// More steps.
    GoOn,
    /// Enough is known.
    Enough,
}

/// Why a march ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MarchStop {
    /// The observer knows enough.
    Enough,
    /// All steps asked for were taken.
    AllSteps,
    /// Somebody asked to stop.
    Interrupted,
    /// The motion grew beyond what the settings allow, or beyond what grid and flow bear: the text says which.
    RanAway(String),
}

/// A step as an observer sees it.
#[derive(Clone, Copy, Debug)]
pub struct MarchStep<'a> {
    /// Number; 0 is the start.
    pub number: usize,
    /// Structure at this instant.
    pub state: &'a ModalState,
    /// Its energy, J.
    pub energy_j: f64,
    /// Work of the pressure in this step, J.
    pub work_j: f64,
    /// Change of the structure's state in the last exchange.
    pub exchange: f64,
    /// Convergence of the flow.
    pub outcome: &'a StepOutcome,
    /// Forces and moments, about the reference point at rest in space.
    pub loads: &'a Loads,
    /// Pressure on the walls where they are now.
    pub walls: &'a [WallPatch],
    /// Nodes of the grid where they are now.
    pub nodes: &'a Nodes,
    /// Wall-clock seconds since the march (or its last resumption) began.
    pub seconds: f64,
}

/// Listens to a march.
pub trait MarchObserver: Observer {
    /// After every step.
    ///
    /// # Errors
    /// Anything that makes going on useless (a full disk); the march ends after writing its restart file.
    fn step(&mut self, step: &MarchStep<'_>) -> Result<Verdict, String>;
    /// The steps up to `number` were done by a march that stopped: its states, `[step]`, the start first.
    ///
    /// # Errors
    /// If what was kept of those steps cannot be found.
    fn resumed(&mut self, number: usize, states: &[ModalState]) -> Result<(), String>;
    /// After [`MarchObserver::resumed`]: true if the steps of the march that stopped are enough.
    fn knows(&self) -> bool {
        false
    }
}

/// A finished march.
#[derive(Debug)]
pub struct MarchResult {
    /// Why it ended.
    pub stop: MarchStop,
    /// States `[step]`, the start first.
    pub states: Vec<ModalState>,
    /// Steps whose flow did not converge.
    pub not_converged: usize,
    /// Pseudo steps in all.
    pub iterations: usize,
    /// Products with the flow's operator in all.
    pub products: usize,
    /// Preconditioners built in all.
    pub builds: usize,
    /// Work of the pressure in all, J.
    pub work_j: f64,
    /// Wall-clock seconds of this march (since its last resumption).
    pub seconds: f64,
    /// Those of them that coupling took: grid and structure.
    pub coupling_seconds: CouplingSeconds,
}

/// What the restart file holds besides the flow.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Kept {
    settings: MarchSettings,
    stream: Stream,
    states: Vec<ModalState>,
    not_converged: usize,
    iterations: usize,
    products: usize,
    builds: usize,
    work_j: f64,
    state: serde_json::Value,
}

/// Marches from `mean` until `observer` knows enough. `grid` is where every generalized coordinate is zero.
///
/// # Errors
/// Settings, files, an observer that cannot go on, and a flow that fails before the motion has grown. Steps that do not
/// converge are counted.
pub fn run(
    settings: &MarchSettings,
    grid: &MultiBlock,
    wing: &Wing,
    stream: Stream,
    mean: &MeanFlow,
    observer: &mut dyn MarchObserver,
    cancel: &AtomicBool,
) -> Result<MarchResult, FlowError> {
    check(settings, wing)?;
    let kept = read_kept(settings, &stream, wing)?;
    let mut coupled = start(settings, grid, wing, stream, mean)?;
    coupled.exchange_tolerance = settings.exchange_tolerance;
    let mut march = March {
        settings,
        wing,
        mean,
        result: MarchResult {
            stop: MarchStop::AllSteps,
            states: vec![coupled.structure.integrator.state().clone()],
            not_converged: 0,
            iterations: 0,
            products: 0,
            builds: 0,
            work_j: 0.0,
            seconds: 0.0,
            coupling_seconds: CouplingSeconds::default(),
        },
        coupled,
        began: Instant::now(),
    };
    match kept {
        Some((kept, values)) => {
            march.coupled.restore(&kept.state, &values)?;
            march.result.states = kept.states;
            march.result.not_converged = kept.not_converged;
            (march.result.iterations, march.result.products) = (kept.iterations, kept.products);
            (march.result.builds, march.result.work_j) = (kept.builds, kept.work_j);
            observer
                .resumed(march.result.states.len() - 1, &march.result.states)
                .map_err(|what| FlowError::Observer { what })?;
        }
        None => {
            let first = CoupledStep {
                state: march.result.states[0].clone(),
                outcome: StepOutcome {
                    converged: true,
                    ..StepOutcome::default()
                },
                exchange: 0.0,
                work_j: 0.0,
            };
            march.report(&first, observer)?;
        }
    }
    march.result.stop = march.go(observer, cancel)?;
    march.result.coupling_seconds = march.coupled.seconds;
    march.result.seconds = march.began.elapsed().as_secs_f64();
    Ok(march.result)
}

/// Flow and structure at the mean position, the structure with its rates.
fn start(
    settings: &MarchSettings,
    grid: &MultiBlock,
    wing: &Wing,
    stream: Stream,
    mean: &MeanFlow,
) -> Result<Coupled, FlowError> {
    let placed = wing.placed(grid, &mean.q);
    let (mut solver, _) = steady::open(&settings.steady, &placed, mean.limiter_constant)?;
    solver.set(&mean.unknowns);
    solver.evaluate();
    // What the structure holds at its mean position; what the steady flow gives beyond it (its own error, and the whole load
    // where the deflection is left out) is balanced by hand, so that the march is one about that position.
    let equations = &wing.equations;
    let held: Vec<f64> = (0..equations.count())
        .map(|m| equations.generalized_mass[m] * equations.omega_rad_s[m].powi(2) * mean.q[m])
        .collect();
    let state = ModalState {
        time_s: 0.0,
        q: mean.q.clone(),
        q_dot: settings.start_rate_1_s.clone(),
        f: held.clone(),
    };
    let integrator = Integrator::new(equations.clone(), settings.scheme, settings.step_s, state).map_err(|e| {
        FlowError::Observer {
            what: format!("structure: {e}"),
        }
    })?;
    let mut coupled = Coupled::new(
        solver,
        &placed,
        Nodes::of(grid),
        Structure {
            integrator,
            shapes: wing.shapes.clone(),
        },
        stream,
        settings.coupling,
        DualTimeSettings {
            dt: stream.time(settings.step_s),
            ..settings.time
        },
        settings.steady.flow,
        settings.steady.reference,
    )?;
    coupled.balanced = coupled.forces().iter().zip(&held).map(|(f, h)| f - h).collect();
    Ok(coupled)
}

fn check(settings: &MarchSettings, wing: &Wing) -> Result<(), FlowError> {
    let wrong = |key, got: String, needed| Err(FlowError::Setting { key, got, needed });
    let rates = settings.start_rate_1_s.len();
    if rates != wing.equations.count() {
        return wrong(
            "start_rate_1_s",
            format!("{rates} rates"),
            "one rate for each mode is needed",
        );
    }
    if settings.start_rate_1_s.iter().all(|r| *r == 0.0) {
        return wrong(
            "start_rate_1_s",
            "zero in every mode".to_owned(),
            "a structure at rest stays at rest: give one mode a rate",
        );
    }
    if settings.steps == 0 || settings.time.max_iterations == 0 || settings.time.max_products == 0 {
        return wrong(
            "steps, max_iterations, max_products",
            "0".to_owned(),
            "at least one of each is needed",
        );
    }
    if !(settings.step_s > 0.0 && settings.step_s.is_finite()) {
        return wrong("step_s", settings.step_s.to_string(), "a positive time step is needed");
    }
    Ok(())
}

fn read_kept(settings: &MarchSettings, stream: &Stream, wing: &Wing) -> Result<Option<(Kept, Vec<f64>)>, FlowError> {
    let Some(path) = settings.restart.as_ref().filter(|p| settings.resume && p.exists()) else {
        return Ok(None);
    };
    let wrong = |what: String| FlowError::Restart {
        path: path.display().to_string(),
        what,
    };
    let (header, body) = read_checked(path, MAGIC)?;
    let kept: Kept = serde_json::from_slice(&header).map_err(|e| wrong(format!("header: {e}")))?;
    let plain = |s: &MarchSettings| MarchSettings {
        // How long to go on and where to keep things may change.
        steps: 0,
        restart: None,
        resume: false,
        checkpoint_steps: 0,
        largest_displacement: 0.0,
        steady: SteadySettings {
            restart: None,
            resume: false,
            checkpoint_steps: 0,
            ..s.steady.clone()
        },
        ..s.clone()
    };
    if plain(&kept.settings) != plain(settings) || kept.stream != *stream {
        return Err(wrong(
            "flow, stream, scheme, start or time step differ from those of the case; start anew or give the old ones"
                .to_owned(),
        ));
    }
    if kept.states.first().is_none_or(|s| s.q.len() != wing.equations.count()) {
        return Err(wrong("it has another number of modes".to_owned()));
    }
    Ok(Some((kept, doubles(&body))))
}

struct March<'a> {
    settings: &'a MarchSettings,
    wing: &'a Wing,
    mean: &'a MeanFlow,
    coupled: Coupled,
    result: MarchResult,
    began: Instant,
}

impl March<'_> {
    fn go(&mut self, observer: &mut dyn MarchObserver, cancel: &AtomicBool) -> Result<MarchStop, FlowError> {
        if observer.knows() {
            return Ok(MarchStop::Enough);
        }
        loop {
            let done = self.result.states.len() - 1;
            if done >= self.settings.steps || cancel.load(Ordering::Relaxed) {
                self.write()?;
                return Ok(if done >= self.settings.steps {
                    MarchStop::AllSteps
                } else {
                    MarchStop::Interrupted
                });
            }
            let step = match self.coupled.advance() {
                Ok(step) => step,
                // A motion that has grown a hundredfold, or would in this step grow beyond its bound, has answered the
                // question; a failure before that is a failure.
                Err(e @ (FlowError::Volume { .. } | FlowError::State { .. }))
                    if self.growth() > 100.0 || self.is_beyond(&self.coupled.structure.integrator.next().q) =>
                {
                    return Ok(MarchStop::RanAway(e.to_string()));
                }
                Err(e) => return Err(e),
            };
            self.result.iterations += step.outcome.iterations;
            self.result.products += step.outcome.products;
            self.result.builds += step.outcome.builds;
            self.result.work_j += step.work_j;
            if !step.outcome.converged {
                self.result.not_converged += 1;
                observer.message(&format!(
                    "step {}: the residual fell by {:.2} orders, {:.2} were asked for",
                    done + 1,
                    step.outcome.orders,
                    self.settings.time.orders
                ));
            }
            self.result.states.push(step.state.clone());
            match self.report(&step, observer) {
                Ok(Verdict::GoOn) => {}
                Ok(Verdict::Enough) => {
                    self.write()?;
                    return Ok(MarchStop::Enough);
                }
                Err(e) => {
                    self.write()?;
                    return Err(e);
                }
            }
            if self.is_beyond(&step.state.q) {
                self.write()?;
                return Ok(MarchStop::RanAway(format!(
                    "the wall moved by more than {:.3} reference chords",
                    self.settings.largest_displacement
                )));
            }
            let every = self.settings.checkpoint_steps;
            if every > 0 && (done + 1).is_multiple_of(every) {
                self.write()?;
            }
        }
    }

    /// True if the wall is farther from its mean position than the settings allow.
    fn is_beyond(&self, q: &[f64]) -> bool {
        let moved: Vec<f64> = q.iter().zip(&self.mean.q).map(|(q, m)| q - m).collect();
        self.wing.displacement(&moved) > self.settings.largest_displacement * self.settings.steady.reference.chord
    }

    /// Energy of the motion about the mean position.
    fn energy(&self, state: &ModalState) -> f64 {
        let moved: Vec<f64> = state.q.iter().zip(&self.mean.q).map(|(q, m)| q - m).collect();
        self.wing.equations.energy_j(&moved, &state.q_dot)
    }

    /// Energy of the last state over that of the first.
    fn growth(&self) -> f64 {
        let [first, last] =
            [self.result.states.first(), self.result.states.last()].map(|s| s.map_or(0.0, |s| self.energy(s)));
        last / first.max(f64::MIN_POSITIVE)
    }

    fn report(&mut self, step: &CoupledStep, observer: &mut dyn MarchObserver) -> Result<Verdict, FlowError> {
        let (loads, walls) = self.coupled.loads();
        let report = MarchStep {
            number: self.result.states.len() - 1,
            state: &step.state,
            energy_j: self.energy(&step.state),
            work_j: step.work_j,
            exchange: step.exchange,
            outcome: &step.outcome,
            loads: &loads,
            walls: &walls,
            nodes: &self.coupled.flow.grid.now,
            seconds: self.began.elapsed().as_secs_f64(),
        };
        observer.step(&report).map_err(|what| FlowError::Observer { what })
    }

    fn write(&self) -> Result<(), FlowError> {
        let Some(path) = &self.settings.restart else {
            return Ok(());
        };
        let json = |e: serde_json::Error| FlowError::Io {
            path: path.display().to_string(),
            source: e.into(),
        };
        let (state, values) = self.coupled.save().map_err(json)?;
        let kept = Kept {
            settings: self.settings.clone(),
            stream: self.coupled.stream,
            states: self.result.states.clone(),
            not_converged: self.result.not_converged,
            iterations: self.result.iterations,
            products: self.result.products,
            builds: self.result.builds,
            work_j: self.result.work_j,
            state,
        };
        let header = serde_json::to_vec(&kept).map_err(json)?;
        write_checked(path, MAGIC, &header, &|out| put_doubles(out, &values))
    }
}
