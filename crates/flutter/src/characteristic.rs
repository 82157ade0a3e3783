//! The flutter equation of the p methods at one condition, and Newton's method for one of its roots.
//!
//! ```text
//! F(sigma, omega) = M p^2 + B p + K + i H - q_dyn [Q(k) + (sigma b / U) D(k)],   p = sigma + i omega,  k = omega b / U
//! ```
//!
//! H is the hysteretic stiffness (absent at omega = 0). D is what a method takes for the change of Q with damping:
//! Im Q / k for Nastran's PK, since (Im Q / k)(p b / U) = i Im Q + (sigma b / U) Im Q / k; zero for Hassig's; dQ/d(ik) =
//! -i dQ/dk for the g-method (Chen, J. Aircraft 37(5), 2000). Where Q is Q_R + i k Q' with constants, PK and g are the same.

use faer::{Mat, c64};

use crate::error::Result;
use crate::forces::KRange;
use crate::linear::{Lu, bilinear, eigenvalues_quadratic, normalize};
use crate::problem::{Condition, FlutterProblem};
use crate::solution::Method;
use crate::structure::columns;

/// First-order change of Q with sigma b / U.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DampingExpansion {
    Rodden,
    Hassig,
    Chen,
}

impl DampingExpansion {
    /// The expansion of a p method; K methods have none and give Hassig's, which is the plain Q(k).
    pub fn of(method: Method) -> Self {
        match method {
            Method::Pk => Self::Rodden,
            Method::G => Self::Chen,
            Method::K | Method::Ke | Method::PkHassig => Self::Hassig,
        }
    }
}

/// A root with its right and left vectors.
#[derive(Debug, Clone)]
pub(crate) struct Root {
    pub p: c64,
    /// Right vector, unit mass norm.
    pub x: Vec<c64>,
    /// Left vector, unit Euclidean norm.
    pub y: Vec<c64>,
    /// Whether it is a real root, kept on the real axis.
    pub real: bool,
}

/// Matrices of the equation and work space. Column-major slices of n * n.
pub(crate) struct Characteristic<'a> {
    pub n: usize,
    problem: FlutterProblem<'a>,
    expansion: DampingExpansion,
    mass: Vec<c64>,
    viscous: Vec<c64>,
    stiffness: Vec<c64>,
    hysteretic: Vec<c64>,
    /// Weight of the modal assurance criterion.
    mass_real: Mat<f64>,
    q: Mat<c64>,
    slope: Mat<c64>,
    slope_ahead: Mat<c64>,
    f: Vec<c64>,
    work: Vec<c64>,
    lu: Lu,
    /// Greatest rate worth telling from zero, rad/s: sets absolute tolerances.
    pub scale_rad_s: f64,
}

impl<'a> Characteristic<'a> {
    pub fn new(problem: &FlutterProblem<'a>, expansion: DampingExpansion) -> Self {
        let n = problem.structure.size();
        let zero = vec![c64::new(0.0, 0.0); n * n];
        let scale = problem
            .structure
            .natural
            .omega_rad_s
            .iter()
            .fold(0.0_f64, |m, &w| m.max(w));
        Self {
            n,
            problem: *problem,
            expansion,
            mass: columns(&problem.structure.mass),
            viscous: columns(&problem.structure.viscous_total()),
            stiffness: columns(&problem.structure.stiffness),
            hysteretic: columns(&problem.structure.hysteretic()),
            mass_real: problem.structure.mass.clone(),
            q: Mat::zeros(n, n),
            slope: Mat::zeros(n, n),
            slope_ahead: Mat::zeros(n, n),
            f: zero.clone(),
            work: zero,
            lu: Lu::new(n),
            scale_rad_s: if scale > 0.0 { scale } else { 1.0 },
        }
    }

    /// Drops B, as KE does.
    pub fn leave_out_viscous_damping(&mut self) {
        self.viscous.fill(c64::new(0.0, 0.0));
    }

    /// Natural modes: omega in rad/s and shape.
    pub fn natural_modes(&self) -> Vec<(f64, Vec<c64>)> {
        let natural = &self.problem.structure.natural;
        let shape = |j: usize| (0..self.n).map(|i| c64::new(natural.shapes[(i, j)], 0.0)).collect();
        natural
            .omega_rad_s
            .iter()
            .enumerate()
            .map(|(j, &omega)| (omega, shape(j)))
            .collect()
    }

    /// Reference semichord, m.
    pub fn semichord_m(&self) -> f64 {
        self.problem.semichord_m
    }

    /// k of a frequency at a condition.
    pub fn reduced_frequency(&self, omega_rad_s: f64, condition: Condition) -> f64 {
        omega_rad_s.abs() * self.problem.semichord_m / condition.speed_m_s
    }

    /// Where k lies in the data.
    pub fn k_range(&self, k: f64) -> KRange {
        self.problem.forces.domain().locate(k)
    }

