//! Structured multi-block grids: made, read, checked.
//!
//! Axes are x aft, y to starboard, z up. See [`Block`] for the storage order, [`Topology`] for how blocks fit
//! together, [`metrics`] for areas and volumes.

pub mod block;
pub mod coarsen;
pub mod face;
pub mod generate;
pub mod geometry;
pub mod metrics;
pub mod picture;
pub mod quality;
pub mod recipe;
pub mod reorient;
pub mod split;
pub mod topology;
pub mod vector;

pub use block::Block;
pub use face::{Face, Window};
pub use metrics::Metrics;
pub use topology::{Condition, Interface, MultiBlock, Orientation, Patch, Side, Topology};
