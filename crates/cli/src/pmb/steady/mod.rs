//! `pmb steady`: steady flow.

pub(in crate::pmb) mod cuts;
mod files;
pub(in crate::pmb) mod watch;

use crate::assemble::{flow, grid};
use crate::exit::{Done, Stop};
use crate::options::Common;
use crate::output::{self, RunFolder};
use crate::progress::{Seconds, Timer, watch_interrupts};
use crate::stamp::{Fingerprint, Stamp};
use cuts::Cut;
use dip_case::file::{FlowModel, SteadyFile};
use dip_pmb::loads::Coefficients;
use dip_pmb::settings::{FlowSettings, Reference};
use dip_pmb::steady::{self as solver, SteadyResult, StopReason};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The restart file.
pub(super) const RESTART: &str = "restart.pmb";

/// Steady flow: forces, pressure cuts, history, restart file.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The case file (.toml)
    case: PathBuf,
    /// Go on from the restart file of an interrupted run, or of a finished one with more iterations or orders
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    common: Common,
}

const EXAMPLES: &str = "Examples:
  pmb steady cases/naca0012/steady.toml
  pmb steady cases/naca0012/steady.toml --set flow.alpha=\"2 deg\" --out runs/alpha2 --json
  pmb steady cases/naca0012/steady.toml --resume

Exit codes: 0 converged; 1 failed; 2 bad arguments or input; 3 not converged; 130 interrupted, --resume goes on.";

/// What `summary.json` holds.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    command: &'static str,
    stamp: Stamp,
    settings: &'a str,
    stop_reason: &'a StopReason,
    converged: bool,
    model: FlowModel,
    mach: f64,
    alpha_deg: f64,
    beta_deg: f64,
    /// None where the grid has no wall.
    cl: Option<f64>,
    cd: Option<f64>,
    cy: Option<f64>,
    cm: Option<f64>,
    /// By the name of the wall.
    patches: &'a BTreeMap<String, Coefficients>,
    reference: Option<ReferenceValues>,
    forces: Option<Forces>,
    cells: usize,
    blocks: usize,
    mesh_hash: &'a str,
    iterations: usize,
    /// Orders of magnitude below the residual of the undisturbed stream.
    residual_drop_orders: f64,
    bytes_per_cell: f64,
    warnings: Vec<String>,
    stages: &'a [(String, Seconds)],
    total: Seconds,
}

#[derive(Debug, Serialize)]
struct ReferenceValues {
    area_m2: f64,
    chord_m: f64,
    moment_point_m: [f64; 3],
}

/// Forces of the model as it is: of the half for a half model.
#[derive(Debug, Serialize)]
struct Forces {
    dynamic_pressure_pa: f64,
    lift_n: f64,
    drag_n: f64,
    pitching_moment_n_m: f64,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    args.common.start()?;
    watch_interrupts();
    let total = Timer::start();
    let document = args.common.document(&args.case)?;
    let file: SteadyFile = document.load()?;
    // Before the grid, which may take a while.
    let mut settings = flow::settings(&document, &file)?;
    let measured = cuts::measured(&document, &file)?;
    let etas = cuts::stations(&document, &file)?;

    let mut stages = Vec::new();
    let timer = Timer::start();
    let mesh = grid::from_case(&document, &file.mesh)?;
    stages.push(("mesh".to_owned(), timer.seconds()));
    flow::on_grid(&mut settings, &document, &file, &mesh.grid)?;

    let mut fingerprint = Fingerprint::new();
    fingerprint.document(&document).text(&mesh.hash);
    let stamp = fingerprint.stamp();
    // A run that goes on is not another one; the solver refuses a restart file of another flow or grid.
    let path = args.common.folder(&args.case);
    let restart = path.join(RESTART);
    if args.resume && !restart.exists() {
        return Err(Stop::input(
            format!("{}: there is no restart file to go on from", restart.display()),
            "leave --resume out to start anew, or name the folder of the run with --out DIR",
        ));
    }
    let folder = RunFolder::open(&path, &stamp, args.common.force || args.resume)?;
    settings.restart = Some(restart);
    settings.resume = args.resume;

    let timer = Timer::start();
    let mut watch = watch::Watch::new(args.common.quiet, settings.solver.orders);
    let cancel = watch.cancel();
    let result = solver::run(&settings, &mesh.grid, &mut watch, &cancel);
    watch.finish();
    let result = result.map_err(|e| flow::explain(&document, e))?;
    stages.push(("flow".to_owned(), timer.seconds()));

    let timer = Timer::start();
    let cuts = cuts::make(&etas, &mesh.grid, &result.walls);
    files::write(&folder, &settings, &result, &cuts, &measured)?;
    if file.steady.paraview.unwrap_or(true) {
        files::write_flow(&folder, &settings.flow, &mesh.grid, &result)?;
    }
    stages.push(("write".to_owned(), timer.seconds()));