    fn load(&mut self, k: f64) -> Result<()> {
        self.problem
            .forces
            .q_and_slope(k, self.q.as_mut(), self.slope.as_mut())?;
        crate::forces::check_finite(&format!("generalized forces at k = {k:.6}"), self.q.as_ref())?;
        crate::forces::check_finite(
            &format!("slope of the generalized forces at k = {k:.6}"),
            self.slope.as_ref(),
        )
    }

    /// D(k) of one entry from Q and dQ/dk there. Next to zero Im Q / k is Im dQ/dk.
    fn damping_entry(&self, i: usize, j: usize, k: f64) -> c64 {
        let (q, slope) = (self.q[(i, j)], self.slope[(i, j)]);
        match self.expansion {
            DampingExpansion::Rodden if k > 1e-6 => c64::new(q.im / k, 0.0),
            DampingExpansion::Rodden => c64::new(slope.im, 0.0),
            DampingExpansion::Hassig => c64::new(0.0, 0.0),
            // At k = 0 Q is real for real p, so its derivative is real too.
            DampingExpansion::Chen if k == 0.0 => c64::new(slope.im, 0.0),
            DampingExpansion::Chen => c64::new(slope.im, -slope.re),
        }
    }

    /// Fills `self.f` with F at p, assuming that `load(k)` was called for its k.
    fn assemble(&mut self, p: c64, k: f64, condition: Condition, out_work: bool) {
        let n = self.n;
        let oscillating = p.im > 0.0;
        let pressure = condition.dynamic_pressure();
        let decay = p.re * self.problem.semichord_m / condition.speed_m_s;
        let p2 = p * p;
        for j in 0..n {
            for i in 0..n {
                let e = j * n + i;
                let mut aero = self.q[(i, j)] + self.damping_entry(i, j, k) * decay;
                let mut value = self.mass[e] * p2 + self.viscous[e] * p + self.stiffness[e];
                if oscillating {
                    value += c64::new(0.0, 1.0) * self.hysteretic[e];
                } else {
                    aero.im = 0.0;
                }
                let target = if out_work { &mut self.work } else { &mut self.f };
                target[e] = value - aero * pressure;
            }
        }
    }

    /// dF/dsigma and dF/domega contracted with y and x. `load(k)` must have been called.
    fn slopes(&mut self, p: c64, k: f64, condition: Condition, y: &[c64], x: &[c64]) -> Result<(c64, c64)> {
        let n = self.n;
        let length = self.problem.semichord_m / condition.speed_m_s;
        let pressure = condition.dynamic_pressure();
        let decay = p.re * length;
        let chen_step = 1e-4 * k.max(1e-3);
        let chen = self.expansion == DampingExpansion::Chen && decay != 0.0;
        if chen {
            let mut unused = Mat::<c64>::zeros(n, n);
            self.problem
                .forces
                .q_and_slope(k + chen_step, unused.as_mut(), self.slope_ahead.as_mut())?;
        }
        let (mut sigma, mut omega) = (c64::new(0.0, 0.0), c64::new(0.0, 0.0));
        for (j, xj) in x.iter().enumerate() {
            let (mut column_sigma, mut column_omega) = (c64::new(0.0, 0.0), c64::new(0.0, 0.0));
            for (i, yi) in y.iter().enumerate() {
                let e = j * n + i;
                let structural = self.mass[e] * p * 2.0 + self.viscous[e];
                let d = self.damping_entry(i, j, k);
                let bend = match self.expansion {
                    DampingExpansion::Rodden if k > 1e-6 => {
                        c64::new((self.slope[(i, j)].im - self.q[(i, j)].im / k) / k, 0.0)
                    }
                    DampingExpansion::Chen if chen => {
                        let second = (self.slope_ahead[(i, j)] - self.slope[(i, j)]) / chen_step;
                        c64::new(second.im, -second.re)
                    }
                    _ => c64::new(0.0, 0.0),
                };
                column_sigma += yi.conj() * (structural - d * (pressure * length));
                let aero = (self.slope[(i, j)] + bend * decay) * (pressure * length);
                column_omega += yi.conj() * (c64::new(0.0, 1.0) * structural - aero);
            }
            sigma += column_sigma * xj;
            omega += column_omega * xj;
        }
        Ok((sigma, omega))
    }

