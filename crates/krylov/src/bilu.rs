//! Incomplete factorization BILU(0) of a seven-point block matrix.
//!
//! With natural ordering two neighbours of a cell are never neighbours of each other, so that the fill which BILU(0)
//! keeps falls on the diagonal only:
//!
//! `A ~ (D + L) D^-1 (D + U)`, `D_i = A_ii - sum_l L_il D_l^-1 U_li` over the lower neighbours l of i
//!
//! (Meijerink and van der Vorst 1977, Math. Comp. 31, in blocks). Only `D^-1` is kept; L and U are the matrix's own.

use crate::dense::{SPARE, invert, multiply_add, multiply_subtract, product, zero_lanes};
use crate::{BLOCK, BlockMatrix, KrylovError, Storage, VARIABLES};

/// Pivots of the incomplete factorization of a [`BlockMatrix`], to be used together with it. Couplings to other
/// structured blocks are not in it ("decoupled" BILU).
#[derive(Clone, Debug, PartialEq)]
pub struct Bilu<S> {
    cells: [usize; 3],
    /// `D^-1`, `[cell][25]` and spare entries.
    inverse: Vec<S>,
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
    /// Room for the pivots of a matrix of `cells` = [ni, nj, nk].
    #[must_use]
    pub fn zeros(cells: [usize; 3]) -> Self {
        Self {
            cells,
            inverse: vec![S::default(); cells.iter().product::<usize>() * BLOCK + SPARE],
        }
    }

    /// Cells along i, j, k.
    #[must_use]
    pub fn cells(&self) -> [usize; 3] {
        self.cells
    }

    /// Factors `a`. Arithmetic is double; pivots are rounded when stored.
    ///
    /// # Errors
    /// [`KrylovError::SingularBlock`] names the first cell whose pivot block is singular or not finite;
    /// [`KrylovError::Length`] if the sizes differ.
    pub fn factor(&mut self, a: &BlockMatrix<S>) -> Result<(), KrylovError> {
        if a.cells() != self.cells {
            return Err(KrylovError::Length {
                what: "cells of the matrix to be factored",
                needed: self.inverse.len() / BLOCK,
                got: a.cell_count(),
            });
        }
        let [ni, nj, nk] = self.cells;
        let nd = a.directions();
        let stride = [1, ni, ni * nj];
        let mut cell = 0;
        for k in 0..nk {
            for j in 0..nj {
                for i in 0..ni {
                    let here = [i, j, k];
                    let mut d = widen(&a.diagonal[cell * BLOCK..]);
                    for dir in 0..nd {
                        if here[dir] > 0 {
                            let below = cell - stride[dir];
                            let lower = widen(&a.lower[(cell * nd + dir) * BLOCK..]);
                            let upper = widen(&a.upper[(below * nd + dir) * BLOCK..]);
                            let pivot = widen(&self.inverse[below * BLOCK..]);
                            for (x, f) in d.iter_mut().zip(&product(&lower, &product(&pivot, &upper))) {
                                *x -= f;
                            }
                        }
                    }
                    let inverse = invert(&d).map_err(|pivot| KrylovError::SingularBlock { ijk: here, pivot })?;
                    narrow(&inverse, &mut self.inverse[cell * BLOCK..]);
                    cell += 1;
                }
            }
        }
        Ok(())
    }

    /// `z = ((D + L) D^-1 (D + U))^-1 r` with the matrix `a` that was factored; vectors `[cell][5]`.
    ///
    /// # Panics
    /// If a vector is not 5 entries a cell, or `a` is of another size.
    pub fn solve<R: Storage>(&self, a: &BlockMatrix<S>, r: &[R], z: &mut [S]) {
        match a.directions() {
            2 => self.solve_in::<2, R>(a, r, z),
            _ => self.solve_in::<3, R>(a, r, z),
        }
    }

