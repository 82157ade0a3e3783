//! Tridiagonal systems along the lines of a grid.

/// A tridiagonal system for all coordinates: `x_m - below x_(m-1) - above x_(m+1) = rest`.
pub(super) struct Line<const D: usize> {
    below: Vec<f64>,
    above: Vec<f64>,
    rest: Vec<[f64; D]>,
    pub(super) out: Vec<[f64; D]>,
}

impl<const D: usize> Line<D> {
    pub(super) fn new(n: usize) -> Self {
        Self {
            below: vec![0.0; n],
            above: vec![0.0; n],
            rest: vec![[0.0; D]; n],
            out: vec![[0.0; D]; n],
        }
    }

    /// One unknown: its weights below and above, and its right-hand side.
    pub(super) fn set(&mut self, m: usize, weights: [f64; 2], rest: [f64; D]) {
        [self.below[m], self.above[m]] = weights;
        self.rest[m] = rest;
    }

    /// Solves for `range` with known values before and behind it (Thomas' algorithm; |below| + |above| < 1).
    pub(super) fn solve(&mut self, range: std::ops::Range<usize>, before: [f64; D], behind: [f64; D]) {
        let last = range.end - 1;
        // What is known before the first unknown and behind the last one goes to the right.
        for d in 0..D {
            self.rest[range.start][d] += self.below[range.start] * before[d];
            self.rest[last][d] += self.above[last] * behind[d];
        }
        for m in range.clone().skip(1) {
            let below = self.below[m];
            let pivot = 1.0 - below * self.above[m - 1];
            let previous = self.rest[m - 1];
            for (value, previous) in self.rest[m].iter_mut().zip(previous) {
                *value = (*value + below * previous) / pivot;
            }
            self.above[m] /= pivot;
        }
        self.out[last] = self.rest[last];
        for m in range.rev().skip(1) {
            for d in 0..D {
                self.out[m][d] = self.rest[m][d] + self.above[m] * self.out[m + 1][d];
            }
        }
    }
}
