//! Geometry of boxes, and what the checks find.

use dip_dlm::kernel::Kernel;
use dip_dlm::lattice::{
    ControlSurface, Divisions, Finding, FindingKind, Lattice, LatticeError, PlaneSymmetry, Severity, Surface,
    boxes_per_wavelength,
};

fn wing() -> Surface {
    Surface::trapezoid("wing", ([0.0, 0.0, 0.0], 2.0), ([1.0, 4.0, 0.0], 1.0), 4, 8)
}

fn find(findings: &[Finding], kind: FindingKind) -> Option<&Finding> {
    findings.iter().find(|f| f.kind == kind)
}

/// Areas add up to the trapezoids'; points lie where they belong, also with uneven divisions and dihedral.
#[test]
fn boxes_of_a_trapezoid() {
    let mut surface = Surface::trapezoid("fin", ([0.0, 1.0, 0.5], 2.0), ([1.0, 1.0, 3.5], 1.0), 3, 2);
    surface.chordwise = Divisions::Fractions(vec![0.0, 0.1, 0.4, 1.0]);
    surface.spanwise = Divisions::Fractions(vec![0.0, 0.25, 1.0]);
    surface.first_box_id = 1001;
    let lattice = Lattice::new(vec![surface], PlaneSymmetry::None).unwrap();
    assert_eq!(lattice.n_boxes(), 6);
    assert!((lattice.area() - 1.5 * 3.0).abs() < 1e-14);
    let b = &lattice.boxes()[4];
    assert_eq!((b.id, b.chord_index, b.span_index), (1005, 1, 1));
    // Upwards from the foot: the normal is to port.
    assert_eq!(b.normal, [0.0, -1.0, 0.0]);
    // Span fraction 0.625, chord 1.375, leading edge 0.625; chord fractions 0.1 to 0.4.
    let lead = 0.625 + 0.1 * 1.375;
    let chord = 0.3 * 1.375;
    for (point, part) in [(b.force_point, 0.25), (b.mid_chord, 0.5), (b.control_point, 0.75)] {
        let expected = [lead + part * chord, 1.0, 0.5 + 3.0 * 0.625];
        assert!(
            point.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14),
            "{point:?} {expected:?}"
        );
    }
    assert!((b.doublet_1[0] - (0.25 + (0.1 + 0.075) * 1.75)).abs() < 1e-14);
    assert!((b.chord - chord).abs() < 1e-14 && (b.width - 2.25).abs() < 1e-14);
}

/// A well-made lattice has no findings.
#[test]
fn good_lattice_passes() {
    let mut surface = wing();
    surface.chordwise = Divisions::Equal(10);
    let lattice = Lattice::new(vec![surface], PlaneSymmetry::Symmetric).unwrap();
    assert_eq!(lattice.check(Kernel::QUARTIC, 0.7, 0.1, 1.0), vec![]);
}

#[test]
fn mach_aspect_and_wave_length() {
    let mut surface = wing();
    surface.chordwise = Divisions::Equal(3);
    surface.spanwise = Divisions::Equal(1);
    let lattice = Lattice::new(vec![surface], PlaneSymmetry::None).unwrap();
    let findings = lattice.check(Kernel::NASTRAN, 1.05, 3.0, 1.0);
    assert_eq!(find(&findings, FindingKind::Mach).unwrap().severity, Severity::Error);
    // Width 4 over mean chord 0.5 is 8: too much for the parabolic fit, not for the quartic.
    let aspect = find(&findings, FindingKind::AspectRatio).unwrap();
    assert_eq!((aspect.severity, aspect.boxes.len()), (Severity::Warning, 3));
    assert!(find(&lattice.check(Kernel::QUARTIC, 0.5, 0.0, 1.0), FindingKind::AspectRatio).is_none());
    assert_eq!(
        find(&findings, FindingKind::FewChordwise).unwrap().severity,
        Severity::Warning
    );
    // Wave length 2 pi / 3 over a chord of 0.5: 4.2 boxes.
    assert!((boxes_per_wavelength(&lattice, 3.0, 1.0) - 2.0 * std::f64::consts::PI / 3.0 / 0.5).abs() < 1e-12);
    assert_eq!(
        find(&findings, FindingKind::WaveLength).unwrap().severity,
        Severity::Warning
    );
    let advice = lattice.check(Kernel::NASTRAN, 0.5, 0.4, 1.0);
    assert_eq!(
        find(&advice, FindingKind::WaveLength).unwrap().severity,
        Severity::Advice
    );
    assert!(find(&lattice.check(Kernel::NASTRAN, 0.5, 0.0, 1.0), FindingKind::WaveLength).is_none());
}

