//! What can be wrong with a deformation.

/// A grid that cannot be deformed, or that a deformation has folded.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeformError {
    /// Nothing moves.
    #[error("deformation: no patch of the grid is a moving wall; name the wall that follows the structure")]
    NoWall,
    /// A list of the wrong length.
    #[error("deformation: {name} has {got} entries, needed {needed}")]
    Count {
        /// What is listed.
        name: &'static str,
        /// Given.
        got: usize,
        /// Needed.
        needed: usize,
    },
    /// A displacement that is not a number.
    #[error("deformation: mode {mode}, wall node {node}: the displacement is not a finite number")]
    NotFinite {
        /// Mode number from 1.
        mode: usize,
        /// Wall node, from 0.
        node: usize,
    },
    /// A mirror plane that is no plane.
    #[error(
        "deformation: symmetry patch {patch:?} of block {block} is not plane: a node is {offset:.3e} off it; correct the grid or give it another boundary condition"
    )]
    NotPlane {
        /// Name of the patch.
        patch: String,
        /// Name of the block.
        block: String,
        /// Distance of the node, in the grid's unit.
        offset: f64,
    },
    /// A cell whose volume has turned its sign.
    #[error(
        "deformation: cell ({i}, {j}, {k}) of block {block} ({name}) is folded: its volume fell from {before:.3e} to {after:.3e}; the displacement is too large for this grid, use a smaller one or coarser cells at the wall"
    )]
    Folded {
        /// Index of the block.
        block: usize,
        /// Name of the block.
        name: String,
        /// Cell index along i, from 0.
        i: usize,
        /// Cell index along j.
        j: usize,
        /// Cell index along k.
        k: usize,
        /// Volume before.
        before: f64,
        /// Volume after.
        after: f64,
    },
}
