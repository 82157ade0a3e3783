//! One step of `q'' + 2 zeta omega q' + omega^2 q = p(t)` with p = f / m given at both ends of the step.

use nalgebra::Matrix4;
use serde::{Deserialize, Serialize};

use super::error::MarchError;

/// How one step is taken. Every scheme is implicit in the force at the new time: the step is done again with each new force
/// that the flow gives, so that at convergence both sit at the same time level. All are of second order in the step.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum StepScheme {
    /// Exact for a force that is linear in time over the step, and so for free motion at any step and damping: the only
    /// error is that of the force between its two ends. (J. W. Edwards, R. M. Bennett, W. Whitlow, D. A. Seidel, AIAA
    /// 82-0685, with a force that is constant over the step.)
    ///
    /// The default: the high modes of a wing, whose periods are a few steps long in a march that resolves flutter, keep
    /// amplitude and frequency, where the trapezoidal rule bends their frequency and an explicit Runge-Kutta step makes
    /// them grow.
    #[default]
    StateTransition,
    /// The thesis's two stages, `w(n+1) = w(n) + dt/2 [R(w(n), f(n)) + R(w(n+1), f(n+1))]` with w = (q, q'): the second
    /// stage is evaluated with the latest w(n+1) instead of an Euler predictor, as in Woodgate, Badcock, Rampurawala and
    /// Richards (Glasgow aerospace report 0313, 2003), where this happens once per pseudo-step of the flow. One evaluation
    /// a correction; it converges only for `omega dt < 2`, to the trapezoidal rule.
    RungeKutta2,
    /// Newmark's method with beta = 1/4, gamma = 1/2 (N. M. Newmark, J. Eng. Mech. Div. ASCE 85, 1959): the trapezoidal
    /// rule. Conserves the amplitude; period error `(omega dt)^2 / 12`.
    Newmark,
    /// Generalized-alpha (J. Chung, G. M. Hulbert, J. Appl. Mech. 60, 1993): as Newmark's, with damping of modes that the
    /// step does not resolve, down to the factor `rho_infinity` (0 to 1) a step.
    GeneralizedAlpha {
        /// Spectral radius at infinite frequency.
        rho_infinity: f64,
    },
}

impl StepScheme {
    pub(super) fn check(self) -> Result<(), MarchError> {
        match self {
            Self::GeneralizedAlpha { rho_infinity } if !(0.0..=1.0).contains(&rho_infinity) => {
                Err(MarchError::RhoInfinity { got: rho_infinity })
            }
            _ => Ok(()),
        }
    }
}

/// Motion of one mode at one instant.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    pub q: f64,
    pub v: f64,
    /// Acceleration; what generalized-alpha carries is its own auxiliary quantity, not q''.
    pub a: f64,
}

/// A scheme with its coefficients for one mode and one step.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Stepper {
    /// Rows of the propagator of (q, dt q', dt^2 p(n), dt^2 (p(n+1) - p(n))) that give q and dt q'.
    Exact {
        dt: f64,
        q: [f64; 4],
        v: [f64; 4],
    },
    TwoStage {
        dt: f64,
        c: f64,
        k: f64,
    },
    Alpha(Alpha),
}

/// Chung and Hulbert's coefficients; Newmark's method is `alpha_m = alpha_f = 0`, beta = 1/4, gamma = 1/2.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Alpha {
    dt: f64,
    c: f64,
    k: f64,
    alpha_m: f64,
    alpha_f: f64,
    beta: f64,
    gamma: f64,
}

