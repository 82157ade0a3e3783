//! The doublet lattice: kernels, influence coefficients, splines, generalized forces.
//!
//! # Conventions, written once
//! - x aft, y starboard, z up. A box's displacement `h` is along its normal (up for a wing), in the lattice's length unit.
//! - Harmonic motion Re(h exp(i omega t)); reduced frequency k = omega b / U with b the reference semichord, always
//!   passed beside k.
//! - The normal wash that a moving surface asks for is `w = dh/dx + i k h / b` (flow velocity along the normal over U), so
//!   a unit nose-up pitch about x0, h = -(x - x0), asks for w = -(1 + i k (x - x0) / b).
//! - `w = D dCp` with D the downwash matrix ([`kernel::downwash`]); `dCp = AIC w`, AIC = D^-1. dCp is the lower minus the
//!   upper pressure over the dynamic pressure, so nose-up pitch gives positive lift.
//! - The generalized aerodynamic force on mode i per amplitude of mode j is `q_dyn Q_ij`, with
//!   `Q_ij = sum over boxes of h_i(quarter chord) area dCp_j` ([`gaf`]). With a symmetry plane the sum is over the given
//!   boxes alone: half of the aircraft, to go with half of the structure.
//!
//! # Way through
//! [`lattice::Surface`] -> [`lattice::Lattice`] -> ([`spline`] -> [`motion::BoxMotion`]) -> [`gaf::generalized_forces`] ->
//! [`gaf::GeneralizedForceTable`]. [`aic::Aerodynamics`] solves for pressures or gives the AIC itself; [`store`] keeps it.

pub mod aic;
pub mod gaf;
mod hash;
pub mod kernel;
pub mod lattice;
mod matrix;
pub mod motion;
pub mod spline;
pub mod store;

pub use faer::c64;
pub use matrix::ComplexMatrix;
