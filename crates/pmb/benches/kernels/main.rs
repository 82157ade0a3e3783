//! The kernels of the flow solver on 53,760 cells in 8 blocks; items are cells.
//!
//! `RAYON_NUM_THREADS=1 cargo bench -p dip-pmb` for the time of one core. Shares of bandwidth and peak: `--example time_pmb`.

mod box_flow;

use box_flow::{CELLS, make};
use dip_krylov::{BlockMatrix, GcgSettings};
use dip_pmb::boundary::{fill_ghosts, fill_sides};
use dip_pmb::gas::Diatomic;
use dip_pmb::reconstruct::Reconstruction;
use dip_pmb::solver::Solver;
use divan::Bencher;
use divan::counter::ItemsCount;

fn main() {
    divan::main();
}

fn solver() -> Solver {
    make(8, CELLS).expect("a box").1
}

fn cells() -> ItemsCount {
    ItemsCount::new(CELLS.iter().product::<usize>())
}

#[divan::bench(args = ["first order", "no limiter", "van Albada"])]
fn residual(bencher: Bencher, scheme: &str) {
    let mut s = solver();
    let scheme = s.equations.scheme.with(match scheme {
        "first order" => Reconstruction::Constant,
        "no limiter" => Reconstruction::Unlimited,
        _ => Reconstruction::VanAlbada,
    });
    let mut out = vec![0.0; s.equations.len()];
    bencher
        .counter(cells())
        .bench_local(|| s.equations.residual_with(&scheme, &mut out));
}

/// Ghost cells from other blocks and from the boundary, and the fluxes through the boundary.
#[divan::bench]
fn boundary(bencher: Bencher) {
    let mut e = solver().equations;
    bencher.counter(cells()).bench_local(|| {
        let (level, boundaries, scheme) = (&e.level, &e.boundaries, &e.scheme);
        e.field
            .exchange(level, |b, w| fill_ghosts(level, boundaries, scheme, b, w));
        fill_sides(&Diatomic, &e.level, &e.boundaries, &e.scheme, &e.field, &mut e.sides);
    });
}

#[divan::bench]
fn time_step(bencher: Bencher) {
    let mut s = solver();
    bencher.counter(cells()).bench_local(|| s.set_time_step(100.0));
}

#[divan::bench]
fn jacobian(bencher: Bencher) {
    let e = solver().equations;
    let time = vec![1e-3; e.level.cell_count];
    let mut matrices: Vec<_> = e
        .level
        .blocks
        .iter()
        .map(|b| BlockMatrix::<f32>::zeros(b.layout.cells))
        .collect();
    bencher
        .counter(cells())
        .bench_local(|| e.jacobian(&time, &mut matrices));
}

/// Jacobian, coarse matrices, BILU(0) factors of all levels.
#[divan::bench]
fn preconditioner(bencher: Bencher) {
    let mut s = solver();
    bencher
        .counter(cells())
        .bench_local(|| s.build().expect("regular blocks"));
}

/// GCG with so many products; items are cells times products.
#[divan::bench(args = [5, 20, 35])]
fn gcg(bencher: Bencher, products: usize) {
    let mut s = solver();
    s.build().expect("regular blocks");
    let settings = GcgSettings {
        tolerance: 1e-30,
        max_iterations: products,
        patience: usize::MAX,
        directions: products,
    };
    bencher
        .counter(ItemsCount::new(products * CELLS.iter().product::<usize>()))
        .bench_local(|| s.solve(&settings).expect("no breakdown"));
}
