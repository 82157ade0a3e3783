//! Whole steady runs: convergence by default settings, conservation, independence of blocks and threads, restart, and
//! exact supersonic flows.

use std::sync::atomic::{AtomicBool, Ordering};

use dip_grid::generate::{AerofoilGrid, AerofoilKind, BoxGrid};
use dip_grid::geometry::{Section, TrailingEdge};
use dip_grid::{Condition, MultiBlock, reorient, split};
use dip_pmb::FlowError;
use dip_pmb::observer::{Observer, Progress, Silent};
use dip_pmb::settings::{FarField, SteadySettings};
use dip_pmb::steady::{SteadyResult, StopReason, run};

use crate::order::planar;

/// A box with a bump on its floor, in three dimensions.
fn bump(cells: [usize; 3]) -> MultiBlock {
    use Condition::{FarField, Symmetry, Wall};
    let mut grid = BoxGrid::new([-1.0, 0.0, 0.0], [2.0, 1.0, 1.5], cells)
        .conditions([FarField, FarField, Symmetry, Symmetry, Wall, FarField])
        .make();
    let block = &mut grid.blocks[0];
    for k in 0..=block.nk {
        for j in 0..=block.nj {
            for i in 0..=block.ni {
                let [x, y, z] = block.point(i, j, k);
                let s = x.clamp(0.0, 1.0);
                let height = 0.08 * (std::f64::consts::PI * s).sin().powi(4) * (1.0 + 0.5 * (3.0 * y).cos());
                block.set_point([i, j, k], [x, y, z + height * (1.0 - z / 1.5)]);
            }
        }
    }
    grid
}

pub fn naca0012(surface: usize) -> MultiBlock {
    AerofoilGrid {
        kind: AerofoilKind::C,
        section: Section::naca4("0012")
            .and_then(|s| s.with_trailing_edge(TrailingEdge::Closed))
            .expect("NACA 0012"),
        chord: 1.0,
        surface,
        wake: surface / 2,
        normal: surface / 2,
        base: 4,
        wall_spacing: 0.4 / surface as f64,
        nose_spacing: 0.4 / surface as f64,
        tail_spacing: 0.5 / surface as f64,
        far_field: 30.0,
        wake_growth: 0.1,
        growth_limit: 2.0,
    }
    .make()
    .expect("a C grid")
}

fn settings(mach: f64, alpha_deg: f64) -> SteadySettings {
    let mut s = SteadySettings::default();
    s.flow.mach = mach;
    s.flow.alpha_deg = alpha_deg;
    s
}

fn steady(settings: &SteadySettings, grid: &MultiBlock) -> SteadyResult {
    run(settings, grid, &mut Silent, &AtomicBool::new(false)).expect("a run")
}

/// Unknowns of every cell in an order that does not depend on the blocks: by the position of the cell.
fn by_position(grid: &MultiBlock, unknowns: &[f64]) -> Vec<([i64; 3], [f64; 5])> {
    let mut out = Vec::new();
    let mut cells = unknowns.chunks_exact(5);
    for block in &grid.blocks {
        for k in 0..block.nk {
            for j in 0..block.nj {
                for i in 0..block.ni {
                    let c = cells.next().expect("five values a cell");
                    let key = block.cell_centre(i, j, k).map(|x| (x * 1e9).round() as i64);
                    out.push((key, [c[0], c[1], c[2], c[3], c[4]]));
                }
            }
        }
    }
    out.sort_by_key(|(key, _)| *key);
    out
}

