//! Do the blocks of a grid fit?

use dip_grid::vector::{norm, sub};
use dip_grid::{Face, MultiBlock};

/// Interfaces join equal nodes (up to the translation), every face cell is on one patch or interface.
pub fn assert_fits(grid: &MultiBlock) {
    for interface in &grid.topology.interfaces {
        let (a, b) = (&grid.blocks[interface.a.block], &grid.blocks[interface.b.block]);
        assert_eq!(
            interface.orientation.size(interface.a.window.size()),
            interface.b.window.size()
        );
        for q in interface.a.window.lo[1]..=interface.a.window.hi[1] {
            for p in interface.a.window.lo[0]..=interface.a.window.hi[0] {
                let pa = a.point_at(a.node_behind(interface.a.face, p, q, 0));
                let [pb, qb] = interface.node_on_b(p, q);
                let pb = b.point_at(b.node_behind(interface.b.face, pb, qb, 0));
                match interface.period {
                    None => assert_eq!(pa, pb),
                    Some(by) => assert!(norm(sub(pb, by.moved(pa))) < 1e-14),
                }
            }
        }
    }
    for (n, block) in grid.blocks.iter().enumerate() {
        for face in Face::ALL {
            let [np, nq] = block.face_cells(face);
            let mut seen = vec![0; np * nq];
            let sides = grid.topology.patches.iter().map(dip_grid::Patch::side);
            let ends = grid.topology.interfaces.iter().flat_map(|i| [i.a, i.b]);
            for side in sides.chain(ends).filter(|s| s.block == n && s.face == face) {
                for q in side.window.lo[1]..side.window.hi[1] {
                    for p in side.window.lo[0]..side.window.hi[0] {
                        seen[p + np * q] += 1;
                    }
                }
            }
            assert!(seen.iter().all(|&s| s == 1), "block {n} {face}");
        }
    }
}
