//! Damping and frequency of modes from time histories of all generalized coordinates.
//!
//! Two steps. A subspace fit (block Hankel matrix, singular value decomposition, shift invariance: Juang and Pappa's
//! eigensystem realization, J. Guidance 8(5) 1985; the same as the matrix pencil of Hua and Sarkar 1990) finds how many
//! exponentials the record holds and where. Then least squares on
//!
//! ```text
//! q_c(t) = offset_c + sum_j Re(a_cj e^{p_j t}),   p_j = sigma_j + i omega_j
//! ```
//!
//! by variable projection (Golub and Pereyra 1973, with Kaufman's Jacobian) makes it the maximum-likelihood answer for
//! white noise and gives standard errors, from which follows how sure the sign of each damping is.

use faer::{Mat, c64};

use crate::error::{FlutterError, Result, check_value};

/// How a record is analysed. The defaults suit a march of one to ten cycles.
#[derive(Debug, Clone, PartialEq)]
pub struct DecaySettings {
    /// Greatest number of exponentials (an oscillating mode is two); `None`: two per channel and four more.
    pub max_order: Option<usize>,
    /// Whether every channel may have a constant offset (a static deflection).
    pub offset: bool,
    /// Iterations of the least-squares step; 0 leaves the subspace answer and gives no standard errors.
    pub iterations: usize,
}

impl Default for DecaySettings {
    fn default() -> Self {
        Self {
            max_order: None,
            offset: true,
            iterations: 20,
        }
    }
}

/// One oscillating mode of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct DecayMode {
    /// p = sigma + i omega, rad/s; sigma > 0 grows.
    pub p_rad_s: c64,
    /// Frequency, Hz.
    pub freq_hz: f64,
    /// g = 2 sigma / omega, positive growing.
    pub g: f64,
    /// Standard error of sigma, rad/s, for the noise that the fit leaves (with its correlation in time).
    pub sigma_error_rad_s: f64,
    /// Standard error of omega, rad/s.
    pub omega_error_rad_s: f64,
    /// Probability that the sign of the damping is right, 0.5 to 1.
    pub confidence: f64,
    /// Complex amplitude of each channel at the first sample.
    pub amplitude: Vec<c64>,
    /// Part of the record's energy (sum of squares, each channel scaled to its rms) that the mode holds alone.
    pub energy: f64,
}

/// What a record holds.
#[derive(Debug, Clone, PartialEq)]
pub struct DecayFit {
    /// Oscillating modes, most energy first.
    pub modes: Vec<DecayMode>,
    /// Rates of non-oscillating exponentials, 1/s.
    pub real_rates_1_s: Vec<f64>,
    /// Offset of each channel.
    pub offsets: Vec<f64>,
    /// Rms of what the fit leaves over the rms of the record, channels scaled to their rms.
    pub residual: f64,
    /// Singular values of the Hankel matrix, for a plot of the gap.
    pub singular_values: Vec<f64>,
}

impl DecayFit {
    /// The mode that grows fastest (or decays slowest) among those with at least `energy` of the record.
    #[must_use]
    pub fn least_stable(&self, energy: f64) -> Option<&DecayMode> {
        self.modes
            .iter()
            .filter(|m| m.energy >= energy)
            .max_by(|a, b| a.p_rad_s.re.total_cmp(&b.p_rad_s.re))
    }
}

/// Rows of the Hankel matrix at most, over all channels.
const MAX_ROWS: usize = 240;
/// Columns of the Hankel matrix at most.
const MAX_COLUMNS: usize = 400;

