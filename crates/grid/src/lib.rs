//! Structured multi-block grids: made, read, checked.
//!
//! Axes are x aft, y to starboard, z up. See [`Block`] for the storage order, [`Topology`] for how blocks fit
//! together, [`metrics`] for areas and volumes.

pub mod block;
pub mod boundary_file;
pub mod cgns;
pub mod coarsen;
pub mod connect;
pub mod face;
pub mod file;
pub mod generate;
pub mod geometry;
pub mod metrics;
pub mod nmf;
pub mod period;
pub mod picture;
pub mod plot3d;
pub mod quality;
pub mod recipe;
pub mod reorient;
pub mod split;
pub mod topology;
pub mod vector;
pub mod vtk;
pub mod wall_distance;

pub use block::Block;
pub use face::{Face, Window};
pub use metrics::Metrics;
pub use period::Period;
pub use topology::{Condition, Interface, MultiBlock, Orientation, Patch, Side, Topology};
