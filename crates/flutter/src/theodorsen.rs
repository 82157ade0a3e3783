//! Exact two-dimensional incompressible aerodynamics: Theodorsen's function and the pitch-plunge section.
//!
//! The solvers know no aerodynamics; this module gives them a Q(k) with known answers, for verification.
//! Theodorsen, NACA Report 496 (1935); for growing and decaying motion Edwards, Ashley and Breakwell, AIAA J. 17(4), 1979.

use std::f64::consts::PI;

use faer::{Mat, MatMut, c64};

use crate::error::{Result, check_value};
use crate::forces::{GeneralizedForces, KDomain};
use crate::structure::Structure;

/// Theodorsen's function C(k) = H1(k) / (H1(k) + i H0(k)), Hankel functions of the second kind, for k >= 0.
#[must_use]
pub fn theodorsen(k: f64) -> c64 {
    theodorsen_laplace(c64::new(0.0, k))
}

/// The generalized function C(s) = K1(s) / (K0(s) + K1(s)), s = p b / U; C(ik) is Theodorsen's. Not for the negative real axis.
#[must_use]
pub fn theodorsen_laplace(s: c64) -> c64 {
    if s.norm() < 1e-300 {
        return c64::new(1.0, 0.0);
    }
    // C = r / (1 + r) with r = K1 / K0, written so that a large ratio does no harm.
    let inverse = ratio_k1_k0(s).inv();
    (inverse + 1.0).inv()
}

/// dC/ds = (r^2 - r / s - 1) / (1 + r)^2, from K0' = -K1 and K1' = -K0 - K1 / s.
#[must_use]
pub fn theodorsen_laplace_slope(s: c64) -> c64 {
    let r = ratio_k1_k0(s);
    (r * r - r / s - 1.0) / ((r + 1.0) * (r + 1.0))
}

/// K1(s) / K0(s): power series (Abramowitz and Stegun 9.6.11, 9.6.13) for |s| <= 2, else Temme's continued fraction.
fn ratio_k1_k0(s: c64) -> c64 {
    const EULER_GAMMA: f64 = 0.577_215_664_901_532_9;
    if s.norm() <= 2.0 {
        let quarter = s * s / 4.0;
        let log = (s / 2.0).ln() + EULER_GAMMA;
        let (mut i0, mut i1) = (c64::new(0.0, 0.0), c64::new(0.0, 0.0));
        let (mut k0, mut k1) = (c64::new(0.0, 0.0), c64::new(0.0, 0.0));
        // term = (s^2/4)^m / (m!)^2 and harmonic = 1 + 1/2 + ... + 1/m.
        let (mut term, mut harmonic) = (c64::new(1.0, 0.0), 0.0);
        for m in 0..40 {
            let next = harmonic + 1.0 / f64::from(m + 1);
            i0 += term;
            i1 += term / f64::from(m + 1);
            k0 += term * harmonic;
            k1 += term * ((harmonic + next) / f64::from(m + 1));
            harmonic = next;
            term *= quarter / f64::from((m + 1) * (m + 1));
        }
        let k0 = k0 - log * i0;
        let half = s / 2.0;
        let k1 = s.inv() + log * i1 * half - k1 * half / 2.0;
        return k1 / k0;
    }
    // Steed's evaluation of the continued fraction with a_n = -(n - 1/2)^2, b_n = 2 (n + s) (Temme 1975).
    let mut b = (s + 1.0) * 2.0;
    let mut d = b.inv();
    let (mut h, mut delta) = (d, d);
    let mut a = -0.25;
    for n in 2..2000 {
        a -= f64::from(2 * (n - 1));
        b += 2.0;
        d = (b + d * a).inv();
        delta *= b * d - 1.0;
        h += delta;
        if delta.norm() < 1e-17 * h.norm() {
            break;
        }
    }
    (s + 0.5 - h * 0.25) / s
}

/// The pitch-plunge section per unit span: Theodorsen's notation, lengths in semichords.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TypicalSection {
    /// Semichord b, m.
    pub semichord_m: f64,
    /// Elastic axis aft of mid-chord, in semichords.
    pub a: f64,
    /// Centre of gravity aft of the elastic axis, in semichords.
    pub x_alpha: f64,
    /// Square of the radius of gyration about the elastic axis, in semichords.
    pub r_alpha_squared: f64,
    /// Mass ratio m / (pi rho b^2).
    pub mass_ratio: f64,
    /// Uncoupled plunge frequency, rad/s.
    pub omega_h_rad_s: f64,
    /// Uncoupled pitch frequency, rad/s.
    pub omega_alpha_rad_s: f64,
}

