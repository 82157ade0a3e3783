//! Splines: rigid motion, virtual work, exact fields, refusals.

use dip_dlm::gaf::PointRule;
use dip_dlm::lattice::{Lattice, PlaneSymmetry, Surface};
use dip_dlm::motion::{BoxMotion, RigidMotion};
use dip_dlm::spline::{BeamSpline, SplineError, SplineKind, SplineSpec, Transfer};

const RULES: [PointRule; 2] = [PointRule::ControlPoint, PointRule::MidChord];

/// A swept half wing with dihedral.
fn wing() -> Lattice {
    Lattice::new(
        vec![Surface::trapezoid(
            "wing",
            ([0.0, 0.0, 0.1], 1.2),
            ([0.9, 3.0, 0.7], 0.8),
            4,
            6,
        )],
        PlaneSymmetry::Symmetric,
    )
    .unwrap()
}

/// Structural nodes in pseudo-random places over the wing, off its plane.
fn scattered(n: usize) -> Vec<[f64; 3]> {
    let mut state = 12345_u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..n)
        .map(|_| {
            let (s, c, off) = (next(), next(), next());
            [0.9 * s + 1.1 * c, 3.0 * s, 0.1 + 0.6 * s + 0.05 * (off - 0.5)]
        })
        .collect()
}

fn beam(direction: [f64; 3], rotations: bool) -> BeamSpline {
    BeamSpline {
        origin: [0.5, 0.0, 0.1],
        direction,
        torsion_flexibility: 1.3,
        displacement_flexibility: 0.0,
        bending_rotation_flexibility: rotations.then_some(0.0),
        twist_rotation_flexibility: rotations.then_some(0.0),
        twist_gradient: false,
    }
}

fn all(lattice: &Lattice) -> Vec<usize> {
    (0..lattice.n_boxes()).collect()
}

/// Splines that follow any rigid motion: (nodes, spline).
fn splines() -> Vec<(Vec<[f64; 3]>, SplineSpec)> {
    let lattice = wing();
    let spec = |n: usize, kind| SplineSpec {
        boxes: all(&lattice),
        nodes: (0..n).collect(),
        kind,
    };
    let axis: Vec<[f64; 3]> = (0..7)
        .map(|i| [0.5 + 0.15 * f64::from(i), 0.5 * f64::from(i), 0.1 + 0.1 * f64::from(i)])
        .collect();
    let ladder: Vec<[f64; 3]> = axis
        .iter()
        .flat_map(|p| [[p[0] - 0.3, p[1], p[2]], [p[0] + 0.4, p[1], p[2]]])
        .collect();
    vec![
        (scattered(15), spec(15, SplineKind::InfinitePlate { flexibility: 0.0 })),
        (scattered(15), spec(15, SplineKind::InfinitePlate { flexibility: 0.3 })),
        (scattered(15), spec(15, SplineKind::ThinPlate { flexibility: 0.0 })),
        (axis.clone(), spec(7, SplineKind::Beam(beam([0.3, 1.0, 0.2], true)))),
        (
            axis.clone(),
            spec(
                7,
                SplineKind::Beam(BeamSpline {
                    displacement_flexibility: 0.01,
                    ..beam([0.3, 1.0, 0.2], true)
                }),
            ),
        ),
        (ladder, spec(14, SplineKind::Beam(beam([0.3, 1.0, 0.2], false)))),
        (vec![[0.5, 1.0, 0.4]], spec(1, SplineKind::Rigid)),
    ]
}

fn freedoms(rigid: &RigidMotion, nodes: &[[f64; 3]]) -> Vec<f64> {
    nodes
        .iter()
        .flat_map(|p| {
            let along = |n: [f64; 3]| rigid.on(n, *p).0;
            let [a, b, c] = rigid.rotation;
            [
                along([1.0, 0.0, 0.0]),
                along([0.0, 1.0, 0.0]),
                along([0.0, 0.0, 1.0]),
                a,
                b,
                c,
            ]
        })
        .collect()
}

