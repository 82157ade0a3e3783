//! Drawing one chart into its cell.

use crate::chart::{Annotation, Direction, Legend, Patch};
use crate::extent::Mapping;
use crate::layout::{LABEL, NOTE, Plan, TICK, TITLE};
use crate::marks::{legend_rows, series_marks};
use crate::palette;
use crate::placement::{self, Taken};
use crate::svg::{Anchor, Path, Px, Svg, TextStyle};
use crate::text;
use crate::trace::{Rect, Trace, sample};

const FRAME: &str = "#333333";
const GRID: &str = "#e3e3e3";

/// What a drawn chart covers, for the search of free places.
pub(crate) struct Drawing<'a> {
    plan: &'a Plan<'a>,
    plot: Rect,
    x: Mapping,
    y: Mapping,
    traces: Vec<Trace>,
    taken: Taken,
}

impl<'a> Drawing<'a> {
    /// Places series and patches of a planned chart in `plot`.
    pub(crate) fn new(plan: &'a Plan<'a>, plot: Rect) -> Self {
        let chart = plan.chart;
        let (plot, x_limits, y_limits) = if chart.equal_scale {
            equalize(plan, plot)
        } else {
            (plot, plan.x_limits, plan.y_limits)
        };
        let x = Mapping::new(&chart.x, x_limits, (plot.x, plot.right()));
        let y = Mapping::new(&chart.y, y_limits, (plot.bottom(), plot.y));
        let traces: Vec<Trace> = chart.series.iter().map(|s| Trace::new(s, &x, &y, &plot)).collect();
        let mut taken = Taken::default();
        for trace in &traces {
            trace.obstacles(&mut taken.points);
        }
        let mut drawing = Self {
            plan,
            plot,
            x,
            y,
            traces,
            taken,
        };
        drawing.take_patches();
        drawing
    }

    fn point(&self, p: (f64, f64)) -> Option<(f64, f64)> {
        Some((self.x.px(p.0)?, self.y.px(p.1)?))
    }

    fn take_patches(&mut self) {
        let chart = self.plan.chart;
        for polygon in chart.patches.iter().flat_map(|patch| &patch.polygons) {
            let corners: Vec<_> = polygon.iter().filter_map(|&p| self.point(p)).collect();
            for (&a, &b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                sample(a, b, &mut self.taken.points);
            }
        }
    }

    /// Whether a legend finds a place inside where it covers nothing.
    pub(crate) fn has_room_for_legend(&self) -> bool {
        let Some(legend) = &self.plan.legend else { return true };
        let mut taken = Taken {
            points: self.taken.points.clone(),
            boxes: Vec::new(),
        };
        // Notes and labels need their room too; where exactly is settled when they are drawn.
        for note in &self.plan.chart.annotations {
            if let Some(p) = self.point(note.at) {
                taken.points.push(p);
            }
        }
        legend.w < 0.62 * self.plot.w
            && legend.h < 0.72 * self.plot.h
            && taken
                .best(&placement::along_rim(&self.plot, legend.w, legend.h), &self.plot)
                .is_some_and(|(_, score)| score == 0)
    }

    /// Draws everything.
    pub(crate) fn draw(mut self, svg: &mut Svg, cell: &Rect, with_x_label: bool) {
        let chart = self.plan.chart;
        self.title(svg, cell);
        if !chart.bare {
            self.grid(svg);
        }
        self.patches(svg);
        let plan = self.plan;
        let labels = self.reference_lines(svg);
        for ((series, trace), color) in chart.series.iter().zip(&self.traces).zip(&plan.colors) {
            series_marks(svg, series, trace, color);
        }
        if !chart.bare {
            self.frame(svg, cell, with_x_label);
        }
        for (place, label, upwards) in labels {
            let style = TextStyle {
                fill: "#444444",
                halo: true,
                ..TextStyle::new(NOTE, Anchor::Start)
            };
            if upwards {
                svg.text(
                    place.right() - 3.0,
                    place.bottom(),
                    &label,
                    TextStyle { upwards, ..style },
                );
            } else {
                svg.text(place.x, place.bottom() - 3.5, &label, style);
            }
        }
        for note in &chart.annotations {
            self.note(svg, note);
        }
        self.legend(svg, cell);
        self.color_bar(svg);
    }

