//! Noise that a fit leaves, with its correlation in time and between channels, and what it makes of the fitted parameters.
//!
//! The noise of channel c at sample i is taken to have the covariance `S_cd r^|i-j|` with that of channel d at sample j: a
//! first-order autoregression, alike in all channels. Both follow from what the fit leaves, but not directly: a fit with
//! many unknowns takes up the slow part of the noise, and what is left looks smaller and whiter than the noise was. So r is
//! the value for which the *expected* correlation of the remainder, with the fitted directions taken out, is the observed one
//! (moments of quadratic forms: E[e^T M e] = tr(M C)); as restricted likelihood does for variances (Patterson and Thompson,
//! Biometrika 58, 1971).

use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef};

/// Largest correlation from sample to sample: beyond it, noise cannot be told from an offset in records of our length.
const LARGEST: f64 = 0.98;
/// Halvings of the interval in which the correlation is looked for.
const HALVINGS: usize = 12;

/// Noise of a record.
#[derive(Debug)]
pub(super) struct Noise {
    /// Correlation from one sample to the next.
    pub correlation: f64,
    /// Covariance of the channels at one instant.
    covariance: Mat<f64>,
    /// Independent values that the covariance is known from.
    freedom: f64,
}

impl Noise {
    /// The noise behind the remainder `rest` `[sample][channel]` of a fit whose linear part spans the orthonormal columns of
    /// `linear` `[sample]` in every channel, and whose other parameters have the Jacobian `jacobian`, `[channel, sample]`
    /// below each other.
    pub fn behind(rest: MatRef<'_, f64>, linear: MatRef<'_, f64>, jacobian: MatRef<'_, f64>) -> Self {
        let (samples, channels) = (rest.nrows(), rest.ncols());
        let sums = rest.transpose() * rest;
        let whole: f64 = (0..channels).map(|c| sums[(c, c)]).sum();
        let lagged: f64 = (0..channels)
            .map(|c| (1..samples).map(|i| rest[(i, c)] * rest[(i - 1, c)]).sum::<f64>())
            .sum();
        if whole <= 0.0 {
            return Self {
                correlation: 0.0,
                covariance: Mat::zeros(channels, channels),
                freedom: f64::INFINITY,
            };
        }
        let shares: Vec<f64> = (0..channels).map(|c| sums[(c, c)] / whole).collect();
        let fitted = Fitted::new(linear, jacobian, shares, samples);
        let observed = lagged / whole;
        let ratio = |r: f64| {
            let expected = fitted.expected(r);
            expected.lagged / expected.size
        };
        let correlation = if observed <= ratio(0.0) {
            0.0
        } else if observed >= ratio(LARGEST) {
            LARGEST
        } else {
            let (mut low, mut high) = (0.0, LARGEST);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if ratio(middle) < observed {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            0.5 * (low + high)
        };
        let expected = fitted.expected(correlation);
        let covariance = Mat::from_fn(channels, channels, |c, d| sums[(c, d)] / expected.size.max(1e-3));
        Self {
            correlation,
            covariance,
            freedom: (expected.size.powi(2) / expected.square).max(1.0),
        }
    }

    /// Standard error of each parameter of a least-squares fit with the Jacobian `jacobian`: the root of the diagonal of
    /// `(J^T J)^-1 J^T C J (J^T J)^-1`, infinite where the parameters cannot be told apart, times the factor that makes one
    /// standard error hold 68 % of Student's distribution too: a variance told from few values is itself uncertain.
    pub fn standard_errors(&self, jacobian: MatRef<'_, f64>) -> Vec<f64> {
        let (count, channels) = (jacobian.ncols(), self.covariance.nrows());
        let samples = jacobian.nrows() / channels.max(1);
        // C J: correlation in time channel by channel, then between channels.
        let mut blurred = Mat::<f64>::zeros(jacobian.nrows(), count);
        let mut column = vec![0.0; samples];
        for k in 0..count {
            for d in 0..channels {
                for (i, v) in column.iter_mut().enumerate() {
                    *v = jacobian[(d * samples + i, k)];
                }
                correlate(self.correlation, &mut column);
                for c in 0..channels {
                    for (i, v) in column.iter().enumerate() {
                        blurred[(c * samples + i, k)] += self.covariance[(c, d)] * v;
                    }
                }
            }
        }
        let normal = jacobian.transpose() * jacobian;
        let inverse = normal.partial_piv_lu().solve(&Mat::<f64>::identity(count, count));
        let spread = &inverse * (jacobian.transpose() * &blurred) * inverse.transpose();
        let student = student(self.freedom);
        (0..count)
            .map(|k| {
                if inverse[(k, k)] > 0.0 && spread[(k, k)] >= 0.0 {
                    student * spread[(k, k)].sqrt()
                } else {
                    f64::INFINITY
                }
            })
            .collect()
    }
}

/// Half-width of Student's distribution with `freedom` degrees of freedom that holds as much as one standard deviation of a
/// normal variable (Abramowitz and Stegun 26.7.5 at x = 1; 1.4 % off at 1, 0.1 % from 2 on).
fn student(freedom: f64) -> f64 {
    1.0 + 0.5 / freedom + 0.25 / freedom.powi(2) + 0.0625 / freedom.powi(3)
}

/// `x_i <- sum_j r^|i-j| x_j`, by one pass each way.
fn correlate(r: f64, x: &mut [f64]) {
    let mut behind = 0.0;
    let before: Vec<f64> = x
        .iter()
        .map(|v| {
            let here = behind;
            behind = r * (behind + v);
            here
        })
        .collect();
    let mut ahead = 0.0;
    for (v, before) in x.iter_mut().zip(before).rev() {
        let own = *v;
        *v = own + before + ahead;
        ahead = r * (ahead + own);
    }
}

/// What a fit can take up of the noise: an orthonormal basis of its directions.
struct Fitted {
    /// Columns `[channel, sample]`.
    basis: Mat<f64>,
    /// B^T S B, S the symmetric shift by one sample.
    shifted: Mat<f64>,
    /// Part of the noise's variance in each channel.
    shares: Vec<f64>,
    samples: usize,
}

impl Fitted {
    fn new(linear: MatRef<'_, f64>, jacobian: MatRef<'_, f64>, shares: Vec<f64>, samples: usize) -> Self {
        let (channels, width) = (shares.len(), linear.ncols());
        let directions = jacobian.qr().compute_thin_Q();
        let basis = Mat::from_fn(
            samples * channels,
            channels * width + directions.ncols(),
            |row, column| {
                let (c, i) = (row / samples, row % samples);
                if column >= channels * width {
                    directions[(row, column - channels * width)]
                } else if column / width == c {
                    linear[(i, column % width)]
                } else {
                    0.0
                }
            },
        );
        let shifted = Mat::from_fn(basis.nrows(), basis.ncols(), |row, k| {
            let i = row % samples;
            let before = if i > 0 { basis[(row - 1, k)] } else { 0.0 };
            let after = if i + 1 < samples { basis[(row + 1, k)] } else { 0.0 };
            0.5 * (before + after)
        });
        Self {
            shifted: basis.transpose() * &shifted,
            basis,
            shares,
            samples,
        }
    }

