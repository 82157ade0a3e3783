//! What a march tells, and to whom.

use dip_modal::ModalState;

use crate::dual_time::StepOutcome;
use crate::loads::{Loads, WallPatch};
use crate::moving::Nodes;
use crate::observer::Observer;

/// What an observer wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// More steps.
    GoOn,
    /// Enough is known.
    Enough,
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
