//! Times a coupled march of AGARD 445.6 with Yates' modes at given densities:
//! `cargo run --release -p dip-pmb --example time_march -- RECIPE MACH SPEED STEPS_PER_CYCLE ORDERS CYCLES DENSITY...`
//! (a cycle is one of 14 Hz; initial velocity in mode 1).

use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use dip_flutter::decay::{DecaySettings, identify};
use dip_grid::recipe;
use dip_modal::{
    Attachment, GridModes, Integrator, ModalEquations, ModalState, Modes, MovingWall, StepScheme, StructuralSurface,
    TableOptions, Transfer,
};
use dip_pmb::couple::{Coupled, Coupling, Stream, Structure};
use dip_pmb::dual_time::DualTimeSettings;
use dip_pmb::moving::Nodes;
use dip_pmb::observer::Silent;
use dip_pmb::settings::{Reference, SteadySettings};
use dip_pmb::steady;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let number = |n: usize| args[n].parse::<f64>();
    let grid = recipe::make(Path::new(&args[0]))?;
    let (mach, speed, steps, orders, cycles) = (number(1)?, number(2)?, number(3)?, number(4)?, number(5)?);
    let table = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../cases/agard445/yates_modes.csv"
    ))?;
    let modes = Modes::from_csv(
        &table,
        &TableOptions {
            length_unit_m: None,
            omega_rad_s: [9.5992, 38.1650, 48.3482, 91.5448, 118.1133]
                .map(|f: f64| f * std::f64::consts::TAU)
                .to_vec(),
            generalized_mass_kg: vec![175.127; 5],
        },
    )?;
    let count = 4;
    let wall = MovingWall::new(&grid, |p| p.condition.is_wall())?;
    let surface = StructuralSurface::of_modes(&modes)?;
    let transfer = Transfer::new(&surface, &wall.points(), Attachment::default())?;
    let shapes: Vec<_> = transfer.modes(&modes)?.into_iter().take(count).collect();
    let begin = Instant::now();
    let fields = GridModes::new(&grid, &wall, &shapes, None)?;
    println!("grid modes {:.2} s", begin.elapsed().as_secs_f64());
    let shapes: Vec<Nodes> = (0..count)
        .map(|m| Nodes {
            blocks: (0..grid.blocks.len()).map(|b| fields.field(m, b).clone()).collect(),
        })
        .collect();
    let mut settings = SteadySettings::default();
    settings.flow.mach = mach;
    settings.reference = Reference {
        area: 0.35315,
        chord: 0.5587,
        moment_point: [0.0; 3],
    };
    settings.solver.orders = 5.0;
    for density in &args[6..] {
        let density: f64 = density.parse()?;
        let begin = Instant::now();
        let result = steady::run(&settings, &grid, &mut Silent, &AtomicBool::new(false))?;
        let steady_seconds = begin.elapsed().as_secs_f64();
        let dt_s = 1.0 / 14.0 / steps;
        let mut start = ModalState::rest(count);
        start.q_dot[0] = 0.1;
        let stream = Stream {
            speed_m_s: speed,
            density_kg_m3: density,
            length_m: 1.0,
        };
        let equations = ModalEquations::from_modes(&modes, count, 0.0)?;
        let mut run = Coupled::new(
            result.solver,
            &grid,
            Nodes::of(&grid),
            Structure {
                integrator: Integrator::new(equations, StepScheme::default(), dt_s, start)?,
                shapes: shapes.clone(),
            },
            stream,
            Coupling::Tight,
            DualTimeSettings {
                dt: stream.time(dt_s),
                orders,
                ..DualTimeSettings::default()
            },
            settings.flow,
            settings.reference,
        )?;
        run.balanced = run.forces();
        let begin = Instant::now();
        let mut q = vec![Vec::new(); count];
        let (mut work, mut iterations, mut products) = (0.0, 0, 0);
        let energy = |s: &ModalState| run_energy(&modes, s);
        let before = energy(run.structure.integrator.state());
        for n in 0..(steps * cycles) as usize {
            let step = run.advance()?;
            work += step.work_j;
            iterations += step.outcome.iterations;
            products += step.outcome.products;
            for (q, v) in q.iter_mut().zip(&step.state.q) {
                q.push(*v);
            }
            if n % 40 == 39 {
                println!(
                    "  {n} q {:.3e} {:.3e} exchange {:.1e} {:?}",
                    step.state.q[0], step.state.q[1], step.exchange, step.outcome
                );
            }
            if n % 20 == 19 && n > 40 {
                let skip = 10;
                let histories: Vec<Vec<f64>> = q.iter().map(|h| h[skip..].to_vec()).collect();
                if let Ok(fit) = identify(&histories, dt_s, &DecaySettings::default()) {
                    let text: Vec<String> = fit
                        .modes
                        .iter()
                        .take(4)
                        .map(|m| {
                            format!(
                                "{:.2} Hz g {:+.4} ({:.0e}, {:.2})",
                                m.freq_hz,
                                m.g,
                                m.sigma_error_rad_s / m.p_rad_s.im,
                                m.confidence
                            )
                        })
                        .collect();
                    println!("  {n}: {}", text.join("; "));
                }
            }
        }
        let after = energy(run.structure.integrator.state());
        println!(
            "density {density}: steady {steady_seconds:.1} s, march {:.1} s, {iterations} pseudo steps, {products} products; work {work:.4e} J, energy {:.4e} J",
            begin.elapsed().as_secs_f64(),
            after - before
        );
    }
    Ok(())
}

fn run_energy(modes: &Modes, s: &ModalState) -> f64 {
    (0..s.q.len())
        .map(|m| 0.5 * modes.generalized_mass[m] * (s.q_dot[m].powi(2) + (modes.omega_rad_s[m] * s.q[m]).powi(2)))
        .sum()
}
