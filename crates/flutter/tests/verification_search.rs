//! The search for the neutral point and the damping of a running record, against known dampings.

use std::f64::consts::TAU;

use dip_flutter::decay::{DecaySettings, Reading, Watch, WatchSettings, limit_cycle};
use dip_flutter::search::{Rate, Search, SearchSettings, SearchStep, Stability, StaticLimit, Trial};

fn settings(first: f64) -> SearchSettings {
    SearchSettings {
        range: [0.02, 1.0],
        first,
        tolerance: 0.01,
        most_runs: 12,
    }
}

/// Runs a search on a damping that is a known function; returns its end and the values that were run.
fn search(first: f64, run: impl Fn(f64) -> Stability) -> (SearchStep, Vec<f64>) {
    let mut search = Search::new(settings(first), Vec::new()).unwrap();
    loop {
        match search.next() {
            SearchStep::Run(at) => search.add(Trial { at, stability: run(at) }).unwrap(),
            end => return (end, search.trials().iter().map(|t| t.at).collect()),
        }
    }
}

fn oscillation(g: f64) -> Stability {
    Stability::Oscillation {
        g,
        g_error: 1e-4,
        freq_hz: 15.0,
    }
}

/// Damping of a march of AGARD 445.6 in kind: nearly flat at low density, falling ever faster, neutral at 0.2.
fn like_agard(rho: f64) -> f64 {
    let x = rho / 0.2;
    -0.3 * x * (1.0 - x.powi(3))
}

#[test]
fn few_runs_find_the_neutral_point_from_either_side() {
    for first in [0.05, 0.12, 0.18, 0.199, 0.22, 0.4] {
        let (end, runs) = search(first, |rho| oscillation(like_agard(rho)));
        let SearchStep::Found(found) = end else {
            panic!("{first}: {end:?}")
        };
        assert!((found.at / 0.2 - 1.0).abs() < 0.01, "{first}: {found:?}");
        assert!((found.at - 0.2).abs() < 2.5 * found.error, "{first}: {found:?}");
        let most = if (0.12..=0.22).contains(&first) { 4 } else { 7 };
        assert!(runs.len() <= most, "{first}: {runs:?}");
    }
}

#[test]
fn a_point_is_not_extrapolated_from_runs_on_one_side() {
    // Two stable runs that a line carries far beyond the neutral point: the damping falls ever faster.
    let bent = |rho: f64| -0.02 * (1.0 - (rho / 0.2).powi(12));
    for first in [0.1, 0.15, 0.17, 0.19, 0.21, 0.23] {
        let (end, runs) = search(first, |rho| oscillation(bent(rho)));
        let SearchStep::Found(found) = end else {
            panic!("{first}: {end:?}")
        };
        assert!((found.at / 0.2 - 1.0).abs() < 0.01, "{first}: {found:?} {runs:?}");
        let nearest = runs.iter().map(|r| (r / found.at - 1.0).abs()).fold(f64::MAX, f64::min);
        assert!(found.bracketed || nearest <= 0.005, "{first}: {found:?} {runs:?}");
    }
}

#[test]
fn two_runs_far_apart_are_not_enough_where_the_slope_doubles_between_them() {
    // Dampings of the AGARD wing at Mach 0.678: the line through the outer two crosses zero 2.3 % too low.
    let agard = |rho: f64| {
        let x = rho - 0.20821;
        -0.0640 + 3.5 * x + 62.0 * x * x
    };
    let (end, runs) = search(0.20821, |rho| oscillation(agard(rho)));
    let SearchStep::Found(found) = end else {
        panic!("{end:?}")
    };
    let exact = 0.20821 + (-3.5 + (3.5_f64.powi(2) + 4.0 * 62.0 * 0.0640).sqrt()) / (2.0 * 62.0);
    assert!((found.at / exact - 1.0).abs() < 0.005, "{found:?} {exact} {runs:?}");
    assert!(
        (found.at - exact).abs() < 2.5 * found.error,
        "{found:?} {exact} {runs:?}"
    );
    assert!(runs.len() <= 4, "{runs:?}");
}

