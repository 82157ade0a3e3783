//! The part of a grid's wall that moves.

use std::collections::BTreeMap;

use dip_grid::{MultiBlock, Patch, metrics};
use nalgebra::Vector3;

use super::error::DeformError;
use super::merged::Merged;

/// The part of a grid's wall that moves: its nodes, each once however many blocks meet there, and its faces.
#[derive(Debug, Clone)]
pub struct MovingWall {
    /// Positions `[wall node]`, in the grid's unit.
    pub positions: Vec<[f64; 3]>,
    /// Wall nodes of each face in order round it, in the order of the patches and, in a patch, of its cells (first direction
    /// fastest).
    pub faces: Vec<[usize; 4]>,
    /// Places in [`dip_grid::Topology::patches`] of the patches that move.
    pub patches: Vec<usize>,
    /// Area of each face.
    pub(super) areas: Vec<f64>,
    pub(super) merged: Merged,
    /// Wall node of a merged node.
    pub(super) number: BTreeMap<usize, usize>,
}

impl MovingWall {
    /// The patches of `grid` that `moves` accepts, e.g. those named `wing`.
    ///
    /// # Errors
    /// [`DeformError::NoWall`].
    pub fn new(grid: &MultiBlock, moves: impl Fn(&Patch) -> bool) -> Result<Self, DeformError> {
        let mut wall = Self {
            positions: Vec::new(),
            faces: Vec::new(),
            patches: Vec::new(),
            areas: Vec::new(),
            merged: Merged::new(grid),
            number: BTreeMap::new(),
        };
        for (place, patch) in grid.topology.patches.iter().enumerate() {
            if !patch.condition.is_wall() || !moves(patch) {
                continue;
            }
            wall.patches.push(place);
            for q in patch.window.lo[1]..patch.window.hi[1] {
                for p in patch.window.lo[0]..patch.window.hi[0] {
                    let mut corner = |a: usize, b: usize| wall.add(grid, patch, p + a, q + b);
                    let face = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    wall.faces.push(face);
                    wall.areas.push(face_area(grid, patch, p, q).norm());
                }
            }
        }
        if wall.faces.is_empty() {
            return Err(DeformError::NoWall);
        }
        Ok(wall)
    }

    /// Number of the wall node at node `(p, q)` of the patch's face.
    fn add(&mut self, grid: &MultiBlock, patch: &Patch, p: usize, q: usize) -> usize {
        let node = self.merged.of_face(grid, patch.block, patch.face, p, q);
        let next = self.positions.len();
        let number = *self.number.entry(node).or_insert(next);
        if number == next {
            self.positions.push(self.merged.position(grid, node));
        }
        number
    }

    /// Positions as vectors, for a [`crate::Transfer`].
    #[must_use]
    pub fn points(&self) -> Vec<Vector3<f64>> {
        self.positions.iter().map(|p| Vector3::from(*p)).collect()
    }

    /// How smooth a shape `[wall node]` is on the wall: the largest change, rad, of the angle between two neighbouring faces
    /// when the shape is laid on so that its largest displacement is `displacement`. Facets of a coarse structure that
    /// show through on the wall are seen here; rigid motion is not.
    #[must_use]
    pub fn largest_kink(&self, shape: &[Vector3<f64>], displacement: f64) -> f64 {
        let largest = shape.iter().map(Vector3::norm).fold(0.0, f64::max);
        if largest == 0.0 || shape.len() != self.positions.len() {
            return 0.0;
        }
        let moved = |n: usize| Vector3::from(self.positions[n]) + displacement / largest * shape[n];
        let normal = |face: &[usize; 4], at: &dyn Fn(usize) -> Vector3<f64>| {
            (at(face[2]) - at(face[0])).cross(&(at(face[3]) - at(face[1])))
        };
        let angle = |a: &Vector3<f64>, b: &Vector3<f64>| a.cross(b).norm().atan2(a.dot(b));
        let still = |n: usize| Vector3::from(self.positions[n]);
        // Faces on either side of an edge.
        let mut edges: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        let mut kink = 0.0_f64;
        for (f, face) in self.faces.iter().enumerate() {
            for side in 0..4 {
                let (a, b) = (face[side], face[(side + 1) % 4]);
                if a == b {
                    continue;
                }
                if let Some(&other) = edges.get(&[a.min(b), a.max(b)]) {
                    let other = &self.faces[other];
                    let before = angle(&normal(face, &still), &normal(other, &still));
                    let after = angle(&normal(face, &moved), &normal(other, &moved));
                    kink = kink.max((after - before).abs());
                } else {
                    edges.insert([a.min(b), a.max(b)], f);
                }
            }
        }
        kink
    }
}

/// Area vector of the face of a patch whose lower corner is node `(p, q)`.
pub(super) fn face_area(grid: &MultiBlock, patch: &Patch, p: usize, q: usize) -> Vector3<f64> {
    let block = &grid.blocks[patch.block];
    let at = |p: usize, q: usize| block.point_at(block.node_behind(patch.face, p, q, 0));
    Vector3::from(metrics::face_area(
        at(p, q),
        at(p + 1, q),
        at(p + 1, q + 1),
        at(p, q + 1),
    ))
}
