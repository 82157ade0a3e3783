//! K and KE methods: harmonic motion kept up by artificial structural damping g, one eigenproblem per reduced frequency.
//!
//! With U = omega b / k the aerodynamic stiffness becomes an apparent mass:
//!
//! ```text
//! [A p^2 + B p + K + iH] q = 0,   A = M + (rho / 2)(b / k)^2 Q(k),   p = i omega / sqrt(1 + i g)
//! ```
//!
//! so that p^2 = -omega^2 / (1 + i g): omega = |p^2| / sqrt(-Re p^2), g = -Im p^2 / Re p^2, U = omega b / k. KE leaves out B
//! (MSC Aeroelastic Analysis User's Guide, K- and KE-methods; the printed values of a KE solution follow from these formulas,
//! see `tests/validation.rs`). Positive g must be added to keep harmonic motion: unstable.

use faer::{Mat, c64};

use crate::characteristic::scale_shape;
use crate::error::{FlutterError, Result, check_value};
use crate::forces::check_finite;
use crate::linear::{bilinear, eigen_pencil, normalize};
use crate::problem::FlutterProblem;
use crate::solution::Method;
use crate::structure::columns;

/// One root of the K equation.
#[derive(Debug, Clone, PartialEq)]
pub struct KRoot {
    /// Reduced frequency.
    pub k: f64,
    /// p = i omega / sqrt(1 + i g), rad/s.
    pub p_rad_s: c64,
    /// Speed U = omega b / k, m/s; `None` when -Re p^2 <= 0, where no speed belongs to the root.
    pub speed_m_s: Option<f64>,
    /// Circular frequency |p^2| / sqrt(-Re p^2), rad/s; zero when there is no speed.
    pub omega_rad_s: f64,
    /// Artificial damping -Im p^2 / Re p^2.
    pub g: f64,
    /// Eigenvector, unit mass norm.
    pub shape: Vec<c64>,
}

impl KRoot {
    pub(crate) fn new(k: f64, p: c64, semichord_m: f64, shape: Vec<c64>) -> Self {
        let p2 = p * p;
        let valid = p2.re < 0.0;
        let omega = if valid { p2.norm() / (-p2.re).sqrt() } else { 0.0 };
        Self {
            k,
            p_rad_s: p,
            speed_m_s: valid.then(|| omega * semichord_m / k),
            omega_rad_s: omega,
            g: if p2.re == 0.0 { 0.0 } else { -p2.im / p2.re },
            shape,
        }
    }
}

/// Matrices of the equation and work space. Column-major slices of n * n.
pub(crate) struct KEquation<'a> {
    pub n: usize,
    pub problem: FlutterProblem<'a>,
    pub viscous: Option<Vec<c64>>,
    mass: Vec<c64>,
    stiffness: Vec<c64>,
    q: Mat<c64>,
    /// Greatest natural frequency, rad/s.
    scale_rad_s: f64,
}

impl<'a> KEquation<'a> {
    pub fn new(problem: &FlutterProblem<'a>, method: Method) -> Self {
        let structure = problem.structure;
        let n = structure.size();
        let viscous = columns(&structure.viscous_total());
        let has_viscous = viscous.iter().any(|v| *v != c64::new(0.0, 0.0));
        let hysteretic = columns(&structure.hysteretic());
        let stiffness = columns(&structure.stiffness)
            .iter()
            .zip(&hysteretic)
            .map(|(k, h)| k + c64::new(0.0, 1.0) * h)
            .collect();
        Self {
            n,
            problem: *problem,
            viscous: (method == Method::K && has_viscous).then_some(viscous),
            mass: columns(&structure.mass),
            stiffness,
            q: Mat::zeros(n, n),
            scale_rad_s: structure.natural.omega_rad_s.iter().fold(1e-12, |m, &w| f64::max(m, w)),
        }
    }

