//! Parallel multi-block Euler/RANS flow solver.
