//! Normal modes: K phi = omega^2 M phi.
//!
//! Large problems by block Lanczos on (K + s M)^-1 M (`lanczos.rs`), small ones and reduced ones dense
//! (`dense.rs`). The shift s is positive, so K + s M is positive definite for supported and for
//! free structures alike, also with massless degrees of freedom.

mod dense;
mod lanczos;

use crate::dof::{DOFS_PER_NODE, Dof};
use crate::element::NodeDof;
use crate::error::{EigenError, ModelError};
use crate::factor::{Factor, Pencil};
use crate::modes::Modes;
use crate::system::System;

/// Up to this size the dense solver is the faster one.
const DENSE_SIZE: usize = 200;
/// Up to this size the dense solver is taken when a large part of all modes is asked for.
const DENSE_LIMIT: usize = 1500;
/// First shift over the lowest Rayleigh quotient of a single degree of freedom. A plate of N elements across has its
/// lowest eigenvalue near N^-4 of that; a smaller shift costs accuracy of free structures only.
const FIRST_SHIFT: f64 = 1e-8;
/// A shift is kept when the lowest elastic eigenvalue lies between these factors of it: a larger shift
/// hides the lowest modes from the iteration, a smaller one costs digits.
const SHIFT_RANGE: std::ops::Range<f64> = 0.1..1e4;
/// Corrections of the shift; each estimate of the lowest eigenvalue comes from above.
const SHIFT_STEPS: usize = 6;
/// A pivot of K + s M below this fraction of its diagonal: no stiffness and no mass there.
const PIVOT_LIMIT: f64 = 1e-14;

/// How mode shapes are scaled.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Normalization {
    /// Generalized mass one.
    #[default]
    Mass,
    /// Largest displacement or rotation of the analysis set one (node frames).
    Maximum,
    /// One at a given point.
    Point(NodeDof),
}

/// What modes are wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct ModesRequest {
    /// How many, from the lowest. A structure with fewer gives what it has.
    pub count: usize,
    /// Only those up to this frequency, Hz.
    pub max_freq_hz: Option<f64>,
    /// Scaling of the shapes.
    pub normalization: Normalization,
    /// Bound on the relative error of each eigenvalue.
    pub tolerance: f64,
    /// Shift s of K + s M, rad^2/s^2, positive; `None`: chosen from the matrices.
    pub shift: Option<f64>,
    /// Whether to count the eigenvalues below the last mode by a Sturm sequence (one more factorization).
    pub sturm_check: bool,
}

impl Default for ModesRequest {
    fn default() -> Self {
        Self {
            count: 10,
            max_freq_hz: None,
            normalization: Normalization::Mass,
            tolerance: 1e-9,
            shift: None,
            sturm_check: true,
        }
    }
}

impl ModesRequest {
    /// The `count` lowest modes, mass-normalized.
    pub fn lowest(count: usize) -> Self {
        Self {
            count,
            ..Self::default()
        }
    }
}

/// One eigenpair over the degrees of freedom of the eigenproblem.
pub(crate) struct Pair {
    /// omega^2.
    pub lambda: f64,
    /// Shape with phi^T M phi = 1.
    pub shape: Vec<f64>,
    /// Bound on the relative error of lambda + s.
    pub residual: f64,
    /// Size of the terms that phi^T K phi is the sum of.
    pub magnitude: f64,
}