#[test]
fn errors_of_the_dampings_widen_the_answer_and_cost_runs_but_do_not_mislead() {
    // Dampings off by a fixed pattern of one standard error.
    let sign = |rho: f64| {
        if ((1e4 * rho) as u64).is_multiple_of(2) {
            1.0
        } else {
            -1.0
        }
    };
    let (end, _) = search(0.15, |rho| Stability::Oscillation {
        g: like_agard(rho) + 0.004 * sign(rho),
        g_error: 0.004,
        freq_hz: 15.0,
    });
    let SearchStep::Found(found) = end else {
        panic!("{end:?}")
    };
    assert!((found.at - 0.2).abs() < 2.5 * found.error, "{found:?}");
    assert!(found.error > 5e-4, "{found:?}");
}

#[test]
fn dampings_that_are_not_known_well_enough_do_not_keep_a_search_going() {
    // g = (x - 0.2) with an error that allows 5 % at best, where 1 % is asked for.
    let blurred = |g_error: f64| {
        move |x: f64| Stability::Oscillation {
            g: x - 0.2,
            g_error,
            freq_hz: 15.0,
        }
    };
    let (end, runs) = search(0.15, blurred(0.01));
    let SearchStep::OutOfRuns(Some(found)) = end else {
        panic!("{end:?}")
    };
    assert!((found.at - 0.2).abs() < 1e-9 && found.error > 0.005, "{found:?}");
    assert!(runs.len() < 6, "{runs:?}");
    // With the accuracy that the search asks for, it ends.
    let mut search = Search::new(settings(0.15), Vec::new()).unwrap();
    let end = loop {
        match search.next() {
            SearchStep::Run(at) => {
                let stability = blurred(search.damping_accuracy().unwrap_or(0.01))(at);
                search.add(Trial { at, stability }).unwrap();
            }
            end => break end,
        }
    };
    assert!(matches!(end, SearchStep::Found(_)), "{end:?}");
}

#[test]
fn an_interrupted_search_goes_on_to_the_same_values() {
    let (_, whole) = search(0.1, |rho| oscillation(like_agard(rho)));
    for done in 0..whole.len() {
        let finished = whole[..done]
            .iter()
            .map(|&at| Trial {
                at,
                stability: oscillation(like_agard(at)),
            })
            .collect();
        let resumed = Search::new(settings(0.1), finished).unwrap();
        assert_eq!(resumed.next(), SearchStep::Run(whole[done]));
    }
}

#[test]
fn a_mode_that_is_less_stable_far_away_does_not_mislead_the_trend() {
    // A second mode at 90 Hz whose damping hardly changes: the least stable one below a density of 0.186.
    for first in [0.05, 0.1, 0.15, 0.18, 0.25] {
        let (end, runs) = search(first, |rho| match like_agard(rho) {
            g if g > -0.05 => oscillation(g),
            _ => Stability::Oscillation {
                g: -0.05 - 0.01 * rho,
                g_error: 1e-4,
                freq_hz: 90.0,
            },
        });
        let SearchStep::Found(found) = end else {
            panic!("{first}: {end:?}")
        };
        assert!((found.at - 0.2).abs() < 2.5 * found.error, "{first}: {found:?}");
        assert!((found.freq_hz - 15.0).abs() < 0.1, "{first}: {found:?}");
        assert!(runs.len() <= 8, "{first}: {runs:?}");
    }
}

#[test]
fn a_first_value_far_beyond_flutter_where_another_motion_grows_faster_does_not_hide_it() {
    // As a rectangular wing at twice its flutter speed: a slow motion that is about to diverge outgrows the flutter of 15 Hz.
    let (end, runs) = search(0.6, |rho| match rho {
        x if x > 0.5 => Stability::Divergence(None),
        x if x > 0.3 => Stability::Oscillation {
            g: 2.0,
            g_error: 1e-3,
            freq_hz: 5.0,
        },
        _ => oscillation(0.8 * (rho - 0.2)),
    });
    let SearchStep::Found(found) = end else {
        panic!("{end:?} after {runs:?}")
    };
    assert!(
        (found.at - 0.2).abs() < 2.0 * found.error.max(1e-4),
        "{found:?} after {runs:?}"
    );
}

