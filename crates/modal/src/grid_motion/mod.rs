//! Deformation of a multi-block grid with its wall: displacement fields of all nodes, one for every mode of the wall.
//!
//! The thesis blends the wall's displacement out to the far field (its equation (4.27), transfinite interpolation from the
//! faces of a block). Here too, but by position instead of by index, and from the wall's neighbourhood instead of one node
//! of it (see `deform`): a node's displacement then depends on where it is alone. So blocks that meet agree to
//! the bit whatever their orientation, a grid cut into more blocks moves the same way, and blocks that do not touch the
//! wall need no rule of their own. Interpolation by index between the faces of cut blocks was tried first: it changed
//! the spacing at the wall by more than a tenth on the coarse O-O grid, where this keeps it to the first order in the
//! displacement.

mod anchors;
mod error;
mod extent;
mod merged;
mod mirrors;
mod volumes;
mod wall;

use dip_grid::MultiBlock;
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::deform::Blending;
use anchors::{anchors, standing};
pub use error::DeformError;
use extent::{Extent, far_distance};
use mirrors::Mirrors;
pub use volumes::{VolumeChange, volume_change};
pub use wall::MovingWall;

/// Displacement of every node of a grid for unit values of generalized coordinates. The deformed grid is
/// `base + sum over modes of q D`: linear in q, so a step of a march costs one pass over the nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct GridModes {
    /// D `[mode][block][x, y, z][node]`, nodes in the block's order.
    fields: Vec<Vec<[Vec<f64>; 3]>>,
    /// `[mode][wall node]`, as the grid moves: with no motion through a mirror plane.
    wall: Vec<Vec<Vector3<f64>>>,
    reach: f64,
}

impl GridModes {
    /// Spreads the wall's `shapes` (`[mode][wall node]`, in the grid's unit) over the grid. Displacement ends at the distance
    /// of the nearest far-field, inflow or outflow node from the wall's box, or at `reach` if that is given and less. Walls
    /// that do not move stay; nodes on mirror planes stay in them.
    ///
    /// # Errors
    /// [`DeformError`] for shapes that do not fit and mirror planes that are none.
    pub fn new(
        grid: &MultiBlock,
        wall: &MovingWall,
        shapes: &[Vec<Vector3<f64>>],
        reach: Option<f64>,
    ) -> Result<Self, DeformError> {
        for (m, shape) in shapes.iter().enumerate() {
            if shape.len() != wall.positions.len() {
                return Err(DeformError::Count {
                    name: "the shape of a mode on the wall",
                    got: shape.len(),
                    needed: wall.positions.len(),
                });
            }
            if let Some(node) = shape.iter().position(|u| !u.iter().all(|v| v.is_finite())) {
                return Err(DeformError::NotFinite { mode: m + 1, node });
            }
        }
        let mirrors = Mirrors::new(grid, &wall.merged)?;
        let shapes: Vec<Vec<Vector3<f64>>> = shapes
            .iter()
            .map(|shape| {
                let mut shape = shape.clone();
                for (node, number) in &wall.number {
                    shape[*number] = mirrors.hold(*node, shape[*number]);
                }
                shape
            })
            .collect();
        let extent = Extent::of(wall);
        let far = far_distance(grid, &extent);
        let reach = reach.map_or(far, |r| r.min(far));
        let standing = standing(grid, wall);
        let anchors = anchors(grid, wall, &standing, &shapes, &mirrors);
        let blending = Blending::new(&anchors, extent.size, reach);

        let displacement = |node: usize| -> Vec<Vector3<f64>> {
            if let Some(&n) = wall.number.get(&node) {
                return shapes.iter().map(|shape| shape[n]).collect();
            }
            let x = wall.merged.position(grid, node);
            if standing.contains_key(&node) || extent.distance(x) >= reach {
                return vec![Vector3::zeros(); shapes.len()];
            }
            let found = blending.at(&Vector3::from(x));
            found.into_iter().map(|u| mirrors.hold(node, u)).collect()
        };
        let mut fields = vec![Vec::with_capacity(grid.blocks.len()); shapes.len()];
        for (b, block) in grid.blocks.iter().enumerate() {
            let values: Vec<Vec<Vector3<f64>>> = (0..block.node_count())
                .into_par_iter()
                .map(|n| displacement(wall.merged.of(b, n)))
                .collect();
            for (m, field) in fields.iter_mut().enumerate() {
                field.push([0, 1, 2].map(|d| values.iter().map(|u| u[m][d]).collect()));
            }
        }
        Ok(Self {
            fields,
            wall: shapes,
            reach,
        })
    }

    /// Number of modes.
    #[must_use]
    pub fn count(&self) -> usize {
        self.fields.len()
    }

    /// Displacement of the nodes of `block` in `mode`: `[x, y, z][node]`.
    #[must_use]
    pub fn field(&self, mode: usize, block: usize) -> &[Vec<f64>; 3] {
        &self.fields[mode][block]
    }

    /// Shape of `mode` on the wall `[wall node]`, as the grid moves.
    #[must_use]
    pub fn wall_shape(&self, mode: usize) -> &[Vector3<f64>] {
        &self.wall[mode]
    }

    /// Shape of `mode` on the faces of the wall, `[face]`: the mean of a face's four nodes. The work of a pressure that is
    /// even over a face is its force times this.
    #[must_use]
    pub fn face_shape(&self, mode: usize, wall: &MovingWall) -> Vec<Vector3<f64>> {
        let shape = &self.wall[mode];
        wall.faces
            .iter()
            .map(|f| 0.25 * (shape[f[0]] + shape[f[1]] + shape[f[2]] + shape[f[3]]))
            .collect()
    }

    /// Distance from the wall, in the grid's unit, from which on nothing moves.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Sets the nodes of `moved` to those of `base` displaced by the generalized coordinates `q` `[mode]`.
    ///
    /// # Errors
    /// [`DeformError::Count`] if `q` or the blocks do not fit.
    pub fn displace(&self, base: &MultiBlock, q: &[f64], moved: &mut MultiBlock) -> Result<(), DeformError> {
        let wrong = |name, got, needed| DeformError::Count { name, got, needed };
        if q.len() != self.count() {
            return Err(wrong("the list of generalized coordinates", q.len(), self.count()));
        }
        if moved.blocks.len() != base.blocks.len() {
            return Err(wrong(
                "the deformed grid's list of blocks",
                moved.blocks.len(),
                base.blocks.len(),
            ));
        }
        for (b, (from, to)) in base.blocks.iter().zip(&moved.blocks).enumerate() {
            let needed = self
                .fields
                .first()
                .map_or(from.node_count(), |f| f.get(b).map_or(0, |c| c[0].len()));
            for got in [from.node_count(), to.node_count()] {
                if got != needed {
                    return Err(wrong("a block's list of nodes", got, needed));
                }
            }
        }
        moved
            .blocks
            .par_iter_mut()
            .zip(&base.blocks)
            .enumerate()
            .for_each(|(b, (to, from))| {
                for (d, (to, from)) in [(&mut to.x, &from.x), (&mut to.y, &from.y), (&mut to.z, &from.z)]
                    .into_iter()
                    .enumerate()
                {
                    to.copy_from_slice(from);
                    for (field, q) in self.fields.iter().zip(q) {
                        for (to, shape) in to.iter_mut().zip(&field[b][d]) {
                            *to += q * shape;
                        }
                    }
                }
            });
        Ok(())
    }
}
