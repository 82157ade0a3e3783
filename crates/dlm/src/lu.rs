//! LU factors with partial pivoting, in place, with the number of threads said and not guessed.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::traits::ComplexField;
use faer::{Conj, MatMut, MatRef, Par};

/// Factors of a square matrix, by columns.
#[derive(Debug)]
pub(crate) struct Lu<T> {
    n: usize,
    factors: Vec<T>,
    forward: Vec<usize>,
    inverse: Vec<usize>,
    parallelism: Par,
}

impl<T: ComplexField> Lu<T> {
    /// Factorizes an `n` x `n` matrix given by columns. A singular one gives a zero on the diagonal or numbers that are not
    /// finite: callers look at [`Lu::diagonal`] or at the solution.
    pub(crate) fn new(n: usize, mut matrix: Vec<T>, parallelism: Par) -> Self {
        let (mut forward, mut inverse) = (vec![0_usize; n], vec![0_usize; n]);
        let scratch = factor::lu_in_place_scratch::<usize, T>(n, n, parallelism, Default::default());
        let mut memory = MemBuffer::new(scratch);
        factor::lu_in_place(
            MatMut::from_column_major_slice_mut(&mut matrix, n, n),
            &mut forward,
            &mut inverse,
            parallelism,
            MemStack::new(&mut memory),
            Default::default(),
        );
        Self {
            n,
            factors: matrix,
            forward,
            inverse,
            parallelism,
        }
    }

    /// Size.
    pub(crate) fn n(&self) -> usize {
        self.n
    }

    /// All factors by columns: L below the diagonal, U on and above it.
    pub(crate) fn factors(&self) -> &[T] {
        &self.factors
    }

    /// Diagonal of U.
    pub(crate) fn diagonal(&self) -> impl Iterator<Item = &T> {
        self.factors.iter().step_by(self.n + 1)
    }

    /// Solves for right-hand sides with `n` rows, in place.
    pub(crate) fn solve_in_place(&self, right: MatMut<'_, T>) {
        let scratch = solve::solve_in_place_scratch::<usize, T>(self.n, right.ncols(), self.parallelism);
        let mut memory = MemBuffer::new(scratch);
        let factors = MatRef::from_column_major_slice(&self.factors, self.n, self.n);
        solve::solve_in_place_with_conj(
            factors,
            factors,
            PermRef::new_checked(&self.forward, &self.inverse, self.n),
            Conj::No,
            right,
            self.parallelism,
            MemStack::new(&mut memory),
        );
    }
}
