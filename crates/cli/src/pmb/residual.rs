//! `pmb residual`: how large the residual of a flow is, and where.

use super::check_jacobian::EQUATIONS;
use crate::assemble::{flow, grid};
use crate::exit::{Done, Stop};
use crate::options::Common;
use crate::output::{self, RunFolder};
use dip_case::file::SteadyFile;
use dip_grid::MultiBlock;
use dip_grid::vtk::{self, Field, On};
use dip_pmb::check::{ResidualReport, report_residual};
use dip_pmb::steady;
use serde::Serialize;
use std::path::PathBuf;

/// Evaluate the residual of a case: norms by equation, worst cells, ParaView file (for developers)
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The case file (.toml) of a steady run
    case: PathBuf,
    /// Cells to list
    #[arg(long, value_name = "N", default_value_t = 10)]
    worst: usize,
    /// Evaluate the undisturbed stream even if the run's folder holds a restart file
    #[arg(long)]
    stream: bool,
    #[command(flatten)]
    common: Common,
}

const EXAMPLES: &str = "Examples:
  pmb residual cases/naca0012/steady.toml
  pmb residual cases/naca0012/steady.toml --worst 30 --out runs/alpha2 --json

The flow is that of the restart file in the run's folder, else the undisturbed stream. residual.vtm in that folder
shows the residual by cell.

Exit codes: 0 done; 1 failed; 2 bad arguments or input.";

#[derive(Debug, Serialize)]
struct Summary<'a> {
    command: &'static str,
    /// True if the flow is that of the restart file.
    restart: bool,
    /// Level of the flow: 0 is the case's grid, n the one merged n times.
    level: usize,
    equations: [&'static str; 5],
    residual: &'a ResidualReport,
    /// Where the residual by cell is; none for a flow on a coarser level.
    paraview: Option<String>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    args.common.start()?;
    let document = args.common.document(&args.case)?;
    let file: SteadyFile = document.load()?;
    let mut settings = flow::settings(&document, &file)?;
    let mesh = grid::from_case(&document, &file.mesh)?;
    flow::on_grid(&mut settings, &document, &file, &mesh.grid)?;
    let path = args.common.folder(&args.case);
    let restart = path.join(super::steady::RESTART);
    settings.resume = restart.exists() && !args.stream;
    settings.restart = Some(restart);

    let (mut equations, level) = steady::equations(&settings, &mesh.grid).map_err(|e| flow::explain(&document, e))?;
    let mut residual = Vec::new();
    let report = report_residual(&mut equations, &settings.flow.state(), args.worst, &mut residual)
        .map_err(|e| flow::explain(&document, e))?;
    let paraview = if level == 0 {
        let folder = RunFolder::plain(&path)?;
        Some(write(&folder, &mesh.grid, &residual)?)
    } else {
        None
    };
    if args.common.json {
        output::print(&output::json(&Summary {
            command: "pmb residual",
            restart: settings.resume,
            level,
            equations: EQUATIONS,
            residual: &report,
            paraview,
        })?);
    } else {
        let what = if settings.resume {
            "restart file"
        } else {
            "undisturbed stream"
        };
        output::print(&table(&report, what, level));
        match paraview {
            Some(path) => tracing::info!("residual by cell in {path}"),
            None => tracing::info!("the restart file is of a coarser level: there is no ParaView file"),
        }
    }
    Ok(Done::Clean)
}

/// The residual of every cell as fields for ParaView; returns the file's path.
fn write(folder: &RunFolder, grid: &MultiBlock, residual: &[f64]) -> Result<String, Stop> {
    let mut fields: Vec<Field> = [("mass", 1), ("momentum", 3), ("energy", 1)]
        .into_iter()
        .map(|(name, components)| Field {
            name: format!("residual_{name}"),
            on: On::Cells,
            components,
            values: Vec::with_capacity(grid.blocks.len()),
        })
        .collect();
    let mut cells = residual.chunks_exact(5);
    for block in &grid.blocks {
        let mut values: [Vec<f64>; 3] = Default::default();
        for r in cells.by_ref().take(block.cell_count()) {
            values[0].push(r[0]);
            values[1].extend_from_slice(&r[1..4]);
            values[2].push(r[4]);
        }
        for (field, values) in fields.iter_mut().zip(values) {
            field.values.push(values);
        }
    }
    let path = folder.path().join("residual.vtm");
    vtk::write(&path, grid, &fields).map_err(|e| {
        Stop::failed(
            format!("{}: cannot write: {e}", path.display()),
            "check the disk's space, or name another folder with --out DIR",
        )
    })?;
    Ok(path.display().to_string())
}

fn table(report: &ResidualReport, what: &str, level: usize) -> String {
    let mut text = format!(
        "{what}, level {level}: residual {:.2} orders below that of the undisturbed stream ({:.3e})\n{:<12}{:>14}{:>14}\n",
        report.orders, report.stream_norm, "equation", "L2 norm", "largest"
    );
    for ((name, norm), largest) in EQUATIONS.iter().zip(report.norms).zip(report.largest) {
        text.push_str(&format!("{name:<12}{norm:>14.4e}{largest:>14.4e}\n"));
    }
    text.push_str(&format!(
        "{:<16}{:>6}{:>6}{:>6}  {:<12}{:>14}\n",
        "block", "i", "j", "k", "equation", "residual"
    ));
    for cell in &report.worst {
        let [i, j, k] = cell.ijk;
        text.push_str(&format!(
            "{:<16}{i:>6}{j:>6}{k:>6}  {:<12}{:>14.4e}\n",
            cell.block,
            EQUATIONS.get(cell.equation).copied().unwrap_or("?"),
            cell.residual
        ));
    }
    text
}
