//! OUTPUT4 files: matrices in text or binary, dense or sparse columns.
//!
//! Layout (MSC Nastran, DMAP module OUTPUT4): a header with columns, rows, form, type and name, then one record a column that is
//! not all zero: column, first row (0 if sparse), number of words, values; the file's last column has number columns + 1.

use super::ModeFileError;
use crate::number::real;

/// A matrix of an op4 file.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedMatrix {
    /// Its name.
    pub name: String,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Real parts, column by column, `rows * columns` values.
    pub real: Vec<f64>,
    /// Imaginary parts likewise; empty for a real matrix.
    pub imaginary: Vec<f64>,
}

/// No matrix that can be of use here has more terms; a larger one is a damaged header.
const LARGEST: usize = 1 << 27;

type Result<T> = std::result::Result<T, ModeFileError>;

/// Reads all matrices of an op4 file, text or binary (4-byte words, either byte order).
///
/// # Errors
/// Truncated, damaged and foreign files.
pub fn read_op4(bytes: &[u8]) -> Result<Vec<NamedMatrix>> {
    let first: Option<[u8; 4]> = bytes.get(..4).and_then(|b| b.try_into().ok());
    match first {
        // A binary header has 24 bytes; text begins with blanks and digits.
        Some(b) if u32::from_le_bytes(b) == 24 => binary(bytes, true),
        Some(b) if u32::from_be_bytes(b) == 24 => binary(bytes, false),
        _ => text(&String::from_utf8_lossy(bytes)),
    }
}

struct Building {
    matrix: NamedMatrix,
    is_complex: bool,
    /// Values of a complex column alternate real and imaginary.
    words_a_value: usize,
}

impl Building {
    fn new(columns: i64, rows: i64, kind: i64, name: &str) -> Option<(Self, bool)> {
        let big_matrix = rows < 0;
        let (columns, rows) = (
            usize::try_from(columns).ok()?,
            usize::try_from(rows.unsigned_abs()).ok()?,
        );
        let terms = columns.checked_mul(rows).filter(|t| *t <= LARGEST && *t > 0)?;
        let (is_complex, words_a_value) = match kind {
            1 => (false, 1),
            2 => (false, 2),
            3 => (true, 1),
            4 => (true, 2),
            _ => return None,
        };
        let imaginary = if is_complex { vec![0.0; terms] } else { Vec::new() };
        let matrix = NamedMatrix {
            name: name.trim().to_owned(),
            rows,
            columns,
            real: vec![0.0; terms],
            imaginary,
        };
        Some((
            Self {
                matrix,
                is_complex,
                words_a_value,
            },
            big_matrix,
        ))
    }

    /// Puts values into a column from a row on (both from zero).
    fn put(&mut self, column: usize, row: usize, values: &[f64]) -> Option<()> {
        let step = if self.is_complex { 2 } else { 1 };
        for (i, value) in values.chunks_exact(step).enumerate() {
            let row = row.checked_add(i).filter(|r| *r < self.matrix.rows)?;
            let at = column * self.matrix.rows + row;
            *self.matrix.real.get_mut(at)? = value[0];
            if self.is_complex {
                *self.matrix.imaginary.get_mut(at)? = value[1];
            }
        }
        Some(())
    }
}

