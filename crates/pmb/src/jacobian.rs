//! The analytic Jacobian of the first-order residual, and the local time step.
//!
//! Row i of dR/dW holds, for each face of cell i, the derivatives of Osher's flux between cell values. Unknowns are the
//! primitive variables; couplings to cells of other blocks stand in the places of the neighbours that a block's outermost cells
//! lack.

use dip_krylov::{BLOCK, BlockMatrix, Storage};
use rayon::prelude::*;

use crate::boundary::{Boundary, SideFlux, Sides, add_jacobian};
use crate::field::{Field, state_at};
use crate::flux::jacobian_osher;
use crate::gas::{Gas, VARIABLES, conservative_gradient};
use crate::level::{FaceSet, Level, LevelBlock};
use crate::real::{LANES, Lanes, Packed};
use crate::residual::{Slab, layer_cells, slabs};

/// Fills `matrices` (one a block) with dR/dW of the first-order scheme. Ghost cells must be filled.
pub fn jacobian<G: Gas, S: Storage>(
    gas: &G,
    level: &Level,
    boundaries: &[Boundary],
    sides: &Sides,
    field: &Field,
    matrices: &mut [BlockMatrix<S>],
) {
    let mut work = Vec::new();
    for (b, (block, matrix)) in level.blocks.iter().zip(matrices.iter_mut()).enumerate() {
        let layer = layer_cells(&block.layout);
        let nd = matrix.directions();
        let (mut diagonal, mut lower, mut upper) = matrix.arrays_mut();
        for slab in slabs(b, &block.layout) {
            let cells = (slab.to - slab.from) * layer;
            let (d, rest_d) = diagonal.split_at_mut(cells * BLOCK);
            let (l, rest_l) = lower.split_at_mut(cells * nd * BLOCK);
            let (u, rest_u) = upper.split_at_mut(cells * nd * BLOCK);
            (diagonal, lower, upper) = (rest_d, rest_l, rest_u);
            work.push((
                slab,
                nd,
                Arrays {
                    diagonal: d,
                    lower: l,
                    upper: u,
                },
            ));
        }
    }
    work.into_par_iter().with_max_len(1).for_each(|(slab, nd, mut arrays)| {
        arrays.diagonal.fill(S::default());
        let faces = Faces {
            gas,
            block: &level.blocks[slab.block],
            w: &field.blocks[slab.block],
            sides: &sides[slab.block],
            nd,
        };
        faces.add(&slab, &mut arrays);
    });
    add_jacobian(gas, level, boundaries, field, matrices);
}

/// The part of a block's matrix that belongs to a slab.
struct Arrays<'a, S> {
    diagonal: &'a mut [S],
    lower: &'a mut [S],
    upper: &'a mut [S],
}

struct Faces<'a, G> {
    gas: &'a G,
    block: &'a LevelBlock,
    w: &'a [f64],
    sides: &'a [Option<SideFlux>; 6],
    nd: usize,
}

/// The two cells of a face, as places in a slab's arrays, where they belong to the slab.
#[derive(Clone, Copy)]
struct Owners {
    left: Option<usize>,
    right: Option<usize>,
}

