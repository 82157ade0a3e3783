//! Block-sparse linear systems: BILU(0) and GCG.
