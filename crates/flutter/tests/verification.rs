//! Exact answers: Theodorsen section, divergence, structural damping, agreement of the methods, order of the damping
//! approximations, tracking through crossings.

mod goland;

use std::f64::consts::{PI, TAU};
use std::path::Path;

use dip_flutter::theodorsen::{TypicalSection, theodorsen, theodorsen_laplace, theodorsen_laplace_slope};
use dip_flutter::{
    AirState, BoundaryCase, CrossingKind, DampingForm, Direction, FlightPoint, FlutterError, FlutterProblem,
    FlutterSolution, GeneralizedForces, Interpolation, KDomain, KRange, Method, OutOfRange, Settings,
    StructuralDamping, Structure, Sweep, TabulatedForces, k_roots, matched_mach, solve, solve_boundary, solve_k,
    solve_points,
};
use faer::{Mat, MatMut, c64};

const METHODS: [Method; 5] = [Method::K, Method::Ke, Method::Pk, Method::PkHassig, Method::G];

fn data(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/data/flutter")
        .join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn linspace(from: f64, to: f64, n: usize) -> Vec<f64> {
    (0..n).map(|j| from + (to - from) * j as f64 / (n - 1) as f64).collect()
}

fn section(a: f64, x_alpha: f64, r2: f64, mu: f64, ratio: f64) -> TypicalSection {
    TypicalSection {
        semichord_m: 0.5,
        a,
        x_alpha,
        r_alpha_squared: r2,
        mass_ratio: mu,
        omega_h_rad_s: ratio * 50.0,
        omega_alpha_rad_s: 50.0,
    }
}

/// Speed unit b omega_alpha of `section`, m/s.
const SPEED_UNIT: f64 = 25.0;
const DENSITY: f64 = 1.225;

fn solve_section(
    section: &TypicalSection,
    method: Method,
    speeds: &[f64],
    damping: StructuralDamping,
) -> FlutterSolution {
    let structure = section
        .structure(DENSITY)
        .unwrap()
        .with_structural_damping(damping, DampingForm::ComplexStiffness)
        .unwrap();
    let forces = section.forces();
    let problem = FlutterProblem {
        structure: &structure,
        forces: &forces,
        semichord_m: 0.5,
        mach: 0.0,
    };
    let sweep = Sweep::Speed {
        density_kg_m3: DENSITY,
        speeds_m_s: speeds,
    };
    solve(&problem, method, &sweep, &Settings::default()).unwrap()
}

/// Parameters of the cases of theodorsen_2dof_flutter.csv: a, x_alpha, r^2, mu, omega_h / omega_alpha, then the answers.
fn section_cases() -> Vec<(String, TypicalSection, [f64; 3])> {
    data("theodorsen_2dof_flutter.csv")
        .lines()
        .filter(|l| l.starts_with('"'))
        .map(|line| {
            let (label, numbers) = line[1..].split_once('"').unwrap();
            let value = |key: &str| {
                let rest = &label[label.find(key).unwrap() + key.len()..];
                rest.split(' ').next().unwrap().parse::<f64>().unwrap()
            };
            let (a, x, r2, mu) = (value("a="), value("x_a="), value("r2="), value("mu="));
            let answers: Vec<f64> = numbers.split(',').skip(1).map(|v| v.trim().parse().unwrap()).collect();
            (
                label.to_string(),
                section(a, x, r2, mu, value("wh/wa=")),
                [answers[0], answers[1], answers[2]],
            )
        })
        .collect()
}

#[test]
fn theodorsen_function_meets_the_table() {
    let mut rows = 0;
    for line in data("theodorsen.csv").lines().filter(|l| !l.starts_with(['#', 'k'])) {
        let v: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
        assert!(
            (theodorsen(v[0]) - c64::new(v[1], v[2])).norm() < 1e-8,
            "k = {}: {}",
            v[0],
            theodorsen(v[0])
        );
        rows += 1;
    }
    assert!(rows >= 18);
}

#[test]
fn theodorsen_function_is_smooth_where_its_two_formulas_meet_and_has_its_limits() {
    assert_eq!(theodorsen(0.0), c64::new(1.0, 0.0));
    assert!((theodorsen(1e9) - c64::new(0.5, 0.0)).norm() < 1e-9);
    for direction in [
        c64::new(0.0, 1.0),
        c64::new(0.6, 0.8),
        c64::new(-0.3, 0.95),
        c64::new(1.0, 0.0),
    ] {
        let direction = direction / direction.norm();
        let (below, above) = (
            theodorsen_laplace(direction * 1.999_999_9),
            theodorsen_laplace(direction * 2.000_000_1),
        );
        assert!((above - below - theodorsen_laplace_slope(direction * 2.0) * direction * 2e-7).norm() < 1e-13);
        for radius in [0.01, 0.7, 1.9, 2.1, 9.0] {
            let (s, h) = (direction * radius, 1e-5 * radius);
            let difference = (theodorsen_laplace(s + h) - theodorsen_laplace(s - h)) / (2.0 * h);
            assert!((difference - theodorsen_laplace_slope(s)).norm() < 1e-8 / radius, "{s}");
        }
    }
}

#[test]
fn every_method_finds_the_flutter_point_of_every_section() {
    for (label, section, [speed, frequency, k]) in section_cases() {
        let speeds = linspace(0.1 * speed * SPEED_UNIT, 1.3 * speed * SPEED_UNIT, 25);
        for method in METHODS {
            let solution = solve_section(&section, method, &speeds, StructuralDamping::None);
            let flutter = solution
                .flutter()
                .unwrap_or_else(|| panic!("{label}: {method} finds no flutter"));
            // The table prints five decimals.
            let close = |got: f64, reference: f64| (got - reference).abs() < 6e-6;
            assert!(
                close(flutter.speed_m_s / SPEED_UNIT, speed),
                "{label} {method}: {}",
                flutter.speed_m_s / SPEED_UNIT
            );
            assert!(
                close(flutter.freq_hz * TAU / 50.0, frequency),
                "{label} {method}: {}",
                flutter.freq_hz * TAU / 50.0
            );
            assert!(close(flutter.k, k), "{label} {method}: {}", flutter.k);
            assert_eq!(flutter.k_range, KRange::Inside);
            assert!(flutter.residual_g.abs() < 1e-8 && flutter.error < 1e-8);
        }
    }
}

/// All methods are the same equation at zero damping, but solve it by different routes: they must agree to round-off.
#[test]
fn methods_agree_at_zero_damping() {
    let section = section(-0.2, 0.2, 0.25, 20.0, 0.5);
    let speeds = linspace(5.0, 70.0, 14);
    let reference = solve_section(&section, Method::K, &speeds, StructuralDamping::None);
    let reference = reference.flutter().unwrap();
    for method in METHODS {
        let solution = solve_section(&section, method, &speeds, StructuralDamping::None);
        let flutter = solution.flutter().unwrap();
        assert!((flutter.speed_m_s / reference.speed_m_s - 1.0).abs() < 1e-8, "{method}");
        assert!((flutter.freq_hz / reference.freq_hz - 1.0).abs() < 1e-8, "{method}");
        assert_eq!(
            (flutter.mode, flutter.direction),
            (reference.mode, Direction::Onset),
            "{method}"
        );
    }
}

/// Forty wings with random axis, mass axis, stiffness and air, five modes, Q in a table of nine k: every method finds the same
/// flutter onsets and recoveries inside the table (K by an eigenproblem per k, the others by following roots in speed).
#[test]
fn methods_agree_on_all_crossings_of_random_wings() {
    let mut state = 7_u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let speeds = linspace(15.0, 450.0, 30);
    let (mut onsets, mut humps) = (0, 0);
    for case in 0..40 {
        let mut wing = goland::Wing::read(&data("goland_wing.json"));
        wing.elastic_axis_frac = 0.2 + 0.35 * random();
        wing.cg_frac = wing.elastic_axis_frac - 0.1 + 0.3 * random();
        wing.bending_n_m2 *= 0.2 + 3.0 * random();
        wing.torsion_n_m2 *= 0.2 + 2.0 * random();
        wing.density_kg_m3 = 0.3 + random();
        let offset = (wing.cg_frac - wing.elastic_axis_frac) * wing.chord_m;
        wing.inertia_kg_m = wing.mass_kg_m * (offset * offset + (0.2 * wing.chord_m).powi(2));
        let (structure, strips) = wing.model(3, 2);
        let ks = [0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.4];
        let q: Vec<_> = ks
            .iter()
            .map(|&k| {
                let mut q = Mat::zeros(5, 5);
                strips.q(k, q.as_mut()).unwrap();
                q
            })
            .collect();
        let forces = TabulatedForces::new(&ks, &q, Interpolation::EvenCubicSpline).unwrap();
        let problem = FlutterProblem {
            structure: &structure,
            forces: &forces,
            semichord_m: wing.semichord_m(),
            mach: 0.0,
        };
        let sweep = Sweep::Speed {
            density_kg_m3: wing.density_kg_m3,
            speeds_m_s: &speeds,
        };
        let points = |method: Method| -> Vec<(f64, f64, Direction)> {
            let solution = solve(&problem, method, &sweep, &Settings::default()).unwrap();
            solution
                .crossings
                .iter()
                .filter(|c| c.kind == CrossingKind::Flutter && c.k_range == KRange::Inside)
                .map(|c| (c.speed_m_s, c.freq_hz, c.direction))
                .collect()
        };
        let reference = points(Method::K);
        onsets += reference.iter().filter(|c| c.2 == Direction::Onset).count();
        humps += reference.iter().filter(|c| c.2 == Direction::Recovery).count();
        for method in [Method::Ke, Method::Pk, Method::PkHassig, Method::G] {
            let found = points(method);
            assert_eq!(
                found.len(),
                reference.len(),
                "wing {case}, {method}: {found:?} against {reference:?}"
            );
            for (ours, k) in found.iter().zip(&reference) {
                assert!(
                    (ours.0 / k.0 - 1.0).abs() < 1e-6 && (ours.1 / k.1 - 1.0).abs() < 1e-6,
                    "wing {case}, {method}"
                );
                assert_eq!(ours.2, k.2, "wing {case}, {method}, {} m/s", ours.0);
            }
        }
    }
    assert!(onsets >= 20, "{onsets} onsets, {humps} recoveries");
}

/// The flutter point satisfies det F(i omega) = 0, evaluated here from Theodorsen's formulas alone.
#[test]
fn the_flutter_point_is_a_root_of_the_determinant() {
    for (label, section, [speed, _, _]) in section_cases() {
        let speeds = linspace(0.1 * speed * SPEED_UNIT, 1.3 * speed * SPEED_UNIT, 20);
        let solution = solve_section(&section, Method::Pk, &speeds, StructuralDamping::None);
        let flutter = solution.flutter().unwrap();
        let p = c64::new(0.0, flutter.freq_hz * TAU);
        let size = determinant(&section, p * 1.1, flutter.speed_m_s, DENSITY).norm();
        assert!(
            determinant(&section, p, flutter.speed_m_s, DENSITY).norm() < 1e-8 * size,
            "{label}"
        );
    }
}

/// det [M p^2 + K - q Q(p b / U)] with the exact Q for damped motion.
fn determinant(section: &TypicalSection, p: c64, speed: f64, density: f64) -> c64 {
    let b = section.semichord_m;
    let q = section.forces().q_laplace(p * b / speed);
    let scale = section.mass_ratio * PI * density * b.powi(4);
    let pressure = 0.5 * density * speed * speed;
    let (x, r2) = (section.x_alpha, section.r_alpha_squared);
    let (wh, wa) = (section.omega_h_rad_s, section.omega_alpha_rad_s);
    let p2 = p * p;
    let f = [
        [
            (p2 + wh * wh) * scale - q[0][0] * pressure,
            p2 * x * scale - q[0][1] * pressure,
        ],
        [
            p2 * x * scale - q[1][0] * pressure,
            (p2 + wa * wa) * r2 * scale - q[1][1] * pressure,
        ],
    ];
    f[0][0] * f[1][1] - f[0][1] * f[1][0]
}

/// Exact root of the section next to `start`, Newton on the determinant.
fn exact_root(section: &TypicalSection, start: c64, speed: f64) -> c64 {
    let mut p = start;
    for _ in 0..50 {
        let h = 1e-6 * p.norm();
        let d = |p: c64| determinant(section, p, speed, DENSITY);
        let step = d(p) * (2.0 * h) / (d(p + h) - d(p - h));
        p -= step;
        if step.norm() < 1e-13 * p.norm() {
            break;
        }
    }
    p
}

/// Near the flutter point the error of the g-method's root falls as sigma^2, that of both p-k forms only as sigma
/// (Chen 2000: first order in the damping is exact there). The exact root is that of the generalized Theodorsen function.
#[test]
fn damping_of_the_g_method_is_exact_to_first_order_and_of_pk_is_not() {
    let section = section(-0.2, 0.2, 0.25, 20.0, 0.5);
    let speeds = linspace(5.0, 60.0, 23);
    let flutter = solve_section(&section, Method::G, &speeds, StructuralDamping::None)
        .flutter()
        .unwrap()
        .clone();
    let error = |method: Method, factor: f64| {
        let speed = flutter.speed_m_s * factor;
        let solution = solve_section(&section, method, &[5.0, 0.5 * speed, speed], StructuralDamping::None);
        let p = solution.modes[flutter.mode - 1].points.last().unwrap().p_rad_s;
        let exact = exact_root(&section, p, speed);
        ((p - exact).norm() / exact.norm(), exact.re / exact.im)
    };
    for (method, order) in [(Method::G, 2.0), (Method::Pk, 1.0), (Method::PkHassig, 1.0)] {
        let (coarse, sigma_coarse) = error(method, 0.96);
        let (fine, sigma_fine) = error(method, 0.99);
        let measured = (coarse / fine).ln() / (sigma_coarse / sigma_fine).ln();
        assert!(
            (measured - order).abs() < 0.15,
            "{method}: order {measured}, errors {coarse:.2e} {fine:.2e}"
        );
    }
    assert!(error(Method::G, 0.97).0 < 0.1 * error(Method::Pk, 0.97).0);
}

#[test]
fn divergence_of_the_section_is_exact() {
    let section = TypicalSection {
        x_alpha: -0.1,
        ..section(0.1, 0.0, 0.25, 20.0, 0.5)
    };
    let exact = section.divergence_speed_m_s().unwrap();
    let speeds = linspace(0.1 * exact, 1.4 * exact, 27);
    for method in [Method::Pk, Method::PkHassig, Method::G] {
        let solution = solve_section(&section, method, &speeds, StructuralDamping::None);
        let divergence = solution.divergence().unwrap();
        assert!(
            (divergence.speed_m_s / exact - 1.0).abs() < 1e-12,
            "{method}: {}",
            divergence.speed_m_s / exact
        );
        assert_eq!((divergence.kind, divergence.freq_hz), (CrossingKind::Divergence, 0.0));
        assert!(divergence.slope > 0.0);
    }
}

/// One mode, no air stiffness: a known static divergence with quasi-steady forces, followed through the real axis:
/// M p^2 + K - q a - q b_d (p b / U) = 0 in closed form.
#[test]
fn one_mode_runs_through_the_real_axis_as_the_quadratic_says() {
    let (m, omega, a, d) = (2.0, 10.0, 3.0, -0.4);
    let structure = Structure::from_modes(&[m], &[omega / TAU]).unwrap();
    let q = |k: f64| Mat::from_fn(1, 1, |_, _| c64::new(a, d * k));
    let forces = TabulatedForces::new(
        &[0.0, 1.0, 3.0],
        &[q(0.0), q(1.0), q(3.0)],
        Interpolation::EvenCubicSpline,
    )
    .unwrap();
    let problem = FlutterProblem {
        structure: &structure,
        forces: &forces,
        semichord_m: 1.0,
        mach: 0.3,
    };
    let speeds = linspace(4.0, 14.0, 21);
    for method in [Method::Pk, Method::G] {
        let sweep = Sweep::Speed {
            density_kg_m3: 1.2,
            speeds_m_s: &speeds,
        };
        let solution = solve(&problem, method, &sweep, &Settings::default()).unwrap();
        let exact_divergence = (2.0 * m * omega * omega / (1.2 * a)).sqrt();
        let divergence = solution.divergence().unwrap();
        assert!((divergence.speed_m_s / exact_divergence - 1.0).abs() < 1e-12);
        assert_eq!(divergence.mode, 1);
        let (mut real, mut oscillating) = (0, 0);
        for point in &solution.modes[0].points {
            let pressure = 0.6 * point.speed_m_s * point.speed_m_s;
            let (half_b, c) = (
                -pressure * d / (2.0 * m * point.speed_m_s),
                omega * omega - pressure * a / m,
            );
            let discriminant = half_b * half_b - c;
            let exact = if discriminant >= 0.0 {
                real += 1;
                c64::new(-half_b + discriminant.sqrt(), 0.0)
            } else {
                oscillating += 1;
                c64::new(-half_b, (-discriminant).sqrt())
            };
            assert!(
                (point.p_rad_s - exact).norm() < 1e-7,
                "{method} at {}: {} {exact}",
                point.speed_m_s,
                point.p_rad_s
            );
        }
        assert!(real > 3 && oscillating > 3);
        assert!(solution.modes.len() == 1 && solution.flutter().is_none());
    }
}

/// Structural damping g_s as complex stiffness: K's artificial g is the total, so with a small uniform g_s the flutter
/// point is where the undamped K curve reaches g = g_s (exactly: K (1 + i g_s) and K (1 + i g) are the same matrix).
#[test]
fn structural_damping_is_a_shift_of_the_artificial_damping() {
    let section = section(-0.2, 0.1, 0.24, 20.0, 0.4);
    let speeds = linspace(20.0, 80.0, 25);
    let g_s = 0.03;
    for method in METHODS {
        let solution = solve_section(&section, method, &speeds, StructuralDamping::Uniform(g_s));
        let flutter = solution.flutter().unwrap();
        let structure = section.structure(DENSITY).unwrap();
        let forces = section.forces();
        let problem = FlutterProblem {
            structure: &structure,
            forces: &forces,
            semichord_m: 0.5,
            mach: 0.0,
        };
        let roots = k_roots(&problem, Method::K, DENSITY, &[flutter.k]).unwrap();
        let at_flutter = roots[0]
            .iter()
            .min_by(|x, y| (x.g - g_s).abs().total_cmp(&(y.g - g_s).abs()))
            .unwrap();
        assert!((at_flutter.g - g_s).abs() < 1e-7, "{method}: {}", at_flutter.g);
        assert!(
            (at_flutter.speed_m_s.unwrap() / flutter.speed_m_s - 1.0).abs() < 1e-7,
            "{method}"
        );
    }
}

/// No air: g of the roots is the structural damping, for every way to give it.
#[test]
fn damping_without_air_is_the_structure_alone() {
    let zero = Mat::<c64>::zeros(2, 2);
    let forces = TabulatedForces::new(&[0.1, 10.0], &[zero.clone(), zero], Interpolation::Linear).unwrap();
    let freq = [3.0, 7.0];
    let speeds = [5.0, 10.0];
    let cases = [
        (StructuralDamping::Uniform(0.02), [0.02, 0.02]),
        (StructuralDamping::PerMode(vec![0.01, 0.03]), [0.01, 0.03]),
        (
            StructuralDamping::Table {
                freq_hz: vec![2.0, 8.0],
                g: vec![0.02, 0.08],
            },
            [0.03, 0.07],
        ),
        (
            StructuralDamping::Table {
                freq_hz: vec![4.0, 5.0],
                g: vec![0.02, 0.03],
            },
            [0.01, 0.05],
        ),
    ];
    for (damping, expected) in cases {
        for form in [DampingForm::ComplexStiffness, DampingForm::ViscousAtNaturalFrequency] {
            let structure = Structure::from_modes(&[2.0, 0.5], &freq)
                .unwrap()
                .with_structural_damping(damping.clone(), form)
                .unwrap();
            let problem = FlutterProblem {
                structure: &structure,
                forces: &forces,
                semichord_m: 1.0,
                mach: 0.0,
            };
            let sweep = Sweep::Speed {
                density_kg_m3: 1.0,
                speeds_m_s: &speeds,
            };
            for method in [Method::Pk, Method::PkHassig, Method::G] {
                let solution = solve(&problem, method, &sweep, &Settings::default()).unwrap();
                for mode in 0..2 {
                    let p = solution.modes[mode].points[1].p_rad_s / (TAU * freq[mode]);
                    let g = expected[mode];
                    let exact = match form {
                        DampingForm::ComplexStiffness => (-c64::new(1.0, g)).sqrt() * -1.0,
                        DampingForm::ViscousAtNaturalFrequency => c64::new(-g / 2.0, (1.0 - g * g / 4.0).sqrt()),
                    };
                    let exact = if exact.im < 0.0 { -exact } else { exact };
                    assert!((p - exact).norm() < 1e-10, "{method} {form:?} mode {mode}: {p} {exact}");
                }
            }
            let roots = k_roots(&problem, Method::K, 1.0, &[1.0]).unwrap();
            for mode in 0..2 {
                let g = expected[mode];
                let exact = match form {
                    DampingForm::ComplexStiffness => -g,
                    DampingForm::ViscousAtNaturalFrequency => -g * (1.0 - g * g / 4.0).sqrt() / (1.0 - g * g / 2.0),
                };
                assert!(
                    (roots[0][mode].g - exact).abs() < 1e-12,
                    "{form:?} {} {exact}",
                    roots[0][mode].g
                );
            }
        }
    }
}

/// Forces given by closed formulas of k.
struct Formula {
    n: usize,
    f: fn(usize, usize, f64) -> c64,
}

impl GeneralizedForces for Formula {
    fn modes(&self) -> usize {
        self.n
    }
    fn domain(&self) -> KDomain {
        KDomain {
            minimum: 0.0,
            maximum: 100.0,
        }
    }
    fn q(&self, k: f64, mut q: MatMut<'_, c64>) -> dip_flutter::Result<()> {
        for j in 0..self.n {
            for i in 0..self.n {
                q[(i, j)] = (self.f)(i, j, k);
            }
        }
        Ok(())
    }
}

/// Two uncoupled modes whose frequencies cross: 2 stiffens with speed, 1 stays. They must not swap.
#[test]
fn modes_that_cross_in_frequency_keep_their_names() {
    let structure = Structure::from_modes(&[1.0, 1.0], &[10.0 / TAU, 20.0 / TAU]).unwrap();
    let forces = Formula {
        n: 2,
        f: |i, j, k| match (i, j) {
            (0, 0) => c64::new(-3.0, -0.05 * k),
            (1, 1) => c64::new(0.0, -0.06 * k),
            _ => c64::new(0.0, 0.0),
        },
    };
    let problem = FlutterProblem {
        structure: &structure,
        forces: &forces,
        semichord_m: 1.0,
        mach: 0.0,
    };
    let speeds = linspace(2.0, 25.0, 12);
    let sweep = Sweep::Speed {
        density_kg_m3: 1.0,
        speeds_m_s: &speeds,
    };
    for method in [Method::Pk, Method::PkHassig, Method::G, Method::K] {
        let solution = solve(&problem, method, &sweep, &Settings::default()).unwrap();
        let last = |mode: usize| solution.modes[mode].points.last().unwrap();
        for mode in 0..2 {
            for point in &solution.modes[mode].points {
                assert!(
                    point.shape[mode].norm() > 0.999,
                    "{method} mode {mode} at {}",
                    point.speed_m_s
                );
            }
        }
        assert!(
            last(0).freq_hz > last(1).freq_hz,
            "{method}: the frequencies have crossed"
        );
        assert!(solution.crossings.is_empty());
    }
}

/// A hump: both crossings and the peak in closed form.
///
/// One mode with an air force that feeds energy in between two reduced frequencies only: Q_I is positive there, it grows
/// and then falls with k: Q_I = c k (k - k1)(k2 - k): positive (unstable) for k1 < k < k2.
#[test]
fn hump_mode_has_both_crossings_and_a_peak_even_inside_one_step() {
    const K1: f64 = 0.50;
    const K2: f64 = 0.52;
    let structure = Structure::from_modes(&[1.0], &[10.0 / TAU]).unwrap();
    let forces = Formula {
        n: 1,
        f: |_, _, k| c64::new(0.0, 0.5 * k * (k - K1) * (K2 - k)),
    };
    let problem = FlutterProblem {
        structure: &structure,
        forces: &forces,
        semichord_m: 1.0,
        mach: 0.0,
    };
    // omega stays 10 rad/s at zero damping: U = 10 / k, so the hump lies between 19.23 and 20 m/s, inside one step of 3 m/s.
    let speeds = linspace(10.0, 40.0, 11);
    for method in [Method::Pk, Method::G] {
        let sweep = Sweep::Speed {
            density_kg_m3: 1.0,
            speeds_m_s: &speeds,
        };
        let solution = solve(&problem, method, &sweep, &Settings::default()).unwrap();
        let crossings: Vec<_> = solution
            .crossings
            .iter()
            .filter(|c| c.kind == CrossingKind::Flutter)
            .collect();
        assert_eq!(crossings.len(), 2, "{method}: {crossings:?}");
        assert!((crossings[0].speed_m_s - 10.0 / K2).abs() < 1e-6 && crossings[0].direction == Direction::Onset);
        assert!((crossings[1].speed_m_s - 10.0 / K1).abs() < 1e-6 && crossings[1].direction == Direction::Recovery);
        let hump = solution.humps.iter().find(|h| h.g > 0.0).unwrap();
        assert!(hump.speed_m_s > crossings[0].speed_m_s && hump.speed_m_s < crossings[1].speed_m_s);
        // Im Q q / (2 omega^2) * 2 = g at first order: q Q_I / omega^2.
        let k = 10.0 / hump.speed_m_s;
        let pressure = 0.5 * hump.speed_m_s * hump.speed_m_s;
        let g = pressure * 0.5 * k * (k - K1) * (K2 - k) / 100.0;
        assert!((hump.g / g - 1.0).abs() < 1e-3, "{method}: {} {g}", hump.g);
    }
}

/// A strongly damped neighbour, a veering pair and repeated frequencies: one root per mode, all roots of the equation.
#[test]
fn roots_are_distinct_and_satisfy_the_equation_for_n_up_to_30() {
    for n in [1, 2, 5, 30] {
        // Pairs of repeated natural frequencies.
        let freq: Vec<f64> = (0..n).map(|i| 2.0 + (i / 2) as f64).collect();
        let structure = Structure::from_modes(&vec![1.0; n], &freq).unwrap();
        let forces = Formula {
            n,
            f: |i, j, k| {
                let coupling = 1.0 / (1.0 + (i as f64 - j as f64).abs().powi(2));
                let sign = if i > j { 0.5 } else { 1.0 };
                c64::new(
                    coupling * sign * (0.3 + 0.1 * i as f64),
                    -coupling * k * (1.0 + 0.05 * j as f64),
                )
            },
        };
        let problem = FlutterProblem {
            structure: &structure,
            forces: &forces,
            semichord_m: 0.3,
            mach: 0.0,
        };
        let speeds = linspace(4.0, 20.0, 5);
        let sweep = Sweep::Speed {
            density_kg_m3: 1.0,
            speeds_m_s: &speeds,
        };
        let solution = solve(&problem, Method::Pk, &sweep, &Settings::default()).unwrap();
        assert!(solution.modes.len() >= n);
        for (number, &speed) in speeds.iter().enumerate() {
            let points: Vec<_> = solution.modes[..n]
                .iter()
                .map(|m| {
                    m.points
                        .iter()
                        .find(|p| p.parameter == speed)
                        .unwrap_or_else(|| panic!("n {n} speed {number}"))
                })
                .collect();
            for (i, a) in points.iter().enumerate() {
                assert!(
                    residual(&problem, a) < 1e-9,
                    "n {n}, mode {i}, speed {speed}: {}",
                    residual(&problem, a)
                );
                for b in &points[..i] {
                    assert!(
                        (a.p_rad_s - b.p_rad_s).norm() > 1e-6,
                        "n {n}: two modes on one root at {speed}"
                    );
                }
            }
        }
    }
}

/// A free-flying section: plunge without stiffness. Every curve consists of roots of the equation, K gives no speed to the
/// rigid mode where it has none, and nothing fails.
#[test]
fn rigid_body_mode_is_no_obstacle() {
    let section = section(-0.2, 0.2, 0.25, 20.0, 0.0);
    let structure = section.structure(DENSITY).unwrap();
    assert!(structure.natural_modes().omega_rad_s[0] < 1e-3);
    let forces = section.forces();
    let problem = FlutterProblem {
        structure: &structure,
        forces: &forces,
        semichord_m: 0.5,
        mach: 0.0,
    };
    let speeds = linspace(10.0, 80.0, 15);
    let sweep = Sweep::Speed {
        density_kg_m3: DENSITY,
        speeds_m_s: &speeds,
    };
    let flutter = |method: Method| {
        let solution = solve(&problem, method, &sweep, &Settings::default()).unwrap();
        if method == Method::Pk {
            for point in solution.modes.iter().flat_map(|m| &m.points).filter(|p| p.k > 0.0) {
                assert!(det_pk(&section, point) < 1e-9, "{}", det_pk(&section, point));
            }
        }
        solution.flutter().map(|c| (c.speed_m_s, c.freq_hz))
    };
    let reference = flutter(Method::K);
    for method in [Method::Pk, Method::PkHassig, Method::G] {
        let found = flutter(method);
        assert_eq!(
            found.is_some(),
            reference.is_some(),
            "{method}: {found:?} {reference:?}"
        );
        if let (Some(a), Some(b)) = (found, reference) {
            assert!(
                (a.0 / b.0 - 1.0).abs() < 1e-7 && (a.1 / b.1 - 1.0).abs() < 1e-7,
                "{method}"
            );
        }
    }
}

/// |det F| of Nastran's PK form over the product of its diagonal terms' sizes.
fn det_pk(section: &TypicalSection, point: &dip_flutter::ModePoint) -> f64 {
    let (b, p, speed) = (section.semichord_m, point.p_rad_s, point.speed_m_s);
    let q = section.forces().q_laplace(c64::new(0.0, point.k));
    let aero = |i: usize, j: usize| {
        (c64::new(q[i][j].re, 0.0) + p * (b / speed) * (q[i][j].im / point.k)) * (0.5 * DENSITY * speed * speed)
    };
    let scale = section.mass_ratio * PI * DENSITY * b.powi(4);
    let p2 = p * p;
    let h = (p2 + section.omega_h_rad_s.powi(2)) * scale - aero(0, 0);
    let alpha = (p2 + section.omega_alpha_rad_s.powi(2)) * section.r_alpha_squared * scale - aero(1, 1);
    let x = p2 * section.x_alpha * scale;
    let size = (p2.norm() * scale + aero(0, 0).norm()) * (p2.norm() * scale + aero(1, 1).norm());
    (h * alpha - (x - aero(0, 1)) * (x - aero(1, 0))).norm() / size
}

/// Tables without physics (random entries, strongly coupled) must neither panic nor run on, and what comes out are roots.
#[test]
fn random_tables_are_survived() {
    let mut state = 99_u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let speeds = linspace(5.0, 60.0, 8);
    for case in 0..25 {
        let n = 2 + case % 4;
        let ks = [0.0, 0.1, 0.3, 0.7, 1.5];
        let q: Vec<_> = ks
            .iter()
            .map(|&k| {
                Mat::from_fn(n, n, |_, _| {
                    c64::new(8.0 * random(), if k > 0.0 { 4.0 * k * random() } else { 0.0 })
                })
            })
            .collect();
        let freq: Vec<f64> = (0..n).map(|i| 2.0 + i as f64 + random()).collect();
        let structure = Structure::from_modes(&vec![1.0; n], &freq).unwrap();
        let forces = TabulatedForces::new(&ks, &q, Interpolation::EvenCubicSpline).unwrap();
        let problem = FlutterProblem {
            structure: &structure,
            forces: &forces,
            semichord_m: 1.0,
            mach: 0.0,
        };
        let sweep = Sweep::Speed {
            density_kg_m3: 0.5,
            speeds_m_s: &speeds,
        };
        for method in METHODS {
            let solution = solve(&problem, method, &sweep, &Settings::default()).unwrap();
            for point in solution.modes.iter().flat_map(|m| &m.points) {
                assert!(point.p_rad_s.re.is_finite() && point.p_rad_s.im.is_finite() && point.g.is_finite());
                if method == Method::Pk && point.k > 1e-3 {
                    assert!(
                        residual(&problem, point) < 1e-6,
                        "case {case}: {}",
                        residual(&problem, point)
                    );
                }
            }
            for crossing in solution.crossings.iter().filter(|c| c.kind == CrossingKind::Flutter) {
                assert!(crossing.residual_g.abs() < 1e-6, "case {case} {method}: {crossing:?}");
            }
        }
    }
}

/// A boundary solved with one thread and with several is the same to the last bit.
#[test]
fn threads_do_not_change_a_bit() {
    let sections: Vec<_> = section_cases().into_iter().map(|c| c.1).collect();
    let structures: Vec<_> = sections.iter().map(|s| s.structure(DENSITY).unwrap()).collect();
    let forces: Vec<_> = sections.iter().map(TypicalSection::forces).collect();
    let speeds = linspace(5.0, 60.0, 10);
    let cases: Vec<_> = (0..sections.len())
        .map(|i| BoundaryCase {
            problem: FlutterProblem {
                structure: &structures[i],
                forces: &forces[i],
                semichord_m: 0.5,
                mach: 0.0,
            },
            sweep: Sweep::Speed {
                density_kg_m3: DENSITY,
                speeds_m_s: &speeds,
            },
        })
        .collect();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve_boundary(&cases, Method::Pk, &Settings::default()).unwrap())
    };
    let one = with(1);
    assert_eq!(one, with(2));
    assert_eq!(one, with(5));
}

