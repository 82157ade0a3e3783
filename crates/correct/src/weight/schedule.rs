//! Weights between, below and beyond the recorded reduced frequencies.
//!
//! A weight is the transfer function of a real system: its real part is even and its imaginary part odd in k. So between two
//! recordings Re W and (Im W) / k are interpolated, straight in k; below the first one both keep their values (the
//! imaginary part goes to zero with k); beyond the last one W goes over to the linear lattice,
//!
//! ```text
//! W(k) = base + s (W(k_last) - base),   s = (1 + cos(pi t)) / 2,   t = (k - k_last) / ((blend - 1) k_last)
//! ```
//!
//! and is the linear lattice from blend k_last on. [`Place`] says which of these a result rests on.

use dip_dlm::c64;
use serde::{Deserialize, Serialize};

/// What a weight at some k rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// On or between recordings.
    Recorded,
    /// Below the first recording: held.
    Below,
    /// Beyond the last recording: going over to the linear lattice.
    Blended,
    /// So far beyond the last recording that it is the linear lattice.
    Linear,
}

/// Recorded reduced frequencies and the rule beyond them.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// Recorded k, rising.
    k: Vec<f64>,
    /// Multiple of the last k from which on the lattice is linear.
    blend: f64,
}

/// Part of one recording in a weight, for the real and for the imaginary part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Share {
    pub(crate) record: usize,
    pub(crate) re: f64,
    pub(crate) im: f64,
}

impl Schedule {
    /// `k` rising, at least one; `blend` above 1.
    pub(crate) fn new(k: Vec<f64>, blend: f64) -> Self {
        Self { k, blend }
    }

    /// Recorded reduced frequencies, rising.
    #[must_use]
    pub fn recorded(&self) -> &[f64] {
        &self.k
    }

    fn last(&self) -> f64 {
        self.k.last().copied().unwrap_or(0.0)
    }

    /// Largest k at which the recordings still have a say.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.blend * self.last()
    }

    /// What a weight at `k` rests on.
    #[must_use]
    pub fn place(&self, k: f64) -> Place {
        let (first, last) = (self.k.first().copied().unwrap_or(0.0), self.last());
        if k < first * (1.0 - 1e-9) {
            Place::Below
        } else if k <= last * (1.0 + 1e-9) {
            Place::Recorded
        } else if k < self.end() {
            Place::Blended
        } else {
            Place::Linear
        }
    }

    /// Part of the correction that is left at `k`: 1 up to the last recording, 0 from the end of the blending on.
    #[must_use]
    pub fn strength(&self, k: f64) -> f64 {
        match self.place(k) {
            Place::Recorded | Place::Below => 1.0,
            Place::Linear => 0.0,
            Place::Blended => {
                let t = (k - self.last()) / (self.end() - self.last());
                0.5 * (1.0 + (std::f64::consts::PI * t).cos())
            }
        }
    }

    /// Recordings that make the weight at `k`.
    pub(crate) fn shares(&self, k: f64) -> Vec<Share> {
        let n = self.k.len();
        let exact = self.k.iter().position(|r| (k - r).abs() <= 1e-12 * r.max(1e-300));
        if let Some(record) = exact {
            return vec![Share {
                record,
                re: 1.0,
                im: 1.0,
            }];
        }
        let upper = self.k.partition_point(|r| *r < k);
        if upper == 0 {
            return vec![Share {
                record: 0,
                re: 1.0,
                im: k / self.k[0],
            }];
        }
        if upper == n {
            let s = self.strength(k);
            return vec![Share {
                record: n - 1,
                re: s,
                im: s,
            }];
        }
        let (low, high) = (self.k[upper - 1], self.k[upper]);
        let t = (k - low) / (high - low);
        // At k = 0 the imaginary part over k is not known: that of the first recording above it holds down to zero.
        let (below, above) = if low == 0.0 {
            (0.0, k / high)
        } else {
            ((1.0 - t) * k / low, t * k / high)
        };
        vec![
            Share {
                record: upper - 1,
                re: 1.0 - t,
                im: below,
            },
            Share {
                record: upper,
                re: t,
                im: above,
            },
        ]
    }

    /// The weight at `k` around `base`, from `values[record]`.
    pub(crate) fn mix(&self, k: f64, base: c64, values: impl Fn(usize) -> c64) -> c64 {
        self.shares(k).iter().fold(base, |sum, share| {
            let away = values(share.record) - base;
            sum + c64::new(share.re * away.re, share.im * away.im)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recordings_are_met_and_the_linear_lattice_is_reached_smoothly() {
        let s = Schedule::new(vec![0.1, 0.2], 2.0);
        let value = |r: usize| [c64::new(1.2, 0.3), c64::new(1.4, 0.5)][r];
        let one = c64::new(1.0, 0.0);
        assert_eq!(s.mix(0.1, one, value), value(0));
        assert_eq!(s.mix(0.2, one, value), value(1));
        let below = s.mix(0.05, one, value);
        assert!((below - c64::new(1.2, 0.15)).norm() < 1e-15);
        assert!((s.mix(0.2 + 1e-7, one, value) - value(1)).norm() < 1e-6);
        assert!((s.mix(0.4 - 1e-7, one, value) - one).norm() < 1e-6);
        assert_eq!(s.mix(0.41, one, value), one);
        assert_eq!(s.place(0.3), Place::Blended);
        assert_eq!(s.place(0.05), Place::Below);
    }

    #[test]
    fn a_steady_recording_fixes_the_real_part_at_zero() {
        let s = Schedule::new(vec![0.0, 0.2], 2.0);
        let value = |r: usize| [c64::new(1.1, 0.0), c64::new(1.3, 0.4)][r];
        let w = s.mix(0.1, c64::new(1.0, 0.0), value);
        assert!((w - c64::new(1.2, 0.2)).norm() < 1e-15);
    }
}
