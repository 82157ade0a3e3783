//! Exact properties of the block matrix, BILU(0) and GCG.

mod blocks;
mod team;

use dip_krylov::dense::{SPARE, invert};
use dip_krylov::{
    BLOCK, Bilu, BlockMatrix, Coupling, Direction, Gcg, GcgSettings, KrylovError, LinearOperator, Preconditioner,
    Storage, VARIABLES,
    multilevel::{LevelShape, Multilevel},
    vector,
};

struct Random(u64);

impl Random {
    /// Uniform in [-0.5, 0.5).
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }
}

/// A random matrix, non-symmetric, with a diagonal that dominates by `dominance`.
fn matrix<S: Storage>(cells: [usize; 3], dominance: f64) -> BlockMatrix<S> {
    let mut random = Random(7);
    let mut a = BlockMatrix::zeros(cells);
    let n = a.cell_count();
    let nd = a.directions();
    for cell in 0..n {
        let here = [
            cell % cells[0],
            (cell / cells[0]) % cells[1],
            cell / (cells[0] * cells[1]),
        ];
        for (row, v) in a.diagonal_mut(cell).iter_mut().enumerate() {
            let unit = if row % (VARIABLES + 1) == 0 { dominance } else { 0.0 };
            *v = S::from_f64(unit + random.next());
        }
        for d in &Direction::ALL[..nd] {
            if here[*d as usize] > 0 {
                a.lower_mut(cell, *d)
                    .iter_mut()
                    .for_each(|v| *v = S::from_f64(random.next()));
            }
            if here[*d as usize] + 1 < cells[*d as usize] {
                a.upper_mut(cell, *d)
                    .iter_mut()
                    .for_each(|v| *v = S::from_f64(random.next()));
            }
        }
    }
    a
}

struct Product<'a, S>(&'a BlockMatrix<S>);
impl<S: Storage> LinearOperator<S> for Product<'_, S> {
    fn apply(&mut self, x: &[S], y: &mut [f64]) -> Result<(), KrylovError> {
        self.0.apply(x, y);
        Ok(())
    }
}
struct Factors<'a, S>(&'a Bilu<S>, &'a BlockMatrix<S>);
impl<S: Storage> Preconditioner<S> for Factors<'_, S> {
    fn solve(&mut self, r: &[f64], z: &mut [S]) {
        self.0.solve(std::slice::from_ref(self.1), r, z);
    }
}

fn random_vector(n: usize, seed: u64) -> Vec<f64> {
    let mut random = Random(seed);
    (0..n * VARIABLES).map(|_| random.next()).collect()
}

#[test]
fn product_equals_the_dense_sum() {
    let cells = [4, 3, 2];
    let a = matrix::<f64>(cells, 3.0);
    let x = random_vector(24, 3);
    let mut y = vec![0.0; x.len()];
    a.apply(&x, &mut y);
    let stride = [1, 4, 12];
    for cell in 0..24 {
        let here = [cell % 4, (cell / 4) % 3, cell / 12];
        for row in 0..5 {
            let term =
                |block: &[f64], other: usize| -> f64 { (0..5).map(|c| block[row + 5 * c] * x[other * 5 + c]).sum() };
            let mut want = term(a.diagonal(cell), cell);
            for d in Direction::ALL {
                let s = stride[d as usize];
                if here[d as usize] > 0 {
                    want += term(a.lower(cell, d), cell - s);
                }
                if here[d as usize] + 1 < cells[d as usize] {
                    want += term(a.upper(cell, d), cell + s);
                }
            }
            assert!((y[cell * 5 + row] - want).abs() < 1e-14);
        }
    }
}

