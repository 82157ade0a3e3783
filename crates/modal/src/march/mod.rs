//! The structure's side of a march in time: modal equations, one step iterated with the flow.

mod equations;
mod error;
mod integrator;
mod scheme;

pub use equations::ModalEquations;
pub use error::MarchError;
pub use integrator::{ForceGuess, Integrator, ModalState};
pub use scheme::StepScheme;
