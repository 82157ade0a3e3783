//! Pitching wings: what a cycle costs and how good its harmonics are; convergence in step, cycle and grid.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use dip_report::{Chart, Figure, Series};
use nalgebra::Complex;

use dip_pmb::dual_time::TimeScheme;

use crate::wing::{Start, Wing, WingCycle};
use crate::{Outcome, complex, mesh};

/// Value without error of the step from those of a step and half of it (second order).
fn without_step(long: Complex<f64>, short: Complex<f64>) -> Complex<f64> {
    short + (short - long) / 3.0
}

fn percent(ours: Complex<f64>, exact: Complex<f64>) -> f64 {
    100.0 * (ours - exact).norm() / exact.norm()
}

/// The yardstick: AGARD 445.6 at Mach 0.678, k 0.244 as others ran it.
pub fn agard(_: &Path) -> Outcome<String> {
    let grid = mesh("agard445_ch_euler")?;
    let wing = Wing {
        mach: 0.678,
        alpha_deg: 0.0,
        k: 0.244,
        amplitude_deg: 1.0,
        chord: 0.5588,
        area: 0.353,
        axis: 0.5,
    };
    let start = Start::new(wing, &grid)?;
    let mut plan = Vec::new();
    for steps in [20, 40, 80] {
        for orders in [1.0, 1.5, 2.5, 4.0] {
            plan.push((TimeScheme::Bdf2, steps, orders));
        }
    }
    for (steps, orders) in [(40, 1.5), (48, 1.5), (52, 1.5), (40, 2.5), (48, 2.5), (80, 4.0)] {
        plan.push((TimeScheme::Bdf2Opt, steps, orders));
    }
    let mut rows: Vec<((TimeScheme, usize, f64), Vec<WingCycle>)> = Vec::new();
    for (scheme, steps, orders) in plan {
        rows.push(((scheme, steps, orders), start.run(scheme, steps, orders, 2)?));
        eprintln!("agard, {scheme:?}, {steps} steps, {orders} orders: done");
    }
    let of = |which: (TimeScheme, usize, f64), c: usize| {
        let row = rows.iter().find(|r| r.0 == which);
        row.and_then(|r| r.1.last())
            .map_or(Complex::new(f64::NAN, 0.0), |l| l.harmonics[c])
    };
    let exact = [0, 1].map(|c| without_step(of((TimeScheme::Bdf2, 40, 4.0), c), of((TimeScheme::Bdf2, 80, 4.0), c)));
    // The other scheme's finest run with its known part of the error taken off: how well the limit is known.
    let checked = [0, 1].map(|c| {
        let ours = of((TimeScheme::Bdf2Opt, 80, 4.0), c);
        let theirs = of((TimeScheme::Bdf2, 80, 4.0), c);
        percent(ours + (ours - theirs) * (0.52 / 0.48), exact[c])
    });
    let mut text = format!(
        "Rigid pitch of 1 degree about the root mid-chord, Mach 0.678, k 0.244 (root semichord), {} cells\n\
         (`meshes/agard445_ch_euler.toml`), second cycle, per radian. CPU time is that of all threads, a mean over both cycles; the\n\
         steady start took {:.1} s. Differences are those of the complex harmonic from CL {}, CM {}: `bdf2`, 4 orders\n\
         a step, 40 and 80 steps a cycle taken to the limit of no step (from `bdf2` and `bdf2-opt` with 80 steps the limit differs by\n\
         {:.3} % and {:.3} %). `in a step` is the difference from 4 orders with the same steps. CFL3D on a grid of as many cells, one\n\
         core: 9.2 s a cycle at 40 steps and 1.65 orders (lift within 0.2 % of its value with converged steps: the column `CL in a step`),\n\
         18 to 19 s at 2.7 orders, 4.7 s at 20 steps (imaginary part 1.4 % off).\n\n\
         | scheme | steps | orders | CPU s a cycle | Newton | products | CL | CM | CL off, % | CM off, % | CL in a step, % | CM in a step, % | not converged |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
        grid.cell_count(),
        start.cpu_s,
        complex(exact[0]),
        complex(exact[1]),
        checked[0],
        checked[1],
    );
    for ((scheme, steps, orders), cycles) in &rows {
        let Some(last) = cycles.last() else { continue };
        let n = cycles.len() as f64;
        let cpu_s = cycles.iter().map(|c| c.cpu_s).sum::<f64>() / n;
        let [cl, cm] = last.harmonics;
        let deep = |c: usize| of((*scheme, *steps, 4.0), c);
        let inside = |ours: Complex<f64>, deep: Complex<f64>| {
            if deep.re.is_nan() {
                "-".to_owned()
            } else {
                format!("{:.2}", percent(ours, deep))
            }
        };
        let name = match scheme {
            TimeScheme::Bdf1 => "bdf1",
            TimeScheme::Bdf2 => "bdf2",
            TimeScheme::Bdf2Opt => "bdf2-opt",
        };
        writeln!(
            text,
            "| {name} | {steps} | {orders} | {cpu_s:.2} | {} | {} | {} | {} | {:.2} | {:.2} | {} | {} | {} |",
            last.iterations,
            last.products,
            complex(cl),
            complex(cm),
            percent(cl, exact[0]),
            percent(cm, exact[1]),
            inside(cl, deep(0)),
            inside(cm, deep(1)),
            cycles.iter().map(|c| c.not_converged).sum::<usize>(),
        )?;
    }
    Ok(text)
}

/// What a wing's runs are called in tables and figures.
struct Names {
    title: &'static str,
    file: &'static str,
    recipe: &'static str,
}

