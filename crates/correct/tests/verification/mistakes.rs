//! The mistakes of the thesis, each put into a recording: caught by the audit, and named.

use super::wing::{MACH, OMEGA_RAD_S, SEMICHORD_M, SPEED_M_S, bridge, modes, pitching, wing};
use dip_correct::audit::suspect::Suspect;
use dip_correct::audit::{Audit, Limits, Verdict, audit};
use dip_correct::bridge::check_match;
use dip_correct::reading::ReadingSettings;
use dip_correct::sample::Rule;
use dip_correct::synthetic::{Disturbance, Synthetic};
use dip_correct::{Method, Settings, correct};
use dip_dlm::aic::Aerodynamics;
use dip_record::{Law, Recording};

fn audited(wing: &Aerodynamics, recording: Recording, settings: &ReadingSettings) -> Audit {
    let (references, mapped) = bridge(wing, &[recording], settings);
    let k = [0.05, 0.2];
    let correction = correct(
        wing,
        &modes(wing),
        MACH,
        &k,
        &references,
        &[Method::Downwash],
        Settings::default(),
    )
    .unwrap();
    audit(
        wing,
        MACH,
        &references,
        &mapped,
        &correction,
        Rule::Conservative,
        &Limits::default(),
    )
    .unwrap()
}

#[track_caller]
fn names(audit: &Audit, suspect: Suspect) {
    assert!(audit.failed(), "not caught: {:#?}", audit.checks);
    assert_eq!(audit.suspects(), [suspect], "{:#?}", audit.checks);
    let named = audit
        .checks
        .iter()
        .any(|c| c.verdict == Verdict::Fail && c.words.starts_with(suspect.words()));
    assert!(named, "{:#?}", audit.checks);
}

fn harmonic(recording: &mut Recording) -> &mut dip_record::Harmonic {
    match &mut recording.setup.motion[0].law {
        Law::Harmonic { harmonics, .. } => &mut harmonics[0],
        other => panic!("{other:?}"),
    }
}

fn plain() -> ReadingSettings {
    ReadingSettings::default()
}

#[test]
fn k_declared_for_omega() {
    let wing = wing();
    let mut recording = pitching(&wing).record().unwrap();
    harmonic(&mut recording).omega_rad_s = OMEGA_RAD_S * SEMICHORD_M / SPEED_M_S;
    names(&audited(&wing, recording, &plain()), Suspect::ReducedForCircular);
}

#[test]
fn k_used_for_omega_by_the_flow_solver() {
    // The motion ran at omega = k: next to steady. The recording says omega.
    let wing = wing();
    let mut recording = Synthetic {
        omega_rad_s: OMEGA_RAD_S * SEMICHORD_M / SPEED_M_S,
        ..pitching(&wing)
    }
    .record()
    .unwrap();
    let stretch = SEMICHORD_M / SPEED_M_S;
    retime(&mut recording, stretch);
    names(&audited(&wing, recording, &plain()), Suspect::ReducedForCircular);
}

fn retime(recording: &mut Recording, factor: f64) {
    harmonic(recording).omega_rad_s /= factor;
    recording.setup.references.time_step_s *= factor;
    for step in &mut recording.steps {
        step.time_s *= factor;
        step.motion[0].rate /= factor;
    }
}

#[test]
fn half_the_reference_length_in_the_time_scale() {
    // Time came out in half chords: every instant is half of what it was, so pressures of k stand at 2 k.
    let wing = wing();
    for factor in [0.5, 2.0] {
        let mut recording = pitching(&wing).record().unwrap();
        retime(&mut recording, factor);
        names(&audited(&wing, recording, &plain()), Suspect::HalfReferenceLength);
    }
}

#[test]
fn half_the_reference_length_in_the_declared_frequency() {
    let wing = wing();
    for factor in [0.5, 2.0] {
        let mut recording = pitching(&wing).record().unwrap();
        harmonic(&mut recording).omega_rad_s *= factor;
        names(&audited(&wing, recording, &plain()), Suspect::HalfReferenceLength);
    }
}

