//! Against exact solutions, symmetries and conservation.

mod aerodynamics;
mod exact_kernel;
mod files;
mod forces;
mod lattice;
mod splines;
