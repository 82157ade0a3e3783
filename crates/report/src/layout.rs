//! How much room title, labels, ticks, colour bar and legend of one chart need.

use crate::chart::{Chart, Legend, Series};
use crate::error::ReportError;
use crate::extent::{self, Span, Which};
use crate::palette;
use crate::text;
use crate::ticks::Ticks;
use crate::trace::Rect;

/// Font sizes, px.
pub(crate) const TITLE: f64 = 14.0;
pub(crate) const LABEL: f64 = 12.5;
pub(crate) const TICK: f64 = 11.5;
pub(crate) const NOTE: f64 = 11.5;
/// Height of a legend row, px.
pub(crate) const LEGEND_ROW: f64 = 17.0;
/// Length of the sample of a line in a legend, px.
pub(crate) const LEGEND_SAMPLE: f64 = 30.0;
/// Width of a colour bar, px.
pub(crate) const BAR: f64 = 13.0;
/// The least plot worth looking at, px.
const LEAST: (f64, f64) = (60.0, 45.0);

/// Room round a plot, px.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Margins {
    pub(crate) left: f64,
    pub(crate) right: f64,
    pub(crate) top: f64,
    pub(crate) bottom: f64,
}

impl Margins {
    /// The larger of both on every side.
    pub(crate) fn widest(self, other: Self) -> Self {
        Self {
            left: self.left.max(other.left),
            right: self.right.max(other.right),
            top: self.top.max(other.top),
            bottom: self.bottom.max(other.bottom),
        }
    }

    pub(crate) fn inside(&self, cell: &Rect) -> Rect {
        Rect {
            x: cell.x + self.left,
            y: cell.y + self.top,
            w: cell.w - self.left - self.right,
            h: cell.h - self.top - self.bottom,
        }
    }
}

/// A legend's rows and size.
#[derive(Debug, Clone)]
pub(crate) struct LegendBox {
    /// Indices of the series shown.
    pub(crate) entries: Vec<usize>,
    pub(crate) columns: usize,
    pub(crate) column_w: f64,
    pub(crate) w: f64,
    pub(crate) h: f64,
    /// Where it stands: `Auto` means inside.
    pub(crate) side: Legend,
}

/// A chart with limits, ticks and margins settled.
pub(crate) struct Plan<'a> {
    pub(crate) chart: &'a Chart,
    pub(crate) x_limits: (f64, f64),
    pub(crate) y_limits: (f64, f64),
    pub(crate) x_ticks: Ticks,
    pub(crate) y_ticks: Ticks,
    pub(crate) bar_ticks: Option<Ticks>,
    pub(crate) title: Vec<String>,
    pub(crate) margins: Margins,
    pub(crate) legend: Option<LegendBox>,
    /// Colour of each series.
    pub(crate) colors: Vec<String>,
}

impl<'a> Plan<'a> {
    /// Settles a chart for a cell of the given size. `x_span` is what x has to show (shared by a column of charts).
    pub(crate) fn new(chart: &'a Chart, x_span: Span, w: f64, h: f64, side: Legend) -> Result<Self, ReportError> {
        check(chart)?;
        let title = text::wrap(&chart.title, TITLE, w - 16.0);
        let x_count = ((w - 80.0) / 80.0).clamp(3.0, 10.0) as usize;
        let y_count = ((h - 80.0) / 42.0).clamp(3.0, 9.0) as usize;
        let x_limits = extent::limits(chart, Which::X, x_span, x_count)?;
        let y_limits = extent::limits(chart, Which::Y, extent::span(chart, Which::Y), y_count)?;
        let mut x_ticks = extent::ticks_of(&chart.x, x_limits, x_count);
        let y_ticks = extent::ticks_of(&chart.y, y_limits, y_count);
        let bar_ticks = chart.color_bar.as_ref().map(|bar| {
            let (lo, hi) = (bar.from.min(bar.to), bar.from.max(bar.to));
            crate::ticks::linear(lo, hi, y_count.min(7))
        });
        // Long labels must not run into each other.
        let widest = widest_label(&x_ticks);
        let fit = ((w - 80.0) / (widest + 14.0)).floor().max(2.0) as usize;
        if x_ticks.major.len() > fit {
            x_ticks = extent::ticks_of(&chart.x, x_limits, fit.saturating_sub(1).max(2));
        }
        let mut plan = Self {
            chart,
            x_limits,
            y_limits,
            x_ticks,
            y_ticks,
            bar_ticks,
            title,
            margins: Margins::default(),
            legend: None,
            colors: colors(&chart.series),
        };
        plan.legend = plan.legend_box(w, side);
        plan.margins = plan.room();
        Ok(plan)
    }

