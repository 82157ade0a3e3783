//! Motion of a volume from the motion of its wall: the kernels. What they do to a grid stands in `grid_motion`.

mod blending;
mod rotation;

pub(crate) use blending::{Anchor, Blending};
pub(crate) use rotation::local_rotation;
