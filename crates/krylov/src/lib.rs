//! Block-sparse linear systems of structured grids: the seven-point block matrix, its incomplete factors BILU(0),
//! and the generalized conjugate gradient method (GCG). No physics.
//!
//! A block of `ni x nj x nk` cells carries [`VARIABLES`] unknowns a cell. Vectors are `[cell][variable]` with cell
//! `(i, j, k)` at `i + ni (j + nj k)`. Entries of matrices, factors and search directions are kept as `f32` or `f64`
//! ([`Storage`]); residuals, solutions and inner products are `f64` always.
//!
//! ```
//! use dip_krylov::{BlockMatrix, Bilu, VARIABLES};
//! let mut a = BlockMatrix::<f64>::zeros([3, 1, 1]);
//! for cell in 0..3 {
//!     for v in 0..VARIABLES {
//!         a.diagonal_mut(cell)[v + VARIABLES * v] = 2.0;
//!     }
//! }
//! let mut factors = Bilu::<f64>::zeros([3, 1, 1]);
//! let blocks = [a];
//! factors.factor(&blocks)?;
//! let mut z = vec![0.0; 3 * VARIABLES];
//! factors.solve(&blocks, &vec![1.0; 3 * VARIABLES], &mut z);
//! assert_eq!(z[0], 0.5);
//! # Ok::<(), dip_krylov::KrylovError>(())
//! ```

pub mod bilu;
pub mod block_matrix;
pub mod dense;
mod error;
pub mod gcg;
pub mod multilevel;
mod order;
mod storage;
mod sweep;
pub mod team;
pub mod vector;

pub use bilu::Bilu;
pub use block_matrix::{BlockMatrix, Direction};
pub use error::KrylovError;
pub use gcg::{Gcg, GcgOutcome, GcgSettings, LinearOperator, Preconditioner};
pub use multilevel::{LevelShape, Multilevel};
pub use order::{Coupling, Sweep};
pub use storage::Storage;

/// Unknowns a cell: density, three velocities, pressure (or energy).
pub const VARIABLES: usize = 5;
/// Entries of one dense block.
pub const BLOCK: usize = VARIABLES * VARIABLES;