/// |F(p) q| over the size of its terms for Nastran's PK form, from the public data alone.
fn residual(problem: &FlutterProblem<'_>, point: &dip_flutter::ModePoint) -> f64 {
    let n = point.shape.len();
    let mut q = Mat::<c64>::zeros(n, n);
    problem.forces.q(point.k, q.as_mut()).unwrap();
    let natural = &problem.structure.natural_modes().omega_rad_s;
    let pressure = 0.5 * point.density_kg_m3 * point.speed_m_s * point.speed_m_s;
    let s = point.p_rad_s * problem.semichord_m / point.speed_m_s;
    let (mut total, mut scale) = (0.0, 0.0_f64);
    for i in 0..n {
        let mut row = c64::new(0.0, 0.0);
        for j in 0..n {
            let aero = c64::new(q[(i, j)].re, 0.0) + s * (q[(i, j)].im / point.k);
            row -= aero * pressure * point.shape[j];
        }
        row += (point.p_rad_s * point.p_rad_s + natural[i] * natural[i]) * point.shape[i];
        total += row.norm_sqr();
        scale = scale.max(natural[i] * natural[i]);
    }
    total.sqrt() / scale
}

/// The three sweeps reach the same stability boundary: the density and the altitude that make a speed critical.
#[test]
fn speed_density_and_altitude_sweeps_meet_in_the_same_point() {
    let section = section(-0.2, 0.2, 0.25, 20.0, 0.5);
    let structure = section.structure(DENSITY).unwrap();
    let forces = section.forces();
    let problem = FlutterProblem {
        structure: &structure,
        forces: &forces,
        semichord_m: 0.5,
        mach: 0.15,
    };
    let settings = Settings::default();
    let at_density = |density: f64| {
        let speeds = linspace(10.0, 80.0, 15);
        let sweep = Sweep::Speed {
            density_kg_m3: density,
            speeds_m_s: &speeds,
        };
        solve(&problem, Method::Pk, &sweep, &settings)
            .unwrap()
            .flutter()
            .unwrap()
            .clone()
    };
    let speed = at_density(0.9).speed_m_s;
    let densities = linspace(0.1, 2.0, 12);
    let sweep = Sweep::Density {
        speed_m_s: speed,
        densities_kg_m3: &densities,
    };
    let found = solve(&problem, Method::G, &sweep, &settings).unwrap();
    assert!((found.flutter().unwrap().density_kg_m3 / 0.9 - 1.0).abs() < 1e-7);

    let atmosphere = |h: f64| AirState {
        density_kg_m3: 1.225 * (-h / 9000.0).exp(),
        sound_speed_m_s: 340.0 - 0.004 * h,
    };
    let altitudes = linspace(12000.0, 0.0, 13);
    let sweep = Sweep::Altitude {
        atmosphere: &atmosphere,
        altitudes_m: &altitudes,
    };
    let found = solve(&problem, Method::Pk, &sweep, &settings).unwrap();
    let flutter = found.flutter().unwrap();
    assert!((flutter.speed_m_s / (0.15 * atmosphere(flutter.parameter).sound_speed_m_s) - 1.0).abs() < 1e-12);
    assert!((at_density(flutter.density_kg_m3).speed_m_s / flutter.speed_m_s - 1.0).abs() < 1e-7);
    assert_eq!(flutter.direction, Direction::Onset);
}

