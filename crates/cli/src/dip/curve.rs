//! A finished curve of a study: what is kept of it on disk, whatever computed it.

use crate::frequency::{FlutterRow, FrequencyResults};
use crate::progress::Seconds;
use crate::stamp::Stamp;
use crate::traces::{MachCurves, ModeShapes};
use dip_case::file::{CurveKind, Method};
use serde::{Deserialize, Serialize};

/// A point of a boundary, or the statement that there is none in the range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BoundaryRow {
    /// Mach number.
    pub mach: f64,
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Speed, m/s; none where the range has no flutter.
    pub flutter_speed_m_s: Option<f64>,
    /// Frequency, Hz.
    pub flutter_frequency_hz: Option<f64>,
    /// Speed of divergence at the same density, m/s, where the range has one.
    #[serde(default)]
    pub divergence_speed_m_s: Option<f64>,
    /// Numerical uncertainty of the speed as a part of it, where the method states one.
    #[serde(default)]
    pub uncertainty: Option<f64>,
    /// Wall seconds of this point, recordings and steady solutions included.
    pub time_s: f64,
    /// CPU seconds of the same.
    pub cpu_s: f64,
}

impl BoundaryRow {
    /// The point of a frequency-domain solution.
    pub fn of(row: &FlutterRow) -> Self {
        Self {
            mach: row.mach,
            density_kg_m3: row.density_kg_m3,
            flutter_speed_m_s: row.flutter_speed_m_s,
            flutter_frequency_hz: row.flutter_frequency_hz,
            divergence_speed_m_s: row.divergence_speed_m_s,
            uncertainty: None,
            time_s: row.time_s,
            cpu_s: row.cpu_s,
        }
    }
}

/// A point by one of the methods that a case names besides the one that gives the boundary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MethodRow {
    /// Correction; empty for the lattice as it is.
    pub correction: String,
    /// The point.
    pub row: FlutterRow,
}

/// One line of an audit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AuditLine {
    /// Mach number.
    pub mach: f64,
    /// What was checked.
    pub check: String,
    /// Of what.
    pub subject: String,
    /// Its value.
    pub value: Option<f64>,
    /// What it must not exceed, where there is such a number.
    pub limit: Option<f64>,
    /// The verdict in a word.
    pub verdict: String,
}

/// A finished curve.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct CurveResult {
    /// Name in figures and tables.
    pub name: String,
    /// How it was computed.
    pub kind: CurveKind,
    /// Stamp of what it was computed from.
    pub stamp: Stamp,
    /// Points of the boundary, one for each Mach number.
    pub boundary: Vec<BoundaryRow>,
    /// Points of all methods.
    pub rows: Vec<MethodRow>,
    /// Natural frequencies, Hz.
    pub natural_frequencies_hz: Vec<f64>,
    /// Mass of the structural model, kg, where it is known.
    pub structure_mass_kg: Option<f64>,
    /// Number of boxes of the lattice.
    pub boxes: Option<usize>,
    /// Number of cells of the grid.
    #[serde(default)]
    pub cells: Option<usize>,
    /// V-g and V-f curves of the boundary's method.
    pub curves: Vec<MachCurves>,
    /// Mode shapes for the pictures.
    pub shapes: Option<ModeShapes>,
    /// What to look at.
    pub warnings: Vec<String>,
    /// What to know besides.
    #[serde(default)]
    pub notes: Vec<String>,
    /// Audit of the hand-over from recordings.
    #[serde(default)]
    pub audit: Vec<AuditLine>,
    /// Seconds for each stage.
    pub stages: Vec<(String, Seconds)>,
}

impl CurveResult {
    /// The curve of a lattice without correction.
    pub fn frequency(name: &str, stamp: Stamp, method: Method, solved: &FrequencyResults) -> Self {
        let mine = || solved.solutions.iter().filter(|s| s.row.method == method);
        let mut warnings: Vec<String> = solved
            .findings
            .iter()
            .filter(|f| f.severity >= dip_dlm::lattice::Severity::Warning)
            .map(|f| f.message.clone())
            .collect();
        for s in mine() {
            warnings.extend(s.row.warnings.iter().map(|w| format!("Mach {}: {w}", s.row.mach)));
        }
        Self {
            name: name.to_owned(),
            kind: CurveKind::Dlm,
            stamp,
            boundary: mine().map(|s| BoundaryRow::of(&s.row)).collect(),
            rows: solved
                .solutions
                .iter()
                .map(|s| MethodRow {
                    correction: String::new(),
                    row: s.row.clone(),
                })
                .collect(),
            natural_frequencies_hz: (0..solved.modes.count()).map(|m| solved.modes.freq_hz(m)).collect(),
            structure_mass_kg: solved.structure_mass_kg,
            boxes: Some(solved.aerodynamics.lattice().n_boxes()),
            cells: None,
            curves: mine().map(|s| MachCurves::new(&s.solution)).collect(),
            shapes: Some(ModeShapes::new(&solved.modes, &solved.elements)),
            warnings,
            notes: Vec::new(),
            audit: Vec::new(),
            stages: solved.stages.clone(),
        }
    }
}
