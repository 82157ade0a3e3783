//! Where points of wall and wake lie in a map.

use std::f64::consts::PI;

use num_complex::Complex64;

use super::{Conformal, Wrap, complex};

impl Conformal {
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
    pub(in crate::generate) fn wake_point(&self, x: f64) -> [f64; 2] {
        match self.wrap {
            Wrap::Parabola { nose } => [x, nose.im + self.drop * (-(x - self.tail)).exp()],
            Wrap::Ellipse { .. } => [x, 0.0],
        }
    }

    /// a above and below the wake at x.
    pub(in crate::generate) fn wake_parameter(&self, x: f64) -> [f64; 2] {
        let p = self.wake_point(x);
        let guess = x.max(0.0).sqrt();
        [self.wall_parameter(p, guess), self.wall_parameter(p, -guess)]
    }

    /// a of the wall point `p` at section parameter t (1: upper trailing edge, -1: lower; beyond: the wake).
    pub(in crate::generate) fn wall_parameter(&self, p: [f64; 2], t: f64) -> f64 {
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
