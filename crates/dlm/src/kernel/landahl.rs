//! Landahl's kernel over a strip of receiving points: the vector loops.
//!
//! With v = u1 / sqrt(1 + u1^2), R^2 = x^2 + beta^2 r1^2 and the identity sqrt(1 + u1^2) = (R - M x) / (beta^2 r1), the
//! kernel's phase exp(-i k1 u1 - i kappa x) is exp(-i kappa M (R - M x) / beta^2), and nothing but sums of products is
//! left of K1 and K2 (Rodden, Giesing and Kalman 1971, eqs. 7 and 8).
//!
//! [`Point::geometry`] finds what does not depend on k, once; [`Point::unsteady`] adds one reduced frequency. Both are loops
//! over plain slices without branches or calls, which the compiler turns into vector code.

use faer::c64;

use super::integrals::{ExponentialSum, SumCoefficients, TERMS};
use super::lanes::{exp_negative, sin_cos};

/// Work space of one thread: one value per box of the longest strip.
pub(super) struct Scratch {
    pub x: Vec<f64>,
    pub one_minus_v: Vec<f64>,
    pub side: Vec<f64>,
    pub power: Vec<f64>,
    pub phase: Vec<f64>,
    pub compress: Vec<f64>,
    pub u: Vec<f64>,
    pub k2_plain: Vec<f64>,
    pub k2_re: Vec<f64>,
    pub k2_im: Vec<f64>,
    pub steady: Vec<f64>,
    pub base: Vec<f64>,
    pub re: Vec<Vec<f64>>,
    pub im: Vec<Vec<f64>>,
    pub phase_re: Vec<Vec<f64>>,
    pub phase_im: Vec<Vec<f64>>,
    pub coefficients: Vec<SumCoefficients>,
}

impl Scratch {
    /// For strips of up to `longest` boxes and `n_k` reduced frequencies.
    pub(super) fn new(longest: usize, n_k: usize) -> Self {
        let one = || vec![0.0; longest];
        let many = || vec![vec![0.0; longest]; n_k];
        Self {
            x: one(),
            one_minus_v: one(),
            side: one(),
            power: one(),
            phase: one(),
            compress: one(),
            u: one(),
            k2_plain: one(),
            k2_re: one(),
            k2_im: one(),
            steady: one(),
            base: one(),
            re: many(),
            im: many(),
            phase_re: many(),
            phase_im: many(),
            coefficients: Vec::with_capacity(n_k * 5),
        }
    }
}

/// One fit point of one sending box, seen from one receiving strip.
pub(super) struct Point {
    pub r1: f64,
    pub mach: f64,
    pub beta2: f64,
    /// Weight of P1, with chord / (8 pi) and T1.
    pub w1: f64,
    /// Weight of P2, with chord / (8 pi) and T2.
    pub w2: f64,
}

/// What one reduced frequency adds.
pub(super) struct Wave<'a> {
    pub k1: f64,
    pub kappa: f64,
    pub shift: c64,
    pub coefficients: &'a SumCoefficients,
}

/// Values per receiving box that do not depend on k.
#[derive(Clone, Copy)]
pub(super) struct Lanes<'a> {
    pub one_minus_v: &'a [f64],
    pub side: &'a [f64],
    pub power: &'a [f64],
    pub phase: &'a [f64],
    pub compress: &'a [f64],
    pub u: &'a [f64],
    pub k2_plain: &'a [f64],
    pub k2_re: &'a [f64],
    pub k2_im: &'a [f64],
    pub phase_re: &'a [f64],
    pub phase_im: &'a [f64],
}

