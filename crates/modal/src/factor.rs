//! A sparse symmetric pencil K, M and the factorization K - sigma M = L D L^T (faer, AMD ordering).
//!
//! One symbolic analysis of the joint pattern serves every shift. The pivots D give the Sturm count (the
//! number of eigenvalues below the shift) and show mechanisms.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky, supernodal::SupernodalLdltRef,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
use sprs::CsMat;

use crate::error::ModelError;

/// Lower triangles of K and M on their joint pattern, column by column.
pub(crate) struct Pencil {
    size: usize,
    column_start: Vec<usize>,
    row: Vec<usize>,
    stiffness: Vec<f64>,
    mass: Vec<f64>,
    /// The entries of M alone, (row, value) column by column: a lumped mass is a diagonal.
    mass_start: Vec<usize>,
    mass_entry: Vec<(usize, f64)>,
    symbolic: SymbolicCholesky<usize>,
}

/// Stands in for a pivot that is exactly zero, so that the factorization goes on and the pivots
/// tell where.
const ZERO_PIVOT: f64 = 1e-150;

/// L D L^T of a shifted pencil.
pub(crate) struct Factor<'a> {
    symbolic: &'a SymbolicCholesky<usize>,
    values: Vec<f64>,
}

impl Pencil {
    /// From symmetric matrices stored in full.
    pub fn new(stiffness: &CsMat<f64>, mass: &CsMat<f64>) -> Result<Self, ModelError> {
        let size = stiffness.rows();
        let (mut column_start, mut row) = (vec![0], Vec::new());
        let (mut k, mut m) = (Vec::new(), Vec::new());
        for j in 0..size {
            // Row j of a symmetric matrix is its column j. Both rows are sorted: merge them.
            let empty: (&[usize], &[f64]) = (&[], &[]);
            let kr = stiffness.outer_view(j);
            let mr = mass.outer_view(j);
            let (ki, kv) = kr.as_ref().map_or(empty, |v| (v.indices(), v.data()));
            let (mi, mv) = mr.as_ref().map_or(empty, |v| (v.indices(), v.data()));
            let (mut a, mut b) = (ki.partition_point(|&i| i < j), mi.partition_point(|&i| i < j));
            // The diagonal is always there: a shift or a pivot may need it.
            if ki.get(a) != Some(&j) && mi.get(b) != Some(&j) {
                row.push(j);
                k.push(0.0);
                m.push(0.0);
            }
            while a < ki.len() || b < mi.len() {
                let next = match (ki.get(a), mi.get(b)) {
                    (Some(&x), Some(&y)) => x.min(y),
                    (Some(&x), None) | (None, Some(&x)) => x,
                    (None, None) => break,
                };
                let take = |i: &[usize], v: &[f64], at: &mut usize| {
                    if i.get(*at) == Some(&next) {
                        *at += 1;
                        v[*at - 1]
                    } else {
                        0.0
                    }
                };
                row.push(next);
                k.push(take(ki, kv, &mut a));
                m.push(take(mi, mv, &mut b));
            }
            column_start.push(row.len());
        }
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &column_start, None, &row);
        let symbolic = factorize_symbolic_cholesky(
            pattern,
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .map_err(|e| ModelError::Factorization {
            size,
            cause: format!("{e:?}"),
        })?;
        let mut mass_start = vec![0];
        let mut mass_entry = Vec::new();
        for j in 0..size {
            let range = column_start[j]..column_start[j + 1];
            mass_entry.extend(
                row[range.clone()]
                    .iter()
                    .copied()
                    .zip(m[range].iter().copied())
                    .filter(|e| e.1 != 0.0),
            );
            mass_start.push(mass_entry.len());
        }
        Ok(Self {
            size,
            column_start,
            row,
            stiffness: k,
            mass: m,
            mass_start,
            mass_entry,
            symbolic,
        })
    }

    /// Number of degrees of freedom.
    pub fn size(&self) -> usize {
        self.size
    }

