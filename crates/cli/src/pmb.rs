//! The `pmb` program: grids and the flow.

use std::process::ExitCode;

/// Runs the program and returns its exit code.
pub fn main() -> ExitCode {
    ExitCode::FAILURE
}
