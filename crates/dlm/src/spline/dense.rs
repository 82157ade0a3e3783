//! The small symmetric-indefinite systems of the splines.

use faer::{Mat, Par};

use super::SplineError;
use crate::lu::Lu;

/// Reciprocal condition number below which the matrix is called singular.
const SINGULAR: f64 = 1e-13;

/// A^-1 C for the spline's matrix A (square) and the first `n_inputs` columns of the identity: coefficients per unit input,
/// [coefficient][input].
///
/// The columns are most of the inverse, so the product of their norm with that of A shows a singular matrix. `exact` names
/// inputs whose coefficients are known, (inputs, coefficients): the linear fields. With thousands of nodes the matrix is ill
/// conditioned and they come out to some 1e-7; the solution is put right for them, so that rigid motions, and with them forces
/// and moments, are kept to round-off.
pub(super) fn coefficients(
    spline: usize,
    a: &Mat<f64>,
    n_inputs: usize,
    exact: Vec<(Vec<f64>, Vec<f64>)>,
    advice: &'static str,
) -> Result<Mat<f64>, SplineError> {
    let n = a.nrows();
    let columns: Vec<f64> = (0..n).flat_map(|j| (0..n).map(move |i| a[(i, j)])).collect();
    // One thread: the result may not depend on how many there are.
    let lu = Lu::new(n, columns, Par::Seq);
    let mut solution = Mat::from_fn(n, n_inputs, |i, j| if i == j { 1.0 } else { 0.0 });
    lu.solve_in_place(solution.as_mut());
    let largest_sum = |m: &Mat<f64>| {
        (0..m.ncols())
            .map(|j| (0..m.nrows()).map(|i| m[(i, j)].abs()).sum::<f64>())
            .fold(0.0, |a: f64, b| if b.is_nan() { b } else { a.max(b) })
    };
    let reciprocal_condition = 1.0 / (largest_sum(a) * largest_sum(&solution));
    if reciprocal_condition.is_nan() || reciprocal_condition < SINGULAR {
        return Err(SplineError::Singular {
            spline,
            reciprocal_condition,
            advice,
        });
    }
    correct(&mut solution, exact);
    Ok(solution)
}

/// Changes the solution least so that `solution * input = coefficients` for every pair: X - (X q - c) q^T with the inputs
/// made orthonormal (Gram and Schmidt), the coefficients going along.
fn correct(solution: &mut Mat<f64>, mut exact: Vec<(Vec<f64>, Vec<f64>)>) {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for k in 0..exact.len() {
        let (done, rest) = exact.split_at_mut(k);
        let Some((input, wanted)) = rest.first_mut() else {
            return;
        };
        let before = dot(input, input).sqrt();
        // Twice is enough (Kahan).
        for (q, c) in done.iter().chain(done.iter()) {
            let along = dot(q, input);
            input.iter_mut().zip(q).for_each(|(x, q)| *x -= along * q);
            wanted.iter_mut().zip(c).for_each(|(x, c)| *x -= along * c);
        }
        let size = dot(input, input).sqrt();
        if size <= 1e-12 * before {
            // The nodes do not tell this field from the others; the rigid check judges what that means.
            input.fill(0.0);
            wanted.fill(0.0);
            continue;
        }
        input.iter_mut().chain(wanted.iter_mut()).for_each(|x| *x /= size);
        for i in 0..solution.nrows() {
            let value: f64 = (0..solution.ncols()).map(|j| solution[(i, j)] * input[j]).sum();
            let error = value - wanted[i];
            for j in 0..solution.ncols() {
                solution[(i, j)] -= error * input[j];
            }
        }
    }
}

/// Square roots of the eigenvalues of the points' second moments about their mean, largest first: one large, the points lie
/// on a line; two, in a plane.
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
