//! Validation of steady Euler flow: NACA 0012, AGARD 445.6, ONERA M6. Writes `docs/validation/euler/`.
//!
//! `cargo run --release -p dip-pmb --example validate_euler [-- naca agard oneram6]` (all by default; some minutes on one core).

use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use dip_grid::generate::{AerofoilGrid, AerofoilKind};
use dip_grid::geometry::{Section, TrailingEdge};
use dip_grid::{MultiBlock, recipe};
use dip_pmb::loads::cut;
use dip_pmb::observer::Silent;
use dip_pmb::settings::{FarField, Reference, SteadySettings};
use dip_pmb::steady::{SteadyResult, run};
use dip_report::{CpCut, cp_cuts, history};

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

/// One run and its row: cells, coefficients, steps, orders, seconds.
fn steady(text: &mut String, name: &str, s: &SteadySettings, grid: &MultiBlock) -> Outcome<SteadyResult> {
    let start = Instant::now();
    let result = run(s, grid, &mut Silent, &AtomicBool::new(false))?;
    let t = &result.loads.total;
    writeln!(
        text,
        "| {name} | {} | {:.3} | {:.2} | {:.5} | {:.5} | {:.5} | {:.1} | {} | {:?} | {} |",
        grid.cell_count(),
        s.flow.mach,
        s.flow.alpha_deg,
        t.cl,
        t.cd,
        t.cm,
        result.orders,
        result.history.len(),
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

const HEADER: &str = "| case | cells | Mach | alpha | CL | CD | CM | orders | steps | stopped | limiter |\n\
                      |---|---|---|---|---|---|---|---|---|---|---|\n";

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

fn naca0012(surface: usize) -> Outcome<MultiBlock> {
    let h = 128.0 / surface as f64;
    Ok(AerofoilGrid {
        kind: AerofoilKind::C,
        section: Section::naca4("0012")?.with_trailing_edge(TrailingEdge::Closed)?,
        chord: 1.0,
        surface,
        wake: surface / 2,
        normal: surface / 2,
        base: 4,
        wall_spacing: 0.003 * h,
        nose_spacing: 0.002 * h,
        tail_spacing: 0.002 * h,
        far_field: 50.0,
        wake_growth: 0.1,
        growth_limit: 2.0,
    }
    .make()?)
}

fn naca(folder: &Path) -> Outcome<String> {
    let mut text = String::from(HEADER);
    let reference = Reference {
        area: 1.0,
        chord: 1.0,
        moment_point: [0.25, 0.0, 0.0],
    };
    let mut cuts = Vec::new();
    for (mach, alpha) in [(0.5, 1.25), (0.8, 1.25)] {
        let mut computed = Vec::new();
        for surface in [80, 160, 320] {
            let grid = naca0012(surface)?;
            let mut s = settings(mach, alpha, reference);
            s.far_field = FarField::Vortex;
            let result = steady(&mut text, &format!("NACA 0012, {surface} cells a side"), &s, &grid)?;
            computed.push((format!("{} cells", grid.cell_count()), curve(&result, 0.0, 0.0, 1.0)));
            if surface == 160 {
                let name = format!("naca0012_m{:.0}_history.svg", 100.0 * mach);
                write_history(
                    folder,
                    &name,
                    &format!("NACA 0012, Mach {mach}, {alpha} degrees"),
                    &result,
                )?;
            }
        }
        cuts.push(CpCut {
            label: format!("Mach {mach}, {alpha} degrees"),
            computed,
            ..CpCut::default()
        });
    }
    fs::write(
        folder.join("naca0012_cp.svg"),
        cp_cuts("NACA 0012", &cuts, 2)?.svg(1100, 480)?,
    )?;
    Ok(text)
}

fn agard(folder: &Path) -> Outcome<String> {
    let mut text = String::from(HEADER);
    // Yates 1988 (NASA TM-100492): semispan 0.762 m, root chord 0.5587 m, tip chord 0.3682 m, quarter-chord sweep 45.
    let (span, root_chord, tip_chord) = (0.762, 0.5587, 0.3682);
    let leading = |eta: f64| {
        let sweep = (span + 0.25 * (root_chord - tip_chord)) / span;
        eta * span * sweep
    };
    let reference = Reference {
        area: 0.5 * (root_chord + tip_chord) * span,
        chord: root_chord,
        moment_point: [0.25 * root_chord, 0.0, 0.0],
    };
    // Coarse grids at both angles; the medium ones, four to eight times as large, at 1 degree.
    let grids = [
        ("meshes/agard445_ch_euler.toml", "C-H coarse", &[0.0, 1.0][..]),
        ("meshes/agard445_oo_coarse.toml", "O-O coarse", &[0.0, 1.0]),
        ("tests/data/flow/agard445_ch_euler_medium.toml", "C-H medium", &[1.0]),
        ("meshes/agard445_oo_medium.toml", "O-O medium", &[1.0]),
    ];
    for mach in [0.678, 0.901, 0.96, 1.072] {
        let mut cuts: Vec<CpCut> = [0.26, 0.52, 0.76, 0.96]
            .iter()
            .map(|eta| CpCut {
                label: format!("eta {eta}"),
                ..CpCut::default()
            })
            .collect();
        for (path, name, angles) in grids {
            let grid = recipe::make(&root().join(path))?;
            for &alpha in angles {
                let result = steady(&mut text, name, &settings(mach, alpha, reference), &grid)?;
                if alpha == 1.0 {
                    for (cut, eta) in cuts.iter_mut().zip([0.26, 0.52, 0.76, 0.96]) {
                        let chord = root_chord + eta * (tip_chord - root_chord);
                        cut.computed
                            .push((name.to_owned(), curve(&result, eta * span, leading(eta), chord)));
                    }
                    if name == grids[0].1 {
                        let file = format!("agard445_m{:.0}_history.svg", 1000.0 * mach);
                        write_history(folder, &file, &format!("AGARD 445.6, Mach {mach}, 1 degree"), &result)?;
                    }
                }
            }
        }
        let file = format!("agard445_m{:.0}_cp.svg", 1000.0 * mach);
        let title = format!("AGARD 445.6, Mach {mach}, 1 degree");
        fs::write(folder.join(file), cp_cuts(title, &cuts, 2)?.svg(1100, 800)?)?;
    }
    Ok(text)
}

fn oneram6(folder: &Path) -> Outcome<String> {
    let mut text = String::from(HEADER);
    // AGARD AR-138: semispan 1.1963 m, root chord 0.8059 m, taper 0.562, leading-edge sweep 30 degrees.
    let (span, root_chord, taper) = (1.1963, 0.8059, 0.562);
    let reference = Reference {
        area: 0.5 * root_chord * (1.0 + taper) * span,
        chord: 0.64607,
        moment_point: [0.0; 3],
    };
    let data = root().join("tests/data/flow");
    let grid = recipe::make(&data.join("oneram6_ch_euler.toml"))?;
    let result = steady(&mut text, "ONERA M6", &settings(0.84, 3.06, reference), &grid)?;
    write_history(
        folder,
        "oneram6_history.svg",
        "ONERA M6, Mach 0.84, 3.06 degrees",
        &result,
    )?;
    let measured = fs::read_to_string(data.join("oneram6_exp_cp_M0.84_a3.06.csv"))?;
    let mut cuts = Vec::new();
    for eta in [0.2, 0.44, 0.65, 0.8, 0.9, 0.95, 0.99] {
        let (y, chord) = (eta * span, root_chord * (1.0 + eta * (taper - 1.0)));
        let leading = y * 30.0_f64.to_radians().tan();
        let mut points = Vec::new();
        for line in measured.lines().filter(|l| !l.starts_with('#')) {
            let fields: Vec<&str> = line.split(',').collect();
            if let [e, _, _, x, cp] = fields[..]
                && e.parse::<f64>().is_ok_and(|e| (e - eta).abs() < 1e-6)
            {
                points.push((x.parse()?, cp.parse()?));
            }
        }
        cuts.push(CpCut {
            label: format!("2y/b = {eta}"),
            computed: vec![("Euler".to_owned(), curve(&result, y, leading, chord))],
            measured: vec![("experiment".to_owned(), points)],
            critical: None,
        });
    }
    fs::write(
        folder.join("oneram6_cp.svg"),
        cp_cuts("ONERA M6, Mach 0.84, 3.06 degrees", &cuts, 3)?.svg(1200, 1100)?,
    )?;
    Ok(text)
}

/// The page: what each part shows, its table as last computed, its figures.
fn page(folder: &Path) -> Outcome<()> {
    let table = |name: &str| {
        fs::read_to_string(folder.join(format!("{name}.md"))).unwrap_or_else(|_| "not yet run\n".to_owned())
    };
    let mut text = String::from(
        "# Steady Euler flow\n\n\
         Made by `cargo run --release -p dip-pmb --example validate_euler`. All runs use the default settings of the solver; `limiter` is\n\
         the constant of the limiter at the end (5 unless a limit cycle made the run raise it), `orders` the fall of the residual\n\
         from that of the undisturbed stream, `steps` those of all levels, `RoundOff` that the residual reached the round-off of\n\
         its fluxes before ten orders.\n\n\
         ## NACA 0012\n\n\
         C grids of 80, 160 and 320 cells along each side, far field at 50 chords with a point vortex, sharp trailing edge.\n\
         Exact drag at Mach 0.5 is zero: what is left falls with the square of the cell size. At Mach 0.8 published results\n\
         lie at CL 0.347 to 0.356 and CD 0.0220 to 0.0232 (band from memory of Vassberg and Jameson, J. Aircraft 47, 2010;\n\
         their table was not at hand).\n\n",
    );
    text += &table("naca");
    text += "\n![Pressure on the NACA 0012](naca0012_cp.svg)\n\n![History at Mach 0.8](naca0012_m80_history.svg)\n\n\
             ## ONERA M6\n\n\
             Measured pressures: AGARD AR-138, test 2308 (Re 11.7e6). Without a boundary layer the rear shock stands some percent of\n\
             chord aft of the measured one and the pressure at the trailing edge is higher: that is the model, not the scheme.\n\n";
    text += &table("oneram6");
    text += "\n![Pressure on the ONERA M6](oneram6_cp.svg)\n\n![History](oneram6_history.svg)\n\n\
             ## AGARD 445.6\n\n\
             No measured pressures are published for this wing; the grids are compared with each other. NASA's CFL3D and ADflow gave, on\n\
             C-H grids of their own with 53,760 cells at Mach 0.96 and 1 degree, CL 0.0703 to 0.0720 and CD 0.0012 to 0.0026\n\
             depending on the limiter.\n\n";
    text += &table("agard");
    for m in [678, 901, 960, 1072] {
        write!(
            text,
            "\n![Pressure at Mach {:.3}](agard445_m{m}_cp.svg)\n",
            f64::from(m) / 1000.0
        )?;
    }
    text += "\n![History at Mach 0.96](agard445_m960_history.svg)\n";
    fs::write(folder.join("README.md"), text)?;
    Ok(())
}

fn main() -> Outcome<()> {
    let folder = root().join("docs/validation/euler");
    fs::create_dir_all(&folder)?;
    let asked: Vec<String> = std::env::args().skip(1).collect();
    for (name, work) in [
        ("oneram6", oneram6 as fn(&Path) -> Outcome<String>),
        ("naca", naca),
        ("agard", agard),
    ] {
        if asked.is_empty() || asked.iter().any(|a| a == name) {
            let table = work(&folder)?;
            fs::write(folder.join(format!("{name}.md")), table)?;
        }
    }
    page(&folder)
}