/// Forces that do not depend on Mach: the matched Mach number is U_f / a. PKNL points are the points of a sweep.
#[test]
fn matched_mach_and_single_points_agree_with_the_sweep() {
    let section = section(-0.2, 0.2, 0.25, 20.0, 0.5);
    let structure = section.structure(DENSITY).unwrap();
    let forces = section.forces();
    let settings = Settings::default();
    let speeds = linspace(10.0, 60.0, 11);
    let sweep = Sweep::Speed {
        density_kg_m3: DENSITY,
        speeds_m_s: &speeds,
    };
    let problem_at = |mach: f64| FlutterProblem {
        structure: &structure,
        forces: &forces,
        semichord_m: 0.5,
        mach,
    };
    let flutter_at = |mach: f64| {
        Ok(solve(&problem_at(mach), Method::Pk, &sweep, &settings)?
            .flutter()
            .cloned())
    };
    let speed = flutter_at(0.3).unwrap().unwrap().speed_m_s;
    let found = matched_mach(&flutter_at, 300.0, (0.05, 0.9), 1e-9).unwrap().unwrap();
    assert!((found.mach / (speed / 300.0) - 1.0).abs() < 1e-8);
    assert!(matched_mach(&flutter_at, 300.0, (0.5, 0.9), 1e-9).unwrap().is_none());

    let solution = solve(&problem_at(0.0), Method::Pk, &sweep, &settings).unwrap();
    let points: Vec<_> = speeds
        .iter()
        .map(|&speed_m_s| FlightPoint {
            problem: problem_at(0.0),
            density_kg_m3: DENSITY,
            speed_m_s,
        })
        .collect();
    let roots = solve_points(&points, Method::Pk, &settings).unwrap();
    // Before the modes coalesce both ways of naming them agree.
    for (speed, roots) in speeds.iter().zip(&roots).take(5) {
        for (curve, root) in solution.modes.iter().zip(roots) {
            let point = curve.points.iter().find(|p| p.parameter == *speed).unwrap();
            assert!((point.p_rad_s - root.p_rad_s).norm() < 1e-9);
        }
    }
}

