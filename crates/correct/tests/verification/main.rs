//! Exact: harmonics of known signals, conservation of the mapping, recordings that the lattice makes itself.

mod harmonics;
mod mapping;
mod methods;
mod mistakes;
mod shapes;
mod wing;
