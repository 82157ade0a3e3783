//! The march itself: steps, reports, restart files.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use dip_grid::MultiBlock;
use dip_modal::{Integrator, ModalState};
use serde::{Deserialize, Serialize};

use super::kept::{Kept, cannot_write, read_kept};
use super::mean::MeanFlow;
use super::{MarchObserver, MarchSettings, MarchStep, Verdict, Wing};
use crate::couple::{Coupled, CoupledStep, Stream, Structure};
use crate::dual_time::{DualTimeSettings, StepOutcome};
use crate::error::FlowError;
use crate::moving::Nodes;
use crate::steady;

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
    /// Where its time went (since its last resumption).
    pub seconds: MarchSeconds,
}

/// Wall-clock seconds of a march and of its parts, which do not overlap and add up to the whole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MarchSeconds {
    /// All.
    pub all: f64,
    /// Residuals of the flow, those in products with its operator included.
    pub residual: f64,
    /// First-order Jacobians.
    pub jacobian: f64,
    /// Their factorizations.
    pub factorization: f64,
    /// GCG without the residuals in its products.
    pub gcg: f64,
    /// Deformation of the grid, its metrics and swept volumes.
    pub deformation: f64,
    /// Pressure to forces on the modes, and the steps of the modal equations.
    pub transfer: f64,
    /// Forces on the walls and the observer: recording, reading of the damping.
    pub observer: f64,
    /// Restart files.
    pub restart: f64,
    /// What is left: time derivative, first guesses, norms, starting.
    pub rest: f64,
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
    let began = Instant::now();
    settings.check(wing)?;
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
            seconds: MarchSeconds::default(),
        },
        coupled,
        began,
        observer_s: 0.0,
        restart_s: 0.0,
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
    march.result.seconds = march.seconds();
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

struct March<'a> {
    settings: &'a MarchSettings,
    wing: &'a Wing,
    mean: &'a MeanFlow,
    coupled: Coupled,
    result: MarchResult,
    began: Instant,
    /// Wall-clock seconds of observer and loads.
    observer_s: f64,
    /// Wall-clock seconds of restart files.
    restart_s: f64,
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
        let begin = Instant::now();
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
        let verdict = observer.step(&report).map_err(|what| FlowError::Observer { what });
        self.observer_s += begin.elapsed().as_secs_f64();
        verdict
    }

    fn write(&mut self) -> Result<(), FlowError> {
        let Some(path) = &self.settings.restart else {
            return Ok(());
        };
        let begin = Instant::now();
        let (state, values) = self.coupled.save().map_err(|e| cannot_write(path, e))?;
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
        kept.write(&values)?;
        self.restart_s += begin.elapsed().as_secs_f64();
        Ok(())
    }

    /// Where the time has gone.
    fn seconds(&self) -> MarchSeconds {
        let flow = &self.coupled.flow.solver.seconds;
        let coupling = &self.coupled.seconds;
        let all = self.began.elapsed().as_secs_f64();
        let known = [
            flow.residual,
            flow.jacobian,
            flow.factorization,
            flow.gcg,
            coupling.grid,
            coupling.structure,
            self.observer_s,
            self.restart_s,
        ];
        MarchSeconds {
            all,
            residual: flow.residual,
            jacobian: flow.jacobian,
            factorization: flow.factorization,
            gcg: flow.gcg,
            deformation: coupling.grid,
            transfer: coupling.structure,
            observer: self.observer_s,
            restart: self.restart_s,
            rest: all - known.iter().sum::<f64>(),
        }
    }
}