/// `(4I8, 2A4, format)`, then for each column `(3I8)` and the values, five of sixteen columns a line by default.
fn text(text: &str) -> Result<Vec<NamedMatrix>> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    let mut at = 0;
    let wrong = |at: usize, needed: &'static str| ModeFileError::Line {
        format: "op4",
        line: at + 1,
        needed,
        got: lines.get(at).unwrap_or(&"").chars().take(60).collect(),
    };
    let integers = |at: usize, count: usize| -> Option<Vec<i64>> {
        let line = lines.get(at)?;
        (0..count)
            .map(|i| line.get(8 * i..(8 * i + 8).min(line.len()))?.trim().parse().ok())
            .collect()
    };
    while at < lines.len() {
        if lines[at].trim().is_empty() {
            at += 1;
            continue;
        }
        let header =
            integers(at, 4).ok_or_else(|| wrong(at, "columns, rows, form and type in four fields of eight"))?;
        let name = lines[at].get(32..40.min(lines[at].len())).unwrap_or("");
        let (a_line, width) = layout(lines[at].get(40..).unwrap_or(""));
        let (mut building, big_matrix) = Building::new(header[0], header[1], header[3], name)
            .ok_or_else(|| wrong(at, "a size and type of a matrix"))?;
        at += 1;
        loop {
            let head =
                integers(at, 3).ok_or_else(|| wrong(at, "column, row and number of words in three fields of eight"))?;
            let column = usize::try_from(head[0])
                .ok()
                .filter(|c| *c > 0)
                .ok_or_else(|| wrong(at, "a column from one"))?;
            let mut words = usize::try_from(head[2]).map_err(|_| wrong(at, "a number of words"))?;
            let is_end = column > building.matrix.columns;
            let sparse = head[1] == 0;
            let start = at;
            at += 1;
            if is_end {
                // The closing record holds one value.
                at += 1;
                break;
            }
            // Words are counted in single precision units in sparse columns and values in dense ones.
            let next_values = |count: usize, at: &mut usize| -> Result<Vec<f64>> {
                let mut values = Vec::new();
                while values.len() < count {
                    let line = lines
                        .get(*at)
                        .ok_or_else(|| wrong(*at, "values; the file was cut off"))?;
                    for i in 0..a_line.min(count - values.len()) {
                        let field = line.get(i * width..((i + 1) * width).min(line.len())).unwrap_or("");
                        values.push(real(field).ok_or_else(|| wrong(*at, "numbers"))?);
                    }
                    *at += 1;
                }
                Ok(values)
            };
            let outside = |at: usize| wrong(at, "rows inside the matrix");
            if sparse {
                while words > 0 {
                    let (row, count, used) = if big_matrix {
                        let s = integers(at, 2).ok_or_else(|| wrong(at, "length and row of a string"))?;
                        (s[1], s[0] - 1, 2)
                    } else {
                        let s = integers_one(lines.get(at)).ok_or_else(|| wrong(at, "a string header"))?;
                        (s % 65536, s / 65536 - 1, 1)
                    };
                    let row = usize::try_from(row - 1).map_err(|_| outside(at))?;
                    let units = usize::try_from(count).ok().filter(|n| *n > 0 && n + used <= words);
                    let units = units.ok_or_else(|| wrong(at, "a string inside its column"))?;
                    at += 1;
                    let values = next_values(units / building.words_a_value, &mut at)?;
                    building.put(column - 1, row, &values).ok_or_else(|| outside(start))?;
                    words -= units + used;
                }
            } else {
                let row = usize::try_from(head[1] - 1).map_err(|_| outside(start))?;
                if words > 2 * building.matrix.rows {
                    return Err(outside(start));
                }
                let values = next_values(words, &mut at)?;
                building.put(column - 1, row, &values).ok_or_else(|| outside(start))?;
            }
        }
        found.push(building.matrix);
    }
    nothing_is_an_error(found)
}

fn integers_one(line: Option<&&str>) -> Option<i64> {
    line?.trim().parse().ok()
}

/// Values a line and their width from a format such as `1P,5E16.9`.
fn layout(format: &str) -> (usize, usize) {
    let upper = format.trim().to_uppercase();
    let behind = upper.rsplit(',').next().unwrap_or("");
    let mut parts = behind.split(['E', 'D', '.']);
    let count = parts.next().and_then(|s| s.parse().ok());
    let width = parts.next().and_then(|s| s.parse().ok());
    match (count, width) {
        (Some(count @ 1..=20), Some(width @ 8..=40)) => (count, width),
        _ => (5, 16),
    }
}

