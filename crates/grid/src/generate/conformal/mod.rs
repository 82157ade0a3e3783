//! Conformal maps from a half plane or strip to the outside of a section: the grid lines of C and O grids.
//!
//! First a closed formula unwraps the section: `Z = Z0 + s^2` (a parabola about a point inside the nose; C grids) or
//! `Z = Zc + f cos s` (confocal ellipses between such a point and the trailing edge; O grids). In the plane of s the
//! section is a gentle curve `Im s = S(Re s)`. Then the half plane Im w > 0 is mapped on the region above that curve by
//! `s = w + i F(w)` with F analytic and `Re F = S` on the edge, found by fixed-point iteration with fast Fourier
//! transforms (Theodorsen, NACA Report 411, 1931, for the circle; for the half plane the circle variable is
//! `d = (L + i w) / (L - i w)`). Lines of constant a = Re w leave the wall at a right angle and never cross: the grid
//! is the solution of Laplace's equations, exactly.
//!
//! `solve` finds the map of a section, `inverse` where a wall point lies in it.

mod inverse;
mod solve;

use num_complex::Complex64;

/// Half of the circle's points lie at |a| < L; a = 1 is the trailing edge of a unit chord.
const SCALE: f64 = 0.7;

/// How the plane of s wraps round the section.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Wrap {
    /// `Z = Z0 + s^2`.
    Parabola { nose: Complex64 },
    /// `Z = Zc + f cos s`.
    Ellipse { centre: Complex64, half_focal: Complex64 },
}

/// A map `w = a + i b -> Z = x + i z`, b = 0 the section (and, in a C grid, the two sides of the wake).
#[derive(Clone, Debug)]
pub(super) struct Conformal {
    wrap: Wrap,
    /// Taylor coefficients of F in d; empty where the curve is straight.
    coefficients: Vec<Complex64>,
    /// Height of the trailing edge above the nose's focus, and its x.
    drop: f64,
    tail: f64,
    /// The wall as Re s against a, both rising: to find a for a wall point.
    wall_a: Vec<f64>,
    wall_s: Vec<f64>,
}

/// Why a section could not be mapped.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
#[error(
    "the map of section {name} did not converge (last change {change:.1e}); it is too thick or too blunt at the nose for this generator"
)]
pub struct MapError {
    /// Name of the section.
    pub name: String,
    /// Largest change of the last iteration.
    pub change: f64,
}

impl Conformal {
    /// Position `[x, z]` of w = a + i b, b >= 0.
    pub(super) fn position(&self, a: f64, b: f64) -> [f64; 2] {
        let w = Complex64::new(a, b);
        let s = w + Complex64::i() * self.correction(w);
        let z = match self.wrap {
            Wrap::Parabola { nose } => nose + s * s,
            Wrap::Ellipse { centre, half_focal } => centre + half_focal * s.cos(),
        };
        [z.re, z.im]
    }

    /// F(w).
    fn correction(&self, w: Complex64) -> Complex64 {
        if self.coefficients.is_empty() {
            return Complex64::default();
        }
        let d = match self.wrap {
            Wrap::Parabola { .. } => {
                let iw = Complex64::i() * w;
                (SCALE + iw) / (SCALE - iw)
            }
            Wrap::Ellipse { .. } => (Complex64::i() * w).exp(),
        };
        // Terms below 1e-16 do not count; away from the wall that leaves few.
        let size = d.norm();
        let terms = if size < 1.0 {
            (-37.0 / size.ln()).min(1e9) as usize + 2
        } else {
            usize::MAX
        };
        // Horner's rule in d^4 for four interleaved polynomials: their chains of products overlap in the processor.
        let d2 = d * d;
        let d4 = d2 * d2;
        let zero = Complex64::default();
        let mut sums = [zero; 4];
        let (fours, rest) = self.coefficients.as_chunks::<4>();
        debug_assert!(rest.is_empty());
        for four in fours.iter().take(terms.div_ceil(4)).rev() {
            for (sum, c) in sums.iter_mut().zip(four) {
                *sum = *sum * d4 + c;
            }
        }
        sums[0] + d * sums[1] + d2 * (sums[2] + d * sums[3])
    }
}

fn complex(p: [f64; 2]) -> Complex64 {
    Complex64::new(p[0], p[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Section, TrailingEdge};

    fn naca0012() -> Section {
        Section::naca4("0012")
            .unwrap()
            .with_trailing_edge(TrailingEdge::Sharp)
            .unwrap()
    }

    /// The edge of the half plane lies on the section, and the map is conformal (Cauchy-Riemann by differences).
    #[test]
    fn the_edge_is_the_section_and_angles_are_kept() {
        let section = naca0012();
        let curve = |t: f64| section.point(t);
        for map in [
            Conformal::c("0012", &curve, section.nose_radius()).unwrap(),
            Conformal::o("0012", &curve, section.nose_radius()).unwrap(),
        ] {
            for n in 1..40 {
                let t = 0.97 * (n as f64 / 20.0 - 1.0);
                let p = section.point(t);
                let a = map.wall_parameter(p, t);
                let q = map.position(a, 0.0);
                assert!((p[0] - q[0]).hypot(p[1] - q[1]) < 2e-5, "{t} {p:?} {q:?}");
                for b in [0.01, 0.1, 1.0] {
                    let h = 1e-5;
                    let d = |da: f64, db: f64| {
                        let (p, q) = (map.position(a + da, b + db), map.position(a - da, b - db));
                        [(p[0] - q[0]) / (2.0 * h), (p[1] - q[1]) / (2.0 * h)]
                    };
                    let (da, db) = (d(h, 0.0), d(0.0, h));
                    let size = da[0].hypot(da[1]);
                    assert!((da[0] - db[1]).abs() < 1e-5 * size && (da[1] + db[0]).abs() < 1e-5 * size);
                }
            }
        }
    }

    /// A Joukowski section has its map in closed form: with `Z = q + 1/q` the lines b = const are the circles
    /// `|q + e| = (1 + e) exp(b)`.
    #[test]
    fn a_joukowski_section_maps_to_its_circles() {
        let e = 0.08;
        let nose = -(1.0 + 2.0 * e) - 1.0 / (1.0 + 2.0 * e);
        let chord = 2.0 - nose;
        let curve = |t: f64| {
            let q = -e + Complex64::from_polar(1.0 + e, 2.0 * t.acos());
            let z = (q + q.inv() - nose) / chord;
            [z.re, z.im]
        };
        let step = 1e-4;
        let slope = curve(step)[1] / (curve(step)[0] - curve(0.0)[0]).sqrt();
        let map = Conformal::o("Joukowski", &curve, 0.5 * slope * slope).unwrap();
        for b in [0.0, 1e-4, 0.02, 0.3, 2.0] {
            for n in 0..16 {
                let [x, z] = map.position(0.2 + n as f64 * 0.38, b);
                let z = Complex64::new(x, z) * chord + nose;
                let root = (z * z - 4.0).sqrt();
                let size = |q: Complex64| (q + e).norm() / (1.0 + e);
                let found = size(0.5 * (z + root)).max(size(0.5 * (z - root))).ln();
                assert!((found - b).abs() < 3e-6, "{n} {b} {found}");
            }
        }
    }
}