#[test]
fn ends_of_the_range_divergence_and_the_last_run_are_said() {
    let (end, _) = search(0.5, |_| oscillation(-0.05));
    assert_eq!(end, SearchStep::StableThroughout);
    let (end, _) = search(0.5, |_| oscillation(0.05));
    assert_eq!(end, SearchStep::UnstableThroughout);
    // Divergence at 0.3 while every oscillation is damped.
    let (end, _) = search(0.1, |rho| {
        if rho > 0.3 {
            Stability::Divergence(None)
        } else {
            oscillation(-0.05)
        }
    });
    let SearchStep::Divergence(StaticLimit {
        between: [below, above],
        point: None,
    }) = end
    else {
        panic!("{end:?}")
    };
    assert!(
        below <= 0.3 && 0.3 < above && above - below < 0.01 * above,
        "{below} {above}"
    );
    let mut few = settings(0.1);
    few.most_runs = 1;
    let one = Trial {
        at: 0.1,
        stability: oscillation(-0.1),
    };
    assert_eq!(Search::new(few, vec![one]).unwrap().next(), SearchStep::OutOfRuns(None));
}

#[test]
fn meaningless_settings_are_refused() {
    for change in [
        |s: &mut SearchSettings| s.range = [0.0, 1.0],
        |s: &mut SearchSettings| s.range = [0.3, 0.2],
        |s: &mut SearchSettings| s.first = 2.0,
        |s: &mut SearchSettings| s.tolerance = 0.0,
        |s: &mut SearchSettings| s.most_runs = 0,
    ] {
        let mut wrong = settings(0.1);
        change(&mut wrong);
        assert!(Search::new(wrong, Vec::new()).is_err());
    }
    let mut search = Search::new(settings(0.1), Vec::new()).unwrap();
    let nan = Trial {
        at: 0.1,
        stability: oscillation(f64::NAN),
    };
    assert!(search.add(nan).is_err());
}

/// Two modes as a march shows them: 14 Hz with damping g in both coordinates, 40 Hz well damped, an answer of the flow that
/// dies out, and noise of a part in 10^4.
fn sample(g: f64, n: usize, dt: f64) -> [f64; 2] {
    let t = n as f64 * dt;
    let (w1, w2) = (14.0 * TAU, 40.0 * TAU);
    let first = (0.5 * g * w1 * t).exp();
    let second = (-0.05 * w2 * t).exp();
    let noise = 1e-4 * ((n * n) as f64 * 0.7).sin();
    [
        first * (w1 * t).sin() + 0.1 * second * (w2 * t).cos() + 0.05 * (-80.0 * t).exp() + noise,
        0.2 * first * (w1 * t + 0.8).sin() + 0.3 * second * (w2 * t).sin() + 0.3 * noise,
    ]
}

#[test]
fn damping_is_known_after_one_to_three_cycles_and_right() {
    for g in [-0.08, -0.02, -0.004, 0.003, 0.03] {
        let dt = 1.0 / 14.0 / 40.0;
        let settings = WatchSettings::new(dt, vec![10.0 * TAU, 38.0 * TAU], vec![1.0, 1.0]);
        let needed = settings.accuracy.max(settings.relative * f64::abs(g));
        let mut watch = Watch::new(settings).unwrap();
        let known = (0..200).find_map(|n| {
            let reading = watch.push(&sample(g, n, dt))?;
            reading.known.then(|| (n, reading.clone()))
        });
        let (n, reading) = known.unwrap();
        assert!((50..120).contains(&n), "{g}: {n}");
        let mode = &reading.modes[0];
        assert!((mode.g - g).abs() < 1.5 * needed, "{g}: {mode:?}");
        assert!((mode.freq_hz - 14.0).abs() < 0.05, "{g}: {mode:?}");
        assert!(reading.growth.is_none(), "{g}: {reading:?}");
    }
}