    /// Room for everything outside the plot.
    fn room(&self) -> Margins {
        let chart = self.chart;
        let mut m = Margins {
            left: 14.0,
            right: 14.0,
            top: 10.0,
            bottom: 10.0,
        };
        m.top += self.title.len() as f64 * (TITLE + 4.0) + if self.title.is_empty() { 0.0 } else { 4.0 };
        if !chart.bare {
            m.left = 12.0 + widest_label(&self.y_ticks) + if chart.y.label.is_empty() { 4.0 } else { LABEL + 10.0 };
            m.bottom = 12.0 + TICK + if chart.x.label.is_empty() { 4.0 } else { LABEL + 10.0 };
            if self.y_ticks.power != 0 {
                m.top += TICK + 3.0;
            }
            if self.x_ticks.power != 0 && chart.x.label.is_empty() {
                m.bottom += TICK + 4.0;
            }
            let last = self
                .x_ticks
                .major
                .last()
                .map_or(0.0, |(_, label)| 0.5 * text::width(label, TICK));
            m.right = m.right.max(last + 4.0);
        }
        if let (Some(bar), Some(ticks)) = (&chart.color_bar, &self.bar_ticks) {
            m.right += self.bar_width(ticks, &bar.label);
            if ticks.power != 0 && self.y_ticks.power == 0 {
                m.top += TICK + 3.0;
            }
        }
        match &self.legend {
            Some(legend) if legend.side == Legend::Right => m.right += legend.w + 6.0,
            Some(legend) if legend.side == Legend::Below => m.bottom += legend.h + 4.0,
            _ => {}
        }
        m
    }

    /// Room for a colour bar with its labels, px.
    pub(crate) fn bar_width(&self, ticks: &Ticks, label: &str) -> f64 {
        10.0 + BAR + 7.0 + widest_label(ticks) + if label.is_empty() { 0.0 } else { LABEL + 6.0 }
    }

    fn legend_box(&self, w: f64, side: Legend) -> Option<LegendBox> {
        let series = &self.chart.series;
        let mut entries: Vec<usize> = Vec::new();
        for (i, s) in series.iter().enumerate() {
            // Parts of one curve may carry one name; it is listed once.
            let same = |j: &usize| {
                series.get(*j).is_some_and(|o| {
                    o.label == s.label && o.style == s.style && self.colors.get(*j) == self.colors.get(i)
                })
            };
            if !s.label.is_empty() && !entries.iter().any(same) {
                entries.push(i);
            }
        }
        if entries.is_empty() || side == Legend::Hidden {
            return None;
        }
        let longest = entries
            .iter()
            .filter_map(|&i| series.get(i))
            .map(|s| text::width(&s.label, NOTE))
            .fold(0.0, f64::max);
        let column_w = LEGEND_SAMPLE + 6.0 + longest + 12.0;
        let columns = if side == Legend::Below {
            (((w - 40.0) / column_w).floor() as usize).clamp(1, entries.len())
        } else {
            1
        };
        let rows = entries.len().div_ceil(columns);
        let (w, h) = (columns as f64 * column_w + 8.0, rows as f64 * LEGEND_ROW + 8.0);
        Some(LegendBox {
            entries,
            columns,
            column_w,
            w,
            h,
            side,
        })
    }

    /// Whether a plot of this size is worth drawing; the error says how large the picture would have to be.
    pub(crate) fn fits(&self, plot: &Rect, figure: &str, size_px: (u32, u32)) -> Result<(), ReportError> {
        let (short_w, short_h) = ((LEAST.0 - plot.w).max(0.0), (LEAST.1 - plot.h).max(0.0));
        if short_w == 0.0 && short_h == 0.0 {
            return Ok(());
        }
        let title = if self.chart.title.is_empty() {
            figure
        } else {
            &self.chart.title
        };
        Err(ReportError::Size {
            figure: title.to_owned(),
            width_px: size_px.0,
            height_px: size_px.1,
            needed_width_px: size_px.0.saturating_add(short_w.ceil() as u32),
            needed_height_px: size_px.1.saturating_add(short_h.ceil() as u32),
        })
    }
}

/// Width of the widest tick label, px.
pub(crate) fn widest_label(ticks: &Ticks) -> f64 {
    ticks
        .major
        .iter()
        .map(|(_, label)| text::width(label, TICK))
        .fold(0.0, f64::max)
}

/// Colours in order; a series that names one does not use up a place in the palette.
fn colors(series: &[Series]) -> Vec<String> {
    let mut next = palette::SERIES.iter().cycle();
    series
        .iter()
        .map(|s| match &s.color {
            Some(color) => palette::checked(color),
            None => next.next().map_or_else(String::new, |c| (*c).to_owned()),
        })
        .collect()
}

/// Error bars go with points one to one.
fn check(chart: &Chart) -> Result<(), ReportError> {
    for s in &chart.series {
        for (errors, axis) in [(&s.x_error, "x"), (&s.y_error, "y")] {
            if !errors.is_empty() && errors.len() != s.points.len() {
                return Err(ReportError::Shape {
                    figure: chart.title.clone(),
                    what: format!("the {axis} uncertainty of series \"{}\"", s.label),
                    needed: s.points.len(),
                    got: errors.len(),
                });
            }
        }
    }
    if let Some(bar) = &chart.color_bar
        && !(bar.from.is_finite() && bar.to.is_finite() && bar.from != bar.to)
    {
        return Err(ReportError::Range {
            figure: chart.title.clone(),
            axis: "colour",
            from: bar.from,
            to: bar.to,
            reason: "the ends of the colour bar are equal or not finite",
        });
    }
    Ok(())
}
