//! The commands of `pmb`, `dlm` and `dip`.
//!
//! One file for each command; `options` has what they share, `output` where results go, `exit` how they end.

mod assemble;
mod correction;
pub mod dip;
pub mod dlm;
mod exit;
mod figures;
mod frequency;
mod load_harmonics;
mod options;
mod output;
pub mod pmb;
mod progress;
mod stamp;
mod traces;

/// What `--version` prints: version and commit.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("DIP_COMMIT"), ")");
