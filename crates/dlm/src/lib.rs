//! The doublet lattice: kernels, influence coefficients, splines, generalized forces.
