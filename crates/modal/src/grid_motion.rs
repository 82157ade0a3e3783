//! Deformation of a multi-block grid with its wall: displacement fields of all nodes, one for every mode of the wall.
//!
//! The thesis blends the wall's displacement out to the far field (its equation (4.27), transfinite interpolation from the
//! faces of a block). Here too, but by position instead of by index, and from the wall's neighbourhood instead of one node
//! of it (see `deform`): a node's displacement then depends on where it is alone. So blocks that meet agree to
//! the bit whatever their orientation, a grid cut into more blocks moves the same way, and blocks that do not touch the
//! wall need no rule of their own. Interpolation by index between the faces of cut blocks was tried first: it changed
//! the spacing at the wall by more than a tenth on the coarse O-O grid, where this keeps it to the first order in the
//! displacement.

use std::collections::BTreeMap;

use dip_grid::{Condition, Face, MultiBlock, Patch, metrics};
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::deform::{Anchor, Blending, local_rotation};

/// A grid that cannot be deformed, or that a deformation has folded.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeformError {
    /// Nothing moves.
    #[error("deformation: no patch of the grid is a moving wall; name the wall that follows the structure")]
    NoWall,
    /// A list of the wrong length.
    #[error("deformation: {name} has {got} entries, needed {needed}")]
    Count {
        /// What is listed.
        name: &'static str,
        /// Given.
        got: usize,
        /// Needed.
        needed: usize,
    },
    /// A displacement that is not a number.
    #[error("deformation: mode {mode}, wall node {node}: the displacement is not a finite number")]
    NotFinite {
        /// Mode number from 1.
        mode: usize,
        /// Wall node, from 0.
        node: usize,
    },
    /// A mirror plane that is no plane.
    #[error(
        "deformation: symmetry patch {patch:?} of block {block} is not plane: a node is {offset:.3e} off it; correct the grid or give it another boundary condition"
    )]
    NotPlane {
        /// Name of the patch.
        patch: String,
        /// Name of the block.
        block: String,
        /// Distance of the node, in the grid's unit.
        offset: f64,
    },
    /// A cell whose volume has turned its sign.
    #[error(
        "deformation: cell ({i}, {j}, {k}) of block {block} ({name}) is folded: its volume fell from {before:.3e} to {after:.3e}; the displacement is too large for this grid, use a smaller one or coarser cells at the wall"
    )]
    Folded {
        /// Index of the block.
        block: usize,
        /// Name of the block.
        name: String,
        /// Cell index along i, from 0.
        i: usize,
        /// Cell index along j.
        j: usize,
        /// Cell index along k.
        k: usize,
        /// Volume before.
        before: f64,
        /// Volume after.
        after: f64,
    },
}

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
    areas: Vec<f64>,
    merged: Merged,
    /// Wall node of a merged node.
    number: BTreeMap<usize, usize>,
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
}

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

/// Volumes of a deformed grid against those before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeChange {
    /// Smallest volume over the one before.
    pub smallest: f64,
    /// Largest.
    pub largest: f64,
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

/// Compares the volumes of `moved` with those of `base` cell by cell.
///
/// # Errors
/// [`DeformError::Folded`] naming the first cell whose volume has not the sign it had.
pub fn volume_change(base: &MultiBlock, moved: &MultiBlock) -> Result<VolumeChange, DeformError> {
    let none = VolumeChange {
        smallest: f64::INFINITY,
        largest: f64::NEG_INFINITY,
    };
    let parts: Vec<Result<VolumeChange, DeformError>> = base
        .blocks
        .par_iter()
        .zip(&moved.blocks)
        .enumerate()
        .map(|(b, (before, after))| {
            let mut change = none;
            for cell in 0..before.cell_count() {
                let [i, j, k] = before.cell_ijk(cell);
                let old = metrics::hexahedron_volume(&before.corners(i, j, k));
                let new = metrics::hexahedron_volume(&after.corners(i, j, k));
                let ratio = new / old;
                if ratio.is_nan() || ratio <= 0.0 {
                    return Err(DeformError::Folded {
                        block: b,
                        name: before.name.clone(),
                        i,
                        j,
                        k,
                        before: old,
                        after: new,
                    });
                }
                change.smallest = change.smallest.min(ratio);
                change.largest = change.largest.max(ratio);
            }
            Ok(change)
        })
        .collect();
    parts.into_iter().try_fold(none, |sum, part| {
        part.map(|p| VolumeChange {
            smallest: sum.smallest.min(p.smallest),
            largest: sum.largest.max(p.largest),
        })
    })
}

