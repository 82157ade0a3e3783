//! Subcritical damping as V-g and V-f, beside curves of the frequency domain.
//!
//! Runs differ in density, in speed or in both. What brings them on one axis, with each other and with curves at another
//! density, is the equivalent speed `U sqrt(rho / rho_1)`, rho_1 that of the first run: at one Mach number it is the speed
//! index but for a factor. Equal equivalent speeds are equal dynamic pressures; what is left is the mass ratio, on which
//! damping depends little near flutter.

use super::case::March;
use super::files;
use super::searching::Searched;
use super::summary::TrialRow;
use crate::exit::Stop;
use crate::figures::drawing;
use dip_flutter::SpeedIndexReference;
use dip_report::{Chart, Figure, Marker, Series};
use std::collections::BTreeMap;
use std::path::Path;

/// One point of a curve of the frequency domain.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    mach: f64,
    method: String,
    mode: usize,
    speed_m_s: f64,
    density_kg_m3: f64,
    g: f64,
    frequency_hz: f64,
}

/// Mach numbers are the same within this.
const SAME_MACH: f64 = 5e-3;

/// Reads `vg.csv` of `dlm flutter`.
///
/// # Errors
/// A file that is missing, has other columns, or holds something else than numbers.
pub fn read(path: &Path) -> Result<Vec<Line>, Stop> {
    let wrong = |what: String| {
        Stop::input(
            format!("{}: {what}", path.display()),
            "give the vg.csv that `dlm flutter` writes",
        )
    };
    let text = std::fs::read_to_string(path).map_err(|e| wrong(e.to_string()))?;
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split(',').map(str::trim).collect();
    let place = |name: &str| {
        header
            .iter()
            .position(|h| *h == name)
            .ok_or_else(|| wrong(format!("line 1: no column `{name}`")))
    };
    let columns = ["mach", "mode", "speed_m_s", "density_kg_m3", "g", "frequency_hz"]
        .map(place)
        .into_iter()
        .collect::<Result<Vec<_>, _>>()?;
    let method = place("method")?;
    let mut points = Vec::new();
    for (n, line) in lines.enumerate().filter(|(_, l)| !l.trim().is_empty()) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let number = |column: usize| -> Result<f64, Stop> {
            let cell = cells.get(column).copied().unwrap_or_default();
            cell.parse()
                .map_err(|_| wrong(format!("line {}, column {}: `{cell}` is no number", n + 2, column + 1)))
        };
        let values = columns.iter().map(|c| number(*c)).collect::<Result<Vec<f64>, _>>()?;
        let [mach, mode, speed_m_s, density_kg_m3, g, frequency_hz] = values[..] else {
            continue;
        };
        points.push(Line {
            mach,
            method: cells.get(method).copied().unwrap_or_default().to_owned(),
            mode: mode as usize,
            speed_m_s,
            density_kg_m3,
            g,
            frequency_hz,
        });
    }
    Ok(points)
}

/// Curves of one method at one Mach number, by mode; PK first, then whatever stands first in the file.
fn chosen(lines: &[Line], mach: f64) -> Option<(String, BTreeMap<usize, Vec<&Line>>)> {
    let here: Vec<&Line> = lines.iter().filter(|l| (l.mach - mach).abs() < SAME_MACH).collect();
    let first = here.first()?.method.clone();
    let method = here
        .iter()
        .find(|l| l.method.eq_ignore_ascii_case("pk"))
        .map_or(first, |l| l.method.clone());
    let mut modes: BTreeMap<usize, Vec<&Line>> = BTreeMap::new();
    for line in here.into_iter().filter(|l| l.method == method) {
        modes.entry(line.mode).or_default().push(line);
    }
    Some((method, modes))
}

