//! Plate bending with discrete shear: DKMQ and DKMT, whose thin limits are DKQ and DKT.
//!
//! Katili, "A new discrete Kirchhoff-Mindlin element based on Mindlin-Reissner plate theory and assumed
//! shear strain fields", Int. J. Numer. Methods Eng. 36 (1993), part I (DKMT) p. 1859, part II (DKMQ)
//! p. 1885; thin limits: Batoz and Tahar 1982 (DKQ), Batoz, Bathe and Ho 1980 (DKT).
//!
//! Rotations of the normal: u = z beta_x, v = z beta_y, so beta_x = theta_y, beta_y = -theta_x and the
//! shear strain is gamma = grad w + beta. The rotation along a side of length L is linear plus a bubble
//! of height Delta:  beta_s = linear + 4 (s/L)(1 - s/L) Delta.  Delta follows from the mean shear
//! strain of the side in two ways, by kinematics and by equilibrium of the side as a beam
//! (T = dM/ds, M = D_s beta_s,s, T = S_s gamma):
//!
//!   gamma = (w_j - w_i)/L + (beta_si + beta_sj)/2 + (2/3) Delta  and  gamma = -(2/3) phi Delta,
//!   phi = 12 D_s / (S_s L^2).
//!
//! Thin plates have phi = 0: no shear strain energy at all, and so no locking.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

use super::geometry::Jacobian;

/// One side of an element: ends, length, direction.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Side {
    /// First corner.
    pub i: usize,
    /// Second corner.
    pub j: usize,
    /// Length.
    pub length: f64,
    /// Direction cosine with x.
    pub c: f64,
    /// Direction cosine with y.
    pub s: f64,
    /// Shear influence 12 D_s / (S_s L^2); zero when rigid in shear.
    pub phi: f64,
}

impl Side {
    /// Side from corner `i` to corner `j`; `d` and `shear` are the stiffness at its middle.
    pub fn new(i: usize, j: usize, corners: &[[f64; 2]], d: &Matrix3<f64>, shear: Option<&Matrix2<f64>>) -> Self {
        let (dx, dy) = (corners[j][0] - corners[i][0], corners[j][1] - corners[i][1]);
        let length = dx.hypot(dy);
        let (c, s) = (dx / length, dy / length);
        let phi = shear.map_or(0.0, |g| {
            // Moment along the side per curvature along the side (the turned D11), and shear likewise.
            let e = Vector3::new(c * c, s * s, 2.0 * s * c);
            let along = Vector2::new(c, s);
            let s_s = along.dot(&(g * along));
            // A side along a knife edge has neither stiffness: its rotation is then Kirchhoff's.
            if s_s > 0.0 {
                12.0 * e.dot(&(d * e)) / (s_s * length * length)
            } else {
                0.0
            }
        });
        Self {
            i,
            j,
            length,
            c,
            s,
            phi,
        }
    }

    /// Delta as a row over (w, beta_x, beta_y) of corner i, then of corner j.
    pub fn delta(&self) -> [[f64; 3]; 2] {
        let f = -1.5 / (self.length * (1.0 + self.phi));
        let beta = 0.5 * self.length * f;
        [[-f, beta * self.c, beta * self.s], [f, beta * self.c, beta * self.s]]
    }

    /// Mean shear strain of the side per Delta.
    pub fn shear_per_delta(&self) -> f64 {
        -2.0 / 3.0 * self.phi
    }
}

/// Derivatives by x and y of the bubbles P_k of the four sides 12, 23, 34, 41 of a quadrilateral.
pub(crate) fn quad_bubbles(xi: f64, eta: f64, jacobian: &Jacobian) -> [[f64; 2]; 4] {
    let natural = [
        [-xi * (1.0 - eta), -0.5 * (1.0 - xi * xi)],
        [0.5 * (1.0 - eta * eta), -eta * (1.0 + xi)],
        [-xi * (1.0 + eta), 0.5 * (1.0 - xi * xi)],
        [-0.5 * (1.0 - eta * eta), -eta * (1.0 - xi)],
    ];
    natural.map(|[a, b]| jacobian.gradient(a, b))
}

/// Derivatives by x and y of the bubbles 4 L_i L_j of the sides 12, 23, 31 of a triangle, from the
/// area coordinates and their gradients.
pub(crate) fn triangle_bubbles(l: &[f64; 3], gradient: &[[f64; 2]; 3]) -> [[f64; 2]; 3] {
    [(0, 1), (1, 2), (2, 0)].map(|(i, j)| [0, 1].map(|a| 4.0 * (gradient[i][a] * l[j] + l[i] * gradient[j][a])))
}

/// Shear strain in a quadrilateral at (xi, eta) per mean shear strain of its four sides: the
/// natural components vary linearly between opposite sides. [row = gamma_x, gamma_y][side]
pub(crate) fn quad_shear(xi: f64, eta: f64, sides: &[Side; 4], jacobian: &Jacobian) -> [[f64; 4]; 2] {
    // gamma_xi = gamma_s ds/dxi with ds/dxi = +- L/2: sides 34 and 41 run against xi and eta.
    let xi_part = [
        0.25 * (1.0 - eta) * sides[0].length,
        0.0,
        -0.25 * (1.0 + eta) * sides[2].length,
        0.0,
    ];
    let eta_part = [
        0.0,
        0.25 * (1.0 + xi) * sides[1].length,
        0.0,
        -0.25 * (1.0 - xi) * sides[3].length,
    ];
    let mut out = [[0.0; 4]; 2];
    for side in 0..4 {
        let g = jacobian.gradient(xi_part[side], eta_part[side]);
        out[0][side] = g[0];
        out[1][side] = g[1];
    }
    out
}

/// Shear strain in a triangle per mean shear strain of its three sides 12, 23, 31: each corner takes
/// the vector whose components along its two sides are theirs, linear between. [row][side]
pub(crate) fn triangle_shear(l: &[f64; 3], sides: &[Side; 3]) -> [[f64; 3]; 2] {
    let mut out = [[0.0; 3]; 2];
    for (corner, &weight) in l.iter().enumerate() {
        // The side that leaves the corner and the one that arrives.
        let (a, b) = (corner, (corner + 2) % 3);
        let (ca, sa, cb, sb) = (sides[a].c, sides[a].s, sides[b].c, sides[b].s);
        let det = ca * sb - sa * cb;
        out[0][a] += weight * sb / det;
        out[0][b] -= weight * sa / det;
        out[1][a] -= weight * cb / det;
        out[1][b] += weight * ca / det;
    }
    out
}
