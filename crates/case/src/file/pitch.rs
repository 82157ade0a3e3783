//! `pitch.toml`: unsteady flow round a body with prescribed motion.

use super::flutter::ModesTable;
use super::mesh::MeshTable;
use super::steady::{CutsTable, FlowTable, LoadReferenceTable, PatchTable, SteadyTable};
use crate::units::{Angle, Frequency, Kind, Length, UnitError, parse};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A case of prescribed motion.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PitchFile {
    /// Free stream. Speed and density, which make seconds and newtons, are those of the standard atmosphere at sea level
    /// if left out.
    pub flow: FlowTable,
    /// The grid, where the motion is zero.
    pub mesh: MeshTable,
    /// What force coefficients and the reduced frequency are made with.
    pub reference: LoadReferenceTable,
    /// What moves and how.
    pub motion: MotionTable,
    /// The structural modes, for motion of kind `mode`.
    pub modes: Option<ModesTable>,
    /// The steady solution that the run starts from; 6 orders if left out.
    #[serde(default)]
    pub steady: SteadyTable,
    /// The solution in time.
    #[serde(default)]
    pub time: TimeTable,
    /// Values of in- and outflow patches, by the patch's name.
    #[serde(default)]
    pub patch: BTreeMap<String, PatchTable>,
    /// Stations at which first harmonics of the pressure are drawn.
    #[serde(default)]
    pub cuts: CutsTable,
}

/// What moves and how.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MotionTable {
    /// What moves.
    #[serde(default)]
    pub kind: MotionKind,
    /// By which law.
    #[serde(default)]
    pub law: MotionLaw,
    /// A point [x, y, z] of the axis of pitch or of the hinge of a control surface.
    pub axis: Option<[Length; 3]>,
    /// Direction of that axis, positive by the right-hand rule (along y if left out: nose up, trailing edge down), or of
    /// positive plunge (along z if left out).
    pub direction: Option<[f64; 3]>,
    /// Number of the mode, from 1; the first if left out.
    pub mode: Option<usize>,
    /// Control surface: from and to which y it reaches.
    pub span: Option<[Length; 2]>,
    /// Control surface: width on either side of `span` over which the rotation fades out; a tenth of the span if left out.
    pub blend: Option<Length>,
    /// Amplitude: an angle, a length for plunge, a number for a mode.
    pub amplitude: Amount,
    /// Mean value, in the same way; 0 if left out.
    pub mean: Option<Amount>,
    /// Frequency, as `"17.98 Hz"` or `"113 rad/s"`; or give `reduced_frequency`.
    pub frequency: Option<Frequency>,
    /// Reduced frequency k = omega b / U with `reference.semichord`.
    pub reduced_frequency: Option<f64>,
    /// Phase of the sine at the beginning; 0 if left out.
    pub phase: Option<Angle>,
    /// Further sines at multiples of the frequency.
    #[serde(default)]
    pub harmonic: Vec<HarmonicTable>,
    /// Time steps in a period of `frequency`.
    #[serde(default = "steps_per_cycle")]
    pub steps_per_cycle: usize,
    /// Periods of `frequency` after which the run ends in any case.
    #[serde(default = "cycles")]
    pub cycles: usize,
    /// The run ends when lift and moment of two successive cycles differ by less than this part of their amplitude; 0
    /// takes all `cycles`.
    #[serde(default = "tolerance")]
    pub tolerance: f64,
    /// Pulse and ramp: how long they last, in periods of `frequency`.
    #[serde(default = "duration")]
    pub duration: f64,
    /// Run once more with half the amplitude and say how much the harmonics change.
    #[serde(default)]
    pub linearity: bool,
}

fn steps_per_cycle() -> usize {
    40
}

fn cycles() -> usize {
    6
}

fn tolerance() -> f64 {
    0.002
}

fn duration() -> f64 {
    1.0
}

/// What moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MotionKind {
    /// The whole body turns about an axis.
    #[default]
    Pitch,
    /// The whole body moves to and fro.
    Plunge,
    /// The body deforms in a structural mode.
    Mode,
    /// A control surface turns about its hinge.
    Control,
}

/// The law of a motion in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MotionLaw {
    /// A sum of sines.
    #[default]
    Harmonic,
    /// A smooth pulse that returns to the mean: one run gives all reduced frequencies.
    Pulse,
    /// A smooth change from the mean to mean + amplitude.
    Ramp,
}

/// A further sine of a harmonic motion.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HarmonicTable {
    /// Multiple of the frequency.
    pub multiple: usize,
    /// Amplitude, as that of the motion.
    pub amplitude: Amount,
    /// Phase of the sine at the beginning; 0 if left out.
    pub phase: Option<Angle>,
}

/// A quantity whose kind another key decides: a number in SI, or text with a unit.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Amount {
    /// A number in SI.
    Number(f64),
    /// A number with its unit.
    Text(String),
}

impl Amount {
    /// The value in SI.
    ///
    /// # Errors
    /// A missing or unknown unit, or one of another kind.
    pub fn value<K: Kind>(&self) -> Result<f64, UnitError> {
        match self {
            Self::Number(v) => Ok(*v),
            Self::Text(text) => parse::<K>(text),
        }
    }
}

/// The solution in time. The defaults suit every case.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimeTable {
    /// Orders of magnitude by which the residual of every step must fall; 2.5 if left out.
    pub orders: Option<f64>,
    /// Pseudo-time iterations in a step, at most.
    pub iterations: Option<usize>,
    /// Difference in time.
    #[serde(default)]
    pub scheme: TimeSchemeKind,
    /// Steps between restart files; a cycle if left out.
    pub checkpoint: Option<usize>,
}

/// Difference in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TimeSchemeKind {
    /// Second order.
    #[default]
    Bdf2,
    /// Second order with half the error of `bdf2` for the same step.
    Bdf2Opt,
    /// First order.
    Bdf1,
}