#[test]
fn overlaps() {
    let flat = |name: &str, x: f64, y0: f64, y1: f64, n: usize| {
        Surface::trapezoid(name, ([x, y0, 0.0], 1.0), ([x, y1, 0.0], 1.0), 4, n)
    };
    let findings = |surfaces: Vec<Surface>| Lattice::new(surfaces, PlaneSymmetry::None).unwrap().check_geometry();
    // The same surface twice, also the other way round; a part of another; a copy inside.
    for other in [
        flat("copy", 0.0, 0.0, 4.0, 8),
        flat("turned", 0.0, 4.0, 0.0, 8),
        flat("part", 0.7, 1.0, 2.0, 2),
    ] {
        let found = findings(vec![flat("wing", 0.0, 0.0, 4.0, 8), other]);
        let overlap = find(&found, FindingKind::Overlap).expect("overlap");
        assert_eq!(overlap.severity, Severity::Error);
    }
    // Side by side, one behind the other, one above the other, crossing as a cross: nothing.
    for other in [
        flat("outboard", 0.0, 4.0, 6.0, 4),
        flat("behind", 1.0, 0.0, 4.0, 8),
        Surface::trapezoid("above", ([0.0, 0.0, 0.3], 1.0), ([0.0, 4.0, 0.3], 1.0), 4, 8),
        Surface::trapezoid("fin", ([0.0, 1.0, 0.1], 1.0), ([0.0, 1.0, 2.0], 1.0), 4, 8),
    ] {
        assert_eq!(findings(vec![flat("wing", 0.0, 0.0, 4.0, 8), other]), vec![]);
    }
    // Different groups may cover the same place.
    let mut other = flat("copy", 0.0, 0.0, 4.0, 8);
    other.interference_group = 2;
    assert_eq!(findings(vec![flat("wing", 0.0, 0.0, 4.0, 8), other]), vec![]);
}

/// A tail whose strips do not line up with the wing's: control points on the wing's strip edges.
#[test]
fn misaligned_strips() {
    let wing = Surface::trapezoid("wing", ([0.0, 0.0, 0.0], 1.0), ([0.0, 4.0, 0.0], 1.0), 4, 4);
    let tail = |n: usize, z: f64| Surface::trapezoid("tail", ([3.0, 0.0, z], 1.0), ([3.0, 4.0, z], 1.0), 4, n);
    let findings = |n, z| {
        Lattice::new(vec![wing.clone(), tail(n, z)], PlaneSymmetry::None)
            .unwrap()
            .check_geometry()
    };
    assert_eq!(findings(4, 0.0), vec![]);
    // Two strips: centres at y = 1 and 3, edges of the wing's strips.
    assert_eq!(
        find(&findings(2, 0.0), FindingKind::PointOnEdge).unwrap().severity,
        Severity::Error
    );
    assert_eq!(
        find(&findings(2, 0.004), FindingKind::PointOnEdge).unwrap().severity,
        Severity::Warning
    );
    assert_eq!(findings(2, 0.5), vec![]);
    let lattice = Lattice::new(vec![wing.clone(), tail(2, 0.0)], PlaneSymmetry::None).unwrap();
    assert!(dip_dlm::aic::Aerodynamics::new(lattice, Kernel::QUARTIC, 0.5).is_err());
}