#[test]
fn factors_reproduce_the_matrix_on_its_stencil() {
    for cells in [[5, 4, 3], [6, 5, 1], [7, 1, 1], [1, 1, 4]] {
        let a = matrix::<f64>(cells, 4.0);
        let mut f = Bilu::<f64>::zeros(cells);
        f.factor(std::slice::from_ref(&a)).expect("dominant matrix");
        let b = &f.reconstruct(std::slice::from_ref(&a)).expect("regular factors")[0];
        for cell in 0..a.cell_count() {
            for e in 0..BLOCK {
                assert!((a.diagonal(cell)[e] - b.diagonal(cell)[e]).abs() < 1e-12);
                for d in &Direction::ALL[..a.directions()] {
                    assert!((a.lower(cell, *d)[e] - b.lower(cell, *d)[e]).abs() < 1e-12);
                    assert!((a.upper(cell, *d)[e] - b.upper(cell, *d)[e]).abs() < 1e-12);
                }
            }
        }
    }
}

#[test]
fn factors_of_a_line_solve_exactly() {
    // Along one line of cells no fill is dropped: BILU(0) is the block LU factorization.
    for cells in [[40, 1, 1], [1, 40, 1], [1, 1, 40]] {
        let a = matrix::<f64>(cells, 4.0);
        let mut f = Bilu::<f64>::zeros(cells);
        f.factor(std::slice::from_ref(&a)).expect("dominant matrix");
        let x = random_vector(40, 5);
        let mut b = vec![0.0; x.len()];
        a.apply(&x, &mut b);
        let mut z = vec![0.0; x.len()];
        f.solve(std::slice::from_ref(&a), &b, &mut z);
        for (z, x) in z.iter().zip(&x) {
            assert!((z - x).abs() < 1e-12);
        }
    }
}

#[test]
fn gcg_solves_and_its_residual_is_the_true_one() {
    let cells = [9, 8, 7];
    let a = matrix::<f64>(cells, 4.5);
    let mut f = Bilu::<f64>::zeros(cells);
    f.factor(std::slice::from_ref(&a)).expect("dominant matrix");
    let b = random_vector(9 * 8 * 7, 11);
    let mut r = b.clone();
    let mut x = vec![0.0; b.len()];
    let settings = GcgSettings {
        tolerance: 1e-12,
        max_iterations: 100,
        patience: usize::MAX,
        directions: 12,
    };
    let out = Gcg::new()
        .solve(&mut Product(&a), &mut Factors(&f, &a), &settings, &mut r, &mut x)
        .expect("no breakdown");
    assert!(out.converged, "{out:?}");
    let mut ax = vec![0.0; b.len()];
    a.apply(&x, &mut ax);
    let error: f64 = ax.iter().zip(&b).map(|(p, q)| (p - q).powi(2)).sum::<f64>().sqrt();
    assert!(error < 3e-12 * vector::norm(&b), "{error:e}");
}

#[test]
fn single_precision_factors_and_directions_reach_single_precision_and_restarts_go_beyond() {
    let cells = [9, 8, 7];
    let a = matrix::<f32>(cells, 4.5);
    let mut f = Bilu::<f32>::zeros(cells);
    f.factor(std::slice::from_ref(&a)).expect("dominant matrix");
    let b = random_vector(9 * 8 * 7, 11);
    let mut x = vec![0.0; b.len()];
    let mut r = b.clone();
    let settings = GcgSettings {
        tolerance: 1e-5,
        max_iterations: 100,
        patience: usize::MAX,
        directions: 12,
    };
    let mut gcg = Gcg::new();
    // Each round solves for the true residual: iterative refinement.
    let exact: BlockMatrix<f64> = matrix(cells, 4.5);
    let mut rounds = 0;
    while vector::norm(&r) > 1e-13 * vector::norm(&b) {
        let mut rest = r.clone();
        let mut dx = vec![0.0; b.len()];
        let out = gcg
            .solve(&mut Product(&a), &mut Factors(&f, &a), &settings, &mut rest, &mut dx)
            .expect("no breakdown");
        assert!(out.converged, "{out:?}");
        vector::add_scaled(&mut x, 1.0, &dx);
        let mut ax = vec![0.0; b.len()];
        exact.apply(&x, &mut ax);
        r = b.iter().zip(&ax).map(|(b, a)| b - a).collect();
        rounds += 1;
        assert!(
            rounds < 8,
            "refinement stalls at {:e}",
            vector::norm(&r) / vector::norm(&b)
        );
    }
}

