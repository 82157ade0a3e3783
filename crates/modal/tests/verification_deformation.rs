//! Deformation of grids: identity, rigid motion, interfaces to the bit, volumes, wall spacing.

use std::path::PathBuf;

use dip_grid::{Block, Condition, Face, MultiBlock, Patch, Window, recipe, split};
use dip_modal::{DeformError, GridModes, MovingWall, volume_change};
use nalgebra::Vector3;

fn recipe(name: &str) -> MultiBlock {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../meshes")
        .join(name);
    recipe::make(&path).unwrap()
}

fn wing(grid: &MultiBlock) -> MovingWall {
    MovingWall::new(grid, |p| p.name == "wing").unwrap()
}

const SEMISPAN: f64 = 0.762;

/// The case: 10 % of the semispan at the tip, 5 degrees of twist there about the mid-chord line, nose up; normals
/// of the plane z = 0 stay normal to it, as in a thin plate: u = -z dw/dx, v = -z dw/dy.
fn bend_and_twist(p: Vector3<f64>) -> Vector3<f64> {
    let s = p.y / SEMISPAN;
    let (twist, axis) = (5.0_f64.to_radians() * s, 0.5 * 0.5587 + MID_CHORD_SWEEP * s);
    let w = 0.1 * SEMISPAN * s * s - twist * (p.x - axis);
    let dw_ds = 0.2 * SEMISPAN * s - 5.0_f64.to_radians() * (p.x - axis) + twist * MID_CHORD_SWEEP;
    Vector3::new(p.z * twist, -p.z * dw_ds / SEMISPAN, w)
}

/// How far the mid-chord line of AGARD 445.6 goes aft from root to tip, m.
const MID_CHORD_SWEEP: f64 = 0.8094 + 0.5 * (0.3682 - 0.5587);

fn bent(grid: &MultiBlock) -> (MovingWall, GridModes, MultiBlock) {
    let wall = wing(grid);
    let shape: Vec<Vector3<f64>> = wall.points().into_iter().map(bend_and_twist).collect();
    let modes = GridModes::new(grid, &wall, &[shape], None).unwrap();
    let mut moved = grid.clone();
    modes.displace(grid, &[1.0], &mut moved).unwrap();
    (wall, modes, moved)
}

/// Nodes that meet on interfaces are at the same place to the bit.
fn assert_closed(grid: &MultiBlock) {
    for interface in &grid.topology.interfaces {
        let (a, b) = (interface.a, interface.b);
        for q in a.window.lo[1]..=a.window.hi[1] {
            for p in a.window.lo[0]..=a.window.hi[0] {
                let [s, t] = interface.node_on_b(p, q);
                let (one, other) = (&grid.blocks[a.block], &grid.blocks[b.block]);
                let one = one.point_at(one.node_behind(a.face, p, q, 0));
                let other = other.point_at(other.node_behind(b.face, s, t, 0));
                assert_eq!(one.map(f64::to_bits), other.map(f64::to_bits));
            }
        }
    }
}

/// Largest relative change of the first `layers` steps off the wall.
fn spacing_change(base: &MultiBlock, moved: &MultiBlock, layers: usize) -> f64 {
    let mut worst = 0.0_f64;
    for patch in base.topology.patches.iter().filter(|p| p.condition.is_wall()) {
        for q in patch.window.lo[1]..=patch.window.hi[1] {
            for p in patch.window.lo[0]..=patch.window.hi[0] {
                for depth in 0..layers {
                    let step = |grid: &MultiBlock| {
                        let block = &grid.blocks[patch.block];
                        let at = |d: usize| Vector3::from(block.point_at(block.node_behind(patch.face, p, q, d)));
                        (at(depth + 1) - at(depth)).norm()
                    };
                    worst = worst.max((step(moved) / step(base) - 1.0).abs());
                }
            }
        }
    }
    worst
}

const GRIDS: [&str; 5] = [
    "agard445_oo_coarse.toml",
    "agard445_oo_coarsest.toml",
    "agard445_ch_coarse.toml",
    "agard445_ch_coarsest.toml",
    "agard445_ch_euler.toml",
];

