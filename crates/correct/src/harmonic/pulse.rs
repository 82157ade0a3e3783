//! Transfer functions from a pulse or a ramp: the ratio of transforms of response and motion.
//!
//! ```text
//! H(omega) = integral of (y(t) - y(0)) e^{-i omega t} dt / integral of (u(t) - u(0)) e^{-i omega t} dt
//! ```
//!
//! Between steps the histories are taken as straight lines, whose transform is exact (Filon 1928); after the last step
//! they are taken to stay where they are, which for omega > 0 adds y(T) e^{-i omega T} / (i omega). At omega = 0 a motion
//! that returns gives the ratio of the areas, one that does not (a ramp) the ratio of the last values.

use super::Histories;
use crate::HarmonicError;
use dip_dlm::c64;

/// A transfer function at one circular frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Transfer {
    /// Circular frequency, rad/s.
    pub omega_rad_s: f64,
    /// H per channel: response per unit of the motion.
    pub ratio: Vec<c64>,
    /// Standard error of |H| per channel, from what is left of the responses in the last part of the record about a straight
    /// line, and from how far they still move there.
    pub error: Vec<f64>,
    /// |U(omega)| over its largest value at the frequencies asked: what the motion excites there.
    pub excitation: f64,
    /// True where `excitation` is at least [`LEAST_EXCITATION`] and a step turns by less than [`LARGEST_TURN_RAD`].
    pub trusted: bool,
}

/// Least part of the strongest excitation at which a ratio is trusted.
pub const LEAST_EXCITATION: f64 = 0.05;

/// Largest turn of e^{i omega t} in one step at which a ratio is trusted, rad (16 steps a cycle).
pub const LARGEST_TURN_RAD: f64 = std::f64::consts::TAU / 16.0;

/// Part of the record, at its end, that noise and settling are judged by.
const TAIL: f64 = 0.15;

/// Transfer functions of all channels at the frequencies asked (rad/s, zero allowed). `motion` has one value for each
/// instant; it and the responses rest before the first instant.
///
/// # Errors
/// Too few instants, a motion that does not move, negative frequencies, numbers that are not finite.
pub fn transfer(responses: Histories<'_>, motion: &[f64], omega_rad_s: &[f64]) -> Result<Vec<Transfer>, HarmonicError> {
    super::check_times(responses.time_s)?;
    let time_s = responses.time_s;
    let n = time_s.len();
    if responses.values.len() != n || motion.len() != n {
        return Err(HarmonicError::Shape {
            instants: n,
            rows: responses.values.len().min(motion.len()),
            window: 0..n,
        });
    }
    if n < 8 {
        return Err(HarmonicError::TooFew { needed: 8, got: n });
    }
    let channels = responses.values[0].len();
    for (step, row) in responses.values.iter().enumerate() {
        if row.len() != channels {
            return Err(HarmonicError::Channels {
                step,
                needed: channels,
                got: row.len(),
            });
        }
        if let Some(channel) = row.iter().position(|v| !v.is_finite()) {
            return Err(HarmonicError::NotFinite { step, channel });
        }
    }
    let span = motion.iter().fold(0.0_f64, |m, u| m.max((u - motion[0]).abs()));
    if !(span.is_finite() && span > 0.0) {
        return Err(HarmonicError::NoMotion { amplitude: span });
    }
    if let Some(bad) = omega_rad_s.iter().find(|w| !(w.is_finite() && **w >= 0.0)) {
        return Err(HarmonicError::Frequency { omega_rad_s: *bad });
    }
    let returns = (motion[n - 1] - motion[0]).abs() <= 1e-9 * span;
    let columns: Vec<Vec<f64>> = (0..channels)
        .map(|c| responses.values.iter().map(|row| row[c]).collect())
        .collect();
    let tails: Vec<Tail> = columns.iter().map(|y| Tail::of(time_s, y)).collect();
    let inputs: Vec<c64> = omega_rad_s
        .iter()
        .map(|w| transform(time_s, motion, *w, returns))
        .collect();
    // A ramp's transform grows without bound towards zero: its strength is that of its rate.
    let strength = |w: f64, u: c64| if returns || w == 0.0 { u.norm() } else { u.norm() * w };
    let strongest = omega_rad_s
        .iter()
        .zip(&inputs)
        .fold(0.0_f64, |m, (w, u)| m.max(strength(*w, *u)));
    let longest = time_s.windows(2).fold(0.0_f64, |m, w| m.max(w[1] - w[0]));
    let step = (time_s[n - 1] - time_s[0]) / (n - 1) as f64;
    let mut result = Vec::with_capacity(omega_rad_s.len());
    for (&omega, &input) in omega_rad_s.iter().zip(&inputs) {
        let excitation = if strongest > 0.0 {
            strength(omega, input) / strongest
        } else {
            0.0
        };
        let size = input.norm().max(f64::MIN_POSITIVE);
        let ratio = columns.iter().map(|y| transform(time_s, y, omega, returns) / input);
        let error = tails.iter().map(|tail| {
            let noise = if omega == 0.0 && !returns {
                tail.noise
            } else {
                tail.noise * step * (n as f64).sqrt()
            };
            // What has not settled goes on for about as long as the tail again.
            let unsettled = if omega == 0.0 && !returns {
                tail.change
            } else {
                tail.change
                    * tail
                        .duration_s
                        .min(if omega > 0.0 { 1.0 / omega } else { f64::INFINITY })
            };
            (noise.powi(2) + unsettled.powi(2)).sqrt() / size
        });
        result.push(Transfer {
            omega_rad_s: omega,
            ratio: ratio.collect(),
            error: error.collect(),
            excitation,
            trusted: excitation >= LEAST_EXCITATION && omega * longest <= LARGEST_TURN_RAD,
        });
    }
    Ok(result)
}

