//! From the files a recipe names to geometry.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::file::{SectionSource, WingSource};
use super::quantity::{Angle, Length};
use super::{RecipeError, source};
use crate::geometry::{Section, Station, TipShape, TrailingEdge, Wing, read_ordinates};

/// `wing.toml`, the file that lattice and structure read too.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct WingFile {
    #[serde(rename = "name")]
    _name: String,
    section: Vec<SectionTable>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SectionTable {
    leading_edge: [Length; 3],
    chord: Length,
    twist: Option<Angle>,
    airfoil: Option<PathBuf>,
}

fn ordinates(path: &Path, nose_radius: Option<f64>) -> Result<Section, RecipeError> {
    let text = source::text(path)?;
    read_ordinates(&path.to_string_lossy(), &text, nose_radius).map_err(|source| RecipeError::Geometry {
        path: path.to_owned(),
        source,
    })
}

fn trailing_edge(path: &Path, name: Option<&str>, default: TrailingEdge) -> Result<TrailingEdge, RecipeError> {
    match name {
        None => Ok(default),
        Some("blunt") => Ok(TrailingEdge::Blunt),
        Some("closed") => Ok(TrailingEdge::Closed),
        Some("sharp") => Ok(TrailingEdge::Sharp),
        Some(other) => Err(RecipeError::Key {
            path: path.to_owned(),
            message: format!("trailing_edge: blunt, closed or sharp is needed, got \"{other}\""),
        }),
    }
}

/// The section of a two-dimensional recipe.
pub(super) fn section(recipe: &Path, from: &SectionSource) -> Result<Section, RecipeError> {
    let geometry = |source| RecipeError::Geometry {
        path: recipe.to_owned(),
        source,
    };
    let section = match (&from.naca, &from.file) {
        (Some(digits), None) => Section::naca4(digits).map_err(geometry)?,
        (None, Some(file)) => ordinates(file, from.nose_radius)?,
        _ => {
            let message = "section: either naca or file is needed".to_owned();
            return Err(RecipeError::Key {
                path: recipe.to_owned(),
                message,
            });
        }
    };
    let treatment = trailing_edge(recipe, from.trailing_edge.as_deref(), TrailingEdge::Blunt)?;
    section.with_trailing_edge(treatment).map_err(geometry)
}

/// The wing of a three-dimensional recipe.
pub(super) fn wing(recipe: &Path, from: &WingSource) -> Result<Wing, RecipeError> {
    let geometry = |source| RecipeError::Geometry {
        path: recipe.to_owned(),
        source,
    };
    let key = |path: &Path, message: String| RecipeError::Key {
        path: path.to_owned(),
        message,
    };
    let Some(path) = &from.file else {
        return Err(key(recipe, "wing.file is needed".into()));
    };
    let file: WingFile = source::parse(path, &source::text(path)?)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let treatment = trailing_edge(recipe, from.trailing_edge.as_deref(), TrailingEdge::Closed)?;
    let mut stations = Vec::new();
    for (n, table) in file.section.iter().enumerate() {
        let Some(airfoil) = &table.airfoil else {
            return Err(key(
                path,
                format!("section {}: a grid needs an airfoil file here", n + 1),
            ));
        };
        let section = ordinates(&folder.join(airfoil), from.nose_radius)?
            .with_trailing_edge(treatment)
            .map_err(geometry)?;
        let [x_le, y, z_le] = table.leading_edge.map(|l| l.0);
        let twist_deg = table.twist.map_or(0.0, |a| a.0.to_degrees());
        stations.push(Station {
            y,
            x_le,
            z_le,
            chord: table.chord.0,
            twist_deg,
            section,
        });
    }
    let tip = match from.tip.as_deref() {
        None | Some("rounded") => TipShape::Rounded,
        Some("tapered") => TipShape::Tapered,
        Some(other) => {
            return Err(key(
                recipe,
                format!("wing.tip: rounded or tapered is needed, got \"{other}\""),
            ));
        }
    };
    let thickest = |s: &Station| {
        s.chord
            * (0..=200)
                .map(|n| s.section.mean_and_half(f64::from(n) / 200.0)[1])
                .fold(0.0, f64::max)
    };
    let tip_length = from
        .tip_length
        .map_or_else(|| stations.last().map_or(0.0, thickest), |l| l.0);
    let wing = Wing {
        stations,
        tip,
        tip_length,
    };
    wing.check().map_err(geometry)?;
    Ok(wing)
}
