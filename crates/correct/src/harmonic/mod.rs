//! Harmonics of sampled histories by least squares over whole cycles.
//!
//! The model of a channel is
//!
//! ```text
//! y(t) = mean + drift (t - t_mid) + sum over f, n of Re( A_fn exp(i n omega_f (t - t0)) )
//! ```
//!
//! with t0 the explicit phase origin: Re(A e^{i theta}) = Re A cos theta - Im A sin theta. All unknowns are found together,
//! so that steps need not divide a cycle and several frequencies need not be orthogonal in the window. What a channel does
//! per unit of the motion is [`Fit::per_unit_of`]: there the motion's own sine, cosine, phase and amplitude drop out.

mod basis;
pub mod pulse;

use crate::HarmonicError;
use basis::Basis;
use dip_dlm::c64;
use std::ops::Range;

/// Histories of several channels at the same instants.
#[derive(Clone, Copy, Debug)]
pub struct Histories<'a> {
    /// Instants, s, rising.
    pub time_s: &'a [f64],
    /// Values `[step][channel]`, one row for each instant.
    pub values: &'a [Vec<f64>],
}

/// What is fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Fundamental circular frequencies, rad/s; one or more.
    pub omega_rad_s: Vec<f64>,
    /// Harmonics of each: 1 is the fundamental alone.
    pub harmonics: usize,
    /// Whether a drift, linear in time, is fitted beside the mean.
    pub drift: bool,
    /// Instant from which phases count, s.
    pub phase_origin_s: f64,
}

/// What a fit gives. Amplitudes are `[frequency][harmonic - 1][channel]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Mean in the middle of the window, per channel.
    pub mean: Vec<f64>,
    /// Drift, per second, per channel; zero where none was fitted.
    pub drift_per_s: Vec<f64>,
    /// Complex amplitudes A of Re(A e^{i n omega (t - t0)}).
    pub amplitude: Vec<Vec<Vec<c64>>>,
    /// Root mean square of what the model leaves, per channel.
    pub residual_rms: Vec<f64>,
    /// Ratio of the largest to the smallest diagonal of the triangular factor: an estimate of the fit's condition.
    pub condition: f64,
}

/// Windows of whole cycles of `omega_rad_s`, counted back from the last instant, oldest first. Each window holds the
/// instants in (end - T, end], so that a cycle divided into N steps holds N of them; what is left at the start is dropped.
///
/// # Errors
/// Fewer than two instants, instants that do not rise, a frequency that is not positive, or not one whole cycle.
pub fn whole_cycles(time_s: &[f64], omega_rad_s: f64) -> Result<Vec<Range<usize>>, HarmonicError> {
    check_times(time_s)?;
    if !(omega_rad_s.is_finite() && omega_rad_s > 0.0) {
        return Err(HarmonicError::Frequency { omega_rad_s });
    }
    let period = std::f64::consts::TAU / omega_rad_s;
    let (first, last) = (time_s[0], time_s[time_s.len() - 1]);
    let step = (last - first) / (time_s.len() - 1) as f64;
    // Round-off of instants that are multiples of a step is not a missing cycle; nor is the step before the first instant.
    let slack = 1e-6 * step;
    let count = ((last - first + step + slack) / period).floor();
    if count < 1.0 {
        return Err(HarmonicError::NoWholeCycle {
            period_s: period,
            recorded_s: last - first,
        });
    }
    let at = |cycle: f64| time_s.partition_point(|t| *t <= last - cycle * period + slack);
    // A record of many more cycles than steps is a wrong frequency; least squares refuses it, here it only must not run away.
    let count = count.min(time_s.len() as f64) as usize;
    Ok((0..count).rev().map(|c| at(c as f64 + 1.0)..at(c as f64)).collect())
}

fn check_times(time_s: &[f64]) -> Result<(), HarmonicError> {
    if time_s.len() < 2 {
        return Err(HarmonicError::TooFew {
            needed: 2,
            got: time_s.len(),
        });
    }
    match time_s.windows(2).position(|w| !(w[1] > w[0] && w[1].is_finite())) {
        Some(at) => Err(HarmonicError::Times {
            step: at + 1,
            before_s: time_s[at],
            got_s: time_s[at + 1],
        }),
        None => Ok(()),
    }
}