#[test]
fn range_of_k_is_reported_or_refused_never_silent() {
    let section = section(-0.2, 0.2, 0.25, 20.0, 0.5);
    let structure = section.structure(DENSITY).unwrap();
    let exact = section.forces();
    let ks = [0.2, 0.35, 0.5];
    let q: Vec<_> = ks
        .iter()
        .map(|&k| {
            let mut q = Mat::zeros(2, 2);
            exact.q(k, q.as_mut()).unwrap();
            q
        })
        .collect();
    let forces = TabulatedForces::new(&ks, &q, Interpolation::EvenCubicSpline).unwrap();
    let problem = FlutterProblem {
        structure: &structure,
        forces: &forces,
        semichord_m: 0.5,
        mach: 0.0,
    };
    let speeds = linspace(10.0, 60.0, 11);
    let sweep = Sweep::Speed {
        density_kg_m3: DENSITY,
        speeds_m_s: &speeds,
    };
    let reported = solve(&problem, Method::Pk, &sweep, &Settings::default()).unwrap();
    let outside = |s: &FlutterSolution| {
        s.modes
            .iter()
            .flat_map(|m| &m.points)
            .filter(|p| p.k_range == KRange::Above)
            .count()
    };
    assert!(outside(&reported) > 0);
    assert!(
        reported
            .warnings
            .iter()
            .any(|w| matches!(w, dip_flutter::Warning::OutOfRange { k_maximum, .. } if *k_maximum > 0.5))
    );
    let refuse = Settings {
        out_of_range: OutOfRange::Refuse,
        ..Settings::default()
    };
    assert!(matches!(
        solve(&problem, Method::Pk, &sweep, &refuse),
        Err(FlutterError::OutOfRange { .. })
    ));
    assert!(matches!(
        solve_k(&problem, Method::K, DENSITY, &[0.1, 0.3], &refuse),
        Err(FlutterError::OutOfRange { .. })
    ));
    assert!(solve_k(&problem, Method::K, DENSITY, &[0.2, 0.3, 0.5], &refuse).is_ok());
}

