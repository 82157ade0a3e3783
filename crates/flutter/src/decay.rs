//! Damping and frequency of modes from time histories of all generalized coordinates.
//!
//! Two steps. A subspace fit (block Hankel matrix, singular value decomposition, shift invariance: Juang and Pappa's
//! eigensystem realization, J. Guidance 8(5) 1985; the same as the matrix pencil of Hua and Sarkar 1990) finds how many
//! exponentials the record holds and where. Then least squares on
//!
//! ```text
//! q_c(t) = offset_c + sum_j Re(a_cj e^{p_j t}),   p_j = sigma_j + i omega_j
//! ```
//!
//! by variable projection (Golub and Pereyra 1973, with Kaufman's Jacobian) makes it the maximum-likelihood answer for
//! white noise and gives standard errors, from which follows how sure the sign of each damping is.

mod drift;
mod limit_cycle;
mod noise;
mod projection;
mod subspace;
mod watch;

use std::sync::OnceLock;

use faer::c64;

use crate::error::{FlutterError, Result, check_value};
pub use drift::{Drift, has_faded};
pub use limit_cycle::{LimitCycle, limit_cycle};
use projection::Projection;
use subspace::subspace;
pub use watch::{Growth, Reading, Watch, WatchSettings, WatchedMode};

/// How a record is analysed. The defaults suit a march of one to ten cycles.
#[derive(Debug, Clone, PartialEq)]
pub struct DecaySettings {
    /// Greatest number of exponentials (an oscillating mode is two); `None`: two per channel and four more.
    pub max_order: Option<usize>,
    /// Whether every channel may have a constant offset (a static deflection).
    pub offset: bool,
    /// Iterations of the least-squares step; 0 leaves the subspace answer and gives no standard errors.
    pub iterations: usize,
}

impl Default for DecaySettings {
    fn default() -> Self {
        Self {
            max_order: None,
            offset: true,
            iterations: 20,
        }
    }
}

/// One oscillating mode of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct DecayMode {
    /// p = sigma + i omega, rad/s; sigma > 0 grows.
    pub p_rad_s: c64,
    /// Frequency, Hz.
    pub freq_hz: f64,
    /// g = 2 sigma / omega, positive growing.
    pub g: f64,
    /// Standard error of sigma, rad/s, for the noise that the fit leaves (with its correlation in time).
    pub sigma_error_rad_s: f64,
    /// Standard error of omega, rad/s.
    pub omega_error_rad_s: f64,
    /// Probability that the sign of the damping is right, 0.5 to 1.
    pub confidence: f64,
    /// Complex amplitude of each channel at the first sample.
    pub amplitude: Vec<c64>,
    /// Part of the record's energy (sum of squares, each channel scaled to its rms) that the mode holds alone.
    pub energy: f64,
}

/// A motion of a record that does not oscillate.
#[derive(Debug, Clone, PartialEq)]
pub struct DecayRoot {
    /// Rate, 1/s; above zero it grows.
    pub rate_1_s: f64,
    /// Its standard error, 1/s.
    pub rate_error_1_s: f64,
    /// Amplitude of each channel at the first sample.
    pub amplitude: Vec<f64>,
}

/// What a record holds.
#[derive(Debug, Clone, PartialEq)]
pub struct DecayFit {
    /// Oscillating modes, most energy first.
    pub modes: Vec<DecayMode>,
    /// Exponentials that do not oscillate.
    pub roots: Vec<DecayRoot>,
    /// Offset of each channel.
    pub offsets: Vec<f64>,
    /// Rms of what the fit leaves over the rms of the record, channels scaled to their rms.
    pub residual: f64,
    /// Singular values of the Hankel matrix, for a plot of the gap.
    pub singular_values: Vec<f64>,
}

impl DecayFit {
    /// The mode that grows fastest (or decays slowest) among those with at least `energy` of the record.
    #[must_use]
    pub fn least_stable(&self, energy: f64) -> Option<&DecayMode> {
        self.modes
            .iter()
            .filter(|m| m.energy >= energy)
            .max_by(|a, b| a.p_rad_s.re.total_cmp(&b.p_rad_s.re))
    }
}

/// Identifies modes from `histories [channel][sample]` taken every `dt_s` seconds.
///
/// # Errors
/// No channel, unequal lengths, fewer than 12 samples, numbers that are not finite, a constant record.
pub fn identify(histories: &[Vec<f64>], dt_s: f64, settings: &DecaySettings) -> Result<DecayFit> {
    match one_thread() {
        Some(pool) => pool.install(|| identify_here(histories, dt_s, settings)),
        None => identify_here(histories, dt_s, settings),
    }
}

/// Where the fit is done: the dense factorizations share their sums out among as many threads as there are, and so have
/// other last digits with each number of them. The matrices are small; one thread is as fast. None where the system gives no
/// thread.
fn one_thread() -> Option<&'static rayon::ThreadPool> {
    static POOL: OnceLock<Option<rayon::ThreadPool>> = OnceLock::new();
    POOL.get_or_init(|| rayon::ThreadPoolBuilder::new().num_threads(1).build().ok())
        .as_ref()
}

