//! The numbers that kernels work on: one number, four at once, or one with its derivatives.
//!
//! A kernel is written once for `T: Real`. [`Lanes`] makes four faces of it at a time without relying on the
//! compiler to find them; [`Dual`] differentiates it (boundary conditions, and the check of every analytic
//! derivative). There are no branches on values: [`Real::select_lt`] chooses lane by lane.
//!
//! `f64` and `Lanes` give the same bits.

use std::ops::{Add, Div, Mul, Neg, Sub};

use wide::{bytemuck::cast, f64x4, u64x4};

/// Four numbers in one register.
pub type Lanes = f64x4;
/// Numbers in a [`Lanes`].
pub const LANES: usize = 4;

/// Arithmetic of a kernel.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A constant.
    fn splat(value: f64) -> Self;
    /// Square root of a number that is not negative.
    fn sqrt(self) -> Self;
    /// `self^exponent` for a positive, normal number.
    fn power(self, exponent: f64) -> Self;
    /// The larger one.
    fn max(self, other: Self) -> Self;
    /// `if a < b { yes } else { no }`, lane by lane.
    fn select_lt(a: Self, b: Self, yes: Self, no: Self) -> Self;
    /// |self|
    #[inline(always)]
    fn abs(self) -> Self {
        self.max(-self)
    }
}

impl Real for f64 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
    #[inline(always)]
    fn power(self, exponent: f64) -> Self {
        Lanes::splat(self).power(exponent).to_array()[0]
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn select_lt(a: Self, b: Self, yes: Self, no: Self) -> Self {
        if a < b { yes } else { no }
    }
}

/// 2/(2m+1)/ln 2: log2 of (1+s)/(1-s) is `s` times the sum of these times `s^2m`.
const LOG2_SERIES: [f64; 12] = {
    let mut c = [0.0; 12];
    let mut m = 0;
    while m < 12 {
        c[m] = 2.0 / (2.0 * m as f64 + 1.0) * std::f64::consts::LOG2_E;
        m += 1;
    }
    c
};

/// (ln 2)^m/m!: the series of 2^f.
const EXP2_SERIES: [f64; 14] = {
    let mut c = [1.0; 14];
    let mut m = 1;
    while m < 14 {
        c[m] = c[m - 1] * std::f64::consts::LN_2 / m as f64;
        m += 1;
    }
    c
};

impl Real for Lanes {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self::splat(value)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }

    /// `2^(e log2 x)`, branch-free. With x = m 2^n and m between sqrt(1/2) and sqrt(2), log2 m is the series in
    /// s = (m-1)/(m+1), |s| < 0.172, and 2^f the series for |f| <= 1/2: both are cut below 1e-17. Exactly one at x = 1.
    #[inline(always)]
    fn power(self, exponent: f64) -> Self {
        let one = Self::splat(1.0);
        // 2^52: adding it to a small integer leaves that integer in the low bits of the mantissa.
        let shifter = Self::splat(4_503_599_627_370_496.0);
        let bits: u64x4 = cast(self);
        let mantissa: Self = cast((bits & u64x4::splat(0x000F_FFFF_FFFF_FFFF)) | u64x4::splat(0x3FF0_0000_0000_0000));
        let biased: Self = cast((bits >> 52) | cast::<_, u64x4>(shifter));
        let n = biased - (shifter + Self::splat(1023.0));
        let above = mantissa.simd_gt(Self::splat(std::f64::consts::SQRT_2));
        let m = above.bitselect(mantissa * Self::splat(0.5), mantissa);
        let n = above.bitselect(n + one, n);
        let s = (m - one) / (m + one);
        let s2 = s * s;
        let mut log2 = Self::splat(LOG2_SERIES[11]);
        for c in LOG2_SERIES[..11].iter().rev() {
            log2 = log2.mul_add(s2, Self::splat(*c));
        }
        let t = (log2 * s + n) * Self::splat(exponent);
        // Clamped to what a normal number can hold.
        let t = t.fast_max(Self::splat(-1021.0)).fast_min(Self::splat(1022.0));
        let whole = t.round_ties_even();
        let f = t - whole;
        let mut exp2 = Self::splat(EXP2_SERIES[13]);
        for c in EXP2_SERIES[..13].iter().rev() {
            exp2 = exp2.mul_add(f, Self::splat(*c));
        }
        let scale: Self = cast(cast::<_, u64x4>(whole + (shifter + Self::splat(1023.0))) << 52);
        exp2 * scale
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.simd_gt(other).bitselect(self, other)
    }
    #[inline(always)]
    fn select_lt(a: Self, b: Self, yes: Self, no: Self) -> Self {
        a.simd_lt(b).bitselect(yes, no)
    }
}

