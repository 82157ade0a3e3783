//! Cuts blocks into smaller ones, for balance between threads and ranks, with interfaces and patches kept.

use crate::block::Block;
use crate::face::{Face, Window};
use crate::topology::{Interface, MultiBlock, Orientation, Patch, Side};

/// Cuts block `block` at node `at` of index direction `axis` (0 = i). The lower part keeps its place in the list, the
/// upper part is appended, and an interface joins them. Nothing happens unless `0 < at < cells`.
pub fn split_block(grid: &mut MultiBlock, block: usize, axis: usize, at: usize) {
    let cells = grid.blocks[block].cells();
    if at == 0 || at >= cells[axis] {
        return;
    }
    let upper = grid.blocks.len();
    let part = |name: String, from: usize, to: usize, whole: &Block| {
        let mut size = cells;
        size[axis] = to - from;
        Block::from_fn(&name, size, |i, j, k| {
            let mut ijk = [i, j, k];
            ijk[axis] += from;
            whole.point_at(ijk)
        })
    };
    let whole = &grid.blocks[block];
    let taken = |name: &str| grid.blocks.iter().any(|b| b.name == name);
    let stem = whole.name.split('.').next().unwrap_or_default().to_owned();
    let mut number = 2;
    while taken(&format!("{stem}.{number}")) {
        number += 1;
    }
    let low = part(whole.name.clone(), 0, at, whole);
    let high = part(format!("{stem}.{number}"), at, cells[axis], whole);
    grid.blocks[block] = low;
    grid.blocks.push(high);

    let cut = Cut { block, upper, axis, at };
    let mut patches = Vec::with_capacity(grid.topology.patches.len() + 4);
    for patch in grid.topology.patches.drain(..) {
        for (side, _) in cut.parts(patch.side()) {
            patches.push(Patch {
                block: side.block,
                face: side.face,
                window: side.window,
                ..patch.clone()
            });
        }
    }
    grid.topology.patches = patches;

    let mut interfaces = Vec::with_capacity(grid.topology.interfaces.len() + 5);
    for interface in grid.topology.interfaces.drain(..) {
        // Cut along a's pieces first, then each along b's: a self-connection may need both.
        for (a, local) in cut.parts(interface.a) {
            let b = window_on_other(&interface, local);
            let half = Interface {
                a,
                b: Side {
                    window: b,
                    ..interface.b
                },
                ..interface
            };
            let back = half.reversed();
            for (b, local) in cut.parts(back.a) {
                let a = window_on_other(&back, local);
                let piece = Interface {
                    a: b,
                    b: Side { window: a, ..back.b },
                    ..back
                };
                interfaces.push(piece.reversed());
            }
        }
    }
    let joint = |block: usize, max: bool| {
        let face = Face::new(axis, max);
        Side {
            block,
            face,
            window: Window::full(grid.blocks[block].face_cells(face)),
        }
    };
    interfaces.push(Interface {
        a: joint(block, true),
        b: joint(upper, false),
        orientation: Orientation::default(),
        translation: None,
    });
    grid.topology.interfaces = interfaces;
}

/// Cuts until there are `count` blocks: each time the block with most cells, across its longest direction, at the
/// node that halves it (or takes its fair share), moved to an edge of a patch or to an even node where one is near, so
/// that coarser levels stay nested. The result depends on the grid and `count` only, never on the machine.
pub fn split_into(grid: &mut MultiBlock, count: usize) {
    while grid.blocks.len() < count {
        let Some(block) = largest(grid) else { return };
        let cells = grid.blocks[block].cells();
        let two_d = grid.is_two_dimensional();
        let Some(axis) = (0..3)
            .filter(|&a| cells[a] >= 2 && !(two_d && a == 2))
            .max_by_key(|&a| (cells[a], 2 - a))
        else {
            return;
        };
        let half = cells[axis] / 2;
        let step = [8, 4, 2]
            .into_iter()
            .find(|&s| cells[axis].is_multiple_of(s) && half >= s)
            .unwrap_or(1);
        let at = (half / step).max(1) * step;
        split_block(grid, block, axis, at);
    }
}

/// The block with most cells that can still be cut; the first of equals.
fn largest(grid: &MultiBlock) -> Option<usize> {
    let blocks = &grid.blocks;
    (0..blocks.len())
        .filter(|&n| blocks[n].cells().iter().any(|&c| c >= 2))
        .max_by(|&a, &b| blocks[a].cell_count().cmp(&blocks[b].cell_count()).then(b.cmp(&a)))
}

/// Where block `block` was cut in two.
struct Cut {
    block: usize,
    upper: usize,
    axis: usize,
    at: usize,
}

impl Cut {
    /// The one or two parts of a side in the new numbering, each with its window in the old numbering.
    fn parts(&self, side: Side) -> Vec<(Side, Window)> {
        if side.block != self.block {
            return vec![(side, side.window)];
        }
        if side.face.axis() == self.axis {
            let block = if side.face.is_max() { self.upper } else { self.block };
            return vec![(Side { block, ..side }, side.window)];
        }
        let d = usize::from(side.face.directions()[1] == self.axis);
        let (lo, hi) = (side.window.lo[d], side.window.hi[d]);
        let mut parts = Vec::with_capacity(2);
        if lo < self.at {
            let mut window = side.window;
            window.hi[d] = hi.min(self.at);
            parts.push((Side { window, ..side }, window));
        }
        if hi > self.at {
            let mut old = side.window;
            old.lo[d] = lo.max(self.at);
            let mut window = old;
            window.lo[d] -= self.at;
            window.hi[d] -= self.at;
            parts.push((
                Side {
                    block: self.upper,
                    window,
                    ..side
                },
                old,
            ));
        }
        parts
    }
}

/// The window of b's face that lies on the part `window` of a's window (old numbering).
fn window_on_other(interface: &Interface, window: Window) -> Window {
    let first = interface.node_on_b(window.lo[0], window.lo[1]);
    let last = interface.node_on_b(window.hi[0], window.hi[1]);
    Window {
        lo: [first[0].min(last[0]), first[1].min(last[1])],
        hi: [first[0].max(last[0]), first[1].max(last[1])],
    }
}
