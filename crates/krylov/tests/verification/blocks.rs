//! BILU(0) over several blocks: what the cut of a grid into blocks, their order and their sweeps change, and what not.

use dip_krylov::{BLOCK, Bilu, BlockMatrix, Coupling, Direction, KrylovError, Storage, Sweep, VARIABLES};

use super::{matrix, random_vector};

/// Cells of a box, cut in two along each direction where `cut` is not zero, as blocks and their couplings.
struct Cut {
    cells: Vec<[usize; 3]>,
    /// First index of each block in the box.
    from: Vec<[usize; 3]>,
    whole: [usize; 3],
}

impl Cut {
    fn new(whole: [usize; 3], cut: [usize; 3]) -> Self {
        let halves = [0, 1, 2].map(|d| {
            if cut[d] > 0 {
                vec![(0, cut[d]), (cut[d], whole[d])]
            } else {
                vec![(0, whole[d])]
            }
        });
        let (mut cells, mut from) = (Vec::new(), Vec::new());
        for k in &halves[2] {
            for j in &halves[1] {
                for i in &halves[0] {
                    cells.push([i.1 - i.0, j.1 - j.0, k.1 - k.0]);
                    from.push([i.0, j.0, k.0]);
                }
            }
        }
        Self { cells, from, whole }
    }

    /// Block and cell in it of a cell of the box.
    fn place(&self, at: [usize; 3]) -> (usize, usize) {
        let block = (0..self.cells.len())
            .find(|b| (0..3).all(|d| at[d] >= self.from[*b][d] && at[d] < self.from[*b][d] + self.cells[*b][d]))
            .expect("a cell of the box");
        let [ni, nj, _] = self.cells[block];
        let [i, j, k] = [0, 1, 2].map(|d| at[d] - self.from[block][d]);
        (block, i + ni * (j + nj * k))
    }

    /// Place of every cell of the box, counted over all blocks.
    fn numbers(&self) -> Vec<usize> {
        let mut offsets = vec![0];
        for c in &self.cells {
            offsets.push(offsets[offsets.len() - 1] + c.iter().product::<usize>());
        }
        let [ni, nj, nk] = self.whole;
        (0..ni * nj * nk)
            .map(|n| {
                let (block, cell) = self.place([n % ni, n / ni % nj, n / (ni * nj)]);
                offsets[block] + cell
            })
            .collect()
    }

    fn couplings(&self) -> Vec<Coupling> {
        let numbers = self.numbers();
        let [ni, nj, nk] = self.whole;
        let stride = [1, ni, ni * nj];
        let mut out = Vec::new();
        for n in 0..ni * nj * nk {
            let at = [n % ni, n / ni % nj, n / (ni * nj)];
            for d in 0..3 {
                if at[d] + 1 == self.whole[d] {
                    continue;
                }
                let mut next = at;
                next[d] += 1;
                let (here, there) = (self.place(at), self.place(next));
                if here.0 != there.0 {
                    for (row, upper, neighbour) in [(here, true, n + stride[d]), (there, false, n)] {
                        out.push(Coupling {
                            block: row.0 as u32,
                            cell: row.1 as u32,
                            direction: d as u8,
                            upper,
                            neighbour: numbers[neighbour] as u32,
                        });
                    }
                }
            }
        }
        out
    }

    /// The matrix of the box as those of its blocks.
    fn matrices<S: Storage>(&self, a: &BlockMatrix<S>) -> Vec<BlockMatrix<S>> {
        let mut out: Vec<BlockMatrix<S>> = self.cells.iter().map(|c| BlockMatrix::zeros(*c)).collect();
        let [ni, nj, nk] = self.whole;
        for n in 0..ni * nj * nk {
            let (block, cell) = self.place([n % ni, n / ni % nj, n / (ni * nj)]);
            out[block].diagonal_mut(cell).copy_from_slice(a.diagonal(n));
            for d in &Direction::ALL[..out[block].directions()] {
                out[block].lower_mut(cell, *d).copy_from_slice(a.lower(n, *d));
                out[block].upper_mut(cell, *d).copy_from_slice(a.upper(n, *d));
            }
        }
        out
    }
}

/// Values of the cells of the box, as those of its blocks.
fn scatter(values: &[f64], numbers: &[usize]) -> Vec<f64> {
    let mut out = vec![0.0; values.len()];
    for (n, to) in numbers.iter().enumerate() {
        out[to * VARIABLES..][..VARIABLES].copy_from_slice(&values[n * VARIABLES..][..VARIABLES]);
    }
    out
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |worst, (a, b)| worst.max((a - b).abs()))
}

