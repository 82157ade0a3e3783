//! Face area vectors and volumes of hexahedra whose faces need not be plane.
//!
//! A face is the bilinear patch through its four corners, so two cells (and two blocks) that share four corners share
//! the face, whatever order their nodes come in. Its area vector is exact, half the cross product of the diagonals, and
//! the volume is that of the trilinear hexahedron between six such patches: area vectors of a cell sum to zero and
//! volumes sum to the domain's, both to round-off.

use crate::block::Block;
use crate::vector::{add, cross, dot, sub};

/// Area vector of the bilinear patch `p00, p10, p11, p01` (in order round the edge):
/// `S = 1/2 (p11 - p00) x (p01 - p10)`, along `d(1) x d(2)` with direction 1 from `p00` to `p10`.
///
/// Another order of the same nodes gives the same bits, or the same bits negated: the diagonals only swap or turn
/// round, and [`cross`] is exactly antisymmetric.
#[inline]
#[must_use]
pub fn face_area(p00: [f64; 3], p10: [f64; 3], p11: [f64; 3], p01: [f64; 3]) -> [f64; 3] {
    let s = cross(sub(p11, p00), sub(p01, p10));
    [0.5 * s[0], 0.5 * s[1], 0.5 * s[2]]
}

/// Volume of the trilinear hexahedron with the corners `c` in binary order (corner `a + 2 b + 4 c`), positive when
/// i, j, k are right-handed. J. Grandy, Efficient Computation of Volume of Hexahedral Cells, UCRL-ID-128886 (1997),
/// three triple products that are exact where the faces are bilinear (a test integrates over such faces).
///
/// The volume swept by a face whose corners move along straight lines is the same function with the old face as
/// corners 0-3 and the new one as 4-7.
#[inline]
#[must_use]
pub fn hexahedron_volume(c: &[[f64; 3]; 8]) -> f64 {
    let triple = |a, b, d| dot(a, cross(b, d));
    let d70 = |a: usize, b: usize| sub(c[a], c[b]);
    (triple(add(d70(7, 1), d70(6, 0)), d70(7, 2), d70(3, 0))
        + triple(d70(6, 0), add(d70(7, 2), d70(5, 0)), d70(7, 4))
        + triple(d70(7, 1), d70(5, 0), add(d70(7, 4), d70(3, 0))))
        / 12.0
}

/// Metrics of a block, as structure of arrays with i fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Metrics {
    /// Area vectors of the faces normal to i, towards increasing i: three arrays (x, y, z components) of
    /// `(ni+1) nj nk`, face `(i, j, k)` at `i + (ni+1) (j + nj k)`; face `i` is between cells `i-1` and `i`.
    pub si: [Vec<f64>; 3],
    /// Area vectors of the faces normal to j: `ni (nj+1) nk`, face `(i, j, k)` at `i + ni (j + (nj+1) k)`.
    pub sj: [Vec<f64>; 3],
    /// Area vectors of the faces normal to k: `ni nj (nk+1)`, face `(i, j, k)` at `i + ni (j + nj k)`.
    pub sk: [Vec<f64>; 3],
    /// Volumes, `ni nj nk`.
    pub volume: Vec<f64>,
}

impl Metrics {
    /// Computes the metrics of `block`. Area vectors point towards increasing index if the block is right-handed
    /// (volumes are positive); in a left-handed block both turn their sign.
    #[must_use]
    pub fn new(block: &Block) -> Self {
        let [ni, nj, nk] = block.cells();
        let array = |n: usize| [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        let mut m = Self {
            si: array((ni + 1) * nj * nk),
            sj: array(ni * (nj + 1) * nk),
            sk: array(ni * nj * (nk + 1)),
            volume: vec![0.0; ni * nj * nk],
        };
        let p = |i, j, k| block.point(i, j, k);
        let put = |to: &mut [Vec<f64>; 3], n: usize, s: [f64; 3]| {
            for d in 0..3 {
                to[d][n] = s[d];
            }
        };
        for k in 0..nk {
            for j in 0..nj {
                for i in 0..=ni {
                    let s = face_area(p(i, j, k), p(i, j + 1, k), p(i, j + 1, k + 1), p(i, j, k + 1));
                    put(&mut m.si, i + (ni + 1) * (j + nj * k), s);
                }
            }
            for j in 0..=nj {
                for i in 0..ni {
                    let s = face_area(p(i, j, k), p(i, j, k + 1), p(i + 1, j, k + 1), p(i + 1, j, k));
                    put(&mut m.sj, i + ni * (j + (nj + 1) * k), s);
                }
            }
        }
        for k in 0..=nk {
            for j in 0..nj {
                for i in 0..ni {
                    let s = face_area(p(i, j, k), p(i + 1, j, k), p(i + 1, j + 1, k), p(i, j + 1, k));
                    put(&mut m.sk, i + ni * (j + nj * k), s);
                }
            }
        }
        let mut n = 0;
        for k in 0..nk {
            for j in 0..nj {
                for i in 0..ni {
                    m.volume[n] = hexahedron_volume(&block.corners(i, j, k));
                    n += 1;
                }
            }
        }
        m
    }

    /// Sum of the six outward area vectors of cell `(i, j, k)` of a block of `cells`: zero to round-off.
    #[must_use]
    pub fn closure(&self, cells: [usize; 3], i: usize, j: usize, k: usize) -> [f64; 3] {
        let [ni, nj, _] = cells;
        let fi = i + (ni + 1) * (j + nj * k);
        let fj = i + ni * (j + (nj + 1) * k);
        let fk = i + ni * (j + nj * k);
        [0, 1, 2].map(|d| {
            (self.si[d][fi + 1] - self.si[d][fi])
                + (self.sj[d][fj + ni] - self.sj[d][fj])
                + (self.sk[d][fk + ni * nj] - self.sk[d][fk])
        })
    }
}
