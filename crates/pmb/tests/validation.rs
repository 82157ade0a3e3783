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

/// One case of `docs/validation/unsteady`: a 2 % thick section pitches about its quarter chord at Mach 0.5, k 0.2. Sign, phase
/// origin and the meaning of k all show in it.
#[test]
fn a_thin_section_pitches_as_possio_says() {
    let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes/thin_aerofoil_unsteady.toml");
    let grid = dip_grid::recipe::make(&mesh).expect("the grid");
    let case = Pitching {
        mach: 0.5,
        k: 0.2,
        mean_deg: 0.0,
        amplitude: 0.2,
        axis: Some(0.25),
        steps: 40,
        orders: 2.0,
    };
    let cycle = case.run(&grid).expect("a run");
    assert_eq!(cycle.not_converged, 0);
    let exact = possio::coefficients(0.5, 0.2, 0.25, PlateMotion::Pitch)[0];
    let ratio = cycle.harmonics[0] / exact;
    assert!(
        (ratio.norm() - 1.0).abs() < 0.03 && ratio.arg().to_degrees().abs() < 3.0,
        "lift {}, Possio {exact}: amplitude {:.4}, phase {:.2} degrees",
        cycle.harmonics[0],
        ratio.norm(),
        ratio.arg().to_degrees()
    );
}
