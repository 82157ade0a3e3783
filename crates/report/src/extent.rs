//! From data to axis limits, and from data units to pixels.

use crate::chart::{Axis, Chart, Direction, Scale};
use crate::error::ReportError;
use crate::ticks::{self, LARGEST, Ticks};

/// Whether a value can be placed on an axis; what cannot is a gap. The ends of what f64 holds are left out: the decade
/// below the least number is zero.
pub(crate) fn drawable(value: f64, scale: Scale) -> bool {
    value.is_finite() && value.abs() < LARGEST && (scale == Scale::Linear || value > 1.0 / LARGEST)
}

/// Least and greatest of what an axis has to show.
#[derive(Clone, Copy)]
pub(crate) struct Span {
    lo: f64,
    hi: f64,
}

impl Span {
    const EMPTY: Self = Self {
        lo: f64::INFINITY,
        hi: f64::NEG_INFINITY,
    };

    fn take(&mut self, value: f64, scale: Scale) {
        if drawable(value, scale) {
            self.lo = self.lo.min(value);
            self.hi = self.hi.max(value);
        }
    }

    /// The span of both.
    pub(crate) fn join(self, other: Self) -> Self {
        Self {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
        }
    }
}

/// Which axis of a chart is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Which {
    X,
    Y,
}

impl Which {
    pub(crate) fn axis(self, chart: &Chart) -> &Axis {
        match self {
            Self::X => &chart.x,
            Self::Y => &chart.y,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
        }
    }

    pub(crate) fn pick(self, p: (f64, f64)) -> f64 {
        match self {
            Self::X => p.0,
            Self::Y => p.1,
        }
    }
}

/// What the chart's data takes up on one axis. Points that are a gap on the other axis do not count, nor do points
/// outside a range given for it: the limits fit what is seen.
pub(crate) fn span(chart: &Chart, which: Which) -> Span {
    let (own, other) = match which {
        Which::X => (Which::X, Which::Y),
        Which::Y => (Which::Y, Which::X),
    };
    let (scale, other_axis) = (own.axis(chart).scale, other.axis(chart));
    let seen = |p: (f64, f64)| {
        let v = other.pick(p);
        let inside = other_axis.range.is_none_or(|(a, b)| v >= a.min(b) && v <= a.max(b));
        inside && drawable(v, other_axis.scale)
    };
    let mut span = Span::EMPTY;
    for series in &chart.series {
        let errors = match which {
            Which::X => &series.x_error,
            Which::Y => &series.y_error,
        };
        for (i, &p) in series.points.iter().enumerate().filter(|(_, p)| seen(**p)) {
            let v = which.pick(p);
            span.take(v, scale);
            if let Some((below, above)) = errors.get(i).filter(|_| v.is_finite()) {
                span.take(v - below.abs(), scale);
                span.take(v + above.abs(), scale);
            }
        }
    }
    for &p in chart
        .patches
        .iter()
        .flat_map(|patch| patch.polygons.iter().flatten())
        .filter(|p| seen(**p))
    {
        span.take(which.pick(p), scale);
    }
    for note in chart.annotations.iter().filter(|note| seen(note.at)) {
        span.take(which.pick(note.at), scale);
    }
    for line in &chart.lines {
        let counts = match line.direction {
            Direction::Vertical => which == Which::X,
            Direction::Horizontal => which == Which::Y,
        };
        if counts {
            span.take(line.at, scale);
        }
    }
    span
}

/// Limits of one axis in data units, lower first: those asked for, else those that fit `span` with about `count` ticks.
pub(crate) fn limits(chart: &Chart, which: Which, span: Span, count: usize) -> Result<(f64, f64), ReportError> {
    let axis = which.axis(chart);
    if let Some((from, to)) = axis.range {
        let refuse = |reason| ReportError::Range {
            figure: chart.title.clone(),
            axis: which.name(),
            from,
            to,
            reason,
        };
        let (lo, hi) = (from.min(to), from.max(to));
        if !(from.is_finite() && to.is_finite() && lo > -LARGEST && hi < LARGEST) {
            return Err(refuse("a limit is not finite"));
        }
        if axis.scale == Scale::Log && lo <= 1.0 / LARGEST {
            return Err(refuse("a logarithmic axis has positive limits only"));
        }
        if hi - lo <= 1e-12 * lo.abs().max(hi.abs()) || hi - lo < 1e-290 {
            return Err(refuse("the limits are equal"));
        }
        return Ok((lo, hi));
    }
    if span.lo > span.hi {
        return Ok(if axis.scale == Scale::Log {
            (0.1, 10.0)
        } else {
            (0.0, 1.0)
        });
    }
    Ok(match axis.scale {
        Scale::Linear if chart.equal_scale || chart.bare => {
            let room = 0.03 * (span.hi - span.lo).max(f64::MIN_POSITIVE);
            let (lo, hi) = (span.lo - room, span.hi + room);
            if hi - lo > 1e-12 * lo.abs().max(hi.abs()) {
                (lo, hi)
            } else {
                ticks::linear_limits(lo, hi, count, 0.0)
            }
        }
        // Curves run from side to side, but keep off the top and the bottom.
        Scale::Linear => ticks::linear_limits(span.lo, span.hi, count, if which == Which::X { 0.0 } else { 0.02 }),
        Scale::Log => ticks::log_limits(span.lo, span.hi),
    })
}

/// Ticks of an axis between its limits.
pub(crate) fn ticks_of(axis: &Axis, limits: (f64, f64), count: usize) -> Ticks {
    match axis.scale {
        Scale::Linear => ticks::linear(limits.0, limits.1, count),
        Scale::Log => ticks::log(limits.0, limits.1, count),
    }
}

/// Data units to pixels along one axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mapping {
    scale: Scale,
    /// Values at the two ends, on the axis' own scale.
    from: f64,
    to: f64,
    /// Pixels at the two ends.
    from_px: f64,
    to_px: f64,
}

impl Mapping {
    /// `limits` (lower, upper) go to `px` (where the lower one is, where the upper one is), swapped if inverted.
    pub(crate) fn new(axis: &Axis, limits: (f64, f64), px: (f64, f64)) -> Self {
        let put = |v: f64| if axis.scale == Scale::Log { v.log10() } else { v };
        let (from_px, to_px) = if axis.inverted { (px.1, px.0) } else { px };
        Self {
            scale: axis.scale,
            from: put(limits.0),
            to: put(limits.1),
            from_px,
            to_px,
        }
    }

    /// Pixel of a value, or none where it cannot be drawn.
    pub(crate) fn px(&self, value: f64) -> Option<f64> {
        if !drawable(value, self.scale) {
            return None;
        }
        let v = if self.scale == Scale::Log { value.log10() } else { value };
        // Halves, so that a range over nearly all of f64 does not overflow.
        let part = (0.5 * v - 0.5 * self.from) / (0.5 * self.to - 0.5 * self.from);
        Some(self.from_px + part * (self.to_px - self.from_px))
    }

    /// Whether a pixel lies between the ends (with a hair of slack).
    pub(crate) fn holds(&self, px: f64) -> bool {
        px >= self.from_px.min(self.to_px) - 0.01 && px <= self.from_px.max(self.to_px) + 0.01
    }
}
