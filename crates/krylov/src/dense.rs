//! Dense 5 x 5 blocks, column-major: entry (row, column) at `row + 5 column`.
//!
//! A column is read as eight entries, three of which belong to what follows and are not used: one or two vector
//! registers hold a column without a masked load. Slices passed here must have [`SPARE`] entries after the block.

use crate::{BLOCK, Storage, VARIABLES};

/// Entries that must follow the last block of an array.
pub const SPARE: usize = 3;
/// Entries read at once: a column and [`SPARE`].
const LANES: usize = VARIABLES + SPARE;

/// `y - A x` for a block; returns lanes of which the first five count.
///
/// # Panics
/// If `a` is shorter than a block and [`SPARE`] entries, or `x` than five.
#[inline(always)]
pub fn multiply_subtract<S: Storage>(a: &[S], x: &[S], mut y: [S; LANES]) -> [S; LANES] {
    let a = &a[..BLOCK + SPARE];
    let x = &x[..VARIABLES];
    for c in 0..VARIABLES {
        let minus_x = x[c].negate();
        let column = &a[VARIABLES * c..VARIABLES * c + LANES];
        for l in 0..LANES {
            y[l] = column[l].mul_add(minus_x, y[l]);
        }
    }
    y
}

/// `y + A x` for a block; returns lanes of which the first five count.
///
/// # Panics
/// As [`multiply_subtract`].
#[inline(always)]
pub fn multiply_add<S: Storage>(a: &[S], x: &[S], mut y: [S; LANES]) -> [S; LANES] {
    let a = &a[..BLOCK + SPARE];
    let x = &x[..VARIABLES];
    for c in 0..VARIABLES {
        let column = &a[VARIABLES * c..VARIABLES * c + LANES];
        for l in 0..LANES {
            y[l] = column[l].mul_add(x[c], y[l]);
        }
    }
    y
}

/// Eight zeros.
#[inline(always)]
pub fn zero_lanes<S: Storage>() -> [S; LANES] {
    [S::default(); LANES]
}

/// `A B` in double precision; all column-major with spare entries.
#[inline(always)]
pub fn product(a: &[f64; BLOCK + SPARE], b: &[f64; BLOCK + SPARE]) -> [f64; BLOCK + SPARE] {
    let mut out = [0.0; BLOCK + SPARE];
    for c in 0..VARIABLES {
        let mut y = [0.0; LANES];
        for m in 0..VARIABLES {
            let f = b[m + VARIABLES * c];
            for l in 0..LANES {
                y[l] = a[VARIABLES * m + l].mul_add(f, y[l]);
            }
        }
        // Later columns overwrite the spare lanes of earlier ones.
        out[VARIABLES * c..VARIABLES * c + LANES].copy_from_slice(&y);
    }
    out[BLOCK..].fill(0.0);
    out
}

/// Inverse by Gauss-Jordan elimination with row pivoting. `Err` holds the largest pivot left, relative to the largest
/// entry of the block (not a number if the block holds one).
///
/// # Errors
/// If the largest pivot left in a column is not above 1e-14 of the largest entry.
#[inline]
pub fn invert(a: &[f64; BLOCK + SPARE]) -> Result<[f64; BLOCK + SPARE], f64> {
    const N: usize = VARIABLES;
    // Rows of the augmented matrix [A | I]; ten columns, padded so that a row fills whole registers.
    let mut w = [[0.0_f64; 2 * N + 2]; N];
    let mut largest = 0.0_f64;
    for r in 0..N {
        for c in 0..N {
            let v = a[r + N * c];
            w[r][c] = v;
            largest = largest.max(v.abs());
        }
        w[r][N + r] = 1.0;
    }
    for c in 0..N {
        let mut best = c;
        for r in c + 1..N {
            if w[r][c].abs() > w[best][c].abs() {
                best = r;
            }
        }
        if best != c {
            w.swap(best, c);
        }
        let pivot = w[c][c];
        // Written so that a NaN is refused as well.
        if !(pivot.abs() > 1e-14 * largest && pivot.is_finite()) {
            return Err(pivot.abs() / largest);
        }
        let inverse = 1.0 / pivot;
        let mut row = w[c];
        for v in &mut row {
            *v *= inverse;
        }
        w[c] = row;
        for (r, other) in w.iter_mut().enumerate() {
            if r != c {
                let f = other[c];
                for (o, p) in other.iter_mut().zip(&row) {
                    *o -= f * p;
                }
            }
        }
    }
    let mut out = [0.0; BLOCK + SPARE];
    for c in 0..N {
        for r in 0..N {
            out[r + N * c] = w[r][N + c];
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(seed: u64) -> [f64; BLOCK + SPARE] {
        let mut s = seed;
        let mut a = [0.0; BLOCK + SPARE];
        for v in a.iter_mut().take(BLOCK) {
            s = s
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            *v = (s >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
        }
        a
    }

    #[test]
    fn inverse_times_block_is_identity() {
        for seed in 0..50 {
            let a = sample(seed);
            let i = product(&invert(&a).expect("random blocks are regular"), &a);
            for r in 0..5 {
                for c in 0..5 {
                    let want = if r == c { 1.0 } else { 0.0 };
                    assert!((i[r + 5 * c] - want).abs() < 1e-11, "{seed} {r} {c} {}", i[r + 5 * c]);
                }
            }
        }
    }

    #[test]
    fn a_zero_diagonal_is_pivoted_and_a_singular_block_is_refused() {
        let mut a = [0.0; BLOCK + SPARE];
        for r in 0..5 {
            a[r + 5 * (4 - r)] = 1.0;
        }
        assert!(invert(&a).is_ok());
        a[4] = 0.0;
        assert!(invert(&a).is_err());
        a[4] = f64::NAN;
        assert!(invert(&a).is_err());
    }
}
