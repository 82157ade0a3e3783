//! `[mesh]`: which grid a flow case runs on.

use schemars::JsonSchema;
use serde::Deserialize;
use std::path::PathBuf;

/// The grid of a flow case.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshTable {
    /// Recipe that the grid is made from, as for `pmb mesh`.
    pub recipe: PathBuf,
    /// Split into this many blocks, shared out among the threads; results depend on it only to the convergence asked
    /// for. The recipe's own number if left out.
    pub blocks: Option<usize>,
}
