//! Every method on pressures that are known: the lattice's own, those of a known weight, those of every mode.

use super::wing::{
    MACH, OMEGA_RAD_S, SEMICHORD_M, SPEED_M_S, bridge, known_weight, largest, modes, moving_mode, pitching, wing,
};
use dip_correct::apply::{Corrected, correct};
use dip_correct::audit::{Limits, Verdict, audit};
use dip_correct::reading::ReadingSettings;
use dip_correct::sample::Rule;
use dip_correct::synthetic::{Disturbance, Synthetic};
use dip_correct::weight::Treatment;
use dip_correct::weight::schedule::Place;
use dip_correct::{CorrectError, Correction, Method, Settings};
use dip_dlm::aic::Aerodynamics;
use dip_dlm::{ComplexMatrix, c64};
use dip_record::Recording;

const K: [f64; 5] = [0.0, 0.05, 0.15, 0.3, 0.6];
const NOT_FULL: [Method; 8] = [
    Method::Downwash,
    Method::DownwashSteady,
    Method::PressureRatio,
    Method::Force,
    Method::ForceSteady,
    Method::Additive,
    Method::Mode,
    Method::DauGarner,
];

fn run(wing: &Aerodynamics, recordings: &[Recording], methods: &[Method]) -> Correction {
    let (references, _) = bridge(wing, recordings, &ReadingSettings::default());
    correct(wing, &modes(wing), MACH, &K, &references, methods, Settings::default()).unwrap()
}

fn distance(a: &ComplexMatrix, b: &ComplexMatrix) -> f64 {
    let away: f64 = a.data().iter().zip(b.data()).map(|(x, y)| (x - y).norm_sqr()).sum();
    away.sqrt() / b.norm()
}

fn worst(correction: &Correction, corrected: &Corrected) -> f64 {
    largest(corrected.q.iter().zip(&correction.linear).map(|(q, l)| distance(q, l)))
}

#[test]
fn every_method_leaves_the_lattice_alone_when_fed_its_own_pressures() {
    let wing = wing();
    let correction = run(&wing, &[pitching(&wing).record().unwrap()], &NOT_FULL);
    for at in &correction.recordings {
        let away = largest(at.weight.ratio.iter().map(|w| (w - c64::new(1.0, 0.0)).norm()));
        assert!(away < 1e-9, "W_T = 1: {away}");
        assert_eq!(at.weight.treated(), 0);
    }
    for corrected in &correction.methods {
        assert!(worst(&correction, corrected) < 1e-9, "{:?}", corrected.method);
        for r in &corrected.reproduction {
            assert!(r.error < 1e-10, "{:?} {r:?}", corrected.method);
        }
    }
}

#[test]
fn offset_drift_and_higher_harmonics_do_not_matter() {
    let wing = wing();
    let disturbed = Synthetic {
        phase_rad: 0.7,
        disturbance: Disturbance {
            offset: 2.0,
            drift_per_s: 3.0,
            second: 1.5,
            ..Disturbance::default()
        },
        ..pitching(&wing)
    };
    let correction = run(&wing, &[disturbed.record().unwrap()], &[Method::Downwash]);
    let away = largest(
        correction.recordings[0]
            .weight
            .ratio
            .iter()
            .map(|w| (w - c64::new(1.0, 0.0)).norm()),
    );
    assert!(away < 1e-8, "{away}");
}

