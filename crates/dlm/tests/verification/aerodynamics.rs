//! Symmetry, similarity, limits and sign of the solved aerodynamics.

use dip_dlm::aic::{Aerodynamics, AicError};
use dip_dlm::gaf::PointRule;
use dip_dlm::kernel::{Kernel, downwash};
use dip_dlm::lattice::{Lattice, PlaneSymmetry, Surface};
use dip_dlm::motion::{BoxMotion, RigidMotion};
use dip_dlm::{ComplexMatrix, c64};

const KERNELS: [Kernel; 2] = [Kernel::NASTRAN, Kernel::QUARTIC];

fn relative(a: &ComplexMatrix, b: &ComplexMatrix) -> f64 {
    let top: f64 = a.data().iter().zip(b.data()).map(|(a, b)| (a - b).norm_sqr()).sum();
    top.sqrt() / b.norm()
}

/// A starboard half wing with sweep and dihedral over a small tail, well clear of both planes.
fn half_aircraft() -> Vec<Surface> {
    vec![
        Surface::trapezoid("wing", ([0.0, 0.3, 0.5], 1.0), ([0.7, 2.3, 0.9], 0.6), 4, 6),
        Surface::trapezoid("tail", ([3.0, 0.3, 1.2], 0.6), ([3.2, 1.1, 1.2], 0.4), 3, 3),
    ]
}

/// The mirror image in y = 0, z = 0 or both, always described from left to right (normal up).
fn reflected(surface: &Surface, flip_y: bool, flip_z: bool) -> Surface {
    let at = |p: [f64; 3]| {
        [
            p[0],
            if flip_y { -p[1] } else { p[1] },
            if flip_z { -p[2] } else { p[2] },
        ]
    };
    let mut other = surface.clone();
    (other.leading_edge_1, other.leading_edge_2) = (at(surface.leading_edge_1), at(surface.leading_edge_2));
    if flip_y {
        std::mem::swap(&mut other.leading_edge_1, &mut other.leading_edge_2);
        std::mem::swap(&mut other.chord_1, &mut other.chord_2);
    }
    other
}

/// Index in a reflected surface of the box that is the image of box `i` of the original.
fn image_index(lattice: &Lattice, i: usize, swap: bool) -> usize {
    let b = &lattice.boxes()[i];
    let surface = &lattice.surfaces()[b.surface];
    let (n_chord, n_span) = (surface.chordwise.count(), surface.spanwise.count());
    let first = lattice.surface_boxes(b.surface).start;
    let span = if swap { n_span - 1 - b.span_index } else { b.span_index };
    first + span * n_chord + b.chord_index
}

/// Half models with symmetry planes equal full models folded by hand, for k > 0, all signs, both planes.
#[test]
fn symmetry_planes_are_images() {
    let half = Lattice::new(half_aircraft(), PlaneSymmetry::None).unwrap();
    let n = half.n_boxes();
    let signs = [
        PlaneSymmetry::None,
        PlaneSymmetry::Symmetric,
        PlaneSymmetry::Antisymmetric,
    ];
    let sign = |s: PlaneSymmetry| match s {
        PlaneSymmetry::None => 0.0,
        PlaneSymmetry::Symmetric => 1.0,
        PlaneSymmetry::Antisymmetric => -1.0,
    };
    // One lattice with all four images.
    let mut surfaces = half_aircraft();
    for (y, z) in [(true, false), (false, true), (true, true)] {
        surfaces.extend(half_aircraft().iter().map(|s| reflected(s, y, z)));
    }
    let full = Lattice::new(surfaces, PlaneSymmetry::None).unwrap();
    for kernel in KERNELS {
        for kappa in [0.0, 0.7] {
            let d_full = &downwash(&full, kernel, 0.6, &[kappa])[0];
            for y in signs {
                for z in signs {
                    let model = Lattice::new(half_aircraft(), y).unwrap().with_symmetry_z(z);
                    let d = &downwash(&model, kernel, 0.6, &[kappa])[0];
                    let folded = ComplexMatrix::from_fn(n, n, |i, j| {
                        // A mirror in z turns a load along an upward normal into one along the image's downward side.
                        let image = |block: usize, swap: bool| d_full[(i, block * n + image_index(&half, j, swap))];
                        image(0, false) + image(1, true) * sign(y)
                            - image(2, false) * sign(z)
                            - image(3, true) * sign(y) * sign(z)
                    });
                    let error = relative(d, &folded);
                    assert!(error < 1e-12, "{kernel:?} kappa {kappa} y {y:?} z {z:?}: {error:.1e}");
                }
            }
        }
    }
}