#[test]
fn symmetry_plane_crossed() {
    let full = Surface::trapezoid("wing", ([0.0, -2.0, 0.0], 1.0), ([0.0, 2.0, 0.0], 1.0), 4, 4);
    let found = Lattice::new(vec![full], PlaneSymmetry::Symmetric)
        .unwrap()
        .check_geometry();
    assert_eq!(
        find(&found, FindingKind::CrossesSymmetryPlane).unwrap().severity,
        Severity::Error
    );
}

#[test]
fn impossible_descriptions() {
    let fails = |change: &dyn Fn(&mut Surface)| {
        let mut surface = wing();
        change(&mut surface);
        Lattice::new(vec![surface], PlaneSymmetry::None).unwrap_err()
    };
    assert!(matches!(
        fails(&|s| s.chordwise = Divisions::Equal(0)),
        LatticeError::Divisions { .. }
    ));
    for list in [
        vec![],
        vec![0.0],
        vec![0.0, 0.5, 0.5, 1.0],
        vec![0.1, 1.0],
        vec![0.0, 0.9],
        vec![0.0, f64::NAN, 1.0],
    ] {
        assert!(matches!(
            fails(&|s| s.spanwise = Divisions::Fractions(list.clone())),
            LatticeError::Divisions { .. }
        ));
    }
    assert!(matches!(
        fails(&|s| s.chordwise = Divisions::Equal(usize::MAX)),
        LatticeError::TooMany { .. }
    ));
    assert!(matches!(fails(&|s| s.chord_1 = -1.0), LatticeError::Shape { .. }));
    assert!(matches!(
        fails(&|s| (s.chord_1, s.chord_2) = (0.0, 0.0)),
        LatticeError::Shape { .. }
    ));
    assert!(matches!(
        fails(&|s| s.leading_edge_2 = [1.0, 0.0, 0.0]),
        LatticeError::Shape { .. }
    ));
    assert!(matches!(
        fails(&|s| s.leading_edge_2[1] = f64::NAN),
        LatticeError::Shape { .. }
    ));
    assert_eq!(
        Lattice::new(vec![], PlaneSymmetry::None).unwrap_err(),
        LatticeError::Empty
    );
    let mut lattice = Lattice::new(vec![wing()], PlaneSymmetry::None).unwrap();
    let control = |boxes, b| ControlSurface {
        name: "flap".into(),
        boxes,
        hinge: [[0.0; 3], b],
    };
    assert!(lattice.add_control(control(vec![99], [0.0, 1.0, 0.0])).is_err());
    assert!(lattice.add_control(control(vec![], [0.0, 1.0, 0.0])).is_err());
    assert!(lattice.add_control(control(vec![0], [0.0; 3])).is_err());
}

/// The stamp changes with anything that the coefficients depend on and with nothing else.
#[test]
fn geometry_hash() {
    let base = Lattice::new(vec![wing()], PlaneSymmetry::Symmetric).unwrap();
    let mut renamed = wing();
    renamed.name = "another name".into();
    renamed.first_box_id = 77;
    assert_eq!(
        base.geometry_hash(),
        Lattice::new(vec![renamed], PlaneSymmetry::Symmetric)
            .unwrap()
            .geometry_hash()
    );
    let mut others = vec![
        Lattice::new(vec![wing()], PlaneSymmetry::None).unwrap(),
        base.clone().with_symmetry_z(PlaneSymmetry::Symmetric),
    ];
    let changes: [fn(&mut Surface); 4] = [
        |s| s.chord_2 += 1e-12,
        |s| s.interference_group = 2,
        |s| s.chordwise = Divisions::Equal(5),
        |s| s.leading_edge_2[2] += 1e-9,
    ];
    for change in changes {
        let mut s = wing();
        change(&mut s);
        others.push(Lattice::new(vec![s], PlaneSymmetry::Symmetric).unwrap());
    }
    for other in others {
        assert_ne!(base.geometry_hash(), other.geometry_hash());
    }
}

