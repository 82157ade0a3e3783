//! Incomplete factorization BILU(0) of a seven-point block matrix.
//!
//! With natural ordering two neighbours of a cell are never neighbours of each other, so that the fill which BILU(0)
//! keeps falls on the diagonal only:
//!
//! `A ~ (D + L) D^-1 (D + U)`, `D_i = A_ii - sum_l L_il D_l^-1 U_li` over the lower neighbours l of i
//!
//! (Meijerink and van der Vorst 1977, Math. Comp. 31, in blocks). Kept are `D^-1`, `D^-1 L` and `D^-1 U`: a solve is
//! then one block product a neighbour, and one with `D^-1`.

use crate::dense::{SPARE, invert, multiply_add, multiply_subtract, product, zero_lanes};
use crate::{BLOCK, BlockMatrix, KrylovError, Storage, VARIABLES};

/// Factors of a [`BlockMatrix`]. Couplings to other structured blocks are not in it ("decoupled" BILU).
#[derive(Clone, Debug, PartialEq)]
pub struct Bilu<S> {
    cells: [usize; 3],
    directions: usize,
    /// `D^-1`, `[cell][25]`.
    inverse: Vec<S>,
    /// `D^-1 L`, `[cell][direction][25]`.
    lower: Vec<S>,
    /// `D^-1 U`, `[cell][direction][25]`.
    upper: Vec<S>,
}

type Dense = [f64; BLOCK + SPARE];

#[inline(always)]
fn widen<S: Storage>(block: &[S]) -> Dense {
    let mut out = [0.0; BLOCK + SPARE];
    for (o, b) in out.iter_mut().zip(&block[..BLOCK]) {
        *o = b.to_f64();
    }
    out
}

#[inline(always)]
fn narrow<S: Storage>(block: &Dense, to: &mut [S]) {
    for (t, b) in to[..BLOCK].iter_mut().zip(block) {
        *t = S::from_f64(*b);
    }
}

impl<S: Storage> Bilu<S> {
    /// Room for the factors of a matrix of `cells` = [ni, nj, nk].
    #[must_use]
    pub fn zeros(cells: [usize; 3]) -> Self {
        let empty = BlockMatrix::<S>::zeros(cells);
        Self {
            cells,
            directions: empty.directions(),
            inverse: empty.diagonal,
            lower: empty.lower,
            upper: empty.upper,
        }
    }

    /// Cells along i, j, k.
    #[must_use]
    pub fn cells(&self) -> [usize; 3] {
        self.cells
    }

    /// Factors `a`, which may be kept in another precision. Arithmetic is double; factors are rounded when stored.
    ///
    /// # Errors
    /// [`KrylovError::SingularBlock`] names the first cell whose pivot block is singular or not finite;
    /// [`KrylovError::Length`] if the sizes differ.
    pub fn factor<M: Storage>(&mut self, a: &BlockMatrix<M>) -> Result<(), KrylovError> {
        if a.cells() != self.cells {
            return Err(KrylovError::Length {
                what: "cells of the matrix to be factored",
                needed: self.inverse.len() / BLOCK,
                got: a.cell_count(),
            });
        }
        for (to, from) in
            [(&mut self.inverse, &a.diagonal), (&mut self.lower, &a.lower), (&mut self.upper, &a.upper)]
        {
            for (t, f) in to.iter_mut().zip(from) {
                *t = S::from_f64(f.to_f64());
            }
        }
        self.eliminate()
    }

    /// Factors `a` in the memory that it lies in; [`Bilu::into_matrix`] gives the memory back for the next matrix.
    ///
    /// # Errors
    /// As [`Bilu::factor`]; the matrix is lost.
    pub fn factor_in_place(a: BlockMatrix<S>) -> Result<Self, KrylovError> {
        let mut this =
            Self { cells: a.cells(), directions: a.directions(), inverse: a.diagonal, lower: a.lower, upper: a.upper };
        this.eliminate()?;
        Ok(this)
    }

    /// Turns the matrix in the arrays into its factors, cell after cell.
    fn eliminate(&mut self) -> Result<(), KrylovError> {
        let [ni, nj, nk] = self.cells;
        let nd = self.directions;
        let stride = [1, ni, ni * nj];
        for cell in 0..ni * nj * nk {
            let here = [cell % ni, (cell / ni) % nj, cell / (ni * nj)];
            let mut d = widen(&self.inverse[cell * BLOCK..]);
            let mut lower = [[0.0; BLOCK + SPARE]; 3];
            for dir in 0..nd {
                if here[dir] > 0 {
                    lower[dir] = widen(&self.lower[(cell * nd + dir) * BLOCK..]);
                    let below = widen(&self.upper[((cell - stride[dir]) * nd + dir) * BLOCK..]);
                    for (x, f) in d.iter_mut().zip(&product(&lower[dir], &below)) {
                        *x -= f;
                    }
                }
            }
            let inverse = invert(&d).map_err(|pivot| KrylovError::SingularBlock { ijk: here, pivot })?;
            narrow(&inverse, &mut self.inverse[cell * BLOCK..]);
            for dir in 0..nd {
                let b = (cell * nd + dir) * BLOCK;
                if here[dir] > 0 {
                    narrow(&product(&inverse, &lower[dir]), &mut self.lower[b..]);
                }
                if here[dir] + 1 < self.cells[dir] {
                    let upper = widen(&self.upper[b..]);
                    narrow(&product(&inverse, &upper), &mut self.upper[b..]);
                }
            }
        }
        Ok(())
    }

