//! Where an axis carries ticks, and what is written beside them.

/// Ticks of one axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ticks {
    /// Places in data units, each with its label.
    pub(crate) major: Vec<(f64, String)>,
    /// Places without a label.
    pub(crate) minor: Vec<f64>,
    /// The labels are to be multiplied by ten to this power (0: as they stand).
    pub(crate) power: i32,
}

/// Values beyond this are not drawn: differences of them would overflow.
pub(crate) const LARGEST: f64 = 1e300;

/// The minus sign of typesetting, as wide as a plus.
const MINUS: char = '\u{2212}';

/// `digits` x 10^`exponent` in decimal, exactly.
fn decimal(digits: i128, exponent: i32) -> String {
    let sign = if digits < 0 { MINUS.to_string() } else { String::new() };
    let magnitude = digits.unsigned_abs().to_string();
    if exponent >= 0 {
        let zeros = if digits == 0 { 0 } else { exponent as usize };
        return format!("{sign}{magnitude}{}", "0".repeat(zeros));
    }
    let decimals = exponent.unsigned_abs() as usize;
    let padded = format!("{magnitude:0>width$}", width = decimals + 1);
    let (whole, part) = padded.split_at(padded.len() - decimals);
    format!("{sign}{whole}.{part}")
}

/// A step of 1, 2 or 5 times a power of ten: (digit, exponent), the smallest that gives no more than `count` intervals.
fn nice_step(span: f64, count: usize) -> (i128, i32) {
    let rough = span / count.max(1) as f64;
    let exponent = rough.log10().floor() as i32;
    for digit in [1, 2, 5] {
        // A hair of slack, so that 0..1 in ten intervals is cut at 0.1 although 1/10 is not exact.
        if digit as f64 * power_of_ten(exponent) >= rough * (1.0 - 1e-9) {
            return (digit, exponent);
        }
    }
    (1, exponent + 1)
}

/// Correctly rounded 10^e (`powi` loses digits for large exponents).
fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}")
        .parse()
        .unwrap_or(if exponent < 0 { 0.0 } else { f64::INFINITY })
}

/// The value of `digits` x 10^`exponent`, rounded once.
fn value_of(digits: i128, exponent: i32) -> f64 {
    format!("{digits}e{exponent}").parse().unwrap_or(f64::NAN)
}

/// Limits for data between `lo` and `hi` on a linear axis: `room` (a part of the span) on both sides, ending on half a
/// step, and zero kept as an end where the data begins there.
pub(crate) fn linear_limits(lo: f64, hi: f64, count: usize, room: f64) -> (f64, f64) {
    let (lo, hi) = apart(lo, hi);
    let room = room * (hi - lo);
    let (digit, exponent) = nice_step(hi - lo, count);
    let half = 0.5 * digit as f64 * power_of_ten(exponent);
    // A hair of slack: data that ends on half a step by rounding does not get another one.
    let from = if lo == 0.0 {
        0.0
    } else {
        ((lo - room) / half + 1e-9).floor() * half
    };
    let to = if hi == 0.0 {
        0.0
    } else {
        ((hi + room) / half - 1e-9).ceil() * half
    };
    // Non-negative data does not get a negative axis from its margin.
    (
        if lo > 0.0 { from.max(0.0) } else { from },
        if hi < 0.0 { to.min(0.0) } else { to },
    )
}

/// Two limits that really differ: equal ones (or ones that differ by rounding) are moved apart.
fn apart(lo: f64, hi: f64) -> (f64, f64) {
    let size = lo.abs().max(hi.abs());
    if hi - lo > 1e-12 * size && hi - lo > 1e-290 {
        return (lo, hi);
    }
    let half = if size > 1e-280 { 0.1 * size } else { 1.0 };
    (lo - half, hi + half)
}

