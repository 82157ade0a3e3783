//! `pmb mesh check FILE`: is the grid good?

use super::quality::{Quality, outcome};
use super::target::Target;
use super::words;
use crate::assemble::grid;
use crate::exit::{Done, Stop};
use crate::output;
use dip_grid::{quality, vtk};
use std::path::PathBuf;

/// Options of `pmb mesh check`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The grid: Plot3D of any layout, CGNS (.cgns), or a recipe (.toml)
    file: PathBuf,
    /// Boundary conditions (.toml or .nmf; default: the .bc.toml or .nmf beside the grid)
    #[arg(long, value_name = "FILE")]
    boundary_conditions: Option<PathBuf>,
    /// Write the worst cells as a ParaView file (.vtu)
    #[arg(long, value_name = "FILE")]
    worst: Option<PathBuf>,
    /// Print the report as JSON on stdout
    #[arg(long)]
    json: bool,
    /// Say nothing on stderr but warnings (the reasons of exit code 3) and errors
    #[arg(short, long)]
    quiet: bool,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    words(args.quiet)?;
    let loaded = grid::read(&args.file, args.boundary_conditions.as_deref())?;
    let report = quality::check(&loaded.grid);
    if let Some(path) = &args.worst {
        vtk::write_worst(path, &loaded.grid, &report).map_err(|e| Target::failed(path, &e))?;
    }
    if args.json {
        output::print(&output::json(&Quality::new(&loaded.grid, &report))?);
    } else {
        output::print(&report.to_string());
    }
    Ok(outcome(&report, args.json))
}