    fn title(&self, svg: &mut Svg, cell: &Rect) {
        for (i, line) in self.plan.title.iter().enumerate() {
            let y = cell.y + 10.0 + TITLE + i as f64 * (TITLE + 4.0) - 2.0;
            // Over the plot, unless the line is so long that it would leave the cell.
            let half = 0.5 * text::width(line, TITLE);
            let middle = self.plot.x + 0.5 * self.plot.w;
            let x = middle
                .max(cell.x + half + 4.0)
                .min((cell.right() - half - 4.0).max(cell.x + 0.5 * cell.w));
            svg.text(
                x,
                y,
                line,
                TextStyle {
                    bold: true,
                    ..TextStyle::new(TITLE, Anchor::Middle)
                },
            );
        }
    }

    fn grid(&self, svg: &mut Svg) {
        let mut path = Path::default();
        for (v, _) in &self.plan.x_ticks.major {
            if let Some(px) = self.x.px(*v).filter(|px| self.x.holds(*px)) {
                path.move_to((px, self.plot.y));
                path.line_to((px, self.plot.bottom()));
            }
        }
        for (v, _) in &self.plan.y_ticks.major {
            if let Some(py) = self.y.px(*v).filter(|py| self.y.holds(*py)) {
                path.move_to((self.plot.x, py));
                path.line_to((self.plot.right(), py));
            }
        }
        svg.path(&path, &format!(r#"fill="none" stroke="{GRID}" stroke-width="1""#));
    }

    fn frame(&self, svg: &mut Svg, cell: &Rect, with_x_label: bool) {
        let (plan, plot) = (self.plan, &self.plot);
        let mut path = Path::default();
        path.polygon(&[
            (plot.x, plot.y),
            (plot.right(), plot.y),
            (plot.right(), plot.bottom()),
            (plot.x, plot.bottom()),
        ]);
        let x_marks = plan
            .x_ticks
            .major
            .iter()
            .map(|t| (t.0, 4.5))
            .chain(plan.x_ticks.minor.iter().map(|v| (*v, 2.5)));
        for (v, length) in x_marks {
            if let Some(px) = self.x.px(v).filter(|px| self.x.holds(*px)) {
                path.move_to((px, plot.bottom()));
                path.line_to((px, plot.bottom() + length));
            }
        }
        let y_marks = plan
            .y_ticks
            .major
            .iter()
            .map(|t| (t.0, 4.5))
            .chain(plan.y_ticks.minor.iter().map(|v| (*v, 2.5)));
        for (v, length) in y_marks {
            if let Some(py) = self.y.px(v).filter(|py| self.y.holds(*py)) {
                path.move_to((plot.x, py));
                path.line_to((plot.x - length, py));
            }
        }
        svg.path(&path, &format!(r#"fill="none" stroke="{FRAME}" stroke-width="1""#));
        for (v, label) in &plan.x_ticks.major {
            if let Some(px) = self.x.px(*v).filter(|px| self.x.holds(*px)) {
                svg.text(
                    px,
                    plot.bottom() + 7.0 + TICK,
                    label,
                    TextStyle::new(TICK, Anchor::Middle),
                );
            }
        }
        for (v, label) in &plan.y_ticks.major {
            if let Some(py) = self.y.px(*v).filter(|py| self.y.holds(*py)) {
                svg.text(plot.x - 8.0, py + 0.36 * TICK, label, TextStyle::new(TICK, Anchor::End));
            }
        }
        self.axis_labels(svg, cell, with_x_label);
    }

    fn axis_labels(&self, svg: &mut Svg, cell: &Rect, with_x_label: bool) {
        let (plan, plot, chart) = (self.plan, &self.plot, self.plan.chart);
        let below = plot.bottom() + 12.0 + TICK + LABEL;
        if with_x_label {
            svg.text(
                plot.x + 0.5 * plot.w,
                below,
                &chart.x.label,
                fitted(&chart.x.label, plot.w.max(0.8 * cell.w)),
            );
        }
        let beside = plot.x - plan.margins_left_of_ticks();
        let style = fitted(&chart.y.label, plot.h.max(0.8 * cell.h));
        svg.text(
            beside,
            plot.y + 0.5 * plot.h,
            &chart.y.label,
            TextStyle { upwards: true, ..style },
        );
        if plan.x_ticks.power != 0 {
            svg.text(
                plot.right(),
                below,
                &times_power(plan.x_ticks.power),
                TextStyle::new(TICK, Anchor::End),
            );
        }
        if plan.y_ticks.power != 0 {
            svg.text(
                plot.x,
                plot.y - 6.0,
                &times_power(plan.y_ticks.power),
                TextStyle::new(TICK, Anchor::Start),
            );
        }
    }

    fn patches(&self, svg: &mut Svg) {
        for patch in &self.plan.chart.patches {
            let mut path = Path::default();
            for polygon in &patch.polygons {
                let corners: Option<Vec<_>> = polygon.iter().map(|&p| self.point(p)).collect();
                if let Some(corners) = corners {
                    path.polygon(&corners);
                }
            }
            svg.path(&path, &patch_look(patch));
        }
    }

    /// Draws the lines now and returns their labels with the places found, to be written over the series.
    fn reference_lines(&mut self, svg: &mut Svg) -> Vec<(Rect, String, bool)> {
        let plot = self.plot;
        let mut labels = Vec::new();
        for line in &self.plan.chart.lines {
            let upwards = line.direction == Direction::Vertical;
            let (mapping, length) = (if upwards { &self.x } else { &self.y }, text::width(&line.label, NOTE));
            let Some(px) = mapping.px(line.at).filter(|px| mapping.holds(*px)) else {
                continue;
            };
            let (a, b, places) = if upwards {
                let places = placement::along_vertical(px, &plot, length, NOTE + 3.0);
                ((px, plot.y), (px, plot.bottom()), places)
            } else {
                let places = placement::along_horizontal(px, &plot, length, NOTE + 3.0);
                ((plot.x, px), (plot.right(), px), places)
            };
            svg.line(
                a,
                b,
                r##"stroke="#555555" stroke-width="1" stroke-dasharray="7 3 1.5 3""##,
            );
            if let Some((place, _)) = self.taken.best(&places, &plot).filter(|_| !line.label.is_empty()) {
                self.taken.boxes.push(place);
                labels.push((place, line.label.clone(), upwards));
            }
            sample(a, b, &mut self.taken.points);
        }
        labels
    }

    fn note(&mut self, svg: &mut Svg, note: &Annotation) {
        let Some(p) = self.point(note.at).filter(|p| self.plot.grown(0.5).holds(*p)) else {
            return;
        };
        if note.ring {
            svg.put(format_args!(
                r#"<circle cx="{}" cy="{}" r="6.5" fill="none" stroke="{}" stroke-width="1.6"/>"#,
                Px(p.0),
                Px(p.1),
                palette::ALERT
            ));
            self.taken.boxes.push(Rect {
                x: p.0 - 7.0,
                y: p.1 - 7.0,
                w: 14.0,
                h: 14.0,
            });
        }
        if note.text.is_empty() {
            return;
        }
        let (w, h) = (text::width(&note.text, NOTE), NOTE + 4.0);
        let Some(place) = self.taken.best_note(p, w, h, &self.plot.grown(-2.0)) else {
            return;
        };
        let foot = placement::foot(p, &place);
        let gap = (foot.0 - p.0).hypot(foot.1 - p.1);
        if gap > 16.0 {
            let start = if note.ring { 6.5 / gap } else { 3.0 / gap };
            let from = (p.0 + start * (foot.0 - p.0), p.1 + start * (foot.1 - p.1));
            svg.line(from, foot, r##"stroke="#666666" stroke-width="0.8""##);
        }
        svg.text(
            place.x,
            place.bottom() - 4.0,
            &note.text,
            TextStyle {
                halo: true,
                ..TextStyle::new(NOTE, Anchor::Start)
            },
        );
        self.taken.boxes.push(place);
    }

    fn legend(&self, svg: &mut Svg, cell: &Rect) {
        let Some(legend) = &self.plan.legend else { return };
        let plot = &self.plot;
        let place = match legend.side {
            Legend::Right => Rect {
                x: cell.right() - legend.w - 6.0,
                y: plot.y,
                w: legend.w,
                h: legend.h,
            },
            Legend::Below => {
                let x = (plot.x + 0.5 * (plot.w - legend.w)).max(cell.x + 4.0);
                Rect {
                    x,
                    y: cell.bottom() - legend.h - 4.0,
                    w: legend.w,
                    h: legend.h,
                }
            }
            _ => {
                let places = placement::along_rim(plot, legend.w, legend.h);
                let Some((place, _)) = self.taken.best(&places, plot) else {
                    return;
                };
                svg.rect(
                    place.x,
                    place.y,
                    place.w,
                    place.h,
                    r##"rx="2" fill="#ffffff" fill-opacity="0.9" stroke="#bbbbbb" stroke-width="0.8""##,
                );
                place
            }
        };
        legend_rows(svg, self.plan.chart, &self.plan.colors, legend, &place);
    }

    fn color_bar(&self, svg: &mut Svg) {
        let (Some(bar), Some(ticks)) = (&self.plan.chart.color_bar, &self.plan.bar_ticks) else {
            return;
        };
        let plot = &self.plot;
        let (x, w) = (plot.right() + 14.0, crate::layout::BAR);
        let steps = if bar.bands == 0 { 96 } else { bar.bands };
        let (lo, hi) = (bar.from.min(bar.to), bar.from.max(bar.to));
        for i in 0..steps {
            let top = plot.bottom() - plot.h * (i + 1) as f64 / steps as f64;
            let t = (i as f64 + 0.5) / steps as f64;
            let t = if bar.from <= bar.to { t } else { 1.0 - t };
            let color = bar.map.at(t);
            // Half a pixel of overlap closes the seams.
            let h = plot.h / steps as f64 + if i == 0 { 0.0 } else { 0.5 };
            svg.rect(x, top, w, h, &format!(r#"fill="{color}""#));
        }
        svg.rect(
            x,
            plot.y,
            w,
            plot.h,
            &format!(r#"fill="none" stroke="{FRAME}" stroke-width="0.8""#),
        );
        for (v, label) in &ticks.major {
            let y = plot.bottom() - (v - lo) / (hi - lo) * plot.h;
            svg.line(
                (x + w, y),
                (x + w + 4.0, y),
                &format!(r#"stroke="{FRAME}" stroke-width="0.8""#),
            );
            svg.text(x + w + 7.0, y + 0.36 * TICK, label, TextStyle::new(TICK, Anchor::Start));
        }
        if ticks.power != 0 {
            svg.text(
                x,
                plot.y - 6.0,
                &times_power(ticks.power),
                TextStyle::new(TICK, Anchor::Start),
            );
        }
        let label_x = x + w + 7.0 + crate::layout::widest_label(ticks) + LABEL;
        svg.text(
            label_x,
            plot.y + 0.5 * plot.h,
            &bar.label,
            TextStyle {
                upwards: true,
                ..fitted(&bar.label, plot.h)
            },
        );
    }
}

impl Plan<'_> {
    /// Distance of the y label's baseline from the plot, px.
    fn margins_left_of_ticks(&self) -> f64 {
        crate::layout::widest_label(&self.y_ticks) + 16.0
    }
}

/// The plot cut down so that one unit is as long along x as along y; limits are widened only where the plot would
/// become a sliver.
fn equalize(plan: &Plan<'_>, plot: Rect) -> (Rect, (f64, f64), (f64, f64)) {
    let (mut x, mut y) = (plan.x_limits, plan.y_limits);
    let (dx, dy) = (x.1 - x.0, y.1 - y.0);
    let px_per_unit = (plot.w / dx).min(plot.h / dy);
    let w = (px_per_unit * dx).max(0.3 * plot.w);
    let h = (px_per_unit * dy).max(0.3 * plot.h);
    let widen = |limits: (f64, f64), length: f64| {
        let (middle, half) = (0.5 * (limits.0 + limits.1), 0.5 * length / px_per_unit);
        (middle - half, middle + half)
    };
    if w > px_per_unit * dx * (1.0 + 1e-9) {
        x = widen(x, w);
    }
    if h > px_per_unit * dy * (1.0 + 1e-9) {
        y = widen(y, h);
    }
    (
        Rect {
            x: plot.x + 0.5 * (plot.w - w),
            y: plot.y + 0.5 * (plot.h - h),
            w,
            h,
        },
        x,
        y,
    )
}

fn times_power(power: i32) -> String {
    format!("\u{d7}10^{{{}}}", power.to_string().replace('-', "\u{2212}"))
}

/// A label made smaller where it is longer than its axis.
fn fitted(label: &str, length_px: f64) -> TextStyle<'static> {
    let full = text::width(label, LABEL);
    let size = if full > length_px {
        (LABEL * length_px / full).max(8.0)
    } else {
        LABEL
    };
    TextStyle::new(size, Anchor::Middle)
}

fn patch_look(patch: &Patch) -> String {
    let fill = patch
        .fill
        .as_ref()
        .map_or_else(|| "none".to_owned(), |c| palette::checked(c));
    match (&patch.rim, &patch.fill) {
        (Some((color, width)), _) => format!(
            r#"fill="{fill}" fill-rule="evenodd" stroke="{}" stroke-width="{}" stroke-linejoin="round""#,
            palette::checked(color),
            Px(if width.is_finite() { *width } else { 1.0 })
        ),
        (None, Some(_)) => format!(r#"fill="{fill}" stroke="{fill}" stroke-width="0.6" stroke-linejoin="round""#),
        (None, None) => r#"fill="none""#.to_owned(),
    }
}
