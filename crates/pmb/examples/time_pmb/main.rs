//! Times the flow solver's kernels and says what share of memory bandwidth and of peak each reaches:
//! `RAYON_NUM_THREADS=1 cargo run --release -p dip-pmb --example time_pmb [blocks ni nj nk]`.
//!
//! Prints the median of several batches, in CPU time, as a table for `docs/performance.md`. Bytes are the least traffic there can be: every
//! array a kernel reads or writes, once. Bandwidth and peak are measured in the same run, on the same core.

#[path = "../../benches/kernels/box_flow.rs"]
mod box_flow;
mod count;
mod machine;

use dip_krylov::{BLOCK, GcgSettings, LevelShape, Multilevel, VARIABLES, vector};
use dip_pmb::reconstruct::Reconstruction;
use machine::median;

/// Blocks of a matrix a cell: its own and six neighbours'.
const STENCIL: usize = 7;
/// Operations of a product of two blocks, or of a block and a vector, a cell.
const BLOCK_PRODUCT: usize = 2 * BLOCK * VARIABLES;
const BLOCK_VECTOR: usize = 2 * BLOCK;
/// Gauss-Jordan elimination of a block beside the identity.
const INVERSION: usize = VARIABLES * (2 * VARIABLES + 4 * 2 * 2 * VARIABLES);

struct Table {
    cells: usize,
    repetitions: usize,
    triad_gb_s: f64,
    peak_gflop_s: f64,
}

impl Table {
    /// A row: microseconds, bytes and operations a cell.
    fn row(&self, what: &str, bytes: usize, operations: usize, times: usize, work: impl FnMut()) {
        let us = median(self.repetitions, work) / (self.cells * times) as f64 * 1e6;
        let (gb_s, gflop_s) = (bytes as f64 / us * 1e-3, operations as f64 / us * 1e-3);
        println!(
            "| {what} | {us:.3} | {bytes} | {gb_s:.1} | {:.0} % | {operations} | {gflop_s:.1} | {:.0} % |",
            100.0 * gb_s / self.triad_gb_s,
            100.0 * gflop_s / self.peak_gflop_s,
        );
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let given: Vec<usize> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let (blocks, size) = match given[..] {
        [b, i, j, k] => (b, [i, j, k]),
        _ => (8, box_flow::CELLS),
    };
    let (grid, mut solver) = box_flow::make(blocks, size)?;
    let n = solver.equations.level.cell_count;
    let table = Table {
        cells: n,
        repetitions: if n > 1_000_000 { 3 } else { 7 },
        triad_gb_s: machine::triad_gb_s(),
        peak_gflop_s: machine::peak_gflop_s(),
    };
    println!(
        "{n} cells in {} blocks; triad {:.1} GB/s, multiply-add {:.1} GFLOP/s\n\n\
         | kernel | us a cell | bytes a cell | GB/s | of triad | operations a cell | GFLOP/s | of peak |\n\
         |---|---|---|---|---|---|---|---|",
        grid.blocks.len(),
        table.triad_gb_s,
        table.peak_gflop_s
    );

    // Flow and residual, normal and area of three faces.
    let residual_bytes = 8 * (2 * VARIABLES + 3 * 4);
    let mut r = vec![0.0; VARIABLES * n];
    for (name, reconstruction) in [
        ("residual, first order", Reconstruction::Constant),
        ("residual, no limiter", Reconstruction::Unlimited),
        ("residual, van Albada", Reconstruction::VanAlbada),
    ] {
        let scheme = solver.equations.scheme.with(reconstruction);
        let operations = count::residual(reconstruction) as usize;
        table.row(name, residual_bytes, operations, 1, || {
            solver.equations.residual_with(&scheme, &mut r);
        });
    }

    let shape = LevelShape {
        cells: grid.blocks.iter().map(dip_grid::Block::cells).collect(),
        couplings: solver.equations.level.couplings(),
        sweeps: solver.equations.level.sweeps.clone(),
        parents: Vec::new(),
    };
    let mut one = Multilevel::<f32>::new(vec![shape]);
    let time = vec![1e-3; n];
    let matrix_bytes = 4 * STENCIL * BLOCK;
    table.row(
        "Jacobian, analytic, stored in f32",
        matrix_bytes + 8 * (VARIABLES + 3 * 4),
        count::jacobian() as usize,
        1,
        || solver.equations.jacobian(&time, &mut one.finest_mut().blocks),
    );
    table.row(
        "BILU(0) factors, f32 storage",
        matrix_bytes + 4 * BLOCK,
        3 * (2 * BLOCK_PRODUCT + BLOCK) + INVERSION,
        1,
        || one.factor().expect("regular blocks"),
    );
    let mut z = vec![0.0_f32; VARIABLES * n];
    table.row(
        "BILU(0) solve, f32",
        4 * (STENCIL + 1) * BLOCK + (8 + 3 * 4) * VARIABLES,
        (STENCIL + 1) * BLOCK_VECTOR,
        1,
        || one.solve(&r, &mut z),
    );
    let mut rest = vec![0.0_f32; VARIABLES * n];
    table.row(
        "product with the block matrix, f32",
        matrix_bytes + (8 + 2 * 4) * VARIABLES,
        STENCIL * BLOCK_VECTOR,
        1,
        || one.finest().residual(&r, &z, &mut rest),
    );
    drop(one);

    let kept = 10;
    let images: Vec<Vec<f32>> = (0..kept).map(|m| vec![1e-3 * m as f32; VARIABLES * n]).collect();
    let images: Vec<&[f32]> = images.iter().map(Vec::as_slice).collect();
    let (mut scratch, mut products, small) = (Vec::new(), vec![0.0; kept + 1], vec![1e-30; kept]);
    let mut y = r.clone();
    table.row(
        "orthogonalization against 10 directions",
        VARIABLES * (2 * kept * 4 + 4 * 8),
        2 * VARIABLES * (2 * kept + 3),
        1,
        || {
            vector::dot_many(&mut y, &images, &mut scratch, &mut products);
            vector::orthogonalize(&mut y, &small, &images, &r, &mut scratch);
        },
    );

    println!("\n| together | us a cell |\n|---|---|");
    let report = |what: &str, us: f64| println!("| {what} | {us:.3} |");
    let us = |seconds: f64| seconds / n as f64 * 1e6;
    report(
        "time step",
        us(median(table.repetitions, || solver.set_time_step(100.0))),
    );
    report(
        "Jacobian, coarse matrices and factors of all levels",
        us(median(table.repetitions, || solver.build().expect("regular blocks"))),
    );
    for products in [20, 35] {
        let settings = GcgSettings {
            tolerance: 1e-30,
            max_iterations: products,
            patience: usize::MAX,
            directions: products,
        };
        let seconds = median(table.repetitions.min(5), || {
            solver.solve(&settings).expect("no breakdown");
        });
        report(
            &format!("one GCG iteration, mean of {products} from the first on"),
            us(seconds) / products as f64,
        );
    }
    println!(
        "\n{:.0} bytes a cell with 35 directions",
        solver.bytes() as f64 / n as f64
    );
    Ok(())
}
