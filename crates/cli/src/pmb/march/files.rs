//! Pictures of a march: generalized coordinates in time, damping and frequency over what was varied.

use super::case::March;
use super::parameter::Parameter;
use super::searching::Searched;
use super::summary::TrialRow;
use crate::exit::Stop;
use crate::figures::drawing;
use crate::output::RunFolder;
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

/// Draws damping and frequency of the least stable mode over what was varied, and where a run does not oscillate, the rate at
/// which it goes away or comes to rest.
///
/// # Errors
/// What the file system says.
pub fn damping(folder: &RunFolder, march: &March<'_>, searched: &Searched) -> Result<(), Stop> {
    let parameter = march.parameter;
    let (label, place): (&str, &dyn Fn(f64) -> f64) = match parameter {
        Parameter::Density { .. } => ("Density, kg/m³", &|at| at),
        Parameter::Speed { .. } => ("Speed, m/s", &|at| at),
        Parameter::Altitude { .. } => ("Altitude, m", &|at| parameter.altitude_m(at).unwrap_or(f64::NAN)),
    };
    let mut rows: Vec<&TrialRow> = searched.trials.iter().collect();
    rows.sort_by(|a, b| place(a.at).total_cmp(&place(b.at)));
    let oscillating: Vec<&TrialRow> = rows.iter().copied().filter(|t| t.g.is_some()).collect();
    let curve = |value: fn(&TrialRow) -> Option<f64>| -> Vec<(f64, f64)> {
        rows.iter().filter_map(|t| Some((place(t.at), value(t)?))).collect()
    };
    let rates = rates(&rows, place);
    let divergence = searched.divergence().map(|(at, _)| place(at));
    let mut figure = Figure::new(format!("Mach {}", march.file.flow.mach)).share_x();
    let mut height = 0;
    if !oscillating.is_empty() {
        let errors = oscillating.iter().map(|t| t.g_error.map_or((0.0, 0.0), |e| (e, e)));
        let mut g = Chart::new("", label, "Damping g")
            .hline(0.0, "")
            .series(Series::line_markers("marched", curve(|t| t.g), Marker::Circle).y_error(errors.collect()));
        let mut f = Chart::new("", label, "Frequency, Hz").series(Series::line_markers(
            "marched",
            curve(|t| t.frequency_hz),
            Marker::Circle,
        ));
        if let Some(point) = &searched.found {
            g = g.mark(place(point.at), 0.0, "flutter");
            f = f.mark(place(point.at), point.freq_hz, "flutter");
        }
        if let Some(at) = divergence {
            g = g.vline(at, "divergence");
            f = f.vline(at, "divergence");
        }
        if let Some(rates) = &rates {
            f = rates.at_rest(f);
        }
        figure = figure.row(vec![g]).row(vec![f]);
        height += 600;
    }
    if let Some(rates) = rates {
        figure = figure.row(vec![rates.chart(label, divergence)]);
        height += 300;
    }
    if height == 0 {
        return Ok(());
    }
    let svg = figure.svg(760, height + 40).map_err(|e| drawing(&e))?;
    folder.write("damping.svg", svg.as_bytes())?;
    Ok(())
}

/// Rates of motion that does not oscillate, and beside them those of the oscillations before, from which they come.
pub struct Rates {
    alone: Vec<(f64, f64)>,
    errors: Vec<(f64, f64)>,
    oscillating: Vec<(f64, f64)>,
}

/// The rates of runs in order, at `place` of what was varied; none where all oscillate.
pub fn rates(rows: &[&TrialRow], place: impl Fn(f64) -> f64) -> Option<Rates> {
    let alone: Vec<_> = rows
        .iter()
        .filter_map(|t| Some((place(t.at), t.rate_1_s?, t.rate_error_1_s.unwrap_or(0.0))))
        .collect();
    let sigma = |t: &&TrialRow| Some((place(t.at), std::f64::consts::PI * t.frequency_hz? * t.g?));
    (!alone.is_empty()).then(|| Rates {
        errors: alone.iter().map(|r| (r.2, r.2)).collect(),
        alone: alone.into_iter().map(|r| (r.0, r.1)).collect(),
        oscillating: rows.iter().filter_map(sigma).collect(),
    })
}

impl Rates {
    /// The runs in a chart of frequencies: 0 Hz.
    pub fn at_rest(&self, frequencies: Chart) -> Chart {
        let zero = self.alone.iter().map(|r| (r.0, 0.0)).collect();
        frequencies.series(Series::markers("without oscillation", zero, Marker::Diamond).hollow())
    }

    /// Drawn over what `label` says, with the place of divergence.
    pub fn chart(self, label: &str, divergence: Option<f64>) -> Chart {
        let mut chart = Chart::new("", label, "Rate σ, 1/s")
            .hline(0.0, "")
            .series(Series::line_markers("without oscillation", self.alone, Marker::Diamond).y_error(self.errors));
        if !self.oscillating.is_empty() {
            chart = chart.series(Series::markers(
                "oscillating, g ω / 2",
                self.oscillating,
                Marker::Circle,
            ));
        }
        match divergence {
            Some(at) => chart.mark(at, 0.0, "divergence"),
            None => chart,
        }
    }
}