#[test]
fn a_fast_mode_that_is_known_early_does_not_end_a_run_in_which_a_slow_one_may_be_less_stable() {
    let dt = 1.0 / 14.0 / 40.0;
    let mut watch = Watch::new(WatchSettings::new(dt, vec![10.0 * TAU, 90.0 * TAU], vec![1.0, 1.0])).unwrap();
    let known = (0..200).find_map(|n| {
        let t = n as f64 * dt;
        let wave = |hz: f64, g: f64| (0.5 * g * TAU * hz * t).exp() * (TAU * hz * t).sin();
        // Noise of a part in a thousand: the slow mode is hidden in it at first.
        let noise = 1e-3 * ((n * n) as f64 * 0.7).sin();
        let q = [wave(14.0, -0.02) + noise, 0.1 * wave(92.0, -0.05) + 0.1 * noise];
        let reading = watch.push(&q)?;
        reading.known.then(|| reading.modes.clone())
    });
    let modes = known.unwrap();
    assert!(
        (modes[0].freq_hz - 14.0).abs() < 0.5 && (modes[0].g + 0.02).abs() < 0.005,
        "{modes:?}"
    );
}

#[test]
fn growth_without_oscillation_is_seen_and_known() {
    let dt = 1.0 / 14.0 / 40.0;
    let mut watch = Watch::new(WatchSettings::new(dt, vec![10.0 * TAU, 38.0 * TAU], vec![1.0, 1.0])).unwrap();
    let mut known = None;
    for n in 0..100 {
        let t = n as f64 * dt;
        let [a, b] = sample(-0.1, n, dt);
        let reading = watch.push(&[a + 0.2 * (12.0 * t).exp(), b - 0.05 * (12.0 * t).exp()]);
        known = known.or(reading.filter(|r| r.known && r.growth.is_some()).map(|_| n));
    }
    let growth = watch.reading().unwrap().growth.unwrap();
    assert!((growth.rate_1_s - 12.0).abs() < 0.5, "{growth:?}");
    assert!(
        (growth.rate_1_s - 12.0).abs() < 3.0 * growth.rate_error_1_s,
        "{growth:?}"
    );
    assert!(known.is_some());
    // A drift that dies out is none.
    let mut watch = Watch::new(WatchSettings::new(dt, vec![10.0 * TAU, 38.0 * TAU], vec![1.0, 1.0])).unwrap();
    for n in 0..100 {
        let t = n as f64 * dt;
        let [a, b] = sample(-0.1, n, dt);
        watch.push(&[a + 0.2 * (-12.0 * t).exp(), b]);
    }
    assert_eq!(watch.reading().unwrap().growth, None);
}

/// A mode whose stiffness the air takes away, `q'' + 2 zeta w q' + (1 - s) w^2 q = 0`, has the real roots
/// `w (-zeta +- (zeta^2 - 1 + s)^(1/2))` near s = 1 and diverges beyond it, slowly at first, long after all that oscillates has died.
#[test]
fn a_run_does_not_end_before_slow_divergence_is_told_from_a_drift_that_dies_out() {
    let dt = 1.0 / 10.0 / 40.0;
    let (w, zeta) = (10.0 * TAU, 0.3_f64);
    for s in [0.97, 0.99, 1.01, 1.03, 1.1] {
        let root = (zeta * zeta - 1.0 + s).sqrt();
        let rates = [w * (root - zeta), -w * (root + zeta)];
        let mut watch = Watch::new(WatchSettings::new(dt, vec![w, 38.0 * TAU], vec![1.0, 1.0])).unwrap();
        let known = (0..1200).find_map(|n| {
            let t = n as f64 * dt;
            let noise = 1e-5 * ((n * n) as f64 * 0.7).sin();
            // From rest with a velocity, and an oscillation with g = -0.2.
            let slow = (rates[0] * t).exp() - (rates[1] * t).exp();
            let fast = (-0.1 * 38.0 * TAU * t).exp() * (38.0 * TAU * t).sin();
            let reading = watch.push(&[slow + 0.1 * fast + noise, 0.2 * fast - 0.1 * slow + noise])?;
            reading.known.then(|| (n, reading.clone()))
        });
        let (n, reading) = known.unwrap_or_else(|| panic!("{s}: {:?}", watch.reading()));
        assert_eq!(reading.growth.is_some(), s > 1.0, "{s} after {n}: {reading:?}");
        if let Some(growth) = reading.growth {
            let off = growth.rate_1_s - rates[0];
            assert!(
                off.abs() < 4.0 * growth.rate_error_1_s,
                "{s}: {} and {growth:?}",
                rates[0]
            );
        }
    }
}

