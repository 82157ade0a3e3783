//! What can go wrong in a stability solution, and what to do about it.

use thiserror::Error;

/// Error of the flutter crate. Every variant says where, what was needed, what was found and what to do next.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FlutterError {
    /// A matrix or list has the wrong size.
    #[error("{what}: needed {needed}, got {got}; give every matrix the size of the generalized coordinates")]
    Shape {
        /// Which input.
        what: String,
        /// Size needed.
        needed: String,
        /// Size found.
        got: String,
    },
    /// An input is NaN or infinite.
    #[error("{what}: entry ({row}, {column}) is {value}; all entries must be finite numbers")]
    NotFinite {
        /// Which input.
        what: String,
        /// Row, from 0.
        row: usize,
        /// Column, from 0.
        column: usize,
        /// The value found.
        value: f64,
    },
    /// A scalar input is outside what the equations allow.
    #[error("{what}: needed {needed}, got {got}")]
    Value {
        /// Which input, with its unit.
        what: String,
        /// What is allowed.
        needed: String,
        /// The value found.
        got: f64,
    },
    /// Mass and stiffness have no set of natural modes.
    #[error("natural modes: {reason}; remove the coordinates without mass or give them some")]
    NoNaturalModes {
        /// Why.
        reason: String,
    },
    /// A reduced frequency lies outside what the aerodynamics cover and the settings forbid extension.
    #[error(
        "reduced frequency k = {k:.6} is outside the table ({minimum:.6} to {maximum:.6}) for {at}; add reduced frequencies, \
         change the speed range, or allow extension (OutOfRange::Report)"
    )]
    OutOfRange {
        /// k asked for.
        k: f64,
        /// Least k of the table.
        minimum: f64,
        /// Greatest k of the table.
        maximum: f64,
        /// What asked for it.
        at: String,
    },
    /// A dense eigenvalue solution failed.
    #[error("eigenvalue solution at {at} did not converge; check the matrices for extreme scaling")]
    Eigen {
        /// The place.
        at: String,
    },
    /// The method cannot make the sweep asked for.
    #[error("{method} cannot {request}; {advice}")]
    Unsupported {
        /// Method name.
        method: String,
        /// What was asked.
        request: String,
        /// What to do.
        advice: String,
    },
    /// Aerodynamics supplied by another crate failed.
    #[error("aerodynamic forces at k = {k:.6}: {reason}")]
    Forces {
        /// k asked for.
        k: f64,
        /// What the supplier said.
        reason: String,
    },
}

/// Result of the flutter crate.
pub type Result<T> = std::result::Result<T, FlutterError>;

/// `Ok` if `value` is finite and satisfies `holds`.
pub(crate) fn check_value(what: &str, value: f64, needed: &str, holds: bool) -> Result<()> {
    if value.is_finite() && holds {
        Ok(())
    } else {
        Err(FlutterError::Value {
            what: what.to_string(),
            needed: needed.to_string(),
            got: value,
        })
    }
}
