//! From recipes and grid files to grids, with the hash by which results name the grid they were made on.

use crate::exit::Stop;
use dip_case::Document;
use dip_case::file::MeshTable;
use dip_grid::Period;
use dip_grid::cgns::CgnsError;
use dip_grid::file::{self, FileError};
use dip_grid::recipe::RecipeError;
use dip_grid::topology::{Interface, MultiBlock, Side};
use dip_grid::{quality, split};
use sha2::{Digest, Sha256};
use std::path::Path;

/// A grid in metres and its hash.
#[derive(Debug)]
pub struct Loaded {
    /// The grid.
    pub grid: MultiBlock,
    /// SHA-256 over nodes and topology, hexadecimal.
    pub hash: String,
}

/// The grid of a recipe or grid file that a user names, as it stands there. Says on stderr what was done to it.
///
/// # Errors
/// What is wrong in the file, with its line where it has one.
pub fn read(path: &Path, boundary_conditions: Option<&Path>) -> Result<Loaded, Stop> {
    let grid = open(path, boundary_conditions)?;
    Ok(Loaded {
        hash: hash(&grid),
        grid,
    })
}

/// The grid that `[mesh]` of a case names.
///
/// # Errors
/// What is wrong in the table or in the files that it names.
pub fn from_case(document: &Document, table: &MeshTable) -> Result<Loaded, Stop> {
    let (key, named) = match (&table.recipe, &table.file) {
        (Some(recipe), None) => ("mesh.recipe", recipe),
        (None, Some(file)) => ("mesh.file", file),
        (both, _) => {
            let message = if both.is_some() {
                "both recipe and file"
            } else {
                "neither recipe nor file"
            };
            return Err(document.error("mesh", message, "give one of them").into());
        }
    };
    if table.recipe.is_some() && table.boundary_conditions.is_some() {
        let message = "boundary_conditions goes with file; a recipe's grid has its conditions";
        return Err(document
            .error("mesh.boundary_conditions", message, "leave it out")
            .into());
    }
    let is_recipe = named.extension().is_some_and(|e| e == "toml");
    if is_recipe != table.recipe.is_some() {
        let message = format!("{} is {} recipe", named.display(), if is_recipe { "a" } else { "no" });
        let help = "recipe = \"....toml\" makes a grid, file = \"....xyz\" reads one";
        return Err(document.error(key, message, help).into());
    }
    let exists = |key: &str, path: &Path| {
        if path.is_file() {
            return Ok(());
        }
        let message = format!("no file at {}", path.display());
        Err(document.error(key, message, "paths are relative to the file that names them"))
    };
    let path = document.path(named);
    exists(key, &path)?;
    let conditions = table.boundary_conditions.as_ref().map(|p| document.path(p));
    if let Some(p) = &conditions {
        exists("mesh.boundary_conditions", p)?;
    }
    let mut grid = open(&path, conditions.as_deref())?;
    if let Some(first) = quality::misfits(&grid).first() {
        let help =
            "look at the grid by `pmb mesh check`; conditions and interfaces stand in the .bc.toml or .nmf beside it";
        return Err(document.error(key, &first.text, help).into());
    }
    let turned = |i: &Interface| matches!(i.period, Some(Period::Rotation { .. }));
    if grid.topology.interfaces.iter().any(turned) {
        let message = "the grid is periodic by rotation, and the flow solver knows shifts only";
        let help = "take a grid of the whole body, or symmetry planes on the two sides of the wedge";
        return Err(document.error(key, message, help).into());
    }
    if let Some(unit) = table.length_unit {
        if unit.0 <= 0.0 {
            let message = format!("{} m: needed a positive length", unit.0);
            return Err(document
                .error(
                    "mesh.length_unit",
                    message,
                    "length_unit = \"1 in\" for a grid in inches",
                )
                .into());
        }
        scale(&mut grid, unit.0);
    }
    let given = grid.blocks.len();
    for (block, face, axis, at) in split::part_at_own_cuts(&mut grid) {
        tracing::info!(
            "block {block} meets itself across {face}: cut in two at {} = {at}, which the flow solver is quicker with",
            ["i", "j", "k"][axis]
        );
    }
    if let Some(blocks) = table.blocks {
        if blocks < given || blocks > 4096 {
            let message = format!("{blocks} blocks: needed {given} to 4096");
            let help = "the grid has that many blocks before it is split";
            return Err(document.error("mesh.blocks", message, help).into());
        }
        split::split_into(&mut grid, blocks);
    }
    Ok(Loaded {
        hash: hash(&grid),
        grid,
    })
}