    /// Newton's method for the root next to `start`; `None` when it does not converge or leaves the upper half plane.
    ///
    /// Vectors by inverse iteration with F(p) and its adjoint; the step solves y^H F(p) x = 0 for (sigma, omega) as two real
    /// unknowns, since F depends on omega through k and so is not analytic in p.
    pub fn correct(&mut self, start: &Root, condition: Condition) -> Result<Option<Root>> {
        let mut root = start.clone();
        let floor = 1e-13 * self.scale_rad_s;
        let mut best_step = f64::INFINITY;
        for iteration in 0..40 {
            let k = self.reduced_frequency(root.p.im, condition);
            self.load(k)?;
            self.assemble(root.p, k, condition, false);
            self.lu.factor(&self.f);
            for _ in 0..if iteration == 0 { 2 } else { 1 } {
                self.lu.solve(&mut root.x);
                self.lu.solve_adjoint(&mut root.y);
                if !normalize(&mut root.x) || !normalize(&mut root.y) {
                    return Ok(None);
                }
            }
            let f = bilinear(&root.y, &self.f, &root.x);
            let (slope_sigma, slope_omega) = self.slopes(root.p, k, condition, &root.y, &root.x)?;
            let mut step = if root.real {
                c64::new(
                    -(f.re * slope_sigma.re + f.im * slope_sigma.im) / slope_sigma.norm_sqr(),
                    0.0,
                )
            } else {
                solve_real_pair(slope_sigma, slope_omega, -f)
            };
            if !(step.re.is_finite() && step.im.is_finite()) {
                return Ok(None);
            }
            let size = root.p.norm().max(1e-3 * self.scale_rad_s);
            let length = step.norm();
            if length > 0.3 * size {
                step *= 0.3 * size / length;
            }
            root.p += step;
            if !root.real && root.p.im <= 0.0 {
                return Ok(None);
            }
            let length = step.norm();
            if length <= 4e-15 * root.p.norm() + floor * 1e-2
                || (length <= 1e-11 * size + floor && length >= 0.25 * best_step)
            {
                self.finish(&mut root);
                return Ok(Some(root));
            }
            best_step = best_step.min(length);
        }
        // A table with kinks can keep the step from falling to round-off; 1e-9 is then the honest limit.
        if best_step <= 1e-9 * root.p.norm() + floor {
            self.finish(&mut root);
            return Ok(Some(root));
        }
        Ok(None)
    }

    /// Unit mass norm, largest entry real.
    fn finish(&self, root: &mut Root) {
        scale_shape(&self.mass_real, &mut root.x);
    }

    /// dp/dt along a path of conditions, by implicit differentiation of y^H F x = 0 (central differences of F in t).
    pub fn rate(&mut self, root: &Root, at: Condition, before: Condition, after: Condition, dt: f64) -> Result<c64> {
        let mut change = c64::new(0.0, 0.0);
        for (condition, sign) in [(after, 1.0), (before, -1.0)] {
            let k = self.reduced_frequency(root.p.im, condition);
            self.load(k)?;
            self.assemble(root.p, k, condition, true);
            change += bilinear(&root.y, &self.work, &root.x) * sign;
        }
        let change = change / dt;
        let k = self.reduced_frequency(root.p.im, at);
        self.load(k)?;
        let (slope_sigma, slope_omega) = self.slopes(root.p, k, at, &root.y, &root.x)?;
        let rate = if root.real {
            c64::new(-(change / slope_sigma).re, 0.0)
        } else {
            solve_real_pair(slope_sigma, slope_omega, -change)
        };
        Ok(if rate.re.is_finite() && rate.im.is_finite() {
            rate
        } else {
            c64::new(0.0, 0.0)
        })
    }

    /// Eigenvalues gamma = sigma b / U of F at a fixed k: a quadratic problem; roots of F are those with Im gamma = 0.
    ///
    /// (U/b)^2 M gamma^2 + [2 i k (U/b)^2 M + (U/b) B - q D] gamma + [-k^2 (U/b)^2 M + i k (U/b) B + K + iH - q Q].
    pub fn gammas(&mut self, k: f64, condition: Condition) -> Result<Vec<c64>> {
        self.load(k)?;
        let n = self.n;
        let rate = condition.speed_m_s / self.problem.semichord_m;
        let pressure = condition.dynamic_pressure();
        let i_unit = c64::new(0.0, 1.0);
        let (mut a2, mut a1, mut a0) = (self.mass.clone(), self.mass.clone(), self.mass.clone());
        for j in 0..n {
            for i in 0..n {
                let e = j * n + i;
                let (mut q, mut d) = (self.q[(i, j)], self.damping_entry(i, j, k));
                let mut stiffness = self.stiffness[e];
                if k > 0.0 {
                    stiffness += i_unit * self.hysteretic[e];
                } else {
                    q.im = 0.0;
                    d.im = 0.0;
                }
                let m = self.mass[e] * (rate * rate);
                a2[e] = m;
                a1[e] = m * c64::new(0.0, 2.0 * k) + self.viscous[e] * rate - d * pressure;
                a0[e] = m * (-k * k) + self.viscous[e] * c64::new(0.0, k * rate) + stiffness - q * pressure;
            }
        }
        eigenvalues_quadratic(
            n,
            &a2,
            &a1,
            &a0,
            &format!("k = {k:.6}, speed {} m/s", condition.speed_m_s),
        )
    }

