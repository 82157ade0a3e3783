//! What the kernels of the flow solver are timed on: disturbed transonic flow in a wavy box, in as many blocks as a case has.

use dip_grid::generate::BoxGrid;
use dip_grid::{MultiBlock, split};
use dip_pmb::FlowError;
use dip_pmb::boundary::Boundary;
use dip_pmb::level::Level;
use dip_pmb::reconstruct::Reconstruction;
use dip_pmb::scheme::{Scheme, free_stream};
use dip_pmb::solver::{Equations, Solver};

/// Cells along i, j, k of the AGARD 445.6 C-H grid at which flow solvers were compared.
pub const CELLS: [usize; 3] = [96, 20, 28];

/// The grid and a solver on it.
///
/// # Errors
/// None for cells that make a grid.
pub fn make(blocks: usize, cells: [usize; 3]) -> Result<(MultiBlock, Solver), FlowError> {
    let mut grid = BoxGrid::new([0.0; 3], [3.0, 0.8, 1.2], cells).wavy(0.04).make();
    split::split_into(&mut grid, blocks);
    let level = Level::new(&grid)?;
    let stream = free_stream(1.4, 0.8, 0.05, 0.03);
    let boundaries = level
        .patches
        .iter()
        .map(|p| match p.name.as_str() {
            "zmin" => Boundary::Wall,
            _ => Boundary::FarField(stream),
        })
        .collect();
    let scheme = Scheme::new(1.4, Reconstruction::VanAlbada, 1.0, level.cell_count, level.planar, 0.8);
    let mut solver = Solver::new(Equations::new(level, scheme, boundaries, &stream)?);
    let disturbed: Vec<f64> = solver
        .unknowns
        .iter()
        .enumerate()
        .map(|(m, w)| w * (1.0 + 0.02 * (m as f64 * 0.37).sin()))
        .collect();
    solver.set(&disturbed);
    solver.set_time_step(100.0);
    Ok((grid, solver))
}
