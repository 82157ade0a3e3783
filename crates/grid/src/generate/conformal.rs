//! Conformal maps from a half plane or strip to the outside of a section: the grid lines of C and O grids.
//!
//! First a closed formula unwraps the section: `Z = Z0 + s^2` (a parabola about a point inside the nose; C grids) or
//! `Z = Zc + f cos s` (confocal ellipses between such a point and the trailing edge; O grids). In the plane of s the
//! section is a gentle curve `Im s = S(Re s)`. Then the half plane Im w > 0 is mapped on the region above that curve by
//! `s = w + i F(w)` with F analytic and `Re F = S` on the edge, found by fixed-point iteration with fast Fourier
//! transforms (Theodorsen, NACA Report 411, 1931, for the circle; for the half plane the circle variable is
//! `d = (L + i w) / (L - i w)`). Lines of constant a = Re w leave the wall at a right angle and never cross: the grid
//! is the solution of Laplace's equations, exactly.

use std::f64::consts::PI;

use num_complex::Complex64;

use super::fourier::Fourier;

/// Points on the circle; the half plane's L below puts half of them within one root chord of the nose.
const POINTS: usize = 4096;

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
    /// Map for a C grid round the unit section `curve(t)`, t from 1 (upper trailing edge) to -1, with a nose of radius
    /// `nose_radius` (0: a plate). The wake leaves the trailing edge and levels off at the height of the nose.
    pub(super) fn c(name: &str, curve: &dyn Fn(f64) -> [f64; 2], nose_radius: f64) -> Result<Self, MapError> {
        let at = |t: f64| complex(curve(t));
        // The focus of a parabola lies half a nose radius inside it.
        let inward = (at(1.0) - at(0.0)).unscale((at(1.0) - at(0.0)).norm());
        let nose = at(0.0) + inward * (0.5 * nose_radius);
        let samples = 4000;
        // Angle of Z - Z0 followed from the nose (pi) both ways; s is its root with half the angle.
        let mut body = Vec::with_capacity(2 * samples + 1);
        for side in [-1.0, 1.0] {
            let mut previous = PI + inward.arg();
            let mut half = Vec::with_capacity(samples + 1);
            for m in 0..=samples {
                let t = m as f64 / samples as f64;
                let r = at(side * t) - nose;
                if m > 0 || r.norm() > 0.0 {
                    let turns = ((previous - r.arg()) / (2.0 * PI)).round();
                    let mut angle = r.arg() + 2.0 * PI * turns;
                    if m == 1 && nose_radius == 0.0 {
                        // A plate: the two sides start at the angles 0 and 2 pi from its edge.
                        angle = r.arg() + if side > 0.0 { 0.0 } else { 2.0 * PI };
                    }
                    previous = angle;
                    let s = Complex64::from_polar(r.norm().sqrt(), 0.5 * angle);
                    half.push([s.re, s.im]);
                } else {
                    half.push([0.0, 0.0]);
                }
            }
            if side < 0.0 {
                half.reverse();
                half.pop();
            }
            body.append(&mut half);
        }
        let straight = body.iter().all(|p| p[1].abs() < 1e-14);
        let last = body[body.len() - 1][0];
        let (drop, tail) = (at(1.0).im - nose.im, at(1.0).re);
        let table = Table::new(body);
        let height = |s: f64| {
            if s.abs() <= last {
                return table.value(s);
            }
            let beyond = s * s - last * last;
            0.5 * drop / s * (-beyond).exp()
        };
        let map = Self::solve(name, Wrap::Parabola { nose }, straight, &height)?;
        Ok(Self { drop, tail, ..map })
    }

    /// Map for an O grid round the unit section `curve(t)` with a closed trailing edge.
    pub(super) fn o(name: &str, curve: &dyn Fn(f64) -> [f64; 2], nose_radius: f64) -> Result<Self, MapError> {
        let at = |t: f64| complex(curve(t));
        let inward = (at(1.0) - at(0.0)).unscale((at(1.0) - at(0.0)).norm());
        let nose = at(0.0) + inward * (0.5 * nose_radius);
        let tail = at(1.0);
        let centre = 0.5 * (nose + tail);
        let half_focal = 0.5 * (tail - nose);
        let samples = 8000;
        let mut body = Vec::with_capacity(samples + 1);
        body.push([0.0, 0.0]);
        let mut previous = Complex64::new(0.0, 0.0);
        for m in 1..samples {
            // Re s runs from the trailing edge along the lower surface.
            let angle = 2.0 * PI * m as f64 / samples as f64;
            let t = -(0.5 * angle).cos();
            let principal = ((at(t) - centre) / half_focal).acos();
            // cos s is even and periodic: of all s take the one next to the last point (at first: just beyond 0).
            let guess = if m == 1 {
                Complex64::new(angle, 0.0)
            } else {
                previous + Complex64::new(angle / m as f64, 0.0)
            };
            let nearest = |s: Complex64| s + 2.0 * PI * ((guess.re - s.re) / (2.0 * PI)).round();
            let (p, q) = (nearest(principal), nearest(-principal));
            let s = if (p - guess).norm() <= (q - guess).norm() { p } else { q };
            previous = s;
            body.push([s.re, s.im]);
        }
        body.push([2.0 * PI, 0.0]);
        let straight = body.iter().all(|p| p[1].abs() < 1e-14);
        let table = Table::new(body);
        let height = |s: f64| table.value(s.rem_euclid(2.0 * PI));
        Self::solve(name, Wrap::Ellipse { centre, half_focal }, straight, &height)
    }

    /// Fixed-point iteration `h(a) = S(a - Im F(a))` with `Re F = h` on the edge.
    fn solve(name: &str, wrap: Wrap, straight: bool, height: &dyn Fn(f64) -> f64) -> Result<Self, MapError> {
        let n = POINTS;
        let first = match wrap {
            // Half a step off, so that no point lies at infinity (angle pi).
            Wrap::Parabola { .. } => -PI + PI / n as f64,
            Wrap::Ellipse { .. } => 0.0,
        };
        let angle = |m: usize| first + 2.0 * PI * m as f64 / n as f64;
        let edge = |m: usize| match wrap {
            Wrap::Parabola { .. } => SCALE * (0.5 * angle(m)).tan(),
            Wrap::Ellipse { .. } => angle(m),
        };
        let wall_a: Vec<f64> = (0..n).map(edge).collect();
        if straight {
            return Ok(Self {
                wrap,
                coefficients: Vec::new(),
                drop: 0.0,
                tail: 1.0,
                wall_s: wall_a.clone(),
                wall_a,
            });
        }
        let mut h: Vec<f64> = wall_a.iter().map(|&a| height(a)).collect();
        let mut coefficients = vec![Complex64::default(); n / 2];
        let mut wall_s = wall_a.clone();
        let mut change = f64::INFINITY;
        let fourier = Fourier::new(n);
        for _ in 0..400 {
            let mut x: Vec<Complex64> = h.iter().map(|&v| Complex64::new(v, 0.0)).collect();
            fourier.transform(&mut x, false);
            for (k, c) in coefficients.iter_mut().enumerate() {
                // The analytic function with this real part has twice the coefficients of positive index.
                let twice = if k == 0 { 1.0 } else { 2.0 };
                *c = x[k] * Complex64::cis(-(k as f64) * first) * (twice / n as f64);
            }
            if let Wrap::Parabola { .. } = wrap {
                // F vanishes at infinity (d = -1): the free imaginary constant is a shift along the edge.
                let far: Complex64 = coefficients.iter().rev().fold(Complex64::default(), |sum, c| *c - sum);
                coefficients[0].im -= far.im;
            }
            let mut f = vec![Complex64::default(); n];
            for (k, c) in coefficients.iter().enumerate() {
                f[k] = *c * Complex64::cis(k as f64 * first);
            }
            fourier.transform(&mut f, true);
            change = 0.0;
            for m in 0..n {
                wall_s[m] = wall_a[m] - f[m].im;
                let new = height(wall_s[m]);
                change = f64::max(change, (new - h[m]).abs());
                h[m] += 0.7 * (new - h[m]);
            }
            if change < 1e-13 {
                break;
            }
        }
        if change.is_nan() || change > 1e-9 || wall_s.windows(2).any(|v| v[1] <= v[0]) {
            return Err(MapError {
                name: name.to_owned(),
                change,
            });
        }
        Ok(Self {
            wrap,
            coefficients,
            drop: 0.0,
            tail: 1.0,
            wall_a,
            wall_s,
        })
    }

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

    /// The unwrapped coordinate Re s of the wall point `p`, near `guess`.
    fn unwrapped(&self, p: [f64; 2], guess: f64) -> f64 {
        let z = complex(p);
        match self.wrap {
            Wrap::Parabola { nose } => {
                let s = (z - nose).sqrt();
                if (s.re - guess).abs() <= (-s.re - guess).abs() {
                    s.re
                } else {
                    -s.re
                }
            }
            Wrap::Ellipse { centre, half_focal } => {
                let s = ((z - centre) / half_focal).acos().re;
                let nearest = |s: f64| s + 2.0 * PI * ((guess - s) / (2.0 * PI)).round();
                let (p, q) = (nearest(s), nearest(-s));
                if (p - guess).abs() <= (q - guess).abs() { p } else { q }
            }
        }
    }

    /// The wake of a C grid at x: it leaves the trailing edge and levels off at the height of the nose.
    pub(super) fn wake_point(&self, x: f64) -> [f64; 2] {
        match self.wrap {
            Wrap::Parabola { nose } => [x, nose.im + self.drop * (-(x - self.tail)).exp()],
            Wrap::Ellipse { .. } => [x, 0.0],
        }
    }

    /// a above and below the wake at x.
    pub(super) fn wake_parameter(&self, x: f64) -> [f64; 2] {
        let p = self.wake_point(x);
        let guess = x.max(0.0).sqrt();
        [self.wall_parameter(p, guess), self.wall_parameter(p, -guess)]
    }

    /// a of the wall point `p` at section parameter t (1: upper trailing edge, -1: lower; beyond: the wake).
    pub(super) fn wall_parameter(&self, p: [f64; 2], t: f64) -> f64 {
        let guess = match self.wrap {
            Wrap::Parabola { .. } => t,
            // t = -cos(Re s / 2), see `o`.
            Wrap::Ellipse { .. } => 2.0 * (-t).clamp(-1.0, 1.0).acos(),
        };
        let n = self.wall_s.len();
        let (wanted, turn) = match self.wrap {
            Wrap::Parabola { .. } => (self.unwrapped(p, guess), 0.0),
            Wrap::Ellipse { .. } => {
                // The trailing edge is a branch point of the wrap: Re s is known there, and round-off must not touch it.
                let s = if t.abs() >= 1.0 {
                    guess
                } else {
                    self.unwrapped(p, guess)
                };
                if s > self.wall_s[n - 1] {
                    (s - 2.0 * PI, 2.0 * PI)
                } else {
                    (s, 0.0)
                }
            }
        };
        let at = |a: f64| a - self.correction(Complex64::new(a, 0.0)).im;
        // The table gives a bracket; regula falsi with bisection closes it.
        let m = self.wall_s.partition_point(|&s| s <= wanted);
        let (mut lo, mut hi) = match self.wrap {
            Wrap::Ellipse { .. } => (
                if m == 0 {
                    self.wall_a[n - 1] - 2.0 * PI
                } else {
                    self.wall_a[m - 1]
                },
                self.wall_a[m.min(n - 1)],
            ),
            Wrap::Parabola { .. } if m == 0 => (10.0 * self.wall_a[0], self.wall_a[0]),
            Wrap::Parabola { .. } if m == n => (self.wall_a[n - 1], 10.0 * self.wall_a[n - 1]),
            Wrap::Parabola { .. } => (self.wall_a[m - 1], self.wall_a[m]),
        };
        let (mut below, mut above) = (at(lo) - wanted, at(hi) - wanted);
        let mut a = 0.5 * (lo + hi);
        for turn in 0..60 {
            a = if turn % 3 == 2 {
                0.5 * (lo + hi)
            } else {
                lo - below * (hi - lo) / (above - below)
            };
            if !(a >= lo && a <= hi) {
                a = 0.5 * (lo + hi);
            }
            let error = at(a) - wanted;
            if error.abs() < 1e-14 || hi - lo < 1e-14 * hi.abs().max(1e-3) {
                break;
            }
            if error < 0.0 {
                (lo, below) = (a, error);
            } else {
                (hi, above) = (a, error);
            }
        }
        a + turn
    }
}

fn complex(p: [f64; 2]) -> Complex64 {
    Complex64::new(p[0], p[1])
}

/// A curve through points with rising abscissa: straight in between (thousands of points).
struct Table(Vec<[f64; 2]>);

impl Table {
    fn new(mut points: Vec<[f64; 2]>) -> Self {
        points.dedup_by(|b, a| b[0] <= a[0]);
        Self(points)
    }

    fn value(&self, s: f64) -> f64 {
        let n = self.0.len();
        let m = self.0.partition_point(|p| p[0] <= s).clamp(1, n - 1);
        let (p, q) = (self.0[m - 1], self.0[m]);
        p[1] + (s - p[0]) / (q[0] - p[0]) * (q[1] - p[1])
    }
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
