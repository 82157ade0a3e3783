//! Pictures of a march: generalized coordinates in time, damping and frequency over what was varied.

use super::case::March;
use super::parameter::Parameter;
use super::summary::TrialRow;
use crate::exit::Stop;
use crate::figures::drawing;
use crate::output::RunFolder;
use dip_flutter::search::Neutral;
use dip_modal::ModalState;
use dip_report::{Chart, Figure, Marker, Series};

/// Writes the generalized coordinates of a run as CSV and SVG, each over its own largest value.
///
/// # Errors
/// What the file system says.
pub fn modes(folder: &RunFolder, name: &str, title: &str, states: &[ModalState]) -> Result<(), Stop> {
    let count = states.first().map_or(0, |s| s.q.len());
    let mut csv = String::from("time_s");
    for what in ["q", "q_dot_1_s", "force_n_m"] {
        (1..=count).for_each(|m| csv.push_str(&format!(",{what}{m}")));
    }
    csv.push('\n');
    for s in states {
        csv.push_str(&s.time_s.to_string());
        for values in [&s.q, &s.q_dot, &s.f] {
            values.iter().for_each(|v| csv.push_str(&format!(",{v}")));
        }
        csv.push('\n');
    }
    folder.write(&format!("{name}.csv"), csv.as_bytes())?;
    if states.len() < 3 || count == 0 {
        return Ok(());
    }
    let mut figure = Figure::new(title).share_x();
    for m in 0..count.min(4) {
        let points = states.iter().map(|s| (s.time_s, s.q[m])).collect();
        figure = figure.row(vec![
            Chart::new("", "Time, s", format!("q_{{{}}}", m + 1)).series(Series::line("", points)),
        ]);
    }
    let height = 120 + 200 * u32::try_from(count.min(4)).unwrap_or(4);
    let svg = figure.svg(800, height).map_err(|e| drawing(&e))?;
    folder.write(&format!("{name}.svg"), svg.as_bytes())?;
    Ok(())
}

/// Draws damping and frequency of the least stable mode over what was varied.
///
/// # Errors
/// What the file system says.
pub fn damping(
    folder: &RunFolder,
    march: &March<'_>,
    trials: &[TrialRow],
    found: Option<&Neutral>,
) -> Result<(), Stop> {
    let parameter = march.parameter;
    let (label, place): (&str, &dyn Fn(f64) -> f64) = match parameter {
        Parameter::Density { .. } => ("Density, kg/m³", &|at| at),
        Parameter::Speed { .. } => ("Speed, m/s", &|at| at),
        Parameter::Altitude { .. } => ("Altitude, m", &|at| parameter.altitude_m(at).unwrap_or(f64::NAN)),
    };
    let mut rows: Vec<&TrialRow> = trials.iter().filter(|t| t.g.is_some()).collect();
    rows.sort_by(|a, b| place(a.at).total_cmp(&place(b.at)));
    if rows.is_empty() {
        return Ok(());
    }
    let curve = |value: fn(&TrialRow) -> Option<f64>| -> Vec<(f64, f64)> {
        rows.iter().filter_map(|t| Some((place(t.at), value(t)?))).collect()
    };
    let mut g = Chart::new("", label, "Damping g").hline(0.0, "").series(
        Series::line_markers("marched", curve(|t| t.g), Marker::Circle)
            .y_error(rows.iter().map(|t| t.g_error.map_or((0.0, 0.0), |e| (e, e))).collect()),
    );
    let mut f = Chart::new("", label, "Frequency, Hz").series(Series::line_markers(
        "marched",
        curve(|t| t.frequency_hz),
        Marker::Circle,
    ));
    if let Some(point) = found {
        g = g.mark(place(point.at), 0.0, "flutter");
        f = f.mark(place(point.at), point.freq_hz, "flutter");
    }
    let title = format!("Mach {}", march.file.flow.mach);
    let figure = Figure::new(title).share_x().row(vec![g]).row(vec![f]);
    let svg = figure.svg(760, 640).map_err(|e| drawing(&e))?;
    folder.write("damping.svg", svg.as_bytes())?;
    Ok(())
}
