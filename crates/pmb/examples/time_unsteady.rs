//! Times a rigid pitch run: `cargo run --release -p dip-pmb --example time_unsteady -- RECIPE MACH K STEPS ORDERS CYCLES
//! [STEADY_ORDERS [bdf2|bdf2-opt [steps]]]`
//! (pitch of 1 degree about root mid-chord; K with the root semichord; chord is taken as the recipe's unit length times
//! 0.5588).

use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use cpu_time::ProcessTime;
use dip_grid::recipe;
use dip_pmb::dual_time::{DualTime, DualTimeSettings, TimeScheme};
use dip_pmb::loads::{WallGeometry, integrate};
use dip_pmb::motion::{Coordinate, Harmonic, Law, Motion, Shape};
use dip_pmb::moving::Nodes;
use dip_pmb::observer::Silent;
use dip_pmb::settings::{Reference, SteadySettings};
use dip_pmb::steady;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let number = |n: usize, default: f64| args.get(n).map_or(Ok(default), |a| a.parse::<f64>());
    let grid = recipe::make(Path::new(&args[0]))?;
    let (mach, k, steps) = (number(1, 0.678)?, number(2, 0.136)?, number(3, 40.0)?);
    let (orders, cycles) = (number(4, 2.5)?, number(5, 3.0)?);
    let chord = 0.5588;
    let mut settings = SteadySettings::default();
    settings.flow.mach = mach;
    settings.reference = Reference {
        area: 0.353,
        chord,
        moment_point: [0.5 * chord, 0.0, 0.0],
    };
    settings.solver.orders = number(6, 6.0)?;
    let begin = ProcessTime::now();
    let result = steady::run(&settings, &grid, &mut Silent, &AtomicBool::new(false))?;
    println!(
        "steady {:?} {:.2} s of CPU time",
        result.stop,
        begin.elapsed().as_secs_f64()
    );
    let omega = 2.0 * k / chord;
    let dt = std::f64::consts::TAU / omega / steps;
    let motion = Motion {
        rest: Nodes::of(&grid),
        coordinates: vec![Coordinate {
            name: "pitch".into(),
            shape: Shape::Rotation {
                point: [0.5 * chord, 0.0, 0.0],
                axis: [0.0, 1.0, 0.0],
            },
            law: Law::Harmonic {
                mean: 0.0,
                terms: vec![Harmonic {
                    amplitude: 1.0_f64.to_radians(),
                    omega,
                    phase: 0.0,
                }],
            },
            blocks: None,
        }],
    };
    let level = result.solver.equations.level.clone();
    let mut walls = WallGeometry::merged(&grid, &level, &result.solver.equations.boundaries, &level);
    let mut run = DualTime::new(
        result.solver,
        &grid,
        DualTimeSettings {
            dt,
            orders,
            scheme: match args.get(7).map(String::as_str) {
                Some("bdf2-opt") => TimeScheme::Bdf2Opt,
                _ => TimeScheme::Bdf2,
            },
            ..DualTimeSettings::default()
        },
    );
    let per_cycle = steps as usize;
    for cycle in 0..cycles as usize {
        let (begin, wall) = (ProcessTime::now(), Instant::now());
        let (mut iterations, mut products, mut builds, mut failed) = (0, 0, 0, 0);
        let mut sums = [[0.0; 2]; 2];
        for n in 0..per_cycle {
            let time = (run.step + 1) as f64 * dt;
            let outcome = run.advance(|nodes| motion.place(time, nodes))?;
            iterations += outcome.iterations;
            products += outcome.products;
            builds += outcome.builds;
            failed += usize::from(!outcome.converged);
            let e = &run.solver.equations;
            walls.follow(&e.level, &run.grid.now);
            let loads = integrate(
                &walls.pressures(&e.level, &e.sides, &settings.flow),
                &settings.flow,
                &settings.reference,
            )
            .total;
            let angle = std::f64::consts::TAU * ((n + 1) as f64) / steps;
            // alpha = Re(-i a e^{i w t}): sine in phase, cosine ahead by a quarter.
            for (sum, c) in sums.iter_mut().zip([loads.cl, loads.cm]) {
                sum[0] += c * angle.sin() * 2.0 / steps;
                sum[1] += c * angle.cos() * 2.0 / steps;
            }
            if args.len() > 8 {
                println!("{n:3} {outcome:?}  CL {:.6}", loads.cl);
            }
        }
        let a = 1.0_f64.to_radians();
        println!(
            "cycle {cycle}: {:.2} s of CPU time, {:.2} s, {iterations} Newton, {products} products, {builds} builds, {failed} not converged; CL {:.5} {:+.5} i  CM {:.5} {:+.5} i a radian",
            begin.elapsed().as_secs_f64(),
            wall.elapsed().as_secs_f64(),
            sums[0][0] / a,
            sums[0][1] / a,
            sums[1][0] / a,
            sums[1][1] / a
        );
    }
    Ok(())
}