    let warnings = warnings(&result, settings.solver.orders, &cuts);
    for warning in &warnings {
        tracing::warn!("{warning}");
    }
    let forces = |value: fn(&Coefficients) -> f64| file.reference.is_some().then(|| value(&result.loads.total));
    let summary = Summary {
        command: "pmb steady",
        stamp,
        settings: document.text(),
        stop_reason: &result.stop,
        converged: result.stop.is_converged(),
        model: file.flow.model,
        mach: settings.flow.mach,
        alpha_deg: settings.flow.alpha_deg,
        beta_deg: settings.flow.beta_deg,
        cl: forces(|c| c.cl),
        cd: forces(|c| c.cd),
        cy: forces(|c| c.cy),
        cm: forces(|c| c.cm),
        patches: &result.loads.patches,
        reference: file.reference.is_some().then_some(ReferenceValues {
            area_m2: settings.reference.area,
            chord_m: settings.reference.chord,
            moment_point_m: settings.reference.moment_point,
        }),
        forces: dimensional(&file, &settings.reference, &result.loads.total),
        cells: mesh.grid.cell_count(),
        blocks: mesh.grid.blocks.len(),
        mesh_hash: &mesh.hash,
        iterations: result.history.len(),
        residual_drop_orders: result.orders,
        bytes_per_cell: result.bytes_per_cell,
        warnings,
        stages: &stages,
        total: total.seconds(),
    };
    folder.write_json(output::SUMMARY, &summary)?;
    if args.common.json {
        output::print(&output::json(&summary)?);
    } else {
        output::print(&table(&settings.flow, &result));
        tracing::info!("results in {}", folder.path().display());
    }
    ended(&args.case, &folder, &result)
}

/// Exit code 0, 3 or 130.
fn ended(case: &Path, folder: &RunFolder, result: &SteadyResult) -> Result<Done, Stop> {
    match result.stop {
        StopReason::Interrupted => Err(Stop::Interrupted(format!(
            "{} steps are in {}; `pmb steady {} --out {} --resume` goes on",
            result.history.len(),
            folder.path().join(RESTART).display(),
            case.display(),
            folder.path().display(),
        ))),
        _ if result.stop.is_converged() => Ok(Done::Clean),
        _ => Ok(Done::LookAt),
    }
}

fn dimensional(file: &SteadyFile, reference: &Reference, c: &Coefficients) -> Option<Forces> {
    file.reference.as_ref()?;
    let q = 0.5 * file.flow.density?.0 * file.flow.speed?.0.powi(2);
    let force = q * reference.area;
    Some(Forces {
        dynamic_pressure_pa: q,
        lift_n: c.cl * force,
        drag_n: c.cd * force,
        pitching_moment_n_m: c.cm * force * reference.chord,
    })
}

fn warnings(result: &SteadyResult, asked: f64, cuts: &[Cut]) -> Vec<String> {
    let mut warnings = Vec::new();
    let (orders, steps) = (result.orders, result.history.len());
    match result.stop {
        StopReason::MaxSteps => warnings.push(format!(
            "not converged: the residual fell by {orders:.2} orders in {steps} steps, {asked} were asked for; go on with --resume --set steady.iterations=N"
        )),
        StopReason::Stalled => warnings.push(format!(
            "not converged: no step could be found after {steps} steps; the residual fell by {orders:.2} orders, the last good flow is kept"
        )),
        StopReason::Converged | StopReason::RoundOff | StopReason::Interrupted => {}
    }
    for cut in cuts.iter().filter(|c| c.upper.is_empty() && c.lower.is_empty()) {
        warnings.push(format!("no wall at the station {}", cut.label));
    }
    warnings
}

/// Coefficients by wall, and how the run ended.
fn table(flow: &FlowSettings, result: &SteadyResult) -> String {
    let reason = match result.stop {
        StopReason::Converged => "converged",
        StopReason::RoundOff => "converged to round-off",
        StopReason::MaxSteps => "NOT CONVERGED (all steps used)",
        StopReason::Stalled => "NOT CONVERGED (stalled)",
        StopReason::Interrupted => "interrupted",
    };
    let mut text = format!(
        "Mach {}, alpha {} deg: {reason} after {} steps, residual down {:.2} orders\n",
        flow.mach,
        flow.alpha_deg,
        result.history.len(),
        result.orders
    );
    if result.loads.patches.is_empty() {
        return text;
    }
    let mut row = |name: &str, c: &Coefficients| {
        text.push_str(&format!(
            "{name:<16}{:>13.7}{:>13.7}{:>13.7}{:>13.7}\n",
            c.cl, c.cd, c.cy, c.cm
        ));
    };
    for (name, c) in &result.loads.patches {
        row(name, c);
    }
    row("total", &result.loads.total);
    let header = format!("{:<16}{:>13}{:>13}{:>13}{:>13}\n", "wall", "CL", "CD", "CY", "CM");
    let at = text.find('\n').map_or(text.len(), |n| n + 1);
    text.insert_str(at, &header);
    text
}
