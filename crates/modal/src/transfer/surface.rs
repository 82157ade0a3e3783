//! The structure's nodes as a surface of triangles.

use std::collections::{BTreeMap, HashSet};

use delaunator::{Point, triangulate};
use nalgebra::{Matrix3, Vector3};

use super::error::TransferError;
use crate::modes::Modes;

/// Structural nodes joined by triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct StructuralSurface {
    nodes: Vec<Vector3<f64>>,
    triangles: Vec<[usize; 3]>,
    left_out: Vec<usize>,
}

/// A triangle on the rim is a sliver if its height over its outer edge is less than this part of that edge: the hull of
/// nodes that stand in line but for rounding.
const SLIVER: f64 = 0.02;
/// Nodes nearer than this part of the extent are one in the plan view.
const SAME: f64 = 1e-9;

impl StructuralSurface {
    /// A surface with known triangles, by their nodes counted from 0.
    ///
    /// # Errors
    /// [`TransferError`] naming the triangle.
    pub fn new(nodes: Vec<Vector3<f64>>, triangles: Vec<[usize; 3]>) -> Result<Self, TransferError> {
        check_finite(&nodes, "structural node")?;
        for (n, t) in triangles.iter().enumerate() {
            let wrong = |problem| TransferError::Triangle {
                triangle: n,
                nodes: *t,
                count: nodes.len(),
                problem,
            };
            if t.iter().any(|&i| i >= nodes.len()) {
                return Err(wrong("names a node that does not exist"));
            }
            let (a, b) = (nodes[t[1]] - nodes[t[0]], nodes[t[2]] - nodes[t[0]]);
            if a.cross(&b).norm() <= 1e-10 * a.norm_squared().max(b.norm_squared()) {
                return Err(wrong("has no area; leave it out"));
            }
        }
        if triangles.is_empty() {
            return Err(TransferError::TooFewNodes { got: nodes.len() });
        }
        let used: HashSet<usize> = triangles.iter().flatten().copied().collect();
        let left_out = (0..nodes.len()).filter(|n| !used.contains(n)).collect();
        Ok(Self {
            nodes,
            triangles,
            left_out,
        })
    }

    /// Joins nodes by Delaunay triangles in their plan view: the plane that fits them best. Of nodes at the same place there
    /// only the first is used, and slivers along the rim are left out.
    ///
    /// # Errors
    /// [`TransferError::TooFewNodes`], [`TransferError::OnOneLine`] and [`TransferError::NotFinite`].
    pub fn triangulate(nodes: &[Vector3<f64>]) -> Result<Self, TransferError> {
        check_finite(nodes, "structural node")?;
        if nodes.len() < 3 {
            return Err(TransferError::TooFewNodes { got: nodes.len() });
        }
        let count = nodes.len() as f64;
        let centre = nodes.iter().sum::<Vector3<f64>>() / count;
        let spread: Matrix3<f64> = nodes.iter().map(|p| (p - centre) * (p - centre).transpose()).sum();
        let axes = spread.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| axes.eigenvalues[b].total_cmp(&axes.eigenvalues[a]));
        let [long, wide] = [order[0], order[1]].map(|d| axes.eigenvectors.column(d).into_owned());
        let size = |d: usize| (axes.eigenvalues[d].max(0.0) / count).sqrt();
        let ratio = size(order[1]) / size(order[0]).max(f64::MIN_POSITIVE);
        if ratio.is_nan() || ratio <= 1e-6 {
            return Err(TransferError::OnOneLine {
                nodes: nodes.len(),
                ratio,
            });
        }
        let plan: Vec<[f64; 2]> = nodes
            .iter()
            .map(|p| [(p - centre).dot(&long), (p - centre).dot(&wide)])
            .collect();
        let kept = distinct(&plan, SAME * size(order[0]));
        let points: Vec<Point> = kept
            .iter()
            .map(|&n| Point {
                x: plan[n][0],
                y: plan[n][1],
            })
            .collect();
        let found = triangulate(&points);
        let triangles: Vec<[usize; 3]> = found
            .triangles
            .chunks_exact(3)
            .map(|t| [kept[t[0]], kept[t[1]], kept[t[2]]])
            .collect();
        let triangles = without_slivers(triangles, &plan);
        if triangles.is_empty() {
            // A line but for rounding in the table.
            return Err(TransferError::OnOneLine {
                nodes: nodes.len(),
                ratio,
            });
        }
        Self::new(nodes.to_vec(), triangles)
    }

    /// The nodes of `modes`, joined as by [`StructuralSurface::triangulate`].
    ///
    /// # Errors
    /// As [`StructuralSurface::triangulate`].
    pub fn of_modes(modes: &Modes) -> Result<Self, TransferError> {
        let nodes: Vec<Vector3<f64>> = modes.nodes.iter().map(|n| n.position).collect();
        Self::triangulate(&nodes)
    }

    /// Positions `[node]`.
    #[must_use]
    pub fn nodes(&self) -> &[Vector3<f64>] {
        &self.nodes
    }

    /// Nodes of each triangle, counted from 0.
    #[must_use]
    pub fn triangles(&self) -> &[[usize; 3]] {
        &self.triangles
    }

    /// Nodes in no triangle: they neither move the surface nor receive forces.
    #[must_use]
    pub fn left_out(&self) -> &[usize] {
        &self.left_out
    }

    /// Corners of a triangle.
    pub(super) fn corners(&self, triangle: usize) -> [Vector3<f64>; 3] {
        self.triangles[triangle].map(|n| self.nodes[n])
    }
}

