//! Normal modes that another program has computed: f06 print files, punch files, op2 and op4 binaries.
//!
//! All readers take whole files in memory, believe no length before it is checked against the bytes that are there, and
//! return errors, never panics, on truncated or foreign files.

mod f06;
mod op2;
mod op4;
mod punch;

use std::{fs, path::Path};

pub use f06::read_f06;
pub use op2::{Op2Grid, Op2Modes, read_op2};
pub use op4::{NamedMatrix, read_op4};
pub use punch::read_punch;

/// Why a mode file could not be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ModeFileError {
    /// The file itself.
    #[error("cannot read {path}: {reason}")]
    Read {
        /// The file.
        path: String,
        /// What the system said.
        reason: String,
    },
    /// The file holds no modes.
    #[error("no {what} in this {format} file; {hint}")]
    Nothing {
        /// f06, punch, op2 or op4.
        format: &'static str,
        /// What was looked for.
        what: &'static str,
        /// What to ask the other program for.
        hint: &'static str,
    },
    /// A line of a text file.
    #[error("line {line} of this {format} file: needed {needed}, got \"{got}\"")]
    Line {
        /// f06, punch or op4.
        format: &'static str,
        /// Line from one.
        line: usize,
        /// What the format has there.
        needed: &'static str,
        /// What stands there.
        got: String,
    },
    /// A place in a binary file.
    #[error("byte {at} of this {format} file: {what}")]
    Bytes {
        /// op2 or op4.
        format: &'static str,
        /// Offset from zero.
        at: usize,
        /// What is wrong.
        what: String,
    },
    /// Modes that do not all have the same points.
    #[error("mode {mode} has {got} points and mode 1 has {needed}; print all modes for the same set of points")]
    Points {
        /// The mode, from one.
        mode: usize,
        /// Points of mode 1.
        needed: usize,
        /// Points of this mode.
        got: usize,
    },
}

/// One row of the table of real eigenvalues.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eigenvalue {
    /// Mode number from one.
    pub mode: usize,
    /// Square of the circular frequency.
    pub eigenvalue: f64,
    /// Frequency in Hz.
    pub freq_hz: f64,
    /// Generalized mass; none where the file does not give it.
    pub generalized_mass: Option<f64>,
}

/// Modes as printed: frequencies and shapes in each point's displacement system.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ModeTable {
    /// Eigenvalues, as many as shapes or more.
    pub eigenvalues: Vec<Eigenvalue>,
    /// Point numbers, ascending.
    pub points: Vec<u32>,
    /// `[mode][point][component]`: three translations, three rotations.
    pub shapes: Vec<Vec<[f64; 6]>>,
}

/// The shapes as they are met in a file: mode by mode, row by row.
#[derive(Default)]
struct Collector {
    modes: Vec<Collected>,
}

struct Collected {
    value: Eigenvalue,
    rows: Vec<(u32, [f64; 6])>,
}

impl Collector {
    /// Opens a mode, or goes on with it when its number was the last (a new page).
    fn open(&mut self, mode: usize, eigenvalue: f64, freq_hz: f64) {
        if self.modes.last().is_some_and(|last| last.value.mode == mode) {
            return;
        }
        let value = Eigenvalue {
            mode,
            eigenvalue,
            freq_hz,
            generalized_mass: None,
        };
        self.modes.push(Collected {
            value,
            rows: Vec::new(),
        });
    }

    fn row(&mut self, point: u32, row: [f64; 6]) {
        if let Some(last) = self.modes.last_mut() {
            last.rows.push((point, row));
        }
    }

    /// The table of all modes; a mode that was printed twice counts once, its last printing.
    fn finish(self, mut eigenvalues: Vec<Eigenvalue>) -> Result<ModeTable, ModeFileError> {
        let mut table = ModeTable::default();
        let mut modes = self.modes;
        modes.retain(|m| !m.rows.is_empty());
        modes.reverse();
        modes.sort_by_key(|m| m.value.mode);
        modes.dedup_by_key(|m| m.value.mode);
        for (index, Collected { value, mut rows }) in modes.into_iter().enumerate() {
            rows.sort_by_key(|(point, _)| *point);
            rows.dedup_by_key(|(point, _)| *point);
            let points: Vec<u32> = rows.iter().map(|(point, _)| *point).collect();
            if index == 0 {
                table.points = points;
            } else if points != table.points {
                return Err(ModeFileError::Points {
                    mode: index + 1,
                    needed: table.points.len(),
                    got: points.len(),
                });
            }
            table.shapes.push(rows.into_iter().map(|(_, row)| row).collect());
            if !eigenvalues.iter().any(|e| e.mode == value.mode) {
                eigenvalues.push(value);
            }
        }
        eigenvalues.sort_by_key(|e| e.mode);
        table.eigenvalues = eigenvalues;
        Ok(table)
    }
}

/// Reads the modes of a file by its name's ending: `f06`, `out` or `prt`, `pch` or `pun`, `op2`.
///
/// # Errors
/// A file that cannot be read or holds no modes.
pub fn read_modes(path: impl AsRef<Path>) -> Result<ModeTable, ModeFileError> {
    let path = path.as_ref();
    let bytes = fs::read(path).map_err(|error| ModeFileError::Read {
        path: path.display().to_string(),
        reason: error.to_string(),
    })?;
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_lowercase();
    match ending.as_str() {
        "pch" | "pun" => read_punch(&String::from_utf8_lossy(&bytes)),
        "op2" => read_op2(&bytes).map(|modes| modes.table),
        _ => read_f06(&String::from_utf8_lossy(&bytes)),
    }
}
