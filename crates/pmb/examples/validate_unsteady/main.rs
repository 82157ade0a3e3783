//! Validation of unsteady Euler flow: a thin section against Possio's equation, AGARD R-702's pitching aerofoils, pitching
//! wings. Writes `docs/validation/unsteady/`.
//!
//! `RAYON_NUM_THREADS=1 cargo run --release -p dip-pmb --example validate_unsteady [-- thin limit ct3 ct ct6 agard lann f5 motions]`
//! (all by default; some minutes on one core). With no part that it knows, it only puts the page together.

mod motions;
mod pitching;
mod plates;
mod possio;
mod wing;
mod wings;

use std::error::Error;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use dip_grid::{MultiBlock, recipe};
use dip_report::{Chart, CpCut, Figure, Marker, Series, cp_cuts};
use nalgebra::Complex;

use pitching::{Cycle, Pitching};

type Outcome<T> = Result<T, Box<dyn Error>>;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn mesh(name: &str) -> Outcome<MultiBlock> {
    Ok(recipe::make(&root().join("meshes").join(format!("{name}.toml")))?)
}

/// A complex number in a table.
fn complex(c: Complex<f64>) -> String {
    format!("{:.4} {:+.4}i", c.re, c.im)
}

const CT_HEADER: &str = "| case | cells | steps | orders | CL mean | CL harmonic | CM mean | CM harmonic | cycles | change, % | Newton | products | not converged |\n\
                         |---|---|---|---|---|---|---|---|---|---|---|---|---|\n";

/// Runs a case and writes its row.
fn row(text: &mut String, name: &str, case: &Pitching, grid: &MultiBlock) -> Outcome<Cycle> {
    let cycle = case.run(grid)?;
    writeln!(
        text,
        "| {name} | {} | {} | {} | {:.4} | {} | {:.4} | {} | {} | {:.2} | {:.1} | {:.0} | {} |",
        grid.cell_count(),
        case.steps,
        case.orders,
        cycle.means[0],
        complex(cycle.harmonics[0]),
        cycle.means[1],
        complex(cycle.harmonics[1]),
        cycle.cycles,
        100.0 * cycle.change,
        cycle.iterations,
        cycle.products,
        cycle.not_converged,
    )?;
    eprintln!(
        "{name}, {} cells, {} steps: done, change {:.1e}",
        grid.cell_count(),
        case.steps,
        cycle.change
    );
    Ok(cycle)
}

/// Rows of numbers of a file, without its comments and heading.
fn read(name: &str) -> Outcome<Vec<Vec<String>>> {
    let text = fs::read_to_string(root().join("tests/data/flow").join(name))?;
    Ok(text
        .lines()
        .filter(|l| !l.starts_with('#'))
        .skip(1)
        .map(|l| l.split(',').map(str::to_owned).collect())
        .collect())
}

/// Lift and moment over angle.
fn loops(title: &str, curves: &[(&str, &Cycle)], measured: Option<&[[f64; 3]]>) -> Figure {
    let charts = [(1, "CL"), (2, "CM about the quarter chord")]
        .map(|(c, label)| {
            let mut chart = Chart::new("", "Angle of attack, degrees", label);
            for (name, cycle) in curves {
                let points = cycle.loop_points.iter().map(|p| (p[0], p[c])).collect();
                chart = chart.series(Series::line(*name, points));
            }
            if let Some(points) = measured {
                let points = points.iter().map(|p| (p[0], p[c])).collect();
                chart = chart.series(Series::experiment("experiment", points, Marker::Circle));
            }
            chart
        })
        .to_vec();
    Figure::new(title).row(charts)
}

/// Conditions of AGARD R-702, from `unsteady_conditions.csv`; CT3's are those of CFL3D's test case too.
fn conditions(mach: f64, mean_deg: f64, amplitude: f64, k: f64, axis: f64) -> Pitching {
    Pitching {
        mach,
        k,
        mean_deg,
        amplitude,
        axis: Some(axis),
        steps: 40,
        orders: 2.5,
    }
}

