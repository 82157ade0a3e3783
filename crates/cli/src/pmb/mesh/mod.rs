//! `pmb mesh`: grids made, checked and converted.

mod check;
mod convert;
mod make;
mod quality;
mod target;

use crate::exit::{Done, Stop};
use crate::options::Common;
use dip_grid::cgns::IS_BUILT;

/// Make a grid from a recipe, check it and draw it.
#[derive(Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true, after_help = help())]
pub struct Args {
    #[command(subcommand)]
    action: Option<Action>,
    #[command(flatten)]
    make: make::Args,
}

const EXAMPLES: &str = "Examples:
  pmb mesh meshes/naca0012_c.toml -o runs/naca0012-grid
  pmb mesh meshes/naca0012_c.toml -o naca0012.xyz
  pmb mesh check naca0012.xyz
  pmb mesh convert naca0012.xyz naca0012.vtm

Exit code 3: the grid was made, and the check found something that a user must look at.";

/// Examples, and which files this program was built for.
fn help() -> String {
    let cgns = if IS_BUILT {
        "CGNS is built in."
    } else {
        "CGNS is not built in: `cargo build --release --features cgns`."
    };
    format!("{EXAMPLES}\n{cgns}")
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Check a grid: volumes, closure, skewness, stretching, interfaces, faces without a condition
    Check(check::Args),
    /// Write a grid as another kind of file: Plot3D of any layout, CGNS, ParaView
    Convert(convert::Args),
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    match &args.action {
        Some(Action::Check(check)) => check::run(check),
        Some(Action::Convert(convert)) => convert::run(convert),
        None => make::run(&args.make),
    }
}

/// Sets up messages for the actions that have no results folder.
fn words(quiet: bool) -> Result<(), Stop> {
    Common {
        out: None,
        force: false,
        set: Vec::new(),
        json: false,
        threads: None,
        quiet,
        verbose: 0,
    }
    .start()
}
