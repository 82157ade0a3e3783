//! Times the linear algebra kernels on one block: `cargo run --release -p dip-krylov --example time_krylov [ni nj nk]`.
//!
//! Prints microseconds a cell (best of several) and the memory bandwidth that the least possible traffic stands for.

use std::time::Instant;

use dip_krylov::{Bilu, BlockMatrix, Storage, VARIABLES, vector};

fn best(cells: usize, mut work: impl FnMut()) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..7 {
        let start = Instant::now();
        work();
        least = least.min(start.elapsed().as_secs_f64());
    }
    least / cells as f64 * 1e6
}

fn run<S: Storage>(cells: [usize; 3], name: &str) {
    let n: usize = cells.iter().product();
    let mut a = BlockMatrix::<S>::zeros(cells);
    {
        let (diagonal, lower, upper) = a.arrays_mut();
        for (m, set) in [diagonal, lower, upper].into_iter().enumerate() {
            for (e, v) in set.iter_mut().enumerate() {
                let unit = if m == 0 && (e % 25) % 6 == 0 { 4.0 } else { 0.0 };
                *v = S::from_f64(unit + ((e * 7919) % 1000) as f64 * 1e-3 - 0.5);
            }
        }
    }
    let mut f = Bilu::<S>::zeros(cells);
    let mut z = vec![S::default(); n * VARIABLES];
    let r = vec![1.0; n * VARIABLES];
    let mut y = vec![0.0; n * VARIABLES];
    let size = size_of::<S>();
    let report = |what: &str, us: f64, bytes: usize| {
        println!(
            "{name} {what:<10} {us:.4} us/cell  {:.1} GB/s",
            bytes as f64 / us * 1e-3
        );
    };
    report(
        "factor",
        best(n, || f.factor(&a).expect("dominant matrix")),
        14 * 25 * size,
    );
    report(
        "solve",
        best(n, || f.solve(&a, &r, &mut z)),
        7 * 25 * size + 5 * (8 + size),
    );
    report(
        "product",
        best(n, || a.apply(&z, &mut y)),
        7 * 25 * size + 5 * (8 + size),
    );
    report("dot", best(n, || assert!(vector::dot(&r, &y).is_finite())), 80);
}

fn main() {
    let given: Vec<usize> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let cells = if given.len() == 3 {
        [given[0], given[1], given[2]]
    } else {
        [96, 20, 28]
    };
    println!("{} x {} x {} cells", cells[0], cells[1], cells[2]);
    run::<f64>(cells, "f64");
    run::<f32>(cells, "f32");
}
