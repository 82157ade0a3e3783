//! Physics that does not care who moves: Galilean invariance, pitching grid or pitching stream, pistons.

use dip_grid::generate::{AerofoilGrid, AerofoilKind};
use dip_grid::geometry::{Section, TrailingEdge};
use dip_grid::{Condition, MultiBlock};
use dip_pmb::boundary::Boundary;
use dip_pmb::dual_time::{DualTime, DualTimeSettings, TimeScheme};
use dip_pmb::loads::{WallGeometry, integrate};
use dip_pmb::motion::{Coordinate, Harmonic, Law, Motion, Shape};
use dip_pmb::moving::Nodes;
use dip_pmb::observer::Silent;
use dip_pmb::reconstruct::Reconstruction;
use dip_pmb::scheme::free_stream;
use dip_pmb::settings::SteadySettings;
use dip_pmb::steady;

use super::order::carried_vortex;
use super::{displace, flow_on, tight};
use crate::order::{cell_mean, planar};

/// A vortex in a stream, seen by somebody who moves at `velocity`, on a grid that moves with him.
fn vortex_seen_from(velocity: [f64; 2]) -> Vec<[f64; 5]> {
    let n = 20;
    let grid = planar([n, n], [Condition::FarField; 4], |s, t| {
        [8.0 * s - 4.0 + 0.1 * (9.0 * t).sin(), 8.0 * t - 4.0]
    });
    let stream = [0.6 - velocity[0], 0.1 - velocity[1]];
    let seen = |p: [f64; 2]| carried_vortex(p, [0.0, 0.0], stream);
    let far = seen([1e3, 0.0]);
    let settings = tight(TimeScheme::Bdf2, 0.05);
    let flow = flow_on(&grid, &far, Reconstruction::VanAlbada, settings, |c| match c {
        Condition::Symmetry => Boundary::Symmetry,
        _ => Boundary::FarField(far),
    });
    let mut solver = flow.solver;
    let means: Vec<f64> = (0..n * n)
        .flat_map(|c| cell_mean(&grid.blocks[0], c % n, c / n, &seen))
        .collect();
    solver.set(&means);
    let mut flow = DualTime::new(solver, &grid, settings);
    let rest = Nodes::of(&grid);
    for step in 1..=12 {
        let t = 0.05 * f64::from(step);
        let outcome = flow
            .advance(|nodes| displace(&rest, nodes, |[x, y, z]| [x - velocity[0] * t, y, z - velocity[1] * t]))
            .expect("a step");
        assert!(outcome.converged, "{outcome:?}");
    }
    flow.solver
        .unknowns
        .chunks_exact(5)
        .map(|w| [w[0], w[1] + velocity[0], w[2], w[3] + velocity[1], w[4]])
        .collect()
}

/// Fluxes see velocities relative to the face, reconstruction sees differences of velocity, and the face speeds obey
/// the conservation law: the discrete equations themselves are invariant, so only tolerance and round-off differ.
#[test]
fn a_grid_that_moves_with_the_stream_sees_the_same_flow() {
    let still = vortex_seen_from([0.0, 0.0]);
    // At rest relative to the stream, and faster than sound against it.
    for velocity in [[0.6, 0.1], [-3.0, 0.7]] {
        let moving = vortex_seen_from(velocity);
        let worst = still
            .iter()
            .flatten()
            .zip(moving.iter().flatten())
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        println!("seen from {velocity:?}: largest difference {worst:e}");
        assert!(worst < 1e-9, "seen from {velocity:?}: {worst:e}");
    }
}

fn naca0012() -> MultiBlock {
    AerofoilGrid {
        kind: AerofoilKind::C,
        section: Section::naca4("0012")
            .and_then(|s| s.with_trailing_edge(TrailingEdge::Closed))
            .expect("NACA 0012"),
        chord: 1.0,
        surface: 32,
        wake: 16,
        normal: 16,
        base: 4,
        wall_spacing: 0.012,
        nose_spacing: 0.012,
        tail_spacing: 0.016,
        far_field: 15.0,
        wake_growth: 0.1,
        growth_limit: 2.0,
    }
    .make()
    .expect("a C grid")
}