/// Identifies modes from `histories [channel][sample]` taken every `dt_s` seconds.
///
/// # Errors
/// No channel, unequal lengths, fewer than 12 samples, numbers that are not finite, a constant record.
pub fn identify(histories: &[Vec<f64>], dt_s: f64, settings: &DecaySettings) -> Result<DecayFit> {
    let (samples, scales) = check_record(histories, dt_s)?;
    let channels: Vec<usize> = (0..histories.len()).filter(|&c| scales[c] > 0.0).collect();
    let max_order = settings.max_order.unwrap_or(2 * channels.len() + 4);
    // Scaled copies: every channel that moves counts alike.
    let scaled: Vec<Vec<f64>> = channels
        .iter()
        .map(|&c| histories[c].iter().map(|v| v / scales[c]).collect())
        .collect();
    let (poles, singular_values) = subspace(&scaled, dt_s, max_order, settings.offset)?;
    let mut fit = Projection::new(poles, &scaled, dt_s, settings.offset);
    let errors = fit.refine(settings.iterations);
    let total: f64 = scaled.iter().flatten().map(|v| v * v).sum();

    let mut modes = Vec::new();
    let mut real_rates_1_s = Vec::new();
    let mut place = 0;
    for (index, pole) in fit.poles.iter().enumerate() {
        let (sigma_error, omega_error) = errors.as_ref().map_or((f64::INFINITY, f64::INFINITY), |e| e[index]);
        if pole.im == 0.0 {
            real_rates_1_s.push(pole.re);
            place += 1;
            continue;
        }
        let mut amplitude = vec![c64::new(0.0, 0.0); histories.len()];
        let mut energy = 0.0;
        for (row, &c) in channels.iter().enumerate() {
            // a Re + b Im parts: Re((a - i b)(cos + i sin)).
            let scaled = c64::new(fit.linear[(place, row)], -fit.linear[(place + 1, row)]);
            amplitude[c] = scaled * scales[c];
            energy += (0..samples)
                .map(|j| (scaled * (*pole * (j as f64 * dt_s)).exp()).re.powi(2))
                .sum::<f64>();
        }
        place += 2;
        modes.push(DecayMode {
            p_rad_s: *pole,
            freq_hz: pole.im / std::f64::consts::TAU,
            g: 2.0 * pole.re / pole.im,
            sigma_error_rad_s: sigma_error,
            omega_error_rad_s: omega_error,
            confidence: normal_probability(pole.re.abs() / sigma_error),
            amplitude,
            energy: energy / total,
        });
    }
    modes.sort_by(|a, b| b.energy.total_cmp(&a.energy));
    let mut offsets = vec![0.0; histories.len()];
    if settings.offset {
        for (row, &c) in channels.iter().enumerate() {
            offsets[c] = fit.linear[(place, row)] * scales[c];
        }
    }
    for c in 0..histories.len() {
        if scales[c] == 0.0 {
            offsets[c] = histories[c][0];
        }
    }
    Ok(DecayFit {
        modes,
        real_rates_1_s,
        offsets,
        residual: (fit.sum_of_squares / total).sqrt(),
        singular_values,
    })
}

/// Number of samples and the rms of each channel about its mean (zero for a channel that does not move).
fn check_record(histories: &[Vec<f64>], dt_s: f64) -> Result<(usize, Vec<f64>)> {
    check_value("time step, s", dt_s, "above zero", dt_s > 0.0)?;
    let samples = histories.first().map_or(0, Vec::len);
    if samples < 12 || histories.iter().any(|h| h.len() != samples) {
        return Err(FlutterError::Shape {
            what: "time histories".into(),
            needed: "at least one channel and 12 samples, as many in every channel".into(),
            got: format!("{} channels, {} samples", histories.len(), samples),
        });
    }
    let mut scales = Vec::with_capacity(histories.len());
    for (channel, history) in histories.iter().enumerate() {
        for (sample, &value) in history.iter().enumerate() {
            if !value.is_finite() {
                let what = "time histories (row = channel, column = sample)".into();
                return Err(FlutterError::NotFinite {
                    what,
                    row: channel,
                    column: sample,
                    value,
                });
            }
        }
        let mean = history.iter().sum::<f64>() / samples as f64;
        let rms = (history.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / samples as f64).sqrt();
        let size = history.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        scales.push(if rms > 1e-13 * size { rms } else { 0.0 });
    }
    if scales.iter().all(|&s| s == 0.0) {
        return Err(FlutterError::Value {
            what: "rms of the time histories about their mean".into(),
            needed: "above zero in at least one channel".into(),
            got: 0.0,
        });
    }
    Ok((samples, scales))
}

/// Poles (upper half plane and real axis) and singular values.
fn subspace(scaled: &[Vec<f64>], dt_s: f64, max_order: usize, offset: bool) -> Result<(Vec<c64>, Vec<f64>)> {
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
    use faer::linalg::solvers::SolveLstsq;
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

/// The separable least-squares problem: poles are nonlinear, amplitudes and offsets linear.
struct Projection<'a> {
    poles: Vec<c64>,
    data: &'a [Vec<f64>],
    dt_s: f64,
    offset: bool,
    /// Linear coefficients [basis function][channel].
    linear: Mat<f64>,
    /// What the fit leaves [sample][channel].
    rest: Mat<f64>,
    sum_of_squares: f64,
}

