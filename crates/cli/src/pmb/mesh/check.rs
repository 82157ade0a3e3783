//! `pmb mesh check FILE`: is the grid good?

use super::quality::{Quality, outcome};
use crate::assemble::grid;
use crate::exit::{Done, Stop};
use crate::options::Common;
use crate::output;
use dip_grid::quality;
use std::path::PathBuf;

/// Options of `pmb mesh check`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The grid: a recipe (.toml)
    file: PathBuf,
    /// Print the report as JSON on stdout
    #[arg(long)]
    json: bool,
    /// Threads to use (default: all cores)
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Say nothing on stderr but errors
    #[arg(short, long)]
    quiet: bool,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    Common {
        out: None,
        force: false,
        set: Vec::new(),
        json: args.json,
        threads: args.threads,
        quiet: args.quiet,
        verbose: 0,
    }
    .start()?;
    let loaded = grid::read(&args.file)?;
    let report = quality::check(&loaded.grid);
    if args.json {
        output::print(&output::json(&Quality::new(&loaded.grid, &report))?);
    } else {
        output::print(&report.to_string());
    }
    Ok(outcome(&report))
}
