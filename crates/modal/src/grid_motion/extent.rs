//! How far the motion of a wall reaches into the grid.

use dip_grid::{Condition, MultiBlock};
use nalgebra::Vector3;

use super::wall::MovingWall;

/// The box round the moving wall.
pub(super) struct Extent {
    lo: [f64; 3],
    hi: [f64; 3],
    /// Half its diagonal.
    pub(super) size: f64,
}

impl Extent {
    pub(super) fn of(wall: &MovingWall) -> Self {
        let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in &wall.positions {
            for d in 0..3 {
                lo[d] = lo[d].min(p[d]);
                hi[d] = hi[d].max(p[d]);
            }
        }
        let size = 0.5 * (Vector3::from(hi) - Vector3::from(lo)).norm();
        Self { lo, hi, size }
    }

    pub(super) fn distance(&self, p: [f64; 3]) -> f64 {
        let outside = |d: usize| (self.lo[d] - p[d]).max(p[d] - self.hi[d]).max(0.0);
        (outside(0).powi(2) + outside(1).powi(2) + outside(2).powi(2)).sqrt()
    }
}

/// Distance from the wall's box to the nearest node of an open boundary, or to the farthest node of a closed grid.
pub(super) fn far_distance(grid: &MultiBlock, extent: &Extent) -> f64 {
    let open = |c: Condition| !c.is_wall() && !matches!(c, Condition::Symmetry | Condition::Collapsed);
    let mut nearest = f64::INFINITY;
    for patch in grid.topology.patches.iter().filter(|p| open(p.condition)) {
        let block = &grid.blocks[patch.block];
        for q in patch.window.lo[1]..=patch.window.hi[1] {
            for p in patch.window.lo[0]..=patch.window.hi[0] {
                let node = block.point_at(block.node_behind(patch.face, p, q, 0));
                nearest = nearest.min(extent.distance(node));
            }
        }
    }
    if nearest.is_finite() && nearest > 0.0 {
        return nearest;
    }
    let farthest = grid
        .blocks
        .iter()
        .flat_map(|b| (0..b.node_count()).map(|n| [b.x[n], b.y[n], b.z[n]]));
    farthest.map(|p| extent.distance(p)).fold(extent.size, f64::max)
}