impl<G: Gas> Faces<'_, G> {
    fn add<S: Storage>(&self, slab: &Slab, arrays: &mut Arrays<'_, S>) {
        let [ni, nj, nk] = self.block.layout.cells;
        let (j_from, j_to, k_from, k_to) = if nk > 1 {
            (0, nj, slab.from, slab.to)
        } else {
            (slab.from, slab.to, 0, 1)
        };
        let rows = j_to - j_from;
        let row_of = |j: usize, k: usize| (j - j_from) + rows * (k - k_from);
        for d in 0..3 {
            if self.block.layout.ghosts[d] == 0 {
                continue;
            }
            let (j_end, k_end) = (j_to + usize::from(d == 1), k_to + usize::from(d == 2));
            for k in k_from..k_end {
                for j in j_from..j_end {
                    let owners = match d {
                        1 => Owners {
                            left: (j > j_from).then(|| row_of(j - 1, k)),
                            right: (j < j_to).then(|| row_of(j, k)),
                        },
                        2 => Owners {
                            left: (k > k_from).then(|| row_of(j, k - 1)),
                            right: (k < k_to).then(|| row_of(j, k)),
                        },
                        _ => Owners {
                            left: Some(row_of(j, k)),
                            right: Some(row_of(j, k)),
                        },
                    };
                    self.row(d, j, k, ni, owners, arrays);
                }
            }
        }
    }

    /// Adds the derivatives of a row of faces (.., j, k) normal to `d`.
    fn row<S: Storage>(&self, d: usize, j: usize, k: usize, ni: usize, rows: Owners, arrays: &mut Arrays<'_, S>) {
        let set = &self.block.faces[d];
        let count = set.count[0];
        let mut n = 0;
        let mut first_new = 0;
        while n < count {
            let lanes = count >= LANES;
            let at = if lanes { n.min(count - LANES) } else { n };
            let face = set.at(at, j, k);
            let right = self.block.layout.at(at, j, k);
            let stride = self.block.layout.stride[d];
            let mut blocks = [[[[0.0; LANES]; VARIABLES]; VARIABLES]; 2];
            let width = if lanes {
                self.pack::<Lanes>(set, face, right, stride, &mut blocks);
                LANES
            } else {
                self.pack::<f64>(set, face, right, stride, &mut blocks);
                1
            };
            for lane in first_new - at..width {
                self.scatter(d, at + lane, [j, k], ni, rows, &blocks, lane, arrays);
            }
            n = at + width;
            first_new = n;
        }
    }

    #[inline(always)]
    fn pack<T: Packed>(
        &self,
        set: &FaceSet,
        face: usize,
        right: usize,
        stride: usize,
        out: &mut [[[[f64; LANES]; VARIABLES]; VARIABLES]; 2],
    ) {
        let size = self.block.layout.size;
        let zero = T::splat(0.0);
        let (mut l, mut r) = ([zero; VARIABLES], [zero; VARIABLES]);
        for v in 0..VARIABLES {
            let w = &self.w[v * size..(v + 1) * size];
            l[v] = T::load(w, right - stride);
            r[v] = T::load(w, right);
        }
        let normal = [
            T::load(&set.normal[0], face),
            T::load(&set.normal[1], face),
            T::load(&set.normal[2], face),
        ];
        let speed = if set.speed.is_empty() {
            zero
        } else {
            T::load(&set.speed, face)
        };
        let area = T::load(&set.area, face);
        let derivative = jacobian_osher(self.gas, &l, &r, &normal, speed);
        for side in 0..2 {
            for c in 0..VARIABLES {
                for row in 0..VARIABLES {
                    (derivative[side][c][row] * area).store(&mut out[side][c][row], 0);
                }
            }
        }
    }

    /// True if the matrix has places for neighbours along `d`.
    fn keeps(&self, d: usize) -> bool {
        d < self.nd
    }

    /// True if the face on the side of the block is a boundary, not an interface.
    #[inline]
    fn is_boundary(&self, d: usize, at: [usize; 3], last: bool) -> bool {
        self.sides[2 * d + usize::from(last)].as_ref().is_some_and(|side| {
            let [p, q] = [[at[1], at[2]], [at[0], at[2]], [at[0], at[1]]][d];
            side.physical[p + side.size[0] * q]
        })
    }

    /// Adds the derivatives of one face to the rows of its two cells. A face on the side of the block adds nothing here
    /// if it is a boundary (its own derivative is added later).
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "a face, its two cells, and where both are kept"
    )]
    fn scatter<S: Storage>(
        &self,
        d: usize,
        i: usize,
        [j, k]: [usize; 2],
        ni: usize,
        rows: Owners,
        blocks: &[[[[f64; LANES]; VARIABLES]; VARIABLES]; 2],
        lane: usize,
        arrays: &mut Arrays<'_, S>,
    ) {
        let position = [i, j, k][d];
        let (first, last) = (position == 0, position == self.block.layout.cells[d]);
        if (first || last) && self.is_boundary(d, [i, j, k], last) {
            return;
        }
        let back = usize::from(d == 0);
        if let Some(row) = rows.left.filter(|_| !first) {
            let cell = row * ni + i - back;
            let diagonal = &mut arrays.diagonal[cell * BLOCK..][..BLOCK];
            for c in 0..VARIABLES {
                for r in 0..VARIABLES {
                    let e = &mut diagonal[r + VARIABLES * c];
                    *e = *e + S::from_f64(blocks[0][c][r][lane]);
                }
            }
            if !last || self.keeps(d) {
                let upper = &mut arrays.upper[(cell * self.nd + d) * BLOCK..][..BLOCK];
                for c in 0..VARIABLES {
                    for r in 0..VARIABLES {
                        upper[r + VARIABLES * c] = S::from_f64(blocks[1][c][r][lane]);
                    }
                }
            }
        }
        if let Some(row) = rows.right.filter(|_| !last) {
            let cell = row * ni + i;
            let diagonal = &mut arrays.diagonal[cell * BLOCK..][..BLOCK];
            for c in 0..VARIABLES {
                for r in 0..VARIABLES {
                    let e = &mut diagonal[r + VARIABLES * c];
                    *e = *e - S::from_f64(blocks[1][c][r][lane]);
                }
            }
            if !first || self.keeps(d) {
                let lower = &mut arrays.lower[(cell * self.nd + d) * BLOCK..][..BLOCK];
                for c in 0..VARIABLES {
                    for r in 0..VARIABLES {
                        lower[r + VARIABLES * c] = S::from_f64(-blocks[0][c][r][lane]);
                    }
                }
            }
        }
    }
}