/// Fits the model to the instants of `window`.
///
/// # Errors
/// Too few instants, instants that do not rise, frequencies that can't be told apart in the window, values that are not
/// finite, rows of different length.
pub fn fit(histories: Histories<'_>, window: Range<usize>, model: &Model) -> Result<Fit, HarmonicError> {
    let bad_window = window.start >= window.end || window.end > histories.time_s.len();
    if bad_window || histories.values.len() != histories.time_s.len() {
        return Err(HarmonicError::Shape {
            instants: histories.time_s.len(),
            rows: histories.values.len(),
            window,
        });
    }
    check_times(histories.time_s)?;
    let (time_s, rows) = (&histories.time_s[window.clone()], &histories.values[window.clone()]);
    let channels = rows[0].len();
    for (row, number) in rows.iter().zip(window.start..) {
        if row.len() != channels {
            return Err(HarmonicError::Channels {
                step: number,
                needed: channels,
                got: row.len(),
            });
        }
        if let Some(channel) = row.iter().position(|v| !v.is_finite()) {
            return Err(HarmonicError::NotFinite { step: number, channel });
        }
    }
    let basis = Basis::new(time_s, model)?;
    let unknowns = basis.unknowns();
    // Coefficients [unknown][channel], summed step by step: one order whatever the number of threads.
    let mut coefficients = vec![vec![0.0; channels]; unknowns];
    for (i, row) in rows.iter().enumerate() {
        for (j, sums) in coefficients.iter_mut().enumerate() {
            let weight = basis.inverse(j, i);
            for (sum, value) in sums.iter_mut().zip(row) {
                *sum += weight * value;
            }
        }
    }
    let mut residual = vec![0.0; channels];
    for (i, row) in rows.iter().enumerate() {
        for (c, (sum, value)) in residual.iter_mut().zip(row).enumerate() {
            let fitted: f64 = coefficients
                .iter()
                .enumerate()
                .map(|(j, a)| basis.value(j, i) * a[c])
                .sum();
            *sum += (value - fitted).powi(2);
        }
    }
    let n = rows.len() as f64;
    let drift_per_s = basis.drift().map_or_else(
        || vec![0.0; channels],
        |(j, scale)| coefficients[j].iter().map(|a| a / scale).collect(),
    );
    let amplitude = (0..model.omega_rad_s.len())
        .map(|f| {
            (1..=model.harmonics)
                .map(|h| {
                    let (cos, sin) = basis.pair(f, h);
                    let parts = coefficients[cos].iter().zip(&coefficients[sin]);
                    parts.map(|(c, s)| c64::new(*c, -s)).collect()
                })
                .collect()
        })
        .collect();
    Ok(Fit {
        mean: coefficients[0].clone(),
        drift_per_s,
        amplitude,
        residual_rms: residual.iter().map(|r| (r / n).sqrt()).collect(),
        condition: basis.condition(),
    })
}

impl Fit {
    /// Harmonic `n` (from 1) of frequency `f` of all channels per unit of the motion's own complex fundamental `motion`:
    /// A_n / (|motion| (motion / |motion|)^n). For the fundamental it is the plain ratio; for the others time is moved so
    /// that the motion is a cosine, and the amplitude stays per unit. The motion's sine, cosine and phase drop out.
    ///
    /// # Errors
    /// A motion of no amplitude, or a harmonic that was not fitted.
    pub fn per_unit_of(&self, motion: c64, f: usize, n: usize) -> Result<Vec<c64>, HarmonicError> {
        let size = motion.norm();
        if !(size.is_finite() && size > 0.0) {
            return Err(HarmonicError::NoMotion { amplitude: size });
        }
        let Some(column) = self.amplitude.get(f).and_then(|a| a.get(n.wrapping_sub(1))) else {
            return Err(HarmonicError::NotFitted {
                frequency: f,
                harmonic: n,
            });
        };
        let turn = (motion / size).powi(i32::try_from(n).unwrap_or(i32::MAX)) * size;
        Ok(column.iter().map(|a| a / turn).collect())
    }
}

/// Change from one cycle to the next, relative to the size of the later one: norm over all channels.
#[must_use]
pub fn relative_change(before: &[c64], after: &[c64]) -> f64 {
    let change: f64 = before.iter().zip(after).map(|(a, b)| (a - b).norm_sqr()).sum();
    let size: f64 = after.iter().map(c64::norm_sqr).sum();
    if size > 0.0 {
        (change / size).sqrt()
    } else if change > 0.0 {
        f64::INFINITY
    } else {
        0.0
    }
}
