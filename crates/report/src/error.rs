//! What can be wrong with a picture, a table or a report.

use thiserror::Error;

/// Why a figure, table or report could not be made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ReportError {
    /// The picture is too small to hold its own axes and labels.
    #[error(
        "figure \"{figure}\": {width_px} x {height_px} px leaves no room to draw in; it needs at least \
         {needed_width_px} x {needed_height_px} px: ask for a larger picture or fewer charts in it"
    )]
    Size {
        /// Title of the figure.
        figure: String,
        /// Width asked for, px.
        width_px: u32,
        /// Height asked for, px.
        height_px: u32,
        /// Least width that works, px.
        needed_width_px: u32,
        /// Least height that works, px.
        needed_height_px: u32,
    },
    /// An axis range given by the caller cannot be drawn.
    #[error(
        "figure \"{figure}\", {axis} axis: range {from} to {to} cannot be drawn: {reason}; give two different finite \
         limits, or none to fit the data"
    )]
    Range {
        /// Title of the figure.
        figure: String,
        /// Which axis ("x", "y" or "colour").
        axis: &'static str,
        /// First limit given.
        from: f64,
        /// Second limit given.
        to: f64,
        /// What is wrong with them.
        reason: &'static str,
    },
    /// An array does not have the length that the others ask for.
    #[error("figure \"{figure}\": {what} has {got} entries, needed {needed}: check the array that was passed")]
    Shape {
        /// Title of the figure or table.
        figure: String,
        /// Which array.
        what: String,
        /// Length (or index bound) needed.
        needed: usize,
        /// Length (or index) got.
        got: usize,
    },
    /// There is nothing to draw.
    #[error("figure \"{figure}\": {what} is empty: pass at least one")]
    Empty {
        /// Title of the figure.
        figure: String,
        /// What is missing.
        what: &'static str,
    },
}
