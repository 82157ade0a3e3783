//! What the user asks: case files, units, atmosphere and scales.
//!
//! * [`document`] reads a TOML file, merges `--set` overrides and keeps every value's place in the text;
//! * [`diagnose`] turns a wrong key or value into an error with file, line, what was needed and what to do;
//! * [`units`] reads quantities such as `"0.2082 kg/m^3"`;
//! * [`mod@file`] holds one type for each kind of case file, one doc comment for each key;
//! * [`atmosphere`] is the U.S. Standard Atmosphere 1976;
//! * [`scales`] is the one place that knows reduced frequency.

pub mod airfoil;
pub mod atmosphere;
pub mod diagnose;
pub mod document;
pub mod file;
pub mod scales;
pub mod table;
pub mod units;
pub mod wing;

pub use diagnose::CaseError;
pub use document::Document;
