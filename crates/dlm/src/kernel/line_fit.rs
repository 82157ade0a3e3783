//! Integrals along the doublet line of the polynomial that fits the kernel's numerator.
//!
//! With y, z the receiving point in the sending box's axes, e its half width, and the numerator of the unsteady increment
//! fitted by A eta^2 + B eta + C (+ D eta^3 + E eta^4), the increment of the normal wash is chord / (8 pi) times
//!
//! integral of P1 / ((y - eta)^2 + z^2) + integral of P2 / ((y - eta)^2 + z^2)^2 over -e <= eta <= e.
//!
//! Both are linear in the values of P1 and P2 at the fit's points, so all that a pair of strips needs is one weight per
//! point, and the published branches for points near the sending plane are taken once per pair of strips.
//!
//! Rodden, Giesing and Kalman 1971, eqs. 27 - 41; Rodden, Taylor and McIntosh 1998, eqs. 15 - 34.

use super::LineFit;

/// Most points of any fit.
pub(super) const POINTS: usize = 5;

/// Height over half width below which a point counts as lying in the sending plane (Nastran's value).
const PLANAR: f64 = 1e-3;

impl LineFit {
    /// Stations of the fit in half widths.
    pub(super) fn stations(self) -> &'static [f64] {
        match self {
            Self::Parabolic => &[-1.0, 0.0, 1.0],
            Self::Quartic => &[-1.0, -0.5, 0.0, 0.5, 1.0],
        }
    }

    /// Weights of the values at the stations, from those of the coefficients (A, B, C, D, E).
    fn weights_of_values(self, g: [f64; 5], e: f64) -> [f64; POINTS] {
        let [a, b, c, d, f] = g;
        match self {
            Self::Parabolic => {
                let (a, b) = (a / (2.0 * e * e), b / (2.0 * e));
                [a - b, c - 2.0 * a, a + b, 0.0, 0.0]
            }
            Self::Quartic => {
                let (a, b) = (-a / (6.0 * e * e), b / (6.0 * e));
                let (d, f) = (-2.0 * d / (3.0 * e.powi(3)), 2.0 * f / (3.0 * e.powi(4)));
                [
                    a + b + d + f,
                    -16.0 * a - 8.0 * b - 2.0 * d - 4.0 * f,
                    30.0 * a + c + 6.0 * f,
                    -16.0 * a + 8.0 * b + 2.0 * d - 4.0 * f,
                    a - b - d + f,
                ]
            }
        }
    }
}

/// Weights of a pair of strips; `chord / (8 pi)` is left to the sending box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LineWeights {
    /// Of the values of P1 at the stations.
    pub planar: [f64; POINTS],
    /// Of the values of P2 at the stations; `None` in the sending plane, where the second part is dropped.
    pub nonplanar: Option<[f64; POINTS]>,
}

impl LineWeights {
    /// For a receiving point at `y`, `z` in the sending strip's axes, half width `e`.
    pub(super) fn new(fit: LineFit, y: f64, z: f64, e: f64) -> Self {
        let (y2, z2, e2) = (y * y, z * z, e * e);
        let q = y2 + z2 - e2;
        let in_plane = z.abs() <= PLANAR * e;
        // F = integral of 1 / ((y - eta)^2 + z^2), eqs. 31 - 33; `alpha` is the part of it that D2 needs without loss of
        // digits: F = 2 e / q (1 - alpha z^2 / e^2).
        let (f, alpha) = if in_plane {
            (2.0 * e / (y2 - e2), 0.0)
        } else {
            let ratio = 2.0 * e * z.abs() / q;
            let f = (2.0 * e * z.abs()).atan2(q) / z.abs();
            let alpha = if ratio.abs() <= 0.3 {
                let r2 = ratio * ratio;
                // Eq. 33, to n = 7 as published; for points above the box itself (q < 0) atan's branch adds pi.
                let series =
                    1.0 / 3.0 - r2 * (1.0 / 5.0 - r2 * (1.0 / 7.0 - r2 * (1.0 / 9.0 - r2 * (1.0 / 11.0 - r2 / 13.0))));
                let branch = if q < 0.0 {
                    std::f64::consts::PI / ratio.abs() * e2 / z2
                } else {
                    0.0
                };
                4.0 * e2 * e2 / (q * q) * series + branch
            } else {
                (1.0 - f * q / (2.0 * e)) * e2 / z2
            };
            (f, alpha)
        };
        let log = (((y - e).powi(2) + z2) / ((y + e).powi(2) + z2)).ln();
        let planar = [
            (y2 - z2) * f + y * log + 2.0 * e,
            y * f + 0.5 * log,
            f,
            y * (y2 - 3.0 * z2) * f + 0.5 * (3.0 * y2 - z2) * log + 4.0 * e * y,
            (y2 * y2 - 6.0 * y2 * z2 + z2 * z2) * f + 2.0 * y * (y2 - z2) * log + 2.0 * e * (3.0 * y2 - z2 + e2 / 3.0),
        ];
        let nonplanar = (!in_plane).then(|| second(y, z, e, f, alpha, log));
        Self {
            planar: fit.weights_of_values(planar, e),
            nonplanar: nonplanar.map(|g| fit.weights_of_values(g, e)),
        }
    }
}

