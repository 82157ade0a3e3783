//! Levels of a grid sequence, and the flow carried from a coarse level to the next finer one.

use crate::field::{Field, state_at};
use crate::gas::VARIABLES;
use crate::level::{CellMap, Level};
use crate::reconstruct::guarded;

/// Levels from the finest to the coarsest, with the maps between neighbours.
#[derive(Clone, Debug)]
pub struct Sequence {
    /// Levels; the first is the finest.
    pub levels: Vec<Level>,
    /// Map of level n to level n + 1.
    pub maps: Vec<CellMap>,
}

impl Sequence {
    /// At most `count` levels under and with `finest`.
    #[must_use]
    pub fn new(finest: Level, count: usize) -> Self {
        // A level of fewer cells costs nothing and brings nothing.
        const LEAST_CELLS: usize = 200;
        let mut levels = vec![finest];
        let mut maps = Vec::new();
        while levels.len() < count.max(1) {
            let Some((coarse, map)) = levels.last().and_then(Level::coarser) else {
                break;
            };
            if coarse.cell_count < LEAST_CELLS {
                break;
            }
            levels.push(coarse);
            maps.push(map);
        }
        Self { levels, maps }
    }
}

/// Linear interpolation of a coarse flow to the cells of the finer level, `[cell][variable]`: along every merged
/// direction a fine cell takes a quarter of the difference to the neighbour of its parent on its own side. The ghost
/// cells of `from` must be filled.
#[must_use]
pub fn prolong(map: &CellMap, fine: &Level, coarse: &Level, from: &Field) -> Vec<f64> {
    let mut out = Vec::with_capacity(fine.cell_count * VARIABLES);
    for (b, block) in fine.blocks.iter().enumerate() {
        let merge = map.merge[b];
        let layout = &coarse.blocks[b].layout;
        let w = &from.blocks[b];
        let [ni, nj, nk] = block.layout.cells;
        for k in 0..nk {
            for j in 0..nj {
                for i in 0..ni {
                    let index = [i, j, k];
                    let [a, c, e] = [0, 1, 2].map(|d| if merge[d] { index[d] / 2 } else { index[d] });
                    let at = layout.at(a, c, e);
                    let parent = state_at(w, layout.size, at);
                    let mut state = parent;
                    for d in (0..3).filter(|d| merge[*d]) {
                        let neighbour = if index[d] % 2 == 0 {
                            at - layout.stride[d]
                        } else {
                            at + layout.stride[d]
                        };
                        let beside = state_at(w, layout.size, neighbour);
                        for v in 0..VARIABLES {
                            state[v] += 0.25 * (beside[v] - parent[v]);
                        }
                    }
                    out.extend_from_slice(&guarded(&parent, &state));
                }
            }
        }
    }
    out
}
