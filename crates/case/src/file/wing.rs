//! `wing.toml`: planform and sections.

use crate::units::{Angle, Length};
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::PathBuf;

/// A wing: planform and sections, shared by grid recipe, lattice and structure.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WingFile {
    /// Name for titles and reports.
    pub name: String,
    /// Sections from root to tip; straight panels between them.
    pub section: Vec<SectionTable>,
}

/// One section.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SectionTable {
    /// Leading edge [x, y, z]: x aft, y to starboard, z up.
    pub leading_edge: [Length; 3],
    /// Chord along x.
    pub chord: Length,
    /// Twist about the leading edge, positive nose up; none if left out.
    pub twist: Option<Angle>,
    /// CSV file of ordinates over the chord: columns `x` and `half_thickness`, or `x`, `upper`, `lower`.
    pub airfoil: Option<PathBuf>,
}