    /// K - sigma M in factors.
    pub fn factor(&self, sigma: f64) -> Result<Factor<'_>, ModelError> {
        let shifted: Vec<f64> = self
            .stiffness
            .iter()
            .zip(&self.mass)
            .map(|(k, m)| k - sigma * m)
            .collect();
        let pattern = SymbolicSparseColMatRef::new_checked(self.size, self.size, &self.column_start, None, &self.row);
        let matrix = SparseColMatRef::new(pattern, &shifted[..]);
        let mut values = vec![0.0; self.symbolic.len_val()];
        let mut memory = MemBuffer::try_new(
            self.symbolic
                .factorize_numeric_ldlt_scratch::<f64>(Par::Seq, faer::Spec::default()),
        )
        .map_err(|_| {
            let cause = "out of memory".to_owned();
            ModelError::Factorization { size: self.size, cause }
        })?;
        let regularization = LdltRegularization {
            dynamic_regularization_signs: None,
            dynamic_regularization_delta: ZERO_PIVOT,
            dynamic_regularization_epsilon: ZERO_PIVOT,
        };
        self.symbolic
            .factorize_numeric_ldlt(
                &mut values,
                matrix,
                Side::Lower,
                regularization,
                Par::Seq,
                MemStack::new(&mut memory),
                faer::Spec::default(),
            )
            .map_err(|e| ModelError::Factorization {
                size: self.size,
                cause: format!("{e:?}"),
            })?;
        Ok(Factor {
            symbolic: &self.symbolic,
            values,
        })
    }

    /// K x.
    pub fn stiffness_times(&self, x: &[f64], y: &mut [f64]) {
        self.times(|j| self.column(&self.stiffness, j), x, y);
    }

    /// M x.
    pub fn mass_times(&self, x: &[f64], y: &mut [f64]) {
        let entries = |j: usize| {
            self.mass_entry[self.mass_start[j]..self.mass_start[j + 1]]
                .iter()
                .copied()
        };
        self.times(entries, x, y);
    }

    /// Rows and values of the lower triangle in column `j`.
    fn column<'v>(&'v self, values: &'v [f64], j: usize) -> impl Iterator<Item = (usize, f64)> + 'v {
        let range = self.column_start[j]..self.column_start[j + 1];
        self.row[range.clone()]
            .iter()
            .copied()
            .zip(values[range].iter().copied())
    }

    /// The symmetric matrix whose lower triangle has the columns `column`, times x.
    fn times<C: Iterator<Item = (usize, f64)>>(&self, column: impl Fn(usize) -> C, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for j in 0..self.size {
            let mut sum = 0.0;
            for (i, v) in column(j) {
                if i != j {
                    y[i] += v * x[j];
                }
                sum += v * x[i];
            }
            y[j] += sum;
        }
    }

    /// |K| |x|: the size of the terms that each component of K x is the sum of.
    pub fn stiffness_magnitudes(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.size];
        for j in 0..self.size {
            for (i, k) in self.column(&self.stiffness, j) {
                if i != j {
                    y[i] += (k * x[j]).abs();
                }
                y[j] += (k * x[i]).abs();
            }
        }
        y
    }

    /// Diagonals of K and M.
    pub fn diagonals(&self) -> (Vec<f64>, Vec<f64>) {
        let pick = |values: &[f64]| (0..self.size).map(|j| values[self.column_start[j]]).collect();
        (pick(&self.stiffness), pick(&self.mass))
    }
}

impl Factor<'_> {
    /// Solves for every column of `x` (size x columns, column by column) in place.
    pub fn solve(&self, x: &mut [f64], columns: usize) -> Result<(), ModelError> {
        let size = self.symbolic.nrows();
        let mut memory =
            MemBuffer::try_new(self.symbolic.solve_in_place_scratch::<f64>(columns, Par::Seq)).map_err(|_| {
                ModelError::Factorization {
                    size,
                    cause: "out of memory".to_owned(),
                }
            })?;
        LdltRef::new(self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, size, columns),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        Ok(())
    }

    /// Pivots D in the order of elimination, and the degree of freedom of each.
    fn pivots(&self) -> (Vec<f64>, Vec<usize>) {
        let size = self.symbolic.nrows();
        let mut permuted = vec![0.0; size];
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(s) => {
                // The factor is unit lower triangular with D kept on its diagonal, first in each column.
                for (j, pivot) in permuted.iter_mut().enumerate() {
                    *pivot = self.values[s.col_ptr()[j]];
                }
            }
            SymbolicCholeskyRaw::Supernodal(s) => {
                let factor = SupernodalLdltRef::new(s, &self.values);
                for node in 0..s.n_supernodes() {
                    let part = factor.supernode(node);
                    let block = part.val();
                    for j in 0..block.ncols() {
                        permuted[part.start() + j] = block[(j, j)];
                    }
                }
            }
        }
        let order = self
            .symbolic
            .perm()
            .map_or_else(|| (0..size).collect(), |p| p.arrays().0.to_vec());
        (permuted, order)
    }

    /// Number of eigenvalues of the pencil below the shift (Sylvester's law of inertia).
    pub fn eigenvalues_below(&self) -> usize {
        self.pivots().0.iter().filter(|&&d| d < 0.0).count()
    }

    /// First degree of freedom in the elimination whose pivot is not clearly positive against the
    /// diagonal that it started from: something there moves without stiffness. Gives its number and the
    /// ratio. Later pivots say nothing once one has vanished.
    pub fn loose(&self, diagonal: &[f64], limit: f64) -> Option<(usize, f64)> {
        let (pivots, order) = self.pivots();
        pivots
            .iter()
            .zip(order)
            .map(|(p, at)| (at, if diagonal[at] > 0.0 { p / diagonal[at] } else { 0.0 }))
            .find(|(_, ratio)| ratio.is_nan() || *ratio < limit)
    }
}