#[test]
fn noise_and_transient_change_weights_by_no_more_than_their_size() {
    let wing = wing();
    for noise in [1e-3, 1e-2] {
        let noisy = Synthetic {
            disturbance: Disturbance {
                noise,
                ..Disturbance::default()
            },
            ..pitching(&wing)
        };
        let (references, _) = bridge(&wing, &[noisy.record().unwrap()], &ReadingSettings::default());
        let exact = noisy.pressures().unwrap();
        // Two sides, two halves of unequal use: the standard error of an amplitude is noise sqrt(2/3) / sqrt(N / 2) a face.
        let away = largest(
            references.pressures[0]
                .dcp
                .iter()
                .zip(&exact)
                .map(|(a, b)| (a - b).norm()),
        );
        assert!(away > 0.02 * noise && away < 2.0 * noise, "{away} {noise}");
    }
    let late = |cycles| Synthetic {
        cycles,
        disturbance: Disturbance {
            transient: 5.0,
            ..Disturbance::default()
        },
        ..pitching(&wing)
    };
    let error = |cycles| {
        let (references, _) = bridge(&wing, &[late(cycles).record().unwrap()], &ReadingSettings::default());
        let exact = late(cycles).pressures().unwrap();
        largest(
            references.pressures[0]
                .dcp
                .iter()
                .zip(&exact)
                .map(|(a, b)| (a - b).norm()),
        )
    };
    // e^-4 a cycle.
    assert!(
        error(4) < 0.03 * error(3) && error(4) < 1e-4,
        "{} {}",
        error(3),
        error(4)
    );
}

#[test]
fn a_known_weight_is_recovered() {
    let wing = wing();
    let weight = known_weight(&wing);
    let weighted = Synthetic {
        weight: weight.clone(),
        ..pitching(&wing)
    };
    let correction = run(&wing, &[weighted.record().unwrap()], &NOT_FULL);
    for (found, known) in correction.recordings[0].weight.ratio.iter().zip(&weight) {
        assert!((found - known).norm() < 1e-9);
    }
    // And with it the forces of other motions, which the weight was put on as well.
    let k = weighted.omega_rad_s * SEMICHORD_M / SPEED_M_S;
    let at = correction.k.iter().position(|x| (x - k).abs() < 1e-12).unwrap();
    let mut wash = modes(&wing).downwash(k / SEMICHORD_M);
    let n = weight.len();
    for (i, w) in wash.data_mut().iter_mut().enumerate() {
        *w *= weight[i % n];
    }
    wing.factor(MACH, k).unwrap().solve_in_place(&mut wash).unwrap();
    let exact = dip_dlm::gaf::generalized_force(&wing, &modes(&wing), &wash).unwrap();
    assert!(distance(&correction.methods[0].q[at], &exact) < 1e-9);
    for corrected in &correction.methods {
        assert!(
            corrected.reproduction.iter().all(|r| r.error < 1e-9),
            "{:?}",
            corrected.method
        );
        let unsteady = !corrected.method.is_steady();
        assert_eq!(unsteady, !corrected.reproduction.is_empty(), "{:?}", corrected.method);
        assert!(
            worst(&correction, corrected) > 1e-3,
            "{:?} corrects something",
            corrected.method
        );
    }
}

#[test]
fn weights_are_interpolated_between_recordings_and_fade_beyond_them() {
    let wing = wing();
    let at = |factor: f64| {
        Synthetic {
            omega_rad_s: factor * OMEGA_RAD_S,
            weight: vec![c64::new(1.0 + 0.1 * factor, 0.05 * factor); wing.lattice().n_boxes()],
            ..pitching(&wing)
        }
        .record()
        .unwrap()
    };
    let correction = run(&wing, &[at(1.0), at(2.0)], &[Method::Downwash]);
    let corrected = &correction.methods[0];
    let k1 = correction.schedule.recorded()[0];
    for (i, &k) in correction.k.iter().enumerate() {
        let place = corrected.place[i];
        let factor = k / k1;
        // A constant weight over the planform is a factor on Q.
        let weight = |f: f64| c64::new(1.0 + 0.1 * f, 0.05 * f);
        let expected = match place {
            Place::Below => c64::new(1.1, 0.05 * factor),
            Place::Recorded => weight(factor),
            Place::Blended => {
                let t = (factor - 2.0) / 2.0;
                let s = 0.5 * (1.0 + (std::f64::consts::PI * t).cos());
                c64::new(1.0, 0.0) + (weight(2.0) - 1.0) * s
            }
            Place::Linear => c64::new(1.0, 0.0),
        };
        let want = ComplexMatrix::from_fn(3, 3, |r, c| correction.linear[i][(r, c)] * expected);
        assert!(distance(&corrected.q[i], &want) < 1e-9, "k = {k} {place:?}");
    }
    let places: Vec<Place> = corrected.place.clone();
    for place in [Place::Below, Place::Recorded, Place::Blended, Place::Linear] {
        assert!(places.contains(&place), "{place:?}");
    }
}