#[test]
fn one_block_and_eight_turned_blocks_converge_to_the_same_flow_and_balance() {
    let one = bump([24, 8, 12]);
    let mut eight = one.clone();
    split::split_into(&mut eight, 8);
    for (n, axes) in [[1, 2, 0], [2, 1, 0], [0, 2, 1], [1, 0, 2]].into_iter().enumerate() {
        reorient::reorient(&mut eight, 2 * n, axes, [n % 2 == 0, n > 1, true]);
    }
    let mut s = settings(0.6, 0.0);
    s.solver.orders = 12.0;
    let (a, b) = (steady(&s, &one), steady(&s, &eight));
    for r in [&a, &b] {
        assert!(r.stop.is_converged() && r.orders > 10.0, "{:?} {:.2}", r.stop, r.orders);
        assert!(r.history.len() < 60, "{} steps", r.history.len());
    }
    let (ua, ub) = (
        by_position(&one, &a.solver.unknowns),
        by_position(&eight, &b.solver.unknowns),
    );
    for ((ka, wa), (kb, wb)) in ua.iter().zip(&ub) {
        assert_eq!(ka, kb);
        for v in 0..5 {
            assert!((wa[v] - wb[v]).abs() < 1e-10, "{ka:?}: {wa:?} {wb:?}");
        }
    }
    assert!((a.loads.total.cd - b.loads.total.cd).abs() < 1e-10);
    // What enters leaves: mass, momentum (with the force on the wall), energy.
    let sides = &a.solver.equations.sides[0];
    for v in 0..5 {
        let (mut sum, mut size) = (0.0_f64, 0.0_f64);
        for (n, side) in sides.iter().enumerate() {
            let side = side.as_ref().expect("every side is a boundary");
            for f in 0..side.physical.len() {
                let flux = side.flux_at(f)[v];
                sum += if n % 2 == 1 { flux } else { -flux };
                size += flux.abs();
            }
        }
        assert!(sum.abs() < 1e-10 * size, "variable {v}: {sum:e} of {size:e}");
    }
}

#[test]
fn an_aerofoil_converges_by_default_settings_in_every_speed_range() {
    let grid = naca0012(32);
    for (mach, alpha) in [(0.3, 2.0), (0.8, 1.25), (0.95, 0.0), (1.2, 1.0), (2.0, 3.0)] {
        let result = steady(&settings(mach, alpha), &grid);
        assert!(
            result.stop.is_converged(),
            "M {mach}: {:?} at {:.2} orders",
            result.stop,
            result.orders
        );
    }
}

#[test]
fn a_symmetric_flow_has_no_lift_and_opposite_angles_opposite_lift() {
    let grid = naca0012(32);
    let zero = steady(&settings(0.7, 0.0), &grid).loads.total;
    assert!(zero.cl.abs() < 1e-9 && zero.cm.abs() < 1e-9, "{zero:?}");
    let up = steady(&settings(0.7, 1.0), &grid).loads.total;
    let down = steady(&settings(0.7, -1.0), &grid).loads.total;
    assert!(
        (up.cl + down.cl).abs() < 1e-8 && (up.cd - down.cd).abs() < 1e-8,
        "{up:?} {down:?}"
    );
}

#[test]
fn a_far_field_vortex_makes_the_lift_independent_of_the_distance() {
    let near_and_far = |far_field: FarField| {
        [8.0, 60.0].map(|distance| {
            let mut grid = AerofoilGrid {
                kind: AerofoilKind::O,
                section: Section::naca4("0012")
                    .and_then(|s| s.with_trailing_edge(TrailingEdge::Closed))
                    .expect("NACA 0012"),
                chord: 1.0,
                surface: 48,
                wake: 24,
                normal: 32,
                base: 4,
                wall_spacing: 0.01,
                nose_spacing: 0.008,
                tail_spacing: 0.01,
                far_field: distance,
                wake_growth: 0.1,
                growth_limit: 2.0,
            };
            grid.normal = if distance > 20.0 { 40 } else { 32 };
            let mut s = settings(0.5, 2.0);
            s.far_field = far_field;
            s.reference.moment_point = [0.25, 0.0, 0.0];
            let result = steady(&s, &grid.make().expect("an O grid"));
            assert!(
                result.stop.is_converged(),
                "{far_field:?} {distance}: {:?}",
                result.stop
            );
            result.loads.total.cl
        })
    };
    let [near, far] = near_and_far(FarField::Vortex);
    let with = (near / far - 1.0).abs();
    let [near, far] = near_and_far(FarField::FreeStream);
    let without = (near / far - 1.0).abs();
    assert!(
        with < 0.006 && with < 0.3 * without,
        "change of lift with the vortex {with:.4}, without {without:.4}"
    );
}

