//! `flutter.toml`: modes, lattice, splines and the flutter solution.

use super::correct::{CorrectTable, RecordingsTable};
use crate::units::{Density, Frequency, Length, Mass, Speed, Volume};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A flutter case by the doublet lattice.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FlutterFile {
    /// The wing file.
    pub wing: PathBuf,
    /// Reference quantities.
    pub reference: ReferenceTable,
    /// The structure's modes.
    pub modes: Option<ModesTable>,
    /// The doublet lattice.
    pub lattice: LatticeTable,
    /// From structure to lattice.
    #[serde(default)]
    pub spline: SplineTable,
    /// The flutter solution.
    pub flutter: Option<FlutterTable>,
    /// Recordings for `dlm correct`.
    pub recordings: Option<RecordingsTable>,
    /// The correction by them, for `dlm correct`.
    pub correct: Option<CorrectTable>,
}

/// Reference quantities; one set serves all curves that are compared.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReferenceTable {
    /// Root semichord b; half the first section's chord if left out.
    pub semichord: Option<Length>,
    /// Mass m of the wing in the mass ratio.
    pub mass: Mass,
    /// Volume V in the mass ratio m / (rho V).
    pub volume: Volume,
    /// Frequency of the first torsion mode in the flutter speed index.
    pub omega_alpha: Frequency,
}

/// Where the modes come from: a structure file, or a table of shapes.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModesTable {
    /// A structure file: modes are computed.
    pub structure: Option<PathBuf>,
    /// A file of mode shapes: CSV (columns `x`, `y`, `z` with a unit as in `x_in`; `phi1`, `phi2`, ...), or Nastran's f06, punch, op2.
    pub file: Option<PathBuf>,
    /// Deck with the nodes, for mode files of Nastran (f06, punch, op2).
    pub geometry: Option<PathBuf>,
    /// What one unit of length in that deck is; 1 m if left out.
    pub length_unit: Option<Length>,
    /// What one unit of generalized mass in the mode file is; 1 kg if left out.
    pub mass_unit: Option<Mass>,
    /// Frequencies that go with the shapes of a CSV file; beside `structure`, one for each mode in place of the computed ones, as from
    /// a ground vibration test (shapes and generalized masses stay).
    pub frequencies: Option<Vec<Frequency>>,
    /// Generalized masses that go with the shapes of a CSV file; 1 kg each if left out.
    pub generalized_masses: Option<Vec<Mass>>,
    /// Use the first so many modes; all if left out.
    pub count: Option<usize>,
}

/// The doublet lattice.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LatticeTable {
    /// Boxes along the chord.
    pub chordwise: usize,
    /// Boxes along the span of the whole wing, shared out over its panels by span.
    pub spanwise: usize,
    /// Fit of the unsteady kernel across the doublet line.
    #[serde(default)]
    pub kernel: KernelKind,
    /// Approximation in the kernel's integrals.
    #[serde(default)]
    pub approximation: Approximation,
    /// Motion about the plane y = 0.
    #[serde(default)]
    pub symmetry: Symmetry,
    /// Mach numbers, each below 1.
    pub mach: Vec<f64>,
    /// Reduced frequencies k = omega b / U with b the root semichord; 0 is quasi-steady.
    pub reduced_frequencies: Vec<f64>,
    /// More lifting surfaces (tails, fins), each a wing file.
    #[serde(default)]
    pub surface: Vec<SurfaceTable>,
    /// Control surfaces on the wing.
    #[serde(default)]
    pub control_surface: Vec<ControlSurfaceTable>,
}

/// One more lifting surface.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SurfaceTable {
    /// Its wing file.
    pub wing: PathBuf,
    /// Boxes along its chord.
    pub chordwise: usize,
    /// Boxes along its span.
    pub spanwise: usize,
}

