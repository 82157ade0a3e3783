//! Time of one Mach number and reduced frequency: assembly, factorization, pressures of five modes.
//!
//! Run with one thread for CPU time: `RAYON_NUM_THREADS=1 cargo bench -p dip-dlm`.

use dip_dlm::aic::Aerodynamics;
use dip_dlm::gaf::PointRule;
use dip_dlm::kernel::Kernel;
use dip_dlm::lattice::{Lattice, PlaneSymmetry, Surface};
use dip_dlm::motion::BoxMotion;

fn main() {
    divan::main();
}

/// A swept full-span wing (as many boxes as PanelAero needs for it) with `n` x `n` boxes.
fn wing(n: usize) -> Aerodynamics {
    let half = |sign: f64| ([1.0, 3.0 * sign, 0.0], 0.7);
    let root = ([0.0, 0.0, 0.0], 1.0);
    let surfaces = vec![
        Surface::trapezoid("port", half(-1.0), root, n, n / 2),
        Surface::trapezoid("starboard", root, half(1.0), n, n / 2),
    ];
    Aerodynamics::new(
        Lattice::new(surfaces, PlaneSymmetry::None).unwrap(),
        Kernel::NASTRAN,
        0.5,
    )
    .unwrap()
}

fn modes(model: &Aerodynamics) -> BoxMotion {
    let mut motion = BoxMotion::empty(model.lattice().n_boxes());
    for power in 1..=5 {
        motion.push_field(model.lattice(), PointRule::ControlPoint, |_, p| {
            (p[1].abs().powi(power) * p[0], p[1].abs().powi(power))
        });
    }
    motion
}

#[divan::bench(args = [20, 40], sample_count = 5, sample_size = 1)]
fn downwash_matrix(bencher: divan::Bencher, n: usize) {
    let model = wing(n);
    bencher.bench_local(|| model.downwash(0.8, &[0.5]).unwrap());
}

#[divan::bench(args = [20], sample_count = 5, sample_size = 1)]
fn downwash_eight_frequencies(bencher: divan::Bencher, n: usize) {
    let model = wing(n);
    let k = [0.05, 0.1, 0.2, 0.3, 0.5, 0.8, 1.0, 1.5];
    bencher.bench_local(|| model.downwash(0.8, &k).unwrap());
}

#[divan::bench(args = [20, 40], sample_count = 5, sample_size = 1)]
fn pressures_of_five_modes(bencher: divan::Bencher, n: usize) {
    let model = wing(n);
    let motion = modes(&model);
    bencher.bench_local(|| model.pressures(0.8, &[0.5], &motion).unwrap());
}