/// Stops a run after some steps.
struct StopAfter<'a>(usize, &'a AtomicBool);
impl Observer for StopAfter<'_> {
    fn progress(&mut self, p: &Progress) {
        if p.step >= self.0 {
            self.1.store(true, Ordering::Relaxed);
        }
    }
    fn message(&mut self, _: &str) {}
}

#[test]
fn a_resumed_run_has_the_bits_of_one_that_never_stopped() {
    let grid = naca0012(32);
    let whole = steady(&settings(0.8, 1.25), &grid);
    let folder = tempfile::tempdir().expect("a folder");
    let mut s = settings(0.8, 1.25);
    s.restart = Some(folder.path().join("case.restart"));
    s.resume = true;
    // Twice: on a coarse level and on the finest.
    for after in [2, whole.history.len() - 3] {
        let cancel = AtomicBool::new(false);
        let stopped = run(&s, &grid, &mut StopAfter(after, &cancel), &cancel).expect("a run");
        assert_eq!(stopped.stop, StopReason::Interrupted);
        assert_eq!(stopped.history.len(), after);
    }
    let resumed = steady(&s, &grid);
    assert_eq!(resumed.stop, whole.stop);
    assert_eq!(resumed.history.len(), whole.history.len());
    for (a, b) in resumed.history.iter().zip(&whole.history) {
        assert_eq!(
            (a.cfl.to_bits(), a.orders.to_bits(), a.cl.to_bits()),
            (b.cfl.to_bits(), b.orders.to_bits(), b.cl.to_bits())
        );
    }
    assert!(
        resumed
            .solver
            .unknowns
            .iter()
            .zip(&whole.solver.unknowns)
            .all(|(a, b)| a.to_bits() == b.to_bits())
    );
}

#[test]
fn runs_have_the_same_bits_for_any_number_of_threads() {
    let mut grid = bump([24, 8, 12]);
    split::split_into(&mut grid, 4);
    let run_with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a thread pool");
        pool.install(|| steady(&settings(0.7, 0.5), &grid).solver.unknowns)
    };
    let one = run_with(1);
    for threads in [2, 5] {
        assert!(
            one.iter()
                .zip(&run_with(threads))
                .all(|(a, b)| a.to_bits() == b.to_bits()),
            "{threads} threads"
        );
    }
}

#[test]
fn bad_input_is_refused_with_its_name() {
    let grid = bump([8, 4, 4]);
    let refused = |change: &dyn Fn(&mut SteadySettings)| {
        let mut s = settings(0.5, 0.0);
        change(&mut s);
        match run(&s, &grid, &mut Silent, &AtomicBool::new(false)) {
            Err(e) => e.to_string(),
            Ok(r) => panic!("accepted: {:?}", r.stop),
        }
    };
    assert!(refused(&|s| s.flow.mach = -0.3).contains("flow.mach"));
    assert!(refused(&|s| s.flow.mach = f64::NAN).contains("flow.mach"));
    assert!(refused(&|s| s.flow.gamma = 1.0).contains("flow.gamma"));
    assert!(refused(&|s| s.reference.area = 0.0).contains("reference.area"));
    assert!(refused(&|s| s.solver.directions = 0).contains("directions"));
    let mut open = grid.clone();
    open.topology.patches.remove(2);
    let error = run(&settings(0.5, 0.0), &open, &mut Silent, &AtomicBool::new(false)).expect_err("an open side");
    assert!(
        matches!(
            &error,
            FlowError::Uncovered {
                face: "jmin",
                times: 0,
                ..
            }
        ),
        "{error}"
    );
    let mut viscous = grid.clone();
    viscous.topology.patches[4].condition = Condition::WallNoSlip;
    let error = run(&settings(0.5, 0.0), &viscous, &mut Silent, &AtomicBool::new(false)).expect_err("a viscous wall");
    assert!(error.to_string().contains("zmin"), "{error}");
    let mut folded = grid.clone();
    folded.blocks[0].set_point([3, 2, 2], [9.0, 0.5, 0.5]);
    let error = run(&settings(0.5, 0.0), &folded, &mut Silent, &AtomicBool::new(false)).expect_err("a folded cell");
    assert!(matches!(error, FlowError::Volume { .. }), "{error}");
}

