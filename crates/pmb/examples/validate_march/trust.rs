//! What a flutter point depends on beside the flow, what it costs, and the responses that it is read from.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use dip_pmb::couple::Coupling;
use dip_report::{Chart, Figure, Series};

use crate::agard::{self, speed_index};
use crate::driver::{Case, Outcome, ReadDamping, cpu_s};
use crate::{mesh, percent, root, search};

/// Mach number and what time step, tolerance, start and number of modes add to the error of a point, % of speed.
const UNCERTAINTY: &str = "docs/validation/march/parts/uncertainty.csv";

/// Numerical error of a point in % of speed, without that of the grid: its identification's (`identified`, % of speed) and
/// what the study of sensitivity found for the Mach number, between its two by a straight line.
pub fn numerical_uncertainty(mach: f64, identified: f64) -> Outcome<f64> {
    let file = root().join(UNCERTAINTY);
    let text =
        fs::read_to_string(&file).map_err(|e| format!("{}: {e}: run the part `sensitivity` first", file.display()))?;
    let rows: Vec<(f64, f64)> = text
        .lines()
        .skip(1)
        .filter_map(|l| {
            l.split_once(',')
                .and_then(|(m, p)| Some((m.parse().ok()?, p.parse().ok()?)))
        })
        .collect();
    let [(from, low), (to, high)] = rows[..] else {
        return Err(format!("{}: two Mach numbers are needed", file.display()).into());
    };
    let other = low + (high - low) * ((mach - from) / (to - from)).clamp(0.0, 1.0);
    Ok(identified.hypot(other))
}

