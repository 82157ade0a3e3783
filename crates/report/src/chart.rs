//! The chart as data: axes, series, lines and notes. Drawing it is `draw`'s affair.

use crate::error::ReportError;
use crate::figure::Figure;
use crate::palette::ColorMap;

/// How values are spread over an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// By their logarithm; values that are not positive are gaps.
    Log,
}

/// One axis of a chart.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// Label with its unit, e.g. `"Speed, m/s"`; `_{..}` and `^{..}` make sub- and superscripts.
    pub label: String,
    /// Limits in data units, or none to fit the data.
    pub range: Option<(f64, f64)>,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// Larger values to the left, or down (as is usual for the pressure coefficient).
    pub inverted: bool,
}

/// Shape of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// Disc.
    Circle,
    /// Square on its side.
    Square,
    /// Square on its corner.
    Diamond,
    /// Triangle pointing up.
    TriangleUp,
    /// Triangle pointing down.
    TriangleDown,
    /// Upright cross.
    Plus,
    /// Diagonal cross.
    Cross,
}

impl Marker {
    /// Distinct markers in the order in which figures hand them out.
    pub const ALL: [Self; 7] = [
        Self::Circle,
        Self::Square,
        Self::TriangleUp,
        Self::Diamond,
        Self::TriangleDown,
        Self::Cross,
        Self::Plus,
    ];
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Full line.
    Line,
    /// Dashed line.
    Dashed,
    /// Dotted line.
    Dotted,
    /// Markers only, one for every point.
    Markers(Marker),
    /// Full line with markers; where points crowd, the line stays whole and markers are thinned out (not of twenty or fewer).
    LineMarkers(Marker),
    /// Dashed line with markers, thinned out likewise.
    DashedMarkers(Marker),
}

/// Points that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend; empty to leave the series out of it.
    pub label: String,
    /// (x, y) in data units, in drawing order. A point with NaN or infinity in it is a gap.
    pub points: Vec<(f64, f64)>,
    /// Lines, markers or both.
    pub style: Style,
    /// `#rrggbb`, or none for the next colour of [`crate::palette::SERIES`].
    pub color: Option<String>,
    /// Markers without filling.
    pub hollow: bool,
    /// Uncertainty of x at every point (below, above), both as lengths >= 0; empty for none.
    pub x_error: Vec<(f64, f64)>,
    /// Uncertainty of y at every point (below, above), both as lengths >= 0; empty for none.
    pub y_error: Vec<(f64, f64)>,
}

impl Series {
    /// A series in the given style.
    pub fn new(label: impl Into<String>, points: Vec<(f64, f64)>, style: Style) -> Self {
        Self {
            label: label.into(),
            points,
            style,
            color: None,
            hollow: false,
            x_error: Vec::new(),
            y_error: Vec::new(),
        }
    }

    /// A full line.
    pub fn line(label: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::new(label, points, Style::Line)
    }

    /// A dashed line.
    pub fn dashed(label: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::new(label, points, Style::Dashed)
    }

    /// Markers only.
    pub fn markers(label: impl Into<String>, points: Vec<(f64, f64)>, marker: Marker) -> Self {
        Self::new(label, points, Style::Markers(marker))
    }

    /// A full line with markers.
    pub fn line_markers(label: impl Into<String>, points: Vec<(f64, f64)>, marker: Marker) -> Self {
        Self::new(label, points, Style::LineMarkers(marker))
    }

    /// Measured points: hollow black markers, as in every figure here.
    pub fn experiment(label: impl Into<String>, points: Vec<(f64, f64)>, marker: Marker) -> Self {
        Self::markers(label, points, marker)
            .color(crate::palette::EXPERIMENT)
            .hollow()
    }

    /// Sets the colour, `#rrggbb` (anything that is not of that form falls back to black).
    #[must_use]
    pub fn color(mut self, color: impl Into<String>) -> Self {
        self.color = Some(color.into());
        self
    }

    /// Markers without filling.
    #[must_use]
    pub fn hollow(mut self) -> Self {
        self.hollow = true;
        self
    }

    /// Uncertainty of y, (below, above) per point as lengths.
    #[must_use]
    pub fn y_error(mut self, below_above: Vec<(f64, f64)>) -> Self {
        self.y_error = below_above;
        self
    }

    /// Uncertainty of x, (below, above) per point as lengths.
    #[must_use]
    pub fn x_error(mut self, below_above: Vec<(f64, f64)>) -> Self {
        self.x_error = below_above;
        self
    }
}

/// A note at a point of the chart; its place is chosen so that it covers as little as possible.
#[derive(Debug, Clone, PartialEq)]
pub struct Annotation {
    /// Point in data units.
    pub at: (f64, f64),
    /// What is said there.
    pub text: String,
    /// Whether a ring marks the point.
    pub ring: bool,
}

/// Which way a reference line runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// At one x.
    Vertical,
    /// At one y.
    Horizontal,
}

/// A line across the whole chart at one value.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceLine {
    /// Vertical (value of x) or horizontal (value of y).
    pub direction: Direction,
    /// Where, in data units.
    pub at: f64,
    /// What is written along it; may be empty.
    pub label: String,
}

/// Where the legend stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Legend {
    /// Inside where it covers no data, else outside to the right.
    #[default]
    Auto,
    /// Outside, to the right of the plot.
    Right,
    /// Outside, below the plot.
    Below,
    /// None.
    Hidden,
}

