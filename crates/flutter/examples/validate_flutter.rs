//! Writes docs/validation/flutter: tables and figures of the flutter solvers against exact answers.
//!
//! `cargo run --release -p dip-flutter --example validate_flutter`

#[path = "../tests/goland/mod.rs"]
mod goland;

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;

use dip_flutter::theodorsen::TypicalSection;
use dip_flutter::{CrossingKind, FlutterProblem, FlutterSolution, Method, Settings, Sweep, solve};
use dip_report::{Cell, Chart, Column, NumberFormat, Series, Table, VgCrossing, VgMode, vg};
use faer::c64;

const DENSITY: f64 = 1.225;
const OMEGA_ALPHA: f64 = 50.0;
const SEMICHORD_M: f64 = 0.5;
const METHODS: [Method; 5] = [Method::K, Method::Ke, Method::Pk, Method::PkHassig, Method::G];

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let out = root.join("docs/validation/flutter");
    std::fs::create_dir_all(&out)?;
    let data = root.join("tests/data/flutter");
    let mut page = String::from(
        "# Flutter solvers against exact answers\n\nMade by `cargo run --release -p dip-flutter --example validate_flutter`. The crate \
         knows no aerodynamics; these cases use Theodorsen's exact incompressible section (NACA Report 496) as Q(k).\n\n",
    );
    page.push_str("## Pitch-plunge sections\n\n");
    page.push_str(&sections(&std::fs::read_to_string(
        data.join("theodorsen_2dof_flutter.csv"),
    )?)?);
    page.push_str("\n## Damping away from the flutter point\n\n");
    page.push_str(&damping_error(&out)?);
    page.push_str("\n## Goland wing\n\n");
    page.push_str(&goland_wing(
        &std::fs::read_to_string(data.join("goland_wing.json"))?,
        &out,
    )?);
    std::fs::write(out.join("README.md"), page)?;
    Ok(())
}

fn run(section: &TypicalSection, method: Method, speeds: &[f64]) -> dip_flutter::Result<FlutterSolution> {
    let structure = section.structure(DENSITY)?;
    let forces = section.forces();
    let problem = FlutterProblem {
        structure: &structure,
        forces: &forces,
        semichord_m: SEMICHORD_M,
        mach: 0.0,
    };
    solve(
        &problem,
        method,
        &Sweep::Speed {
            density_kg_m3: DENSITY,
            speeds_m_s: speeds,
        },
        &Settings::default(),
    )
}

fn linspace(from: f64, to: f64, n: usize) -> Vec<f64> {
    (0..n).map(|j| from + (to - from) * j as f64 / (n - 1) as f64).collect()
}

fn sections(reference: &str) -> Result<String, Box<dyn Error>> {
    let number = |name: &str, digits| Column::number(name, "", NumberFormat::Fixed(digits));
    let mut table = Table::new(
        "",
        vec![
            Column::text("section"),
            Column::text("method"),
            number("U/(b w_a)", 5),
            number("reference", 5),
            number("w/w_a", 5),
            number("reference", 5),
            number("k", 5),
            number("reference", 5),
            number("|g| left x 1e9", 4),
        ],
    );
    for line in reference.lines().filter(|l| l.starts_with('"')) {
        let (label, numbers) = line[1..].split_once('"').ok_or("label")?;
        let value = |key: &str| -> Result<f64, Box<dyn Error>> {
            let rest = &label[label.find(key).ok_or("key")? + key.len()..];
            Ok(rest.split(' ').next().ok_or("value")?.parse()?)
        };
        let answers: Vec<f64> = numbers
            .split(',')
            .skip(1)
            .map(|v| v.trim().parse())
            .collect::<Result<_, _>>()?;
        let section = TypicalSection {
            semichord_m: SEMICHORD_M,
            a: value("a=")?,
            x_alpha: value("x_a=")?,
            r_alpha_squared: value("r2=")?,
            mass_ratio: value("mu=")?,
            omega_h_rad_s: value("wh/wa=")? * OMEGA_ALPHA,
            omega_alpha_rad_s: OMEGA_ALPHA,
        };
        let unit = SEMICHORD_M * OMEGA_ALPHA;
        let speeds = linspace(0.1 * answers[0] * unit, 1.3 * answers[0] * unit, 25);
        for method in METHODS {
            let solution = run(&section, method, &speeds)?;
            let flutter = solution.flutter().ok_or("no flutter")?;
            table.push(vec![
                Cell::from(label),
                Cell::from(method.name()),
                Cell::from(flutter.speed_m_s / unit),
                Cell::from(answers[0]),
                Cell::from(flutter.freq_hz * std::f64::consts::TAU / OMEGA_ALPHA),
                Cell::from(answers[1]),
                Cell::from(flutter.k),
                Cell::from(answers[2]),
                Cell::from(flutter.residual_g.abs() * 1e9),
            ])?;
        }
    }
    Ok(format!(
        "Reference: an independent U-g solution, printed to five decimals (`tests/data/flutter/theodorsen_2dof_flutter.csv`).\n\n{}",
        table.markdown()
    ))
}

