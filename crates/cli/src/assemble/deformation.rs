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
    check_place(&wall.points(), modes, grid.is_two_dimensional())?;
    let refuse = |e: &dyn std::fmt::Display| {
        Stop::input(
            format!("transfer from the structure to the wall: {e}"),
            "give nodes fore and aft of each other, as on ribs, whose motion shows how the sections turn",
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

/// How far a structure may reach beyond the wall, over the extent of the wall along that axis, and (across a thin wall, where engines hang)
/// over its largest.
const BEYOND: [f64; 2] = [0.5, 0.25];
/// Largest extent of a structure over that of the wall, at least: a wall may have bodies that the structure has not.
const LEAST_EXTENT: f64 = 0.2;

/// An axis, and where structure and wall begin and end along it.
type Extents = (usize, [f64; 2], [f64; 2]);

/// A structure that lies elsewhere than the wall, or is of another size, is a mistake in units, axes or files; the transfer would carry
/// its modes there all the same.
fn check_place(wall: &[Vector3<f64>], modes: &Modes, planar: bool) -> Result<(), Stop> {
    let extent = |points: &mut dyn Iterator<Item = f64>| {
        points.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)])
    };
    // What a plane flow's grid is across says nothing.
    let axes: &[usize] = if planar { &[0] } else { &[0, 1, 2] };
    let boxes: Vec<Extents> = axes
        .iter()
        .map(|&d| {
            let structure = extent(&mut modes.nodes.iter().map(|n| n.position[d]));
            (d, structure, extent(&mut wall.iter().map(|p| p[d])))
        })
        .collect();
    let largest = |of: fn(&Extents) -> [f64; 2]| {
        let sizes = boxes.iter().map(|b| (b.0, of(b)[1] - of(b)[0]));
        sizes.fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a })
    };
    let (structure, wall) = (largest(|b| b.1), largest(|b| b.2));
    let beyond = |b: &&Extents| {
        let margin = (BEYOND[0] * (b.2[1] - b.2[0])).max(BEYOND[1] * wall.1);
        b.1[0] < b.2[0] - margin || b.1[1] > b.2[1] + margin
    };
    let small = || {
        boxes
            .iter()
            .find(|b| b.0 == wall.0 && structure.1 < LEAST_EXTENT * wall.1)
    };
    match boxes.iter().find(beyond).or_else(small) {
        None => Ok(()),
        Some((axis, [from, to], [wall_from, wall_to])) => Err(Stop::input(
            format!(
                "the structure does not lie on the wall of the grid: along {} its nodes go from {from:.4} to {to:.4} m, the wall from {wall_from:.4} to {wall_to:.4} m",
                ["x", "y", "z"][*axis]
            ),
            "check mesh.length_unit and the units of the modes, that x points aft, y to starboard and z up in both, and that both are of one wing",
        )),
    }
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
    fn a_structure_of_another_unit_side_or_axis_is_refused() {
        let structure = |place: fn(f64, f64) -> [f64; 3]| Modes {
            nodes: [(0.0, 0.0), (0.6, 0.0), (0.8, 0.76), (1.2, 0.76)]
                .into_iter()
                .map(|(x, y)| dip_modal::ModeNode {
                    id: 1,
                    position: place(x, y).into(),
                    frame: nalgebra::Matrix3::identity(),
                })
                .collect(),
            shapes: Vec::new(),
            omega_rad_s: Vec::new(),
            generalized_mass: Vec::new(),
            residual: Vec::new(),
        };
        let wall = [(0.0, 0.0), (0.56, 0.0), (0.81, 0.762), (1.18, 0.762)]
            .map(|(x, y)| [Vector3::new(x, y, 0.01), Vector3::new(x, y, -0.01)])
            .concat();
        assert!(check_place(&wall, &structure(|x, y| [x, y, 0.0]), false).is_ok());
        // A box between the spars, half of the span.
        assert!(check_place(&wall, &structure(|x, y| [0.2 + 0.5 * x, 0.5 * y, 0.0]), false).is_ok());
        for (wrong, axis) in [
            ((|x, y| [x, -y, 0.0]) as fn(f64, f64) -> [f64; 3], "along y"),
            (|x, y| [x, 0.0, y], "along z"),
            (|x, y| [1e3 * x, 1e3 * y, 0.0], "along x"),
            (|x, y| [0.0254 * x, 0.0254 * y, 0.0], "along x"),
        ] {
            let stop = format!("{:?}", check_place(&wall, &structure(wrong), false).unwrap_err());
            assert!(stop.contains(axis), "{stop}");
        }
        // In plane flow the width of the grid is nobody's.
        assert!(check_place(&wall, &structure(|x, y| [x, 20.0 * y, 0.0]), true).is_ok());
    }

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