/// A fin through a wing with a control point on one of the wing's doublet lines.
#[test]
fn crossing_surfaces() {
    let wing = Surface::trapezoid("wing", ([0.0, 0.0, 0.0], 1.0), ([0.0, 4.0, 0.0], 1.0), 4, 4);
    // Strip centres of the fin at z = -0.5 and 0 (in the wing's plane), 0.5; y = 1.4 inside the wing's second strip.
    let fin = |x: f64| Surface::trapezoid("fin", ([x, 1.4, -0.75], 1.0), ([x, 1.4, 0.75], 1.0), 4, 3);
    let findings = |x: f64| {
        Lattice::new(vec![wing.clone(), fin(x)], PlaneSymmetry::None)
            .unwrap()
            .check_geometry()
    };
    // Control points lie half a box behind doublet lines.
    assert_eq!(
        find(&findings(0.125), FindingKind::PointOnDoubletLine)
            .unwrap()
            .severity,
        Severity::Error
    );
    assert_eq!(findings(0.05), vec![]);
}

/// A surface a hair above another one is warned about; well above, or behind, it is not.
#[test]
fn close_above() {
    let wing = Surface::trapezoid("wing", ([0.0, 0.0, 0.0], 1.0), ([0.0, 4.0, 0.0], 1.0), 4, 4);
    let other = |x: f64, z: f64| Surface::trapezoid("other", ([x, 0.0, z], 1.0), ([x, 4.0, z], 1.0), 4, 4);
    let findings = |x, z| {
        Lattice::new(vec![wing.clone(), other(x, z)], PlaneSymmetry::None)
            .unwrap()
            .check_geometry()
    };
    assert_eq!(
        find(&findings(0.1, 0.01), FindingKind::CloseAbove).unwrap().severity,
        Severity::Warning
    );
    assert_eq!(findings(0.1, 0.3), vec![]);
    assert_eq!(findings(1.5, 0.01), vec![]);
}

/// Random pairs of surfaces, many of them degenerate on purpose: nothing panics, and what passes the checks gives finite
/// coefficients.
#[test]
fn random_lattices() {
    let mut state = 2026_u64;
    let mut next = |choices: &[f64]| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        choices[(state >> 33) as usize % choices.len()]
    };
    let places = [0.0, 0.25, 0.5, 1.0, 1.0, -1.0, 2.0, 1e-3, 1.0 / 3.0, 1e-9];
    let (mut solved, mut refused) = (0, 0);
    for _ in 0..3000 {
        let mut surface = |name: &str| {
            let mut p = || [next(&places), next(&places), next(&places)];
            let (a, b) = (p(), p());
            let (c1, c2) = (next(&places), next(&places));
            let mut s = Surface::trapezoid(
                name,
                (a, c1),
                (b, c2),
                next(&[1.0, 2.0, 3.0]) as usize,
                next(&[1.0, 2.0, 4.0]) as usize,
            );
            s.interference_group = next(&[1.0, 1.0, 1.0, 2.0]) as u32;
            s
        };
        let surfaces = vec![surface("one"), surface("two")];
        let symmetry = [
            PlaneSymmetry::None,
            PlaneSymmetry::Symmetric,
            PlaneSymmetry::Antisymmetric,
        ][next(&[0.0, 1.0, 2.0]) as usize];
        let Ok(lattice) = Lattice::new(surfaces.clone(), symmetry) else {
            refused += 1;
            continue;
        };
        if lattice
            .check(Kernel::QUARTIC, 0.5, 0.5, 1.0)
            .iter()
            .any(|f| f.severity == Severity::Error)
        {
            refused += 1;
            continue;
        }
        let mach = next(&[0.0, 0.5, 0.95]);
        for kernel in [Kernel::NASTRAN, Kernel::QUARTIC] {
            for d in dip_dlm::kernel::downwash(&lattice, kernel, mach, &[0.0, 0.3, 5.0]) {
                assert!(d.is_finite(), "{mach} {symmetry:?} {surfaces:?}");
            }
        }
        solved += 1;
    }
    println!("{solved} lattices gave finite coefficients, {refused} were refused");
    assert!(solved > 300 && refused > 300);
}
