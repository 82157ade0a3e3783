//! The transfer as a matrix: displacements out, forces back by its transpose.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::closest::closest;
use super::constant_volume::ConstantVolume;
use super::error::TransferError;
use super::surface::{StructuralSurface, check_finite};
use crate::modes::Modes;

/// How a point hangs on the structure's triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Attachment {
    /// On the nearest triangle, as published. The surface has the triangles' facets, and jumps a little between two of
    /// them where it stands off or overhangs.
    Nearest,
    /// On the triangles round the nearest one, weighted so that the result is continuous, and of second degree instead of
    /// first where triangles are regular. The default.
    ///
    /// With p the nearest point of the triangles to c, lambda its barycentric coordinates, B(x) the mean of the tetrahedra
    /// of the triangles round the three corners, weighted with lambda and area, and P linear interpolation:
    /// `B(c) + (P(p) - B(p)) / 2`. Interpolation errs by half the second derivative on one side, expansion about
    /// the corners by as much on the other.
    #[default]
    Blended,
}

/// A linear map from displacements of structural nodes to displacements of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Transfer {
    structural: Vec<Vector3<f64>>,
    points: Vec<Vector3<f64>>,
    /// Entries of point n are `start[n]..start[n + 1]`.
    start: Vec<usize>,
    entries: Vec<(usize, Matrix3<f64>)>,
    left_out: usize,
    largest_offset: f64,
}

/// What [`Transfer::check`] found; the first four are zero but for rounding.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferCheck {
    /// Largest error under a rigid translation of 1 m, m.
    pub translation_error_m: f64,
    /// Largest error under a (linearized) rigid rotation of 1 rad about the middle of the structure, over the extent.
    pub rotation_error: f64,
    /// Error of total force and moment that come back, over the sum of the forces (and times the extent).
    pub balance_error: f64,
    /// Difference of the work done on both sides over the work.
    pub virtual_work_error: f64,
    /// Largest sum of the norms of the matrices of one point: 1 for interpolation, more where displacements are
    /// extrapolated or the point stands off the triangles.
    pub amplification: f64,
    /// Largest distance of a point from the triangles, m.
    pub largest_offset_m: f64,
    /// Structural nodes in no triangle.
    pub nodes_left_out: usize,
}

/// Entries of one point and its distance from the triangles, m.
struct Row {
    entries: Vec<(usize, Matrix3<f64>)>,
    offset: f64,
}

impl Transfer {
    /// Ties `points` to `surface`.
    ///
    /// # Errors
    /// [`TransferError::NotFinite`].
    pub fn new(
        surface: &StructuralSurface,
        points: &[Vector3<f64>],
        attachment: Attachment,
    ) -> Result<Self, TransferError> {
        check_finite(points, "surface point")?;
        let hosts = Hosts::new(surface);
        let rows: Vec<Row> = points.par_iter().map(|p| hosts.row(p, attachment)).collect();
        let mut start = vec![0];
        let mut entries = Vec::new();
        let mut largest_offset = 0.0_f64;
        for row in rows {
            entries.extend(row.entries);
            start.push(entries.len());
            largest_offset = largest_offset.max(row.offset);
        }
        Ok(Self {
            structural: surface.nodes().to_vec(),
            points: points.to_vec(),
            start,
            entries,
            left_out: surface.left_out().len(),
            largest_offset,
        })
    }

