//! Aerofoil sections from files of ordinates.

use crate::diagnose::CaseError;
use crate::table::Table;
use std::path::Path;

/// Ordinates of an aerofoil on the unit chord, upper and lower side from leading to trailing edge.
#[derive(Debug, Clone, PartialEq)]
pub struct Airfoil {
    /// Stations x/c, increasing from 0 to 1.
    pub x: Vec<f64>,
    /// Upper ordinates z/c at `x`.
    pub upper: Vec<f64>,
    /// Lower ordinates z/c at `x`.
    pub lower: Vec<f64>,
}

impl Airfoil {
    /// Reads a file of ordinates over the chord: CSV with columns `x` and `half_thickness`, or `x`, `upper` and `lower`; or, as the grid
    /// recipes do, numbers with blanks, commas or semicolons between after any title lines: a loop of x and z from one trailing edge
    /// round the nose to the other (the usual `.dat`), a half section (x rising, half thickness), or x, upper and lower z.
    ///
    /// # Errors
    /// Lines that cannot be read, stations that do not increase from 0 to 1, an upper side below the lower one.
    pub fn read(file: &Path) -> Result<Self, CaseError> {
        let text = std::fs::read_to_string(file).map_err(|e| {
            let help = "check the path: paths inside a file are relative to that file".to_owned();
            CaseError::new(format!("{}: {e}", file.display()), Some(help))
        })?;
        let wrong = |message: &str| {
            let help = "give ordinates over the chord, from the leading edge (0) to the trailing edge (1)".to_owned();
            CaseError::new(format!("{}: {message}", file.display()), Some(help))
        };
        let header = text
            .lines()
            .find(|l| !l.trim_start().starts_with('#') && !l.trim().is_empty())
            .unwrap_or_default();
        let names: Vec<&str> = header.split(',').map(str::trim).collect();
        let [x, upper, lower] = if names.contains(&"half_thickness") || names.contains(&"upper") {
            let table = Table::parse(file, text.clone())?;
            let x = table.numbers("x")?;
            if table.has("half_thickness") {
                symmetric(x, table.numbers("half_thickness")?)
            } else {
                [x, table.numbers("upper")?, table.numbers("lower")?]
            }
        } else {
            let rows = rows(file, &text)?;
            let column = |c: usize| rows.iter().map(|r| r[c]).collect::<Vec<f64>>();
            if rows.first().is_some_and(|r| r.len() == 3) {
                [column(0), column(1), column(2)]
            } else if rows.windows(2).all(|w| w[1][0] > w[0][0]) {
                symmetric(column(0), column(1))
            } else {
                let points: Vec<[f64; 2]> = rows.iter().map(|r| [r[0], r[1]]).collect();
                sides(&points).ok_or_else(|| {
                    wrong("the points must run from one trailing edge round the nose to the other, with x rising along both sides")
                })?
            }
        };
        if x.len() < 3 || x.windows(2).any(|w| w[1] <= w[0]) {
            return Err(wrong("x must have three or more increasing stations"));
        }
        if x[0].abs() > 1e-9 || (x[x.len() - 1] - 1.0).abs() > 1e-9 {
            return Err(wrong("x must go from 0 to 1"));
        }
        if upper.iter().zip(&lower).any(|(u, l)| u < l) {
            return Err(wrong("the upper side lies below the lower side"));
        }
        Ok(Self { x, upper, lower })
    }
}

fn symmetric(x: Vec<f64>, half: Vec<f64>) -> [Vec<f64>; 3] {
    let lower = half.iter().map(|t| -t).collect();
    [x, half, lower]
}

/// Lines of two or three numbers, all alike, after title lines; `#` begins a comment.
fn rows(file: &Path, text: &str) -> Result<Vec<Vec<f64>>, CaseError> {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for (n, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        let values: Option<Vec<f64>> = line
            .split(|c: char| c == ',' || c == ';' || c.is_whitespace())
            .filter(|word| !word.is_empty())
            .map(|word| word.parse::<f64>().ok().filter(|v| v.is_finite()))
            .collect();
        let columns = rows.first().map(Vec::len);
        match values {
            Some(row) if matches!(row.len(), 2 | 3) && columns.is_none_or(|c| c == row.len()) => rows.push(row),
            None if rows.is_empty() => {}
            _ => {
                let needed = columns.map_or("two or three numbers".to_owned(), |c| format!("{c} numbers, as above"));
                return Err(CaseError::new(
                    format!("{}:{}: needed {needed}; got \"{line}\"", file.display(), n + 1),
                    Some("x and z as a loop round the nose; x and half thickness; or x, upper and lower z".to_owned()),
                ));
            }
        }
    }
    Ok(rows)
}