impl System {
    /// Normal modes, lowest first.
    ///
    /// The sign of a shape is fixed: its largest displacement (the first of equal ones) is positive.
    ///
    /// # Errors
    /// [`EigenError`]: no mass, a mechanism without mass, no convergence, modes missed.
    pub fn modes(&self, request: &ModesRequest) -> Result<Modes, EigenError> {
        if request.count == 0 {
            return Err(EigenError::NoneAsked);
        }
        if let Some(shift) = request.shift
            && !(shift > 0.0 && shift.is_finite())
        {
            return Err(ModelError::BadValue {
                place: "the request for modes".to_owned(),
                name: "the shift",
                needed: "a positive value",
                got: format!("{shift}"),
            }
            .into());
        }
        let mut pairs = if self.analysis.is_empty() {
            self.pairs_free(request)?
        } else {
            self.pairs_reduced(request)?
        };
        if let Some(limit) = request.max_freq_hz {
            pairs.retain(|p| p.lambda.max(0.0).sqrt() <= limit * std::f64::consts::TAU);
        }
        pairs.truncate(request.count);
        let mut out = Modes {
            nodes: self.nodes.clone(),
            shapes: Vec::with_capacity(pairs.len()),
            omega_rad_s: Vec::with_capacity(pairs.len()),
            generalized_mass: Vec::with_capacity(pairs.len()),
            residual: Vec::with_capacity(pairs.len()),
        };
        for (mode, pair) in pairs.into_iter().enumerate() {
            // A strain energy within the round-off of its terms is that of a rigid motion.
            let rigid = pair.lambda.abs() <= 100.0 * f64::EPSILON * pair.magnitude;
            out.omega_rad_s
                .push(if rigid { 0.0 } else { pair.lambda.max(0.0).sqrt() });
            let mut shape = self.expand(&pair.shape);
            let factor = self.scale(&shape, mode, request.normalization)?;
            shape.iter_mut().flatten().for_each(|v| *v *= factor);
            out.shapes.push(shape);
            out.generalized_mass.push(factor * factor);
            out.residual.push(pair.residual);
        }
        Ok(out)
    }

    /// Factor that brings a mass-normalized shape to the wanted scale and sign.
    fn scale(
        &self,
        shape: &[[f64; DOFS_PER_NODE]],
        mode: usize,
        normalization: Normalization,
    ) -> Result<f64, EigenError> {
        let largest = |dofs: std::ops::Range<usize>| {
            let peak = shape
                .iter()
                .flat_map(|s| &s[dofs.clone()])
                .fold(0.0_f64, |m, v| m.max(v.abs()));
            // The first of those that are equal up to round-off, so that symmetric shapes keep one sign.
            shape
                .iter()
                .flat_map(|s| &s[dofs.clone()])
                .copied()
                .find(|v| v.abs() >= peak * (1.0 - 1e-6))
                .unwrap_or(0.0)
        };
        let translation = largest(0..3);
        let sign = if translation != 0.0 { translation } else { largest(3..6) }.signum();
        Ok(match normalization {
            Normalization::Mass => sign,
            Normalization::Maximum => {
                let all: Vec<f64> = shape.iter().flatten().copied().collect();
                let set: Vec<f64> = if self.analysis.is_empty() {
                    all
                } else {
                    self.analysis.iter().map(|&f| all[self.reduction.free[f]]).collect()
                };
                let peak = set.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                if peak > 0.0 { sign / peak } else { sign }
            }
            Normalization::Point(at) => {
                let n = self.index.find(at.node, || "the normalization point".to_owned())?;
                let value = shape[n][at.dof.index()];
                let peak = shape.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
                if value.abs() <= 1e-9 * peak {
                    return Err(EigenError::BadNormalization {
                        mode: mode + 1,
                        node: at.node,
                        dof: at.dof,
                    });
                }
                1.0 / value
            }
        })
    }

    fn pairs_reduced(&self, request: &ModesRequest) -> Result<Vec<Pair>, EigenError> {
        let condensed = self.condense()?;
        let mut pairs = dense::solve(&condensed.stiffness, &condensed.mass, request.shift)?;
        pairs.truncate(request.count);
        let n = self.size();
        for pair in &mut pairs {
            pair.shape = (0..n)
                .map(|i| {
                    pair.shape
                        .iter()
                        .enumerate()
                        .map(|(j, v)| condensed.motion[(i, j)] * v)
                        .sum()
                })
                .collect();
        }
        Ok(pairs)
    }

