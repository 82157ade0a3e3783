//! Steps of the modal equations that can be done again until the flow agrees.

use serde::{Deserialize, Serialize};

use super::equations::ModalEquations;
use super::error::MarchError;
use super::scheme::{Motion, StepScheme, Stepper};

/// Motion of all modes at one instant with the forces that belong to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModalState {
    /// Time, s.
    pub time_s: f64,
    /// Generalized coordinates `[mode]`.
    pub q: Vec<f64>,
    /// Their rates `[mode]`, 1/s.
    pub q_dot: Vec<f64>,
    /// Generalized forces `[mode]`.
    pub f: Vec<f64>,
}

impl ModalState {
    /// At rest, without force, at time zero.
    #[must_use]
    pub fn rest(modes: usize) -> Self {
        Self {
            time_s: 0.0,
            q: vec![0.0; modes],
            q_dot: vec![0.0; modes],
            f: vec![0.0; modes],
        }
    }
}

/// First estimate of the force at the new time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum ForceGuess {
    /// As at the old time. A step that is never corrected (loose coupling) is then of first order.
    Hold,
    /// On the line through the last two instants: of second order even where it is never corrected.
    #[default]
    Linear,
}

/// March of the modal equations. A step is [`Integrator::predict`], any number of [`Integrator::correct`], and
/// [`Integrator::accept`].
///
/// Serialized and read again (with a format that keeps every bit of a double), it goes on as if it had never stopped.
///
/// ```
/// use dip_modal::{ForceGuess, Integrator, ModalEquations, ModalState, StepScheme};
///
/// let equations = ModalEquations::new(vec![60.0], vec![0.0], vec![1.0])?;
/// let mut start = ModalState::rest(1);
/// start.q_dot[0] = 0.1;
/// let mut march = Integrator::new(equations, StepScheme::default(), 1e-3, start)?;
/// march.predict(ForceGuess::Linear);
/// for _ in 0..4 {
///     // What the flow answers to the motion: here a spring.
///     let force = -500.0 * march.next().q[0];
///     march.correct(&[force])?;
/// }
/// march.accept();
/// assert_eq!(march.state().time_s, 1e-3);
/// # Ok::<(), dip_modal::MarchError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Saved", into = "Saved")]
pub struct Integrator {
    equations: ModalEquations,
    scheme: StepScheme,
    step_s: f64,
    steps: u64,
    start_s: f64,
    old: ModalState,
    /// Accelerations that the scheme carries `[mode]`.
    old_a: Vec<f64>,
    /// Forces one step before `old` `[mode]`; none in the first step.
    older_f: Option<Vec<f64>>,
    new: ModalState,
    new_a: Vec<f64>,
    steppers: Vec<Stepper>,
}

/// What a restart needs: the coefficients of the steps follow from it.
#[derive(Clone, Serialize, Deserialize)]
struct Saved {
    equations: ModalEquations,
    scheme: StepScheme,
    step_s: f64,
    steps: u64,
    start_s: f64,
    old: ModalState,
    old_a: Vec<f64>,
    older_f: Option<Vec<f64>>,
    new: ModalState,
    new_a: Vec<f64>,
}

impl From<Integrator> for Saved {
    fn from(i: Integrator) -> Self {
        Self {
            equations: i.equations,
            scheme: i.scheme,
            step_s: i.step_s,
            steps: i.steps,
            start_s: i.start_s,
            old: i.old,
            old_a: i.old_a,
            older_f: i.older_f,
            new: i.new,
            new_a: i.new_a,
        }
    }
}

impl TryFrom<Saved> for Integrator {
    type Error = MarchError;

    fn try_from(s: Saved) -> Result<Self, MarchError> {
        let mut i = Self::new(s.equations, s.scheme, s.step_s, s.old)?;
        for (name, list) in [
            ("the restart's list of accelerations", &s.old_a),
            ("the restart's list of new accelerations", &s.new_a),
            (
                "the restart's list of earlier forces",
                s.older_f.as_ref().unwrap_or(&s.old_a),
            ),
            ("the restart's list of new coordinates", &s.new.q),
            ("the restart's list of new rates", &s.new.q_dot),
            ("the restart's list of new forces", &s.new.f),
        ] {
            i.equations.check_count(name, list.len())?;
        }
        i.steps = s.steps;
        i.start_s = s.start_s;
        i.old_a = s.old_a;
        i.older_f = s.older_f;
        i.new = s.new;
        i.new_a = s.new_a;
        Ok(i)
    }
}

