//! Small dense complex systems: LU that survives a singular matrix, and eigenvalues of quadratic and linear pencils.
//!
//! The correctors solve thousands of systems of size 2 to 30 that are singular at the answer. This LU replaces a vanishing
//! pivot by round-off of the matrix, which is what inverse iteration needs, and allocates nothing after the first use.
//! Matrices are column-major slices of length n * n.

use faer::{Mat, c64};

use crate::error::{FlutterError, Result};

/// P A = L U of a complex matrix.
#[derive(Debug, Clone)]
pub(crate) struct Lu {
    n: usize,
    factors: Vec<c64>,
    pivots: Vec<usize>,
}

impl Lu {
    pub fn new(n: usize) -> Self {
        Self {
            n,
            factors: vec![c64::new(0.0, 0.0); n * n],
            pivots: vec![0; n],
        }
    }

    /// Factors `a`; pivots smaller than round-off are replaced by round-off.
    pub fn factor(&mut self, a: &[c64]) {
        let n = self.n;
        self.factors.copy_from_slice(a);
        let lu = &mut self.factors;
        // The second bound is for a matrix of zeros (one mode exactly at its root); its square must not underflow.
        let floor = (f64::EPSILON * lu.iter().fold(0.0_f64, |m, v| m.max(v.l1_norm()))).max(1e-140);
        for j in 0..n {
            let pivot = (j..n).fold(j, |best, i| {
                if lu[j * n + i].norm_sqr() > lu[j * n + best].norm_sqr() {
                    i
                } else {
                    best
                }
            });
            self.pivots[j] = pivot;
            if pivot != j {
                for column in 0..n {
                    lu.swap(column * n + j, column * n + pivot);
                }
            }
            if lu[j * n + j].l1_norm() < floor {
                lu[j * n + j] = c64::new(floor, 0.0);
            }
            let inverse = lu[j * n + j].inv();
            for i in j + 1..n {
                lu[j * n + i] *= inverse;
            }
            let (left, right) = lu.split_at_mut((j + 1) * n);
            let multipliers = &left[j * n..];
            for column in right.chunks_exact_mut(n) {
                let top = column[j];
                for i in j + 1..n {
                    column[i] -= multipliers[i] * top;
                }
            }
        }
    }

    /// x := A^-1 x.
    pub fn solve(&self, x: &mut [c64]) {
        let (n, lu) = (self.n, &self.factors);
        for j in 0..n {
            x.swap(j, self.pivots[j]);
        }
        for j in 0..n {
            let value = x[j];
            for i in j + 1..n {
                x[i] -= lu[j * n + i] * value;
            }
        }
        for j in (0..n).rev() {
            x[j] /= lu[j * n + j];
            let value = x[j];
            for i in 0..j {
                x[i] -= lu[j * n + i] * value;
            }
        }
    }

    /// x := A^-H x.
    pub fn solve_adjoint(&self, x: &mut [c64]) {
        let (n, lu) = (self.n, &self.factors);
        for j in 0..n {
            let sum: c64 = (0..j).map(|i| lu[j * n + i].conj() * x[i]).sum();
            x[j] = (x[j] - sum) / lu[j * n + j].conj();
        }
        for j in (0..n).rev() {
            let sum: c64 = (j + 1..n).map(|i| lu[j * n + i].conj() * x[i]).sum();
            x[j] -= sum;
        }
        for j in (0..n).rev() {
            x.swap(j, self.pivots[j]);
        }
    }
}

/// Scales `x` to unit Euclidean norm; `false` when it is zero or not finite.
pub(crate) fn normalize(x: &mut [c64]) -> bool {
    let largest = x.iter().fold(0.0_f64, |m, v| m.max(v.l1_norm()));
    if !(largest > 0.0 && largest.is_finite()) {
        return false;
    }
    let norm = x.iter().map(|v| (v / largest).norm_sqr()).sum::<f64>().sqrt() * largest;
    for v in x.iter_mut() {
        *v /= norm;
    }
    true
}

/// y^H A x for a column-major A.
pub(crate) fn bilinear(y: &[c64], a: &[c64], x: &[c64]) -> c64 {
    let n = x.len();
    a.chunks_exact(n).zip(x).map(|(column, xj)| dot(y, column) * xj).sum()
}