impl TypicalSection {
    /// Structure in coordinates (h/b positive down, alpha nose up) for air of a density, per unit span.
    ///
    /// # Errors
    /// Values that make no structure.
    pub fn structure(&self, density_kg_m3: f64) -> Result<Structure> {
        check_value("mass ratio", self.mass_ratio, "above zero", self.mass_ratio > 0.0)?;
        let b2 = self.semichord_m * self.semichord_m;
        let scale = self.mass_ratio * PI * density_kg_m3 * b2 * b2;
        let r2 = self.r_alpha_squared;
        let mass = [[1.0, self.x_alpha], [self.x_alpha, r2]];
        let diagonal = [
            self.omega_h_rad_s * self.omega_h_rad_s,
            r2 * self.omega_alpha_rad_s * self.omega_alpha_rad_s,
        ];
        Structure::new(
            Mat::from_fn(2, 2, |i, j| scale * mass[i][j]),
            Mat::from_fn(2, 2, |i, j| if i == j { scale * diagonal[i] } else { 0.0 }),
        )
    }

    /// Aerodynamics of the section, per unit span.
    #[must_use]
    pub fn forces(&self) -> SectionForces {
        SectionForces {
            semichord_m: self.semichord_m,
            a: self.a,
        }
    }

    /// Divergence speed: K_alpha = q S dC_L/dalpha e gives U^2 = mu r^2 (b omega_alpha)^2 / (1 + 2 a), `None` for a <= -1/2.
    #[must_use]
    pub fn divergence_speed_m_s(&self) -> Option<f64> {
        let lever = 1.0 + 2.0 * self.a;
        (lever > 0.0).then(|| {
            self.semichord_m * self.omega_alpha_rad_s * (self.mass_ratio * self.r_alpha_squared / lever).sqrt()
        })
    }
}

/// Q of a pitch-plunge section in coordinates (h/b positive down, alpha nose up), per unit span, for k = omega b / U.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionForces {
    /// Semichord, m.
    pub semichord_m: f64,
    /// Elastic axis aft of mid-chord, in semichords.
    pub a: f64,
}

impl SectionForces {
    /// Q(s) for s = p b / U in the right half plane, on the imaginary axis, and in the left half plane off the negative
    /// real axis: row-major 2 x 2.
    ///
    /// Theodorsen's lift and moment (NACA 496, equations XVIII and XX without flap) over rho U^2 / 2, times b for the force on
    /// h/b: apparent mass in s^2, rotation in s, and the circulation 2 C(s) [s h/b + (1 + (1/2 - a) s) alpha], all times 2 pi b^2.
    #[must_use]
    pub fn q_laplace(&self, s: c64) -> [[c64; 2]; 2] {
        self.assemble(s, theodorsen_laplace(s))
    }

    fn assemble(&self, s: c64, c: c64) -> [[c64; 2]; 2] {
        let a = self.a;
        let scale = 2.0 * PI * self.semichord_m * self.semichord_m;
        let wash_h = s * c * 2.0;
        let wash_alpha = (s * (0.5 - a) + 1.0) * c * 2.0;
        let s2 = s * s;
        [
            [-(s2 + wash_h) * scale, -(s - s2 * a + wash_alpha) * scale],
            [
                (s2 * a + wash_h * (a + 0.5)) * scale,
                (-s * (0.5 - a) - s2 * (0.125 + a * a) + wash_alpha * (a + 0.5)) * scale,
            ],
        ]
    }

    /// dQ/ds, by the product rule on `assemble`.
    fn slope(&self, s: c64) -> [[c64; 2]; 2] {
        let a = self.a;
        let scale = 2.0 * PI * self.semichord_m * self.semichord_m;
        let (c, dc) = (theodorsen_laplace(s), theodorsen_laplace_slope(s));
        let wash_h = (c + s * dc) * 2.0;
        let wash_alpha = (c * (0.5 - a) + (s * (0.5 - a) + 1.0) * dc) * 2.0;
        [
            [-(s * 2.0 + wash_h) * scale, -(-s * 2.0 * a + 1.0 + wash_alpha) * scale],
            [
                (s * 2.0 * a + wash_h * (a + 0.5)) * scale,
                (-s * 2.0 * (0.125 + a * a) - (0.5 - a) + wash_alpha * (a + 0.5)) * scale,
            ],
        ]
    }
}

/// k below which the logarithm of C(k) is cut off: dQ/dk grows as ln k there and has no value at zero.
const LEAST_K: f64 = 1e-8;

impl GeneralizedForces for SectionForces {
    fn modes(&self) -> usize {
        2
    }

    fn domain(&self) -> KDomain {
        KDomain {
            minimum: 0.0,
            maximum: f64::INFINITY,
        }
    }

    fn q(&self, k: f64, mut q: MatMut<'_, c64>) -> Result<()> {
        let value = self.q_laplace(c64::new(0.0, k));
        for j in 0..2 {
            for i in 0..2 {
                q[(i, j)] = value[i][j];
            }
        }
        Ok(())
    }

    fn q_and_slope(&self, k: f64, mut q: MatMut<'_, c64>, mut dq_dk: MatMut<'_, c64>) -> Result<()> {
        self.q(k, q.as_mut())?;
        let slope = self.slope(c64::new(0.0, k.max(LEAST_K)));
        for j in 0..2 {
            for i in 0..2 {
                dq_dk[(i, j)] = c64::new(0.0, 1.0) * slope[i][j];
            }
        }
        Ok(())
    }
}
