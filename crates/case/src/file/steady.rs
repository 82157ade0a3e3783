//! `steady.toml`: steady flow round a body.

use super::mesh::MeshTable;
use crate::units::{Angle, Area, Density, Length, Speed};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A case of steady flow.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SteadyFile {
    /// Free stream.
    pub flow: FlowTable,
    /// The grid.
    pub mesh: MeshTable,
    /// What force coefficients are made with; needed where the grid has walls.
    pub reference: Option<LoadReferenceTable>,
    /// The solution method.
    #[serde(default)]
    pub steady: SteadyTable,
    /// Values of in- and outflow patches, by the patch's name.
    #[serde(default)]
    pub patch: BTreeMap<String, PatchTable>,
    /// Pressure distributions to write.
    #[serde(default)]
    pub cuts: CutsTable,
}

/// Free stream and gas.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FlowTable {
    /// Mach number.
    pub mach: f64,
    /// Angle of attack: the stream turns from x (aft) towards z (up); 0 if left out.
    pub alpha: Option<Angle>,
    /// Angle of sideslip: the stream turns towards y (starboard); 0 if left out.
    pub beta: Option<Angle>,
    /// Which equations are solved.
    #[serde(default)]
    pub model: FlowModel,
    /// Ratio of specific heats; 1.4 (air) if left out.
    pub gamma: Option<f64>,
    /// Speed of the stream; with `density`, forces are given in newtons as well.
    pub speed: Option<Speed>,
    /// Density of the stream.
    pub density: Option<Density>,
}

/// Which equations are solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FlowModel {
    /// Inviscid flow.
    #[default]
    Euler,
}

/// What force and moment coefficients are made with. For a half model: area and forces of the half.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadReferenceTable {
    /// Area of force coefficients; on a two-dimensional grid chord times the grid's width if left out.
    pub area: Option<Area>,
    /// Length of moment coefficients.
    pub chord: Length,
    /// Point about which moments are taken [x, y, z]; the origin if left out.
    pub moment_point: Option<[Length; 3]>,
    /// Distance from root to tip, for cuts given as fractions of it.
    pub semispan: Option<Length>,
    /// Semichord b of the reduced frequency k = omega b / U of unsteady runs; half of `chord` if left out.
    pub semichord: Option<Length>,
}

/// The solution method. The defaults suit every case.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SteadyTable {
    /// Orders of magnitude by which the residual must fall; 10 if left out.
    pub orders: Option<f64>,
    /// Steps on the finest level after which to give up.
    pub iterations: Option<usize>,
    /// Coarser levels to start on, at most; 1 starts on the grid itself.
    pub levels: Option<usize>,
    /// CFL number of the first implicit step.
    pub cfl: Option<f64>,
    /// Largest growth of the CFL number from one step to the next.
    pub cfl_growth: Option<f64>,
    /// What holds on far-field patches.
    #[serde(default)]
    pub far_field: FarFieldKind,
    /// How states at cell faces are made from cell values.
    #[serde(default)]
    pub reconstruction: ReconstructionKind,
    /// Constant of the limiter: larger limits less.
    pub limiter_constant: Option<f64>,
    /// Steps between restart files; 50 if left out. One is written at the end in any case.
    pub checkpoint: Option<usize>,
    /// Write the flow in all cells for ParaView (`flow.vtm`); true if left out.
    pub paraview: Option<bool>,
}

/// What holds on far-field patches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FarFieldKind {
    /// Undisturbed stream outside.
    #[default]
    FreeStream,
    /// Riemann invariants of the undisturbed stream and the flow inside.
    Characteristic,
    /// Undisturbed stream with the point vortex of the lift; two-dimensional grids only.
    Vortex,
}

/// How states at cell faces are made from cell values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ReconstructionKind {
    /// Second order with van Albada's limiter.
    #[default]
    VanAlbada,
    /// Third-order upwind-biased (kappa = 1/3) with Koren's limiter.
    Koren,
    /// Second order without limiter; for flow without shocks.
    Unlimited,
    /// First order.
    FirstOrder,
}

/// Values on a patch of in- or outflow, as ratios to the free stream's static values.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PatchTable {
    /// Subsonic inflow: total pressure over the stream's static pressure.
    pub total_pressure: Option<f64>,
    /// Subsonic inflow: total temperature over the stream's static temperature.
    pub total_temperature: Option<f64>,
    /// Subsonic inflow: direction [x, y, z]; the stream's if left out.
    pub direction: Option<[f64; 3]>,
    /// Subsonic outflow: static pressure over the stream's.
    pub pressure: Option<f64>,
}

/// Pressure distributions along the chord. On a two-dimensional grid there is one, whatever stands here.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CutsTable {
    /// Stations as fractions of `reference.semispan`.
    #[serde(default)]
    pub eta: Vec<f64>,
    /// Stations as lengths along y.
    #[serde(default)]
    pub y: Vec<Length>,
    /// Measured points to show beside the computed ones: CSV with columns `x_over_c`, `cp` and, for several stations,
    /// `eta`.
    pub measured: Option<PathBuf>,
}