/// NACA 0012, CT3, with the experiment.
fn ct3(folder: &Path) -> Outcome<String> {
    let (coarse, fine) = (mesh("naca0012_unsteady")?, mesh("naca0012_unsteady_fine")?);
    let case = conditions(0.6, 4.86, 2.44, 0.081, 0.25);
    let mut text = String::from(CT_HEADER);
    for steps in [20, 80] {
        row(&mut text, "CT3", &Pitching { steps, ..case }, &coarse)?;
    }
    let on_coarse = row(&mut text, "CT3", &case, &coarse)?;
    let on_fine = row(&mut text, "CT3", &case, &fine)?;

    let points: Vec<[f64; 3]> = read("naca0012_CT3_exp_cl_cm_loop.csv")?
        .iter()
        .map(|r| Ok([r[0].parse()?, r[1].parse()?, r[2].parse()?]))
        .collect::<Outcome<_>>()?;
    text += "\n| measured at, deg | phase, deg | CL measured | Euler | difference | CM measured | Euler | difference |\n\
             |---|---|---|---|---|---|---|---|\n";
    let values = |c: usize| -> Vec<f64> { on_fine.loop_points[..case.steps].iter().map(|p| p[c]).collect() };
    let (cl, cm) = (values(1), values(2));
    let mut squares = [0.0; 2];
    for (n, p) in points.iter().enumerate() {
        let count = points.len();
        let rising = points[(n + 1) % count][0] > points[(n + count - 1) % count][0];
        let sine = ((p[0] - 4.86) / 2.44).clamp(-1.0, 1.0).asin();
        let phase = if rising { sine } else { 0.5 * TAU - sine };
        let ours = [Cycle::at_phase(&cl, phase), Cycle::at_phase(&cm, phase)];
        let off = [ours[0] - p[1], ours[1] - p[2]];
        for (s, o) in squares.iter_mut().zip(off) {
            *s += o * o / count as f64;
        }
        writeln!(
            text,
            "| {:.2} | {:.0} | {:.4} | {:.4} | {:+.4} | {:.4} | {:.4} | {:+.4} |",
            p[0],
            phase.rem_euclid(TAU).to_degrees(),
            p[1],
            ours[0],
            off[0],
            p[2],
            ours[1],
            off[1]
        )?;
    }
    writeln!(
        text,
        "\nRoot mean square difference from the experiment: CL {:.3}, CM {:.4}.",
        squares[0].sqrt(),
        squares[1].sqrt()
    )?;
    let figure = loops(
        "NACA 0012, AGARD CT3: Mach 0.6, 4.86 + 2.44 sin, k 0.081",
        &[("Euler, 161 x 33", &on_coarse), ("Euler, 321 x 65", &on_fine)],
        Some(&points),
    );
    fs::write(folder.join("ct3_loops.svg"), figure.svg(1100, 480)?)?;

    let mut cuts = Vec::new();
    for (angle, phase) in [
        ("5.95", ((5.95_f64 - 4.86) / 2.44).asin()),
        ("2.43", 0.5 * TAU - ((2.43_f64 - 4.86) / 2.44).asin()),
    ] {
        let mut measured = Vec::new();
        for r in read(&format!("naca0012_CT3_exp_cp_alpha{angle}.csv"))? {
            measured.push((r[1].parse()?, r[2].parse()?));
        }
        let computed = [("161 x 33", &on_coarse), ("321 x 65", &on_fine)]
            .map(|(name, cycle)| {
                let value = |cp: &[f64]| Cycle::at_phase(cp, phase);
                let mut line = cycle.side(false, value);
                line.reverse();
                line.extend(cycle.side(true, value));
                (format!("Euler, {name}"), line)
            })
            .to_vec();
        cuts.push(CpCut {
            label: format!("{angle} degrees, phase {:.0}", phase.to_degrees()),
            computed,
            measured: vec![("experiment".to_owned(), measured)],
            // Isentropic Cp at Mach 0.6 where the flow is sonic (gamma 1.4).
            critical: Some(2.0 / (1.4 * 0.36) * (((1.0 + 0.2 * 0.36) / 1.2_f64).powf(3.5) - 1.0)),
        });
    }
    let figure = cp_cuts("NACA 0012, AGARD CT3: pressure at two instants", &cuts, 2)?;
    fs::write(folder.join("ct3_cp.svg"), figure.svg(1100, 480)?)?;
    Ok(text)
}

