//! The plane of a shell element, its corners in that plane, and its integration points.

use nalgebra::{Matrix3, Vector3};

use crate::error::ModelError;

/// Height of a corner over the mean plane, over the square root of the area, past which a
/// quadrilateral is refused. Nastran warns from 0.05.
const WARP_LIMIT: f64 = 0.1;
/// Smallest ratio of area to the square of the longest side.
const AREA_LIMIT: f64 = 1e-8;
/// Smallest ratio of the Jacobian at a corner to its mean: 0 is an interior angle of 180 degrees.
const JACOBIAN_LIMIT: f64 = 1e-4;

/// Area coordinates of the three integration points of a triangle (mid-sides 1-2, 2-3, 3-1; exact
/// for quadratics), each with a third of the area.
pub fn triangle_points() -> [[f64; 3]; 3] {
    [[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]]
}

/// Natural coordinates (xi, eta) of the 2 x 2 Gauss points of a quadrilateral, in the order of the
/// corners they are next to; each has weight one.
pub fn quad_points() -> [[f64; 2]; 4] {
    let g = 1.0 / 3.0_f64.sqrt();
    [[-g, -g], [g, -g], [g, g], [-g, g]]
}

/// Bilinear shape functions at (xi, eta).
pub(crate) fn quad_shape(xi: f64, eta: f64) -> [f64; 4] {
    [
        0.25 * (1.0 - xi) * (1.0 - eta),
        0.25 * (1.0 + xi) * (1.0 - eta),
        0.25 * (1.0 + xi) * (1.0 + eta),
        0.25 * (1.0 - xi) * (1.0 + eta),
    ]
}

/// Derivatives of the bilinear shape functions by xi and by eta.
pub(crate) fn quad_shape_derivatives(xi: f64, eta: f64) -> ([f64; 4], [f64; 4]) {
    (
        [
            -0.25 * (1.0 - eta),
            0.25 * (1.0 - eta),
            0.25 * (1.0 + eta),
            -0.25 * (1.0 + eta),
        ],
        [
            -0.25 * (1.0 - xi),
            -0.25 * (1.0 + xi),
            0.25 * (1.0 + xi),
            0.25 * (1.0 - xi),
        ],
    )
}

/// Jacobian of the map from natural to plane coordinates at one point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Jacobian {
    /// Determinant.
    pub det: f64,
    /// Inverse, [row = d/dx, d/dy][column = d/dxi, d/deta].
    pub inverse: [[f64; 2]; 2],
}

impl Jacobian {
    /// From derivatives of the shape functions and corner coordinates.
    pub fn new(d_xi: &[f64], d_eta: &[f64], corners: &[[f64; 2]]) -> Self {
        let sum = |d: &[f64], axis: usize| d.iter().zip(corners).map(|(a, c)| a * c[axis]).sum::<f64>();
        let (x_xi, y_xi, x_eta, y_eta) = (sum(d_xi, 0), sum(d_xi, 1), sum(d_eta, 0), sum(d_eta, 1));
        let det = x_xi * y_eta - x_eta * y_xi;
        Self {
            det,
            inverse: [[y_eta / det, -y_xi / det], [-x_eta / det, x_xi / det]],
        }
    }

    /// (d/dx, d/dy) of a function from its natural derivatives.
    pub fn gradient(&self, d_xi: f64, d_eta: f64) -> [f64; 2] {
        let j = &self.inverse;
        [j[0][0] * d_xi + j[0][1] * d_eta, j[1][0] * d_xi + j[1][1] * d_eta]
    }
}

/// A shell element laid into its mean plane.
#[derive(Debug, Clone)]
pub struct ShellPlane {
    /// Element axes: columns x (along side 1-2), y, z (normal) in basic axes.
    pub axes: Matrix3<f64>,
    /// Corners in the plane, [corner][x, y].
    pub corners: Vec<[f64; 2]>,
    /// From each node to its corner in the mean plane, basic axes (zero for a flat element).
    pub to_plane: Vec<Vector3<f64>>,
    /// Area.
    pub area: f64,
    /// Largest height of a node over the mean plane over the square root of the area.
    pub warp: f64,
}

impl ShellPlane {
    /// Lays the nodes at `points` (three or four) into their mean plane; `place` names the element.
    ///
    /// # Errors
    /// [`ModelError::BadElement`]: no area, crossed or re-entrant corners, or warped too far.
    pub fn new(points: &[Vector3<f64>], place: &dyn Fn() -> String) -> Result<Self, ModelError> {
        let n = points.len();
        let bad = |problem, measure, limit| {
            Err(ModelError::BadElement {
                place: place(),
                problem,
                measure,
                limit,
            })
        };
        let centre = points.iter().sum::<Vector3<f64>>() / n as f64;
        // Twice the area vector; for a quadrilateral the diagonals' product gives the mean plane.
        let twice = if n == 4 {
            (points[2] - points[0]).cross(&(points[3] - points[1]))
        } else {
            (points[1] - points[0]).cross(&(points[2] - points[0]))
        };
        let longest = (0..n)
            .map(|i| (points[(i + 1) % n] - points[i]).norm())
            .fold(0.0, f64::max);
        let shape = 0.5 * twice.norm() / (longest * longest);
        // A NaN (all nodes at one point) must not pass.
        if shape.is_nan() || shape < AREA_LIMIT {
            return bad("no area (area over longest side squared)", shape, AREA_LIMIT);
        }
        let z = twice.normalize();
        let side = points[1] - points[0];
        let in_plane = side - z * z.dot(&side);
        if in_plane.norm() < AREA_LIMIT.sqrt() * longest {
            return bad(
                "side 1-2 has no length in the plane",
                in_plane.norm() / longest,
                AREA_LIMIT.sqrt(),
            );
        }
        let x = in_plane.normalize();
        let y = z.cross(&x);
        let axes = Matrix3::from_columns(&[x, y, z]);
        let local: Vec<Vector3<f64>> = points.iter().map(|p| axes.tr_mul(&(p - centre))).collect();
        let corners: Vec<[f64; 2]> = local.iter().map(|p| [p.x, p.y]).collect();
        let area = 0.5 * twice.norm();
        let warp = local.iter().map(|p| p.z.abs()).fold(0.0, f64::max) / area.sqrt();
        if warp > WARP_LIMIT {
            return bad("warped out of its plane (height over root of area)", warp, WARP_LIMIT);
        }
        if n == 4 {
            for (xi, eta) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let (a, b) = quad_shape_derivatives(xi, eta);
                let ratio = 4.0 * Jacobian::new(&a, &b, &corners).det / area;
                if ratio < JACOBIAN_LIMIT {
                    return bad(
                        "crossed, reversed or re-entrant corners (Jacobian over mean)",
                        ratio,
                        JACOBIAN_LIMIT,
                    );
                }
            }
        }
        let to_plane = local.iter().map(|p| z * -p.z).collect();
        Ok(Self {
            axes,
            corners,
            to_plane,
            area,
            warp,
        })
    }
}
