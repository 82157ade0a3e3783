//! Steady Euler flow from a mesh recipe or box of options:
//!
//! `cargo run --release -p dip-pmb --example steady -- meshes/agard445_ch_euler.toml --mach 0.96 --alpha 1`
//!
//! Options: `--mach M --alpha DEG --area S --chord C --x X --limiter K --orders N --levels N --blocks N
//! --restart FILE --resume --cut Y --csv FILE --aerofoil SURFACE,NORMAL,WAKE (NACA 0012 C grid instead of a recipe)`

use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use dip_grid::generate::{AerofoilGrid, AerofoilKind};
use dip_grid::geometry::{Section, TrailingEdge};
use dip_grid::{MultiBlock, recipe, split};
use dip_pmb::cut::cut;
use dip_pmb::observer::{Observer, Progress};
use dip_pmb::reconstruct::Reconstruction;
use dip_pmb::settings::{FarField, SteadySettings};
use dip_pmb::steady;

struct Print;

impl Observer for Print {
    fn progress(&mut self, p: &Progress) {
        eprintln!(
            "level {} step {:4}  CFL {:9.2e}  orders {:6.2}  CL {:10.6}  CD {:10.6}  CM {:10.6}  products {:3} ({:.0e})  part {:.2}  {:.2} s, {:.1} s left",
            p.level,
            p.step,
            p.cfl,
            p.orders,
            p.cl,
            p.cd,
            p.cm,
            p.products,
            p.linear_reduction,
            p.part,
            p.seconds,
            p.seconds_left
        );
    }
    fn message(&mut self, text: &str) {
        eprintln!("{text}");
    }
}

fn naca0012(cells: &str) -> Result<MultiBlock, Box<dyn Error>> {
    let n: Vec<usize> = cells.split(',').map(str::parse).collect::<Result<_, _>>()?;
    let [surface, normal, wake] = n[..] else {
        return Err("--aerofoil needs SURFACE,NORMAL,WAKE".into());
    };
    let fine = 128.0 / surface as f64;
    Ok(AerofoilGrid {
        kind: AerofoilKind::C,
        section: Section::naca4("0012")?.with_trailing_edge(TrailingEdge::Closed)?,
        chord: 1.0,
        surface,
        wake,
        normal,
        base: 4,
        wall_spacing: 0.003 * fine,
        nose_spacing: 0.003 * fine,
        tail_spacing: 0.004 * fine,
        far_field: 50.0,
        wake_growth: 0.1,
        growth_limit: 2.0,
    }
    .make()?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut settings = SteadySettings::default();
    let mut grid = None;
    let (mut blocks, mut cuts, mut csv) = (0, Vec::new(), None);
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        let mut value = || args.next().ok_or_else(|| format!("{arg} needs a value"));
        match arg.as_str() {
            "--mach" => settings.flow.mach = value()?.parse()?,
            "--alpha" => settings.flow.alpha_deg = value()?.parse()?,
            "--area" => settings.reference.area = value()?.parse()?,
            "--chord" => settings.reference.chord = value()?.parse()?,
            "--x" => settings.reference.moment_point[0] = value()?.parse()?,
            "--limiter" => settings.limiter_constant = value()?.parse()?,
            "--koren" => settings.reconstruction = Reconstruction::Koren,
            "--unlimited" => settings.reconstruction = Reconstruction::Unlimited,
            "--vortex" => settings.far_field = FarField::Vortex,
            "--orders" => settings.solver.orders = value()?.parse()?,
            "--levels" => settings.solver.levels = value()?.parse()?,
            "--cfl" => settings.solver.cfl_start = value()?.parse()?,
            "--growth" => settings.solver.cfl_growth = value()?.parse()?,
            "--coarse-orders" => settings.solver.coarse_orders = value()?.parse()?,
            "--directions" => settings.solver.directions = value()?.parse()?,
            "--products" => settings.solver.max_products = value()?.parse()?,
            "--steps" => settings.solver.max_steps = value()?.parse()?,
            "--blocks" => blocks = value()?.parse()?,
            "--restart" => settings.restart = Some(value()?.into()),
            "--resume" => settings.resume = true,
            "--cut" => cuts.push(value()?.parse::<f64>()?),
            "--csv" => csv = Some(value()?),
            "--aerofoil" => grid = Some(naca0012(&value()?)?),
            path => grid = Some(recipe::make(Path::new(path))?),
        }
    }
    let mut grid = grid.ok_or("a mesh recipe or --aerofoil is needed")?;
    if blocks > 0 {
        split::split_into(&mut grid, blocks);
    }
    let cancel = AtomicBool::new(false);
    let result = steady::run(&settings, &grid, &mut Print, &cancel)?;
    println!(
        "stopped: {:?} after {} steps, {:.2} orders",
        result.stop,
        result.history.len(),
        result.orders
    );
    println!("{:.0} bytes a cell in the large arrays", result.bytes_per_cell);
    let print = |name: &str, c: &dip_pmb::loads::Coefficients| {
        println!(
            "{name:<16} CL {:.6}  CD {:.6}  CY {:.6}  CM {:.6}",
            c.cl, c.cd, c.cy, c.cm
        );
    };
    for (name, c) in &result.loads.patches {
        print(name, c);
    }
    print("total", &result.loads.total);
    if let Some(path) = csv {
        let mut text = String::from("y,side,x,z,cp\n");
        for y in cuts {
            let cut = cut(&result.walls, y, result.planar);
            for (side, points) in [("upper", &cut.upper), ("lower", &cut.lower)] {
                for [x, z, cp] in points {
                    text += &format!("{y},{side},{x},{z},{cp}\n");
                }
            }
        }
        std::fs::write(path, text)?;
    }
    Ok(())
}
