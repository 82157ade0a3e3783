//! Validation of steady Euler flow: order of accuracy, NACA 0012, ONERA M6, AGARD 445.6, convergence on all shipped grids.
//! Writes `docs/validation/euler/`.
//!
//! `cargo run --release -p dip-pmb --example validate_euler [-- oneram6 naca shipped order limiters agard]` (all by default; half an hour
//! of one core).

mod agard;
mod limiters;
mod naca;
mod oneram6;
mod order;
mod shipped;

use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use cpu_time::ProcessTime;
use dip_grid::MultiBlock;
use dip_pmb::cut::cut;
use dip_pmb::observer::Silent;
use dip_pmb::settings::{Reference, SteadySettings};
use dip_pmb::steady::{SteadyResult, run};
use dip_report::history;

type Outcome<T> = Result<T, Box<dyn Error>>;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn settings(mach: f64, alpha_deg: f64, reference: Reference) -> SteadySettings {
    let mut s = SteadySettings {
        reference,
        ..SteadySettings::default()
    };
    s.flow.mach = mach;
    s.flow.alpha_deg = alpha_deg;
    s
}

/// One run and its row: cells, coefficients, orders, steps, products with the operator on the finest level, seconds of CPU time.
fn steady(text: &mut String, name: &str, s: &SteadySettings, grid: &MultiBlock) -> Outcome<SteadyResult> {
    let start = ProcessTime::now();
    let result = run(s, grid, &mut Silent, &AtomicBool::new(false))?;
    let t = &result.loads.total;
    writeln!(
        text,
        "| {name} | {} | {:.3} | {:.2} | {:.5} | {:.5} | {:.5} | {:.2} | {} | {} | {:.1} | {:?} | {} |",
        grid.cell_count(),
        s.flow.mach,
        s.flow.alpha_deg,
        t.cl,
        t.cd,
        t.cm,
        result.orders,
        result.history.len(),
        result
            .history
            .iter()
            .filter(|p| p.level == 0)
            .map(|p| p.products)
            .sum::<usize>(),
        start.elapsed().as_secs_f64(),
        result.stop,
        result.limiter_constant,
    )?;
    eprintln!(
        "{name}: {:?}, {:.1} orders, {:.1} s",
        result.stop,
        result.orders,
        start.elapsed().as_secs_f64()
    );
    Ok(result)
}

const HEADER: &str = "| case | cells | Mach | alpha | CL | CD | CM | orders | steps | products | CPU s | stopped | limiter |\n\
                      |---|---|---|---|---|---|---|---|---|---|---|---|---|\n";

fn write_history(folder: &Path, name: &str, title: &str, result: &SteadyResult) -> Outcome<()> {
    let fine: Vec<_> = result.history.iter().collect();
    let residual = fine.iter().map(|p| (p.step as f64, 10.0_f64.powf(-p.orders))).collect();
    let load = |f: &dyn Fn(&dip_pmb::observer::Progress) -> f64| fine.iter().map(|p| (p.step as f64, f(p))).collect();
    let figure = history(
        title,
        "Step (all levels)",
        &[("residual over that of the undisturbed stream".to_owned(), residual)],
        &[("CL".to_owned(), load(&|p| p.cl)), ("CD".to_owned(), load(&|p| p.cd))],
        None,
    )?;
    fs::write(folder.join(name), figure.svg(900, 600)?)?;
    Ok(())
}

/// Cp against x/c of both sides, in order round the section.
fn curve(result: &SteadyResult, y: f64, leading: f64, chord: f64) -> Vec<(f64, f64)> {
    let c = cut(&result.walls, y, result.planar);
    let point = |p: &[f64; 3]| ((p[0] - leading) / chord, p[2]);
    c.lower
        .iter()
        .rev()
        .map(point)
        .chain(c.upper.iter().map(point))
        .collect()
}

