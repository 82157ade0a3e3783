//! Against published or independently computed numbers; each test names them.

use std::path::PathBuf;

use dip_dlm::aic::Aerodynamics;
use dip_dlm::gaf::{PointRule, generalized_force};
use dip_dlm::kernel::{IntegralSum, Kernel, LineFit};
use dip_dlm::lattice::{ControlSurface, Lattice, PlaneSymmetry, Surface};
use dip_dlm::motion::{BoxMotion, RigidMotion};
use dip_dlm::{ComplexMatrix, c64};
use serde_json::Value;

fn data(name: &str) -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/data/dlm")
        .join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn json(name: &str) -> Value {
    serde_json::from_str(&data(name)).unwrap()
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap()
}

fn complex(v: &Value) -> c64 {
    c64::new(number(&v[0]), number(&v[1]))
}

fn column(v: &Value) -> Vec<c64> {
    v.as_array().unwrap().iter().map(complex).collect()
}

fn kernel(name: &str) -> Kernel {
    match name {
        "parabolic" => Kernel {
            fit: LineFit::Parabolic,
            integrals: IntegralSum::Laschka11,
        },
        "quartic" => Kernel {
            fit: LineFit::Quartic,
            integrals: IntegralSum::Desmarais12,
        },
        other => panic!("kernel {other}"),
    }
}

/// |a - b| / |b| over all entries.
fn difference(a: &[c64], b: &[c64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let top: f64 = a.iter().zip(b).map(|(a, b)| (a - b).norm_sqr()).sum();
    let bottom: f64 = b.iter().map(c64::norm_sqr).sum();
    (top / bottom).sqrt()
}

/// The sign vectors of scripts/panelaero_reference.py: Knuth's MMIX generator.
fn signs(n: usize, seed: u64) -> Vec<c64> {
    let mut state = seed;
    (0..n)
        .map(|_| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            c64::new(if state >> 63 == 1 { 1.0 } else { -1.0 }, 0.0)
        })
        .collect()
}

/// AGARD 445.6 half wing (AGARD R-765) with 20 x 20 boxes, symmetric.
fn agard() -> Lattice {
    let wing = Surface::trapezoid(
        "wing",
        ([0.0, 0.0, 0.0], 0.5587),
        ([0.8094, 0.762, 0.0], 0.3682),
        20,
        20,
    );
    Lattice::new(vec![wing], PlaneSymmetry::Symmetric).unwrap()
}

/// Wing with dihedral, fin and T-tail with dihedral: both sides given.
fn ttail() -> Lattice {
    let s = Surface::trapezoid;
    let surfaces = vec![
        s("port wing", ([0.6, -3.0, 0.42], 0.8), ([0.0, 0.0, 0.0], 1.4), 5, 8),
        s("starboard wing", ([0.0, 0.0, 0.0], 1.4), ([0.6, 3.0, 0.42], 0.8), 5, 8),
        s("fin", ([3.0, 0.0, 0.0], 1.2), ([3.6, 0.0, 1.2], 0.9), 5, 5),
        s("port tail", ([4.0, -1.2, 1.3], 0.5), ([3.6, 0.0, 1.2], 0.9), 4, 5),
        s("starboard tail", ([3.6, 0.0, 1.2], 0.9), ([4.0, 1.2, 1.3], 0.5), 4, 5),
    ];
    Lattice::new(surfaces, PlaneSymmetry::None).unwrap()
}

/// Nose-up pitch about x = 0 and a bending with twist, as in the script (displacements along the normal).
fn script_motions(lattice: &Lattice) -> BoxMotion {
    let mut motion = BoxMotion::empty(lattice.n_boxes());
    let boxes = lattice.boxes();
    motion.push_field(lattice, PointRule::ControlPoint, |i, p| {
        (-p[0] * boxes[i].normal[2], -boxes[i].normal[2])
    });
    motion.push_field(lattice, PointRule::ControlPoint, |_, p| {
        let s2 = p[1] * p[1] + p[2] * p[2];
        (s2 * (1.0 + 0.3 * p[0]), 0.3 * s2)
    });
    motion
}

