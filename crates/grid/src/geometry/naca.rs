//! NACA four-digit sections.

/// E. N. Jacobs, K. E. Ward, R. M. Pinkerton, NACA Report 460 (1933): thickness distribution with a blunt trailing
/// edge of 0.0021 t/0.2 half thickness, laid off normal to a mean line of two parabolas.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Naca4 {
    thickness: f64,
    camber: f64,
    camber_at: f64,
}

impl Naca4 {
    /// From the four digits.
    pub(super) fn new(digits: &str) -> Option<Self> {
        if digits.len() != 4 || !digits.bytes().all(|b| b.is_ascii_digit()) {
            return None;
        }
        let digit = |n: usize| f64::from(digits.as_bytes()[n] - b'0');
        let thickness = (10.0 * digit(2) + digit(3)) / 100.0;
        let camber_at = digit(1) / 10.0;
        let camber = if camber_at > 0.0 { digit(0) / 100.0 } else { 0.0 };
        (thickness > 0.0).then_some(Self {
            thickness,
            camber,
            camber_at,
        })
    }

    /// Point at parameter t: abscissa of the mean line t^2, upper surface for t > 0.
    pub(super) fn point(&self, t: f64) -> [f64; 2] {
        let x = t * t;
        // Report 460, equation of the thickness: y = t/0.2 (0.2969 sqrt(x) - 0.1260 x - 0.3516 x^2 + 0.2843 x^3 - 0.1015 x^4).
        let half = self.thickness / 0.2
            * (0.2969 * t.abs() + x * (-0.1260 + x * (-0.3516 + x * (0.2843 - 0.1015 * x))))
            * t.signum();
        if self.camber == 0.0 {
            return [x, half];
        }
        let (m, p) = (self.camber, self.camber_at);
        let q = if x < p { p } else { 1.0 - p };
        let mean = if x < p {
            m / (p * p) * (2.0 * p * x - x * x)
        } else {
            m / (q * q) * (1.0 - 2.0 * p + 2.0 * p * x - x * x)
        };
        let slope = 2.0 * m / (q * q) * (p - x);
        let length = (1.0 + slope * slope).sqrt();
        [x - half * slope / length, mean + half / length]
    }
}
