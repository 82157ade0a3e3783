//! Numbers for points: equal points have one.

use std::collections::HashMap;

use crate::block::Block;
use crate::face::Face;
use crate::vector::distance;

/// Points with numbers; points nearer than the tolerance share one.
pub(super) struct Points {
    cells: HashMap<[i64; 3], Vec<u32>>,
    at: Vec<[f64; 3]>,
    tolerance: f64,
}

impl Points {
    /// No points yet.
    pub(super) fn new(tolerance: f64) -> Self {
        Self {
            cells: HashMap::new(),
            at: Vec::new(),
            tolerance,
        }
    }

    /// The number of point `p`, where an equal point must not be further than `most` either.
    pub(super) fn number(&mut self, p: [f64; 3], most: f64) -> u32 {
        let tolerance = self.tolerance.min(most);
        let width = 4.0 * self.tolerance;
        let scaled = p.map(|v| v / width);
        let home = scaled.map(|v| v.floor() as i64);
        // Only boxes within the tolerance of p can hold its equal: most often that is its own alone.
        let near = |d: usize| {
            let part = scaled[d] - home[d] as f64;
            (if part < 0.25 { -1 } else { 0 })..=(if part > 0.75 { 1 } else { 0 })
        };
        for dz in near(2) {
            for dy in near(1) {
                for dx in near(0) {
                    let Some(list) = self.cells.get(&[home[0] + dx, home[1] + dy, home[2] + dz]) else {
                        continue;
                    };
                    for &n in list {
                        if distance(self.at[n as usize], p) <= tolerance {
                            return n;
                        }
                    }
                }
            }
        }
        let n = self.at.len() as u32;
        self.at.push(p);
        self.cells.entry(home).or_default().push(n);
        n
    }
}

/// Shortest edge at a face node, in the face and into the block; edges of no length do not count.
pub(crate) fn shortest_edge(block: &Block, face: Face, p: usize, q: usize) -> f64 {
    let [np, nq] = block.face_cells(face);
    let here = block.point_at(block.node_behind(face, p, q, 0));
    let others = [
        (p > 0).then(|| block.node_behind(face, p - 1, q, 0)),
        (p < np).then(|| block.node_behind(face, p + 1, q, 0)),
        (q > 0).then(|| block.node_behind(face, p, q - 1, 0)),
        (q < nq).then(|| block.node_behind(face, p, q + 1, 0)),
        Some(block.node_behind(face, p, q, 1)),
    ];
    others
        .into_iter()
        .flatten()
        .map(|ijk| distance(here, block.point_at(ijk)))
        .filter(|&d| d > 0.0)
        .fold(f64::INFINITY, f64::min)
}
