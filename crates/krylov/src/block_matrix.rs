//! The seven-point matrix of 5 x 5 blocks on a structured block.

use crate::dense::{SPARE, multiply_add, zero_lanes};
use crate::{BLOCK, Storage, VARIABLES};

/// A neighbour direction of the stencil.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Along i.
    I,
    /// Along j.
    J,
    /// Along k.
    K,
}

impl Direction {
    /// All three, in storage order.
    pub const ALL: [Self; 3] = [Self::I, Self::J, Self::K];
}

/// A block matrix whose cell `(i, j, k)` couples to itself and to its six neighbours inside the structured block.
///
/// Blocks are dense, 5 x 5, column-major (row = equation, column = variable of the neighbour). Diagonal, lower
/// (towards smaller index) and upper blocks lie in arrays of their own, since each half of a triangular solve streams
/// one of them. With `nk == 1` nothing is kept for k.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockMatrix<S> {
    cells: [usize; 3],
    /// Directions kept: 2 if `nk == 1`, else 3.
    directions: usize,
    /// `[cell][25]` and spare entries.
    pub(crate) diagonal: Vec<S>,
    /// `[cell][direction][25]` and spare entries.
    pub(crate) lower: Vec<S>,
    /// `[cell][direction][25]` and spare entries.
    pub(crate) upper: Vec<S>,
}

impl<S: Storage> BlockMatrix<S> {
    /// A matrix of zeros for `cells` = [ni, nj, nk].
    #[must_use]
    pub fn zeros(cells: [usize; 3]) -> Self {
        let directions = if cells[2] == 1 { 2 } else { 3 };
        let n: usize = cells.iter().product();
        let make = |blocks: usize| vec![S::default(); blocks * BLOCK + SPARE];
        Self {
            cells,
            directions,
            diagonal: make(n),
            lower: make(n * directions),
            upper: make(n * directions),
        }
    }

    /// Cells along i, j, k.
    #[must_use]
    pub fn cells(&self) -> [usize; 3] {
        self.cells
    }

    /// Number of cells.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.cells.iter().product()
    }

    /// Directions that are kept: 2 (i, j) if `nk == 1`, else 3.
    #[must_use]
    pub fn directions(&self) -> usize {
        self.directions
    }

    /// Sets every entry to zero.
    pub fn clear(&mut self) {
        self.diagonal.fill(S::default());
        self.lower.fill(S::default());
        self.upper.fill(S::default());
    }

    /// Diagonal block of `cell`, 25 entries, column-major.
    #[inline(always)]
    #[must_use]
    pub fn diagonal(&self, cell: usize) -> &[S] {
        &self.diagonal[cell * BLOCK..(cell + 1) * BLOCK]
    }

    /// Diagonal block of `cell`, to write.
    #[inline(always)]
    pub fn diagonal_mut(&mut self, cell: usize) -> &mut [S] {
        &mut self.diagonal[cell * BLOCK..(cell + 1) * BLOCK]
    }

    /// Block of `cell` for its neighbour at the smaller index along `direction`.
    #[inline(always)]
    #[must_use]
    pub fn lower(&self, cell: usize, direction: Direction) -> &[S] {
        let b = cell * self.directions + direction as usize;
        &self.lower[b * BLOCK..(b + 1) * BLOCK]
    }

    /// Block of `cell` for its neighbour at the smaller index along `direction`, to write.
    #[inline(always)]
    pub fn lower_mut(&mut self, cell: usize, direction: Direction) -> &mut [S] {
        let b = cell * self.directions + direction as usize;
        &mut self.lower[b * BLOCK..(b + 1) * BLOCK]
    }

    /// Block of `cell` for its neighbour at the larger index along `direction`.
    #[inline(always)]
    #[must_use]
    pub fn upper(&self, cell: usize, direction: Direction) -> &[S] {
        let b = cell * self.directions + direction as usize;
        &self.upper[b * BLOCK..(b + 1) * BLOCK]
    }

    /// Block of `cell` for its neighbour at the larger index along `direction`, to write.
    #[inline(always)]
    pub fn upper_mut(&mut self, cell: usize, direction: Direction) -> &mut [S] {
        let b = cell * self.directions + direction as usize;
        &mut self.upper[b * BLOCK..(b + 1) * BLOCK]
    }

    /// The three arrays (diagonal `[cell][25]`, lower and upper `[cell][direction][25]`), to fill rows of cells at once.
    pub fn arrays_mut(&mut self) -> (&mut [S], &mut [S], &mut [S]) {
        (&mut self.diagonal, &mut self.lower, &mut self.upper)
    }

    /// `y = A x`, vectors `[cell][5]`.
    ///
    /// # Panics
    /// If a vector is not 5 entries a cell.
    pub fn apply(&self, x: &[S], y: &mut [f64]) {
        let [ni, nj, nk] = self.cells;
        let n = self.cell_count();
        assert_eq!(x.len(), n * VARIABLES, "x of the block product");
        assert_eq!(y.len(), n * VARIABLES, "y of the block product");
        let stride = [1, ni, ni * nj];
        let nd = self.directions;
        let mut cell = 0;
        for k in 0..nk {
            for j in 0..nj {
                for i in 0..ni {
                    let here = [i, j, k];
                    let mut sum = multiply_add(&self.diagonal[cell * BLOCK..], &x[cell * VARIABLES..], zero_lanes());
                    for d in 0..nd {
                        let b = (cell * nd + d) * BLOCK;
                        if here[d] > 0 {
                            sum = multiply_add(&self.lower[b..], &x[(cell - stride[d]) * VARIABLES..], sum);
                        }
                        if here[d] + 1 < self.cells[d] {
                            sum = multiply_add(&self.upper[b..], &x[(cell + stride[d]) * VARIABLES..], sum);
                        }
                    }
                    for v in 0..VARIABLES {
                        y[cell * VARIABLES + v] = sum[v].to_f64();
                    }
                    cell += 1;
                }
            }
        }
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of::<S>() * (self.diagonal.len() + self.lower.len() + self.upper.len())
    }
}
