//! Motion that grows and then keeps its size.

use super::{DecayMode, DecaySettings, identify};
use crate::error::Result;

/// A limit cycle: growth that a linear system would not have given up.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitCycle {
    /// Frequency, Hz.
    pub freq_hz: f64,
    /// Amplitude of each channel.
    pub amplitude: Vec<f64>,
    /// g in the first half of the record.
    pub g_early: f64,
    /// g in the last third.
    pub g_late: f64,
}

/// Cycles that a record must hold before its halves can be compared.
const LEAST_CYCLES: f64 = 8.0;
/// Growth below this is none.
const LEAST_GROWTH: f64 = 0.002;
/// Factor by which the motion must have grown in the first half: a slow transient beside a neutral mode does not.
const LEAST_FACTOR: f64 = 1.15;
/// Part of the early growth that may be left.
const LEFT: f64 = 0.2;

/// Whether `histories` `[channel][sample]` settle to a limit cycle: the mode with the most energy grows in the first half of
/// the record and keeps its size in the last third.
///
/// # Errors
/// Those of [`identify`].
pub fn limit_cycle(histories: &[Vec<f64>], dt_s: f64, settings: &DecaySettings) -> Result<Option<LimitCycle>> {
    let samples = histories.first().map_or(0, Vec::len);
    let part = |from: usize, to: usize| -> Vec<Vec<f64>> {
        let cut = |h: &Vec<f64>| h.get(from..to.min(h.len())).unwrap_or_default().to_vec();
        histories.iter().map(cut).collect()
    };
    let late = identify(&part(samples - samples / 3, samples), dt_s, settings)?;
    let Some(last) = late.modes.first() else {
        return Ok(None);
    };
    if samples as f64 * dt_s * last.freq_hz < LEAST_CYCLES {
        return Ok(None);
    }
    let early = identify(&part(0, samples / 2), dt_s, settings)?;
    let apart = |m: &DecayMode| (m.freq_hz - last.freq_hz).abs();
    let same = early.modes.iter().filter(|m| apart(m) < 0.2 * last.freq_hz);
    let Some(first) = same.max_by(|a, b| a.energy.total_cmp(&b.energy)) else {
        return Ok(None);
    };
    let factor = (first.p_rad_s.re * (samples / 2) as f64 * dt_s).exp();
    let grows = first.g > LEAST_GROWTH && first.confidence > 0.99 && factor > LEAST_FACTOR;
    Ok((grows && last.g.abs() < LEFT * first.g).then(|| LimitCycle {
        freq_hz: last.freq_hz,
        amplitude: last.amplitude.iter().map(|a| a.norm()).collect(),
        g_early: first.g,
        g_late: last.g,
    }))
}
