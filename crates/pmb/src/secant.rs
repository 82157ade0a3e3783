//! The first guess of a real time step from what the last steps taught.
//!
//! Every finished step leaves a pair: by how much the flow changed, dW, and by how much the residual of that step's
//! equations changed with it, db = A dW. A new step starts from the old flow and its residual b; the combination of
//! kept changes whose residuals add up to b best (least squares) is taken as the first change: no product with the
//! operator is needed. For a small periodic motion a few pairs span every change to come. An extrapolation in time with
//! fixed coefficients, which this replaces, amplifies what earlier steps left unconverged; a least residual cannot.

use dip_krylov::vector;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// The last pairs, oldest first.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Secants {
    /// Pairs kept, at most.
    pub most: usize,
    /// Changes of the flow and of the residual, `[pair][cell][variable]`.
    #[serde(skip)]
    pub pairs: Vec<[Vec<f32>; 2]>,
    /// Inner products of the residuals' changes, lower triangle: `[pair][pair up to it]`.
    gram: Vec<Vec<f64>>,
}

impl Secants {
    /// Keeps at most `most` pairs.
    #[must_use]
    pub fn new(most: usize) -> Self {
        Self {
            most,
            pairs: Vec::new(),
            gram: Vec::new(),
        }
    }

    /// Adds a pair: flow and right-hand side (minus the residual) at the beginning and at the end of a step.
    pub fn learn(&mut self, w: [&[f64]; 2], b: [&[f64]; 2]) {
        if self.most == 0 {
            return;
        }
        let mut pair = if self.pairs.len() >= self.most {
            self.gram.remove(0);
            for row in &mut self.gram {
                row.remove(0);
            }
            self.pairs.remove(0)
        } else {
            [vec![0.0; w[0].len()], vec![0.0; w[0].len()]]
        };
        const PIECE: usize = 2560;
        let [dw, db] = &mut pair;
        dw.par_chunks_mut(PIECE)
            .zip(db.par_chunks_mut(PIECE))
            .enumerate()
            .for_each(|(n, (dw, db))| {
                let from = n * PIECE;
                for (i, (dw, db)) in dw.iter_mut().zip(db).enumerate() {
                    *dw = (w[1][from + i] - w[0][from + i]) as f32;
                    *db = (b[0][from + i] - b[1][from + i]) as f32;
                }
            });
        self.pairs.push(pair);
        let last = self.pairs.len() - 1;
        let row: Vec<f64> = self
            .pairs
            .iter()
            .map(|p| vector::dot(&p[1], &self.pairs[last][1]))
            .collect();
        self.gram.push(row);
    }

    /// Adds to `w` the combination of kept changes that would bring the right-hand side `b` down most. Returns false if there
    /// is nothing to add.
    pub fn apply(&self, b: &[f64], w: &mut [f64]) -> bool {
        let n = self.pairs.len();
        // Pairs of a motion that begins may have no length.
        let size: Vec<f64> = (0..n).map(|i| self.gram[i][i].sqrt()).collect();
        if n == 0 || size.iter().any(|s| !(*s > 0.0 && s.is_finite())) {
            return false;
        }
        let products: Vec<f64> = self.pairs.iter().map(|p| vector::dot(b, &p[1])).collect();
        // Changes of unit length, so that old and new ones count alike; directions below single precision are left out.
        let gram = DMatrix::from_fn(n, n, |i, j| self.gram[i.max(j)][i.min(j)] / (size[i] * size[j]));
        let right = DVector::from_fn(n, |i, _| products[i] / size[i]);
        const SMALLEST: f64 = 1e-9;
        let eigen = gram.symmetric_eigen();
        let largest = eigen.eigenvalues.max();
        let mut coefficients = DVector::zeros(n);
        for (value, direction) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value > SMALLEST * largest {
                coefficients += direction * (direction.dot(&right) / value);
            }
        }
        if coefficients.iter().any(|c| !c.is_finite()) {
            return false;
        }
        let scaled: Vec<f64> = coefficients.iter().zip(&size).map(|(c, size)| c / size).collect();
        let changes: Vec<&[f32]> = self.pairs.iter().map(|p| p[0].as_slice()).collect();
        vector::add_many(w, &scaled, &changes);
        true
    }
}
