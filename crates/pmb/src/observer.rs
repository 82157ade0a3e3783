//! How a run tells what it does.

use serde::{Deserialize, Serialize};

/// One line of a run's history.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Level: 0 is the finest.
    pub level: usize,
    /// Step, counted over all levels.
    pub step: usize,
    /// CFL number of the step.
    pub cfl: f64,
    /// Residual as orders of magnitude below that of the undisturbed stream on the same level.
    pub orders: f64,
    /// Lift coefficient.
    pub cl: f64,
    /// Drag coefficient.
    pub cd: f64,
    /// Pitching moment coefficient, nose up.
    pub cm: f64,
    /// Products with the operator in the step.
    pub products: usize,
    /// Reduction of the linear residual.
    pub linear_reduction: f64,
    /// Part of the step that was taken.
    pub part: f64,
    /// Wall-clock seconds since the run (or its last resumption) began.
    pub seconds: f64,
    /// Estimate of the wall-clock seconds that remain; not a number while unknown.
    pub seconds_left: f64,
}

/// Listens to a run.
pub trait Observer {
    /// After every step.
    fn progress(&mut self, progress: &Progress);
    /// Anything a user should read.
    fn message(&mut self, text: &str);
}

/// Hears nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {
    fn progress(&mut self, _: &Progress) {}
    fn message(&mut self, _: &str) {}
}
