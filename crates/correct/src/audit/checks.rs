//! The single checks.

use super::suspect::{self, Alternative, Suspect};
use super::{Audit, Limits, strip_phases};
use crate::apply::{Correction, Method, References};
use crate::bridge::Mapped;
use crate::reading::MotionCheck;
use crate::sample::strip_loads_of_boxes;
use crate::weight::Treatment;
use dip_dlm::aic::{Aerodynamics, AicError};
use dip_dlm::c64;

pub(super) fn subject(m: &Mapped) -> String {
    format!("{}: {}, k = {:.4}", m.reading.label, m.reading.name, m.reading.k)
}

pub(super) fn harmonic(audit: &mut Audit, m: &Mapped, label: &str, limits: &Limits) {
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
pub(super) fn against_lattice(
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

/// How much the weights change the reference motion's downwash, root mean square over that of the downwash: where a mode
/// hardly moves, a large ratio changes little.
pub(super) fn weights(
    audit: &mut Audit,
    correction: &Correction,
    references: &References,
    area: &[f64],
    b_m: f64,
    limits: &Limits,
) {
    // Methods that replace pressures of modes use no weights: nothing they rest on would be judged.
    let replaced = |m: Method| matches!(m, Method::Mode | Method::Full);
    if !correction.methods.is_empty() && correction.methods.iter().all(|c| replaced(c.method)) {
        return;
    }
    for at in &correction.recordings {
        let wash = references.motion.downwash(at.k / b_m);
        let wash = wash.column(references.main);
        let sum = |of: &dyn Fn(usize) -> f64| -> f64 { (0..area.len()).map(|i| area[i] * of(i)).sum() };
        let away: Vec<f64> = at
            .weight
            .ratio
            .iter()
            .map(|w| (w - c64::new(1.0, 0.0)).norm())
            .collect();
        let change = sum(&|i| (away[i] * wash[i].norm()).powi(2));
        let mean = (change / sum(&|i| wash[i].norm_sqr()).max(f64::MIN_POSITIVE)).sqrt();
        let worst = (0..away.len())
            .max_by(|i, j| away[*i].total_cmp(&away[*j]))
            .unwrap_or(0);
        let treated = at.weight.treatment.iter().filter(|t| **t != Treatment::Ratio).count();
        let at_worst = format!(
            "change of the downwash, root mean square over the downwash; worst box {worst} with W = {:.3} {:+.3} i; {treated} boxes bounded or additive",
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
pub(super) fn steady(
    audit: &mut Audit,
    aerodynamics: &Aerodynamics,
    mapped: &[Mapped],
    references: &References,
    limits: &Limits,
) {
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
pub(super) fn linearity(audit: &mut Audit, mapped: &[Mapped], area: &[f64], limits: &Limits) {
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
