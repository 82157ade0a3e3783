//! Forces, moments and pressure coefficients on walls.

use std::collections::BTreeMap;

use dip_grid::MultiBlock;
use dip_grid::vector::{cross, dot, sub};
use serde::{Deserialize, Serialize};

use crate::boundary::{Boundary, Sides};
use crate::level::{Level, LevelPatch};
use crate::moving::Nodes;
use crate::settings::{FlowSettings, Reference};

/// Force and moment coefficients.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Coefficients {
    /// Lift, normal to the stream in the plane of x and z.
    pub cl: f64,
    /// Drag, along the stream.
    pub cd: f64,
    /// Side force.
    pub cy: f64,
    /// Pitching moment about y, nose up.
    pub cm: f64,
    /// Force along x, y, z.
    pub force: [f64; 3],
    /// Moment about x, y, z (right-hand rule).
    pub moment: [f64; 3],
}

/// Coefficients by patch name, and their sum.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Loads {
    /// All walls.
    pub total: Coefficients,
    /// Each wall.
    pub patches: BTreeMap<String, Coefficients>,
}

/// Pressure on one patch of wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WallPatch {
    /// Name.
    pub name: String,
    /// Block.
    pub block: usize,
    /// Face cells along the two directions of the patch.
    pub size: [usize; 2],
    /// Face centres, first direction fastest; grid's unit.
    pub centre: Vec<[f64; 3]>,
    /// Area vectors into the body (out of the fluid).
    pub area: Vec<[f64; 3]>,
    /// Pressure coefficients.
    pub cp: Vec<f64>,
}

/// Face centres of the walls of the finest level.
#[derive(Clone, Debug)]
pub struct WallGeometry {
    /// Index of the patch in the level and its face centres.
    patches: Vec<(usize, Vec<[f64; 3]>)>,
}

impl WallGeometry {
    /// Takes the centres of all wall faces of a level; `finest` is the level of the grid itself.
    #[must_use]
    pub fn merged(grid: &MultiBlock, level: &Level, boundaries: &[Boundary], finest: &Level) -> Self {
        let patches = boundaries
            .iter()
            .enumerate()
            .filter(|(_, b)| b.is_wall())
            .map(|(n, _)| (n, face_centres(grid, &level.patches[n], &finest.patches[n])))
            .collect();
        Self { patches }
    }

    /// Mean over the four corners of every wall face of a quantity given at the nodes of the finest level's grid, `[patch][face]`.
    #[must_use]
    pub fn at_faces(&self, level: &Level, nodes: &Nodes) -> Vec<Vec<[f64; 3]>> {
        self.patches
            .iter()
            .map(|(n, _)| corner_means(level, &level.patches[*n], nodes))
            .collect()
    }

    /// Follows the walls of a moving grid; for the finest level only.
    pub fn follow(&mut self, level: &Level, nodes: &Nodes) {
        for (n, centres) in &mut self.patches {
            *centres = corner_means(level, &level.patches[*n], nodes);
        }
    }

    /// True if there is a wall.
    #[must_use]
    pub fn has_wall(&self) -> bool {
        !self.patches.is_empty()
    }

    /// Pressure coefficients of every wall from the boundary fluxes of the last residual.
    #[must_use]
    pub fn pressures(&self, level: &Level, sides: &Sides, flow: &FlowSettings) -> Vec<WallPatch> {
        let stream = flow.state()[4];
        self.patches
            .iter()
            .map(|(n, centres)| {
                let patch = &level.patches[*n];
                let block = &level.blocks[patch.block];
                let set = &block.faces[patch.face.axis()];
                let sign = if patch.face.is_max() { 1.0 } else { -1.0 };
                let (mut area, mut cp) = (Vec::new(), Vec::new());
                for q in patch.window.lo[1]..patch.window.hi[1] {
                    for p in patch.window.lo[0]..patch.window.hi[0] {
                        let [i, j, k] = patch.face.ijk(set.count, p, q, 0);
                        area.push(set.vector(set.at(i, j, k)).map(|s| sign * s));
                        let pressure = sides[patch.block][patch.face as usize]
                            .as_ref()
                            .map_or(stream, |s| s.pressure[p + s.size[0] * q]);
                        cp.push(2.0 * (pressure - stream));
                    }
                }
                WallPatch {
                    name: patch.name.clone(),
                    block: patch.block,
                    size: patch.window.size(),
                    centre: centres.clone(),
                    area,
                    cp,
                }
            })
            .collect()
    }
}