fn scale(grid: &mut MultiBlock, unit_m: f64) {
    for block in &mut grid.blocks {
        for coordinate in [&mut block.x, &mut block.y, &mut block.z] {
            for value in coordinate {
                *value *= unit_m;
            }
        }
    }
    for interface in &mut grid.topology.interfaces {
        interface.period = interface.period.map(|p| p.scaled(unit_m));
    }
}

fn open(path: &Path, boundary_conditions: Option<&Path>) -> Result<MultiBlock, Stop> {
    let opened = file::open(path, boundary_conditions).map_err(|e| explain(&e))?;
    for note in &opened.notes {
        tracing::info!("{note}");
    }
    Ok(opened.grid)
}

/// An error of the grid's files with what to do next: bad input, or a failure where the disk is to blame.
pub fn explain(error: &FileError) -> Stop {
    let help = match error {
        FileError::Recipe(RecipeError::Read { .. }) => "check the path: paths inside a file are relative to that file",
        FileError::Recipe(RecipeError::Syntax { .. } | RecipeError::Key { .. }) => {
            "see docs/grids.md for the keys of a recipe"
        }
        FileError::Recipe(RecipeError::Geometry { .. }) => "check the ordinates and the wing's stations",
        FileError::Recipe(RecipeError::Generate { .. }) => {
            "change the number of cells or the spacing that the message names"
        }
        FileError::Recipe(RecipeError::Coarsen { .. }) => {
            "every level needs an even number of cells in every direction"
        }
        FileError::Plot3d(_) => "needed a recipe (.toml), a Plot3D or a CGNS (.cgns) grid file",
        FileError::Cgns(CgnsError::NotBuilt { .. }) => {
            "`pmb mesh convert` of a program built with CGNS makes Plot3D of it"
        }
        FileError::Cgns(_) => "needed structured zones in HDF5, as `cgnscheck` accepts them",
        FileError::Boundary(_) | FileError::Nmf(_) => "see docs/grids.md for files of boundary conditions",
        FileError::Io { .. } => "check the path, the disk's space and the folder's rights",
    };
    Stop::input(error.to_string(), help)
}

fn hash(grid: &MultiBlock) -> String {
    let mut sum = Sha256::new();
    for block in &grid.blocks {
        sum.update(block.name.as_bytes());
        for n in block.cells() {
            sum.update((n as u64).to_le_bytes());
        }
        for coordinate in [&block.x, &block.y, &block.z] {
            for value in coordinate {
                sum.update(value.to_le_bytes());
            }
        }
    }
    let side = |s: &Side| format!("{} {} {:?} {:?}", s.block, s.face.name(), s.window.lo, s.window.hi);
    for i in &grid.topology.interfaces {
        sum.update(format!(
            "{} {} {:?} {:?};",
            side(&i.a),
            side(&i.b),
            i.orientation,
            i.period
        ));
    }
    for p in &grid.topology.patches {
        sum.update(format!("{} {} {};", p.name, p.condition, side(&p.side())));
    }
    sum.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::{hash, scale};
    use dip_grid::generate::box_grid;

    #[test]
    fn hash_sees_nodes_and_conditions() {
        let grid = box_grid([0.0; 3], [1.0; 3], [2, 2, 2]);
        assert_eq!(hash(&grid), hash(&grid.clone()));
        let mut moved = grid.clone();
        moved.blocks[0].set_point([1, 1, 1], [0.5, 0.5, 0.5 + 1e-12]);
        assert_ne!(hash(&grid), hash(&moved));
        let mut renamed = grid.clone();
        renamed.topology.patches[0].name = "other".into();
        assert_ne!(hash(&grid), hash(&renamed));
    }
    #[test]
    fn a_scaled_grid_is_the_same_shape() {
        let mut inches = box_grid([0.0; 3], [1.0; 3], [2, 2, 2]);
        scale(&mut inches, 0.0254);
        assert_eq!(inches.bounds(), [[0.0; 3], [0.0254; 3]]);
    }
}
