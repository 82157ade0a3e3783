//! A grid as the flow solver sees it: sizes with ghost cells, face normals, volumes, and who lies beside whom.
//!
//! A coarse level is made by merging cells of a finer one (2 x 2 x 2 where the dimensions allow): area vectors and
//! volumes are summed, so that every level is closed to round-off and needs no nodes.

mod coarser;
mod links;
mod sweeps;

use dip_grid::{Condition, Face, Metrics, MultiBlock, Window};
use dip_krylov::Sweep;

use crate::error::FlowError;

pub use coarser::CellMap;
pub use links::GhostLink;
use links::Joint;

/// Layers of ghost cells.
pub const GHOSTS: usize = 2;

/// Indexing of a block with its ghost cells.
///
/// A field is a structure of arrays: variable `v` of all cells, ghost cells included, follows variable `v - 1`; i is
/// fastest. A planar block (one cell across between symmetry planes) has no ghost cells along k.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Cells along i, j, k, without ghosts.
    pub cells: [usize; 3],
    /// Ghost layers along i, j, k at each end.
    pub ghosts: [usize; 3],
    /// Distance of neighbours along i, j, k.
    pub stride: [usize; 3],
    /// Cells with ghosts: length of one variable.
    pub size: usize,
}

impl Layout {
    /// Layout of a block of `cells`; `planar` blocks have no ghosts along k.
    #[must_use]
    pub fn new(cells: [usize; 3], planar: bool) -> Self {
        let ghosts = [GHOSTS, GHOSTS, if planar { 0 } else { GHOSTS }];
        let full = [0, 1, 2].map(|d| cells[d] + 2 * ghosts[d]);
        Self {
            cells,
            ghosts,
            stride: [1, full[0], full[0] * full[1]],
            size: full[0] * full[1] * full[2],
        }
    }

    /// Cells without ghosts.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.cells.iter().product()
    }

    /// Place of cell (i, j, k) in one variable.
    #[inline(always)]
    #[must_use]
    pub fn at(&self, i: usize, j: usize, k: usize) -> usize {
        (i + self.ghosts[0]) + (j + self.ghosts[1]) * self.stride[1] + (k + self.ghosts[2]) * self.stride[2]
    }

    /// Place of the cell of face cell `(p, q)`, `depth` layers inside the block; negative depths are ghost layers.
    #[inline(always)]
    #[must_use]
    pub fn behind(&self, face: Face, p: usize, q: usize, depth: isize) -> usize {
        let [i, j, k] = face.ijk(self.cells, p, q, 0);
        let from = self.at(i, j, k) as isize;
        let step = self.stride[face.axis()] as isize;
        (from + if face.is_max() { -depth * step } else { depth * step }) as usize
    }
}

/// Faces normal to one index direction: unit normals towards increasing index, and areas. Faces along the direction
/// number one more than cells; i fastest. A face without area has a zero normal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaceSet {
    /// Faces along i, j, k.
    pub count: [usize; 3],
    /// Unit normals, x, y, z.
    pub normal: [Vec<f64>; 3],
    /// Areas.
    pub area: Vec<f64>,
    /// Speed of each face along its normal; empty on a grid at rest.
    pub speed: Vec<f64>,
}

impl FaceSet {
    fn from_vectors(count: [usize; 3], vectors: &[Vec<f64>; 3], sign: f64) -> Self {
        let n = count.iter().product();
        let mut set = Self {
            count,
            normal: [vec![0.0; n], vec![0.0; n], vec![0.0; n]],
            area: vec![0.0; n],
            speed: Vec::new(),
        };
        let [x, y, z] = vectors;
        for (f, ((x, y), z)) in x.iter().zip(y).zip(z).enumerate() {
            set.set_vector(f, [sign * x, sign * y, sign * z]);
        }
        set
    }

    /// Place of face (i, j, k).
    #[inline(always)]
    #[must_use]
    pub fn at(&self, i: usize, j: usize, k: usize) -> usize {
        i + self.count[0] * (j + self.count[1] * k)
    }

    /// Sets normal and area of a face from its area vector.
    pub fn set_vector(&mut self, f: usize, s: [f64; 3]) {
        let area = (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]).sqrt();
        self.area[f] = area;
        for (normal, s) in self.normal.iter_mut().zip(s) {
            normal[f] = if area > 0.0 { s / area } else { 0.0 };
        }
    }

    /// Unit normal of a face.
    #[inline(always)]
    #[must_use]
    pub fn unit(&self, f: usize) -> [f64; 3] {
        [self.normal[0][f], self.normal[1][f], self.normal[2][f]]
    }

    /// Area vector of a face.
    #[must_use]
    pub fn vector(&self, f: usize) -> [f64; 3] {
        self.unit(f).map(|n| n * self.area[f])
    }

    /// Speed of a face along its normal.
    #[inline(always)]
    #[must_use]
    pub fn face_speed(&self, f: usize) -> f64 {
        if self.speed.is_empty() { 0.0 } else { self.speed[f] }
    }
}

/// One block of a level.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelBlock {
    /// Name, for messages.
    pub name: String,
    /// Indexing.
    pub layout: Layout,
    /// Faces normal to i, j, k.
    pub faces: [FaceSet; 3],
    /// Cell volumes, `[k][j][i]`.
    pub volume: Vec<f64>,
    /// First cell of the block in vectors over the whole level.
    pub offset: usize,
}

