//! Mirror planes that nodes may not leave.

use std::collections::BTreeMap;

use dip_grid::{Condition, MultiBlock};
use nalgebra::Vector3;

use super::error::DeformError;
use super::merged::Merged;
use super::wall::face_area;

/// Planes that nodes may not leave.
pub(super) struct Mirrors {
    /// Normals of the planes through a merged node.
    normals: BTreeMap<usize, Vec<Vector3<f64>>>,
    /// The one plane of the grid, if there is just one: a point on it and its normal.
    pub(super) single: Option<[Vector3<f64>; 2]>,
}

/// Planes are the same within this part of the grid's size.
const PLANE: f64 = 1e-6;

impl Mirrors {
    pub(super) fn new(grid: &MultiBlock, merged: &Merged) -> Result<Self, DeformError> {
        let [lo, hi] = grid.bounds().map(Vector3::from);
        let tolerance = PLANE * (hi - lo).norm();
        let mut planes: Vec<[Vector3<f64>; 2]> = Vec::new();
        let mut normals: BTreeMap<usize, Vec<Vector3<f64>>> = BTreeMap::new();
        for patch in &grid.topology.patches {
            if patch.condition != Condition::Symmetry {
                continue;
            }
            let block = &grid.blocks[patch.block];
            let node = |p: usize, q: usize| block.point_at(block.node_behind(patch.face, p, q, 0));
            let mut area = Vector3::zeros();
            for q in patch.window.lo[1]..patch.window.hi[1] {
                for p in patch.window.lo[0]..patch.window.hi[0] {
                    area += face_area(grid, patch, p, q);
                }
            }
            let Some(normal) = area.try_normalize(0.0).map(snapped) else {
                continue;
            };
            let point = Vector3::from(node(patch.window.lo[0], patch.window.lo[1]));
            for q in patch.window.lo[1]..=patch.window.hi[1] {
                for p in patch.window.lo[0]..=patch.window.hi[0] {
                    let offset = (Vector3::from(node(p, q)) - point).dot(&normal).abs();
                    if offset > tolerance {
                        return Err(DeformError::NotPlane {
                            patch: patch.name.clone(),
                            block: block.name.clone(),
                            offset,
                        });
                    }
                    let list = normals
                        .entry(merged.of_face(grid, patch.block, patch.face, p, q))
                        .or_default();
                    if !list.iter().any(|n| n.cross(&normal).norm() < PLANE) {
                        list.push(normal);
                    }
                }
            }
            let same = |[q, n]: &[Vector3<f64>; 2]| {
                n.cross(&normal).norm() < PLANE && (point - q).dot(&normal).abs() < tolerance
            };
            if !planes.iter().any(same) {
                planes.push([point, normal]);
            }
        }
        let single = match planes[..] {
            [plane] => Some(plane),
            _ => None,
        };
        Ok(Self { normals, single })
    }

    /// `u` without its part through the planes of `node`.
    pub(super) fn hold(&self, node: usize, mut u: Vector3<f64>) -> Vector3<f64> {
        for n in self.normals.get(&node).into_iter().flatten() {
            u -= n * n.dot(&u);
        }
        u
    }
}

/// An axis where `normal` is one but for rounding, so that its zeros are exact.
fn snapped(normal: Vector3<f64>) -> Vector3<f64> {
    let rounded = normal.map(f64::round);
    if (normal - rounded).norm() < PLANE {
        rounded
    } else {
        normal
    }
}