#[test]
fn a_damaged_restart_file_is_refused_and_a_failed_write_keeps_the_old_one() {
    let grid = bump([8, 4, 4]);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("case.restart");
    let mut s = settings(0.5, 0.0);
    s.restart = Some(path.clone());
    let result = steady(&s, &grid);
    let good = std::fs::read(&path).expect("a restart file");
    // A folder in the way of the temporary file stands for a disk that refuses.
    std::fs::create_dir(folder.path().join("case.restart.part")).expect("a folder");
    assert!(matches!(result.snapshot.write(&path), Err(FlowError::Io { .. })));
    assert_eq!(std::fs::read(&path).expect("a restart file"), good);
    s.resume = true;
    for damage in [
        &good[..good.len() / 2],
        &good[..4],
        b"nonsense that is long enough to be read",
    ] {
        std::fs::write(&path, damage).expect("a file");
        let error = run(&s, &grid, &mut Silent, &AtomicBool::new(false)).expect_err("damage");
        assert!(matches!(error, FlowError::Restart { .. }), "{error}");
    }
    std::fs::write(&path, &good).expect("a file");
    let other = bump([8, 4, 6]);
    let error = run(&s, &other, &mut Silent, &AtomicBool::new(false)).expect_err("another grid");
    assert!(error.to_string().contains("another grid"), "{error}");
}

#[test]
fn a_restart_file_with_a_value_that_is_no_number_is_refused_with_the_cell() {
    let grid = bump([8, 4, 4]);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("case.restart");
    let mut s = settings(0.5, 0.0);
    let mut snapshot = steady(&s, &grid).snapshot;
    let cell = 3 + 8 * (2 + 4);
    for (value, variable, what) in [(f64::NAN, 1, "x-velocity"), (-0.1, 4, "pressure")] {
        let good = std::mem::replace(&mut snapshot.unknowns[5 * cell + variable], value);
        snapshot.write(&path).expect("a file");
        snapshot.unknowns[5 * cell + variable] = good;
        (s.restart, s.resume) = (Some(path.clone()), true);
        let error = run(&s, &grid, &mut Silent, &AtomicBool::new(false)).expect_err("a bad state");
        let named = matches!(&error, FlowError::State { ijk: [3, 2, 1], what: w, .. } if *w == what);
        assert!(named, "{error}");
    }
}

#[test]
fn a_stream_across_the_plane_of_the_grid_is_refused() {
    // The aerofoil in the x-y plane, as many 2D grids are written: alpha turns the stream out of it.
    let mut grid = naca0012(32);
    for block in &mut grid.blocks {
        for k in 0..=block.nk {
            for j in 0..=block.nj {
                for i in 0..=block.ni {
                    let [x, y, z] = block.point(i, j, k);
                    block.set_point([i, j, k], [x, z, -y]);
                }
            }
        }
    }
    let error = run(&settings(0.5, 2.0), &grid, &mut Silent, &AtomicBool::new(false)).expect_err("a stream across");
    assert!(error.to_string().contains("0.0349 of its speed"), "{error}");
    assert!(run(&settings(0.5, 0.0), &grid, &mut Silent, &AtomicBool::new(false)).is_ok());
}

/// Couplings between blocks, and faces along which the undisturbed stream runs (where Osher's flux changes sides), included.
#[test]
fn the_jacobian_of_a_flow_is_the_derivative_of_its_residual() {
    let mut result = steady(&settings(0.8, 1.25), &naca0012(32));
    let converged = dip_pmb::check::check_jacobian(&mut result.solver.equations).expect("a physical flow");
    let mut eight = naca0012(32);
    split::split_into(&mut eight, 8);
    let (mut stream, _) = dip_pmb::steady::equations(&settings(0.8, 0.0), &eight).expect("equations");
    let undisturbed = dip_pmb::check::check_jacobian(&mut stream).expect("a physical flow");
    for check in [converged, undisturbed] {
        assert!(check.relative < 1e-12, "{check:?}");
        assert!(check.residual < 1e-13, "{check:?}");
    }
}

