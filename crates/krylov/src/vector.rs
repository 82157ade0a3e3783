//! Long vectors: inner products whose result does not depend on the number of threads.
//!
//! Vectors are cut into pieces of [`PIECE`] entries. Each piece is summed in interleaved partial sums, pieces are
//! added in order: the order of additions is fixed, whoever does them. All kernels are bound by memory or cache, so
//! those of an orthogonalization do all that a pass over the vectors allows.

use rayon::prelude::*;

use crate::Storage;

/// Entries of a piece: a multiple of 5, so that pieces hold whole cells; small enough for the first-level cache.
pub const PIECE: usize = 2560;
/// Interleaved partial sums of a piece: as many as fill the vector registers in flight.
const SUMS: usize = 16;
/// Basis vectors worked on at a time, so that an entry that meets all of them is read and written a quarter as often.
const GROUP: usize = 4;
/// Interleaved partial sums of each vector of a group.
const GROUP_SUMS: usize = 8;
/// Pieces that a thread takes at once at most: what others wait for it in the end is as long as they take.
const MOST_PIECES: usize = 4;
/// Below this length threads cost more than they bring.
const PARALLEL_FROM: usize = 16 * PIECE;

/// Partial sums of one piece each: `work(n, piece, sums)` for all pieces of `y`, added in order into `total`.
/// `scratch` is kept by the caller so that nothing is allocated.
fn sum_pieces<T: Send>(
    y: &mut [T],
    scratch: &mut Vec<f64>,
    total: &mut [f64],
    work: impl Fn(usize, &mut [T], &mut [f64]) + Sync,
) {
    let width = total.len();
    scratch.clear();
    scratch.resize(y.len().div_ceil(PIECE) * width, 0.0);
    if y.len() < PARALLEL_FROM {
        let pieces = y.chunks_mut(PIECE).zip(scratch.chunks_mut(width));
        pieces.enumerate().for_each(|(n, (y, sums))| work(n, y, sums));
    } else {
        let pieces = y.par_chunks_mut(PIECE).zip(scratch.par_chunks_mut(width));
        pieces
            .enumerate()
            .with_max_len(MOST_PIECES)
            .for_each(|(n, (y, sums))| work(n, y, sums));
    }
    total.fill(0.0);
    for sums in scratch.chunks(width) {
        total.iter_mut().zip(sums).for_each(|(t, s)| *t += s);
    }
}

#[inline(always)]
fn dot_piece<A: Storage, B: Storage>(a: &[A], b: &[B]) -> f64 {
    let mut sums = [0.0_f64; SUMS];
    let (xs, x_rest) = a.as_chunks::<SUMS>();
    let (ys, y_rest) = b.as_chunks::<SUMS>();
    for (x, y) in xs.iter().zip(ys) {
        for l in 0..SUMS {
            sums[l] = x[l].to_f64().mul_add(y[l].to_f64(), sums[l]);
        }
    }
    for (l, (x, y)) in x_rest.iter().zip(y_rest).enumerate() {
        sums[l] = x.to_f64().mul_add(y.to_f64(), sums[l]);
    }
    sums.iter().sum()
}

/// Inner products of a piece with those of four vectors.
#[inline(always)]
fn dot_group<S: Storage>(x: &[f64], b: [&[S]; GROUP]) -> [f64; GROUP] {
    let mut sums = [[0.0_f64; GROUP_SUMS]; GROUP];
    let (xs, x_rest) = x.as_chunks::<GROUP_SUMS>();
    let [(b0, r0), (b1, r1), (b2, r2), (b3, r3)] = b.map(<[S]>::as_chunks::<GROUP_SUMS>);
    for ((((x, b0), b1), b2), b3) in xs.iter().zip(b0).zip(b1).zip(b2).zip(b3) {
        for (sums, b) in sums.iter_mut().zip([b0, b1, b2, b3]) {
            for l in 0..GROUP_SUMS {
                sums[l] = b[l].to_f64().mul_add(x[l], sums[l]);
            }
        }
    }
    for (sums, rest) in sums.iter_mut().zip([r0, r1, r2, r3]) {
        for (s, (x, b)) in sums.iter_mut().zip(x_rest.iter().zip(rest)) {
            *s = b.to_f64().mul_add(*x, *s);
        }
    }
    sums.map(|s| s.iter().sum())
}

/// `y += sum of c b` for four vectors.
#[inline(always)]
fn add_group<S: Storage>(y: &mut [f64], c: [f64; GROUP], b: [&[S]; GROUP]) {
    let n = y.len();
    let [b0, b1, b2, b3] = b.map(|b| &b[..n]);
    for (m, y) in y.iter_mut().enumerate() {
        let mut sum = b0[m].to_f64().mul_add(c[0], *y);
        sum = b1[m].to_f64().mul_add(c[1], sum);
        sum = b2[m].to_f64().mul_add(c[2], sum);
        *y = b3[m].to_f64().mul_add(c[3], sum);
    }
}

/// `y += sum of c b` over a piece that starts at entry `from`.
#[inline(always)]
fn add_piece<S: Storage>(y: &mut [f64], from: usize, coefficients: &[f64], basis: &[&[S]]) {
    let to = from + y.len();
    let (groups, rest) = basis.as_chunks::<GROUP>();
    let (group_c, rest_c) = coefficients.as_chunks::<GROUP>();
    for (b, c) in groups.iter().zip(group_c) {
        add_group(y, *c, b.map(|b| &b[from..to]));
    }
    for (b, c) in rest.iter().zip(rest_c) {
        for (y, b) in y.iter_mut().zip(&b[from..to]) {
            *y = b.to_f64().mul_add(*c, *y);
        }
    }
}