/// Which nodes of block faces are one: those that interfaces join, those at the same place to the bit (collapsed edges,
/// blocks that meet in an edge), and in a two-dimensional grid those across it.
#[derive(Debug, Clone)]
struct Merged {
    /// First node of each block in the count over all blocks.
    first: Vec<usize>,
    /// Towards the smallest node that is the same.
    parent: Vec<usize>,
}

impl Merged {
    fn new(grid: &MultiBlock) -> Self {
        let mut first = Vec::with_capacity(grid.blocks.len());
        let mut count = 0;
        for block in &grid.blocks {
            first.push(count);
            count += block.node_count();
        }
        let mut merged = Self {
            first,
            parent: (0..count).collect(),
        };
        for interface in &grid.topology.interfaces {
            let (a, b) = (interface.a, interface.b);
            for q in a.window.lo[1]..=a.window.hi[1] {
                for p in a.window.lo[0]..=a.window.hi[0] {
                    let [s, t] = interface.node_on_b(p, q);
                    let one = merged.of_face(grid, a.block, a.face, p, q);
                    let other = merged.of_face(grid, b.block, b.face, s, t);
                    merged.join(one, other);
                }
            }
        }
        let mut places: Vec<([u64; 3], usize)> = merged
            .face_nodes(grid)
            .into_iter()
            .map(|n| (merged.position(grid, n).map(|v| (v + 0.0).to_bits()), n))
            .collect();
        places.sort_unstable();
        for pair in places.windows(2) {
            if pair[0].0 == pair[1].0 {
                merged.join(pair[0].1, pair[1].1);
            }
        }
        if grid.is_two_dimensional() {
            for (b, block) in grid.blocks.iter().enumerate() {
                let plane = (block.ni + 1) * (block.nj + 1);
                for n in 0..plane {
                    merged.join(merged.of(b, n), merged.of(b, n + plane));
                }
            }
        }
        merged
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
    }

    fn root(&self, mut n: usize) -> usize {
        while self.parent[n] != n {
            n = self.parent[n];
        }
        n
    }

    /// The merged node of node `n` of block `b`.
    fn of(&self, b: usize, n: usize) -> usize {
        self.root(self.first[b] + n)
    }

    fn of_face(&self, grid: &MultiBlock, b: usize, face: Face, p: usize, q: usize) -> usize {
        let block = &grid.blocks[b];
        let [i, j, k] = block.node_behind(face, p, q, 0);
        self.of(b, block.node(i, j, k))
    }

    fn position(&self, grid: &MultiBlock, node: usize) -> [f64; 3] {
        let b = self.first.partition_point(|&f| f <= node) - 1;
        let (block, n) = (&grid.blocks[b], node - self.first[b]);
        [block.x[n], block.y[n], block.z[n]]
    }

    /// All merged nodes on faces of blocks, ascending.
    fn face_nodes(&self, grid: &MultiBlock) -> Vec<usize> {
        let mut all = Vec::new();
        for (b, block) in grid.blocks.iter().enumerate() {
            for face in Face::ALL {
                let [np, nq] = block.face_cells(face);
                for q in 0..=nq {
                    all.extend((0..=np).map(|p| self.of_face(grid, b, face, p, q)));
                }
            }
        }
        all.sort_unstable();
        all.dedup();
        all
    }
}

/// Planes that nodes may not leave.
struct Mirrors {
    /// Normals of the planes through a merged node.
    normals: BTreeMap<usize, Vec<Vector3<f64>>>,
    /// The one plane of the grid, if there is just one: a point on it and its normal.
    single: Option<[Vector3<f64>; 2]>,
}

/// Planes are the same within this part of the grid's size.
const PLANE: f64 = 1e-6;

