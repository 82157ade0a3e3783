//! What is asked: structure + aerodynamics + reference length, the sweep, the settings.

use crate::error::{FlutterError, Result, check_value};
use crate::forces::GeneralizedForces;
use crate::structure::Structure;

/// Structure and aerodynamics at one Mach number.
#[derive(Clone, Copy)]
pub struct FlutterProblem<'a> {
    /// The structure.
    pub structure: &'a Structure,
    /// Q(k) at this Mach number.
    pub forces: &'a dyn GeneralizedForces,
    /// Reference semichord b of k = omega b / U, m.
    pub semichord_m: f64,
    /// Mach number of the aerodynamics (recorded, and used by altitude sweeps).
    pub mach: f64,
}

impl std::fmt::Debug for FlutterProblem<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FlutterProblem")
            .field("structure", self.structure)
            .field("modes", &self.forces.modes())
            .field("domain", &self.forces.domain())
            .field("semichord_m", &self.semichord_m)
            .field("mach", &self.mach)
            .finish()
    }
}

impl FlutterProblem<'_> {
    pub(crate) fn check(&self) -> Result<()> {
        check_value(
            "reference semichord, m",
            self.semichord_m,
            "above zero",
            self.semichord_m > 0.0,
        )?;
        check_value("Mach number", self.mach, "zero or more", self.mach >= 0.0)?;
        let (n, modes) = (self.structure.size(), self.forces.modes());
        if n != modes {
            return Err(FlutterError::Shape {
                what: "generalized forces".into(),
                needed: format!("{n} x {n}, as the generalized mass"),
                got: format!("{modes} x {modes}"),
            });
        }
        let domain = self.forces.domain();
        if domain.minimum.is_nan() || domain.minimum < 0.0 || domain.maximum.is_nan() || domain.maximum <= 0.0 {
            return Err(FlutterError::Value {
                what: format!(
                    "reduced frequencies of the generalized forces, {} to {}",
                    domain.minimum, domain.maximum
                ),
                needed: "0 <= least k, greatest k above zero".into(),
                got: domain.maximum,
            });
        }
        Ok(())
    }
}

/// Density and speed of sound of the air at an altitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AirState {
    /// Density, kg/m3.
    pub density_kg_m3: f64,
    /// Speed of sound, m/s.
    pub sound_speed_m_s: f64,
}

/// Altitude in m to air state. Any atmosphere will do; it must be continuous.
pub type Atmosphere<'a> = dyn Fn(f64) -> AirState + Sync + 'a;

/// One parameter varied at fixed Mach number. The conditions are those asked for; the solver inserts more where it must.
#[derive(Clone, Copy)]
pub enum Sweep<'a> {
    /// Speed varies at fixed density, as the deck of a wing at one altitude (Mach and speed need not match).
    Speed {
        /// Density, kg/m3.
        density_kg_m3: f64,
        /// Speeds, m/s, rising, above zero.
        speeds_m_s: &'a [f64],
    },
    /// Density varies at fixed speed, as in a wind tunnel held at one Mach number and total temperature.
    Density {
        /// Speed, m/s.
        speed_m_s: f64,
        /// Densities, kg/m3, rising, above zero.
        densities_kg_m3: &'a [f64],
    },
    /// Altitude varies at the Mach number of the problem: every point is matched, U = M a(h), rho(h).
    Altitude {
        /// The atmosphere.
        atmosphere: &'a Atmosphere<'a>,
        /// Altitudes, m, falling or rising.
        altitudes_m: &'a [f64],
    },
}

/// Speed and density of one condition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Condition {
    pub speed_m_s: f64,
    pub density_kg_m3: f64,
}

impl Condition {
    pub fn dynamic_pressure(self) -> f64 {
        0.5 * self.density_kg_m3 * self.speed_m_s * self.speed_m_s
    }
}

impl Sweep<'_> {
    /// Name of the parameter with its unit.
    #[must_use]
    pub fn parameter_name(&self) -> &'static str {
        match self {
            Self::Speed { .. } => "speed, m/s",
            Self::Density { .. } => "density, kg/m3",
            Self::Altitude { .. } => "altitude, m",
        }
    }

    pub(crate) fn parameters(&self) -> &[f64] {
        match self {
            Self::Speed { speeds_m_s: list, .. }
            | Self::Density {
                densities_kg_m3: list, ..
            }
            | Self::Altitude { altitudes_m: list, .. } => list,
        }
    }

    pub(crate) fn condition(&self, mach: f64, parameter: f64) -> Condition {
        match self {
            Self::Speed { density_kg_m3, .. } => Condition {
                speed_m_s: parameter,
                density_kg_m3: *density_kg_m3,
            },
            Self::Density { speed_m_s, .. } => Condition {
                speed_m_s: *speed_m_s,
                density_kg_m3: parameter,
            },
            Self::Altitude { atmosphere, .. } => {
                let air = atmosphere(parameter);
                Condition {
                    speed_m_s: mach * air.sound_speed_m_s,
                    density_kg_m3: air.density_kg_m3,
                }
            }
        }
    }

    pub(crate) fn check(&self, mach: f64) -> Result<()> {
        let name = self.parameter_name();
        let list = self.parameters();
        if list.is_empty() {
            return Err(FlutterError::Shape {
                what: format!("sweep ({name})"),
                needed: "at least one value".into(),
                got: "none".into(),
            });
        }
        let altitude = matches!(self, Self::Altitude { .. });
        let falls = altitude && list.len() > 1 && list[1] < list[0];
        for (j, &value) in list.iter().enumerate() {
            let ordered = j == 0
                || if falls {
                    value < list[j - 1]
                } else {
                    value > list[j - 1]
                };
            check_value(
                name,
                value,
                "each value beyond the one before it, without repeats",
                ordered,
            )?;
            let condition = self.condition(mach, value);
            let at = |what: &str| format!("{what} at {name} = {value}");
            check_value(
                &at("speed in m/s"),
                condition.speed_m_s,
                "above zero",
                condition.speed_m_s > 0.0,
            )?;
            let positive = condition.density_kg_m3 > 0.0;
            check_value(&at("density in kg/m3"), condition.density_kg_m3, "above zero", positive)?;
        }
        Ok(())
    }
}

/// What to do with a reduced frequency outside the aerodynamics' domain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OutOfRange {
    /// Use the forces' documented extension, mark every such point and warn.
    #[default]
    Report,
    /// Refuse the solution.
    Refuse,
}

/// Settings of the solvers. The defaults suit most problems.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Rule for k outside the data.
    pub out_of_range: OutOfRange,
    /// Confidence below which the step in the sweep is halved (0 to 1).
    pub confidence: f64,
    /// How many times a step between two requested conditions may be halved.
    pub halvings: u32,
    /// Relative tolerance of the crossing's parameter.
    pub tolerance: f64,
    /// Whether to search all roots at the end of the sweep and at the first onset for unstable roots of no mode.
    pub audit: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            out_of_range: OutOfRange::Report,
            confidence: 0.8,
            halvings: 10,
            tolerance: 1e-9,
            audit: true,
        }
    }
}

impl Settings {
    pub(crate) fn check(&self) -> Result<()> {
        let confidence = self.confidence;
        check_value(
            "least confidence",
            confidence,
            "0 to 1",
            (0.0..=1.0).contains(&confidence),
        )?;
        let tolerance = self.tolerance;
        check_value(
            "tolerance of crossings",
            tolerance,
            "1e-13 to 0.1",
            (1e-13..=0.1).contains(&tolerance),
        )
    }
}