#[test]
fn a_box_cut_into_blocks_has_the_factors_of_the_whole() {
    for (whole, cut) in [([8, 6, 5], [3, 2, 3]), ([9, 7, 1], [4, 3, 0]), ([6, 5, 4], [0, 3, 0])] {
        let a = matrix::<f64>(whole, 5.0);
        let cut = Cut::new(whole, cut);
        let numbers = cut.numbers();
        let r = random_vector(numbers.len(), 3);

        let mut one = Bilu::zeros(whole);
        one.factor(std::slice::from_ref(&a)).expect("dominant matrix");
        let mut want = vec![0.0; r.len()];
        one.solve(std::slice::from_ref(&a), &r, &mut want);

        let blocks = cut.matrices(&a);
        let mut many = Bilu::over(&cut.cells, &cut.couplings(), &[]);
        many.factor(&blocks).expect("dominant matrix");
        let mut got = vec![0.0; r.len()];
        many.solve(&blocks, &scatter(&r, &numbers), &mut got);
        let error = largest_difference(&got, &scatter(&want, &numbers));
        assert!(error < 1e-13, "{whole:?}: {error:e}");

        // And they are something else without the couplings.
        let mut alone = Bilu::over(&cut.cells, &[], &[]);
        alone.factor(&blocks).expect("dominant matrix");
        alone.solve(&blocks, &scatter(&r, &numbers), &mut got);
        assert!(largest_difference(&got, &scatter(&want, &numbers)) > 1e-3);
    }
}

