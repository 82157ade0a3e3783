//! Bulk data entries with their types. Each type's `read` says in its first line how the card is laid out (fields 2 to 9,
//! `/` between lines); names of fields are those of the usual manuals.

pub mod aero;
pub mod constraint;
pub mod control;
pub mod element;
pub mod geometry;
pub mod mass;
pub mod material;
pub mod matrix;
pub mod property;
pub mod spline;