/// Every spline carries a rigid body's six motions over exactly.
#[test]
fn rigid_motions() {
    let lattice = wing();
    for rule in RULES {
        for (nodes, spec) in splines() {
            let transfer = Transfer::new(&lattice, &nodes, std::slice::from_ref(&spec), rule).unwrap();
            assert!(
                transfer.rigid_error() < 1e-9,
                "{:?}: {:.1e}",
                spec.kind,
                transfer.rigid_error()
            );
            assert!(transfer.uncovered_boxes().is_empty());
            let rigid = RigidMotion {
                translation: [0.3, -0.2, 1.0],
                rotation: [0.2, -0.4, 0.7],
                centre: [0.4, 0.2, -0.3],
            };
            let motion = transfer.motion(&[freedoms(&rigid, &nodes)]).unwrap();
            let mut exact = BoxMotion::empty(lattice.n_boxes());
            exact.push_rigid(&lattice, rule, &rigid);
            for i in 0..lattice.n_boxes() {
                for (a, b) in [
                    (motion.slope[i], exact.slope[i]),
                    (motion.at_control[i], exact.at_control[i]),
                    (motion.at_force[i], exact.at_force[i]),
                ] {
                    assert!((a - b).abs() < 1e-9, "{:?} box {i}: {a} {b}", spec.kind);
                }
            }
        }
    }
}

/// Forces through the transpose: virtual work of any displacement, total force and total moment are kept.
#[test]
fn forces_keep_work_force_and_moment() {
    let lattice = wing();
    for rule in RULES {
        for (nodes, spec) in splines() {
            let transfer = Transfer::new(&lattice, &nodes, std::slice::from_ref(&spec), rule).unwrap();
            let box_forces: Vec<f64> = (0..lattice.n_boxes()).map(|i| (i as f64 * 0.7).sin() + 0.3).collect();
            let nodal = transfer.nodal_forces(&box_forces).unwrap();
            let any: Vec<f64> = (0..6 * nodes.len()).map(|i| (i as f64 * 1.3).cos()).collect();
            let motion = transfer.motion(std::slice::from_ref(&any)).unwrap();
            let outside: f64 = motion.at_force.iter().zip(&box_forces).map(|(h, f)| h * f).sum();
            let inside: f64 = nodal.iter().zip(&any).map(|(f, u)| f * u).sum();
            assert!(
                (outside - inside).abs() < 1e-10 * outside.abs().max(1.0),
                "{:?}: {outside} {inside}",
                spec.kind
            );
            // The wing's rigid motions measure resultant force and moment.
            for axis in 0..3 {
                for rotation in [false, true] {
                    let mut unit = [0.0; 3];
                    unit[axis] = 1.0;
                    let rigid = if rotation {
                        RigidMotion {
                            rotation: unit,
                            ..RigidMotion::default()
                        }
                    } else {
                        RigidMotion {
                            translation: unit,
                            ..RigidMotion::default()
                        }
                    };
                    let work: f64 = nodal.iter().zip(freedoms(&rigid, &nodes)).map(|(f, u)| f * u).sum();
                    let direct: f64 = lattice
                        .boxes()
                        .iter()
                        .zip(&box_forces)
                        .map(|(b, f)| f * rigid.on(b.normal, b.force_point).0)
                        .sum();
                    assert!((work - direct).abs() < 1e-8, "{:?}: {work} {direct}", spec.kind);
                }
            }
        }
    }
}

