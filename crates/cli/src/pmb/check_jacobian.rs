//! `pmb check-jacobian`: the solver's Jacobian against differentiation of its residual.

use crate::assemble::{flow, grid};
use crate::exit::{Done, Stop};
use crate::options::Common;
use crate::output;
use dip_case::file::SteadyFile;
use dip_pmb::check::{JacobianCheck, check_jacobian};
use dip_pmb::steady;
use serde::Serialize;
use std::path::PathBuf;

/// Largest difference that passes, over the largest entry.
const TOLERANCE: f64 = 1e-8;

/// Check the analytic Jacobian of a case against differentiation of its residual (for developers)
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The case file (.toml) of a steady run
    case: PathBuf,
    /// Check at the undisturbed stream even if the run's folder holds a restart file
    #[arg(long)]
    stream: bool,
    #[command(flatten)]
    common: Common,
}

const EXAMPLES: &str = "Examples:
  pmb check-jacobian cases/naca0012/steady.toml
  pmb check-jacobian cases/naca0012/steady.toml --out runs/alpha2 --json

The flow is that of the restart file in the run's folder, else the undisturbed stream.

Exit codes: 0 they agree to 1e-8; 1 failed; 2 bad arguments or input; 3 they do not agree.";

/// Names of the equations, in the solver's order.
pub const EQUATIONS: [&str; 5] = ["mass", "x-momentum", "y-momentum", "z-momentum", "energy"];

#[derive(Debug, Serialize)]
struct Summary<'a> {
    command: &'static str,
    /// True if the flow is that of the restart file.
    restart: bool,
    tolerance: f64,
    passed: bool,
    worst: &'a JacobianCheck,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    args.common.start()?;
    let document = args.common.document(&args.case)?;
    let file: SteadyFile = document.load()?;
    let mut settings = flow::settings(&document, &file)?;
    let mesh = grid::from_case(&document, &file.mesh)?;
    flow::on_grid(&mut settings, &document, &file, &mesh.grid)?;
    let path = args.common.folder(&args.case).join(super::steady::RESTART);
    settings.resume = path.exists() && !args.stream;
    settings.restart = Some(path);

    let (mut equations, level) = steady::equations(&settings, &mesh.grid).map_err(|e| flow::explain(&document, e))?;
    let worst = check_jacobian(&mut equations).map_err(|e| flow::explain(&document, e))?;
    // A NaN does not pass.
    let passed = worst.relative <= TOLERANCE && worst.residual <= TOLERANCE;
    if args.common.json {
        output::print(&output::json(&Summary {
            command: "pmb check-jacobian",
            restart: settings.resume,
            tolerance: TOLERANCE,
            passed,
            worst: &worst,
        })?);
    } else {
        let [i, j, k] = worst.ijk;
        output::print(&format!(
            "{} of {} cells on level {level}: largest difference {:.2e} of the largest entry, block {} cell i {i} j {j} k {k}, {}; residual and \
             differentiated fluxes differ by {:.2e}: {}\n",
            if settings.resume {
                "restart file"
            } else {
                "undisturbed stream"
            },
            equations.level.cell_count,
            worst.relative,
            worst.block,
            EQUATIONS.get(worst.equation).copied().unwrap_or("?"),
            worst.residual,
            if passed { "agrees" } else { "DOES NOT AGREE to 1e-8" },
        ));
    }
    Ok(if passed { Done::Clean } else { Done::LookAt })
}