pub(super) fn check_finite(points: &[Vector3<f64>], what: &'static str) -> Result<(), TransferError> {
    match points.iter().position(|p| !p.iter().all(|v| v.is_finite())) {
        Some(index) => Err(TransferError::NotFinite { what, index }),
        None => Ok(()),
    }
}

/// Points that are not at the place of an earlier one, on a raster of `tolerance` and its neighbours.
fn distinct(plan: &[[f64; 2]], tolerance: f64) -> Vec<usize> {
    let cell = |v: f64| (v / tolerance.max(f64::MIN_POSITIVE)).round();
    let mut taken: BTreeMap<[i64; 2], ()> = BTreeMap::new();
    let mut kept = Vec::with_capacity(plan.len());
    for (n, p) in plan.iter().enumerate() {
        let [i, j] = [cell(p[0]) as i64, cell(p[1]) as i64];
        let near = (-1..=1).any(|a| (-1..=1).any(|b| taken.contains_key(&[i.saturating_add(a), j.saturating_add(b)])));
        if !near {
            taken.insert([i, j], ());
            kept.push(n);
        }
    }
    kept
}

/// Removes slivers from the rim inward until there are none.
fn without_slivers(mut triangles: Vec<[usize; 3]>, plan: &[[f64; 2]]) -> Vec<[usize; 3]> {
    loop {
        let mut uses: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        for t in &triangles {
            for (a, b, _) in sides(t) {
                *uses.entry((a.min(b), a.max(b))).or_default() += 1;
            }
        }
        let before = triangles.len();
        triangles.retain(|t| {
            !sides(t).any(|(a, b, c)| {
                let (p, q, r) = (plan[a], plan[b], plan[c]);
                let (e, f) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
                let squared = e[0] * e[0] + e[1] * e[1];
                let height = (e[0] * f[1] - e[1] * f[0]).abs() / squared;
                let foot = (e[0] * f[0] + e[1] * f[1]) / squared;
                uses[&(a.min(b), a.max(b))] == 1 && height < SLIVER && (0.0..=1.0).contains(&foot)
            })
        });
        if triangles.len() == before {
            return triangles;
        }
    }
}

/// Sides of a triangle with the corner opposite.
fn sides(t: &[usize; 3]) -> impl Iterator<Item = (usize, usize, usize)> {
    [(t[0], t[1], t[2]), (t[1], t[2], t[0]), (t[2], t[0], t[1])].into_iter()
}
