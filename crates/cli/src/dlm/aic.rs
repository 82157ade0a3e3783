//! `dlm aic`: influence coefficients and generalized forces over Mach number and reduced frequency.

use crate::assemble::modes as tables;
use crate::exit::{Done, Stop};
use crate::frequency::FlutterCase;
use crate::options::Common;
use crate::output::{self, RunFolder};
use crate::progress::{Seconds, Timer, bar, check_interrupt, watch_interrupts};
use crate::stamp::Stamp;
use dip_dlm::lattice::Severity;
use dip_dlm::store::StoredAic;
use serde::Serialize;
use std::path::PathBuf;

/// Influence coefficients and generalized forces over Mach number and reduced frequency.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The flutter case; without [modes] only the influence coefficients are made
    case: PathBuf,
    /// Store the influence coefficients, to be used again for any structure by `dlm flutter --aic`
    #[arg(long, value_name = "FILE")]
    store: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

/// Generalized forces at one Mach number and reduced frequency.
#[derive(Debug, Serialize)]
struct Entry {
    mach: f64,
    reduced_frequency: f64,
    /// Q `[row = force][column = mode]`, real and imaginary part; force on mode i = dynamic pressure x Q_ij x amplitude j.
    q_m2: Vec<Vec<[f64; 2]>>,
}

/// What `summary.json` holds.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    command: &'static str,
    stamp: Stamp,
    settings: &'a str,
    stop_reason: &'static str,
    boxes: usize,
    semichord_m: f64,
    generalized_forces: Vec<Entry>,
    warnings: Vec<String>,
    total: Seconds,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    args.common.start()?;
    watch_interrupts();
    let timer = Timer::start();
    let case = FlutterCase::read(args.common.document(&args.case)?)?;
    let stamp = case.fingerprint.stamp();
    let folder = RunFolder::open(&args.common.folder(&args.case), &stamp, args.common.force)?;
    let aerodynamics = case.aerodynamics()?;
    let findings = case.findings(&aerodynamics)?;
    let mut entries = Vec::new();
    if case.file.modes.is_some() {
        let structure = tables::modes(&case.document, &case.file)?;
        let (motion, _) = case.motion(&aerodynamics, &structure)?;
        let bar = bar(case.file.lattice.mach.len() as u64, args.common.quiet);
        for &mach in &case.file.lattice.mach {
            check_interrupt("nothing yet")?;
            bar.set_message(format!("Mach {mach}"));
            let table = dip_dlm::gaf::generalized_forces(&aerodynamics, &motion, &[mach], &case.reduced_frequencies())
                .map_err(|e| Stop::failed(format!("generalized forces at Mach {mach}: {e}"), "check the lattice"))?;
            for (k, q) in table.k.iter().zip(&table.q[0]) {
                let row = |i: usize| {
                    (0..q.columns())
                        .map(|j| (q.column(j)[i].re, q.column(j)[i].im).into())
                        .collect()
                };
                entries.push(Entry {
                    mach,
                    reduced_frequency: *k,
                    q_m2: (0..q.rows()).map(row).collect(),
                });
            }
            bar.inc(1);
        }
        bar.finish_and_clear();
    }
    if let Some(path) = &args.store {
        let stored = StoredAic::compute(&aerodynamics, &case.file.lattice.mach, &case.reduced_frequencies())
            .map_err(|e| Stop::failed(format!("influence coefficients: {e}"), "check the lattice"))?;
        stored.save(path).map_err(|e| {
            Stop::failed(
                format!("{}: {e}", path.display()),
                "check the disk's space and the folder",
            )
        })?;
        tracing::info!("influence coefficients in {}", path.display());
    }
    let summary = Summary {
        command: "dlm aic",
        stamp,
        settings: case.document.text(),
        stop_reason: "done",
        boxes: aerodynamics.lattice().n_boxes(),
        semichord_m: case.reference.semichord_m,
        generalized_forces: entries,
        warnings: findings
            .iter()
            .filter(|f| f.severity >= Severity::Warning)
            .map(|f| f.message.clone())
            .collect(),
        total: timer.seconds(),
    };
    for warning in &summary.warnings {
        tracing::warn!("{warning}");
    }
    folder.write_json(output::SUMMARY, &summary)?;
    if args.common.json {
        output::print(&output::json(&summary)?);
    } else {
        output::print(&text(&summary));
        tracing::info!("results in {}", folder.path().display());
    }
    Ok(if summary.warnings.is_empty() {
        Done::Clean
    } else {
        Done::LookAt
    })
}

fn text(summary: &Summary<'_>) -> String {
    let mut out = format!("{} boxes, b = {} m\n", summary.boxes, summary.semichord_m);
    for e in &summary.generalized_forces {
        out.push_str(&format!("M {} k {}: Q, m^2\n", e.mach, e.reduced_frequency));
        for row in &e.q_m2 {
            let cells: Vec<String> = row
                .iter()
                .map(|[re, im]| format!("{re:>12.5e} {im:>+12.5e}i"))
                .collect();
            out.push_str(&format!("  {}\n", cells.join("  ")));
        }
    }
    out
}
