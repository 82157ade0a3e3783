//! Who lies beside whom: ghost cells that copy cells of other blocks, and couplings of the matrices.

use dip_grid::{Interface, Orientation, Side};
use dip_krylov::Coupling;

use super::{GHOSTS, Level};

/// A ghost cell and the cell it is a copy of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GhostLink {
    /// Ghost cell's place in its block.
    pub ghost: u32,
    /// Block of the cell.
    pub block: u32,
    /// The cell's place in that block.
    pub cell: u32,
}

/// Where an interface's windows lie: needed to make coarser levels.
#[derive(Clone, Debug)]
pub(super) struct Joint {
    pub(super) a: Side,
    pub(super) b: Side,
    pub(super) orientation: Orientation,
}

impl Joint {
    /// The interface from either of its sides.
    fn both_ways(&self) -> [Interface; 2] {
        let there = Interface {
            a: self.a,
            b: self.b,
            orientation: self.orientation,
            period: None,
        };
        let back = there.reversed();
        [there, back]
    }
}

impl Level {
    /// Finds the cells behind every interface.
    pub(super) fn link(&mut self) {
        let mut links = vec![Vec::new(); self.blocks.len()];
        for joint in &self.joints {
            for one in joint.both_ways() {
                let (layout_a, layout_b) = (self.blocks[one.a.block].layout, self.blocks[one.b.block].layout);
                let deep = layout_b.cells[one.b.face.axis()];
                for q in one.a.window.lo[1]..one.a.window.hi[1] {
                    for p in one.a.window.lo[0]..one.a.window.hi[0] {
                        let [pb, qb] = one.cell_on_b(p, q);
                        for layer in 0..GHOSTS {
                            let ghost = layout_a.behind(one.a.face, p, q, -1 - layer as isize);
                            // A neighbour one cell thick has nothing behind: its only cell stands for both layers.
                            let cell = layout_b.behind(one.b.face, pb, qb, layer.min(deep - 1) as isize);
                            links[one.a.block].push(GhostLink {
                                ghost: ghost as u32,
                                block: one.b.block as u32,
                                cell: cell as u32,
                            });
                        }
                    }
                }
            }
        }
        self.links = links;
    }

    /// Which cells of other blocks (or of the other end of the same one) the outermost cells touch.
    #[must_use]
    pub fn couplings(&self) -> Vec<Coupling> {
        let mut out = Vec::new();
        for joint in &self.joints {
            for one in joint.both_ways() {
                let (a, b) = (&self.blocks[one.a.block], &self.blocks[one.b.block]);
                let place = |cells: [usize; 3], [i, j, k]: [usize; 3]| i + cells[0] * (j + cells[1] * k);
                if one.a.face.axis() == 2 && a.layout.cells[2] == 1 {
                    // The matrix of a block one cell thick has no places along k.
                    continue;
                }
                for q in one.a.window.lo[1]..one.a.window.hi[1] {
                    for p in one.a.window.lo[0]..one.a.window.hi[0] {
                        let [pb, qb] = one.cell_on_b(p, q);
                        let cell = place(a.layout.cells, one.a.face.ijk(a.layout.cells, p, q, 0));
                        let other = place(b.layout.cells, one.b.face.ijk(b.layout.cells, pb, qb, 0));
                        out.push(Coupling {
                            block: one.a.block as u32,
                            cell: cell as u32,
                            direction: one.a.face.axis() as u8,
                            upper: one.a.face.is_max(),
                            neighbour: (b.offset + other) as u32,
                        });
                    }
                }
            }
        }
        out
    }
}
