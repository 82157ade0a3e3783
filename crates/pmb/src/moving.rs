//! A grid whose nodes move: metrics at every time level, and the volumes that its faces sweep.
//!
//! Between two time levels nodes move along straight lines, so the volume a face sweeps is that of the trilinear
//! hexahedron between its old and its new place, and volumes differ by exactly what the faces sweep. With a backward
//! difference `(a0 Q V|n+1 + a1 Q V|n + a2 Q V|n-1 + a3 Q V|n-2)/dt`, `a0 + a1 + a2 + a3 = 0`, a uniform stream stays uniform if
//!
//! `sum_f s A = (a0 V|n+1 + a1 V|n + a2 V|n-1 + a3 V|n-2)/dt = sum_f (a0 dV_f|n+1 - (a2 + a3) dV_f|n - a3 dV_f|n-1)/dt`
//!
//! (the geometric conservation law: Thomas and Lombard 1979, AIAA J. 17; formulation.md, section 2), which gives each
//! face its speed s along its normal. The old volumes that enter the time difference are taken as the new one less what
//! was swept, so that the law holds to the last digits of the sums however thin the cells are.

use dip_grid::MultiBlock;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::FlowError;
use crate::level::{Level, LevelBlock};
use crate::real::{LANES, Lanes, Packed, Real};

/// Node coordinates of one block: x, y, z, each `[k][j][i]` over the nodes.
pub type BlockNodes = [Vec<f64>; 3];

/// Node coordinates of every block of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Nodes {
    /// One set a block.
    pub blocks: Vec<BlockNodes>,
}

impl Nodes {
    /// The nodes of a grid.
    #[must_use]
    pub fn of(grid: &MultiBlock) -> Self {
        let blocks = grid
            .blocks
            .iter()
            .map(|b| [b.x.clone(), b.y.clone(), b.z.clone()])
            .collect();
        Self { blocks }
    }

    /// Writes the nodes to a grid of the same blocks.
    pub fn write_to(&self, grid: &mut MultiBlock) {
        for (block, [x, y, z]) in grid.blocks.iter_mut().zip(&self.blocks) {
            block.x.clone_from(x);
            block.y.clone_from(y);
            block.z.clone_from(z);
        }
    }
}

/// Coefficients of a backward difference in time of step `dt`: `(a[0] x|n+1 + a[1] x|n + a[2] x|n-1 + a[3] x|n-2)/dt`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Backward {
    /// Coefficients; their sum is zero.
    pub a: [f64; 4],
    /// Time step.
    pub dt: f64,
}

impl Backward {
    /// First order.
    #[must_use]
    pub fn first(dt: f64) -> Self {
        Self {
            a: [1.0, -1.0, 0.0, 0.0],
            dt,
        }
    }

    /// Second order (Gear).
    #[must_use]
    pub fn second(dt: f64) -> Self {
        Self {
            a: [1.5, -2.0, 0.5, 0.0],
            dt,
        }
    }

    /// Second order with half the error: Gear's difference of second order and 0.48 of the way to that of third order, as
    /// far as one may go and stay stable for every frequency and damping (Vatsa, Carpenter and Lockard, AIAA 2010-0122).
    #[must_use]
    pub fn second_optimized(dt: f64) -> Self {
        const PART: f64 = 0.48;
        Self {
            a: [1.5 + PART / 3.0, -2.0 - PART, 0.5 + PART, -PART / 3.0],
            dt,
        }
    }

    /// Time levels before the newest one that enter.
    #[must_use]
    pub fn levels(&self) -> usize {
        self.a.iter().rposition(|a| *a != 0.0).unwrap_or(0)
    }
}

/// Volumes that the faces of a block swept towards increasing i, j, k in a step, in the order of
/// [`crate::level::LevelBlock::faces`].
pub type Swept = [Vec<f64>; 3];

/// A grid in motion, on the finest level.
#[derive(Clone, Debug)]
pub struct MovingGrid {
    /// Nodes at the new time level.
    pub now: Nodes,
    /// Nodes at the time level before.
    pub old: Nodes,
    /// Swept in the step to the new level, one a block.
    pub swept: Vec<Swept>,
    /// Swept in the step before.
    pub swept_old: Vec<Swept>,
    /// Swept in the step before that.
    pub swept_older: Vec<Swept>,
    /// -1 for left-handed blocks.
    signs: Vec<f64>,
}

impl MovingGrid {
    /// A grid that has been at rest; `level` is the finest level made of it.
    #[must_use]
    pub fn new(grid: &MultiBlock, level: &Level) -> Self {
        let now = Nodes::of(grid);
        let still: Vec<Swept> = level
            .blocks
            .iter()
            .map(|b| [0, 1, 2].map(|d| vec![0.0; b.faces[d].area.len()]))
            .collect();
        let signs = grid
            .blocks
            .iter()
            .map(|b| {
                let first = dip_grid::metrics::hexahedron_volume(&b.corners(0, 0, 0));
                if first < 0.0 { -1.0 } else { 1.0 }
            })
            .collect();
        Self {
            old: now.clone(),
            now,
            swept: still.clone(),
            swept_old: still.clone(),
            swept_older: still,
            signs,
        }
    }

