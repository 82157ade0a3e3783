//! From recipes to grids, with the hash by which results name the grid they were made on.

use crate::exit::Stop;
use dip_case::Document;
use dip_case::file::MeshTable;
use dip_grid::recipe::{self, RecipeError};
use dip_grid::split;
use dip_grid::topology::{MultiBlock, Side};
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

impl Loaded {
    fn new(grid: MultiBlock) -> Self {
        let hash = hash(&grid);
        Self { grid, hash }
    }
}

/// The grid of a file that a user names.
///
/// # Errors
/// What is wrong in the file, with its line where it has one.
pub fn read(path: &Path) -> Result<Loaded, Stop> {
    Ok(Loaded::new(make(path)?))
}

/// The grid that `[mesh]` of a case names.
///
/// # Errors
/// What is wrong in the table or in the file that it names.
pub fn from_case(document: &Document, table: &MeshTable) -> Result<Loaded, Stop> {
    let path = document.path(&table.recipe);
    if !path.exists() {
        let message = format!("no recipe at {}", path.display());
        let help = "paths are relative to the file that names them";
        return Err(document.error("mesh.recipe", message, help).into());
    }
    let mut grid = make(&path)?;
    if let Some(blocks) = table.blocks {
        if blocks < grid.blocks.len() || blocks > 4096 {
            let message = format!("{blocks} blocks: needed {} to 4096", grid.blocks.len());
            let help = "the grid has that many blocks before it is split";
            return Err(document.error("mesh.blocks", message, help).into());
        }
        split::split_into(&mut grid, blocks);
    }
    Ok(Loaded::new(grid))
}

fn make(path: &Path) -> Result<MultiBlock, Stop> {
    recipe::make(path).map_err(|error| {
        let help = match &error {
            RecipeError::Read { .. } => "check the path: paths inside a file are relative to that file",
            RecipeError::Syntax { .. } | RecipeError::Key { .. } => "see docs/grids.md for the keys of a recipe",
            RecipeError::Geometry { .. } => "check the ordinates and the wing's stations",
            RecipeError::Generate { .. } => "change the number of cells or the spacing that the message names",
            RecipeError::Coarsen { .. } => "every level needs an even number of cells in every direction",
        };
        Stop::input(error.to_string(), help)
    })
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
            i.translation
        ));
    }
    for p in &grid.topology.patches {
        sum.update(format!("{} {} {};", p.name, p.condition, side(&p.side())));
    }
    sum.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::hash;
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
}
