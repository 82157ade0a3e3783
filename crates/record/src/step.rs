//! What is recorded at every step.

use serde::Serialize;

use crate::motion::MotionValue;

/// The state at one instant. Everything in it belongs to `time_s`: motion, pressures and loads alike.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Step {
    /// Number of the step; each is one more than the one before it. Step 0 is the start.
    pub number: u32,
    /// The instant, s from the start of the run.
    pub time_s: f64,
    /// Motion coordinates, in the order of [`Setup::motion`](crate::Setup::motion).
    pub motion: Vec<MotionValue>,
    /// Pressure coefficients (p - p_inf) / (rho U^2 / 2), `[patch][face]`, in the order of
    /// [`Setup::surface`](crate::Setup::surface).
    pub pressures: Vec<Vec<f64>>,
    /// Resultants.
    pub loads: Loads,
    /// Generalized coordinates and forces, where there is a structure.
    pub modal: Option<Modal>,
    /// How well the step was solved.
    pub convergence: Convergence,
    /// The wall's nodes at this instant, `[patch][node][x, y, z]`, m, where the run gives them (at intervals). Without
    /// them [`Setup`](crate::Setup) and the motion say where the wall is.
    pub shape_m: Option<Vec<Vec<[f64; 3]>>>,
}

/// Resultants on all walls, in the coordinates of the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Loads {
    /// Lift coefficient, normal to the stream.
    pub cl: f64,
    /// Drag coefficient, along the stream.
    pub cd: f64,
    /// Pitching moment coefficient, nose up.
    pub cm: f64,
    /// Force, N.
    pub force_n: [f64; 3],
    /// Moment about the reference point, N m.
    pub moment_n_m: [f64; 3],
}

/// The structure at one instant, one entry per mode.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Modal {
    /// Generalized coordinates.
    pub q: Vec<f64>,
    /// Their rates, 1/s.
    pub q_dot: Vec<f64>,
    /// Generalized aerodynamic forces: work per unit of the coordinate, J.
    pub force_j: Vec<f64>,
}

/// How well a step was solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Convergence {
    /// Orders of magnitude by which the residual of the step fell.
    pub orders: f64,
    /// Pseudo-time iterations.
    pub iterations: u32,
    /// True if the orders asked for were reached.
    pub converged: bool,
}
