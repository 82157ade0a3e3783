//! How points are spread along a line.

/// `n + 1` values from 0 to `length` whose first step is `first` and whose steps grow by one constant ratio.
///
/// The ratio is what remains to be found: `first (r^n - 1)/(r - 1) = length`, by bisection on ln r.
#[must_use]
pub fn geometric(n: usize, first: f64, length: f64) -> Vec<f64> {
    let n = n.max(1);
    let rate = geometric_rate(n, first, length);
    let total = series(n, rate);
    (0..=n)
        .map(|m| {
            if m == n {
                length
            } else {
                length * series(m, rate) / total
            }
        })
        .collect()
}

/// The growth ratio of [`geometric`].
#[must_use]
pub fn geometric_ratio(n: usize, first: f64, length: f64) -> f64 {
    geometric_rate(n.max(1), first, length).exp()
}

pub(super) fn geometric_rate(n: usize, first: f64, length: f64) -> f64 {
    let wanted = (length / first).ln();
    let (mut lo, mut hi) = (-20.0 / n as f64, 3.0f64);
    for _ in 0..200 {
        let mid = 0.5 * (lo + hi);
        if series(n, mid).ln() < wanted {
            lo = mid;
        } else {
            hi = mid;
        }
        if hi - lo < 1e-15 {
            break;
        }
    }
    0.5 * (lo + hi)
}

/// `1 + r + ... + r^(m-1)` with `r = exp(rate)`.
fn series(m: usize, rate: f64) -> f64 {
    if (rate * m as f64).abs() < 1e-9 {
        return m as f64;
    }
    (rate * m as f64).exp_m1() / rate.exp_m1()
}

/// `n + 1` values from 0 to 1 whose first and last steps are close to `first` and `last`.
///
/// M. Vinokur, On One-Dimensional Stretching Functions for Finite-Difference Calculations, J. Comp. Phys. 50 (1983),
/// the two-sided function: `u = 1/2 (1 + tanh(d (m/n - 1/2)) / tanh(d/2))`, `s = u / (A + (1 - A) u)`,
/// `A = sqrt(last/first)`, and `sinh d / d = 1 / (n sqrt(first last))`
/// (`tan` and `sin` where that is below one).
#[must_use]
pub fn two_sided(n: usize, first: f64, last: f64) -> Vec<f64> {
    let n = n.max(1);
    let ratio = 1.0 / (n as f64 * (first * last).sqrt());
    let a = (last / first).sqrt();
    let value = |m: usize| {
        let centred = m as f64 / n as f64 - 0.5;
        let u = if ratio > 1.000_001 {
            let d = solve(ratio, |d| d.sinh() / d, 1e-6, 60.0);
            0.5 * (1.0 + (d * centred).tanh() / (0.5 * d).tanh())
        } else if ratio < 0.999_999 {
            // sin d / d falls from 1 to 0 on 0..pi.
            let d = solve(-ratio.max(0.05), |d| -d.sin() / d, 1e-6, std::f64::consts::PI);
            0.5 * (1.0 + (d * centred).tan() / (0.5 * d).tan())
        } else {
            0.5 + centred
        };
        u / (a + (1.0 - a) * u)
    };
    let mut out: Vec<f64> = (0..=n).map(value).collect();
    out[0] = 0.0;
    out[n] = 1.0;
    out
}

/// Root of `f(d) = wanted` for a rising `f`.
fn solve(wanted: f64, f: impl Fn(f64) -> f64, mut lo: f64, mut hi: f64) -> f64 {
    for _ in 0..100 {
        let mid = 0.5 * (lo + hi);
        if f(mid) < wanted { lo = mid } else { hi = mid }
    }
    0.5 * (lo + hi)
}

/// The largest ratio between neighbouring steps, either way.
#[must_use]
pub fn largest_ratio(values: &[f64]) -> f64 {
    values
        .windows(3)
        .map(|v| {
            let (a, b) = (v[1] - v[0], v[2] - v[1]);
            (a / b).max(b / a)
        })
        .fold(1.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn geometric_meets_first_step_length_and_ratio() {
        for (n, first, length) in [(40, 1e-6, 15.0), (10, 0.1, 1.0), (8, 0.5, 1.0), (1, 1.0, 1.0)] {
            let s = geometric(n, first, length);
            assert_eq!(s[n], length);
            assert!(((s[1] - s[0]) / first - 1.0).abs() < 1e-9);
            let r = geometric_ratio(n, first, length);
            for m in 1..n {
                assert!(((s[m + 1] - s[m]) / (s[m] - s[m - 1]) / r - 1.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn two_sided_comes_close_to_both_steps_and_rises() {
        for (n, a, b) in [(64, 1e-3, 5e-3), (32, 0.05, 0.05), (40, 1e-4, 1e-2), (10, 0.2, 0.2)] {
            let s = two_sided(n, a, b);
            assert!(s.windows(2).all(|v| v[1] > v[0]));
            assert!(((s[1] - s[0]) / a - 1.0).abs() < 0.25, "{n} {a} {}", s[1] - s[0]);
            assert!(((s[n] - s[n - 1]) / b - 1.0).abs() < 0.25);
        }
    }
}
