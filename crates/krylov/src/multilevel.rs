//! A multilevel preconditioner: BILU(0) as smoother on every level, coarse matrices by aggregation.
//!
//! BILU(0) reduces errors that vary from cell to cell; what is long against a cell it moves by a few cells a solve. A
//! coarse level takes that part: cells are merged (in pairs along each direction), the residual is summed over each
//! aggregate, the correction is constant on it, and the coarse matrix is the Galerkin product of the two, that is the
//! sum of the blocks of the merged cells. For an upwind flux this is again an upwind flux. One V-cycle, coarse levels
//! first, with one smoothing on each is the preconditioner (Braess 1995, Computing 55, for aggregation; Blatt, Ippisch and Bastian
//! 2012 for its use in Krylov methods).
//!
//! Couplings between structured blocks are part of the level matrices (kept in the places of neighbours that a block's
//! outermost cells lack inside it) and of their factors.

use rayon::prelude::*;

use crate::dense::{multiply_add, multiply_subtract, zero_lanes};
use crate::vector::PIECE;
use crate::{BLOCK, Bilu, BlockMatrix, Coupling, KrylovError, Storage, Sweep, VARIABLES};

/// Matrices of one level, by block, and the couplings between them.
#[derive(Clone, Debug)]
pub struct LevelMatrix<S> {
    /// One matrix a block. The lower (upper) blocks of cells at the lower (upper) end of a direction hold the couplings.
    pub blocks: Vec<BlockMatrix<S>>,
    /// Couplings between blocks, by block and in the order of their cells.
    couplings: Vec<Vec<Coupling>>,
    /// First cell of each block, counted over all blocks.
    offsets: Vec<usize>,
}

impl<S: Storage> LevelMatrix<S> {
    /// Matrices of zeros for blocks of `cells`.
    ///
    /// # Panics
    /// If a coupling is of a block that there is not.
    #[must_use]
    pub fn zeros(cells: &[[usize; 3]], couplings: Vec<Coupling>) -> Self {
        let mut offsets = Vec::with_capacity(cells.len());
        let mut total = 0;
        for c in cells {
            offsets.push(total);
            total += c.iter().product::<usize>();
        }
        let mut by_block = vec![Vec::new(); cells.len()];
        for coupling in couplings {
            by_block[coupling.block as usize].push(coupling);
        }
        for couplings in &mut by_block {
            couplings.sort_by_key(|c| c.cell);
        }
        Self {
            blocks: cells.iter().map(|c| BlockMatrix::zeros(*c)).collect(),
            couplings: by_block,
            offsets,
        }
    }