/// Turning everything about the x axis changes nothing.
#[test]
fn rotation_about_the_stream() {
    let turn = |p: [f64; 3], a: f64| [p[0], p[1] * a.cos() - p[2] * a.sin(), p[1] * a.sin() + p[2] * a.cos()];
    let original = Lattice::new(half_aircraft(), PlaneSymmetry::None).unwrap();
    for angle in [0.4, 1.9, -2.5, std::f64::consts::PI] {
        let turned = half_aircraft()
            .into_iter()
            .map(|mut s| {
                s.leading_edge_1 = turn(s.leading_edge_1, angle);
                s.leading_edge_2 = turn(s.leading_edge_2, angle);
                s
            })
            .collect();
        let turned = Lattice::new(turned, PlaneSymmetry::None).unwrap();
        for kernel in KERNELS {
            let a = &downwash(&original, kernel, 0.7, &[0.9])[0];
            let b = &downwash(&turned, kernel, 0.7, &[0.9])[0];
            assert!(
                relative(b, a) < 1e-10,
                "turn {angle} {kernel:?}: {:.1e}",
                relative(b, a)
            );
        }
    }
}

/// D depends on lengths only through their ratios and kappa times length, and not on where x = 0 is.
#[test]
fn scale_and_origin() {
    let moved = |scale: f64, shift: f64| {
        let surfaces = half_aircraft()
            .into_iter()
            .map(|mut s| {
                for p in [&mut s.leading_edge_1, &mut s.leading_edge_2] {
                    *p = p.map(|x| scale * x);
                    p[0] += shift;
                }
                s.chord_1 *= scale;
                s.chord_2 *= scale;
                s
            })
            .collect();
        Lattice::new(surfaces, PlaneSymmetry::Symmetric).unwrap()
    };
    let a = &downwash(&moved(1.0, 0.0), Kernel::QUARTIC, 0.5, &[0.8])[0];
    let b = &downwash(&moved(1e-3, 0.0), Kernel::QUARTIC, 0.5, &[800.0])[0];
    let c = &downwash(&moved(1.0, 1e4), Kernel::QUARTIC, 0.5, &[0.8])[0];
    assert!(relative(b, a) < 1e-11, "{:.1e}", relative(b, a));
    // 1e4 chords away four digits of the coordinates themselves are gone.
    assert!(relative(c, a) < 1e-8, "{:.1e}", relative(c, a));
}

/// Steady flow: the Prandtl-Glauert-Goethert rule. Pressures at M equal those of the wing stretched by 1/beta along x at M = 0
/// with the same downwash, divided by beta.
#[test]
fn goethert_similarity() {
    let mach: f64 = 0.8;
    let beta = (1.0 - mach * mach).sqrt();
    let stretched = half_aircraft()
        .into_iter()
        .map(|mut s| {
            s.leading_edge_1[0] /= beta;
            s.leading_edge_2[0] /= beta;
            s.chord_1 /= beta;
            s.chord_2 /= beta;
            s
        })
        .collect();
    let solve = |surfaces: Vec<Surface>, mach: f64| {
        let model = Aerodynamics::new(
            Lattice::new(surfaces, PlaneSymmetry::Symmetric).unwrap(),
            Kernel::QUARTIC,
            1.0,
        )
        .unwrap();
        let n = model.lattice().n_boxes();
        let mut w = ComplexMatrix::from_fn(n, 1, |i, _| c64::new(-1.0 - 0.1 * i as f64, 0.0));
        model.factor(mach, 0.0).unwrap().solve_in_place(&mut w).unwrap();
        w
    };
    let (at_mach, at_rest) = (solve(half_aircraft(), mach), solve(stretched, 0.0));
    for (a, b) in at_mach.data().iter().zip(at_rest.data()) {
        assert!((a - b / beta).norm() < 1e-11 * b.norm(), "{a} {}", b / beta);
    }
}

