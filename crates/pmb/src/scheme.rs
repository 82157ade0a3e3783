//! What is discretized, and how: the constants that every kernel of a level shares.

use crate::gas::State;
use crate::reconstruct::Reconstruction;

/// Spatial scheme of a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scheme {
    /// Ratio of specific heats.
    pub gamma: f64,
    /// Face states.
    pub reconstruction: Reconstruction,
    /// Squares of the limiter's constants for density, velocity, pressure.
    ///
    /// Differences well below the constant are not limited, which leaves smooth extrema alone and keeps the limiter
    /// from switching in round-off. The constant is `(K h)^(3/2)` of the free-stream value's scale, with h = N^(-1/d)
    /// for N cells in d dimensions: it falls faster than a shock's jump and slower than the second difference at an
    /// extremum (h^2), as in Venkatakrishnan 1995 (J. Comput. Phys. 118), but neither units nor stretching enter.
    pub limiter_squared: [f64; 3],
}

impl Scheme {
    /// Scheme for a level of `cells` in two or three dimensions at a free-stream Mach number.
    #[must_use]
    pub fn new(
        gamma: f64,
        reconstruction: Reconstruction,
        limiter_constant: f64,
        cells: usize,
        planar: bool,
        mach: f64,
    ) -> Self {
        let dimensions = if planar { 2.0 } else { 3.0 };
        let h = (cells.max(1) as f64).powf(-1.0 / dimensions);
        // Not zero: the mean of two zero differences must not be 0/0.
        let e2 = (limiter_constant * h).powi(3).max(1e-24);
        // Pressure and velocity vary by the order of the dynamic pressure and speed, density by M^2 of that.
        let density = mach.min(1.0).powi(4).max(1e-6);
        Self {
            gamma,
            reconstruction,
            limiter_squared: [e2 * density, e2, e2],
        }
    }

    /// The same with another reconstruction.
    #[must_use]
    pub fn with(self, reconstruction: Reconstruction) -> Self {
        Self { reconstruction, ..self }
    }
}

/// Free-stream state `[rho, u, v, w, p]`: density and speed are one, pressure 1/(gamma M^2). `alpha` turns the stream
/// from x to z (nose-up positive), `beta` to y, radians.
#[must_use]
pub fn free_stream(gamma: f64, mach: f64, alpha: f64, beta: f64) -> State<f64> {
    [
        1.0,
        alpha.cos() * beta.cos(),
        beta.sin(),
        alpha.sin() * beta.cos(),
        1.0 / (gamma * mach * mach),
    ]
}
