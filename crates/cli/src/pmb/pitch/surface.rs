//! The walls of a grid as a recording has them, in the order in which the solver gives their pressures.

use dip_grid::MultiBlock;
use dip_pmb::loads::WallPatch;
use dip_pmb::moving::Nodes;
use dip_record::{SurfaceGrid, SurfacePatch};

/// Patches with nodes (m) and faces; `walls` are those of any flow on the grid.
pub fn patches(grid: &MultiBlock, walls: &[WallPatch]) -> SurfaceGrid {
    let windows: Vec<_> = grid.topology.patches.iter().filter(|p| p.condition.is_wall()).collect();
    let patches = windows
        .iter()
        .zip(walls)
        .enumerate()
        .map(|(n, (patch, wall))| {
            let twin = windows.iter().filter(|p| p.name == patch.name).count() > 1;
            let name = if twin {
                format!("{}.{}", patch.name, n + 1)
            } else {
                patch.name.clone()
            };
            let make = |flip: bool| {
                SurfacePatch::structured(
                    name.clone(),
                    window(grid, &Nodes::of(grid), patch),
                    patch.window.size(),
                    flip,
                )
            };
            // The solver's area vectors point into the body, a recording's out of it.
            let plain = make(false);
            let along: f64 = plain
                .areas_m2
                .iter()
                .zip(&wall.area)
                .map(|(a, b)| a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
                .sum();
            if along > 0.0 { make(true) } else { plain }
        })
        .collect();
    SurfaceGrid { patches }
}

/// A quantity given at the nodes of a grid, at the wall nodes of every patch in the same order, `[patch][node]`.
pub fn at_walls(grid: &MultiBlock, nodes: &Nodes) -> Vec<Vec<[f64; 3]>> {
    grid.topology
        .patches
        .iter()
        .filter(|p| p.condition.is_wall())
        .map(|patch| window(grid, nodes, patch))
        .collect()
}

fn window(grid: &MultiBlock, nodes: &Nodes, patch: &dip_grid::Patch) -> Vec<[f64; 3]> {
    let block = &grid.blocks[patch.block];
    let [x, y, z] = &nodes.blocks[patch.block];
    let mut out = Vec::new();
    for q in patch.window.lo[1]..=patch.window.hi[1] {
        for p in patch.window.lo[0]..=patch.window.hi[0] {
            let [i, j, k] = block.node_behind(patch.face, p, q, 0);
            let n = block.node(i, j, k);
            out.push([x[n], y[n], z[n]]);
        }
    }
    out
}
