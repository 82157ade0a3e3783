//! The modal equations in time against exact solutions.

use dip_modal::{ForceGuess, Integrator, MarchError, ModalEquations, ModalState, StepScheme};

const ALL: [StepScheme; 4] = [
    StepScheme::StateTransition,
    StepScheme::RungeKutta2,
    StepScheme::Newmark,
    StepScheme::GeneralizedAlpha { rho_infinity: 0.8 },
];

fn equations(omega: f64, zeta: f64, mass: f64) -> ModalEquations {
    ModalEquations::new(vec![omega], vec![zeta], vec![mass]).unwrap()
}

fn moving(q: f64, q_dot: f64, f: f64) -> ModalState {
    ModalState {
        time_s: 0.0,
        q: vec![q],
        q_dot: vec![q_dot],
        f: vec![f],
    }
}

/// One step with a force that does not depend on the motion, corrected until it stands still.
fn step(march: &mut Integrator, force: f64) {
    march.predict(ForceGuess::Linear);
    for _ in 0..400 {
        if march.correct(&[force]).unwrap() < 1e-16 {
            break;
        }
    }
    march.accept();
}

/// Free motion of a damped oscillator: q and q' at t from q0 and v0.
fn free(omega: f64, zeta: f64, q0: f64, v0: f64, t: f64) -> [f64; 2] {
    let damped = omega * (1.0 - zeta * zeta).sqrt();
    let (a, b) = (q0, (v0 + zeta * omega * q0) / damped);
    let (e, s, c) = ((-zeta * omega * t).exp(), (damped * t).sin(), (damped * t).cos());
    let q = e * (a * c + b * s);
    let v = -zeta * omega * q + e * damped * (b * c - a * s);
    [q, v]
}

#[test]
fn state_transition_is_exact_in_free_motion_at_any_step_and_damping() {
    for (omega, zeta) in [(60.0, 0.0), (60.0, 0.03), (60.0, 0.7), (600.0, 0.01)] {
        for dt in [1e-4, 3e-3, 0.05] {
            let mut march = Integrator::new(
                equations(omega, zeta, 2.0),
                StepScheme::StateTransition,
                dt,
                moving(0.7, -9.0, 0.0),
            )
            .unwrap();
            for n in 1..=200 {
                step(&mut march, 0.0);
                let [q, v] = free(omega, zeta, 0.7, -9.0, f64::from(n) * dt);
                let size = 1.0 + 9.0 / omega;
                assert!((march.state().q[0] - q).abs() < 2e-12 * size, "{omega} {zeta} {dt} {n}");
                assert!((march.state().q_dot[0] - v).abs() < 2e-12 * size * omega);
            }
        }
    }
}

#[test]
fn state_transition_is_exact_under_forces_linear_in_time() {
    // Undamped, f = m (c0 + c1 t): q = (c0 + c1 t - c0 cos wt - c1/w sin wt) / w^2 from rest.
    let (omega, mass, c0, c1, dt) = (41.0, 3.0, 5.0, -70.0, 0.013);
    let mut march = Integrator::new(
        equations(omega, 0.0, mass),
        StepScheme::StateTransition,
        dt,
        moving(0.0, 0.0, mass * c0),
    )
    .unwrap();
    for n in 1..=50 {
        let t = f64::from(n) * dt;
        step(&mut march, mass * (c0 + c1 * t));
        let exact = (c0 + c1 * t - c0 * (omega * t).cos() - c1 / omega * (omega * t).sin()) / (omega * omega);
        assert!((march.state().q[0] - exact).abs() < 1e-14, "{n}");
    }
}

