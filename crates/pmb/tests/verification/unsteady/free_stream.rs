//! The geometric conservation law: a uniform stream stays uniform on any moving grid.

use dip_grid::generate::BoxGrid;
use dip_grid::{Condition, MultiBlock, reorient, split};
use dip_pmb::FlowError;
use dip_pmb::boundary::Boundary;
use dip_pmb::dual_time::{DualTime, TimeScheme};
use dip_pmb::moving::Nodes;
use dip_pmb::reconstruct::Reconstruction;
use dip_pmb::scheme::free_stream;

use super::{displace, flow_on, tight};
use crate::Random;
use crate::order::planar;

const STEPS: usize = 100;
const DT: f64 = 0.07;

/// A box of blocks that run in all directions, some left-handed.
fn boxes() -> MultiBlock {
    let mut grid = BoxGrid::new([0.0; 3], [1.2, 1.0, 0.8], [8, 6, 5])
        .conditions([Condition::FarField; 6])
        .make();
    split::split_into(&mut grid, 6);
    let axes = [[1, 2, 0], [2, 1, 0], [0, 2, 1], [1, 0, 2], [2, 0, 1], [0, 1, 2]];
    for (n, axes) in axes.into_iter().enumerate() {
        reorient::reorient(&mut grid, n, axes, [n % 2 == 0, n > 2, n == 3]);
    }
    grid
}

/// A quarter of a cylinder whose first side is its axis.
fn wedge() -> MultiBlock {
    use Condition::{Collapsed, FarField};
    let mut grid = BoxGrid::new([0.0; 3], [1.0; 3], [5, 6, 4])
        .conditions([Collapsed, FarField, FarField, FarField, FarField, FarField])
        .make();
    let block = &mut grid.blocks[0];
    for k in 0..=block.nk {
        for j in 0..=block.nj {
            for i in 0..=block.ni {
                let [r, t, y] = block.point(i, j, k);
                let angle = 0.5 * std::f64::consts::PI * t;
                let point = if i == 0 {
                    [0.0, y, 0.0]
                } else {
                    [r * angle.sin(), y, r * angle.cos()]
                };
                block.set_point([i, j, k], point);
            }
        }
    }
    grid
}

fn plane() -> MultiBlock {
    planar([12, 9], [Condition::FarField; 4], |s, t| [1.3 * s, 0.9 * t])
}

/// A shift that depends on the place and the step only, so that nodes which blocks share stay together. In a plane grid both
/// sheets move alike.
fn shift(place: [f64; 3], step: usize, size: f64, planar: bool) -> [f64; 3] {
    let mut seed = 77 + step as u64;
    for (d, x) in place.into_iter().enumerate() {
        if planar && d == 1 {
            continue;
        }
        seed = seed
            .wrapping_mul(1_000_003)
            .wrapping_add((x * 1e7).round() as i64 as u64)
            .rotate_left(17);
    }
    let mut random = Random(seed);
    random.uniform();
    let by = [random.uniform(), random.uniform(), random.uniform()];
    [
        place[0] + size * by[0],
        if planar { place[1] } else { place[1] + size * by[1] },
        place[2] + size * by[2],
    ]
}

fn start(grid: &MultiBlock, scheme: TimeScheme) -> DualTime {
    let stream = free_stream(1.4, 0.7, 0.08, if grid.is_two_dimensional() { 0.0 } else { 0.11 });
    flow_on(
        grid,
        &stream,
        Reconstruction::VanAlbada,
        tight(scheme, DT),
        |condition| match condition {
            Condition::Symmetry => Boundary::Symmetry,
            Condition::Collapsed => Boundary::Collapsed,
            _ => Boundary::FarField(stream),
        },
    )
}

/// Largest change of the stream, and largest speed of a face.
fn deviation(flow: &DualTime) -> (f64, f64) {
    let w = &flow.solver.unknowns;
    let stream = flow.solver.equations.boundaries.iter().find_map(|b| match b {
        Boundary::FarField(s) => Some(*s),
        _ => None,
    });
    let stream = stream.expect("a far field");
    let change = w
        .chunks_exact(5)
        .flat_map(|w| w.iter().zip(stream).map(|(w, s)| (w - s).abs()))
        .fold(0.0, f64::max);
    let blocks = &flow.solver.equations.level.blocks;
    let faces = blocks.iter().flat_map(|b| &b.faces);
    let speed = faces.flat_map(|f| f.speed.iter().map(|s| s.abs())).fold(0.0, f64::max);
    (change, speed)
}

#[test]
fn a_uniform_stream_stays_uniform_on_grids_that_move_at_random() {
    for (name, grid, size) in [
        ("boxes", boxes(), 0.025),
        ("plane", plane(), 0.02),
        ("wedge", wedge(), 0.02),
    ] {
        let planar = grid.is_two_dimensional();
        assert_eq!(planar, name == "plane");
        let rest = Nodes::of(&grid);
        for scheme in [TimeScheme::Bdf1, TimeScheme::Bdf2, TimeScheme::Bdf2Opt] {
            for restart in [None, Some(43)] {
                let mut flow = start(&grid, scheme);
                let mut fastest = 0.0_f64;
                for step in 1..=STEPS {
                    flow.advance(|nodes| displace(&rest, nodes, |p| shift(p, step, size, planar)))
                        .unwrap_or_else(|e| panic!("{name}: {e}"));
                    if restart == Some(step) {
                        let (header, values) = flow.save().expect("a state");
                        flow = start(&grid, scheme);
                        flow.restore(&header, &values).expect("the same grid");
                        assert_eq!(flow.step, step);
                    }
                    let (change, speed) = deviation(&flow);
                    fastest = fastest.max(speed);
                    assert!(change <= 1e-12, "{name}, {scheme:?}, step {step}: {change:e}");
                }
                // The grid did move, about as fast as the stream.
                assert!(fastest > 0.3, "{name}: faces moved at {fastest} only");
            }
        }
    }
}

#[test]
fn a_grid_that_folds_is_refused_with_block_and_cell() {
    let grid = boxes();
    let rest = Nodes::of(&grid);
    let mut flow = start(&grid, TimeScheme::Bdf2);
    flow.advance(|nodes| displace(&rest, nodes, |p| shift(p, 1, 0.02, false)))
        .expect("a good grid");
    let inside = grid.blocks[4].node(1, 1, 1);
    let error = flow
        .advance(|nodes| nodes.blocks[4][0][inside] += 3.0)
        .expect_err("a folded cell");
    match &error {
        FlowError::Volume { block, ijk, volume } => {
            assert_eq!(*block, grid.blocks[4].name);
            // One of the eight cells round the node.
            assert!(ijk.iter().all(|i| *i <= 1), "{ijk:?}");
            assert!(*volume < 0.0, "{volume}");
        }
        other => panic!("{other}"),
    }
    assert!(error.to_string().contains(&grid.blocks[4].name), "{error}");
}