/// y^H x.
pub(crate) fn dot(y: &[c64], x: &[c64]) -> c64 {
    y.iter().zip(x).map(|(a, b)| a.conj() * b).sum()
}

/// Eigenvalues and unit right vectors of A x = lambda B x by B^-1 A.
///
/// B must not be singular; where it nearly is, eigenvalues come out huge. (The QZ solution of faer 0.24.4 overruns its work
/// space for small matrices, and B is well conditioned at every call.)
pub(crate) fn eigen_pencil(n: usize, a: &[c64], b: &[c64], at: &str) -> Result<Vec<(c64, Vec<c64>)>> {
    let mut lu = Lu::new(n);
    lu.factor(b);
    let mut standard = a.to_vec();
    for column in standard.chunks_exact_mut(n) {
        lu.solve(column);
    }
    let matrix = Mat::from_fn(n, n, |i, j| standard[j * n + i]);
    let eigen = matrix.eigen().map_err(|_| FlutterError::Eigen { at: at.to_string() })?;
    let mut pairs = Vec::with_capacity(n);
    for j in 0..n {
        let value = eigen.S()[j];
        let mut x: Vec<c64> = (0..n).map(|i| eigen.U()[(i, j)]).collect();
        if value.re.is_finite() && value.im.is_finite() && normalize(&mut x) {
            pairs.push((value, x));
        }
    }
    Ok(pairs)
}

/// All eigenvalues of (lambda^2 A2 + lambda A1 + A0) x = 0 by the companion form.
///
/// A2 is inverted: it is a mass matrix (positive definite) wherever this is used.
pub(crate) fn eigenvalues_quadratic(n: usize, a2: &[c64], a1: &[c64], a0: &[c64], at: &str) -> Result<Vec<c64>> {
    let mut lu = Lu::new(n);
    lu.factor(a2);
    let mut companion = Mat::<c64>::zeros(2 * n, 2 * n);
    let mut column = vec![c64::new(0.0, 0.0); n];
    for j in 0..n {
        companion[(j, n + j)] = c64::new(1.0, 0.0);
        for (block, source) in [(0, a0), (n, a1)] {
            column.copy_from_slice(&source[j * n..(j + 1) * n]);
            lu.solve(&mut column);
            for i in 0..n {
                companion[(n + i, block + j)] = -column[i];
            }
        }
    }
    companion
        .eigenvalues()
        .map_err(|_| FlutterError::Eigen { at: at.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(n: usize) -> Vec<c64> {
        (0..n * n)
            .map(|e| c64::new(((e * 7 + 3) % 11) as f64 - 4.0, ((e * 5 + 1) % 7) as f64 - 3.0))
            .collect()
    }

    #[test]
    fn solves_and_adjoint_solves() {
        for n in [1, 2, 5, 9] {
            let a = matrix(n);
            let x: Vec<_> = (0..n).map(|i| c64::new(1.0 + i as f64, -0.5 * i as f64)).collect();
            let mut forward = vec![c64::new(0.0, 0.0); n];
            let mut adjoint = forward.clone();
            for j in 0..n {
                for i in 0..n {
                    forward[i] += a[j * n + i] * x[j];
                    adjoint[j] += a[j * n + i].conj() * x[i];
                }
            }
            let mut lu = Lu::new(n);
            lu.factor(&a);
            lu.solve(&mut forward);
            lu.solve_adjoint(&mut adjoint);
            for i in 0..n {
                assert!((forward[i] - x[i]).norm() < 1e-11);
                assert!((adjoint[i] - x[i]).norm() < 1e-11);
            }
        }
    }

    #[test]
    fn singular_matrix_gives_its_null_vector() {
        let v = |re: f64| c64::new(re, 0.0);
        let mut lu = Lu::new(2);
        lu.factor(&[v(1.0), v(2.0), v(3.0), v(6.0)]);
        let mut x = vec![v(1.0), v(0.3)];
        lu.solve(&mut x);
        assert!(normalize(&mut x));
        assert!((x[0] + x[1] * 3.0).norm() < 1e-12);
    }
}
