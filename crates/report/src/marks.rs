//! What stands for data: lines, markers and error bars of a series, and their samples in the legend.

use crate::chart::{Chart, Marker, Series, Style};
use crate::layout::{LEGEND_ROW, LEGEND_SAMPLE, LegendBox, NOTE};
use crate::svg::{Anchor, Path, Px, Svg, TextStyle};
use crate::text;
use crate::trace::{Rect, Trace};

fn dash(style: Style) -> &'static str {
    match style {
        Style::Dashed | Style::DashedMarkers(_) => r#" stroke-dasharray="7 4""#,
        Style::Dotted => r#" stroke-dasharray="1.5 3.5""#,
        _ => "",
    }
}

/// Draws a placed series: error bars, line, markers.
pub(crate) fn series_marks(svg: &mut Svg, series: &Series, trace: &Trace, color: &str) {
    svg.open_group(&format!(
        r#"class="series" data-label="{}""#,
        crate::svg::escape(&text::plain(&series.label))
    ));
    for bar in &trace.bars {
        let look = format!(r#"stroke="{color}" stroke-width="1.1""#);
        svg.line(bar.ends[0], bar.ends[1], &look);
        for (end, capped) in bar.ends.iter().zip(bar.capped) {
            if capped {
                let (dx, dy) = if bar.vertical { (3.5, 0.0) } else { (0.0, 3.5) };
                svg.line((end.0 - dx, end.1 - dy), (end.0 + dx, end.1 + dy), &look);
            }
        }
    }
    let look = format!(
        r#"fill="none" stroke="{color}" stroke-width="1.8" stroke-linejoin="round" stroke-linecap="butt"{}"#,
        dash(series.style)
    );
    svg.path(&trace.path(), &look);
    for &(x, y) in &trace.lone {
        svg.put(format_args!(
            r#"<circle cx="{}" cy="{}" r="2" fill="{color}"/>"#,
            Px(x),
            Px(y)
        ));
    }
    if let Style::Markers(kind) | Style::LineMarkers(kind) | Style::DashedMarkers(kind) = series.style {
        for &p in &trace.markers {
            marker(svg, kind, p, color, series.hollow);
        }
    }
    svg.close_group();
}

/// A marker about 8 px across; hollow ones are filled white so that lines do not run through them.
fn marker(svg: &mut Svg, kind: Marker, (x, y): (f64, f64), color: &str, hollow: bool) {
    let fill = if hollow { "#ffffff" } else { color };
    let rim = format!(r#"fill="{fill}" stroke="{color}" stroke-width="1.4""#);
    let stroke = format!(r#"fill="none" stroke="{color}" stroke-width="1.9""#);
    let mut path = Path::default();
    let corner = |dx: f64, dy: f64| (x + dx, y + dy);
    match kind {
        Marker::Circle => {
            svg.put(format_args!(r#"<circle cx="{}" cy="{}" r="3.7" {rim}/>"#, Px(x), Px(y)));
            return;
        }
        Marker::Square => path.polygon(&[
            corner(-3.4, -3.4),
            corner(3.4, -3.4),
            corner(3.4, 3.4),
            corner(-3.4, 3.4),
        ]),
        Marker::Diamond => path.polygon(&[corner(0.0, -4.9), corner(4.9, 0.0), corner(0.0, 4.9), corner(-4.9, 0.0)]),
        Marker::TriangleUp => path.polygon(&[corner(0.0, -4.8), corner(4.4, 3.2), corner(-4.4, 3.2)]),
        Marker::TriangleDown => path.polygon(&[corner(0.0, 4.8), corner(4.4, -3.2), corner(-4.4, -3.2)]),
        Marker::Plus | Marker::Cross => {
            let arms = if kind == Marker::Plus {
                [(4.4, 0.0), (0.0, 4.4)]
            } else {
                [(3.4, 3.4), (3.4, -3.4)]
            };
            for (dx, dy) in arms {
                path.move_to(corner(-dx, -dy));
                path.line_to(corner(dx, dy));
            }
            svg.path(&path, &stroke);
            return;
        }
    }
    svg.path(&path, &rim);
}

/// Draws the rows of a legend at its place.
pub(crate) fn legend_rows(svg: &mut Svg, chart: &Chart, colors: &[String], legend: &LegendBox, place: &Rect) {
    let rows = legend.entries.len().div_ceil(legend.columns.max(1));
    svg.open_group(r#"class="legend""#);
    for (n, &i) in legend.entries.iter().enumerate() {
        let (Some(series), Some(color)) = (chart.series.get(i), colors.get(i)) else {
            continue;
        };
        let (column, row) = (n / rows.max(1), n % rows.max(1));
        let x = place.x + 6.0 + column as f64 * legend.column_w;
        let y = place.y + 4.0 + (row as f64 + 0.5) * LEGEND_ROW;
        let middle = (x + 0.5 * LEGEND_SAMPLE, y);
        if !matches!(series.style, Style::Markers(_)) {
            let look = format!(r#"stroke="{color}" stroke-width="1.8"{}"#, dash(series.style));
            svg.line((x, y), (x + LEGEND_SAMPLE, y), &look);
        }
        if let Style::Markers(kind) | Style::LineMarkers(kind) | Style::DashedMarkers(kind) = series.style {
            marker(svg, kind, middle, color, series.hollow);
        }
        let style = TextStyle::new(NOTE, Anchor::Start);
        svg.text(x + LEGEND_SAMPLE + 6.0, y + 0.36 * NOTE, &series.label, style);
    }
    svg.close_group();
}