fn binary(bytes: &[u8], little: bool) -> Result<Vec<NamedMatrix>> {
    let mut at = 0;
    let error = |at: usize, what: &str| ModeFileError::Bytes {
        format: "op4",
        at,
        what: what.to_owned(),
    };
    let word = |b: &[u8]| -> i32 {
        let b = [b[0], b[1], b[2], b[3]];
        if little {
            i32::from_le_bytes(b)
        } else {
            i32::from_be_bytes(b)
        }
    };
    let mut found = Vec::new();
    let block = |at: &mut usize| -> Result<&[u8]> {
        let cut = || error(*at, "the file ends inside a record; it was cut off");
        let length = bytes.get(*at..*at + 4).map(&word).ok_or_else(cut)?;
        let length = usize::try_from(length).map_err(|_| error(*at, "a record of negative length"))?;
        let data = bytes.get(*at + 4..).and_then(|b| b.get(..length)).ok_or_else(cut)?;
        let closing = bytes
            .get(*at + 4 + length..)
            .and_then(|b| b.get(..4))
            .map(&word)
            .ok_or_else(cut)?;
        if usize::try_from(closing) != Ok(length) {
            return Err(error(*at, "a record whose two lengths differ"));
        }
        *at += length + 8;
        Ok(data)
    };
    while at < bytes.len() {
        let header = block(&mut at)?;
        if header.len() != 24 {
            return Err(error(at, "needed the header of a matrix (24 bytes)"));
        }
        let name: String = header[16..24].iter().map(|b| char::from(*b)).collect();
        let n = |i: usize| i64::from(word(&header[4 * i..4 * i + 4]));
        let (mut building, big_matrix) =
            Building::new(n(0), n(1), n(3), &name).ok_or_else(|| error(at, "a header whose size or type cannot be"))?;
        loop {
            let data = block(&mut at)?;
            if data.len() < 12 {
                return Err(error(at, "a column shorter than its header"));
            }
            let head = [word(&data[0..4]), word(&data[4..8]), word(&data[8..12])];
            let column = usize::try_from(head[0])
                .ok()
                .filter(|c| *c > 0)
                .ok_or_else(|| error(at, "a column below one"))?;
            if column > building.matrix.columns {
                break;
            }
            let words: Vec<&[u8]> = data[12..].chunks_exact(4).collect();
            let size = building.words_a_value;
            let values = |words: &[&[u8]]| -> Vec<f64> {
                words
                    .chunks_exact(size)
                    .map(|w| {
                        if size == 1 {
                            f64::from(f32::from_bits(word(w[0]) as u32))
                        } else {
                            let (low, high) = if little { (w[0], w[1]) } else { (w[1], w[0]) };
                            f64::from_bits(u64::from(word(high) as u32) << 32 | u64::from(word(low) as u32))
                        }
                    })
                    .collect()
            };
            let outside = || error(at, "rows outside the matrix");
            if head[1] != 0 {
                let row = usize::try_from(head[1] - 1).map_err(|_| outside())?;
                building.put(column - 1, row, &values(&words)).ok_or_else(outside)?;
                continue;
            }
            let mut i = 0;
            while i < words.len() {
                let (row, count, used) = if big_matrix {
                    let Some(second) = words.get(i + 1) else {
                        return Err(outside());
                    };
                    (word(second), word(words[i]) - 1, 2)
                } else {
                    let s = word(words[i]);
                    (s % 65536, s / 65536 - 1, 1)
                };
                let row = usize::try_from(row - 1).map_err(|_| outside())?;
                let count = usize::try_from(count).ok().filter(|n| *n > 0).ok_or_else(outside)?;
                let string = words.get(i + used..).and_then(|w| w.get(..count)).ok_or_else(outside)?;
                building.put(column - 1, row, &values(string)).ok_or_else(outside)?;
                i += used + count;
            }
        }
        found.push(building.matrix);
    }
    nothing_is_an_error(found)
}

fn nothing_is_an_error(found: Vec<NamedMatrix>) -> Result<Vec<NamedMatrix>> {
    if found.is_empty() {
        return Err(ModeFileError::Nothing {
            format: "op4",
            what: "matrix",
            hint: "the file is empty",
        });
    }
    Ok(found)
}
