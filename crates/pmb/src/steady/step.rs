//! One implicit step: its CFL number, the linear solve, and whether it is accepted.
//!
//! The local time step grows as the residual falls (pseudo-transient continuation: Kelley and Keyes 1998, SIAM J. Numer.
//! Anal. 35; Mulder and van Leer's law); at large CFL number the step is Newton's. A step that leaves the physical range or
//! makes the residual explode is taken back and redone with a smaller CFL number.

use dip_krylov::{GcgOutcome, GcgSettings};

use super::march::Run;
use crate::error::FlowError;
use crate::observer::Observer;

impl Run<'_> {
    /// One accepted step, or `None` if none could be found. Returns the linear solve, the part taken and its CFL number.
    pub(super) fn take_step(
        &mut self,
        observer: &mut dyn Observer,
    ) -> Result<Option<(GcgOutcome, f64, f64)>, FlowError> {
        const LEAST_CFL: f64 = 1e-2;
        self.backup.clear();
        self.backup.extend_from_slice(&self.solver.unknowns);
        loop {
            let cfl = self.cfl;
            // On a thread of the pool: one outside of it would fall asleep and be woken at each of the thousands of loops.
            let tried = dip_krylov::team::awake(|| self.try_step(cfl));
            let (why, outcome, part) = match tried {
                Ok((outcome, part)) => {
                    let new = self.solver.norm();
                    // Far from the solution waves travel and the residual may rise; near it a rise is a failure.
                    let allowed = if self.orders() < 1.0 { 4.0 } else { 1.5 };
                    if !(new.is_finite() && new <= allowed * self.norm) {
                        (
                            format!("the residual would grow by a factor of {:.1e}", new / self.norm),
                            outcome,
                            part,
                        )
                    } else if part < 0.05 {
                        (
                            format!("only {part:.1e} of the step keeps density and pressure positive"),
                            outcome,
                            part,
                        )
                    } else {
                        self.accept(new, part, &outcome);
                        return Ok(Some((outcome, part, cfl)));
                    }
                }
                Err(FlowError::Linear(e)) => (
                    e.to_string(),
                    GcgOutcome {
                        iterations: 0,
                        reduction: 1.0,
                        converged: false,
                    },
                    0.0,
                ),
                Err(e) => return Err(e),
            };
            let backup = std::mem::take(&mut self.backup);
            self.solver.set(&backup);
            self.backup = backup;
            self.cfl *= if part > 0.0 { 0.25 } else { 0.1 };
            observer.message(&format!(
                "step {} redone with CFL {:.3e}: {why}",
                self.step + 1,
                self.cfl
            ));
            let _ = outcome;
            if self.cfl < LEAST_CFL {
                return Ok(None);
            }
        }
    }

    fn try_step(&mut self, cfl: f64) -> Result<(GcgOutcome, f64), FlowError> {
        let s = &self.settings.solver;
        self.solver.set_time_step(cfl);
        self.solver.build()?;
        // Tighter as Newton's method takes hold.
        let tolerance = if cfl < 1e3 {
            0.1
        } else {
            (self.norm / self.last_norm).powi(2).clamp(1e-2, 0.1)
        };
        // No tighter than the goal and the round-off of the residual ask for.
        let goal = self.reference_norm * 10.0_f64.powf(-self.goal());
        let tolerance = tolerance
            .max(0.3 * goal.max(self.solver.round_off()) / self.norm)
            .min(0.5);
        // On coarser levels memory does not count: all directions are kept.
        let directions = if self.level > 0 { s.max_products } else { s.directions };
        let gcg = GcgSettings {
            tolerance,
            max_iterations: s.max_products,
            patience: 20,
            directions,
        };
        let outcome = self.solver.solve(&gcg)?;
        let part = self.solver.admissible(0.5);
        self.solver.advance(part);
        Ok((outcome, part))
    }

    fn accept(&mut self, new: f64, part: f64, outcome: &GcgOutcome) {
        let ratio = self.norm / new;
        let tried_cfl = self.cfl;
        let growth = self.settings.solver.cfl_growth;
        // A linear system that GCG can hardly reduce is too stiff: a smaller time step makes it easier and costs less.
        const HARD: usize = 30;
        let growth = if self.orders() < 4.0 && outcome.iterations > HARD {
            growth.min(1.5)
        } else {
            growth
        };
        let solvable = if outcome.reduction > 0.5 { 0.25 } else { 1.0 };
        self.cfl *= solvable
            * if part < 1.0 {
                part.max(0.5)
            } else {
                (1.5 * ratio).clamp(0.5, growth)
            };
        // Where one was met lies a ceiling, lifted a little by every step that goes well.
        if outcome.reduction > 0.5 {
            self.ceiling = 0.5 * tried_cfl;
        } else {
            self.ceiling *= 1.5;
        }
        self.cfl = self.cfl.min(self.ceiling).min(1e12);
        self.last_norm = self.norm;
        self.norm = new;
        self.step += 1;
        self.level_step += 1;
        self.update_vortex();
    }
}
