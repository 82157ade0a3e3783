//! Generalized forces: conventions, and interpolation over k.

use dip_dlm::aic::Aerodynamics;
use dip_dlm::gaf::{Interpolation, KInterpolant, PointRule, TableError, generalized_forces};
use dip_dlm::kernel::Kernel;
use dip_dlm::lattice::{ControlSurface, Lattice, PlaneSymmetry, Surface};
use dip_dlm::motion::{BoxMotion, RigidMotion};
use dip_dlm::{ComplexMatrix, c64};

fn model() -> Aerodynamics {
    let wing = Surface::trapezoid("wing", ([0.0, 0.0, 0.0], 1.0), ([0.5, 2.0, 0.3], 0.7), 5, 6);
    Aerodynamics::new(
        Lattice::new(vec![wing], PlaneSymmetry::Symmetric).unwrap(),
        Kernel::QUARTIC,
        0.5,
    )
    .unwrap()
}

/// Work by hand: Q_ij is the work of mode j's box forces on mode i's quarter-chord displacements.
#[test]
fn definition() {
    let model = model();
    let lattice = model.lattice();
    let mut motion = BoxMotion::empty(lattice.n_boxes());
    motion.push_field(lattice, PointRule::ControlPoint, |_, p| {
        (p[1] * p[1] * (1.0 + p[0]), p[1] * p[1])
    });
    motion.push_rigid(
        lattice,
        PointRule::ControlPoint,
        &RigidMotion {
            rotation: [0.0, 1.0, 0.0],
            centre: [0.3, 0.0, 0.0],
            ..RigidMotion::default()
        },
    );
    let table = generalized_forces(&model, &motion, &[0.0, 0.6], &[0.0, 0.3]).unwrap();
    let aic = model.influence(0.6, &[0.3]).unwrap().remove(0);
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let n = lattice.n_boxes();
        let mut q = c64::new(0.0, 0.0);
        for r in 0..n {
            let b = &lattice.boxes()[r];
            let h = if i == 0 {
                b.force_point[1].powi(2) * (1.0 + b.force_point[0])
            } else {
                // Along the normal of a wing with dihedral.
                -(b.force_point[0] - 0.3) * b.normal[2]
            };
            for s in 0..n {
                let c = &lattice.boxes()[s];
                let p = c.control_point;
                let w = if j == 0 {
                    c64::new(p[1] * p[1], 0.3 / 0.5 * p[1] * p[1] * (1.0 + p[0]))
                } else {
                    c64::new(-c.normal[2], -0.3 / 0.5 * (p[0] - 0.3) * c.normal[2])
                };
                q += aic[(r, s)] * w * (b.area * h);
            }
        }
        let ours = table.q[1][1][(i, j)];
        assert!((ours - q).norm() < 1e-11 * q.norm(), "Q[{i}][{j}]: {ours} {q}");
    }
}

/// For a motion that is linear along the chord both point rules are the same; for a curved one they differ, and come together
/// with more boxes.
#[test]
fn point_rules() {
    let lift = |n: usize, rule: PointRule, curved: bool| {
        let wing = Surface::trapezoid("wing", ([0.0, 0.0, 0.0], 1.0), ([0.5, 2.0, 0.0], 0.7), n, 6);
        let model = Aerodynamics::new(
            Lattice::new(vec![wing], PlaneSymmetry::Symmetric).unwrap(),
            Kernel::QUARTIC,
            0.5,
        )
        .unwrap();
        let mut motion = BoxMotion::empty(model.lattice().n_boxes());
        motion.push_field(model.lattice(), rule, |_, p| {
            if curved {
                (p[0].powi(3), 3.0 * p[0] * p[0])
            } else {
                (p[1] * (1.0 + p[0]), p[1])
            }
        });
        generalized_forces(&model, &motion, &[0.4], &[0.5]).unwrap().q[0][0][(0, 0)]
    };
    let (own, nastran) = (
        lift(4, PointRule::ControlPoint, false),
        lift(4, PointRule::MidChord, false),
    );
    assert!((own - nastran).norm() < 1e-12 * own.norm());
    let gap = |n: usize| {
        let (own, nastran) = (
            lift(n, PointRule::ControlPoint, true),
            lift(n, PointRule::MidChord, true),
        );
        (own - nastran).norm() / own.norm()
    };
    let (coarse, fine) = (gap(5), gap(20));
    assert!(coarse > 1e-3 && fine < 0.35 * coarse, "{coarse} {fine}");
}

/// A control surface that is the whole wing is a rotation of the wing about the hinge.
#[test]
fn whole_wing_control() {
    let model = model();
    let mut lattice = model.lattice().clone();
    let hinge = [[0.4, 0.0, 0.0], [0.7, 2.0, 0.3]];
    let boxes = (0..lattice.n_boxes()).collect();
    lattice
        .add_control(ControlSurface {
            name: "all".into(),
            boxes,
            hinge,
        })
        .unwrap();
    let d = [0, 1, 2].map(|i| hinge[1][i] - hinge[0][i]);
    let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    for rule in [PointRule::ControlPoint, PointRule::MidChord] {
        let (mut control, mut rigid) = (BoxMotion::empty(lattice.n_boxes()), BoxMotion::empty(lattice.n_boxes()));
        control.push_control(&lattice, rule, &lattice.controls()[0]);
        let turn = RigidMotion {
            rotation: d.map(|x| x / length),
            centre: hinge[0],
            ..RigidMotion::default()
        };
        rigid.push_rigid(&lattice, rule, &turn);
        assert_eq!(control, rigid);
        // Trailing edge down.
        assert!(control.slope.iter().all(|s| *s < 0.0));
    }
}

