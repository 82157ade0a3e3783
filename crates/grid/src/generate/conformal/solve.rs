//! Finds the map of a section: the unwrapped wall as a curve, and the analytic function that has it as its edge.

use std::f64::consts::PI;

use num_complex::Complex64;

use super::super::fourier::Fourier;
use super::{Conformal, MapError, SCALE, Wrap, complex};

/// Points on the circle; the half plane's L below puts half of them within one root chord of the nose.
const POINTS: usize = 4096;

impl Conformal {
    /// Map for a C grid round the unit section `curve(t)`, t from 1 (upper trailing edge) to -1, with a nose of radius
    /// `nose_radius` (0: a plate). The wake leaves the trailing edge and levels off at the height of the nose.
    pub(in crate::generate) fn c(
        name: &str,
        curve: &dyn Fn(f64) -> [f64; 2],
        nose_radius: f64,
    ) -> Result<Self, MapError> {
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
    pub(in crate::generate) fn o(
        name: &str,
        curve: &dyn Fn(f64) -> [f64; 2],
        nose_radius: f64,
    ) -> Result<Self, MapError> {
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