impl Point {
    /// Fills the scratch arrays that do not depend on k; sums the steady numerators K10 and K20 (eqs. 15, 16), since the
    /// fit is of the difference, in `base`.
    pub(super) fn geometry<S: ExponentialSum, const NONPLANAR: bool>(&self, scratch: &mut Scratch, m: usize) {
        let Self {
            r1,
            mach,
            beta2,
            w1,
            w2,
        } = *self;
        let x = &scratch.x[..m];
        let one_minus_v = &mut scratch.one_minus_v[..m];
        let side = &mut scratch.side[..m];
        let power = &mut scratch.power[..m];
        let phase = &mut scratch.phase[..m];
        let compress = &mut scratch.compress[..m];
        let u_abs = &mut scratch.u[..m];
        let k2_plain = &mut scratch.k2_plain[..m];
        let k2_re = &mut scratch.k2_re[..m];
        let k2_im = &mut scratch.k2_im[..m];
        let base = &mut scratch.base[..m];
        let distance2 = beta2 * r1 * r1;
        let inverse = 1.0 / (beta2 * r1);
        let m_over_beta2 = mach / beta2;
        for i in 0..m {
            let xi = x[i];
            let big_r = xi.mul_add(xi, distance2).sqrt();
            let slant = (-mach).mul_add(xi, big_r);
            let reciprocal = 1.0 / (big_r * slant);
            let over_slant = reciprocal * big_r;
            let over_r = reciprocal * slant;
            let ahead = mach.mul_add(big_r, -xi);
            let v = ahead * over_slant;
            let u = ahead * inverse;
            let positive = u >= 0.0;
            let abs_u = u.abs();
            one_minus_v[i] = 1.0 - v.abs();
            side[i] = if positive { 1.0 } else { -1.0 };
            u_abs[i] = abs_u;
            power[i] = exp_negative(-S::STEP * abs_u);
            phase[i] = m_over_beta2 * slant;
            // M r1 / (R sqrt(1 + u^2))
            compress[i] = mach * distance2 * reciprocal;
            let k10 = -1.0 - xi * over_r;
            let mut difference = w1 * k10;
            if NONPLANAR {
                let s = beta2 * r1 * over_slant; // 1 / sqrt(1 + u^2)
                let r1_r = r1 * over_r;
                let squeeze = beta2 * r1_r * r1_r;
                k2_plain[i] = abs_u * s * s * s;
                k2_re[i] = mach * r1_r * s * (squeeze + s * s * (2.0 + mach * r1_r * u));
                k2_im[i] = mach * mach * r1_r * r1_r * s;
                let k20 = 2.0 + xi * over_r * (2.0 + squeeze);
                difference += w2 * k20;
            }
            base[i] += difference;
        }
    }

    /// Adds P1 w1 + P2 w2 of one k: -(K exp(-i kappa x) - K0), without the steady numerators.
    pub(super) fn unsteady<S: ExponentialSum, const NONPLANAR: bool, const COMPRESSIBLE: bool>(
        &self,
        wave: &Wave<'_>,
        lanes: Lanes<'_>,
        re: &mut [f64],
        im: &mut [f64],
    ) {
        let m = re.len();
        // Equal lengths, told once, keep bound checks out of the loop.
        let im = &mut im[..m];
        let (one_minus_v, side, power, phase) = (
            &lanes.one_minus_v[..m],
            &lanes.side[..m],
            &lanes.power[..m],
            &lanes.phase[..m],
        );
        let (compress, u, k2_plain) = (&lanes.compress[..m], &lanes.u[..m], &lanes.k2_plain[..m]);
        let (k2_re, k2_im) = (&lanes.k2_re[..m], &lanes.k2_im[..m]);
        let (phase_re, phase_im) = (&lanes.phase_re[..m], &lanes.phase_im[..m]);
        let Self { w1, w2, .. } = *self;
        let (k1, kappa) = (wave.k1, wave.kappa);
        let SumCoefficients {
            t_re,
            t_im,
            w_re,
            w_im,
            i1_zero,
            i2_zero,
        } = wave.coefficients;
        // For u < 0: I(u) = 2 Re I(0) - conj I(-u), eqs. A.5 and A.9.
        let from_zero = if NONPLANAR {
            w1 * i1_zero - w2 * i2_zero
        } else {
            w1 * i1_zero
        };
        let (zero_re, zero_im) = (from_zero * wave.shift.re, from_zero * wave.shift.im);
        for i in 0..m {
            let (sine, cosine) = if COMPRESSIBLE {
                sin_cos(kappa * phase[i])
            } else {
                (0.0, 1.0)
            };
            let first = power[i];
            let mut e = first;
            let (mut tr, mut ti, mut wr, mut wi) = (0.0, 0.0, 0.0, 0.0);
            for n in 0..TERMS {
                if n >= S::COUNT {
                    continue;
                }
                if n > 0 {
                    e = S::next(e, first);
                }
                tr = e.mul_add(t_re[n], tr);
                ti = e.mul_add(t_im[n], ti);
                if NONPLANAR {
                    wr = e.mul_add(w_re[n], wr);
                    wi = e.mul_add(w_im[n], wi);
                }
            }
            let q = one_minus_v[i];
            let c1_re = side[i].mul_add(q + tr, compress[i]);
            let c1_im = ti;
            let (c_re, c_im) = if NONPLANAR {
                let k1u = k1 * u[i];
                let b_re = 2.0 * q - k2_plain[i] + tr - k1u * ti + wr;
                let b_im = k1u * (q + tr) + ti + wi;
                let c2_re = side[i].mul_add(b_re, k2_re[i]);
                let c2_im = k1.mul_add(k2_im[i], b_im);
                (w1 * c1_re - w2 * c2_re, w1 * c1_im - w2 * c2_im)
            } else {
                (w1 * c1_re, w1 * c1_im)
            };
            let behind = 0.5 - 0.5 * side[i];
            let tail_re = behind * (phase_re[i] * zero_re - phase_im[i] * zero_im);
            let tail_im = behind * (phase_re[i] * zero_im + phase_im[i] * zero_re);
            re[i] += c_re * cosine + c_im * sine + tail_re;
            im[i] += c_im * cosine - c_re * sine + tail_im;
        }
    }
}
