//! What a flutter solution holds: curves of modes, crossings, humps, warnings.

use faer::c64;

use crate::forces::KRange;

/// Method of a solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// American method with artificial structural damping, viscous damping included.
    K,
    /// Nastran's restricted K-method: no viscous damping.
    Ke,
    /// p-k with the aerodynamic damping (Im Q / k) p as in Nastran (Rodden), after the British method of Lawrence and Jackson.
    Pk,
    /// p-k after Hassig (1971): Q(ik) as it is, for damped motion too.
    PkHassig,
    /// Chen's g-method (2000): Q expanded to first order in the damping by dQ/d(ik).
    G,
}

impl Method {
    /// Name for tables and figures.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::K => "K",
            Self::Ke => "KE",
            Self::Pk => "PK",
            Self::PkHassig => "PK (Hassig)",
            Self::G => "g",
        }
    }

    /// Whether the frequencies and dampings away from g = 0 are those of free motion (p methods) and not artificial.
    #[must_use]
    pub fn is_p_method(self) -> bool {
        !matches!(self, Self::K | Self::Ke)
    }
}

impl std::fmt::Display for Method {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// One root of one mode at one condition.
#[derive(Debug, Clone, PartialEq)]
pub struct ModePoint {
    /// Sweep parameter: speed (m/s), density (kg/m3) or altitude (m); for K and KE the reduced frequency.
    pub parameter: f64,
    /// True airspeed, m/s.
    pub speed_m_s: f64,
    /// Density, kg/m3.
    pub density_kg_m3: f64,
    /// Eigenvalue p = sigma + i omega, rad/s. For K and KE p = i omega / sqrt(1 + i g).
    pub p_rad_s: c64,
    /// Frequency omega / (2 pi), Hz; zero for a real root.
    pub freq_hz: f64,
    /// Damping: 2 sigma / omega for p methods (2 sigma b / (U ln 2) for a real root, as Nastran prints), the artificial
    /// damping needed for K and KE. Positive = unstable.
    pub g: f64,
    /// Reduced frequency omega b / U.
    pub k: f64,
    /// Whether the aerodynamics rest on data here.
    pub k_range: KRange,
    /// Confidence, 0 to 1, that this is the same mode as at the point before.
    pub confidence: f64,
    /// Modal assurance criterion with the vector at the point before.
    pub mac: f64,
    /// Eigenvector in generalized coordinates, unit mass norm, largest entry real.
    pub shape: Vec<c64>,
    /// Whether this condition was asked for (and not inserted by refinement).
    pub requested: bool,
}

/// One mode through the sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeCurve {
    /// Number of the natural mode it starts from, from 1; roots that start from none (aerodynamic lag) are numbered on.
    pub mode: usize,
    /// Natural frequency, Hz; zero for a root that starts from no natural mode.
    pub natural_freq_hz: f64,
    /// Whether the root starts from no natural mode.
    pub is_lag_root: bool,
    /// Points in the order of the sweep.
    pub points: Vec<ModePoint>,
}

/// Kind of a stability boundary.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CrossingKind {
    /// Oscillatory.
    Flutter,
    /// Static.
    Divergence,
}

/// Direction of a crossing as the sweep parameter goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Stable to unstable.
    Onset,
    /// Unstable to stable: the end of a hump.
    Recovery,
}

/// How fast damping is lost at an onset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Severity {
    /// Slope |2 q dg/dq| below 0.1: damping falls by less than 0.001 per percent of speed.
    Mild,
    /// Between mild and explosive.
    Moderate,
    /// Slope |2 q dg/dq| above 1: damping falls by more than 0.01 per percent of speed.
    Explosive,
}

