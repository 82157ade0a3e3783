//! A marched curve: the flutter density at every Mach number, at the experiment's speed. Finished points and densities are kept.

use super::curve::{BoundaryRow, CurveResult};
use super::study::MarchCurve;
use crate::exit::Stop;
use crate::options::Common;
use crate::pmb::march::{self, ModeRow, Summary};
use crate::progress::{Seconds, check_interrupt};
use crate::stamp::Stamp;
use crate::traces::{MachCurves, ModeTrace, Onset};
use dip_case::file::CurveKind;
use std::collections::BTreeMap;
use std::path::Path;

/// Computes a curve; its points go to folders of `folder`.
///
/// # Errors
/// What a march fails with; finished points stay on disk.
pub fn compute(
    name: &str,
    stamp: Stamp,
    curve: &MarchCurve,
    folder: &Path,
    common: &Common,
) -> Result<CurveResult, Stop> {
    let mut result = CurveResult {
        name: name.to_owned(),
        kind: CurveKind::March,
        stamp,
        boundary: Vec::new(),
        rows: Vec::new(),
        natural_frequencies_hz: Vec::new(),
        structure_mass_kg: None,
        boxes: None,
        cells: None,
        curves: Vec::new(),
        shapes: None,
        warnings: Vec::new(),
        notes: vec![
            "Marched at the experiment's speed; the density is varied until the damping of the least stable mode vanishes.".to_owned(),
        ],
        audit: Vec::new(),
        stages: Vec::new(),
    };
    for point in &curve.points {
        let [mach, _, first] = *point;
        check_interrupt(&format!("finished points are in {}", folder.display()))?;
        let to = folder.join(format!("M{mach:.3}"));
        let document = curve.document(*point)?;
        let kept = if common.force {
            None
        } else {
            march::kept(&document, &to)?
        };
        let summary = match kept {
            Some(kept) => {
                tracing::info!("{}: kept", to.display());
                kept
            }
            None => {
                tracing::info!("march at Mach {mach} to {}", to.display());
                // Densities of an interrupted search of the same inputs are kept; of other inputs they are not.
                let own = Common {
                    force: true,
                    ..common.clone()
                };
                march::compute(&document, &to, !common.force, &own)?
            }
        };
        result.stages.push((format!("march, Mach {mach}"), summary.total));
        result
            .natural_frequencies_hz
            .clone_from(&summary.natural_frequencies_hz);
        result.cells = Some(summary.cells);
        result
            .warnings
            .extend(summary.warnings.iter().map(|w| format!("Mach {mach}: {w}")));
        result.curves.extend(damping(mach, &summary));
        let found = summary.flutter.first();
        let limit = summary.divergence.as_ref();
        let Seconds { wall_s, cpu_s } = summary.total;
        result.boundary.push(BoundaryRow {
            mach,
            density_kg_m3: found
                .map(|p| p.density_kg_m3)
                .or(limit.map(|d| d.density_kg_m3))
                .unwrap_or(first),
            flutter_speed_m_s: found.map(|p| p.flutter_speed_m_s),
            flutter_frequency_hz: found.map(|p| p.flutter_frequency_hz),
            divergence_speed_m_s: limit.map(|d| d.speed_m_s),
            uncertainty: found.map(|p| p.speed_index_error),
            time_s: wall_s,
            cpu_s,
        });
    }
    Ok(result)
}

/// Damping and frequency of all modes that the runs have read, over the speed at the first run's density that has the same
/// dynamic pressure.
fn damping(mach: f64, summary: &Summary) -> Option<MachCurves> {
    let first = summary.trials.first()?.density_kg_m3;
    let equivalent = |speed: f64, density: f64| speed * (density / first).sqrt();
    let mut rows: Vec<(f64, &ModeRow)> = summary
        .trials
        .iter()
        .flat_map(|t| {
            let at = equivalent(t.speed_m_s, t.density_kg_m3);
            t.modes.iter().map(move |m| (at, m))
        })
        .collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut traces: BTreeMap<usize, ModeTrace> = BTreeMap::new();
    for (at, row) in rows {
        let natural = summary.natural_frequencies_hz.get(row.mode.saturating_sub(1));
        let trace = traces.entry(row.mode).or_insert_with(|| ModeTrace {
            mode: row.mode,
            natural_frequency_hz: natural.copied().unwrap_or(0.0),
            speed_m_s: Vec::new(),
            g: Vec::new(),
            frequency_hz: Vec::new(),
        });
        trace.speed_m_s.push(at);
        trace.g.push(row.g);
        trace.frequency_hz.push(row.frequency_hz);
    }
    traces.retain(|_, t| t.g.len() > 1);
    if traces.is_empty() {
        return None;
    }
    Some(MachCurves {
        mach,
        method: "march".to_owned(),
        density_kg_m3: Some(first),
        modes: traces.into_values().collect(),
        crossings: summary
            .flutter
            .iter()
            .map(|p| Onset {
                divergence: false,
                speed_m_s: equivalent(p.flutter_speed_m_s, p.density_kg_m3),
                frequency_hz: p.flutter_frequency_hz,
            })
            .chain(summary.divergence.iter().map(|d| Onset {
                divergence: true,
                speed_m_s: equivalent(d.speed_m_s, d.density_kg_m3),
                frequency_hz: 0.0,
            }))
            .collect(),
    })
}