#[test]
fn cells_that_nearly_triple_from_step_to_step_do_not_fold_either() {
    let grid = recipe("../cases/agard445/mesh_like.toml");
    let (_, _, moved) = bent(&grid);
    let change = volume_change(&grid, &moved).unwrap();
    assert!(change.smallest > 0.4 && change.largest < 2.0, "{change:?}");
    assert_closed(&moved);
}

#[test]
fn tip_of_ten_percent_and_five_degrees_folds_no_cell_and_keeps_the_wall_spacing() {
    // The finer levels are in the validation program.
    for name in GRIDS {
        let grid = recipe(name);
        let (_, modes, moved) = bent(&grid);
        let change = volume_change(&grid, &moved).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(change.smallest > 0.5 && change.largest < 2.0, "{name}: {change:?}");
        // A displacement linear in the angle lengthens what it turns by half its square; what is left is the blending's.
        let turned = 0.5 * 0.3_f64.powi(2);
        let whole = spacing_change(&grid, &moved, 1);
        assert!(whole < 1.2 * turned, "{name}: {whole}");
        let mut little = grid.clone();
        modes.displace(&grid, &[1e-3], &mut little).unwrap();
        let spacing = spacing_change(&grid, &little, 1) / 1e-3;
        println!(
            "{name}: volumes {:.3} to {:.3}, first step {whole:.2e}, {spacing:.2e}",
            change.smallest, change.largest
        );
        assert!(spacing < 2e-4, "{name}: {spacing}");
        assert_closed(&moved);
        // The far field has not moved.
        for patch in grid
            .topology
            .patches
            .iter()
            .filter(|p| p.condition == Condition::FarField)
        {
            for q in 0..=patch.window.hi[1] {
                let block = &grid.blocks[patch.block];
                let [i, j, k] = block.node_behind(patch.face, patch.window.hi[0], q, 0);
                let n = block.node(i, j, k);
                assert!((0..3).all(|d| modes.field(0, patch.block)[d][n] == 0.0));
            }
        }
    }
}

#[test]
fn nothing_moves_without_displacement() {
    let grid = recipe(GRIDS[1]);
    let wall = wing(&grid);
    let still = vec![Vector3::zeros(); wall.positions.len()];
    let modes = GridModes::new(&grid, &wall, &[still], None).unwrap();
    let mut moved = grid.clone();
    modes.displace(&grid, &[3.0], &mut moved).unwrap();
    assert_eq!(moved, grid);
    let (_, modes, _) = bent(&grid);
    modes.displace(&grid, &[0.0], &mut moved).unwrap();
    assert_eq!(moved, grid);
}