fn compare_with_panelaero(lattice: Lattice, file: &str) -> (f64, usize) {
    let reference = json(file);
    assert_eq!(lattice.n_boxes() as u64, reference["boxes"].as_u64().unwrap());
    let motion = script_motions(&lattice);
    let n = lattice.n_boxes();
    let semichord = number(&reference["semichord"]);
    let mut worst = 0.0_f64;
    let mut count = 0;
    for case in reference["cases"].as_array().unwrap() {
        let name = case["kernel"].as_str().unwrap();
        let (mach, k) = (number(&case["mach"]), number(&case["k"]));
        let model = Aerodynamics::new(lattice.clone(), kernel(name), semichord).unwrap();
        let d = &model.downwash(mach, &[k]).unwrap()[0];
        let norm = number(&case["norm"]);
        assert!(
            (d.norm() - norm).abs() < 1e-6 * norm,
            "{file} {name} M {mach} k {k}: |D| {} {norm}",
            d.norm()
        );
        for (seed, product) in case["d_times_signs"].as_array().unwrap().iter().enumerate() {
            let v = ComplexMatrix::from_columns(n, 1, signs(n, seed as u64 + 1)).unwrap();
            // The product of a random sign vector with a matrix has the Frobenius norm on average, so this is the relative
            // Frobenius difference of the matrices up to chance.
            let error = difference(d.times(&v).data(), &column(product));
            worst = worst.max(error);
            assert!(error < 1e-6, "{file} {name} M {mach} k {k}: D differs by {error:.2e}");
        }
        let pressures = &model.pressures(mach, &[k], &motion).unwrap()[0];
        for (mode, reference) in case["pressures"].as_array().unwrap().iter().enumerate() {
            let error = difference(pressures.column(mode), &column(reference));
            worst = worst.max(error);
            assert!(
                error < 1e-6,
                "{file} {name} M {mach} k {k} mode {mode}: pressures differ by {error:.2e}"
            );
        }
        count += 1;
    }
    (worst, count)
}

/// PanelAero 2025.8 on the AGARD wing, 20 x 20 boxes, M 0 - 0.9, k 0 - 2, both kernels.
#[test]
fn panelaero_agard_wing() {
    let (worst, count) = compare_with_panelaero(agard(), "panelaero_agard_20x20.json");
    println!("AGARD 20 x 20: {count} conditions, worst difference {worst:.2e}");
    assert_eq!(count, 24);
}

/// PanelAero 2025.8 on a wing with dihedral and a T-tail, M 0 - 0.9, k 0 - 2, both kernels.
#[test]
fn panelaero_t_tail() {
    let (worst, count) = compare_with_panelaero(ttail(), "panelaero_ttail.json");
    println!("T-tail: {count} conditions, worst difference {worst:.2e}");
    assert_eq!(count, 24);
}

