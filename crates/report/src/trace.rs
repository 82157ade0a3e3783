//! Series in pixels: clipped lines, markers that are seen, error bars. Everything later (drawing, the search for free
//! places) works on this.

use crate::chart::{Series, Style};
use crate::extent::Mapping;
use crate::svg::Path;

/// A rectangle in px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rect {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) w: f64,
    pub(crate) h: f64,
}

impl Rect {
    pub(crate) fn right(&self) -> f64 {
        self.x + self.w
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.y + self.h
    }

    pub(crate) fn holds(&self, p: (f64, f64)) -> bool {
        p.0 >= self.x && p.0 <= self.right() && p.1 >= self.y && p.1 <= self.bottom()
    }

    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.x < other.right() && other.x < self.right() && self.y < other.bottom() && other.y < self.bottom()
    }

    pub(crate) fn contains(&self, other: &Self) -> bool {
        other.x >= self.x && other.y >= self.y && other.right() <= self.right() && other.bottom() <= self.bottom()
    }

    /// Larger by `by` px on every side.
    pub(crate) fn grown(&self, by: f64) -> Self {
        Self {
            x: self.x - by,
            y: self.y - by,
            w: self.w + 2.0 * by,
            h: self.h + 2.0 * by,
        }
    }
}

/// One series in px.
#[derive(Default)]
pub(crate) struct Trace {
    /// Runs of joined points, clipped to the plot.
    pub(crate) lines: Vec<Vec<(f64, f64)>>,
    /// Markers to draw.
    pub(crate) markers: Vec<(f64, f64)>,
    /// Points of a line that has no neighbour to be joined to; drawn as dots so that they are not lost.
    pub(crate) lone: Vec<(f64, f64)>,
    /// Error bars: ends of the bar, clipped, and whether each end is real (gets a cap).
    pub(crate) bars: Vec<Bar>,
}

/// An error bar in px.
pub(crate) struct Bar {
    pub(crate) ends: [(f64, f64); 2],
    pub(crate) capped: [bool; 2],
    pub(crate) vertical: bool,
}

/// Least distance between markers on a line, px.
const MARKER_SPACING: f64 = 13.0;

/// Up to this many points each one is a result to be seen, however near the next one.
const FEW: usize = 20;

impl Trace {
    /// Places a series in the plot.
    pub(crate) fn new(series: &Series, x: &Mapping, y: &Mapping, plot: &Rect) -> Self {
        let mut trace = Self::default();
        let points: Vec<Option<(f64, f64)>> = series.points.iter().map(|p| Some((x.px(p.0)?, y.px(p.1)?))).collect();
        let seen = plot.grown(0.01);
        let (lined, marked, thinned) = match series.style {
            Style::Line | Style::Dashed | Style::Dotted => (true, false, false),
            Style::Markers(_) => (false, true, false),
            Style::LineMarkers(_) | Style::DashedMarkers(_) => (true, true, points.len() > FEW),
        };
        if lined {
            trace.join(&points, plot);
            if !marked {
                for (i, p) in points.iter().enumerate() {
                    let alone = |j: Option<usize>| j.and_then(|j| points.get(j)).is_none_or(Option::is_none);
                    if let Some(p) = p
                        && alone(i.checked_sub(1))
                        && alone(i.checked_add(1))
                        && seen.holds(*p)
                    {
                        trace.lone.push(*p);
                    }
                }
            }
        }
        if marked {
            let mut last: Option<(f64, f64)> = None;
            for p in points.iter().flatten().filter(|p| seen.holds(**p)) {
                let close = last.is_some_and(|q| (p.0 - q.0).hypot(p.1 - q.1) < MARKER_SPACING);
                if !(thinned && close) {
                    trace.markers.push(*p);
                    last = Some(*p);
                }
            }
        }
        trace.error_bars(series, x, y, plot, &points);
        trace
    }

    /// Joins neighbouring points, clips, and drops points that lie within a third of a pixel of the one before.
    fn join(&mut self, points: &[Option<(f64, f64)>], plot: &Rect) {
        let mut open: Vec<(f64, f64)> = Vec::new();
        for pair in points.windows(2) {
            let piece = match pair {
                [Some(a), Some(b)] => clip(*a, *b, plot),
                _ => None,
            };
            let Some((a, b)) = piece else {
                self.close(&mut open);
                continue;
            };
            if open.last().is_some_and(|q| (q.0 - a.0).hypot(q.1 - a.1) > 0.34) {
                self.close(&mut open);
            }
            if open.is_empty() {
                open.push(a);
            }
            if open.last().is_some_and(|q| (q.0 - b.0).hypot(q.1 - b.1) > 0.33) {
                open.push(b);
            }
        }
        self.close(&mut open);
    }

