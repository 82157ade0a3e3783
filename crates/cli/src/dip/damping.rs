//! Subcritical damping of marched curves beside that of the frequency domain, Mach number by Mach number.

use super::curve::CurveResult;
use crate::traces::{MachCurves, ModeTrace};
use dip_report::{Chart, Figure, Marker, Series};

/// Mach numbers are the same within this.
const SAME_MACH: f64 = 1e-6;

/// For every Mach number of every marched curve that a curve of the frequency domain has too: the Mach number, and V-g and V-f of
/// the marched modes with the same modes of all those curves, over the equivalent speed (the same dynamic pressure at the march's
/// first density).
pub fn figures(results: &[CurveResult]) -> Vec<(f64, Figure)> {
    let (marched, solved): (Vec<&CurveResult>, Vec<&CurveResult>) = results
        .iter()
        .partition(|r| r.curves.iter().any(|c| c.method == "march"));
    marched
        .iter()
        .flat_map(|m| m.curves.iter().map(move |c| (*m, c)))
        .filter_map(|(result, curves)| Some((curves.mach, figure(result, curves, &solved)?)))
        .collect()
}

fn figure(result: &CurveResult, march: &MachCurves, solved: &[&CurveResult]) -> Option<Figure> {
    let first = march.density_kg_m3?;
    let beside: Vec<(&str, f64, &MachCurves)> = solved
        .iter()
        .flat_map(|r| r.curves.iter().map(move |c| (r.name.as_str(), c)))
        .filter(|(_, c)| (c.mach - march.mach).abs() < SAME_MACH)
        .filter_map(|(name, c)| Some((name, (c.density_kg_m3? / first).sqrt(), c)))
        .collect();
    if beside.is_empty() {
        return None;
    }
    let speeds = || march.modes.iter().flat_map(|m| m.speed_m_s.iter().copied());
    let (low, high) = (
        0.8 * speeds().fold(f64::INFINITY, f64::min),
        1.2 * speeds().fold(0.0, f64::max),
    );
    let label = format!("Equivalent speed at {first:.5} kg/m\u{b3}, m/s");
    let mut damping = Chart::new("", label.as_str(), "Damping g").hline(0.0, "");
    let mut frequency = Chart::new("", label.as_str(), "Frequency, Hz");
    let points = |trace: &ModeTrace, scale: f64, values: &[f64]| -> Vec<(f64, f64)> {
        let speeds = trace.speed_m_s.iter().map(|u| u * scale);
        speeds
            .zip(values.iter().copied())
            .filter(|p| (low..=high).contains(&p.0))
            .collect()
    };
    for trace in &march.modes {
        let name = format!("{}, mode {}", result.name, trace.mode);
        let marker = Marker::ALL[trace.mode.saturating_sub(1) % Marker::ALL.len()];
        damping = damping.series(Series::line_markers(&name, points(trace, 1.0, &trace.g), marker));
        frequency = frequency.series(Series::line_markers(
            &name,
            points(trace, 1.0, &trace.frequency_hz),
            marker,
        ));
        for (curve, scale, curves) in &beside {
            for other in curves.modes.iter().filter(|m| m.mode == trace.mode) {
                let name = format!("{curve}, mode {}", other.mode);
                let (g, f) = (
                    points(other, *scale, &other.g),
                    points(other, *scale, &other.frequency_hz),
                );
                if g.len() > 1 {
                    damping = damping.series(Series::dashed(&name, g));
                    frequency = frequency.series(Series::dashed(&name, f));
                }
            }
        }
    }
    let title = format!("Mach {}: damping of the march beside the frequency domain", march.mach);
    Some(Figure::new(title).share_x().row(vec![damping]).row(vec![frequency]))
}