#[test]
fn recordings_of_every_mode_give_the_generalized_forces() {
    let wing = wing();
    let mut recordings = Vec::new();
    for mode in 0..3 {
        for factor in [0.5, 1.0, 2.0] {
            recordings.push(moving_mode(&wing, mode, factor * OMEGA_RAD_S).record().unwrap());
        }
    }
    let (references, _) = bridge(&wing, &recordings, &ReadingSettings::default());
    let methods = [Method::Full, Method::Mode];
    let correction = correct(
        &wing,
        &modes(&wing),
        MACH,
        &K,
        &references,
        &methods,
        Settings::default(),
    )
    .unwrap();
    for corrected in &correction.methods {
        for (i, &k) in correction.k.iter().enumerate() {
            let recorded = correction.schedule.recorded().iter().any(|r| (r - k).abs() < 1e-12);
            let away = distance(&corrected.q[i], &correction.linear[i]);
            // At recorded k to round-off; between them `full` rests on the spline, `mode` on a deviation of zero.
            let limit = match (recorded, corrected.method) {
                (true, _) | (_, Method::Mode) => 1e-9,
                _ => 0.02,
            };
            assert!(away < limit, "{:?} k = {k}: {away}", corrected.method);
        }
    }
}

#[test]
fn replaced_modes_are_exact_and_others_take_their_share() {
    let wing = wing();
    // Mode 1 with a weight, and the pitch without: mode 1's column is the weighted one, the pitch stays linear.
    let weight = known_weight(&wing);
    let weighted = Synthetic {
        weight: weight.clone(),
        ..moving_mode(&wing, 0, OMEGA_RAD_S)
    };
    let correction = run(
        &wing,
        &[pitching(&wing).record().unwrap(), weighted.record().unwrap()],
        &[Method::Mode],
    );
    let k = OMEGA_RAD_S * SEMICHORD_M / SPEED_M_S;
    let at = correction.k.iter().position(|x| (x - k).abs() < 1e-12).unwrap();
    let column = ComplexMatrix::from_columns(weight.len(), 1, weighted.pressures().unwrap()).unwrap();
    let exact = dip_dlm::gaf::generalized_force(&wing, &modes(&wing), &column).unwrap();
    for row in 0..3 {
        let found = correction.methods[0].q[at][(row, 0)];
        assert!((found - exact[(row, 0)]).norm() < 1e-9 * exact.norm());
    }
    assert!(correction.methods[0].reproduction.iter().all(|r| r.error < 1e-10));
}

