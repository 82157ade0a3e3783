//! The commands of `pmb`, `dlm` and `dip`.

pub mod dip;
pub mod dlm;
pub mod pmb;
