//! A radix-2 fast Fourier transform: enough for a conformal map on a circle.

use num_complex::Complex64;

/// A transform of one length, with its factors.
pub(super) struct Fourier {
    /// `exp(-2 pi i m / n)` for m below n / 2, each by its own sine and cosine: a running product would lose digits.
    factors: Vec<Complex64>,
}

impl Fourier {
    /// For arrays of `n` numbers, a power of two.
    pub(super) fn new(n: usize) -> Self {
        debug_assert!(n.is_power_of_two());
        let step = -2.0 * std::f64::consts::PI / n as f64;
        Self {
            factors: (0..n / 2).map(|m| Complex64::cis(step * m as f64)).collect(),
        }
    }

    /// `X[k] = sum_m x[m] exp(-2 pi i k m / n)` in place (`+` in the exponent if `inverse`; no scaling).
    /// J. W. Cooley, J. W. Tukey, Math. Comp. 19 (1965), decimation in time.
    pub(super) fn transform(&self, x: &mut [Complex64], inverse: bool) {
        let n = x.len();
        debug_assert_eq!(n, 2 * self.factors.len());
        let bits = n.trailing_zeros();
        for m in 0..n {
            let r = m.reverse_bits() >> (usize::BITS - bits).min(usize::BITS - 1);
            if m < r {
                x.swap(m, r);
            }
        }
        let mut half = 1;
        while half < n {
            let stride = n / (2 * half);
            for start in (0..n).step_by(2 * half) {
                for m in 0..half {
                    let factor = self.factors[m * stride];
                    let odd = if inverse { factor.conj() } else { factor } * x[start + half + m];
                    let even = x[start + m];
                    x[start + m] = even + odd;
                    x[start + half + m] = even - odd;
                }
            }
            half *= 2;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transform_is_the_sum_it_says() {
        let n = 16;
        let x: Vec<_> = (0..n)
            .map(|m| Complex64::new((m * m % 7) as f64, (m % 3) as f64))
            .collect();
        let mut y = x.clone();
        let fourier = Fourier::new(n);
        fourier.transform(&mut y, false);
        for (k, value) in y.iter().enumerate() {
            let sum: Complex64 = (0..n)
                .map(|m| x[m] * Complex64::cis(-2.0 * std::f64::consts::PI * (k * m) as f64 / n as f64))
                .sum();
            assert!((sum - value).norm() < 1e-12);
        }
        fourier.transform(&mut y, true);
        assert!(y.iter().zip(&x).all(|(a, b)| (a / n as f64 - b).norm() < 1e-13));
    }
}
