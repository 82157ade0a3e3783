//! Recipes: TOML files that say which grid to make.
//!
//! See `docs/grids.md` of the project for every key, and `meshes/*.toml` for the shipped recipes.

mod file;
mod generate;
mod quantity;
mod source;
mod wing_file;

use std::path::{Path, PathBuf};

pub use file::{
    Cells, Extent, Kind, Recipe, SectionSource, Shape, SmoothingStart, SmoothingTable, Spacing, WingSource, YPlus,
};
pub use quantity::{Angle, Length};

use crate::coarsen::{CoarsenError, coarsen};
use crate::generate::GenerateError;
use crate::geometry::GeometryError;
use crate::split::split_into;
use crate::topology::MultiBlock;

/// Why a recipe could not be followed.
#[derive(Debug, thiserror::Error)]
pub enum RecipeError {
    /// A file cannot be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file says something that is not understood.
    #[error("{}:{line}:{column}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What is wrong and what would be right.
        message: String,
    },
    /// A key is missing, or does not go with the kind.
    #[error("{}: {message}", path.display())]
    Key {
        /// The recipe.
        path: PathBuf,
        /// Which key, what is needed.
        message: String,
    },
    /// The geometry is wrong.
    #[error("{}: {source}", path.display())]
    Geometry {
        /// The recipe.
        path: PathBuf,
        /// Why.
        source: GeometryError,
    },
    /// The grid cannot be made.
    #[error("{}: {source}", path.display())]
    Generate {
        /// The recipe.
        path: PathBuf,
        /// Why.
        source: GenerateError,
    },
    /// The coarser level does not exist.
    #[error("{}: coarsen: {source}", path.display())]
    Coarsen {
        /// The recipe.
        path: PathBuf,
        /// Why.
        source: CoarsenError,
    },
}

/// Reads the recipe at `path` and makes its grid.
/// # Errors
/// Names file, line and key where the recipe is wrong, and the setting where the grid cannot be made.
pub fn make(path: &Path) -> Result<MultiBlock, RecipeError> {
    read(path)?.make()
}

/// Reads the recipe at `path` without making anything.
/// # Errors
/// Names file, line and key where the recipe is wrong.
pub fn read(path: &Path) -> Result<Recipe, RecipeError> {
    source::read(path)
}

impl Recipe {
    /// Makes the grid: generates, coarsens, splits.
    /// # Errors
    /// Names the key or setting that is wrong.
    pub fn make(&self) -> Result<MultiBlock, RecipeError> {
        let (mut grid, times) = self.generate()?;
        for _ in 0..times {
            grid = coarsen(&grid).map_err(|source| RecipeError::Coarsen {
                path: self.path.clone(),
                source,
            })?;
        }
        if let Some(count) = self.blocks {
            split_into(&mut grid, count);
        }
        Ok(grid)
    }
}

/// Height of the first cell for a y+ on a flat plate: `y = y+ L / (Re sqrt(cf / 2))` with the turbulent skin friction
/// `cf = 0.026 Re^(-1/7)` (F. M. White, Fluid Mechanics, the one-seventh-power law, with `Re` of length L).
#[must_use]
pub fn wall_height(y_plus: f64, reynolds: f64, length: f64) -> f64 {
    let friction = 0.026 * reynolds.powf(-1.0 / 7.0);
    y_plus * length / (reynolds * (0.5 * friction).sqrt())
}
