//! The nearest point of a triangle.

use nalgebra::Vector3;

/// Barycentric coordinates of the point of triangle `t` nearest to `p` (C. Ericson, Real-Time Collision Detection, 2005,
/// 5.1.5: the region of a corner, an edge or the inside is found from six projections).
pub(super) fn closest(t: &[Vector3<f64>; 3], p: &Vector3<f64>) -> [f64; 3] {
    let (ab, ac) = (t[1] - t[0], t[2] - t[0]);
    let project = |corner: usize| {
        let v = p - t[corner];
        (ab.dot(&v), ac.dot(&v))
    };
    let (d1, d2) = project(0);
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let (d3, d4) = project(1);
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let s = d1 / (d1 - d3);
        return [1.0 - s, s, 0.0];
    }
    let (d5, d6) = project(2);
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let s = d2 / (d2 - d6);
        return [1.0 - s, 0.0, s];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - s, s];
    }
    let sum = va + vb + vc;
    let (v, w) = (vb / sum, vc / sum);
    [1.0 - v - w, v, w]
}
