//! Motion coordinates: what moves, about which axis, by which law.

use serde::Serialize;

/// One coordinate of the motion: an angle, a distance, or the amplitude of a shape.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MotionCoordinate {
    /// Name, unique in a recording: `pitch`, `mode 1`.
    pub name: String,
    /// What it does to the surface; also says the unit of its value (rad, m, or 1).
    pub kind: CoordinateKind,
    /// The law that it was asked to follow.
    pub law: Law,
    /// Displacement of the wall's nodes per unit of the coordinate, `[patch][node][x, y, z]`, m per rad, m or 1. Needed
    /// where the kind does not say it (mode, control); empty for rigid motion.
    pub shape_m: Vec<Vec<[f64; 3]>>,
    /// The structural mode behind a coordinate of kind [`CoordinateKind::Mode`].
    pub mode: Option<StructuralMode>,
}

/// What a coordinate does to the surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase", tag = "kind")]
pub enum CoordinateKind {
    /// Rigid rotation, rad, by the right-hand rule: about an axis along +y that is nose up.
    Pitch {
        /// A point of the axis, m.
        axis_point_m: [f64; 3],
        /// Direction of the axis, length 1.
        axis_direction: [f64; 3],
    },
    /// Rigid translation, m.
    Plunge {
        /// Direction of positive values, length 1.
        direction: [f64; 3],
    },
    /// Generalized coordinate of a structural mode, 1; the shape carries the metres.
    Mode,
    /// Rotation of a control surface about its hinge, rad, positive by the right-hand rule; the shape says what moves.
    Control {
        /// A point of the hinge, m.
        axis_point_m: [f64; 3],
        /// Direction of the hinge, length 1.
        axis_direction: [f64; 3],
    },
}

impl CoordinateKind {
    /// Name in the file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pitch { .. } => "pitch",
            Self::Plunge { .. } => "plunge",
            Self::Mode => "mode",
            Self::Control { .. } => "control",
        }
    }

    /// Unit of the coordinate: `rad`, `m` or `1`. Its rate is per second.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Pitch { .. } | Self::Control { .. } => "rad",
            Self::Plunge { .. } => "m",
            Self::Mode => "1",
        }
    }
}

/// The law of a motion. What a step really had stands in [`Step::motion`](crate::Step::motion); for the laws with a
/// formula here a reader checks the two against each other.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase", tag = "law")]
pub enum Law {
    /// mean + sum of `amplitude` sin(`omega` (t - `phase_origin`) + `phase`) after the phase origin. At that instant
    /// itself stands the flow before the motion, whose coordinate is the mean.
    Harmonic {
        /// Mean, in the unit of the coordinate.
        mean: f64,
        /// Instant from which the phases count, s.
        phase_origin_s: f64,
        /// The sines; the first one is the fundamental.
        harmonics: Vec<Harmonic>,
    },
    /// A smooth pulse that returns to the mean.
    Pulse {
        /// Mean, in the unit of the coordinate.
        mean: f64,
        /// Height above the mean.
        amplitude: f64,
        /// Instant at which it begins, s.
        start_s: f64,
        /// How long it lasts, s.
        duration_s: f64,
        /// The formula in words or symbols, for people.
        formula: String,
    },
    /// A smooth change from the mean to mean + amplitude.
    Ramp {
        /// Value before, in the unit of the coordinate.
        mean: f64,
        /// Change.
        amplitude: f64,
        /// Instant at which it begins, s.
        start_s: f64,
        /// How long it lasts, s.
        duration_s: f64,
        /// The formula in words or symbols, for people.
        formula: String,
    },
    /// Moves freely: the structure decides.
    Free,
}

/// One sine of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Harmonic {
    /// Circular frequency, rad/s.
    pub omega_rad_s: f64,
    /// Amplitude, in the unit of the coordinate.
    pub amplitude: f64,
    /// Phase of the sine at the law's phase origin, rad.
    pub phase_rad: f64,
}

/// What is known of a structural mode.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StructuralMode {
    /// Number, from 1.
    pub number: u32,
    /// Natural circular frequency, rad/s.
    pub omega_rad_s: f64,
    /// Generalized mass belonging to the shape, kg.
    pub generalized_mass_kg: f64,
    /// Part of critical damping.
    pub damping_ratio: f64,
}

/// A coordinate at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct MotionValue {
    /// Value, rad, m or 1.
    pub value: f64,
    /// Its rate, per second.
    pub rate: f64,
}

impl Law {
    /// Name in the file.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Harmonic { .. } => "harmonic",
            Self::Pulse { .. } => "pulse",
            Self::Ramp { .. } => "ramp",
            Self::Free => "free",
        }
    }

    /// Value and rate of a harmonic law at an instant; none for the others, whose steps alone say what they did.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Option<MotionValue> {
        let Self::Harmonic {
            mean,
            phase_origin_s,
            harmonics,
        } = self
        else {
            return None;
        };
        let mut now = MotionValue {
            value: *mean,
            rate: 0.0,
        };
        for h in harmonics {
            let (sin, cos) = (h.omega_rad_s * (time_s - phase_origin_s) + h.phase_rad).sin_cos();
            now.value += h.amplitude * sin;
            now.rate += h.amplitude * h.omega_rad_s * cos;
        }
        Some(now)
    }

    /// Circular frequency of the fundamental, rad/s, of a harmonic law.
    #[must_use]
    pub fn fundamental_rad_s(&self) -> Option<f64> {
        match self {
            Self::Harmonic { harmonics, .. } => harmonics.first().map(|h| h.omega_rad_s),
            _ => None,
        }
    }
}
