//! `dip compare`: table, figures and report of a study.

use super::curve::CurveResult;
use super::run::Fidelity;
use super::study::Study;
use super::{report, run as study_run};
use crate::exit::{Done, Stop};
use crate::options::Common;
use crate::output::{self, RunFolder};
use crate::progress::Timer;
use dip_report::{Cell, Column, NumberFormat, Table};
use serde::Serialize;
use std::path::PathBuf;

/// Table, figures and HTML report of a study: boundaries against experiment; computes what is missing.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The study file
    study: PathBuf,
    /// Go on after an interrupt; finished curves of the same inputs are kept with or without it
    #[arg(long)]
    resume: bool,
    /// Grids of the flow cases
    #[arg(long, value_enum, default_value_t = Fidelity::Coarse)]
    fidelity: Fidelity,
    #[command(flatten)]
    common: Common,
}

/// One computed point beside the measured one.
#[derive(Debug, Clone, Serialize)]
pub struct Compared {
    /// Curve.
    pub curve: String,
    /// Mach number.
    pub mach: f64,
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Flutter speed, m/s.
    pub flutter_speed_m_s: Option<f64>,
    /// Flutter frequency, Hz.
    pub flutter_frequency_hz: Option<f64>,
    /// Flutter speed index on the study's reference quantities.
    pub flutter_speed_index: Option<f64>,
    /// omega / omega_alpha on the same.
    pub frequency_ratio: Option<f64>,
    /// Speed of divergence at the same density, m/s, where there is one.
    pub divergence_speed_m_s: Option<f64>,
    /// Measured speed, m/s.
    pub experiment_speed_m_s: Option<f64>,
    /// Measured frequency, Hz.
    pub experiment_frequency_hz: Option<f64>,
    /// Measured flutter speed index.
    pub experiment_speed_index: Option<f64>,
    /// Speed index against the measured one, per cent; the densities are the same where the case takes the experiment's.
    pub speed_error_percent: Option<f64>,
    /// Frequency against the measured one, per cent.
    pub frequency_error_percent: Option<f64>,
    /// Wall seconds of this point.
    pub time_s: f64,
    /// CPU seconds of this point.
    pub cpu_s: f64,
}

/// What `summary.json` of a comparison holds.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    command: &'static str,
    stamp: crate::stamp::Stamp,
    settings: &'a str,
    stop_reason: &'static str,
    points: &'a [Compared],
    warnings: Vec<String>,
    total: crate::progress::Seconds,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    args.common.start()?;
    study_run::refuse_resume_with_force(args.resume, &args.common)?;
    let timer = Timer::start();
    let study = Study::read(&args.study, &args.common.set, args.fidelity == Fidelity::Medium)?;
    let stamp = study.fingerprint.stamp();
    let folder = RunFolder::open(&args.common.folder(&args.study), &stamp, args.common.force)?;
    let results = study_run::curves(&study, folder.path(), &args.common)?;
    let points = compared(&study, &results);
    let table = table(&points)?;
    let warnings: Vec<String> = results
        .iter()
        .flat_map(|r| r.warnings.iter().map(move |w| format!("{}: {w}", r.name)))
        .collect();
    for warning in &warnings {
        tracing::warn!("{warning}");
    }
    report::write(&folder, &study, &results, &points, &stamp, timer.seconds())?;
    folder.write("boundary.csv", table.csv().as_bytes())?;
    let summary = Summary {
        command: "dip compare",
        stamp,
        settings: study.document.text(),
        stop_reason: "done",
        points: &points,
        warnings,
        total: timer.seconds(),
    };
    folder.write_json(output::SUMMARY, &summary)?;
    if args.common.json {
        output::print(&output::json(&summary)?);
    } else {
        output::print(&table.plain());
        tracing::info!("report: {}", folder.path().join("report.html").display());
    }
    Ok(if summary.warnings.is_empty() {
        Done::Clean
    } else {
        Done::LookAt
    })
}

