//! Makes grids from geometry.
//!
//! Aerofoils and wings stand in analytic coordinates that wrap round them (see the `conformal` module's own notes):
//! sections are mapped conformally, so that lines leave the wall at a right angle; nodes are then spread along each line
//! by its true arc length, so that wall spacing is exact at any fineness. If asked, planes are smoothed by elliptic
//! equations instead, from the map or from transfinite interpolation.

mod aerofoil;
mod box_grid;
mod channel;
mod chord;
mod conformal;
mod elliptic;
mod fourier;
mod line;
mod plane_c;
mod smoothing;
pub mod spacing;
mod transfinite;
mod wall_normal;
mod wing_ch;
mod wing_oo;

pub use aerofoil::{AerofoilGrid, AerofoilKind};
pub use box_grid::{BoxGrid, box_grid};
pub use channel::{ChannelGrid, ChannelShape};
pub use conformal::MapError;
pub use smoothing::{Smoothing, Start};
pub use wing_ch::WingCh;
pub use wing_oo::WingOo;

use crate::geometry::GeometryError;

/// Why a grid could not be made.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
pub enum GenerateError {
    /// The geometry is wrong.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// A section cannot be mapped.
    #[error(transparent)]
    Map(#[from] MapError),
    /// A setting is out of range.
    #[error("{name}: {needed} needed, got {got}")]
    Setting {
        /// The setting.
        name: String,
        /// What is needed.
        needed: String,
        /// What it is.
        got: String,
    },
    /// Cells grow too fast from the wall to the far field.
    #[error(
        "cells grow by {growth:.3} from wall to far field with {cells} cells, over the growth limit {limit}; \
         use at least {needed} cells, a larger wall spacing or a higher growth_limit"
    )]
    Growth {
        /// Ratio that was found.
        growth: f64,
        /// Ratio that is allowed.
        limit: f64,
        /// Cells asked for.
        cells: usize,
        /// Cells that would do.
        needed: usize,
    },
    /// Smoothing left folded cells.
    #[error(
        "{folded} cells are folded after {sweeps} sweeps of smoothing, the last of which moved a node by {change:.1e} \
         of its step: take more sweeps, or smoothing.start = \"map\""
    )]
    Folded {
        /// Cells without positive area.
        folded: usize,
        /// Sweeps that were done.
        sweeps: usize,
        /// Largest move of the last sweep, over the step along the wall.
        change: f64,
    },
}

impl GenerateError {
    fn setting(name: &str, needed: &str, got: impl std::fmt::Display) -> Self {
        Self::Setting {
            name: name.into(),
            needed: needed.into(),
            got: got.to_string(),
        }
    }
}

/// A number of cells must be large enough, at least `least` on the level kept, and a multiple of the stride.
fn check_count(name: &str, cells: usize, least: usize, stride: usize) -> Result<(), GenerateError> {
    let stride = stride.max(1);
    if cells < least * stride || !cells.is_multiple_of(stride) {
        let needed = if stride == 1 {
            format!("at least {least} cells")
        } else {
            format!(
                "a multiple of {stride} with at least {} cells, for the coarser level,",
                least * stride
            )
        };
        return Err(GenerateError::setting(name, &needed, cells));
    }
    Ok(())
}

/// A length or factor must be a finite number above zero.
fn check_positive(name: &str, value: f64) -> Result<(), GenerateError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(GenerateError::setting(name, "a number above zero", value))
}

/// A step must be above zero and below half of what it divides.
fn check_step(name: &str, value: f64, whole: f64) -> Result<(), GenerateError> {
    if value > 0.0 && value < 0.5 * whole {
        return Ok(());
    }
    Err(GenerateError::setting(
        name,
        &format!("a step above zero and below {:.4}", 0.5 * whole),
        value,
    ))
}

/// A growth factor along the wake may be zero.
fn check_growth(value: f64) -> Result<(), GenerateError> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(GenerateError::setting("wake_growth", "zero or more", value))
}
