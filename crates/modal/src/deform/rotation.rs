//! The rotation of a wall about each of its nodes.

use nalgebra::{Matrix3, Vector3};

/// Below this part of the largest one, a principal value says nothing about the rotation about its axis.
const CUTOFF: f64 = 1e-8;

/// The rotation theta, rad, that fits the motion of the neighbours best: least squares of `du - theta x dx` over the edges
/// `(dx, du)`, each weighted with `1 / |dx|^2` so that short and long edges count alike. Rotations about an axis that the
/// edges do not determine (all on one line) are zero.
pub(crate) fn local_rotation(edges: impl Iterator<Item = (Vector3<f64>, Vector3<f64>)>) -> Vector3<f64> {
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (dx, du) in edges {
        let squared = dx.norm_squared();
        if squared > 0.0 {
            matrix += Matrix3::identity() - dx * dx.transpose() / squared;
            right += dx.cross(&du) / squared;
        }
    }
    let eigen = matrix.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    (0..3)
        .filter(|&n| eigen.eigenvalues[n] > CUTOFF * largest)
        .map(|n| {
            let axis = eigen.eigenvectors.column(n);
            axis * (axis.dot(&right) / eigen.eigenvalues[n])
        })
        .sum()
}
