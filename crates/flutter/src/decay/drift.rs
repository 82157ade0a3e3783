//! What a record holds beside its oscillations: how a structure goes away when it diverges, slowly where the stream is little
//! faster than needed, long after its oscillations have died.

use super::DecayFit;

/// Part of its largest elastic energy below which a motion has died out: what would diverge had a part in the beginning of
/// it, and that would be left.
const FADED: f64 = 1e-5;

/// Errors of a rate from which its sign is sure. What a flow remembers of the start decays ever more slowly: half the change from
/// quarter to quarter is the error of the rate, so four of them are what the rate may yet change in as long again.
const SURE: f64 = 4.0;

/// Whether the motion of `record` `[coordinate][sample]` about the position of equilibrium has died out in the last quarter;
/// `stiffness` of each coordinate weighs it.
#[must_use]
pub fn has_faded(record: &[Vec<f64>], stiffness: &[f64]) -> bool {
    let samples = record.first().map_or(0, Vec::len);
    let (mut largest, mut last) = (0.0_f64, 0.0_f64);
    for i in 0..samples {
        let energy: f64 = record.iter().zip(stiffness).map(|(q, k)| k * q[i] * q[i]).sum();
        largest = largest.max(energy);
        if i >= samples - samples / 4 {
            last = last.max(energy);
        }
    }
    last < FADED * largest
}

/// The part of a motion that does not oscillate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Rate at which it grows, 1/s, over the second half of the record.
    pub rate_1_s: f64,
    /// Standard error of the rate; infinite where the drift changes its sign in that half.
    pub rate_error_1_s: f64,
    /// Its part of the elastic energy in the last quarter of the record.
    pub share: f64,
}

impl Drift {
    /// Whether it is sure to die out.
    #[must_use]
    pub fn dies(&self) -> bool {
        self.rate_1_s + SURE * self.rate_error_1_s < 0.0
    }

    /// Whether it is sure to grow.
    #[must_use]
    pub fn grows(&self) -> bool {
        self.rate_1_s > SURE * self.rate_error_1_s
    }

    /// The drift of `record` `[coordinate][sample]` about the position of equilibrium, `dt_s` apart: what is left without the
    /// modes of `fit` that oscillate at `lowest_rad_s` or faster. `stiffness` of each coordinate weighs it. None for a record
    /// too short for two halves of a half.
    ///
    /// The rate is the slope of the logarithm of the drift's size along its mean shape. Its error is that of the straight line, or
    /// half the difference between the slopes of the two quarters where that is more: a transient has no one rate.
    #[must_use]
    pub fn of(record: &[Vec<f64>], dt_s: f64, fit: &DecayFit, lowest_rad_s: f64, stiffness: &[f64]) -> Option<Self> {
        let samples = record.first()?.len();
        let half = samples / 2;
        if samples - half < 8 {
            return None;
        }
        let fast: Vec<_> = fit.modes.iter().filter(|m| m.p_rad_s.im >= lowest_rad_s).collect();
        let mut energy = [0.0; 2];
        // The record without its fast part `[coordinate][sample]`.
        let mut slow = record.to_vec();
        for ((c, rest), k) in slow.iter_mut().enumerate().zip(stiffness) {
            for (i, rest) in rest.iter_mut().enumerate() {
                let t = i as f64 * dt_s;
                let oscillation: f64 = fast.iter().map(|m| (m.amplitude[c] * (m.p_rad_s * t).exp()).re).sum();
                *rest -= oscillation;
                if i >= samples - samples / 4 {
                    energy[0] += k * *rest * *rest;
                    energy[1] += k * oscillation * oscillation;
                }
            }
        }
        let whole = energy[0] + energy[1];
        let share = if whole > 0.0 { energy[0] / whole } else { 0.0 };
        let unknown = Self {
            rate_1_s: 0.0,
            rate_error_1_s: f64::INFINITY,
            share,
        };
        let mean: Vec<f64> = slow.iter().map(|s| s[half..].iter().sum()).collect();
        let logarithms: Vec<f64> = (half..samples)
            .map(|i| {
                let along = mean.iter().zip(stiffness).zip(&slow);
                along.map(|((m, k), s)| k * m * s[i]).sum::<f64>().ln()
            })
            .collect();
        // The logarithm of what is not above zero is no number.
        if !logarithms.iter().all(|l| l.is_finite()) {
            return Some(unknown);
        }
        let quarter = logarithms.len() / 2;
        let (rate, error) = slope(&logarithms, dt_s);
        let (early, _) = slope(&logarithms[..quarter], dt_s);
        let (late, _) = slope(&logarithms[quarter..], dt_s);
        Some(Self {
            rate_1_s: rate,
            rate_error_1_s: error.max(0.5 * (late - early).abs()),
            share,
        })
    }
}

/// Slope of a straight line through values `dt` apart, and its standard error.
fn slope(values: &[f64], dt: f64) -> (f64, f64) {
    let n = values.len() as f64;
    let middle = 0.5 * (n - 1.0);
    let mean = values.iter().sum::<f64>() / n;
    let (mut xx, mut xy) = (0.0, 0.0);
    for (i, v) in values.iter().enumerate() {
        let x = i as f64 - middle;
        xx += x * x;
        xy += x * (v - mean);
    }
    let slope = xy / xx;
    let rest: f64 = values
        .iter()
        .enumerate()
        .map(|(i, v)| (v - mean - slope * (i as f64 - middle)).powi(2))
        .sum();
    (slope / dt, (rest / ((n - 2.0) * xx)).sqrt() / dt)
}
