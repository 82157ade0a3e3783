//! Q between the tabulated reduced frequencies.
//!
//! Q(ik) is the transform of a real function of time, so its real part is even and its imaginary part odd in k. The
//! interpolant is built on the data and their mirror image at -k, which gives it the right behaviour towards k = 0: real
//! part with zero slope, imaginary part proportional to k. Above the largest k nothing is known: asking there is an error.

use super::TableError;
use crate::c64;
use crate::matrix::ComplexMatrix;

/// How Q is interpolated over k.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Cubic spline through the data and their mirror image; at the largest k the curve ends with the slope of the parabola
    /// through the last three points.
    #[default]
    Spline,
    /// Straight lines between the data and their mirror image.
    Linear,
}

/// Q(k) of one Mach number, ready to be asked.
#[derive(Clone, Debug)]
pub struct KInterpolant {
    k: Vec<f64>,
    q: Vec<ComplexMatrix>,
    /// Second derivatives by k; none for straight lines.
    bend: Vec<ComplexMatrix>,
}

impl KInterpolant {
    /// From k (not negative, in any order, without repetition) and Q of one size each.
    ///
    /// # Errors
    /// No data, repeated or bad k, sizes that differ, values that are not finite.
    pub fn new(k: &[f64], q: &[ComplexMatrix], how: Interpolation) -> Result<Self, TableError> {
        let wrong = |reason: String| Err(TableError::Data { reason });
        if k.is_empty() || k.len() != q.len() {
            return wrong(format!("one Q per k is needed, got {} k and {} Q", k.len(), q.len()));
        }
        if let Some(bad) = k.iter().find(|k| !k.is_finite() || **k < 0.0) {
            return wrong(format!("k must be finite and not negative, got {bad}"));
        }
        let size = (q[0].rows(), q[0].columns());
        if q.iter().any(|m| (m.rows(), m.columns()) != size) {
            return wrong("the Q of all k must have one size".into());
        }
        if let Some(at) = q.iter().position(|m| !m.is_finite()) {
            return wrong(format!("Q at k = {} holds a number that is not finite", k[at]));
        }
        let mut order: Vec<usize> = (0..k.len()).collect();
        order.sort_by(|&a, &b| k[a].total_cmp(&k[b]));
        let k: Vec<f64> = order.iter().map(|&i| k[i]).collect();
        let q: Vec<ComplexMatrix> = order.iter().map(|&i| q[i].clone()).collect();
        if let Some(w) = k.windows(2).find(|w| w[1] == w[0]) {
            return wrong(format!("k = {} is given twice", w[0]));
        }
        let bend = match how {
            Interpolation::Linear => Vec::new(),
            Interpolation::Spline => bends(&k, &q),
        };
        Ok(Self { k, q, bend })
    }

    /// Smallest and largest tabulated k. Between 0 and the smallest, Q follows from evenness and oddness.
    pub fn range(&self) -> (f64, f64) {
        (self.k[0], self.k[self.k.len() - 1])
    }

    /// Number of rows of Q.
    pub fn n_modes(&self) -> usize {
        self.q[0].rows()
    }

    /// Q at `k`, [row = force mode][column = displacement mode].
    ///
    /// # Errors
    /// k above the largest tabulated one (or negative, or not a number): nothing is extrapolated.
    pub fn at(&self, k: f64) -> Result<ComplexMatrix, TableError> {
        self.evaluate(k, false)
    }

    /// dQ/dk at `k`.
    ///
    /// # Errors
    /// As [`KInterpolant::at`].
    pub fn slope_at(&self, k: f64) -> Result<ComplexMatrix, TableError> {
        self.evaluate(k, true)
    }

    fn evaluate(&self, k: f64, slope: bool) -> Result<ComplexMatrix, TableError> {
        let (low, high) = self.range();
        // Round-off of a k found as omega b / U is not extrapolation.
        if !(k >= 0.0 && k <= high * (1.0 + 1e-12)) {
            return Err(TableError::Range { k, low, high });
        }
        let upper = self.k.partition_point(|x| *x < k).min(self.k.len() - 1);
        let (left, a_re, a_im, lower) = if upper == 0 {
            if self.k[0] == 0.0 && self.k.len() == 1 {
                (-1.0, 1.0, -1.0, 0)
            } else if self.k[0] == 0.0 {
                // k = 0 exactly: the first interval.
                return self.cubic(k, slope, 0.0, 1.0, 1.0, 0, 1);
            } else {
                (-self.k[0], 1.0, -1.0, 0)
            }
        } else {
            (self.k[upper - 1], 1.0, 1.0, upper - 1)
        };
        self.cubic(k, slope, left, a_re, a_im, lower, upper)
    }