#[test]
fn bad_input_is_an_error_with_its_place() {
    let one = |v: f64| Mat::from_fn(1, 1, |_, _| v);
    assert!(matches!(
        Structure::new(one(0.0), one(1.0)),
        Err(FlutterError::NoNaturalModes { .. })
    ));
    let singular = Mat::from_fn(2, 2, |_, _| 1.0);
    let identity = Mat::<f64>::identity(2, 2);
    assert!(matches!(
        Structure::new(singular, identity.clone()),
        Err(FlutterError::NoNaturalModes { .. })
    ));
    assert!(matches!(
        Structure::new(one(f64::NAN), one(1.0)),
        Err(FlutterError::NotFinite { .. })
    ));
    assert!(matches!(
        Structure::new(identity.clone(), one(1.0)),
        Err(FlutterError::Shape { .. })
    ));
    assert!(matches!(
        Structure::new(one(1.0), one(-1.0)),
        Err(FlutterError::NoNaturalModes { .. })
    ));
    let structure = Structure::from_modes(&[1.0], &[1.0]).unwrap();
    let broken = Formula {
        n: 1,
        f: |_, _, k| c64::new(if k > 0.5 { f64::NAN } else { 1.0 }, 0.0),
    };
    let problem = FlutterProblem {
        structure: &structure,
        forces: &broken,
        semichord_m: 1.0,
        mach: 0.0,
    };
    let run = |problem: &FlutterProblem<'_>, method: Method, speeds: &[f64], density: f64| {
        solve(
            problem,
            method,
            &Sweep::Speed {
                density_kg_m3: density,
                speeds_m_s: speeds,
            },
            &Settings::default(),
        )
    };
    for method in METHODS {
        assert!(
            matches!(
                run(&problem, method, &[1.0, 2.0], 1.0),
                Err(FlutterError::NotFinite { .. })
            ),
            "{method}"
        );
        assert!(
            matches!(run(&problem, method, &[0.0, 2.0], 1.0), Err(FlutterError::Value { .. })),
            "{method}"
        );
        assert!(
            matches!(run(&problem, method, &[2.0, 1.0], 1.0), Err(FlutterError::Value { .. })),
            "{method}"
        );
        assert!(
            matches!(run(&problem, method, &[], 1.0), Err(FlutterError::Shape { .. })),
            "{method}"
        );
        assert!(
            matches!(run(&problem, method, &[1.0], f64::NAN), Err(FlutterError::Value { .. })),
            "{method}"
        );
    }
    let two = Formula {
        n: 2,
        f: |_, _, _| c64::new(0.0, 0.0),
    };
    let problem = FlutterProblem {
        forces: &two,
        ..problem
    };
    assert!(matches!(
        run(&problem, Method::Pk, &[1.0, 2.0], 1.0),
        Err(FlutterError::Shape { .. })
    ));
    let sweep = Sweep::Density {
        speed_m_s: 1.0,
        densities_kg_m3: &[1.0],
    };
    let one_dof = Formula {
        n: 1,
        f: |_, _, _| c64::new(0.0, 0.0),
    };
    let problem = FlutterProblem {
        forces: &one_dof,
        ..problem
    };
    assert!(matches!(
        solve(&problem, Method::K, &sweep, &Settings::default()),
        Err(FlutterError::Unsupported { .. })
    ));
}

