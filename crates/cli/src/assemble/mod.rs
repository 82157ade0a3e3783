//! From what the user asks to what the solvers take: one file for each solver's input.

pub mod deformation;
pub mod flow;
pub mod grid;
pub mod lattice;

pub mod modes;
pub mod motion;
mod nastran_modes;
pub mod references;
pub mod structure;
pub mod surface;