/// The infinite plate passes through its nodes, and through the exact deflection of a plate under forces at the nodes (the
/// fundamental solution itself).
#[test]
fn infinite_plate_reproduces_plate_solutions() {
    let lattice = Lattice::new(
        vec![Surface::trapezoid(
            "flat",
            ([0.0, 0.0, 0.0], 1.0),
            ([0.0, 2.0, 0.0], 1.0),
            5,
            7,
        )],
        PlaneSymmetry::None,
    )
    .unwrap();
    let nodes: Vec<[f64; 3]> = scattered(12).iter().map(|p| [p[0], p[1], 0.0]).collect();
    // Forces in equilibrium: any three chosen so that the sums vanish.
    let mut force: Vec<f64> = (0..12).map(|i| (f64::from(i) * 2.1).sin()).collect();
    let (x, y) = (|i: usize| nodes[i][0], |i: usize| nodes[i][1]);
    let sums = |f: &[f64]| {
        let s: f64 = f[3..].iter().sum();
        let sx: f64 = (3..12).map(|i| f[i] * x(i)).sum();
        let sy: f64 = (3..12).map(|i| f[i] * y(i)).sum();
        (s, sx, sy)
    };
    let (s, sx, sy) = sums(&force);
    let determinant = (x(1) - x(0)) * (y(2) - y(0)) - (x(2) - x(0)) * (y(1) - y(0));
    let (a, b) = (-(sx - s * x(0)), -(sy - s * y(0)));
    force[1] = (a * (y(2) - y(0)) - b * (x(2) - x(0))) / determinant;
    force[2] = ((x(1) - x(0)) * b - (y(1) - y(0)) * a) / determinant;
    force[0] = -s - force[1] - force[2];
    let field = |p: [f64; 3]| -> (f64, f64) {
        let mut w = 0.2 - 0.3 * p[0] + 0.1 * p[1];
        let mut slope = -0.3;
        for (i, f) in force.iter().enumerate() {
            let (dx, dy) = (p[0] - nodes[i][0], p[1] - nodes[i][1]);
            let r2 = dx * dx + dy * dy;
            if r2 > 0.0 {
                w += f * r2 * r2.ln();
                slope += f * 2.0 * dx * (r2.ln() + 1.0);
            }
        }
        (w, slope)
    };
    let mode: Vec<f64> = nodes
        .iter()
        .flat_map(|p| [0.0, 0.0, field(*p).0, 0.0, 0.0, 0.0])
        .collect();
    for kind in [
        SplineKind::InfinitePlate { flexibility: 0.0 },
        SplineKind::ThinPlate { flexibility: 0.0 },
    ] {
        let spec = SplineSpec {
            boxes: all(&lattice),
            nodes: (0..12).collect(),
            kind,
        };
        let transfer = Transfer::new(&lattice, &nodes, &[spec], PointRule::ControlPoint).unwrap();
        let motion = transfer.motion(std::slice::from_ref(&mode)).unwrap();
        for (i, b) in lattice.boxes().iter().enumerate() {
            let (h, slope) = field(b.control_point);
            assert!((motion.at_control[i] - h).abs() < 1e-9, "{} {h}", motion.at_control[i]);
            assert!((motion.slope[i] - slope).abs() < 1e-8, "{} {slope}", motion.slope[i]);
            assert!((motion.at_force[i] - field(b.force_point).0).abs() < 1e-9);
        }
    }
}

/// The beam without rotations is the natural cubic spline of its nodes, and twist runs straight between them; on a swept axis
/// the slope is w0' sin(sweep) - theta cos(sweep).
#[test]
fn beam_is_a_natural_cubic_spline() {
    // Simply supported at 0, 1, 2 with a unit deflection in the middle: w = 1.5 y - 0.5 y^3 to the middle (theory of beams).
    let sweep: f64 = 0.5;
    let (cos, sin) = (sweep.cos(), sweep.sin());
    let along = [sin, cos, 0.0];
    let lattice = Lattice::new(
        vec![Surface::trapezoid(
            "wing",
            ([-0.4, 0.0, 0.0], 0.8),
            ([0.7, 1.7, 0.0], 0.8),
            3,
            9,
        )],
        PlaneSymmetry::None,
    )
    .unwrap();
    let nodes: Vec<[f64; 3]> = (0..3).map(|i| along.map(|a| a * f64::from(i))).collect();
    let twist = [0.0, 0.3, -0.2];
    // Twist is the rotation about the beam; the bending rotations are not attached.
    let mode: Vec<f64> = (0..3)
        .flat_map(|i| {
            let w = if i == 1 { 1.0 } else { 0.0 };
            [0.0, 0.0, w, twist[i] * along[0], twist[i] * along[1], 0.0]
        })
        .collect();
    let axis = BeamSpline {
        origin: [0.0; 3],
        direction: along,
        torsion_flexibility: 0.7,
        displacement_flexibility: 0.0,
        bending_rotation_flexibility: None,
        twist_rotation_flexibility: Some(0.0),
        twist_gradient: false,
    };
    for gradient in [false, true] {
        let kind = SplineKind::Beam(BeamSpline {
            twist_gradient: gradient,
            ..axis.clone()
        });
        let spec = SplineSpec {
            boxes: all(&lattice),
            nodes: vec![0, 1, 2],
            kind,
        };
        let transfer = Transfer::new(&lattice, &nodes, &[spec], PointRule::ControlPoint).unwrap();
        let motion = transfer.motion(std::slice::from_ref(&mode)).unwrap();
        for (i, b) in lattice.boxes().iter().enumerate() {
            let p = b.control_point;
            let (x, y) = (p[0] * cos - p[1] * sin, p[0] * sin + p[1] * cos);
            // Mirror symmetric about the middle; beyond the ends straight.
            let half = |y: f64| {
                if y < 0.0 {
                    (1.5 * y, 1.5)
                } else {
                    (1.5 * y - 0.5 * y.powi(3), 1.5 - 1.5 * y * y)
                }
            };
            let (w, bend) = if y <= 1.0 {
                half(y)
            } else {
                (half(2.0 - y).0, -half(2.0 - y).1)
            };
            let t = y.clamp(0.0, 2.0);
            let (theta, rate) = if t < 1.0 {
                (0.3 * t, 0.3)
            } else {
                (0.3 - 0.5 * (t - 1.0), -0.5)
            };
            let rate = if (0.0..=2.0).contains(&y) && gradient {
                rate
            } else {
                0.0
            };
            let h = w - x * theta;
            let slope = sin * (bend - x * rate) - cos * theta;
            assert!(
                (motion.at_control[i] - h).abs() < 1e-9,
                "box {i} y {y}: {} {h}",
                motion.at_control[i]
            );
            assert!(
                (motion.slope[i] - slope).abs() < 1e-9,
                "box {i} y {y}: {} {slope}",
                motion.slope[i]
            );
        }
    }
}