    /// Moments of the remainder for noise of variance 1 over all channels with correlation `r`; P = 1 - B B^T.
    fn expected(&self, r: f64) -> Expected {
        let (rows, count, n) = (self.basis.nrows(), self.basis.ncols(), self.samples);
        // C B, C = shares x r^|i-j|.
        let mut blurred = Mat::<f64>::zeros(rows, count);
        let mut column = vec![0.0; n];
        for k in 0..count {
            for (c, share) in self.shares.iter().enumerate() {
                for (i, v) in column.iter_mut().enumerate() {
                    *v = self.basis[(c * n + i, k)];
                }
                correlate(r, &mut column);
                for (i, v) in column.iter().enumerate() {
                    blurred[(c * n + i, k)] = share * v;
                }
            }
        }
        let inner = self.basis.transpose() * &blurred;
        let (mut taken, mut crossed, mut twice) = (0.0, 0.0, 0.0);
        for k in 0..count {
            taken += inner[(k, k)];
            for l in 0..count {
                twice += inner[(k, l)] * self.shifted[(l, k)];
            }
            for c in 0..self.shares.len() {
                for i in 1..n {
                    let row = c * n + i;
                    crossed += 0.5
                        * (self.basis[(row, k)] * blurred[(row - 1, k)] + self.basis[(row - 1, k)] * blurred[(row, k)]);
                }
            }
        }
        let whole: f64 = self.shares.iter().sum();
        // tr(C C): n + 2 sum_d (n - d) r^2d in each channel.
        let lags: f64 = (1..n).map(|d| (n - d) as f64 * r.powi(2 * d as i32)).sum();
        let squares: f64 = self.shares.iter().map(|s| s * s * (n as f64 + 2.0 * lags)).sum();
        let norm = |m: &Mat<f64>| m.squared_norm_l2();
        Expected {
            size: n as f64 * whole - taken,
            lagged: (n - 1) as f64 * r * whole - 2.0 * crossed + twice,
            square: squares - 2.0 * norm(&blurred) + norm(&inner),
        }
    }
}

/// Moments of what a fit leaves of noise.
struct Expected {
    /// Sum of squares, tr(P C).
    size: f64,
    /// Sum of products with the next sample, tr(P C P S).
    lagged: f64,
    /// Half the variance of the sum of squares, tr(P C P C).
    square: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlation_in_two_passes_is_the_product_with_the_matrix() {
        let x: Vec<f64> = (0..9).map(|i| f64::from(i * i % 7) - 2.5).collect();
        let mut fast = x.clone();
        correlate(0.7, &mut fast);
        for (i, fast) in fast.iter().enumerate() {
            let slow: f64 = x
                .iter()
                .enumerate()
                .map(|(j, v)| 0.7_f64.powi(i.abs_diff(j) as i32) * v)
                .sum();
            assert!((fast - slow).abs() < 1e-12, "{i}: {fast} {slow}");
        }
    }