    /// A root to start the correction from when only p is known: vectors by inverse iteration from fixed starts.
    pub fn seed(&mut self, p: c64, condition: Condition, real: bool) -> Result<Option<Root>> {
        let k = self.reduced_frequency(p.im, condition);
        self.load(k)?;
        self.assemble(p, k, condition, false);
        self.lu.factor(&self.f);
        // Incommensurate entries: orthogonal to no eigenvector that symmetry could produce.
        let mut x: Vec<c64> = (0..self.n)
            .map(|i| {
                c64::new(
                    1.0 / (1.0 + i as f64).sqrt(),
                    if real { 0.0 } else { 0.1 * (1.0 + i as f64).sin() },
                )
            })
            .collect();
        let mut y = x.clone();
        for _ in 0..3 {
            self.lu.solve(&mut x);
            self.lu.solve_adjoint(&mut y);
            if !normalize(&mut x) || !normalize(&mut y) {
                return Ok(None);
            }
        }
        Ok(Some(Root { p, x, y, real }))
    }

    /// Left null vector of K - q Re Q(0) where `x` is the right one.
    pub fn left_static(&mut self, x: &[c64], condition: Condition) -> Result<Vec<c64>> {
        self.load(0.0)?;
        self.assemble(c64::new(0.0, 0.0), 0.0, condition, false);
        self.lu.factor(&self.f);
        let mut y = x.to_vec();
        for _ in 0..3 {
            self.lu.solve_adjoint(&mut y);
            if !normalize(&mut y) {
                return Ok(x.to_vec());
            }
        }
        Ok(y)
    }

    /// Modal assurance criterion with mass weighting, |a^H M b|^2 for unit mass norms.
    pub fn mac(&self, a: &[c64], b: &[c64]) -> f64 {
        bilinear(a, &self.mass, b).norm_sqr().min(1.0)
    }

    /// Smallest dynamic pressures at which K - q Re Q(0) is singular, with vectors: divergence, exact for every method.
    pub fn divergence(&mut self) -> Result<Vec<(f64, Vec<c64>)>> {
        self.load(0.0)?;
        let n = self.n;
        let real = |v: c64| c64::new(v.re, 0.0);
        let aero: Vec<c64> = (0..n * n).map(|e| real(self.q[(e % n, e / n)])).collect();
        let norm = |m: &[c64]| m.iter().fold(0.0_f64, |m, v| m.max(v.norm()));
        if norm(&aero) == 0.0 {
            return Ok(Vec::new());
        }
        // K x = q Q x with a shift to a negative pressure, where K - shift Q is regular even for rigid-body modes:
        // Q x = nu (K - shift Q) x, q = shift + 1 / nu.
        let shift = -0.3 * norm(&self.stiffness).max(f64::MIN_POSITIVE) / norm(&aero);
        let shifted: Vec<c64> = self.stiffness.iter().zip(&aero).map(|(k, q)| k - q * shift).collect();
        let pairs = crate::linear::eigen_pencil(n, &aero, &shifted, "divergence, k = 0")?;
        let mut found: Vec<(f64, Vec<c64>)> = pairs
            .into_iter()
            .filter(|(nu, _)| nu.re > 0.0 && nu.im.abs() <= 1e-8 * nu.re)
            .map(|(nu, x)| (shift + 1.0 / nu.re, x))
            .filter(|(pressure, _)| *pressure > -1e-9 * shift && pressure.is_finite())
            .map(|(pressure, mut x)| {
                scale_shape(&self.mass_real, &mut x);
                (pressure, x)
            })
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(found)
    }
}

/// Unit mass norm and largest entry real and positive, so that shapes compare between runs.
pub(crate) fn scale_shape(mass: &Mat<f64>, x: &mut [c64]) {
    let n = x.len();
    let mut norm = 0.0;
    for j in 0..n {
        for i in 0..n {
            norm += (x[i].conj() * x[j]).re * mass[(i, j)];
        }
    }
    let largest = x.iter().fold(c64::new(0.0, 0.0), |m, &v| {
        if v.norm_sqr() > m.norm_sqr() * (1.0 + 1e-9) {
            v
        } else {
            m
        }
    });
    if norm > 0.0 && largest.norm() > 0.0 {
        let factor = largest.conj() / (largest.norm() * norm.sqrt());
        for v in x.iter_mut() {
            *v *= factor;
        }
    }
}

/// Real a, b with a u + b v = w; returned as a + i b.
fn solve_real_pair(u: c64, v: c64, w: c64) -> c64 {
    let determinant = u.re * v.im - u.im * v.re;
    c64::new(
        (w.re * v.im - w.im * v.re) / determinant,
        (u.re * w.im - u.im * w.re) / determinant,
    )
}
