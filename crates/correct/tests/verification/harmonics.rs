//! Least squares over whole cycles; pulses.

use dip_correct::HarmonicError;
use dip_correct::harmonic::{Histories, Model, fit, pulse, whole_cycles};
use dip_correct::reading::amplitude_of_sine;
use dip_dlm::c64;

fn times(step: f64, n: usize) -> Vec<f64> {
    (0..n).map(|i| step * i as f64).collect()
}

fn model(omega: Vec<f64>, harmonics: usize) -> Model {
    Model {
        omega_rad_s: omega,
        harmonics,
        drift: true,
        phase_origin_s: 0.0,
    }
}

#[test]
fn a_sin_plus_b_cos_has_the_phasor_b_minus_i_a() {
    let (omega, a, b) = (7.3, 0.4, -1.1);
    let t = times(0.013, 300);
    let y: Vec<Vec<f64>> = t
        .iter()
        .map(|t| vec![a * (omega * t).sin() + b * (omega * t).cos() + 3.0 - 0.2 * t])
        .collect();
    let window = whole_cycles(&t, omega).unwrap();
    let last = window.last().unwrap().clone();
    let fit = fit(Histories { time_s: &t, values: &y }, last, &model(vec![omega], 2)).unwrap();
    assert!((fit.amplitude[0][0][0] - c64::new(b, -a)).norm() < 1e-12);
    assert!(fit.amplitude[0][1][0].norm() < 1e-12);
    assert!((fit.drift_per_s[0] + 0.2).abs() < 1e-11);
    assert!(fit.residual_rms[0] < 1e-13);
}

#[test]
fn several_frequencies_and_harmonics_that_do_not_divide_the_window_are_separated() {
    let (w1, w2) = (5.0, 5.0 * 2.0_f64.sqrt());
    let t = times(0.021, 400);
    let phasors = [
        c64::new(1.0, 0.5),
        c64::new(-0.3, 0.1),
        c64::new(0.2, -0.7),
        c64::new(0.05, 0.02),
    ];
    let y: Vec<Vec<f64>> = t
        .iter()
        .map(|t| {
            let turn = |w: f64| c64::from_polar(1.0, w * t);
            vec![
                (phasors[0] * turn(w1)
                    + phasors[1] * turn(2.0 * w1)
                    + phasors[2] * turn(w2)
                    + phasors[3] * turn(2.0 * w2))
                .re,
            ]
        })
        .collect();
    let fit = fit(Histories { time_s: &t, values: &y }, 0..400, &model(vec![w1, w2], 2)).unwrap();
    for (f, h, want) in [(0, 0, 0), (0, 1, 1), (1, 0, 2), (1, 1, 3)] {
        assert!((fit.amplitude[f][h][0] - phasors[want]).norm() < 1e-11);
    }
}

#[test]
fn response_per_unit_of_the_motion_knows_no_phase_origin() {
    let (omega, ratio, second) = (11.0, c64::new(3.0, 0.7), c64::new(0.4, -0.2));
    let t = times(std::f64::consts::TAU / omega / 24.0, 73);
    let mut found = Vec::new();
    for (phase, origin) in [
        (0.0, 0.0),
        (1.2, 0.0),
        (-2.0, 0.37),
        (std::f64::consts::FRAC_PI_2, -0.1),
    ] {
        let motion = amplitude_of_sine(0.02, phase);
        let unit = motion / motion.norm();
        let values: Vec<Vec<f64>> = t
            .iter()
            .map(|t| {
                let turn = c64::from_polar(1.0, omega * t);
                let y = ratio * motion * turn + second * motion.norm() * unit * unit * turn * turn;
                vec![(motion * turn).re, y.re]
            })
            .collect();
        let histories = Histories {
            time_s: &t,
            values: &values,
        };
        let model = Model {
            phase_origin_s: origin,
            ..model(vec![omega], 2)
        };
        let fit = fit(histories, 25..73, &model).unwrap();
        let own = fit.amplitude[0][0][0];
        found.push((
            fit.per_unit_of(own, 0, 1).unwrap()[1],
            fit.per_unit_of(own, 0, 2).unwrap()[1],
        ));
    }
    for (first, other) in found {
        assert!((first - ratio).norm() < 1e-11 && (other - second).norm() < 1e-11);
    }
}

#[test]
fn a_sine_is_its_phasor() {
    for phase in [0.0, 0.4, -1.9] {
        let a = amplitude_of_sine(2.0, phase);
        for angle in [0.0, 0.7, 2.9] {
            let want = 2.0 * f64::sin(angle + phase);
            assert!(((a * c64::from_polar(1.0, angle)).re - want).abs() < 1e-15);
        }
    }
}

