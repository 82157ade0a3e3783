//! Exponentials by separable least squares, with standard errors.

use faer::linalg::solvers::{Solve, SolveLstsq};
use faer::{Mat, c64};

use super::noise::Noise;

/// The separable least-squares problem: poles are nonlinear, amplitudes and offsets linear.
pub(super) struct Projection<'a> {
    pub poles: Vec<c64>,
    data: &'a [Vec<f64>],
    dt_s: f64,
    offset: bool,
    /// Linear coefficients [basis function][channel].
    pub linear: Mat<f64>,
    /// What the fit leaves [sample][channel].
    rest: Mat<f64>,
    pub sum_of_squares: f64,
}

impl<'a> Projection<'a> {
    pub fn new(poles: Vec<c64>, data: &'a [Vec<f64>], dt_s: f64, offset: bool) -> Self {
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

    /// Basis functions: e^{sigma t} cos, e^{sigma t} sin (one exponential for a real pole), constant.
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
    pub fn refine(&mut self, iterations: usize) -> Option<Vec<(f64, f64)>> {
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

    /// Standard errors of sigma and omega of every pole.
    ///
    /// Exponentials that hold less than what the fit leaves cannot be told from noise: the subspace step finds a few
    /// in noise that is not white. Their motion counts as noise, or the noise would seem smaller than it is.
    fn standard_errors(&self) -> Vec<(f64, f64)> {
        let (q, ..) = self.project(&self.poles);
        let jacobian = self.jacobian(&q);
        let sizes = self.sizes();
        let clear = |(size, _): &(f64, c64)| *size > self.sum_of_squares;
        let poles: Vec<c64> = sizes
            .into_iter()
            .zip(self.poles.iter().copied())
            .filter(clear)
            .map(|(_, p)| p)
            .collect();
        let noise = if poles.is_empty() || poles.len() == self.poles.len() {
            Noise::behind(self.rest.as_ref(), q.as_ref(), jacobian.as_ref())
        } else {
            let fewer = Self::new(poles, self.data, self.dt_s, self.offset);
            let (q, ..) = fewer.project(&fewer.poles);
            Noise::behind(fewer.rest.as_ref(), q.as_ref(), fewer.jacobian(&q).as_ref())
        };
        let mut errors = noise.standard_errors(jacobian.as_ref()).into_iter();
        let mut next = || errors.next().unwrap_or(f64::INFINITY);
        self.poles
            .iter()
            .map(|p| (next(), if p.im == 0.0 { 0.0 } else { next() }))
            .collect()
    }

    /// Sum of squares of the motion of each pole alone, over all channels.
    fn sizes(&self) -> Vec<f64> {
        let mut place = 0;
        self.poles
            .iter()
            .map(|p| {
                let oscillating = p.im != 0.0;
                let mut size = 0.0;
                for c in 0..self.data.len() {
                    let b = if oscillating { -self.linear[(place + 1, c)] } else { 0.0 };
                    let a = c64::new(self.linear[(place, c)], b);
                    size += (0..self.samples())
                        .map(|i| (a * (*p * (i as f64 * self.dt_s)).exp()).re.powi(2))
                        .sum::<f64>();
                }
                place += if oscillating { 2 } else { 1 };
                size
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
    damped.partial_piv_lu().solve(gradient)
}
