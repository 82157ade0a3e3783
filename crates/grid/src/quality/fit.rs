//! Do the blocks fit: interfaces whose nodes are apart, face cells with no owner or with two.

use super::Finding;
use crate::block::Block;
use crate::connect::shortest_edge;
use crate::face::Face;
use crate::topology::{Interface, MultiBlock, Side};
use crate::vector::distance;

/// Nodes that an interface says are one and that lie further apart than this share of the shortest edge there are not.
const APART: f64 = 0.1;

/// Distance between nodes an interface says are one: against the edges there, and against what round-off explains.
pub(super) fn interface_findings(grid: &MultiBlock, findings: &mut Vec<Finding>) {
    let [lo, hi] = grid.bounds();
    let round_off = distance(lo, hi) * if is_single(grid) { 2e-7 } else { 1e-9 };
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
        let Some(gap) = widest_gap(grid, interface) else {
            continue;
        };
        let fatal = gap.share.is_nan() || gap.share > APART;
        if fatal || gap.width > round_off {
            let [x, y, z] = gap.at;
            let text = format!("{what}: nodes are {:.3e} apart at ({x:.6}, {y:.6}, {z:.6})", gap.width);
            findings.push(Finding { fatal, text });
        }
    }
}

/// The widest gap between two nodes that are to be one.
struct Gap {
    width: f64,
    /// Over the shortest edge there.
    share: f64,
    at: [f64; 3],
}

fn widest_gap(grid: &MultiBlock, interface: &Interface) -> Option<Gap> {
    let (a, b) = (grid.blocks.get(interface.a.block)?, grid.blocks.get(interface.b.block)?);
    let mut worst: Option<Gap> = None;
    let w = interface.a.window;
    for q in w.lo[1]..=w.hi[1] {
        for p in w.lo[0]..=w.hi[0] {
            let at = a.point_at(a.node_behind(interface.a.face, p, q, 0));
            let [r, s] = interface.node_on_b(p, q);
            let pb = b.point_at(b.node_behind(interface.b.face, r, s, 0));
            let width = distance(interface.period.map_or(at, |period| period.moved(at)), pb);
            if width == 0.0 {
                continue;
            }
            let share = width / shortest_edge(a, interface.a.face, p, q);
            if worst.as_ref().is_none_or(|w| share > w.share || share.is_nan()) {
                worst = Some(Gap { width, share, at });
            }
        }
    }
    worst
}

/// True if every coordinate is one of single precision: then round-off is that of single precision.
fn is_single(grid: &MultiBlock) -> bool {
    let single = |v: &f64| f64::from(*v as f32) == *v;
    let of = |b: &Block| [&b.x, &b.y, &b.z].into_iter().flatten().all(single);
    grid.blocks.iter().all(of)
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