    /// Cells of all blocks.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.blocks.iter().map(BlockMatrix::cell_count).sum()
    }

    /// `out = r - A z` with the couplings.
    ///
    /// # Panics
    /// If a vector is not 5 entries a cell.
    pub fn residual<R: Storage>(&self, r: &[R], z: &[S], out: &mut [S]) {
        // Cells of a piece of work: a few microseconds, so that no thread waits long for another one's last piece.
        const CELLS: usize = 512;
        assert_eq!(r.len(), self.cell_count() * VARIABLES, "right-hand side of a level");
        assert_eq!(z.len(), r.len(), "solution of a level");
        let mut pieces = Vec::with_capacity(self.cell_count() / CELLS + self.blocks.len());
        for (b, out) in split(out, &self.blocks).into_iter().enumerate() {
            let row = self.blocks[b].cells()[0];
            let rows = (CELLS / row).max(1);
            let parts = out.chunks_mut(rows * row * VARIABLES).enumerate();
            pieces.extend(parts.map(|(n, out)| (b, n * rows * row, out)));
        }
        pieces.into_par_iter().with_max_len(4).for_each(|(b, first, out)| {
            let (matrix, offset) = (&self.blocks[b], self.offsets[b]);
            let range = offset * VARIABLES..(offset + matrix.cell_count()) * VARIABLES;
            matrix.subtract_product(first, &r[range.clone()], &z[range], out);
            let couplings = &self.couplings[b];
            let from = couplings.partition_point(|c| (c.cell as usize) < first);
            let last = first + out.len() / VARIABLES;
            for c in couplings[from..].iter().take_while(|c| (c.cell as usize) < last) {
                let at = (c.cell as usize * matrix.directions() + c.direction as usize) * BLOCK;
                let block = if c.upper {
                    &matrix.upper[at..]
                } else {
                    &matrix.lower[at..]
                };
                let row = (c.cell as usize - first) * VARIABLES;
                let mut y = zero_lanes::<S>();
                y[..VARIABLES].copy_from_slice(&out[row..row + VARIABLES]);
                let y = multiply_subtract(block, &z[c.neighbour as usize * VARIABLES..], y);
                out[row..row + VARIABLES].copy_from_slice(&y[..VARIABLES]);
            }
        });
    }

    /// Sums the blocks of `fine` over the aggregates: `parents[fine cell]` is a cell of this level, both counted over all
    /// blocks. Aggregates are boxes of cells, so that a neighbour's parent is the parent itself or its neighbour in the
    /// same direction.
    fn aggregate(&mut self, fine: &Self, parents: &[u32]) {
        let offsets = &self.offsets;
        self.blocks
            .par_iter_mut()
            .enumerate()
            .with_max_len(1)
            .for_each(|(b, coarse)| {
                coarse.clear();
                let matrix = &fine.blocks[b];
                let cells = matrix.cells();
                let stride = [1, cells[0], cells[0] * cells[1]];
                let nd = matrix.directions();
                let parents = &parents[fine.offsets[b]..fine.offsets[b] + matrix.cell_count()];
                let first = offsets[b] as u32;
                let add = |to: &mut [S], from: &[S]| {
                    for (t, f) in to[..BLOCK].iter_mut().zip(from) {
                        *t = *t + *f;
                    }
                };
                for cell in 0..matrix.cell_count() {
                    let here = [cell % cells[0], (cell / cells[0]) % cells[1], cell / stride[2]];
                    let parent = (parents[cell] - first) as usize;
                    add(&mut coarse.diagonal[parent * BLOCK..], &matrix.diagonal[cell * BLOCK..]);
                    for d in 0..nd {
                        let at = (cell * nd + d) * BLOCK;
                        let to = (parent * nd + d) * BLOCK;
                        let inside_low = here[d] > 0 && parents[cell - stride[d]] == parents[cell];
                        let inside_high = here[d] + 1 < cells[d] && parents[cell + stride[d]] == parents[cell];
                        let lower = &matrix.lower[at..];
                        let upper = &matrix.upper[at..];
                        if inside_low {
                            add(&mut coarse.diagonal[parent * BLOCK..], lower);
                        } else {
                            add(&mut coarse.lower[to..], lower);
                        }
                        if inside_high {
                            add(&mut coarse.diagonal[parent * BLOCK..], upper);
                        } else {
                            add(&mut coarse.upper[to..], upper);
                        }
                    }
                }
            });
    }
}

/// Cuts a vector over all blocks into one piece a block.
fn split<'a, S, M: Storage>(mut vector: &'a mut [S], blocks: &[BlockMatrix<M>]) -> Vec<&'a mut [S]> {
    blocks
        .iter()
        .map(|m| {
            let (head, tail) = std::mem::take(&mut vector).split_at_mut(m.cell_count() * VARIABLES);
            vector = tail;
            head
        })
        .collect()
}

/// One level of the cycle.
#[derive(Clone, Debug)]
struct CycleLevel<S> {
    matrix: LevelMatrix<S>,
    factors: Bilu<S>,
    /// Parents of this level's cells on the next coarser one; empty on the coarsest.
    parents: Vec<u32>,
    /// Right-hand side (unused on the finest level).
    rhs: Vec<S>,
    solution: Vec<S>,
    /// What the coarse solution leaves of the right-hand side.
    rest: Vec<S>,
    /// The coarse solution on this level's cells.
    coarse_part: Vec<S>,
}