/// In the two-dimensional limit the quarter/three-quarter chord rule gives the flat plate's lift slope 2 pi / beta and its moment
/// about the quarter chord exactly, for any number of boxes.
#[test]
fn two_dimensional_limit() {
    for (n_chord, mach) in [(1, 0.0_f64), (3, 0.0), (8, 0.6)] {
        let beta = (1.0 - mach * mach).sqrt();
        let wing = Surface::trapezoid(
            "infinite",
            ([0.0, -1e10, 0.0], 1.0),
            ([0.0, 1e10, 0.0], 1.0),
            n_chord,
            1,
        );
        let model = Aerodynamics::new(
            Lattice::new(vec![wing], PlaneSymmetry::None).unwrap(),
            Kernel::QUARTIC,
            0.5,
        )
        .unwrap();
        let mut w = ComplexMatrix::from_fn(n_chord, 1, |_, _| c64::new(-1.0, 0.0));
        model.factor(mach, 0.0).unwrap().solve_in_place(&mut w).unwrap();
        let boxes = model.lattice().boxes();
        let lift: f64 = boxes.iter().zip(w.column(0)).map(|(b, p)| p.re * b.chord).sum();
        let moment: f64 = boxes
            .iter()
            .zip(w.column(0))
            .map(|(b, p)| p.re * b.chord * (b.force_point[0] - 0.25))
            .sum();
        let exact = 2.0 * std::f64::consts::PI / beta;
        assert!((lift - exact).abs() < 1e-8 * exact, "{n_chord} boxes: {lift} {exact}");
        assert!(moment.abs() < 1e-8, "{n_chord} boxes: {moment}");
    }
}

/// The sign convention: nose up gives lift, moving up takes it away, a flap down gives lift.
#[test]
fn signs() {
    let wing = Surface::trapezoid("wing", ([0.0, 0.0, 0.0], 1.0), ([0.0, 3.0, 0.0], 1.0), 4, 6);
    let mut lattice = Lattice::new(vec![wing], PlaneSymmetry::Symmetric).unwrap();
    let boxes = (0..lattice.n_boxes())
        .filter(|&i| lattice.boxes()[i].chord_index == 3)
        .collect();
    // The hinge line's points in the unusual order: the flap's sense does not depend on it.
    let flap = dip_dlm::lattice::ControlSurface {
        name: "flap".into(),
        boxes,
        hinge: [[0.75, 3.0, 0.0], [0.75, 0.0, 0.0]],
    };
    lattice.add_control(flap).unwrap();
    let model = Aerodynamics::new(lattice, Kernel::QUARTIC, 0.5).unwrap();
    let lattice = model.lattice();
    let mut motion = BoxMotion::empty(lattice.n_boxes());
    let rule = PointRule::ControlPoint;
    motion.push_rigid(
        lattice,
        rule,
        &RigidMotion {
            rotation: [0.0, 1.0, 0.0],
            ..RigidMotion::default()
        },
    );
    motion.push_rigid(
        lattice,
        rule,
        &RigidMotion {
            translation: [0.0, 0.0, 1.0],
            ..RigidMotion::default()
        },
    );
    motion.push_control(lattice, rule, &lattice.controls()[0]);
    let pressures = model.pressures(0.3, &[0.0, 0.05], &motion).unwrap();
    let lift = |k: usize, mode: usize| -> c64 {
        pressures[k]
            .column(mode)
            .iter()
            .zip(lattice.boxes())
            .map(|(p, b)| p * b.area)
            .sum()
    };
    assert!(lift(0, 0).re > 0.0 && lift(0, 2).re > 0.0);
    assert!(lift(0, 1).norm() < 1e-14, "a steady plunge is no motion");
    // h = exp(i omega t): upward velocity leads by 90 degrees and takes lift away.
    assert!(lift(1, 1).im < 0.0);
}