impl Mirrors {
    fn new(grid: &MultiBlock, merged: &Merged) -> Result<Self, DeformError> {
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
    fn hold(&self, node: usize, mut u: Vector3<f64>) -> Vector3<f64> {
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

/// The box round the moving wall.
struct Extent {
    lo: [f64; 3],
    hi: [f64; 3],
    /// Half its diagonal.
    size: f64,
}

impl Extent {
    fn of(wall: &MovingWall) -> Self {
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

    fn distance(&self, p: [f64; 3]) -> f64 {
        let outside = |d: usize| (self.lo[d] - p[d]).max(p[d] - self.hi[d]).max(0.0);
        (outside(0).powi(2) + outside(1).powi(2) + outside(2).powi(2)).sqrt()
    }
}

/// Distance from the wall's box to the nearest node of an open boundary, or to the farthest node of a closed grid.
fn far_distance(grid: &MultiBlock, extent: &Extent) -> f64 {
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

/// Area vector of the face of a patch whose lower corner is node `(p, q)`.
fn face_area(grid: &MultiBlock, patch: &Patch, p: usize, q: usize) -> Vector3<f64> {
    let block = &grid.blocks[patch.block];
    let at = |p: usize, q: usize| block.point_at(block.node_behind(patch.face, p, q, 0));
    Vector3::from(metrics::face_area(
        at(p, q),
        at(p + 1, q),
        at(p + 1, q + 1),
        at(p, q + 1),
    ))
}

/// Anchors of all walls: nodes of the moving one, of those that stay, and the mirror images of both.
fn anchors(
    grid: &MultiBlock,
    wall: &MovingWall,
    standing: &BTreeMap<usize, f64>,
    shapes: &[Vec<Vector3<f64>>],
    mirrors: &Mirrors,
) -> Vec<Anchor> {
    let positions = wall.points();
    let count = positions.len();
    let mut area = vec![0.0; count];
    let mut neighbours: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (face, whole) in wall.faces.iter().zip(&wall.areas) {
        let quarter = 0.25 * whole;
        for n in 0..4 {
            area[face[n]] += quarter;
            neighbours[face[n]].extend([face[(n + 1) % 4], face[(n + 3) % 4]]);
        }
    }
    for (n, list) in neighbours.iter_mut().enumerate() {
        list.sort_unstable();
        list.dedup();
        list.retain(|&m| m != n);
    }
    let mut all: Vec<Anchor> = (0..count)
        .into_par_iter()
        .map(|n| Anchor {
            position: positions[n],
            area: area[n],
            moves: true,
            motion: shapes
                .iter()
                .map(|u| {
                    let edges = neighbours[n]
                        .iter()
                        .map(|&m| (positions[m] - positions[n], u[m] - u[n]));
                    [u[n], local_rotation(edges)]
                })
                .collect(),
        })
        .collect();
    all.extend(standing.iter().map(|(&node, &area)| Anchor {
        position: Vector3::from(wall.merged.position(grid, node)),
        area,
        moves: false,
        motion: vec![[Vector3::zeros(); 2]; shapes.len()],
    }));
    if let Some([point, normal]) = mirrors.single {
        let reflect = |v: &Vector3<f64>| v - normal * (2.0 * normal.dot(v));
        let images: Vec<Anchor> = all
            .iter()
            .map(|a| Anchor {
                position: point + reflect(&(a.position - point)),
                motion: a
                    .motion
                    .iter()
                    // A rotation is an axial vector: it turns round where a displacement is reflected.
                    .map(|[u, theta]| [reflect(u), -reflect(theta)])
                    .collect(),
                ..*a
            })
            .collect();
        all.extend(images);
    }
    all
}

/// Nodes of the walls that stay where they are, each with the area that belongs to it.
fn standing(grid: &MultiBlock, wall: &MovingWall) -> BTreeMap<usize, f64> {
    let mut area = BTreeMap::new();
    for (place, patch) in grid.topology.patches.iter().enumerate() {
        if !patch.condition.is_wall() || wall.patches.contains(&place) {
            continue;
        }
        for q in patch.window.lo[1]..patch.window.hi[1] {
            for p in patch.window.lo[0]..patch.window.hi[0] {
                let quarter = 0.25 * face_area(grid, patch, p, q).norm();
                for (p, q) in [(p, q), (p + 1, q), (p + 1, q + 1), (p, q + 1)] {
                    let node = wall.merged.of_face(grid, patch.block, patch.face, p, q);
                    if !wall.number.contains_key(&node) {
                        *area.entry(node).or_insert(0.0) += quarter;
                    }
                }
            }
        }
    }
    area
}
