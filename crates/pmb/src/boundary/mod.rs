//! Boundary conditions: what fills the ghost cells, and what crosses a boundary face.
//!
//! Each boundary face has the state of its cell extrapolated to the face (by the same reconstruction as inside, from
//! the ghost cell) and a flux that follows from it and from the condition. The flux is a generic kernel, so that its
//! derivative, needed by the implicit scheme, is the kernel run on dual numbers.

mod ghosts;
pub mod kernel;
mod sides;

pub use ghosts::fill_ghosts;
pub use kernel::{Boundary, flux_boundary};
pub(crate) use sides::outward;
pub use sides::{SideFlux, Sides, add_jacobian, fill_sides};