/// NACA 0012, CT1, CT2 and CT5.
fn ct(folder: &Path) -> Outcome<String> {
    let grid = mesh("naca0012_unsteady")?;
    let mut text = String::from(CT_HEADER);
    let one = row(&mut text, "CT1", &conditions(0.6, 2.89, 2.41, 0.0808, 0.25), &grid)?;
    let two = row(&mut text, "CT2", &conditions(0.6, 3.16, 4.59, 0.0811, 0.25), &grid)?;
    let figure = loops(
        "NACA 0012 at Mach 0.6",
        &[
            ("CT1: 2.89 + 2.41 sin, k 0.0808", &one),
            ("CT2: 3.16 + 4.59 sin, k 0.0811", &two),
        ],
        None,
    );
    fs::write(folder.join("ct12_loops.svg"), figure.svg(1100, 480)?)?;
    let case = conditions(0.755, 0.016, 2.51, 0.0814, 0.25);
    let long = row(&mut text, "CT5", &Pitching { steps: 20, ..case }, &grid)?;
    let middle = row(&mut text, "CT5", &case, &grid)?;
    let short = row(&mut text, "CT5", &Pitching { steps: 80, ..case }, &grid)?;
    let figure = loops(
        "NACA 0012, AGARD CT5: Mach 0.755, 0.016 + 2.51 sin, k 0.0814",
        &[("20 steps a cycle", &long), ("40", &middle), ("80", &short)],
        None,
    );
    fs::write(folder.join("ct5_loops.svg"), figure.svg(1100, 480)?)?;
    Ok(text)
}

/// NACA 64A010, CT6: first harmonic of the pressure.
fn ct6(folder: &Path) -> Outcome<String> {
    let (coarse, fine) = (mesh("naca64a010_unsteady")?, mesh("naca64a010_unsteady_fine")?);
    let case = conditions(0.796, 0.0, 1.01, 0.202, 0.248);
    let mut text = String::from(CT_HEADER);
    for steps in [20, 80] {
        row(&mut text, "CT6", &Pitching { steps, ..case }, &coarse)?;
    }
    let on_coarse = row(&mut text, "CT6", &case, &coarse)?;
    let on_fine = row(&mut text, "CT6", &case, &fine)?;
    let amplitude = case.amplitude.to_radians();
    let charts = [
        ("Real part of Cp, a radian", true),
        ("Imaginary part of Cp, a radian", false),
    ]
    .map(|(label, real)| {
        let mut chart = Chart::new("", "x/c", label);
        for (name, cycle) in [("161 x 33", &on_coarse), ("321 x 65", &on_fine)] {
            for (side, upper) in [("upper", true), ("lower", false)] {
                let points = cycle.side(upper, |cp| {
                    let n = cp.len() as f64;
                    cp.iter()
                        .enumerate()
                        .map(|(step, cp)| {
                            let (sin, cos) = (TAU * step as f64 / n).sin_cos();
                            cp * if real { sin } else { cos } * 2.0 / (n * amplitude)
                        })
                        .sum()
                });
                let label = format!("{name}, {side}");
                chart = chart.series(if upper {
                    Series::line(label, points)
                } else {
                    Series::dashed(label, points)
                });
            }
        }
        chart
    })
    .to_vec();
    let figure = Figure::new("NACA 64A010, AGARD CT6: Mach 0.796, 1.01 degrees, k 0.202").row(charts);
    fs::write(folder.join("ct6_cp.svg"), figure.svg(1100, 480)?)?;
    let figure = loops(
        "NACA 64A010, AGARD CT6",
        &[("Euler, 161 x 33", &on_coarse), ("Euler, 321 x 65", &on_fine)],
        None,
    );
    fs::write(folder.join("ct6_loops.svg"), figure.svg(1100, 480)?)?;
    Ok(text)
}

