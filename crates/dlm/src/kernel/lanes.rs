//! Exponential, sine and cosine without branches or calls, so that loops over many points become vector code.
//!
//! Range reduction by adding 1.5 * 2^52 (the sum's low bits then hold the integer) and Cody-Waite steps with fused
//! multiply-add; Taylor polynomials long enough for a relative error of some 2e-16 on the reduced range (Muller,
//! Elementary Functions, chapters 4 and 11).

/// 1.5 * 2^52: adding it rounds to an integer that sits in the low bits.
const MAGIC: f64 = 6_755_399_441_055_744.0;

/// exp(x) for x <= 0; below -700 it returns exp(-700), about 1e-304, which all users of it treat as nothing.
#[inline(always)]
pub(super) fn exp_negative(x: f64) -> f64 {
    const LN2_HIGH: f64 = 0.693_147_180_369_123_8;
    const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    let x = if x > -700.0 { x } else { -700.0 };
    let shifted = x.mul_add(std::f64::consts::LOG2_E, MAGIC);
    let n = shifted - MAGIC;
    let r = (-n).mul_add(LN2_LOW, (-n).mul_add(LN2_HIGH, x));
    // Taylor to r^12: |r| <= ln2 / 2 leaves 2e-16.
    let p = 1.0 / 479_001_600.0;
    let p = r.mul_add(p, 1.0 / 39_916_800.0);
    let p = r.mul_add(p, 1.0 / 3_628_800.0);
    let p = r.mul_add(p, 1.0 / 362_880.0);
    let p = r.mul_add(p, 1.0 / 40_320.0);
    let p = r.mul_add(p, 1.0 / 5_040.0);
    let p = r.mul_add(p, 1.0 / 720.0);
    let p = r.mul_add(p, 1.0 / 120.0);
    let p = r.mul_add(p, 1.0 / 24.0);
    let p = r.mul_add(p, 1.0 / 6.0);
    let p = r.mul_add(p, 0.5);
    let p = r.mul_add(p, 1.0);
    let p = r.mul_add(p, 1.0);
    let scale = f64::from_bits((shifted.to_bits() << 52).wrapping_add(1023 << 52));
    p * scale
}

/// (sin x, cos x) for |x| below about 1e8.
#[inline(always)]
pub(super) fn sin_cos(x: f64) -> (f64, f64) {
    const HALF_PI_1: f64 = 1.570_796_326_734_125_6;
    const HALF_PI_2: f64 = 6.077_100_506_303_966e-11;
    const HALF_PI_3: f64 = 2.022_266_248_795_950_6e-21;
    let shifted = x.mul_add(std::f64::consts::FRAC_2_PI, MAGIC);
    let n = shifted - MAGIC;
    let bits = shifted.to_bits();
    let r = (-n).mul_add(HALF_PI_1, x);
    let r = (-n).mul_add(HALF_PI_2, r);
    let r = (-n).mul_add(HALF_PI_3, r);
    let s = r * r;
    let p = -1.0 / 1_307_674_368_000.0;
    let p = s.mul_add(p, 1.0 / 6_227_020_800.0);
    let p = s.mul_add(p, -1.0 / 39_916_800.0);
    let p = s.mul_add(p, 1.0 / 362_880.0);
    let p = s.mul_add(p, -1.0 / 5_040.0);
    let p = s.mul_add(p, 1.0 / 120.0);
    let p = s.mul_add(p, -1.0 / 6.0);
    let sine = (s * r).mul_add(p, r);
    let q = 1.0 / 20_922_789_888_000.0;
    let q = s.mul_add(q, -1.0 / 87_178_291_200.0);
    let q = s.mul_add(q, 1.0 / 479_001_600.0);
    let q = s.mul_add(q, -1.0 / 3_628_800.0);
    let q = s.mul_add(q, 1.0 / 40_320.0);
    let q = s.mul_add(q, -1.0 / 720.0);
    let q = s.mul_add(q, 1.0 / 24.0);
    let q = s.mul_add(q, -0.5);
    let cosine = s.mul_add(q, 1.0);
    // Quadrant n mod 4: odd ones swap, then signs.
    let swap = (bits & 1) != 0;
    let (a, b) = if swap { (cosine, sine) } else { (sine, cosine) };
    let sine_sign = (bits & 2) << 62;
    let cosine_sign = (bits.wrapping_add(1) & 2) << 62;
    (
        f64::from_bits(a.to_bits() ^ sine_sign),
        f64::from_bits(b.to_bits() ^ cosine_sign),
    )
}

#[cfg(test)]
mod tests {
    use super::{exp_negative, sin_cos};

    #[test]
    fn exponential_agrees_with_the_library() {
        for i in 0..200_000 {
            let x = -f64::from(i) * 3.3e-3;
            let exact = x.exp();
            assert!((exp_negative(x) - exact).abs() <= 4e-16 * exact, "exp({x})");
        }
        assert!(exp_negative(-1e300) < 1e-300);
    }

    #[test]
    fn sine_and_cosine_agree_with_the_library() {
        for i in -100_000..100_000 {
            for scale in [1e-9, 1.3e-4, 7.7e-2, 31.0] {
                let x = f64::from(i) * scale;
                let (s, c) = sin_cos(x);
                let (es, ec) = x.sin_cos();
                assert!((s - es).abs() <= 3e-16, "sin({x}): {s} {es}");
                assert!((c - ec).abs() <= 3e-16, "cos({x}): {c} {ec}");
                if x.abs() < 0.5 {
                    assert!((s - es).abs() <= 3e-16 * es.abs(), "sin({x}) relative");
                }
            }
        }
    }
}