    /// The memory of the factors, as a matrix whose entries mean nothing.
    #[must_use]
    pub fn into_matrix(self) -> BlockMatrix<S> {
        BlockMatrix::from_arrays(self.cells, self.directions, self.inverse, self.lower, self.upper)
    }

    /// `z = ((D + L) D^-1 (D + U))^-1 r`, vectors `[cell][5]`.
    ///
    /// # Panics
    /// If a vector is not 5 entries a cell.
    pub fn solve(&self, r: &[f64], z: &mut [S]) {
        match self.directions {
            2 => self.solve_in::<2>(r, z),
            _ => self.solve_in::<3>(r, z),
        }
    }

    fn solve_in<const ND: usize>(&self, r: &[f64], z: &mut [S]) {
        const V: usize = VARIABLES;
        let [ni, nj, nk] = self.cells;
        let n = ni * nj * nk;
        assert_eq!(r.len(), n * V, "r of the triangular solve");
        assert_eq!(z.len(), n * V, "z of the triangular solve");
        let stride = [1, ni, ni * nj];
        // (D + L) y = r, that is y = D^-1 r - (D^-1 L) y. The i-neighbour comes last: it is the one just computed.
        let mut cell = 0;
        for k in 0..nk {
            for j in 0..nj {
                let mut last = zero_lanes::<S>();
                for i in 0..ni {
                    let mut rhs = [S::default(); V];
                    for v in 0..V {
                        rhs[v] = S::from_f64(r[cell * V + v]);
                    }
                    let mut y = multiply_add(&self.inverse[cell * BLOCK..], &rhs, zero_lanes());
                    if ND > 2 && k > 0 {
                        y = multiply_subtract(&self.lower[(cell * ND + 2) * BLOCK..], &z[(cell - stride[2]) * V..], y);
                    }
                    if j > 0 {
                        y = multiply_subtract(&self.lower[(cell * ND + 1) * BLOCK..], &z[(cell - stride[1]) * V..], y);
                    }
                    if i > 0 {
                        y = multiply_subtract(&self.lower[cell * ND * BLOCK..], &last, y);
                    }
                    z[cell * V..(cell + 1) * V].copy_from_slice(&y[..V]);
                    last = y;
                    cell += 1;
                }
            }
        }
        // (I + D^-1 U) z = y.
        for k in (0..nk).rev() {
            for j in (0..nj).rev() {
                let mut last = zero_lanes::<S>();
                for i in (0..ni).rev() {
                    cell -= 1;
                    let mut y = zero_lanes::<S>();
                    y[..V].copy_from_slice(&z[cell * V..(cell + 1) * V]);
                    if ND > 2 && k + 1 < nk {
                        y = multiply_subtract(&self.upper[(cell * ND + 2) * BLOCK..], &z[(cell + stride[2]) * V..], y);
                    }
                    if j + 1 < nj {
                        y = multiply_subtract(&self.upper[(cell * ND + 1) * BLOCK..], &z[(cell + stride[1]) * V..], y);
                    }
                    if i + 1 < ni {
                        y = multiply_subtract(&self.upper[cell * ND * BLOCK..], &last, y);
                    }
                    z[cell * V..(cell + 1) * V].copy_from_slice(&y[..V]);
                    last = y;
                }
            }
        }
    }

    /// The blocks of `(D + L) D^-1 (D + U)` on the stencil. BILU(0) reproduces the factored matrix there; what it drops
    /// lies off the stencil.
    ///
    /// # Errors
    /// [`KrylovError::SingularBlock`] if a stored inverse cannot be inverted back.
    pub fn reconstruct(&self) -> Result<BlockMatrix<S>, KrylovError> {
        let mut out = BlockMatrix::zeros(self.cells);
        let [ni, nj, nk] = self.cells;
        let nd = self.directions;
        let stride = [1, ni, ni * nj];
        for cell in 0..ni * nj * nk {
            let here = [cell % ni, (cell / ni) % nj, cell / (ni * nj)];
            let d = invert(&widen(&self.inverse[cell * BLOCK..]))
                .map_err(|pivot| KrylovError::SingularBlock { ijk: here, pivot })?;
            let mut diagonal = d;
            for dir in 0..nd {
                let b = (cell * nd + dir) * BLOCK;
                if here[dir] > 0 {
                    let lower = product(&d, &widen(&self.lower[b..]));
                    let below = widen(&self.upper[((cell - stride[dir]) * nd + dir) * BLOCK..]);
                    for (x, f) in diagonal.iter_mut().zip(&product(&lower, &below)) {
                        *x += f;
                    }
                    narrow(&lower, &mut out.lower[b..]);
                }
                if here[dir] + 1 < self.cells[dir] {
                    narrow(&product(&d, &widen(&self.upper[b..])), &mut out.upper[b..]);
                }
            }
            narrow(&diagonal, &mut out.diagonal[cell * BLOCK..]);
        }
        Ok(out)
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of::<S>() * (self.inverse.len() + self.lower.len() + self.upper.len())
    }
}
