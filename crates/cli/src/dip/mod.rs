//! The `dip` program: whole studies, and what recordings hold.

mod compare;
mod corrected;
mod curve;
mod damping;
mod doctor;
mod export;
mod info;
mod marched;
mod published;
mod recording;
mod report;
mod run;
mod study;

use crate::exit::{Done, Stop, finish};
use crate::{options, output};
use clap::{CommandFactory, Parser, Subcommand};
use std::process::ExitCode;

/// Flutter boundaries by several methods, side by side with experiment; and recordings of unsteady runs.
#[derive(Debug, Parser)]
#[command(name = "dip", version = crate::VERSION, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "Examples:
  dip compare cases/agard445/boundary.toml
  dip run cases/agard445/boundary.toml --out runs/agard
  dip info runs/agard445-pitch/pitch.mcap
  dip schema flutter > flutter.schema.json

Exit codes: 0 done; 1 failed; 2 bad arguments or input; 3 done, with a warning to look at; 130 interrupted.";

#[derive(Debug, Subcommand)]
enum Command {
    /// Compute what is missing of a study; what is there is kept
    Run(run::Args),
    /// Table, figures and HTML report of a study: boundaries against experiment; computes what is missing
    Compare(compare::Args),
    /// What a recording holds: reference quantities, motion, surface, steps
    Info(info::Args),
    /// Write a recording as tables, JSON, ParaView files, or first harmonics of the pressures
    Export(export::Args),
    /// What is wrong with a recording, and what can be saved
    Doctor(doctor::Args),
    /// Print the JSON Schema of a kind of case file
    Schema {
        /// wing, structure, flutter, study, steady, pitch or march
        kind: String,
    },
    /// Print the completions of a shell
    #[command(hide = true)]
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
}

/// Runs the program and returns its exit code.
pub fn main() -> ExitCode {
    finish(run(Cli::parse().command))
}

fn run(command: Command) -> Result<Done, Stop> {
    match command {
        Command::Run(args) => run::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Doctor(args) => doctor::run(&args),
        Command::Schema { kind } => schema(&kind),
        Command::Completions { shell } => {
            options::completions(&mut Cli::command(), shell);
            Ok(Done::Clean)
        }
    }
}

fn schema(kind: &str) -> Result<Done, Stop> {
    let all = dip_case::file::schemas();
    match all.iter().find(|(name, _)| *name == kind) {
        Some((_, schema)) => {
            output::print(&output::json(schema)?);
            Ok(Done::Clean)
        }
        None => {
            let names: Vec<&str> = all.iter().map(|(n, _)| *n).collect();
            Err(Stop::input(
                format!("no kind of case file `{kind}`"),
                format!("known: {}", names.join(", ")),
            ))
        }
    }
}
