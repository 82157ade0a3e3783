//! Published and classical results: Possio's and Theodorsen's oscillating plate.

#[path = "../examples/validate_unsteady/pitching.rs"]
#[expect(dead_code, reason = "the page shows more of a run than this test looks at")]
mod pitching;
#[path = "../examples/validate_unsteady/possio.rs"]
mod possio;

use std::path::Path;

use nalgebra::Complex;
use pitching::Pitching;
use possio::PlateMotion;

/// Possio's equation, solved here, at a vanishing Mach number against Theodorsen (NACA Report 496): lift and moment, pitch and
/// plunge.
#[test]
fn possio_becomes_theodorsen() {
    for k in [0.05, 0.3, 1.0] {
        for axis in [0.0, 0.25, 0.6] {
            for motion in [PlateMotion::Pitch, PlateMotion::Plunge] {
                let ours = possio::coefficients(1e-3, k, axis, motion);
                let exact = possio::incompressible(k, axis, motion);
                for (a, b) in ours.iter().zip(&exact) {
                    let size = exact[0].norm();
                    assert!((a - b).norm() < 2e-3 * size, "{motion:?}, k {k}, axis {axis}: {a}, {b}");
                }
            }
        }
    }
    // theodorsen.csv: C(0.1) = 0.83192410 - 0.17230223 i; a plunging plate's circulatory lift is -2 pi C ik h/b.
    let k = 0.1;
    let ik = Complex::new(0.0, k);
    let [lift, _] = possio::incompressible(k, 0.25, PlateMotion::Plunge);
    let c = (lift + ik * ik * (2.0 * std::f64::consts::PI)) / (-ik * (4.0 * std::f64::consts::PI));
    assert!((c - Complex::new(0.831_924_10, -0.172_302_23)).norm() < 1e-7, "{c}");
}

/// Two cases of `docs/validation/unsteady` on a grid of every second point: a 1 % thick section pitches about its quarter
/// chord. Sign, phase origin and the meaning of k show in the lift, resolution of nose and tail in the moment.
#[test]
fn a_thin_section_pitches_as_possio_says() {
    let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes/thin_plate_1_unsteady_coarse.toml");
    let grid = dip_grid::recipe::make(&mesh).expect("the grid");
    for (mach, k) in [(0.5, 0.2), (0.3, 0.5)] {
        let case = Pitching {
            mach,
            k,
            mean_deg: 0.0,
            amplitude: 0.1,
            axis: Some(0.25),
            steps: 40,
            orders: 2.0,
        };
        let cycle = case.run(&grid).expect("a run");
        assert_eq!(cycle.not_converged, 0);
        let exact = possio::coefficients(mach, k, 0.25, PlateMotion::Pitch);
        for (name, ours, exact) in [
            ("lift", cycle.harmonics[0], exact[0]),
            ("moment about the quarter chord", cycle.harmonics[1], exact[1]),
        ] {
            let ratio = ours / exact;
            let (amplitude, phase) = (ratio.norm(), ratio.arg().to_degrees());
            assert!(
                (amplitude - 1.0).abs() < 0.03 && phase.abs() < 3.0,
                "{name} at Mach {mach}, k {k}: {ours}, Possio {exact}: amplitude {amplitude:.4}, phase {phase:.2} degrees"
            );
        }
    }
}
