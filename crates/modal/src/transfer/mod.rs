//! Motion from the structure's nodes to points of a surface, forces back.

mod closest;
mod constant_volume;
mod error;
mod matrix;
mod surface;

pub use constant_volume::ConstantVolume;
pub use error::TransferError;
pub use matrix::{Attachment, Transfer, TransferCheck};
pub use surface::StructuralSurface;
