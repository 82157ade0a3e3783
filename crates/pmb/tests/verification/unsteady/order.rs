//! Measured order in time, and of space and time together, on moving grids.

use std::f64::consts::TAU;

use dip_grid::generate::BoxGrid;
use dip_grid::{Condition, Face, MultiBlock};
use dip_pmb::boundary::Boundary;
use dip_pmb::dual_time::{DualTime, TimeScheme};
use dip_pmb::gas::{Diatomic, State, conservative};
use dip_pmb::moving::Nodes;
use dip_pmb::reconstruct::Reconstruction;

use super::{displace, flow_on, tight};
use crate::order::{cell_mean, face_states, planar};

/// A state that depends on time only.
fn uniform(t: f64) -> State<f64> {
    [
        1.0 + 0.2 * (2.0 * t).sin(),
        1.0 + 0.3 * (3.0 * t).cos(),
        0.2 * (2.5 * t).sin(),
        0.1 + 0.2 * (2.0 * t).cos(),
        1.4 * (1.0 + 0.2 * (3.0 * t + 1.0).sin()),
    ]
}

/// dQ/dt of [`uniform`], by a difference of fourth order whose error is far below those measured.
fn uniform_rate(t: f64) -> State<f64> {
    let h = 1e-3;
    let q = |t: f64| conservative(&Diatomic, &uniform(t));
    let (a, b, c, d) = (q(t - 2.0 * h), q(t - h), q(t + h), q(t + 2.0 * h));
    [0, 1, 2, 3, 4].map(|v| (a[v] - 8.0 * b[v] + 8.0 * c[v] - d[v]) / (12.0 * h))
}

/// Root mean square error at time 1 of [`uniform`] with its rate as a source, on a grid that deforms and moves: nothing
/// but the error in time.
fn error_of_uniform(scheme: TimeScheme, steps: usize) -> f64 {
    let grid = BoxGrid::new([0.0; 3], [1.0; 3], [5, 4, 3])
        .conditions([Condition::FarField; 6])
        .make();
    let dt = 1.0 / steps as f64;
    let mut flow = flow_on(
        &grid,
        &uniform(0.0),
        Reconstruction::VanAlbada,
        tight(scheme, dt),
        |_| Boundary::FarField(uniform(0.0)),
    );
    let rest = Nodes::of(&grid);
    for n in 1..=steps {
        let t = n as f64 * dt;
        flow.begin_step();
        flow.place(|nodes| {
            displace(&rest, nodes, |[x, y, z]| {
                let s = 0.06 * (TAU * 0.7 * t).sin();
                [
                    x + s * (TAU * y).sin() + 0.3 * t,
                    y + s * (TAU * z).cos() * (3.0 * x).sin(),
                    z * (1.0 + 2.0 * s) + s * (TAU * x).cos(),
                ]
            });
        })
        .expect("a good grid");
        let rate = uniform_rate(t);
        flow.solver.equations.boundaries.fill(Boundary::FarField(uniform(t)));
        let volume = &flow.solver.equations.level.blocks[0].volume;
        let inertia = flow.solver.inertia.as_mut().expect("an unsteady flow");
        for (source, volume) in inertia.source.chunks_exact_mut(5).zip(volume) {
            for (s, r) in source.iter_mut().zip(rate) {
                *s -= volume * r;
            }
        }
        solve(&mut flow);
    }
    let exact = uniform(1.0);
    let w = &flow.solver.unknowns;
    let sum: f64 = w
        .chunks_exact(5)
        .flat_map(|w| w.iter().zip(exact).map(|(w, e)| (w - e).powi(2)))
        .sum();
    (sum / w.len() as f64).sqrt()
}

/// A begun and placed step, to its end.
fn solve(flow: &mut DualTime) {
    flow.guess();
    for _ in 0..flow.settings.max_iterations {
        if flow.is_converged() || !flow.iterate().expect("a physical flow") {
            break;
        }
    }
    let outcome = flow.finish_step().expect("a physical flow");
    assert!(outcome.converged, "{outcome:?}");
}

#[test]
fn a_manufactured_flow_on_a_deforming_grid_has_the_order_of_its_backward_difference() {
    let mut finest = Vec::new();
    for (scheme, order) in [
        (TimeScheme::Bdf1, 1.0),
        (TimeScheme::Bdf2, 2.0),
        (TimeScheme::Bdf2Opt, 2.0),
    ] {
        let errors = [40, 80, 160].map(|n| error_of_uniform(scheme, n));
        let measured = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect::<Vec<_>>();
        println!("{scheme:?}: errors {errors:?}, orders {measured:.3?}");
        assert!(
            (measured[1] - order).abs() < 0.1,
            "{scheme:?}: errors {errors:?}, orders {measured:.3?}"
        );
        finest.push(errors[2]);
    }
    // The leading error of the optimized one is 0.52 of BDF2's.
    let part = finest[2] / finest[1];
    assert!((part - 0.52).abs() < 0.05, "{part}");
}

