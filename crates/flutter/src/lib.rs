//! Flutter stability of a structure under given generalized aerodynamic forces: K, KE, PK and g methods, mode tracking,
//! crossings, humps, divergence, matched points, flutter boundaries, and the damping of time histories.
//!
//! The crate knows no aerodynamics: Q(k) comes in through [`GeneralizedForces`]. All methods solve, for a structure M, B,
//! K and `q_dyn = rho U^2 / 2`,
//!
//! ```text
//! [M p^2 + B p + K (1 + i g_s) - q_dyn Q] q = 0,    p = sigma + i omega,    k = omega b / U
//! ```
//!
//! and differ in what Q is away from harmonic motion (sigma = 0), where all of them are the same equation:
//!
//! | method | Q for damped motion |
//! |---|---|
//! | K, KE | Q(k), motion kept harmonic by artificial damping g: K (1 + i g) |
//! | PK (Nastran, Rodden) | Re Q + (Im Q / k)(p b / U) |
//! | PK (Hassig) | Q(k) |
//! | g (Chen) | Q(k) + (sigma b / U) dQ/d(ik) |
//!
//! SI units; omega in rad/s; g = 2 sigma / omega, positive unstable.

mod assignment;
mod boundary;
mod characteristic;
mod crossing;
pub mod decay;
mod error;
mod follow;
mod forces;
mod k_crossing;
mod k_equation;
mod k_method;
mod linear;
mod matched;
mod p_method;
mod problem;
pub mod search;
mod solution;
mod solve;
mod structure;
mod table;
pub mod theodorsen;

pub use boundary::{BoundaryPoint, SpeedIndexReference};
pub use error::{FlutterError, Result};
pub use forces::{GeneralizedForces, KDomain, KRange};
pub use k_equation::{KRoot, k_roots};
pub use k_method::solve_k;
pub use matched::{FlightPoint, MatchedPoint, matched_mach, solve_points};
pub use problem::{AirState, Atmosphere, FlutterProblem, OutOfRange, Settings, Sweep};
pub use solution::{
    Crossing, CrossingKind, Direction, FlutterSolution, Hump, Method, ModeCurve, ModePoint, Severity, Warning,
};
pub use solve::{BoundaryCase, solve, solve_boundary};
pub use structure::{DampingForm, NaturalModes, StructuralDamping, Structure};
pub use table::{Extension, Interpolation, TabulatedForces};
