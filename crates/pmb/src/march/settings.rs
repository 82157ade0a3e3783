//! How flow and structure are marched.

use std::path::PathBuf;

use dip_modal::StepScheme;
use serde::{Deserialize, Serialize};

use super::Wing;
use crate::couple::Coupling;
use crate::dual_time::DualTimeSettings;
use crate::error::FlowError;
use crate::settings::SteadySettings;

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

impl MarchSettings {
    /// Refuses what cannot be marched.
    pub(super) fn check(&self, wing: &Wing) -> Result<(), FlowError> {
        let wrong = |key, got: String, needed| Err(FlowError::Setting { key, got, needed });
        let rates = self.start_rate_1_s.len();
        if rates != wing.equations.count() {
            return wrong(
                "start_rate_1_s",
                format!("{rates} rates"),
                "one rate for each mode is needed",
            );
        }
        if self.start_rate_1_s.iter().all(|r| *r == 0.0) {
            return wrong(
                "start_rate_1_s",
                "zero in every mode".to_owned(),
                "a structure at rest stays at rest: give one mode a rate",
            );
        }
        if self.steps == 0 || self.time.max_iterations == 0 || self.time.max_products == 0 {
            return wrong(
                "steps, max_iterations, max_products",
                "0".to_owned(),
                "at least one of each is needed",
            );
        }
        if !(self.step_s > 0.0 && self.step_s.is_finite()) {
            return wrong("step_s", self.step_s.to_string(), "a positive time step is needed");
        }
        Ok(())
    }
}
