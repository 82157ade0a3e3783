//! Force weighting: lift and moment of every strip matched with the least change of its pressures.
//!
//! After Giesing, Kalman and Rodden (AFFDL-TR-76): pressures are multiplied by 1 + eps box by box, and of all eps that
//! give a strip its lift and moment the one with the least sum of area |eps|^2 is taken,
//! eps = C^H (C W^-1 C^H)^-1 r over the areas, C = [area p; area x p], r what is missing.

use super::{Diagonal, Limits, Treatment};
use dip_dlm::c64;
use dip_dlm::lattice::Lattice;

/// Weights on the pressures that give every strip of `linear` the lift and moment of `target`, both `[box]`.
pub(crate) fn match_strips(lattice: &Lattice, target: &[c64], linear: &[c64], limits: Limits) -> Diagonal {
    let n = lattice.n_boxes();
    let (zero, one) = (c64::new(0.0, 0.0), c64::new(1.0, 0.0));
    let mut result = Diagonal {
        ratio: vec![one; n],
        remainder: vec![zero; n],
        treatment: vec![Treatment::Ratio; n],
    };
    for strip in lattice.strips() {
        let range = strip.first..strip.first + strip.count;
        let boxes = &lattice.boxes()[range.clone()];
        let area: Vec<f64> = boxes.iter().map(|b| b.area).collect();
        let total: f64 = area.iter().sum();
        // Arms about the strip's middle, over its length: lift and moment of one size.
        let middle = boxes.iter().zip(&area).map(|(b, a)| b.force_point[0] * a).sum::<f64>() / total;
        let length: f64 = boxes.iter().map(|b| b.chord).sum();
        let arm: Vec<f64> = boxes.iter().map(|b| (b.force_point[0] - middle) / length).collect();
        let loads = |p: &[c64]| -> [c64; 2] {
            let mut sums = [zero, zero];
            for ((p, a), x) in p.iter().zip(&area).zip(&arm) {
                sums[0] += p * *a;
                sums[1] += p * (a * x);
            }
            sums
        };
        let (want, have) = (loads(&target[range.clone()]), loads(&linear[range.clone()]));
        let missing = [want[0] - have[0], want[1] - have[1]];
        let change = least(&linear[range.clone()], &area, &arm, missing).unwrap_or_else(|| vec![zero; strip.count]);
        let largest = change.iter().fold(0.0_f64, |m, e| m.max(e.norm()));
        let cut = if largest > limits.bound {
            limits.bound / largest
        } else {
            1.0
        };
        let corrected: Vec<c64> = linear[range.clone()]
            .iter()
            .zip(&change)
            .map(|(p, e)| p * (one + e * cut))
            .collect();
        let have = loads(&corrected);
        let left = [want[0] - have[0], want[1] - have[1]];
        let size = have[0].norm() + have[1].norm() + want[0].norm() + want[1].norm();
        let whole = left[0].norm() + left[1].norm() <= 1e-12 * size;
        let treatment = match (whole, cut < 1.0) {
            (true, _) => Treatment::Ratio,
            (false, true) => Treatment::Bounded,
            (false, false) => Treatment::Additive,
        };
        // What is left, as the least additive pressure.
        let extra = if whole {
            vec![zero; strip.count]
        } else {
            least(&vec![one; strip.count], &area, &arm, left).unwrap_or_else(|| vec![left[0] / total; strip.count])
        };
        for (i, at) in range.enumerate() {
            result.ratio[at] = one + change[i] * cut;
            result.remainder[at] = extra[i];
            result.treatment[at] = treatment;
        }
    }
    result
}

/// The eps of least sum of area |eps|^2 with sum area p eps = r0 and sum area arm p eps = r1; none where the strip can't do it.
fn least(p: &[c64], area: &[f64], arm: &[f64], r: [c64; 2]) -> Option<Vec<c64>> {
    // Gram matrix of C over the areas: real, since |p|^2 is.
    let (mut g00, mut g01, mut g11) = (0.0, 0.0, 0.0);
    for ((p, a), x) in p.iter().zip(area).zip(arm) {
        let w = a * p.norm_sqr();
        g00 += w;
        g01 += w * x;
        g11 += w * x * x;
    }
    let determinant = g00 * g11 - g01 * g01;
    if p.len() == 1 && g00 > 0.0 {
        // One box: its lift only.
        return Some(vec![r[0] / (p[0] * area[0])]);
    }
    if determinant.is_nan() || determinant <= 1e-10 * g00 * g11 {
        return None;
    }
    let l0 = (r[0] * g11 - r[1] * g01) / determinant;
    let l1 = (r[1] * g00 - r[0] * g01) / determinant;
    Some(p.iter().zip(arm).map(|(p, x)| p.conj() * (l0 + l1 * *x)).collect())
}
