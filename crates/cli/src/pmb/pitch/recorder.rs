//! Listens to a run with prescribed motion: recording and progress.

use crate::pmb::steady::watch::Watch;
use dip_pmb::forced::{ForcedObserver, ForcedStep};
use dip_pmb::observer::{Observer, Progress};
use dip_record::{Convergence, Loads, MotionValue, Setup, Step, Writer, WriterOptions};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Writes the recording.
#[derive(Debug)]
pub struct Recorder {
    /// Progress and Ctrl-C.
    pub watch: Watch,
    path: PathBuf,
    setup: Setup,
    writer: Option<Writer>,
    force_n: f64,
    moment_n_m: f64,
    steps: usize,
    last_line: Option<Instant>,
}

impl Recorder {
    /// Records at `path` what `setup` describes; `steps` are taken at most.
    pub fn new(watch: Watch, path: PathBuf, setup: Setup, steps: usize) -> Self {
        let q = setup.references.dynamic_pressure_pa();
        let area = setup.references.reference_area_m2;
        Self {
            watch,
            path,
            force_n: q * area,
            moment_n_m: q * area * setup.references.reference_chord_m,
            setup,
            writer: None,
            steps,
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

    fn say(&mut self, step: &ForcedStep<'_>) {
        let change = if step.cycle_change.is_finite() {
            format!(", cycle to cycle {:.2} %", 100.0 * step.cycle_change)
        } else {
            String::new()
        };
        let c = &step.loads.total;
        let line = format!(
            "time step {:>4} of {}  {:.2} orders in {} ({} products)  CL {:.6}  CM {:.6}{change}  {:.1} s, {:.0} s left",
            step.number,
            self.steps,
            step.outcome.orders,
            step.outcome.iterations,
            step.outcome.products,
            c.cl,
            c.cm,
            step.seconds,
            step.seconds_left
        );
        let part = step.number as f64 / self.steps.max(1) as f64;
        if self.watch.show(part, &line) {
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

impl Observer for Recorder {
    fn progress(&mut self, progress: &Progress) {
        self.watch.progress(progress);
    }

    fn message(&mut self, text: &str) {
        self.watch.message(text);
    }
}

impl ForcedObserver for Recorder {
    fn step(&mut self, step: &ForcedStep<'_>) -> Result<(), String> {
        self.watch.interrupt();
        let speed = self.setup.references.speed_m_s;
        let c = &step.loads.total;
        let time_s = step.time / speed;
        let motion: Vec<MotionValue> = step
            .motion
            .iter()
            .map(|[value, rate]| MotionValue {
                value: *value,
                // Rates of the solver are per metre of stream.
                rate: rate * speed,
            })
            .collect();
        let record = Step {
            number: u32::try_from(step.number).map_err(|e| e.to_string())?,
            time_s,
            motion,
            pressures: step.walls.iter().map(|w| w.cp.clone()).collect(),
            loads: Loads {
                cl: c.cl,
                cd: c.cd,
                cm: c.cm,
                force_n: c.force.map(|f| f * self.force_n),
                moment_n_m: c.moment.map(|m| m * self.moment_n_m),
            },
            modal: None,
            convergence: Convergence {
                orders: step.outcome.orders,
                iterations: u32::try_from(step.outcome.iterations).unwrap_or(u32::MAX),
                converged: step.outcome.converged,
            },
            shape_m: None,
        };
        let writer = match &mut self.writer {
            Some(writer) => writer,
            none => none.insert(
                Writer::create(&self.path, self.setup.clone(), WriterOptions::default()).map_err(|e| e.to_string())?,
            ),
        };
        writer.step(&record).map_err(|e| e.to_string())?;
        self.say(step);
        Ok(())
    }

    fn resumed(&mut self, number: usize) -> Result<(), String> {
        let last = u32::try_from(number).map_err(|e| e.to_string())?;
        let writer = Writer::resume(&self.path, self.setup.clone(), WriterOptions::default(), last);
        self.writer = Some(writer.map_err(|e| e.to_string())?);
        self.watch.message(&format!("going on after time step {number}"));
        Ok(())
    }
}