/// The preconditioner: matrices and factors of all levels.
#[derive(Clone, Debug)]
pub struct Multilevel<S> {
    levels: Vec<CycleLevel<S>>,
}

/// Sizes of one level, to set up a [`Multilevel`].
#[derive(Clone, Debug)]
pub struct LevelShape {
    /// Cells of every block.
    pub cells: Vec<[usize; 3]>,
    /// Couplings between blocks.
    pub couplings: Vec<Coupling>,
    /// Sweeps of the blocks; from the smallest indices, in the order of their numbers, where there is none.
    pub sweeps: Vec<Sweep>,
    /// Cell of the next coarser level for every cell, counted over all blocks; empty on the coarsest.
    pub parents: Vec<u32>,
}

impl<S: Storage> Multilevel<S> {
    /// Room for all levels, the finest first.
    #[must_use]
    pub fn new(shapes: Vec<LevelShape>) -> Self {
        let levels = shapes
            .into_iter()
            .enumerate()
            .map(|(n, shape)| {
                let factors = Bilu::over(&shape.cells, &shape.couplings, &shape.sweeps);
                let matrix = LevelMatrix::zeros(&shape.cells, shape.couplings);
                let length = matrix.cell_count() * VARIABLES;
                let vector = || vec![S::default(); length];
                CycleLevel {
                    factors,
                    parents: shape.parents,
                    rhs: if n > 0 { vector() } else { Vec::new() },
                    solution: if n > 0 { vector() } else { Vec::new() },
                    rest: vector(),
                    coarse_part: vector(),
                    matrix,
                }
            })
            .collect();
        Self { levels }
    }

    /// Matrices of the finest level, to be filled before [`Multilevel::factor`].
    ///
    /// # Panics
    /// If it was made without a level.
    pub fn finest_mut(&mut self) -> &mut LevelMatrix<S> {
        &mut self.levels[0].matrix
    }

    /// Matrices of the finest level.
    ///
    /// # Panics
    /// If it was made without a level.
    #[must_use]
    pub fn finest(&self) -> &LevelMatrix<S> {
        &self.levels[0].matrix
    }

    /// Sums up the coarse matrices and factors all levels.
    ///
    /// # Errors
    /// [`KrylovError::SingularBlock`].
    pub fn factor(&mut self) -> Result<(), KrylovError> {
        for n in 0..self.levels.len() {
            if n > 0 {
                let (fine, coarse) = self.levels.split_at_mut(n);
                coarse[0].matrix.aggregate(&fine[n - 1].matrix, &fine[n - 1].parents);
            }
            let level = &mut self.levels[n];
            level.factors.factor(&level.matrix.blocks)?;
        }
        Ok(())
    }

    /// One V-cycle: `z ~ A^-1 r`, vectors `[cell][5]` over all blocks.
    ///
    /// # Panics
    /// If a vector is not 5 entries a cell.
    pub fn solve(&mut self, r: &[f64], z: &mut [S]) {
        cycle(&mut self.levels, r, z);
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.levels
            .iter()
            .map(|l| {
                let vectors = l.rhs.len() + l.solution.len() + l.rest.len() + l.coarse_part.len();
                vectors * size_of::<S>()
                    + 4 * l.parents.len()
                    + l.matrix.blocks.iter().map(BlockMatrix::bytes).sum::<usize>()
                    + l.factors.bytes()
            })
            .sum()
    }
}

