//! `boundary.toml`: a study that puts several boundaries side by side.

use super::correct::CorrectMethod;
use super::flutter::{Method, ReferenceTable};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A study: curves of flutter boundaries over Mach number, computed and published, beside experiment.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StudyFile {
    /// Title of the report.
    pub title: String,
    /// One paragraph for the report's start.
    pub description: Option<String>,
    /// CSV of the experiment: columns `mach`, `density_kg_m3`, `speed_m_s`, `frequency_hz`.
    pub experiment: Option<PathBuf>,
    /// Mach numbers of the study; every curve is computed at these.
    pub mach: Vec<f64>,
    /// Reference quantities of the speed index, one set for all curves, experiment included.
    pub reference: ReferenceTable,
    /// Curves that are computed.
    pub curve: Vec<CurveTable>,
    /// Curves of others, for comparison.
    #[serde(default)]
    pub published: Vec<PublishedTable>,
}

/// One computed curve.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CurveTable {
    /// Name in figures and tables, and of its folder in the output.
    pub name: String,
    /// How it is computed.
    pub kind: CurveKind,
    /// The case file.
    pub case: PathBuf,
    /// Which flutter method of the case gives the boundary; the case's first if left out.
    pub method: Option<Method>,
    /// Mach numbers of this curve, if not all of the study's.
    pub mach: Option<Vec<f64>>,
    /// `corrected`: the case of prescribed motion that is run and recorded at every Mach number.
    pub pitch: Option<PathBuf>,
    /// `corrected`: which correction gives the boundary; the case's first if left out.
    pub correction: Option<CorrectMethod>,
    /// `corrected`: recordings are made at these multiples of the uncorrected flutter frequency; [0.75, 1.15] if left out.
    pub around: Option<Vec<f64>>,
    /// Keys of the flow case (`pitch`, or `case` of a march) to override, as `key=value` texts.
    #[serde(default)]
    pub set: Vec<String>,
    /// Keys that `--fidelity medium` overrides besides.
    #[serde(default)]
    pub medium: Vec<String>,
}

/// How a curve is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CurveKind {
    /// The doublet lattice without correction.
    Dlm,
    /// The doublet lattice corrected by recordings of prescribed motion, which are made first.
    Corrected,
    /// Flow and structure marched together, with a search for the flutter point.
    March,
}

/// A published curve.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PublishedTable {
    /// Name in figures and tables.
    pub name: String,
    /// CSV with columns `mach`, `density_kg_m3`, `speed_m_s`, `frequency_hz`; or `mach`, `flutter_speed_index`, `frequency_ratio`.
    pub file: PathBuf,
    /// Where it comes from.
    pub source: String,
}