/// det [M p^2 + K - q Q(p b / U)] of the section with the exact Q for damped motion.
fn determinant(section: &TypicalSection, p: c64, speed: f64) -> c64 {
    let b = section.semichord_m;
    let q = section.forces().q_laplace(p * b / speed);
    let scale = section.mass_ratio * std::f64::consts::PI * DENSITY * b.powi(4);
    let pressure = 0.5 * DENSITY * speed * speed;
    let (x, r2) = (section.x_alpha, section.r_alpha_squared);
    let p2 = p * p;
    let h = (p2 + section.omega_h_rad_s.powi(2)) * scale - q[0][0] * pressure;
    let alpha = (p2 + section.omega_alpha_rad_s.powi(2)) * r2 * scale - q[1][1] * pressure;
    h * alpha - (p2 * x * scale - q[0][1] * pressure) * (p2 * x * scale - q[1][0] * pressure)
}

fn exact_root(section: &TypicalSection, start: c64, speed: f64) -> c64 {
    let mut p = start;
    for _ in 0..50 {
        let h = 1e-6 * p.norm();
        let slope = (determinant(section, p + h, speed) - determinant(section, p - h, speed)) / (2.0 * h);
        let step = determinant(section, p, speed) / slope;
        p -= step;
        if step.norm() < 1e-13 * p.norm() {
            break;
        }
    }
    p
}

fn damping_error(out: &Path) -> Result<String, Box<dyn Error>> {
    let section = TypicalSection {
        semichord_m: SEMICHORD_M,
        a: -0.2,
        x_alpha: 0.2,
        r_alpha_squared: 0.25,
        mass_ratio: 20.0,
        omega_h_rad_s: 25.0,
        omega_alpha_rad_s: OMEGA_ALPHA,
    };
    let unit = SEMICHORD_M * OMEGA_ALPHA;
    let speeds = linspace(5.0, 60.0, 111);
    let mut chart = Chart::new(
        "g of the flutter mode, section A",
        "U/(b omega_alpha)",
        "g = 2 sigma / omega",
    )
    .hline(0.0, "");
    let mut exact_line = Vec::new();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut flutter_speed = 0.0;
    for method in [Method::G, Method::Pk, Method::PkHassig] {
        let solution = run(&section, method, &speeds)?;
        let flutter = solution.flutter().ok_or("no flutter")?;
        flutter_speed = flutter.speed_m_s;
        let points = &solution.modes[flutter.mode - 1].points;
        let line: Vec<(f64, f64)> = points.iter().map(|p| (p.speed_m_s / unit, p.g)).collect();
        if method == Method::G {
            exact_line = points
                .iter()
                .map(|p| {
                    let exact = exact_root(&section, p.p_rad_s, p.speed_m_s);
                    (p.speed_m_s / unit, 2.0 * exact.re / exact.im)
                })
                .collect();
        }
        chart = chart.series(Series::line(method.name(), line));
        let mut row = Vec::new();
        for factor in [0.90, 0.95, 0.98, 0.99] {
            let solution = run(
                &section,
                method,
                &[5.0, 0.5 * flutter.speed_m_s, factor * flutter.speed_m_s],
            )?;
            let p = solution.modes[flutter.mode - 1]
                .points
                .last()
                .ok_or("no point")?
                .p_rad_s;
            let exact = exact_root(&section, p, factor * flutter.speed_m_s);
            row.push((p - exact).norm() / exact.norm());
        }
        rows.push(row);
    }
    chart = chart.series(Series::dashed("exact (generalized Theodorsen function)", exact_line));
    std::fs::write(
        out.join("damping.svg"),
        chart.x_range(0.8, 2.4).y_range(-0.3, 0.4).svg(720, 420)?,
    )?;
    let number = |name: &str| Column::number(name, "", NumberFormat::Significant(3));
    let mut table = Table::new(
        "",
        vec![
            Column::text("method"),
            number("|p - exact| / |p| at 0.90 U_f"),
            number("0.95 U_f"),
            number("0.98 U_f"),
            number("0.99 U_f"),
            number("order in sigma (last two)"),
        ],
    );
    let exact_sigma = |factor: f64| -> Result<f64, Box<dyn Error>> {
        let solution = run(&section, Method::G, &[5.0, 0.5 * flutter_speed, factor * flutter_speed])?;
        let flutter_mode = run(&section, Method::G, &speeds)?.flutter().ok_or("no flutter")?.mode;
        let p = solution.modes[flutter_mode - 1]
            .points
            .last()
            .ok_or("no point")?
            .p_rad_s;
        Ok(exact_root(&section, p, factor * flutter_speed).re)
    };
    let ratio = (exact_sigma(0.98)? / exact_sigma(0.99)?).ln();
    for (method, row) in [Method::G, Method::Pk, Method::PkHassig].iter().zip(&rows) {
        let mut cells = vec![Cell::from(method.name())];
        cells.extend(row.iter().map(|&v| Cell::from(v)));
        cells.push(Cell::from((row[2] / row[3]).ln() / ratio));
        table.push(cells)?;
    }
    Ok(format!(
        "Section A against the root of the determinant with the generalized Theodorsen function K1/(K0 + K1) (Edwards, Ashley and \
         Breakwell 1979). The g-method is exact to first order in the damping, both p-k forms are not (Chen 2000).\n\n{}\n\
         ![damping](damping.svg)\n",
        table.markdown()
    ))
}

