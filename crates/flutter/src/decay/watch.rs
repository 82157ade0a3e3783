//! Damping while a march runs: read from time to time, until it is known well enough.

use faer::c64;

use super::{DecayFit, DecaySettings, Drift, has_faded, identify};
use crate::error::{Result, check_value};
use crate::search::{Rate, Stability};

/// Part of the elastic energy at the end of a record from which a drift counts.
const DRIFT_SHARE: f64 = 0.2;
/// An oscillation slower than this part of the lowest natural frequency is a drift: the air takes the stiffness away as the
/// structure comes near divergence, and a fit makes pairs of its real roots.
const SLOW: f64 = 0.5;

/// When and how a running march is read.
#[derive(Debug, Clone, PartialEq)]
pub struct WatchSettings {
    /// Time between samples, s.
    pub dt_s: f64,
    /// Natural circular frequency of each coordinate, rad/s: its potential energy is `mass omega^2 q^2 / 2`.
    pub omega_rad_s: Vec<f64>,
    /// Generalized mass of each coordinate, kg.
    pub mass_kg: Vec<f64>,
    /// Samples at the beginning that are left out (the flow's answer to a sudden start).
    pub skip: usize,
    /// Samples from one reading to the next.
    pub every: usize,
    /// Cycles of the least stable mode that a record must hold.
    pub least_cycles: f64,
    /// Accuracy of g: its standard error, and its change from reading to reading, must be below this,
    pub accuracy: f64,
    /// or below this part of g, where that is more.
    pub relative: f64,
    /// Part of the record's energy that a mode must hold to count.
    pub least_energy: f64,
    /// The fit.
    pub decay: DecaySettings,
}

impl WatchSettings {
    /// Usual settings for modes of these frequencies and masses, sampled every `dt_s` seconds.
    #[must_use]
    pub fn new(dt_s: f64, omega_rad_s: Vec<f64>, mass_kg: Vec<f64>) -> Self {
        Self {
            dt_s,
            omega_rad_s,
            mass_kg,
            skip: 4,
            every: 5,
            least_cycles: 1.25,
            accuracy: 0.002,
            relative: 0.1,
            least_energy: 0.01,
            decay: DecaySettings::default(),
        }
    }
}

/// A mode as a reading sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct WatchedMode {
    /// p = sigma + i omega, rad/s.
    pub p_rad_s: c64,
    /// Frequency, Hz.
    pub freq_hz: f64,
    /// g = 2 sigma / omega, positive growing.
    pub g: f64,
    /// Standard error of g: the fit's, or half its change since the last reading where that is more.
    pub g_error: f64,
    /// Part of the record's mean energy.
    pub energy: f64,
    /// Complex amplitude of each coordinate at the first sample of the record.
    pub amplitude: Vec<c64>,
}

/// Growth without oscillation, clear of the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Growth {
    /// Rate, 1/s.
    pub rate_1_s: f64,
    /// Standard error of the rate: the fit's, or half its change since the last reading where that is more.
    pub rate_error_1_s: f64,
    /// Part of the record's mean energy.
    pub energy: f64,
}

/// What a march shows so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Samples so far, those left out included.
    pub samples: usize,
    /// Modes that hold enough energy, least stable first.
    pub modes: Vec<WatchedMode>,
    /// The fastest growth without oscillation: the structure diverges.
    pub growth: Option<Growth>,
    /// What moves beside the oscillations, where it holds a good part of the motion at the end of the record: until it is seen to
    /// die out or to grow, the structure may yet diverge.
    pub drift: Option<Drift>,
    /// True if nothing is left of the motion that it began with.
    pub faded: bool,
    /// Part of the record that the fit leaves.
    pub residual: f64,
    /// True if the damping of the least stable mode, or the rate of divergence, is known as well as asked, or if the
    /// motion has died out, or is seen to without an oscillation.
    pub known: bool,
}

impl Reading {
    /// Whether what is least stable comes to rest without oscillating: a structure near divergence, whose motion the air damps
    /// beyond oscillation.
    #[must_use]
    pub fn subsides(&self) -> bool {
        let last = self.drift.filter(|d| d.rate_1_s < 0.0 && d.share > 1.0 - DRIFT_SHARE);
        let is_least_stable = |d: Drift| self.modes.iter().all(|m| m.p_rad_s.re < d.rate_1_s);
        self.growth.is_none() && (last.is_some_and(is_least_stable) || self.faded && self.modes.is_empty())
    }

