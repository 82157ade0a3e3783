//! A section on springs: plunge and pitch.

use std::f64::consts::PI;

use dip_grid::MultiBlock;
use dip_modal::{GridModes, ModalEquations, MovingWall};
use dip_pmb::couple::{Coupling, Stream};
use dip_pmb::march::Wing;
use dip_pmb::settings::{Reference, SteadySettings};
use nalgebra::{Complex, Matrix2, Vector2, Vector3};

use crate::driver::{Case, Outcome};
use crate::possio::{self, PlateMotion};

type C = Complex<f64>;

/// Parameters of a typical section (Bisplinghoff, Ashley and Halfman), lengths in semichords.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    /// Elastic axis aft of mid-chord.
    pub a: f64,
    /// Centre of gravity aft of the elastic axis.
    pub x_alpha: f64,
    /// Square of the radius of gyration about the elastic axis.
    pub r2: f64,
    /// Mass ratio m / (pi rho b^2).
    pub mu: f64,
    /// Plunging over pitching frequency, uncoupled.
    pub frequency_ratio: f64,
}

/// Uncoupled pitching frequency, rad/s. It only sets the clock.
pub const OMEGA_ALPHA: f64 = 100.0;
/// Semichord of the sections' grids, m.
pub const SEMICHORD: f64 = 0.5;
const DENSITY: f64 = 1.225;

impl Section {
    /// Mass (rise, pitch) for a metre of span, and stiffness.
    fn matrices(&self) -> [Matrix2<f64>; 2] {
        let b = SEMICHORD;
        let m = self.mu * PI * DENSITY * b * b;
        // The centre of gravity lies aft: nose up lowers it.
        let s = -m * self.x_alpha * b;
        let i = m * self.r2 * b * b;
        let (wa, wh) = (OMEGA_ALPHA, OMEGA_ALPHA * self.frequency_ratio);
        [
            Matrix2::new(m, s, s, i),
            Matrix2::new(m * wh * wh, 0.0, 0.0, i * wa * wa),
        ]
    }

    /// Circular frequencies, rad/s, and mass-normalized modes (rise in metres, nose-up angle) of a metre of span.
    pub fn modes(&self) -> [(f64, Vector2<f64>); 2] {
        let [mass, stiffness] = self.matrices();
        // Of a 2 x 2 problem: K v = w^2 M v through the inverse square root of M.
        let e = mass.symmetric_eigen();
        let root = e.eigenvectors
            * Matrix2::from_diagonal(&e.eigenvalues.map(|v| 1.0 / v.sqrt()))
            * e.eigenvectors.transpose();
        let s = (root * stiffness * root).symmetric_eigen();
        let mode = |n: usize| (s.eigenvalues[n].sqrt(), root * s.eigenvectors.column(n));
        if s.eigenvalues[0] < s.eigenvalues[1] {
            [mode(0), mode(1)]
        } else {
            [mode(1), mode(0)]
        }
    }

    /// The case on a grid of a section of chord 1 m with its nose at the origin.
    pub fn case(&self, grid: MultiBlock, mach: f64, freq_hz: f64) -> Outcome<Case> {
        let [lo, hi] = grid.bounds();
        let width = hi[1] - lo[1];
        let wall = MovingWall::new(&grid, |p| p.condition.is_wall())?;
        let axis = SEMICHORD * (1.0 + self.a);
        let modes = self.modes();
        let shapes: Vec<Vec<Vector3<f64>>> = modes
            .iter()
            .map(|(_, v)| {
                let at = |p: Vector3<f64>| Vector3::new(v[1] * p.z, 0.0, v[0] - v[1] * (p.x - axis));
                wall.points().into_iter().map(at).collect()
            })
            .collect();
        let fields = GridModes::new(&grid, &wall, &shapes, None)?;
        let omega = modes.iter().map(|m| m.0).collect();
        // Mass and forces are those of the grid's width.
        let equations = ModalEquations::new(omega, vec![0.0; 2], vec![width; 2])?;
        let wing = Wing::new(equations, &fields, &grid)?;
        let mut steady = SteadySettings::default();
        steady.flow.mach = mach;
        steady.solver.orders = 7.0;
        steady.reference = Reference {
            area: width,
            chord: 1.0,
            moment_point: [axis, 0.0, 0.0],
        };
        Ok(Case {
            grid,
            wing,
            steady,
            freq_hz,
            steps_per_cycle: 40.0,
            orders: 2.5,
            start: vec![1e-3, 1e-3],
            deflects: false,
            coupling: Coupling::Tight,
            cycles: 10.0,
            whole: false,
        })
    }