#[test]
fn a_rigid_body_mode_falls_freely() {
    for scheme in ALL {
        let mut march = Integrator::new(equations(0.0, 0.0, 4.0), scheme, 0.01, moving(1.0, 2.0, 12.0)).unwrap();
        for _ in 0..100 {
            step(&mut march, 12.0);
        }
        // q = 1 + 2 t + 3 t^2 / 2 at t = 1 s.
        assert!(
            (march.state().q[0] - 4.5).abs() < 1e-12,
            "{scheme:?} {}",
            march.state().q[0]
        );
        assert!((march.state().q_dot[0] - 5.0).abs() < 1e-12);
        assert!((march.state().time_s - 1.0).abs() < 1e-15);
    }
}

/// Error at 1 s of a damped oscillator under a harmonic force, from the exact particular and free solution.
fn harmonic_error(scheme: StepScheme, steps: u32) -> f64 {
    let (omega, zeta, mass, drive, force) = (20.0, 0.02, 1.5, 13.0, 30.0);
    // (w^2 - d^2 + 2 i z w d) Q = (force/m) for f = force e^{i d t}, real part taken.
    let (re, im) = (omega * omega - drive * drive, 2.0 * zeta * omega * drive);
    let scale = force / mass / (re * re + im * im);
    let (qr, qi) = (scale * re, -scale * im);
    let particular = |t: f64| {
        let (s, c) = (drive * t).sin_cos();
        [qr * c - qi * s, -drive * (qr * s + qi * c)]
    };
    let dt = 1.0 / f64::from(steps);
    let mut march = Integrator::new(equations(omega, zeta, mass), scheme, dt, moving(0.0, 0.0, force)).unwrap();
    for n in 1..=steps {
        step(&mut march, force * (drive * f64::from(n) * dt).cos());
    }
    let [p0, v0] = particular(0.0);
    let [p1, v1] = particular(1.0);
    let [f1, g1] = free(omega, zeta, -p0, -v0, 1.0);
    ((march.state().q[0] - p1 - f1).powi(2) + ((march.state().q_dot[0] - v1 - g1) / omega).powi(2)).sqrt()
}

#[test]
fn every_scheme_is_of_second_order() {
    for scheme in ALL {
        let order = (harmonic_error(scheme, 400) / harmonic_error(scheme, 800)).log2();
        assert!((order - 2.0).abs() < 0.1, "{scheme:?}: {order}");
    }
}

#[test]
fn the_two_stage_scheme_iterated_is_the_trapezoidal_rule() {
    let run = |scheme| {
        let mut march = Integrator::new(equations(30.0, 0.05, 2.0), scheme, 0.01, moving(0.3, 1.0, 0.0)).unwrap();
        for n in 1..=40 {
            step(&mut march, 50.0 * (0.3 * f64::from(n)).sin());
        }
        [march.state().q[0], march.state().q_dot[0] / 30.0]
    };
    let (a, b) = (run(StepScheme::RungeKutta2), run(StepScheme::Newmark));
    assert!(
        (a[0] - b[0]).abs() < 1e-13 && (a[1] - b[1]).abs() < 1e-13,
        "{a:?} {b:?}"
    );
}

#[test]
fn newmark_keeps_the_amplitude_and_has_the_known_period() {
    // tan(w_numerical dt / 2) = w dt / 2.
    let (omega, dt) = (100.0_f64, 0.008_f64);
    let numerical = 2.0 / dt * (0.5 * omega * dt).atan();
    let mut march = Integrator::new(
        equations(omega, 0.0, 1.0),
        StepScheme::Newmark,
        dt,
        moving(1.0, 0.0, 0.0),
    )
    .unwrap();
    for n in 1..=500 {
        step(&mut march, 0.0);
        let exact = (numerical * f64::from(n) * dt).cos();
        assert!((march.state().q[0] - exact).abs() < 1e-11, "{n}");
    }
}

