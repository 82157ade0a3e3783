//! `dip run`: compute what is missing of a study.

use super::study::{Curve, CurveResult, Study};
use crate::exit::{Done, Stop};
use crate::frequency::FrequencyResults;
use crate::options::Common;
use crate::output::{self, RunFolder};
use crate::progress::{bar, watch_interrupts};
use crate::traces::{MachCurves, ModeShapes};
use std::path::{Path, PathBuf};

/// Compute what is missing of a study; what is there is kept.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The study file
    study: PathBuf,
    /// Go on after an interrupt; finished curves of the same inputs are kept with or without it
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    common: Common,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    args.common.start()?;
    refuse_resume_with_force(args.resume, &args.common)?;
    let study = Study::read(&args.study, &args.common.set)?;
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
        let stamp = curve.case.fingerprint.stamp();
        let own = folder.join(curve.slug());
        if let Some(kept) = kept(&own, &stamp.fingerprint, curve).filter(|_| !common.force) {
            tracing::info!("{}: kept from {}", curve.table.name, own.display());
            results.push(kept);
            continue;
        }
        let to = RunFolder::open(&own, &stamp, common.force)?;
        tracing::info!("{}: computing from {}", curve.table.name, curve.table.case.display());
        let steps = 2 + 2 * curve.case.file.lattice.mach.len() as u64;
        let bar = bar(steps, common.quiet);
        let solved = curve.case.solve(None, |stage| {
            bar.inc(1);
            bar.set_message(stage.to_owned());
        });
        bar.finish_and_clear();
        let result = result(curve, stamp, &solved?);
        to.write_json(output::SUMMARY, &result)?;
        results.push(result);
    }
    Ok(results)
}

/// A finished curve of the same inputs, if the folder holds one.
fn kept(folder: &Path, fingerprint: &str, curve: &Curve) -> Option<CurveResult> {
    let text = std::fs::read_to_string(folder.join(output::SUMMARY)).ok()?;
    let result: CurveResult = serde_json::from_str(&text).ok()?;
    let same_method = result.boundary.iter().all(|r| r.method == curve.method);
    (result.stamp.fingerprint == fingerprint && same_method).then_some(result)
}

fn result(curve: &Curve, stamp: crate::stamp::Stamp, solved: &FrequencyResults) -> CurveResult {
    let mine = || solved.solutions.iter().filter(|s| s.row.method == curve.method);
    let mut warnings: Vec<String> = solved
        .findings
        .iter()
        .filter(|f| f.severity >= dip_dlm::lattice::Severity::Warning)
        .map(|f| f.message.clone())
        .collect();
    for s in mine() {
        warnings.extend(s.row.warnings.iter().map(|w| format!("Mach {}: {w}", s.row.mach)));
    }
    CurveResult {
        name: curve.table.name.clone(),
        stamp,
        boundary: mine().map(|s| s.row.clone()).collect(),
        rows: solved.solutions.iter().map(|s| s.row.clone()).collect(),
        natural_frequencies_hz: (0..solved.modes.count()).map(|m| solved.modes.freq_hz(m)).collect(),
        structure_mass_kg: solved.structure_mass_kg,
        boxes: solved.aerodynamics.lattice().n_boxes(),
        curves: mine().map(|s| MachCurves::new(&s.solution)).collect(),
        shapes: ModeShapes::new(&solved.modes, &solved.elements),
        warnings,
        stages: solved.stages.clone(),
    }
}