    fn solve_in<const ND: usize, R: Storage>(&self, a: &BlockMatrix<S>, r: &[R], z: &mut [S]) {
        const V: usize = VARIABLES;
        let [ni, nj, nk] = self.cells;
        let n = ni * nj * nk;
        assert_eq!(a.cells(), self.cells, "matrix of the triangular solve");
        assert_eq!(r.len(), n * V, "r of the triangular solve");
        assert_eq!(z.len(), n * V, "z of the triangular solve");
        let stride = [1, ni, ni * nj];
        // (D + L) y = r. The i-neighbour comes last: it is the one just computed.
        let mut cell = 0;
        for k in 0..nk {
            for j in 0..nj {
                let mut last = zero_lanes::<S>();
                for i in 0..ni {
                    let mut y = zero_lanes::<S>();
                    for v in 0..V {
                        y[v] = S::from_f64(r[cell * V + v].to_f64());
                    }
                    if ND > 2 && k > 0 {
                        y = multiply_subtract(&a.lower[(cell * ND + 2) * BLOCK..], &z[(cell - stride[2]) * V..], y);
                    }
                    if j > 0 {
                        y = multiply_subtract(&a.lower[(cell * ND + 1) * BLOCK..], &z[(cell - stride[1]) * V..], y);
                    }
                    if i > 0 {
                        y = multiply_subtract(&a.lower[cell * ND * BLOCK..], &last, y);
                    }
                    last = multiply_add(&self.inverse[cell * BLOCK..], &y, zero_lanes());
                    z[cell * V..(cell + 1) * V].copy_from_slice(&last[..V]);
                    cell += 1;
                }
            }
        }
        // (D + U) z = D y, that is z = y - D^-1 (U z).
        for k in (0..nk).rev() {
            for j in (0..nj).rev() {
                let mut last = zero_lanes::<S>();
                for i in (0..ni).rev() {
                    cell -= 1;
                    let mut sum = zero_lanes::<S>();
                    if ND > 2 && k + 1 < nk {
                        sum = multiply_add(&a.upper[(cell * ND + 2) * BLOCK..], &z[(cell + stride[2]) * V..], sum);
                    }
                    if j + 1 < nj {
                        sum = multiply_add(&a.upper[(cell * ND + 1) * BLOCK..], &z[(cell + stride[1]) * V..], sum);
                    }
                    if i + 1 < ni {
                        sum = multiply_add(&a.upper[cell * ND * BLOCK..], &last, sum);
                    }
                    let mut y = zero_lanes::<S>();
                    y[..V].copy_from_slice(&z[cell * V..(cell + 1) * V]);
                    last = multiply_subtract(&self.inverse[cell * BLOCK..], &sum, y);
                    z[cell * V..(cell + 1) * V].copy_from_slice(&last[..V]);
                }
            }
        }
    }

    /// The blocks of `(D + L) D^-1 (D + U)` on the stencil of `a`. BILU(0) reproduces the factored matrix there; what
    /// it drops lies off the stencil.
    ///
    /// # Errors
    /// [`KrylovError::SingularBlock`] if a stored inverse cannot be inverted back.
    pub fn reconstruct(&self, a: &BlockMatrix<S>) -> Result<BlockMatrix<S>, KrylovError> {
        let mut out = a.clone();
        let [ni, nj, nk] = self.cells;
        let nd = a.directions();
        let stride = [1, ni, ni * nj];
        for cell in 0..ni * nj * nk {
            let here = [cell % ni, (cell / ni) % nj, cell / (ni * nj)];
            let mut diagonal = invert(&widen(&self.inverse[cell * BLOCK..]))
                .map_err(|pivot| KrylovError::SingularBlock { ijk: here, pivot })?;
            for dir in (0..nd).filter(|d| here[*d] > 0) {
                let below = cell - stride[dir];
                let lower = widen(&a.lower[(cell * nd + dir) * BLOCK..]);
                let upper = widen(&a.upper[(below * nd + dir) * BLOCK..]);
                let pivot = widen(&self.inverse[below * BLOCK..]);
                for (x, f) in diagonal.iter_mut().zip(&product(&lower, &product(&pivot, &upper))) {
                    *x += f;
                }
            }
            narrow(&diagonal, &mut out.diagonal[cell * BLOCK..]);
        }
        Ok(out)
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of::<S>() * self.inverse.len()
    }
}