#[test]
fn generalized_alpha_damps_unresolved_modes_to_its_radius() {
    for rho in [0.0, 0.5, 0.9] {
        let scheme = StepScheme::GeneralizedAlpha { rho_infinity: rho };
        let mut march = Integrator::new(equations(1e7, 0.0, 1.0), scheme, 1.0, moving(1.0, 0.0, 0.0)).unwrap();
        let mut size = [0.0; 2];
        for n in 0..200 {
            step(&mut march, 0.0);
            // The triple root leaves a factor that grows with the square of the number of steps: compare far apart.
            if n == 99 || n == 199 {
                size[n / 100] = march.state().q[0].abs().max(1e-300);
            }
        }
        if rho > 0.0 {
            let factor = (size[1] / size[0]).powf(1.0 / 100.0);
            assert!((factor / rho - 1.0).abs() < 0.05, "{rho}: {factor}");
        } else {
            assert!(size[0] < 1e-12);
        }
    }
}

#[test]
fn work_of_the_force_is_the_change_of_energy() {
    // Trapezoidal rule: exactly, with the mean force over the step. State transition: to the second order.
    let run = |scheme, steps: u32| {
        let dt = 1.0 / f64::from(steps);
        let equations = equations(25.0, 0.0, 2.0);
        let mut march = Integrator::new(equations.clone(), scheme, dt, moving(0.1, 0.0, 0.0)).unwrap();
        let first = equations.energy_j(&march.state().q, &march.state().q_dot);
        let mut work = 0.0;
        for n in 1..=steps {
            let old = march.state().clone();
            step(&mut march, 400.0 * (9.0 * f64::from(n) * dt).sin());
            work += 0.5 * (old.f[0] + march.state().f[0]) * (march.state().q[0] - old.q[0]);
        }
        let last = equations.energy_j(&march.state().q, &march.state().q_dot);
        assert!((last - first).abs() > 1.0);
        ((last - first - work) / (last - first)).abs()
    };
    assert!(run(StepScheme::Newmark, 100) < 1e-12);
    assert!(run(StepScheme::RungeKutta2, 100) < 1e-12);
    let order = (run(StepScheme::StateTransition, 200) / run(StepScheme::StateTransition, 400)).log2();
    assert!((order - 2.0).abs() < 0.1, "{order}");
}

/// Error of a march whose force answers to the motion (`f = -s q - d q'`, a spring and a damper), against the oscillator
/// that both make together; `corrections` 0 is loose coupling.
fn coupled_error(steps: u32, corrections: u32, guess: ForceGuess) -> f64 {
    let (omega, spring, damper) = (20.0_f64, 150.0, 2.0);
    let answer = |s: &ModalState| -spring * s.q[0] - damper * s.q_dot[0];
    let mut start = moving(0.0, 3.0, 0.0);
    start.f[0] = answer(&start);
    let dt = 1.0 / f64::from(steps);
    let mut march = Integrator::new(equations(omega, 0.0, 1.0), StepScheme::StateTransition, dt, start).unwrap();
    for _ in 0..steps {
        march.predict(guess);
        for _ in 0..corrections {
            let force = answer(march.next());
            march.correct(&[force]).unwrap();
        }
        if corrections == 0 {
            let force = answer(march.next());
            march.accept_loose(&[force]).unwrap();
        } else {
            march.accept();
        }
    }
    let together = (omega * omega + spring).sqrt();
    let [q, v] = free(together, 0.5 * damper / together, 0.0, 3.0, 1.0);
    (march.state().q[0] - q).hypot((march.state().q_dot[0] - v) / together)
}

#[test]
fn iterated_coupling_is_of_second_order_and_loose_coupling_of_first() {
    let order =
        |corrections, guess| (coupled_error(1000, corrections, guess) / coupled_error(2000, corrections, guess)).log2();
    let iterated = order(20, ForceGuess::Linear);
    assert!((iterated - 2.0).abs() < 0.1, "iterated: {iterated}");
    let loose = order(0, ForceGuess::Hold);
    assert!((loose - 1.0).abs() < 0.1, "loose: {loose}");
    let extrapolated = order(0, ForceGuess::Linear);
    assert!((extrapolated - 2.0).abs() < 0.1, "loose, extrapolated: {extrapolated}");
}

