//! A corrected curve: at every Mach number the uncorrected flutter point, recordings of prescribed motion round its reduced frequency,
//! and the lattice corrected by them. Recordings that are there already are kept.

use super::curve::{AuditLine, BoundaryRow, CurveResult, MethodRow};
use super::study::CorrectedCurve;
use crate::correction::{CorrectionCase, CorrectionResults};
use crate::exit::Stop;
use crate::frequency::FlutterRow;
use crate::options::Common;
use crate::pmb::pitch::{self, PitchDone};
use crate::progress::{Seconds, Timer, check_interrupt};
use crate::stamp::Stamp;
use crate::traces::{MachCurves, ModeShapes};
use dip_case::Document;
use dip_case::file::CurveKind;
use std::path::Path;

/// Computes a curve; recordings go to `folder`.
///
/// # Errors
/// What a run fails with; finished recordings stay on disk.
pub fn compute(
    name: &str,
    stamp: Stamp,
    curve: &CorrectedCurve,
    folder: &Path,
    common: &Common,
) -> Result<CurveResult, Stop> {
    let mut stages = Vec::new();
    let timer = Timer::start();
    let linear = curve.case.solve(None, |_| ())?;
    stages.push(("uncorrected lattice".to_owned(), timer.seconds()));
    let mut recordings = Vec::new();
    let mut seconds: Vec<(f64, Seconds)> = Vec::new();
    let mut warnings = Vec::new();
    let mut cells = None;
    for s in linear.solutions.iter().filter(|s| s.row.method == curve.method) {
        let (Some(speed), Some(k)) = (s.row.flutter_speed_m_s, s.row.reduced_frequency) else {
            warnings.push(format!(
                "Mach {}: the uncorrected lattice has no flutter point to record around; left out",
                s.row.mach
            ));
            continue;
        };
        let mut spent = Seconds::default();
        for factor in &curve.around {
            check_interrupt(&format!("finished recordings are in {}", folder.display()))?;
            let to = folder
                .join(format!("M{:.3}", s.row.mach))
                .join(format!("k{:.4}", factor * k));
            let document = pitch_document(curve, &s.row, speed, factor * k)?;
            let done = record(&document, &to, common)?;
            warnings.extend(
                done.warnings
                    .iter()
                    .map(|w| format!("Mach {}, recording at k = {:.4}: {w}", s.row.mach, factor * k)),
            );
            for key in ["wall_s", "cpu_s"] {
                let value = done.summary["total"][key].as_f64().unwrap_or(0.0);
                match key {
                    "wall_s" => spent.wall_s += value,
                    _ => spent.cpu_s += value,
                }
            }
            cells = done.summary["cells"].as_u64().map(|n| n as usize).or(cells);
            recordings.push(done.recording);
        }
        stages.push((format!("recordings, Mach {}", s.row.mach), spent));
        seconds.push((s.row.mach, spent));
    }
    let timer = Timer::start();
    let case = CorrectionCase::read(curve.document()?, &recordings)?;
    let results = case.solve(|_| ())?;
    stages.push(("correction and flutter".to_owned(), timer.seconds()));
    let share = timer.seconds();
    let result = assemble(name, stamp, curve, &results, &seconds, share, warnings, stages)?;
    Ok(CurveResult {
        natural_frequencies_hz: (0..linear.modes.count()).map(|m| linear.modes.freq_hz(m)).collect(),
        structure_mass_kg: linear.structure_mass_kg,
        shapes: Some(ModeShapes::new(&linear.modes, &linear.elements)),
        cells,
        ..result
    })
}

/// The pitch case at a Mach number, speed, density and reduced frequency.
fn pitch_document(curve: &CorrectedCurve, row: &FlutterRow, speed: f64, k: f64) -> Result<Document, Stop> {
    let plain = Document::read(&curve.pitch, &curve.pitch_overrides)?;
    // Whichever key the case has for the frequency is the one to override.
    let frequency = if plain.has("motion.frequency") {
        let b = curve.case.reference.semichord_m;
        format!("motion.frequency={:?}", k * speed / b)
    } else {
        format!("motion.reduced_frequency={k:?}")
    };
    let mut overrides = curve.pitch_overrides.clone();
    overrides.extend([
        format!("flow.mach={:?}", row.mach),
        format!("flow.speed={speed:?}"),
        format!("flow.density={:?}", row.density_kg_m3),
        frequency,
    ]);
    Ok(Document::read(&curve.pitch, &overrides)?)
}

/// A recording: kept where it is there, gone on with where it was stopped, made where not.
fn record(document: &Document, to: &Path, common: &Common) -> Result<PitchDone, Stop> {
    if !common.force
        && let Some(kept) = pitch::kept(document, to)?
    {
        tracing::info!("{}: kept", kept.recording.display());
        return Ok(kept);
    }
    tracing::info!("recording to {}", to.display());
    let resume = !common.force && pitch::can_resume(document, to);
    // What is there is of other inputs, or half done: this study's folder is its own.
    let common = Common {
        force: true,
        ..common.clone()
    };
    pitch::compute(document, to, resume, &common)
}

#[expect(clippy::too_many_arguments, reason = "each is a different thing")]
fn assemble(
    name: &str,
    stamp: Stamp,
    curve: &CorrectedCurve,
    results: &CorrectionResults,
    seconds: &[(f64, Seconds)],
    share: Seconds,
    mut warnings: Vec<String>,
    stages: Vec<(String, Seconds)>,
) -> Result<CurveResult, Stop> {
    let (mut boundary, mut rows, mut curves, mut audit) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let part = 1.0 / results.machs.len().max(1) as f64;
    for m in &results.machs {
        let spent = seconds
            .iter()
            .find(|(mach, _)| (mach - m.mach).abs() < 1e-9)
            .map_or(Seconds::default(), |(_, s)| *s);
        for s in &m.solutions {
            rows.push(MethodRow {
                correction: s.row.correction.to_owned(),
                row: s.row.row.clone(),
            });
            if s.row.correction == curve.correction && s.row.row.method == curve.method {
                boundary.push(BoundaryRow {
                    time_s: spent.wall_s + part * share.wall_s,
                    cpu_s: spent.cpu_s + part * share.cpu_s,
                    ..BoundaryRow::of(&s.row.row)
                });
                curves.push(MachCurves::new(&s.solution));
                warnings.extend(s.row.row.warnings.iter().map(|w| format!("Mach {}: {w}", m.mach)));
            }
        }
        for c in &m.audit.checks {
            let verdict = serde_json::to_value(c.verdict)
                .ok()
                .and_then(|v| v.as_str().map(str::to_owned))
                .unwrap_or_default();
            if c.verdict == dip_correct::audit::Verdict::Fail {
                warnings.push(format!(
                    "audit, Mach {}, {}: {}: {}",
                    m.mach, c.subject, c.name, c.words
                ));
            }
            audit.push(AuditLine {
                mach: m.mach,
                check: c.name.to_string(),
                subject: c.subject.to_string(),
                value: c.value.filter(|v| v.is_finite()),
                // JSON has no infinity.
                limit: Some(c.limit).filter(|v| v.is_finite()),
                verdict,
            });
        }
    }
    Ok(CurveResult {
        name: name.to_owned(),
        kind: CurveKind::Corrected,
        stamp,
        boundary,
        rows,
        natural_frequencies_hz: Vec::new(),
        structure_mass_kg: None,
        boxes: Some(results.aerodynamics.lattice().n_boxes()),
        cells: None,
        curves,
        shapes: None,
        warnings,
        notes: results.notes.clone(),
        audit,
        stages,
    })
}
