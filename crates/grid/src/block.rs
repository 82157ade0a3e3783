//! One structured block: its size and its nodes.

use crate::face::Face;

/// A structured hexahedral block of `ni x nj x nk` cells with `(ni+1) x (nj+1) x (nk+1)` nodes.
///
/// Coordinates are kept as three arrays (structure of arrays), i fastest:
/// node `(i, j, k)` is at `i + (ni+1) * (j + (nj+1) * k)`, cell `(i, j, k)` at `i + ni * (j + nj * k)`.
/// A two-dimensional grid is one cell across (`nk == 1` in all grids this crate makes: i runs along the wall,
/// j away from it and k across, to starboard).
///
/// The length unit is the file's or the recipe's; the crate never scales.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Name for messages and files; unique in a [`crate::MultiBlock`].
    pub name: String,
    /// Cells along i.
    pub ni: usize,
    /// Cells along j.
    pub nj: usize,
    /// Cells along k.
    pub nk: usize,
    /// x of every node, `[k][j][i]`.
    pub x: Vec<f64>,
    /// y of every node, `[k][j][i]`.
    pub y: Vec<f64>,
    /// z of every node, `[k][j][i]`.
    pub z: Vec<f64>,
}

impl Block {
    /// A block of `cells` with every node at the origin.
    #[must_use]
    pub fn zeros(name: &str, cells: [usize; 3]) -> Self {
        let n = (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1);
        Self {
            name: name.to_owned(),
            ni: cells[0],
            nj: cells[1],
            nk: cells[2],
            x: vec![0.0; n],
            y: vec![0.0; n],
            z: vec![0.0; n],
        }
    }

    /// A block whose node `(i, j, k)` is at `position(i, j, k)`.
    #[must_use]
    pub fn from_fn(name: &str, cells: [usize; 3], mut position: impl FnMut(usize, usize, usize) -> [f64; 3]) -> Self {
        let mut block = Self::zeros(name, cells);
        let mut n = 0;
        for k in 0..=cells[2] {
            for j in 0..=cells[1] {
                for i in 0..=cells[0] {
                    let p = position(i, j, k);
                    block.x[n] = p[0];
                    block.y[n] = p[1];
                    block.z[n] = p[2];
                    n += 1;
                }
            }
        }
        block
    }

    /// A two-dimensional block of `cells`, one cell across: `x` and `up` of `(ni+1) x (nj+1)` nodes, i fastest. It stands in
    /// the plane (x, z); k runs to port, so that the block keeps its hand.
    #[must_use]
    pub fn across(name: &str, cells: [usize; 2], x: &[f64], up: &[f64]) -> Self {
        let y = std::iter::repeat_n(1.0, x.len()).chain(std::iter::repeat_n(0.0, x.len()));
        Self {
            name: name.to_owned(),
            ni: cells[0],
            nj: cells[1],
            nk: 1,
            x: x.repeat(2),
            y: y.collect(),
            z: up.repeat(2),
        }
    }

    /// Cells along i, j, k.
    #[must_use]
    pub fn cells(&self) -> [usize; 3] {
        [self.ni, self.nj, self.nk]
    }

    /// Nodes along i, j, k.
    #[must_use]
    pub fn nodes(&self) -> [usize; 3] {
        [self.ni + 1, self.nj + 1, self.nk + 1]
    }

