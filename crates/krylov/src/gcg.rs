//! Generalized conjugate gradients (GCG) for non-symmetric systems.
//!
//! O. Axelsson, A generalized conjugate gradient, least square method, Numer. Math. 51 (1987); with the preconditioner
//! on the right this is GCR (Eisenstat, Elman and Schultz 1983): each search direction `p = M^-1 r` has its image
//! `q = A p` made orthogonal to the kept images, and the step along it makes `|r|` least over all kept directions.
//! The preconditioner may change from one iteration to the next. `A p = q` is kept for every direction, so directions
//! can be stored in single precision while `r` and `x` are double.
//!
//! Only the images are made orthogonal as the iteration goes. The directions stay as the preconditioner gave them, and
//! the coefficients of the triangular relation `A P = Q R` are kept instead: the step along the orthogonalized
//! directions is `P R^-1 y` with `y_m = b . q_m`, summed up once at the end. That is the same method with a third of
//! its memory traffic less. A direction that makes room for a new one is first taken out of those that stay.

use crate::vector::{add_many, add_scaled, add_scaled_stored, dot_many, norm, orthogonalize, store_and_step};
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

/// A kept direction and its part in the solution.
#[derive(Clone, Debug)]
struct Kept<S> {
    /// The direction as the preconditioner gave it.
    p: Vec<S>,
    /// Its image, orthogonal to the older ones, of unit length.
    q: Vec<S>,
    /// `A p . q` with the images of the older directions, by slot (column of R above its diagonal).
    above: Vec<f64>,
    /// `A p . q` with its own (diagonal of R).
    length: f64,
    /// Step along the image.
    step: f64,
}

impl<S> Default for Kept<S> {
    fn default() -> Self {
        Self {
            p: Vec::new(),
            q: Vec::new(),
            above: Vec::new(),
            length: 1.0,
            step: 0.0,
        }
    }
}

/// The method with its work arrays, kept between solves so that no vector is allocated in an iteration.
#[derive(Clone, Debug, Default)]
pub struct Gcg<S> {
    kept: Vec<Kept<S>>,
    image: Vec<f64>,
    scratch: Vec<f64>,
    products: Vec<f64>,
}

