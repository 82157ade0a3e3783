//! Listens to a march: reads the damping as it goes, records, and says how far it is.

use crate::pmb::steady::watch::Watch;
use dip_flutter::decay::{self, Reading};
use dip_modal::ModalState;
use dip_pmb::march::{MarchObserver, MarchStep, Verdict};
use dip_pmb::observer::{Observer, Progress};
use dip_record::{Convergence, Loads, Modal, MotionValue, Setup, Step, Writer, WriterOptions};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Hears a run at one density.
#[derive(Debug)]
pub struct Listener {
    /// Progress and Ctrl-C.
    pub watch: Watch,
    /// Damping so far.
    pub damping: decay::Watch,
    /// Generalized coordinates of the mean position.
    pub mean: Vec<f64>,
    /// True if a run goes on when its damping is known.
    pub all_cycles: bool,
    /// Steps at most.
    pub steps: usize,
    /// Name of the run in messages.
    pub label: String,
    path: PathBuf,
    setup: Setup,
    writer: Option<Writer>,
    last_line: Option<Instant>,
}

impl Listener {
    /// A listener that records at `path`.
    pub fn new(
        watch: Watch,
        damping: decay::Watch,
        mean: Vec<f64>,
        (steps, all_cycles): (usize, bool),
        label: String,
        path: PathBuf,
        setup: Setup,
    ) -> Self {
        Self {
            watch,
            damping,
            mean,
            all_cycles,
            steps,
            label,
            path,
            setup,
            writer: None,
            last_line: None,
        }
    }

    /// Ends the recording.
    ///
    /// # Errors
    /// If the rest cannot be written.
    pub fn finish(&mut self, reason: &str) -> Result<(), String> {
        match self.writer.take() {
            Some(writer) => writer.finish(reason).map_err(|e| e.to_string()),
            None => Ok(()),
        }
    }

    fn read(&mut self, state: &ModalState) -> Option<&Reading> {
        let q: Vec<f64> = state.q.iter().zip(&self.mean).map(|(q, m)| q - m).collect();
        self.damping.push(&q)
    }

    fn record(&mut self, step: &MarchStep<'_>) -> Result<(), String> {
        if self.writer.is_none() {
            let setup = self.setup.clone();
            let writer = Writer::create(&self.path, setup, WriterOptions::default()).map_err(|e| e.to_string())?;
            self.writer = Some(writer);
        }
        let q = self.setup.references.dynamic_pressure_pa();
        let force = q * self.setup.references.reference_area_m2;
        let c = &step.loads.total;
        let record = Step {
            number: u32::try_from(step.number).map_err(|e| e.to_string())?,
            time_s: step.state.time_s,
            motion: step
                .state
                .q
                .iter()
                .zip(&step.state.q_dot)
                .map(|(value, rate)| MotionValue {
                    value: *value,
                    rate: *rate,
                })
                .collect(),
            pressures: step.walls.iter().map(|w| w.cp.clone()).collect(),
            loads: Loads {
                cl: c.cl,
                cd: c.cd,
                cm: c.cm,
                force_n: c.force.map(|f| f * force),
                moment_n_m: c.moment.map(|m| m * force * self.setup.references.reference_chord_m),
            },
            modal: Some(Modal {
                q: step.state.q.clone(),
                q_dot: step.state.q_dot.clone(),
                force_j: step.state.f.clone(),
            }),
            convergence: Convergence {
                orders: step.outcome.orders,
                iterations: u32::try_from(step.outcome.iterations).unwrap_or(u32::MAX),
                converged: step.outcome.converged || step.number == 0,
            },
            shape_m: None,
        };
        match &mut self.writer {
            Some(writer) => writer.step(&record).map_err(|e| e.to_string()),
            None => Ok(()),
        }
    }

    fn say(&mut self, step: &MarchStep<'_>) {
        let damping = self
            .damping
            .reading()
            .and_then(|r| r.modes.first())
            .map_or_else(String::new, |m| {
                format!("  {:.2} Hz, g {:+.4} +- {:.4}", m.freq_hz, m.g, m.g_error)
            });
        let q: Vec<String> = step.state.q.iter().take(4).map(|q| format!("{q:+.2e}")).collect();
        let left = step.seconds / step.number.max(1) as f64 * self.steps.saturating_sub(step.number) as f64;
        let line = format!(
            "{}: time step {:>4} of at most {}  {:.2} orders in {}  q {}{damping}  {:.1} s, {left:.0} s left at most",
            self.label,
            step.number,
            self.steps,
            step.outcome.orders,
            step.outcome.iterations,
            q.join(" "),
            step.seconds
        );
        if self.watch.show(step.number as f64 / self.steps.max(1) as f64, &line) {
            return;
        }
        const INTERVAL: Duration = Duration::from_secs(5);
        if self.last_line.is_none_or(|at| at.elapsed() >= INTERVAL) {
            tracing::info!("{line}");
            self.last_line = Some(Instant::now());
        } else {
            tracing::debug!("{line}");
        }
    }
}

impl Observer for Listener {
    fn progress(&mut self, progress: &Progress) {
        self.watch.progress(progress);
    }

    fn message(&mut self, text: &str) {
        self.watch.message(text);
    }
}

impl MarchObserver for Listener {
    fn step(&mut self, step: &MarchStep<'_>) -> Result<Verdict, String> {
        self.watch.interrupt();
        self.record(step)?;
        let known = self.read(step.state).is_some_and(|r| r.known);
        self.say(step);
        Ok(if known && !self.all_cycles {
            Verdict::Enough
        } else {
            Verdict::GoOn
        })
    }

    fn resumed(&mut self, number: usize, states: &[ModalState]) -> Result<(), String> {
        for state in states {
            self.read(state);
        }
        let last = u32::try_from(number).map_err(|e| e.to_string())?;
        let setup = self.setup.clone();
        let writer = Writer::resume(&self.path, setup, WriterOptions::default(), last).map_err(|e| e.to_string())?;
        self.writer = Some(writer);
        self.watch.message(&format!("going on after time step {number}"));
        Ok(())
    }

    fn knows(&self) -> bool {
        !self.all_cycles && self.damping.reading().is_some_and(|r| r.known)
    }
}