mod decay {
    //! Identification of synthetic records with known answers.
    use super::*;
    use dip_flutter::decay::{DecaySettings, identify};

    /// Normal numbers of unit variance: sum of twelve uniforms of a fixed congruential sequence.
    struct Noise(u64);
    impl Noise {
        fn next(&mut self) -> f64 {
            let mut uniform = || {
                self.0 = self
                    .0
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (self.0 >> 11) as f64 / (1_u64 << 53) as f64
            };
            (0..12).map(|_| uniform()).sum::<f64>() - 6.0
        }
    }

    const POLES: [(f64, f64); 3] = [(-1.2, 60.0), (0.8, 100.0), (-6.0, 310.0)];
    const SHAPES: [[(f64, f64); 3]; 3] = [
        [(1.0, 0.0), (0.2, 0.1), (0.02, 0.0)],
        [(0.3, -0.2), (0.5, 0.4), (0.05, 0.02)],
        [(0.0, 0.1), (0.1, -0.3), (0.2, 0.1)],
    ];

    fn record(samples: usize, dt: f64, noise: f64, seed: u64, offset: f64) -> Vec<Vec<f64>> {
        let mut random = Noise(seed);
        (0..3)
            .map(|c| {
                (0..samples)
                    .map(|j| {
                        let t = j as f64 * dt;
                        let clean: f64 = (0..3)
                            .map(|m| {
                                let (a, b) = SHAPES[c][m];
                                (c64::new(a, b) * (c64::new(POLES[m].0, POLES[m].1) * t).exp()).re
                            })
                            .sum();
                        clean + offset * (c as f64 - 0.5) + noise * random.next()
                    })
                    .collect()
            })
            .collect()
    }

