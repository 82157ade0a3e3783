//! The audit of the hand-over: every check with its value, limit, verdict and, where it fails, the likely cause in words.

mod checks;
pub mod suspect;

use crate::apply::{Correction, Method, References};
use crate::bridge::Mapped;
use crate::reading::Source;
use crate::sample::{Rule, strip_loads_of_boxes};
use checks::{against_lattice, harmonic, linearity, steady, subject, weights};
use dip_dlm::aic::{Aerodynamics, AicError};
use dip_dlm::c64;
use serde::Serialize;
use suspect::Suspect;

/// Whether a check is passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Within its limit.
    Pass,
    /// Beyond its limit: look before the result is used.
    Fail,
    /// The recordings do not say.
    NotRecorded,
}

/// One check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// Its name.
    pub name: &'static str,
    /// What was checked: a recording, a method, or all.
    pub subject: String,
    /// The value found.
    pub value: Option<f64>,
    /// The largest value that passes.
    pub limit: f64,
    /// Unit of both.
    pub unit: &'static str,
    /// Verdict.
    pub verdict: Verdict,
    /// What the value means and, where it fails, the likely cause.
    pub words: String,
    /// The mistake that it looks like.
    pub suspect: Option<Suspect>,
}

/// Limits of the checks. The defaults are explained in `docs/theory-correction.md`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Change from cycle to cycle.
    pub cycle_change: f64,
    /// Residual of the harmonic fit over the fundamental.
    pub residual: f64,
    /// Recorded motion against its law.
    pub motion: f64,
    /// Phase of the section lift against the linear lattice, degrees.
    pub phase_deg: f64,
    /// Root mean square of |W - 1| over the boxes' area.
    pub weight: f64,
    /// Strip lift and moment before and after mapping.
    pub mapping: f64,
    /// Pressures of the reference motion given back.
    pub reproduction: f64,
    /// Steady slope against the limit k -> 0.
    pub steady: f64,
    /// Left against right.
    pub symmetry: f64,
    /// Half amplitude against full.
    pub linearity: f64,
    /// Condition number of the downwash matrix.
    pub condition: f64,
    /// Projected wall outside of the boxes.
    pub overhang: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            cycle_change: 0.02,
            residual: 0.05,
            motion: 1e-9,
            phase_deg: 30.0,
            weight: 1.0,
            mapping: 1e-10,
            reproduction: 1e-9,
            steady: 0.15,
            symmetry: 1e-3,
            linearity: 0.05,
            condition: 1e10,
            overhang: 0.05,
        }
    }
}

/// All checks.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Audit {
    /// In the order of the chain.
    pub checks: Vec<Check>,
}

impl Audit {
    /// True where a check fails.
    #[must_use]
    pub fn failed(&self) -> bool {
        self.checks.iter().any(|c| c.verdict == Verdict::Fail)
    }

    /// Mistakes that failed checks look like, each once.
    #[must_use]
    pub fn suspects(&self) -> Vec<Suspect> {
        let mut list: Vec<Suspect> = Vec::new();
        for suspect in self
            .checks
            .iter()
            .filter(|c| c.verdict == Verdict::Fail)
            .filter_map(|c| c.suspect)
        {
            if !list.contains(&suspect) {
                list.push(suspect);
            }
        }
        list
    }

    fn push(
        &mut self,
        name: &'static str,
        subject: &str,
        value: Option<f64>,
        limit: f64,
        unit: &'static str,
        words: (&str, &str),
    ) {
        let verdict = match value {
            None => Verdict::NotRecorded,
            // What is not a number passes nothing.
            Some(v) if v <= limit => Verdict::Pass,
            Some(_) => Verdict::Fail,
        };
        self.checks.push(Check {
            name,
            subject: subject.to_owned(),
            value,
            limit,
            unit,
            verdict,
            words: match verdict {
                Verdict::Fail => words.1.to_owned(),
                _ => words.0.to_owned(),
            },
            suspect: None,
        });
    }

    fn blame(&mut self, suspect: Option<Suspect>) {
        if let (Some(suspect), Some(check)) = (suspect, self.checks.last_mut())
            && check.verdict == Verdict::Fail
        {
            check.suspect = Some(suspect);
            check.words = format!("{}; {}", suspect.words(), check.words);
        }
    }
}

/// Lift and phase of one strip.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StripPhase {
    /// Mid-span y, m.
    pub y_m: f64,
    /// Mid-span z, m.
    pub z_m: f64,
    /// Section lift over the dynamic pressure and the strip's area, recorded, real and imaginary part per unit of the motion.
    pub recorded: [f64; 2],
    /// The linear lattice's.
    pub linear: [f64; 2],
    /// Phase of the recorded lift, degrees.
    pub recorded_deg: f64,
    /// Phase of the linear lift, degrees.
    pub linear_deg: f64,
}

