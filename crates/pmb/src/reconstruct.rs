//! States at a face from cell values: MUSCL (van Leer 1979) on primitive variables with the limiter of van Albada,
//! van Leer and Roberts 1982.

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

/// Left and right state at the face between `b` and `c` of the four cells `a, b, c, d` across it.
///
/// `e2` are the squares of the limiter's constants (see [`crate::scheme::Scheme`]), density, velocity, pressure. A side
/// whose density or pressure would fall below a tenth of its cell's falls back to the cell's state.
#[inline(always)]
pub fn muscl<T: Real, const LIMITED: bool>(
    a: &State<T>,
    b: &State<T>,
    c: &State<T>,
    d: &State<T>,
    e2: &[T; 3],
) -> [State<T>; 2] {
    let half = T::splat(0.5);
    let (mut l, mut r) = (*b, *c);
    for v in 0..5 {
        let e = match v {
            0 => e2[0],
            4 => e2[2],
            _ => e2[1],
        };
        let (d1, d2, d3) = (b[v] - a[v], c[v] - b[v], d[v] - c[v]);
        let (left, right) = if LIMITED {
            (slope_van_albada(d1, d2, e), slope_van_albada(d2, d3, e))
        } else {
            (half * (d1 + d2), half * (d2 + d3))
        };
        l[v] = b[v] + half * left;
        r[v] = c[v] - half * right;
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