    #[test]
    fn noiseless_records_are_identified_to_round_off() {
        // 1.6 cycles of the slowest mode; and a record so fine that a cycle has a thousand samples.
        for (samples, dt) in [(170, 1e-3), (2000, 1e-4)] {
            let fit = identify(&record(samples, dt, 0.0, 1, 0.3), dt, &DecaySettings::default()).unwrap();
            assert_eq!(fit.modes.len(), 3, "{:?}", fit.modes);
            for (m, (sigma, omega)) in POLES.iter().enumerate() {
                let mode = fit
                    .modes
                    .iter()
                    .find(|f| (f.p_rad_s.im / omega - 1.0).abs() < 0.01)
                    .unwrap();
                assert!(
                    (mode.p_rad_s - c64::new(*sigma, *omega)).norm() < 1e-6,
                    "{}",
                    mode.p_rad_s
                );
                for (amplitude, shape) in mode.amplitude.iter().zip(SHAPES) {
                    assert!((amplitude - c64::new(shape[m].0, shape[m].1)).norm() < 1e-6);
                }
            }
            for c in 0..3 {
                assert!((fit.offsets[c] - 0.3 * (c as f64 - 0.5)).abs() < 1e-6);
            }
            assert!(fit.residual < 1e-7);
        }
    }

