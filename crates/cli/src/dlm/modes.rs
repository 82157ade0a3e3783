//! `dlm modes`: normal modes of a structure.

use crate::assemble::{modes as tables, structure};
use crate::exit::{Done, Stop};
use crate::options::Common;
use crate::output::{self, RunFolder};
use crate::progress::{Seconds, Timer};
use crate::stamp::{Fingerprint, Stamp};
use serde::Serialize;
use std::path::PathBuf;

/// Normal modes of a structure.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The structure file, or a flutter case whose [modes] names one
    case: PathBuf,
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
    nodes: usize,
    mass_kg: Option<f64>,
    frequencies_hz: Vec<f64>,
    generalized_masses_kg: &'a [f64],
    total: Seconds,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    args.common.start()?;
    let timer = Timer::start();
    let document = args.common.document(&args.case)?;
    let mut fingerprint = Fingerprint::new();
    let solved = if document.has("lattice") {
        let file: dip_case::file::FlutterFile = document.load()?;
        fingerprint.document(&document);
        if let Some(table) = &file.modes {
            tables::fingerprint(&document, table, &mut fingerprint);
        }
        tables::modes(&document, &file)?
    } else {
        structure::fingerprint(&document, &mut fingerprint);
        structure::modes(&document)?
    };
    let stamp = fingerprint.stamp();
    let folder = RunFolder::open(&args.common.folder(&args.case), &stamp, args.common.force)?;
    folder.write("modes.csv", csv(&solved.modes, solved.max_scale).as_bytes())?;
    super::figures::mode_shapes(
        &folder,
        &crate::traces::ModeShapes::new(&solved.modes, &solved.elements),
    )?;
    let summary = Summary {
        command: "dlm modes",
        stamp,
        settings: document.text(),
        stop_reason: "done",
        nodes: solved.modes.nodes.len(),
        mass_kg: solved.mass_kg,
        frequencies_hz: (0..solved.modes.count()).map(|m| solved.modes.freq_hz(m)).collect(),
        generalized_masses_kg: &solved.modes.generalized_mass,
        total: timer.seconds(),
    };
    folder.write_json(output::SUMMARY, &summary)?;
    if args.common.json {
        output::print(&output::json(&summary)?);
        return Ok(Done::Clean);
    }
    let mut text = String::new();
    if let Some(mass) = summary.mass_kg {
        text.push_str(&format!("mass {mass:.4} kg\n"));
    }
    text.push_str("mode  frequency, Hz\n");
    for (m, f) in summary.frequencies_hz.iter().enumerate() {
        text.push_str(&format!("{:>4}  {f:>13.4}\n", m + 1));
    }
    output::print(&text);
    tracing::info!("results in {}", folder.path().display());
    Ok(Done::Clean)
}

/// Shapes as a table that `[modes] file` reads back: positions and z displacement of every mode.
fn csv(modes: &dip_modal::Modes, max_scale: bool) -> String {
    let heave = modes.heave();
    let scale: Vec<f64> = heave
        .iter()
        .map(|mode| {
            let largest = mode.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            if max_scale && largest > 0.0 { 1.0 / largest } else { 1.0 }
        })
        .collect();
    let mut text = String::from("node,x_m,y_m,z_m");
    for m in 0..modes.count() {
        text.push_str(&format!(",phi{}", m + 1));
    }
    text.push('\n');
    for (n, node) in modes.nodes.iter().enumerate() {
        let p = node.position;
        text.push_str(&format!("{},{},{},{}", node.id, p.x, p.y, p.z));
        for (mode, s) in heave.iter().zip(&scale) {
            text.push_str(&format!(",{:e}", mode[n] * s));
        }
        text.push('\n');
    }
    text
}
