//! Several charts in one picture, with their plots in line.

use crate::chart::{Chart, Legend};
use crate::draw::Drawing;
use crate::error::ReportError;
use crate::extent::{self, Span, Which};
use crate::layout::{Margins, Plan};
use crate::svg::{Anchor, Svg, TextStyle};
use crate::text;
use crate::trace::Rect;

const TITLE: f64 = 16.0;

/// Rows of charts in one picture. Plots of a column share left and right edge, plots of a row top and bottom.
///
/// ```
/// use dip_report::{Chart, Figure, Series};
/// let damping = Chart::new("", "Speed, m/s", "Damping g").series(Series::line("mode 1", vec![(0.0, 0.0), (9.0, -1.0)]));
/// let frequency = Chart::new("", "Speed, m/s", "Frequency, Hz").series(Series::line("", vec![(0.0, 9.6), (9.0, 12.0)]));
/// let svg = Figure::new("V-g and V-f").row(vec![damping]).row(vec![frequency]).share_x().svg(640, 720)?;
/// # Ok::<(), dip_report::ReportError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figure {
    /// Title over all charts; may be empty.
    pub title: String,
    /// Charts [row][column]; rows may differ in length.
    pub rows: Vec<Vec<Chart>>,
    /// All charts of a column show the same range of x, and only the lowest carries the label.
    pub share_x: bool,
}

impl Figure {
    /// An empty figure.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            ..Self::default()
        }
    }

    /// Adds a row of charts.
    #[must_use]
    pub fn row(mut self, charts: Vec<Chart>) -> Self {
        self.rows.push(charts);
        self
    }

    /// Charts of a column share x.
    #[must_use]
    pub fn share_x(mut self) -> Self {
        self.share_x = true;
        self
    }

    /// The figure as an SVG document of the given size in px. The same figure gives the same bytes.
    ///
    /// # Errors
    /// As [`Chart::svg`], and [`ReportError::Empty`] for a figure without charts.
    pub fn svg(&self, width_px: u32, height_px: u32) -> Result<String, ReportError> {
        if self.rows.iter().all(Vec::is_empty) {
            return Err(ReportError::Empty {
                figure: self.title.clone(),
                what: "the list of charts",
            });
        }
        let (w, h) = (f64::from(width_px), f64::from(height_px));
        let title = text::wrap(&self.title, TITLE, w - 24.0);
        let top = title.len() as f64 * (TITLE + 5.0) + if title.is_empty() { 0.0 } else { 6.0 };
        let row_h = (h - top) / self.rows.len() as f64;
        let mut svg = Svg::default();
        for (i, line) in title.iter().enumerate() {
            let y = 8.0 + TITLE + i as f64 * (TITLE + 5.0);
            svg.text(
                0.5 * w,
                y,
                line,
                TextStyle {
                    bold: true,
                    ..TextStyle::new(TITLE, Anchor::Middle)
                },
            );
        }
        let plans = self.plans(w, row_h)?;
        let last_row_of = |c: usize| plans.iter().rposition(|row| row.len() > c);
        for (r, row) in plans.iter().enumerate() {
            for (c, plan) in row.iter().enumerate() {
                let cell_w = w / row.len() as f64;
                let cell = Rect {
                    x: c as f64 * cell_w,
                    y: top + r as f64 * row_h,
                    w: cell_w,
                    h: row_h,
                };
                let plot = common_margins(&plans, r, c).inside(&cell);
                plan.fits(&plot, &self.title, (width_px, height_px))?;
                let with_x_label = !self.share_x || last_row_of(c) == Some(r);
                Drawing::new(plan, plot).draw(&mut svg, &cell, with_x_label);
            }
        }
        Ok(svg.finish(width_px, height_px, &self.spoken_title(), &self.description()))
    }

    /// All charts with their limits, ticks and margins.
    fn plans(&self, w: f64, row_h: f64) -> Result<Vec<Vec<Plan<'_>>>, ReportError> {
        self.rows
            .iter()
            .map(|row| {
                row.iter()
                    .enumerate()
                    .map(|(c, chart)| plan(chart, self.x_span(c, chart), w / row.len() as f64, row_h))
                    .collect()
            })
            .collect()
    }

    /// What x of a chart has to show: its own data, or that of its whole column.
    fn x_span(&self, column: usize, chart: &Chart) -> Span {
        let own = extent::span(chart, Which::X);
        if !self.share_x {
            return own;
        }
        self.rows
            .iter()
            .filter_map(|row| row.get(column))
            .fold(own, |all, c| all.join(extent::span(c, Which::X)))
    }

    fn spoken_title(&self) -> String {
        if !self.title.is_empty() {
            return self.title.clone();
        }
        let titles: Vec<&str> = self
            .rows
            .iter()
            .flatten()
            .map(|c| c.title.as_str())
            .filter(|t| !t.is_empty())
            .collect();
        if titles.is_empty() {
            "Chart".to_owned()
        } else {
            titles.join("; ")
        }
    }

    /// What the figure shows in words, for those who cannot see it; also says how many points are gaps.
    fn description(&self) -> String {
        let mut sentences = Vec::new();
        for chart in self.rows.iter().flatten() {
            let names: Vec<String> = chart
                .series
                .iter()
                .filter(|s| !s.label.is_empty())
                .map(|s| text::plain(&s.label))
                .collect();
            let (x, y) = (text::plain(&chart.x.label), text::plain(&chart.y.label));
            let mut sentence = if chart.bare {
                format!("{y}, {x}")
            } else {
                format!("{y} against {x}")
            };
            if !names.is_empty() {
                sentence.push_str(": ");
                sentence.push_str(&names.join(", "));
            }
            let gaps = chart
                .series
                .iter()
                .flat_map(|s| &s.points)
                .filter(|p| !(extent::drawable(p.0, chart.x.scale) && extent::drawable(p.1, chart.y.scale)))
                .count();
            if gaps > 0 {
                sentence.push_str(&format!(" ({gaps} points have no value that can be drawn)"));
            }
            for note in chart.annotations.iter().filter(|n| !n.text.is_empty()) {
                sentence.push_str("; ");
                sentence.push_str(&text::plain(&note.text));
            }
            sentences.push(sentence + ".");
        }
        sentences.join(" ")
    }
}