/// Supersonic flow along a floor that turns by `turn` at x = 0, between x = -0.4 and 1.
fn corner(turn: f64, n: usize, mach: f64) -> (MultiBlock, SteadyResult) {
    use Condition::{FarField, OutflowSupersonic, Wall};
    let grid = planar([n, n], [FarField, OutflowSupersonic, Wall, FarField], |s, t| {
        let x = -0.4 + 1.4 * s;
        let floor = x.max(0.0) * turn.tan();
        let top = if turn > 0.0 { 1.2 } else { 0.9 };
        [x, floor + t * (top - floor)]
    });
    let result = steady(&settings(mach, 0.0), &grid);
    assert!(result.stop.is_converged(), "{:?} {:.2}", result.stop, result.orders);
    (grid, result)
}

#[test]
fn an_oblique_shock_stands_at_its_angle() {
    // exact_solutions.json: M 2, 15 degrees: beta 45.3436 degrees, p2/p1 2.194653.
    let n = 120;
    let (grid, result) = corner(15.0_f64.to_radians(), n, 2.0);
    let p1 = 1.0 / (1.4 * 4.0);
    let middle = p1 * 0.5 * (1.0 + 2.194_653_133_607_668);
    let block = &grid.blocks[0];
    let pressure = |i: usize, j: usize| result.solver.unknowns[5 * (i + n * j) + 4];
    // Height of the shock on every column: where the pressure passes the mean of both sides.
    let mut points = Vec::new();
    for i in 0..n {
        let x = block.cell_centre(i, 0, 0)[0];
        if !(0.25..0.9).contains(&x) {
            continue;
        }
        let j = (0..n - 1)
            .find(|j| pressure(i, *j) >= middle && pressure(i, j + 1) < middle)
            .expect("a shock");
        let t = (pressure(i, j) - middle) / (pressure(i, j) - pressure(i, j + 1));
        let (a, b) = (block.cell_centre(i, j, 0), block.cell_centre(i, j + 1, 0));
        points.push([x, a[2] + t * (b[2] - a[2])]);
    }
    let count = points.len() as f64;
    let mean = [0, 1].map(|d| points.iter().map(|p| p[d]).sum::<f64>() / count);
    let slope = points.iter().map(|p| (p[0] - mean[0]) * (p[1] - mean[1])).sum::<f64>()
        / points.iter().map(|p| (p[0] - mean[0]).powi(2)).sum::<f64>();
    let angle = slope.atan().to_degrees();
    assert!(
        (angle / 45.343_616_761_854_4 - 1.0).abs() < 0.005,
        "shock angle {angle}"
    );
    let wall = pressure(3 * n / 4, 0) / p1;
    assert!(
        (wall / 2.194_653_133_607_668 - 1.0).abs() < 0.005,
        "pressure behind the shock {wall}"
    );
}

#[test]
fn an_expansion_turns_the_flow_as_prandtl_and_meyer_say() {
    // exact_solutions.json: M 2, 10 degrees: M2 2.384887, p2/p1 0.547969.
    let n = 120;
    let (grid, result) = corner(-10.0_f64.to_radians(), n, 2.0);
    // Half-way between the wall and the fan's last ray (14.8 degrees up), off the corner's own entropy layer.
    let i = 3 * n / 4;
    let x = grid.blocks[0].cell_centre(i, 0, 0)[0];
    let height = 0.5 * x * (14.8_f64.to_radians().tan() - 10.0_f64.to_radians().tan());
    let j = (0..n)
        .find(|j| grid.blocks[0].cell_centre(i, *j, 0)[2] > height)
        .expect("a cell");
    let w = &result.solver.unknowns[5 * (i + n * j)..][..5];
    let p1 = 1.0 / (1.4 * 4.0);
    let mach = (w[1] * w[1] + w[3] * w[3]).sqrt() / (1.4 * w[4] / w[0]).sqrt();
    let angle = (w[3] / w[1]).atan().to_degrees();
    assert!(
        (w[4] / p1 / 0.547_968_731_276_783_8 - 1.0).abs() < 0.005,
        "pressure ratio {}",
        w[4] / p1
    );
    assert!(
        (mach / 2.384_887_154_593_211_5 - 1.0).abs() < 0.005,
        "Mach number {mach}"
    );
    assert!((angle / -10.0 - 1.0).abs() < 0.005, "flow angle {angle}");
}