impl<S: Storage> Gcg<S> {
    /// Room is made when first used.
    #[must_use]
    pub fn new() -> Self {
        Self {
            kept: Vec::new(),
            image: Vec::new(),
            scratch: Vec::new(),
            products: Vec::new(),
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
        let most = settings.directions.max(1);
        self.kept.truncate(most);
        self.image.resize(n, 0.0);

        let start = norm(b);
        if start == 0.0 {
            return Ok(GcgOutcome {
                iterations: 0,
                reduction: 0.0,
                converged: true,
            });
        }
        let mut outcome = GcgOutcome {
            iterations: 0,
            reduction: 1.0,
            converged: false,
        };
        while outcome.iterations < settings.max_iterations {
            let iteration = outcome.iterations;
            let slot = iteration % most;
            let full = iteration >= most;
            if full {
                self.retire(slot, x);
            } else if slot == self.kept.len() {
                self.kept.push(Kept::default());
            }
            let reduction = self.iterate(operator, preconditioner, iteration, slot, full, b)? / start;
            outcome.iterations += 1;
            outcome.reduction = reduction;
            if !reduction.is_finite() {
                return Err(breakdown(iteration, reduction));
            }
            outcome.converged = reduction <= settings.tolerance;
            if outcome.converged || (outcome.iterations == settings.patience && reduction > 0.9) {
                break;
            }
        }
        let used = outcome.iterations.min(most);
        let oldest = if outcome.iterations > most {
            outcome.iterations % most
        } else {
            0
        };
        self.sum_up(used, oldest, x);
        Ok(outcome)
    }

    /// One direction more, in `slot`: its image is made orthogonal to the kept ones, and `b` least along it. Returns the
    /// norm of `b`.
    fn iterate(
        &mut self,
        operator: &mut impl LinearOperator<S>,
        preconditioner: &mut impl Preconditioner<S>,
        iteration: usize,
        slot: usize,
        full: bool,
        b: &mut [f64],
    ) -> Result<f64, KrylovError> {
        let used = if full { self.kept.len() } else { slot + 1 };
        let mut new = std::mem::take(&mut self.kept[slot]);
        for vector in [&mut new.p, &mut new.q] {
            if vector.len() != b.len() {
                // Zeros from the system: their pages come when a thread first writes to them, not here one by one.
                *vector = vec![S::default(); b.len()];
            }
        }
        preconditioner.solve(b, &mut new.p);
        operator.apply(&new.p, &mut self.image)?;

        // Orthogonalize the image against the kept ones (classical Gram-Schmidt: one pass for all products).
        let others = |m: &usize| *m != slot;
        let basis: Vec<&[S]> = (0..used).filter(others).map(|m| self.kept[m].q.as_slice()).collect();
        self.products.resize(used, 0.0);
        dot_many(&mut self.image, &basis, &mut self.scratch, &mut self.products);
        let (coefficients, own) = self.products.split_at(used - 1);
        if !(own[0] > 0.0 && own[0].is_finite()) {
            return Err(breakdown(iteration, own[0]));
        }
        let [length_squared, product] = orthogonalize(&mut self.image, coefficients, &basis, b, &mut self.scratch);
        if !(length_squared > 0.0 && length_squared.is_finite()) {
            return Err(breakdown(iteration, length_squared));
        }
        new.length = length_squared.sqrt();
        new.step = product / new.length;
        new.above.clear();
        new.above.resize(self.kept.len(), 0.0);
        for (m, c) in (0..used).filter(others).zip(coefficients) {
            new.above[m] = *c;
        }
        let scale = 1.0 / new.length;
        let squared = store_and_step(&self.image, scale, &mut new.q, new.step, b, &mut self.scratch);
        self.kept[slot] = new;
        Ok(squared.sqrt())
    }

    /// Takes the oldest direction, in `slot`, out of the sums that are still to be made: its part goes into `x`, and the
    /// directions that were made orthogonal to it by their coefficients now are so themselves.
    fn retire(&mut self, slot: usize, x: &mut [f64]) {
        let (before, rest) = self.kept.split_at_mut(slot);
        let Some((old, after)) = rest.split_first_mut() else {
            return;
        };
        let scale = 1.0 / old.length;
        add_scaled(x, old.step * scale, &old.p);
        for other in before.iter_mut().chain(after) {
            let c = std::mem::replace(&mut other.above[slot], 0.0);
            add_scaled_stored(&mut other.p, -c * scale, &old.p);
        }
    }

    /// `x += P R^-1 y` over `used` directions, the oldest in slot `oldest`.
    fn sum_up(&mut self, used: usize, oldest: usize, x: &mut [f64]) {
        let mut weights: Vec<f64> = self.kept[..used].iter().map(|k| k.step).collect();
        // From the newest back: what a direction adds along older images is taken off the older ones' weights.
        for age in (0..used).rev() {
            let m = (oldest + age) % used;
            weights[m] /= self.kept[m].length;
            for older in 0..age {
                let o = (oldest + older) % used;
                weights[o] -= self.kept[m].above[o] * weights[m];
            }
        }
        let directions: Vec<&[S]> = self.kept[..used].iter().map(|k| k.p.as_slice()).collect();
        add_many(x, &weights, &directions);
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let directions: usize = self.kept.iter().map(|k| k.p.len() + k.q.len()).sum();
        directions * size_of::<S>() + self.image.len() * size_of::<f64>()
    }
}

fn breakdown(iteration: usize, norm_squared: f64) -> KrylovError {
    KrylovError::Breakdown {
        iteration: iteration + 1,
        norm_squared,
    }
}