/// The page: what each part shows, its table as last computed, its figures.
fn page(folder: &Path) -> Outcome<()> {
    let table = |name: &str| fs::read_to_string(folder.join(format!("{name}.md"))).unwrap_or_default();
    let text = format!(
        "# Unsteady Euler flow\n\n\
         Made by `cargo run --release -p dip-pmb --example validate_unsteady`; what is exact is tested in\n\
         `crates/pmb/tests/verification/unsteady/`. Reduced frequency k = omega c/(2U). Harmonics are A of a coefficient\n\
         Re(A e^(i omega t)) for a motion Re(e^(i omega t)): real part in phase with the motion, per radian of pitch or per chord of\n\
         plunge. Runs begin from the steady flow at the mean angle and end when lift and moment of two successive cycles differ by\n\
         less than 0.2 % (`change`), or after ten cycles. `steps` are those of a cycle, `orders` the fall of the residual in each; `Newton` and `products` are means a\n\
         step. Where `change` is larger than 0.2 the flow did not become periodic: its harmonics are those of the last cycle\n\
         only, and steps that did not converge are likely why.\n\n\
         ## A thin section against linear theory\n\n\
         {}\n\
         ![Amplitude and phase](thin.svg)\n\n\
         {}\n\
         ## NACA 0012, AGARD CT3\n\n\
         Mach 0.600, 4.86 + 2.44 sin(omega t) degrees about the quarter chord, k 0.0810. Experiment: AGARD R-702 data set 3 (Landon) as\n\
         distributed with CFL3D. The experiment has Re 4.8e6 and a shock at the highest incidence that its boundary layer feels;\n\
         Euler flow has none.\n\n{}\n\
         ![Lift and moment](ct3_loops.svg)\n\n![Pressure](ct3_cp.svg)\n\n\
         ## NACA 0012, AGARD CT1, CT2, CT5\n\n\
         Conditions from memory (`unsteady_conditions.csv`); no measured numbers were at hand, so these show convergence only.\n\n{}\n\
         ![CT1 and CT2](ct12_loops.svg)\n\n![CT5](ct5_loops.svg)\n\n\
         ## NACA 64A010, AGARD CT6\n\n\
         Mach 0.796, 1.01 sin(omega t) degrees about 0.248 c, k 0.202; conditions from memory, no measured numbers at hand.\n\n{}\n\
         ![First harmonic of the pressure](ct6_cp.svg)\n\n![Lift and moment](ct6_loops.svg)\n\n\
         ## AGARD 445.6: cost and accuracy\n\n{}\n\
         ## A wing like that of the F-5\n\n{}\n\
         ![First harmonic of Cp, F-5-like wing](f5_cp.svg)\n\n\
         ## LANN wing\n\n{}\n\
         ![First harmonic of Cp, LANN wing](lann_cp.svg)\n\n\
         ## The wing's pressures beside the lattice's\n\n\
         First harmonics of Cp at three sections of AGARD 445.6 as in the thesis's figure 6.9, beside the doublet lattice's:\n\
         [correction](../correction/README.md).\n\n\
         ## One run or several\n\n{}",
        table("thin"),
        table("limit"),
        table("ct3"),
        table("ct"),
        table("ct6"),
        table("agard"),
        table("f5"),
        table("lann"),
        table("motions"),
    );
    // A figure of a part that has never been run is left out.
    let is_there = |line: &&str| {
        let figure = line
            .strip_prefix("![")
            .and_then(|l| l.split_once("]("))
            .map(|(_, f)| f.trim_end_matches(')'));
        figure.is_none_or(|f| folder.join(f).exists())
    };
    let lines: Vec<&str> = text.lines().filter(is_there).collect();
    fs::write(folder.join("README.md"), lines.join("\n") + "\n")?;
    Ok(())
}

fn main() -> Outcome<()> {
    let folder = root().join("docs/validation/unsteady");
    fs::create_dir_all(&folder)?;
    let asked: Vec<String> = std::env::args().skip(1).collect();
    for (name, work) in [
        ("thin", plates::thin as fn(&Path) -> Outcome<String>),
        ("ct3", ct3),
        ("ct", ct),
        ("ct6", ct6),
        ("limit", plates::limit),
        ("agard", wings::agard),
        ("f5", wings::f5),
        ("lann", wings::lann),
        ("motions", motions::motions),
    ] {
        if asked.is_empty() || asked.iter().any(|a| a == name) {
            let table = work(&folder)?;
            fs::write(folder.join(format!("{name}.md")), table)?;
        }
    }
    page(&folder)
}
