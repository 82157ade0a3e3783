//! How a grid meets its walls: height of the first cells, and the angle at which lines leave.

use super::cells::Tally;
use super::{CellPlace, Figure, names};
use crate::metrics::{face_area, hexahedron_volume};
use crate::topology::MultiBlock;
use crate::vector::{add, dot, norm, sub, unit};

/// What the cells on walls are like.
pub(super) struct Walls {
    /// Smallest, mean and largest height: volume over wall area.
    pub(super) spacing: [f64; 3],
    /// Angle between the line off the wall and the wall's normal.
    pub(super) angle: Figure,
}

/// Looks at every cell on a wall; `None` if there is no wall.
pub(super) fn walls(grid: &MultiBlock) -> Option<Walls> {
    let (mut least, mut sum, mut most, mut count) = (f64::INFINITY, 0.0, 0.0f64, 0usize);
    let mut angles = Tally::new(names::WALL_ANGLE, 1.0);
    for patch in grid.topology.patches.iter().filter(|p| p.condition.is_wall()) {
        let block = grid.blocks.get(patch.block)?;
        let limit = block.face_cells(patch.face);
        for q in patch.window.lo[1]..patch.window.hi[1].min(limit[1]) {
            for p in patch.window.lo[0]..patch.window.hi[0].min(limit[0]) {
                let node = |dp: usize, dq: usize, deep: usize| {
                    block.point_at(block.node_behind(patch.face, p + dp, q + dq, deep))
                };
                let area = face_area(node(0, 0, 0), node(1, 0, 0), node(1, 1, 0), node(0, 1, 0));
                let [i, j, k] = block.cell_behind(patch.face, p, q, 0);
                let height = hexahedron_volume(&block.corners(i, j, k)).abs() / norm(area).max(f64::MIN_POSITIVE);
                least = least.min(height);
                most = most.max(height);
                sum += height;
                count += 1;
                let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
                let line = corners
                    .iter()
                    .fold([0.0; 3], |sum, &(a, b)| add(sum, sub(node(a, b, 1), node(a, b, 0))));
                let angle = dot(unit(line), unit(area)).abs().min(1.0).acos().to_degrees();
                angles.add(angle, || CellPlace {
                    block: patch.block,
                    ijk: [i, j, k],
                    centre: block.cell_centre(i, j, k),
                    value: 0.0,
                });
            }
        }
    }
    (count > 0).then(|| Walls {
        spacing: [least, sum / count as f64, most],
        angle: angles.figure(count),
    })
}
