//! Times the flow solver's kernels: `cargo run --release -p dip-pmb --example time_pmb [blocks ni nj nk]`.
//!
//! Prints the best of several repetitions, in microseconds a cell, on one thread (set `RAYON_NUM_THREADS` for more).

use std::time::Instant;

use dip_grid::generate::BoxGrid;
use dip_grid::split;
use dip_krylov::{GcgSettings, LevelShape, Multilevel};
use dip_pmb::boundary::Boundary;
use dip_pmb::level::Level;
use dip_pmb::reconstruct::Reconstruction;
use dip_pmb::scheme::{Scheme, free_stream};
use dip_pmb::solver::{Equations, Solver};

fn best(cells: usize, repetitions: usize, mut work: impl FnMut()) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..repetitions {
        let start = Instant::now();
        work();
        least = least.min(start.elapsed().as_secs_f64());
    }
    least / cells as f64 * 1e6
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let given: Vec<usize> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let (blocks, cells) = match given[..] {
        [b, i, j, k] => (b, [i, j, k]),
        _ => (8, [96, 20, 28]),
    };
    let mut grid = BoxGrid::new([0.0; 3], [3.0, 0.8, 1.2], cells).wavy(0.04).make();
    split::split_into(&mut grid, blocks);
    let level = Level::new(&grid)?;
    let n = level.cell_count;
    let stream = free_stream(1.4, 0.8, 0.05, 0.03);
    let boundaries: Vec<Boundary> = level
        .patches
        .iter()
        .map(|p| {
            if p.name == "zmin" {
                Boundary::Wall
            } else {
                Boundary::FarField(stream)
            }
        })
        .collect();
    let scheme = Scheme::new(1.4, Reconstruction::VanAlbada, 1.0, n, level.planar, 0.8);
    let mut solver = Solver::new(Equations::new(level, scheme, boundaries, &stream)?);
    let start: Vec<f64> = solver
        .unknowns
        .iter()
        .enumerate()
        .map(|(m, w)| w * (1.0 + 0.02 * (m as f64 * 0.37).sin()))
        .collect();
    solver.set(&start);
    let repetitions = if n > 1_000_000 { 3 } else { 15 };
    println!("{n} cells in {} blocks", grid.blocks.len());
    let mut r = vec![0.0; 5 * n];
    let report = |what: &str, us: f64| println!("{what:<34} {us:8.4} us/cell");
    for (name, reconstruction) in [
        ("first order", Reconstruction::Constant),
        ("no limiter", Reconstruction::Unlimited),
        ("van Albada", Reconstruction::VanAlbada),
    ] {
        let scheme = scheme.with(reconstruction);
        report(
            &format!("residual, {name}"),
            best(n, repetitions, || solver.equations.residual_with(&scheme, &mut r)),
        );
    }
    solver.set_time_step(100.0);
    report("time step", best(n, repetitions, || solver.set_time_step(100.0)));
    let shape = LevelShape {
        cells: grid.blocks.iter().map(dip_grid::Block::cells).collect(),
        couplings: solver.equations.level.couplings(),
        parents: Vec::new(),
    };
    let mut one = Multilevel::<f32>::new(vec![shape]);
    let time = vec![1e-3; n];
    report(
        "Jacobian",
        best(n, repetitions, || {
            solver.equations.jacobian(&time, &mut one.finest_mut().blocks);
        }),
    );
    report(
        "BILU(0) factors, f32",
        best(n, repetitions, || one.factor().expect("regular blocks")),
    );
    let mut z = vec![0.0_f32; 5 * n];
    report("BILU(0) solve, f32", best(n, repetitions, || one.solve(&r, &mut z)));
    drop(one);
    report(
        "build (Jacobian, all levels)",
        best(n, repetitions, || solver.build().expect("regular blocks")),
    );
    let products = 20;
    let settings = GcgSettings {
        tolerance: 1e-12,
        max_iterations: products,
        patience: usize::MAX,
        directions: products,
    };
    let us = best(n, repetitions.min(5), || {
        solver.solve(&settings).expect("no breakdown");
    });
    report("GCG iteration, mean of 20", us / products as f64);
    println!(
        "{:.0} bytes a cell with {products} directions",
        solver.bytes() as f64 / n as f64
    );
    Ok(())
}