#[test]
fn factors_of_several_blocks_reproduce_their_matrices() {
    let whole = [8, 6, 5];
    let cut = Cut::new(whole, [3, 2, 3]);
    let blocks = cut.matrices(&matrix::<f64>(whole, 5.0));
    let sweeps: Vec<Sweep> = (0..8)
        .map(|b| Sweep {
            rank: (5 * b + 3) % 8,
            reversed: [b % 2 == 0, b % 3 == 0, b > 4],
        })
        .collect();
    let mut f = Bilu::over(&cut.cells, &cut.couplings(), &sweeps);
    f.factor(&blocks).expect("dominant matrix");
    for (a, b) in blocks.iter().zip(&f.reconstruct(&blocks).expect("regular factors")) {
        for cell in 0..a.cell_count() {
            for e in 0..BLOCK {
                assert!((a.diagonal(cell)[e] - b.diagonal(cell)[e]).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn a_sweep_from_the_other_ends_is_that_of_the_turned_matrix() {
    // Several slabs, so that the sweep goes from slab to slab.
    for cells in [[30, 20, 10], [60, 80, 1]] {
        let a = matrix::<f64>(cells, 5.0);
        let [ni, nj, nk] = cells;
        let n = a.cell_count();
        let turned = |n: usize| {
            let [i, j, k] = [n % ni, n / ni % nj, n / (ni * nj)];
            (ni - 1 - i) + ni * ((nj - 1 - j) + nj * (nk - 1 - k))
        };
        let mut b = BlockMatrix::zeros(cells);
        for cell in 0..n {
            b.diagonal_mut(turned(cell)).copy_from_slice(a.diagonal(cell));
            for d in &Direction::ALL[..a.directions()] {
                b.lower_mut(turned(cell), *d).copy_from_slice(a.upper(cell, *d));
                b.upper_mut(turned(cell), *d).copy_from_slice(a.lower(cell, *d));
            }
        }
        let r = random_vector(n, 8);
        let numbers: Vec<usize> = (0..n).map(turned).collect();
        let back = Sweep {
            rank: 0,
            reversed: [true; 3],
        };
        let mut f = Bilu::over(&[cells], &[], &[back]);
        f.factor(std::slice::from_ref(&a)).expect("dominant matrix");
        let mut z = vec![0.0; r.len()];
        f.solve(std::slice::from_ref(&a), &r, &mut z);
        let mut g = Bilu::zeros(cells);
        g.factor(std::slice::from_ref(&b)).expect("dominant matrix");
        let mut want = vec![0.0; r.len()];
        g.solve(std::slice::from_ref(&b), &scatter(&r, &numbers), &mut want);
        assert!(
            scatter(&z, &numbers)
                .iter()
                .zip(&want)
                .all(|(a, b)| a.to_bits() == b.to_bits()),
            "{cells:?}"
        );
    }
}

/// A line of cells in two blocks that both count away from where they touch, as on the two sides of a wake cut: exact if
/// one is swept towards the cut and comes first, not if both are swept away from it.
#[test]
fn a_line_through_a_cut_is_solved_exactly_by_sweeps_that_go_through() {
    let half = 20;
    let a = matrix::<f64>([2 * half, 1, 1], 4.0);
    let mut blocks = vec![BlockMatrix::<f64>::zeros([half, 1, 1]); 2];
    // Cell of the line: in the first block counted back from the cut.
    let place = |n: usize| if n < half { (0, half - 1 - n) } else { (1, n - half) };
    for n in 0..2 * half {
        let (block, cell) = place(n);
        let m = &mut blocks[block];
        m.diagonal_mut(cell).copy_from_slice(a.diagonal(n));
        let (to_lower, to_upper) = (a.lower(n, Direction::I), a.upper(n, Direction::I));
        let (low, high) = if block == 0 {
            (to_upper, to_lower)
        } else {
            (to_lower, to_upper)
        };
        m.lower_mut(cell, Direction::I).copy_from_slice(low);
        m.upper_mut(cell, Direction::I).copy_from_slice(high);
    }
    let cut = |block: u32, neighbour: usize| Coupling {
        block,
        cell: 0,
        direction: 0,
        upper: false,
        neighbour: neighbour as u32,
    };
    let couplings = [cut(0, half), cut(1, 0)];
    let numbers: Vec<usize> = (0..2 * half).map(|n| place(n).0 * half + place(n).1).collect();
    let x = random_vector(2 * half, 5);
    let mut b = vec![0.0; x.len()];
    a.apply(&x, &mut b);
    let error = |reversed: bool| {
        let sweeps = [
            Sweep {
                rank: 0,
                reversed: [reversed, false, false],
            },
            Sweep {
                rank: 1,
                ..Sweep::default()
            },
        ];
        let mut f = Bilu::over(&[[half, 1, 1]; 2], &couplings, &sweeps);
        f.factor(&blocks).expect("dominant matrix");
        let mut z = vec![0.0; x.len()];
        f.solve(&blocks, &scatter(&b, &numbers), &mut z);
        largest_difference(&z, &scatter(&x, &numbers))
    };
    assert!(error(true) < 1e-12, "{:e}", error(true));
    assert!(error(false) > 1e-6, "{:e}", error(false));
}

#[test]
fn slabs_give_the_same_bits_for_any_number_of_threads() {
    let whole = [40, 30, 20];
    let cut = Cut::new(whole, [20, 15, 0]);
    let blocks = cut.matrices(&matrix::<f32>(whole, 5.0));
    let sweeps: Vec<Sweep> = [(2, true), (0, false), (3, false), (1, true)]
        .map(|(rank, back)| Sweep {
            rank,
            reversed: [back, !back, back],
        })
        .to_vec();
    let r = random_vector(40 * 30 * 20, 4);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a thread pool");
        pool.install(|| {
            let mut f = Bilu::over(&cut.cells, &cut.couplings(), &sweeps);
            f.factor(&blocks).expect("dominant matrix");
            let mut z = vec![0.0_f32; r.len()];
            f.solve(&blocks, &r, &mut z);
            z
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

#[test]
fn the_first_singular_block_in_the_order_is_named_for_any_number_of_threads() {
    let whole = [40, 30, 20];
    let cut = Cut::new(whole, [20, 15, 0]);
    let mut blocks = cut.matrices(&matrix::<f64>(whole, 5.0));
    // Two blocks that threads meet side by side, a layer that others wait for among them.
    for (block, cell) in [(0, 1203), (1, 2045), (2, 4000)] {
        blocks[block].diagonal_mut(cell).fill(f64::NAN);
    }
    let named = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a thread pool");
        pool.install(|| {
            let mut f = Bilu::over(&cut.cells, &cut.couplings(), &[]);
            match f.factor(&blocks) {
                Err(KrylovError::SingularBlock { ijk, .. }) => ijk,
                other => panic!("{other:?}"),
            }
        })
    };
    let one = named(1);
    for threads in [2, 3, 5] {
        for _ in 0..20 {
            assert_eq!(named(threads), one, "{threads} threads");
        }
    }
}
