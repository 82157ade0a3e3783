//! Searches the flutter density of AGARD 445.6 with Yates' modes at one Mach number and says what it cost:
//! `cargo run --release -p dip-pmb --example time_search -- RECIPE MACH SPEED STEPS_PER_CYCLE ORDERS FIRST_DENSITY [MODES] [ALPHA]`
//! (a cycle is one of 14 Hz; initial velocity in mode 1).

use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use dip_flutter::decay::{Watch, WatchSettings};
use dip_flutter::search::{Search, SearchSettings, SearchStep, Stability, Trial};
use dip_grid::recipe;
use dip_modal::{
    Attachment, GridModes, ModalEquations, ModalState, Modes, MovingWall, StepScheme, StructuralSurface, TableOptions,
    Transfer,
};
use dip_pmb::couple::{Coupling, Stream};
use dip_pmb::dual_time::DualTimeSettings;
use dip_pmb::march::mean::{DeflectionSettings, deflected, rigid};
use dip_pmb::march::{MarchObserver, MarchSettings, MarchStep, Verdict, Wing, run};
use dip_pmb::observer::{Observer, Progress, Silent};
use dip_pmb::settings::{Reference, SteadySettings};

/// Processor time of the process, seconds (fields 14 and 15 of /proc/self/stat, in ticks of 10 ms).
fn cpu_s() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = text.rsplit(')').next().unwrap_or_default();
    let ticks = after.split_whitespace().skip(11).take(2);
    ticks.filter_map(|t| t.parse::<f64>().ok()).sum::<f64>() / 100.0
}

struct Reader {
    watch: Watch,
    mean: Vec<f64>,
}

impl Observer for Reader {
    fn progress(&mut self, _: &Progress) {}
    fn message(&mut self, text: &str) {
        println!("    {text}");
    }
}

impl MarchObserver for Reader {
    fn step(&mut self, step: &MarchStep<'_>) -> Result<Verdict, String> {
        let q: Vec<f64> = step.state.q.iter().zip(&self.mean).map(|(q, m)| q - m).collect();
        let Some(reading) = self.watch.push(&q) else {
            return Ok(Verdict::GoOn);
        };
        if let Some(m) = reading.modes.first() {
            println!(
                "    {:4}: {:.2} Hz g {:+.4} +- {:.4}, energy {:.2}, residual {:.1e}, {} modes",
                step.number,
                m.freq_hz,
                m.g,
                m.g_error,
                m.energy,
                reading.residual,
                reading.modes.len()
            );
        }
        Ok(if reading.known { Verdict::Enough } else { Verdict::GoOn })
    }
    fn resumed(&mut self, _: usize, _: &[ModalState]) -> Result<(), String> {
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let number = |n: usize| args[n].parse::<f64>();
    let grid = recipe::make(Path::new(&args[0]))?;
    let (mach, speed, steps, orders, first) = (number(1)?, number(2)?, number(3)?, number(4)?, number(5)?);
    let count = args.get(6).map_or(Ok(4), |a| a.parse())?;
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
    let began = cpu_s();
    let wall = MovingWall::new(&grid, |p| p.condition.is_wall())?;
    let surface = StructuralSurface::of_modes(&modes)?;
    let transfer = Transfer::new(&surface, &wall.points(), Attachment::default())?;
    let shapes: Vec<_> = transfer.modes(&modes)?.into_iter().take(count).collect();
    let fields = GridModes::new(&grid, &wall, &shapes, None)?;
    let equations = ModalEquations::from_modes(&modes, count, 0.0)?;
    let wing = Wing::new(equations.clone(), &fields, &grid)?;
    let prepared = cpu_s();
    let mut steady = SteadySettings::default();
    steady.flow.mach = mach;
    steady.flow.alpha_deg = args.get(7).map_or(Ok(0.0), |a| a.parse())?;
    steady.reference = Reference {
        area: 0.35315,
        chord: 0.5587,
        moment_point: [0.0; 3],
    };
    steady.solver.orders = 5.0;
    let never = AtomicBool::new(false);
    let still = rigid(&steady, &grid, count, &mut Silent, &never)?.ok_or("interrupted")?;
    let solved = cpu_s();
    println!(
        "{} cells; structure on the grid {:.2} s, steady flow {:.2} s ({:?}, CL {:.5})",
        grid.cell_count(),
        prepared - began,
        solved - prepared,
        still.stop,
        still.loads.total.cl
    );
    let mut start_rate_1_s = vec![0.0; count];
    start_rate_1_s[0] = 1e-3 * 0.762 * equations.omega_rad_s[0] / wing.largest[0];
    let settings = MarchSettings {
        steady,
        time: DualTimeSettings {
            orders,
            ..DualTimeSettings::default()
        },
        step_s: 1.0 / 14.0 / steps,
        steps: (8.0 * steps) as usize,
        scheme: StepScheme::default(),
        coupling: Coupling::Tight,
        exchange_tolerance: 1e-6,
        start_rate_1_s,
        largest_displacement: 0.2,
        restart: None,
        resume: false,
        checkpoint_steps: 0,
    };
    let mut search = Search::new(
        SearchSettings {
            range: [0.2 * first, 5.0 * first],
            first,
            tolerance: 0.01,
            most_runs: 8,
        },
        Vec::new(),
    )?;
    let end = loop {
        let density = match search.next() {
            SearchStep::Run(density) => density,
            end => break end,
        };
        let begin = cpu_s();
        let stream = Stream {
            speed_m_s: speed,
            density_kg_m3: density,
            length_m: 1.0,
        };
        let mean = deflected(
            &settings.steady,
            &DeflectionSettings::default(),
            &grid,
            &wing,
            &stream,
            &still,
            &never,
        )?
        .ok_or("interrupted")?;
        if mean.exchanges > 0 {
            println!(
                "  deflected in {} exchanges to {:.4} mm (change {:.1e}), CL {:.5}, {:.2} s",
                mean.exchanges,
                1e3 * wing.displacement(&mean.q),
                mean.change,
                mean.loads.total.cl,
                cpu_s() - begin
            );
        }
        let mut reader = Reader {
            watch: Watch::new(WatchSettings::new(
                settings.step_s,
                equations.omega_rad_s.clone(),
                equations.generalized_mass.clone(),
            ))?,
            mean: mean.q.clone(),
        };
        let result = run(&settings, &grid, &wing, stream, &mean, &mut reader, &never)?;
        let reading = reader.watch.reading().ok_or("nothing was read")?;
        let mode = reading.modes.first().ok_or("no mode was read")?;
        println!(
            "  density {density:.5}: {:?} after {} steps, {} pseudo steps, {} products, {} builds; {:.2} Hz g {:+.4} +- {:.4}; {:.2} s",
            result.stop,
            result.states.len() - 1,
            result.iterations,
            result.products,
            result.builds,
            mode.freq_hz,
            mode.g,
            mode.g_error,
            cpu_s() - begin
        );
        search.add(Trial {
            at: density,
            stability: Stability::Oscillation {
                g: mode.g,
                g_error: mode.g_error,
                freq_hz: mode.freq_hz,
            },
        })?;
    };
    println!("{end:?}; {:.2} s of processor time in all", cpu_s() - began);
    Ok(())
}