impl Stepper {
    pub fn new(scheme: StepScheme, omega: f64, zeta: f64, dt: f64) -> Self {
        let (c, k) = (2.0 * zeta * omega, omega * omega);
        let alpha = |alpha_m: f64, alpha_f: f64| {
            let gamma = 0.5 - alpha_m + alpha_f;
            Self::Alpha(Alpha {
                dt,
                c,
                k,
                alpha_m,
                alpha_f,
                beta: 0.25 * (0.5 + gamma).powi(2),
                gamma,
            })
        };
        match scheme {
            StepScheme::StateTransition => {
                #[rustfmt::skip]
                let rates = Matrix4::new(
                    0.0,            1.0,     0.0, 0.0,
                    -k * dt * dt,  -c * dt,  1.0, 0.0,
                    0.0,            0.0,     0.0, 1.0,
                    0.0,            0.0,     0.0, 0.0,
                );
                let e = rates.exp();
                let row = |i: usize| [e[(i, 0)], e[(i, 1)], e[(i, 2)], e[(i, 3)]];
                Self::Exact {
                    dt,
                    q: row(0),
                    v: row(1),
                }
            }
            StepScheme::RungeKutta2 => Self::TwoStage { dt, c, k },
            StepScheme::Newmark => alpha(0.0, 0.0),
            StepScheme::GeneralizedAlpha { rho_infinity: r } => alpha((2.0 * r - 1.0) / (r + 1.0), r / (r + 1.0)),
        }
    }

    /// Acceleration to carry at the start of a march.
    pub fn start(&self, q: f64, v: f64, p: f64) -> f64 {
        match self {
            Self::Exact { .. } => 0.0,
            Self::TwoStage { c, k, .. } | Self::Alpha(Alpha { c, k, .. }) => p - c * v - k * q,
        }
    }

    /// Motion at the end of the step from `old` at its start, with forces per mass `p0` and `p1`; `latest` is the last
    /// estimate of the result.
    pub fn step(&self, old: Motion, latest: Motion, p0: f64, p1: f64) -> Motion {
        match self {
            Self::Exact { dt, q, v } => {
                let state = [old.q, dt * old.v, dt * dt * p0, dt * dt * (p1 - p0)];
                let row = |r: &[f64; 4]| r[0] * state[0] + r[1] * state[1] + r[2] * state[2] + r[3] * state[3];
                Motion {
                    q: row(q),
                    v: row(v) / dt,
                    a: 0.0,
                }
            }
            Self::TwoStage { dt, c, k } => {
                let rate = |v: f64, q: f64, p: f64| p - c * v - k * q;
                let first = rate(old.v, old.q, p0);
                let second = rate(latest.v, latest.q, p1);
                Motion {
                    q: old.q + 0.5 * dt * (old.v + latest.v),
                    v: old.v + 0.5 * dt * (first + second),
                    a: second,
                }
            }
            Self::Alpha(s) => s.step(old, p0, p1),
        }
    }

    /// First estimate of the result, before any force at the new time: the two-stage scheme's Euler predictor; the others
    /// need none.
    pub fn predictor(&self, old: Motion, p0: f64) -> Motion {
        match self {
            Self::TwoStage { dt, c, k } => {
                let a = p0 - c * old.v - k * old.q;
                Motion {
                    q: old.q + dt * old.v,
                    v: old.v + dt * a,
                    a,
                }
            }
            _ => old,
        }
    }
}

impl Alpha {
    /// `(1-am) a1 + am a0 + c v(1-af) + k q(1-af) = p(1-af)` with `x(1-af) = (1-af) x1 + af x0` and Newmark's
    /// `q1 = q0 + dt v0 + dt^2 [(1/2 - beta) a0 + beta a1]`, `v1 = v0 + dt [(1 - gamma) a0 + gamma a1]`.
    fn step(&self, old: Motion, p0: f64, p1: f64) -> Motion {
        let Self {
            dt,
            c,
            k,
            alpha_m,
            alpha_f,
            beta,
            gamma,
        } = *self;
        let q_known = old.q + dt * old.v + dt * dt * (0.5 - beta) * old.a;
        let v_known = old.v + dt * (1.0 - gamma) * old.a;
        let new = 1.0 - alpha_f;
        let mass = 1.0 - alpha_m + new * (c * gamma * dt + k * beta * dt * dt);
        let right = new * (p1 - c * v_known - k * q_known) + alpha_f * (p0 - c * old.v - k * old.q) - alpha_m * old.a;
        let a = right / mass;
        Motion {
            q: q_known + beta * dt * dt * a,
            v: v_known + gamma * dt * a,
            a,
        }
    }
}
