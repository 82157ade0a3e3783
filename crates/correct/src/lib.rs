//! From pressure recordings to a corrected doublet lattice.
//!
//! [`harmonic`] finds complex amplitudes of histories, [`reading`] what a recording says per unit of its motion, [`sample`]
//! brings pressures from wall faces to boxes, [`bridge`] both together; [`mod@weight`] finds what the lattice lacks, [`apply`]
//! makes corrected generalized forces from it by every published class of method, and [`audit`] looks for the mistakes that
//! such a chain can hold.
//!
//! Conventions are those of `dip-dlm`: x aft, y to starboard, z up; Re(A e^{i omega t}); pitch nose up; k = omega b / U;
//! dCp = Cp of the lower minus Cp of the upper side, so that lift up is positive.

pub mod apply;
pub mod audit;
pub mod bridge;
mod error;
pub mod harmonic;
pub mod reading;
pub mod sample;
pub mod synthetic;
pub mod weight;

pub use apply::{Correction, Method, RecordedPressures, References, Settings, correct};
pub use error::{CorrectError, HarmonicError, MismatchError, ReadingError, SampleError};