/// Stations, upper and lower side of a loop, moved and scaled to the nose at x = 0 and unit chord; z keeps its zero.
fn sides(points: &[[f64; 2]]) -> Option<[Vec<f64>; 3]> {
    let nose = (0..points.len()).min_by(|&a, &b| points[a][0].total_cmp(&points[b][0]))?;
    let end = points.first()?[0].max(points.last()?[0]);
    let (x0, chord) = (points[nose][0], end - points[nose][0]);
    let scaled = |p: &[f64; 2]| [(p[0] - x0) / chord, p[1] / chord];
    let one: Vec<[f64; 2]> = points[..=nose].iter().rev().map(scaled).collect();
    let other: Vec<[f64; 2]> = points[nose..].iter().map(scaled).collect();
    let rising = |side: &[[f64; 2]]| side.len() >= 3 && side.windows(2).all(|w| w[1][0] > w[0][0]);
    if chord.is_nan() || chord <= 0.0 || !rising(&one) || !rising(&other) {
        return None;
    }
    let mut x: Vec<f64> = one.iter().chain(&other).map(|p| p[0]).collect();
    x.sort_by(f64::total_cmp);
    x.dedup_by(|a, b| *a - *b < 1e-12);
    let along = |side: &[[f64; 2]]| x.iter().map(|&x| at(side, x)).collect::<Vec<f64>>();
    let (one, other) = (along(&one), along(&other));
    let is_above = one.iter().sum::<f64>() > other.iter().sum::<f64>();
    let (upper, lower) = if is_above { (one, other) } else { (other, one) };
    Some([x, upper, lower])
}

/// Straight between the points of a side; level beyond its end (a side may end a little before the other).
fn at(side: &[[f64; 2]], x: f64) -> f64 {
    let n = side.partition_point(|p| p[0] < x);
    match (n.checked_sub(1).map(|b| side[b]), side.get(n)) {
        (Some(b), Some(a)) => b[1] + (a[1] - b[1]) * (x - b[0]) / (a[0] - b[0]),
        (None, Some(a)) => a[1],
        (b, None) => b.map_or(0.0, |b| b[1]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str, text: &str) -> Result<Airfoil, CaseError> {
        let file = std::env::temp_dir().join(format!("dip-airfoil-{}-{name}", std::process::id()));
        std::fs::write(&file, text).unwrap();
        let read = Airfoil::read(&file);
        std::fs::remove_file(&file).unwrap();
        read
    }

    #[test]
    fn all_forms_of_one_section_are_the_same() {
        let x = [0.0, 0.25, 0.5, 1.0];
        let (upper, lower) = ([0.0, 0.06, 0.05, 0.0], [0.0, -0.02, -0.01, 0.0]);
        let named = read(
            "named.csv",
            "# a comment\nx,upper,lower\n0,0,0\n0.25,0.06,-0.02\n0.5,0.05,-0.01\n1,0,0\n",
        )
        .unwrap();
        assert_eq!(
            (named.x, named.upper, named.lower),
            (x.to_vec(), upper.to_vec(), lower.to_vec())
        );
        for (name, text) in [
            ("three.dat", "Section\n0 0 0\n0.25 0.06 -0.02\n0.5 0.05 -0.01\n1 0 0\n"),
            (
                "loop.dat",
                "NACA nothing\n1.0 0.0\n0.5  0.05\n.25 0.06\n0 0\n0.25 -0.02\n0.5 -0.01\n1 0\n",
            ),
            // From the lower side, twice the size and set aft by 3.
            ("other.dat", "x,z\n5,0\n4,-0.02\n3.5,-0.04\n3,0\n3.5,0.12\n4,0.1\n5,0\n"),
        ] {
            let airfoil = read(name, text).unwrap();
            assert_eq!(airfoil.x, x, "{name}");
            for k in 0..4 {
                assert!(
                    (airfoil.upper[k] - upper[k]).abs() < 1e-15 && (airfoil.lower[k] - lower[k]).abs() < 1e-15,
                    "{name}"
                );
            }
        }
        let half = read("half.dat", "0 0\n0.4 0.05\n1 0\n").unwrap();
        assert_eq!((half.upper[1], half.lower[1]), (0.05, -0.05));
        let named = read("half.csv", "x,half_thickness\n0,0\n0.4,0.05\n1,0\n").unwrap();
        assert_eq!(half, named);
    }

    #[test]
    fn sides_with_other_stations_are_joined() {
        let airfoil = read("sides.dat", "1 0\n0.5 0.05\n0 0\n0.25 -0.02\n1 0\n").unwrap();
        assert_eq!(airfoil.x, [0.0, 0.25, 0.5, 1.0]);
        assert!((airfoil.upper[1] - 0.025).abs() < 1e-15 && (airfoil.lower[2] + 0.02 * 2.0 / 3.0).abs() < 1e-15);
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, what) in [
            ("title\n1 0\n0.5 0.05\nnonsense\n", ":4: needed 2 numbers"),
            ("1 0\n0.5 nan\n", ":2: needed 2 numbers"),
            ("1 0 0 0\n", ":1: needed two or three numbers"),
            ("1 0\n0.2 0.1\n0.4 0.1\n0 0\n0.5 -0.1\n1 0\n", "round the nose"),
            ("x,half_thickness\n0,0\n0.5,0.1\n0.9,0\n", "from 0 to 1"),
            ("", "three or more"),
        ] {
            let error = read("wrong.dat", text).unwrap_err().to_string();
            assert!(error.contains(what), "{text:?}: {error}");
        }
    }
}
