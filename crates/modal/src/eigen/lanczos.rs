//! Block Lanczos with full reorthogonalization and thick restarts.
//!
//! The operator A = (K + s M)^-1 M is self-adjoint in the inner product of M; its eigenvalues are
//! theta = 1 / (omega^2 + s), largest for the lowest modes. Grimes, Lewis and Simon, "A shifted block
//! Lanczos algorithm for solving sparse symmetric generalized eigenproblems", SIAM J. Matrix Anal. Appl. 15
//! (1994), p. 228; restarts after Wu and Simon, "Thick-restart Lanczos method", same journal 22 (2000), p. 602.
//! A block finds multiple roots; the start vector is fixed, so results repeat bit for bit.

use faer::{Accum, Mat, Par};

use super::Pair;
use super::dense::symmetric_eigen;
use crate::error::{EigenError, ModelError};
use crate::factor::{Factor, Pencil};

/// Vectors iterated together: more than the six rigid motions of a free structure.
const BLOCK: usize = 8;
/// Blocks after which the search is given up.
const MAX_BLOCKS: usize = 300;
/// A vector that loses all but this part of its norm in orthogonalization was dependent: what is left
/// is round-off, which in a singular mass may even be a massless motion.
const DEPENDENT: f64 = 1e-9;

/// Eigenpairs found, and the Ritz value after them.
pub(super) struct Found {
    pub pairs: Vec<Pair>,
    /// Estimate (from above) of the next eigenvalue.
    pub next: Option<f64>,
}

/// A growing M-orthonormal basis and the projection of the operator on it.
struct Basis<'a> {
    pencil: &'a Pencil,
    factor: &'a Factor<'a>,
    /// Columns [size][capacity].
    q: Mat<f64>,
    /// Columns in use.
    used: usize,
    /// Q^T M A Q over the processed columns.
    t: Mat<f64>,
    /// Generator of start vectors.
    random: Random,
}

/// A fixed sequence of numbers in [-1, 1) (xorshift, Marsaglia, J. Stat. Softw. 8 (2003)).
struct Random(u64);

impl Random {
    fn new() -> Self {
        Self(0x9E37_79B9_7F4A_7C15)
    }

    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Root of x^T M x.
fn norm(pencil: &Pencil, x: &[f64]) -> f64 {
    let mut product = vec![0.0; x.len()];
    pencil.mass_times(x, &mut product);
    x.iter().zip(&product).map(|(a, b)| a * b).sum::<f64>().max(0.0).sqrt()
}

/// Largest part of the spectrum wanted, with the basis that a run may use.
fn capacity(count: usize, size: usize) -> usize {
    (2 * count + 6 * BLOCK).max(10 * BLOCK).min(size + BLOCK)
}

impl<'a> Basis<'a> {
    fn new(pencil: &'a Pencil, factor: &'a Factor<'a>, capacity: usize) -> Self {
        let n = pencil.size();
        Self {
            pencil,
            factor,
            q: Mat::zeros(n, capacity + BLOCK),
            used: 0,
            t: Mat::zeros(capacity + BLOCK, capacity + BLOCK),
            random: Random::new(),
        }
    }

    /// A x for every column of `x`.
    fn operate(&self, x: &[f64]) -> Result<Vec<f64>, ModelError> {
        let n = self.pencil.size();
        let mut y = vec![0.0; x.len()];
        for (xc, yc) in x.chunks_exact(n).zip(y.chunks_exact_mut(n)) {
            self.pencil.mass_times(xc, yc);
        }
        self.factor.solve(&mut y, x.len() / n)?;
        Ok(y)
    }

    /// M x for every column of `x`.
    fn weigh(&self, x: &[f64]) -> Mat<f64> {
        let n = self.pencil.size();
        let columns = x.len() / n;
        let mut y = vec![0.0; x.len()];
        for (xc, yc) in x.chunks_exact(n).zip(y.chunks_exact_mut(n)) {
            self.pencil.mass_times(xc, yc);
        }
        Mat::from_fn(n, columns, |i, j| y[j * n + i])
    }