pub fn sensitivity(_: &Path) -> Outcome<String> {
    let mut page = String::from(
        "## Sensitivity of a flutter point\n\nO-O coarse, Yates' modes, searched to 0.3 %. The first line of each Mach number is what the others change.\n\n\
        | Mach | change | density, kg/m^3 | speed index | change of speed | frequency, Hz | marches | CPU, s |\n|---|---|---|---|---|---|---|---|\n",
    );
    let grid = mesh("agard445_oo_coarse")?;
    type Change = (&'static str, usize, fn(&mut Case));
    let time: [Change; 3] = [
        ("40 steps a cycle, 2 orders, 0.1 % of the semispan, 4 modes", 4, |_| ()),
        ("20 steps a cycle", 4, |c| c.steps_per_cycle = 20.0),
        ("80 steps a cycle", 4, |c| c.steps_per_cycle = 80.0),
    ];
    let tolerance: [Change; 3] = [
        ("1 order a step", 4, |c| c.orders = 1.0),
        ("1.5 orders a step", 4, |c| c.orders = 1.5),
        ("3 orders a step", 4, |c| c.orders = 3.0),
    ];
    let start: [Change; 4] = [
        ("0.01 % of the semispan", 4, |c| c.start[0] *= 0.1),
        ("1 % of the semispan", 4, |c| c.start[0] *= 10.0),
        ("3 % of the semispan", 4, |c| c.start[0] *= 30.0),
        ("all modes started", 4, |c| c.start = vec![7.62e-4, 2e-4, 2e-4, 1e-4]),
    ];
    let structure: [Change; 2] = [("2 modes", 2, |_| ()), ("5 modes", 5, |_| ())];
    let coupling: [Change; 1] = [("loose coupling", 4, |c| c.coupling = Coupling::Loose)];
    let mut sums = String::new();
    let mut uncertainty = String::from("mach,percent_of_speed\n");
    for (mach, first) in [(0.678, 0.215), (0.96, 0.054)] {
        let point = agard::point(mach)?;
        let mut reference = None;
        // Squares of what a finer step, a smaller tolerance, a smaller start and one mode more change, in per cent of speed.
        let (mut squares, mut identified) = (0.0, 0.0);
        let groups: [&[Change]; 5] = [&time, &tolerance, &start, &structure, &coupling];
        for (label, count, change) in groups.into_iter().flatten() {
            let modes = agard::modes("yates", *count)?;
            let mut case = agard::case(&grid, &modes, mach, 0.0)?;
            change(&mut case);
            println!("Mach {mach}, {label}");
            let (still, seconds) = case.still()?;
            let found = case.search(&still, search(first, [0.01, 1.0], 0.003), |d| {
                agard::stream(point.speed_m_s, d)
            })?;
            let Some(n) = found.neutral() else {
                let _ = writeln!(
                    page,
                    "| {mach} | {label} | {:?} | | | | {} | |",
                    found.end,
                    found.rows.len()
                );
                continue;
            };
            let index = speed_index(point.speed_m_s, n.at);
            let reference = *reference.get_or_insert(index);
            let change = 100.0 * (index / reference - 1.0);
            if change == 0.0 {
                // The index goes with the root of density.
                identified = 50.0 * n.error / n.at;
            }
            squares += match *label {
                // Second order: the step's own error is four thirds of what half the step changes.
                "80 steps a cycle" => (4.0 / 3.0 * change).powi(2),
                "3 orders a step" | "0.01 % of the semispan" | "5 modes" => change.powi(2),
                _ => 0.0,
            };
            let _ = writeln!(
                page,
                "| {mach} | {label} | {:.4} +- {:.4} | {index:.4} | {} | {:.2} | {} | {:.1} |",
                n.at,
                n.error,
                percent(index, reference),
                n.freq_hz,
                found.rows.len(),
                seconds + found.cpu_s
            );
        }
        let _ = writeln!(
            sums,
            "- Mach {mach}: {:.2} % of speed from time step (four thirds of the change to 80 steps), tolerance, start and number of modes together (root of the sum of squares), {:.2} % with the identification of this point.",
            squares.sqrt(),
            identified.hypot(squares.sqrt())
        );
        let _ = writeln!(uncertainty, "{mach},{:.3}", squares.sqrt());
    }
    let _ = writeln!(
        page,
        "\nNumerical uncertainty of a point, without that of the grid, which the flutter points below carry beside that of their identification:\n\n{sums}\nThe grid's is in the tables below: 1 % at Mach 0.678 between 14,336 and 202,752 cells; at 0.96 it is the largest \
        of all, 9 % between 14,336 and 53,760 cells."
    );
    fs::write(root().join(UNCERTAINTY), uncertainty)?;
    Ok(page)
}

/// What a march says of the damping when it stops, against the same march gone on for many cycles.
pub fn confidence(_: &Path) -> Outcome<String> {
    let mut page = String::from(
        "## How far the stated errors hold\n\n\
        O-O coarse, Yates' modes, 12 cycles of 14 Hz without stopping. `when it would stop`: the reading with which a search would have ended the march, \
        with its standard error; `z`: its distance from the reading of the whole record in standard errors.\n\n\
        | Mach | density, kg/m^3 | steps | g when it would stop | steps | g of the whole record | z |\n|---|---|---|---|---|---|---|\n",
    );
    let grid = mesh("agard445_oo_coarse")?;
    let modes = agard::modes("yates", 4)?;
    let (mut first, mut all) = (Vec::new(), Vec::new());
    for (mach, densities) in [
        (0.678, &[0.19, 0.22][..]),
        (0.901, &[0.08, 0.088, 0.1]),
        (0.96, &[0.05, 0.0527, 0.058]),
        (1.072, &[0.1, 0.112]),
    ] {
        let point = agard::point(mach)?;
        let mut case = agard::case(&grid, &modes, mach, 0.0)?;
        case.whole = true;
        case.cycles = 12.0;
        let (still, _) = case.still()?;
        for &density in densities {
            let row = case.march(&still, density, agard::stream(point.speed_m_s, density), None)?;
            let readings = case.readings(&row.states)?;
            let Some((last, before)) = readings.split_last() else {
                return Err("a march without a reading".into());
            };
            let z = |r: &ReadDamping| (r.g - last.g) / r.g_error;
            let stop = before.iter().find(|r| r.known).ok_or("a damping that is never known")?;
            let _ = writeln!(
                page,
                "| {mach} | {density} | {} | {:+.5} +- {:.5} | {} | {:+.5} +- {:.5} | {:+.2} |",
                stop.samples,
                stop.g,
                stop.g_error,
                last.samples,
                last.g,
                last.g_error,
                z(stop)
            );
            first.push(z(stop));
            // From where it would stop to four cycles of 14 Hz: later readings are hardly apart from the last.
            let late = stop.samples.max(4 * case.steps_per_cycle as usize);
            let early = before.iter().filter(|r| r.samples >= stop.samples && r.samples <= late);
            all.extend(early.map(z));
        }
    }
    let rms = |z: &[f64]| (z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64).sqrt();
    let within = |z: &[f64]| 100.0 * z.iter().filter(|z| z.abs() < 1.0).count() as f64 / z.len() as f64;
    let _ = writeln!(
        page,
        "\nRoot mean square of z where they stop {:.2} ({} of {} within one standard error; 1 and 68 % would be exact); over all {} readings from there to four cycles \
        {:.2}, {:.0} % within one.",
        rms(&first),
        first.iter().filter(|z| z.abs() < 1.0).count(),
        first.len(),
        all.len(),
        rms(&all),
        within(&all)
    );
    Ok(page)
}

pub fn cost(_: &Path) -> Outcome<String> {
    let mut page = format!(
        "## What a flutter point costs\n\n\
        C-H grid of 53,760 cells, Yates' modes, first density the experiment's, to 1 % in density, {} thread(s). An established code on a like grid, one core: \
        249 s for the steady flow and two bracketing runs. `grid`: deformation, metrics, swept volumes; `structure`: forces, modal equations; parts \
        of the time of the marches.\n\n\
        | Mach | density, kg/m^3 | structure on the grid, CPU s | steady flow, CPU s | marches | steps | marches, CPU s | in all, CPU s | wall, s | grid | structure |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
        rayon::current_num_threads()
    );
    let grid = mesh("agard445_ch_euler")?;
    let modes = agard::modes("yates", 4)?;
    for mach in [0.678, 0.901, 0.96] {
        let point = agard::point(mach)?;
        let (begin, clock) = (cpu_s(), std::time::Instant::now());
        let case = agard::case(&grid, &modes, mach, 0.0)?;
        let prepared = cpu_s() - begin;
        let (still, seconds) = case.still()?;
        let rho = point.density_kg_m3;
        let found = case.search(&still, search(rho, [0.2 * rho, 4.0 * rho], 0.01), |d| {
            agard::stream(point.speed_m_s, d)
        })?;
        let n = found.neutral().ok_or("no flutter point")?;
        let steps: usize = found.rows.iter().map(|r| r.steps).sum();
        let part = |c: usize| 100.0 * found.rows.iter().map(|r| r.coupling[c]).sum::<f64>() / found.rows.len() as f64;
        let _ = writeln!(
            page,
            "| {mach} | {:.4} +- {:.4} | {prepared:.2} | {seconds:.1} | {} | {steps} | {:.1} | {:.1} | {:.1} | {:.1} % | {:.1} % |",
            n.at,
            n.error,
            found.rows.len(),
            found.cpu_s,
            cpu_s() - begin,
            clock.elapsed().as_secs_f64(),
            part(0),
            part(1)
        );
    }
    Ok(page)
}

pub fn responses(folder: &Path) -> Outcome<String> {
    let grid = mesh("agard445_oo_coarse")?;
    let modes = agard::modes("yates", 4)?;
    let mut charts = Vec::new();
    for (mach, densities) in [(0.678, [0.205, 0.23]), (0.96, [0.05, 0.07])] {
        let point = agard::point(mach)?;
        let mut case = agard::case(&grid, &modes, mach, 0.0)?;
        case.whole = true;
        case.cycles = 6.0;
        let (still, _) = case.still()?;
        for density in densities {
            let row = case.march(&still, density, agard::stream(point.speed_m_s, density), None)?;
            let mut chart = Chart::new(
                format!("Mach {mach}, {density} kg/m^{{3}}: g = {:+.3}", row.g),
                "Time, s",
                "Tip displacement of the mode, mm",
            );
            for m in 0..4 {
                let largest = 1e3 * case.wing.largest[m];
                let points = row.states.iter().map(|s| (s.time_s, largest * s.q[m])).collect();
                chart = chart.series(Series::line(format!("mode {}", m + 1), points));
            }
            charts.push(chart);
        }
    }
    let mut charts = charts.into_iter();
    let mut figure = Figure::new("Modal responses below and above flutter, O-O coarse");
    while let Some(first) = charts.next() {
        figure = figure.row(std::iter::once(first).chain(charts.next()).collect());
    }
    fs::write(folder.join("responses.svg"), figure.svg(1200, 800)?)?;
    Ok(
        "## Modal responses\n\nBelow and above flutter, as in the thesis's figures. A search needs only the first 1.2 to 1.5 cycles of these.\n\n\
        ![modal responses](responses.svg)\n"
            .to_owned(),
    )
}