/// Every computed point beside the measured one at its Mach number.
fn compared(study: &Study, results: &[CurveResult]) -> Vec<Compared> {
    let percent = |ours: Option<f64>, theirs: Option<f64>| ours.zip(theirs).map(|(a, b)| 100.0 * (a / b - 1.0));
    let mut points = Vec::new();
    for result in results {
        for row in &result.boundary {
            let measured = study.experiment.iter().find(|p| (p.mach - row.mach).abs() < 1e-6);
            // The study's reference quantities serve all curves, whatever a case says.
            let index = row
                .flutter_speed_m_s
                .map(|u| study.reference.speed_index(u, row.density_kg_m3));
            let measured_index = measured.and_then(|p| p.flutter_speed_index);
            let measured_frequency = measured.and_then(|p| p.frequency_hz);
            points.push(Compared {
                curve: result.name.clone(),
                mach: row.mach,
                density_kg_m3: row.density_kg_m3,
                flutter_speed_m_s: row.flutter_speed_m_s,
                flutter_frequency_hz: row.flutter_frequency_hz,
                flutter_speed_index: index,
                frequency_ratio: row.flutter_frequency_hz.map(|f| study.reference.frequency_ratio(f)),
                divergence_speed_m_s: row.divergence_speed_m_s,
                experiment_speed_m_s: measured.and_then(|p| p.speed_m_s),
                experiment_frequency_hz: measured_frequency,
                experiment_speed_index: measured_index,
                speed_error_percent: percent(index, measured_index),
                frequency_error_percent: percent(row.flutter_frequency_hz, measured_frequency),
                time_s: row.time_s,
                cpu_s: row.cpu_s,
            });
        }
    }
    points
}

/// The table of all curves, for stdout and CSV.
fn table(points: &[Compared]) -> Result<Table, Stop> {
    let mut columns = vec![Column::text("curve")];
    let diverges = points.iter().any(|p| p.divergence_speed_m_s.is_some());
    columns.extend(columns_of_points(diverges));
    let mut table = Table::new("Flutter boundary beside experiment", columns);
    for p in points {
        let mut row: Vec<Cell> = vec![p.curve.as_str().into()];
        row.extend(cells_of_point(p, diverges));
        table.push(row).map_err(|e| crate::figures::drawing(&e))?;
    }
    Ok(table)
}

/// The table of one curve, narrow enough for a page.
pub fn curve_table(curve: &str, points: &[Compared]) -> Result<Table, Stop> {
    let of_curve = || points.iter().filter(|p| p.curve == curve);
    let diverges = of_curve().any(|p| p.divergence_speed_m_s.is_some());
    let mut table = Table::new(format!("{curve} beside experiment"), columns_of_points(diverges));
    for p in of_curve() {
        table
            .push(cells_of_point(p, diverges))
            .map_err(|e| crate::figures::drawing(&e))?;
    }
    Ok(table)
}

/// Columns of a table of points; that of divergence only where a point `diverges`.
fn columns_of_points(diverges: bool) -> Vec<Column> {
    let number = |name: &str, unit: &str, digits: usize| Column::number(name, unit, NumberFormat::Fixed(digits));
    let mut columns = vec![
        number("Mach", "", 3),
        number("\u{3c1}", "kg/m\u{b3}", 5),
        number("U", "m/s", 2),
        number("exp.", "m/s", 2),
        number("f", "Hz", 2),
        number("exp.", "Hz", 2),
        number("FSI", "", 4),
        number("exp.", "", 4),
        number("error", "%", 1),
        number("time", "s", 2),
    ];
    if diverges {
        columns.insert(2, number("divergence", "m/s", 2));
    }
    columns
}

fn cells_of_point(p: &Compared, diverges: bool) -> Vec<Cell> {
    let mut cells: Vec<Cell> = vec![
        p.mach.into(),
        p.density_kg_m3.into(),
        p.flutter_speed_m_s.into(),
        p.experiment_speed_m_s.into(),
        p.flutter_frequency_hz.into(),
        p.experiment_frequency_hz.into(),
        p.flutter_speed_index.into(),
        p.experiment_speed_index.into(),
        p.speed_error_percent.into(),
        p.time_s.into(),
    ];
    if diverges {
        cells.insert(2, p.divergence_speed_m_s.into());
    }
    cells
}
