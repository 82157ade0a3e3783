//! Listens to a march: reads the damping as it goes, records, and says how far it is.

use crate::assemble::surface;
use crate::pmb::logbook::{Logbook, convergence};
use crate::pmb::steady::watch::Watch;
use dip_flutter::decay::{self, Reading};
use dip_grid::MultiBlock;
use dip_modal::ModalState;
use dip_pmb::march::{MarchObserver, MarchStep, Verdict};
use dip_pmb::observer::{Observer, Progress};
use dip_record::{Convergence, Modal, MotionValue, Step};
use std::time::Instant;

/// Hears a run at one density.
#[derive(Debug)]
pub struct Listener<'a> {
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
    /// Wall-clock seconds that reading the damping has taken.
    pub reading_s: f64,
    /// The grid at rest.
    pub grid: &'a MultiBlock,
    /// The recording.
    pub log: Logbook,
}

/// Steps from one recorded shape of the wall to the next. The modes give it at every step; recorded, it can be checked.
const SHAPE_INTERVAL: usize = 20;

impl Listener<'_> {
    fn read(&mut self, state: &ModalState) -> Option<&Reading> {
        let begin = Instant::now();
        let q: Vec<f64> = state.q.iter().zip(&self.mean).map(|(q, m)| q - m).collect();
        let reading = self.damping.push(&q);
        self.reading_s += begin.elapsed().as_secs_f64();
        reading
    }

    fn record(&mut self, step: &MarchStep<'_>) -> Result<(), String> {
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
            loads: self.log.loads(&step.loads.total),
            modal: Some(Modal {
                q: step.state.q.clone(),
                q_dot: step.state.q_dot.clone(),
                force_j: step.state.f.clone(),
            }),
            convergence: Convergence {
                // The mean position is a steady flow.
                converged: step.outcome.converged || step.number == 0,
                ..convergence(step.outcome)
            },
            shape_m: step
                .number
                .is_multiple_of(SHAPE_INTERVAL)
                .then(|| surface::at_walls(self.grid, step.nodes)),
        };
        self.log.step(&record, self.watch.is_interrupted())
    }

    fn say(&mut self, step: &MarchStep<'_>) {
        let damping = self.damping.reading().map_or_else(String::new, |r| {
            let modes = r.modes.first().map_or_else(String::new, |m| {
                format!("  {:.2} Hz, g {:+.4} +- {:.4}", m.freq_hz, m.g, m.g_error)
            });
            let growth = r
                .growth
                .map_or_else(String::new, |g| format!("  diverging at {:.2} 1/s", g.rate_1_s));
            modes + &growth
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
        self.watch.tell(step.number as f64 / self.steps.max(1) as f64, line);
    }
}

impl Observer for Listener<'_> {
    fn progress(&mut self, progress: &Progress) {
        self.watch.progress(progress);
    }

    fn message(&mut self, text: &str) {
        self.watch.message(text);
    }
}

impl MarchObserver for Listener<'_> {
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
        self.log.resume(number)?;
        self.watch.message(&format!("going on after time step {number}"));
        Ok(())
    }

    fn knows(&self) -> bool {
        !self.all_cycles && self.damping.reading().is_some_and(|r| r.known)
    }
}
