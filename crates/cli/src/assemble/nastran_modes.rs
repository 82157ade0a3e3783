//! Modes that Nastran has computed: shapes from f06, punch or op2, nodes from the deck.

use crate::exit::Stop;
use dip_case::Document;
use dip_case::file::ModesTable;
use dip_deck::coordinate::Geometry;
use dip_modal::{ModeNode, Modes};
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
    // Scalar points of the file have no place and move nothing.
    let placed: Vec<(usize, ModeNode)> = table
        .points
        .iter()
        .enumerate()
        .filter_map(|(i, id)| {
            let at = frames.grid(*id)?;
            let cd = deck.bulk.grids.get(id).map_or(0, |g| g.cd);
            let frame = frames.frame(cd).map(|f| f.directions(at))?;
            Some((
                i,
                ModeNode {
                    id: *id,
                    position: at * unit,
                    frame,
                },
            ))
        })
        .collect();
    if placed.is_empty() {
        let message = format!(
            "none of the {} points of the modes is a GRID of the deck",
            table.points.len()
        );
        return Err(wrong("geometry", message, "give the deck that made this mode file"));
    }
    let mut modes = Modes {
        nodes: placed.iter().map(|(_, n)| n.clone()).collect(),
        shapes: Vec::new(),
        omega_rad_s: Vec::new(),
        generalized_mass: Vec::new(),
        residual: Vec::new(),
    };
    for (m, shape) in table.shapes.iter().enumerate() {
        let Some(value) = table.eigenvalues.get(m) else {
            return Err(wrong(
                "file",
                format!("mode {} has no eigenvalue in the file", m + 1),
                "print the table of eigenvalues too",
            ));
        };
        let given = keys
            .generalized_masses
            .as_ref()
            .and_then(|list| list.get(m))
            .map(|g| g.0);
        let Some(mass) = given.or(value.generalized_mass.map(|g| g * mass_unit)) else {
            let help = "add generalized_masses = [\"1 kg\", ...] (1 each for modes normalized to mass)";
            return Err(wrong(
                "file",
                format!("the file has no generalized mass for mode {}", m + 1),
                help,
            ));
        };
        // Rotations are per the deck's unit of displacement: per metre they are smaller by the unit.
        modes
            .shapes
            .push(placed.iter().map(|(i, _)| rescale(shape[*i], unit)).collect());
        modes.omega_rad_s.push(value.freq_hz * std::f64::consts::TAU);
        modes.generalized_mass.push(mass);
    }
    Ok(modes)
}

/// Displacements as they stand (per unit of the generalized coordinate), rotations in radians per metre.
fn rescale(shape: [f64; 6], unit: f64) -> [f64; 6] {
    let [x, y, z, rx, ry, rz] = shape;
    [x, y, z, rx / unit, ry / unit, rz / unit]
}