    /// What a search makes of it; none where nothing could be read.
    #[must_use]
    pub fn stability(&self) -> Option<Stability> {
        if self.subsides() {
            let rate = self.drift.filter(|d| d.rate_error_1_s.is_finite()).map(|d| Rate {
                rate_1_s: d.rate_1_s,
                rate_error_1_s: d.rate_error_1_s,
            });
            return Some(Stability::Subsidence(rate));
        }
        let mode = self.modes.first();
        let outgrows = |g: &Growth| mode.is_none_or(|m| g.rate_1_s > m.p_rad_s.re);
        if let Some(growth) = self.growth.filter(outgrows) {
            return Some(Stability::Divergence(Some(Rate {
                rate_1_s: growth.rate_1_s,
                rate_error_1_s: growth.rate_error_1_s,
            })));
        }
        mode.map(|m| Stability::Oscillation {
            g: m.g,
            // Read only once before the motion ran away: nothing says how well.
            g_error: if m.g_error.is_finite() { m.g_error } else { m.g.abs() },
            freq_hz: m.freq_hz,
        })
    }
}

/// Reads a march as it goes.
#[derive(Debug, Clone)]
pub struct Watch {
    settings: WatchSettings,
    histories: Vec<Vec<f64>>,
    last: Option<Reading>,
}

impl Watch {
    /// Begins to watch.
    ///
    /// # Errors
    /// A time step or a number of samples that has no meaning, lists of different lengths.
    pub fn new(settings: WatchSettings) -> Result<Self> {
        check_value("time step, s", settings.dt_s, "above zero", settings.dt_s > 0.0)?;
        let every = settings.every as f64;
        check_value("samples between readings", every, "one or more", settings.every > 0)?;
        let (modes, masses) = (settings.omega_rad_s.len(), settings.mass_kg.len());
        check_value(
            "number of masses",
            masses as f64,
            "as many as frequencies, at least one",
            masses == modes && modes > 0,
        )?;
        Ok(Self {
            histories: vec![Vec::new(); modes],
            settings,
            last: None,
        })
    }

    /// Histories `[coordinate][sample]` so far, without the samples left out at the beginning.
    #[must_use]
    pub fn record(&self) -> Vec<Vec<f64>> {
        let skip = self.settings.skip;
        self.histories
            .iter()
            .map(|h| h.get(skip..).unwrap_or_default().to_vec())
            .collect()
    }

    /// The last reading.
    #[must_use]
    pub fn reading(&self) -> Option<&Reading> {
        self.last.as_ref()
    }

    /// Adds a sample `[coordinate]`; a reading where one is due and the record allows it.
    pub fn push(&mut self, q: &[f64]) -> Option<&Reading> {
        for (history, v) in self.histories.iter_mut().zip(q) {
            history.push(*v);
        }
        let samples = self.histories[0].len();
        if samples < self.settings.skip + 12 || !(samples - self.settings.skip).is_multiple_of(self.settings.every) {
            return None;
        }
        let record = self.record();
        let fit = identify(&record, self.settings.dt_s, &self.settings.decay).ok()?;
        let reading = self.read(&record, &fit, samples);
        Some(self.last.insert(reading))
    }

