//! Generalized aerodynamic forces at one Mach number as a function of reduced frequency.
//!
//! The force on the generalized coordinates is `q_dyn Q(k) q` with `q_dyn = rho U^2 / 2` and `k = omega b / U`, b the
//! reference semichord of the [`crate::FlutterProblem`]. Harmonic quantities are Re(A e^{i omega t}).

use faer::{Mat, MatMut, MatRef, c64};

use crate::error::{FlutterError, Result};

/// Reduced frequencies for which forces rest on data (or on an exact formula).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KDomain {
    /// Least k.
    pub minimum: f64,
    /// Greatest k; may be infinite.
    pub maximum: f64,
}

/// Where a reduced frequency lies with respect to a [`KDomain`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KRange {
    /// Inside the data.
    Inside,
    /// Below the least k: the even continuation through k = 0 was used.
    Below,
    /// Above the greatest k: the extension rule of the forces was used.
    Above,
}

impl KDomain {
    /// Where `k` lies. A relative slack of 1e-9 forgives round-off at the ends.
    #[must_use]
    pub fn locate(&self, k: f64) -> KRange {
        if k < self.minimum * (1.0 - 1e-9) {
            KRange::Below
        } else if k > self.maximum * (1.0 + 1e-9) {
            KRange::Above
        } else {
            KRange::Inside
        }
    }
}

/// Generalized forces Q(k) at one Mach number.
///
/// `Q [row = force][column = mode]`, complex, size `modes() x modes()`. Implementations answer for every k >= 0, also
/// outside `domain()` by an extension that they document; the solvers report every point that used one.
pub trait GeneralizedForces: Sync {
    /// Number of generalized coordinates.
    fn modes(&self) -> usize;

    /// Where Q rests on data.
    fn domain(&self) -> KDomain;

    /// Writes Q(k) into `q` (`modes() x modes()`).
    ///
    /// # Errors
    /// When the supplier cannot give Q at this k.
    fn q(&self, k: f64, q: MatMut<'_, c64>) -> Result<()>;

    /// Writes Q(k) and dQ/dk. Central differences (one-sided, second order, next to k = 0) unless overridden.
    ///
    /// # Errors
    /// As [`Self::q`].
    fn q_and_slope(&self, k: f64, mut q: MatMut<'_, c64>, mut dq_dk: MatMut<'_, c64>) -> Result<()> {
        let n = self.modes();
        let step = 1e-5 * k.max(0.01);
        self.q(k, q.as_mut())?;
        let mut other = Mat::<c64>::zeros(n, n);
        if k > step {
            self.q(k + step, dq_dk.as_mut())?;
            self.q(k - step, other.as_mut())?;
            for j in 0..n {
                for i in 0..n {
                    dq_dk[(i, j)] = (dq_dk[(i, j)] - other[(i, j)]) / (2.0 * step);
                }
            }
        } else {
            self.q(k + step, dq_dk.as_mut())?;
            self.q(k + 2.0 * step, other.as_mut())?;
            for j in 0..n {
                for i in 0..n {
                    dq_dk[(i, j)] = (4.0 * dq_dk[(i, j)] - other[(i, j)] - 3.0 * q[(i, j)]) / (2.0 * step);
                }
            }
        }
        Ok(())
    }
}

/// `Ok` if every entry is a number.
pub(crate) fn check_finite(what: &str, matrix: MatRef<'_, c64>) -> Result<()> {
    for column in 0..matrix.ncols() {
        for row in 0..matrix.nrows() {
            let value = matrix[(row, column)];
            if !(value.re.is_finite() && value.im.is_finite()) {
                let value = if value.re.is_finite() { value.im } else { value.re };
                return Err(FlutterError::NotFinite {
                    what: what.to_string(),
                    row,
                    column,
                    value,
                });
            }
        }
    }
    Ok(())
}