/// Section lift along the span at one frequency.
#[must_use]
pub fn strip_phases(aerodynamics: &Aerodynamics, recorded: &[c64], linear: &[c64]) -> Vec<StripPhase> {
    let lattice = aerodynamics.lattice();
    let (a, b) = (
        strip_loads_of_boxes(lattice, recorded),
        strip_loads_of_boxes(lattice, linear),
    );
    let area = |s: &dip_dlm::lattice::Strip| {
        lattice.boxes()[s.first..s.first + s.count]
            .iter()
            .map(|b| b.area)
            .sum::<f64>()
    };
    lattice
        .strips()
        .iter()
        .zip(a.lift_m2.iter().zip(&b.lift_m2))
        .map(|(s, (recorded, linear))| {
            let (recorded, linear) = (recorded / area(s), linear / area(s));
            StripPhase {
                y_m: s.y,
                z_m: s.z,
                recorded: [recorded.re, recorded.im],
                linear: [linear.re, linear.im],
                recorded_deg: recorded.arg().to_degrees(),
                linear_deg: linear.arg().to_degrees(),
            }
        })
        .collect()
}

/// Checks everything that the recordings allow.
///
/// # Errors
/// What the lattice refuses at the frequencies that it is compared at.
pub fn audit(
    aerodynamics: &Aerodynamics,
    mach: f64,
    references: &References,
    mapped: &[Mapped],
    correction: &Correction,
    rule: Rule,
    limits: &Limits,
) -> Result<Audit, AicError> {
    let mut audit = Audit::default();
    let area: Vec<f64> = aerodynamics.lattice().boxes().iter().map(|b| b.area).collect();
    for m in mapped {
        let label = subject(m);
        if m.reading.source == Source::Harmonic {
            harmonic(&mut audit, m, &label, limits);
        } else {
            audit.push(
                "standard error of the transfer function",
                &label,
                Some(m.reading.quality.residual),
                limits.residual,
                "",
                (
                    "noise and what has not settled, over the ratio",
                    "the record ends before the flow has settled, or the steps are noisy: record longer or converge deeper",
                ),
            );
        }
        if rule == Rule::Conservative {
            let largest = m.lift_error.max(m.moment_error);
            audit.push(
                "strip lift and moment before and after mapping",
                &label,
                Some(largest),
                limits.mapping,
                "",
                (
                    "largest difference of a strip over the largest lift",
                    "a strip of one box can't keep its moment: use two or more boxes along the chord",
                ),
            );
        } else {
            audit.push(
                "strip lift and moment before and after mapping",
                &label,
                Some(m.lift_error.max(m.moment_error)),
                f64::INFINITY,
                "",
                (
                    "not kept by this rule of sampling; conservative sampling keeps both",
                    "",
                ),
            );
        }
        audit.push(
            "wall outside of the boxes",
            &label,
            Some(m.overhang),
            limits.overhang,
            "",
            (
                "part of the projected wall that went to the nearest box",
                "the wall is not the lattice's planform: other walls in the recording, or another wing?",
            ),
        );
        against_lattice(&mut audit, aerodynamics, mach, references, m, &label, &area, limits)?;
        audit.push(
            "symmetry of left and right",
            &label,
            m.asymmetry,
            limits.symmetry,
            "",
            (
                if m.asymmetry.is_some() {
                    "lift of both half wings"
                } else {
                    "half a model"
                },
                "the half wings carry different lift: sideslip, an unconverged flow, or an asymmetric grid",
            ),
        );
    }
    weights(
        &mut audit,
        correction,
        references,
        &area,
        aerodynamics.semichord(),
        limits,
    );
    steady(&mut audit, aerodynamics, mapped, references, limits);
    linearity(&mut audit, mapped, &area, limits);
    for corrected in &correction.methods {
        let worst = corrected.reproduction.iter().map(|r| r.error).reduce(f64::max);
        let what = match corrected.method {
            Method::Force | Method::ForceSteady => "lift and moment of every strip given back for the reference motion",
            _ => "pressures given back for the reference motion",
        };
        audit.push(
            "reference motion reproduced",
            corrected.method.name(),
            worst,
            limits.reproduction,
            "",
            (
                if worst.is_some() {
                    what
                } else {
                    "steady weights: no steady slope was recorded to give back"
                },
                "a defect of the program: please report it",
            ),
        );
    }
    let condition = correction.recordings.iter().map(|r| r.condition).fold(0.0, f64::max);
    audit.push(
        "condition of the downwash matrix",
        "lattice",
        Some(condition),
        limits.condition,
        "",
        (
            "1-norm condition number at the recorded frequencies",
            "the lattice is nearly singular: coincident boxes, or boxes of very different size",
        ),
    );
    Ok(audit)
}