/// PanelAero on the rectangular wing of aspect ratio 4 (6 x 12 boxes): lift, moment and hinge moment of three modes.
#[test]
fn panelaero_rectangular_wing() {
    let reference = json("panelaero_rect_ar4.json");
    let wing = Surface::trapezoid("wing", ([0.0, -2.0, 0.0], 1.0), ([0.0, 2.0, 0.0], 1.0), 6, 12);
    let mut lattice = Lattice::new(vec![wing], PlaneSymmetry::None).unwrap();
    let boxes = (0..lattice.n_boxes())
        .filter(|&i| lattice.boxes()[i].chord_index >= 4)
        .collect();
    let hinge = [[2.0 / 3.0, -2.0, 0.0], [2.0 / 3.0, 2.0, 0.0]];
    lattice
        .add_control(ControlSurface {
            name: "flap".into(),
            boxes,
            hinge,
        })
        .unwrap();
    let rule = PointRule::ControlPoint;
    let mut motion = BoxMotion::empty(lattice.n_boxes());
    motion.push_rigid(
        &lattice,
        rule,
        &RigidMotion {
            translation: [0.0, 0.0, 1.0],
            ..RigidMotion::default()
        },
    );
    motion.push_rigid(
        &lattice,
        rule,
        &RigidMotion {
            rotation: [0.0, 1.0, 0.0],
            centre: [0.25, 0.0, 0.0],
            ..RigidMotion::default()
        },
    );
    motion.push_control(&lattice, rule, &lattice.controls()[0]);
    let mut compared = 0;
    for row in reference["rows"].as_array().unwrap() {
        let model = Aerodynamics::new(lattice.clone(), kernel(row["kernel"].as_str().unwrap()), 0.5).unwrap();
        let (mach, k) = (number(&row["mach"]), number(&row["k"]));
        let pressures = &model.pressures(mach, &[k], &motion).unwrap()[0];
        let q = generalized_force(&model, &motion, pressures).unwrap();
        // The file's forces are over S = 4 and c = 1: lift = plunge row, nose-up moment = pitch row; the hinge moment there
        // is trailing edge down, as is the flap mode.
        for (mode, key) in [(0, "CL"), (1, "CM_c4_noseup"), (2, "CH_hinge_Sc")] {
            let expected = column(&row[key]);
            for j in 0..3 {
                let ours = q[(mode, j)] / 4.0;
                let error = (ours - expected[j]).norm();
                let scale = expected[j].norm().max(1e-2);
                assert!(
                    error < 1e-5 * scale,
                    "M {mach} k {k} {key} mode {j}: {ours} {}",
                    expected[j]
                );
                compared += 1;
            }
        }
    }
    println!("rectangular wing: {compared} coefficients");
    assert!(compared >= 90);
}

/// PanelAero on a rectangular wing of aspect ratio 11 (10 x 40 boxes), omega/U up to 10 per metre, M 0 - 0.8: CL, CM and
/// entries of the AIC.
#[test]
fn panelaero_rigid_coefficients() {
    let wing = Surface::trapezoid("wing", ([0.0, -0.552, 0.0], 0.1), ([0.0, 0.552, 0.0], 0.1), 10, 40);
    let lattice = Lattice::new(vec![wing], PlaneSymmetry::None).unwrap();
    let rule = PointRule::ControlPoint;
    let mut motion = BoxMotion::empty(400);
    motion.push_rigid(
        &lattice,
        rule,
        &RigidMotion {
            translation: [0.0, 0.0, 1.0],
            ..RigidMotion::default()
        },
    );
    motion.push_rigid(
        &lattice,
        rule,
        &RigidMotion {
            rotation: [0.0, 1.0, 0.0],
            ..RigidMotion::default()
        },
    );
    let (area, chord) = (lattice.area(), 0.1);
    let mut compared = 0;
    for line in data("panelaero_simplewing_rigid_gaf.csv")
        .lines()
        .filter(|l| !l.starts_with(['#', 'M']))
    {
        let f: Vec<&str> = line.split(',').collect();
        let v = |i: usize| f[i].parse::<f64>().unwrap();
        // With b = 1 the file's k = omega / U is ours.
        let model = Aerodynamics::new(lattice.clone(), kernel(f[2]), 1.0).unwrap();
        let pressures = &model.pressures(v(0), &[v(1)], &motion).unwrap()[0];
        let q = generalized_force(&model, &motion, pressures).unwrap();
        let mode = if f[3] == "plunge" { 0 } else { 1 };
        let (cl, cm) = (q[(0, mode)] / area, q[(1, mode)] / (area * chord));
        let (cl_ref, cm_ref) = (c64::new(v(4), v(5)), c64::new(v(6), v(7)));
        assert!((cl - cl_ref).norm() <= 1e-5 * cl_ref.norm() + 1e-9, "{line}: CL {cl}");
        assert!((cm - cm_ref).norm() <= 1e-5 * cm_ref.norm() + 1e-9, "{line}: CM {cm}");
        if mode == 0 && v(1) == 5.0 {
            let aic = &model.influence(v(0), &[v(1)]).unwrap()[0];
            assert!((aic.norm() - v(8)).abs() < 1e-5 * v(8), "{line}: |AIC| {}", aic.norm());
            // The file's Qjj is -AIC.
            assert!(
                (-aic[(0, 0)] - c64::new(v(9), v(10))).norm() < 1e-5 * aic[(0, 0)].norm(),
                "{line}"
            );
            assert!((-aic[(0, 399)] - c64::new(v(11), v(12))).norm() < 1e-6, "{line}");
        }
        compared += 1;
    }
    println!("rigid coefficients: {compared} rows");
    assert_eq!(compared, 72);
}

