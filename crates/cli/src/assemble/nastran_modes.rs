//! Modes that Nastran has computed: shapes from f06, punch or op2, nodes from the deck.

use crate::exit::Stop;
use dip_case::Document;
use dip_case::file::ModesTable;
use dip_deck::coordinate::Geometry;
use dip_deck::modes::modes_of_file;
use dip_modal::Modes;
use dip_nastran::{Deck, modes::read_modes};
use std::path::Path;

/// Reads a mode file and puts its points where the deck has them.
///
/// # Errors
/// Files that can't be read, points that the deck does not have, modes without generalized mass.
pub fn read(document: &Document, keys: &ModesTable, path: &Path) -> Result<Modes, Stop> {
    let wrong =
        |key: &str, message: String, help: &str| Stop::from(document.error(&format!("modes.{key}"), message, help));
    let table = read_modes(path).map_err(|e| {
        wrong(
            "file",
            format!("{}: {e}", path.display()),
            "needed modes printed for all points (f06, punch, op2)",
        )
    })?;
    let Some(geometry) = &keys.geometry else {
        let help = "add geometry = \"deck.bdf\": the deck that has the GRIDs of these modes";
        return Err(wrong("file", "a mode file of Nastran needs its nodes".to_owned(), help));
    };
    let deck = Deck::read(document.path(geometry)).map_err(|e| wrong("geometry", e.to_string(), "correct the deck"))?;
    let frames = Geometry::new(&deck.bulk).map_err(|e| wrong("geometry", e.to_string(), "correct the deck"))?;
    let unit = keys.length_unit.map_or(1.0, |l| l.0);
    let mass_unit = keys.mass_unit.map_or(1.0, |m| m.0);
    if unit <= 0.0 || mass_unit <= 0.0 {
        return Err(wrong(
            "length_unit",
            "a unit that is not positive".to_owned(),
            "as in \"1 in\" and \"175.127 kg\"",
        ));
    }
    let mut modes = modes_of_file(&deck.bulk, &frames, &table)
        .map_err(|e| wrong("geometry", e.to_string(), "give the deck that made this mode file"))?;
    // Scalar points have no place and move no boxes.
    let placed: Vec<usize> = (0..modes.nodes.len())
        .filter(|n| frames.grid(modes.nodes[*n].id).is_some())
        .collect();
    if placed.is_empty() {
        return Err(wrong(
            "geometry",
            "the modes have no grid points".to_owned(),
            "print the modes of the structure's GRIDs",
        ));
    }
    modes.nodes = placed.iter().map(|n| modes.nodes[*n].clone()).collect();
    for node in &mut modes.nodes {
        node.position *= unit;
    }
    for shape in &mut modes.shapes {
        // Displacements stay per unit of the generalized coordinate; rotations turn from per deck's length to per metre.
        *shape = placed.iter().map(|n| rescale(shape[*n], unit)).collect();
    }
    let given = keys.generalized_masses.as_deref().unwrap_or_default();
    for (m, mass) in modes.generalized_mass.iter_mut().enumerate() {
        *mass = given.get(m).map_or(*mass * mass_unit, |g| g.0);
        if mass.is_nan() || *mass <= 0.0 {
            let help = "add generalized_masses = [\"1 kg\", ...] (1 each for modes normalized to mass)";
            return Err(wrong(
                "file",
                format!("generalized mass {mass} of mode {}", m + 1),
                help,
            ));
        }
    }
    Ok(modes)
}

/// Displacements as they stand (per unit of the generalized coordinate), rotations in radians per metre.
fn rescale(shape: [f64; 6], unit: f64) -> [f64; 6] {
    let [x, y, z, rx, ry, rz] = shape;
    [x, y, z, rx / unit, ry / unit, rz / unit]
}