    /// Number of structural nodes.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.structural.len()
    }

    /// Number of points.
    #[must_use]
    pub fn point_count(&self) -> usize {
        self.points.len()
    }

    /// The matrix's 3 x 3 blocks of `point`: (structural node, block).
    pub fn row(&self, point: usize) -> &[(usize, Matrix3<f64>)] {
        &self.entries[self.start[point]..self.start[point + 1]]
    }

    /// Displacements `[point]` for displacements of the structural nodes `[node]`.
    ///
    /// # Errors
    /// [`TransferError::Count`].
    pub fn displacements(&self, nodes: &[Vector3<f64>]) -> Result<Vec<Vector3<f64>>, TransferError> {
        self.check_count("the list of nodal displacements", nodes.len(), self.structural.len())?;
        Ok((0..self.points.len())
            .into_par_iter()
            .map(|p| self.row(p).iter().map(|(n, m)| m * nodes[*n]).sum())
            .collect())
    }

    /// Forces `[node]` that do the same work as `forces` on the points `[point]`: the transpose.
    ///
    /// # Errors
    /// [`TransferError::Count`].
    pub fn forces(&self, forces: &[Vector3<f64>]) -> Result<Vec<Vector3<f64>>, TransferError> {
        self.check_count("the list of forces", forces.len(), self.points.len())?;
        let mut nodes = vec![Vector3::zeros(); self.structural.len()];
        for (p, f) in forces.iter().enumerate() {
            for (n, m) in self.row(p) {
                nodes[*n] += m.tr_mul(f);
            }
        }
        Ok(nodes)
    }

    /// Mode shapes on the points: `[mode][point]`, in the units of the table's displacements. Only displacements of the
    /// nodes enter; rotations, where a table has them, follow from the neighbours.
    ///
    /// # Errors
    /// [`TransferError::Count`] if the modes are of other nodes.
    pub fn modes(&self, modes: &Modes) -> Result<Vec<Vec<Vector3<f64>>>, TransferError> {
        self.check_count("the table of modes", modes.nodes.len(), self.structural.len())?;
        (0..modes.count())
            .map(|m| {
                let nodes: Vec<Vector3<f64>> = (0..modes.nodes.len()).map(|n| modes.motion(m, n).0).collect();
                self.displacements(&nodes)
            })
            .collect()
    }

    /// Inspects the matrix: rigid motion, balance, virtual work, extrapolation.
    #[must_use]
    pub fn check(&self) -> TransferCheck {
        let count = self.structural.len().max(1) as f64;
        let centre = self.structural.iter().sum::<Vector3<f64>>() / count;
        let extent = self
            .structural
            .iter()
            .chain(&self.points)
            .map(|p| (p - centre).norm())
            .fold(f64::MIN_POSITIVE, f64::max);
        let through = |motion: &dyn Fn(&Vector3<f64>) -> Vector3<f64>| {
            let nodes: Vec<Vector3<f64>> = self.structural.iter().map(motion).collect();
            let worst = (0..self.points.len()).map(|p| {
                let found: Vector3<f64> = self.row(p).iter().map(|(n, m)| m * nodes[*n]).sum();
                (found - motion(&self.points[p])).norm()
            });
            worst.fold(0.0, f64::max)
        };
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let translation = axes.iter().map(|e| through(&|_| *e)).fold(0.0, f64::max);
        let rotation = axes
            .iter()
            .map(|e| through(&|p| e.cross(&(p - centre))) / extent)
            .fold(0.0, f64::max);
        // A force and a displacement without any pattern, the same in every run.
        let mut number = 0x9e37_79b9_7f4a_7c15_u64;
        let mut random = || {
            number ^= number << 13;
            number ^= number >> 7;
            number ^= number << 17;
            (number >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let mut vector = || Vector3::new(random(), random(), random());
        let forces: Vec<Vector3<f64>> = self.points.iter().map(|_| vector()).collect();
        let motion: Vec<Vector3<f64>> = self.structural.iter().map(|_| vector()).collect();
        let (mut back, mut work_out, mut work_size) = (vec![Vector3::zeros(); self.structural.len()], 0.0, 0.0);
        for (p, f) in forces.iter().enumerate() {
            let mut moved = Vector3::zeros();
            for (n, m) in self.row(p) {
                back[*n] += m.tr_mul(f);
                moved += m * motion[*n];
            }
            work_out += f.dot(&moved);
            work_size += f.norm() * moved.norm();
        }
        let work_in: f64 = back.iter().zip(&motion).map(|(f, u)| f.dot(u)).sum();
        let wrench = |at: &[Vector3<f64>], f: &[Vector3<f64>]| {
            at.iter()
                .zip(f)
                .fold((Vector3::zeros(), Vector3::zeros()), |(force, moment), (p, f)| {
                    (force + f, moment + (p - centre).cross(f) / extent)
                })
        };
        let (f0, m0) = wrench(&self.points, &forces);
        let (f1, m1) = wrench(&self.structural, &back);
        let size: f64 = forces.iter().map(Vector3::norm).sum::<f64>().max(f64::MIN_POSITIVE);
        TransferCheck {
            translation_error_m: translation,
            rotation_error: rotation,
            balance_error: ((f1 - f0).norm() + (m1 - m0).norm()) / size,
            virtual_work_error: (work_in - work_out).abs() / work_size.max(f64::MIN_POSITIVE),
            amplification: (0..self.points.len())
                .map(|p| self.row(p).iter().map(|(_, m)| m.singular_values().max()).sum())
                .fold(0.0, f64::max),
            largest_offset_m: self.largest_offset,
            nodes_left_out: self.left_out,
        }
    }

    fn check_count(&self, name: &'static str, got: usize, needed: usize) -> Result<(), TransferError> {
        if got == needed {
            Ok(())
        } else {
            Err(TransferError::Count { name, got, needed })
        }
    }
}

/// The surface with what a search needs.
struct Hosts<'a> {
    surface: &'a StructuralSurface,
    /// Bounding spheres [triangle].
    spheres: Vec<(Vector3<f64>, f64)>,
    areas: Vec<f64>,
    /// Triangles round a node `[node]`.
    fans: Vec<Vec<usize>>,
}

