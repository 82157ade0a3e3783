//! The curve through a table of ordinates: a cubic spline in the root of x, which is smooth round the nose.

/// Cubic spline z(t) with x = t^2 through every point; the third derivative vanishes in the end intervals.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Spline {
    t: Vec<f64>,
    z: Vec<f64>,
    /// Second derivatives at the points, one list for each side of the nose (they differ there if the slope is given).
    curvature: Vec<[f64; 2]>,
}

impl Spline {
    /// `t` ascending with one zero entry. With `nose_slope` the curve is split at the nose into two splines that start
    /// with this slope, which is a given nose radius.
    pub(super) fn new(t: Vec<f64>, z: Vec<f64>, nose_slope: Option<f64>) -> Self {
        let n = t.len();
        let mut curvature = vec![[0.0; 2]; n];
        match (nose_slope, t.iter().position(|&v| v == 0.0)) {
            (Some(slope), Some(nose)) => {
                let low = second_derivatives(&t[..=nose], &z[..=nose], None, Some(slope));
                let high = second_derivatives(&t[nose..], &z[nose..], Some(slope), None);
                for (m, &c) in low.iter().enumerate() {
                    curvature[m] = [c; 2];
                }
                for (m, &c) in high.iter().enumerate() {
                    curvature[nose + m][1] = c;
                    if m > 0 {
                        curvature[nose + m][0] = c;
                    }
                }
            }
            _ => {
                for (m, c) in second_derivatives(&t, &z, None, None).into_iter().enumerate() {
                    curvature[m] = [c; 2];
                }
            }
        }
        Self { t, z, curvature }
    }

    pub(super) fn value(&self, t: f64) -> f64 {
        let n = self.t.len();
        let m = self.t.partition_point(|&v| v <= t).clamp(1, n - 1) - 1;
        let h = self.t[m + 1] - self.t[m];
        let (a, b) = ((self.t[m + 1] - t) / h, (t - self.t[m]) / h);
        a * self.z[m]
            + b * self.z[m + 1]
            + ((a * a * a - a) * self.curvature[m][1] + (b * b * b - b) * self.curvature[m + 1][0]) * h * h / 6.0
    }
}

/// Second derivatives of the cubic spline through `(t, z)`: clamped where a slope is given, else with equal second
/// derivatives at the last two points.
fn second_derivatives(t: &[f64], z: &[f64], first: Option<f64>, last: Option<f64>) -> Vec<f64> {
    let n = t.len();
    let mut lower = vec![0.0; n];
    let mut diagonal = vec![1.0; n];
    let mut upper = vec![0.0; n];
    let mut rhs = vec![0.0; n];
    let step = |m: usize| t[m + 1] - t[m];
    let rise = |m: usize| (z[m + 1] - z[m]) / step(m);
    for m in 1..n - 1 {
        lower[m] = step(m - 1) / 6.0;
        diagonal[m] = (step(m - 1) + step(m)) / 3.0;
        upper[m] = step(m) / 6.0;
        rhs[m] = rise(m) - rise(m - 1);
    }
    match first {
        Some(slope) => {
            diagonal[0] = step(0) / 3.0;
            upper[0] = step(0) / 6.0;
            rhs[0] = rise(0) - slope;
        }
        None => upper[0] = -1.0,
    }
    match last {
        Some(slope) => {
            diagonal[n - 1] = step(n - 2) / 3.0;
            lower[n - 1] = step(n - 2) / 6.0;
            rhs[n - 1] = slope - rise(n - 2);
        }
        None => lower[n - 1] = -1.0,
    }
    for m in 1..n {
        let f = lower[m] / diagonal[m - 1];
        diagonal[m] -= f * upper[m - 1];
        rhs[m] -= f * rhs[m - 1];
    }
    rhs[n - 1] /= diagonal[n - 1];
    for m in (0..n - 1).rev() {
        rhs[m] = (rhs[m] - upper[m] * rhs[m + 1]) / diagonal[m];
    }
    rhs
}
