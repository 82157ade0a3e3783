//! Histories of one recording: fits, cycle by cycle, and what the steps say about the motion.

use super::{MotionCheck, Quality, Reading, ReadingSettings, Source, amplitude_of_sine};
use crate::harmonic::{Histories, Model, fit, pulse, relative_change, whole_cycles};
use dip_dlm::c64;
use dip_record::{Law, Recording};

/// Relative misfit beyond which the frequency of the steps is looked for instead of the declared one taken.
const FITS: f64 = 1e-3;

/// A recording in the form that the analysis takes.
pub(super) struct History<'a> {
    pub(super) recording: &'a Recording,
    pub(super) label: &'a str,
    pub(super) time_s: &'a [f64],
    pub(super) pressures: &'a [Vec<f64>],
    pub(super) area: &'a [f64],
    pub(super) settings: &'a ReadingSettings,
}

impl History<'_> {
    /// Root mean square over the faces, weighted by area.
    fn rms(&self, values: impl Iterator<Item = f64>) -> f64 {
        let total: f64 = self.area.iter().sum();
        (values.zip(self.area).map(|(v, a)| v * v * a).sum::<f64>() / total.max(f64::MIN_POSITIVE)).sqrt()
    }

    fn reading(&self, c: usize, source: Source) -> Reading {
        let setup = &self.recording.setup;
        let coordinate = &setup.motion[c];
        Reading {
            label: self.label.to_owned(),
            source,
            references: setup.references.clone(),
            name: coordinate.name.clone(),
            kind: coordinate.kind,
            mode: coordinate.mode,
            omega_rad_s: 0.0,
            k: 0.0,
            amplitude: 0.0,
            cp: Vec::new(),
            higher: Vec::new(),
            mean: Vec::new(),
            quality: Quality {
                cycles: 0,
                cycles_used: 0,
                cycle_change: None,
                window_change: None,
                residual: 0.0,
                higher: Vec::new(),
                unconverged: self
                    .recording
                    .steps
                    .iter()
                    .filter(|s| s.number > 0 && !s.convergence.converged)
                    .count(),
                time_step_s: (self.time_s[self.time_s.len() - 1] - self.time_s[0]) / (self.time_s.len() - 1) as f64,
                trusted: true,
            },
            motion: None,
        }
    }

    pub(super) fn harmonic(
        &self,
        list: &[(usize, f64)],
        motion_of: impl Fn(usize) -> Vec<f64>,
    ) -> Result<Vec<Reading>, crate::HarmonicError> {
        // The steps say what the frequency was; a declared one that does not fit is a finding of the audit.
        let mut omegas = Vec::new();
        let mut checks = Vec::new();
        for &(c, declared) in list {
            let motion = motion_of(c);
            let omega = sampled_omega(self.time_s, &motion, declared, list.len());
            checks.push(self.motion_check(c, &motion, declared, omega, list.len())?);
            omegas.push(omega);
        }
        let lowest = omegas.iter().copied().fold(f64::INFINITY, f64::min);
        let cycles = whole_cycles(self.time_s, lowest)?;
        let used = match self.settings.cycles {
            0 => cycles.len(),
            n => n.min(cycles.len()),
        };
        let window = cycles[cycles.len() - used].start..self.time_s.len();
        let harmonics = if omegas.len() == 1 {
            self.settings.harmonics.max(1)
        } else {
            1
        };
        let histories = Histories {
            time_s: self.time_s,
            values: self.pressures,
        };
        let model = |harmonics: usize, drift: bool| Model {
            omega_rad_s: omegas.clone(),
            harmonics,
            drift,
            phase_origin_s: 0.0,
        };
        // Few steps a cycle carry few harmonics.
        let per_cycle = window.len() / used.max(1);
        let harmonics = harmonics.min((per_cycle.saturating_sub(3) / 2).max(1));
        let whole = fit(histories, window.clone(), &model(harmonics, true))?;
        let single: Vec<_> = cycles
            .iter()
            .map(|cycle| fit(histories, cycle.clone(), &model(harmonics, true)).ok())
            .collect();
        let mut readings = Vec::new();
        for (f, (&(c, _), check)) in list.iter().zip(checks).enumerate() {
            let motion: Vec<Vec<f64>> = motion_of(c).into_iter().map(|u| vec![u]).collect();
            let moved = |range: std::ops::Range<usize>| {
                let histories = Histories {
                    time_s: self.time_s,
                    values: &motion,
                };
                fit(histories, range, &model(harmonics, false)).map(|m| m.amplitude[f][0][0])
            };
            let amplitude = moved(window.clone())?;
            let cp = whole.per_unit_of(amplitude, f, 1)?;
            let higher = (2..=harmonics)
                .map(|n| whole.per_unit_of(amplitude, f, n))
                .collect::<Result<Vec<_>, _>>()?;
            let of_cycle: Vec<Option<Vec<c64>>> = cycles
                .iter()
                .zip(&single)
                .map(|(range, fit)| {
                    let fit = fit.as_ref()?;
                    fit.per_unit_of(moved(range.clone()).ok()?, f, 1).ok()
                })
                .collect();
            let weighted =
                |list: &[c64]| -> Vec<c64> { list.iter().zip(self.area).map(|(z, a)| z * a.sqrt()).collect() };
            let change = |a: &Option<Vec<c64>>, b: &Option<Vec<c64>>| match (a, b) {
                (Some(a), Some(b)) => Some(relative_change(&weighted(a), &weighted(b))),
                _ => None,
            };
            let n = of_cycle.len();
            let size = self.rms(cp.iter().map(|z| z.norm())) * amplitude.norm();
            let mut reading = self.reading(c, Source::Harmonic);
            let q = &mut reading.quality;
            q.cycles = n;
            q.cycles_used = used;
            q.cycle_change = if n > 1 {
                change(&of_cycle[n - 2], &of_cycle[n - 1])
            } else {
                None
            };
            q.window_change = of_cycle[n - used..n - 1]
                .iter()
                .filter_map(|cycle| change(cycle, &of_cycle[n - 1]))
                .reduce(f64::max);
            q.residual = self.rms(whole.residual_rms.iter().copied()) * std::f64::consts::SQRT_2 / size;
            q.higher = higher
                .iter()
                .map(|h| self.rms(h.iter().map(|z| z.norm())) * amplitude.norm() / size)
                .collect();
            q.unconverged = self.recording.steps[window.clone()]
                .iter()
                .filter(|s| s.number > 0 && !s.convergence.converged)
                .count();
            reading.omega_rad_s = omegas[f];
            reading.k = reading.references.reduced_frequency(omegas[f]);
            reading.amplitude = amplitude.norm();
            reading.cp = cp;
            reading.higher = higher;
            reading.mean.clone_from(&whole.mean);
            reading.motion = Some(check);
            readings.push(reading);
        }
        Ok(readings)
    }

    /// Declared against sampled motion, over all steps from the second cycle on or all there are.
    fn motion_check(
        &self,
        c: usize,
        motion: &[f64],
        declared_omega: f64,
        omega: f64,
        frequencies: usize,
    ) -> Result<MotionCheck, crate::HarmonicError> {
        let law = &self.recording.setup.motion[c].law;
        let Law::Harmonic {
            phase_origin_s,
            harmonics,
            ..
        } = law
        else {
            return Err(crate::HarmonicError::NoMotion { amplitude: 0.0 });
        };
        let own = harmonics
            .iter()
            .find(|h| h.omega_rad_s == declared_omega)
            .or(harmonics.first());
        let declared = own.map_or(c64::new(0.0, 0.0), |h| amplitude_of_sine(h.amplitude, h.phase_rad));
        let values: Vec<Vec<f64>> = motion.iter().map(|u| vec![*u]).collect();
        let histories = Histories {
            time_s: self.time_s,
            values: &values,
        };
        let others: Vec<f64> = harmonics
            .iter()
            .map(|h| h.omega_rad_s)
            .filter(|w| (w - declared_omega).abs() > 1e-9 * declared_omega)
            .filter(|_| frequencies > 1 || harmonics.len() > 1)
            .collect();
        let model = Model {
            omega_rad_s: std::iter::once(omega).chain(others).collect(),
            harmonics: 1,
            drift: false,
            phase_origin_s: *phase_origin_s,
        };
        let sampled = fit(histories, 0..motion.len(), &model)?.amplitude[0][0][0];
        let error = (sampled - declared).norm() / declared.norm().max(f64::MIN_POSITIVE)
            + (omega - declared_omega).abs() / declared_omega;
        Ok(MotionCheck {
            declared_omega_rad_s: declared_omega,
            sampled_omega_rad_s: omega,
            declared,
            sampled,
            error,
        })
    }

    pub(super) fn pulse(&self, c: usize, motion: &[f64]) -> Result<Vec<Reading>, crate::HarmonicError> {
        let refs = &self.recording.setup.references;
        let to_omega = refs.speed_m_s / refs.reference_semichord_m;
        let mut omega: Vec<f64> = self.settings.pulse_k.iter().map(|k| k * to_omega).collect();
        omega.push(0.0);
        omega.sort_by(f64::total_cmp);
        omega.dedup();
        let histories = Histories {
            time_s: self.time_s,
            values: self.pressures,
        };
        let span = motion.iter().fold(0.0_f64, |m, u| m.max((u - motion[0]).abs()));
        let found = pulse::transfer(histories, motion, &omega)?;
        let make = |t: pulse::Transfer| {
            let mut reading = self.reading(c, Source::Pulse);
            reading.quality.residual =
                self.rms(t.error.iter().copied()) / self.rms(t.ratio.iter().map(|z| z.norm())).max(f64::MIN_POSITIVE);
            reading.quality.trusted = t.trusted;
            reading.omega_rad_s = t.omega_rad_s;
            reading.k = t.omega_rad_s / to_omega;
            reading.amplitude = span;
            reading.cp = t.ratio;
            reading.mean = self.pressures[0].clone();
            reading
        };
        Ok(found.into_iter().filter(|t| t.trusted).map(make).collect())
    }

    pub(super) fn ramp(&self, c: usize, motion: &[f64]) -> Result<Reading, crate::HarmonicError> {
        let histories = Histories {
            time_s: self.time_s,
            values: self.pressures,
        };
        let found = pulse::transfer(histories, motion, &[0.0])?;
        let mut reading = self.reading(c, Source::Ramp);
        for t in found {
            reading.quality.residual =
                self.rms(t.error.iter().copied()) / self.rms(t.ratio.iter().map(|z| z.norm())).max(f64::MIN_POSITIVE);
            reading.cp = t.ratio;
        }
        reading.amplitude = (motion[motion.len() - 1] - motion[0]).abs();
        reading.mean = self.pressures[0].clone();
        Ok(reading)
    }
}