    /// The stream at a reduced velocity U/(b omega_alpha).
    pub fn stream(&self, reduced: f64) -> Stream {
        Stream {
            speed_m_s: reduced * SEMICHORD * OMEGA_ALPHA,
            density_kg_m3: DENSITY,
            length_m: 1.0,
        }
    }

    /// U/(b omega_alpha) of static divergence: where the moment about the elastic axis for a radian of incidence, a
    /// coefficient of the chord, takes up the stiffness in pitch.
    pub fn divergence(&self, moment_slope: f64) -> f64 {
        // I omega_alpha^2 = rho/2 U^2 c^2 cm_alpha with I = mu pi rho b^4 r^2 and c = 2 b.
        (self.mu * PI * self.r2 / (2.0 * moment_slope)).sqrt()
    }

    /// Flutter of a thin plate by Possio's equation at `mach` (Theodorsen's at 0): U/(b omega_alpha) and omega/omega_alpha at the
    /// lowest speed, by the U-g method: `(M + rho/2 (b/k)^2 Q(k)) v = (1 + ig)/omega^2 K v`.
    pub fn flutter(&self, mach: f64) -> Option<[f64; 2]> {
        let [mass, stiffness] = self.matrices();
        let axis = 0.5 * (1.0 + self.a);
        let roots = |k: f64| -> [C; 2] {
            let force = |motion| {
                if mach > 0.0 {
                    possio::coefficients(mach, k, axis, motion)
                } else {
                    possio::incompressible(k, axis, motion)
                }
            };
            let (pitch, rise) = (force(PlateMotion::Pitch), force(PlateMotion::Plunge));
            // Chord 1 m: lift and moment per dynamic pressure of a metre of rise and a radian.
            let q = Matrix2::new(rise[0], pitch[0], rise[1], pitch[1]);
            let a = mass.map(|v| C::new(v, 0.0)) + q * C::new(0.5 * DENSITY * (SEMICHORD / k).powi(2), 0.0);
            let inverse = Matrix2::from_diagonal(&stiffness.diagonal().map(|v| C::new(1.0 / v, 0.0)));
            let b = inverse * a;
            let (trace, determinant) = (b.trace(), b.determinant());
            let root = (trace * trace * 0.25 - determinant).sqrt();
            [trace * 0.5 + root, trace * 0.5 - root]
        };
        // From high k (low speed) down: the first change of sign of g on either branch.
        let mut best: Option<[f64; 2]> = None;
        let ks: Vec<f64> = (0..60).map(|n| 1.2 * 0.94_f64.powi(n)).collect();
        let table: Vec<[C; 2]> = ks.iter().map(|k| roots(*k)).collect();
        let nearest = |[x, y]: [C; 2], to: C| if (x - to).norm() < (y - to).norm() { x } else { y };
        for branch in 0..2 {
            let mut last = table[0][branch];
            for (pair, there) in ks.windows(2).zip(&table[1..]) {
                let new = nearest(*there, last);
                // g = Im/Re; it grows through zero where the oscillation loses its damping.
                if last.im < 0.0 && new.im >= 0.0 && new.re > 0.0 {
                    let (mut high, mut low, mut at_high) = (pair[0], pair[1], last);
                    for _ in 0..40 {
                        let middle = 0.5 * (high + low);
                        let here = nearest(roots(middle), at_high);
                        if here.im < 0.0 {
                            (high, at_high) = (middle, here);
                        } else {
                            low = middle;
                        }
                    }
                    let omega = at_high.re.powf(-0.5);
                    let found = [omega / (high * OMEGA_ALPHA), omega / OMEGA_ALPHA];
                    if best.is_none_or(|b| found[0] < b[0]) {
                        best = Some(found);
                    }
                }
                last = new;
            }
        }
        best
    }
}