/// Blair's 3 x 3 example (AFFDL/WL-TR-95-3022): plunging square half wing, M 0.5, k = 1. Its own kernel fit is of 1969; PanelAero's
/// parabolic fit is as ours.
#[test]
fn blair_square_wing() {
    let wing = Surface::trapezoid("wing", ([0.0, 0.0, 0.0], 12.0), ([0.0, 12.0, 0.0], 12.0), 3, 3);
    let lattice = Lattice::new(vec![wing], PlaneSymmetry::Symmetric).unwrap();
    let model = Aerodynamics::new(lattice, Kernel::NASTRAN, 6.0).unwrap();
    let mut w = ComplexMatrix::from_fn(9, 1, |_, _| c64::new(0.0, -1.0));
    model.factor(0.5, 1.0).unwrap().solve_in_place(&mut w).unwrap();
    let mut blair = Vec::new();
    for line in data("blair_3x3.csv")
        .lines()
        .filter(|l| l.starts_with(|c: char| c.is_ascii_digit()))
    {
        let v: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
        let index = (v[0] as usize - 1) * 3 + v[1] as usize - 1;
        let ours = w[(index, 0)];
        // Four printed decimals.
        assert!(
            (ours - c64::new(v[4], v[5])).norm() < 2e-4,
            "box {index}: {ours} against PanelAero {line}"
        );
        // The kernel fits of 1969 and 1971 differ by 4 - 8 % on so coarse a lattice (the file's header).
        assert!(
            (ours - c64::new(v[2], v[3])).norm() < 0.08 * c64::new(v[2], v[3]).norm().max(3.0),
            "box {index}"
        );
        blair.push(c64::new(v[2], v[3]));
    }
    let cl: c64 = w.column(0).iter().sum::<c64>() / 9.0;
    let reference: c64 = blair.iter().sum::<c64>() / 9.0;
    println!(
        "Blair: |CL| {:.4} at {:.2} deg, published {:.4} at {:.2} deg",
        cl.norm(),
        cl.arg().to_degrees(),
        reference.norm(),
        reference.arg().to_degrees()
    );
    assert!((reference.norm() - 3.790).abs() < 1e-3);
    assert!((cl.norm() - reference.norm()).abs() < 0.05 * reference.norm());
    assert!((cl.arg() - reference.arg()).to_degrees().abs() < 1.0);
}