/// Coarse correction first, then one smoothing of what is left. (Smoothing before and after was tried: BILU(0) is not a
/// convergent iteration of its own on stretched grids, and its second use amplifies what the Krylov method must then
/// take out.)
fn cycle<S: Storage, R: Storage>(levels: &mut [CycleLevel<S>], r: &[R], z: &mut [S]) {
    let Some((level, coarser)) = levels.split_first_mut() else {
        return;
    };
    let Some(next) = coarser.first_mut() else {
        level.factors.solve(&level.matrix.blocks, r, z);
        return;
    };
    let mut rhs = std::mem::take(&mut next.rhs);
    let mut solution = std::mem::take(&mut next.solution);
    // A block's aggregates are its own cells: every block sums for itself, in the order of the cells.
    let (fine, coarse) = (&level.matrix, &next.matrix);
    let parents = &level.parents;
    split(&mut rhs, &coarse.blocks)
        .into_par_iter()
        .enumerate()
        .with_max_len(1)
        .for_each(|(b, rhs)| {
            rhs.fill(S::default());
            let range = fine.offsets[b]..fine.offsets[b] + fine.blocks[b].cell_count();
            let r = &r[range.start * VARIABLES..range.end * VARIABLES];
            for (parent, from) in parents[range].iter().zip(r.chunks_exact(VARIABLES)) {
                let to = &mut rhs[(*parent as usize - coarse.offsets[b]) * VARIABLES..][..VARIABLES];
                for (t, f) in to.iter_mut().zip(from) {
                    *t = *t + S::from_f64(f.to_f64());
                }
            }
        });
    cycle(coarser, &rhs, &mut solution);
    level
        .coarse_part
        .par_chunks_mut(PIECE)
        .zip(level.parents.par_chunks(PIECE / VARIABLES))
        .for_each(|(to, parents)| {
            for (parent, to) in parents.iter().zip(to.chunks_exact_mut(VARIABLES)) {
                to.copy_from_slice(&solution[*parent as usize * VARIABLES..][..VARIABLES]);
            }
        });
    coarser[0].rhs = rhs;
    coarser[0].solution = solution;
    level.matrix.residual(r, &level.coarse_part, &mut level.rest);
    level.factors.solve(&level.matrix.blocks, &level.rest, z);
    z.par_chunks_mut(PIECE)
        .zip(level.coarse_part.par_chunks(PIECE))
        .for_each(|(z, c)| {
            for (t, c) in z.iter_mut().zip(c) {
                *t = *t + *c;
            }
        });
}

impl<S: Storage> BlockMatrix<S> {
    /// `out = r - A x` inside the block for the cells from `first` on, whole rows of them, as many as `out` has room for;
    /// vectors `[cell][5]`, `r` and `x` of the whole block.
    fn subtract_product<R: Storage>(&self, first: usize, r: &[R], x: &[S], out: &mut [S]) {
        match self.directions() {
            2 => self.subtract_product_in::<2, R>(first, r, x, out),
            _ => self.subtract_product_in::<3, R>(first, r, x, out),
        }
    }

    fn subtract_product_in<const ND: usize, R: Storage>(&self, first: usize, r: &[R], x: &[S], out: &mut [S]) {
        const V: usize = VARIABLES;
        let cells = self.cells();
        let [ni, nj, _] = cells;
        let stride = [1, ni, ni * nj];
        for (row, out) in out.chunks_exact_mut(ni * V).enumerate() {
            let row = first / ni + row;
            let (j, k) = (row % nj, row / nj);
            for (i, out) in out.chunks_exact_mut(V).enumerate() {
                let cell = row * ni + i;
                let here = [i, j, k];
                let mut sum = multiply_add(&self.diagonal[cell * BLOCK..], &x[cell * V..], zero_lanes());
                for d in 0..ND {
                    let b = (cell * ND + d) * BLOCK;
                    if here[d] > 0 {
                        sum = multiply_add(&self.lower[b..], &x[(cell - stride[d]) * V..], sum);
                    }
                    if here[d] + 1 < cells[d] {
                        sum = multiply_add(&self.upper[b..], &x[(cell + stride[d]) * V..], sum);
                    }
                }
                for v in 0..V {
                    out[v] = S::from_f64(r[cell * V + v].to_f64()) - sum[v];
                }
            }
        }
    }
}
