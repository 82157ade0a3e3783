//! A marched curve: the flutter density at every Mach number, at the experiment's speed. Finished points and densities are kept.

use super::curve::{BoundaryRow, CurveResult};
use super::study::MarchCurve;
use crate::exit::Stop;
use crate::options::Common;
use crate::pmb::march::{self, Summary};
use crate::progress::{Seconds, check_interrupt};
use crate::stamp::Stamp;
use crate::traces::{MachCurves, ModeTrace, Onset};
use dip_case::file::CurveKind;
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
        let [mach, speed, first] = *point;
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
        let Seconds { wall_s, cpu_s } = summary.total;
        result.boundary.push(BoundaryRow {
            mach,
            density_kg_m3: found.map_or(first, |p| p.density_kg_m3),
            flutter_speed_m_s: found.map(|_| speed),
            flutter_frequency_hz: found.map(|p| p.flutter_frequency_hz),
            // The index goes with the root of the density.
            uncertainty: found.map(|p| 0.5 * p.density_error),
            time_s: wall_s,
            cpu_s,
        });
    }
    Ok(result)
}

/// Damping and frequency of the runs over the speed index's own abscissa: the speed at the first run's density that has the same
/// dynamic pressure.
fn damping(mach: f64, summary: &Summary) -> Option<MachCurves> {
    let first = summary.trials.first()?.density_kg_m3;
    let speed = summary.speed_m_s;
    let mut rows: Vec<(f64, f64, f64)> = summary
        .trials
        .iter()
        .filter_map(|t| Some((speed * (t.density_kg_m3 / first).sqrt(), t.g?, t.frequency_hz?)))
        .collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    if rows.len() < 2 {
        return None;
    }
    Some(MachCurves {
        mach,
        method: "march".to_owned(),
        modes: vec![ModeTrace {
            mode: 1,
            natural_frequency_hz: summary.natural_frequencies_hz.first().copied().unwrap_or(0.0),
            speed_m_s: rows.iter().map(|r| r.0).collect(),
            g: rows.iter().map(|r| r.1).collect(),
            frequency_hz: rows.iter().map(|r| r.2).collect(),
        }],
        crossings: summary
            .flutter
            .iter()
            .map(|p| Onset {
                divergence: false,
                speed_m_s: speed * (p.density_kg_m3 / first).sqrt(),
                frequency_hz: p.flutter_frequency_hz,
            })
            .collect(),
    })
}
