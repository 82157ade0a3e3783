//! Weights: what has to be done to the linear lattice so that the reference motion gives the reference pressures.
//!
//! Every weight is found so that, for the reference motion at the recorded frequency,
//!
//! ```text
//! ratio x linear + remainder = target          box by box, exactly
//! ```
//!
//! with the remainder zero wherever a plain ratio is safe. Where the linear value is small against the rest, the ratio stays 1
//! and the difference is additive; where the ratio would leave the bound, it is cut off there and the rest is additive.
//! The additive part belongs to the reference motion: another motion gets it by its share of the reference downwash.

pub(crate) mod force;
pub(crate) mod garner;
pub mod schedule;

use dip_dlm::c64;
use serde::{Deserialize, Serialize};

/// When a plain ratio is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Largest |ratio - 1| of a box.
    pub bound: f64,
    /// Least |linear| of a box over the root mean square of all boxes for a ratio to be taken.
    pub least: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            bound: 10.0,
            least: 0.02,
        }
    }
}

/// What was done in a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Treatment {
    /// The plain ratio.
    Ratio,
    /// The linear value is small: additive.
    Additive,
    /// The ratio would be out of bounds: cut off, the rest additive.
    Bounded,
}

/// A weight for every box, with what the ratio can't carry.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagonal {
    /// Factors `[box]`.
    pub ratio: Vec<c64>,
    /// Additive part for the reference motion `[box]`, in the unit of what is weighted.
    pub remainder: Vec<c64>,
    /// What was done `[box]`.
    pub treatment: Vec<Treatment>,
}

/// Root mean square weighted by area.
pub(crate) fn rms(values: &[c64], area: &[f64]) -> f64 {
    let total: f64 = area.iter().sum();
    let sum: f64 = values.iter().zip(area).map(|(v, a)| v.norm_sqr() * a).sum();
    (sum / total).sqrt()
}

impl Diagonal {
    /// Ratios target / linear around `base` (1 for a factor on the linear value itself, 0 for a gain from another quantity).
    pub(crate) fn new(target: &[c64], linear: &[c64], base: f64, area: &[f64], limits: Limits) -> Self {
        let (base, size) = (c64::new(base, 0.0), rms(linear, area));
        let n = target.len();
        let mut diagonal = Self {
            ratio: Vec::with_capacity(n),
            remainder: Vec::with_capacity(n),
            treatment: Vec::with_capacity(n),
        };
        // A gain is bounded by what it does: against the largest pressures, not against 1.
        let scale = if base.re == 0.0 {
            (rms(target, area) / size.max(f64::MIN_POSITIVE)).max(1.0)
        } else {
            1.0
        };
        for (&target, &linear) in target.iter().zip(linear) {
            let (ratio, treatment) = if linear.norm() <= limits.least * size {
                (base, Treatment::Additive)
            } else {
                let ratio = target / linear;
                let away = (ratio - base).norm();
                if away <= limits.bound * scale {
                    (ratio, Treatment::Ratio)
                } else {
                    (
                        base + (ratio - base) * (limits.bound * scale / away),
                        Treatment::Bounded,
                    )
                }
            };
            let remainder = if treatment == Treatment::Ratio {
                c64::new(0.0, 0.0)
            } else {
                target - ratio * linear
            };
            diagonal.ratio.push(ratio);
            diagonal.remainder.push(remainder);
            diagonal.treatment.push(treatment);
        }
        diagonal
    }

    /// The same with real parts only: a weight for all frequencies from one at a low frequency.
    pub(crate) fn real(&self) -> Self {
        let real = |list: &[c64]| list.iter().map(|z| c64::new(z.re, 0.0)).collect();
        Self {
            ratio: real(&self.ratio),
            remainder: real(&self.remainder),
            treatment: self.treatment.clone(),
        }
    }

    /// Number of boxes that did not get the plain ratio.
    #[must_use]
    pub fn treated(&self) -> usize {
        self.treatment.iter().filter(|t| **t != Treatment::Ratio).count()
    }
}
