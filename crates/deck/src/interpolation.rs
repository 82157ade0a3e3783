//! Nastran's interpolation of aerodynamics in the K and KE methods.
//!
//! IMETH L is a natural cubic spline through the complex Q itself over reduced frequency (not through Im Q / k, and not
//! mirrored at k = 0, as in PK), IMETH S a plate spline over Mach number and reduced frequency. Both are sums of radial functions
//! with a linear part; beyond the last point they go on as a straight line (L) or as the plate does (S). NASTRAN-95 builds
//! them with the routines of its splines (modules FA1, MINTRP); MSC's printed roots follow from the same formula to all
//! digits (`docs/validation/deck`).

use dip_dlm::c64;
use dip_flutter::{FlutterError, KDomain};
use faer::{
    Mat, MatMut,
    linalg::solvers::{FullPivLu, Solve},
};

use crate::aerodynamics::GeneralizedForces;

/// Radial function and linear part of an interpolation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spline {
    /// |k - k_j|^3 and 1, k: the natural cubic spline.
    Cubic,
    /// r^2 ln r^2 with r^2 = (M - M_j)^2 + (k - k_j)^2, and 1, M, k: the infinite plate.
    Plate,
}

/// Q at one Mach number as a function of k.
#[derive(Debug, Clone)]
pub struct RadialForces {
    spline: Spline,
    mach: f64,
    /// Mach number and reduced frequency of each matrix.
    places: Vec<(f64, f64)>,
    q: Vec<Mat<c64>>,
    /// Inverse of the spline's matrix, its first columns: [function][matrix].
    weights: Mat<f64>,
}

impl RadialForces {
    /// The interpolation of `forces` at Mach number `mach`; for [`Spline::Cubic`] all of one Mach number.
    ///
    /// None if the points do not determine it (plate: all on one line).
    pub fn new(spline: Spline, mach: f64, forces: &[&GeneralizedForces]) -> Option<Self> {
        let places: Vec<(f64, f64)> = forces.iter().map(|f| (f.mach, f.k)).collect();
        let n = places.len();
        let linear = linear_terms(spline, (0.0, 0.0))
            .len()
            .min(if spline == Spline::Cubic { n } else { usize::MAX });
        let size = n + linear;
        let a = Mat::from_fn(size, size, |i, j| match (i < n, j < n) {
            (true, true) => radial(spline, places[i], places[j]),
            (true, false) => linear_terms(spline, places[i])[j - n],
            (false, true) => linear_terms(spline, places[j])[i - n],
            (false, false) => 0.0,
        });
        let lu = FullPivLu::new(a.as_ref());
        let pivots: Vec<f64> = (0..size).map(|i| lu.U()[(i, i)].abs()).collect();
        let largest = pivots.iter().copied().fold(0.0, f64::max);
        if n == 0 || pivots.iter().any(|p| p.is_nan() || *p <= 1e-14 * largest) {
            return None;
        }
        let weights = lu.solve(&Mat::from_fn(size, n, |i, j| if i == j { 1.0 } else { 0.0 }));
        let q = forces
            .iter()
            .map(|f| Mat::from_fn(f.q.rows(), f.q.columns(), |i, j| f.q[(i, j)]))
            .collect();
        Some(Self {
            spline,
            mach,
            places,
            q,
            weights,
        })
    }

    /// Share of each matrix in Q(k).
    fn shares(&self, k: f64) -> Vec<f64> {
        let n = self.places.len();
        let at = (self.mach, k);
        let linear = linear_terms(self.spline, at);
        (0..n)
            .map(|j| {
                let curved: f64 = (0..n)
                    .map(|i| radial(self.spline, at, self.places[i]) * self.weights[(i, j)])
                    .sum();
                let straight: f64 = (n..self.weights.nrows())
                    .map(|i| linear[i - n] * self.weights[(i, j)])
                    .sum();
                curved + straight
            })
            .collect()
    }
}

