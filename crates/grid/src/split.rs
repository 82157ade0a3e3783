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
        period: None,
    });
    grid.topology.interfaces = interfaces;
}

/// Cuts until there are `count` blocks of sizes as equal as possible: every block gets its share of the parts by its cells,
/// and is halved (a third goes to one side where the parts are three) across a long direction until they are made. Cuts
/// along j, through the boundary layer, only where j is by far the longest; cuts at nodes that coarser levels have too,
/// where balance allows. The result depends on the grid and `count` only, never on the machine.
pub fn split_into(grid: &mut MultiBlock, count: usize) {
    let cells: Vec<usize> = grid.blocks.iter().map(Block::cell_count).collect();
    let mut parts = vec![1usize; cells.len()];
    for _ in cells.len()..count {
        // The next part goes where parts are largest; to the first of equals.
        let Some(n) =
            (0..cells.len()).max_by(|&a, &b| (cells[a] * parts[b]).cmp(&(cells[b] * parts[a])).then(b.cmp(&a)))
        else {
            return;
        };
        parts[n] += 1;
    }
    let two_d = grid.is_two_dimensional();
    for (block, parts) in parts.into_iter().enumerate() {
        divide(grid, block, parts, two_d);
    }
}

/// Cuts every block that meets itself across one of its own faces, as a C grid does along its wake, into one block on each
/// side. The flow is the same; its solver sweeps each block from end to end and carries a wave through an interface where
/// one block is swept towards it and the next away from it, which no sweep of a single block can do on both sides of its
/// own cut. Returns the cuts: name of the block, its face, index direction and node.
pub fn part_at_own_cuts(grid: &mut MultiBlock) -> Vec<(String, Face, usize, usize)> {
    let mut cuts = Vec::new();
    // The narrowest gap first: where others are wider the same cut serves them. A cut leaves fewer, so that this ends.
    while let Some((block, face, axis, gap)) = grid
        .topology
        .interfaces
        .iter()
        .filter_map(own_cut)
        .min_by_key(|(block, _, axis, [lo, hi])| (hi - lo, *block, *axis, *lo))
    {
        let at = middle(gap);
        cuts.push((grid.blocks[block].name.clone(), face, axis, at));
        split_block(grid, block, axis, at);
    }
    cuts
}

/// Block, face, index direction and the nodes between which a cut parts the two sides of an interface that joins a face to itself.
fn own_cut(interface: &Interface) -> Option<(usize, Face, usize, [usize; 2])> {
    let (a, b) = (interface.a, interface.b);
    if (a.block, a.face) != (b.block, b.face) {
        return None;
    }
    (0..2).find_map(|d| {
        let [first, second] = if a.window.lo[d] < b.window.lo[d] {
            [a, b]
        } else {
            [b, a]
        };
        let gap = [first.window.hi[d], second.window.lo[d]];
        (gap[0] <= gap[1]).then(|| (a.block, a.face, a.face.directions()[d], gap))
    })
}

/// Node near the middle of a gap, one that coarser levels have too where there is one.
fn middle([lo, hi]: [usize; 2]) -> usize {
    let centre = lo.midpoint(hi);
    [8, 4, 2]
        .into_iter()
        .map(|step| centre / step * step)
        .find(|at| (lo..=hi).contains(at))
        .unwrap_or(centre)
}

fn divide(grid: &mut MultiBlock, block: usize, parts: usize, two_d: bool) {
    let cells = grid.blocks[block].cells();
    let weight = |axis: usize| cells[axis] * if axis == 1 { 1 } else { 3 };
    let axis = (0..3)
        .filter(|&a| cells[a] >= 2 && !(two_d && a == 2))
        .max_by_key(|&a| (weight(a), 2 - a));
    let (Some(axis), true) = (axis, parts >= 2) else { return };
    let (n, lower) = (cells[axis], parts / 2);
    let ideal = n as f64 * lower as f64 / parts as f64;
    let near = |step: usize| (ideal / step as f64).round() as usize * step;
    let good = |step: usize| {
        let at = near(step);
        n.is_multiple_of(step) && at > 0 && at < n && (at as f64 - ideal).abs() <= 0.04 * n as f64
    };
    let at = [8, 4, 2]
        .into_iter()
        .find(|&s| good(s))
        .map_or_else(|| near(1).clamp(1, n - 1), near);
    split_block(grid, block, axis, at);
    let upper = grid.blocks.len() - 1;
    divide(grid, block, lower, two_d);
    divide(grid, upper, parts - lower, two_d);
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
