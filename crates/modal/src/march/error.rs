//! What can be wrong with modal equations and their steps.

/// Modal equations that cannot be marched.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MarchError {
    /// A list that does not have one entry per mode.
    #[error("modal equations: {name} has {got} entries, needed {needed} (one per mode)")]
    Count {
        /// What is listed.
        name: &'static str,
        /// Given.
        got: usize,
        /// Needed.
        needed: usize,
    },
    /// A value that has no meaning.
    #[error("modal equations, mode {mode}: {name} needs {needed}, got {got}")]
    Value {
        /// Mode number from 1.
        mode: usize,
        /// Name of the quantity.
        name: &'static str,
        /// The admissible range.
        needed: &'static str,
        /// What was given.
        got: f64,
    },
    /// A step in time that is none.
    #[error("modal equations: the time step must be a finite number of seconds above zero, got {got}")]
    Step {
        /// What was given.
        got: f64,
    },
    /// A parameter of a scheme out of its range.
    #[error("generalized-alpha step: rho_infinity needs a number from 0 to 1, got {got}")]
    RhoInfinity {
        /// What was given.
        got: f64,
    },
    /// A generalized force that is not a number.
    #[error(
        "modal equations, mode {mode}: the generalized force at {time_s:.6e} s is {got}; the flow solution has failed, use a smaller time step or displacement"
    )]
    Force {
        /// Mode number from 1.
        mode: usize,
        /// Instant the force belongs to, s.
        time_s: f64,
        /// What was given.
        got: f64,
    },
}