    fn pairs_free(&self, request: &ModesRequest) -> Result<Vec<Pair>, EigenError> {
        let n = self.size();
        // Whoever asks for more than there are gets all.
        let wanted = request.count.min(n);
        let pencil = Pencil::new(&self.stiffness, &self.mass)?;
        let (k, m) = pencil.diagonals();
        if m.iter().all(|&v| v <= 0.0) {
            return Err(EigenError::NoMass);
        }
        let mut shift = request.shift.unwrap_or_else(|| first_shift(k.iter().copied().zip(m)));
        let mut factor = self.factor(&pencil, shift)?;
        if n <= DENSE_SIZE || (n <= DENSE_LIMIT && 4 * wanted >= n) {
            // The factorization above has found mechanisms, with their names.
            let dense = |a: &sprs::CsMat<f64>| faer::Mat::from_fn(n, n, |i, j| a.get(i, j).copied().unwrap_or(0.0));
            return dense::solve(&dense(&self.stiffness), &dense(&self.mass), request.shift);
        }
        for _ in 0..if request.shift.is_some() { 0 } else { SHIFT_STEPS } {
            let elastic = lanczos::lowest_elastic(&pencil, &factor, shift)?;
            if elastic <= 0.0 || SHIFT_RANGE.contains(&(elastic / shift)) {
                break;
            }
            shift = elastic;
            factor = self.factor(&pencil, shift)?;
        }
        // Two more than asked for: the count is taken in a gap, and the value above it must be known.
        let mut count = wanted + 2;
        let mut found = lanczos::solve(&pencil, &factor, shift, count, request.tolerance)?;
        if request.sturm_check && count_below(&pencil, &found).is_err() {
            // A root of high multiplicity may hide from a start block: look with a larger basis.
            count += wanted.max(16);
            found = lanczos::solve(&pencil, &factor, shift, count, request.tolerance)?;
            count_below(&pencil, &found)?;
        }
        Ok(found.pairs)
    }

    /// K + s M in factors; a pivot that vanishes is a mechanism.
    fn factor<'a>(&self, pencil: &'a Pencil, shift: f64) -> Result<Factor<'a>, EigenError> {
        let factor = pencil.factor(-shift)?;
        let (k, m) = pencil.diagonals();
        let diagonal: Vec<f64> = k.iter().zip(&m).map(|(k, m)| k + shift * m).collect();
        match factor.loose(&diagonal, PIVOT_LIMIT) {
            Some((free, ratio)) => Err(self.mechanism(free, ratio).into()),
            None => Ok(factor),
        }
    }
}

/// A shift to begin with, from the diagonals (k, m): a unit motion of one degree of freedom has the Rayleigh
/// quotient k/m, and the lowest of them bounds the lowest eigenvalue from above.
fn first_shift(diagonals: impl Iterator<Item = (f64, f64)>) -> f64 {
    let bound = diagonals
        .filter(|(k, m)| *m > 0.0 && *k > 0.0)
        .map(|(k, m)| k / m)
        .fold(f64::INFINITY, f64::min);
    if bound.is_finite() { FIRST_SHIFT * bound } else { 1.0 }
}

/// Compares the number of modes found below a gap in the spectrum with the Sturm count there.
fn count_below(pencil: &Pencil, found: &lanczos::Found) -> Result<(), EigenError> {
    let lambda: Vec<f64> = found.pairs.iter().map(|p| p.lambda).chain(found.next).collect();
    // The highest gap that is wide against round-off.
    let gap = (1..lambda.len())
        .rev()
        .find(|&i| lambda[i] > 0.0 && lambda[i] - lambda[i - 1] > 1e-3 * lambda[i]);
    let Some(below) = gap else { return Ok(()) };
    // Nearer to the mode below: the value above may not have converged, and falls when it does.
    let at = lambda[below - 1].max(0.0) + 0.25 * (lambda[below] - lambda[below - 1].max(0.0));
    let counted = pencil.factor(at)?.eigenvalues_below();
    if counted == below {
        return Ok(());
    }
    Err(EigenError::Missed {
        found: below,
        counted,
        omega_rad_s: at.sqrt(),
    })
}

impl Modes {
    /// The component `dof` of every node in `mode`, node frames.
    pub fn component(&self, mode: usize, dof: Dof) -> impl Iterator<Item = f64> {
        self.shapes[mode].iter().map(move |s| s[dof.index()])
    }
}