/// What (mean, cosine, sine) at a frequency leave of a history, over its size about the mean.
fn misfit(time_s: &[f64], values: &[Vec<f64>], size: f64, omega: f64) -> f64 {
    let histories = Histories { time_s, values };
    let model = Model {
        omega_rad_s: vec![omega],
        harmonics: 1,
        drift: false,
        phase_origin_s: time_s[0],
    };
    fit(histories, 0..time_s.len(), &model).map_or(f64::INFINITY, |f| f.residual_rms[0] / size)
}

/// Frequency of the motion that the steps hold: the declared one where it fits, else the best one of a scan.
fn sampled_omega(time_s: &[f64], motion: &[f64], declared: f64, frequencies: usize) -> f64 {
    let values: Vec<Vec<f64>> = motion.iter().map(|u| vec![*u]).collect();
    let mean = motion.iter().sum::<f64>() / motion.len() as f64;
    let size = (motion.iter().map(|u| (u - mean).powi(2)).sum::<f64>() / motion.len() as f64).sqrt();
    let cost = |omega: f64| misfit(time_s, &values, size, omega);
    // A motion of several frequencies is not fitted by one of them: the declared ones are taken.
    if frequencies > 1 || cost(declared) < FITS {
        return declared;
    }
    let n = time_s.len();
    let duration = time_s[n - 1] - time_s[0];
    let (low, high) = (
        0.25 * std::f64::consts::TAU / duration,
        0.9 * std::f64::consts::PI * (n - 1) as f64 / duration,
    );
    let points = 8 * n;
    let step = (high - low) / points as f64;
    let grid = (0..=points).map(|i| low + step * i as f64);
    let (mut best, mut least) = (declared, cost(declared));
    for omega in grid {
        let c = cost(omega);
        if c < least {
            (best, least) = (omega, c);
        }
    }
    // Golden section about the best point of the scan.
    let (mut a, mut b) = ((best - step).max(0.5 * low), best + step);
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..80 {
        let (c, d) = (b - golden * (b - a), a + golden * (b - a));
        if cost(c) < cost(d) {
            b = d;
        } else {
            a = c;
        }
    }
    let refined = 0.5 * (a + b);
    if cost(refined) < 0.1 { refined } else { declared }
}
