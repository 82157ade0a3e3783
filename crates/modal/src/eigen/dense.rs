//! All eigenpairs of a small pencil.
//!
//! With K + s M = L L^T the problem is the symmetric one of L^-1 M L^-T with eigenvalues
//! theta = 1 / (omega^2 + s); theta = 0 belongs to massless motions, which are left out.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, Mat, MatRef, Par};

use super::{Pair, SHIFT_RANGE, SHIFT_STEPS, first_shift};
use crate::error::EigenError;

/// Eigenvalues theta below this fraction of the largest are round-off of massless motions.
const MASSLESS: f64 = 1e-13;

/// Eigenpairs of K and M (both triangles given), lowest first.
pub(super) fn solve(k: &Mat<f64>, m: &Mat<f64>, shift: Option<f64>) -> Result<Vec<Pair>, EigenError> {
    if let Some(shift) = shift {
        return at_shift(k, m, shift);
    }
    let mut shift = first_shift((0..k.nrows()).map(|i| (k[(i, i)], m[(i, i)])));
    let mut pairs = at_shift(k, m, shift)?;
    for _ in 0..SHIFT_STEPS {
        let rigid = |p: &&Pair| p.lambda <= 100.0 * f64::EPSILON * p.magnitude;
        match pairs.iter().find(|p| !rigid(p)).map(|p| p.lambda) {
            Some(elastic) if !SHIFT_RANGE.contains(&(elastic / shift)) => {
                shift = elastic;
                pairs = at_shift(k, m, shift)?;
            }
            _ => break,
        }
    }
    Ok(pairs)
}

fn at_shift(k: &Mat<f64>, m: &Mat<f64>, shift: f64) -> Result<Vec<Pair>, EigenError> {
    let n = k.nrows();
    let failed = |cause: String| EigenError::Dense { size: n, cause };
    let no_memory = |_| failed("out of memory".to_owned());
    let mut l = Mat::from_fn(n, n, |i, j| k[(i, j)] + shift * m[(i, j)]);
    let mut memory =
        MemBuffer::try_new(cholesky_in_place_scratch::<f64>(n, Par::Seq, faer::Spec::default())).map_err(no_memory)?;
    cholesky_in_place(
        l.as_mut(),
        LltRegularization::default(),
        Par::Seq,
        MemStack::new(&mut memory),
        faer::Spec::default(),
    )
    .map_err(|_| failed(format!("K + s M is not positive definite at s = {shift:.3e}; a motion has neither stiffness nor mass, or a negative one")))?;
    // L^-1 M L^-T, one side at a time.
    let mut c = m.clone();
    solve_lower_triangular_in_place(l.as_ref(), c.as_mut(), Par::Seq);
    let mut c = c.transpose().to_owned();
    solve_lower_triangular_in_place(l.as_ref(), c.as_mut(), Par::Seq);
    let (theta, mut vectors) = symmetric_eigen(c.as_ref()).map_err(failed)?;
    solve_upper_triangular_in_place(l.transpose(), vectors.as_mut(), Par::Seq);
    let largest = theta.iter().fold(0.0_f64, |a, &b| a.max(b));
    if largest.is_nan() || largest <= 0.0 {
        return Err(EigenError::NoMass);
    }
    let times = |a: &Mat<f64>| {
        let mut out = Mat::<f64>::zeros(n, n);
        faer::linalg::matmul::matmul(
            out.as_mut(),
            Accum::Replace,
            a.as_ref(),
            vectors.as_ref(),
            1.0,
            Par::Seq,
        );
        out
    };
    let (kv, mv) = (times(k), times(m));
    let dot = |a: &Mat<f64>, b: &Mat<f64>, j: usize| (0..n).map(|i| a[(i, j)] * b[(i, j)]).sum::<f64>();
    let mut pairs = Vec::new();
    // Eigenvalues come in ascending order of theta: the last is the lowest mode.
    for j in (0..n).rev().filter(|&j| theta[j] > MASSLESS * largest) {
        let mass = dot(&vectors, &mv, j);
        if mass.is_nan() || mass <= 0.0 {
            continue;
        }
        let lambda = dot(&vectors, &kv, j) / mass;
        let factor = mass.sqrt().recip();
        let shape: Vec<f64> = (0..n).map(|i| vectors[(i, j)] * factor).collect();
        // As in the sparse solver: the norm in M of (K + s M)^-1 (K x - lambda M x).
        let mut z = Mat::from_fn(n, 1, |i, _| (kv[(i, j)] - lambda * mv[(i, j)]) * factor);
        solve_lower_triangular_in_place(l.as_ref(), z.as_mut(), Par::Seq);
        solve_upper_triangular_in_place(l.transpose(), z.as_mut(), Par::Seq);
        let mut mz = Mat::<f64>::zeros(n, 1);
        faer::linalg::matmul::matmul(mz.as_mut(), Accum::Replace, m.as_ref(), z.as_ref(), 1.0, Par::Seq);
        let residual = (0..n).map(|i| z[(i, 0)] * mz[(i, 0)]).sum::<f64>().max(0.0).sqrt();
        let magnitude = (0..n)
            .map(|i| (0..n).map(|p| (shape[i] * k[(i, p)] * shape[p]).abs()).sum::<f64>())
            .sum();
        pairs.push(Pair {
            lambda,
            shape,
            residual,
            magnitude,
        });
    }
    pairs.sort_by(|a, b| a.lambda.total_cmp(&b.lambda));
    Ok(pairs)
}

/// Eigenvalues in ascending order and eigenvectors (columns) of a symmetric matrix; the lower triangle is read.
pub(super) fn symmetric_eigen(a: MatRef<'_, f64>) -> Result<(Vec<f64>, Mat<f64>), String> {
    let n = a.nrows();
    let mut values = Diag::<f64>::zeros(n);
    let mut vectors = Mat::<f64>::zeros(n, n);
    let mut memory = MemBuffer::try_new(self_adjoint_evd_scratch::<f64>(
        n,
        ComputeEigenvectors::Yes,
        Par::Seq,
        faer::Spec::default(),
    ))
    .map_err(|_| "out of memory".to_owned())?;
    self_adjoint_evd(
        a,
        values.as_mut(),
        Some(vectors.as_mut()),
        Par::Seq,
        MemStack::new(&mut memory),
        faer::Spec::default(),
    )
    .map_err(|e| format!("{e:?}"))?;
    Ok((values.column_vector().iter().copied().collect(), vectors))
}
