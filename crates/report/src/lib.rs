//! What people look at: SVG charts, tables and self-contained HTML reports.
//!
//! Everything here is plain data in, text out, the same bytes for the same data. A [`Chart`] holds series, lines and
//! notes; a [`Figure`] puts charts in line in one picture; [`vg`], [`boundary`], [`cp_cuts`], [`history`], [`mode_map`],
//! [`mode_view`] and [`lattice`] make the pictures of this subject. A [`Table`] is written as text, Markdown, CSV or HTML; a
//! [`Page`] holds text, tables and figures.

mod boundary;
mod chart;
mod contour;
mod cp;
mod draw;
mod error;
mod extent;
mod figure;
mod history;
mod html;
mod lattice;
mod layout;
mod marks;
mod modes;
mod number;
pub mod palette;
mod placement;
mod svg;
mod table;
mod text;
mod ticks;
mod trace;
mod vg;

pub use boundary::{BoundaryCurve, BoundaryPoint, boundary};
pub use chart::{
    Annotation, Axis, Chart, ColorBar, Direction, Legend, Marker, Patch, ReferenceLine, Scale, Series, Style,
};
pub use cp::{CpCut, cp_cuts};
pub use error::ReportError;
pub use figure::Figure;
pub use history::{Curve, history};
pub use html::{Block, Page, Picture};
pub use lattice::{BoxCorners, lattice, worst_boxes};
pub use modes::{Mesh, mode_map, mode_view};
pub use number::{NumberFormat, write_number};
pub use palette::ColorMap;
pub use table::{Align, Cell, Column, Table, Tone, Value};
pub use vg::{CrossingKind, VgCrossing, VgMode, vg};
