//! Q(k) tabulated at some reduced frequencies, interpolated as Nastran does.

use faer::{Mat, MatMut, c64};

use crate::error::{FlutterError, Result, check_value};
use crate::forces::{GeneralizedForces, KDomain, check_finite};

/// How a table of Q(k) is interpolated. Both interpolate Re Q and (Im Q)/k, which are even in k.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// Natural cubic spline through the table mirrored about k = 0. It is the function that Nastran builds from
    /// |k - k_j|^3 + (k + k_j)^3 and a constant ("special linear interpolation", MSC Aeroelastic Analysis User's Guide;
    /// NASTRAN-95 theoretical manual 17.5).
    #[default]
    EvenCubicSpline,
    /// Straight lines between the points, constant below the first.
    Linear,
}

/// What a table answers above its greatest k.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Extension {
    /// Re Q and (Im Q)/k keep their last values: forces stay bounded as the speed goes to zero.
    #[default]
    Hold,
    /// The straight line that continues the spline, as Nastran does.
    Linear,
}

/// Q(k) tabulated at some reduced frequencies.
#[derive(Debug, Clone)]
pub struct TabulatedForces {
    modes: usize,
    k: Vec<f64>,
    /// `values[node][entry]`: Re Q and Im Q / k as one complex number, entries column by column.
    values: Vec<c64>,
    /// Second derivatives of `values` with respect to k, same order (zero for linear interpolation).
    curvature: Vec<c64>,
    interpolation: Interpolation,
    extension: Extension,
}

impl TabulatedForces {
    /// A table of `q [k]`, each `n x n`, at rising reduced frequencies `k >= 0`.
    ///
    /// One k = 0 is allowed: it gives Re Q there, and (Im Q)/k at zero is then taken from the other nodes.
    ///
    /// # Errors
    /// Empty, unsorted or repeated k, matrices of different size, or numbers that are not finite.
    pub fn new(k: &[f64], q: &[Mat<c64>], interpolation: Interpolation) -> Result<Self> {
        if k.is_empty() || k.len() != q.len() {
            return Err(FlutterError::Shape {
                what: "table of generalized forces".into(),
                needed: "one matrix for each of at least one reduced frequency".into(),
                got: format!("{} reduced frequencies and {} matrices", k.len(), q.len()),
            });
        }
        let modes = q[0].nrows();
        for (index, (&kj, qj)) in k.iter().zip(q).enumerate() {
            check_value(&format!("reduced frequency {}", index + 1), kj, "k >= 0", kj >= 0.0)?;
            if index > 0 && kj <= k[index - 1] {
                return Err(FlutterError::Value {
                    what: format!("reduced frequency {}", index + 1),
                    needed: format!(
                        "above the one before ({}); sort the table and remove repeats",
                        k[index - 1]
                    ),
                    got: kj,
                });
            }
            if modes == 0 || qj.nrows() != modes || qj.ncols() != modes {
                return Err(FlutterError::Shape {
                    what: format!("generalized forces at k = {kj}"),
                    needed: format!("{0} x {0}, at least 1 x 1", modes.max(1)),
                    got: format!("{} x {}", qj.nrows(), qj.ncols()),
                });
            }
            check_finite(&format!("generalized forces at k = {kj}"), qj.as_ref())?;
        }
        if k.len() == 1 && k[0] == 0.0 {
            return Err(FlutterError::Value {
                what: "the only reduced frequency".into(),
                needed: "above zero: damping forces need at least one k > 0".into(),
                got: 0.0,
            });
        }
        let entries = modes * modes;
        let mut values = Vec::with_capacity(k.len() * entries);
        for (&kj, qj) in k.iter().zip(q) {
            for column in 0..modes {
                for row in 0..modes {
                    let value = qj[(row, column)];
                    values.push(c64::new(value.re, if kj > 0.0 { value.im / kj } else { 0.0 }));
                }
            }
        }
        let mut table = Self {
            modes,
            k: k.to_vec(),
            curvature: vec![c64::new(0.0, 0.0); values.len()],
            values,
            interpolation,
            extension: Extension::default(),
        };
        if k[0] == 0.0 {
            table.fill_damping_at_zero();
        }
        if interpolation == Interpolation::EvenCubicSpline {
            table.curvature = even_spline_curvature(&table.k, &table.values, entries);
        }
        Ok(table)
    }

