//! Reads tables of section ordinates.

use super::section::{GeometryError, Section};

/// Reads a section from text: two columns x and z, blanks or commas between, `#` comments and one title line allowed.
///
/// Understood are a loop (from one trailing edge round the nose to the other) and a half section (x rising from the
/// nose, z the half thickness of a symmetric section). `file` names the text in messages; `nose_radius` is in chords.
/// # Errors
/// Names the line that cannot be read, or what the points lack.
pub fn read_ordinates(file: &str, text: &str, nose_radius: Option<f64>) -> Result<Section, GeometryError> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    let mut title = false;
    for (n, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        let values: Vec<Option<f64>> = line
            .split(|c: char| c == ',' || c == ';' || c.is_whitespace())
            .filter(|word| !word.is_empty())
            .map(|word| word.parse().ok())
            .collect();
        match values[..] {
            [Some(x), Some(z)] => points.push([x, z]),
            _ if points.is_empty() && !title => title = true,
            _ => {
                return Err(GeometryError::Ordinates {
                    file: file.to_owned(),
                    line: n + 1,
                    what: format!("two numbers, x and z, are needed; got \"{line}\""),
                });
            }
        }
    }
    let name = std::path::Path::new(file)
        .file_stem()
        .map_or_else(|| file.to_owned(), |s| s.to_string_lossy().into_owned());
    let rising = points.windows(2).all(|p| p[1][0] > p[0][0]);
    if rising && points.len() > 1 {
        let (x, z): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (p[0], p[1])).unzip();
        return Section::symmetric(&name, &x, &z, nose_radius);
    }
    Section::from_points(&name, &points, nose_radius)
}
