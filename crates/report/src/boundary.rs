//! The flutter boundary: speed index and frequency ratio against Mach number, methods beside experiment.

use crate::chart::{Chart, Legend, Marker, Series, Style};
use crate::figure::Figure;

/// Flutter at one Mach number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundaryPoint {
    /// Mach number.
    pub mach: f64,
    /// U / (b omega_alpha sqrt(mu)).
    pub speed_index: f64,
    /// Uncertainty of the speed index (below, above) as lengths; (0, 0) for none.
    pub speed_index_error: (f64, f64),
    /// omega / omega_alpha; NaN where it is not known.
    pub frequency_ratio: f64,
}

/// One method, or the experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryCurve {
    /// Name in the legend.
    pub label: String,
    /// Points in order of Mach number.
    pub points: Vec<BoundaryPoint>,
    /// Measured: black, hollow, not joined.
    pub experiment: bool,
}

/// Speed index over frequency ratio, with a common Mach axis; without any frequency only the speed index.
pub fn boundary(title: impl Into<String>, curves: &[BoundaryCurve]) -> Figure {
    let mut index = Chart::new(
        "",
        "Mach number",
        "Flutter speed index U / (b \u{3c9}_{\u{3b1}} \u{221a}\u{b5})",
    );
    let mut ratio = Chart::new("", "Mach number", "Frequency ratio \u{3c9} / \u{3c9}_{\u{3b1}}").legend(Legend::Hidden);
    let (mut methods, mut tests) = (0, 0);
    for curve in curves {
        let series = |points: Vec<(f64, f64)>, count: usize| {
            let marker = Marker::ALL[count % Marker::ALL.len()];
            if curve.experiment {
                Series::experiment(&curve.label, points, marker)
            } else if count < 6 {
                Series::new(&curve.label, points, Style::LineMarkers(marker))
            } else {
                Series::new(&curve.label, points, Style::DashedMarkers(marker))
            }
        };
        let counter = if curve.experiment { &mut tests } else { &mut methods };
        let mut upper = series(curve.points.iter().map(|p| (p.mach, p.speed_index)).collect(), *counter);
        if curve.points.iter().any(|p| p.speed_index_error != (0.0, 0.0)) {
            upper = upper.y_error(curve.points.iter().map(|p| p.speed_index_error).collect());
        }
        index = index.series(upper);
        ratio = ratio.series(series(
            curve.points.iter().map(|p| (p.mach, p.frequency_ratio)).collect(),
            *counter,
        ));
        *counter += 1;
    }
    let figure = Figure::new(title).row(vec![index]);
    if curves
        .iter()
        .flat_map(|c| &c.points)
        .any(|p| p.frequency_ratio.is_finite())
    {
        figure.row(vec![ratio]).share_x()
    } else {
        figure
    }
}
