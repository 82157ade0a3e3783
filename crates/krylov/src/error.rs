//! What can go wrong in a linear solve.

/// Errors of factorizations and Krylov iterations.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum KrylovError {
    /// A pivot block cannot be inverted.
    #[error(
        "incomplete factorization: the diagonal block of cell {ijk:?} is singular (pivot {pivot:e}); \
         a smaller time step (CFL number) makes the diagonal dominant"
    )]
    SingularBlock {
        /// Cell (i, j, k) of the block.
        ijk: [usize; 3],
        /// Largest pivot that was left, relative to the block's largest entry.
        pivot: f64,
    },
    /// An inner product is not a number, or a search direction is in the operator's null space.
    #[error(
        "GCG broke down in iteration {iteration}: |A p|^2 = {norm_squared:e}; the operator or the right-hand side holds a value that is not finite, or the operator is singular"
    )]
    Breakdown {
        /// Iteration, from 1.
        iteration: usize,
        /// Squared norm of the image of the search direction.
        norm_squared: f64,
    },
    /// Array lengths differ.
    #[error("{what}: {needed} entries needed, got {got}")]
    Length {
        /// Which array.
        what: &'static str,
        /// Length needed.
        needed: usize,
        /// Length given.
        got: usize,
    },
}
