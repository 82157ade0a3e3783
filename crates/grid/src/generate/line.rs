//! Spreads nodes along a curve by arc length.

use super::spacing::{geometric, geometric_rate};

/// Parameters of `n + 1` points on `curve`, p from 0 to `end`, with the first step `first` (an arc length) and one
/// growth ratio, and that ratio.
///
/// The curve is measured at points that crowd at p = 0 down to a fraction of the first step.
pub(super) fn spread<const D: usize>(
    curve: impl Fn(f64) -> [f64; D],
    end: f64,
    n: usize,
    first: f64,
) -> (Vec<f64>, f64) {
    const SAMPLES: usize = 72;
    // Samples grow by a ratio of exp(crowding / SAMPLES); the smallest is end exp(-crowding).
    let crowding = 18.0f64;
    let sample = |m: usize| end * (crowding * m as f64 / SAMPLES as f64).exp_m1() / crowding.exp_m1();
    let p: Vec<f64> = (0..=SAMPLES).map(sample).collect();
    let mut s = vec![0.0; SAMPLES + 1];
    let mut last = curve(0.0);
    for m in 1..=SAMPLES {
        // Two chords with one step of Richardson's extrapolation: the arc to fourth order.
        let middle = curve(0.5 * (p[m - 1] + p[m]));
        let next = curve(p[m]);
        let (halves, whole) = (gap(last, middle) + gap(middle, next), gap(last, next));
        s[m] = s[m - 1] + halves + (halves - whole) / 3.0;
        last = next;
    }
    let length = s[SAMPLES];
    let slope = monotone_slopes(&s, &p);
    let at = |wanted: f64| {
        let m = s.partition_point(|&v| v <= wanted).clamp(1, SAMPLES) - 1;
        let h = s[m + 1] - s[m];
        let u = (wanted - s[m]) / h;
        let (u2, u3) = (u * u, u * u * u);
        (2.0 * u3 - 3.0 * u2 + 1.0) * p[m]
            + (u3 - 2.0 * u2 + u) * h * slope[m]
            + (3.0 * u2 - 2.0 * u3) * p[m + 1]
            + (u3 - u2) * h * slope[m + 1]
    };
    let mut out: Vec<f64> = geometric(n, first, length).into_iter().map(at).collect();
    out[0] = 0.0;
    out[n] = end;
    (out, geometric_rate(n, first, length).exp())
}

fn gap<const D: usize>(p: [f64; D], q: [f64; D]) -> f64 {
    p.iter().zip(q).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Slopes dp/ds for a monotone cubic (Fritsch and Butland, SIAM J. Sci. Stat. Comp. 5, 1984: the weighted harmonic
/// mean).
fn monotone_slopes(s: &[f64], p: &[f64]) -> Vec<f64> {
    let n = s.len();
    let rise = |m: usize| (p[m + 1] - p[m]) / (s[m + 1] - s[m]).max(f64::MIN_POSITIVE);
    let mut slope = vec![0.0; n];
    for m in 1..n - 1 {
        let (h0, h1) = (s[m] - s[m - 1], s[m + 1] - s[m]);
        let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
        slope[m] = (w0 + w1) / (w0 / rise(m - 1) + w1 / rise(m));
    }
    slope[0] = rise(0);
    slope[n - 1] = rise(n - 2);
    slope
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_on_a_circle_and_on_a_square_root_have_the_asked_arc_lengths() {
        let circle = |p: f64| [2.0 * (1.0 - p.cos()), 2.0 * p.sin()];
        let (p, ratio) = spread(circle, 1.5, 30, 1e-5);
        for m in 1..30 {
            let arc = |m: usize| 2.0 * (p[m + 1] - p[m]);
            assert!((arc(m) / arc(m - 1) / ratio - 1.0).abs() < 2e-3, "{m}");
        }
        assert!((2.0 * p[1] / 1e-5 - 1.0).abs() < 1e-3);
        // s = p^2: the line from the edge of a plate.
        let (p, _) = spread(|p| [p * p, 0.0], 3.0, 40, 1e-6);
        assert!((p[1] * p[1] / 1e-6 - 1.0).abs() < 0.05, "{}", p[1] * p[1]);
    }
}
