//! A recording in memory.

use serde::Serialize;

use crate::setup::Setup;
use crate::step::Step;

/// A setup and the steps that followed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recording {
    /// What holds for the whole run.
    pub setup: Setup,
    /// Steps without gaps, in the order of time.
    pub steps: Vec<Step>,
    /// Why the run ended, in its own words; none for a run that was killed or still goes on.
    pub end: Option<String>,
}
