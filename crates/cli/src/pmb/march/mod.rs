//! `pmb march`: flow and structure marched together, once or until the flutter point is found.

mod case;
mod files;
mod inspect;
mod listen;
mod motion;
mod parameter;
mod recording;
mod searching;
mod steps;
mod summary;
mod trial;
mod vg;

use crate::assemble::grid;
use crate::exit::{Done, Stop};
use crate::options::Common;
use crate::output;
use crate::progress::{Timer, watch_interrupts};
use case::March;
use dip_case::Document;
use dip_case::file::MarchFile;
use dip_pmb::march::MarchStop;
use searching::Searched;
use std::path::{Path, PathBuf};
use summary::Cost;
pub use summary::{FlutterPoint, ModeRow, Summary, TrialRow};

/// Fingerprint of what a run was begun from.
const INPUTS: &str = "inputs.sha256";
/// Finished runs of a search.
const TRIALS: &str = "trials.json";

/// Flow and structure marched together: one run, or with `[search]` the flutter point.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The case file (.toml)
    case: PathBuf,
    /// Go on with an interrupted or killed run or search; finished runs are kept
    #[arg(long)]
    resume: bool,
    /// V-g curves of the frequency domain (vg.csv of `dlm flutter`) to draw beside those of the march
    #[arg(long, value_name = "FILE")]
    beside: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

const EXAMPLES: &str = "Examples:
  pmb march cases/agard445/march.toml
  pmb march cases/agard445/march.toml --set flow.mach=0.96 --set 'flow.speed=\"309.01 m/s\"' --set 'flow.density=\"0.06339 kg/m^3\"' --out runs/m096
  pmb march cases/agard445/march.toml --set 'search.parameter=\"altitude\"' --out runs/matched
  pmb march cases/agard445/march.toml --beside runs/agard445-flutter/vg.csv
  pmb march cases/agard445/march.toml --resume

Exit codes: 0 done; 1 failed; 2 bad arguments or input; 3 done, but no flutter point was found, the wing diverges or keeps a limit
cycle, or steps did not converge; 130 interrupted, --resume goes on.";

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    args.common.start()?;
    let beside = args.beside.as_deref().map(vg::read).transpose()?;
    let document = args.common.document(&args.case)?;
    let folder = args.common.folder(&args.case);
    let (summary, table) = march(&document, &folder, args.resume, &args.common, beside.as_deref())?;
    if args.common.json {
        output::print(&output::json(&summary)?);
    } else {
        output::print(&table);
        tracing::info!("results in {}", folder.display());
    }
    Ok(if summary.warnings.is_empty() {
        Done::Clean
    } else {
        Done::LookAt
    })
}

/// A finished march of the same inputs in `path`, if there is one.
///
/// # Errors
/// What is wrong in the case.
pub fn kept(document: &Document, path: &Path) -> Result<Option<Summary>, Stop> {
    let Ok(text) = std::fs::read_to_string(path.join(output::SUMMARY)) else {
        return Ok(None);
    };
    let file: MarchFile = document.load()?;
    let mesh = grid::from_case(document, &file.mesh)?;
    let stamp = case::stamp(document, &file, &mesh.hash);
    let summary: Option<Summary> = serde_json::from_str(&text).ok();
    Ok(summary.filter(|s| s.stamp.fingerprint == stamp.fingerprint))
}

/// Runs a case and writes its results to `path`.
///
/// # Errors
/// What is wrong in the case, or what a solver fails with; finished runs and restart files stay.
pub fn compute(document: &Document, path: &Path, resume: bool, common: &Common) -> Result<Summary, Stop> {
    march(document, path, resume, common, None).map(|(summary, _)| summary)
}

