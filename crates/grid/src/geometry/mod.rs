//! What the grid goes round: aerofoil sections and wings.

mod naca;
mod ordinates;
mod section;
mod spline;
mod wing;

pub use ordinates::read_ordinates;
pub use section::{GeometryError, Section, TrailingEdge};
pub(crate) use wing::closure;
pub use wing::{Between, Station, TipShape, Wing};
