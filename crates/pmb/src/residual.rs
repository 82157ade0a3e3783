//! Sum of the fluxes out of every cell.
//!
//! R_i = sum over the faces of cell i of F.S, outward; a steady flow has R = 0, and V dQ/dt = -R (formulation.md,
//! section 2). Rows of faces along i are worked on four at a time. A block is cut into slabs along its slowest
//! direction; a face between two slabs is computed by both, with the same bits, so that the result does not depend
//! on who does which slab.

use rayon::prelude::*;

use crate::boundary::{SideFlux, Sides};
use crate::field::Field;
use crate::flux::flux_osher;
use crate::gas::{Gas, VARIABLES};
use crate::level::{FaceSet, Level, LevelBlock};
use crate::real::{LANES, Lanes, Packed};
use crate::reconstruct::{Koren, Mean, Reconstruction, VanAlbada, muscl};
use crate::scheme::Scheme;

/// Planes of cells in a slab of a three-dimensional block, rows in one of a planar block.
pub(crate) const SLAB: [usize; 2] = [7, 16];

/// Computes `out = R`, `[cell][variable]` over the level. Ghost cells and boundary fluxes must be up to date.
pub fn residual<G: Gas>(gas: &G, level: &Level, scheme: &Scheme, field: &Field, sides: &Sides, out: &mut [f64]) {
    residual_then(gas, level, scheme, field, sides, out, &|_, _| ());
}

/// [`residual`], and then `finish` for each piece of it while it is still in the cache: the number of its first cell and its
/// values.
pub fn residual_then<G: Gas>(
    gas: &G,
    level: &Level,
    scheme: &Scheme,
    field: &Field,
    sides: &Sides,
    out: &mut [f64],
    finish: &(impl Fn(usize, &mut [f64]) + Sync),
) {
    match scheme.reconstruction {
        Reconstruction::Constant => residual_as::<G, 0>(gas, level, scheme, field, sides, out, finish),
        Reconstruction::Unlimited => residual_as::<G, 1>(gas, level, scheme, field, sides, out, finish),
        Reconstruction::VanAlbada => residual_as::<G, 2>(gas, level, scheme, field, sides, out, finish),
        Reconstruction::Koren => residual_as::<G, 3>(gas, level, scheme, field, sides, out, finish),
    }
}

/// A slab: cells `from..to` of the slowest direction of a block.
pub(crate) struct Slab {
    pub block: usize,
    pub from: usize,
    pub to: usize,
}

/// Slabs of a block: along k, or along j where there is one cell along k.
pub(crate) fn slabs(block: usize, layout: &crate::level::Layout) -> impl Iterator<Item = Slab> + use<> {
    let (count, thick) = if layout.cells[2] > 1 {
        (layout.cells[2], SLAB[0])
    } else {
        (layout.cells[1], SLAB[1])
    };
    (0..count.div_ceil(thick)).map(move |n| Slab {
        block,
        from: n * thick,
        to: ((n + 1) * thick).min(count),
    })
}

/// Cells in one layer of the slowest direction.
pub(crate) fn layer_cells(layout: &crate::level::Layout) -> usize {
    if layout.cells[2] > 1 {
        layout.cells[0] * layout.cells[1]
    } else {
        layout.cells[0]
    }
}

fn residual_as<G: Gas, const ORDER: u8>(
    gas: &G,
    level: &Level,
    scheme: &Scheme,
    field: &Field,
    sides: &Sides,
    out: &mut [f64],
    finish: &(impl Fn(usize, &mut [f64]) + Sync),
) {
    let mut work = Vec::new();
    let mut rest = out;
    for (b, block) in level.blocks.iter().enumerate() {
        let layer = layer_cells(&block.layout) * VARIABLES;
        for slab in slabs(b, &block.layout) {
            let (head, tail) = rest.split_at_mut((slab.to - slab.from) * layer);
            rest = tail;
            work.push((slab, head));
        }
    }
    work.into_par_iter().with_max_len(1).for_each(|(slab, out)| {
        let rows = Rows::<G, ORDER> {
            gas,
            block: &level.blocks[slab.block],
            w: &field.blocks[slab.block],
            sides: &sides[slab.block],
            scheme,
        };
        rows.residual(&slab, out);
        let block = &level.blocks[slab.block];
        finish(block.offset + slab.from * layer_cells(&block.layout), out);
    });
}

/// What the rows of one block share.
struct Rows<'a, G, const ORDER: u8> {
    gas: &'a G,
    block: &'a LevelBlock,
    w: &'a [f64],
    sides: &'a [Option<SideFlux>; 6],
    scheme: &'a Scheme,
}