/// Towards k = 0 the coefficients join the steady ones, and the imaginary part over k settles: nothing cancels.
#[test]
fn small_reduced_frequencies() {
    let model = Aerodynamics::new(
        Lattice::new(half_aircraft(), PlaneSymmetry::Symmetric).unwrap(),
        Kernel::QUARTIC,
        0.5,
    )
    .unwrap();
    let d = model.downwash(0.7, &[0.0, 1e-12, 1e-8, 1e-5]).unwrap();
    assert!(d[0].data().iter().all(|z| z.im == 0.0));
    for (m, k) in d[1..].iter().zip([1e-12, 1e-8, 1e-5]) {
        assert!(relative(m, &d[0]) < 100.0 * k, "k {k}: {:.1e}", relative(m, &d[0]));
    }
    let slope = |m: &ComplexMatrix, k: f64| -> Vec<f64> { m.data().iter().map(|z| z.im / k).collect() };
    let (a, b) = (slope(&d[1], 1e-12), slope(&d[2], 1e-8));
    let size = a.iter().map(|x| x * x).sum::<f64>().sqrt();
    let difference = a.iter().zip(&b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt();
    assert!(difference < 1e-6 * size, "{difference:.1e} of {size:.1e}");
}

/// High reduced frequencies and Mach numbers close to one stay finite.
#[test]
fn large_reduced_frequencies_are_finite() {
    for kernel in KERNELS {
        for mach in [0.0, 0.5, 0.95, 0.999] {
            let lattice = Lattice::new(half_aircraft(), PlaneSymmetry::Symmetric).unwrap();
            let model = Aerodynamics::new(lattice, kernel, 0.5).unwrap();
            for d in model.influence(mach, &[10.0, 50.0]).unwrap() {
                assert!(d.is_finite());
            }
        }
    }
}

/// Many reduced frequencies at once give the bits of each one alone, whatever the number of threads.
#[test]
fn bits_do_not_depend_on_threads() {
    let wing = Surface::trapezoid("wing", ([0.0, 0.0, 0.0], 1.0), ([0.7, 2.3, 0.4], 0.6), 12, 25);
    let model = Aerodynamics::new(
        Lattice::new(vec![wing], PlaneSymmetry::Symmetric).unwrap(),
        Kernel::QUARTIC,
        0.5,
    )
    .unwrap();
    let lattice = model.lattice();
    let mut motion = BoxMotion::empty(lattice.n_boxes());
    motion.push_field(lattice, PointRule::ControlPoint, |_, p| (p[0] * p[1], p[1]));
    let k = [0.0, 0.1, 0.4, 1.0];
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let together = model.pressures(0.6, &k, &motion).unwrap();
            let alone: Vec<_> = k
                .iter()
                .map(|k| model.pressures(0.6, &[*k], &motion).unwrap().remove(0))
                .collect();
            let influence = model.factor(0.6, 0.4).unwrap().influence().unwrap();
            (together, alone, influence)
        })
    };
    let one = run(1);
    for threads in [2, 3, 4] {
        let many = run(threads);
        assert_eq!(one.0, many.0, "{threads} threads");
        assert_eq!(one.1, many.1, "{threads} threads, one k at a time");
        assert_eq!(one.2, many.2, "{threads} threads, AIC");
    }
}

/// Boxes of different interference groups do not see each other.
#[test]
fn interference_groups() {
    let mut surfaces = half_aircraft();
    surfaces[1].interference_group = 2;
    let lattice = Lattice::new(surfaces, PlaneSymmetry::Symmetric).unwrap();
    let d = &downwash(&lattice, Kernel::QUARTIC, 0.3, &[0.5])[0];
    let wing = lattice.surface_boxes(0);
    for i in 0..lattice.n_boxes() {
        for j in 0..lattice.n_boxes() {
            assert_eq!(d[(i, j)].norm() > 0.0, wing.contains(&i) == wing.contains(&j));
        }
    }
}

