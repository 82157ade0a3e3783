//! `march.toml`: flow and structure marched together, once or until the flutter point is found.

use super::flutter::{ModesTable, ReferenceTable};
use super::mesh::MeshTable;
use super::pitch::TimeTable;
use super::steady::{FlowTable, LoadReferenceTable, PatchTable, SteadyTable};
use crate::units::{Density, Frequency, Length};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A case of marching in time.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MarchFile {
    /// Free stream: `speed` and `density` are needed; a search starts at this density.
    pub flow: FlowTable,
    /// The grid, where every generalized coordinate is zero.
    pub mesh: MeshTable,
    /// What force coefficients are made with.
    pub reference: LoadReferenceTable,
    /// Modes of the structure.
    pub modes: ModesTable,
    /// The march.
    #[serde(default)]
    pub march: MarchTable,
    /// Search of the flutter point; without it there is one run at the density of `[flow]`.
    pub search: Option<SearchTable>,
    /// Reference quantities of the flutter speed index.
    pub speed_index: Option<ReferenceTable>,
    /// The steady flow that the march starts from.
    #[serde(default)]
    pub steady: SteadyTable,
    /// How a time step is solved.
    #[serde(default)]
    pub time: TimeTable,
    /// Values of in- and outflow patches, by the patch's name.
    #[serde(default)]
    pub patch: BTreeMap<String, PatchTable>,
}

/// The march.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MarchTable {
    /// Frequency whose period is divided into `steps_per_cycle` steps; one and a half times that of the first mode if left out.
    pub frequency: Option<Frequency>,
    /// Time steps in a period of `frequency`; 40 if left out.
    pub steps_per_cycle: Option<usize>,
    /// Periods of `frequency` after which a run ends in any case; 8 if left out.
    pub cycles: Option<usize>,
    /// Mode that is given an initial velocity, from 1; the first if left out.
    pub start_mode: Option<usize>,
    /// The displacement that this velocity would make without air; a thousandth of the semispan (or of twice the reference chord) if left out.
    pub start_displacement: Option<Length>,
    /// Viscous damping of each mode as a fraction of critical; none if left out.
    pub damping: Option<f64>,
    /// How flow and structure exchange forces and motion.
    #[serde(default)]
    pub coupling: CouplingKind,
    /// How the structure is marched.
    #[serde(default)]
    pub scheme: StructureScheme,
    /// Go on for all cycles, even when the damping is known.
    #[serde(default)]
    pub all_cycles: bool,
}

/// How flow and structure exchange forces and motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CouplingKind {
    /// In every pseudo step: both sit at the same time level.
    #[default]
    Tight,
    /// Once a time step: first order in time, to compare with.
    Loose,
}

/// How the structure is marched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StructureScheme {
    /// Exact for forces that are linear in time over the step.
    #[default]
    StateTransition,
    /// Two-stage Runge-Kutta, done again in every exchange.
    RungeKutta,
    /// Newmark's trapezoidal rule.
    Newmark,
}

/// Search of the flutter point: the density at which the least stable mode has no damping, at fixed Mach number and speed.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SearchTable {
    /// Smallest density; a fifth of that of `[flow]` if left out.
    pub from: Option<Density>,
    /// Largest density; five times that of `[flow]` if left out.
    pub to: Option<Density>,
    /// Relative standard error of the density at which the search ends; 0.01 (half a per cent in speed) if left out.
    pub tolerance: Option<f64>,
    /// Runs at most; 8 if left out.
    pub runs: Option<usize>,
}