    /// Removes from `w` its part in the basis, twice; returns the coefficients [basis][column].
    fn project_out(&self, w: &mut [f64]) -> Mat<f64> {
        let n = self.pencil.size();
        let columns = w.len() / n;
        let q = self.q.as_ref().subcols(0, self.used);
        let mut sum = Mat::<f64>::zeros(self.used, columns);
        for _ in 0..2 {
            let weighed = self.weigh(w);
            let mut h = Mat::<f64>::zeros(self.used, columns);
            faer::linalg::matmul::matmul(
                h.as_mut(),
                Accum::Replace,
                q.transpose(),
                weighed.as_ref(),
                1.0,
                Par::Seq,
            );
            let target = faer::MatMut::from_column_major_slice_mut(w, n, columns);
            faer::linalg::matmul::matmul(target, Accum::Add, q, h.as_ref(), -1.0, Par::Seq);
            sum += &h;
        }
        sum
    }

    /// Norm of every column of `w`.
    fn sizes(&self, w: &[f64]) -> Vec<f64> {
        w.chunks_exact(self.pencil.size())
            .map(|c| norm(self.pencil, c))
            .collect()
    }

    /// M-orthonormalizes the columns of `w` among themselves and appends them. A column that is dependent
    /// (against its size before projection) is replaced by a new start vector as long as the space has more.
    /// Returns how many were appended, and R [row][column] of w = Q R.
    fn append(&mut self, w: &[f64], sizes: &[f64]) -> Result<(usize, Mat<f64>), ModelError> {
        let n = self.pencil.size();
        let columns = w.len() / n;
        let before = self.used;
        let mut r = Mat::<f64>::zeros(columns, columns);
        // M times the columns that this call has appended.
        let mut weighed: Vec<Vec<f64>> = Vec::with_capacity(columns);
        for c in 0..columns {
            let mut v = w[c * n..(c + 1) * n].to_vec();
            for _ in 0..2 {
                for (p, mq) in weighed.iter().enumerate() {
                    let h: f64 = v.iter().zip(mq).map(|(a, b)| a * b).sum();
                    v.iter_mut()
                        .zip(self.q.col(before + p).iter())
                        .for_each(|(x, q)| *x -= h * q);
                    r[(p, c)] += h;
                }
            }
            let mut left = norm(self.pencil, &v);
            if left > DEPENDENT * sizes[c] && left > 0.0 {
                r[(self.used - before, c)] = left;
            } else {
                // An exhausted direction couples to nothing: R keeps zero there.
                let fresh: Vec<f64> = (0..n).map(|_| self.random.next()).collect();
                v = self.operate(&fresh)?;
                let start = norm(self.pencil, &v);
                self.project_out(&mut v);
                left = norm(self.pencil, &v);
                if left.is_nan() || left <= DEPENDENT * start || start == 0.0 {
                    continue;
                }
                // What is left is small against its start: clean it once more at norm one.
                v.iter_mut().for_each(|x| *x /= left);
                self.project_out(&mut v);
                left = norm(self.pencil, &v);
            }
            v.iter_mut().for_each(|x| *x /= left);
            self.q.col_mut(self.used).iter_mut().zip(&v).for_each(|(q, x)| *q = *x);
            let mut mv = vec![0.0; n];
            self.pencil.mass_times(&v, &mut mv);
            weighed.push(mv);
            self.used += 1;
        }
        Ok((self.used - before, r))
    }

    /// One step: operates on columns `from..used`, fills T, appends the next block.
    /// Returns the number of columns appended and R.
    fn step(&mut self, from: usize) -> Result<(usize, Mat<f64>), ModelError> {
        let to = self.used;
        let x: Vec<f64> = (from..to)
            .flat_map(|c| self.q.col(c).iter().copied().collect::<Vec<_>>())
            .collect();
        let mut w = self.operate(&x)?;
        let sizes = self.sizes(&w);
        let h = self.project_out(&mut w);
        for c in from..to {
            for p in 0..to {
                self.t[(p, c)] = h[(p, c - from)];
                self.t[(c, p)] = h[(p, c - from)];
            }
        }
        self.append(&w, &sizes)
    }

