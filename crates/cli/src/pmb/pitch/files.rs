//! Files of a run with prescribed motion: history and loops of the loads, first harmonics of the pressures.

use super::recorder::Line;
use crate::exit::Stop;
use crate::figures::drawing;
use crate::output::RunFolder;
use crate::pmb::steady::cuts::Cut;
use dip_pmb::forced::ForcedResult;
use dip_report::{Chart, CpCut, Figure, Series, cp_cuts};

/// Writes `history.csv` and the pictures of the loads.
///
/// # Errors
/// What the file system says.
pub fn loads(
    folder: &RunFolder,
    title: &str,
    unit: (&str, f64),
    lines: &[Line],
    steps_per_cycle: usize,
    result: &ForcedResult,
) -> Result<(), Stop> {
    let mut csv = String::from("time_s,motion,cl,cd,cm,residual_drop_orders,iterations,products\n");
    for l in lines {
        csv.push_str(&format!(
            "{},{},{},{},{},{},{},{}\n",
            l.time_s, l.value, l.loads[0], l.loads[1], l.loads[2], l.solved.0, l.solved.1, l.solved.2
        ));
    }
    folder.write("history.csv", csv.as_bytes())?;
    if lines.len() < 2 {
        return Ok(());
    }
    let names = ["C_{L}", "C_{D}", "C_{M}"];
    let mut history = Figure::new(title).share_x();
    for (n, name) in names.into_iter().enumerate() {
        let points = lines.iter().map(|l| (l.time_s, l.loads[n])).collect();
        history = history.row(vec![Chart::new("", "Time, s", name).series(Series::line("", points))]);
    }
    let svg = history.svg(800, 780).map_err(|e| drawing(&e))?;
    folder.write("history.svg", svg.as_bytes())?;
    let n = steps_per_cycle;
    if n == 0 || lines.len() <= n || result.steps < n {
        return Ok(());
    }
    let (label, scale) = unit;
    let mut charts = Vec::new();
    for (c, name) in [(0, "C_{L}"), (2, "C_{M}")] {
        let mut chart = Chart::new("", label, name);
        // Whole cycles, the last one drawn last.
        let cycles = (lines.len() - 1) / n;
        for cycle in cycles.saturating_sub(2)..cycles {
            let from = lines.len() - 1 - (cycles - cycle) * n;
            let points = lines[from..=from + n]
                .iter()
                .map(|l| (l.value * scale, l.loads[c]))
                .collect();
            let label = format!("cycle {}", result.steps / n - (cycles - cycle) + 1);
            chart = chart.series(if cycle + 1 == cycles {
                Series::line(label, points)
            } else {
                Series::dashed(label, points)
            });
        }
        charts.push(chart);
    }
    let svg = Figure::new(title).row(charts).svg(1000, 460).map_err(|e| drawing(&e))?;
    folder.write("loops.svg", svg.as_bytes())?;
    Ok(())
}

/// Writes the first harmonics of Cp at the stations: `parts` are the cuts of the real and of the imaginary part.
///
/// # Errors
/// What the file system says.
pub fn pressures(folder: &RunFolder, title: &str, parts: &[Vec<Cut>; 2]) -> Result<(), Stop> {
    let mut csv = String::from("eta,y_m,side,x_m,z_m,x_over_c,cp_real,cp_imaginary\n");
    let cell = |v: Option<f64>| v.map_or_else(String::new, |v| v.to_string());
    let mut charts = Vec::new();
    for (real, imaginary) in parts[0].iter().zip(&parts[1]) {
        let y = cell(real.station.as_ref().map(|s| s.y_m));
        let eta = cell(real.station.as_ref().and_then(|s| s.eta));
        let mut computed = Vec::new();
        for (side, re, im) in [
            ("upper", &real.upper, &imaginary.upper),
            ("lower", &real.lower, &imaginary.lower),
        ] {
            for (r, i) in re.iter().zip(im) {
                csv.push_str(&format!(
                    "{eta},{y},{side},{},{},{},{},{}\n",
                    r[0], r[1], r[2], r[3], i[3]
                ));
            }
            let line = |points: &[[f64; 4]]| points.iter().map(|p| (p[2], p[3])).collect();
            computed.push((format!("{side}, in phase"), line(re)));
            computed.push((format!("{side}, a quarter ahead"), line(im)));
        }
        if !real.upper.is_empty() || !real.lower.is_empty() {
            charts.push(CpCut {
                label: real.label.clone(),
                computed,
                measured: Vec::new(),
                critical: None,
            });
        }
    }
    if parts[0].is_empty() {
        return Ok(());
    }
    folder.write("cp_harmonic.csv", csv.as_bytes())?;
    if charts.is_empty() {
        return Ok(());
    }
    let columns = charts.len().min(2);
    let rows = u32::try_from(charts.len().div_ceil(columns)).unwrap_or(1);
    let width = if columns == 1 { 640 } else { 1000 };
    let svg = cp_cuts(title, &charts, columns)
        .and_then(|figure| figure.svg(width, 60 + 400 * rows))
        .map_err(|e| drawing(&e))?;
    folder.write("cp_harmonic.svg", svg.as_bytes())?;
    Ok(())
}
