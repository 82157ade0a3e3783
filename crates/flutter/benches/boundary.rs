//! A whole flutter boundary: 5 Mach numbers, 8 reduced frequencies each, 5 modes, 30 speeds.

#[path = "../tests/goland/mod.rs"]
mod goland;

use dip_flutter::{
    BoundaryCase, FlutterProblem, GeneralizedForces, Interpolation, Method, Settings, Structure, Sweep,
    TabulatedForces, solve_boundary,
};
use faer::{Mat, c64};

const MACHS: [f64; 5] = [0.5, 0.68, 0.8, 0.9, 0.95];

fn main() {
    divan::main();
}

/// The Goland wing with Q tabulated and scaled by Prandtl and Glauert's factor, to stand for five Mach numbers.
fn tables() -> (Structure, Vec<TabulatedForces>, goland::Wing) {
    let text = include_str!("../../../tests/data/flutter/goland_wing.json");
    let wing = goland::Wing::read(text);
    let (structure, strips) = wing.model(3, 2);
    let ks = [0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.4];
    let tables = MACHS
        .iter()
        .map(|mach| {
            let factor = (1.0 - mach * mach).sqrt().recip();
            let q: Vec<_> = ks
                .iter()
                .map(|&k| {
                    let mut q = Mat::<c64>::zeros(5, 5);
                    strips.q(k, q.as_mut()).unwrap();
                    Mat::from_fn(5, 5, |i, j| q[(i, j)] * factor)
                })
                .collect();
            TabulatedForces::new(&ks, &q, Interpolation::EvenCubicSpline).unwrap()
        })
        .collect();
    (structure, tables, wing)
}

#[divan::bench(args = ["K", "KE", "PK", "g"])]
fn boundary(bencher: divan::Bencher<'_, '_>, name: &str) {
    let method = match name {
        "K" => Method::K,
        "KE" => Method::Ke,
        "PK" => Method::Pk,
        _ => Method::G,
    };
    let (structure, tables, wing) = tables();
    let semichord_m = wing.semichord_m();
    let speeds: Vec<f64> = (1..=30).map(|j| 8.0 * f64::from(j)).collect();
    let cases: Vec<_> = MACHS
        .iter()
        .zip(&tables)
        .map(|(&mach, forces)| BoundaryCase {
            problem: FlutterProblem {
                structure: &structure,
                forces,
                semichord_m,
                mach,
            },
            sweep: Sweep::Speed {
                density_kg_m3: wing.density_kg_m3,
                speeds_m_s: &speeds,
            },
        })
        .collect();
    bencher.bench(|| {
        let solutions = solve_boundary(&cases, method, &Settings::default()).unwrap();
        assert!(solutions.iter().all(|s| s.flutter().is_some()));
        solutions
    });
}