/// Nodes on one line along the beam without rotations say nothing of twist: the boxes then follow bending alone.
#[test]
fn beam_without_twist() {
    let lattice = wing();
    let nodes: Vec<[f64; 3]> = (0..4).map(|i| [0.5, f64::from(i), 0.1 + 0.2 * f64::from(i)]).collect();
    let kind = SplineKind::Beam(beam([0.0, 1.0, 0.2], false));
    let spec = SplineSpec {
        boxes: all(&lattice),
        nodes: (0..4).collect(),
        kind,
    };
    Transfer::new(&lattice, &nodes, &[spec], PointRule::MidChord).unwrap();
}

#[test]
fn refusals() {
    let lattice = wing();
    let build = |nodes: &[[f64; 3]], spec: SplineSpec| Transfer::new(&lattice, nodes, &[spec], PointRule::ControlPoint);
    let plate = |n: usize| SplineSpec {
        boxes: all(&lattice),
        nodes: (0..n).collect(),
        kind: SplineKind::InfinitePlate { flexibility: 0.0 },
    };
    let line: Vec<[f64; 3]> = (0..5).map(|i| [0.1 * f64::from(i), f64::from(i), 0.0]).collect();
    assert!(matches!(build(&line, plate(5)), Err(SplineError::Collinear { .. })));
    assert!(matches!(build(&line, plate(2)), Err(SplineError::TooFewNodes { .. })));
    let mut twice = scattered(6);
    twice[4] = twice[1];
    assert!(matches!(
        build(&twice, plate(6)),
        Err(SplineError::Coincident { a: 1, b: 4, .. })
    ));
    let mut nan = scattered(6);
    nan[2][1] = f64::NAN;
    assert!(matches!(build(&nan, plate(6)), Err(SplineError::Value { .. })));
    assert!(matches!(
        build(&scattered(6), plate(7)),
        Err(SplineError::Index { what: "node", .. })
    ));
    let mut far = plate(6);
    far.boxes.push(999);
    assert!(matches!(
        build(&scattered(6), far),
        Err(SplineError::Index { what: "box", .. })
    ));
    let mut negative = plate(6);
    negative.kind = SplineKind::InfinitePlate { flexibility: -1.0 };
    assert!(matches!(build(&scattered(6), negative), Err(SplineError::Value { .. })));
    // Three nodes at one station of a beam, rigidly attached: one too many.
    let station = vec![[0.0, 1.0, 0.3], [0.5, 1.0, 0.3], [1.0, 1.0, 0.3], [0.5, 2.0, 0.5]];
    let kind = SplineKind::Beam(beam([0.0, 1.0, 0.2], false));
    let spec = SplineSpec {
        boxes: all(&lattice),
        nodes: (0..4).collect(),
        kind,
    };
    assert!(matches!(
        build(&station, spec.clone()),
        Err(SplineError::Singular { .. })
    ));
    let soft = SplineKind::Beam(BeamSpline {
        displacement_flexibility: 0.01,
        ..beam([0.0, 1.0, 0.2], false)
    });
    assert!(
        build(
            &station,
            SplineSpec {
                kind: soft,
                ..spec.clone()
            }
        )
        .is_ok()
    );
    let upright = SplineKind::Beam(beam(lattice.boxes()[0].normal, true));
    assert!(matches!(
        build(&station, SplineSpec { kind: upright, ..spec }),
        Err(SplineError::Value { .. })
    ));
    // A box with two masters.
    let nodes = scattered(6);
    let both = Transfer::new(&lattice, &nodes, &[plate(6), plate(6)], PointRule::ControlPoint);
    assert!(matches!(both, Err(SplineError::Twice { .. })));
    // Coplanar nodes cannot carry a fin.
    let tail = Lattice::new(
        vec![
            Surface::trapezoid("wing", ([0.0, 0.0, 0.0], 1.0), ([0.0, 2.0, 0.0], 1.0), 2, 2),
            Surface::trapezoid("winglet", ([0.0, 2.0, 0.0], 1.0), ([0.2, 2.0, 1.0], 1.0), 2, 2),
        ],
        PlaneSymmetry::None,
    )
    .unwrap();
    let flat: Vec<[f64; 3]> = scattered(8).iter().map(|p| [p[0], p[1], 0.0]).collect();
    let kind = SplineKind::ThinPlate { flexibility: 0.0 };
    let spec = SplineSpec {
        boxes: all(&tail),
        nodes: (0..8).collect(),
        kind,
    };
    assert!(matches!(
        Transfer::new(&tail, &flat, &[spec], PointRule::ControlPoint),
        Err(SplineError::Rigid { .. })
    ));
    let plate = SplineSpec {
        boxes: all(&tail),
        nodes: (0..8).collect(),
        kind: SplineKind::InfinitePlate { flexibility: 0.0 },
    };
    assert!(matches!(
        Transfer::new(&tail, &flat, &[plate], PointRule::ControlPoint),
        Err(SplineError::Normals { .. })
    ));
}