impl<'a> Projection<'a> {
    fn new(poles: Vec<c64>, data: &'a [Vec<f64>], dt_s: f64, offset: bool) -> Self {
        let mut own = Self {
            poles,
            data,
            dt_s,
            offset,
            linear: Mat::new(),
            rest: Mat::new(),
            sum_of_squares: f64::INFINITY,
        };
        let (_, linear, rest, sum) = own.project(&own.poles);
        own.linear = linear;
        own.rest = rest;
        own.sum_of_squares = sum;
        own
    }

    fn samples(&self) -> usize {
        self.data[0].len()
    }

    /// Basis functions: e^{sigma t} cos, e^{sigma t} sin (one exponential for a real pole), constant. Growing ones count from
    /// the end of the record, so that none overflows or dwarfs the rest.
    fn basis(&self, poles: &[c64]) -> Mat<f64> {
        let n = self.samples();
        let width = poles.iter().map(|p| if p.im == 0.0 { 1 } else { 2 }).sum::<usize>() + usize::from(self.offset);
        let mut basis = Mat::<f64>::zeros(n, width);
        for row in 0..n {
            let t = row as f64 * self.dt_s;
            let mut column = 0;
            for p in poles {
                let z = (*p * t).exp();
                basis[(row, column)] = z.re;
                column += 1;
                if p.im != 0.0 {
                    basis[(row, column)] = z.im;
                    column += 1;
                }
            }
            if self.offset {
                basis[(row, column)] = 1.0;
            }
        }
        basis
    }

    /// Orthonormal basis, linear coefficients, rest and its sum of squares.
    fn project(&self, poles: &[c64]) -> (Mat<f64>, Mat<f64>, Mat<f64>, f64) {
        let basis = self.basis(poles);
        let (n, channels) = (self.samples(), self.data.len());
        let data = Mat::<f64>::from_fn(n, channels, |i, c| self.data[c][i]);
        let qr = basis.qr();
        use faer::linalg::solvers::SolveLstsq;
        let linear = qr.solve_lstsq(&data);
        let rest = &data - &basis * &linear;
        let mut sum = 0.0;
        for c in 0..channels {
            for i in 0..n {
                sum += rest[(i, c)] * rest[(i, c)];
            }
        }
        (
            qr.compute_thin_Q(),
            linear,
            rest,
            if sum.is_finite() { sum } else { f64::INFINITY },
        )
    }

    /// Jacobian of the rest in the nonlinear parameters (sigma, and omega of oscillating poles), projected off the basis
    /// (Kaufman): one column per parameter, samples of all channels below each other.
    fn jacobian(&self, q: &Mat<f64>) -> Mat<f64> {
        let (n, channels) = (self.samples(), self.data.len());
        let count = self.parameter_count();
        let mut jacobian = Mat::<f64>::zeros(n * channels, count);
        for c in 0..channels {
            let (mut column, mut place) = (0, 0);
            let mut block = Mat::<f64>::zeros(n, count);
            for p in &self.poles {
                let oscillating = p.im != 0.0;
                let a = c64::new(
                    self.linear[(place, c)],
                    if oscillating { -self.linear[(place + 1, c)] } else { 0.0 },
                );
                for i in 0..n {
                    let t = i as f64 * self.dt_s;
                    let motion = a * (*p * t).exp() * t;
                    block[(i, column)] = motion.re;
                    if oscillating {
                        block[(i, column + 1)] = -motion.im;
                    }
                }
                column += if oscillating { 2 } else { 1 };
                place += if oscillating { 2 } else { 1 };
            }
            let projected = &block - q * (q.transpose() * &block);
            for j in 0..count {
                for i in 0..n {
                    jacobian[(c * n + i, j)] = projected[(i, j)];
                }
            }
        }
        jacobian
    }

    fn parameter_count(&self) -> usize {
        self.poles.iter().map(|p| if p.im == 0.0 { 1 } else { 2 }).sum()
    }

    /// Gauss-Newton with Levenberg's damping; standard errors (sigma, omega) of each pole at the end.
    fn refine(&mut self, iterations: usize) -> Option<Vec<(f64, f64)>> {
        if iterations == 0 {
            return None;
        }
        let mut damping = 1e-6;
        for _ in 0..iterations {
            let (q, ..) = self.project(&self.poles);
            let jacobian = self.jacobian(&q);
            let stacked = self.stacked_rest();
            let gradient = jacobian.transpose() * &stacked;
            let normal = jacobian.transpose() * &jacobian;
            let before = self.sum_of_squares;
            for _ in 0..8 {
                let step = solve_damped(&normal, &gradient, damping);
                let trial = self.moved(&step);
                let (_, linear, rest, sum) = self.project(&trial);
                if sum <= self.sum_of_squares {
                    self.poles = trial;
                    self.linear = linear;
                    self.rest = rest;
                    self.sum_of_squares = sum;
                    damping = (damping * 0.1).max(1e-14);
                    break;
                }
                damping *= 10.0;
            }
            if before - self.sum_of_squares <= 1e-10 * before {
                break;
            }
        }
        Some(self.standard_errors())
    }