/// A wing of aspect ratio 120, mid-span strip, against Theodorsen's lift and moment in plunge and pitch, and Sears' gust lift
/// (closed forms with C(k) and S(k) of Fung / Bisplinghoff; values computed with scipy, see the file's header).
#[test]
fn high_aspect_ratio_against_theodorsen_and_sears() {
    let mut table = Vec::new();
    for line in data("theodorsen.csv")
        .lines()
        .filter(|l| l.starts_with(|c: char| c.is_ascii_digit()))
    {
        let v: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
        table.push((v[0], c64::new(v[1], v[2]), c64::new(v[3], v[4])));
    }
    let half_span = 60.0;
    let (b, k_values) = (0.5, [0.1, 0.5, 1.0]);
    let mut errors = Vec::new();
    for (n_chord, n_span, grow) in [(20, 32, 1.15_f64), (40, 48, 1.1)] {
        let mut wing = Surface::trapezoid(
            "strip",
            ([-0.5, 0.0, 0.0], 1.0),
            ([-0.5, half_span, 0.0], 1.0),
            n_chord,
            n_span,
        );
        // Narrow boxes at mid-span, where the strip is compared, wider ones outboard.
        let total = grow.powi(n_span as i32) - 1.0;
        wing.spanwise = dip_dlm::lattice::Divisions::Fractions(
            (0..=n_span)
                .map(|i| {
                    if i == n_span {
                        1.0
                    } else {
                        (grow.powi(i as i32) - 1.0) / total
                    }
                })
                .collect(),
        );
        let lattice = Lattice::new(vec![wing], PlaneSymmetry::Symmetric).unwrap();
        let model = Aerodynamics::new(lattice, Kernel::QUARTIC, b).unwrap();
        let lattice = model.lattice();
        let mut motion = BoxMotion::empty(lattice.n_boxes());
        let rule = PointRule::ControlPoint;
        // Plunge up, pitch nose up about mid-chord (x = 0).
        motion.push_rigid(
            lattice,
            rule,
            &RigidMotion {
                translation: [0.0, 0.0, 1.0],
                ..RigidMotion::default()
            },
        );
        motion.push_rigid(
            lattice,
            rule,
            &RigidMotion {
                rotation: [0.0, 1.0, 0.0],
                ..RigidMotion::default()
            },
        );
        let mut found = Vec::new();
        for k in k_values {
            let &(_, theodorsen, sears) = table.iter().find(|t| t.0 == k).unwrap();
            let mut columns = motion.downwash(k / b);
            // An upward gust w_g exp(-i k x / b) asks for a normal wash -w_g.
            let gust: Vec<c64> = lattice
                .boxes()
                .iter()
                .map(|c| -c64::new(0.0, -k * c.control_point[0] / b).exp())
                .collect();
            let mut all = columns.data().to_vec();
            all.extend(gust);
            columns = ComplexMatrix::from_columns(lattice.n_boxes(), 3, all).unwrap();
            model.factor(0.0, k).unwrap().solve_in_place(&mut columns).unwrap();
            // Section lift over q c and nose-up moment about mid-chord over q c^2 of the strip at the plane of symmetry.
            let strip = &lattice.strips()[0];
            let section = |case: usize, arm: bool| -> c64 {
                (strip.first..strip.first + strip.count)
                    .map(|i| {
                        let c = &lattice.boxes()[i];
                        columns[(i, case)] * c.chord * if arm { -c.force_point[0] } else { 1.0 }
                    })
                    .sum()
            };
            let i = c64::new(0.0, 1.0);
            let ik = i * k;
            let pi = std::f64::consts::PI;
            // Theodorsen with h up positive and in lengths of b: plunge h = 1 (so h/b = 2), pitch about mid-chord a = 0.
            let cl_plunge = (ik * ik * -pi - ik * theodorsen * 2.0 * pi) / b;
            let cl_pitch = ik * pi + theodorsen * 2.0 * pi * (ik * 0.5 + 1.0);
            // Nose-up moment about mid-chord per q c^2 = (2 b)^2: see Bisplinghoff, Ashley and Halfman, eq. 5-312.
            let m_pitch = 0.25 * pi * (-(ik * 1.0) - ik * ik * 0.25 + theodorsen * 2.0 * (ik * 0.5 + 1.0));
            let m_plunge = 0.25 * pi * (-(theodorsen * 2.0) * ik / b);
            let cl_gust = sears * 2.0 * pi;
            for (what, ours, exact) in [
                ("plunge lift", section(0, false), cl_plunge),
                ("pitch lift", section(1, false), cl_pitch),
                ("plunge moment", section(0, true), m_plunge),
                ("pitch moment", section(1, true), m_pitch),
                ("gust lift", section(2, false), cl_gust),
            ] {
                let error = (ours - exact).norm() / exact.norm();
                println!(
                    "{n_chord:3} boxes, k {k}: {what}: {ours:.5} exact {exact:.5} error {:.2} %",
                    100.0 * error
                );
                found.push(error);
            }
        }
        errors.push(found);
    }
    for (coarse, fine) in errors[0].iter().zip(&errors[1]) {
        assert!(*fine < 0.02 && fine < coarse, "{errors:?}");
    }
}
