//! Modal assurance criterion: how alike two mode shapes are.

use crate::error::TableError;
use crate::modes::Modes;

/// MAC of two real shapes, (a . b)^2 / ((a . a)(b . b)) (Allemang and Brown, IMAC 1982); 0 when one
/// of them is zero. Shapes of different length are compared over the shorter.
pub fn mac(a: &[f64], b: &[f64]) -> f64 {
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(p, q)| p * q).sum::<f64>();
    let norm = dot(a, a) * dot(b, b);
    if norm > 0.0 { dot(a, b).powi(2) / norm } else { 0.0 }
}

impl Modes {
    /// MAC of the displacements along z between all modes of two tables that list the same nodes:
    /// [mode of self][mode of other].
    ///
    /// # Errors
    /// [`TableError::Count`] when the numbers of nodes differ.
    pub fn mac_heave(&self, other: &Self) -> Result<Vec<Vec<f64>>, TableError> {
        if self.nodes.len() != other.nodes.len() {
            return Err(TableError::Count {
                name: "the other table's list of nodes",
                got: other.nodes.len(),
                needed: self.nodes.len(),
            });
        }
        let (a, b) = (self.heave(), other.heave());
        Ok(a.iter().map(|x| b.iter().map(|y| mac(x, y)).collect()).collect())
    }
}