fn goland_wing(json: &str, out: &Path) -> Result<String, Box<dyn Error>> {
    let mut table = Table::new(
        "",
        vec![
            Column::text("density"),
            Column::text("method"),
            Column::number("flutter speed", "m/s", NumberFormat::Fixed(2)),
            Column::number("frequency", "rad/s", NumberFormat::Fixed(2)),
            Column::number("k", "", NumberFormat::Fixed(4)),
            Column::number("U dg/dU", "", NumberFormat::Fixed(2)),
            Column::text("quoted"),
        ],
    );
    let speeds = linspace(10.0, 200.0, 20);
    let mut notes = String::new();
    for (density, quoted) in [(1.225, "137.2 m/s, 70.7 rad/s"), (1.02, "")] {
        let mut wing = goland::Wing::read(json);
        wing.density_kg_m3 = density;
        let (structure, forces) = wing.model(5, 5);
        let problem = FlutterProblem {
            structure: &structure,
            forces: &forces,
            semichord_m: wing.semichord_m(),
            mach: 0.0,
        };
        for method in METHODS {
            let sweep = Sweep::Speed {
                density_kg_m3: wing.density_kg_m3,
                speeds_m_s: &speeds,
            };
            let solution = solve(&problem, method, &sweep, &Settings::default())?;
            let flutter = solution.flutter().ok_or("no flutter")?;
            table.push(vec![
                Cell::from(format!("{density} kg/m3")),
                Cell::from(method.name()),
                Cell::from(flutter.speed_m_s),
                Cell::from(flutter.freq_hz * std::f64::consts::TAU),
                Cell::from(flutter.k),
                Cell::from(flutter.slope),
                Cell::from(quoted),
            ])?;
            if density == 1.225 && matches!(method, Method::Pk | Method::K) {
                let name = format!("goland_{}.svg", method.name().to_lowercase());
                let figure = vg_figure(&format!("Goland wing, {method}"), &solution)?;
                std::fs::write(out.join(&name), figure)?;
                let _ = writeln!(notes, "\n![V-g and V-f by {method}]({name})");
            }
        }
    }
    Ok(format!(
        "Uniform cantilever, five bending and five torsion modes, Theodorsen's section at every station. The quoted exact strip \
         solution (Goland 1945, quoted from memory in `tests/data/flutter/flutter_cases.csv`) belongs to sea level; \
         `goland_wing.json` carries the 1.02 kg/m3 of a later study.\n\n{}{notes}",
        table.markdown()
    ))
}

fn vg_figure(title: &str, solution: &FlutterSolution) -> Result<String, Box<dyn Error>> {
    let modes: Vec<VgMode> = solution
        .modes
        .iter()
        .take(4)
        .map(|m| VgMode {
            label: format!("mode {}", m.mode),
            speed_m_s: m.points.iter().map(|p| p.speed_m_s).collect(),
            damping_g: m.points.iter().map(|p| p.g).collect(),
            freq_hz: m.points.iter().map(|p| p.freq_hz).collect(),
        })
        .collect();
    let crossings: Vec<VgCrossing> = solution
        .crossings
        .iter()
        .map(|c| VgCrossing {
            kind: match c.kind {
                CrossingKind::Flutter => dip_report::CrossingKind::Flutter,
                CrossingKind::Divergence => dip_report::CrossingKind::Divergence,
            },
            speed_m_s: c.speed_m_s,
            freq_hz: c.freq_hz,
            damping_g: 0.0,
        })
        .collect();
    Ok(vg(title, &modes, &crossings)?.svg(760, 620)?)
}