/// A chart's plan; its legend goes outside when it would cover data inside and there is room for that.
fn plan(chart: &Chart, x_span: Span, w: f64, h: f64) -> Result<Plan<'_>, ReportError> {
    let first = Plan::new(chart, x_span, w, h, chart.legend)?;
    if chart.legend != Legend::Auto || first.legend.is_none() {
        return Ok(first);
    }
    let plot = first.margins.inside(&Rect { x: 0.0, y: 0.0, w, h });
    if plot.w <= 0.0 || plot.h <= 0.0 || Drawing::new(&first, plot).has_room_for_legend() {
        return Ok(first);
    }
    let beside = Plan::new(chart, x_span, w, h, Legend::Right)?;
    let left = beside.margins.inside(&Rect { x: 0.0, y: 0.0, w, h });
    if left.w >= 0.55 * plot.w && beside.legend.as_ref().is_some_and(|l| l.h <= left.h) {
        return Ok(beside);
    }
    let below = Plan::new(chart, x_span, w, h, Legend::Below)?;
    let left = below.margins.inside(&Rect { x: 0.0, y: 0.0, w, h });
    Ok(if left.h >= 0.55 * plot.h { below } else { first })
}

/// Margins of the chart at [r][c] such that plots are in line with their row and, where rows are alike, their column.
fn common_margins(plans: &[Vec<Plan<'_>>], r: usize, c: usize) -> Margins {
    let row = plans.get(r).map_or(&[][..], Vec::as_slice);
    let columns = row.len();
    let mut across = Margins::default();
    for plan in row {
        across = across.widest(plan.margins);
    }
    let mut along = Margins::default();
    for plan in plans
        .iter()
        .filter(|other| other.len() == columns)
        .filter_map(|other| other.get(c))
    {
        along = along.widest(plan.margins);
    }
    Margins {
        left: along.left,
        right: along.right,
        top: across.top,
        bottom: across.bottom,
    }
}