impl<'a> Hosts<'a> {
    fn new(surface: &'a StructuralSurface) -> Self {
        let count = surface.triangles().len();
        let mut fans = vec![Vec::new(); surface.nodes().len()];
        for (t, nodes) in surface.triangles().iter().enumerate() {
            for &n in nodes {
                fans[n].push(t);
            }
        }
        let spheres = (0..count).map(|t| {
            let corners = surface.corners(t);
            let middle = corners.iter().sum::<Vector3<f64>>() / 3.0;
            (middle, corners.iter().map(|c| (c - middle).norm()).fold(0.0, f64::max))
        });
        let areas = (0..count).map(|t| {
            let [a, b, c] = surface.corners(t);
            0.5 * (b - a).cross(&(c - a)).norm()
        });
        Self {
            surface,
            spheres: spheres.collect(),
            areas: areas.collect(),
            fans,
        }
    }

    /// The nearest triangle with the barycentric coordinates of its nearest point, and the distance. Among those at the
    /// same distance (beyond an edge or a corner of the rim) the one that needs the least extrapolation.
    fn nearest(&self, p: &Vector3<f64>) -> (usize, [f64; 3], f64) {
        let mut best = (0, [1.0, 0.0, 0.0], f64::INFINITY);
        let mut outside = f64::INFINITY;
        for (t, (middle, radius)) in self.spheres.iter().enumerate() {
            let tie = 1e-9 * radius;
            if (p - middle).norm() - radius > best.2 + tie {
                continue;
            }
            let corners = self.surface.corners(t);
            let lambda = closest(&corners, p);
            let distance = (p - combine(&corners, &lambda)).norm();
            if distance > best.2 + tie {
                continue;
            }
            let extrapolation = ConstantVolume::new(corners, *p).map_or(f64::INFINITY, |c| {
                -(1.0 - c.alpha - c.beta).min(c.alpha).min(c.beta).min(0.0)
            });
            if distance < best.2 - tie || extrapolation < outside {
                best = (t, lambda, distance);
                outside = extrapolation;
            }
        }
        best
    }

    fn row(&self, p: &Vector3<f64>, attachment: Attachment) -> Row {
        let (host, lambda, offset) = self.nearest(p);
        let mut entries: Vec<(usize, Matrix3<f64>)> = Vec::new();
        let mut add = |node: usize, m: Matrix3<f64>| match entries.iter_mut().find(|e| e.0 == node) {
            Some(entry) => entry.1 += m,
            None => entries.push((node, m)),
        };
        let mut tie = |triangle: usize, point: Vector3<f64>, weight: f64| {
            // Triangles without area were refused when the surface was made.
            if let Some(c) = ConstantVolume::new(self.surface.corners(triangle), point) {
                for (n, m) in self.surface.triangles()[triangle].iter().zip(c.derivatives()) {
                    add(*n, weight * m);
                }
            }
        };
        match attachment {
            Attachment::Nearest => tie(host, *p, 1.0),
            Attachment::Blended => {
                let corners = self.surface.triangles()[host];
                let foot = combine(&self.surface.corners(host), &lambda);
                for (corner, share) in corners.iter().zip(lambda) {
                    let fan = &self.fans[*corner];
                    let whole: f64 = fan.iter().map(|&t| self.areas[t]).sum();
                    for &t in fan {
                        let weight = share * self.areas[t] / whole;
                        tie(t, *p, weight);
                        tie(t, foot, -0.5 * weight);
                    }
                }
                for (corner, share) in corners.iter().zip(lambda) {
                    add(*corner, 0.5 * share * Matrix3::identity());
                }
                entries.retain(|(_, m)| m.iter().any(|v| *v != 0.0));
            }
        }
        entries.sort_by_key(|e| e.0);
        Row { entries, offset }
    }
}

fn combine(corners: &[Vector3<f64>; 3], lambda: &[f64; 3]) -> Vector3<f64> {
    corners[0] * lambda[0] + corners[1] * lambda[1] + corners[2] * lambda[2]
}
