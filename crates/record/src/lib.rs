//! Recordings of unsteady runs: what moved, how, and what pressure that made, each with the instant it belongs to.
//!
//! A [`Recording`] is a [`Setup`] (reference quantities, motion coordinates, the surface) and [`Step`]s. [`Writer`] puts
//! it in an MCAP file while a run goes on; [`Recording::read`] takes only whole, checked files and
//! [`Recording::read_salvage`] takes what it can and says what is wrong.
//!
//! Everything is in SI units, angles in radians unless a name says `deg`; x aft, y to starboard, z up. Time counts from
//! the start of the run.

mod check;
mod container;
pub mod csv;
pub mod error;
pub mod finding;
mod message;
mod metadata;
pub mod motion;
pub mod paraview;
mod position;
pub mod read;
pub mod recording;
pub mod schema;
pub mod setup;
pub mod step;
pub mod surface;
pub mod write;

pub use error::RecordError;
pub use finding::{Finding, FindingKind};
pub use message::Precision;
pub use motion::{CoordinateKind, Harmonic, Law, MotionCoordinate, MotionValue, StructuralMode};
pub use read::Salvage;
pub use recording::Recording;
pub use setup::{Provenance, References, Setup};
pub use step::{Convergence, Loads, Modal, Step};
pub use surface::{SurfaceGrid, SurfacePatch};
pub use write::{Writer, WriterOptions};
