//! How a run converged: residuals (logarithmic) over loads, with a common axis.

use crate::chart::{Chart, Series, Style};
use crate::error::ReportError;
use crate::figure::Figure;

/// A named curve: (abscissa, value).
pub type Curve = (String, Vec<(f64, f64)>);

/// Residuals over loads against `x_label` (`"Iteration"` or `"CPU time, s"`). Either list may be empty; `target` draws
/// the residual asked for.
///
/// # Errors
/// [`ReportError::Empty`] if both lists are.
pub fn history(
    title: impl Into<String>,
    x_label: &str,
    residuals: &[Curve],
    loads: &[Curve],
    target: Option<f64>,
) -> Result<Figure, ReportError> {
    let mut figure = Figure::new(title).share_x();
    if !residuals.is_empty() {
        let mut chart = curves(Chart::new("", x_label, "Residual").log_y(), residuals);
        if let Some(target) = target {
            chart = chart.hline(target, "asked for");
        }
        figure = figure.row(vec![chart]);
    }
    if !loads.is_empty() {
        figure = figure.row(vec![curves(Chart::new("", x_label, "Coefficient"), loads)]);
    }
    if figure.rows.is_empty() {
        return Err(ReportError::Empty {
            figure: figure.title,
            what: "the history",
        });
    }
    Ok(figure)
}

fn curves(chart: Chart, list: &[Curve]) -> Chart {
    list.iter().enumerate().fold(chart, |chart, (i, (label, points))| {
        let style = [Style::Line, Style::Dashed, Style::Dotted][(i / 6) % 3];
        chart.series(Series::new(label, points.clone(), style))
    })
}