    /// Number of cells.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.ni * self.nj * self.nk
    }

    /// Number of nodes.
    #[must_use]
    pub fn node_count(&self) -> usize {
        (self.ni + 1) * (self.nj + 1) * (self.nk + 1)
    }

    /// Index of node `(i, j, k)` in `x`, `y`, `z`.
    #[inline]
    #[must_use]
    pub fn node(&self, i: usize, j: usize, k: usize) -> usize {
        i + (self.ni + 1) * (j + (self.nj + 1) * k)
    }

    /// Index of cell `(i, j, k)` in cell arrays.
    #[inline]
    #[must_use]
    pub fn cell(&self, i: usize, j: usize, k: usize) -> usize {
        i + self.ni * (j + self.nj * k)
    }

    /// Cell `(i, j, k)` of a cell index: the inverse of [`Block::cell`].
    #[must_use]
    pub fn cell_ijk(&self, cell: usize) -> [usize; 3] {
        [cell % self.ni, (cell / self.ni) % self.nj, cell / (self.ni * self.nj)]
    }

    /// Position of node `(i, j, k)`.
    #[inline]
    #[must_use]
    pub fn point(&self, i: usize, j: usize, k: usize) -> [f64; 3] {
        let n = self.node(i, j, k);
        [self.x[n], self.y[n], self.z[n]]
    }

    /// Position of the node `ijk`.
    #[inline]
    #[must_use]
    pub fn point_at(&self, ijk: [usize; 3]) -> [f64; 3] {
        self.point(ijk[0], ijk[1], ijk[2])
    }

    /// Moves node `ijk` to `p`.
    #[inline]
    pub fn set_point(&mut self, ijk: [usize; 3], p: [f64; 3]) {
        let n = self.node(ijk[0], ijk[1], ijk[2]);
        self.x[n] = p[0];
        self.y[n] = p[1];
        self.z[n] = p[2];
    }

    /// The eight corners of cell `(i, j, k)` in binary order: corner `a + 2 b + 4 c` is node `(i+a, j+b, k+c)`.
    #[inline]
    #[must_use]
    pub fn corners(&self, i: usize, j: usize, k: usize) -> [[f64; 3]; 8] {
        let n = self.node(i, j, k);
        let dj = self.ni + 1;
        let dk = dj * (self.nj + 1);
        let at = |n: usize| [self.x[n], self.y[n], self.z[n]];
        [
            at(n),
            at(n + 1),
            at(n + dj),
            at(n + dj + 1),
            at(n + dk),
            at(n + dk + 1),
            at(n + dk + dj),
            at(n + dk + dj + 1),
        ]
    }

    /// Mean of the eight corners of cell `(i, j, k)`.
    #[must_use]
    pub fn cell_centre(&self, i: usize, j: usize, k: usize) -> [f64; 3] {
        let mut centre = [0.0; 3];
        for corner in self.corners(i, j, k) {
            for (sum, value) in centre.iter_mut().zip(corner) {
                *sum += 0.125 * value;
            }
        }
        centre
    }

    /// Number of face cells of `face` along its two directions (see [`Face::directions`]).
    #[must_use]
    pub fn face_cells(&self, face: Face) -> [usize; 2] {
        let [a, b] = face.directions();
        let cells = self.cells();
        [cells[a], cells[b]]
    }

    /// Cell `(p, q)` of `face`, `depth` cells inside the block (0: touching the face).
    #[inline]
    #[must_use]
    pub fn cell_behind(&self, face: Face, p: usize, q: usize, depth: usize) -> [usize; 3] {
        face.ijk(self.cells(), p, q, depth)
    }

    /// Node `(p, q)` of `face`, `depth` nodes inside the block (0: on the face).
    #[inline]
    #[must_use]
    pub fn node_behind(&self, face: Face, p: usize, q: usize, depth: usize) -> [usize; 3] {
        face.ijk(self.nodes(), p, q, depth)
    }

    /// Smallest box that holds every node: lower and upper corner.
    #[must_use]
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let range = |v: &[f64]| {
            v.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), &a| {
                (lo.min(a), hi.max(a))
            })
        };
        let (x, y, z) = (range(&self.x), range(&self.y), range(&self.z));
        [[x.0, y.0, z.0], [x.1, y.1, z.1]]
    }

    /// The same nodes in another order: new index direction `d` runs along the old direction `axes[d]`,
    /// backwards where `reverse[d]`.
    #[must_use]
    pub fn reoriented(&self, axes: [usize; 3], reverse: [bool; 3]) -> Self {
        let old = self.cells();
        let cells = axes.map(|a| old[a]);
        Self::from_fn(&self.name, cells, |i, j, k| {
            let new = [i, j, k];
            let mut ijk = [0; 3];
            for d in 0..3 {
                ijk[axes[d]] = if reverse[d] { cells[d] - new[d] } else { new[d] };
            }
            self.point_at(ijk)
        })
    }
}