/// The summary, and the table for stdout.
fn march(
    document: &Document,
    path: &Path,
    resume: bool,
    common: &Common,
    beside: Option<&[vg::Line]>,
) -> Result<(Summary, String), Stop> {
    watch_interrupts();
    let total = Timer::start();
    let mut stages = Vec::new();
    let march = March::read(document, path, resume, common, &mut stages)?;
    let file = &march.file;
    let index = match &file.speed_index {
        Some(table) => Some(crate::frequency::reference(document, table, None)?),
        None => None,
    };
    let searched = if file.search.is_some() {
        march.searched(&mut stages)?
    } else {
        let at = march.search.first;
        let trial = march.trial(at, 1, None)?;
        stages.push((format!("march, {}", march.parameter.words(at)), trial.seconds));
        Searched {
            trials: vec![trial],
            found: None,
            limit: None,
            reason: "single run".to_owned(),
        }
    };
    let warnings = warnings(&march, &searched);
    for warning in &warnings {
        tracing::warn!("{warning}");
    }
    files::damping(&march.folder, &march, &searched)?;
    vg::write(&march, &searched, index.as_ref(), beside)?;
    let divergence = march.divergence(&searched, total.seconds().wall_s);
    let Searched {
        trials, found, reason, ..
    } = searched;
    let point = found.map(|f| march.point(&f, &trials, index.as_ref(), total.seconds().wall_s));
    let cost = Cost::sum(trials.iter().map(|t| &t.cost));
    if trials.len() > 1 {
        tracing::info!("all runs: {}", cost.words());
    }
    let summary = Summary {
        command: "pmb march".to_owned(),
        stamp: march.stamp.clone(),
        settings: document.text().to_owned(),
        stop_reason: reason,
        mach: file.flow.mach,
        speed_m_s: march.parameter.stream(march.search.first).speed_m_s,
        cells: march.grid.cell_count(),
        mesh_hash: march.mesh_hash.clone(),
        natural_frequencies_hz: march
            .wing
            .equations
            .omega_rad_s
            .iter()
            .map(|w| w / std::f64::consts::TAU)
            .collect(),
        time_step_s: march.settings.step_s,
        transfer: march.inspection.clone(),
        flutter: point.into_iter().collect(),
        divergence,
        trials,
        warnings,
        stages,
        cost,
        total: total.seconds(),
    };
    march.folder.write_json(output::SUMMARY, &summary)?;
    let table = summary::text(&summary, march.parameter);
    Ok((summary, table))
}

/// What the user must look at.
fn warnings(march: &March<'_>, searched: &Searched) -> Vec<String> {
    let mut warnings = march.inspection.warnings();
    if !march.mean.stop.is_converged() {
        warnings.push(format!(
            "the steady start is not converged ({:?}): look at it by `pmb steady`",
            march.mean.stop
        ));
    }
    if march.file.search.is_some() && searched.found.is_none() {
        warnings.push(format!("no flutter point: {}", searched.reason));
    }
    if let Some(point) = searched.found.filter(|_| searched.reason != "found") {
        warnings.push(format!(
            "the flutter point is known to {:.3} %, not to the {:.3} % asked for: {}; give more search.runs or a larger search.tolerance",
            100.0 * point.error / point.at,
            100.0 * march.search.tolerance,
            searched.reason
        ));
    }
    for t in &searched.trials {
        let place = march.parameter.words(t.at);
        if t.not_converged > 0 {
            warnings.push(format!(
                "{place}: {} of {} time steps did not converge",
                t.not_converged, t.steps
            ));
        }
        // Beyond the flutter point it is no news, and beyond the point of divergence it has been said.
        let is_news = searched.limit.is_none() && searched.found.is_none_or(|point| t.at < point.at);
        if t.diverges && is_news {
            let rate = t.rate_1_s.map_or_else(String::new, |r| format!(" at {r:.3} 1/s"));
            warnings.push(format!(
                "{place}: divergence: the wing moves away without oscillating{rate}"
            ));
        }
        if !t.settled {
            warnings.push(format!(
                "{place}: the position in which the structure holds the steady load was not found: it is beyond divergence, near it, or the flow is not steady"
            ));
        }
        if let Some(drift) = &t.drift {
            let rate = drift.rate_error_1_s.map_or_else(
                || "at a rate that changes its sign".to_owned(),
                |e| format!("growing at {:.2} +- {e:.2} 1/s", drift.rate_1_s),
            );
            warnings.push(format!(
                "{place}: divergence cannot be told from a drift that dies out: {:.0} % of the energy at the end does not oscillate, {rate}; give \
                more march.cycles",
                100.0 * drift.share
            ));
        }
        if let Some(c) = &t.limit_cycle {
            warnings.push(format!(
                "{place}: limit cycle: the motion has grown (g {:+.4}) and keeps its size now, {:.2} Hz, up to {:.3} mm at the wall",
                c.g_early,
                c.frequency_hz,
                1e3 * c.wall_amplitude_m
            ));
        }
        if let MarchStop::RanAway(words) = &t.stop {
            tracing::info!("{place}: {words}");
        }
    }
    warnings
}
