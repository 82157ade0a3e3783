//! Fixed points of a costly map of few unknowns.

use nalgebra::{DMatrix, DVector};

/// Longest step: twice r, or as long as the way made so far, whichever is more. What was learnt from small steps is tried on ones that
/// are not much longer: where the map bends, a long step misses the fixed point that is reached first.
const LONGEST: f64 = 2.0;

/// Broyden's method (Broyden 1965, Math. Comp. 19, the first of his two) for `r(q) = h(q) - q = 0`: the inverse of dr/dq is
/// learnt from the changes of r with each step. A relaxed iteration q + w r needs 1/(1 - x) exchanges where h answers a
/// change of q by x times as much, as a structure does at x times its dynamic pressure of divergence; this needs a few for
/// each direction in which h answers.
///
/// Beyond x = 1 lies a fixed point too, from which the structure goes away. A step against r would lead there; the relaxed one is
/// taken in its place, as the structure would go.
#[derive(Clone, Debug)]
pub struct Broyden {
    /// Minus the inverse of dr/dq: a step is this times r.
    inverse: DMatrix<f64>,
    /// Part of r that the first step takes.
    relaxation: f64,
    /// The last step, and r before it.
    last: Option<[DVector<f64>; 2]>,
    /// Sum of the steps.
    way: DVector<f64>,
}

impl Broyden {
    /// For `unknowns`; the first step is `relaxation` times r.
    #[must_use]
    pub fn new(unknowns: usize, relaxation: f64) -> Self {
        Self {
            inverse: DMatrix::identity(unknowns, unknowns) * relaxation,
            relaxation,
            last: None,
            way: DVector::zeros(unknowns),
        }
    }

    /// The next step from `r` at the point that the last step led to.
    pub fn step(&mut self, r: &[f64]) -> Vec<f64> {
        let r = DVector::from_column_slice(r);
        if let Some([step, before]) = &self.last {
            // H y = -s, with y = r - before, by the smallest change of the inverse's inverse.
            let answer = &self.inverse * (&r - before);
            let along = step.dot(&answer);
            if along.abs() > 1e-12 * step.norm_squared() {
                let row = step.transpose() * &self.inverse;
                self.inverse -= (step + &answer) * row / along;
            }
        }
        let mut step = &self.inverse * &r;
        if step.dot(&r) <= 0.0 {
            step = self.relaxation * &r;
        }
        let (length, most) = (step.norm(), (LONGEST * r.norm()).max(self.way.norm()));
        if length > most {
            step *= most / length;
        }
        self.way += &step;
        let taken = step.as_slice().to_vec();
        self.last = Some([step, r]);
        taken
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps until r is 1e-8 of the first one, for h(q) = load + gain q + bend q_0^2.
    fn steps(gain: &[[f64; 3]; 3], bend: f64) -> Option<usize> {
        let load = [1.0, -0.2, 0.05];
        let change = |q: &[f64]| -> Vec<f64> {
            (0..3)
                .map(|i| {
                    let answer: f64 = gain[i].iter().zip(q).map(|(g, q)| g * q).sum();
                    load[i] + answer + bend * q[0] * q[0] - q[i]
                })
                .collect()
        };
        let size = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>().sqrt();
        let mut q = vec![0.0; 3];
        let first = size(&change(&q));
        let mut broyden = Broyden::new(3, 0.8);
        (1..60).find(|_| {
            let step = broyden.step(&change(&q));
            q.iter_mut().zip(step).for_each(|(q, s)| *q += s);
            size(&change(&q)) < 1e-8 * first
        })
    }

    #[test]
    fn a_structure_near_its_divergence_takes_as_few_steps_as_one_far_from_it() {
        // One direction in which the load grows with the displacement, others in which it hardly changes or is taken away.
        for x in [0.1, 0.5, 0.9, 0.95, 0.98] {
            let gain = [[x, 0.05, 0.0], [0.02, -0.4, 0.03], [0.01, 0.0, 0.1]];
            let needed = steps(&gain, 0.0);
            assert!(needed.is_some_and(|n| n <= 14), "{x}: {needed:?}");
        }
        // Beyond it there is no position to settle in.
        let gain = [[1.2, 0.05, 0.0], [0.02, -0.4, 0.03], [0.01, 0.0, 0.1]];
        assert_eq!(steps(&gain, 0.0), None);
        let gain = [[0.8, 0.05, 0.0], [0.02, -0.4, 0.03], [0.01, 0.0, 0.1]];
        let needed = steps(&gain, 0.002);
        assert!(needed.is_some_and(|n| n <= 14), "bent: {needed:?}");
        // A load that is taken away more than it bends: plain iteration runs away.
        let gain = [[-3.0, 0.2, 0.0], [0.1, -0.4, 0.03], [0.01, 0.0, 0.1]];
        let needed = steps(&gain, 0.0);
        assert!(needed.is_some_and(|n| n <= 9), "washed out: {needed:?}");
    }
}