    /// Chooses the rule above the greatest k.
    #[must_use]
    pub fn with_extension(mut self, extension: Extension) -> Self {
        self.extension = extension;
        self
    }

    /// Reduced frequencies of the table.
    #[must_use]
    pub fn reduced_frequencies(&self) -> &[f64] {
        &self.k
    }

    /// (Im Q)/k at k = 0 by the same interpolation through the nodes above zero.
    fn fill_damping_at_zero(&mut self) {
        let entries = self.modes * self.modes;
        let k = &self.k[1..];
        let upper = self.values[entries..].to_vec();
        let curvature = match self.interpolation {
            Interpolation::EvenCubicSpline => even_spline_curvature(k, &upper, entries),
            Interpolation::Linear => vec![c64::new(0.0, 0.0); upper.len()],
        };
        for entry in 0..entries {
            let below = below_first(k[0], upper[entry], curvature[entry], 0.0).0;
            self.values[entry].im = below.im;
        }
    }

    /// Value and derivative in k of entry `entry` of (Re Q) + i (Im Q)/k.
    fn entry(&self, place: Place, entry: usize) -> (c64, c64) {
        let entries = self.modes * self.modes;
        let at = |node: usize| self.values[node * entries + entry];
        let bend = |node: usize| self.curvature[node * entries + entry];
        match place {
            Place::Below(k) => below_first(self.k[0], at(0), bend(0), k),
            Place::Between(low, k) => {
                let (k0, k1) = (self.k[low], self.k[low + 1]);
                between(k0, k1, [at(low), at(low + 1)], [bend(low), bend(low + 1)], k)
            }
            Place::Above(k) => {
                let last = self.k.len() - 1;
                match self.extension {
                    Extension::Hold => (at(last), c64::new(0.0, 0.0)),
                    Extension::Linear if last == 0 => (at(0), c64::new(0.0, 0.0)),
                    Extension::Linear => {
                        let (k0, k1) = (self.k[last - 1], self.k[last]);
                        let (value, slope) =
                            between(k0, k1, [at(last - 1), at(last)], [bend(last - 1), bend(last)], k1);
                        (value + slope * (k - k1), slope)
                    }
                }
            }
        }
    }

    fn place(&self, k: f64) -> Place {
        let last = self.k.len() - 1;
        if k > self.k[last] {
            Place::Above(k)
        } else if k < self.k[0] || last == 0 {
            Place::Below(k)
        } else {
            Place::Between(self.k.partition_point(|&kj| kj <= k).clamp(1, last) - 1, k)
        }
    }
}

#[derive(Clone, Copy)]
enum Place {
    Below(f64),
    Between(usize, f64),
    Above(f64),
}

impl GeneralizedForces for TabulatedForces {
    fn modes(&self) -> usize {
        self.modes
    }

    fn domain(&self) -> KDomain {
        KDomain {
            minimum: self.k[0],
            maximum: self.k[self.k.len() - 1],
        }
    }

    fn q(&self, k: f64, mut q: MatMut<'_, c64>) -> Result<()> {
        let place = self.place(k);
        for column in 0..self.modes {
            for row in 0..self.modes {
                let value = self.entry(place, column * self.modes + row).0;
                q[(row, column)] = c64::new(value.re, k * value.im);
            }
        }
        Ok(())
    }

    fn q_and_slope(&self, k: f64, mut q: MatMut<'_, c64>, mut dq_dk: MatMut<'_, c64>) -> Result<()> {
        let place = self.place(k);
        for column in 0..self.modes {
            for row in 0..self.modes {
                let (value, slope) = self.entry(place, column * self.modes + row);
                q[(row, column)] = c64::new(value.re, k * value.im);
                dq_dk[(row, column)] = c64::new(slope.re, value.im + k * slope.im);
            }
        }
        Ok(())
    }
}

