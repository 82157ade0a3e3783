//! Fluxes through a face between two states.

pub mod osher;
pub mod riemann;

pub use osher::{flux_osher, jacobian_osher};