/// A recorded march: the time step and the generalized coordinates `[step][mode]`.
fn recorded(name: &str) -> (f64, Vec<Vec<f64>>) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/flutter/").to_owned() + name;
    let text = std::fs::read_to_string(&path).unwrap();
    let mut rows: Vec<Vec<f64>> = text
        .lines()
        .filter(|l| !l.starts_with('#'))
        .skip(1)
        .map(|l| l.split(',').map(|v| v.parse().unwrap()).collect())
        .collect();
    let step = rows[1][0] - rows[0][0];
    for row in &mut rows {
        row.remove(0);
    }
    (step, rows)
}

/// The reading by which a watch would have ended a recorded march.
fn known(name: &str, natural_hz: [f64; 4], mass_kg: f64) -> Reading {
    let (step, rows) = recorded(name);
    let settings = WatchSettings::new(step, natural_hz.map(|hz| hz * TAU).to_vec(), vec![mass_kg; 4]);
    let mut watch = Watch::new(settings).unwrap();
    let known = rows.iter().find_map(|q| watch.push(q).filter(|r| r.known).cloned());
    known.unwrap_or_else(|| panic!("{name}: {:?}", watch.reading()))
}

/// The first quarter of an oscillation goes one way only, and a fit makes a growing exponential of it.
#[test]
fn the_beginning_of_an_oscillation_is_no_divergence() {
    for (name, g) in [("march_1.072.csv", -0.02334), ("march_0.99.csv", 0.02265)] {
        // Of the whole record of 8 cycles.
        let reading = known(name, [9.5992, 38.165, 48.3482, 91.5448], 175.127);
        assert!(reading.growth.is_none() && reading.samples >= 40, "{name}: {reading:?}");
        assert!((reading.modes[0].g - g).abs() < 0.001, "{name}: {reading:?}");
    }
}

/// Marches of the forward-swept wing on both sides of its divergence: an oscillation damped so much that nothing is left of it after a few
/// cycles, then motion that comes to rest without oscillating, then one that goes away, slowly at first. A fit with offsets makes an exponential
/// that grows at 11 1/s of the last, which grows at 1.3 to 1.6.
#[test]
fn marches_on_both_sides_of_divergence_are_told_apart() {
    let at = |density: &str| {
        known(
            &format!("forward_swept_{density}.csv"),
            [13.7588, 44.6880, 69.1848, 104.6703],
            1.0,
        )
    };
    for (density, hz) in [("0.36286", 5.455), ("0.39429", 1.8)] {
        let reading = at(density);
        let mode = &reading.modes[0];
        assert!(
            reading.growth.is_none() && !reading.subsides(),
            "{density}: {reading:?}"
        );
        assert!(
            mode.g < -0.8 && (mode.freq_hz / hz - 1.0).abs() < 0.02,
            "{density}: {reading:?}"
        );
    }
    // Rates of the same records after ten cycles.
    for (density, rate) in [("0.40215", -7.0), ("0.40608", -2.4)] {
        let reading = at(density);
        let drift = reading.drift.unwrap();
        assert!(reading.subsides() && drift.dies(), "{density}: {reading:?}");
        assert!(
            (drift.rate_1_s - rate).abs() < 4.0 * drift.rate_error_1_s,
            "{density}: {reading:?}"
        );
    }
    let reading = at("0.41001");
    let growth = reading.growth.unwrap();
    assert!(
        growth.rate_1_s > 1.0 && growth.rate_1_s < 2.5 && !reading.subsides(),
        "{reading:?}"
    );
}

/// A search of the density from 0.38 at 1 % with what `of` says of each run.
fn search_to_divergence(of: impl Fn(f64) -> Stability) -> (SearchStep, usize) {
    let settings = SearchSettings {
        range: [0.05, 4.0],
        first: 0.38,
        tolerance: 0.01,
        most_runs: 8,
    };
    let mut search = Search::new(settings, Vec::new()).unwrap();
    loop {
        match search.next() {
            SearchStep::Run(at) => search.add(Trial { at, stability: of(at) }).unwrap(),
            end => return (end, search.trials().len()),
        }
    }
}

