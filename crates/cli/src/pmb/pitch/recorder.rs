//! Listens to a run with prescribed motion: recording and progress.

use crate::pmb::logbook::{Logbook, convergence};
use crate::pmb::steady::watch::Watch;
use dip_pmb::forced::{ForcedObserver, ForcedStep};
use dip_pmb::observer::{Observer, Progress};
use dip_record::{MotionValue, Step};

/// Writes the recording and says how far the run is.
#[derive(Debug)]
pub struct Recorder {
    /// Progress and Ctrl-C.
    pub watch: Watch,
    /// The recording.
    pub log: Logbook,
    /// Steps at most.
    pub steps: usize,
}

impl Recorder {
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
        self.watch.tell(step.number as f64 / self.steps.max(1) as f64, line);
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
        let speed = self.log.setup().references.speed_m_s;
        let motion = step.motion.iter().map(|[value, rate]| MotionValue {
            value: *value,
            // Rates of the solver are per metre of stream.
            rate: rate * speed,
        });
        let record = Step {
            number: u32::try_from(step.number).map_err(|e| e.to_string())?,
            time_s: step.time / speed,
            motion: motion.collect(),
            pressures: step.walls.iter().map(|w| w.cp.clone()).collect(),
            loads: self.log.loads(&step.loads.total),
            modal: None,
            convergence: convergence(step.outcome),
            shape_m: None,
        };
        self.log.step(&record, self.watch.is_interrupted())?;
        self.say(step);
        Ok(())
    }

    fn resumed(&mut self, number: usize) -> Result<(), String> {
        self.log.resume(number)?;
        self.watch.message(&format!("going on after time step {number}"));
        Ok(())
    }
}
