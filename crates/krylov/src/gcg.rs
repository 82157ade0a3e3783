//! Generalized conjugate gradients (GCG) for non-symmetric systems.
//!
//! O. Axelsson, A generalized conjugate gradient, least square method, Numer. Math. 51 (1987); with the preconditioner
//! on the right this is GCR (Eisenstat, Elman and Schultz 1983): each search direction `p = M^-1 r` has its image
//! `q = A p` made orthogonal to the kept images, and the step along it makes `|r|` least over all kept directions.
//! The preconditioner may change from one iteration to the next. `A p = q` is kept for every direction, so directions
//! can be stored in single precision while `r` and `x` are double.

use crate::vector::{add_scaled, dot, dot_many, norm, scale_into, subtract_many};
use crate::{KrylovError, Storage};

/// `y = A x`.
pub trait LinearOperator<S> {
    /// Applies the operator to a direction.
    ///
    /// # Errors
    /// The operator's own; they end the iteration.
    fn apply(&mut self, x: &[S], y: &mut [f64]) -> Result<(), KrylovError>;
}

/// `z ~ A^-1 r`.
pub trait Preconditioner<S> {
    /// Applies the preconditioner.
    fn solve(&mut self, r: &[f64], z: &mut [S]);
}

/// When to stop, and how much to keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GcgSettings {
    /// Ends when `|r|` is below this part of its first value.
    pub tolerance: f64,
    /// Ends after as many products with the operator.
    pub max_iterations: usize,
    /// Ends after as many products if `|r|` is then still above nine tenths of its first value: the system is out of reach.
    pub patience: usize,
    /// Directions kept. When all are in use the oldest is given up (truncation).
    pub directions: usize,
}

impl Default for GcgSettings {
    fn default() -> Self {
        Self {
            tolerance: 0.1,
            max_iterations: 30,
            patience: 30,
            directions: 10,
        }
    }
}

/// How an iteration ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GcgOutcome {
    /// Products with the operator.
    pub iterations: usize,
    /// `|r|` at the end, as part of its first value.
    pub reduction: f64,
    /// True if the tolerance was met.
    pub converged: bool,
}

/// The method with its work arrays, kept between solves so that nothing is allocated in an iteration.
#[derive(Clone, Debug, Default)]
pub struct Gcg<S> {
    p: Vec<Vec<S>>,
    q: Vec<Vec<S>>,
    image: Vec<f64>,
}

impl<S: Storage> Gcg<S> {
    /// Room is made when first used.
    #[must_use]
    pub fn new() -> Self {
        Self {
            p: Vec::new(),
            q: Vec::new(),
            image: Vec::new(),
        }
    }

    /// Solves `A x = b` from `x = 0`. `b` holds the remaining residual at the end.
    ///
    /// # Errors
    /// [`KrylovError::Breakdown`] if a value is not finite or `A p = 0`; whatever the operator reports;
    /// [`KrylovError::Length`].
    pub fn solve(
        &mut self,
        operator: &mut impl LinearOperator<S>,
        preconditioner: &mut impl Preconditioner<S>,
        settings: &GcgSettings,
        b: &mut [f64],
        x: &mut [f64],
    ) -> Result<GcgOutcome, KrylovError> {
        let n = b.len();
        if x.len() != n {
            return Err(KrylovError::Length {
                what: "solution vector",
                needed: n,
                got: x.len(),
            });
        }
        x.fill(0.0);
        let kept = settings.directions.max(1);
        for set in [&mut self.p, &mut self.q] {
            set.resize_with(kept, Vec::new);
            set.iter_mut().for_each(|v| v.resize(n, S::default()));
        }
        self.image.resize(n, 0.0);

        let start = norm(b);
        if start == 0.0 {
            return Ok(GcgOutcome {
                iterations: 0,
                reduction: 0.0,
                converged: true,
            });
        }
        let mut reduction = 1.0;
        for iteration in 0..settings.max_iterations {
            let slot = iteration % kept;
            let used = iteration.min(kept);
            preconditioner.solve(b, &mut self.p[slot]);
            operator.apply(&self.p[slot], &mut self.image)?;

            // Orthogonalize the image against the kept ones (classical Gram-Schmidt: one pass for all products).
            let (p_new, p_old) = split(&mut self.p, slot, used);
            let (q_new, q_old) = split(&mut self.q, slot, used);
            let products = dot_many(&self.image, &q_old);
            let own = products[used.min(q_old.len())];
            if !(own > 0.0 && own.is_finite()) {
                return Err(KrylovError::Breakdown {
                    iteration: iteration + 1,
                    norm_squared: own,
                });
            }
            let coefficients = &products[..q_old.len()];
            subtract_many(&mut self.image, coefficients, &q_old);
            subtract_many(p_new, coefficients, &p_old);
            let length_squared = dot(&self.image, &self.image);
            if !(length_squared > 0.0 && length_squared.is_finite()) {
                return Err(KrylovError::Breakdown {
                    iteration: iteration + 1,
                    norm_squared: length_squared,
                });
            }
            // Images are stored with unit length, their directions scaled alike.
            let scale = 1.0 / length_squared.sqrt();
            scale_into(scale, &self.image, q_new);
            for v in p_new.iter_mut() {
                *v = S::from_f64(v.to_f64() * scale);
            }
            let step = dot(b, &*q_new);
            add_scaled(x, step, &*p_new);
            add_scaled(b, -step, &*q_new);

            reduction = norm(b) / start;
            if !reduction.is_finite() {
                return Err(KrylovError::Breakdown {
                    iteration: iteration + 1,
                    norm_squared: length_squared,
                });
            }
            if reduction <= settings.tolerance {
                return Ok(GcgOutcome {
                    iterations: iteration + 1,
                    reduction,
                    converged: true,
                });
            }
            if iteration + 1 == settings.patience && reduction > 0.9 {
                return Ok(GcgOutcome {
                    iterations: iteration + 1,
                    reduction,
                    converged: false,
                });
            }
        }
        Ok(GcgOutcome {
            iterations: settings.max_iterations,
            reduction,
            converged: false,
        })
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let directions: usize = self.p.iter().chain(&self.q).map(Vec::len).sum();
        directions * size_of::<S>() + self.image.len() * size_of::<f64>()
    }
}

/// The vector to be written and those in use, the oldest of which is the one overwritten once all are.
fn split<S>(set: &mut [Vec<S>], slot: usize, used: usize) -> (&mut Vec<S>, Vec<&[S]>) {
    let (before, rest) = set.split_at_mut(slot);
    // The slot is never empty: there is at least one.
    let (new, after) = rest.split_at_mut(1);
    let old = before
        .iter()
        .chain(after.iter().take(used.saturating_sub(slot)))
        .map(Vec::as_slice)
        .collect();
    (&mut new[0], old)
}
