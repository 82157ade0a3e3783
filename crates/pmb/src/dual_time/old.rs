//! What the old time levels contribute to the equations of a step.
//!
//! Old volumes are the new one less what the faces have swept since (see [`crate::moving`]): with S, S', S'' the growth of a cell
//! in this step and the two before,
//!
//! `(a1 Q V|n + a2 Q V|n-1 + a3 Q V|n-2)/dt = c V|n + d`, `V|n = V|n+1 - S`,
//! `c = (a1 Q|n + a2 Q|n-1 + a3 Q|n-2)/dt`, `d = -((a2 Q|n-1 + a3 Q|n-2) S' + a3 Q|n-2 S'')/dt`
//!
//! c and d are the same wherever the nodes are placed in the step.

use rayon::prelude::*;

use super::DualTime;
use crate::gas::{Diatomic, Gas, Perfect, State, VARIABLES, conservative};
use crate::level::LevelBlock;
use crate::moving::{Backward, growth};

/// c and d, `[cell][variable]`.
#[derive(Clone, Debug, Default)]
pub(super) struct OldLevels {
    factor: Vec<f64>,
    rest: Vec<f64>,
}

impl OldLevels {
    pub(super) fn zeros(cells: usize) -> Self {
        Self {
            factor: vec![0.0; cells * VARIABLES],
            rest: vec![0.0; cells * VARIABLES],
        }
    }
}

/// Rows of cells of a block: the first one, and its cells counted over all blocks.
struct Rows<'a> {
    block: usize,
    first: usize,
    cell: usize,
    arrays: [&'a mut [f64]; 2],
}

/// Cuts two arrays of `widths` entries a cell into rows of cells.
fn cut<'a>(blocks: &[LevelBlock], widths: [usize; 2], mut arrays: [&'a mut [f64]; 2]) -> Vec<Rows<'a>> {
    const CELLS: usize = 1024;
    let mut out = Vec::new();
    for (b, block) in blocks.iter().enumerate() {
        let [ni, nj, nk] = block.layout.cells;
        let rows = (CELLS / ni).max(1);
        for first in (0..nj * nk).step_by(rows) {
            let cells = rows.min(nj * nk - first) * ni;
            let mut n = 0;
            let parts = arrays.each_mut().map(|array| {
                let (head, tail) = std::mem::take(array).split_at_mut(cells * widths[n]);
                *array = tail;
                n += 1;
                head
            });
            out.push(Rows {
                block: b,
                first,
                cell: block.offset + first * ni,
                arrays: parts,
            });
        }
    }
    out
}

impl DualTime {
    /// Prepares a step: its history and what was swept in earlier steps are known.
    pub(super) fn set_old_levels(&mut self) {
        if self.solver.equations.scheme.gamma == 1.4 {
            self.set_old_levels_of(&Diatomic);
        } else {
            let gamma = self.solver.equations.scheme.gamma;
            self.set_old_levels_of(&Perfect { gamma });
        }
    }

    fn set_old_levels_of(&mut self, gas: &impl Gas) {
        let level = &self.solver.equations.level;
        let Backward { a, dt } = self.backward;
        let levels = self.backward.levels();
        let OldLevels { factor, rest } = &mut self.old_levels;
        let work = cut(&level.blocks, [VARIABLES; 2], [factor, rest]);
        let (history, grid) = (&self.history, &self.grid);
        work.into_par_iter().with_max_len(4).for_each(|rows| {
            let block = &level.blocks[rows.block];
            let [ni, nj, _] = block.layout.cells;
            let [factor, rest] = rows.arrays;
            let cells = factor.chunks_exact_mut(VARIABLES).zip(rest.chunks_exact_mut(VARIABLES));
            for (n, (c, d)) in cells.enumerate() {
                let row = rows.first + n / ni;
                let at = [n % ni, row % nj, row / nj];
                let part = |level: usize| -> State<f64> {
                    if level >= levels {
                        return [0.0; VARIABLES];
                    }
                    let w = &history[level][VARIABLES * (rows.cell + n)..][..VARIABLES];
                    conservative(gas, &[w[0], w[1], w[2], w[3], w[4]]).map(|q| a[1 + level] / dt * q)
                };
                let q = [part(0), part(1), part(2)];
                let swept = |n: usize, by: &[crate::moving::Swept]| {
                    if levels > n {
                        growth(block, &by[rows.block], at)
                    } else {
                        0.0
                    }
                };
                let (before, longer) = (swept(1, &grid.swept_old), swept(2, &grid.swept_older));
                for v in 0..VARIABLES {
                    c[v] = q[0][v] + (q[1][v] + q[2][v]);
                    d[v] = -((q[1][v] + q[2][v]) * before + q[2][v] * longer);
                }
            }
        });
    }

    /// rate = a0 V/dt, source = c V|n + d
    pub(super) fn set_inertia(&mut self) {
        let level = &self.solver.equations.level;
        let Some(inertia) = &mut self.solver.inertia else {
            return;
        };
        let Backward { a, dt } = self.backward;
        let work = cut(
            &level.blocks,
            [1, VARIABLES],
            [&mut inertia.rate[..], &mut inertia.source[..]],
        );
        let (old, grid) = (&self.old_levels, &self.grid);
        work.into_par_iter().with_max_len(4).for_each(|rows| {
            let block = &level.blocks[rows.block];
            let [ni, nj, _] = block.layout.cells;
            let [rate, source] = rows.arrays;
            let range = rows.cell * VARIABLES..rows.cell * VARIABLES + source.len();
            let (factor, rest) = (&old.factor[range.clone()], &old.rest[range]);
            let volumes = &block.volume[rows.first * ni..];
            let of_row = rate.chunks_exact_mut(ni).zip(volumes.chunks_exact(ni));
            for (row, (rate, volume)) in of_row.enumerate() {
                let (j, k) = ((rows.first + row) % nj, (rows.first + row) / nj);
                for (i, (rate, volume)) in rate.iter_mut().zip(volume).enumerate() {
                    *rate = a[0] / dt * volume;
                    let old = volume - growth(block, &grid.swept[rows.block], [i, j, k]);
                    let n = (row * ni + i) * VARIABLES;
                    for v in n..n + VARIABLES {
                        source[v] = factor[v].mul_add(old, rest[v]);
                    }
                }
            }
        });
    }
}