impl<G: Gas, const ORDER: u8> Rows<'_, G, ORDER> {
    fn residual(&self, slab: &Slab, out: &mut [f64]) {
        let [ni, nj, nk] = self.block.layout.cells;
        let (j_range, k_range) = if nk > 1 {
            (0..nj, slab.from..slab.to)
        } else {
            (slab.from..slab.to, 0..1)
        };
        let with_k = self.block.layout.ghosts[2] > 0;
        let width = ni + 1;
        let row = width * VARIABLES;
        let mut across = vec![0.0; row];
        let mut below = vec![0.0; row];
        let mut above = vec![0.0; row];
        let mut next = vec![0.0; row];
        // Fluxes through the k-faces under the current plane, one row for each j.
        let mut floor = vec![0.0; if with_k { row * j_range.len() } else { 0 }];
        if with_k {
            for (j, to) in j_range.clone().zip(floor.chunks_exact_mut(row)) {
                self.faces(2, 0, j, k_range.start, to, width);
            }
        }
        let mut cells = out.chunks_exact_mut(ni * VARIABLES);
        for k in k_range {
            self.faces(1, 0, j_range.start, k, &mut below, width);
            for j in j_range.clone() {
                let Some(cells) = cells.next() else { return };
                self.faces(0, 0, j, k, &mut across, width);
                self.faces(1, 0, j + 1, k, &mut above, width);
                for v in 0..VARIABLES {
                    let (a, b, c) = (
                        &across[v * width..][..width],
                        &below[v * width..][..ni],
                        &above[v * width..][..ni],
                    );
                    for i in 0..ni {
                        cells[i * VARIABLES + v] = (a[i + 1] - a[i]) + (c[i] - b[i]);
                    }
                }
                std::mem::swap(&mut below, &mut above);
                if with_k {
                    self.faces(2, 0, j, k + 1, &mut next, width);
                    let floor = &mut floor[(j - j_range.start) * row..][..row];
                    for v in 0..VARIABLES {
                        let (b, c) = (&floor[v * width..][..ni], &next[v * width..][..ni]);
                        for i in 0..ni {
                            cells[i * VARIABLES + v] += c[i] - b[i];
                        }
                    }
                    floor.copy_from_slice(&next);
                }
            }
        }
    }

    /// Fluxes times area of the row of faces (.., j, k) normal to direction `d`, from the field or from the boundary,
    /// `[variable][i]` with `width` entries a variable.
    #[inline]
    fn faces(&self, d: usize, i: usize, j: usize, k: usize, out: &mut [f64], width: usize) {
        let set = &self.block.faces[d];
        let cells = self.block.layout.cells;
        let position = [i, j, k][d];
        if d > 0 && (position == 0 || position == cells[d]) {
            let side = &self.sides[2 * d + usize::from(position > 0)];
            if let Some(side) = side {
                if !side.whole {
                    self.row(d, i, j, k, out, width);
                }
                let q = if d == 1 { k } else { j };
                let from = side.size[0] * q;
                let n = side.physical.len();
                for p in 0..cells[0] {
                    if side.physical[from + p] {
                        for v in 0..VARIABLES {
                            out[v * width + p] = side.flux[v * n + from + p];
                        }
                    }
                }
                return;
            }
        }
        self.row(d, i, j, k, out, width);
        if d == 0 {
            let f = j + cells[1] * k;
            for (side, at) in [(&self.sides[0], 0), (&self.sides[1], set.count[0] - 1)] {
                if let Some(side) = side.as_ref().filter(|s| s.physical[f]) {
                    for (v, flux) in side.flux_at(f).into_iter().enumerate() {
                        out[v * width + at] = flux;
                    }
                }
            }
        }
    }

    fn row(&self, d: usize, i: usize, j: usize, k: usize, out: &mut [f64], width: usize) {
        let set = &self.block.faces[d];
        let count = set.count[0];
        let first = set.at(i, j, k);
        let right = self.block.layout.at(i, j, k);
        let stride = self.block.layout.stride[d];
        let mut n = 0;
        if count >= LANES {
            while n < count {
                // The last pack reaches back over faces already done: the same numbers are written again.
                let at = n.min(count - LANES);
                self.pack::<Lanes>(set, first + at, right + at, stride, out, at, width);
                n = at + LANES;
            }
        } else {
            while n < count {
                self.pack::<f64>(set, first + n, right + n, stride, out, n, width);
                n += 1;
            }
        }
    }

    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "places in four arrays")]
    fn pack<T: Packed>(
        &self,
        set: &FaceSet,
        face: usize,
        right: usize,
        stride: usize,
        out: &mut [f64],
        at: usize,
        width: usize,
    ) {
        let size = self.block.layout.size;
        let zero = T::splat(0.0);
        let mut cells = [[zero; VARIABLES]; 4];
        let [a, b, c, d] = &mut cells;
        for v in 0..VARIABLES {
            let w = &self.w[v * size..(v + 1) * size];
            if ORDER > 0 {
                a[v] = T::load(w, right - 2 * stride);
                d[v] = T::load(w, right + stride);
            }
            b[v] = T::load(w, right - stride);
            c[v] = T::load(w, right);
        }
        let e2 = self.scheme.limiter_squared.map(T::splat);
        let [left, right] = match ORDER {
            0 => [*b, *c],
            1 => muscl::<T, Mean>(a, b, c, d, &e2),
            2 => muscl::<T, VanAlbada>(a, b, c, d, &e2),
            _ => muscl::<T, Koren>(a, b, c, d, &e2),
        };
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
        let flux = flux_osher(self.gas, &left, &right, &normal, speed);
        let area = T::load(&set.area, face);
        for (v, f) in flux.into_iter().enumerate() {
            (f * area).store(out, v * width + at);
        }
    }
}
