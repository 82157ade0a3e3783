//! The kernels of the linear solver on one block of 53,760 cells; items are cells, bytes the least traffic possible.
//!
//! `RAYON_NUM_THREADS=1 cargo bench -p dip-krylov` for the time of one core.

use dip_krylov::{BLOCK, Bilu, BlockMatrix, Storage, VARIABLES, vector};
use divan::Bencher;
use divan::counter::{BytesCount, ItemsCount};

fn main() {
    divan::main();
}

const CELLS: [usize; 3] = [96, 20, 28];
const COUNT: usize = CELLS[0] * CELLS[1] * CELLS[2];
/// Blocks a cell: its own and six neighbours'.
const STENCIL: usize = 7;

/// A matrix with dominant diagonal, the same every time.
fn matrix<S: Storage>() -> BlockMatrix<S> {
    let mut a = BlockMatrix::<S>::zeros(CELLS);
    let (diagonal, lower, upper) = a.arrays_mut();
    for (m, set) in [diagonal, lower, upper].into_iter().enumerate() {
        for (e, v) in set.iter_mut().enumerate() {
            let unit = if m == 0 && (e % BLOCK).is_multiple_of(VARIABLES + 1) {
                4.0
            } else {
                0.0
            };
            *v = S::from_f64(unit + ((e * 7919) % 1000) as f64 * 1e-3 - 0.5);
        }
    }
    a
}

fn vectors<S: Storage>(count: usize) -> Vec<Vec<S>> {
    let entry = |n: usize, m: usize| S::from_f64(((n * 31 + m * 7919) % 1000) as f64 * 1e-3 - 0.5);
    (0..count)
        .map(|n| (0..COUNT * VARIABLES).map(|m| entry(n, m)).collect())
        .collect()
}

/// Bytes of the matrix and of a double vector and one of its own precision.
fn product_bytes<S>() -> BytesCount {
    BytesCount::new(COUNT * (STENCIL * BLOCK * size_of::<S>() + VARIABLES * (8 + size_of::<S>())))
}

#[divan::bench(types = [f32, f64])]
fn factor<S: Storage>(bencher: Bencher) {
    let a = [matrix::<S>()];
    let mut f = Bilu::<S>::zeros(CELLS);
    bencher
        .counter(ItemsCount::new(COUNT))
        .counter(BytesCount::new(COUNT * (STENCIL + 1) * BLOCK * size_of::<S>()))
        .bench_local(|| f.factor(&a).expect("dominant matrix"));
}

#[divan::bench(types = [f32, f64])]
fn solve<S: Storage>(bencher: Bencher) {
    let a = [matrix::<S>()];
    let mut f = Bilu::<S>::zeros(CELLS);
    f.factor(&a).expect("dominant matrix");
    let r = vec![1.0; COUNT * VARIABLES];
    let mut z = vec![S::default(); COUNT * VARIABLES];
    bencher
        .counter(ItemsCount::new(COUNT))
        .counter(product_bytes::<S>())
        .bench_local(|| f.solve(&a, &r, &mut z));
}

#[divan::bench(types = [f32, f64])]
fn product<S: Storage>(bencher: Bencher) {
    let a = matrix::<S>();
    let x = vec![S::from_f64(1.0); COUNT * VARIABLES];
    let mut y = vec![0.0; COUNT * VARIABLES];
    bencher
        .counter(ItemsCount::new(COUNT))
        .counter(product_bytes::<S>())
        .bench_local(|| a.apply(&x, &mut y));
}

/// Inner products of a vector with so many kept images, and their removal from it: what GCG does for every product.
#[divan::bench(args = [1, 10, 30])]
fn orthogonalization(bencher: Bencher, kept: usize) {
    let basis = vectors::<f32>(kept);
    let basis: Vec<&[f32]> = basis.iter().map(Vec::as_slice).collect();
    let b = vectors::<f64>(1).remove(0);
    let mut y = b.clone();
    let mut products = vec![0.0; kept + 1];
    // So small that the vector stays what it is.
    let coefficients = vec![1e-30; kept];
    let mut scratch = Vec::new();
    bencher
        .counter(ItemsCount::new(COUNT))
        .counter(BytesCount::new(COUNT * VARIABLES * (2 * kept * 4 + 4 * 8)))
        .bench_local(|| {
            vector::dot_many(&mut y, &basis, &mut scratch, &mut products);
            vector::orthogonalize(&mut y, &coefficients, &basis, &b, &mut scratch)
        });
}
