//! Do the blocks fit: interfaces whose nodes are apart, face cells with no owner or with two.

use super::Finding;
use crate::face::Face;
use crate::topology::{MultiBlock, Side};
use crate::vector::distance;

/// Distance between nodes an interface says are one, relative to the cells there.
pub(super) fn interface_findings(grid: &MultiBlock, findings: &mut Vec<Finding>) {
    for (n, interface) in grid.topology.interfaces.iter().enumerate() {
        let what = format!(
            "interface {} between {} and {}",
            n,
            name_side(grid, interface.a),
            name_side(grid, interface.b)
        );
        let valid = |s: Side| {
            grid.blocks.get(s.block).is_some_and(|b| {
                let c = b.face_cells(s.face);
                (0..2).all(|d| s.window.lo[d] < s.window.hi[d] && s.window.hi[d] <= c[d])
            })
        };
        if !valid(interface.a) || !valid(interface.b) {
            findings.push(Finding {
                fatal: true,
                text: format!("{what}: a window does not lie on its face"),
            });
            continue;
        }
        if interface.orientation.size(interface.a.window.size()) != interface.b.window.size() {
            findings.push(Finding {
                fatal: true,
                text: format!("{what}: the windows have different sizes"),
            });
            continue;
        }
        let (a, b) = (&grid.blocks[interface.a.block], &grid.blocks[interface.b.block]);
        let mut worst = (0.0, [0.0; 3]);
        let w = interface.a.window;
        for q in w.lo[1]..=w.hi[1] {
            for p in w.lo[0]..=w.hi[0] {
                let pa = a.point_at(a.node_behind(interface.a.face, p, q, 0));
                let [r, s] = interface.node_on_b(p, q);
                let pb = b.point_at(b.node_behind(interface.b.face, r, s, 0));
                let gap = distance(interface.period.map_or(pa, |period| period.moved(pa)), pb);
                if gap > worst.0 || gap.is_nan() {
                    worst = (gap, pa);
                }
            }
        }
        let [lo, hi] = grid.bounds();
        if worst.0.is_nan() || worst.0 > 1e-9 * distance(lo, hi) {
            let [x, y, z] = worst.1;
            let text = format!("{what}: nodes are {:.3e} apart at ({x:.6}, {y:.6}, {z:.6})", worst.0);
            findings.push(Finding { fatal: true, text });
        }
    }
}

/// Every face cell must be on one patch or one interface.
pub(super) fn cover_findings(grid: &MultiBlock, findings: &mut Vec<Finding>) {
    let mut sides: Vec<(Side, String)> = Vec::new();
    for patch in &grid.topology.patches {
        sides.push((patch.side(), format!("patch {}", patch.name)));
    }
    for (n, interface) in grid.topology.interfaces.iter().enumerate() {
        sides.push((interface.a, format!("interface {n}")));
        sides.push((interface.b, format!("interface {n}")));
    }
    for (n, block) in grid.blocks.iter().enumerate() {
        for face in Face::ALL {
            let [np, nq] = block.face_cells(face);
            let mut owner = vec![usize::MAX; np * nq];
            let mut overlap = None;
            for (m, (side, _)) in sides
                .iter()
                .enumerate()
                .filter(|(_, (s, _))| s.block == n && s.face == face)
            {
                for q in side.window.lo[1]..side.window.hi[1].min(nq) {
                    for p in side.window.lo[0]..side.window.hi[0].min(np) {
                        let old = std::mem::replace(&mut owner[p + np * q], m);
                        if old != usize::MAX && overlap.is_none() {
                            overlap = Some((old, m, p, q));
                        }
                    }
                }
            }
            if let Some((old, new, p, q)) = overlap {
                let text = format!(
                    "block {n} ({}) {face}: {} and {} overlap, first at face cell ({p}, {q}); a face cell belongs to one",
                    block.name, sides[old].1, sides[new].1
                );
                findings.push(Finding { fatal: true, text });
            }
            let free = owner.iter().filter(|&&o| o == usize::MAX).count();
            if free > 0 {
                let first = owner.iter().position(|&o| o == usize::MAX).unwrap_or(0);
                let text = format!(
                    "block {n} ({}) {face}: {free} of {} face cells have no condition and no neighbour, first ({}, {}); a .bc.toml or \
                     .nmf beside the grid gives conditions",
                    block.name,
                    np * nq,
                    first % np,
                    first / np
                );
                findings.push(Finding { fatal: true, text });
            }
        }
    }
}

fn name_side(grid: &MultiBlock, side: Side) -> String {
    let name = grid.blocks.get(side.block).map_or("?", |b| b.name.as_str());
    format!("block {} ({name}) {} {}", side.block, side.face, side.window)
}