/// A trailing-edge control surface between two span stations.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ControlSurfaceTable {
    /// Its name.
    pub name: String,
    /// Hinge line as a fraction of the local chord.
    pub hinge: f64,
    /// Inner and outer end as fractions of the span.
    pub span: [f64; 2],
    /// Frequency of its rotation mode, with `inertia`; leave out both for generalized forces only.
    pub frequency: Option<Frequency>,
    /// Moment of inertia about the hinge line.
    pub inertia: Option<crate::units::Inertia>,
}

/// Fit of the unsteady kernel across the doublet line.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum KernelKind {
    /// Three points (Giesing, Kalman, Rodden 1971).
    Parabolic,
    /// Five points (Rodden, Taylor, McIntosh 1998).
    #[default]
    Quartic,
}

/// Approximation in the kernel's integrals.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Approximation {
    /// Laschka's eleven exponentials.
    Laschka,
    /// Desmarais' twelve exponentials.
    #[default]
    Desmarais,
}

/// Motion about the plane y = 0.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Symmetry {
    /// Both wings move alike, as a half model on a wall.
    #[default]
    Symmetric,
    /// Both wings move in opposite ways.
    Antisymmetric,
    /// Only what the files give: no image.
    None,
}

/// From structure to lattice.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SplineTable {
    /// Kind of spline.
    #[serde(default)]
    pub kind: SplineKind,
    /// Smoothing flexibility at the nodes, 0 for interpolation.
    #[serde(default)]
    pub smoothing: f64,
    /// Where a box takes its displacement and slope.
    #[serde(default)]
    pub points: Points,
}

/// Kind of spline.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SplineKind {
    /// Surface spline of an infinite plate (Harder, Desmarais 1972).
    #[default]
    InfinitePlate,
    /// Thin-plate spline in space.
    ThinPlate,
    /// Beam with torsion along the wing's nodes.
    Beam,
    /// The best rigid motion.
    Rigid,
}

/// Where a box takes its displacement and slope.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Points {
    /// Displacement and slope at 3/4 chord, force at 1/4 chord of the box.
    #[default]
    Own,
    /// Displacement and slope at mid-chord, the box rigid, as Nastran does.
    Nastran,
}

/// The flutter solution.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FlutterTable {
    /// Methods, each solved on the same generalized forces.
    pub methods: Vec<Method>,
    /// Density at each Mach number of the lattice, in its order.
    pub densities: Option<Vec<Density>>,
    /// Altitudes at each Mach number, in place of densities: standard atmosphere.
    pub altitudes: Option<Vec<Length>>,
    /// What is varied to find flutter.
    #[serde(default)]
    pub search: Search,
    /// Highest speed looked at; twice the sound speed of the standard day if left out.
    pub speed_max: Option<Speed>,
    /// Lowest speed looked at.
    pub speed_min: Option<Speed>,
    /// Number of speeds in the curves.
    pub speed_count: Option<usize>,
    /// Structural damping g, one for all modes.
    #[serde(default)]
    pub structural_damping: f64,
    /// Structural damping g of each mode, instead of one for all.
    pub structural_damping_modes: Option<Vec<f64>>,
    /// Structural damping g against frequency (TABDMP1-like), instead of either: pairs of frequency and g.
    pub structural_damping_table: Option<Vec<(Frequency, f64)>>,
}

/// Flutter solution method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// K: artificial structural damping at fixed k.
    K,
    /// KE: K without vectors, with Nastran's printed V and g.
    Ke,
    /// PK: Nastran's form.
    Pk,
    /// PK, British form.
    PkBritish,
    /// g-method (Chen 2000).
    G,
}

/// What is varied to find flutter at a fixed Mach number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Search {
    /// Speed at the given density, as a wind tunnel's experiment is quoted.
    #[default]
    Speed,
    /// Altitude in the standard atmosphere, speed = Mach number times sound speed.
    MatchedPoint,
}

impl Method {
    /// Name for tables and figures.
    pub fn name(self) -> &'static str {
        match self {
            Self::K => "K",
            Self::Ke => "KE",
            Self::Pk => "PK",
            Self::PkBritish => "PK (British)",
            Self::G => "g",
        }
    }
}