/// Numbers that are read from and written to arrays, [`Packed::WIDTH`] at a time.
pub trait Packed: Real {
    /// Numbers in one.
    const WIDTH: usize;
    /// Reads `from[at..at + WIDTH]`.
    fn load(from: &[f64], at: usize) -> Self;
    /// Writes `to[at..at + WIDTH]`.
    fn store(self, to: &mut [f64], at: usize);
}

impl Packed for f64 {
    const WIDTH: usize = 1;
    #[inline(always)]
    fn load(from: &[f64], at: usize) -> Self {
        from[at]
    }
    #[inline(always)]
    fn store(self, to: &mut [f64], at: usize) {
        to[at] = self;
    }
}

impl Packed for Lanes {
    const WIDTH: usize = LANES;
    #[inline(always)]
    fn load(from: &[f64], at: usize) -> Self {
        let s = &from[at..at + LANES];
        Self::new([s[0], s[1], s[2], s[3]])
    }
    #[inline(always)]
    fn store(self, to: &mut [f64], at: usize) {
        to[at..at + LANES].copy_from_slice(&self.to_array());
    }
}

/// A number with its derivatives with respect to `N` others (forward differentiation).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    /// The value.
    pub value: f64,
    /// Its derivatives.
    pub derivative: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The `n`-th independent variable.
    #[must_use]
    pub fn variable(value: f64, n: usize) -> Self {
        let mut derivative = [0.0; N];
        derivative[n] = 1.0;
        Self { value, derivative }
    }

    #[inline(always)]
    fn chain(self, value: f64, slope: f64) -> Self {
        Self {
            value,
            derivative: self.derivative.map(|d| d * slope),
        }
    }

    #[inline(always)]
    fn combine(self, other: Self, value: f64, a: f64, b: f64) -> Self {
        let mut derivative = [0.0; N];
        for (n, d) in derivative.iter_mut().enumerate() {
            *d = a * self.derivative[n] + b * other.derivative[n];
        }
        Self { value, derivative }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.combine(o, self.value + o.value, 1.0, 1.0)
    }
}
impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.combine(o, self.value - o.value, 1.0, -1.0)
    }
}
impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        self.combine(o, self.value * o.value, o.value, self.value)
    }
}
impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let q = self.value / o.value;
        self.combine(o, q, 1.0 / o.value, -q / o.value)
    }
}
impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl<const N: usize> Real for Dual<N> {
    fn splat(value: f64) -> Self {
        Self {
            value,
            derivative: [0.0; N],
        }
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }
    fn power(self, exponent: f64) -> Self {
        let power = Real::power(self.value, exponent);
        self.chain(power, exponent * power / self.value)
    }
    fn max(self, other: Self) -> Self {
        if self.value > other.value { self } else { other }
    }
    fn select_lt(a: Self, b: Self, yes: Self, no: Self) -> Self {
        if a.value < b.value { yes } else { no }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_is_that_of_the_standard_library_to_round_off() {
        for e in [1.0 / 7.0, 0.2, 2.5, -3.0, 5.0] {
            for step in -400..400 {
                let x = 10.0_f64.powf(f64::from(step) * 0.021);
                let (ours, std) = (Real::power(x, e), x.powf(e));
                // The exponent is rounded before it is raised: the error grows with its size.
                let bound = 4e-16 * (6.0 + (e * x.ln()).abs());
                assert!((ours / std - 1.0).abs() < bound, "{x} ^ {e}: {ours} {std}");
            }
            assert_eq!(Real::power(1.0, e), 1.0);
        }
    }

    #[test]
    fn dual_numbers_differentiate() {
        let f = |x: Dual<1>| ((x * x + Dual::splat(3.0)).sqrt() / x).power(0.3) - x;
        let d = f(Dual::variable(1.7, 0)).derivative[0];
        let h = 1e-6;
        let difference = (f(Dual::variable(1.7 + h, 0)).value - f(Dual::variable(1.7 - h, 0)).value) / (2.0 * h);
        assert!((d - difference).abs() < 1e-9);
    }
}