/// What cannot be computed is refused with a reason.
#[test]
fn refusals() {
    let lattice = || Lattice::new(half_aircraft(), PlaneSymmetry::None).unwrap();
    let model = Aerodynamics::new(lattice(), Kernel::QUARTIC, 0.5).unwrap();
    for mach in [1.0, 1.3, -0.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(model.downwash(mach, &[0.1]), Err(AicError::Mach { .. })));
    }
    for k in [-0.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(model.factor(0.5, k), Err(AicError::ReducedFrequency { .. })));
    }
    for b in [0.0, -1.0, f64::NAN] {
        assert!(Aerodynamics::new(lattice(), Kernel::QUARTIC, b).is_err());
    }
    let mut short = ComplexMatrix::zeros(3, 1);
    assert!(matches!(
        model.factor(0.5, 0.1).unwrap().solve_in_place(&mut short),
        Err(AicError::Size { .. })
    ));
    assert!(matches!(
        model.pressures(0.5, &[0.1], &BoxMotion::empty(3)),
        Err(AicError::Size { .. })
    ));
}

/// A fin in the plane of symmetry is its own image: a half model with it gives the pressures of the full aircraft, loaded in
/// antisymmetric motion and idle in symmetric motion.
#[test]
fn fin_in_the_plane_of_symmetry() {
    let wing = Surface::trapezoid("wing", ([0.0, 0.0, 0.0], 1.0), ([0.4, 2.0, 0.2], 0.6), 4, 5);
    let tail = Surface::trapezoid("tail", ([3.0, 0.0, 1.0], 0.6), ([3.2, 1.0, 1.1], 0.4), 3, 3);
    let fin = Surface::trapezoid("fin", ([2.6, 0.0, 0.0], 1.0), ([3.0, 0.0, 1.0], 0.6), 4, 4);
    let half = vec![wing.clone(), tail.clone(), fin.clone()];
    let full = vec![
        wing.clone(),
        tail.clone(),
        fin,
        reflected(&wing, true, false),
        reflected(&tail, true, false),
    ];
    let n = 4 * 5 + 3 * 3;
    let n_half = n + 16;
    let w = |i: usize| c64::new((1.0 + i as f64).sin(), (0.3 * i as f64).cos());
    for (symmetry, sign) in [(PlaneSymmetry::Symmetric, 1.0), (PlaneSymmetry::Antisymmetric, -1.0)] {
        let model = |surfaces: &[Surface], symmetry| {
            Aerodynamics::new(Lattice::new(surfaces.to_vec(), symmetry).unwrap(), Kernel::QUARTIC, 0.5).unwrap()
        };
        let (small, large) = (model(&half, symmetry), model(&full, PlaneSymmetry::None));
        // The fin moves sideways in antisymmetric motion alone.
        let fin_moves = if sign < 0.0 { 1.0 } else { 0.0 };
        let mut a = ComplexMatrix::from_fn(n_half, 1, |i, _| if i < n { w(i) } else { w(i) * fin_moves });
        let mut b = ComplexMatrix::zeros(n_half + n, 1);
        for i in 0..n_half {
            b[(i, 0)] = a[(i, 0)];
        }
        for i in 0..n {
            b[(n_half + image_index(small.lattice(), i, true), 0)] = w(i) * sign;
        }
        small.factor(0.5, 0.4).unwrap().solve_in_place(&mut a).unwrap();
        large.factor(0.5, 0.4).unwrap().solve_in_place(&mut b).unwrap();
        for i in 0..n_half {
            assert!(
                (a[(i, 0)] - b[(i, 0)]).norm() < 1e-10 * a.norm(),
                "{symmetry:?} box {i}: {} {}",
                a[(i, 0)],
                b[(i, 0)]
            );
            if i >= n && sign > 0.0 {
                assert!(
                    a[(i, 0)].norm() < 1e-10 * a.norm(),
                    "the fin is idle in symmetric motion"
                );
            }
        }
    }
}
