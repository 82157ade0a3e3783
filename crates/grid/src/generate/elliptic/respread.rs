//! Spreads the nodes of a line anew, along the curve through them.

use super::distance;
use crate::generate::spacing::geometric;

/// Nodes of a line spread anew: the curve through `old`, with the first step `first` and one growth ratio.
pub(super) fn respread<const D: usize>(old: &[[f64; D]], first: f64) -> Vec<[f64; D]> {
    let last = old.len() - 1;
    let mut arc = vec![0.0; last + 1];
    for j in 1..=last {
        arc[j] = arc[j - 1] + distance(old[j - 1], old[j]);
    }
    let wanted = geometric(last, first, arc[last]);
    let mut new = old.to_vec();
    for (j, &wanted) in wanted.iter().enumerate().take(last).skip(1) {
        let m = arc.partition_point(|&s| s <= wanted).clamp(1, last) - 1;
        new[j] = cubic(old, &arc, m, wanted);
    }
    new
}

/// The curve through `points` at arc length `s`, which lies in interval m: a cubic with slopes of the parabola through three
/// points, in arc length.
fn cubic<const D: usize>(points: &[[f64; D]], arc: &[f64], m: usize, s: f64) -> [f64; D] {
    let last = points.len() - 1;
    let chord = |a: usize| -> [f64; D] {
        let h = (arc[a + 1] - arc[a]).max(f64::MIN_POSITIVE);
        std::array::from_fn(|d| (points[a + 1][d] - points[a][d]) / h)
    };
    let slope = |n: usize| -> [f64; D] {
        if n == 0 {
            return chord(0);
        }
        if n == last {
            return chord(last - 1);
        }
        let (h0, h1) = (arc[n] - arc[n - 1], arc[n + 1] - arc[n]);
        let (c0, c1) = (chord(n - 1), chord(n));
        let w = h1 / (h0 + h1);
        std::array::from_fn(|d| w * c0[d] + (1.0 - w) * c1[d])
    };
    let h = (arc[m + 1] - arc[m]).max(f64::MIN_POSITIVE);
    let u = (s - arc[m]) / h;
    let (u2, u3) = (u * u, u * u * u);
    let (sa, sb) = (slope(m), slope(m + 1));
    std::array::from_fn(|d| {
        (2.0 * u3 - 3.0 * u2 + 1.0) * points[m][d]
            + (u3 - 2.0 * u2 + u) * h * sa[d]
            + (3.0 * u2 - 2.0 * u3) * points[m + 1][d]
            + (u3 - u2) * h * sb[d]
    })
}
