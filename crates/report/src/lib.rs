//! What people look at: SVG charts and self-contained HTML reports.
//!
//! Everything here is plain data in, text out, the same bytes for the same data. A [`Chart`] holds series, lines and
//! notes; a [`Figure`] puts charts in line in one picture.

mod chart;
mod draw;
mod error;
mod extent;
mod figure;
mod layout;
pub mod palette;
mod placement;
mod svg;
mod text;
mod ticks;
mod trace;

pub use chart::{
    Annotation, Axis, Chart, ColorBar, Direction, Legend, Marker, Patch, ReferenceLine, Scale, Series, Style,
};
pub use error::ReportError;
pub use figure::Figure;
pub use palette::ColorMap;