    fn stacked_rest(&self) -> Mat<f64> {
        let n = self.samples();
        Mat::from_fn(n * self.data.len(), 1, |i, _| self.rest[(i % n, i / n)])
    }

    fn moved(&self, step: &Mat<f64>) -> Vec<c64> {
        let mut column = 0;
        self.poles
            .iter()
            .map(|p| {
                let real = step[(column, 0)];
                let imaginary = if p.im == 0.0 { 0.0 } else { step[(column + 1, 0)] };
                column += if p.im == 0.0 { 1 } else { 2 };
                let moved = p + c64::new(real, imaginary);
                if p.im > 0.0 && moved.im <= 0.0 { *p } else { moved }
            })
            .collect()
    }

    /// sqrt of the diagonal of s^2 (J^T J)^-1; s^2 from the rest and its degrees of freedom, times (1 + r)/(1 - r) for rests
    /// with correlation r from sample to sample (model errors are not white).
    fn standard_errors(&self) -> Vec<(f64, f64)> {
        let (n, channels) = (self.samples(), self.data.len());
        let (q, ..) = self.project(&self.poles);
        let jacobian = self.jacobian(&q);
        let normal = jacobian.transpose() * &jacobian;
        let unknowns = self.parameter_count() + self.linear.nrows() * channels;
        let freedom = (n * channels).saturating_sub(unknowns).max(1) as f64;
        let (mut product, mut square) = (0.0, f64::MIN_POSITIVE);
        for c in 0..channels {
            for i in 1..n {
                product += self.rest[(i, c)] * self.rest[(i - 1, c)];
                square += self.rest[(i, c)] * self.rest[(i, c)];
            }
        }
        let correlation = (product / square).clamp(0.0, 0.98);
        let variance = self.sum_of_squares / freedom * (1.0 + correlation) / (1.0 - correlation);
        let inverse = inverse_diagonal(&normal);
        let mut column = 0;
        self.poles
            .iter()
            .map(|p| {
                let sigma = (variance * inverse[column]).sqrt();
                let omega = if p.im == 0.0 {
                    0.0
                } else {
                    (variance * inverse[column + 1]).sqrt()
                };
                column += if p.im == 0.0 { 1 } else { 2 };
                (sigma, omega)
            })
            .collect()
    }
}

/// (N + damping diag N)^-1 gradient.
fn solve_damped(normal: &Mat<f64>, gradient: &Mat<f64>, damping: f64) -> Mat<f64> {
    let n = normal.nrows();
    let largest = (0..n)
        .fold(0.0_f64, |m, i| m.max(normal[(i, i)]))
        .max(f64::MIN_POSITIVE);
    let damped = Mat::from_fn(n, n, |i, j| {
        normal[(i, j)]
            + if i == j {
                damping * normal[(i, i)] + 1e-15 * largest
            } else {
                0.0
            }
    });
    use faer::linalg::solvers::Solve;
    damped.partial_piv_lu().solve(gradient)
}

/// Diagonal of N^-1 (infinite where N is singular).
fn inverse_diagonal(normal: &Mat<f64>) -> Vec<f64> {
    use faer::linalg::solvers::Solve;
    let n = normal.nrows();
    let inverse = normal.partial_piv_lu().solve(&Mat::<f64>::identity(n, n));
    (0..n)
        .map(|i| {
            if inverse[(i, i)] > 0.0 {
                inverse[(i, i)]
            } else {
                f64::INFINITY
            }
        })
        .collect()
}

/// Probability that a normal variable lies below `x` standard deviations (Abramowitz and Stegun 7.1.26, error 1.5e-7).
fn normal_probability(x: f64) -> f64 {
    if x.is_nan() {
        return 0.5;
    }
    let z = x / std::f64::consts::SQRT_2;
    let t = 1.0 / (1.0 + 0.327_591_1 * z);
    let poly =
        t * (0.254_829_592 + t * (-0.284_496_736 + t * (1.421_413_741 + t * (-1.453_152_027 + t * 1.061_405_429))));
    1.0 - 0.5 * poly * (-z * z).exp()
}