    fn read(&self, record: &[Vec<f64>], fit: &DecayFit, samples: usize) -> Reading {
        let s = &self.settings;
        let lowest_rad_s = s.omega_rad_s.iter().copied().fold(f64::INFINITY, f64::min);
        let slowest_rad_s = SLOW * lowest_rad_s;
        let duration = (samples - s.skip - 1) as f64 * s.dt_s;
        // Mean of e^(2 sigma t) over the record.
        let growth = |sigma: f64| {
            let x = 2.0 * sigma * duration;
            if x.abs() < 1e-6 { 1.0 } else { x.exp_m1() / x }
        };
        // Mean energy of an exponential: kinetic and elastic, half of it where it oscillates.
        let energy = |rate: c64, squares: &mut dyn Iterator<Item = f64>| -> f64 {
            let part = if rate.im == 0.0 { 0.5 } else { 0.25 };
            let size: f64 = squares
                .zip(s.omega_rad_s.iter().zip(&s.mass_kg))
                .map(|(a, (w, m))| part * m * (w * w + rate.norm_sqr()) * a)
                .sum();
            size * growth(rate.re)
        };
        let energies: Vec<f64> = fit
            .modes
            .iter()
            .map(|mode| energy(mode.p_rad_s, &mut mode.amplitude.iter().map(c64::norm_sqr)))
            .collect();
        let drifts: Vec<f64> = fit
            .roots
            .iter()
            .map(|root| energy(c64::new(root.rate_1_s, 0.0), &mut root.amplitude.iter().map(|a| a * a)))
            .collect();
        let total: f64 = energies.iter().chain(&drifts).sum();
        let mut modes: Vec<WatchedMode> = fit
            .modes
            .iter()
            .zip(&energies)
            .filter(|(_, e)| **e >= s.least_energy * total)
            .map(|(mode, e)| {
                let fitted = 2.0 * mode.sigma_error_rad_s / mode.p_rad_s.im;
                // The mode of the last reading with the nearest root.
                let before = self.last.iter().flat_map(|r| &r.modes).min_by(|a, b| {
                    let far = |m: &WatchedMode| (m.p_rad_s - mode.p_rad_s).norm();
                    far(a).total_cmp(&far(b))
                });
                let change = before.map_or(f64::INFINITY, |b| 0.5 * (b.g - mode.g).abs());
                WatchedMode {
                    p_rad_s: mode.p_rad_s,
                    freq_hz: mode.freq_hz,
                    g: mode.g,
                    g_error: fitted.max(change),
                    energy: e / total,
                    amplitude: mode.amplitude.clone(),
                }
            })
            .collect();
        modes.sort_by(|a, b| b.g.total_cmp(&a.g));
        let stiffness: Vec<f64> = s.omega_rad_s.iter().zip(&s.mass_kg).map(|(w, m)| m * w * w).collect();
        let faded = has_faded(record, &stiffness);
        let drift =
            Drift::of(record, s.dt_s, fit, slowest_rad_s, &stiffness).filter(|d| !faded && d.share >= DRIFT_SHARE);
        if drift.is_some() && modes.iter().any(|m| m.p_rad_s.im >= slowest_rad_s) {
            modes.retain(|m| m.p_rad_s.im >= slowest_rad_s);
        }
        let before = self.last.as_ref().and_then(|r| r.growth);
        let grown = fit
            .roots
            .iter()
            .zip(&drifts)
            .map(|(root, e)| Growth {
                rate_1_s: root.rate_1_s,
                rate_error_1_s: before.map_or(root.rate_error_1_s, |b| {
                    root.rate_error_1_s.max(0.5 * (b.rate_1_s - root.rate_1_s).abs())
                }),
                energy: e / total,
            })
            // A drift that has not grown by e within the record may be the beginning of anything.
            .filter(|g| g.rate_1_s * duration >= 1.0 && g.rate_1_s > 3.0 * g.rate_error_1_s)
            .filter(|g| g.energy >= s.least_energy)
            // An exponential of a fit with offsets stands for the beginning of any transient; growth itself is in the record.
            .filter(|g| drift.is_some_and(|d| d.grows() && (g.rate_1_s - d.rate_1_s).abs() < 0.5 * d.rate_1_s))
            .max_by(|a, b| a.rate_1_s.total_cmp(&b.rate_1_s));
        let lowest = lowest_rad_s / std::f64::consts::TAU;
        let known_growth = grown.is_some_and(|g| {
            before.is_some() && g.rate_error_1_s < s.relative * g.rate_1_s && duration * lowest >= s.least_cycles
        });
        // Fast growth shows as an exponential of the fit; slow growth as a drift, when the oscillations have died. Before they have
        // been seen for a cycle, they are a drift too.
        let slow = drift
            .filter(|d| d.share > 1.0 - DRIFT_SHARE && d.grows() && duration * lowest >= s.least_cycles)
            .map(|d| Growth {
                rate_1_s: d.rate_1_s,
                rate_error_1_s: d.rate_error_1_s,
                energy: d.share,
            });
        let dies = drift.is_none_or(|d| d.dies());
        // Overdamped, or nearly so. The first half-wave of an oscillation dies down too, but is over before a cycle is.
        let overdamped = modes.is_empty() && drift.is_some_and(|d| d.dies());
        let at_rest = (faded && modes.iter().all(|m| m.g < 0.0) || overdamped) && duration * lowest >= s.least_cycles;
        let diverges = known_growth || slow.is_some();
        let grown = grown.or(slow);
        if grown.is_some() {
            // Two real roots that grow, as a fit may see them.
            modes.retain(|m| m.p_rad_s.im >= slowest_rad_s);
        }
        let clear = |m: &WatchedMode| {
            m.g_error < s.accuracy.max(s.relative * m.g.abs()) && duration * m.freq_hz >= s.least_cycles
        };
        // Slow modes are known later than fast ones: none may be left that could yet turn out less stable than the first.
        let settled = modes.split_first().is_some_and(|(first, others)| {
            clear(first) && others.iter().all(|m| clear(m) || m.g + 2.0 * m.g_error < first.g)
        });
        Reading {
            samples,
            growth: grown,
            residual: fit.residual,
            modes,
            known: settled && dies || diverges || at_rest,
            drift,
            faded,
        }
    }
}