fn check_lengths<S>(n: usize, basis: &[&[S]]) {
    for b in basis {
        assert_eq!(b.len(), n, "operation on vectors of different lengths");
    }
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

/// `y += c x`.
///
/// # Panics
/// If the lengths differ.
pub fn add_scaled<S: Storage>(y: &mut [f64], c: f64, x: &[S]) {
    add_many(y, &[c], &[x]);
}

/// `y += sum of coefficients[m] basis[m]`, in one pass over `y`.
///
/// # Panics
/// If a length differs.
pub fn add_many<S: Storage>(y: &mut [f64], coefficients: &[f64], basis: &[&[S]]) {
    check_lengths(y.len(), basis);
    assert_eq!(coefficients.len(), basis.len(), "a coefficient for every vector");
    let piece = |(n, y): (usize, &mut [f64])| add_piece(y, n * PIECE, coefficients, basis);
    if y.len() < PARALLEL_FROM {
        y.chunks_mut(PIECE).enumerate().for_each(piece);
    } else {
        y.par_chunks_mut(PIECE).enumerate().for_each(piece);
    }
}

/// Inner products of `y` with each of `basis`, and with itself as the last of `products`, in one pass.
///
/// # Panics
/// If a length differs, or `products` has not one entry more than `basis`.
pub fn dot_many<S: Storage>(y: &mut [f64], basis: &[&[S]], scratch: &mut Vec<f64>, products: &mut [f64]) {
    check_lengths(y.len(), basis);
    assert_eq!(products.len(), basis.len() + 1, "a product for every vector");
    sum_pieces(y, scratch, products, |n, y, sums| {
        let range = n * PIECE..n * PIECE + y.len();
        let (sums, own) = sums.split_at_mut(basis.len());
        let (groups, rest) = basis.as_chunks::<GROUP>();
        let (group_sums, rest_sums) = sums.as_chunks_mut::<GROUP>();
        for (b, s) in groups.iter().zip(group_sums) {
            *s = dot_group(y, b.map(|b| &b[range.clone()]));
        }
        for (b, s) in rest.iter().zip(rest_sums) {
            *s = dot_piece(y, &b[range.clone()]);
        }
        own[0] = dot_piece(y, y);
    });
}

/// `y -= sum of coefficients[m] basis[m]`; returns `[y . y, y . b]` of the new `y`, in one pass.
///
/// # Panics
/// If a length differs.
pub fn orthogonalize<S: Storage>(
    y: &mut [f64],
    coefficients: &[f64],
    basis: &[&[S]],
    b: &[f64],
    scratch: &mut Vec<f64>,
) -> [f64; 2] {
    check_lengths(y.len(), basis);
    check_lengths(y.len(), &[b]);
    assert_eq!(coefficients.len(), basis.len(), "a coefficient for every vector");
    let minus: Vec<f64> = coefficients.iter().map(|c| -c).collect();
    let mut out = [0.0; 2];
    sum_pieces(y, scratch, &mut out, |n, y, sums| {
        add_piece(y, n * PIECE, &minus, basis);
        sums[0] = dot_piece(y, y);
        sums[1] = dot_piece(y, &b[n * PIECE..n * PIECE + y.len()]);
    });
    out
}

/// `q = scale y` in another precision, then `b -= step q`; returns `b . b` of the new `b`, in one pass.
///
/// # Panics
/// If a length differs.
pub fn store_and_step<S: Storage>(
    y: &[f64],
    scale: f64,
    q: &mut [S],
    step: f64,
    b: &mut [f64],
    scratch: &mut Vec<f64>,
) -> f64 {
    check_lengths(b.len(), &[y]);
    assert_eq!(b.len(), q.len(), "operation on vectors of different lengths");
    // Pieces of q go with those of b.
    let mut pairs: Vec<(&mut [S], &mut [f64])> = q.chunks_mut(PIECE).zip(b.chunks_mut(PIECE)).collect();
    let work = |n: usize, (q, b): &mut (&mut [S], &mut [f64])| {
        let y = &y[n * PIECE..n * PIECE + b.len()];
        for ((q, b), y) in q.iter_mut().zip(b.iter_mut()).zip(y) {
            *q = S::from_f64(scale * y);
            *b = q.to_f64().mul_add(-step, *b);
        }
        dot_piece(b, b)
    };
    scratch.clear();
    if y.len() < PARALLEL_FROM {
        scratch.extend(pairs.iter_mut().enumerate().map(|(n, pair)| work(n, pair)));
    } else {
        pairs
            .par_iter_mut()
            .enumerate()
            .with_max_len(MOST_PIECES)
            .map(|(n, pair)| work(n, pair))
            .collect_into_vec(scratch);
    }
    scratch.iter().sum()
}

/// `y = S(y + c x)` in the precision of `y`.
///
/// # Panics
/// If the lengths differ.
pub fn add_scaled_stored<S: Storage>(y: &mut [S], c: f64, x: &[S]) {
    assert_eq!(y.len(), x.len(), "operation on vectors of different lengths");
    let piece = |(y, x): (&mut [S], &[S])| {
        for (y, x) in y.iter_mut().zip(x) {
            *y = S::from_f64(x.to_f64().mul_add(c, y.to_f64()));
        }
    };
    if y.len() < PARALLEL_FROM {
        y.chunks_mut(PIECE).zip(x.chunks(PIECE)).for_each(piece);
    } else {
        y.par_chunks_mut(PIECE).zip(x.par_chunks(PIECE)).for_each(piece);
    }
}