fn identify_here(histories: &[Vec<f64>], dt_s: f64, settings: &DecaySettings) -> Result<DecayFit> {
    let (samples, scales) = check_record(histories, dt_s)?;
    let channels: Vec<usize> = (0..histories.len()).filter(|&c| scales[c] > 0.0).collect();
    let max_order = settings.max_order.unwrap_or(2 * channels.len() + 4);
    // Scaled copies: every channel that moves counts alike.
    let scaled: Vec<Vec<f64>> = channels
        .iter()
        .map(|&c| histories[c].iter().map(|v| v / scales[c]).collect())
        .collect();
    let (poles, singular_values) = subspace(&scaled, dt_s, max_order, settings.offset)?;
    let mut fit = Projection::new(poles, &scaled, dt_s, settings.offset);
    let errors = fit.refine(settings.iterations);
    let total: f64 = scaled.iter().flatten().map(|v| v * v).sum();

    let mut modes = Vec::new();
    let mut roots = Vec::new();
    let mut place = 0;
    for (index, pole) in fit.poles.iter().enumerate() {
        let (sigma_error, omega_error) = errors.as_ref().map_or((f64::INFINITY, f64::INFINITY), |e| e[index]);
        if pole.im == 0.0 {
            let mut amplitude = vec![0.0; histories.len()];
            for (row, &c) in channels.iter().enumerate() {
                amplitude[c] = fit.linear[(place, row)] * scales[c];
            }
            roots.push(DecayRoot {
                rate_1_s: pole.re,
                rate_error_1_s: sigma_error,
                amplitude,
            });
            place += 1;
            continue;
        }
        let mut amplitude = vec![c64::new(0.0, 0.0); histories.len()];
        let mut energy = 0.0;
        for (row, &c) in channels.iter().enumerate() {
            // a Re + b Im parts: Re((a - i b)(cos + i sin)).
            let scaled = c64::new(fit.linear[(place, row)], -fit.linear[(place + 1, row)]);
            amplitude[c] = scaled * scales[c];
            energy += (0..samples)
                .map(|j| (scaled * (*pole * (j as f64 * dt_s)).exp()).re.powi(2))
                .sum::<f64>();
        }
        place += 2;
        modes.push(DecayMode {
            p_rad_s: *pole,
            freq_hz: pole.im / std::f64::consts::TAU,
            g: 2.0 * pole.re / pole.im,
            sigma_error_rad_s: sigma_error,
            omega_error_rad_s: omega_error,
            confidence: normal_probability(pole.re.abs() / sigma_error),
            amplitude,
            energy: energy / total,
        });
    }
    modes.sort_by(|a, b| b.energy.total_cmp(&a.energy));
    let mut offsets = vec![0.0; histories.len()];
    if settings.offset {
        for (row, &c) in channels.iter().enumerate() {
            offsets[c] = fit.linear[(place, row)] * scales[c];
        }
    }
    for c in 0..histories.len() {
        if scales[c] == 0.0 {
            offsets[c] = histories[c][0];
        }
    }
    Ok(DecayFit {
        modes,
        roots,
        offsets,
        residual: (fit.sum_of_squares / total).sqrt(),
        singular_values,
    })
}

/// Number of samples and the rms of each channel about its mean (zero for a channel that does not move).
fn check_record(histories: &[Vec<f64>], dt_s: f64) -> Result<(usize, Vec<f64>)> {
    check_value("time step, s", dt_s, "above zero", dt_s > 0.0)?;
    let samples = histories.first().map_or(0, Vec::len);
    if samples < 12 || histories.iter().any(|h| h.len() != samples) {
        return Err(FlutterError::Shape {
            what: "time histories".into(),
            needed: "at least one channel and 12 samples, as many in every channel".into(),
            got: format!("{} channels, {} samples", histories.len(), samples),
        });
    }
    let mut scales = Vec::with_capacity(histories.len());
    for (channel, history) in histories.iter().enumerate() {
        for (sample, &value) in history.iter().enumerate() {
            if !value.is_finite() {
                let what = "time histories (row = channel, column = sample)".into();
                return Err(FlutterError::NotFinite {
                    what,
                    row: channel,
                    column: sample,
                    value,
                });
            }
        }
        let mean = history.iter().sum::<f64>() / samples as f64;
        let rms = (history.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / samples as f64).sqrt();
        let size = history.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        scales.push(if rms > 1e-13 * size { rms } else { 0.0 });
    }
    if scales.iter().all(|&s| s == 0.0) {
        return Err(FlutterError::Value {
            what: "rms of the time histories about their mean".into(),
            needed: "above zero in at least one channel".into(),
            got: 0.0,
        });
    }
    Ok((samples, scales))
}

/// Probability that a normal variable lies below `x` standard deviations (Abramowitz and Stegun 7.1.26, error 1.5e-7).
fn normal_probability(x: f64) -> f64 {
    if x.is_nan() {
        return 0.5;
    }
    let z = x / std::f64::consts::SQRT_2;
    let t = 1.0 / (1.0 + 0.327_591_1 * z);
    let poly =
        t * (0.254_829_592 + t * (-0.284_496_736 + t * (1.421_413_741 + t * (-1.453_152_027 + t * 1.061_405_429))));
    1.0 - 0.5 * poly * (-z * z).exp()
}
