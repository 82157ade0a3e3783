//! Opens grids from, and saves them to, files of any kind the crate knows.

use std::path::{Path, PathBuf};

use crate::boundary_file::{self, BoundaryError};
use crate::cgns::{self, CgnsError};
use crate::connect::{self, Options};
use crate::face::{Face, Window};
use crate::nmf::{self, NmfError};
use crate::plot3d::{self, Encoding, Layout, Plot3dError};
use crate::recipe::{self, RecipeError};
use crate::reorient::{reorient, turn_right_handed};
use crate::topology::{Condition, MultiBlock, Patch, Side, Topology};
use crate::{metrics::hexahedron_volume, vtk};

/// Why a file could not be opened or saved.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// A recipe.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// A Plot3D file.
    #[error(transparent)]
    Plot3d(#[from] Plot3dError),
    /// A CGNS file.
    #[error(transparent)]
    Cgns(#[from] CgnsError),
    /// A boundary file.
    #[error(transparent)]
    Boundary(#[from] BoundaryError),
    /// A neutral map file.
    #[error(transparent)]
    Nmf(#[from] NmfError),
    /// Reading or writing failed.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

/// A grid that was opened, and what was done to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Opened {
    /// The grid.
    pub grid: MultiBlock,
    /// What a user should know: layout, conditions from where, interfaces found, blocks turned.
    pub notes: Vec<String>,
}

/// Opens a recipe (`.toml`), a CGNS file (with the feature `cgns`) or a Plot3D file. Conditions come from `boundary` if given;
/// else those of a Plot3D file from the `.bc.toml` or `.nmf` beside it, and a CGNS file has its own. Interfaces that these do
/// not name are found by points. Left-handed blocks are turned.
/// # Errors
/// Whatever is wrong with one of the files.
pub fn open(path: &Path, boundary: Option<&Path>) -> Result<Opened, FileError> {
    if path.extension().is_some_and(|e| e == "toml") {
        return Ok(Opened {
            grid: recipe::make(path)?,
            notes: Vec::new(),
        });
    }
    let is_cgns = cgns::is_named_so(path);
    let (mut grid, mut notes, single) = if is_cgns { open_cgns(path)? } else { open_plot3d(path)? };
    let tolerance = single.then_some(2e-7);
    let mut periodic = Vec::new();
    let beside = || {
        [path.with_extension("bc.toml"), path.with_extension("nmf")]
            .into_iter()
            .find(|p| p.is_file())
    };
    let beside = || if is_cgns { None } else { beside() };
    if let Some(file) = boundary.map(Path::to_path_buf).or_else(beside) {
        let text = std::fs::read_to_string(&file).map_err(|source| FileError::Io {
            path: file.clone(),
            source,
        })?;
        let name = file.to_string_lossy();
        (grid.topology, periodic) = if file.extension().is_some_and(|e| e == "nmf") {
            (neutral_map(&name, &text, &mut grid)?, Vec::new())
        } else {
            boundary_file::parse_with_periods(&name, &text, &grid)?
        };
        notes.push(format!("conditions from {name}"));
    }
    lay_across(&mut grid, &mut notes);
    if periodic.is_empty() {
        close_sides(&mut grid, &mut notes);
    }
    let [lo, hi] = grid.bounds();
    let diagonal = crate::vector::distance(lo, hi);
    let options = Options {
        tolerance: tolerance.map(|t| t * diagonal),
        periodic,
    };
    let found = connect::find_interfaces(&mut grid, &options);
    if found.interfaces + found.collapsed > 0 || found.free > 0 {
        notes.push(found.to_string());
    }
    // Where periods are named, the two sides of a grid one cell across may be each other's.
    close_sides(&mut grid, &mut notes);
    for n in 0..grid.blocks.len() {
        let block = &grid.blocks[n];
        let negative = |cell: usize| {
            let [i, j, k] = block.cell_ijk(cell);
            hexahedron_volume(&block.corners(i, j, k)) < 0.0
        };
        let count = (0..block.cell_count()).filter(|&c| negative(c)).count();
        if 2 * count > block.cell_count() {
            notes.push(format!(
                "block {n} ({}) is left-handed: turned, k runs backwards now",
                block.name
            ));
            turn_right_handed(&mut grid, n);
        }
    }
    Ok(Opened { grid, notes })
}

/// Grid, notes, and whether it is in single precision.
type Raw = (MultiBlock, Vec<String>, bool);

fn open_plot3d(path: &Path) -> Result<Raw, FileError> {
    let read = plot3d::read(path)?;
    let mut notes = vec![describe(&read.layout, read.blocks.len())];
    notes.extend(overset(&read));
    let grid = MultiBlock {
        blocks: read.blocks,
        topology: Topology::default(),
    };
    Ok((grid, notes, !read.layout.double))
}

/// Holes and fringes of an overset grid (iblank of zero and below), which nothing here knows.
fn overset(read: &plot3d::Grid) -> Option<String> {
    let marked = |blank: &Option<Vec<i32>>| blank.iter().flatten().filter(|&&v| v <= 0).count();
    let (block, count) = read
        .iblank
        .iter()
        .map(marked)
        .enumerate()
        .find(|(_, count)| *count > 0)?;
    let all: usize = read.iblank.iter().map(marked).sum();
    Some(format!(
        "iblank marks {all} nodes as holes or as interpolated from other blocks (first in block {block}, {count} there): \
         overset grids are not understood, all cells are taken as cells of the flow"
    ))
}

#[cfg(feature = "cgns")]
fn open_cgns(path: &Path) -> Result<Raw, FileError> {
    let read = cgns::read(path)?;
    let topology = &read.grid.topology;
    let mut notes = vec![format!(
        "CGNS, {} zones, {} precision, {} interfaces, {} boundary patches",
        read.grid.blocks.len(),
        if read.single { "single" } else { "double" },
        topology.interfaces.len(),
        topology.patches.len()
    )];
    notes.extend(read.notes);
    Ok((read.grid, notes, read.single))
}

#[cfg(not(feature = "cgns"))]
fn open_cgns(path: &Path) -> Result<Raw, FileError> {
    Err(CgnsError::NotBuilt { path: path.to_owned() }.into())
}

#[cfg(feature = "cgns")]
fn save_cgns(path: &Path, grid: &MultiBlock) -> Result<(), FileError> {
    Ok(cgns::write(path, grid)?)
}

#[cfg(not(feature = "cgns"))]
fn save_cgns(path: &Path, _: &MultiBlock) -> Result<(), FileError> {
    Err(CgnsError::NotBuilt { path: path.to_owned() }.into())
}

/// The topology of a neutral map. One that has two nodes along i stands beside the three-dimensional form of a grid; of the
/// two-dimensional form it numbers the same nodes once the grid has i across, too.
fn neutral_map(name: &str, text: &str, grid: &mut MultiBlock) -> Result<Topology, NmfError> {
    let fault = match nmf::parse(name, text, grid) {
        Ok(topology) => return Ok(topology),
        Err(fault) => fault,
    };
    if axis_across(grid) == Some(2) {
        let mut turned = grid.clone();
        for n in 0..turned.blocks.len() {
            reorient(&mut turned, n, [2, 0, 1], [false; 3]);
        }
        if let Ok(topology) = nmf::parse(name, text, &turned) {
            *grid = turned;
            return Ok(topology);
        }
    }
    Err(fault)
}

/// Axis along which every block is one cell thick, k before i before j.
fn axis_across(grid: &MultiBlock) -> Option<usize> {
    let across = |axis: usize| grid.blocks.iter().all(|b| b.cells()[axis] == 1 && b.cell_count() > 1);
    [2, 0, 1].into_iter().find(|&axis| across(axis))
}

/// Grids one cell across: the crate's own have k across. Others (CFL3D has i) are renumbered.
fn lay_across(grid: &mut MultiBlock, notes: &mut Vec<String>) {
    let Some(axis) = axis_across(grid) else {
        return;
    };
    if axis != 2 {
        for n in 0..grid.blocks.len() {
            reorient(grid, n, [(axis + 1) % 3, (axis + 2) % 3, axis], [false; 3]);
        }
        notes.push(format!(
            "one cell across along {}: renumbered so that k is across",
            ['i', 'j', 'k'][axis]
        ));
    }
}

/// Sides of a grid one cell across that nothing names become symmetry planes.
fn close_sides(grid: &mut MultiBlock, notes: &mut Vec<String>) {
    if axis_across(grid) != Some(2) {
        return;
    }
    let mut added = 0;
    for n in 0..grid.blocks.len() {
        for (face, name) in [(Face::KMin, "left"), (Face::KMax, "right")] {
            let on = |side: Side| side.block == n && side.face == face;
            let named = grid.topology.patches.iter().any(|p| on(p.side()))
                || grid.topology.interfaces.iter().any(|i| on(i.a) || on(i.b));
            if !named {
                let window = Window::full(grid.blocks[n].face_cells(face));
                let condition = Condition::Symmetry;
                grid.topology.patches.push(Patch {
                    name: name.into(),
                    block: n,
                    face,
                    window,
                    condition,
                });
                added += 1;
            }
        }
    }
    if added > 0 {
        notes.push(format!(
            "{added} sides of a grid one cell across had no condition: symmetry"
        ));
    }
}

fn describe(layout: &Layout, blocks: usize) -> String {
    let encoding = match layout.encoding {
        Encoding::Ascii => "text".to_owned(),
        Encoding::Stream { big_endian } => {
            format!("stream binary, {} endian", if big_endian { "big" } else { "little" })
        }
        Encoding::Records { big_endian, marker } => {
            format!(
                "Fortran records, {} endian, {marker}-byte markers",
                if big_endian { "big" } else { "little" }
            )
        }
    };
    format!(
        "Plot3D, {blocks} blocks, {}: {encoding}, {} precision, {} block count, {} iblank",
        if layout.three_d { "3-D" } else { "2-D" },
        if layout.double { "double" } else { "single" },
        if layout.multi { "with" } else { "without" },
        if layout.iblank { "with" } else { "without" }
    )
}

/// Saves a grid: `.vtm` for ParaView; `.cgns` (with the feature `cgns`) with everything in one file; else Plot3D in `layout` with a `.bc.toml` beside it, and a `.nmf` too. Notes say what
/// the formats cannot hold.
/// # Errors
/// If a file cannot be written.
pub fn save(path: &Path, grid: &MultiBlock, layout: Layout) -> Result<Vec<String>, FileError> {
    let io = |path: &Path| {
        let path = path.to_owned();
        move |source| FileError::Io { path, source }
    };
    if path.extension().is_some_and(|e| e == "vtm") {
        vtk::write(path, grid, &[]).map_err(io(path))?;
        return Ok(Vec::new());
    }
    if cgns::is_named_so(path) {
        save_cgns(path, grid)?;
        return Ok(cgns::left_out(grid)
            .map(|n| {
                format!("{n} periodic interfaces turn about an axis that CGNS cannot name and are not in the file")
            })
            .into_iter()
            .collect());
    }
    plot3d::write(path, &grid.blocks, &[], layout)?;
    let conditions = path.with_extension("bc.toml");
    std::fs::write(&conditions, boundary_file::format(&grid.topology)).map_err(io(&conditions))?;
    let map = path.with_extension("nmf");
    let (text, left_out) = nmf::format(grid);
    std::fs::write(&map, text).map_err(io(&map))?;
    let mut notes = vec![format!("conditions in {} and {}", conditions.display(), map.display())];
    if left_out > 0 {
        notes.push(format!(
            "{left_out} periodic interfaces have no place in a .nmf and are in the .bc.toml only"
        ));
    }
    Ok(notes)
}

/// Opens `from` and saves it as `to`.
/// # Errors
/// As [`open`] and [`save`].
pub fn convert(from: &Path, to: &Path, layout: Layout) -> Result<Opened, FileError> {
    let mut opened = open(from, None)?;
    opened.notes.extend(save(to, &opened.grid, layout)?);
    Ok(opened)
}
