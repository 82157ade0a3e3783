//! The `dlm` program: the frequency domain.

mod aic;
mod correct;
mod deck;

mod figures;
mod flutter;
mod modes;

use crate::exit::{Done, Stop, finish};
use crate::options;
use clap::{CommandFactory, Parser, Subcommand};
use std::process::ExitCode;

/// Doublet lattice, normal modes and flutter in the frequency domain.
#[derive(Debug, Parser)]
#[command(name = "dlm", version = crate::VERSION, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "Examples:
  dlm modes cases/agard445/structure.toml
  dlm flutter cases/agard445/flutter.toml --set lattice.chordwise=10
  dlm flutter wing.bdf
  dlm correct cases/agard445/flutter.toml --from pitch.mcap
  dlm aic cases/agard445/flutter.toml --json

Exit codes: 0 done; 1 failed; 2 bad arguments or input; 3 done, with a warning to look at; 130 interrupted.";

#[derive(Debug, Subcommand)]
enum Command {
    /// Normal modes of a structure
    Modes(modes::Args),
    /// Influence coefficients and generalized forces over Mach number and reduced frequency
    Aic(aic::Args),
    /// Flutter by K, KE, PK and g; a case file or a Nastran SOL 145 deck
    Flutter(flutter::Args),
    /// The lattice corrected by recorded pressures, its flutter, and the audit of the hand-over
    Correct(correct::Args),
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
        Command::Modes(args) => modes::run(&args),
        Command::Aic(args) => aic::run(&args),
        Command::Flutter(args) => flutter::run(&args),
        Command::Correct(args) => correct::run(&args),
        Command::Completions { shell } => {
            options::completions(&mut Cli::command(), shell);
            Ok(Done::Clean)
        }
    }
}