/// First harmonic of the normal force at reduced frequency `k` for a small angle, by pitching the grid or the stream.
fn normal_force(k: f64, pitch_grid: bool) -> [f64; 2] {
    const STEPS: usize = 24;
    let amplitude = 0.5_f64.to_radians();
    let grid = naca0012();
    let mut settings = SteadySettings::default();
    settings.flow.mach = 0.4;
    settings.reference.moment_point = [0.25, 0.0, 0.0];
    // The limiter works on components along x, y, z, which a coarse grid sees: the steady lifts of a turned grid and of a turned
    // stream differ by 1 % with it.
    settings.reconstruction = Reconstruction::Unlimited;
    settings.solver.orders = 5.0;
    let result = steady::run(
        &settings,
        &grid,
        &mut Silent,
        &std::sync::atomic::AtomicBool::new(false),
    )
    .expect("a run");
    let omega = 2.0 * k;
    let dt = std::f64::consts::TAU / omega / STEPS as f64;
    let motion = Motion {
        rest: Nodes::of(&grid),
        coordinates: vec![Coordinate {
            name: "pitch".into(),
            shape: Shape::Rotation {
                point: [0.25, 0.0, 0.0],
                axis: [0.0, 1.0, 0.0],
            },
            law: Law::Harmonic {
                mean: 0.0,
                terms: vec![Harmonic {
                    amplitude,
                    omega,
                    phase: 0.0,
                }],
            },
            blocks: None,
        }],
    };
    let e = &result.solver.equations;
    let mut walls = WallGeometry::merged(&grid, &e.level, &e.boundaries, &e.level);
    let time = DualTimeSettings {
        dt,
        orders: 6.0,
        max_iterations: 25,
        ..DualTimeSettings::default()
    };
    let mut flow = DualTime::new(result.solver, &grid, time);
    let mut sum = [0.0; 2];
    for step in 1..=2 * STEPS {
        let t = step as f64 * dt;
        let angle = amplitude * (omega * t).sin();
        let outcome = if pitch_grid {
            flow.advance(|nodes| motion.place(t, nodes))
        } else {
            let stream = free_stream(1.4, 0.4, angle, 0.0);
            for b in &mut flow.solver.equations.boundaries {
                if let Boundary::FarField(state) = b {
                    *state = stream;
                }
            }
            flow.advance(|_| ())
        }
        .expect("a step");
        assert!(outcome.converged, "{outcome:?}");
        let e = &flow.solver.equations;
        walls.follow(&e.level, &flow.grid.now);
        let force = integrate(
            &walls.pressures(&e.level, &e.sides, &settings.flow),
            &settings.flow,
            &settings.reference,
        );
        let [x, _, z] = force.total.force;
        // Normal to the chord.
        let normal = if pitch_grid {
            z * angle.cos() + x * angle.sin()
        } else {
            z
        };
        if step > STEPS {
            let (sin, cos) = (omega * t).sin_cos();
            sum[0] += normal * sin * 2.0 / (STEPS as f64 * amplitude);
            sum[1] += normal * cos * 2.0 / (STEPS as f64 * amplitude);
        }
    }
    sum
}

/// A stream that turns at the far boundary turns at the aerofoil later, by the time that the news takes: the phases differ
/// by O(k R), R chords to the far field, the amplitudes less.
#[test]
fn a_pitching_grid_and_a_pitching_stream_give_the_same_slow_lift() {
    let size = |s: [f64; 2]| s[0].hypot(s[1]);
    for (k, tolerance) in [(0.005, 0.01), (0.001, 0.002)] {
        let (grid, stream) = (normal_force(k, true), normal_force(k, false));
        println!("k {k}: pitching grid {grid:.5?}, pitching stream {stream:.5?}");
        // Lift follows the angle, a little late, in both.
        assert!(grid[0] > 5.0 && grid[1] < 0.0 && stream[1] < 0.0, "{grid:?} {stream:?}");
        assert!(
            (size(grid) / size(stream) - 1.0).abs() < tolerance,
            "k {k}: pitching grid {grid:?}, pitching stream {stream:?}"
        );
    }
}

/// Gas at rest (speed of sound 1) between a fixed wall at x = 0 and a piston at x = 1 + its stroke.
struct Cylinder {
    flow: DualTime,
    rest: Nodes,
}

const REST: [f64; 5] = [1.0, 0.0, 0.0, 0.0, 1.0 / 1.4];

impl Cylinder {
    fn new(cells: usize, settings: DualTimeSettings) -> Self {
        use Condition::{Symmetry, Wall};
        let grid = planar([cells, 2], [Wall, Wall, Symmetry, Symmetry], |s, t| [s, 0.05 * t]);
        let flow = flow_on(&grid, &REST, Reconstruction::VanAlbada, settings, |c| match c {
            Wall => Boundary::Wall,
            _ => Boundary::Symmetry,
        });
        Self {
            flow,
            rest: Nodes::of(&grid),
        }
    }

