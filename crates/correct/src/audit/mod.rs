//! The audit of the hand-over: every check with its value, limit, verdict and, where it fails, the likely cause in words.

pub mod suspect;

use crate::apply::{Correction, Method, References};
use crate::bridge::Mapped;
use crate::reading::{MotionCheck, Source};
use crate::sample::{Rule, strip_loads_of_boxes};
use crate::weight::Treatment;
use dip_dlm::aic::{Aerodynamics, AicError};
use dip_dlm::c64;
use serde::Serialize;
use suspect::{Alternative, Suspect};

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
    weights(&mut audit, correction, &area, limits);
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

fn subject(m: &Mapped) -> String {
    format!("{}: {}, k = {:.4}", m.reading.label, m.reading.name, m.reading.k)
}

fn harmonic(audit: &mut Audit, m: &Mapped, label: &str, limits: &Limits) {
    let q = &m.reading.quality;
    if let Some(check) = &m.reading.motion {
        audit.push(
            "recorded motion against its law",
            label,
            Some(check.error),
            limits.motion,
            "",
            (
                "amplitude, phase and frequency of the steps against the declared ones",
                "the steps hold another motion than the setup declares",
            ),
        );
        audit.blame(motion_suspect(check, m));
    }
    let window = q.window_change.filter(|_| q.cycles_used == q.cycles);
    audit.push(
        "cycle-to-cycle change",
        label,
        match (q.cycle_change, window) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        },
        limits.cycle_change,
        "",
        (
            if q.cycles > 1 {
                "last cycle against the one before"
            } else {
                "one cycle only: whether the transient is over is not known; record two or more"
            },
            if q.cycles_used == q.cycles {
                "discard the first cycle"
            } else {
                "the flow is not periodic yet: record more cycles"
            },
        ),
    );
    let first_in = q.cycles_used == q.cycles && q.cycles > 1;
    audit.blame(first_in.then_some(Suspect::FirstCycle));
    audit.push(
        "residual of the harmonic fit",
        label,
        Some(q.residual),
        limits.residual,
        "",
        (
            "what mean, drift and harmonics leave, over the fundamental",
            "noise, a transient, a wrong frequency, or more harmonics than were fitted",
        ),
    );
    let higher = q.higher.iter().copied().fold(0.0, f64::max);
    audit.push(
        "higher harmonics over the fundamental",
        label,
        Some(higher),
        f64::INFINITY,
        "",
        (
            "kept and shown; large ones say that the motion is not small for this flow",
            "",
        ),
    );
    audit.push(
        "steps that did not converge",
        label,
        Some(q.unconverged as f64),
        0.0,
        "",
        (
            "every step of the window reached the orders asked",
            "steps of the window stopped before the orders asked: raise the iterations, or ask for less",
        ),
    );
}

/// What a difference of declared and sampled motion looks like.
fn motion_suspect(check: &MotionCheck, m: &Mapped) -> Option<Suspect> {
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < 0.01;
    let ratio = check.sampled_omega_rad_s / check.declared_omega_rad_s;
    let scale = m.reading.references.speed_m_s / m.reading.references.reference_semichord_m;
    if near(ratio, scale) && !near(ratio, 1.0) {
        return Some(Suspect::ReducedForCircular);
    }
    if near(ratio, 2.0) || near(ratio, 0.5) {
        return Some(Suspect::HalfReferenceLength);
    }
    if !near(ratio, 1.0) || check.declared.norm() == 0.0 {
        return None;
    }
    let factor = check.sampled / check.declared;
    let degrees = 180.0 / std::f64::consts::PI;
    if near(factor.norm(), degrees) || near(factor.norm(), 1.0 / degrees) {
        return Some(Suspect::DegreesForRadians);
    }
    let turn = factor.arg().abs();
    if (turn - std::f64::consts::FRAC_PI_2).abs() < 0.02 {
        return Some(Suspect::SineForCosine);
    }
    let step = check.sampled_omega_rad_s * m.reading.quality.time_step_s;
    near(turn, step).then_some(Suspect::StepShift)
}

