//! `boundary.toml`: a study that puts several boundaries side by side.

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
    /// Which method of the case gives the boundary; the case's first if left out.
    pub method: Option<Method>,
}

/// How a curve is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CurveKind {
    /// The doublet lattice without correction.
    Dlm,
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