/// Limits for positive data on a logarithmic axis: whole decades when it spans more than one and a half.
pub(crate) fn log_limits(lo: f64, hi: f64) -> (f64, f64) {
    let (a, b) = (lo.log10(), hi.log10());
    if b - a > 1.5 {
        // Data that ends a hair above a decade does not buy a whole empty one.
        return (
            power_of_ten((a + 1e-6).floor() as i32),
            power_of_ten((b - 1e-6).ceil() as i32),
        );
    }
    let room = (0.06 * (b - a)).max(if b - a < 1e-9 { 0.3 } else { 0.02 });
    (10f64.powf(a - room), 10f64.powf(b + room))
}

/// Ticks of a linear axis from `lo` to `hi` with about `count` intervals.
pub(crate) fn linear(lo: f64, hi: f64, count: usize) -> Ticks {
    let span = hi - lo;
    let (digit, exponent) = nice_step(span, count);
    let step = digit as f64 * power_of_ten(exponent);
    let slack = 1e-9 * span / step;
    let first = (lo / step - slack).ceil() as i128;
    let last = (hi / step + slack).floor() as i128;
    let largest = (first.abs().max(last.abs()) * digit) as f64 * power_of_ten(exponent);
    let power = if largest >= 1e5 || (largest < 1e-3 && largest > 0.0) {
        (largest.log10() + 1e-9).floor() as i32
    } else {
        0
    };
    // The cap only guards against a range whose ticks cannot be told apart in f64.
    let major = (first..=last)
        .take(4 * count.max(1) + 8)
        .map(|i| (value_of(i * digit, exponent), decimal(i * digit, exponent - power)))
        .collect();
    let parts = if digit == 2 { 4 } else { 5 };
    let fine = step / f64::from(parts);
    let from = (lo / fine - slack).ceil() as i128;
    let to = (hi / fine + slack).floor() as i128;
    let minor = (from..=to)
        .take(40 * count.max(1) + 80)
        .filter(|i| i % i128::from(parts) != 0)
        .map(|i| i as f64 * fine)
        .collect();
    Ticks { major, minor, power }
}

/// Ticks of a logarithmic axis from `lo` to `hi` (both positive) with about `count` labels.
pub(crate) fn log(lo: f64, hi: f64, count: usize) -> Ticks {
    let (a, b) = (lo.log10(), hi.log10());
    let (first, last) = ((a - 1e-9).floor() as i32, (b + 1e-9).floor() as i32);
    let inside = |v: f64| v >= lo * (1.0 - 1e-9) && v <= hi * (1.0 + 1e-9);
    if b - a < 2.0 {
        let all: Vec<(i32, i32)> = (first..=last)
            .flat_map(|e| (1..10).map(move |d| (d, e)))
            .filter(|&(d, e)| inside(value(d, e)))
            .collect();
        for labelled in [&[1, 2, 5][..], &[1, 2, 3, 4, 6, 8]] {
            let (major, minor): (Vec<_>, Vec<_>) = all.iter().partition(|(d, _)| labelled.contains(d));
            if major.len() >= 3 {
                return with_labels(&major, minor.iter().map(|&(d, e)| value(d, e)).collect());
            }
        }
        // Well within a decade the places of a linear axis read better; only positive ones can be meant.
        let mut ticks = linear(lo, hi, count);
        ticks.major.retain(|(v, _)| *v > 0.0);
        ticks.minor.retain(|v| *v > 0.0);
        return ticks;
    }
    let stride = ((last - first).unsigned_abs() as usize).div_ceil(count.max(1)).max(1) as i32;
    let decades = (first..=last).filter(|&e| inside(value(1, e)));
    let (major, between): (Vec<_>, Vec<_>) = decades.map(|e| (1, e)).partition(|(_, e)| e.rem_euclid(stride) == 0);
    let mut minor: Vec<f64> = between.iter().map(|&(d, e)| value(d, e)).collect();
    if stride == 1 && b - a <= 8.0 {
        minor.extend(
            (first..=last)
                .flat_map(|e| (2..10).map(move |d| value(d, e)))
                .filter(|v| inside(*v)),
        );
    }
    with_labels(&major, minor)
}