/// Integral of (eta^2, eta, 1, eta^3, eta^4) / ((y - eta)^2 + z^2)^2: eqs. 40 and 41 of 1971, 33 and 34 of 1998.
fn second(y: f64, z: f64, e: f64, f: f64, alpha: f64, log: f64) -> [f64; 5] {
    let (y2, z2, e2) = (y * y, z * z, e * e);
    let (y4, z4, e4) = (y2 * y2, z2 * z2, e2 * e2);
    let q = y2 + z2 - e2;
    let plus = 1.0 / ((y + e).powi(2) + z2);
    let minus = 1.0 / ((y - e).powi(2) + z2);
    if q.abs() <= 0.1 * 2.0 * e * z.abs() {
        let ends = |even: f64, odd: f64| plus * (even + odd) - minus * (even - odd);
        let scale = 0.5 / z2;
        [
            scale * ((y2 + z2) * f + ends((y2 + z2) * y, (y2 - z2) * e)),
            scale * (y * f + ends(y2 + z2, y * e)),
            scale * (f + ends(y, e)),
            scale * (y * (y2 + 3.0 * z2) * f + ends(y4 - z4, (y2 - 3.0 * z2) * y * e) + z2 * log),
            scale
                * ((y4 + 6.0 * y2 * z2 - 3.0 * z4) * f
                    + ends((y4 - 2.0 * y2 * z2 - 3.0 * z4) * y, (y4 - 6.0 * y2 * z2 + z4) * e)
                    + 4.0 * z2 * (e + y * log)),
        ]
    } else {
        let scale = e / q;
        let both = plus * minus;
        let alpha = alpha / e2;
        let cubic = y4 - 2.0 * e2 * y2 + 2.0 * y2 * z2 + 3.0 * e4 + 2.0 * e2 * z2 + z4;
        let quartic = 3.0 * y2 * y4 - 7.0 * e2 * y4 + 5.0 * y4 * z2 + 6.0 * e4 * y2 + 6.0 * e2 * y2 * z2
            - 3.0 * e2 * z4
            - z2 * z4
            + y2 * z4
            - 2.0 * e4 * z2;
        [
            scale * (2.0 * (y2 + z2 + e2) * e2 * both - alpha * (y2 + z2)),
            scale * (4.0 * y * e2 * both - alpha * y),
            scale * (2.0 * (y2 + z2 + e2) * both - alpha),
            scale * (2.0 * y * cubic * both - alpha * y * (y2 + 3.0 * z2)) + 0.5 * log,
            scale * (2.0 * quartic * both - alpha * (y4 + 6.0 * y2 * z2 - 3.0 * z4)) + 2.0 * (e + y * log),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::{LineFit, LineWeights};

    /// Gauss-Legendre with 32 panels of 5 points of `value(eta)` over -e .. e.
    fn integrate(e: f64, value: impl Fn(f64) -> f64) -> f64 {
        const X: [f64; 3] = [0.0, 0.538_469_310_105_683_1, 0.906_179_845_938_664];
        const W: [f64; 3] = [
            0.568_888_888_888_888_9,
            0.478_628_670_499_366_47,
            0.236_926_885_056_189_08,
        ];
        let panels = 4000;
        let h = e / f64::from(panels);
        (0..panels)
            .map(|i| {
                let mid = -e + h * f64::from(2 * i + 1);
                h * (W[0] * value(mid)
                    + (1..3)
                        .map(|j| W[j] * (value(mid - h * X[j]) + value(mid + h * X[j])))
                        .sum::<f64>())
            })
            .sum()
    }

    /// The weights integrate every polynomial of the fit's degree exactly: against quadrature, on all branches
    /// (far, near the plane outside the box, above the box, on the circle y^2 + z^2 = e^2).
    #[test]
    fn weights_integrate_polynomials() {
        let e = 0.7;
        let points = [
            (3.0, 0.5),
            (-2.0, 0.05),
            (0.2, 0.02),
            (0.1, -0.01),
            (0.0, 0.7),
            (0.3, 0.63),
            (0.5, 0.5),
            (-0.9, 0.3),
            (0.2, 2.0),
            (1.4, 0.002),
            (-0.6, 0.1),
        ];
        for fit in [LineFit::Parabolic, LineFit::Quartic] {
            for (y, z) in points {
                let w = LineWeights::new(fit, y, z, e);
                let degree = fit.stations().len() as i32;
                for power in 0..degree {
                    let values = fit.stations().iter().map(|s| (s * e).powi(power));
                    let first: f64 = values.clone().zip(w.planar).map(|(v, w)| v * w).sum();
                    let second: f64 = values.zip(w.nonplanar.unwrap()).map(|(v, w)| v * w).sum();
                    let exact = |n: i32| integrate(e, |eta: f64| eta.powi(power) / ((y - eta).powi(2) + z * z).powi(n));
                    let size = |n: i32| {
                        integrate(e, |eta: f64| {
                            eta.powi(power).abs() / ((y - eta).powi(2) + z * z).powi(n)
                        })
                    };
                    // The published series near the plane is cut at n = 7 (relative 1e-7), and far from the line D2 loses
                    // digits by differences of nearly equal terms.
                    assert!(
                        (first - exact(1)).abs() < 1e-8 * size(1),
                        "{fit:?} {y} {z} power {power}: {first} {}",
                        exact(1)
                    );
                    assert!(
                        (second - exact(2)).abs() < 2e-6 * size(2),
                        "{fit:?} {y} {z} power {power}: {second} {}",
                        exact(2)
                    );
                }
            }
        }
    }
}