    /// Ritz values, largest first, and vectors [basis][value] over the first `m` columns.
    fn ritz(&self, m: usize) -> Result<(Vec<f64>, Mat<f64>), EigenError> {
        let t = Mat::from_fn(m, m, |i, j| 0.5 * (self.t[(i, j)] + self.t[(j, i)]));
        let (values, vectors) = symmetric_eigen(t.as_ref()).map_err(|cause| EigenError::Dense { size: m, cause })?;
        let order: Vec<usize> = (0..m).rev().collect();
        let sorted = Mat::from_fn(m, m, |i, j| vectors[(i, order[j])]);
        Ok((order.iter().map(|&j| values[j]).collect(), sorted))
    }

    /// Q y over the first `m` columns, for the first `count` columns of y.
    fn lift(&self, y: &Mat<f64>, m: usize, count: usize) -> Mat<f64> {
        let mut out = Mat::<f64>::zeros(self.pencil.size(), count);
        let q = self.q.as_ref().subcols(0, m);
        faer::linalg::matmul::matmul(
            out.as_mut(),
            Accum::Replace,
            q,
            y.as_ref().subcols(0, count),
            1.0,
            Par::Seq,
        );
        out
    }

    /// Starts with a block from the range of the operator, so that massless motions are not in it.
    fn start(&mut self) -> Result<usize, ModelError> {
        let n = self.pencil.size();
        let x: Vec<f64> = (0..n * BLOCK.min(n)).map(|_| self.random.next()).collect();
        let w = self.operate(&x)?;
        let sizes = self.sizes(&w);
        Ok(self.append(&w, &sizes)?.0)
    }
}

/// Lowest eigenvalue that is not a rigid motion's, roughly.
pub(super) fn lowest_elastic(pencil: &Pencil, factor: &Factor<'_>, shift: f64) -> Result<f64, EigenError> {
    let mut basis = Basis::new(pencil, factor, 4 * BLOCK);
    let mut from = 0;
    if basis.start()? == 0 {
        return Err(EigenError::NoMass);
    }
    let mut processed = basis.used;
    for _ in 0..3 {
        processed = basis.used;
        let (added, _) = basis.step(from)?;
        if added == 0 {
            break;
        }
        from = processed;
    }
    let (theta, y) = basis.ritz(processed)?;
    let keep = theta.len().min(2 * BLOCK);
    let lifted = basis.lift(&y, processed, keep);
    for j in 0..keep {
        let pair = pair(pencil, factor, lifted.col(j).iter().copied().collect())?;
        if pair.lambda > 100.0 * f64::EPSILON * pair.magnitude {
            return Ok(pair.lambda);
        }
    }
    Ok(shift)
}

/// The `count` lowest eigenpairs of the pencil whose K + `shift` M is `factor`.
pub(super) fn solve(
    pencil: &Pencil,
    factor: &Factor<'_>,
    shift: f64,
    count: usize,
    tolerance: f64,
) -> Result<Found, EigenError> {
    let limit = capacity(count, pencil.size());
    let mut basis = Basis::new(pencil, factor, limit);
    if basis.start()? == 0 {
        return Err(EigenError::NoMass);
    }
    let mut from = 0;
    // The residual of a Ritz pair is R times the last part of its vector; the estimate is a bound
    // before the last digits, so a little is kept in hand for the check that follows.
    let wanted = 0.1 * tolerance;
    let mut worst = (0, f64::INFINITY);
    for _ in 0..MAX_BLOCKS {
        let processed = basis.used;
        let (added, r) = basis.step(from)?;
        let (theta, y) = basis.ritz(processed)?;
        let last = processed - from;
        let estimate = |j: usize| {
            let norm2: f64 = (0..added)
                .map(|i| (0..last).map(|c| r[(i, c)] * y[(from + c, j)]).sum::<f64>().powi(2))
                .sum();
            norm2.sqrt() / theta[j].abs().max(f64::MIN_POSITIVE)
        };
        let enough = count.min(processed);
        worst = (0..enough)
            .map(|j| (j, estimate(j)))
            .fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a });
        let exhausted = added == 0;
        if (processed >= count && worst.1 <= wanted) || exhausted {
            let positive = (0..enough).filter(|&j| theta[j] > 1e-14 * theta[0]).count();
            let lifted = basis.lift(&y, processed, positive);
            let mut pairs = (0..positive)
                .map(|j| pair(pencil, factor, lifted.col(j).iter().copied().collect()))
                .collect::<Result<Vec<_>, _>>()?;
            pairs.sort_by(|a, b| a.lambda.total_cmp(&b.lambda));
            for (mode, p) in pairs.iter().enumerate().filter(|(_, p)| p.residual > tolerance) {
                if p.residual > round_off(pencil, factor, p)? {
                    return Err(EigenError::NotConverged {
                        mode: mode + 1,
                        residual: p.residual,
                        tolerance,
                        steps: processed / BLOCK,
                    });
                }
            }
            let next = theta.get(enough).filter(|t| **t > 0.0).map(|t| 1.0 / t - shift);
            return Ok(Found { pairs, next });
        }
        if basis.used + BLOCK > limit {
            // Thick restart: the Ritz vectors and the residual block span the new start.
            let keep = (count + 2 * BLOCK).min(processed - BLOCK).max(1);
            let lifted = basis.lift(&y, processed, keep);
            let residual = basis.q.as_ref().subcols(processed, added).to_owned();
            basis.t.fill(0.0);
            for (j, value) in theta.iter().take(keep).enumerate() {
                basis.t[(j, j)] = *value;
            }
            basis.q.as_mut().subcols_mut(0, keep).copy_from(&lifted);
            basis.q.as_mut().subcols_mut(keep, added).copy_from(&residual);
            basis.used = keep + added;
            from = keep;
        } else {
            from = processed;
        }
    }
    Err(EigenError::NotConverged {
        mode: worst.0 + 1,
        residual: worst.1,
        tolerance,
        steps: MAX_BLOCKS,
    })
}

