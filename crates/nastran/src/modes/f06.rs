//! Print files: the table REAL EIGENVALUES and the pages REAL EIGENVECTOR NO.

use super::{Collector, Eigenvalue, ModeFileError, ModeTable};
use crate::number::real;

/// What the rows below the last heading are.
enum Section {
    Other,
    Eigenvalues,
    Eigenvector,
}

/// Reads the modes of an f06 file.
///
/// # Errors
/// A file without eigenvectors, modes with different points.
pub fn read_f06(text: &str) -> Result<ModeTable, ModeFileError> {
    let mut section = Section::Other;
    let mut eigenvalues: Vec<Eigenvalue> = Vec::new();
    let mut shapes = Collector::default();
    let mut above = (0.0, 0.0);
    for line in text.lines() {
        // Column one is the printer's carriage control: a one begins a page.
        if line.starts_with('1') && line.contains("PAGE") {
            section = Section::Other;
            continue;
        }
        let squeezed: String = line.chars().filter(|c| !c.is_whitespace()).collect();
        if let Some(value) = after(line, "EIGENVALUE =") {
            above.0 = value;
        }
        if let Some(value) = after(line, "CYCLES =").or_else(|| after(line, "CYCLIC FREQUENCY =")) {
            above.1 = value;
        }
        if squeezed.ends_with("REALEIGENVALUES") {
            section = Section::Eigenvalues;
            continue;
        }
        if let Some(at) = squeezed.find("REALEIGENVECTORNO.") {
            let digits: String = squeezed[at + 18..].chars().take_while(char::is_ascii_digit).collect();
            section = Section::Other;
            if let Ok(mode) = digits.parse() {
                shapes.open(mode, above.0, above.1);
                section = Section::Eigenvector;
            }
            continue;
        }
        match section {
            Section::Other => {}
            Section::Eigenvalues => {
                if let Some(row) = eigenvalue_row(line) {
                    // The table is printed again after augmentation and for the modes that are used: the last one counts.
                    if row.mode == 1 {
                        eigenvalues.clear();
                    }
                    eigenvalues.push(row);
                }
            }
            Section::Eigenvector => vector_row(line, &mut shapes),
        }
    }
    let table = shapes.finish(eigenvalues)?;
    if table.shapes.is_empty() {
        return Err(ModeFileError::Nothing {
            format: "f06",
            what: "page REAL EIGENVECTOR",
            hint: "ask for VECTOR(PRINT) = ALL in the case control section",
        });
    }
    Ok(table)
}

/// The number behind a label.
fn after(line: &str, label: &str) -> Option<f64> {
    let at = line.find(label)? + label.len();
    real(line.get(at..)?.split_whitespace().next()?.trim_end_matches(')'))
}

/// `mode order eigenvalue radians cycles mass stiffness`
fn eigenvalue_row(line: &str) -> Option<Eigenvalue> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [mode, _, eigenvalue, _, cycles, mass, _] = words.as_slice() else {
        return None;
    };
    Some(Eigenvalue {
        mode: mode.parse().ok()?,
        eigenvalue: real(eigenvalue)?,
        freq_hz: real(cycles)?,
        generalized_mass: Some(real(mass)?),
    })
}

/// `point G t1 t2 t3 r1 r2 r3`, or `point S` and the values of up to six consecutive scalar points.
fn vector_row(line: &str, shapes: &mut Collector) {
    let mut words = line.split_whitespace();
    let (Some(point), Some(kind)) = (words.next().and_then(|w| w.parse::<u32>().ok()), words.next()) else {
        return;
    };
    let values: Option<Vec<f64>> = words.map(real).collect();
    let Some(values) = values.filter(|v| !v.is_empty() && v.len() <= 6) else {
        return;
    };
    match kind {
        "G" if values.len() == 6 => {
            let mut row = [0.0; 6];
            row.copy_from_slice(&values);
            shapes.row(point, row);
        }
        "S" => {
            for (i, value) in (0u32..).zip(values) {
                if let Some(point) = point.checked_add(i) {
                    shapes.row(point, [value, 0.0, 0.0, 0.0, 0.0, 0.0]);
                }
            }
        }
        _ => {}
    }
}