#[test]
fn gcg_minimizes_over_all_directions_it_keeps() {
    // Without truncation GCG ends in as many steps as there are distinct eigenvalues: here three.
    let cells = [6, 1, 1];
    let mut a = BlockMatrix::<f64>::zeros(cells);
    for cell in 0..6 {
        for v in 0..VARIABLES {
            a.diagonal_mut(cell)[v + VARIABLES * v] = [1.0, 2.0, 5.0][(cell + v) % 3];
        }
    }
    struct Identity;
    impl Preconditioner<f64> for Identity {
        fn solve(&mut self, r: &[f64], z: &mut [f64]) {
            z.copy_from_slice(r);
        }
    }
    let mut b = random_vector(6, 2);
    let mut x = vec![0.0; b.len()];
    let settings = GcgSettings {
        tolerance: 1e-12,
        max_iterations: 20,
        patience: usize::MAX,
        directions: 5,
    };
    let out = Gcg::new()
        .solve(&mut Product(&a), &mut Identity, &settings, &mut b, &mut x)
        .expect("no breakdown");
    assert_eq!(out.iterations, 3, "{out:?}");
}

#[test]
fn a_singular_cell_is_named() {
    let cells = [3, 2, 2];
    let mut a = matrix::<f64>(cells, 4.0);
    let cell = 2 + 3; // (2, 1, 0)
    a.diagonal_mut(cell).fill(f64::NAN);
    let mut f = Bilu::<f64>::zeros(cells);
    match f.factor(std::slice::from_ref(&a)) {
        Err(KrylovError::SingularBlock { ijk, .. }) => assert_eq!(ijk, [2, 1, 0]),
        other => panic!("{other:?}"),
    }
    let zero = [0.0; BLOCK + SPARE];
    assert!(invert(&zero).is_err());
}

#[test]
fn a_value_that_is_not_finite_breaks_down_with_a_message() {
    let cells = [3, 2, 2];
    let a = matrix::<f64>(cells, 4.0);
    let mut f = Bilu::<f64>::zeros(cells);
    f.factor(std::slice::from_ref(&a)).expect("dominant matrix");
    let mut b = vec![1.0; 60];
    b[7] = f64::NAN;
    let mut x = vec![0.0; 60];
    let out = Gcg::new().solve(
        &mut Product(&a),
        &mut Factors(&f, &a),
        &GcgSettings::default(),
        &mut b,
        &mut x,
    );
    assert!(matches!(out, Err(KrylovError::Breakdown { .. })), "{out:?}");
    let out = Gcg::new().solve(
        &mut Product(&a),
        &mut Factors(&f, &a),
        &GcgSettings::default(),
        &mut b,
        &mut x[..55],
    );
    assert!(matches!(out, Err(KrylovError::Length { .. })), "{out:?}");
}

#[test]
fn results_are_the_same_bits_for_any_number_of_threads() {
    // Long enough that the vectors are cut for threads.
    let cells = [40, 24, 16];
    let a = matrix::<f32>(cells, 4.5);
    let mut f = Bilu::<f32>::zeros(cells);
    f.factor(std::slice::from_ref(&a)).expect("dominant matrix");
    let run = |threads: usize| -> Vec<f64> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a thread pool");
        pool.install(|| {
            let mut b = random_vector(40 * 24 * 16, 9);
            let mut x = vec![0.0; b.len()];
            let settings = GcgSettings {
                tolerance: 1e-6,
                max_iterations: 20,
                patience: usize::MAX,
                directions: 4,
            };
            Gcg::new()
                .solve(&mut Product(&a), &mut Factors(&f, &a), &settings, &mut b, &mut x)
                .expect("no breakdown");
            x
        })
    };
    let one = run(1);
    for threads in [2, 3, 5] {
        assert!(
            one.iter().zip(&run(threads)).all(|(a, b)| a.to_bits() == b.to_bits()),
            "{threads} threads"
        );
    }
}

