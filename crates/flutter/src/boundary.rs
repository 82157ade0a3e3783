//! Flutter boundaries: the speed index against Mach number, for points from any source.

use crate::error::{Result, check_value};
use crate::solution::Crossing;

/// Reference quantities of the flutter speed index.
///
/// The published curves of one wing use different pairs of mass and omega_alpha: say which one and use it for all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedIndexReference {
    /// Reference semichord b, m (root semichord for the AGARD wing).
    pub semichord_m: f64,
    /// Uncoupled (or first) torsion frequency omega_alpha, rad/s.
    pub omega_alpha_rad_s: f64,
    /// Mass m of the wing (the panel, for a half model), kg.
    pub mass_kg: f64,
    /// Volume of the conical frustum round the panel, m3.
    pub volume_m3: f64,
}

impl SpeedIndexReference {
    /// Checked reference quantities.
    ///
    /// # Errors
    /// When one is not above zero.
    pub fn new(semichord_m: f64, omega_alpha_rad_s: f64, mass_kg: f64, volume_m3: f64) -> Result<Self> {
        let positive = |what: &str, value: f64| check_value(what, value, "above zero", value > 0.0);
        positive("reference semichord, m", semichord_m)?;
        positive("torsion frequency omega_alpha, rad/s", omega_alpha_rad_s)?;
        positive("mass, kg", mass_kg)?;
        positive("volume, m3", volume_m3)?;
        Ok(Self {
            semichord_m,
            omega_alpha_rad_s,
            mass_kg,
            volume_m3,
        })
    }

    /// Mass ratio mu = m / (rho V).
    #[must_use]
    pub fn mass_ratio(&self, density_kg_m3: f64) -> f64 {
        self.mass_kg / (density_kg_m3 * self.volume_m3)
    }

    /// Flutter speed index U / (b omega_alpha sqrt(mu)).
    #[must_use]
    pub fn speed_index(&self, speed_m_s: f64, density_kg_m3: f64) -> f64 {
        speed_m_s / (self.semichord_m * self.omega_alpha_rad_s * self.mass_ratio(density_kg_m3).sqrt())
    }

    /// omega / omega_alpha.
    #[must_use]
    pub fn frequency_ratio(&self, freq_hz: f64) -> f64 {
        std::f64::consts::TAU * freq_hz / self.omega_alpha_rad_s
    }
}

/// One point of a flutter boundary: computed by any method, marched in time, or measured.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryPoint {
    /// Where it comes from: "PK", "time march", "experiment", ...
    pub source: String,
    /// Mach number.
    pub mach: f64,
    /// Density, kg/m3.
    pub density_kg_m3: f64,
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Frequency, Hz; zero for divergence, `None` when the source gives none.
    pub freq_hz: Option<f64>,
    /// Half width of the uncertainty of the speed, m/s, when the source gives one (half a bracket counts).
    pub speed_uncertainty_m_s: Option<f64>,
    /// Number of the mode, when known.
    pub mode: Option<usize>,
}

impl BoundaryPoint {
    /// The point of a crossing found by `source` at `mach`; its uncertainty is that of the solution of the equation.
    #[must_use]
    pub fn from_crossing(source: &str, mach: f64, crossing: &Crossing) -> Self {
        Self {
            source: source.to_string(),
            mach,
            density_kg_m3: crossing.density_kg_m3,
            speed_m_s: crossing.speed_m_s,
            freq_hz: Some(crossing.freq_hz),
            speed_uncertainty_m_s: Some(crossing.error * crossing.speed_m_s),
            mode: Some(crossing.mode),
        }
    }

    /// Dynamic pressure, Pa.
    #[must_use]
    pub fn dynamic_pressure_pa(&self) -> f64 {
        0.5 * self.density_kg_m3 * self.speed_m_s * self.speed_m_s
    }

    /// Flutter speed index.
    #[must_use]
    pub fn speed_index(&self, reference: &SpeedIndexReference) -> f64 {
        reference.speed_index(self.speed_m_s, self.density_kg_m3)
    }

    /// omega / omega_alpha, when there is a frequency.
    #[must_use]
    pub fn frequency_ratio(&self, reference: &SpeedIndexReference) -> Option<f64> {
        self.freq_hz.map(|f| reference.frequency_ratio(f))
    }
}
