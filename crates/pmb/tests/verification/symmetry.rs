//! Mirror images: what is symmetric stays symmetric, to the last bit where the order of operations is mirrored too.
//!
//! Two blocks that are each other's image, cell by cell, go through the same operations in the residual: Osher's fluxes,
//! limiter, metrics, boundary conditions. One block across the plane of symmetry does not: Osher's path runs from the left
//! state to the right one, so that the flux through a face and that through its image differ in round-off. BILU(0) is
//! never the same on both sides: it sweeps one half towards the plane and the other away from it, or a wave across the
//! plane would stop there. Converged flows are symmetric to what the residual is then.

use std::sync::atomic::AtomicBool;

use dip_grid::connect::{Options, find_interfaces};
use dip_grid::{Block, Condition, Face, MultiBlock, Patch, Topology, Window};
use dip_pmb::level::Level;
use dip_pmb::observer::Silent;
use dip_pmb::scheme::Scheme;
use dip_pmb::settings::SteadySettings;
use dip_pmb::solver::{Equations, Solver};
use dip_pmb::steady::{SteadyResult, run};

use crate::Random;
use crate::steady::naca0012;

/// The upper half of a C grid, from the line ahead of the nose to the exit, with its cut edges on the plane z = 0 exactly.
fn upper_half(whole: &Block, wake: usize) -> Block {
    let half = whole.ni / 2;
    Block::from_fn("upper", [whole.ni - half, whole.nj, whole.nk], |i, j, k| {
        let [x, y, z] = whole.point(half + i, j, k);
        let on_plane = i == 0 || (j == 0 && half + i + wake >= whole.ni);
        [x, y, if on_plane { 0.0 } else { z }]
    })
}

/// The half and its image in z = 0, or both in one block that runs from the lower exit to the upper one.
fn mirrored(two_blocks: bool) -> MultiBlock {
    use Condition::{FarField, Symmetry, Wall};
    let whole = naca0012(32);
    let wake = 16;
    let upper = upper_half(&whole.blocks[0], wake);
    let image = |i: usize, j: usize, k: usize| {
        let [x, y, z] = upper.point(i, j, k);
        [x, y, -z]
    };
    let [ni, nj, nk] = upper.cells();
    let blocks = if two_blocks {
        vec![upper.clone(), Block::from_fn("lower", [ni, nj, nk], image)]
    } else {
        vec![Block::from_fn("both", [2 * ni, nj, nk], |i, j, k| {
            if i < ni {
                image(ni - i, j, k)
            } else {
                upper.point(i - ni, j, k)
            }
        })]
    };
    let mut patches = Vec::new();
    for (n, block) in blocks.iter().enumerate() {
        let mut put = |name: &str, face: Face, window: Window, condition: Condition| {
            patches.push(Patch {
                name: name.to_owned(),
                block: n,
                face,
                window,
                condition,
            });
        };
        let full = |face: Face| Window::full(block.face_cells(face));
        if !two_blocks {
            put("far", Face::IMin, full(Face::IMin), FarField);
        }
        put("far", Face::IMax, full(Face::IMax), FarField);
        put("far", Face::JMax, full(Face::JMax), FarField);
        put("side", Face::KMin, full(Face::KMin), Symmetry);
        put("side", Face::KMax, full(Face::KMax), Symmetry);
        let from = if two_blocks { 0 } else { wake };
        let [d0, _] = Face::JMin.directions();
        let (mut lo, mut hi) = ([0, 0], block.face_cells(Face::JMin));
        let along = usize::from(d0 != 0);
        (lo[along], hi[along]) = (from, block.ni - wake);
        put(&block.name, Face::JMin, Window::new(lo, hi), Wall);
    }
    let mut grid = MultiBlock {
        blocks,
        topology: Topology {
            interfaces: Vec::new(),
            patches,
        },
    };
    let found = find_interfaces(&mut grid, &Options::default());
    assert_eq!(found.free, 0, "{found}");
    grid
}

fn image(w: &[f64]) -> [f64; 5] {
    // Adding zero makes -0 the same as 0.
    [w[0], w[1], w[2], -w[3], w[4]].map(|x| x + 0.0)
}

fn transonic() -> SteadySettings {
    let mut s = SteadySettings::default();
    s.flow.mach = 0.8;
    s
}

/// The undisturbed stream.
fn equations(grid: &MultiBlock) -> Equations {
    let s = transonic();
    let level = Level::new(grid).expect("a good grid");
    let boundaries = s.boundaries(&level).expect("conditions");
    let scheme = Scheme::new(
        1.4,
        s.reconstruction,
        s.limiter_constant,
        level.cell_count,
        level.planar,
        0.8,
    );
    Equations::new(level, scheme, boundaries, &s.flow.state()).expect("equations")
}

