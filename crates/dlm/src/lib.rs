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
//!
//! ```
//! use dip_dlm::aic::Aerodynamics;
//! use dip_dlm::gaf::{Interpolation, PointRule, generalized_forces};
//! use dip_dlm::kernel::Kernel;
//! use dip_dlm::lattice::{Lattice, PlaneSymmetry, Surface};
//! use dip_dlm::motion::{BoxMotion, RigidMotion};
//!
//! // A half wing, 1 m chord, 4 m half span, 8 x 12 boxes, symmetric about y = 0; semichord 0.5 m.
//! let wing = Surface::trapezoid("wing", ([0.0, 0.0, 0.0], 1.0), ([0.0, 4.0, 0.0], 1.0), 8, 12);
//! let lattice = Lattice::new(vec![wing], PlaneSymmetry::Symmetric)?;
//! let model = Aerodynamics::new(lattice, Kernel::QUARTIC, 0.5)?;
//! for finding in model.check(0.6, 0.5) {
//!     println!("{:?}: {}", finding.severity, finding.message);
//! }
//! // Modes: up, and nose up about the quarter chord.
//! let mut modes = BoxMotion::empty(model.lattice().n_boxes());
//! let up = RigidMotion { translation: [0.0, 0.0, 1.0], ..RigidMotion::default() };
//! let pitch = RigidMotion { rotation: [0.0, 1.0, 0.0], centre: [0.25, 0.0, 0.0], ..RigidMotion::default() };
//! modes.push_rigid(model.lattice(), PointRule::ControlPoint, &up);
//! modes.push_rigid(model.lattice(), PointRule::ControlPoint, &pitch);
//! let table = generalized_forces(&model, &modes, &[0.6], &[0.0, 0.1, 0.3, 0.5])?;
//! let q = table.at_mach(0.6, Interpolation::Spline)?.at(0.2)?;
//! // Lift per radian of pitch over dynamic pressure and the half wing's 4 m^2: below the two-dimensional 2 pi / beta.
//! assert!(q[(0, 1)].re / 4.0 > 4.0 && q[(0, 1)].re / 4.0 < 7.85);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod aic;
pub mod gaf;
mod hash;
pub mod kernel;
pub mod lattice;
mod lu;
mod matrix;
pub mod motion;
pub mod spline;
pub mod store;

pub use faer::c64;
pub use matrix::ComplexMatrix;