/// An isentropic vortex about (`x`, `z`) in a stream at Mach 0.5: velocity `e r exp((1 - r^2)/2)` round the centre,
/// enthalpy `-e^2/2 exp(1 - r^2)` off the stream's.
pub fn carried_vortex([x, z]: [f64; 2], centre: [f64; 2], stream: [f64; 2]) -> State<f64> {
    const E: f64 = 0.3;
    const MACH: f64 = 0.5;
    let (x, z) = (x - centre[0], z - centre[1]);
    let g = (0.5 * (1.0 - x * x - z * z)).exp();
    let a2 = 1.0 / (MACH * MACH) - 0.4 * 0.5 * E * E * g * g;
    let rho = (a2 * MACH * MACH).powf(2.5);
    [rho, stream[0] + E * z * g, 0.0, stream[1] - E * x * g, rho * a2 / 1.4]
}

/// A square of n x n cells, and its nodes in a sinusoidal motion that leaves none at rest.
fn square(n: usize) -> MultiBlock {
    planar([n, n], [Condition::FarField; 4], |s, t| [8.0 * s - 4.0, 8.0 * t - 4.0])
}

fn wobble([x, y, z]: [f64; 3], t: f64) -> [f64; 3] {
    let s = 0.25 * (TAU * t).sin();
    [
        x + s * (0.5 * TAU * z / 4.0).sin() + 0.5 * s,
        y,
        z + s * (0.5 * TAU * (x + 1.0) / 4.0).cos(),
    ]
}

/// Cell means of density at time `time` of the vortex carried over the moving grid, and their error.
fn carry(n: usize, steps: usize, time: f64) -> (Vec<f64>, f64) {
    let mut grid = square(n);
    let rest = Nodes::of(&grid);
    let stream = [1.0, 0.2];
    let at = |t: f64| move |p: [f64; 2]| carried_vortex(p, [-0.5 + t, -0.1 + 0.2 * t], stream);
    let dt = time / steps as f64;
    // Start where the motion is at time 0.
    let settings = dip_pmb::dual_time::DualTimeSettings {
        orders: 6.0,
        ..tight(TimeScheme::Bdf2, dt)
    };
    let far = at(0.0)([1e3, 0.0]);
    let mut flow = flow_on(&grid, &far, Reconstruction::Unlimited, settings, |c| match c {
        Condition::Symmetry => Boundary::Symmetry,
        _ => Boundary::FarField(far),
    });
    let means = |grid: &MultiBlock, t: f64| -> Vec<f64> {
        let block = &grid.blocks[0];
        (0..n * n)
            .flat_map(|c| cell_mean(block, c % n, c / n, &at(t)))
            .collect()
    };
    flow.solver.set(&means(&grid, 0.0));
    let mut flow = DualTime::new(flow.solver, &grid, settings);
    for step in 1..=steps {
        let t = step as f64 * dt;
        flow.begin_step();
        flow.place(|nodes| displace(&rest, nodes, |p| wobble(p, t)))
            .expect("a good grid");
        flow.grid.now.write_to(&mut grid);
        let patches = flow.solver.equations.level.patches.clone();
        for (b, patch) in flow.solver.equations.boundaries.iter_mut().zip(&patches) {
            if !matches!(patch.face, Face::KMin | Face::KMax) {
                *b = Boundary::Fixed(face_states(&grid.blocks[0], patch.face, &at(t)));
            }
        }
        solve(&mut flow);
    }
    let exact = means(&grid, time);
    let density: Vec<f64> = flow.solver.unknowns.iter().step_by(5).copied().collect();
    let sum: f64 = density
        .iter()
        .zip(exact.iter().step_by(5))
        .map(|(a, b)| (a - b).powi(2))
        .sum();
    let error = (sum / density.len() as f64).sqrt();
    (density, error)
}

#[test]
fn a_vortex_carried_over_a_moving_grid_is_second_order_in_time() {
    let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    let runs = [80, 160, 320].map(|steps| carry(16, steps, 1.0).0);
    let order = (difference(&runs[0], &runs[1]) / difference(&runs[1], &runs[2])).log2();
    println!("order in time {order:.3}");
    assert!((order - 2.0).abs() < 0.1, "order in time {order}");
}

#[test]
fn a_vortex_carried_over_a_moving_grid_is_second_order_in_space_and_time() {
    let errors = [(24, 12), (48, 24), (96, 48)].map(|(n, steps)| carry(n, steps, 0.5).1);
    let orders: Vec<f64> = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
    println!("errors {errors:?}, orders {orders:.3?}");
    assert!(orders[1] > 1.9, "errors {errors:?}, orders {orders:.3?}");
}
