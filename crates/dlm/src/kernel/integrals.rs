//! Exponential sums for the integrals I1 and I2 of the kernel.
//!
//! With 1 - u/sqrt(1+u^2) ~ sum a_n exp(-lambda_n u) for u >= 0 (Rodden, Giesing and Kalman 1971, eqs. A.1 - A.9):
//!
//! I1 exp(i k1 u) = 1 - v - i k1 I0, I0 = sum a_n E_n / (lambda_n + i k1)
//! 3 I2 exp(i k1 u) = (2 + i k1 u)(1 - v) - u/(1+u^2)^1.5 - i k1 I0 + k1^2 J0,
//! J0 = sum a_n E_n / (lambda_n + i k1)^2 + u I0
//!
//! with v = u/sqrt(1+u^2), E_n = exp(-lambda_n u).

use super::IntegralSum;

/// Most terms of any sum.
pub(super) const TERMS: usize = 12;

/// One exponential sum: how the powers E_n follow from one exponential, and the coefficients.
pub(super) trait ExponentialSum {
    /// Number of terms.
    const COUNT: usize;
    /// Coefficients a_n; unused ones are zero.
    const A: [f64; TERMS];
    /// Exponent of the first power: E_1 = exp(-STEP u).
    const STEP: f64;
    /// Exponent lambda_n of term n = 0, 1, ...
    fn lambda(n: usize) -> f64;
    /// Power E_{n+1} from E_n and E_1.
    fn next(current: f64, first: f64) -> f64;
}

/// Laschka 1963, 11 terms: lambda_n = 0.372 n (coefficients as in Rodden, Giesing and Kalman 1971, A.4).
pub(super) struct Laschka11;

impl ExponentialSum for Laschka11 {
    const COUNT: usize = 11;
    const A: [f64; TERMS] = [
        0.24186198, -2.7918027, 24.991079, -111.59196, 271.43549, -305.75288, -41.183630, 545.98537, -644.78155,
        328.72755, -64.279511, 0.0,
    ];
    const STEP: f64 = 0.372;
    fn lambda(n: usize) -> f64 {
        0.372 * (n + 1) as f64
    }
    #[inline(always)]
    fn next(current: f64, first: f64) -> f64 {
        current * first
    }
}

/// Desmarais 1982, 12 terms: lambda_n = 0.009054814793 * 2^n, n = 1 ... 12.
pub(super) struct Desmarais12;

impl ExponentialSum for Desmarais12 {
    const COUNT: usize = 12;
    const A: [f64; TERMS] = [
        0.000319759140,
        -0.000055461471,
        0.002726074362,
        0.005749551566,
        0.031455895072,
        0.106031126212,
        0.406838011567,
        0.798112357155,
        -0.417749229098,
        0.077480713894,
        -0.012677284771,
        0.001787032960,
    ];
    const STEP: f64 = 2.0 * 0.009054814793;
    fn lambda(n: usize) -> f64 {
        0.009054814793 * (1_u32 << (n + 1)) as f64
    }
    #[inline(always)]
    fn next(current: f64, _first: f64) -> f64 {
        current * current
    }
}

impl IntegralSum {
    /// The sum's approximation of 1 - u/sqrt(1+u^2) for u >= 0: what its accuracy is judged by.
    pub fn one_minus_v(self, u: f64) -> f64 {
        fn sum<S: ExponentialSum>(u: f64) -> f64 {
            (0..TERMS).map(|n| S::A[n] * (-S::lambda(n) * u).exp()).sum()
        }
        match self {
            Self::Laschka11 => sum::<Laschka11>(u),
            Self::Desmarais12 => sum::<Desmarais12>(u),
        }
    }
}

/// Everything of the integrals that depends on k1 = omega r1 / U alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct SumCoefficients {
    /// -i k1 I0 = sum `t_n` `E_n`: real parts.
    pub t_re: [f64; TERMS],
    /// Imaginary parts.
    pub t_im: [f64; TERMS],
    /// k1^2 (J0 - u I0) = sum `w_n` `E_n`: real parts.
    pub w_re: [f64; TERMS],
    /// Imaginary parts.
    pub w_im: [f64; TERMS],
    /// 2 Re I1(u = 0): what u < 0 needs (eq. A.5).
    pub i1_zero: f64,
    /// 2 Re 3 I2(u = 0) (eq. A.9).
    pub i2_zero: f64,
}

impl SumCoefficients {
    pub(super) fn new<S: ExponentialSum>(k1: f64) -> Self {
        let mut c = Self {
            t_re: [0.0; TERMS],
            t_im: [0.0; TERMS],
            w_re: [0.0; TERMS],
            w_im: [0.0; TERMS],
            i1_zero: 0.0,
            i2_zero: 0.0,
        };
        let square = k1 * k1;
        let (mut t, mut w) = (0.0, 0.0);
        for n in 0..TERMS {
            let lambda = S::lambda(n);
            let part = S::A[n] / lambda.mul_add(lambda, square);
            c.t_re[n] = -square * part;
            c.t_im[n] = -k1 * lambda * part;
            let part2 = square * part / lambda.mul_add(lambda, square);
            c.w_re[n] = part2 * (lambda * lambda - square);
            c.w_im[n] = part2 * (-2.0 * lambda * k1);
            t += c.t_re[n];
            w += c.w_re[n];
        }
        c.i1_zero = 2.0 * (1.0 + t);
        c.i2_zero = 2.0 * (2.0 + t + w);
        c
    }
}
