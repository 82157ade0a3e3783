//! `[recordings]` and `[correct]` of a flutter case: the correction of the lattice by recorded pressures.

use crate::units::Length;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Recordings of unsteady runs that the correction goes by.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RecordingsTable {
    /// Files (.mcap), of any of the case's Mach numbers, motions and frequencies.
    pub files: Vec<PathBuf>,
}

/// How the lattice is corrected.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CorrectTable {
    /// Methods, each from the same recordings.
    pub methods: Vec<CorrectMethod>,
    /// How pressures on the wall become pressures on boxes.
    pub sampling: Sampling,
    /// Place of point sampling, as a fraction of the box chord.
    pub point: f64,
    /// Whole cycles used, counted from the end of a recording; 0 uses all, the first one too.
    pub cycles: usize,
    /// Harmonics fitted.
    pub harmonics: usize,
    /// Largest |weight - 1| of a box; what is beyond is additive.
    pub bound: f64,
    /// Least linear value of a box over the root mean square of all, for a ratio to be taken; below it the correction is additive.
    pub least: f64,
    /// Multiple of the highest recorded reduced frequency from which on the lattice is linear.
    pub blend: f64,
    /// A point of the pitch axis that the recordings must have.
    pub axis: Option<[Length; 3]>,
}

impl Default for CorrectTable {
    fn default() -> Self {
        Self {
            methods: vec![CorrectMethod::Downwash],
            sampling: Sampling::default(),
            point: 0.75,
            cycles: 1,
            harmonics: 3,
            bound: 10.0,
            least: 0.02,
            blend: 2.0,
            axis: None,
        }
    }
}

/// A method of correction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CorrectMethod {
    /// Weights on the downwash, box by box, for each recorded reduced frequency.
    Downwash,
    /// The same from steady slopes, at every reduced frequency.
    DownwashSteady,
    /// Weights on the pressures.
    PressureRatio,
    /// Lift and moment of every strip matched with the least change of its pressures.
    Force,
    /// The same from steady slopes.
    ForceSteady,
    /// Additional pressures in proportion to the downwash.
    Additive,
    /// Pressures of the recorded motions replaced, other motions by their share of them.
    Mode,
    /// Pressures of every mode from recordings of every mode.
    Full,
    /// Unsteady pressures from steady ones by Garner's and Dau's semi-empirical ratio.
    DauGarner,
}

/// How pressures on the wall become pressures on boxes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Sampling {
    /// Area-weighted overlap that keeps lift and moment of every strip.
    #[default]
    Conservative,
    /// Area-weighted overlap that keeps the lift.
    Average,
    /// The value at a point of each box.
    Point,
}
