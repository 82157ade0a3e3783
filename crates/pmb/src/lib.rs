//! Parallel multi-block Euler/RANS flow solver.
//!
//! The crate knows grids ([`dip_grid`]) and linear algebra ([`dip_krylov`]), but neither case files nor output formats:
//! it takes plain settings ([`settings`]) and reports to an [`observer::Observer`]. Inside, length is in the grid's
//! unit, velocity is divided by the free-stream speed, density by its density, pressure by density times speed squared.
//!
//! From the bottom up: [`real`] and [`gas`]; the kernels [`flux`], [`reconstruct`] and [`boundary`]; [`level`] (a grid
//! as the solver sees it) and [`field`] (the flow on it); [`residual`] and [`jacobian`]; [`solver`] (Newton steps on a
//! level); [`steady`] (from free stream to convergence over a sequence of levels).

pub mod boundary;
pub mod check;
pub mod couple;
pub mod cut;
pub mod dual_time;
pub mod error;
pub mod field;
pub mod flux;
pub mod forced;
pub mod gas;
pub mod jacobian;
pub mod level;
pub mod loads;
pub mod march;
pub mod motion;
pub mod moving;
pub mod observer;
pub mod real;
pub mod reconstruct;
pub mod residual;
pub mod restart;
pub mod scheme;
pub mod secant;
pub mod sequence;
pub mod settings;
pub mod solver;
pub mod steady;
pub mod vortex;

pub use error::FlowError;
