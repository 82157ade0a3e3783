//! The exact coarser level: every second point.

use crate::block::Block;
use crate::topology::{MultiBlock, Side};

/// Why a grid has no coarser level.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
pub enum CoarsenError {
    /// An odd number of cells.
    #[error("block {block}: {cells} cells along {direction}; every second point needs an even number")]
    Block {
        /// Name of the block.
        block: String,
        /// Cells there.
        cells: usize,
        /// i, j or k.
        direction: char,
    },
    /// A patch or interface ends between two kept points.
    #[error("block {block} {face}: a patch or interface ends at an odd node, which the coarser grid does not have")]
    Window {
        /// Name of the block.
        block: String,
        /// Name of the face.
        face: &'static str,
    },
}

/// Keeps every second point in every direction (not across a two-dimensional grid).
/// # Errors
/// Where a block, patch or interface does not fall on even points.
pub fn coarsen(grid: &MultiBlock) -> Result<MultiBlock, CoarsenError> {
    let two_d = grid.is_two_dimensional();
    let step = [2, 2, if two_d { 1 } else { 2 }];
    let mut out = grid.clone();
    for (coarse, fine) in out.blocks.iter_mut().zip(&grid.blocks) {
        let cells = fine.cells();
        for d in 0..3 {
            if cells[d] % step[d] != 0 {
                return Err(CoarsenError::Block {
                    block: fine.name.clone(),
                    cells: cells[d],
                    direction: ['i', 'j', 'k'][d],
                });
            }
        }
        let less = [cells[0] / step[0], cells[1] / step[1], cells[2] / step[2]];
        *coarse = Block::from_fn(&fine.name, less, |i, j, k| {
            fine.point(step[0] * i, step[1] * j, step[2] * k)
        });
    }
    let halve = |side: &mut Side| {
        let directions = side.face.directions();
        for (d, direction) in directions.into_iter().enumerate() {
            let (lo, hi) = (side.window.lo[d], side.window.hi[d]);
            if lo % step[direction] != 0 || hi % step[direction] != 0 {
                let block = grid.blocks[side.block].name.clone();
                return Err(CoarsenError::Window {
                    block,
                    face: side.face.name(),
                });
            }
            side.window.lo[d] = lo / step[direction];
            side.window.hi[d] = hi / step[direction];
        }
        Ok(())
    };
    for patch in &mut out.topology.patches {
        let mut side = patch.side();
        halve(&mut side)?;
        patch.window = side.window;
    }
    for interface in &mut out.topology.interfaces {
        halve(&mut interface.a)?;
        halve(&mut interface.b)?;
    }
    Ok(out)
}
