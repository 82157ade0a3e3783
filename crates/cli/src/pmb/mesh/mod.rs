//! `pmb mesh`: grids made and checked.

mod check;
mod make;
mod quality;

use crate::exit::{Done, Stop};

/// Make a grid from a recipe, check it and draw it.
#[derive(Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true, after_help = EXAMPLES)]
pub struct Args {
    #[command(subcommand)]
    action: Option<Action>,
    #[command(flatten)]
    make: make::Args,
}

const EXAMPLES: &str = "Examples:
  pmb mesh meshes/naca0012_c.toml -o runs/naca0012-grid
  pmb mesh check meshes/agard445_ch_euler.toml

Exit code 3: the grid was made, and the check found something that a user must look at.";

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Check a grid: volumes, closure, skewness, stretching, interfaces, faces without a condition
    Check(check::Args),
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    match &args.action {
        Some(Action::Check(check)) => check::run(check),
        None => make::run(&args.make),
    }
}
