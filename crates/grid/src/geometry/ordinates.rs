//! Reads tables of section ordinates.

use super::section::{GeometryError, Section};

/// Reads a section from text: numbers with blanks, commas or semicolons between, `#` comments and title lines allowed.
///
/// Understood are two columns x and z as a loop (from one trailing edge round the nose to the other) or as a half section
/// (x rising from the nose, z the half thickness of a symmetric section), and three columns x, upper z, lower z with x
/// rising. `file` names the text in messages; `nose_radius` is in chords.
/// # Errors
/// Names the line that cannot be read, or what the points lack.
pub fn read_ordinates(file: &str, text: &str, nose_radius: Option<f64>) -> Result<Section, GeometryError> {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for (n, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        let values: Option<Vec<f64>> = line
            .split(|c: char| c == ',' || c == ';' || c.is_whitespace())
            .filter(|word| !word.is_empty())
            .map(|word| word.parse().ok())
            .collect();
        let columns = rows.first().map_or(0, Vec::len);
        match values {
            Some(row) if (columns == 0 && matches!(row.len(), 2 | 3)) || (columns > 0 && row.len() == columns) => {
                rows.push(row);
            }
            None if rows.is_empty() => {}
            _ => {
                let needed = if columns == 3 {
                    "three numbers, x, upper and lower z,"
                } else {
                    "two numbers, x and z,"
                };
                return Err(GeometryError::Ordinates {
                    file: file.to_owned(),
                    line: n + 1,
                    what: format!("{needed} are needed; got \"{line}\""),
                });
            }
        }
    }
    let name = std::path::Path::new(file)
        .file_stem()
        .map_or_else(|| file.to_owned(), |s| s.to_string_lossy().into_owned());
    if rows.first().is_some_and(|row| row.len() == 3) {
        let upper = rows.iter().rev().map(|row| [row[0], row[1]]);
        let lower = rows.iter().skip(1).map(|row| [row[0], row[2]]);
        return Section::from_points(&name, &upper.chain(lower).collect::<Vec<_>>(), nose_radius);
    }
    let rising = rows.windows(2).all(|p| p[1][0] > p[0][0]);
    if rising && rows.len() > 1 {
        let (x, z): (Vec<f64>, Vec<f64>) = rows.iter().map(|p| (p[0], p[1])).unzip();
        return Section::symmetric(&name, &x, &z, nose_radius);
    }
    Section::from_points(
        &name,
        &rows.iter().map(|p| [p[0], p[1]]).collect::<Vec<_>>(),
        nose_radius,
    )
}
