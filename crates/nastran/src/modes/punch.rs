//! Punch files: blocks headed `$EIGENVALUE = ... MODE = ...`.

use super::{Collector, ModeFileError, ModeTable};
use crate::number::real;

/// Reads the modes of a punch file.
///
/// # Errors
/// A file without eigenvectors, rows that cannot be read, modes with different points.
pub fn read_punch(text: &str) -> Result<ModeTable, ModeFileError> {
    let mut shapes = Collector::default();
    let mut is_vector = false;
    let mut open = false;
    let mut row: Option<(u32, usize, [f64; 6])> = None;
    for (i, line) in text.lines().enumerate() {
        let wrong = |needed: &'static str| ModeFileError::Line {
            format: "punch",
            line: i + 1,
            needed,
            got: line.chars().take(60).collect(),
        };
        if let Some(header) = line.strip_prefix('$') {
            if let Some((point, _, values)) = row.take() {
                shapes.row(point, values);
            }
            let header = header.get(..72).unwrap_or(header);
            if header.starts_with("EIGENVECTOR") {
                is_vector = true;
                open = false;
            } else if is_kind(header) {
                is_vector = false;
                open = false;
            } else if is_vector && header.starts_with("EIGENVALUE") {
                let mut numbers = header.split(['=', ' ']).filter_map(real);
                let (Some(eigenvalue), Some(mode)) = (numbers.next(), numbers.next()) else {
                    return Err(wrong("$EIGENVALUE = value MODE = number"));
                };
                let freq_hz = eigenvalue.max(0.0).sqrt() / std::f64::consts::TAU;
                if !(1.0..1e9).contains(&mode) {
                    return Err(wrong("a mode number from one"));
                }
                shapes.open(mode as usize, eigenvalue, freq_hz);
                open = true;
            }
            continue;
        }
        if !open || line.trim().is_empty() {
            continue;
        }
        let column = |from: usize, to: usize| line.get(from..to.min(line.len())).unwrap_or("").trim();
        let mut values = Vec::new();
        for from in [18, 36, 54] {
            let field = column(from, from + 18);
            if !field.is_empty() {
                values.push(real(field).ok_or_else(|| wrong("numbers in columns 19 to 72"))?);
            }
        }
        if line.starts_with("-CONT-") {
            let Some((_, filled, numbers)) = &mut row else {
                return Err(wrong("a point before its continuation"));
            };
            for value in values {
                if *filled < 6 {
                    numbers[*filled] = value;
                    *filled += 1;
                }
            }
        } else {
            if let Some((point, _, values)) = row.take() {
                shapes.row(point, values);
            }
            let point = column(0, 10)
                .parse()
                .map_err(|_| wrong("a point number in columns 1 to 10"))?;
            let mut numbers = [0.0; 6];
            numbers[..values.len()].copy_from_slice(&values);
            row = Some((point, values.len(), numbers));
        }
    }
    if let Some((point, _, values)) = row {
        shapes.row(point, values);
    }
    let table = shapes.finish(Vec::new())?;
    if table.shapes.is_empty() {
        return Err(ModeFileError::Nothing {
            format: "punch",
            what: "block $EIGENVECTOR",
            hint: "ask for VECTOR(PUNCH) = ALL in the case control section",
        });
    }
    Ok(table)
}

/// Headers that name another kind of result.
fn is_kind(header: &str) -> bool {
    [
        "DISPLACEMENTS",
        "VELOCITIES",
        "ACCELERATION",
        "SPCF",
        "MPCF",
        "OLOAD",
        "ELEMENT",
        "GRID POINT",
    ]
    .iter()
    .any(|kind| header.starts_with(kind))
}
