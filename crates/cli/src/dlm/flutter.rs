//! `dlm flutter`: flutter of a case or a Nastran deck.

use crate::exit::{Done, Stop};
use crate::frequency::{FlutterCase, FlutterRow, FrequencyResults};
use crate::options::Common;
use crate::output::{self, RunFolder};
use crate::progress::{Seconds, Timer, bar, watch_interrupts};
use crate::stamp::Stamp;
use dip_dlm::lattice::Severity;
use dip_dlm::store::StoredAic;
use serde::Serialize;
use std::path::PathBuf;

/// Flutter by K, KE, PK and g; a case file or a Nastran SOL 145 deck.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The case file (.toml), or a Nastran deck (.bdf, .dat, .nas)
    case: PathBuf,
    /// Influence coefficients stored by `dlm aic --store`, for the same lattice, Mach numbers and reduced frequencies
    #[arg(long, value_name = "FILE")]
    aic: Option<PathBuf>,
    /// For a deck: take the modes of this file (f06, punch, op2) instead of the deck's own structure
    #[arg(long, value_name = "FILE")]
    modes: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

/// What `summary.json` holds.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    command: &'static str,
    stamp: Stamp,
    settings: &'a str,
    stop_reason: &'static str,
    boxes: usize,
    natural_frequencies_hz: Vec<f64>,
    structure_mass_kg: Option<f64>,
    flutter: Vec<&'a FlutterRow>,
    warnings: Vec<String>,
    notes: Vec<String>,
    stages: &'a [(String, Seconds)],
    total: Seconds,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    args.common.start()?;
    let deck = args.case.extension().is_some_and(|e| {
        ["bdf", "dat", "nas", "inp", "dec", "nastran"].contains(&e.to_string_lossy().to_lowercase().as_str())
    });
    if deck {
        super::deck::run(&args.case, args.modes.as_deref(), &args.common)
    } else {
        case(args)
    }
}

fn case(args: &Args) -> Result<Done, Stop> {
    if args.modes.is_some() {
        return Err(Stop::input(
            "--modes goes with a deck",
            "in a case file give [modes] file and geometry",
        ));
    }
    let timer = Timer::start();
    let case = FlutterCase::read(args.common.document(&args.case)?)?;
    let stamp = case.fingerprint.stamp();
    let folder = RunFolder::open(&args.common.folder(&args.case), &stamp, args.common.force)?;
    watch_interrupts();
    let stored = match &args.aic {
        Some(path) => Some(StoredAic::load(path).map_err(|e| {
            Stop::input(
                format!("{}: {e}", path.display()),
                "make the file by `dlm aic CASE.toml --store FILE`",
            )
        })?),
        None => None,
    };
    let bar = bar(2 + 2 * case.file.lattice.mach.len() as u64, args.common.quiet);
    let solved = case.solve(stored.as_ref(), |stage| {
        bar.inc(1);
        bar.set_message(stage.to_owned());
    });
    bar.finish_and_clear();
    let solved = solved?;

    let findings = |from: Severity, to: Severity| {
        solved
            .findings
            .iter()
            .filter(move |f| f.severity >= from && f.severity <= to)
            .map(|f| f.message.clone())
    };
    let mut warnings: Vec<String> = findings(Severity::Warning, Severity::Error).collect();
    for s in &solved.solutions {
        let place = format!("Mach {}, {}", s.row.mach, s.solution.method.name());
        warnings.extend(s.row.warnings.iter().map(|w| format!("{place}: {w}")));
    }
    for warning in &warnings {
        tracing::warn!("{warning}");
    }
    write_curves(&folder, &solved)?;
    super::figures::write(&folder, &solved)?;
    let summary = Summary {
        command: "dlm flutter",
        stamp,
        settings: case.document.text(),
        stop_reason: "done",
        boxes: solved.aerodynamics.lattice().n_boxes(),
        natural_frequencies_hz: (0..solved.modes.count()).map(|m| solved.modes.freq_hz(m)).collect(),
        structure_mass_kg: solved.structure_mass_kg,
        flutter: solved.solutions.iter().map(|s| &s.row).collect(),
        warnings,
        notes: findings(Severity::Advice, Severity::Advice).collect(),
        stages: &solved.stages,
        total: timer.seconds(),
    };
    folder.write_json(output::SUMMARY, &summary)?;
    if args.common.json {
        output::print(&output::json(&summary)?);
    } else {
        output::print(&table(&summary.flutter));
        tracing::info!("results in {}", folder.path().display());
    }
    Ok(if summary.warnings.is_empty() {
        Done::Clean
    } else {
        Done::LookAt
    })
}

/// The flutter points as a text table.
fn table(rows: &[&FlutterRow]) -> String {
    let mut text = format!(
        "{:>6}  {:>4}  {:>10}  {:>9}  {:>8}  {:>8}  {:>8}  {:>7}  {:>4}  {:>10}\n",
        "Mach", "", "density", "speed", "freq.", "FSI", "f/f_a", "k", "mode", "divergence"
    );
    text.push_str(&format!(
        "{:>6}  {:>4}  {:>10}  {:>9}  {:>8}  {:>8}  {:>8}  {:>7}  {:>4}  {:>10}\n",
        "", "", "kg/m^3", "m/s", "Hz", "", "", "", "", "m/s"
    ));
    let number = |v: Option<f64>, digits: usize| v.map_or_else(|| "none".to_owned(), |v| format!("{v:.digits$}"));
    for r in rows {
        let method = serde_json::to_value(r.method)
            .ok()
            .and_then(|v| v.as_str().map(str::to_owned))
            .unwrap_or_default();
        text.push_str(&format!(
            "{:>6.3}  {:>4}  {:>10.5}  {:>9}  {:>8}  {:>8}  {:>8}  {:>7}  {:>4}  {:>10}\n",
            r.mach,
            method,
            r.density_kg_m3,
            number(r.flutter_speed_m_s, 2),
            number(r.flutter_frequency_hz, 3),
            number(r.flutter_speed_index, 4),
            number(r.frequency_ratio, 4),
            number(r.reduced_frequency, 4),
            r.mode.map_or_else(|| "-".to_owned(), |m| m.to_string()),
            number(r.divergence_speed_m_s, 2),
        ));
    }
    text
}

/// V-g and V-f curves of all methods and modes as one CSV.
fn write_curves(folder: &RunFolder, solved: &FrequencyResults) -> Result<(), Stop> {
    let mut csv = String::from("mach,method,mode,speed_m_s,density_kg_m3,g,frequency_hz,k,confidence\n");
    for s in &solved.solutions {
        for mode in &s.solution.modes {
            for p in &mode.points {
                csv.push_str(&format!(
                    "{},{},{},{},{},{},{},{},{}\n",
                    s.row.mach,
                    s.solution.method.name(),
                    mode.mode,
                    p.speed_m_s,
                    p.density_kg_m3,
                    p.g,
                    p.freq_hz,
                    p.k,
                    p.confidence
                ));
            }
        }
    }
    folder.write("vg.csv", csv.as_bytes())?;
    Ok(())
}
