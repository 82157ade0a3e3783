//! Pressure along cuts: C_p against the chord, upwards negative, with experiment.

use crate::chart::{Chart, Marker, Series, Style};
use crate::error::ReportError;
use crate::figure::Figure;

/// Pressures along one cut.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CpCut {
    /// Which cut, e.g. `"2y/b = 0.44"`.
    pub label: String,
    /// Computed curves: name and (x/c, Cp) in order round the section.
    pub computed: Vec<(String, Vec<(f64, f64)>)>,
    /// Measured points: name and (x/c, Cp).
    pub measured: Vec<(String, Vec<(f64, f64)>)>,
    /// C_p at which the flow is sonic, if it is to be marked.
    pub critical: Option<f64>,
}

/// All cuts in rows of `columns`.
///
/// # Errors
/// [`ReportError::Empty`] without cuts or columns.
pub fn cp_cuts(title: impl Into<String>, cuts: &[CpCut], columns: usize) -> Result<Figure, ReportError> {
    let title = title.into();
    if cuts.is_empty() || columns == 0 {
        let what = if cuts.is_empty() {
            "the list of cuts"
        } else {
            "a row of the figure (columns = 0)"
        };
        return Err(ReportError::Empty { figure: title, what });
    }
    let mut figure = Figure::new(title);
    for row in cuts.chunks(columns) {
        figure = figure.row(row.iter().map(chart).collect());
    }
    Ok(figure)
}

fn chart(cut: &CpCut) -> Chart {
    let mut chart = Chart::new(&cut.label, "x / c", "C_{p}").invert_y();
    for (i, (label, points)) in cut.computed.iter().enumerate() {
        let style = [Style::Line, Style::Dashed, Style::Dotted][i % 3];
        chart = chart.series(Series::new(label, points.clone(), style));
    }
    for (i, (label, points)) in cut.measured.iter().enumerate() {
        chart = chart.series(Series::experiment(
            label,
            points.clone(),
            Marker::ALL[i % Marker::ALL.len()],
        ));
    }
    match cut.critical {
        Some(critical) => chart.hline(critical, "C_{p}^{*}"),
        None => chart,
    }
}