/// Cubic of one interval from values and second derivatives at its ends: value and slope at `k`.
fn between(k0: f64, k1: f64, y: [c64; 2], bend: [c64; 2], k: f64) -> (c64, c64) {
    let h = k1 - k0;
    let (a, b) = ((k1 - k) / h, (k - k0) / h);
    let value = y[0] * a + y[1] * b + (bend[0] * (a * a * a - a) + bend[1] * (b * b * b - b)) * (h * h / 6.0);
    let slope = (y[1] - y[0]) / h + (bend[1] * (3.0 * b * b - 1.0) - bend[0] * (3.0 * a * a - 1.0)) * (h / 6.0);
    (value, slope)
}

/// The even cubic on (-k0, k0): equal second derivatives at both ends make it y0 + bend (k^2 - k0^2) / 2.
fn below_first(k0: f64, y0: c64, bend: c64, k: f64) -> (c64, c64) {
    (y0 + bend * ((k * k - k0 * k0) / 2.0), bend * k)
}

/// Second derivatives of the natural cubic spline through the nodes and their mirror images about k = 0.
///
/// `values [node][entry]`. Continuity of the slope at node j with intervals h_j, h_{j+1}:
/// h_j m_{j-1} + 2 (h_j + h_{j+1}) m_j + h_{j+1} m_{j+1} = 6 (slope difference); at the first node the interval to the left is
/// (-k_0, k_0) of width 2 k_0 with m_{-1} = m_0 and no slope, so (6 k_0 + 2 h) m_0 + h m_1 = 6 (y_1 - y_0)/h. With k_0 = 0
/// this is the symmetry condition of zero slope. The last m is zero.
fn even_spline_curvature(k: &[f64], values: &[c64], entries: usize) -> Vec<c64> {
    let nodes = k.len();
    let zero = c64::new(0.0, 0.0);
    let mut bend = vec![zero; nodes * entries];
    if nodes < 2 {
        return bend;
    }
    let free = nodes - 1;
    let interval = |j: usize| k[j + 1] - k[j];
    // Thomas algorithm: the matrix is the same for all entries, diagonally dominant.
    let mut upper = vec![0.0; free];
    let mut pivots = vec![0.0; free];
    for j in 0..free {
        let (diagonal, below) = if j == 0 {
            (6.0 * k[0] + 2.0 * interval(0), 0.0)
        } else {
            (2.0 * (interval(j - 1) + interval(j)), interval(j - 1))
        };
        pivots[j] = diagonal - if j == 0 { 0.0 } else { below * upper[j - 1] };
        upper[j] = interval(j) / pivots[j];
    }
    for entry in 0..entries {
        let y = |j: usize| values[j * entries + entry];
        for j in 0..free {
            let right = (y(j + 1) - y(j)) / interval(j);
            let left = if j == 0 {
                zero
            } else {
                (y(j) - y(j - 1)) / interval(j - 1)
            };
            let mut rhs = (right - left) * 6.0;
            if j > 0 {
                rhs -= bend[(j - 1) * entries + entry] * interval(j - 1);
            }
            bend[j * entries + entry] = rhs / pivots[j];
        }
        for j in (0..free - 1).rev() {
            let next = bend[(j + 1) * entries + entry];
            bend[j * entries + entry] -= next * upper[j];
        }
    }
    bend
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(k: &[f64], f: impl Fn(f64) -> c64, kind: Interpolation) -> TabulatedForces {
        let q: Vec<_> = k.iter().map(|&kj| Mat::from_fn(1, 1, |_, _| f(kj))).collect();
        TabulatedForces::new(k, &q, kind).unwrap()
    }

    fn at(forces: &TabulatedForces, k: f64) -> (c64, c64) {
        let (mut q, mut slope) = (Mat::zeros(1, 1), Mat::zeros(1, 1));
        forces.q_and_slope(k, q.as_mut(), slope.as_mut()).unwrap();
        (q[(0, 0)], slope[(0, 0)])
    }

    /// Nastran's own construction, solved as a dense system (MSC guide; NASTRAN-95 FA1PKI builds the same matrix).
    fn special_linear(k: &[f64], y: &[f64], at: f64) -> f64 {
        let n = k.len();
        let kernel = |a: f64, b: f64| (a - b).abs().powi(3) + (a + b).powi(3);
        let a = Mat::<f64>::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
            (true, true) => kernel(k[i], k[j]),
            (false, false) => 0.0,
            _ => 1.0,
        });
        let b = Mat::<f64>::from_fn(n + 1, 1, |i, _| if i < n { y[i] } else { 0.0 });
        use faer::linalg::solvers::Solve;
        let c = a.partial_piv_lu().solve(&b);
        (0..n).map(|j| c[(j, 0)] * kernel(at, k[j])).sum::<f64>() + c[(n, 0)]
    }

    #[test]
    fn spline_is_nastrans_special_linear_interpolation() {
        let k = [0.05, 0.1, 0.22, 0.4, 0.9];
        let f = |k: f64| c64::new((3.0 * k).sin() + 0.3, k * (1.0 / (0.3 + k)));
        let forces = table(&k, f, Interpolation::EvenCubicSpline).with_extension(Extension::Linear);
        let re: Vec<_> = k.iter().map(|&k| f(k).re).collect();
        let im: Vec<_> = k.iter().map(|&k| f(k).im / k).collect();
        for probe in [0.0, 0.01, 0.05, 0.07, 0.3, 0.55, 0.9, 1.1] {
            let (q, _) = at(&forces, probe);
            assert!((q.re - special_linear(&k, &re, probe)).abs() < 1e-11, "{probe}");
            assert!((q.im - probe * special_linear(&k, &im, probe)).abs() < 1e-11, "{probe}");
        }
    }

    #[test]
    fn slope_is_the_derivative_and_nodes_are_met() {
        let k = [0.0, 0.1, 0.22, 0.4, 0.9];
        let f = |k: f64| c64::new((3.0 * k).cos(), k * (1.0 / (0.3 + k * k)));
        for kind in [Interpolation::EvenCubicSpline, Interpolation::Linear] {
            let forces = table(&k, f, kind);
            for &node in &k {
                assert!((at(&forces, node).0 - f(node)).norm() < 1e-14);
            }
            for probe in [0.03, 0.15, 0.33, 0.7, 1.5] {
                let h = 1e-6;
                let difference = (at(&forces, probe + h).0 - at(&forces, probe - h).0) / (2.0 * h);
                assert!((at(&forces, probe).1 - difference).norm() < 1e-7, "{kind:?} {probe}");
            }
        }
    }

    #[test]
    fn bad_tables_are_refused() {
        let one = |v: f64| Mat::from_fn(1, 1, |_, _| c64::new(v, 0.0));
        let kind = Interpolation::EvenCubicSpline;
        assert!(matches!(
            TabulatedForces::new(&[], &[], kind),
            Err(FlutterError::Shape { .. })
        ));
        assert!(matches!(
            TabulatedForces::new(&[0.1, 0.1], &[one(1.0), one(1.0)], kind),
            Err(FlutterError::Value { .. })
        ));
        assert!(matches!(
            TabulatedForces::new(&[0.1], &[one(f64::NAN)], kind),
            Err(FlutterError::NotFinite { .. })
        ));
        assert!(matches!(
            TabulatedForces::new(&[0.0], &[one(1.0)], kind),
            Err(FlutterError::Value { .. })
        ));
        assert!(matches!(
            TabulatedForces::new(&[-0.1], &[one(1.0)], kind),
            Err(FlutterError::Value { .. })
        ));
    }
}
