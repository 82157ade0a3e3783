//! The `pmb` program: grids and the flow.

mod check_jacobian;
mod logbook;
pub mod march;
mod mesh;
pub mod pitch;
mod residual;
mod steady;

use crate::exit::{Done, Stop, finish};
use crate::options;
use clap::{CommandFactory, Parser, Subcommand};
use std::process::ExitCode;

/// Multi-block grids and the flow on them.
#[derive(Debug, Parser)]
#[command(name = "pmb", version = crate::VERSION, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "Examples:
  pmb mesh meshes/naca0012_c.toml -o runs/naca0012-grid
  pmb mesh check grid.xyz
  pmb mesh convert grid.xyz grid.vtm
  pmb steady cases/naca0012/steady.toml
  pmb steady cases/agard445/steady.toml --set flow.mach=0.678 --out runs/agard-M0678
  pmb steady cases/agard445/steady.toml --resume
  pmb pitch cases/agard445/pitch.toml
  pmb march cases/agard445/march.toml

Exit codes: 0 done; 1 failed; 2 bad arguments or input; 3 done, with a warning to look at; 130 interrupted.";

#[derive(Debug, Subcommand)]
enum Command {
    /// Make a grid from a recipe; check or convert a grid
    Mesh(mesh::Args),
    /// Steady flow: forces, pressure cuts, history, restart file
    Steady(steady::Args),
    /// Unsteady flow with prescribed motion: pitch, plunge, a mode, a control surface; recording and first harmonics
    Pitch(pitch::Args),
    /// Flow and structure marched together: one run, or the flutter point
    March(march::Args),
    /// For developers: the assembled Jacobian against differences of the residual
    CheckJacobian(check_jacobian::Args),
    /// For developers: norms and worst cells of the residual of a case or its restart file
    Residual(residual::Args),
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
        Command::Mesh(args) => mesh::run(&args),
        Command::Steady(args) => steady::run(&args),
        Command::Pitch(args) => pitch::run(&args),
        Command::March(args) => march::run(&args),
        Command::CheckJacobian(args) => check_jacobian::run(&args),
        Command::Residual(args) => residual::run(&args),
        Command::Completions { shell } => {
            options::completions(&mut Cli::command(), shell);
            Ok(Done::Clean)
        }
    }
}
