//! States at a face from cell values: MUSCL (van Leer 1979) on primitive variables, with the limiter of van Albada,
//! van Leer and Roberts 1982 or that of Koren 1988.

use crate::gas::State;
use crate::real::Real;

/// How states at faces are made from cell values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Reconstruction {
    /// The cell's own value: first order.
    Constant,
    /// Linear with the mean slope: second order, oscillates at shocks.
    Unlimited,
    /// Linear with van Albada's slope: second order in smooth flow.
    VanAlbada,
    /// Third-order upwind-biased (kappa = 1/3) with Koren's limiter.
    Koren,
}

impl Reconstruction {
    /// True if slopes are limited, so that the limiter's constant matters.
    #[must_use]
    pub fn is_limited(self) -> bool {
        matches!(self, Self::VanAlbada | Self::Koren)
    }
}

/// The slope of a cell from the difference `near` across the face that a state is wanted at and the difference `far`
/// across the opposite face; `e2` is the square of the limiter's constant.
pub trait Slope {
    /// The change over a whole cell.
    fn slope<T: Real>(near: T, far: T, e2: T) -> T;
}

/// The plain mean (kappa = 0).
#[derive(Clone, Copy, Debug)]
pub struct Mean;
/// [`slope_van_albada`].
#[derive(Clone, Copy, Debug)]
pub struct VanAlbada;
/// [`slope_koren`].
#[derive(Clone, Copy, Debug)]
pub struct Koren;

impl Slope for Mean {
    #[inline(always)]
    fn slope<T: Real>(near: T, far: T, _: T) -> T {
        T::splat(0.5) * (near + far)
    }
}

impl Slope for VanAlbada {
    #[inline(always)]
    fn slope<T: Real>(near: T, far: T, e2: T) -> T {
        slope_van_albada(near, far, e2)
    }
}

impl Slope for Koren {
    #[inline(always)]
    fn slope<T: Real>(near: T, far: T, e2: T) -> T {
        slope_koren(near, far, e2)
    }
}

/// Van Albada's mean of two neighbouring differences in the form of Anderson, Thomas and van Leer 1986 (AIAA J. 24),
/// `s (d1 + d2)/2` with `s = (2 max(d1 d2, 0) + 2 e2)/(d1^2 + d2^2 + 2 e2)`: the plain mean where both are small against
/// e or close to each other, near twice the smaller one's half elsewhere, and nothing at an extremum above e. Without
/// the clip at extrema the cells of a captured shock never come to rest.
#[inline(always)]
pub fn slope_van_albada<T: Real>(d1: T, d2: T, e2: T) -> T {
    let product = (d1 * d2).max(T::splat(0.0)) + e2;
    (d1 + d2) * product / (d1 * d1 + d2 * d2 + e2 + e2)
}

/// Koren's smooth limiter of the third-order upwind-biased scheme (kappa = 1/3), with r = near/far
/// `far r (2 r + 1)/(2 r^2 - r + 2)` (Koren 1988, CWI report NM-R8801; Spekreijse's form of it), and with a constant as Venkatakrishnan 1990 (AIAA 90-0429)
/// has it: `(2 near + far)(near far + e2)/(2 (near^2 + far^2) - near far + 3 e2)`, which is (2 near + far)/3 where both are
/// small against e or equal. Clipped at extrema as van Albada's is.
#[inline(always)]
pub fn slope_koren<T: Real>(near: T, far: T, e2: T) -> T {
    let (two, three) = (T::splat(2.0), T::splat(3.0));
    let product = near * far;
    let limited = product.max(T::splat(0.0)) + e2;
    (two * near + far) * limited / (two * (near * near + far * far) - product + three * e2)
}

/// Left and right state at the face between `b` and `c` of the four cells `a, b, c, d` across it.
///
/// `e2` are the squares of the limiter's constants (see [`crate::scheme::Scheme`]), density, velocity, pressure. A side
/// whose density or pressure would fall below a tenth of its cell's falls back to the cell's state.
#[inline(always)]
pub fn muscl<T: Real, S: Slope>(a: &State<T>, b: &State<T>, c: &State<T>, d: &State<T>, e2: &[T; 3]) -> [State<T>; 2] {
    let half = T::splat(0.5);
    let (mut l, mut r) = (*b, *c);
    for v in 0..5 {
        let e = match v {
            0 => e2[0],
            4 => e2[2],
            _ => e2[1],
        };
        let (d1, d2, d3) = (b[v] - a[v], c[v] - b[v], d[v] - c[v]);
        l[v] = b[v] + half * S::slope(d2, d1, e);
        r[v] = c[v] - half * S::slope(d2, d3, e);
    }
    [guarded(b, &l), guarded(c, &r)]
}

/// `face`, or `cell` where the density or the pressure of `face` is below a tenth of the cell's.
#[inline(always)]
pub fn guarded<T: Real>(cell: &State<T>, face: &State<T>) -> State<T> {
    let tenth = T::splat(0.1);
    let one = T::splat(1.0);
    let zero = T::splat(0.0);
    let low = T::select_lt(face[0], tenth * cell[0], one, zero) + T::select_lt(face[4], tenth * cell[4], one, zero);
    let mut out = *face;
    for v in 0..5 {
        out[v] = T::select_lt(zero, low, cell[v], face[v]);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means of x^2 over cells of unit width from `first` on.
    fn parabola(first: f64) -> [State<f64>; 4] {
        std::array::from_fn(|n| {
            let x = first + n as f64;
            [((x + 1.0).powi(3) - x.powi(3)) / 3.0; 5]
        })
    }

    #[test]
    fn korens_slope_gives_a_parabola_exactly_at_the_face_where_nothing_is_limited() {
        let [a, b, c, d] = parabola(3.0);
        // The face between the second and the third cell lies at x = 5.
        for state in muscl::<f64, Koren>(&a, &b, &c, &d, &[1e12; 3]) {
            assert!((state[0] - 25.0).abs() < 1e-9, "{}", state[0]);
        }
        let [mean, _] = muscl::<f64, Mean>(&a, &b, &c, &d, &[0.0; 3]);
        assert!(
            (mean[0] - 25.0).abs() > 1e-2,
            "the mean slope is second order only: {}",
            mean[0]
        );
    }

    #[test]
    fn limited_slopes_are_the_plain_one_on_a_line_nothing_at_extrema_and_keep_between_the_neighbours() {
        let slopes: [fn(f64, f64, f64) -> f64; 2] = [VanAlbada::slope::<f64>, Koren::slope::<f64>];
        for slope in slopes {
            assert!((slope(0.7, 0.7, 1e-24) - 0.7).abs() < 1e-12);
            assert!(slope(0.7, -0.3, 1e-24).abs() < 1e-12);
            for far in [0.01, 0.1, 0.4, 0.9, 1.0, 1.3, 3.0, 10.0, 100.0] {
                // Half the slope, the change from the cell to its face, is at most the change to the neighbour, on both sides.
                let half = 0.5 * slope(1.0, far, 1e-24);
                assert!(half > 0.0 && half <= 1.0 && half <= far, "{half} for {far}");
            }
        }
    }
}