/// Writes `vg.csv` and `vg.svg`.
///
/// # Errors
/// What the file system says.
pub fn write(
    march: &March<'_>,
    searched: &Searched,
    index: Option<&SpeedIndexReference>,
    beside: Option<&[Line]>,
) -> Result<(), Stop> {
    let Searched { trials, found, .. } = searched;
    let Some(first) = trials.first().map(|t| t.density_kg_m3) else {
        return Ok(());
    };
    let equivalent = |speed: f64, density: f64| speed * (density / first).sqrt();
    let mach = march.file.flow.mach;
    let reference = &march.file.reference;
    let semichord = reference.semichord.map_or(0.5 * reference.chord.0, |b| b.0);
    let mut rows: Vec<&TrialRow> = trials.iter().collect();
    rows.sort_by(|a, b| equivalent(a.speed_m_s, a.density_kg_m3).total_cmp(&equivalent(b.speed_m_s, b.density_kg_m3)));
    let mut csv = String::from(
        "mach,method,mode,speed_m_s,density_kg_m3,g,frequency_hz,k,g_error,equivalent_speed_m_s,dynamic_pressure_pa,speed_index\n",
    );
    type Curve = (Vec<(f64, f64)>, Vec<(f64, f64)>, Vec<(f64, f64)>);
    let mut curves: BTreeMap<usize, Curve> = BTreeMap::new();
    for t in &rows {
        let at = equivalent(t.speed_m_s, t.density_kg_m3);
        for m in &t.modes {
            let k = std::f64::consts::TAU * m.frequency_hz * semichord / t.speed_m_s;
            let pressure = 0.5 * t.density_kg_m3 * t.speed_m_s.powi(2);
            let index = index.map_or_else(String::new, |r| r.speed_index(t.speed_m_s, t.density_kg_m3).to_string());
            csv.push_str(&format!(
                "{mach},march,{},{},{},{},{},{k},{},{at},{pressure},{index}\n",
                m.mode,
                t.speed_m_s,
                t.density_kg_m3,
                m.g,
                m.frequency_hz,
                m.g_error.map_or_else(String::new, |e| e.to_string())
            ));
            let (g, error, f) = curves.entry(m.mode).or_default();
            g.push((at, m.g));
            error.push(m.g_error.map_or((0.0, 0.0), |e| (e, e)));
            f.push((at, m.frequency_hz));
        }
    }
    march.folder.write("vg.csv", csv.as_bytes())?;
    let rates = files::rates(&rows, |at| {
        let stream = march.parameter.stream(at);
        equivalent(stream.speed_m_s, stream.density_kg_m3)
    });
    if curves.is_empty() && rates.is_none() {
        return Ok(());
    }
    let lattice = beside.and_then(|lines| {
        let found = chosen(lines, mach);
        if found.is_none() {
            tracing::warn!("the curves to draw beside have none at Mach {mach}");
        }
        found
    });
    let label = format!("Equivalent speed at {first:.5} kg/m³, m/s");
    let mut damping = Chart::new("", label.as_str(), "Damping g").hline(0.0, "");
    let mut frequency = Chart::new("", label.as_str(), "Frequency, Hz");
    for (mode, (g, error, f)) in &curves {
        let name = format!("mode {mode}, march");
        let marker = Marker::ALL[(mode - 1) % Marker::ALL.len()];
        damping = damping.series(Series::line_markers(&name, g.clone(), marker).y_error(error.clone()));
        frequency = frequency.series(Series::line_markers(&name, f.clone(), marker));
    }
    if let Some((method, modes)) = &lattice {
        // Where the march was, and a little beyond: damping of other modes far away would flatten the picture.
        let all: Vec<f64> = curves.values().flat_map(|c| c.0.iter().map(|p| p.0)).collect();
        let low = 0.8 * all.iter().copied().fold(f64::INFINITY, f64::min);
        let high = 1.2 * all.iter().copied().fold(0.0, f64::max);
        for (mode, lines) in modes.iter().filter(|(mode, _)| curves.contains_key(mode)) {
            let curve = |value: fn(&Line) -> f64| -> Vec<(f64, f64)> {
                lines
                    .iter()
                    .map(|l| (equivalent(l.speed_m_s, l.density_kg_m3), value(l)))
                    .filter(|p| (low..=high).contains(&p.0))
                    .collect()
            };
            let name = format!("mode {mode}, {method}");
            let (g, f) = (curve(|l| l.g), curve(|l| l.frequency_hz));
            if g.len() > 1 {
                damping = damping.series(Series::dashed(&name, g));
                frequency = frequency.series(Series::dashed(&name, f));
            }
        }
    }
    if let Some(point) = found {
        let stream = march.parameter.stream(point.at);
        let at = equivalent(stream.speed_m_s, stream.density_kg_m3);
        damping = damping.mark(at, 0.0, "flutter");
        frequency = frequency.mark(at, point.freq_hz, "flutter");
    }
    let divergence = searched.divergence().map(|(at, _)| {
        let stream = march.parameter.stream(at);
        equivalent(stream.speed_m_s, stream.density_kg_m3)
    });
    if let Some(at) = divergence {
        damping = damping.vline(at, "divergence");
        frequency = frequency.vline(at, "divergence");
    }
    let mut figure = Figure::new(format!("V-g and V-f at Mach {mach}")).share_x();
    let mut height = 40;
    if let Some(rates) = &rates {
        frequency = rates.at_rest(frequency);
    }
    if !curves.is_empty() {
        figure = figure.row(vec![damping]).row(vec![frequency]);
        height += 720;
    }
    if let Some(rates) = rates {
        figure = figure.row(vec![rates.chart(&label, divergence)]);
        height += 360;
    }
    let svg = figure.svg(820, height).map_err(|e| drawing(&e))?;
    march.folder.write("vg.svg", svg.as_bytes())?;
    Ok(())
}