/// A true root of the flutter equation at zero damping.
#[derive(Debug, Clone, PartialEq)]
pub struct Crossing {
    /// Mode number, as [`ModeCurve::mode`].
    pub mode: usize,
    /// Flutter or divergence.
    pub kind: CrossingKind,
    /// Onset or recovery.
    pub direction: Direction,
    /// Sweep parameter at the crossing.
    pub parameter: f64,
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Density, kg/m3.
    pub density_kg_m3: f64,
    /// Frequency, Hz.
    pub freq_hz: f64,
    /// Reduced frequency.
    pub k: f64,
    /// Whether the aerodynamics rest on data here.
    pub k_range: KRange,
    /// Slope of damping, 2 q dg/dq along the sweep with q the dynamic pressure: U dg/dU where the density is fixed. K and
    /// KE give the slope of free motion too (that of the g-method, exact at zero
    /// damping), since their own curves may run backwards in speed. Infinite at a divergence without any damping.
    pub slope: f64,
    /// Mild or explosive.
    pub severity: Severity,
    /// Damping g left when the iteration stopped.
    pub residual_g: f64,
    /// Width of the last bracket or last step of the parameter, relative: the error of the solution of the equation.
    pub error: f64,
    /// Speed that straight-line interpolation of the sweep gives, m/s: shows what re-solving was worth.
    pub interpolated_speed_m_s: f64,
    /// Least tracking confidence next to the crossing.
    pub confidence: f64,
    /// Eigenvector, as [`ModePoint::shape`].
    pub shape: Vec<c64>,
}

/// A local maximum of damping of one mode, inside the sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Hump {
    /// Mode number.
    pub mode: usize,
    /// Sweep parameter at the peak.
    pub parameter: f64,
    /// Speed at the peak, m/s.
    pub speed_m_s: f64,
    /// Density at the peak, kg/m3.
    pub density_kg_m3: f64,
    /// Frequency, Hz.
    pub freq_hz: f64,
    /// Damping at the peak; positive when the hump is unstable.
    pub g: f64,
}

/// Something the user must look at.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// Points whose reduced frequency lies outside the table.
    OutOfRange {
        /// Mode number.
        mode: usize,
        /// Number of points outside.
        points: usize,
        /// Least and greatest k met.
        k_minimum: f64,
        /// Greatest k met.
        k_maximum: f64,
    },
    /// The identity of a mode is uncertain next to this condition. Zero confidence: its damping changes sign from the condition
    /// before without a root at zero damping between, so the curve jumped from one root to another and no crossing is given;
    /// take closer conditions or more reduced frequencies.
    LowConfidence {
        /// Mode number.
        mode: usize,
        /// Sweep parameter.
        parameter: f64,
        /// Confidence there.
        confidence: f64,
    },
    /// A root could not be followed beyond this condition: a strongly damped root of a p-k equation may end (two roots meet).
    Lost {
        /// Mode number.
        mode: usize,
        /// Last sweep parameter with a root.
        parameter: f64,
    },
    /// An unstable root that belongs to no mode (a real root behind divergence, a lag root) has been added as a curve.
    ExtraRoot {
        /// Its number.
        mode: usize,
        /// Where it was found.
        parameter: f64,
    },
    /// An unstable root that appears at strong damping without ever crossing zero: a product of the method's expansion of Q
    /// for damped motion, left out of the curves.
    Artifact {
        /// Sweep parameter where it was seen.
        parameter: f64,
        /// The root, rad/s.
        p_rad_s: c64,
    },
    /// The sweep starts unstable: an onset lies below its first condition.
    UnstableAtStart {
        /// Mode number.
        mode: usize,
    },
}

/// Solution of one method at one Mach number.
#[derive(Debug, Clone, PartialEq)]
pub struct FlutterSolution {
    /// Method.
    pub method: Method,
    /// Mach number of the aerodynamics.
    pub mach: f64,
    /// Curves, mode 1 first.
    pub modes: Vec<ModeCurve>,
    /// Crossings in the order of speed.
    pub crossings: Vec<Crossing>,
    /// Damping peaks in the order of speed.
    pub humps: Vec<Hump>,
    /// What to look at.
    pub warnings: Vec<Warning>,
}

impl FlutterSolution {
    /// First flutter onset in the order of the sweep.
    #[must_use]
    pub fn flutter(&self) -> Option<&Crossing> {
        self.first(CrossingKind::Flutter)
    }

    /// First divergence onset in the order of the sweep.
    #[must_use]
    pub fn divergence(&self) -> Option<&Crossing> {
        self.first(CrossingKind::Divergence)
    }

    fn first(&self, kind: CrossingKind) -> Option<&Crossing> {
        self.crossings
            .iter()
            .find(|c| c.kind == kind && c.direction == Direction::Onset)
    }
}