/// Labels for places `digit` x 10^`exponent`: plain numbers if all are between 0.001 and 1000, else all powers of ten.
fn with_labels(places: &[(i32, i32)], minor: Vec<f64>) -> Ticks {
    let plain = places.iter().all(|(_, e)| (-3..=3).contains(e));
    let label = |digit: i32, exponent: i32| {
        let power = format!("10^{{{}}}", decimal(i128::from(exponent), 0));
        match (plain, digit) {
            (true, _) => decimal(i128::from(digit), exponent),
            (false, 1) => power,
            (false, _) => format!("{digit}\u{b7}{power}"),
        }
    };
    Ticks {
        major: places.iter().map(|&(d, e)| (value(d, e), label(d, e))).collect(),
        minor,
        power: 0,
    }
}

/// `digit` x 10^`exponent`, rounded once.
fn value(digit: i32, exponent: i32) -> f64 {
    value_of(i128::from(digit), exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_exact() {
        assert_eq!(decimal(25, -2), "0.25");
        assert_eq!(decimal(-5, -3), "\u{2212}0.005");
        assert_eq!(decimal(7, 2), "700");
        assert_eq!(decimal(0, 3), "0");
        assert_eq!(decimal(0, -1), "0.0");
    }

    #[test]
    fn linear_ticks_are_few_in_order_and_distinct_over_24_decades() {
        for e in -12..=12 {
            for (a, b) in [(0.0, 1.0), (-3.7, 4.1), (0.93, 0.97), (-1.0, -0.2)] {
                let scale = power_of_ten(e);
                let (lo, hi) = linear_limits(a * scale, b * scale, 6, 0.02);
                assert!(lo <= a * scale && hi >= b * scale, "{lo} {hi} for {a}e{e}..{b}e{e}");
                let ticks = linear(lo, hi, 6);
                assert!((3..=14).contains(&ticks.major.len()), "{ticks:?}");
                assert!(ticks.major.windows(2).all(|w| w[0].0 < w[1].0 && w[0].1 != w[1].1));
                assert!(
                    ticks
                        .major
                        .iter()
                        .all(|(v, _)| *v >= lo - 1e-9 * (hi - lo) && *v <= hi + 1e-9 * (hi - lo))
                );
                assert!(ticks.major.iter().all(|(_, l)| l.chars().count() <= 8), "{ticks:?}");
                for (v, label) in &ticks.major {
                    let read: f64 = label.replace(MINUS, "-").parse().unwrap();
                    assert!(
                        (read * power_of_ten(ticks.power) - v).abs() <= 1e-12 * v.abs(),
                        "{label} for {v}"
                    );
                }
            }
        }
    }

    #[test]
    fn equal_limits_are_moved_apart() {
        for v in [0.0, 1.0, -3.0, 1e-200, 1e200, 5e-324] {
            let (lo, hi) = linear_limits(v, v, 6, 0.02);
            assert!(
                lo < hi && lo <= v && hi >= v && lo.is_finite() && hi.is_finite(),
                "{v}: {lo} {hi}"
            );
            assert!(!linear(lo, hi, 6).major.is_empty());
        }
        let (lo, hi) = log_limits(3.0, 3.0);
        assert!(lo < 3.0 && hi > 3.0);
        assert!(log(lo, hi, 6).major.len() >= 2);
    }

    #[test]
    fn log_ticks_carry_decades_and_thin_out() {
        let (lo, hi) = log_limits(3e-13, 1.0);
        assert_eq!((lo, hi), (1e-13, 1.0));
        let ticks = log(lo, hi, 7);
        assert!((4..=8).contains(&ticks.major.len()), "{ticks:?}");
        assert!(ticks.major.iter().all(|(_, l)| l.starts_with("10^{")), "{ticks:?}");
        let whole = linear_limits(0.0, 10.0, 6, 0.0);
        assert_eq!(whole, (0.0, 10.0));
        let short = log(1.0, 40.0, 6);
        let labels: Vec<_> = short.major.iter().map(|(_, l)| l.as_str()).collect();
        assert_eq!(labels, ["1", "2", "5", "10", "20"]);
        for e in -12..=12 {
            let (lo, hi) = log_limits(power_of_ten(e) * 1.3, power_of_ten(e) * 4.1);
            assert!(log(lo, hi, 6).major.len() >= 2, "decade {e}");
        }
    }
}