/// The page: what each part shows, its table as last computed, its figures.
fn page(folder: &Path) -> Outcome<()> {
    let table = |name: &str| {
        fs::read_to_string(folder.join(format!("{name}.md"))).unwrap_or_else(|_| "not yet run\n".to_owned())
    };
    let mut text = String::from(
        "# Steady Euler flow\n\n\
         Made by `scripts/validate euler`. All runs use the default settings of the solver. In the tables `orders` is the fall of the\n\
         residual from that of the undisturbed stream, `steps` are those of all levels, `products` those with the operator on the\n\
         finest level, `CPU s` the seconds of all threads without the grid, `limiter` the constant of the limiter at the end (5\n\
         unless a limit cycle made the run raise it). `RoundOff` says that the residual reached the round-off of its fluxes before\n\
         ten orders.\n\n\
         ## Order of accuracy\n\n",
    );
    text += &table("order");
    text += "\n![Error against cells](order.svg)\n\n\
         ## NACA 0012\n\n\
         C grids of 80, 160 and 320 cells along each side, far field at 50 chords with a point vortex, sharp trailing edge.\n\
         Exact drag at Mach 0.5 is zero: what is left falls with the square of the cell size. At Mach 0.8 published results\n\
         lie at CL 0.347 to 0.356 and CD 0.0220 to 0.0232 (band from memory of Vassberg and Jameson, J. Aircraft 47, 2010;\n\
         their table was not at hand).\n\n";
    text += &table("naca");
    text += "\n![Pressure on the NACA 0012](naca0012_cp.svg)\n\n![History at Mach 0.8](naca0012_m80_history.svg)\n\n\
             ## ONERA M6\n\n\
             Measured pressures: AGARD AR-138, test 2308 (Re 11.7e6). Without a boundary layer the rear shock stands some percent of\n\
             chord aft of the measured one and the pressure at the trailing edge is higher: that is the model, not the scheme.\n\n";
    text += &table("oneram6");
    text += "\n![Pressure on the ONERA M6](oneram6_cp.svg)\n\n![History](oneram6_history.svg)\n\n\
             ## AGARD 445.6\n\n\
             No measured pressures are published for this wing; the grids are compared with each other. On C-H grids of their own with\n\
             53,760 cells, at Mach 0.96 and 1 degree, CL / CD are 0.07204 / 0.00183 by NASA's CFL3D (smooth limiter), 0.07034 / 0.00255 by\n\
             ADflow (van Albada), 0.07123 / 0.00123 by ADflow without limiter. Ours depend on the constant of the limiter as theirs do\n\
             (`docs/performance.md` has them for other constants); the table has the default, 5. The medium O-O grid has twice the cells of the coarse\n\
             one along each direction, the medium C-H grid half as many again.\n\n";
    text += &table("agard");
    for m in [678, 901, 960, 1072] {
        for alpha in [0, 1] {
            let mach = f64::from(m) / 1000.0;
            write!(
                text,
                "\n![Pressure at Mach {mach:.3}, {alpha} degrees](agard445_m{m}_a{alpha}_cp.svg)\n"
            )?;
        }
    }
    text += "\n![History at Mach 0.96](agard445_m960_history.svg)\n\n\
             ## Limiters\n\n\
             Van Albada's limiter (default) and Koren's of the third-order upwind-biased scheme (`reconstruction = \"koren\"`), both with the default\n\
             constant, 5.\n\n";
    text += &table("limiters");
    text += "\n## Convergence on all shipped grids\n\n\
             The aerofoils at the inviscid conditions of AGARD AR-211 and others, the wing over its range of Mach numbers; coefficients are of\n\
             an area and a chord of one grid unit. By default settings, no number changed for any case. `rae2822_c` is a grid for viscous flow (first cells of\n\
             y+ 1), shown for what it does to inviscid flow: the residual hangs.\n\n";
    text += &table("shipped");
    fs::write(folder.join("README.md"), text)?;
    Ok(())
}

fn main() -> Outcome<()> {
    let folder = root().join("docs/validation/euler");
    fs::create_dir_all(&folder)?;
    // `page` alone puts the page together from the tables that are there.
    let asked: Vec<String> = std::env::args().skip(1).collect();
    for (name, work) in [
        ("oneram6", oneram6::oneram6 as fn(&Path) -> Outcome<String>),
        ("naca", naca::naca),
        ("shipped", shipped::shipped),
        ("order", order::order),
        ("limiters", limiters::limiters),
        ("agard", agard::agard),
    ] {
        if asked.is_empty() || asked.iter().any(|a| a == name) {
            let table = work(&folder)?;
            fs::write(folder.join(format!("{name}.md")), table)?;
            page(&folder)?;
        }
    }
    page(&folder)
}
