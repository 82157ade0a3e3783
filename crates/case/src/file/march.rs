//! `march.toml`: flow and structure marched together, once or until the flutter point is found.

use super::flutter::{ModesTable, ReferenceTable};
use super::mesh::MeshTable;
use super::pitch::{Amount, TimeTable};
use super::steady::{FlowTable, LoadReferenceTable, PatchTable, SteadyTable};
use crate::units::{Frequency, Length};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A case of marching in time.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MarchFile {
    /// Free stream: `speed` and `density` are needed, and a search starts there; in a search of the altitude they follow from it.
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
    /// Search of the flutter point; without it there is one run at the stream of `[flow]`.
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
    /// Mode that is given an initial velocity, from 1, or `"all"` for a pulse that gives every mode the same energy; the first if left out.
    pub start_mode: Option<StartMode>,
    /// The displacement that this velocity would make without air; a thousandth of the semispan (or of twice the reference chord) if left out.
    pub start_displacement: Option<Length>,
    /// Viscous damping of the modes as a fraction of critical: one number for all, or a list with one for each; none if left out.
    /// A structural damping g is g/2 here.
    pub damping: Option<ModalDamping>,
    /// Which components of the modes move the wall.
    #[serde(default)]
    pub displacement: WallDisplacement,
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

/// What the initial velocity is given to.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "needed the number of a mode, from 1, or \"all\"")]
pub enum StartMode {
    /// One mode, from 1.
    One(usize),
    /// By a word.
    Word(StartWord),
}

/// Words for what the initial velocity is given to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StartWord {
    /// A pulse in all modes.
    All,
}

/// Damping of the modes.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "needed a number, or a list with one for each mode")]
pub enum ModalDamping {
    /// The same in all modes.
    Same(f64),
    /// One value for each mode.
    Each(Vec<f64>),
}

/// Which components of the modes move the wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WallDisplacement {
    /// All: sections turn as rigid bodies do.
    #[default]
    All,
    /// Along z only, as codes have it that take one deflection for each point; to compare with those.
    Z,
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
    /// Generalized-alpha: as Newmark's rule, with damping of modes that the step does not resolve (down to 0.8 a step).
    GeneralizedAlpha,
}

/// Search of the flutter point: the density, speed or altitude at which the least stable mode has no damping, at fixed Mach number.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SearchTable {
    /// What is varied.
    #[serde(default)]
    pub parameter: SearchParameter,
    /// First value; that of `[flow]` if left out (of the altitude: where standard air has the density of `[flow]`).
    pub first: Option<Amount>,
    /// Smallest value, such as `"0.05 kg/m^3"`, `"150 m/s"` or `"2 km"`; a fifth of the first density (or dynamic pressure) if left out.
    pub from: Option<Amount>,
    /// Largest value; five times the first density (or dynamic pressure) if left out.
    pub to: Option<Amount>,
    /// Relative standard error of the density (or speed) at which the search ends; 0.01 if left out.
    pub tolerance: Option<f64>,
    /// Runs at most; 8 if left out.
    pub runs: Option<usize>,
}

/// What a search varies at fixed Mach number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SearchParameter {
    /// The density, at the speed of `[flow]`, as in a tunnel.
    #[default]
    Density,
    /// The speed, at the density of `[flow]`; the sound speed follows from the Mach number.
    Speed,
    /// The altitude in the standard atmosphere, which gives density and, by the Mach number, speed: a matched point.
    Altitude,
}