/// Sum over the faces of each cell of half the spectral radius |u.n - face speed| + a times area: the volume over the
/// local time step at CFL one. `[cell]` over the level.
pub fn spectral_radii<G: Gas>(gas: &G, level: &Level, field: &Field, out: &mut [f64]) {
    for (block, w) in level.blocks.iter().zip(&field.blocks) {
        let [ni, nj, nk] = block.layout.cells;
        let out = &mut out[block.offset..block.offset + block.layout.cell_count()];
        out.par_chunks_mut(ni).enumerate().for_each(|(row, out)| {
            let (j, k) = (row % nj, row / nj);
            debug_assert!(k < nk);
            for (i, out) in out.iter_mut().enumerate() {
                let s = state_at(w, block.layout.size, block.layout.at(i, j, k));
                let a = gas.sound(s[0], s[4]);
                let mut sum = 0.0;
                for d in 0..3 {
                    if block.layout.ghosts[d] == 0 {
                        continue;
                    }
                    let set = &block.faces[d];
                    let low = set.at(i, j, k);
                    let step = [1, set.count[0], set.count[0] * set.count[1]][d];
                    for f in [low, low + step] {
                        let n = set.unit(f);
                        let un = s[1] * n[0] + s[2] * n[1] + s[3] * n[2] - set.face_speed(f);
                        sum += 0.5 * (un.abs() + a) * set.area[f];
                    }
                }
                *out = sum;
            }
        });
    }
}

/// Adds `factor[cell] dQ/dW` to the diagonals: the time derivative of the conservative variables (V/dt, and later the
/// real-time term of dual time stepping).
pub fn add_time<G: Gas, S: Storage>(
    gas: &G,
    level: &Level,
    field: &Field,
    factor: &[f64],
    matrices: &mut [BlockMatrix<S>],
) {
    matrices
        .par_iter_mut()
        .enumerate()
        .with_max_len(1)
        .for_each(|(b, matrix)| {
            let block = &level.blocks[b];
            let [ni, nj, nk] = block.layout.cells;
            let mut cell = 0;
            for k in 0..nk {
                for j in 0..nj {
                    for i in 0..ni {
                        let s = state_at(&field.blocks[b], block.layout.size, block.layout.at(i, j, k));
                        let gradient = conservative_gradient(gas, &s);
                        let f = factor[block.offset + cell];
                        let diagonal = matrix.diagonal_mut(cell);
                        for (r, row) in gradient.iter().enumerate() {
                            for (c, g) in row.iter().enumerate() {
                                let e = &mut diagonal[r + VARIABLES * c];
                                *e = *e + S::from_f64(f * g);
                            }
                        }
                        cell += 1;
                    }
                }
            }
        });
}