    /// With noise the answers scatter as the standard errors say: of many seeds, the normalized errors have unit variance.
    #[test]
    fn standard_errors_are_those_of_repeated_experiments() {
        let (mut sum, mut count) = (0.0, 0);
        for seed in 0..40 {
            let data = record(300, 1e-3, 0.05, 77 + seed, 0.1);
            let fit = identify(&data, 1e-3, &DecaySettings::default()).unwrap();
            for (sigma, omega) in &POLES[..2] {
                let mode = fit
                    .modes
                    .iter()
                    .find(|f| (f.p_rad_s.im / omega - 1.0).abs() < 0.05)
                    .unwrap();
                sum += ((mode.p_rad_s.re - sigma) / mode.sigma_error_rad_s).powi(2);
                sum += ((mode.p_rad_s.im - omega) / mode.omega_error_rad_s).powi(2);
                count += 2;
            }
        }
        let variance = sum / f64::from(count);
        assert!(
            (0.6..1.6).contains(&variance),
            "normalized variance {variance} of {count}"
        );
    }

    #[test]
    fn the_growing_mode_is_named_and_sure() {
        let fit = identify(&record(300, 1e-3, 0.02, 5, 0.0), 1e-3, &DecaySettings::default()).unwrap();
        let worst = fit.least_stable(0.02).unwrap();
        assert!(
            (worst.freq_hz - 100.0 / TAU).abs() < 0.1 && worst.g > 0.0 && worst.confidence > 0.95,
            "{worst:?}"
        );
    }

    #[test]
    fn bad_records_are_refused() {
        let settings = DecaySettings::default();
        assert!(identify(&[], 0.1, &settings).is_err());
        assert!(identify(&[vec![0.0; 5]], 0.1, &settings).is_err());
        assert!(identify(&[vec![1.0; 50]], 0.1, &settings).is_err());
        assert!(identify(&[vec![f64::NAN; 50]], 0.1, &settings).is_err());
        assert!(identify(&[vec![1.0; 50], vec![1.0; 49]], 0.1, &settings).is_err());
        assert!(identify(&record(50, 1e-3, 0.0, 1, 0.0), 0.0, &settings).is_err());
    }
}

/// The dense algebra underneath shares its sums out among threads where it may; the answer must not depend on how many.
#[test]
fn damping_has_the_same_bits_for_any_number_of_threads() {
    use dip_flutter::decay::{DecaySettings, identify};
    let dt_s = 1.0 / 560.0;
    let histories: Vec<Vec<f64>> = (0..4_i32)
        .map(|c| {
            (0..60)
                .map(|j| {
                    let t = f64::from(j) * dt_s;
                    (1..=4_i32)
                        .map(|m| {
                            let (w, lead) = (60.0 * f64::from(m * m) / 2.0, f64::from(c * m));
                            (-0.02 * w * t).exp() * (w * t + lead).sin() / f64::from(1 + (c - m).abs())
                        })
                        .sum::<f64>()
                        // Something that the fit cannot explain, as a march has it.
                        + 1e-4 * (1e4 * t * t + f64::from(c)).sin()
                })
                .collect()
        })
        .collect();
    let read = |threads: usize| -> Vec<[u64; 4]> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let fit = pool.install(|| identify(&histories, dt_s, &DecaySettings::default()).unwrap());
        let bits =
            |m: &dip_flutter::decay::DecayMode| [m.g, m.freq_hz, m.sigma_error_rad_s, m.energy].map(f64::to_bits);
        fit.modes.iter().map(bits).collect()
    };
    let one = read(1);
    assert!(!one.is_empty());
    for threads in [2, 3, 5] {
        assert_eq!(one, read(threads), "{threads} threads");
    }
}