fn radial(spline: Spline, a: (f64, f64), b: (f64, f64)) -> f64 {
    match spline {
        Spline::Cubic => (a.1 - b.1).abs().powi(3) / 12.0,
        Spline::Plate => {
            let r2 = (a.0 - b.0).powi(2) + (a.1 - b.1).powi(2);
            if r2 > 0.0 { r2 * r2.ln() } else { 0.0 }
        }
    }
}

fn linear_terms(spline: Spline, (mach, k): (f64, f64)) -> Vec<f64> {
    match spline {
        Spline::Cubic => vec![1.0, k],
        Spline::Plate => vec![1.0, mach, k],
    }
}

impl dip_flutter::GeneralizedForces for RadialForces {
    fn modes(&self) -> usize {
        self.q[0].nrows()
    }

    fn domain(&self) -> KDomain {
        let (minimum, maximum) = self
            .places
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(low, high), p| (low.min(p.1), high.max(p.1)));
        KDomain { minimum, maximum }
    }

    fn q(&self, k: f64, mut q: MatMut<'_, c64>) -> Result<(), FlutterError> {
        let shares = self.shares(k);
        for j in 0..self.modes() {
            for i in 0..self.modes() {
                q[(i, j)] = self.q.iter().zip(&shares).map(|(m, share)| m[(i, j)] * *share).sum();
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use dip_dlm::ComplexMatrix;
    use dip_flutter::GeneralizedForces as _;

    use super::*;

    fn entry(mach: f64, k: f64, value: f64) -> GeneralizedForces {
        GeneralizedForces {
            mach,
            k,
            q: ComplexMatrix::from_fn(1, 1, |_, _| c64::new(value, 2.0 * value)),
        }
    }

    fn at(forces: &RadialForces, k: f64) -> c64 {
        let mut q = Mat::zeros(1, 1);
        forces.q(k, q.as_mut()).unwrap();
        q[(0, 0)]
    }

    #[test]
    fn the_cubic_spline_is_natural_and_goes_on_straight() {
        let data = [
            entry(0.5, 0.1, 1.0),
            entry(0.5, 0.3, 2.0),
            entry(0.5, 0.6, -1.0),
            entry(0.5, 1.0, 0.5),
        ];
        let list: Vec<_> = data.iter().collect();
        let forces = RadialForces::new(Spline::Cubic, 0.5, &list).unwrap();
        for d in &data {
            assert!((at(&forces, d.k) - d.q[(0, 0)]).norm() < 1e-12);
        }
        let second = |k: f64| (at(&forces, k + 0.1) - 2.0 * at(&forces, k) + at(&forces, k - 0.1)).norm();
        assert!(second(1.5) < 1e-10 && second(-0.5) < 1e-10 && second(0.5) > 1e-3);
    }

    #[test]
    fn a_plane_over_mach_and_k_is_reproduced_and_a_line_is_refused() {
        let plane = |m: f64, k: f64| 1.0 + 2.0 * m - 3.0 * k;
        let data: Vec<_> = [(0.3, 0.1), (0.3, 0.9), (0.6, 0.2), (0.8, 0.7)]
            .iter()
            .map(|(m, k)| entry(*m, *k, plane(*m, *k)))
            .collect();
        let list: Vec<_> = data.iter().collect();
        let forces = RadialForces::new(Spline::Plate, 0.5, &list).unwrap();
        assert!((at(&forces, 0.4).re - plane(0.5, 0.4)).abs() < 1e-12);
        let line = [entry(0.5, 0.1, 1.0), entry(0.5, 0.2, 1.0), entry(0.5, 0.4, 1.0)];
        assert!(RadialForces::new(Spline::Plate, 0.5, &line.iter().collect::<Vec<_>>()).is_none());
    }

    #[test]
    fn one_point_is_a_constant() {
        let data = entry(0.5, 0.1, 1.5);
        let forces = RadialForces::new(Spline::Cubic, 0.5, &[&data]).unwrap();
        assert!((at(&forces, 7.0).re - 1.5).abs() < 1e-14);
    }
}