    /// Begins a step: what is new becomes old. The new nodes keep their places until they are moved.
    pub fn begin_step(&mut self) {
        for (old, now) in self.old.blocks.iter_mut().zip(&self.now.blocks) {
            for (old, now) in old.iter_mut().zip(now) {
                old.copy_from_slice(now);
            }
        }
        std::mem::swap(&mut self.swept_old, &mut self.swept_older);
        std::mem::swap(&mut self.swept, &mut self.swept_old);
    }

    /// Computes normals, areas, volumes and face speeds of `level` from the nodes now and before.
    ///
    /// # Errors
    /// [`FlowError::Volume`] names the first cell whose volume is not positive.
    pub fn update(&mut self, level: &mut Level, backward: &Backward) -> Result<(), FlowError> {
        let planar = level.planar;
        let Self {
            now,
            old,
            swept,
            swept_old,
            swept_older,
            signs,
        } = self;
        let folded = level
            .blocks
            .par_iter_mut()
            .zip(swept)
            .enumerate()
            .with_max_len(1)
            .map(|(b, (block, swept))| {
                let place = Place {
                    cells: block.layout.cells,
                    now: &now.blocks[b],
                    old: &old.blocks[b],
                    sign: signs[b],
                    backward,
                };
                for (d, swept) in swept.iter_mut().enumerate() {
                    let still = planar && d == 2;
                    let before = [&swept_old[b][d][..], &swept_older[b][d]];
                    place.faces(d, still, &mut block.faces[d], before, swept);
                }
                place.volumes(&mut block.volume);
                block.volume.iter().position(|v| !(*v > 0.0 && v.is_finite()))
            });
        let folded: Vec<Option<usize>> = folded.collect();
        for (block, cell) in level.blocks.iter().zip(folded) {
            if let Some(cell) = cell {
                let [ni, nj, _] = block.layout.cells;
                return Err(FlowError::Volume {
                    block: block.name.clone(),
                    ijk: [cell % ni, (cell / ni) % nj, cell / (ni * nj)],
                    volume: block.volume[cell],
                });
            }
        }
        Ok(())
    }
}

/// Volume that the faces of cell (i, j, k) of a block swept outwards: by how much it grew.
#[inline(always)]
pub(crate) fn growth(block: &LevelBlock, swept: &Swept, [i, j, k]: [usize; 3]) -> f64 {
    let [ni, nj, _] = block.layout.cells;
    let step = [1, ni, ni * nj];
    let mut total = 0.0;
    for d in 0..3 {
        let f = block.faces[d].at(i, j, k);
        total += swept[d][f + step[d]] - swept[d][f];
    }
    total
}

/// One block at two time levels.
struct Place<'a> {
    cells: [usize; 3],
    now: &'a BlockNodes,
    old: &'a BlockNodes,
    sign: f64,
    backward: &'a Backward,
}

#[inline(always)]
fn at<T: Packed>(nodes: &BlockNodes, n: usize) -> [T; 3] {
    [T::load(&nodes[0], n), T::load(&nodes[1], n), T::load(&nodes[2], n)]
}

#[inline(always)]
fn sub<T: Real>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn add<T: Real>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn cross<T: Real>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline(always)]
fn triple<T: Real>(a: &[T; 3], b: &[T; 3], c: &[T; 3]) -> T {
    let x = cross(b, c);
    a[0] * x[0] + a[1] * x[1] + a[2] * x[2]
}

/// [`dip_grid::metrics::hexahedron_volume`] for several cells at a time.
#[inline(always)]
fn volume_hexahedron<T: Real>(c: &[[T; 3]; 8]) -> T {
    let (d72, d74, d30) = (sub(&c[7], &c[2]), sub(&c[7], &c[4]), sub(&c[3], &c[0]));
    let (d60, d71, d50) = (sub(&c[6], &c[0]), sub(&c[7], &c[1]), sub(&c[5], &c[0]));
    (triple(&add(&d71, &d60), &d72, &d30) + triple(&d60, &add(&d72, &d50), &d74) + triple(&d71, &d50, &add(&d74, &d30)))
        * T::splat(1.0 / 12.0)
}