#[test]
fn vanishing_downwash_is_additive_and_wild_weights_are_bounded_box_by_box() {
    let wing = wing();
    // A wild weight on one box; a weight on a motion whose downwash vanishes on a line.
    let mut weight = vec![c64::new(1.0, 0.0); wing.lattice().n_boxes()];
    weight[17] = c64::new(-60.0, 5.0);
    let wild = Synthetic {
        weight,
        ..pitching(&wing)
    };
    let correction = run(&wing, &[wild.record().unwrap()], &NOT_FULL);
    let at = &correction.recordings[0];
    assert_eq!(at.weight.treatment[17], Treatment::Bounded);
    assert!(((at.weight.ratio[17] - 1.0).norm() - 10.0).abs() < 1e-9);
    assert_eq!(at.weight.treated(), 1);
    for corrected in correction.methods.iter().filter(|m| !m.method.is_steady()) {
        assert!(
            corrected.reproduction.iter().all(|r| r.error < 1e-9),
            "{:?}",
            corrected.method
        );
    }
    // A plunging wing at a low frequency: the downwash i k h / b is small everywhere alike, and still a ratio is safe; a mode
    // with a node line has boxes without downwash.
    let all = modes(&wing);
    let n = all.n_boxes;
    let mut twisting = moving_mode(&wing, 1, OMEGA_RAD_S);
    for i in 0..n {
        if wing.lattice().boxes()[i].span_index == 0 {
            twisting.motion.slope[i] = 0.0;
            twisting.motion.at_control[i] = 0.0;
        }
    }
    let recording = twisting.record().unwrap();
    let (mut references, _) = bridge(&wing, &[recording], &ReadingSettings::default());
    references.motion = twisting.motion.clone();
    references.mode_of = vec![None];
    // Other pressures than the lattice's, so that there is something to add where the downwash is nought.
    for p in &mut references.pressures[0].dcp {
        *p *= c64::new(1.1, 0.05);
    }
    let correction = correct(&wing, &all, MACH, &K, &references, &NOT_FULL, Settings::default()).unwrap();
    let at = &correction.recordings[0];
    for i in 0..n {
        let additive = at.weight.treatment[i] == Treatment::Additive;
        assert_eq!(additive, wing.lattice().boxes()[i].span_index == 0, "box {i}");
    }
    for corrected in correction.methods.iter().filter(|m| !m.method.is_steady()) {
        assert!(
            corrected.reproduction.iter().all(|r| r.error < 1e-9),
            "{:?}",
            corrected.method
        );
        assert!(!corrected.reproduction.is_empty());
    }
}

#[test]
fn full_says_which_modes_are_missing() {
    let wing = wing();
    let (references, _) = bridge(&wing, &[pitching(&wing).record().unwrap()], &ReadingSettings::default());
    let error = correct(
        &wing,
        &modes(&wing),
        MACH,
        &K,
        &references,
        &[Method::Full],
        Settings::default(),
    )
    .unwrap_err();
    assert!(matches!(error, CorrectError::Method { method: "full", .. }));
    assert!(error.to_string().contains("mode 1, 2, 3 has none"), "{error}");
}

#[test]
fn results_do_not_depend_on_threads() {
    let wing = wing();
    let recording = pitching(&wing).record().unwrap();
    let q = |threads: usize| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
            .install(|| {
                run(&wing, std::slice::from_ref(&recording), &NOT_FULL)
                    .methods
                    .into_iter()
                    .map(|m| m.q)
                    .collect::<Vec<_>>()
            })
    };
    assert_eq!(q(1), q(3));
}

#[test]
fn a_good_recording_passes_the_audit() {
    let wing = wing();
    let recordings = [
        pitching(&wing).record().unwrap(),
        Synthetic {
            amplitude: 0.5_f64.to_radians(),
            ..pitching(&wing)
        }
        .record()
        .unwrap(),
    ];
    let (references, mapped) = bridge(&wing, &recordings, &ReadingSettings::default());
    let correction = correct(
        &wing,
        &modes(&wing),
        MACH,
        &K,
        &references,
        &NOT_FULL,
        Settings::default(),
    )
    .unwrap();
    let audit = audit(
        &wing,
        MACH,
        &references,
        &mapped,
        &correction,
        Rule::Conservative,
        &Limits::default(),
    )
    .unwrap();
    for check in &audit.checks {
        assert_ne!(check.verdict, Verdict::Fail, "{check:?}");
    }
    for name in [
        "recorded motion against its law",
        "cycle-to-cycle change",
        "residual of the harmonic fit",
        "phase of section lift against the lattice",
        "weights W on the downwash",
        "strip lift and moment before and after mapping",
        "reference motion reproduced",
        "linearity: smaller against larger amplitude",
        "condition of the downwash matrix",
    ] {
        assert!(
            audit
                .checks
                .iter()
                .any(|c| c.name == name && c.verdict == Verdict::Pass),
            "{name}"
        );
    }
}
