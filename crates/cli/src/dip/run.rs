//! `dip run`: compute what is missing of a study.

use super::corrected;
use super::curve::CurveResult;
use super::marched;
use super::study::{Study, Work};
use crate::exit::{Done, Stop};
use crate::options::Common;
use crate::output::{self, RunFolder};
use crate::progress::{bar, watch_interrupts};
use std::path::{Path, PathBuf};

/// Compute what is missing of a study; what is there is kept.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The study file
    study: PathBuf,
    /// Go on after an interrupt; finished curves of the same inputs are kept with or without it
    #[arg(long)]
    resume: bool,
    /// Grids of the flow cases
    #[arg(long, value_enum, default_value_t = Fidelity::Coarse)]
    fidelity: Fidelity,
    #[command(flatten)]
    common: Common,
}

/// How fine the grids of a study's flow cases are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Fidelity {
    /// As the cases say.
    Coarse,
    /// With the `medium` overrides of the study's curves.
    Medium,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    args.common.start()?;
    refuse_resume_with_force(args.resume, &args.common)?;
    let study = Study::read(&args.study, &args.common.set, args.fidelity == Fidelity::Medium)?;
    let folder = args.common.folder(&args.study);
    let results = curves(&study, &folder, &args.common)?;
    if args.common.json {
        output::print(&output::json(&results)?);
    }
    let look = results.iter().any(|r| !r.warnings.is_empty());
    Ok(if look { Done::LookAt } else { Done::Clean })
}

/// `--force` computes everything anew, which is not going on.
///
/// # Errors
/// Both of them given.
pub fn refuse_resume_with_force(resume: bool, common: &Common) -> Result<(), Stop> {
    if resume && common.force {
        return Err(Stop::input(
            "--resume and --force contradict each other",
            "--resume keeps what is there, --force computes it anew",
        ));
    }
    Ok(())
}

/// The curves of a study: read where they are there, computed where they are not.
///
/// # Errors
/// What a curve fails with; finished curves stay on disk.
pub fn curves(study: &Study, folder: &Path, common: &Common) -> Result<Vec<CurveResult>, Stop> {
    watch_interrupts();
    let mut results = Vec::new();
    for curve in &study.curves {
        let stamp = curve.fingerprint.stamp();
        let own = folder.join(curve.slug());
        if let Some(kept) = kept(&own, &stamp.fingerprint).filter(|_| !common.force) {
            tracing::info!("{}: kept from {}", curve.table.name, own.display());
            results.push(kept);
            continue;
        }
        // An older curve of other inputs makes way; recordings of the same inputs in it are kept.
        let to = RunFolder::plain(&own)?;
        tracing::info!("{}: computing from {}", curve.table.name, curve.table.case.display());
        let result = match &curve.work {
            Work::Dlm(case, method) => {
                let steps = 2 + 2 * case.file.lattice.mach.len() as u64;
                let bar = bar(steps, common.quiet);
                let solved = case.solve(None, |stage| {
                    bar.inc(1);
                    bar.set_message(stage.to_owned());
                });
                bar.finish_and_clear();
                CurveResult::frequency(&curve.table.name, stamp, *method, &solved?)
            }
            Work::March(work) => marched::compute(&curve.table.name, stamp, work, &own, common)?,
            Work::Corrected(work) => corrected::compute(&curve.table.name, stamp, work, &own, common)?,
        };
        to.write_json(output::SUMMARY, &result)?;
        results.push(result);
    }
    Ok(results)
}

/// A finished curve of the same inputs, if the folder holds one.
fn kept(folder: &Path, fingerprint: &str) -> Option<CurveResult> {
    let text = std::fs::read_to_string(folder.join(output::SUMMARY)).ok()?;
    let result: CurveResult = serde_json::from_str(&text).ok()?;
    (result.stamp.fingerprint == fingerprint).then_some(result)
}
