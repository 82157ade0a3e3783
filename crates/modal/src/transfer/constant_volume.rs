//! The constant volume tetrahedron: a point that follows a triangle.

use nalgebra::{Matrix3, Vector3};

/// A point c tied to the triangle s1, s2, s3 by `c - s1 = alpha a + beta b + gamma d` with `a = s2 - s1`, `b = s3 - s1`,
/// `d = a x b`. When the triangle moves, alpha and beta stay and gamma changes so that the tetrahedron's volume
/// `c . d / 6 = gamma |d|^2 / 6` stays (Goura, Badcock, Woodgate, Richards, Aeronaut. J. 105, 2001).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantVolume {
    triangle: [Vector3<f64>; 3],
    /// Share of edge a.
    pub alpha: f64,
    /// Share of edge b.
    pub beta: f64,
    /// Share of the normal d, 1/m.
    pub gamma: f64,
}

impl ConstantVolume {
    /// Ties `point` to `triangle`; `None` if the triangle has no area.
    #[must_use]
    pub fn new(triangle: [Vector3<f64>; 3], point: Vector3<f64>) -> Option<Self> {
        let [a, b, d] = edges(&triangle);
        let c = point - triangle[0];
        let (aa, bb, ab) = (a.dot(&a), b.dot(&b), a.dot(&b));
        // |d|^2 = |a|^2 |b|^2 - (a . b)^2, but without its cancellation.
        let area = d.dot(&d);
        if area.is_nan() || area <= 1e-24 * aa.max(bb).powi(2) {
            return None;
        }
        Some(Self {
            triangle,
            alpha: (bb * a.dot(&c) - ab * b.dot(&c)) / area,
            beta: (aa * b.dot(&c) - ab * a.dot(&c)) / area,
            gamma: c.dot(&d) / area,
        })
    }

    /// Where the point is when the triangle's corners are at `moved`.
    #[must_use]
    pub fn position(&self, moved: &[Vector3<f64>; 3]) -> Vector3<f64> {
        let [_, _, old] = edges(&self.triangle);
        let [a, b, d] = edges(moved);
        let gamma = self.gamma * old.norm_squared() / d.norm_squared();
        moved[0] + self.alpha * a + self.beta * b + gamma * d
    }

    /// Derivatives of [`ConstantVolume::position`] by the three corners at the undeformed triangle: displacement of the
    /// point = sum over corners of matrix times displacement. They add up to the unit matrix.
    ///
    /// With `dd = da x b + a x db` and `dgamma = -2 gamma (d . dd) / |d|^2`:
    /// `dc = ds1 + alpha da + beta db + G dd`, `G = gamma (1 - 2 d d^T / |d|^2)`.
    #[must_use]
    pub fn derivatives(&self) -> [Matrix3<f64>; 3] {
        let [a, b, d] = edges(&self.triangle);
        let g = self.gamma * (Matrix3::identity() - d * d.transpose() * (2.0 / d.norm_squared()));
        let second = Matrix3::identity() * self.alpha - g * b.cross_matrix();
        let third = Matrix3::identity() * self.beta + g * a.cross_matrix();
        [Matrix3::identity() - second - third, second, third]
    }
}

/// Edges a and b from the first corner, and their cross product.
fn edges(t: &[Vector3<f64>; 3]) -> [Vector3<f64>; 3] {
    let (a, b) = (t[1] - t[0], t[2] - t[0]);
    [a, b, a.cross(&b)]
}
