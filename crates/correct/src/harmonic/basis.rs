//! The functions of the fit at the instants of a window, and their pseudo-inverse.

use super::Model;
use crate::HarmonicError;

/// Columns [mean, (drift), cos and sin of every frequency and harmonic] as an orthonormal and a triangular factor.
pub(super) struct Basis {
    drift_scale: Option<f64>,
    harmonics: usize,
    /// Functions `[unknown][instant]`.
    columns: Vec<Vec<f64>>,
    /// Pseudo-inverse `[unknown][instant]`.
    inverse: Vec<Vec<f64>>,
    condition: f64,
}

/// Columns whose triangular factor falls below this part of the largest can't be told apart.
const RANK: f64 = 1e-7;

impl Basis {
    pub(super) fn new(time_s: &[f64], model: &Model) -> Result<Self, HarmonicError> {
        if let Some(bad) = model.omega_rad_s.iter().find(|w| !(w.is_finite() && **w > 0.0)) {
            return Err(HarmonicError::Frequency { omega_rad_s: *bad });
        }
        let n = time_s.len();
        let unknowns = 1 + usize::from(model.drift) + 2 * model.omega_rad_s.len() * model.harmonics;
        if n <= unknowns {
            return Err(HarmonicError::TooFew {
                needed: unknowns + 1,
                got: n,
            });
        }
        let middle = 0.5 * (time_s[0] + time_s[n - 1]);
        let half = 0.5 * (time_s[n - 1] - time_s[0]);
        let mut columns = vec![vec![1.0; n]];
        if model.drift {
            columns.push(time_s.iter().map(|t| (t - middle) / half).collect());
        }
        for omega in &model.omega_rad_s {
            for h in 1..=model.harmonics {
                let angle = |t: &f64| h as f64 * omega * (t - model.phase_origin_s);
                columns.push(time_s.iter().map(|t| angle(t).cos()).collect());
                columns.push(time_s.iter().map(|t| angle(t).sin()).collect());
            }
        }
        let (q, r) = orthogonalize(&columns);
        let size = |j: usize| r[j][j].abs();
        let (largest, smallest) =
            (0..unknowns).fold((0.0_f64, f64::INFINITY), |(a, b), j| (a.max(size(j)), b.min(size(j))));
        if smallest <= RANK * largest {
            return Err(HarmonicError::Indistinct {
                omega_rad_s: model.omega_rad_s.clone(),
                harmonics: model.harmonics,
                window_s: 2.0 * half,
                instants: n,
            });
        }
        Ok(Self {
            drift_scale: model.drift.then_some(half),
            harmonics: model.harmonics,
            inverse: invert(&q, &r),
            columns,
            condition: largest / smallest,
        })
    }

    pub(super) fn unknowns(&self) -> usize {
        self.columns.len()
    }

    pub(super) fn value(&self, unknown: usize, instant: usize) -> f64 {
        self.columns[unknown][instant]
    }

    pub(super) fn inverse(&self, unknown: usize, instant: usize) -> f64 {
        self.inverse[unknown][instant]
    }

    /// Place of the drift among the unknowns, and the seconds that its function is scaled by.
    pub(super) fn drift(&self) -> Option<(usize, f64)> {
        self.drift_scale.map(|scale| (1, scale))
    }

    /// Places of cosine and sine of frequency `f` and harmonic `h` (from 1).
    pub(super) fn pair(&self, f: usize, h: usize) -> (usize, usize) {
        let first = 1 + usize::from(self.drift_scale.is_some()) + 2 * (f * self.harmonics + h - 1);
        (first, first + 1)
    }

    pub(super) fn condition(&self) -> f64 {
        self.condition
    }
}

/// Modified Gram-Schmidt, twice ("twice is enough", Giraud, Langou, Rozloznik 2005): Q [column][instant], R [column][row].
fn orthogonalize(columns: &[Vec<f64>]) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let mut q: Vec<Vec<f64>> = Vec::with_capacity(columns.len());
    let mut r: Vec<Vec<f64>> = Vec::with_capacity(columns.len());
    for column in columns {
        let mut v = column.clone();
        let mut above = vec![0.0; q.len() + 1];
        for _ in 0..2 {
            for (k, e) in q.iter().enumerate() {
                let part = dot(e, &v);
                above[k] += part;
                for (x, y) in v.iter_mut().zip(e) {
                    *x -= part * y;
                }
            }
        }
        let norm = dot(&v, &v).sqrt();
        above[q.len()] = norm;
        if norm > 0.0 {
            v.iter_mut().for_each(|x| *x /= norm);
        }
        q.push(v);
        r.push(above);
    }
    (q, r)
}

/// R^-1 Q^T by back substitution, [unknown][instant].
fn invert(q: &[Vec<f64>], r: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let p = q.len();
    let mut inverse = q.to_vec();
    for j in (0..p).rev() {
        let (head, tail) = inverse.split_at_mut(j + 1);
        for (done, column) in tail.iter().zip(&r[j + 1..]) {
            for (x, y) in head[j].iter_mut().zip(done) {
                *x -= column[j] * y;
            }
        }
        inverse[j].iter_mut().for_each(|x| *x /= r[j][j]);
    }
    inverse
}
