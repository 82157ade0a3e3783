//! Modal equations of motion.

use serde::{Deserialize, Serialize};

use super::error::MarchError;
use crate::modes::Modes;

/// `m (q'' + 2 zeta omega q' + omega^2 q) = f`, one line per mode (thesis (4.31) with m = 1). Units follow the modes: with
/// mass-normalized shapes in metres m is 1 kg, q has no unit and f is in N m; only their products matter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModalEquations {
    /// Circular frequency `[mode]`, rad/s; zero for a rigid body mode.
    pub omega_rad_s: Vec<f64>,
    /// Fraction of critical damping `[mode]`. A structural damping g (dissipation proportional to displacement) is
    /// `zeta = g / 2` at the mode's own frequency.
    pub damping_ratio: Vec<f64>,
    /// Generalized mass `[mode]`, kg.
    pub generalized_mass: Vec<f64>,
}

impl ModalEquations {
    /// Equations from their coefficients, each `[mode]`.
    ///
    /// # Errors
    /// [`MarchError::Count`] and [`MarchError::Value`].
    pub fn new(omega_rad_s: Vec<f64>, damping_ratio: Vec<f64>, generalized_mass: Vec<f64>) -> Result<Self, MarchError> {
        let equations = Self {
            omega_rad_s,
            damping_ratio,
            generalized_mass,
        };
        equations.check()?;
        Ok(equations)
    }

    /// The first `count` of `modes` with the same damping ratio in each.
    ///
    /// # Errors
    /// [`MarchError::Count`] if there are fewer modes, and as [`ModalEquations::new`].
    pub fn from_modes(modes: &Modes, count: usize, damping_ratio: f64) -> Result<Self, MarchError> {
        if modes.count() < count || modes.omega_rad_s.len() < count || modes.generalized_mass.len() < count {
            return Err(MarchError::Count {
                name: "the table of modes",
                got: modes.count(),
                needed: count,
            });
        }
        Self::new(
            modes.omega_rad_s[..count].to_vec(),
            vec![damping_ratio; count],
            modes.generalized_mass[..count].to_vec(),
        )
    }

    /// Number of modes.
    #[must_use]
    pub fn count(&self) -> usize {
        self.omega_rad_s.len()
    }

    /// Kinetic and elastic energy, J: `sum m (q'^2 + omega^2 q^2) / 2`.
    #[must_use]
    pub fn energy_j(&self, q: &[f64], q_dot: &[f64]) -> f64 {
        let modes = self.omega_rad_s.iter().zip(&self.generalized_mass);
        modes
            .zip(q.iter().zip(q_dot))
            .map(|((w, m), (q, v))| 0.5 * m * (v * v + w * w * q * q))
            .sum()
    }

    /// Displacement under constant generalized forces: `q = f / (m omega^2)`.
    ///
    /// # Errors
    /// [`MarchError::Value`] for a rigid body mode, which has no such displacement.
    pub fn static_displacement(&self, generalized_forces: &[f64]) -> Result<Vec<f64>, MarchError> {
        self.check_count("the list of generalized forces", generalized_forces.len())?;
        self.omega_rad_s
            .iter()
            .zip(&self.generalized_mass)
            .zip(generalized_forces)
            .enumerate()
            .map(|(n, ((w, m), f))| {
                if *w > 0.0 {
                    Ok(f / (m * w * w))
                } else {
                    Err(MarchError::Value {
                        mode: n + 1,
                        name: "circular frequency",
                        needed: "more than zero for a static displacement (a rigid body mode has none)",
                        got: *w,
                    })
                }
            })
            .collect()
    }

    pub(super) fn check(&self) -> Result<(), MarchError> {
        self.check_count("the list of damping ratios", self.damping_ratio.len())?;
        self.check_count("the list of generalized masses", self.generalized_mass.len())?;
        let value = |mode: usize, name, needed, got: f64| MarchError::Value {
            mode: mode + 1,
            name,
            needed,
            got,
        };
        for n in 0..self.count() {
            let (w, z, m) = (self.omega_rad_s[n], self.damping_ratio[n], self.generalized_mass[n]);
            if !(w >= 0.0 && w.is_finite()) {
                return Err(value(n, "circular frequency", "zero or more rad/s", w));
            }
            // Negative damping is asked for in studies of stability, so it passes.
            if !z.is_finite() {
                return Err(value(n, "damping ratio", "a finite number", z));
            }
            if !(m > 0.0 && m.is_finite()) {
                return Err(value(n, "generalized mass", "more than zero", m));
            }
        }
        Ok(())
    }

    pub(super) fn check_count(&self, name: &'static str, got: usize) -> Result<(), MarchError> {
        let needed = self.count();
        if got == needed {
            Ok(())
        } else {
            Err(MarchError::Count { name, got, needed })
        }
    }
}