/// Shapes of a level of two blocks along i and of the one merged from it in pairs along i and j.
fn two_levels(cells: [usize; 3]) -> Vec<LevelShape> {
    let coarse = [cells[0] / 2, cells[1] / 2, cells[2]];
    let count = |c: [usize; 3]| c.iter().product::<usize>();
    let couplings = |c: [usize; 3]| {
        let mut out = Vec::new();
        for row in 0..c[1] * c[2] {
            let (end, start) = (c[0] - 1 + c[0] * row, c[0] * row);
            let coupling = |block: u32, cell: usize, upper: bool, neighbour: usize| Coupling {
                block,
                cell: cell as u32,
                direction: 0,
                upper,
                neighbour: neighbour as u32,
            };
            out.push(coupling(0, end, true, count(c) + start));
            out.push(coupling(1, start, false, end));
        }
        out
    };
    let mut parents = Vec::new();
    for block in 0..2 {
        for cell in 0..count(cells) {
            let [i, j, k] = [
                cell % cells[0],
                (cell / cells[0]) % cells[1],
                cell / (cells[0] * cells[1]),
            ];
            parents.push((block * count(coarse) + i / 2 + coarse[0] * (j / 2 + coarse[1] * k)) as u32);
        }
    }
    vec![
        LevelShape {
            cells: vec![cells; 2],
            couplings: couplings(cells),
            sweeps: Vec::new(),
            parents,
        },
        LevelShape {
            cells: vec![coarse; 2],
            couplings: couplings(coarse),
            sweeps: Vec::new(),
            parents: Vec::new(),
        },
    ]
}

/// A diffusion matrix on two blocks, with the couplings between them: long waves are what BILU(0) is slow for.
fn diffusion(multilevel: &mut Multilevel<f64>, strength: [f64; 3]) {
    for matrix in &mut multilevel.finest_mut().blocks {
        for cell in 0..matrix.cell_count() {
            for v in 0..VARIABLES {
                matrix.diagonal_mut(cell)[v + VARIABLES * v] = 1e-4 + 2.0 * strength.iter().sum::<f64>();
                for (d, s) in Direction::ALL.into_iter().zip(strength) {
                    matrix.lower_mut(cell, d)[v + VARIABLES * v] = -s;
                    matrix.upper_mut(cell, d)[v + VARIABLES * v] = -s;
                }
            }
        }
    }
}

struct Cycle<'a>(&'a mut Multilevel<f64>);
impl Preconditioner<f64> for Cycle<'_> {
    fn solve(&mut self, r: &[f64], z: &mut [f64]) {
        self.0.solve(r, z);
    }
}
struct Whole<'a>(&'a Multilevel<f64>);
impl LinearOperator<f64> for Whole<'_> {
    fn apply(&mut self, x: &[f64], y: &mut [f64]) -> Result<(), KrylovError> {
        let zero = vec![0.0; x.len()];
        self.0.finest().residual(&zero, x, y);
        y.iter_mut().for_each(|v| *v = -*v);
        Ok(())
    }
}

#[test]
fn a_coarse_level_speeds_up_convergence() {
    let cells = [32, 24, 4];
    let shapes = two_levels(cells);
    let n = 2 * cells.iter().product::<usize>();
    let solve = |shapes: Vec<LevelShape>| {
        let mut multilevel = Multilevel::<f64>::new(shapes);
        diffusion(&mut multilevel, [1.0, 0.8, 0.6]);
        multilevel.factor().expect("dominant matrix");
        let operator = multilevel.clone();
        let mut b: Vec<f64> = random_vector(n, 3);
        let mut x = vec![0.0; b.len()];
        let settings = GcgSettings {
            tolerance: 1e-8,
            max_iterations: 60,
            patience: usize::MAX,
            directions: 60,
        };
        let out = Gcg::new()
            .solve(
                &mut Whole(&operator),
                &mut Cycle(&mut multilevel),
                &settings,
                &mut b,
                &mut x,
            )
            .expect("no breakdown");
        assert!(out.converged, "{out:?}");
        out.iterations
    };
    let mut one = vec![shapes[0].clone()];
    one[0].parents.clear();
    let (single, two) = (solve(one), solve(shapes));
    assert!(two < single, "{two} iterations with a coarse level, {single} without");
}
