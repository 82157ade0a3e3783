//! Renumbers the nodes of a block in place, with everything that refers to it.

use crate::face::{Face, Window};
use crate::topology::{MultiBlock, Orientation, Side};

/// Renumbers block `block`: its new index direction `d` runs along the old direction `axes[d]`, backwards where
/// `reverse[d]`. Interfaces and patches follow; the geometry stays.
pub fn reorient(grid: &mut MultiBlock, block: usize, axes: [usize; 3], reverse: [bool; 3]) {
    let cells = grid.blocks[block].cells();
    grid.blocks[block] = grid.blocks[block].reoriented(axes, reverse);
    for patch in &mut grid.topology.patches {
        if patch.block == block {
            let (side, _) = renumbered(patch.side(), cells, axes, reverse);
            patch.face = side.face;
            patch.window = side.window;
        }
    }
    for interface in &mut grid.topology.interfaces {
        if interface.a.block == block {
            let (side, turn) = renumbered(interface.a, cells, axes, reverse);
            interface.a = side;
            interface.orientation = turn.inverse().then(interface.orientation);
        }
        if interface.b.block == block {
            let (side, turn) = renumbered(interface.b, cells, axes, reverse);
            interface.b = side;
            interface.orientation = interface.orientation.then(turn);
        }
    }
}

/// Turns a left-handed block right-handed by running k backwards.
pub fn turn_right_handed(grid: &mut MultiBlock, block: usize) {
    reorient(grid, block, [0, 1, 2], [false, false, true]);
}

/// The side in the new numbering and the orientation from the old window to the new one. `cells` are the block's
/// cells in the old numbering.
fn renumbered(side: Side, cells: [usize; 3], axes: [usize; 3], reverse: [bool; 3]) -> (Side, Orientation) {
    let new_axis = |old: usize| (0..3).find(|&d| axes[d] == old).unwrap_or(old);
    let normal = new_axis(side.face.axis());
    let face = Face::new(normal, side.face.is_max() != reverse[normal]);
    let old = side.face.directions();
    let new = face.directions();
    let swap = new_axis(old[0]) != new[0];
    let turn = Orientation {
        swap,
        reverse: new.map(|d| reverse[d]),
    };
    let mut window = Window { lo: [0; 2], hi: [0; 2] };
    for d in 0..2 {
        let from = if swap { 1 - d } else { d };
        let n = cells[old[from]];
        let (lo, hi) = (side.window.lo[from], side.window.hi[from]);
        (window.lo[d], window.hi[d]) = if reverse[new[d]] { (n - hi, n - lo) } else { (lo, hi) };
    }
    (
        Side {
            block: side.block,
            face,
            window,
        },
        turn,
    )
}
