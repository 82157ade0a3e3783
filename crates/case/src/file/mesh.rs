//! `[mesh]`: which grid a flow case runs on.

use crate::units::Length;
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::PathBuf;

/// The grid of a flow case: `recipe` or `file`.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshTable {
    /// Recipe that the grid is made from, as for `pmb mesh`.
    pub recipe: Option<PathBuf>,
    /// Plot3D file of the grid.
    pub file: Option<PathBuf>,
    /// Boundary conditions of `file`: TOML as `pmb mesh` writes it, or a neutral map file (.nmf). The `.bc.toml` or
    /// `.nmf` beside the grid if left out.
    pub boundary_conditions: Option<PathBuf>,
    /// What one unit of length in `file` is; 1 m if left out.
    pub length_unit: Option<Length>,
    /// Split into this many blocks, shared out among the threads; results depend on it only to the convergence asked
    /// for. As many as the grid has if left out.
    pub blocks: Option<usize>,
}
