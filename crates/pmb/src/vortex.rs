//! Far field of a lifting aerofoil: free stream and a compressible point vortex.
//!
//! Thomas and Salas 1986 (AIAA J. 24): with circulation G = CL c U/2, distance r and angle theta from the quarter-chord
//! point, the disturbance of the velocity is `G sqrt(1-M^2) / (2 pi r (1 - M^2 sin^2(theta - alpha)))` against the
//! angle; pressure and density follow from constant total enthalpy and entropy. Without it the far field must stand
//! some hundred chords away.

use dip_grid::MultiBlock;

use crate::boundary::Boundary;
use crate::level::Level;
use crate::loads::face_centres;
use crate::settings::{FlowSettings, Reference};

/// Face centres of the far-field patches of a level.
#[derive(Clone, Debug)]
pub struct FarFieldVortex {
    patches: Vec<(usize, Vec<[f64; 3]>)>,
}

impl FarFieldVortex {
    /// Takes the centres of all patches whose states are given face by face.
    #[must_use]
    pub fn new(grid: &MultiBlock, level: &Level, finest: &Level, boundaries: &[Boundary]) -> Self {
        let patches = boundaries
            .iter()
            .enumerate()
            .filter(|(_, b)| matches!(b, Boundary::Fixed(_)))
            .map(|(n, _)| (n, face_centres(grid, &level.patches[n], &finest.patches[n])))
            .collect();
        Self { patches }
    }

    /// Sets the far-field states for a lift coefficient.
    pub fn set(&self, boundaries: &mut [Boundary], flow: &FlowSettings, reference: &Reference, cl: f64) {
        let stream = flow.state();
        let alpha = flow.alpha_deg.to_radians();
        let m2 = flow.mach * flow.mach;
        // One cell across: the area of the coefficients is chord times span.
        let circulation = 0.5 * cl * reference.chord;
        let beta = (1.0 - m2).max(0.0).sqrt();
        let total = 0.5 + flow.gamma / (flow.gamma - 1.0) * stream[4];
        for (n, centres) in &self.patches {
            let Some(Boundary::Fixed(states)) = boundaries.get_mut(*n) else {
                continue;
            };
            for (state, c) in states.iter_mut().zip(centres) {
                let (x, z) = (c[0] - reference.moment_point[0], c[2] - reference.moment_point[2]);
                let r = x.hypot(z);
                let theta = z.atan2(x);
                let f = circulation * beta / (std::f64::consts::TAU * r * (1.0 - m2 * (theta - alpha).sin().powi(2)));
                let u = stream[1] + f * theta.sin();
                let w = stream[3] - f * theta.cos();
                let enthalpy = total - 0.5 * (u * u + stream[2] * stream[2] + w * w);
                // Isentropic from the stream: p/rho = (gamma-1)/gamma h.
                let ratio = enthalpy * (flow.gamma - 1.0) / flow.gamma / stream[4];
                let rho = ratio.powf(1.0 / (flow.gamma - 1.0));
                *state = [rho, u, stream[2], w, stream[4] * ratio * rho];
            }
        }
    }
}