#[test]
fn the_wall_moves_as_told_and_the_layers_beside_it_rigidly() {
    for name in [GRIDS[0], GRIDS[4]] {
        let grid = recipe(name);
        let wall = wing(&grid);
        let theta = Vector3::new(0.0, 0.08, 0.0);
        let rigid = |p: &Vector3<f64>| Vector3::new(0.02, 0.0, -0.05) + theta.cross(p);
        let shape: Vec<Vector3<f64>> = wall.points().iter().map(rigid).collect();
        let modes = GridModes::new(&grid, &wall, std::slice::from_ref(&shape), None).unwrap();
        for (told, got) in shape.iter().zip(modes.wall_shape(0)) {
            assert_eq!(told, got);
        }
        for patch in grid.topology.patches.iter().filter(|p| p.name == "wing") {
            let block = &grid.blocks[patch.block];
            for q in patch.window.lo[1]..=patch.window.hi[1] {
                for p in patch.window.lo[0]..=patch.window.hi[0] {
                    for depth in 0..=4 {
                        let [i, j, k] = block.node_behind(patch.face, p, q, depth);
                        let n = block.node(i, j, k);
                        let got = Vector3::from([0, 1, 2].map(|d| modes.field(0, patch.block)[d][n]));
                        let want = rigid(&Vector3::from(block.point(i, j, k)));
                        // On the wall exactly; off it as far as the blending has not begun (4 cells: 1 - 5 mm of 6 m).
                        let limit = if depth == 0 { 1e-17 } else { 2e-6 };
                        assert!(
                            (got - want).norm() <= limit,
                            "{name} {depth}: {:e}",
                            (got - want).norm()
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn symmetry_planes_stay_plane() {
    let grid = recipe(GRIDS[4]);
    let wall = wing(&grid);
    // A motion that would leave the plane.
    let shape: Vec<Vector3<f64>> = wall
        .points()
        .iter()
        .map(|p| Vector3::new(0.0, 0.01, 0.02 * p.y))
        .collect();
    let modes = GridModes::new(&grid, &wall, &[shape], None).unwrap();
    let mut moved = grid.clone();
    modes.displace(&grid, &[1.0], &mut moved).unwrap();
    for patch in grid
        .topology
        .patches
        .iter()
        .filter(|p| p.condition == Condition::Symmetry)
    {
        for q in patch.window.lo[1]..=patch.window.hi[1] {
            for p in patch.window.lo[0]..=patch.window.hi[0] {
                let block = &moved.blocks[patch.block];
                assert_eq!(block.point_at(block.node_behind(patch.face, p, q, 0))[1], 0.0);
            }
        }
    }
    volume_change(&grid, &moved).unwrap();
}

#[test]
fn cutting_and_turning_blocks_changes_nothing_that_matters() {
    let grid = recipe(GRIDS[4]);
    let (_, _, moved) = bent(&grid);
    let mut cut = grid.clone();
    for (block, axis) in [(0, 1), (3, 1), (5, 0), (8, 2)] {
        let at = cut.blocks[block].cells()[axis] / 3;
        split::split_block(&mut cut, block, axis, at);
    }
    let (_, _, cut_moved) = bent(&cut);
    assert_closed(&cut_moved);
    let change = volume_change(&cut, &cut_moved).unwrap();
    let before = volume_change(&grid, &moved).unwrap();
    assert!(
        (change.smallest - before.smallest).abs() < 0.05,
        "{change:?} {before:?}"
    );
    assert!((spacing_change(&cut, &cut_moved, 1) / spacing_change(&grid, &moved, 1) - 1.0).abs() < 1e-6);
}

#[test]
fn two_dimensional_grids_move_alike_on_both_sides() {
    for name in ["naca0012_c.toml", "naca0012_o.toml"] {
        let grid = recipe(name);
        let wall = MovingWall::new(&grid, |p| p.condition.is_wall()).unwrap();
        let pitch = 5.0_f64.to_radians();
        let shape = wall
            .points()
            .iter()
            .map(|p| Vector3::new(pitch * p.z, 0.0, -pitch * (p.x - 0.25)))
            .collect();
        let modes = GridModes::new(&grid, &wall, &[shape], None).unwrap();
        let mut moved = grid.clone();
        modes.displace(&grid, &[1.0], &mut moved).unwrap();
        let change = volume_change(&grid, &moved).unwrap();
        assert!(change.smallest > 0.9 && change.largest < 1.1, "{name}: {change:?}");
        for (b, block) in grid.blocks.iter().enumerate() {
            let plane = (block.ni + 1) * (block.nj + 1);
            for field in modes.field(0, b) {
                assert_eq!(field[..plane], field[plane..]);
            }
            assert!(modes.field(0, b)[1].iter().all(|v| *v == 0.0));
        }
        assert_closed(&moved);
    }
}

#[test]
fn the_boundary_layer_of_viscous_grids_keeps_its_spacing_and_its_right_angles() {
    // First step about 1e-6 of the chord. Pitch by 5 degrees about the quarter chord and camber of 5 % of the chord.
    for name in ["naca0012_viscous.toml", "agard445_ch_coarse.toml"] {
        let grid = recipe(name);
        let wall = MovingWall::new(&grid, |p| p.condition.is_wall()).unwrap();
        let shape: Vec<Vector3<f64>> = if grid.is_two_dimensional() {
            let pitch = 5.0_f64.to_radians();
            let bend = |x: f64| 0.2 * x * (1.0 - x) - pitch * (x - 0.25);
            let slope = |x: f64| 0.2 * (1.0 - 2.0 * x) - pitch;
            let at = |p: Vector3<f64>| Vector3::new(-slope(p.x) * p.z, 0.0, bend(p.x));
            wall.points().into_iter().map(at).collect()
        } else {
            wall.points().into_iter().map(bend_and_twist).collect()
        };
        let modes = GridModes::new(&grid, &wall, &[shape], None).unwrap();
        let moved_by = |q: f64| {
            let mut moved = grid.clone();
            modes.displace(&grid, &[q], &mut moved).unwrap();
            moved
        };
        let whole = moved_by(1.0);
        volume_change(&grid, &whole).unwrap_or_else(|e| panic!("{name}: {e}"));
        // Beyond the turn, which lengthens by half its square: from a thousandth of the displacement, scaled up.
        let little = moved_by(1e-3);
        let first = spacing_change(&grid, &little, 1) / 1e-3;
        let layers = spacing_change(&grid, &little, 8) / 1e-3;
        let tilt = tilt_change(&grid, &little) / 1e-3;
        println!("{name}: first step {first:.1e}, eight layers {layers:.1e}, angle to the wall {tilt:.1e} rad");
        assert!(first < 2e-4, "{name}: {first}");
        assert!(layers < 5e-3, "{name}: {layers}");
        assert!(tilt < 1e-2, "{name}: {tilt}");
    }
}

/// Largest change of the angle between the wall's grid lines and the first step off it, rad.
fn tilt_change(base: &MultiBlock, moved: &MultiBlock) -> f64 {
    let mut worst = 0.0_f64;
    for patch in base.topology.patches.iter().filter(|p| p.condition.is_wall()) {
        for q in patch.window.lo[1]..=patch.window.hi[1] {
            for p in patch.window.lo[0]..patch.window.hi[0] {
                let angle = |grid: &MultiBlock| {
                    let block = &grid.blocks[patch.block];
                    let at = |p: usize, d: usize| Vector3::from(block.point_at(block.node_behind(patch.face, p, q, d)));
                    (at(p, 1) - at(p, 0)).angle(&(at(p + 1, 0) - at(p, 0)))
                };
                worst = worst.max((angle(moved) - angle(base)).abs());
            }
        }
    }
    worst
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let grid = recipe(GRIDS[1]);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let many = rayon::ThreadPoolBuilder::new().num_threads(7).build().unwrap();
    assert_eq!(one.install(|| bent(&grid).1), many.install(|| bent(&grid).1));
}

#[test]
fn displacements_are_linear_in_the_coordinates() {
    let grid = recipe(GRIDS[3]);
    let wall = wing(&grid);
    let heave: Vec<Vector3<f64>> = wall
        .points()
        .iter()
        .map(|p| Vector3::new(0.0, 0.0, p.y * p.y))
        .collect();
    let twist: Vec<Vector3<f64>> = wall.points().into_iter().map(bend_and_twist).collect();
    let both: Vec<Vector3<f64>> = heave.iter().zip(&twist).map(|(h, t)| h * 0.05 + t * 0.5).collect();
    let two = GridModes::new(&grid, &wall, &[heave, twist], None).unwrap();
    let one = GridModes::new(&grid, &wall, &[both], None).unwrap();
    let (mut a, mut b) = (grid.clone(), grid.clone());
    two.displace(&grid, &[0.05, 0.5], &mut a).unwrap();
    one.displace(&grid, &[1.0], &mut b).unwrap();
    for (a, b) in a.blocks.iter().zip(&b.blocks) {
        for (a, b) in [(&a.x, &b.x), (&a.y, &b.y), (&a.z, &b.z)] {
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-14));
        }
    }
    assert_eq!(two.face_shape(1, &wall).len(), wall.faces.len());
}

/// A box with a moving floor and a lid that stays, without far field.
fn tunnel() -> MultiBlock {
    let block = Block::from_fn("tunnel", [8, 4, 6], |i, j, k| {
        [0.25 * i as f64, 0.5 * j as f64, 0.1 * (k as f64).powi(2) / 3.6]
    });
    let patch = |name: &str, face: Face, condition| Patch {
        name: name.into(),
        block: 0,
        face,
        window: Window::full(block.face_cells(face)),
        condition,
    };
    let patches = vec![
        patch("floor", Face::KMin, Condition::Wall),
        patch("lid", Face::KMax, Condition::WallSlip),
        patch("in", Face::IMin, Condition::InflowSubsonic),
        patch("out", Face::IMax, Condition::OutflowSubsonic),
        patch("side", Face::JMin, Condition::Symmetry),
        patch("side", Face::JMax, Condition::Symmetry),
    ];
    let mut grid = MultiBlock {
        blocks: vec![block],
        ..MultiBlock::default()
    };
    grid.topology.patches = patches;
    grid
}

#[test]
fn walls_that_do_not_move_stay() {
    let grid = tunnel();
    let wall = MovingWall::new(&grid, |p| p.name == "floor").unwrap();
    let bump = |p: &Vector3<f64>| Vector3::new(0.0, 0.0, 0.1 * (-8.0 * (p.x - 1.0).powi(2)).exp());
    let shape: Vec<Vector3<f64>> = wall.points().iter().map(bump).collect();
    let modes = GridModes::new(&grid, &wall, &[shape], None).unwrap();
    let mut moved = grid.clone();
    modes.displace(&grid, &[1.0], &mut moved).unwrap();
    volume_change(&grid, &moved).unwrap();
    let [ni, nj, nk] = grid.blocks[0].nodes();
    for j in 0..nj {
        for i in 0..ni {
            assert_eq!(moved.blocks[0].point(i, j, nk - 1), grid.blocks[0].point(i, j, nk - 1));
        }
    }
}

#[test]
fn a_folded_cell_is_named() {
    let grid = tunnel();
    let mut moved = grid.clone();
    let (i, j, k) = (3, 2, 1);
    let mut p = moved.blocks[0].point(i, j, k);
    p[2] += 0.5;
    moved.blocks[0].set_point([i, j, k], p);
    match volume_change(&grid, &moved) {
        Err(DeformError::Folded { block: 0, i, j, k, .. }) => assert_eq!((i, j, k), (2, 1, 1)),
        other => panic!("{other:?}"),
    }
}

#[test]
fn what_cannot_be_deformed_is_refused() {
    let mut grid = tunnel();
    assert!(matches!(
        MovingWall::new(&grid, |p| p.name == "wing"),
        Err(DeformError::NoWall)
    ));
    let wall = MovingWall::new(&grid, |p| p.name == "floor").unwrap();
    let shape = vec![Vector3::z(); wall.positions.len()];
    let short = GridModes::new(&grid, &wall, &[shape[1..].to_vec()], None);
    assert!(matches!(short, Err(DeformError::Count { .. })));
    let mut broken = shape.clone();
    broken[4].x = f64::INFINITY;
    let broken = GridModes::new(&grid, &wall, &[shape.clone(), broken], None);
    assert!(matches!(broken, Err(DeformError::NotFinite { mode: 2, node: 4 })));
    let modes = GridModes::new(&grid, &wall, std::slice::from_ref(&shape), None).unwrap();
    let mut moved = grid.clone();
    assert!(matches!(
        modes.displace(&grid, &[1.0, 2.0], &mut moved),
        Err(DeformError::Count { .. })
    ));
    let n = grid.blocks[0].node(3, 0, 3);
    grid.blocks[0].y[n] += 0.01;
    assert!(matches!(
        GridModes::new(&grid, &wall, &[shape], None),
        Err(DeformError::NotPlane { .. })
    ));
}
