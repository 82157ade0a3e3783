//! What a run with prescribed motion comes to: `summary.json`, the same in words, and what must be looked at.

use crate::assemble::motion::Clock;
use crate::load_harmonics::LoadHarmonics;
use crate::progress::Seconds;
use crate::stamp::Stamp;
use dip_case::file::PitchFile;
use dip_pmb::forced::{ForcedResult, ForcedStop};
use dip_pmb::steady::StopReason;
use serde::Serialize;

/// Mean and first harmonic of a coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Harmonic {
    /// Mean over the cycle.
    pub mean: f64,
    /// Part in phase with the motion, per radian, metre or 1.
    pub real: f64,
    /// Part a quarter of a cycle ahead of it.
    pub imaginary: f64,
}

/// A further sine of the motion and what answers it at its frequency: real and imaginary part per radian, metre or 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Further {
    pub multiple: usize,
    pub reduced_frequency: f64,
    pub cl: [f64; 2],
    pub cd: [f64; 2],
    pub cm: [f64; 2],
}

/// What `summary.json` holds.
#[derive(Debug, Serialize)]
pub struct Summary<'a> {
    pub command: &'static str,
    pub stamp: Stamp,
    pub settings: &'a str,
    pub stop_reason: ForcedStop,
    pub steady_stop_reason: Option<&'a StopReason>,
    pub mach: f64,
    pub alpha_deg: f64,
    pub speed_m_s: f64,
    pub density_kg_m3: f64,
    pub omega_rad_s: f64,
    pub frequency_hz: f64,
    pub reduced_frequency: f64,
    pub amplitude: f64,
    /// Modes and control surfaces: how far the amplitude moves the wall.
    pub largest_displacement_m: Option<f64>,
    pub steps_per_cycle: usize,
    pub steps: usize,
    pub steps_not_converged: usize,
    pub iterations: usize,
    pub products: usize,
    pub preconditioners: usize,
    /// Change from the last cycle but one to the last, as a part of the amplitude.
    pub cycle_change: Option<f64>,
    /// First harmonics per radian, metre or 1, over the last whole cycle.
    pub cl: Option<Harmonic>,
    pub cd: Option<Harmonic>,
    pub cm: Option<Harmonic>,
    /// Of each further sine of `[[motion.harmonic]]`.
    pub further: Vec<Further>,
    /// With half the amplitude, where asked for: the largest change of the harmonics of lift and moment, as a part.
    pub linearity: Option<f64>,
    pub cells: usize,
    pub mesh_hash: &'a str,
    pub recording: &'static str,
    pub warnings: Vec<String>,
    pub stages: &'a [(String, Seconds)],
    pub total: Seconds,
}

/// First harmonics of the coefficients, and those of the further sines.
pub fn harmonics(loads: Option<&LoadHarmonics>, clock: &Clock) -> (Option<[Harmonic; 3]>, Vec<Further>) {
    let first = loads.map(|l| {
        [0, 1, 2].map(|c| Harmonic {
            mean: l.mean[c],
            real: l.first[c].re,
            imaginary: l.first[c].im,
        })
    });
    let further = loads.iter().flat_map(|l| &l.further).map(|(multiple, answer)| {
        let [cl, cd, cm] = answer.map(|a| [a.re, a.im]);
        Further {
            multiple: *multiple,
            reduced_frequency: *multiple as f64 * clock.reduced_frequency,
            cl,
            cd,
            cm,
        }
    });
    (first, further.collect())
}

/// What a user must look at.
pub fn warnings(result: &ForcedResult, file: &PitchFile, clock: &Clock, linearity: Option<f64>) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some(stop) = result.steady_stop.as_ref().filter(|s| !s.is_converged()) {
        warnings.push(format!(
            "the steady start is not converged ({stop:?}): look at it by `pmb steady`"
        ));
    }
    if result.not_converged > 0 {
        warnings.push(format!(
            "{} of {} time steps did not converge to the orders asked for; more steps per cycle or time.iterations help",
            result.not_converged, result.steps
        ));
    }
    if clock.steps_per_cycle > 0 && file.motion.tolerance > 0.0 && result.stop == ForcedStop::AllSteps {
        warnings.push(format!(
            "the last two cycles differ by {:.2} % of the amplitude, {:.2} % were asked for; more motion.cycles help",
            100.0 * result.cycle_change,
            100.0 * file.motion.tolerance
        ));
    }
    if let Some(change) = linearity.filter(|c| *c > 0.05) {
        warnings.push(format!(
            "with half the amplitude the harmonics change by {:.1} %: the response is not linear",
            100.0 * change
        ));
    }
    warnings
}

/// The results in words.
pub fn text(
    title: &str,
    result: &ForcedResult,
    harmonic: Option<&[Harmonic; 3]>,
    further: &[Further],
    linearity: Option<f64>,
) -> String {
    let reason = match result.stop {
        ForcedStop::Periodic => "two successive cycles agree",
        ForcedStop::AllSteps => "all steps taken",
        ForcedStop::Interrupted => "interrupted",
    };
    let mut text = format!(
        "{title}: {reason} after {} time steps, {} pseudo steps, {} products\n",
        result.steps, result.iterations, result.products
    );
    if let Some(h) = harmonic {
        text.push_str(&format!(
            "{:<4}{:>13}{:>13}{:>13}\n",
            "", "mean", "in phase", "1/4 ahead"
        ));
        for (name, h) in ["CL", "CD", "CM"].into_iter().zip(h) {
            text.push_str(&format!(
                "{name:<4}{:>13.7}{:>13.6}{:>13.6}\n",
                h.mean, h.real, h.imaginary
            ));
        }
        for f in further {
            text.push_str(&format!(
                "at {} times the frequency, k = {:.4}\n",
                f.multiple, f.reduced_frequency
            ));
            for (name, [real, imaginary]) in [("CL", f.cl), ("CD", f.cd), ("CM", f.cm)] {
                text.push_str(&format!("{name:<4}{:>13}{real:>13.6}{imaginary:>13.6}\n", ""));
            }
        }
        text.push_str("harmonics per radian, metre or 1 of the motion\n");
    }
    if let Some(change) = linearity {
        text.push_str(&format!(
            "with half the amplitude: harmonics change by {:.2} %\n",
            100.0 * change
        ));
    }
    text
}