    fn close(&mut self, open: &mut Vec<(f64, f64)>) {
        match open.as_slice() {
            [] => {}
            // All of a line within a third of a pixel: still a place to be seen.
            [only] => self.lone.push(*only),
            _ => self.lines.push(open.clone()),
        }
        open.clear();
    }

    fn error_bars(&mut self, s: &Series, x: &Mapping, y: &Mapping, plot: &Rect, points: &[Option<(f64, f64)>]) {
        for (vertical, errors) in [(true, &s.y_error), (false, &s.x_error)] {
            for ((value, centre), (below, above)) in s.points.iter().zip(points).zip(errors) {
                let (Some(centre), true) = (centre, below.is_finite() && above.is_finite()) else {
                    continue;
                };
                if below.abs() + above.abs() == 0.0 {
                    continue;
                }
                let end = |by: f64| {
                    if vertical {
                        // On a logarithmic axis a bar may reach zero: it then runs out of the plot.
                        let px =
                            y.px(value.1 + by)
                                .unwrap_or(if by < 0.0 { plot.bottom() + 1.0 } else { plot.y - 1.0 });
                        (centre.0, px)
                    } else {
                        let px = x
                            .px(value.0 + by)
                            .unwrap_or(if by < 0.0 { plot.x - 1.0 } else { plot.right() + 1.0 });
                        (px, centre.1)
                    }
                };
                let (a, b) = (end(-below.abs()), end(above.abs()));
                if let Some((ca, cb)) = clip(a, b, plot) {
                    let same = |p: (f64, f64), q: (f64, f64)| (p.0 - q.0).abs() + (p.1 - q.1).abs() < 0.02;
                    self.bars.push(Bar {
                        ends: [ca, cb],
                        capped: [same(a, ca), same(b, cb)],
                        vertical,
                    });
                }
            }
        }
    }

    /// Points every few pixels along all that is drawn: what labels should not cover.
    pub(crate) fn obstacles(&self, out: &mut Vec<(f64, f64)>) {
        for line in &self.lines {
            for pair in line.windows(2) {
                sample(pair[0], pair[1], out);
            }
        }
        for bar in &self.bars {
            sample(bar.ends[0], bar.ends[1], out);
        }
        // A marker is some 8 px wide: its corners count, and it weighs more than a point of a line.
        for &(px, py) in self.markers.iter().chain(&self.lone) {
            for (dx, dy) in [(0.0, 0.0), (-4.0, -4.0), (4.0, -4.0), (-4.0, 4.0), (4.0, 4.0)] {
                out.push((px + dx, py + dy));
            }
        }
    }

    /// The lines as one path.
    pub(crate) fn path(&self) -> Path {
        let mut path = Path::default();
        for line in &self.lines {
            for (i, &p) in line.iter().enumerate() {
                if i == 0 { path.move_to(p) } else { path.line_to(p) }
            }
        }
        path
    }
}

/// Points about every 4 px from a to b.
pub(crate) fn sample(a: (f64, f64), b: (f64, f64), out: &mut Vec<(f64, f64)>) {
    let steps = ((b.0 - a.0).hypot(b.1 - a.1) / 4.0).ceil().clamp(1.0, 2000.0);
    for i in 0..=steps as usize {
        let t = i as f64 / steps;
        out.push((a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1)));
    }
}

/// The part of a segment inside a rectangle (Liang and Barsky 1984), or none.
pub(crate) fn clip(a: (f64, f64), b: (f64, f64), r: &Rect) -> Option<((f64, f64), (f64, f64))> {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (p, q) in [
        (-dx, a.0 - r.x),
        (dx, r.right() - a.0),
        (-dy, a.1 - r.y),
        (dy, r.bottom() - a.1),
    ] {
        if p == 0.0 {
            if q < 0.0 {
                return None;
            }
        } else if p < 0.0 {
            enter = enter.max(q / p);
        } else {
            leave = leave.min(q / p);
        }
    }
    if enter > leave {
        return None;
    }
    let cut = |t: f64| (a.0 + t * dx, a.1 + t * dy);
    Some((cut(enter), cut(leave)))
        .filter(|(p, q)| p.0.is_finite() && p.1.is_finite() && q.0.is_finite() && q.1.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_cut_at_the_rim() {
        let r = Rect {
            x: 0.0,
            y: 0.0,
            w: 10.0,
            h: 10.0,
        };
        assert_eq!(clip((-5.0, 5.0), (15.0, 5.0), &r), Some(((0.0, 5.0), (10.0, 5.0))));
        assert_eq!(clip((-5.0, -1.0), (15.0, -1.0), &r), None);
        assert_eq!(clip((2.0, 2.0), (3.0, 4.0), &r), Some(((2.0, 2.0), (3.0, 4.0))));
        assert_eq!(clip((-1e299, 5.0), (1e299, 5.0), &r).map(|p| p.0.1), Some(5.0));
    }
}
