//! First harmonics of loads and pressures over the last whole cycle, per unit of the motion.
//!
//! A quantity is Re(A e^{i omega t}) of a motion Re(a e^{i omega t}); what is given is A/a: the real part is in phase
//! with the motion (formulation.md, section 1). Samples are evenly spread over one cycle, so that the sums are exact.

use dip_pmb::loads::WallPatch;
use num_complex::Complex;

/// `2/n sum x_j e^{-i 2 pi j/n}` over one cycle.
pub fn first(samples: impl ExactSizeIterator<Item = f64>) -> Complex<f64> {
    let n = samples.len() as f64;
    samples
        .enumerate()
        .map(|(j, x)| Complex::from_polar(x * 2.0 / n, -std::f64::consts::TAU * j as f64 / n))
        .sum()
}

/// Mean and first harmonic per unit of the motion.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Harmonic {
    /// Mean over the cycle.
    pub mean: f64,
    /// Part in phase with the motion, per radian, metre or 1.
    pub real: f64,
    /// Part a quarter of a cycle ahead of it.
    pub imaginary: f64,
}

/// Of a coefficient over one cycle.
pub fn of(samples: &[f64], motion: &[f64]) -> Harmonic {
    let ratio = first(samples.iter().copied()) / first(motion.iter().copied());
    Harmonic {
        mean: samples.iter().sum::<f64>() / samples.len().max(1) as f64,
        real: ratio.re,
        imaginary: ratio.im,
    }
}

/// Walls whose pressure coefficient is the real, and the imaginary, part of the first harmonic per unit of motion.
pub fn walls(cycle: &[Vec<WallPatch>], motion: &[f64]) -> Option<[Vec<WallPatch>; 2]> {
    let last = cycle.last()?;
    let unit = first(motion.iter().copied());
    let mut parts = [last.clone(), last.clone()];
    for (w, wall) in last.iter().enumerate() {
        for face in 0..wall.cp.len() {
            let ratio = first(cycle.iter().map(|walls| walls[w].cp[face])) / unit;
            parts[0][w].cp[face] = ratio.re;
            parts[1][w].cp[face] = ratio.im;
        }
    }
    Some(parts)
}

#[cfg(test)]
mod tests {
    use super::of;

    #[test]
    fn phase_is_counted_from_the_motion_whatever_its_own() {
        let n = 40;
        for phase in [0.0, 0.7, std::f64::consts::FRAC_PI_2] {
            let at = |lead: f64, size: f64| -> Vec<f64> {
                (0..n)
                    .map(|j| 0.3 + size * (std::f64::consts::TAU * f64::from(j) / f64::from(n) + phase + lead).sin())
                    .collect()
            };
            let h = of(&at(0.5, 3.0), &at(0.0, 2.0));
            assert!((h.real - 1.5 * 0.5_f64.cos()).abs() < 1e-12 && (h.imaginary - 1.5 * 0.5_f64.sin()).abs() < 1e-12);
            assert!((h.mean - 0.3).abs() < 1e-12);
        }
    }
}
