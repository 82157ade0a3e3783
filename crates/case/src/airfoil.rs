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
    /// Reads a CSV file with columns `x` and `half_thickness`, or `x`, `upper` and `lower`, all over the chord.
    ///
    /// # Errors
    /// Missing columns, stations that do not increase from 0 to 1, an upper side below the lower one.
    pub fn read(file: &Path) -> Result<Self, CaseError> {
        let table = Table::read(file)?;
        let x = table.numbers("x")?;
        let (upper, lower) = if table.has("half_thickness") {
            let half = table.numbers("half_thickness")?;
            let lower = half.iter().map(|t| -t).collect();
            (half, lower)
        } else {
            (table.numbers("upper")?, table.numbers("lower")?)
        };
        let wrong = |message: &str| {
            let help = "give ordinates over the chord, from the leading edge (0) to the trailing edge (1)".to_owned();
            CaseError::new(format!("{}: {message}", file.display()), Some(help))
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
