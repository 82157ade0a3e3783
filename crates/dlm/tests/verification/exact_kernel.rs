//! The assembled coefficients against direct quadrature of the kernel: Landahl's K1 and K2 with the integrals I1 and I2 found
//! numerically, integrated along the doublet line numerically. Nothing is shared with the crate but the definition.

use std::f64::consts::PI;

use dip_dlm::c64;
use dip_dlm::kernel::{IntegralSum, Kernel, LineFit, downwash};
use dip_dlm::lattice::{Lattice, PlaneSymmetry, Surface};

/// Gauss-Legendre nodes and weights on -1 .. 1 by Newton's method.
fn gauss(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|i| {
            let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 0.0;
            for _ in 0..100 {
                let (mut p0, mut p1) = (1.0, x);
                for j in 2..=n {
                    let p2 = ((2 * j - 1) as f64 * x * p1 - (j - 1) as f64 * p0) / j as f64;
                    (p0, p1) = (p1, p2);
                }
                slope = n as f64 * (x * p1 - p0) / (x * x - 1.0);
                let step = p1 / slope;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

fn integrate(rule: &[(f64, f64)], a: f64, b: f64, f: impl Fn(f64) -> c64) -> c64 {
    rule.iter()
        .map(|(x, w)| f(0.5 * (a + b) + 0.5 * (b - a) * x) * (0.5 * (b - a) * w))
        .sum()
}

/// Integral from u1 to infinity of exp(-i k1 u) / (1 + u^2)^power, power 3/2 or 5/2.
fn tail_integral(rule: &[(f64, f64)], u1: f64, k1: f64, five: bool) -> c64 {
    let f = |u: c64| {
        let s = (u * u + 1.0).sqrt();
        (c64::new(0.0, -k1) * u).exp() / if five { s * s * s * s * s } else { s * s * s }
    };
    // Along the real axis to u = 0.7, then down the complex plane, where the exponential decays.
    let turn = u1.max(0.7);
    let mut sum = c64::new(0.0, 0.0);
    let mut a = u1;
    while a < turn {
        let b = (a + 0.25 * (1.0 + 0.3 * a.abs())).min(turn);
        sum += integrate(rule, a, b, |u| f(c64::new(u, 0.0)));
        a = b;
    }
    let (mut a, mut h) = (0.0, 0.1);
    while a < 1e7 && k1 * a < 60.0 {
        sum += integrate(rule, a, a + h, |t| f(c64::new(turn, -t))) * c64::new(0.0, -1.0);
        a += h;
        h *= 1.4;
    }
    sum
}

struct Pair {
    lattice: Lattice,
    mach: f64,
    kappa: f64,
}

impl Pair {
    /// A swept sending box with dihedral and a receiving box elsewhere; widths scaled by `size`.
    fn new(receiver: [f64; 3], tilt: f64, size: f64, mach: f64, kappa: f64) -> Self {
        let (cos, sin) = (0.2_f64.cos(), 0.2_f64.sin());
        let e = 0.4 * size;
        let end = |s: f64| [0.5 * s * e, s * e * cos, s * e * sin];
        let sender = Surface::trapezoid("sender", (end(-1.0), 0.3), (end(1.0), 0.3), 1, 1);
        let (a, b) = (tilt.cos() * 0.1, tilt.sin() * 0.1);
        let place = |s: f64| [receiver[0] - 0.15, receiver[1] + s * a, receiver[2] + s * b];
        let other = Surface::trapezoid("receiver", (place(-1.0), 0.2), (place(1.0), 0.2), 1, 1);
        Self {
            lattice: Lattice::new(vec![sender, other], PlaneSymmetry::None).unwrap(),
            mach,
            kappa,
        }
    }

    /// What a numerator of one gives.
    fn unit(&self) -> f64 {
        let [s, r] = [&self.lattice.boxes()[0], &self.lattice.boxes()[1]];
        let (p, q) = (r.control_point, s.force_point);
        s.chord / (8.0 * PI) * s.width / ((p[1] - q[1]).powi(2) + (p[2] - q[2]).powi(2))
    }

    fn assembled(&self, kernel: Kernel) -> c64 {
        downwash(&self.lattice, kernel, self.mach, &[self.kappa])[0][(1, 0)]
    }

    /// chord / (8 pi) times the integral of (K1 T1 / r1^2 + K2 T2 / r1^4) exp(-i kappa x) along the line.
    fn exact(&self) -> c64 {
        let rule = gauss(24);
        let [s, r] = [&self.lattice.boxes()[0], &self.lattice.boxes()[1]];
        let e = 0.5 * s.width;
        let (mach, kappa) = (self.mach, self.kappa);
        let beta2 = 1.0 - mach * mach;
        let p = r.control_point;
        let d = [0, 1, 2].map(|i| p[i] - 0.5 * (s.doublet_1[i] + s.doublet_2[i]));
        let y = d[1] * s.cos_dihedral + d[2] * s.sin_dihedral;
        let z = d[2] * s.cos_dihedral - d[1] * s.sin_dihedral;
        let tan = (s.doublet_2[0] - s.doublet_1[0]) / s.width;
        let gamma = s.sin_dihedral.atan2(s.cos_dihedral) - r.sin_dihedral.atan2(r.cos_dihedral);
        let integrand = |eta: f64| -> c64 {
            let x = d[0] - eta * tan;
            let r1 = (y - eta).hypot(z);
            let big_r = (x * x + beta2 * r1 * r1).sqrt();
            let u1 = (mach * big_r - x) / (beta2 * r1);
            let k1 = kappa * r1;
            let phase = c64::new(0.0, -k1 * u1).exp();
            let root = (1.0 + u1 * u1).sqrt();
            let i = c64::new(0.0, 1.0);
            let one = tail_integral(&rule, u1, k1, false) + phase * (mach * r1 / big_r / root);
            let two = -3.0 * tail_integral(&rule, u1, k1, true)
                - i * k1 * phase * (mach * r1 / big_r).powi(2) / root
                - phase
                    * (mach * r1 / big_r / root.powi(3))
                    * ((1.0 + u1 * u1) * beta2 * r1 * r1 / (big_r * big_r) + 2.0 + mach * r1 * u1 / big_r);
            let t1 = gamma.cos();
            let t2 = z * (z * gamma.cos() + (y - eta) * gamma.sin());
            (one * t1 / (r1 * r1) + two * t2 / r1.powi(4)) * c64::new(0.0, -kappa * x).exp()
        };
        let panels = 32;
        let h = 2.0 * e / f64::from(panels);
        let sum: c64 = (0..panels)
            .map(|i| integrate(&rule, -e + h * f64::from(i), -e + h * f64::from(i + 1), integrand))
            .sum();
        sum * (s.chord / (8.0 * PI))
    }
}

/// Receiving points: beside, behind, ahead, above, and tilted as a fin or tail; (point, receiver's dihedral).
const PLACES: [([f64; 3], f64); 6] = [
    ([0.3, 1.2, 0.243], 0.2),
    ([3.0, 1.0, 0.203], 0.2),
    ([-2.0, 1.5, 0.304], 0.2),
    ([0.4, 0.1, 0.6], 0.0),
    ([2.5, -0.8, 0.5], 1.4),
    ([-0.3, 0.9, -0.7], -0.6),
];

/// With k = 0 the horseshoe vortex is the doublet line exactly, planar and not.
#[test]
fn steady_part_is_the_line_of_doublets() {
    for mach in [0.0, 0.6, 0.9] {
        for (place, tilt) in PLACES {
            let pair = Pair::new(place, tilt, 1.0, mach, 0.0);
            // k1 = 0 has no decay to rely on: the integrals' closed forms are eqs. 15 and 16, a tiny k1 gives them too.
            let exact = Pair {
                kappa: 1e-9,
                ..Pair::new(place, tilt, 1.0, mach, 0.0)
            }
            .exact();
            let ours = pair.assembled(Kernel::QUARTIC);
            assert!(
                (ours - exact.re).norm() < 1e-7 * exact.norm(),
                "M {mach} {place:?}: {ours} {exact}"
            );
        }
    }
}

/// All kernels against the exact integral; the remaining error of a narrow box is that of the exponential sums, so it is
/// measured against a numerator of one, chord / (8 pi) times width / r^2 (ahead of the box the coefficient itself is the
/// small difference of larger terms).
#[test]
fn unsteady_coefficients_against_quadrature() {
    let mut worst = [0.0_f64; 2];
    for mach in [0.0, 0.5, 0.9] {
        for kappa in [0.01, 0.3, 2.0] {
            for (place, tilt) in PLACES {
                let pair = Pair::new(place, tilt, 0.05, mach, kappa);
                let exact = pair.exact();
                for (w, integrals) in worst.iter_mut().zip([IntegralSum::Laschka11, IntegralSum::Desmarais12]) {
                    for fit in [LineFit::Parabolic, LineFit::Quartic] {
                        let ours = pair.assembled(Kernel { fit, integrals });
                        *w = w.max((ours - exact).norm() / pair.unit());
                    }
                }
            }
        }
    }
    println!(
        "narrow box: worst relative error with Laschka {:.1e}, Desmarais {:.1e}",
        worst[0], worst[1]
    );
    assert!(worst[0] < 1e-2 && worst[1] < 1e-3, "{worst:?}");
}

/// Halving the box's width shrinks the fit's error with its order, down to the error of the exponential sum.
#[test]
fn line_fits_converge() {
    for (fit, order) in [(LineFit::Parabolic, 4.0), (LineFit::Quartic, 6.0)] {
        let kernel = Kernel {
            fit,
            integrals: IntegralSum::Desmarais12,
        };
        for (place, tilt) in [PLACES[0], PLACES[4]] {
            // The sum's own error is taken out: it is that of a narrow box, where the fit is exact, to first order.
            let error = |size: f64| {
                let pair = Pair::new(place, tilt, size, 0.6, 1.5);
                (pair.assembled(kernel), pair.exact())
            };
            let relative: Vec<f64> = [2.0, 1.0]
                .iter()
                .map(|&s| {
                    let (ours, exact) = error(s);
                    (ours - exact).norm() / exact.norm()
                })
                .collect();
            let measured = (relative[0] / relative[1]).log2();
            println!("{fit:?} {place:?}: errors {relative:?}, order {measured:.2}");
            assert!(
                relative[1] < 2e-4 || measured > order - 1.5,
                "{fit:?} {place:?} {relative:?}"
            );
        }
    }
}

/// Close above the box itself, where atan takes its other branch: the published series near the plane with its term pi / |z|,
/// against quadrature. The two parts of the kernel nearly cancel there, so the fit's error grows as 1 / |z|; below a tenth of the
/// half width the lattice check warns.
#[test]
fn close_above_the_box() {
    let (cos, sin) = (0.2_f64.cos(), 0.2_f64.sin());
    for (height, limit) in [(0.04, 0.02), (0.1, 0.01), (0.2, 0.01)] {
        // Half width 0.4, dihedral 0.2; the point lies behind the line, a little off the middle.
        let place = [0.2, 0.05 * cos - height * sin, 0.05 * sin + height * cos];
        let pair = Pair::new(place, 0.2, 1.0, 0.5, 0.3);
        let exact = pair.exact();
        for kernel in [Kernel::NASTRAN, Kernel::QUARTIC] {
            let error = (pair.assembled(kernel) - exact).norm() / exact.norm();
            println!("height {height} {kernel:?}: {exact:.5}, error {error:.1e}");
            assert!(error < limit, "{kernel:?} height {height}: {error:.1e}");
        }
    }
}

/// The exponential sums against u / sqrt(1 + u^2): published largest errors (Desmarais 1982 gives 0.13 % for the 11 terms and
/// far less for his 12).
#[test]
fn exponential_sums() {
    let error = |sum: IntegralSum| {
        (0..4000)
            .map(|i| f64::from(i) * 0.005)
            .map(|u| (sum.one_minus_v(u) - (1.0 - u / u.hypot(1.0))).abs())
            .fold(0.0, f64::max)
    };
    let (laschka, desmarais) = (error(IntegralSum::Laschka11), error(IntegralSum::Desmarais12));
    println!("largest error of the sums: Laschka {laschka:.2e}, Desmarais {desmarais:.2e}");
    assert!(laschka < 3e-3 && desmarais < 1e-4, "{laschka} {desmarais}");
}