/// Arrays of one row of faces.
struct FaceRow<'a> {
    normal: [&'a mut [f64]; 3],
    area: &'a mut [f64],
    speed: &'a mut [f64],
    swept: &'a mut [f64],
    swept_before: [&'a [f64]; 2],
}

impl Place<'_> {
    /// Distance of neighbouring nodes along i, j, k.
    fn strides(&self) -> [usize; 3] {
        let [ni, nj, _] = self.cells;
        [1, ni + 1, (ni + 1) * (nj + 1)]
    }

    /// Faces normal to direction `d`; `still` faces (the planes of a two-dimensional grid) sweep nothing.
    fn faces(
        &self,
        d: usize,
        still: bool,
        set: &mut crate::level::FaceSet,
        swept_before: [&[f64]; 2],
        swept: &mut [f64],
    ) {
        let count = set.count;
        let width = count[0];
        let strides = self.strides();
        set.speed.resize(set.area.len(), 0.0);
        let [nx, ny, nz] = &mut set.normal;
        let rows = nx
            .par_chunks_mut(width)
            .zip(ny.par_chunks_mut(width))
            .zip(nz.par_chunks_mut(width))
            .zip(set.area.par_chunks_mut(width))
            .zip(set.speed.par_chunks_mut(width))
            .zip(swept.par_chunks_mut(width))
            .zip(swept_before[0].par_chunks(width))
            .zip(swept_before[1].par_chunks(width));
        rows.with_min_len(16)
            .enumerate()
            .for_each(|(row, (((((((x, y), z), area), speed), swept), old), older))| {
                let (j, k) = (row % count[1], row / count[1]);
                let node = j * strides[1] + k * strides[2];
                let mut to = FaceRow {
                    normal: [x, y, z],
                    area,
                    speed,
                    swept,
                    swept_before: [old, older],
                };
                let mut n = 0;
                if width >= LANES {
                    while n < width {
                        // The last pack reaches back over faces already done: the same numbers are written again.
                        let i = n.min(width - LANES);
                        self.face::<Lanes>(d, still, node + i, i, &mut to);
                        n = i + LANES;
                    }
                } else {
                    while n < width {
                        self.face::<f64>(d, still, node + n, n, &mut to);
                        n += 1;
                    }
                }
            });
    }

    #[inline(always)]
    fn face<T: Packed>(&self, d: usize, still: bool, node: usize, i: usize, to: &mut FaceRow) {
        let strides = self.strides();
        let (s1, s2) = (strides[(d + 1) % 3], strides[(d + 2) % 3]);
        let corners = |nodes: &BlockNodes| -> [[T; 3]; 4] {
            [
                at(nodes, node),
                at(nodes, node + s1),
                at(nodes, node + s2),
                at(nodes, node + s1 + s2),
            ]
        };
        let new = corners(self.now);
        let s = cross(&sub(&new[3], &new[0]), &sub(&new[2], &new[1]));
        let s = s.map(|c| T::splat(0.5 * self.sign) * c);
        let area = (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]).sqrt();
        let (zero, tiny) = (T::splat(0.0), T::splat(f64::MIN_POSITIVE));
        let inverse = T::select_lt(zero, area, T::splat(1.0) / area.max(tiny), zero);
        for (normal, s) in to.normal.iter_mut().zip(s) {
            (s * inverse).store(normal, i);
        }
        area.store(to.area, i);
        if still {
            zero.store(to.speed, i);
            return;
        }
        let old = corners(self.old);
        let swept =
            T::splat(self.sign) * volume_hexahedron(&[old[0], old[1], old[2], old[3], new[0], new[1], new[2], new[3]]);
        swept.store(to.swept, i);
        let Backward { a, dt } = *self.backward;
        let [before, longer] = to.swept_before;
        let mut sum = T::splat(a[0]) * swept - T::splat(a[2] + a[3]) * T::load(before, i);
        if a[3] != 0.0 {
            sum = sum - T::splat(a[3]) * T::load(longer, i);
        }
        let rate = sum * T::splat(1.0 / dt);
        (rate * inverse).store(to.speed, i);
    }

    fn volumes(&self, volume: &mut [f64]) {
        let [ni, nj, _] = self.cells;
        let strides = self.strides();
        volume
            .par_chunks_mut(ni)
            .with_min_len(16)
            .enumerate()
            .for_each(|(row, to)| {
                let node = (row % nj) * strides[1] + (row / nj) * strides[2];
                let mut n = 0;
                if ni >= LANES {
                    while n < ni {
                        let i = n.min(ni - LANES);
                        self.volume::<Lanes>(node + i).store(to, i);
                        n = i + LANES;
                    }
                } else {
                    for (i, v) in to.iter_mut().enumerate() {
                        *v = self.volume::<f64>(node + i);
                    }
                }
            });
    }

    #[inline(always)]
    fn volume<T: Packed>(&self, node: usize) -> T {
        let [si, sj, sk] = self.strides();
        let nodes = self.now;
        T::splat(self.sign)
            * volume_hexahedron(&[
                at(nodes, node),
                at(nodes, node + si),
                at(nodes, node + sj),
                at(nodes, node + si + sj),
                at(nodes, node + sk),
                at(nodes, node + sk + si),
                at(nodes, node + sk + sj),
                at(nodes, node + sk + sj + si),
            ])
    }
}
