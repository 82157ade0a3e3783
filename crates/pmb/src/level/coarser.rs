//! Coarse levels: cells merged in pairs along every direction that allows it.

use dip_grid::{Face, Window};

use super::links::Joint;
use super::{FaceSet, Layout, Level, LevelBlock, LevelPatch};

impl Level {
    /// A level with cells merged in pairs along every direction that allows it, and the map of cells to it; `None`
    /// where no direction does. Directions of blocks that touch are merged together or not at all.
    #[must_use]
    pub fn coarser(&self) -> Option<(Self, CellMap)> {
        let merge = self.mergeable();
        if !merge.iter().flatten().any(|m| *m) {
            return None;
        }
        let mut blocks = Vec::with_capacity(self.blocks.len());
        let mut parents = Vec::with_capacity(self.cell_count);
        let mut offset = 0;
        for (block, merge) in self.blocks.iter().zip(&merge) {
            let coarse = merged_block(block, *merge, offset, self.planar);
            let step = merge.map(|m| if m { 2 } else { 1 });
            let [ni, nj, nk] = block.layout.cells;
            let [ci, cj, _] = coarse.layout.cells;
            for k in 0..nk {
                for j in 0..nj {
                    for i in 0..ni {
                        parents.push((offset + i / step[0] + ci * (j / step[1] + cj * (k / step[2]))) as u32);
                    }
                }
            }
            offset += coarse.layout.cell_count();
            blocks.push(coarse);
        }
        let half = |block: usize, face: Face, window: &Window| {
            let mut out = *window;
            for (n, d) in face.directions().into_iter().enumerate() {
                if merge[block][d] {
                    out.lo[n] /= 2;
                    out.hi[n] /= 2;
                }
            }
            out
        };
        let side = |s: &dip_grid::Side| dip_grid::Side {
            window: half(s.block, s.face, &s.window),
            ..*s
        };
        let patches = self
            .patches
            .iter()
            .map(|p| LevelPatch {
                window: half(p.block, p.face, &p.window),
                ..p.clone()
            })
            .collect();
        let joints = self
            .joints
            .iter()
            .map(|j| Joint {
                a: side(&j.a),
                b: side(&j.b),
                orientation: j.orientation,
            })
            .collect();
        let mut level = Self {
            blocks,
            links: Vec::new(),
            patches,
            planar: self.planar,
            cell_count: offset,
            sweeps: self.sweeps.clone(),
            joints,
        };
        level.link();
        let merge_of_block = merge;
        Some((
            level,
            CellMap {
                parents,
                merge: merge_of_block,
            },
        ))
    }

    /// Which directions of which blocks can be merged.
    fn mergeable(&self) -> Vec<[bool; 3]> {
        // At least four cells must stay for the scheme to have its neighbours.
        const LEAST: usize = 4;
        let mut can: Vec<[bool; 3]> = self
            .blocks
            .iter()
            .map(|b| {
                [0, 1, 2]
                    .map(|d| b.layout.cells[d] % 2 == 0 && b.layout.cells[d] >= 2 * LEAST && b.layout.ghosts[d] > 0)
            })
            .collect();
        let mut refuse = |block: usize, face: Face, window: &Window| {
            for (n, d) in face.directions().into_iter().enumerate() {
                if !window.lo[n].is_multiple_of(2) || !window.hi[n].is_multiple_of(2) {
                    can[block][d] = false;
                }
            }
        };
        for p in &self.patches {
            refuse(p.block, p.face, &p.window);
        }
        for j in &self.joints {
            refuse(j.a.block, j.a.face, &j.a.window);
            refuse(j.b.block, j.b.face, &j.b.window);
        }
        // Directions that touch share their fate; repeated until nothing changes.
        loop {
            let mut changed = false;
            for j in &self.joints {
                let (da, db) = (j.a.face.directions(), j.b.face.directions());
                for n in 0..2 {
                    let m = if j.orientation.swap { 1 - n } else { n };
                    let both = can[j.a.block][da[n]] && can[j.b.block][db[m]];
                    for (block, d) in [(j.a.block, da[n]), (j.b.block, db[m])] {
                        if can[block][d] != both {
                            can[block][d] = both;
                            changed = true;
                        }
                    }
                }
            }
            if !changed {
                return can;
            }
        }
    }
}

/// Where the cells of a level went in the next coarser one.
#[derive(Clone, Debug)]
pub struct CellMap {
    /// Coarse cell of every fine cell (places in vectors over the whole level).
    pub parents: Vec<u32>,
    /// Directions that were merged, by block.
    pub merge: Vec<[bool; 3]>,
}

fn merged_block(block: &LevelBlock, merge: [bool; 3], offset: usize, planar: bool) -> LevelBlock {
    let step = merge.map(|m| if m { 2 } else { 1 });
    let cells = [0, 1, 2].map(|d| block.layout.cells[d] / step[d]);
    let layout = Layout::new(cells, planar);
    let mut volume = vec![0.0; layout.cell_count()];
    let [ni, nj, nk] = block.layout.cells;
    let mut fine = block.volume.iter();
    for k in 0..nk {
        for j in 0..nj {
            for i in 0..ni {
                volume[i / step[0] + cells[0] * (j / step[1] + cells[1] * (k / step[2]))] +=
                    fine.next().copied().unwrap_or(0.0);
            }
        }
    }
    let faces = [0, 1, 2].map(|d| {
        let mut count = cells;
        count[d] += 1;
        let n: usize = count.iter().product();
        let mut vectors = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        let set = &block.faces[d];
        let mut f = 0;
        for k in 0..set.count[2] {
            for j in 0..set.count[1] {
                for i in 0..set.count[0] {
                    let index = [i, j, k];
                    // Faces inside a merged pair vanish.
                    if index[d] % step[d] == 0 {
                        let [a, b, c] = [0, 1, 2].map(|e| index[e] / step[e]);
                        let to = a + count[0] * (b + count[1] * c);
                        for (v, s) in vectors.iter_mut().zip(set.vector(f)) {
                            v[to] += s;
                        }
                    }
                    f += 1;
                }
            }
        }
        FaceSet::from_vectors(count, &vectors, 1.0)
    });
    LevelBlock {
        name: block.name.clone(),
        layout,
        faces,
        volume,
        offset,
    }
}
