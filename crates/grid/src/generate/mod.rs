//! Makes grids from geometry.

mod box_grid;

pub use box_grid::{BoxGrid, box_grid};
