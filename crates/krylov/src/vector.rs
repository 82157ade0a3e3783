//! Long vectors: inner products whose result does not depend on the number of threads.
//!
//! Vectors are cut into pieces of [`PIECE`] entries. Each piece is summed in `SUMS` interleaved partial sums, pieces
//! are added in order: the order of additions is fixed, whoever does them.

use rayon::prelude::*;

use crate::Storage;

/// Entries of a piece: a multiple of 5, so that pieces hold whole cells; small enough for the first-level cache.
pub const PIECE: usize = 2560;
/// Interleaved partial sums of a piece: as many as fill the vector registers in flight.
const SUMS: usize = 16;
/// Below this length threads cost more than they bring.
const PARALLEL_FROM: usize = 16 * PIECE;

#[inline(always)]
fn dot_piece<A: Storage, B: Storage>(a: &[A], b: &[B]) -> f64 {
    let mut sums = [0.0_f64; SUMS];
    let whole = a.len() / SUMS * SUMS;
    for (x, y) in a[..whole].chunks_exact(SUMS).zip(b[..whole].chunks_exact(SUMS)) {
        for l in 0..SUMS {
            sums[l] = x[l].to_f64().mul_add(y[l].to_f64(), sums[l]);
        }
    }
    for (l, (x, y)) in a[whole..].iter().zip(&b[whole..]).enumerate() {
        sums[l] = x.to_f64().mul_add(y.to_f64(), sums[l]);
    }
    sums.iter().sum()
}

/// Inner product in double precision.
///
/// # Panics
/// If the lengths differ.
#[must_use]
pub fn dot<A: Storage, B: Storage>(a: &[A], b: &[B]) -> f64 {
    assert_eq!(a.len(), b.len(), "inner product of vectors of different lengths");
    if a.len() < PARALLEL_FROM {
        a.chunks(PIECE).zip(b.chunks(PIECE)).map(|(x, y)| dot_piece(x, y)).sum()
    } else {
        let sums: Vec<f64> = a
            .par_chunks(PIECE)
            .zip(b.par_chunks(PIECE))
            .map(|(x, y)| dot_piece(x, y))
            .collect();
        sums.iter().sum()
    }
}

/// Euclidean norm.
#[must_use]
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Inner products of `q` with each of `basis`, in one pass over `q`; and of `q` with itself as the last entry.
///
/// # Panics
/// If a length differs.
#[must_use]
pub fn dot_many<S: Storage>(q: &[f64], basis: &[&[S]]) -> Vec<f64> {
    for b in basis {
        assert_eq!(b.len(), q.len(), "inner product of vectors of different lengths");
    }
    let piece = |n: usize, x: &[f64]| -> Vec<f64> {
        let from = n * PIECE;
        let mut sums: Vec<f64> = basis.iter().map(|b| dot_piece(x, &b[from..from + x.len()])).collect();
        sums.push(dot_piece(x, x));
        sums
    };
    let mut total = vec![0.0; basis.len() + 1];
    let mut add = |sums: &[f64]| total.iter_mut().zip(sums).for_each(|(t, s)| *t += s);
    if q.len() < PARALLEL_FROM {
        q.chunks(PIECE).enumerate().for_each(|(n, x)| add(&piece(n, x)));
    } else {
        let all: Vec<Vec<f64>> = q.par_chunks(PIECE).enumerate().map(|(n, x)| piece(n, x)).collect();
        all.iter().for_each(|sums| add(sums));
    }
    total
}

/// `y -= sum_m coefficients[m] basis[m]`, in one pass over `y`.
///
/// # Panics
/// If a length differs.
pub fn subtract_many<S: Storage, T: Storage>(y: &mut [T], coefficients: &[f64], basis: &[&[S]]) {
    for b in basis {
        assert_eq!(b.len(), y.len(), "sum of vectors of different lengths");
    }
    let piece = |(n, out): (usize, &mut [T])| {
        let from = n * PIECE;
        for (c, b) in coefficients.iter().zip(basis) {
            for (o, v) in out.iter_mut().zip(&b[from..]) {
                *o = T::from_f64(v.to_f64().mul_add(-c, o.to_f64()));
            }
        }
    };
    if y.len() < PARALLEL_FROM {
        y.chunks_mut(PIECE).enumerate().for_each(piece);
    } else {
        y.par_chunks_mut(PIECE).enumerate().for_each(piece);
    }
}

/// `y += c x`.
///
/// # Panics
/// If the lengths differ.
pub fn add_scaled<S: Storage>(y: &mut [f64], c: f64, x: &[S]) {
    assert_eq!(x.len(), y.len(), "sum of vectors of different lengths");
    let piece = |(out, v): (&mut [f64], &[S])| {
        for (o, v) in out.iter_mut().zip(v) {
            *o = v.to_f64().mul_add(c, *o);
        }
    };
    if y.len() < PARALLEL_FROM {
        y.chunks_mut(PIECE).zip(x.chunks(PIECE)).for_each(piece);
    } else {
        y.par_chunks_mut(PIECE).zip(x.par_chunks(PIECE)).for_each(piece);
    }
}

/// `x = S(c y)` entry by entry, into another precision.
///
/// # Panics
/// If the lengths differ.
pub fn scale_into<A: Storage, B: Storage>(c: f64, y: &[A], x: &mut [B]) {
    assert_eq!(x.len(), y.len(), "copy of a vector of another length");
    let piece = |(o, v): (&mut [B], &[A])| {
        for (o, v) in o.iter_mut().zip(v) {
            *o = B::from_f64(c * v.to_f64());
        }
    };
    if y.len() < PARALLEL_FROM {
        x.chunks_mut(PIECE).zip(y.chunks(PIECE)).for_each(piece);
    } else {
        x.par_chunks_mut(PIECE).zip(y.par_chunks(PIECE)).for_each(piece);
    }
}
