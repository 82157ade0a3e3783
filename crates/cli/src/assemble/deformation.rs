//! From shapes on the wall to displacements of every node of a grid.

use crate::exit::Stop;
use dip_case::file::WallDisplacement;
use dip_grid::MultiBlock;
use dip_modal::{Attachment, GridModes, Modes, MovingWall, StructuralSurface, Transfer, TransferCheck};
use dip_pmb::moving::Nodes;
use nalgebra::Vector3;

/// Modes on a grid.
#[derive(Debug)]
pub struct Deformation {
    /// Displacement of every node of the grid for a unit of each generalized coordinate, m, `[mode]`.
    pub fields: Vec<Nodes>,
}

/// Carries the first `count` modes of a structure to the wall (constant volume tetrahedra) and from there to the grid
/// (transfinite blending).
///
/// # Errors
/// What the transfer or the deformation refuses.
pub fn of_modes(grid: &MultiBlock, modes: &Modes, count: usize) -> Result<Deformation, Stop> {
    let fields = nodes(grid, &on_grid(grid, modes, count, WallDisplacement::All)?.modes);
    Ok(Deformation { fields })
}

/// Modes on a grid with the wall that carries them and what an inspection of the transfer found.
#[derive(Debug)]
pub struct OnGrid {
    /// Displacement fields.
    pub modes: GridModes,
    /// The wall.
    pub wall: MovingWall,
    /// Rigid motion, balance, virtual work of the transfer.
    pub check: TransferCheck,
}

/// As [`of_modes`], in the form that the march takes, with the components of the modes that `displacement` says.
///
/// # Errors
/// As [`of_modes`].
pub fn on_grid(grid: &MultiBlock, modes: &Modes, count: usize, displacement: WallDisplacement) -> Result<OnGrid, Stop> {
    let wall = moving_wall(grid)?;
    let refuse = |e: &dyn std::fmt::Display| {
        Stop::input(
            format!("transfer from the structure to the wall: {e}"),
            "check that structure and grid have the same axes and length unit",
        )
    };
    let surface = StructuralSurface::of_modes(modes).map_err(|e| refuse(&e))?;
    let transfer = Transfer::new(&surface, &wall.points(), Attachment::default()).map_err(|e| refuse(&e))?;
    let mut shapes = transfer.modes(modes).map_err(|e| refuse(&e))?;
    shapes.truncate(count);
    if displacement == WallDisplacement::Z {
        shapes.iter_mut().flatten().for_each(|u| (u.x, u.y) = (0.0, 0.0));
    }
    Ok(OnGrid {
        modes: spread(grid, &wall, &shapes)?,
        check: transfer.check(),
        wall,
    })
}

/// Carries one shape, given as the displacement of a wall point, to the grid.
///
/// # Errors
/// As [`of_modes`].
pub fn of_shape(grid: &MultiBlock, shape: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Result<Deformation, Stop> {
    let wall = moving_wall(grid)?;
    let shape = wall.points().into_iter().map(shape).collect();
    let fields = nodes(grid, &spread(grid, &wall, &[shape])?);
    Ok(Deformation { fields })
}

fn moving_wall(grid: &MultiBlock) -> Result<MovingWall, Stop> {
    MovingWall::new(grid, |p| p.condition.is_wall()).map_err(|e| {
        Stop::input(
            format!("no wall to move: {e}"),
            "give the body's patch the condition `wall`",
        )
    })
}

fn spread(grid: &MultiBlock, wall: &MovingWall, shapes: &[Vec<Vector3<f64>>]) -> Result<GridModes, Stop> {
    GridModes::new(grid, wall, shapes, None).map_err(|e| {
        Stop::input(
            format!("deformation of the grid: {e}"),
            "look at the grid by `pmb mesh check`",
        )
    })
}

fn nodes(grid: &MultiBlock, modes: &GridModes) -> Vec<Nodes> {
    (0..modes.count())
        .map(|m| Nodes {
            blocks: (0..grid.blocks.len()).map(|b| modes.field(m, b).clone()).collect(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assemble::modes;
    use dip_case::Document;
    use dip_case::file::MarchFile;
    use std::path::Path;

    #[test]
    fn a_wall_displaced_along_z_has_the_same_deflection_and_no_other() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let document = Document::read(&root.join("cases/agard445/march.toml"), &[]).unwrap();
        let table = document.load::<MarchFile>().unwrap().modes;
        let yates = modes::from_table(&document, &table).unwrap().modes;
        let grid = dip_grid::recipe::make(&root.join("meshes/agard445_ch_coarsest.toml")).unwrap();
        let all = on_grid(&grid, &yates, 2, WallDisplacement::All).unwrap().modes;
        let along_z = on_grid(&grid, &yates, 2, WallDisplacement::Z).unwrap().modes;
        let mut sideways = 0.0_f64;
        for m in 0..2 {
            for (a, z) in all.wall_shape(m).iter().zip(along_z.wall_shape(m)) {
                assert_eq!((z.x, z.y, z.z), (0.0, 0.0, a.z));
                sideways = sideways.max(a.x.abs());
            }
        }
        assert!(sideways > 0.0);
    }
}