#[expect(clippy::too_many_arguments, reason = "one check over all that is known of a reading")]
fn against_lattice(
    audit: &mut Audit,
    aerodynamics: &Aerodynamics,
    mach: f64,
    references: &References,
    m: &Mapped,
    label: &str,
    area: &[f64],
    limits: &Limits,
) -> Result<(), AicError> {
    let k = m.reading.k;
    // The reduced frequency that the pressures would have if omega held k: next to none.
    let quasi_steady = k * aerodynamics.semichord() / m.reading.references.speed_m_s;
    let ks = [k, 0.5 * k, 2.0 * k, quasi_steady];
    let linear = aerodynamics.pressures(mach, &ks, &references.motion)?;
    let column = |i: usize| linear[i].column(m.coordinate).to_vec();
    let other = |suspect, i| Alternative {
        suspect,
        linear: column(i),
    };
    let alternatives = if k > 0.0 {
        vec![
            other(Suspect::HalfReferenceLength, 1),
            other(Suspect::HalfReferenceLength, 2),
            other(Suspect::ReducedForCircular, 3),
        ]
    } else {
        Vec::new()
    };
    let step = m.reading.omega_rad_s * m.reading.quality.time_step_s;
    let own = column(0);
    let found = suspect::find(&m.dcp, &own, &alternatives, step, area);
    audit.push(
        "pressures explained by a mistake",
        label,
        Some(if found.is_some() { 1.0 } else { 0.0 }),
        0.0,
        "",
        (
            "no single factor, sign, phase or frequency turns the linear pressures into these",
            "the linear lattice with that mistake explains the pressures far better than without it",
        ),
    );
    audit.blame(found.map(|f| f.0));
    let phases = strip_phases(aerodynamics, &m.dcp, &own);
    let size = |v: [f64; 2]| v[0].hypot(v[1]);
    let largest = phases
        .iter()
        .fold(0.0_f64, |w, p| w.max(size(p.linear)).max(size(p.recorded)));
    // Strips that carry next to nothing have no phase to speak of.
    let worst = phases
        .iter()
        .filter(|p| size(p.linear) > 0.1 * largest || size(p.recorded) > 0.1 * largest)
        .map(|p| {
            let d = (p.recorded_deg - p.linear_deg).rem_euclid(360.0);
            d.min(360.0 - d)
        })
        .fold(0.0, f64::max);
    audit.push(
        "phase of section lift against the lattice",
        label,
        Some(worst),
        limits.phase_deg,
        "deg",
        (
            "largest difference along the span",
            "the pressures lead or lag the lattice's: frequency, time origin, or a shock that lags by this much",
        ),
    );
    audit.blame(found.map(|f| f.0));
    Ok(())
}

fn weights(audit: &mut Audit, correction: &Correction, area: &[f64], limits: &Limits) {
    let total: f64 = area.iter().sum();
    for at in &correction.recordings {
        let away: Vec<f64> = at
            .weight
            .ratio
            .iter()
            .map(|w| (w - c64::new(1.0, 0.0)).norm())
            .collect();
        let mean = (away.iter().zip(area).map(|(w, a)| w * w * a).sum::<f64>() / total).sqrt();
        let worst = (0..away.len())
            .max_by(|i, j| away[*i].total_cmp(&away[*j]))
            .unwrap_or(0);
        let treated = at.weight.treatment.iter().filter(|t| **t != Treatment::Ratio).count();
        let at_worst = format!(
            "root mean square of |W - 1|; worst box {worst} with W = {:.3} {:+.3} i; {treated} boxes bounded or additive",
            at.weight.ratio[worst].re, at.weight.ratio[worst].im
        );
        let cause =
            format!("{at_worst}. Weights are 1 give or take 1: look at the checks above for units, phase and signs");
        audit.push(
            "weights W on the downwash",
            &format!("k = {:.4}", at.k),
            Some(mean),
            limits.weight,
            "",
            (&at_worst, &cause),
        );
    }
}

/// Limit k -> 0 against the steady slope.
fn steady(audit: &mut Audit, aerodynamics: &Aerodynamics, mapped: &[Mapped], references: &References, limits: &Limits) {
    let main = |m: &&Mapped| m.coordinate == references.main && !m.repeated;
    let slope = mapped.iter().filter(main).find(|m| m.reading.k == 0.0);
    let lowest = mapped
        .iter()
        .filter(main)
        .filter(|m| m.reading.k > 0.0)
        .min_by(|a, b| a.reading.k.total_cmp(&b.reading.k));
    let lift = |m: &Mapped| -> c64 {
        strip_loads_of_boxes(aerodynamics.lattice(), &m.dcp)
            .lift_m2
            .iter()
            .sum()
    };
    let value = match (slope, lowest) {
        (Some(s), Some(l)) => Some((lift(l).re / lift(s).re - 1.0).abs()),
        _ => None,
    };
    // Lift falls with k: the farther the lowest recording is from zero, the more difference is natural.
    let k = lowest.map_or(0.0, |l| l.reading.k);
    audit.push(
        "in-phase lift at the lowest k against the steady slope",
        &lowest.map_or_else(|| "all".to_owned(), subject),
        value,
        limits.steady + 2.0 * k,
        "",
        (
            if value.is_some() {
                "limit widened by 2 k"
            } else {
                "no steady slope recorded"
            },
            "recordings of different flows, or a slope taken over too large an angle",
        ),
    );
}

/// Two amplitudes of the same motion and frequency.
fn linearity(audit: &mut Audit, mapped: &[Mapped], area: &[f64], limits: &Limits) {
    let mut found = false;
    for small in mapped.iter().filter(|m| m.repeated) {
        let large = mapped.iter().find(|m| {
            !m.repeated
                && m.coordinate == small.coordinate
                && (m.reading.k - small.reading.k).abs() <= 1e-3 * m.reading.k
        });
        let Some(large) = large.filter(|l| (l.reading.amplitude / small.reading.amplitude - 1.0).abs() > 0.05) else {
            continue;
        };
        found = true;
        let difference: Vec<c64> = small.dcp.iter().zip(&large.dcp).map(|(a, b)| a - b).collect();
        let value = crate::weight::rms(&difference, area) / crate::weight::rms(&small.dcp, area);
        audit.push(
            "linearity: smaller against larger amplitude",
            &subject(small),
            Some(value),
            limits.linearity,
            "",
            (
                "difference of pressures per unit of the motion",
                "the amplitude is too large for this flow: take the smaller one",
            ),
        );
    }
    if !found {
        audit.push(
            "linearity: smaller against larger amplitude",
            "all",
            None,
            limits.linearity,
            "",
            ("no second amplitude recorded", ""),
        );
    }
}