/// Steps, cycles and grids of one wing, and its pressures at stations (m from the root).
fn converge(folder: &Path, names: &Names, wing: Wing, stations: &[(&str, f64)]) -> Outcome<String> {
    let (fine, coarse) = (mesh(names.recipe)?, mesh(&format!("{}_coarse", names.recipe))?);
    let mut text = String::from(
        "| cells | steps | cycle | CL | CM | CL off the next cycle, % | CM off, % | CPU s a cycle | not converged |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    let mut curves: Vec<(String, WingCycle)> = Vec::new();
    for (grid, all_steps) in [(&coarse, &[20, 40, 80][..]), (&fine, &[20, 40][..])] {
        let start = Start::new(wing, grid)?;
        eprintln!(
            "{}, {} cells: steady {}, {:.1} s",
            names.title,
            grid.cell_count(),
            start.stop,
            start.cpu_s
        );
        for steps in all_steps {
            let cycles = start.run(TimeScheme::Bdf2, *steps, 2.5, 3)?;
            for (n, cycle) in cycles.iter().enumerate() {
                let [cl, cm] = cycle.harmonics;
                let off = cycles.get(n + 1).map_or_else(
                    || "- | -".to_owned(),
                    |next| {
                        let [a, b] = next.harmonics;
                        format!("{:.2} | {:.2}", percent(cl, a), percent(cm, b))
                    },
                );
                writeln!(
                    text,
                    "| {} | {steps} | {} | {} | {} | {off} | {:.1} | {} |",
                    grid.cell_count(),
                    n + 1,
                    complex(cl),
                    complex(cm),
                    cycle.cpu_s,
                    cycle.not_converged
                )?;
            }
            eprintln!("{}, {} cells, {steps} steps: done", names.title, grid.cell_count());
            let last = cycles.len();
            for (n, cycle) in cycles.into_iter().enumerate() {
                let wanted = (grid.cell_count() == fine.cell_count() && n + 1 == last)
                    || (grid.cell_count() == fine.cell_count() && *steps == 20 && n + 2 == last)
                    || (grid.cell_count() == coarse.cell_count() && *steps == 40 && n + 1 == last);
                if wanted {
                    curves.push((
                        format!("{} cells, {steps} steps, cycle {}", grid.cell_count(), n + 1),
                        cycle,
                    ));
                }
            }
        }
    }
    let mut figure = Figure::new(names.title);
    for (label, y) in stations {
        let charts = ["real part", "imaginary part"].iter().enumerate().map(|(part, what)| {
            let mut chart = Chart::new(format!("{label}: {what}"), "x/c", "Cp a radian, upper side");
            for (n, (name, cycle)) in curves.iter().enumerate() {
                let [upper, _] = cycle.section(*y)[part].clone();
                chart = chart.series(if n % 2 == 0 {
                    Series::dashed(name, upper)
                } else {
                    Series::line(name, upper)
                });
            }
            chart
        });
        figure = figure.row(charts.collect());
    }
    fs::write(
        folder.join(names.file),
        figure.svg(1150, 80 + 400 * stations.len() as u32)?,
    )?;
    Ok(text)
}

/// The thesis's conditions on a wing like that of the F-5.
pub fn f5(folder: &Path) -> Outcome<String> {
    let wing = Wing {
        mach: 0.95,
        alpha_deg: 0.0,
        k: 0.264,
        amplitude_deg: 0.222,
        chord: 0.6396,
        area: 0.5 * (0.6396 + 0.1796) * 0.6226,
        axis: 0.5,
    };
    let names = Names {
        title: "F-5-like wing: Mach 0.95, 0.222 degrees about the root mid-chord, k 0.264",
        file: "f5_cp.svg",
        recipe: "f5_like_pitch",
    };
    let stations = [("35.2 %", 0.352), ("72.1 %", 0.721), ("97.7 %", 0.977)].map(|(n, eta)| (n, eta * 0.6226));
    let table = converge(folder, &names, wing, &stations)?;
    Ok(format!(
        "Conditions and sections of Beaubien's thesis (2006, chapter 5): Mach 0.95, 0.222 sin(2 k tau) degrees about the root\n\
         mid-chord, k 0.264, 20 steps a cycle, two cycles (three gave it the same). The F-5's planform and ordinates are not public, nor\n\
         are its measured pressures as numbers: the wing only resembles it (`meshes/geometry/f5_like.toml`), and what is shown is\n\
         convergence in step, cycle and grid (every second point), not agreement. 2.5 orders a step; harmonics per radian, moment about\n\
         the axis on the root chord.\n\n{table}"
    ))
}

/// The LANN wing, AGARD R-702's case CT5.
pub fn lann(folder: &Path) -> Outcome<String> {
    let wing = Wing {
        mach: 0.82,
        alpha_deg: 0.6,
        k: 0.204,
        amplitude_deg: 0.25,
        chord: 0.3606,
        area: 0.2527,
        axis: 0.62,
    };
    let names = Names {
        title: "LANN wing: Mach 0.82, 0.6 + 0.25 sin degrees about 0.62 root chords, k 0.204",
        file: "lann_cp.svg",
        recipe: "lann_ch_euler",
    };
    let stations = [("32.5 %", 0.325), ("65 %", 0.65), ("95 %", 0.95)];
    let table = converge(folder, &names, wing, &stations)?;
    Ok(format!(
        "AGARD R-702 case CT5 in Euler flow: Mach 0.82, 0.6 + 0.25 sin(omega t) degrees about 0.62 root chords, omega c/(2U) 0.204\n\
         with the root chord. The conditions are from memory (`unsteady_conditions.csv`), the geometry is public, the measured\n\
         pressures were not at hand as numbers: what is shown is convergence in step, cycle and grid (every second point). Sections\n\
         are the first, fourth and last but one of its pressure stations. 2.5 orders a step; harmonics per radian.\n\n{table}"
    ))
}