/// The residual that round-off in the terms of K x alone makes: their size in units of the last place
/// with random signs, through the same solve.
fn round_off(pencil: &Pencil, factor: &Factor<'_>, pair: &Pair) -> Result<f64, ModelError> {
    let mut random = Random::new();
    let mut z = pencil.stiffness_magnitudes(&pair.shape);
    z.iter_mut()
        .for_each(|v| *v *= 16.0 * f64::EPSILON * random.next().signum());
    factor.solve(&mut z, 1)?;
    Ok(norm(pencil, &z))
}

/// Normalizes a shape and takes its Rayleigh quotient and residual.
fn pair(pencil: &Pencil, factor: &Factor<'_>, mut shape: Vec<f64>) -> Result<Pair, ModelError> {
    let n = pencil.size();
    let (mut mx, mut kx) = (vec![0.0; n], vec![0.0; n]);
    pencil.mass_times(&shape, &mut mx);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let size = dot(&shape, &mx).max(f64::MIN_POSITIVE).sqrt();
    shape.iter_mut().for_each(|v| *v /= size);
    mx.iter_mut().for_each(|v| *v /= size);
    pencil.stiffness_times(&shape, &mut kx);
    let lambda = dot(&shape, &kx);
    // ||A x - theta x|| over theta, in the norm of M: an eigenvalue theta lies within that relative distance
    // (Parlett, The Symmetric Eigenvalue Problem, 4-5). A x - theta x = -theta (K + s M)^-1 (K x - lambda M x).
    let mut z: Vec<f64> = kx.iter().zip(&mx).map(|(k, m)| k - lambda * m).collect();
    factor.solve(&mut z, 1)?;
    let residual = norm(pencil, &z);
    let terms = pencil.stiffness_magnitudes(&shape);
    let magnitude = shape.iter().zip(&terms).map(|(x, t)| x.abs() * t).sum();
    Ok(Pair {
        lambda,
        shape,
        residual,
        magnitude,
    })
}