impl Integrator {
    /// A march from `start` (its forces belong to its instant) in steps of `step_s` seconds.
    ///
    /// # Errors
    /// [`MarchError`] naming the mode and the value.
    pub fn new(
        equations: ModalEquations,
        scheme: StepScheme,
        step_s: f64,
        start: ModalState,
    ) -> Result<Self, MarchError> {
        equations.check()?;
        scheme.check()?;
        if !(step_s > 0.0 && step_s.is_finite()) {
            return Err(MarchError::Step { got: step_s });
        }
        for (name, list) in [
            ("the start's list of coordinates", &start.q),
            ("the start's list of rates", &start.q_dot),
            ("the start's list of forces", &start.f),
        ] {
            equations.check_count(name, list.len())?;
            if let Some(n) = list.iter().position(|v| !v.is_finite()) {
                return Err(MarchError::Value {
                    mode: n + 1,
                    name,
                    needed: "finite numbers",
                    got: list[n],
                });
            }
        }
        let steppers: Vec<Stepper> = (0..equations.count())
            .map(|n| Stepper::new(scheme, equations.omega_rad_s[n], equations.damping_ratio[n], step_s))
            .collect();
        let old_a: Vec<f64> = (0..equations.count())
            .map(|n| steppers[n].start(start.q[n], start.q_dot[n], start.f[n] / equations.generalized_mass[n]))
            .collect();
        Ok(Self {
            equations,
            scheme,
            step_s,
            steps: 0,
            start_s: start.time_s,
            new: start.clone(),
            new_a: old_a.clone(),
            old: start,
            old_a,
            older_f: None,
            steppers,
        })
    }

    /// The equations.
    #[must_use]
    pub fn equations(&self) -> &ModalEquations {
        &self.equations
    }

    /// Length of a step, s.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// The last accepted state.
    #[must_use]
    pub fn state(&self) -> &ModalState {
        &self.old
    }

    /// The latest estimate of the state at the end of the step under way (the accepted state before the first
    /// [`Integrator::predict`]).
    #[must_use]
    pub fn next(&self) -> &ModalState {
        &self.new
    }

    /// Begins a step: the state at its end with a first estimate of the forces there.
    pub fn predict(&mut self, guess: ForceGuess) -> &ModalState {
        let forces: Vec<f64> = match (&self.older_f, guess) {
            (Some(older), ForceGuess::Linear) => self.old.f.iter().zip(older).map(|(f, o)| 2.0 * f - o).collect(),
            _ => self.old.f.clone(),
        };
        // Counted, not summed up, so that the instants of a long march carry no rounding.
        self.new.time_s = self.start_s + (self.steps + 1) as f64 * self.step_s;
        for n in 0..self.equations.count() {
            let p0 = self.old.f[n] / self.equations.generalized_mass[n];
            let first = self.steppers[n].predictor(self.motion(n), p0);
            (self.new.q[n], self.new.q_dot[n], self.new_a[n]) = (first.q, first.v, first.a);
        }
        self.advance(&forces);
        &self.new
    }

    /// Does the step again with the forces `[mode]` that the flow gives for [`Integrator::next`]. Returns how far the state
    /// moved: the root of the energy of the change over that of the state, zero if nothing moves.
    ///
    /// # Errors
    /// [`MarchError::Count`], or [`MarchError::Force`] for a force that is not a finite number; the step is then as before.
    pub fn correct(&mut self, generalized_forces: &[f64]) -> Result<f64, MarchError> {
        self.check_forces(generalized_forces)?;
        let (q, v) = (self.new.q.clone(), self.new.q_dot.clone());
        self.advance(generalized_forces);
        let change = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        let moved = self
            .equations
            .energy_j(&change(&self.new.q, &q), &change(&self.new.q_dot, &v));
        let whole = self.equations.energy_j(&self.new.q, &self.new.q_dot);
        Ok(if moved > 0.0 { (moved / whole).sqrt() } else { 0.0 })
    }

    /// Ends the step: the latest estimate becomes the state.
    pub fn accept(&mut self) {
        self.older_f = Some(std::mem::replace(&mut self.old.f, self.new.f.clone()));
        self.old.time_s = self.new.time_s;
        self.old.q.clone_from(&self.new.q);
        self.old.q_dot.clone_from(&self.new.q_dot);
        self.old_a.clone_from(&self.new_a);
        self.steps += 1;
    }

    /// Ends a step that is not corrected (loose coupling): the motion stays as predicted, and `generalized_forces`, found
    /// for that motion, are kept for the next step.
    ///
    /// # Errors
    /// As [`Integrator::correct`].
    pub fn accept_loose(&mut self, generalized_forces: &[f64]) -> Result<(), MarchError> {
        self.check_forces(generalized_forces)?;
        self.new.f.copy_from_slice(generalized_forces);
        self.accept();
        Ok(())
    }

    fn check_forces(&self, forces: &[f64]) -> Result<(), MarchError> {
        self.equations
            .check_count("the list of generalized forces", forces.len())?;
        match forces.iter().position(|f| !f.is_finite()) {
            Some(n) => Err(MarchError::Force {
                mode: n + 1,
                time_s: self.new.time_s,
                got: forces[n],
            }),
            None => Ok(()),
        }
    }

    fn motion(&self, n: usize) -> Motion {
        Motion {
            q: self.old.q[n],
            v: self.old.q_dot[n],
            a: self.old_a[n],
        }
    }

    fn advance(&mut self, forces: &[f64]) {
        for (n, &f) in forces.iter().enumerate() {
            let m = self.equations.generalized_mass[n];
            let latest = Motion {
                q: self.new.q[n],
                v: self.new.q_dot[n],
                a: self.new_a[n],
            };
            let new = self.steppers[n].step(self.motion(n), latest, self.old.f[n] / m, f / m);
            (self.new.q[n], self.new.q_dot[n], self.new_a[n]) = (new.q, new.v, new.a);
            self.new.f[n] = f;
        }
    }
}