#[test]
fn cycles_are_counted_back_from_the_end() {
    let t = times(0.1, 61);
    let omega = std::f64::consts::TAU / 2.0;
    let cycles = whole_cycles(&t, omega).unwrap();
    assert_eq!(cycles, vec![1..21, 21..41, 41..61]);
    assert!(matches!(
        whole_cycles(&t[..15], omega),
        Err(HarmonicError::NoWholeCycle { .. })
    ));
    assert!(matches!(whole_cycles(&t, -1.0), Err(HarmonicError::Frequency { .. })));
}

#[test]
fn what_can_not_be_told_is_refused() {
    let t = times(0.1, 40);
    let y = vec![vec![1.0]; 40];
    let histories = Histories { time_s: &t, values: &y };
    let close = model(vec![3.0, 3.0 + 1e-9], 1);
    assert!(matches!(
        fit(histories, 0..40, &close),
        Err(HarmonicError::Indistinct { .. })
    ));
    assert!(matches!(
        fit(histories, 0..3, &model(vec![3.0], 1)),
        Err(HarmonicError::TooFew { .. })
    ));
    let flat = fit(histories, 0..40, &model(vec![3.0], 1)).unwrap();
    assert!(matches!(
        flat.per_unit_of(c64::new(0.0, 0.0), 0, 1),
        Err(HarmonicError::NoMotion { .. })
    ));
}

/// y'' + 2 d y' + y = u, whose transfer function is 1 / (1 - w^2 + 2 i d w); exact for straight pieces of u would need the
/// exact integral, so a fine fourth-order step stands for it.
fn oscillator(t: &[f64], u: impl Fn(f64) -> f64) -> Vec<f64> {
    let d = 0.4;
    let (mut y, mut v) = (0.0, 0.0);
    let mut out = vec![0.0];
    for w in t.windows(2) {
        let n = 4;
        let h = (w[1] - w[0]) / f64::from(n);
        for i in 0..n {
            let s = w[0] + h * f64::from(i);
            let f = |t: f64, y: f64, v: f64| (v, u(t) - y - 2.0 * d * v);
            let k1 = f(s, y, v);
            let k2 = f(s + h / 2.0, y + h / 2.0 * k1.0, v + h / 2.0 * k1.1);
            let k3 = f(s + h / 2.0, y + h / 2.0 * k2.0, v + h / 2.0 * k2.1);
            let k4 = f(s + h, y + h * k3.0, v + h * k3.1);
            y += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
            v += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
        }
        out.push(y);
    }
    out
}

#[test]
fn a_pulse_gives_the_transfer_function_of_an_oscillator() {
    let t = times(0.02, 3001);
    let u = |t: f64| {
        if t < 4.0 {
            (0.5 - 0.5 * (std::f64::consts::FRAC_PI_2 * t).cos()).powi(2)
        } else {
            0.0
        }
    };
    let motion: Vec<f64> = t.iter().map(|t| u(*t)).collect();
    let values: Vec<Vec<f64>> = oscillator(&t, u).into_iter().map(|y| vec![5.0 + y]).collect();
    let found = pulse::transfer(
        Histories {
            time_s: &t,
            values: &values,
        },
        &motion,
        &[0.0, 0.5, 1.0, 2.0, 40.0],
    )
    .unwrap();
    for f in &found[..4] {
        let w = f.omega_rad_s;
        let exact = c64::new(1.0, 0.0) / c64::new(1.0 - w * w, 0.8 * w);
        assert!(
            (f.ratio[0] - exact).norm() < 2e-4 * exact.norm() + 1e-5,
            "{w}: {} {exact}",
            f.ratio[0]
        );
        assert!((f.ratio[0] - exact).norm() < 1e-3 && f.trusted);
        assert!(f.error[0] < 1e-3);
    }
    assert!(!found[4].trusted, "a frequency that the pulse does not excite");
}

#[test]
fn a_ramp_gives_steady_slopes_and_transfer_functions() {
    let t = times(0.02, 3001);
    let u = |t: f64| {
        if t < 2.0 {
            0.3 * (0.5 - 0.5 * (std::f64::consts::FRAC_PI_2 * t).cos())
        } else {
            0.3
        }
    };
    let motion: Vec<f64> = t.iter().map(|t| u(*t)).collect();
    let values: Vec<Vec<f64>> = oscillator(&t, u).into_iter().map(|y| vec![y, 2.0 * y]).collect();
    let found = pulse::transfer(
        Histories {
            time_s: &t,
            values: &values,
        },
        &motion,
        &[0.0, 0.7],
    )
    .unwrap();
    assert!((found[0].ratio[0] - 1.0).norm() < 1e-9 && (found[0].ratio[1] - 2.0).norm() < 1e-9);
    let exact = c64::new(1.0, 0.0) / c64::new(1.0 - 0.49, 0.56);
    assert!((found[1].ratio[0] - exact).norm() < 1e-3);
}
