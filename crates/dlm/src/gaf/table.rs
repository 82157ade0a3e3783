//! A table of Q over Mach number and reduced frequency, and its file.

use serde::{Deserialize, Serialize};

use super::{Interpolation, KInterpolant};
use crate::c64;
use crate::kernel::{IntegralSum, Kernel, LineFit};
use crate::matrix::ComplexMatrix;

/// What can be wrong with a table of generalized forces.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// k outside the tabulated range.
    #[error(
        "k = {k} lies outside the tabulated reduced frequencies ({low} to {high}): add reduced frequencies to the table"
    )]
    Range {
        /// k asked for.
        k: f64,
        /// Smallest tabulated k.
        low: f64,
        /// Largest tabulated k.
        high: f64,
    },
    /// A Mach number that is not in the table.
    #[error("Mach number {mach} is not in the table (it holds {have:?}): add it to the table")]
    Mach {
        /// Mach number asked for.
        mach: f64,
        /// Mach numbers of the table.
        have: Vec<f64>,
    },
    /// Unusable data.
    #[error("table of generalized forces: {reason}")]
    Data {
        /// What was needed and what was got.
        reason: String,
    },
    /// The file could not be read or written.
    #[error("table of generalized forces, {path}: {source}")]
    File {
        /// Its path.
        path: String,
        /// The system's reason.
        source: std::io::Error,
    },
}

/// Q(M, k) with what it was made from.
#[derive(Clone, Debug, PartialEq)]
pub struct GeneralizedForceTable {
    /// Mach numbers.
    pub mach: Vec<f64>,
    /// Reduced frequencies k = omega b / U.
    pub k: Vec<f64>,
    /// b, in the lattice's length unit.
    pub semichord: f64,
    /// [`crate::lattice::Lattice::geometry_hash`] of the lattice.
    pub geometry_hash: u128,
    /// Kernel used.
    pub kernel: Kernel,
    /// Q `[Mach number][k]`, each `[row = force mode][column = displacement mode]`.
    pub q: Vec<Vec<ComplexMatrix>>,
}

const FORMAT: &str = "dip generalized aerodynamic forces";
const VERSION: u32 = 1;

#[derive(Serialize, Deserialize)]
struct Written {
    format: String,
    version: u32,
    definition: String,
    mach: Vec<f64>,
    reduced_frequency: Vec<f64>,
    semichord: f64,
    geometry_hash: String,
    line_fit: String,
    integral_sum: String,
    n_modes: usize,
    /// [Mach][k][row][column][re, im]
    q: Vec<Vec<Vec<Vec<[f64; 2]>>>>,
}

impl GeneralizedForceTable {
    /// Number of modes.
    pub fn n_modes(&self) -> usize {
        self.q.first().and_then(|q| q.first()).map_or(0, ComplexMatrix::rows)
    }

    /// Q of a tabulated Mach number as a function of k. Mach numbers are not interpolated.
    ///
    /// # Errors
    /// The Mach number is not in the table, or the data are unusable.
    pub fn at_mach(&self, mach: f64, how: Interpolation) -> Result<KInterpolant, TableError> {
        let index = self
            .mach
            .iter()
            .position(|m| (m - mach).abs() <= 1e-9)
            .ok_or_else(|| TableError::Mach {
                mach,
                have: self.mach.clone(),
            })?;
        KInterpolant::new(&self.k, &self.q[index], how)
    }