    /// Expected moments against the matrices themselves.
    #[test]
    fn expected_moments_are_the_traces() {
        let (n, channels, r) = (10, 2, 0.6);
        let linear = Mat::<f64>::from_fn(n, 2, |i, k| if k == 0 { 1.0 } else { i as f64 - 4.5 })
            .qr()
            .compute_thin_Q();
        let off = |v: f64, i: usize| v + (i as f64 * 1.7).sin();
        let raw = Mat::<f64>::from_fn(n * channels, 1, |i, _| off(0.3, i));
        // A Jacobian without the linear directions, as the fit has it.
        let block = |c: usize| Mat::<f64>::from_fn(n, 1, |i, _| raw[(c * n + i, 0)]);
        let free: Vec<Mat<f64>> = (0..channels)
            .map(|c| block(c) - &linear * (linear.transpose() * block(c)))
            .collect();
        let jacobian = Mat::<f64>::from_fn(n * channels, 1, |i, _| free[i / n][(i % n, 0)]);
        let shares = vec![0.25, 0.75];
        let fitted = Fitted::new(linear.as_ref(), jacobian.as_ref(), shares.clone(), n);
        let rows = n * channels;
        let c = Mat::<f64>::from_fn(rows, rows, |a, b| {
            if a / n == b / n {
                shares[a / n] * f64::powi(r, a.abs_diff(b) as i32)
            } else {
                0.0
            }
        });
        let p = Mat::<f64>::identity(rows, rows) - &fitted.basis * fitted.basis.transpose();
        let s = Mat::<f64>::from_fn(
            rows,
            rows,
            |a, b| {
                if a / n == b / n && a.abs_diff(b) == 1 { 0.5 } else { 0.0 }
            },
        );
        let trace = |m: Mat<f64>| (0..rows).map(|i| m[(i, i)]).sum::<f64>();
        let expected = fitted.expected(r);
        assert!((expected.size - trace(&p * &c)).abs() < 1e-12);
        assert!((expected.lagged - trace(&p * &c * &p * &s)).abs() < 1e-12);
        assert!((expected.square - trace(&p * &c * &p * &c)).abs() < 1e-12);
    }
}
