//! Unsteady flow on moving grids: conservation laws, order in time, invariance, exact waves, restart.

mod free_stream;
mod motion;
mod order;
mod runs;

use dip_grid::MultiBlock;
use dip_pmb::boundary::Boundary;
use dip_pmb::dual_time::{DualTime, DualTimeSettings, TimeScheme};
use dip_pmb::gas::State;
use dip_pmb::level::Level;
use dip_pmb::moving::{BlockNodes, Nodes};
use dip_pmb::reconstruct::Reconstruction;
use dip_pmb::scheme::Scheme;
use dip_pmb::solver::{Equations, Solver};

/// Every step down to round-off.
fn tight(scheme: TimeScheme, dt: f64) -> DualTimeSettings {
    DualTimeSettings {
        scheme,
        dt,
        orders: 11.0,
        max_iterations: 25,
        max_products: 80,
        directions: 80,
        ..DualTimeSettings::default()
    }
}

/// A flow on `grid` that starts uniform, with the boundary conditions that `boundary` makes of the conditions' names.
fn flow_on(
    grid: &MultiBlock,
    state: &State<f64>,
    reconstruction: Reconstruction,
    settings: DualTimeSettings,
    boundary: impl Fn(dip_grid::Condition) -> Boundary,
) -> DualTime {
    let level = Level::new(grid).expect("a good grid");
    let boundaries = level.patches.iter().map(|p| boundary(p.condition)).collect();
    let scheme = Scheme::new(1.4, reconstruction, 5.0, level.cell_count, level.planar, 0.7);
    let equations = Equations::new(level, scheme, boundaries, state).expect("boundaries");
    DualTime::new(Solver::new(equations), grid, settings)
}

/// Moves every node: `to` of its place at rest.
fn displace(rest: &Nodes, nodes: &mut Nodes, to: impl Fn([f64; 3]) -> [f64; 3]) {
    for (rest, nodes) in rest.blocks.iter().zip(&mut nodes.blocks) {
        let [x, y, z] = rest;
        let [a, b, c]: &mut BlockNodes = nodes;
        for n in 0..x.len() {
            [a[n], b[n], c[n]] = to([x[n], y[n], z[n]]);
        }
    }
}
