//! The keys of a recipe.

use std::path::PathBuf;

use serde::Deserialize;

use super::quantity::{Angle, Length};

/// A recipe. Lengths are metres; plain numbers are SI.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Another recipe whose keys hold where this one says nothing.
    pub extends: Option<PathBuf>,
    /// Title.
    pub name: Option<String>,
    /// What to make.
    pub kind: Option<Kind>,
    /// Keep every second point of what the other keys say, this many times.
    pub coarsen: Option<u32>,
    /// Split into this many blocks.
    pub blocks: Option<usize>,
    /// Aerofoil of a two-dimensional grid.
    pub section: Option<SectionSource>,
    /// Wing of a three-dimensional grid.
    pub wing: Option<WingSource>,
    /// Plate, bump, ramp or box.
    pub shape: Option<Shape>,
    /// Numbers of cells.
    #[serde(default)]
    pub cells: Cells,
    /// Steps.
    #[serde(default)]
    pub spacing: Spacing,
    /// How far the grid reaches.
    #[serde(default)]
    pub extent: Extent,
    /// Smoothing of the planes of C and O grids.
    pub smoothing: Option<SmoothingTable>,
    /// The file the recipe was read from.
    #[serde(skip)]
    pub path: PathBuf,
}

/// What a recipe makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// C grid round an aerofoil.
    AerofoilC,
    /// O grid round an aerofoil.
    AerofoilO,
    /// C-H grid round a half wing.
    WingCh,
    /// O-O grid round a half wing.
    WingOo,
    /// Flat plate with a symmetry line before it.
    FlatPlate,
    /// Bump in a channel's floor.
    Bump,
    /// Floor that turns up by an angle.
    Ramp,
    /// Box, plane or wavy inside.
    Box,
}

impl Kind {
    /// Name as in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::AerofoilC => "aerofoil-c",
            Self::AerofoilO => "aerofoil-o",
            Self::WingCh => "wing-ch",
            Self::WingOo => "wing-oo",
            Self::FlatPlate => "flat-plate",
            Self::Bump => "bump",
            Self::Ramp => "ramp",
            Self::Box => "box",
        }
    }
}

/// Where an aerofoil comes from: `naca` or `file`.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SectionSource {
    /// Four digits.
    pub naca: Option<String>,
    /// File of ordinates.
    pub file: Option<PathBuf>,
    /// Nose radius in chords, to be met exactly.
    pub nose_radius: Option<f64>,
    /// `blunt` (as it is), `closed` or `sharp`.
    pub trailing_edge: Option<String>,
    /// Chord; 1 m if left out.
    pub chord: Option<Length>,
}

/// A wing file and how it is treated.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WingSource {
    /// `wing.toml`: sections with leading edge, chord, twist, airfoil.
    pub file: Option<PathBuf>,
    /// Nose radius in chords of every section, to be met exactly.
    pub nose_radius: Option<f64>,
    /// `closed` or `sharp`.
    pub trailing_edge: Option<String>,
    /// `rounded` or `tapered`.
    pub tip: Option<String>,
    /// Span over which the tip closes; half the tip's thickness if left out.
    pub tip_length: Option<Length>,
    /// Sheet outboard of the tip in C-H grids: `straight` within a quarter of a chord, or the tip's `camber` line.
    pub sheet: Option<String>,
}

/// Plate, bump, ramp or box.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shape {
    /// Length of the wall (plate, bump, ramp).
    pub length: Option<Length>,
    /// Height of the bump.
    pub height: Option<Length>,
    /// Angle of the ramp.
    pub angle: Option<Angle>,
    /// Lower corner of a box.
    pub from: Option<[Length; 3]>,
    /// Upper corner of a box.
    pub to: Option<[Length; 3]>,
    /// Waves inside a box, as a fraction of its edges.
    pub waviness: Option<f64>,
    /// Directions in which a box is periodic.
    pub periodic: Option<[bool; 3]>,
}

/// Numbers of cells of the finest level.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cells {
    /// Along each surface of a section, or along the wall of a plate, bump or ramp.
    pub surface: Option<usize>,
    /// Along the wake.
    pub wake: Option<usize>,
    /// From wall to far field.
    pub normal: Option<usize>,
    /// Along the span of a wing.
    pub span: Option<usize>,
    /// From tip to far field.
    pub outboard: Option<usize>,
    /// Across a blunt base.
    pub base: Option<usize>,
    /// Before a plate, bump or ramp.
    pub upstream: Option<usize>,
    /// Behind a bump.
    pub downstream: Option<usize>,
    /// Of a box along x, y, z.
    pub r#box: Option<[usize; 3]>,
}

/// Steps of the finest level.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spacing {
    /// First step off the wall: a length.
    pub wall: Option<Length>,
    /// First step off the wall: a y+.
    pub y_plus: Option<YPlus>,
    /// Along the surface at the nose, in chords.
    pub nose: Option<f64>,
    /// Along the surface at the trailing edge, in chords.
    pub tail: Option<f64>,
    /// Along the span at the symmetry plane.
    pub root: Option<Length>,
    /// Along the span at the tip.
    pub tip: Option<Length>,
    /// Along a plate, bump or ramp at its ends.
    pub edge: Option<Length>,
    /// Growth of the first step along wake and tip sheet, per chord; 1 if left out.
    pub wake_growth: Option<f64>,
    /// Largest growth ratio from wall to far field; an error above it.
    pub growth_limit: Option<f64>,
}

/// A wall step from boundary-layer scales.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct YPlus {
    /// y+ of the first cell's height.
    pub value: f64,
    /// Reynolds number of `length`.
    pub reynolds: f64,
    /// Length of the Reynolds number.
    pub length: Length,
}

/// Smoothing by elliptic equations.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SmoothingTable {
    /// What it starts from; `map` if left out.
    #[serde(default)]
    pub start: SmoothingStart,
    /// At most so many sweeps; 200 if left out.
    pub sweeps: Option<usize>,
}

/// What smoothing starts from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SmoothingStart {
    /// The conformal map.
    #[default]
    Map,
    /// Transfinite interpolation.
    Transfinite,
}

/// How far the grid reaches.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Extent {
    /// Distance of the far field.
    pub far_field: Option<Length>,
    /// Distance from the leading edge (of the root) to the exit.
    pub exit: Option<Length>,
    /// Distance before a plate, bump or ramp.
    pub upstream: Option<Length>,
    /// Distance behind a bump.
    pub downstream: Option<Length>,
}