/// A pair of roots that meet at 0.3955 and part on the real axis, one of which is zero at 0.408: p^2 + 40 p + 32000 (0.408 - x) = 0.
fn approaching_divergence(x: f64) -> Stability {
    let (half, rest) = (20.0_f64, 32e3 * (0.408 - x));
    let square = half * half - rest;
    if square < 0.0 {
        let omega = (-square).sqrt();
        return Stability::Oscillation {
            g: -2.0 * half / omega,
            g_error: 1e-3,
            freq_hz: omega / TAU,
        };
    }
    let rate = Some(Rate {
        rate_1_s: square.sqrt() - half,
        rate_error_1_s: 0.05,
    });
    if x < 0.408 {
        Stability::Subsidence(rate)
    } else {
        Stability::Divergence(rate)
    }
}

#[test]
fn divergence_is_bracketed_where_no_rate_is_known() {
    let (end, _) = search_to_divergence(|at| match approaching_divergence(at) {
        Stability::Divergence(_) => Stability::Divergence(None),
        Stability::Subsidence(_) => Stability::Subsidence(None),
        oscillation => oscillation,
    });
    let SearchStep::Divergence(StaticLimit {
        between: [stable, divergent],
        point: None,
    }) = end
    else {
        panic!("{end:?}")
    };
    assert!(
        stable < 0.408 && 0.408 <= divergent && divergent - stable < 0.0041,
        "{end:?}"
    );
}

#[test]
fn divergence_is_where_the_rate_of_motion_without_oscillation_vanishes() {
    let (end, runs) = search_to_divergence(approaching_divergence);
    let SearchStep::Divergence(StaticLimit {
        between: [stable, divergent],
        point: Some(point),
    }) = end
    else {
        panic!("{end:?}")
    };
    assert!(stable < 0.408 && 0.408 < divergent && point.bracketed, "{end:?}");
    assert!((point.at - 0.408).abs() < 2.0 * point.error, "{point:?}");
    assert!(point.error < 0.01 * 0.408 && point.freq_hz == 0.0, "{point:?}");
    // The slope of the rate there: 32000 / 40.
    assert!((point.slope / 800.0 - 1.0).abs() < 0.4, "{point:?}");
    assert!(runs <= 6, "{runs} runs");
}

#[test]
fn a_limit_cycle_is_told_from_growth() {
    // Van der Pol: q'' - 2 zeta w (1 - (q/a)^2) q' + w^2 q = 0 settles to the amplitude 2 a (small zeta); the classical
    // fourth-order Runge-Kutta method at 400 steps a cycle.
    let (w, zeta, a) = (TAU * 14.0, 0.05, 0.5);
    let rate = |[q, v]: [f64; 2]| [v, 2.0 * zeta * w * (1.0 - (q / a) * (q / a)) * v - w * w * q];
    let h = 1.0 / 14.0 / 400.0;
    let mut state = [0.01, 0.0];
    let mut history = Vec::new();
    for n in 0..400 * 30 {
        if n % 10 == 0 {
            history.push(state[0]);
        }
        let along = |k: [f64; 2], s: f64| [state[0] + s * h * k[0], state[1] + s * h * k[1]];
        let k1 = rate(state);
        let k2 = rate(along(k1, 0.5));
        let k3 = rate(along(k2, 0.5));
        let k4 = rate(along(k3, 1.0));
        for d in 0..2 {
            state[d] += h / 6.0 * (k1[d] + 2.0 * k2[d] + 2.0 * k3[d] + k4[d]);
        }
    }
    let dt = 10.0 * h;
    let found = limit_cycle(&[history.clone()], dt, &DecaySettings::default())
        .unwrap()
        .unwrap();
    assert!((found.amplitude[0] - 2.0 * a).abs() < 0.02, "{found:?}");
    assert!((found.freq_hz - 14.0).abs() < 0.1 && found.g_early > 0.03, "{found:?}");
    // While it still grows, there is none; nor in linear growth.
    let young = history[..40 * 9].to_vec();
    assert_eq!(limit_cycle(&[young], dt, &DecaySettings::default()).unwrap(), None);
    let linear: Vec<f64> = (0..1200)
        .map(|n| (0.02 * f64::from(n) / 40.0 * TAU).exp() * (TAU * f64::from(n) / 40.0).sin())
        .collect();
    assert_eq!(limit_cycle(&[linear], dt, &DecaySettings::default()).unwrap(), None);
}