/// A fine structural mesh: 1,681 nodes over 400 boxes stay exact and quick.
#[test]
fn many_nodes() {
    let lattice = Lattice::new(
        vec![Surface::trapezoid(
            "wing",
            ([0.0, 0.0, 0.0], 1.2),
            ([0.9, 3.0, 0.0], 0.8),
            20,
            20,
        )],
        PlaneSymmetry::Symmetric,
    )
    .unwrap();
    let nodes: Vec<[f64; 3]> = (0..41)
        .flat_map(|j| {
            (0..41).map(move |i| {
                let (s, c) = (f64::from(j) / 40.0, f64::from(i) / 40.0);
                [0.9 * s + c * (1.2 - 0.4 * s), 3.0 * s, 0.0]
            })
        })
        .collect();
    let kind = SplineKind::InfinitePlate { flexibility: 0.0 };
    let spec = SplineSpec {
        boxes: all(&lattice),
        nodes: (0..nodes.len()).collect(),
        kind,
    };
    let transfer = Transfer::new(&lattice, &nodes, &[spec], PointRule::ControlPoint).unwrap();
    assert!(transfer.rigid_error() < 1e-8, "{:.1e}", transfer.rigid_error());
    // A smooth bending shape comes over to the order of the spacing squared.
    let field = |p: [f64; 3]| (p[1] * p[1] * (1.0 + 0.2 * p[0]), 0.2 * p[1] * p[1]);
    let mode: Vec<f64> = nodes
        .iter()
        .flat_map(|p| [0.0, 0.0, field(*p).0, 0.0, 0.0, 0.0])
        .collect();
    let motion = transfer.motion(&[mode]).unwrap();
    for (i, b) in lattice.boxes().iter().enumerate() {
        assert!((motion.at_control[i] - field(b.control_point).0).abs() < 2e-3);
        assert!((motion.slope[i] - field(b.control_point).1).abs() < 5e-2);
    }
}
