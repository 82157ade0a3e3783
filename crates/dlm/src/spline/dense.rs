//! The small symmetric-indefinite systems of the splines, solved with full pivoting so that a singular one is seen.

use faer::Mat;
use faer::linalg::solvers::{FullPivLu, Solve};

use super::SplineError;

/// Smallest over largest pivot below which the matrix is called singular.
const SINGULAR: f64 = 1e-13;

/// A^-1 C for the spline's matrix A (square) and the first `n_inputs` columns of the identity: coefficients per unit input,
/// [coefficient][input].
pub(super) fn coefficients(
    spline: usize,
    a: &Mat<f64>,
    n_inputs: usize,
    advice: &'static str,
) -> Result<Mat<f64>, SplineError> {
    let n = a.nrows();
    let lu = FullPivLu::new(a.as_ref());
    let pivots: Vec<f64> = (0..n).map(|i| lu.U()[(i, i)].abs()).collect();
    let largest = pivots.iter().copied().fold(0.0, f64::max);
    let smallest = pivots.iter().copied().fold(f64::INFINITY, f64::min);
    // A NaN pivot must not pass.
    let pivot_ratio = if pivots.iter().all(|p| p.is_finite()) && largest > 0.0 {
        smallest / largest
    } else {
        0.0
    };
    if pivot_ratio < SINGULAR {
        return Err(SplineError::Singular {
            spline,
            pivot_ratio,
            advice,
        });
    }
    let right = Mat::from_fn(n, n_inputs, |i, j| if i == j { 1.0 } else { 0.0 });
    Ok(lu.solve(&right))
}

/// Singular values of a set of points about their mean, largest first: 1 large = on a line, 2 = in a plane.
pub(super) fn spread(points: &[[f64; 3]]) -> [f64; 3] {
    let n = points.len().max(1) as f64;
    let mean = [0, 1, 2].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
    let covariance = Mat::from_fn(3, 3, |i, j| {
        points.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum::<f64>()
    });
    match covariance.self_adjoint_eigenvalues(faer::Side::Lower) {
        Ok(values) => [values[2], values[1], values[0]].map(|v| v.max(0.0).sqrt()),
        Err(_) => [0.0; 3],
    }
}