#[test]
fn correcting_again_with_the_same_force_changes_nothing() {
    for scheme in [StepScheme::StateTransition, StepScheme::Newmark] {
        let mut march = Integrator::new(equations(20.0, 0.1, 1.0), scheme, 0.02, moving(0.1, 1.0, 4.0)).unwrap();
        march.predict(ForceGuess::Hold);
        assert!(march.correct(&[7.0]).unwrap() > 0.0);
        let once = march.clone();
        assert_eq!(march.correct(&[7.0]).unwrap(), 0.0);
        assert_eq!(march, once);
    }
}

#[test]
fn a_restart_goes_on_to_the_bit() {
    for scheme in ALL {
        let three = ModalEquations::new(vec![60.0, 240.0, 312.0], vec![0.0, 0.01, 0.0], vec![1.0, 2.0, 0.3]).unwrap();
        let mut start = ModalState::rest(3);
        start.q_dot = vec![0.1, 0.0, -0.3];
        let mut march = Integrator::new(three, scheme, 1.3e-3, start).unwrap();
        let go = |march: &mut Integrator, steps: u32| {
            for _ in 0..steps {
                march.predict(ForceGuess::Linear);
                for _ in 0..3 {
                    let force: Vec<f64> = march.next().q.iter().map(|q| -123.4 * q + 0.1).collect();
                    march.correct(&force).unwrap();
                }
                march.accept();
            }
        };
        go(&mut march, 17);
        let text = serde_json::to_string(&march).unwrap();
        let mut again: Integrator = serde_json::from_str(&text).unwrap();
        go(&mut march, 23);
        go(&mut again, 23);
        assert_eq!(march, again);
    }
}

#[test]
fn static_displacement_is_where_the_spring_holds_the_force() {
    let two = ModalEquations::new(vec![10.0, 20.0], vec![0.0; 2], vec![1.0, 0.5]).unwrap();
    assert_eq!(two.static_displacement(&[50.0, 20.0]).unwrap(), vec![0.5, 0.1]);
    let free = ModalEquations::new(vec![0.0], vec![0.0], vec![1.0]).unwrap();
    assert!(matches!(
        free.static_displacement(&[1.0]),
        Err(MarchError::Value { mode: 1, .. })
    ));
}

#[test]
fn what_cannot_be_marched_is_refused() {
    assert!(matches!(
        ModalEquations::new(vec![1.0, 2.0], vec![0.0], vec![1.0, 1.0]),
        Err(MarchError::Count { got: 1, needed: 2, .. })
    ));
    for (omega, zeta, mass) in [(-1.0, 0.0, 1.0), (1.0, f64::NAN, 1.0), (1.0, 0.0, 0.0)] {
        assert!(matches!(
            ModalEquations::new(vec![omega], vec![zeta], vec![mass]),
            Err(MarchError::Value { mode: 1, .. })
        ));
    }
    let one = equations(1.0, 0.0, 1.0);
    let new = |scheme, dt, start| Integrator::new(one.clone(), scheme, dt, start);
    assert!(matches!(
        new(StepScheme::Newmark, 0.0, ModalState::rest(1)),
        Err(MarchError::Step { .. })
    ));
    assert!(matches!(
        new(StepScheme::Newmark, 0.1, ModalState::rest(2)),
        Err(MarchError::Count { .. })
    ));
    let too_much = StepScheme::GeneralizedAlpha { rho_infinity: 1.5 };
    assert!(matches!(
        new(too_much, 0.1, ModalState::rest(1)),
        Err(MarchError::RhoInfinity { .. })
    ));
    let mut march = new(StepScheme::Newmark, 0.1, ModalState::rest(1)).unwrap();
    march.predict(ForceGuess::Hold);
    let before = march.clone();
    let error = march.correct(&[f64::NAN]).unwrap_err();
    assert!(error.to_string().contains("mode 1"), "{error}");
    assert_eq!(march, before);
}
