//! How many exponentials a record holds and where: the subspace step.

use faer::linalg::solvers::SolveLstsq;
use faer::{Mat, c64};

use crate::error::{FlutterError, Result};

/// Rows of the Hankel matrix at most, over all channels.
const MAX_ROWS: usize = 240;
/// Columns of the Hankel matrix at most.
const MAX_COLUMNS: usize = 400;

/// Poles (upper half plane and real axis) and singular values.
pub(super) fn subspace(scaled: &[Vec<f64>], dt_s: f64, max_order: usize, offset: bool) -> Result<(Vec<c64>, Vec<f64>)> {
    let samples = scaled[0].len();
    // The mean goes out so that an offset does not outweigh the motion; what is left of it is a pole next to zero, which the
    // offset of the least-squares step replaces. (Differencing would remove it too, but multiplies the noise.)
    let mean = |h: &[f64]| {
        if offset {
            h.iter().sum::<f64>() / h.len() as f64
        } else {
            0.0
        }
    };
    let data: Vec<Vec<f64>> = scaled
        .iter()
        .map(|h| {
            let mean = mean(h);
            h.iter().map(|v| v - mean).collect()
        })
        .collect();
    let length = data[0].len();
    let channels = data.len();
    // A finely sampled record takes every stride-th sample down the rows, so that they still span a good part of a cycle; the
    // stride stays a quarter of the Nyquist limit of the rms frequency of the record, which noise pushes up (to stride 1).
    let energy: f64 = data.iter().flatten().map(|v| v * v).sum();
    let change: f64 = data
        .iter()
        .flat_map(|h| h.windows(2))
        .map(|w| (w[1] - w[0]).powi(2))
        .sum();
    let angle = (change / energy).sqrt().max(1e-12);
    let wanted_rows = (MAX_ROWS / channels).clamp(4, (length / 2).max(4));
    let stride = ((std::f64::consts::PI / (4.0 * angle)) as usize).clamp(1, (length / (2 * wanted_rows)).max(1));
    let rows = wanted_rows.min(length / (2 * stride)).max(2);
    let last_start = length - (rows - 1) * stride;
    let column_step = last_start.div_ceil(MAX_COLUMNS).max(1);
    let columns = last_start.div_ceil(column_step);
    let hankel = Mat::<f64>::from_fn(rows * channels, columns, |i, j| {
        data[i % channels][(i / channels) * stride + j * column_step]
    });
    let fail = || FlutterError::Eigen {
        at: format!("singular values of the Hankel matrix, {samples} samples"),
    };
    let svd = hankel.thin_svd().map_err(|_| fail())?;
    let singular: Vec<f64> = svd.S().column_vector().iter().copied().collect();
    let limit = max_order.min(columns).min((rows - 1) * channels).min(singular.len());
    let order = model_order(&singular, rows * channels, columns).clamp(1, limit.max(1));

    // U_up A = U_down in the least-squares sense; eigenvalues of A are the poles over `stride` samples.
    let split = (rows - 1) * channels;
    let u = svd.U();
    let up = Mat::<f64>::from_fn(split, order, |i, j| u[(i, j)]);
    let down = Mat::<f64>::from_fn(split, order, |i, j| u[(i + channels, j)]);
    let shift = up.qr().solve_lstsq(&down);
    let eigenvalues = shift.eigenvalues().map_err(|_| fail())?;
    let interval = dt_s * stride as f64;
    let poles = eigenvalues
        .into_iter()
        .filter(|z| z.norm() > 1e-3 && z.im >= 0.0)
        .filter(|z| !(z.im.abs() <= 1e-12 * z.norm() && z.re <= 0.0))
        .map(|z| {
            let z = if z.im.abs() <= 1e-12 * z.norm() {
                c64::new(z.re, 0.0)
            } else {
                z
            };
            z.ln() / interval
        })
        // Exponentials gone within two samples describe noise, not motion.
        .filter(|p| p.re.abs() * dt_s < 1.0)
        .filter(|p| !(offset && p.norm() * dt_s * (samples as f64) < 1.0))
        .collect::<Vec<_>>();
    if poles.is_empty() {
        return Err(FlutterError::Value {
            what: "number of exponentials found in the time histories".into(),
            needed: "at least one; take a longer record".into(),
            got: 0.0,
        });
    }
    Ok((poles, singular))
}

/// Singular values above the noise: Gavish and Donoho's optimal threshold (IEEE Trans. Inf. Theory 60(8), 2014) for unknown
/// noise, omega(beta) times the median, and never below round-off.
fn model_order(singular: &[f64], rows: usize, columns: usize) -> usize {
    let beta = rows.min(columns) as f64 / rows.max(columns) as f64;
    let omega = 0.56 * beta.powi(3) - 0.95 * beta.powi(2) + 1.82 * beta + 1.43;
    let median = singular[singular.len() / 2];
    let floor = 1e-11 * singular[0];
    singular.iter().filter(|&&s| s > (omega * median).max(floor)).count()
}