fn steady(grid: &MultiBlock) -> SteadyResult {
    let result = run(&transonic(), grid, &mut Silent, &AtomicBool::new(false)).expect("a run");
    assert!(result.stop.is_converged(), "{:?} {:.2}", result.stop, result.orders);
    result
}

/// Largest difference between the values of cells and of their images, over the largest value; cells of one block.
fn asymmetry(values: &[f64], ni: usize) -> f64 {
    let rows = values.chunks_exact(5 * ni);
    let size = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let mut worst = 0.0_f64;
    for row in rows {
        for i in 0..ni / 2 {
            let (a, b) = (&row[5 * i..][..5], image(&row[5 * (ni - 1 - i)..][..5]));
            for (a, b) in a.iter().zip(b) {
                worst = worst.max((a - b).abs());
            }
        }
    }
    worst / size
}

/// Residuals and flow after explicit steps from a symmetric flow full of differences.
#[test]
fn two_blocks_that_mirror_each_other_have_the_same_bits() {
    let grid = mirrored(true);
    let mut solver = Solver::new(equations(&grid));
    let half = solver.unknowns.len() / 2;
    let mut random = Random(11);
    let mut flow = solver.unknowns.clone();
    for n in (0..half).step_by(5) {
        let one: Vec<f64> = flow[n..n + 5].iter().map(|w| w + 0.05 * random.uniform()).collect();
        flow[n..n + 5].copy_from_slice(&one);
        flow[half + n..half + n + 5].copy_from_slice(&image(&one));
    }
    solver.set(&flow);
    let same = |what: &str, values: &[f64]| {
        let (upper, lower) = values.split_at(half);
        for (n, (a, b)) in upper.chunks_exact(5).zip(lower.chunks_exact(5)).enumerate() {
            assert_eq!(image(a), image(&image(b)), "{what}, cell {n}");
        }
    };
    same("residual", &solver.residual);
    for _ in 0..20 {
        solver.set_time_step(0.5);
        solver.explicit_step();
    }
    same("flow", &solver.unknowns);
    same("its residual", &solver.residual);
    assert!(solver.norm().is_finite() && solver.norm() > 0.0);
}

#[test]
fn two_blocks_that_mirror_each_other_converge_to_a_symmetric_flow() {
    let result = steady(&mirrored(true));
    let (upper, lower) = result.solver.unknowns.split_at(result.solver.unknowns.len() / 2);
    let mut worst = 0.0_f64;
    for (a, b) in upper.chunks_exact(5).zip(lower.chunks_exact(5)) {
        for (a, b) in image(a).iter().zip(b) {
            worst = worst.max((a - b).abs());
        }
    }
    println!("converged flow: {worst:e}, {:?}", result.loads.total);
    assert!(worst < 1e-8, "flow {worst:e}");
    assert!(result.loads.total.cl.abs() < 1e-10, "lift {:e}", result.loads.total.cl);
    assert!(
        result.loads.total.cm.abs() < 1e-10,
        "moment {:e}",
        result.loads.total.cm
    );
    assert!(result.loads.total.cd > 0.0);
}

#[test]
fn one_block_across_the_plane_is_symmetric_to_round_off() {
    let grid = mirrored(false);
    let ni = grid.blocks[0].ni;
    // The residual of a symmetric flow full of differences.
    let mut equations = equations(&grid);
    let mut random = Random(7);
    let mut flow = vec![0.0; equations.len()];
    equations.field.store(&equations.level, &mut flow);
    for row in flow.chunks_exact_mut(5 * ni) {
        for i in 0..ni / 2 {
            let one: Vec<f64> = row[5 * i..][..5].iter().map(|w| w + 0.05 * random.uniform()).collect();
            row[5 * i..][..5].copy_from_slice(&one);
            row[5 * (ni - 1 - i)..][..5].copy_from_slice(&image(&one));
        }
    }
    equations.field.load(&equations.level, &flow);
    let mut residual = vec![0.0; flow.len()];
    equations.residual(&mut residual);
    let worst = asymmetry(&residual, ni);
    println!("residual: {worst:e}");
    assert!(worst < 1e-13, "residual {worst:e}");

    let result = steady(&grid);
    let worst = asymmetry(&result.solver.unknowns, ni);
    println!("converged flow: {worst:e}, {:?}", result.loads.total);
    assert!(worst < 1e-8, "flow {worst:e}");
}