    /// One interval from `left` (data `lower`, parts times `a_re`, `a_im`) to `k[upper]`.
    #[expect(clippy::too_many_arguments, reason = "one interval of a cubic, described once")]
    fn cubic(
        &self,
        k: f64,
        slope: bool,
        left: f64,
        a_re: f64,
        a_im: f64,
        lower: usize,
        upper: usize,
    ) -> Result<ComplexMatrix, TableError> {
        let h = self.k[upper] - left;
        let b = ((k - left) / h).clamp(0.0, 1.0);
        let a = 1.0 - b;
        let (wa, wb, va, vb) = if slope {
            (
                -1.0 / h,
                1.0 / h,
                -(3.0 * a * a - 1.0) * h / 6.0,
                (3.0 * b * b - 1.0) * h / 6.0,
            )
        } else {
            (a, b, (a * a * a - a) * h * h / 6.0, (b * b * b - b) * h * h / 6.0)
        };
        let mirror = |z: c64| c64::new(a_re * z.re, a_im * z.im);
        let (first, last) = (&self.q[lower], &self.q[upper]);
        Ok(ComplexMatrix::from_fn(first.rows(), first.columns(), |i, j| {
            let mut value = mirror(first[(i, j)]) * wa + last[(i, j)] * wb;
            if let (Some(m0), Some(m1)) = (self.bend.get(lower), self.bend.get(upper)) {
                value += mirror(m0[(i, j)]) * va + m1[(i, j)] * vb;
            }
            value
        }))
    }
}

/// Second derivatives of the cubic spline through data and mirror image (the classical tridiagonal system, real and
/// imaginary part with their own first row).
fn bends(k: &[f64], q: &[ComplexMatrix]) -> Vec<ComplexMatrix> {
    let n = k.len();
    let (rows, columns) = (q[0].rows(), q[0].columns());
    let mut bend: Vec<ComplexMatrix> = (0..n).map(|_| ComplexMatrix::zeros(rows, columns)).collect();
    for j in 0..columns {
        for i in 0..rows {
            let real: Vec<f64> = q.iter().map(|m| m[(i, j)].re).collect();
            let imaginary: Vec<f64> = q.iter().map(|m| m[(i, j)].im).collect();
            let (even, odd) = (spline(k, &real, 1.0), spline(k, &imaginary, -1.0));
            for (m, (re, im)) in bend.iter_mut().zip(even.into_iter().zip(odd)) {
                m[(i, j)] = c64::new(re, im);
            }
        }
    }
    bend
}

/// Second derivatives at `k` of the spline of `y`; `parity` +1 even, -1 odd.
fn spline(k: &[f64], y: &[f64], parity: f64) -> Vec<f64> {
    let n = k.len();
    let (mut diagonal, mut upper, mut lower, mut right) = (vec![1.0; n], vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    // Left end.
    if k[0] == 0.0 {
        if parity > 0.0 && n > 1 {
            // Even: zero slope at 0.
            let h = k[1];
            diagonal[0] = h / 3.0;
            upper[0] = h / 6.0;
            right[0] = (y[1] - y[0]) / h;
        }
        // Odd: zero second derivative at 0: the row is already that.
    } else {
        // The interval before the first datum runs from its mirror image, h = 2 k0.
        let h0 = 2.0 * k[0];
        let before = (y[0] - parity * y[0]) / h0;
        if n > 1 {
            let h1 = k[1] - k[0];
            diagonal[0] = (h0 + h1) / 3.0 + parity * h0 / 6.0;
            upper[0] = h1 / 6.0;
            right[0] = (y[1] - y[0]) / h1 - before;
        }
        // A single datum: constant or proportional to k.
    }
    for i in 1..n.saturating_sub(1) {
        let (h0, h1) = (k[i] - k[i - 1], k[i + 1] - k[i]);
        lower[i] = h0 / 6.0;
        diagonal[i] = (h0 + h1) / 3.0;
        upper[i] = h1 / 6.0;
        right[i] = (y[i + 1] - y[i]) / h1 - (y[i] - y[i - 1]) / h0;
    }
    if n > 1 {
        // Right end: slope of the parabola through the last three points (the mirror image serves as third if need be).
        let (x2, y2) = (k[n - 1], y[n - 1]);
        let (x1, y1) = (k[n - 2], y[n - 2]);
        let (x0, y0) = if n > 2 {
            (k[n - 3], y[n - 3])
        } else if x1 > 0.0 {
            (-x1, parity * y1)
        } else {
            (-x2, parity * y2)
        };
        let (d21, d10) = ((y2 - y1) / (x2 - x1), (y1 - y0) / (x1 - x0));
        let slope = d21 + (d21 - d10) / (x2 - x0) * (x2 - x1);
        let h = x2 - x1;
        lower[n - 1] = h / 6.0;
        diagonal[n - 1] = h / 3.0;
        right[n - 1] = slope - d21;
    }
    for i in 1..n {
        let factor = lower[i] / diagonal[i - 1];
        diagonal[i] -= factor * upper[i - 1];
        right[i] -= factor * right[i - 1];
    }
    let mut m = right;
    for i in (0..n).rev() {
        let next = if i + 1 < n { upper[i] * m[i + 1] } else { 0.0 };
        m[i] = (m[i] - next) / diagonal[i];
    }
    m
}