fn one(value: c64) -> ComplexMatrix {
    ComplexMatrix::from_fn(1, 1, |_, _| value)
}

/// A function with the right parity: smooth, even real part, odd imaginary part.
fn smooth(k: f64) -> c64 {
    c64::new((0.9 * k).cos() / (1.0 + k * k), (1.3 * k).sin() + 0.2 * k.powi(3))
}

/// The spline's error falls with the fourth power of the spacing, its slope's with the third; parity holds towards k = 0
/// whether or not 0 is tabulated.
#[test]
fn interpolation_order_and_parity() {
    for from in [0.0, 1.0] {
        let errors: Vec<(f64, f64)> = [8, 16, 32]
            .iter()
            .map(|&n| {
                let h = 2.0 / f64::from(n);
                let k: Vec<f64> = (0..n).map(|i| h * (f64::from(i) + from / 2.0)).collect();
                let q: Vec<ComplexMatrix> = k.iter().map(|k| one(smooth(*k))).collect();
                let spline = KInterpolant::new(&k, &q, Interpolation::Spline).unwrap();
                let top = k[k.len() - 1] * 0.8;
                (0..200)
                    .map(|i| top * f64::from(i) / 200.0)
                    .fold((0.0, 0.0), |(value, slope), k| {
                        let e = (spline.at(k).unwrap()[(0, 0)] - smooth(k)).norm();
                        let exact = (smooth(k + 1e-5) - smooth(k - 1e-5)) / 2e-5;
                        let s = (spline.slope_at(k).unwrap()[(0, 0)] - exact).norm();
                        (e.max(value), s.max(slope))
                    })
            })
            .collect();
        let order = |a: f64, b: f64| (a / b).log2();
        let (value, slope) = (order(errors[1].0, errors[2].0), order(errors[1].1, errors[2].1));
        println!("from {from}: errors {errors:?}, orders {value:.2} {slope:.2}");
        assert!(value > 3.5 && slope > 2.5, "{errors:?}");
    }
    let k = [0.1, 0.3, 0.6];
    let q: Vec<ComplexMatrix> = k.iter().map(|k| one(smooth(*k))).collect();
    for how in [Interpolation::Spline, Interpolation::Linear] {
        let f = KInterpolant::new(&k, &q, how).unwrap();
        assert_eq!(f.at(0.0).unwrap()[(0, 0)].im, 0.0);
        assert!(f.slope_at(0.0).unwrap()[(0, 0)].re.abs() < 1e-14);
        for (k, q) in k.iter().zip(&q) {
            assert!((f.at(*k).unwrap()[(0, 0)] - q[(0, 0)]).norm() < 1e-14);
        }
    }
}

/// A constant real part and an imaginary part proportional to k are kept exactly, from one point up, in any order.
#[test]
fn interpolation_of_the_simplest() {
    let value = |k: f64| c64::new(2.5, -0.7 * k);
    for ks in [vec![0.3], vec![0.0, 0.4], vec![0.4, 0.2], vec![0.9, 0.0, 0.4, 0.1]] {
        let q: Vec<ComplexMatrix> = ks.iter().map(|k| one(value(*k))).collect();
        for how in [Interpolation::Spline, Interpolation::Linear] {
            let f = KInterpolant::new(&ks, &q, how).unwrap();
            let (_, high) = f.range();
            for i in 0..=20 {
                let k = high * f64::from(i) / 20.0;
                assert!((f.at(k).unwrap()[(0, 0)] - value(k)).norm() < 1e-13);
                assert!((f.slope_at(k).unwrap()[(0, 0)] - c64::new(0.0, -0.7)).norm() < 1e-12);
            }
        }
    }
}

#[test]
fn interpolation_refusals() {
    let q = |n: usize| (0..n).map(|i| one(c64::new(i as f64, 0.0))).collect::<Vec<_>>();
    let f = KInterpolant::new(&[0.1, 0.5], &q(2), Interpolation::Spline).unwrap();
    for k in [0.51, -0.01, f64::NAN, f64::INFINITY] {
        assert!(matches!(f.at(k), Err(TableError::Range { .. })));
    }
    for (k, n) in [
        (vec![], 0),
        (vec![0.1], 2),
        (vec![0.1, 0.1], 2),
        (vec![-0.1, 0.1], 2),
        (vec![f64::NAN], 1),
    ] {
        assert!(KInterpolant::new(&k, &q(n), Interpolation::Spline).is_err());
    }
    let bad = vec![one(c64::new(f64::NAN, 0.0))];
    assert!(KInterpolant::new(&[0.1], &bad, Interpolation::Linear).is_err());
}