/// Part of the boundary.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LevelPatch {
    /// Name; patches of one surface share it.
    pub name: String,
    /// Block.
    pub block: usize,
    /// Side of the block.
    pub face: Face,
    /// Cells of the side.
    pub window: Window,
    /// What the grid says holds there.
    pub condition: Condition,
}

/// One level of the grid.
#[derive(Clone, Debug)]
pub struct Level {
    /// Blocks.
    pub blocks: Vec<LevelBlock>,
    /// Ghost cells that copy other cells, by the block they belong to.
    pub links: Vec<Vec<GhostLink>>,
    /// Boundary patches.
    pub patches: Vec<LevelPatch>,
    /// True if the grid is one cell across with nothing happening along k.
    pub planar: bool,
    /// Cells of all blocks.
    pub cell_count: usize,
    /// How the preconditioner sweeps the blocks: that of the grid as it was read, also when it has moved.
    pub sweeps: Vec<Sweep>,
    joints: Vec<Joint>,
}

impl Level {
    /// The finest level: metrics of `grid`.
    ///
    /// # Errors
    /// If the grid has no block, a block has mixed or zero volumes, or a side is not wholly covered.
    pub fn new(grid: &MultiBlock) -> Result<Self, FlowError> {
        if grid.blocks.is_empty() {
            return Err(FlowError::Grid {
                what: "the grid has no block".to_owned(),
            });
        }
        let planar = grid.is_two_dimensional();
        let mut blocks = Vec::with_capacity(grid.blocks.len());
        let mut offset = 0;
        for block in &grid.blocks {
            let metrics = Metrics::new(block);
            // A left-handed block has all signs turned: normals towards increasing index all the same.
            let sign = if metrics.volume.iter().sum::<f64>() < 0.0 {
                -1.0
            } else {
                1.0
            };
            let volume: Vec<f64> = metrics.volume.iter().map(|v| sign * v).collect();
            if let Some(cell) = volume.iter().position(|v| !(*v > 0.0 && v.is_finite())) {
                return Err(FlowError::Volume {
                    block: block.name.clone(),
                    ijk: block.cell_ijk(cell),
                    volume: volume[cell],
                });
            }
            let [ni, nj, nk] = block.cells();
            let layout = Layout::new(block.cells(), planar);
            if layout.size > u32::MAX as usize {
                return Err(FlowError::Grid {
                    what: format!(
                        "block `{}` has {} cells; split it into blocks of less than 4e9",
                        block.name, layout.size
                    ),
                });
            }
            blocks.push(LevelBlock {
                name: block.name.clone(),
                layout,
                faces: [
                    FaceSet::from_vectors([ni + 1, nj, nk], &metrics.si, sign),
                    FaceSet::from_vectors([ni, nj + 1, nk], &metrics.sj, sign),
                    FaceSet::from_vectors([ni, nj, nk + 1], &metrics.sk, sign),
                ],
                volume,
                offset,
            });
            offset += block.cell_count();
        }
        let patches = grid
            .topology
            .patches
            .iter()
            .map(|p| LevelPatch {
                name: p.name.clone(),
                block: p.block,
                face: p.face,
                window: p.window,
                condition: p.condition,
            })
            .collect();
        let joints = grid
            .topology
            .interfaces
            .iter()
            .map(|i| Joint {
                a: i.a,
                b: i.b,
                orientation: i.orientation,
            })
            .collect();
        let mut level = Self {
            blocks,
            links: Vec::new(),
            patches,
            planar,
            cell_count: offset,
            sweeps: Vec::new(),
            joints,
        };
        level.check_coverage()?;
        level.link();
        level.sweeps = level.choose_sweeps();
        Ok(level)
    }

    /// Every face cell must be on exactly one patch or interface.
    fn check_coverage(&self) -> Result<(), FlowError> {
        for (b, block) in self.blocks.iter().enumerate() {
            for face in Face::ALL {
                if self.planar && face.axis() == 2 {
                    continue;
                }
                let [d0, d1] = face.directions();
                let size = [block.layout.cells[d0], block.layout.cells[d1]];
                let mut seen = vec![0_u8; size[0] * size[1]];
                let sides = self
                    .joints
                    .iter()
                    .flat_map(|j| [&j.a, &j.b])
                    .map(|s| (s.block, s.face, s.window));
                let patches = self.patches.iter().map(|p| (p.block, p.face, p.window));
                for (_, _, window) in sides.chain(patches).filter(|(n, f, _)| *n == b && *f == face) {
                    if window.hi[0] > size[0] || window.hi[1] > size[1] {
                        return Err(FlowError::Grid {
                            what: format!(
                                "block `{}`, {face}: {window} reach beyond the side's {size:?} cells",
                                block.name
                            ),
                        });
                    }
                    for q in window.lo[1]..window.hi[1] {
                        for p in window.lo[0]..window.hi[0] {
                            seen[p + size[0] * q] += 1;
                        }
                    }
                }
                if let Some(n) = seen.iter().position(|s| *s != 1) {
                    return Err(FlowError::Uncovered {
                        block: block.name.clone(),
                        face: face.name(),
                        cell: [n % size[0], n / size[0]],
                        times: seen[n] as usize,
                    });
                }
            }
        }
        Ok(())
    }
}
