//! The flow on a level: primitive variables in every cell and its ghosts.

use rayon::prelude::*;

use crate::gas::{State, VARIABLES};
use crate::level::Level;

/// Primitive variables `[rho, u, v, w, p]` by block, each a structure of arrays `[variable][k][j][i]` with ghost cells
/// (see [`crate::level::Layout`]). Non-dimensional by free-stream density and speed.
#[derive(Clone, Debug)]
pub struct Field {
    /// One array a block.
    pub blocks: Vec<Vec<f64>>,
    /// States on their way from block to block, `[block][ghost][variable]`; kept so that no exchange allocates.
    gathered: Vec<Vec<f64>>,
}

impl Field {
    /// The same state everywhere.
    #[must_use]
    pub fn uniform(level: &Level, state: &State<f64>) -> Self {
        let blocks = level
            .blocks
            .iter()
            .map(|b| {
                let mut w = vec![0.0; VARIABLES * b.layout.size];
                for (v, value) in state.iter().enumerate() {
                    w[v * b.layout.size..(v + 1) * b.layout.size].fill(*value);
                }
                w
            })
            .collect();
        let gathered = vec![Vec::new(); level.blocks.len()];
        Self { blocks, gathered }
    }

    /// State of a cell at its place in the block.
    #[inline(always)]
    #[must_use]
    pub fn state(&self, level: &Level, block: usize, at: usize) -> State<f64> {
        state_at(&self.blocks[block], level.blocks[block].layout.size, at)
    }

    /// Copies the cells (no ghosts) to a vector `[cell][variable]` over the whole level.
    pub fn store(&self, level: &Level, out: &mut [f64]) {
        for (block, w) in level.blocks.iter().zip(&self.blocks) {
            let [ni, nj, nk] = block.layout.cells;
            let size = block.layout.size;
            let mut to = out[block.offset * VARIABLES..].chunks_exact_mut(VARIABLES);
            for k in 0..nk {
                for j in 0..nj {
                    let row = block.layout.at(0, j, k);
                    for (at, cell) in (row..row + ni).zip(&mut to) {
                        cell.copy_from_slice(&state_at(w, size, at));
                    }
                }
            }
        }
    }

    /// The reverse of [`Field::store`], ghosts are left as they are.
    pub fn load(&mut self, level: &Level, from: &[f64]) {
        self.combine(level, from, 0.0, from);
    }

    /// Sets the cells to `base + factor * direction`, both `[cell][variable]`; ghosts are left as they are.
    pub fn combine(&mut self, level: &Level, base: &[f64], factor: f64, direction: &[impl dip_krylov::Storage]) {
        self.blocks
            .par_iter_mut()
            .zip(&level.blocks)
            .with_max_len(1)
            .for_each(|(w, block)| {
                let [ni, nj, nk] = block.layout.cells;
                let size = block.layout.size;
                let mut n = block.offset * VARIABLES;
                for k in 0..nk {
                    for j in 0..nj {
                        let row = block.layout.at(0, j, k);
                        let base = &base[n..n + ni * VARIABLES];
                        let direction = &direction[n..n + ni * VARIABLES];
                        for v in 0..VARIABLES {
                            let w = &mut w[v * size + row..v * size + row + ni];
                            for (i, w) in w.iter_mut().enumerate() {
                                let m = i * VARIABLES + v;
                                *w = if factor == 0.0 {
                                    base[m]
                                } else {
                                    base[m] + factor * direction[m].to_f64()
                                };
                            }
                        }
                        n += ni * VARIABLES;
                    }
                }
            });
    }

    /// Fills the ghost cells on interfaces from the cells they copy, then does `finish` for every block and its array.
    pub fn exchange(&mut self, level: &Level, finish: impl Fn(usize, &mut [f64]) + Sync) {
        let Self { blocks, gathered } = self;
        // Gathered first, written after: no block is read while it is written, whatever the order.
        gathered
            .par_iter_mut()
            .zip(&level.links)
            .with_max_len(1)
            .for_each(|(values, links)| {
                values.clear();
                for link in links {
                    let size = level.blocks[link.block as usize].layout.size;
                    values.extend_from_slice(&state_at(&blocks[link.block as usize], size, link.cell as usize));
                }
            });
        blocks.par_iter_mut().enumerate().with_max_len(1).for_each(|(b, w)| {
            let size = level.blocks[b].layout.size;
            for (link, state) in level.links[b].iter().zip(gathered[b].chunks_exact(VARIABLES)) {
                for (v, value) in state.iter().enumerate() {
                    w[v * size + link.ghost as usize] = *value;
                }
            }
            finish(b, w);
        });
    }
}

/// State at a place of a block's array.
#[inline(always)]
#[must_use]
pub fn state_at(w: &[f64], size: usize, at: usize) -> State<f64> {
    [
        w[at],
        w[size + at],
        w[2 * size + at],
        w[3 * size + at],
        w[4 * size + at],
    ]
}

/// Writes a state to a place of a block's array.
#[inline(always)]
pub fn set_state(w: &mut [f64], size: usize, at: usize, state: &State<f64>) {
    for (v, value) in state.iter().enumerate() {
        w[v * size + at] = *value;
    }
}
