//! First harmonics of lift, drag and moment in a recording, over the same cycles as those of the pressures: for
//! `dip export --harmonics` and for `pmb pitch`, so that both say the same.
//!
//! A load is Re(A e^{i omega t}) of a motion Re(a e^{i omega t}); what is given is A/a: the real part is in phase with the
//! motion, the imaginary part a quarter of a cycle ahead of it.

use dip_correct::HarmonicError;
use dip_correct::harmonic::{self, Histories, Model, pulse};
use dip_correct::reading::{Reading, Source};
use dip_record::{Law, Recording};
use num_complex::Complex64;

/// Lift, drag and moment coefficient of one motion at one frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadHarmonics {
    /// Means in the middle of the cycles used.
    pub mean: [f64; 3],
    /// Per radian, metre or 1 of the motion, at its frequency.
    pub first: [Complex64; 3],
    /// The same of every further sine of the motion, at that sine's frequency: multiple and answer.
    pub further: Vec<(usize, [Complex64; 3])>,
}

/// The loads that go with a reading; those of a pulse or ramp are ratios of transforms, as its pressures are. `all` are the readings of the recording.
///
/// # Errors
/// Too short a record, or no motion.
pub fn of(recording: &Recording, reading: &Reading, all: &[Reading]) -> Result<Option<LoadHarmonics>, HarmonicError> {
    let Some(coordinate) = recording.setup.motion.iter().position(|c| c.name == reading.name) else {
        return Ok(None);
    };
    if reading.source != Source::Harmonic {
        return transformed(recording, reading, coordinate);
    }
    let multiples = multiples(&recording.setup.motion[coordinate].law, reading.omega_rad_s);
    let time_s: Vec<f64> = recording.steps.iter().map(|s| s.time_s).collect();
    let values: Vec<Vec<f64>> = recording
        .steps
        .iter()
        .map(|s| vec![s.loads.cl, s.loads.cd, s.loads.cm, s.motion[coordinate].value])
        .collect();
    let omega_rad_s: Vec<f64> = all.iter().map(|r| r.omega_rad_s).collect();
    let lowest = omega_rad_s.iter().copied().fold(f64::INFINITY, f64::min);
    let cycles = harmonic::whole_cycles(&time_s, lowest)?;
    let first = cycles.len().saturating_sub(reading.quality.cycles_used);
    let start = cycles.get(first).map_or(0, |c| c.start);
    let own = all.iter().position(|a| std::ptr::eq(a, reading)).unwrap_or(0);
    let highest = multiples.iter().copied().max().unwrap_or(1);
    let model = Model {
        omega_rad_s,
        harmonics: (reading.higher.len() + 1).max(highest),
        drift: true,
        phase_origin_s: 0.0,
    };
    let histories = Histories {
        time_s: &time_s,
        values: &values,
    };
    let fit = harmonic::fit(histories, start..time_s.len(), &model)?;
    // Each sine's answer goes by what the motion itself has at that frequency.
    let answer = |n: usize| -> Result<[Complex64; 3], HarmonicError> {
        let row = &fit.amplitude[own][n - 1];
        if row[3].norm() > 0.0 {
            Ok([0, 1, 2].map(|c| row[c] / row[3]))
        } else {
            Err(HarmonicError::NoMotion {
                amplitude: row[3].norm(),
            })
        }
    };
    Ok(Some(LoadHarmonics {
        mean: [0, 1, 2].map(|c| fit.mean[c]),
        first: answer(1)?,
        further: multiples
            .into_iter()
            .map(|n| Ok((n, answer(n)?)))
            .collect::<Result<_, _>>()?,
    }))
}

fn transformed(
    recording: &Recording,
    reading: &Reading,
    coordinate: usize,
) -> Result<Option<LoadHarmonics>, HarmonicError> {
    let steps = &recording.steps;
    let time_s: Vec<f64> = steps.iter().map(|s| s.time_s).collect();
    let values: Vec<Vec<f64>> = steps.iter().map(|s| vec![s.loads.cl, s.loads.cd, s.loads.cm]).collect();
    let motion: Vec<f64> = steps.iter().map(|s| s.motion[coordinate].value).collect();
    let histories = Histories {
        time_s: &time_s,
        values: &values,
    };
    let found = pulse::transfer(histories, &motion, &[reading.omega_rad_s])?;
    Ok(found.first().zip(values.first()).map(|(t, start)| LoadHarmonics {
        mean: [start[0], start[1], start[2]],
        first: [t.ratio[0], t.ratio[1], t.ratio[2]],
        further: Vec::new(),
    }))
}

/// Whole multiples of a frequency, from 2 on, at which a law has further sines.
fn multiples(law: &Law, omega_rad_s: f64) -> Vec<usize> {
    let Law::Harmonic { harmonics, .. } = law else {
        return Vec::new();
    };
    let mut multiples: Vec<usize> = harmonics
        .iter()
        .filter(|h| h.amplitude != 0.0)
        .map(|h| h.omega_rad_s / omega_rad_s)
        .filter(|times| *times > 1.5 && (times - times.round()).abs() < 1e-6)
        .map(|times| times.round() as usize)
        .collect();
    multiples.sort_unstable();
    multiples.dedup();
    multiples
}
