//! The recording of an unsteady run while it goes on: begun with the first step, gone on with after a stop, forced to the
//! disk wherever the run can be gone on with.

use dip_pmb::dual_time::StepOutcome;
use dip_record::{Convergence, Loads, Setup, Step, Writer, WriterOptions};
use std::path::PathBuf;

/// Steps after which a recording is safe from a kill. Restart files are written after multiples of it, so that a killed
/// run's recording reaches its restart file.
pub fn safe_steps() -> usize {
    WriterOptions::default().steps_per_chunk as usize
}

/// A recording under way.
#[derive(Debug)]
pub struct Logbook {
    path: PathBuf,
    setup: Setup,
    /// Steps between restart files.
    checkpoint: usize,
    writer: Option<Writer>,
}

impl Logbook {
    /// Records at `path` what `setup` describes; `checkpoint` steps lie between two restart files (0: none until the end).
    pub fn new(path: PathBuf, setup: Setup, checkpoint: usize) -> Self {
        Self {
            path,
            setup,
            checkpoint,
            writer: None,
        }
    }

    /// Whether a recording is open.
    pub fn has_begun(&self) -> bool {
        self.writer.is_some()
    }

    /// What holds for the whole run.
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// Coefficients, and the forces that they stand for.
    pub fn loads(&self, c: &dip_pmb::loads::Coefficients) -> Loads {
        let r = &self.setup.references;
        let force_n = r.dynamic_pressure_pa() * r.reference_area_m2;
        Loads {
            cl: c.cl,
            cd: c.cd,
            cm: c.cm,
            force_n: c.force.map(|f| f * force_n),
            moment_n_m: c.moment.map(|m| m * force_n * r.reference_chord_m),
        }
    }

    /// Adds a step. The restart file that follows must find all steps before it, even after a power failure: the recording
    /// is forced to the disk where one is due, and where the run ends with this step (`last`).
    ///
    /// # Errors
    /// If the step cannot be written.
    pub fn step(&mut self, step: &Step, last: bool) -> Result<(), String> {
        let writer = match &mut self.writer {
            Some(writer) => writer,
            none => none.insert(
                Writer::create(&self.path, self.setup.clone(), WriterOptions::default()).map_err(|e| e.to_string())?,
            ),
        };
        writer.step(step).map_err(|e| e.to_string())?;
        let due = self.checkpoint > 0 && (step.number as usize).is_multiple_of(self.checkpoint);
        if due || last {
            writer.sync().map_err(|e| e.to_string())?;
        }
        Ok(())
    }

    /// Goes on with the recording of an earlier run after step `number`.
    ///
    /// # Errors
    /// If it is not there, does not reach that step, or is of another run.
    pub fn resume(&mut self, number: usize) -> Result<(), String> {
        let last = u32::try_from(number).map_err(|e| e.to_string())?;
        let writer = Writer::resume(&self.path, self.setup.clone(), WriterOptions::default(), last);
        self.writer = Some(writer.map_err(|e| e.to_string())?);
        Ok(())
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
}

/// How well a step was solved, as it is recorded.
pub fn convergence(outcome: &StepOutcome) -> Convergence {
    Convergence {
        orders: outcome.orders,
        iterations: u32::try_from(outcome.iterations).unwrap_or(u32::MAX),
        converged: outcome.converged,
    }
}