    /// The table as JSON text (numbers round-trip exactly).
    ///
    /// # Errors
    /// A number that is not finite.
    pub fn to_json(&self) -> Result<String, TableError> {
        let bad = |reason: String| TableError::Data { reason };
        if self.q.iter().flatten().any(|m| !m.is_finite()) {
            return Err(bad("Q holds a number that is not finite and cannot be written".into()));
        }
        let written = Written {
            format: FORMAT.into(),
            version: VERSION,
            definition: "force on mode i = dynamic pressure * Q[i][j] * amplitude of mode j; k = omega semichord / U"
                .into(),
            mach: self.mach.clone(),
            reduced_frequency: self.k.clone(),
            semichord: self.semichord,
            geometry_hash: format!("{:032x}", self.geometry_hash),
            line_fit: match self.kernel.fit {
                LineFit::Parabolic => "parabolic",
                LineFit::Quartic => "quartic",
            }
            .into(),
            integral_sum: match self.kernel.integrals {
                IntegralSum::Laschka11 => "laschka-11",
                IntegralSum::Desmarais12 => "desmarais-12",
            }
            .into(),
            n_modes: self.n_modes(),
            q: self
                .q
                .iter()
                .map(|per_k| {
                    per_k
                        .iter()
                        .map(|m| {
                            (0..m.rows())
                                .map(|i| (0..m.columns()).map(|j| [m[(i, j)].re, m[(i, j)].im]).collect())
                                .collect()
                        })
                        .collect()
                })
                .collect(),
        };
        serde_json::to_string(&written).map_err(|e| bad(e.to_string()))
    }

    /// Reads what [`GeneralizedForceTable::to_json`] wrote.
    ///
    /// # Errors
    /// Not such a file, another version, or sizes that do not fit.
    pub fn from_json(text: &str) -> Result<Self, TableError> {
        let bad = |reason: String| TableError::Data { reason };
        let w: Written = serde_json::from_str(text).map_err(|e| bad(e.to_string()))?;
        if w.format != FORMAT || w.version != VERSION {
            return Err(bad(format!(
                "\"{FORMAT}\" version {VERSION} needed, got \"{}\" version {}",
                w.format, w.version
            )));
        }
        let n = w.n_modes;
        let fits = w.q.len() == w.mach.len()
            && w.q.iter().all(|per_k| {
                per_k.len() == w.reduced_frequency.len()
                    && per_k.iter().all(|m| m.len() == n && m.iter().all(|row| row.len() == n))
            });
        if !fits {
            return Err(bad(format!(
                "Q must be [{} Mach numbers][{} k][{n}][{n}]",
                w.mach.len(),
                w.reduced_frequency.len()
            )));
        }
        let kernel = Kernel {
            fit: match w.line_fit.as_str() {
                "parabolic" => LineFit::Parabolic,
                "quartic" => LineFit::Quartic,
                other => return Err(bad(format!("line_fit must be parabolic or quartic, got {other}"))),
            },
            integrals: match w.integral_sum.as_str() {
                "laschka-11" => IntegralSum::Laschka11,
                "desmarais-12" => IntegralSum::Desmarais12,
                other => {
                    return Err(bad(format!(
                        "integral_sum must be laschka-11 or desmarais-12, got {other}"
                    )));
                }
            },
        };
        let q =
            w.q.iter()
                .map(|per_k| {
                    per_k
                        .iter()
                        .map(|m| ComplexMatrix::from_fn(n, n, |i, j| c64::new(m[i][j][0], m[i][j][1])))
                        .collect()
                })
                .collect();
        Ok(Self {
            mach: w.mach,
            k: w.reduced_frequency,
            semichord: w.semichord,
            geometry_hash: u128::from_str_radix(&w.geometry_hash, 16).map_err(|e| bad(e.to_string()))?,
            kernel,
            q,
        })
    }

    /// Writes the table.
    ///
    /// # Errors
    /// Numbers that are not finite, or the system's.
    pub fn save(&self, path: &std::path::Path) -> Result<(), TableError> {
        std::fs::write(path, self.to_json()?).map_err(|source| TableError::File {
            path: path.display().to_string(),
            source,
        })
    }

    /// Reads a table.
    ///
    /// # Errors
    /// The system's, or as [`GeneralizedForceTable::from_json`].
    pub fn load(path: &std::path::Path) -> Result<Self, TableError> {
        let text = std::fs::read_to_string(path).map_err(|source| TableError::File {
            path: path.display().to_string(),
            source,
        })?;
        Self::from_json(&text)
    }
}