/// The last part of a history: noise about a straight line, and how far the line moves.
struct Tail {
    noise: f64,
    change: f64,
    duration_s: f64,
}

impl Tail {
    fn of(time_s: &[f64], y: &[f64]) -> Self {
        let n = time_s.len();
        let first = n - ((n as f64 * TAIL).ceil() as usize).clamp(4, n);
        let (t, y) = (&time_s[first..], &y[first..]);
        let m = t.len() as f64;
        let (t_mean, y_mean) = (t.iter().sum::<f64>() / m, y.iter().sum::<f64>() / m);
        let (mut tt, mut ty) = (0.0, 0.0);
        for (t, y) in t.iter().zip(y) {
            tt += (t - t_mean).powi(2);
            ty += (t - t_mean) * (y - y_mean);
        }
        let slope = ty / tt;
        let left: f64 = t
            .iter()
            .zip(y)
            .map(|(t, y)| (y - y_mean - slope * (t - t_mean)).powi(2))
            .sum();
        let duration_s = t[t.len() - 1] - t[0];
        Self {
            noise: (left / (m - 2.0)).sqrt(),
            change: (slope * duration_s).abs(),
            duration_s,
        }
    }
}

/// Transform of y - y(0), straight between the instants and constant after the last one. At omega = 0: the area for a motion
/// that `returns`, else the last value.
fn transform(time_s: &[f64], y: &[f64], omega: f64, returns: bool) -> c64 {
    let n = time_s.len();
    let (base, last) = (y[0], y[n - 1] - y[0]);
    if omega == 0.0 {
        let area: f64 = (1..n)
            .map(|i| 0.5 * (y[i] + y[i - 1] - 2.0 * base) * (time_s[i] - time_s[i - 1]))
            .sum();
        return c64::new(if returns { area } else { last }, 0.0);
    }
    let mut sum = c64::new(0.0, 0.0);
    for i in 1..n {
        let h = time_s[i] - time_s[i - 1];
        let middle = 0.5 * (time_s[i] + time_s[i - 1]) - time_s[0];
        let (mean, half) = (0.5 * (y[i] + y[i - 1]) - base, 0.5 * (y[i] - y[i - 1]));
        let turn = 0.5 * omega * h;
        // Over one interval: h [mean sin(x)/x - i half (sin(x)/x - cos(x))/x], x = omega h / 2.
        let (even, odd) = if turn < 1e-3 {
            let x2 = turn * turn;
            (1.0 - x2 / 6.0, turn / 3.0 * (1.0 - x2 / 10.0))
        } else {
            (turn.sin() / turn, (turn.sin() / turn - turn.cos()) / turn)
        };
        sum += c64::from_polar(h, -omega * middle) * c64::new(mean * even, -half * odd);
    }
    let end = time_s[n - 1] - time_s[0];
    sum + c64::from_polar(last, -omega * end) / c64::new(0.0, omega)
}