#[test]
fn half_the_semichord_declared() {
    let wing = wing();
    let mut recording = pitching(&wing).record().unwrap();
    recording.setup.references.reference_semichord_m *= 0.5;
    let error = check_match(&recording, "pitch.mcap", &wing, MACH)
        .unwrap_err()
        .to_string();
    assert!(error.contains("0.139675") && error.contains("0.27935"), "{error}");
    assert!(error.contains("half instead of full reference length"), "{error}");
}

#[test]
fn sine_for_cosine() {
    let wing = wing();
    // In the declared law.
    let mut recording = pitching(&wing).record().unwrap();
    harmonic(&mut recording).phase_rad = std::f64::consts::FRAC_PI_2;
    names(&audited(&wing, recording, &plain()), Suspect::SineForCosine);
    // In the recorded motion: law and steps agree, the pressures know better.
    let mut recording = pitching(&wing).record().unwrap();
    harmonic(&mut recording).phase_rad = std::f64::consts::FRAC_PI_2;
    let law = recording.setup.motion[0].law.clone();
    for step in &mut recording.steps {
        step.motion[0] = law.at(step.time_s).unwrap();
    }
    names(&audited(&wing, recording, &plain()), Suspect::SineForCosine);
}

#[test]
fn one_step_between_motion_and_pressures() {
    let wing = wing();
    for forward in [true, false] {
        let mut recording = pitching(&wing).record().unwrap();
        let pressures: Vec<_> = recording.steps.iter().map(|s| s.pressures.clone()).collect();
        let n = pressures.len();
        for (i, step) in recording.steps.iter_mut().enumerate() {
            let from = if forward {
                (i + 1).min(n - 1)
            } else {
                i.saturating_sub(1)
            };
            step.pressures = pressures[from].clone();
        }
        if forward {
            recording.steps.pop();
        }
        names(&audited(&wing, recording, &plain()), Suspect::StepShift);
    }
    // In the motion alone, against its law.
    let mut recording = pitching(&wing).record().unwrap();
    let law = recording.setup.motion[0].law.clone();
    let dt = recording.setup.references.time_step_s;
    for step in &mut recording.steps {
        step.motion[0] = law.at(step.time_s - dt).unwrap();
    }
    names(&audited(&wing, recording, &plain()), Suspect::StepShift);
}

#[test]
fn degrees_for_radians() {
    let wing = wing();
    // Declared in degrees, moved in radians.
    let mut recording = pitching(&wing).record().unwrap();
    harmonic(&mut recording).amplitude = 1.0;
    names(&audited(&wing, recording, &plain()), Suspect::DegreesForRadians);
    // Law and steps in degrees.
    let mut recording = pitching(&wing).record().unwrap();
    harmonic(&mut recording).amplitude = 1.0;
    for step in &mut recording.steps {
        step.motion[0].value = step.motion[0].value.to_degrees();
    }
    names(&audited(&wing, recording, &plain()), Suspect::DegreesForRadians);
}

#[test]
fn upper_and_lower_swapped() {
    let wing = wing();
    let mut recording = pitching(&wing).record().unwrap();
    for step in &mut recording.steps {
        step.pressures.swap(0, 1);
    }
    names(&audited(&wing, recording, &plain()), Suspect::SidesSwapped);
}

#[test]
fn first_cycle_not_discarded() {
    let wing = wing();
    let recording = Synthetic {
        disturbance: Disturbance {
            transient: 5.0,
            ..Disturbance::default()
        },
        cycles: 4,
        ..pitching(&wing)
    }
    .record()
    .unwrap();
    let all = ReadingSettings {
        cycles: 0,
        ..ReadingSettings::default()
    };
    names(&audited(&wing, recording.clone(), &all), Suspect::FirstCycle);
    // With the last cycle alone nothing is wrong.
    let audit = audited(&wing, recording, &plain());
    assert!(!audit.failed(), "{:#?}", audit.checks);
}
