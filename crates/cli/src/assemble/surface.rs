//! The walls of a grid as a recording has them, in the order in which the solver gives their pressures.

use dip_grid::{MultiBlock, Patch};
use dip_pmb::loads::WallPatch;
use dip_pmb::moving::Nodes;
use dip_record::{SurfaceGrid, SurfacePatch};

/// Patches with nodes (m) and faces.
pub fn patches(grid: &MultiBlock) -> SurfaceGrid {
    let windows: Vec<&Patch> = windows(grid).collect();
    let patches = windows
        .iter()
        .enumerate()
        .map(|(n, patch)| {
            let twin = windows.iter().filter(|p| p.name == patch.name).count() > 1;
            let name = if twin {
                format!("{}.{}", patch.name, n + 1)
            } else {
                patch.name.clone()
            };
            let nodes = Nodes::of(grid);
            let wall = layer(grid, &nodes, patch, 0);
            let make = |flip: bool| SurfacePatch::structured(name.clone(), wall.clone(), patch.window.size(), flip);
            // Area vectors point out of the body, to where the next layer of nodes is.
            let plain = make(false);
            let next = layer(grid, &nodes, patch, 1);
            let out: f64 = plain
                .faces
                .iter()
                .zip(&plain.areas_m2)
                .map(|(face, area)| {
                    let rise = face.iter().map(|n| *n as usize).map(|n| {
                        let step = |c: usize| next[n][c] - wall[n][c];
                        area[0] * step(0) + area[1] * step(1) + area[2] * step(2)
                    });
                    rise.sum::<f64>()
                })
                .sum();
            if out < 0.0 { make(true) } else { plain }
        })
        .collect();
    SurfaceGrid { patches }
}

/// The recorded surface at rest with a value on every face, `[face]` with all patches in order, as the solver's walls.
pub fn walls(grid: &MultiBlock, surface: &SurfaceGrid, values: impl IntoIterator<Item = f64>) -> Vec<WallPatch> {
    let mut values = values.into_iter();
    windows(grid)
        .zip(&surface.patches)
        .map(|(window, patch)| WallPatch {
            name: patch.name.clone(),
            block: window.block,
            size: window.window.size(),
            centre: patch.centroids_m.clone(),
            area: patch.areas_m2.iter().map(|a| a.map(|v| -v)).collect(),
            cp: values.by_ref().take(patch.faces.len()).collect(),
        })
        .collect()
}

/// A quantity given at the nodes of a grid, at the wall nodes of every patch in the same order, `[patch][node]`.
pub fn at_walls(grid: &MultiBlock, nodes: &Nodes) -> Vec<Vec<[f64; 3]>> {
    windows(grid).map(|patch| layer(grid, nodes, patch, 0)).collect()
}

fn windows(grid: &MultiBlock) -> impl Iterator<Item = &Patch> {
    grid.topology.patches.iter().filter(|p| p.condition.is_wall())
}

/// Nodes of a patch, `depth` layers into the flow.
fn layer(grid: &MultiBlock, nodes: &Nodes, patch: &Patch, depth: usize) -> Vec<[f64; 3]> {
    let block = &grid.blocks[patch.block];
    let [x, y, z] = &nodes.blocks[patch.block];
    let mut out = Vec::new();
    for q in patch.window.lo[1]..=patch.window.hi[1] {
        for p in patch.window.lo[0]..=patch.window.hi[0] {
            let [i, j, k] = block.node_behind(patch.face, p, q, depth);
            let n = block.node(i, j, k);
            out.push([x[n], y[n], z[n]]);
        }
    }
    out
}