    /// A step after which the piston stands at 1 + stroke. Grid lines follow it evenly.
    fn step(&mut self, stroke: f64) {
        let rest = &self.rest;
        let outcome = self
            .flow
            .advance(|nodes| displace(rest, nodes, |[x, y, z]| [x * (1.0 + stroke), y, z]))
            .expect("a step");
        assert!(outcome.converged, "{outcome:?}");
    }

    /// Mass and energy of the gas.
    fn content(&self) -> [f64; 2] {
        let w = self.flow.solver.unknowns.chunks_exact(5);
        let volume = &self.flow.solver.equations.level.blocks[0].volume;
        let mut sum = [0.0; 2];
        for (w, v) in w.zip(volume) {
            sum[0] += v * w[0];
            sum[1] += v * (w[4] / 0.4 + 0.5 * w[0] * (w[1] * w[1] + w[3] * w[3]));
        }
        sum
    }

    fn piston_pressure(&self) -> f64 {
        let side = self.flow.solver.equations.sides[0][1].as_ref().expect("the piston");
        side.pressure[0]
    }
}

#[test]
fn a_closed_cylinder_keeps_its_mass_and_takes_the_work_of_its_piston() {
    let (steps, period) = (120, 3.0);
    let dt = period / steps as f64;
    let mut cylinder = Cylinder::new(40, tight(TimeScheme::Bdf2, dt));
    let [mass, energy] = cylinder.content();
    let mut work = 0.0;
    let stroke = |t: f64| 0.15 * (1.0 - (std::f64::consts::TAU * t / period).cos());
    let mut before = cylinder.piston_pressure();
    for n in 1..=steps {
        let t = f64::from(n) * dt;
        cylinder.step(stroke(t));
        let now = cylinder.content();
        assert!((now[0] / mass - 1.0).abs() < 1e-11, "step {n}: mass {}", now[0] / mass);
        // Work done on the gas, by the trapezoidal rule; the box is 0.05 high and 1 wide.
        let pressure = cylinder.piston_pressure();
        work -= 0.05 * 0.5 * (before + pressure) * (stroke(t) - stroke(t - dt));
        before = pressure;
        // BDF2 and the rule differ by O(dt^2).
        let gained = now[1] - energy;
        assert!(
            (gained - work).abs() < 2e-3 * energy,
            "step {n}: gained {gained}, work {work}"
        );
    }
}

/// Largest error of the pressure on a piston that starts smoothly, over the rest pressure, before its wave comes back: the
/// flow is a simple wave, p/p0 = (1 - 0.2 v/a0)^7 for a piston that withdraws at v (gamma 1.4).
fn simple_wave_error(cells: usize, steps: usize, speed: f64) -> f64 {
    let dt = 0.9 / steps as f64;
    // The first steps hardly move: eleven orders below what they begin with would be round-off.
    let settings = DualTimeSettings {
        orders: 6.0,
        ..tight(TimeScheme::Bdf2, dt)
    };
    let mut cylinder = Cylinder::new(cells, settings);
    let mut worst = 0.0_f64;
    for n in 1..=steps {
        let t = n as f64 * dt;
        // x = v (t - sin(pi t)/pi)/2 for 0 < t < 1: the speed grows from 0 to v with zero acceleration at both ends.
        let pi = std::f64::consts::PI;
        cylinder.step(0.5 * speed * (t - (pi * t).sin() / pi));
        let v = 0.5 * speed * (1.0 - (pi * t).cos());
        let exact = (1.0 - 0.2 * v).powi(7);
        worst = worst.max((cylinder.piston_pressure() * 1.4 - exact).abs());
    }
    worst
}

#[test]
fn a_piston_makes_the_simple_wave_it_should() {
    // Withdrawn to and pushed in at 0.4 of the speed of sound: pressure falls to 0.57 and rises to 1.71.
    for speed in [0.4, -0.4] {
        let errors = [(30, 24), (60, 48), (120, 96)].map(|(cells, steps)| simple_wave_error(cells, steps, speed));
        println!("piston at {speed}: errors {errors:?}");
        assert!(errors[2] < 1e-3, "piston at {speed}: {errors:?}");
        assert!(errors[1] / errors[2] > 3.0, "piston at {speed}: {errors:?}");
    }
}
