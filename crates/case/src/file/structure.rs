//! `structure.toml`: plate model of a wing.

use crate::units::{Angle, Density, Inertia, Length, Mass, Pressure, RotationalStiffness, Stiffness};
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::PathBuf;

/// A structure made of plate elements on the wing's mean surface.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StructureFile {
    /// The wing file.
    pub wing: PathBuf,
    /// Mesh of plate elements.
    pub plate: PlateTable,
    /// Material of the plate.
    pub material: MaterialTable,
    /// How the wing is held.
    #[serde(default)]
    pub support: SupportTable,
    /// Concentrated masses.
    #[serde(default)]
    pub mass: Vec<MassTable>,
    /// Springs to ground.
    #[serde(default)]
    pub spring: Vec<SpringTable>,
    /// The modes to compute.
    pub modes: StructureModes,
}

/// Mesh of plate elements.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlateTable {
    /// Nodes along the chord.
    pub nodes_chordwise: usize,
    /// Nodes along the span.
    pub nodes_spanwise: usize,
    /// How the thickness of an element comes from the section's ordinates; not needed with `constant_thickness`.
    pub thickness: Option<ThicknessRule>,
    /// One thickness everywhere, instead of the section's.
    pub constant_thickness: Option<Length>,
    /// No thickness below this; for sections that close to nothing at their edges.
    pub minimum_thickness: Option<Length>,
    /// Consistent or lumped mass, or the mean of both.
    #[serde(default)]
    pub mass: MassModel,
}

/// How the thickness of an element comes from the section's ordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ThicknessRule {
    /// The thickness varies inside the element as interpolated from its nodes.
    Nodal,
    /// One thickness for each element: the mean of its nodes.
    ElementMean,
    /// The section's own thickness at every integration point.
    ExactSection,
}

/// Mass matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MassModel {
    /// From the shape functions.
    #[default]
    Consistent,
    /// Gathered at the nodes.
    Lumped,
    /// The mean of both: their leading errors cancel on regular meshes.
    Mean,
}

/// An orthotropic material; leave out `e2`, `g12` for an isotropic one.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialTable {
    /// Young's modulus along the 1-axis.
    pub e1: Pressure,
    /// Young's modulus across it; as `e1` if left out.
    pub e2: Option<Pressure>,
    /// Shear modulus in the plane; isotropic if left out.
    pub g12: Option<Pressure>,
    /// Poisson's ratio: strain along 2 for stress along 1.
    pub nu12: f64,
    /// Density.
    pub density: Density,
    /// Angle of the 1-axis from the y axis towards x: the sweep of the fibres.
    pub axis_sweep: Option<Angle>,
    /// Transverse shear modulus; a thin plate, rigid in transverse shear, if left out.
    pub g_transverse: Option<Pressure>,
}

/// How the wing is held.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportTable {
    /// `"clamped"` holds all root nodes, `"free"` none; or a list of chordwise root node numbers, from 1.
    #[serde(default)]
    pub root: Clamp,
}

/// Which root nodes are held.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "\"clamped\", \"free\" or a list of root node numbers")]
pub enum Clamp {
    /// All, or none.
    Spec(ClampSpec),
    /// Chordwise node numbers from 1 at the leading edge.
    Nodes(Vec<usize>),
}

impl Default for Clamp {
    fn default() -> Self {
        Self::Spec(ClampSpec::Clamped)
    }
}

/// `"clamped"` or `"free"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ClampSpec {
    /// All root nodes are held.
    Clamped,
    /// None is.
    Free,
}

/// A concentrated mass, tied to the nearest node.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MassTable {
    /// Where it is; the offset from its node counts.
    pub position: [Length; 3],
    /// Its mass.
    pub mass: Mass,
    /// Moments of inertia about its own centre, about x, y, z; none if left out.
    pub inertia: Option<[Inertia; 3]>,
}

/// A spring to ground at the nearest node.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpringTable {
    /// Where it is.
    pub position: [Length; 3],
    /// Stiffness against z displacement.
    pub vertical: Option<Stiffness>,
    /// Stiffness against rotation about x.
    pub roll: Option<RotationalStiffness>,
    /// Stiffness against rotation about y.
    pub pitch: Option<RotationalStiffness>,
}

/// The modes to compute.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StructureModes {
    /// How many, from the lowest frequency.
    pub count: usize,
    /// How the shapes in the output are normalized; solutions use mass normalization.
    #[serde(default)]
    pub normalization: Normalization,
}

/// Normalization of mode shapes in the output.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Normalization {
    /// Generalized mass 1 kg.
    #[default]
    Mass,
    /// Largest displacement 1 m.
    Max,
}