    /// All roots with Im p > 0 at one reduced frequency, in the order of rising frequency.
    pub fn roots(&mut self, k: f64, density_kg_m3: f64) -> Result<Vec<KRoot>> {
        let (n, b) = (self.n, self.problem.semichord_m);
        self.problem.forces.q(k, self.q.as_mut())?;
        check_finite(&format!("generalized forces at k = {k:.6}"), self.q.as_ref())?;
        let factor = 0.5 * density_kg_m3 * (b / k) * (b / k);
        let apparent: Vec<c64> = (0..n * n)
            .map(|e| self.mass[e] + self.q[(e % n, e / n)] * factor)
            .collect();
        let at = format!("k = {k:.6}");
        let mut pairs: Vec<(c64, Vec<c64>)> = match &self.viscous {
            // K q = mu A q, mu = -p^2; of the two signs of p the one in the upper half plane.
            None => eigen_pencil(n, &self.stiffness, &apparent, &at)?
                .into_iter()
                .map(|(mu, x)| {
                    let p = (-mu).sqrt();
                    (if p.im < 0.0 { -p } else { p }, x)
                })
                .collect(),
            // Companion form of the quadratic problem as a pencil, for its vectors.
            Some(viscous) => {
                let size = 2 * n;
                let (mut left, mut right) = (
                    vec![c64::new(0.0, 0.0); size * size],
                    vec![c64::new(0.0, 0.0); size * size],
                );
                for j in 0..n {
                    left[(n + j) * size + j] = c64::new(1.0, 0.0);
                    right[j * size + j] = c64::new(1.0, 0.0);
                    for i in 0..n {
                        left[j * size + n + i] = -self.stiffness[j * n + i];
                        left[(n + j) * size + n + i] = -viscous[j * n + i];
                        right[(n + j) * size + n + i] = apparent[j * n + i];
                    }
                }
                let mut pairs: Vec<_> = eigen_pencil(size, &left, &right, &at)?
                    .into_iter()
                    .filter(|(p, _)| p.im > 0.0)
                    .map(|(p, mut x)| {
                        x.truncate(n);
                        normalize(&mut x);
                        (p, x)
                    })
                    .collect();
                // The n roots wanted are those of oscillation; overdamped ones come last.
                pairs.sort_by(|a, b| (-(a.0 * a.0)).re.total_cmp(&(-(b.0 * b.0)).re).reverse());
                pairs.truncate(n);
                pairs
            }
        };
        pairs.sort_by(|a, b| a.0.im.total_cmp(&b.0.im));
        Ok(pairs
            .into_iter()
            .map(|(p, mut x)| {
                scale_shape(&self.problem.structure.mass, &mut x);
                KRoot::new(k, p, b, x)
            })
            .collect())
    }

    /// Coordinate in which roots are compared: ln p, with a small shift so that a rigid-body root (p = 0) has one too.
    pub fn log_p(&self, root: &KRoot) -> c64 {
        (root.p_rad_s + c64::new(0.0, 1e-3 * self.scale_rad_s)).ln()
    }

    pub fn mac(&self, a: &[c64], b: &[c64]) -> f64 {
        bilinear(a, &self.mass, b).norm_sqr().min(1.0)
    }
}

/// Roots of the K (or KE) equation at each reduced frequency, `[k][root]`, roots by rising frequency and not tracked: what
/// a Nastran K listing prints.
///
/// # Errors
/// Bad inputs, forces that fail or are not finite, a method that is not K or KE.
pub fn k_roots(
    problem: &FlutterProblem<'_>,
    method: Method,
    density_kg_m3: f64,
    reduced_frequencies: &[f64],
) -> Result<Vec<Vec<KRoot>>> {
    check(problem, method, density_kg_m3, reduced_frequencies)?;
    let mut equation = KEquation::new(problem, method);
    reduced_frequencies
        .iter()
        .map(|&k| equation.roots(k, density_kg_m3))
        .collect()
}

pub(crate) fn check(problem: &FlutterProblem<'_>, method: Method, density_kg_m3: f64, ks: &[f64]) -> Result<()> {
    problem.check()?;
    if method.is_p_method() {
        return Err(FlutterError::Unsupported {
            method: method.name().into(),
            request: "run over a list of reduced frequencies".into(),
            advice: "use Method::K or Method::Ke, or give speeds".into(),
        });
    }
    check_value("density, kg/m3", density_kg_m3, "above zero", density_kg_m3 > 0.0)?;
    if ks.is_empty() {
        return Err(FlutterError::Shape {
            what: "reduced frequencies".into(),
            needed: "at least one".into(),
            got: "none".into(),
        });
    }
    for &k in ks {
        check_value("reduced frequency of a K solution", k, "above zero", k > 0.0)?;
    }
    Ok(())
}
