//! Thickness of an airfoil section along its chord, from a table of ordinates.

use crate::error::WingError;

/// Thickness over chord against x over chord, linear between the points of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Ordinates {
    /// x / c, ascending from 0 to 1.
    x: Vec<f64>,
    /// Full thickness / c.
    t: Vec<f64>,
}

impl Ordinates {
    /// From pairs (x / c, half thickness / c) of a symmetric section.
    ///
    /// # Errors
    /// [`WingError::Ordinates`] when x does not ascend from 0 to 1 or a thickness is negative.
    pub fn symmetric(points: &[[f64; 2]]) -> Result<Self, WingError> {
        let bad = |point: usize, needed, got| Err(WingError::Ordinates { point, needed, got });
        if points.len() < 2 {
            return bad(points.len(), "at least two points", points.len() as f64);
        }
        for (i, p) in points.iter().enumerate() {
            if !(p[1] >= 0.0 && p[1].is_finite()) {
                return bad(i + 1, "a half thickness of at least zero", p[1]);
            }
            let ascending = i == 0 || p[0] > points[i - 1][0];
            if !(p[0].is_finite() && ascending) {
                return bad(i + 1, "x / c that ascends", p[0]);
            }
        }
        let (first, last) = (points[0][0], points[points.len() - 1][0]);
        if first.abs() > 1e-9 {
            return bad(1, "x / c = 0 at the first point", first);
        }
        if (last - 1.0).abs() > 1e-9 {
            return bad(points.len(), "x / c = 1 at the last point", last);
        }
        Ok(Self {
            x: points.iter().map(|p| p[0]).collect(),
            t: points.iter().map(|p| 2.0 * p[1]).collect(),
        })
    }

    /// A section of constant thickness.
    pub fn slab(thickness_over_chord: f64) -> Self {
        Self {
            x: vec![0.0, 1.0],
            t: vec![thickness_over_chord; 2],
        }
    }

    /// Thickness / c at `x` / c (held at the ends outside of 0 to 1).
    pub fn thickness(&self, x: f64) -> f64 {
        let i = self.x.partition_point(|&v| v <= x).clamp(1, self.x.len() - 1);
        let s = ((x - self.x[i - 1]) / (self.x[i] - self.x[i - 1])).clamp(0.0, 1.0);
        self.t[i - 1] + s * (self.t[i] - self.t[i - 1])
    }

    /// Area of the section over the chord squared.
    pub fn area(&self) -> f64 {
        self.x
            .windows(2)
            .zip(self.t.windows(2))
            .map(|(x, t)| 0.5 * (x[1] - x[0]) * (t[0] + t[1]))
            .sum()
    }
}
