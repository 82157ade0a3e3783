//! From which ends the blocks are swept by the factors of the preconditioner, and which comes first.
//!
//! A sweep carries a wave across an interface if one block is swept towards it and the next one away from it. That cannot be so
//! at every interface: over a C grid the blocks on both sides of the wake cut begin at the cut. The strongest
//! interfaces come first, by the part that their faces have in the surface of the cells beside them: where cells are
//! long and flat, nearly all of a cell's coupling is to its neighbours across the flat side.

use dip_grid::{Face, Side};
use dip_krylov::Sweep;

use super::Level;
use super::links::Joint;

/// Ends of a block's axis: their sweep's sense relative to that of the first one of the tree.
struct Senses {
    /// Parent of each axis of each block, and whether it is swept the other way.
    parent: Vec<(usize, bool)>,
}

impl Senses {
    /// First axis of the tree, and whether `n` is swept the other way.
    fn root(&self, mut n: usize) -> (usize, bool) {
        let mut other = false;
        while self.parent[n].0 != n {
            other ^= self.parent[n].1;
            n = self.parent[n].0;
        }
        (n, other)
    }

    /// Asks that `a` and `b` be swept alike, or opposite; false if they already are not.
    fn join(&mut self, a: usize, b: usize, opposite: bool) -> bool {
        let ((root_a, a), (root_b, b)) = (self.root(a), self.root(b));
        if root_a == root_b {
            return (a ^ b) == opposite;
        }
        let (low, high) = (root_a.min(root_b), root_a.max(root_b));
        self.parent[high] = (low, a ^ b ^ opposite);
        true
    }
}

impl Level {
    /// Sweeps for blocks joined by `joints`.
    pub(super) fn choose_sweeps(&self) -> Vec<Sweep> {
        let mut joints: Vec<(f64, &Joint)> = self.joints.iter().map(|j| (self.strength(j), j)).collect();
        // Stable: of equal strengths the first comes first.
        joints.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut senses = Senses {
            parent: (0..3 * self.blocks.len()).map(|n| (n, false)).collect(),
        };
        let axis = |side: &Side| 3 * side.block + side.face.axis();
        let kept: Vec<&(f64, &Joint)> = joints
            .iter()
            .filter(|(_, j)| senses.join(axis(&j.a), axis(&j.b), j.a.face.is_max() == j.b.face.is_max()))
            .collect();
        let reversed = |block: usize, axis: usize| senses.root(3 * block + axis).1;
        // Which block comes first: the one whose sweep ends at the interface.
        let ends_at = |block: usize, face: Face| reversed(block, face.axis()) != face.is_max();
        let mut first: Vec<(usize, usize, f64)> = Vec::new();
        for (strength, j) in kept {
            let (a, b) = (j.a.block, j.b.block);
            if a != b {
                let (from, to) = if ends_at(a, j.a.face) { (a, b) } else { (b, a) };
                first.push((from, to, *strength));
            }
        }
        let ranks = ranks(self.blocks.len(), &first);
        (0..self.blocks.len())
            .map(|b| Sweep {
                rank: ranks[b],
                reversed: [0, 1, 2].map(|d| reversed(b, d)),
            })
            .collect()
    }

    /// Part that the faces of an interface have in the surface of the cells on both sides, mean over them.
    fn strength(&self, joint: &Joint) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for side in [&joint.a, &joint.b] {
            let block = &self.blocks[side.block];
            for q in side.window.lo[1]..side.window.hi[1] {
                for p in side.window.lo[0]..side.window.hi[0] {
                    let cell = side.face.ijk(block.layout.cells, p, q, 0);
                    let area = [0, 1, 2].map(|d| {
                        let set = &block.faces[d];
                        let mut above = cell;
                        above[d] += 1;
                        let at = |[i, j, k]: [usize; 3]| set.area[set.at(i, j, k)];
                        // Two-dimensional flow knows no faces along k.
                        if block.layout.ghosts[d] > 0 {
                            at(cell) + at(above)
                        } else {
                            0.0
                        }
                    });
                    let whole: f64 = area.iter().sum();
                    if whole > 0.0 {
                        sum += area[side.face.axis()] / whole;
                    }
                    count += 1.0;
                }
            }
        }
        if count > 0.0 { sum / count } else { 0.0 }
    }
}

/// Ranks that put `first.0` before `first.1`. In a ring of blocks one has to come first all the same: that which asks least
/// for others before it.
fn ranks(blocks: usize, first: &[(usize, usize, f64)]) -> Vec<usize> {
    let mut ranks = vec![usize::MAX; blocks];
    for rank in 0..blocks {
        let mut best: Option<(f64, usize)> = None;
        for block in (0..blocks).filter(|b| ranks[*b] == usize::MAX) {
            let asked = first
                .iter()
                .filter(|(from, to, _)| *to == block && ranks[*from] == usize::MAX);
            // The empty sum of floating-point numbers is -0.
            let sum = asked.map(|(_, _, strength)| strength).sum::<f64>().abs();
            if best.is_none_or(|(least, _)| sum < least) {
                best = Some((sum, block));
            }
        }
        if let Some((_, block)) = best {
            ranks[block] = rank;
        }
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_of_blocks_begins_where_it_is_weakest() {
        let ring = [(0, 1, 0.5), (1, 2, 0.2), (2, 0, 0.9)];
        assert_eq!(ranks(3, &ring), [1, 2, 0]);
    }

    #[test]
    fn an_axis_asked_for_both_senses_keeps_the_first() {
        let mut senses = Senses {
            parent: (0..3).map(|n| (n, false)).collect(),
        };
        assert!(senses.join(0, 1, true));
        assert!(senses.join(2, 1, false));
        assert!(!senses.join(2, 0, false));
        assert!(senses.join(2, 0, true));
        assert_eq!(senses.root(2), (0, true));
    }
}
