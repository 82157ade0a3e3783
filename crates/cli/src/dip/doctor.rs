//! `dip doctor FILE`: what is wrong with a recording, and what can be saved.

use super::recording;
use crate::exit::{Done, Stop};
use crate::{options, output};
use dip_record::{Finding, Precision, RecordError, Recording, Salvage, Writer, WriterOptions};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Options of `dip doctor`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  dip doctor runs/agard445-pitch/pitch.mcap
  dip doctor broken.mcap --save good.mcap

Exit codes: 0 nothing is wrong; 3 something is, and it is said what; 2 no such file.")]
pub struct Args {
    /// The recording (.mcap)
    file: PathBuf,
    /// Write the longest run of good steps as a whole recording
    #[arg(long, value_name = "OUT")]
    save: Option<PathBuf>,
    /// Let --save write over an older file
    #[arg(long)]
    force: bool,
    /// Print what was found as JSON on stdout
    #[arg(long)]
    json: bool,
    /// Say nothing on stderr but warnings (the reasons of exit code 3) and errors
    #[arg(short, long)]
    quiet: bool,
}

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Report {
    file: String,
    /// True if nothing is wrong.
    healthy: bool,
    /// True if there is something to save.
    readable: bool,
    /// Why nothing can be used, if so.
    error: Option<String>,
    findings: Vec<Finding>,
    /// First and last numbers of the runs of good steps.
    good_steps: Vec<[u32; 2]>,
    /// First and last number of what is (or would be) saved.
    saved_steps: Option<[u32; 2]>,
    saved_to: Option<String>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    options::messages(args.quiet)?;
    let report = match Recording::read_salvage(&args.file) {
        Err(error @ RecordError::Io { .. }) => return Err(recording::unusable(&error)),
        Err(error) => Report {
            file: args.file.display().to_string(),
            healthy: false,
            readable: false,
            error: Some(error.to_string()),
            findings: Vec::new(),
            good_steps: Vec::new(),
            saved_steps: None,
            saved_to: None,
        },
        Ok(salvage) => {
            if let Some(out) = &args.save {
                save(&args.file, out, args.force, &salvage)?;
            }
            Report {
                file: args.file.display().to_string(),
                healthy: salvage.findings.is_empty(),
                readable: true,
                error: None,
                saved_steps: recording::bounds(&salvage.recording),
                saved_to: args.save.as_ref().map(|p| p.display().to_string()),
                findings: salvage.findings,
                good_steps: salvage.runs,
            }
        }
    };
    if args.json {
        output::print(&output::json(&report)?);
    } else {
        output::print(&report.text());
    }
    Ok(if report.healthy { Done::Clean } else { Done::LookAt })
}

/// Writes the good part as a file of its own.
fn save(from: &Path, to: &Path, force: bool, salvage: &Salvage) -> Result<(), Stop> {
    let same = from.canonicalize().ok().zip(to.canonicalize().ok());
    if same.is_some_and(|(a, b)| a == b) {
        return Err(Stop::input(
            format!("{}: cannot be saved over itself", to.display()),
            "give another name to --save",
        ));
    }
    if to.exists() && !force {
        return Err(Stop::input(
            format!("{} is there already", to.display()),
            "give another name to --save, or write over it with --force",
        ));
    }
    let good = &salvage.recording;
    // Pressures that are single numbers already lose nothing as such.
    let single = good
        .steps
        .iter()
        .flat_map(|s| s.pressures.iter().flatten())
        .all(|v| f64::from(*v as f32).to_bits() == v.to_bits());
    let options = WriterOptions {
        precision: if single { Precision::Single } else { Precision::Double },
        ..WriterOptions::default()
    };
    let reason = match (&good.end, recording::bounds(good)) {
        (Some(end), _) if salvage.findings.is_empty() => end.clone(),
        (_, Some([first, last])) => format!("saved by dip doctor: steps {first} to {last}"),
        (_, None) => "saved by dip doctor: no steps".to_owned(),
    };
    let write = || {
        let mut writer = Writer::create(to, good.setup.clone(), options)?;
        for step in &good.steps {
            writer.step(step)?;
        }
        writer.finish(&reason)
    };
    write().map_err(|e| recording::unwritable(&e))
}

impl Report {
    fn text(&self) -> String {
        let mut lines = Vec::new();
        if let Some(error) = &self.error {
            lines.push(error.clone());
            lines.push("nothing can be saved".to_owned());
        } else if self.healthy {
            let steps = self.saved_steps.map_or("no steps".to_owned(), steps);
            lines.push(format!("{}: nothing is wrong, {steps}", self.file));
        } else {
            lines.extend(self.findings.iter().map(|f| format!("{}: {f}", self.file)));
            let runs: Vec<String> = self.good_steps.iter().map(|run| steps(*run)).collect();
            lines.push(match (&runs[..], self.saved_steps) {
                ([], _) | (_, None) => "good: the setup, no steps".to_owned(),
                ([one], _) => format!("good: {one}"),
                (all, Some(longest)) => format!("good: {}; the longest run is {}", all.join(", "), steps(longest)),
            });
            if self.saved_to.is_none() && self.saved_steps.is_some() {
                lines.push("`--save OUT` writes the good part as a whole recording; `--resume` goes on with a run that was killed".to_owned());
            }
        }
        if let (Some(out), None) = (&self.saved_to, &self.error) {
            let steps = self.saved_steps.map_or("no steps".to_owned(), steps);
            lines.push(format!("saved: {steps} in {out}"));
        }
        lines.join("\n") + "\n"
    }
}

fn steps([first, last]: [u32; 2]) -> String {
    format!("steps {first} to {last}")
}