/// Means over the four corners of the faces of a patch of the finest level, first direction fastest.
fn corner_means(level: &Level, patch: &LevelPatch, nodes: &Nodes) -> Vec<[f64; 3]> {
    let count = level.blocks[patch.block].layout.cells.map(|c| c + 1);
    let [x, y, z] = &nodes.blocks[patch.block];
    let mut means = Vec::with_capacity(patch.window.count());
    for q in patch.window.lo[1]..patch.window.hi[1] {
        for p in patch.window.lo[0]..patch.window.hi[0] {
            let mut mean = [0.0; 3];
            for (a, b) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let [i, j, k] = patch.face.ijk(count, p + a, q + b, 0);
                let node = i + count[0] * (j + count[1] * k);
                for (m, x) in mean.iter_mut().zip([x, y, z]) {
                    *m += 0.25 * x[node];
                }
            }
            means.push(mean);
        }
    }
    means
}

/// Centres of the faces of a patch (mean of their four corners), first direction fastest. On a coarser level the nodes
/// of the grid that its faces keep are taken.
#[must_use]
pub fn face_centres(grid: &MultiBlock, patch: &LevelPatch, finest: &LevelPatch) -> Vec<[f64; 3]> {
    let block = &grid.blocks[patch.block];
    let (size, fine) = (patch.window.size(), finest.window.size());
    let step = [fine[0] / size[0].max(1), fine[1] / size[1].max(1)];
    let mut centres = Vec::with_capacity(patch.window.count());
    for q in 0..size[1] {
        for p in 0..size[0] {
            let mut centre = [0.0; 3];
            for (a, b) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let node = [
                    finest.window.lo[0] + (p + a) * step[0],
                    finest.window.lo[1] + (q + b) * step[1],
                ];
                let point = block.point_at(block.node_behind(patch.face, node[0], node[1], 0));
                for d in 0..3 {
                    centre[d] += 0.25 * point[d];
                }
            }
            centres.push(centre);
        }
    }
    centres
}

/// Integrates pressure coefficients. Force on the body per face: `cp` times its area vector into the body; the
/// free-stream pressure is left out (it has no resultant on a closed body).
#[must_use]
pub fn integrate(walls: &[WallPatch], flow: &FlowSettings, reference: &Reference) -> Loads {
    let [drag, side, lift] = flow.wind_axes();
    let mut sums: BTreeMap<String, ([f64; 3], [f64; 3])> = BTreeMap::new();
    for wall in walls {
        let (force, moment) = sums.entry(wall.name.clone()).or_default();
        for ((centre, area), cp) in wall.centre.iter().zip(&wall.area).zip(&wall.cp) {
            let f = area.map(|a| cp * a / reference.area);
            let m = cross(sub(*centre, reference.moment_point), f);
            for d in 0..3 {
                force[d] += f[d];
                moment[d] += m[d] / reference.chord;
            }
        }
    }
    let coefficients = |force: [f64; 3], moment: [f64; 3]| Coefficients {
        cl: dot(force, lift),
        cd: dot(force, drag),
        cy: dot(force, side),
        // x aft, z up: nose up turns z towards x, which is positive about y.
        cm: moment[1],
        force,
        moment,
    };
    let mut total = ([0.0; 3], [0.0; 3]);
    for (f, m) in sums.values() {
        for d in 0..3 {
            total.0[d] += f[d];
            total.1[d] += m[d];
        }
    }
    Loads {
        total: coefficients(total.0, total.1),
        patches: sums
            .into_iter()
            .map(|(name, (f, m))| (name, coefficients(f, m)))
            .collect(),
    }
}