/// A filled shape in data units, drawn under the series.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Polygons `[polygon][corner]`, closed by themselves, that share fill and rim.
    pub polygons: Vec<Vec<(f64, f64)>>,
    /// Fill, `#rrggbb`; none for no filling.
    pub fill: Option<String>,
    /// Rim, `#rrggbb` and width in px; none for the fill's own colour (which closes the seams between neighbours).
    pub rim: Option<(String, f64)>,
}

/// The scale of colours beside a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct ColorBar {
    /// Label with its unit.
    pub label: String,
    /// Value at the lower end.
    pub from: f64,
    /// Value at the upper end.
    pub to: f64,
    /// The colours.
    pub map: ColorMap,
    /// Number of bands of equal colour; 0 for a smooth scale.
    pub bands: usize,
}

/// One chart: title, two axes, series, lines and notes.
///
/// ```
/// use dip_report::{Chart, Marker, Series};
/// let svg = Chart::new("Damping of the first mode", "Speed, m/s", "Damping g")
///     .series(Series::line("PK", vec![(100.0, -0.02), (200.0, -0.01), (300.0, 0.02)]))
///     .series(Series::experiment("experiment", vec![(233.0, 0.0)], Marker::Circle))
///     .hline(0.0, "")
///     .svg(640, 420)?;
/// assert!(svg.starts_with("<svg"));
/// # Ok::<(), dip_report::ReportError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chart {
    /// Title above the plot; may be empty.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Series in drawing order.
    pub series: Vec<Series>,
    /// Filled shapes, under the series.
    pub patches: Vec<Patch>,
    /// Lines across the chart.
    pub lines: Vec<ReferenceLine>,
    /// Notes.
    pub annotations: Vec<Annotation>,
    /// Where the legend stands.
    pub legend: Legend,
    /// Scale of colours on the right.
    pub color_bar: Option<ColorBar>,
    /// One unit is as long along x as along y (planforms, sections).
    pub equal_scale: bool,
    /// Neither frame, ticks nor axis labels (oblique views).
    pub bare: bool,
}

impl Chart {
    /// An empty chart. Labels carry units: `Chart::new("Lift", "Angle of attack, deg", "C_{L}")`.
    pub fn new(title: impl Into<String>, x_label: impl Into<String>, y_label: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            x: Axis {
                label: x_label.into(),
                ..Axis::default()
            },
            y: Axis {
                label: y_label.into(),
                ..Axis::default()
            },
            ..Self::default()
        }
    }

    /// Adds a series.
    #[must_use]
    pub fn series(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// Limits of x in data units.
    #[must_use]
    pub fn x_range(mut self, from: f64, to: f64) -> Self {
        self.x.range = Some((from, to));
        self
    }

    /// Limits of y in data units.
    #[must_use]
    pub fn y_range(mut self, from: f64, to: f64) -> Self {
        self.y.range = Some((from, to));
        self
    }

    /// Logarithmic x.
    #[must_use]
    pub fn log_x(mut self) -> Self {
        self.x.scale = Scale::Log;
        self
    }

    /// Logarithmic y.
    #[must_use]
    pub fn log_y(mut self) -> Self {
        self.y.scale = Scale::Log;
        self
    }

    /// Larger y down, as for pressure coefficients.
    #[must_use]
    pub fn invert_y(mut self) -> Self {
        self.y.inverted = true;
        self
    }

    /// One unit as long along x as along y.
    #[must_use]
    pub fn equal_scale(mut self) -> Self {
        self.equal_scale = true;
        self
    }

    /// A vertical line at `x`.
    #[must_use]
    pub fn vline(mut self, x: f64, label: impl Into<String>) -> Self {
        self.lines.push(ReferenceLine {
            direction: Direction::Vertical,
            at: x,
            label: label.into(),
        });
        self
    }

    /// A horizontal line at `y`.
    #[must_use]
    pub fn hline(mut self, y: f64, label: impl Into<String>) -> Self {
        self.lines.push(ReferenceLine {
            direction: Direction::Horizontal,
            at: y,
            label: label.into(),
        });
        self
    }

    /// A note at a point, without a ring.
    #[must_use]
    pub fn annotate(mut self, x: f64, y: f64, text: impl Into<String>) -> Self {
        self.annotations.push(Annotation {
            at: (x, y),
            text: text.into(),
            ring: false,
        });
        self
    }

    /// A note at a point that is marked with a ring.
    #[must_use]
    pub fn mark(mut self, x: f64, y: f64, text: impl Into<String>) -> Self {
        self.annotations.push(Annotation {
            at: (x, y),
            text: text.into(),
            ring: true,
        });
        self
    }

    /// Places the legend.
    #[must_use]
    pub fn legend(mut self, legend: Legend) -> Self {
        self.legend = legend;
        self
    }

    /// The chart as an SVG document of the given size in px. The same chart gives the same bytes.
    ///
    /// # Errors
    /// [`ReportError::Size`] for a picture too small, [`ReportError::Range`] for limits that cannot be drawn,
    /// [`ReportError::Shape`] for error bars that do not match their points.
    pub fn svg(&self, width_px: u32, height_px: u32) -> Result<String, ReportError> {
        Figure::new("").row(vec![self.clone()]).svg(width_px, height_px)
    }
}
