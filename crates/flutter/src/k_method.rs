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

use crate::assignment::assign;
use crate::characteristic::{Characteristic, DampingExpansion, scale_shape};
use crate::crossing::severity;
use crate::error::{FlutterError, Result, check_value};
use crate::follow::MAX_STATIONS;
use crate::forces::check_finite;
use crate::linear::{bilinear, eigen_pencil, normalize};
use crate::p_method::refuse_outside;
use crate::problem::{Condition, FlutterProblem, Settings};
use crate::solution::{
    Crossing, CrossingKind, Direction, FlutterSolution, Hump, Method, ModeCurve, ModePoint, Warning,
};
use crate::structure::columns;

/// Number of reduced frequencies when the caller gives none.
const DEFAULT_POINTS: usize = 48;

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
    fn new(k: f64, p: c64, semichord_m: f64, shape: Vec<c64>) -> Self {
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

struct KEquation<'a> {
    n: usize,
    problem: FlutterProblem<'a>,
    viscous: Option<Vec<c64>>,
    mass: Vec<c64>,
    stiffness: Vec<c64>,
    q: Mat<c64>,
    /// Greatest natural frequency, rad/s.
    scale_rad_s: f64,
}

impl<'a> KEquation<'a> {
    fn new(problem: &FlutterProblem<'a>, method: Method) -> Self {
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
    fn roots(&mut self, k: f64, density_kg_m3: f64) -> Result<Vec<KRoot>> {
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
    fn log_p(&self, root: &KRoot) -> c64 {
        (root.p_rad_s + c64::new(0.0, 1e-3 * self.scale_rad_s)).ln()
    }

    fn mac(&self, a: &[c64], b: &[c64]) -> f64 {
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

fn check(problem: &FlutterProblem<'_>, method: Method, density_kg_m3: f64, ks: &[f64]) -> Result<()> {
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

/// A tracked root with what came before it.
#[derive(Debug, Clone)]
struct KStation {
    root: KRoot,
    confidence: f64,
    mac: f64,
    requested: bool,
}

/// K or KE solution over reduced frequencies: curves tracked one to one, crossings solved to `settings.tolerance` in k.
///
/// The curves run from the greatest k (low speed) to the least. Points without a speed (Re p^2 >= 0) are left out of the
/// curves. Mode numbers come from raising the density from zero at the greatest k.
///
/// # Errors
/// As [`k_roots`], and reduced frequencies outside the domain when the settings refuse them.
pub fn solve_k(
    problem: &FlutterProblem<'_>,
    method: Method,
    density_kg_m3: f64,
    reduced_frequencies: &[f64],
    settings: &Settings,
) -> Result<FlutterSolution> {
    check(problem, method, density_kg_m3, reduced_frequencies)?;
    settings.check()?;
    let mut ks = reduced_frequencies.to_vec();
    ks.sort_by(|a, b| b.total_cmp(a));
    ks.dedup();
    for &k in &ks {
        refuse_outside(problem, settings, k, "the K solution")?;
    }
    let mut equation = KEquation::new(problem, method);
    let mut tracks = start_tracks(&mut equation, ks[0], density_kg_m3, settings)?;
    for pair in ks.windows(2) {
        extend_tracks(
            &mut equation,
            &mut tracks,
            density_kg_m3,
            (pair[0], pair[1]),
            settings,
            0,
            true,
        )?;
    }
    let natural = &problem.structure.natural.omega_rad_s;
    let domain = problem.forces.domain();
    let (mut modes, mut crossings, mut humps, mut warnings) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for track in &mut tracks {
        insert_hidden_extrema(&mut equation, track, density_kg_m3)?;
    }
    for (index, track) in tracks.iter().enumerate() {
        let mode = index + 1;
        for pair in track.windows(2) {
            match k_crossing(&mut equation, mode, &pair[0], &pair[1], density_kg_m3, settings)? {
                KCrossing::Found(crossing) => crossings.push(*crossing),
                KCrossing::Unresolved => {
                    warnings.push(Warning::Unresolved {
                        mode,
                        between: (pair[0].root.k, pair[1].root.k),
                    });
                }
                KCrossing::None => {}
            }
        }
        humps.extend(k_humps(mode, track, density_kg_m3));
        let points: Vec<ModePoint> = track
            .iter()
            .filter_map(|s| {
                s.root.speed_m_s.map(|speed_m_s| ModePoint {
                    parameter: s.root.k,
                    speed_m_s,
                    density_kg_m3,
                    p_rad_s: s.root.p_rad_s,
                    freq_hz: s.root.omega_rad_s / std::f64::consts::TAU,
                    g: s.root.g,
                    k: s.root.k,
                    k_range: domain.locate(s.root.k),
                    confidence: s.confidence,
                    mac: s.mac,
                    shape: s.root.shape.clone(),
                    requested: s.requested,
                })
            })
            .collect();
        for point in points.iter().filter(|p| p.confidence < settings.confidence) {
            warnings.push(Warning::LowConfidence {
                mode,
                parameter: point.k,
                confidence: point.confidence,
            });
        }
        if track.last().is_some_and(|s| s.root.speed_m_s.is_none()) {
            let parameter = points.last().map_or(ks[0], |p| p.parameter);
            warnings.push(Warning::Lost { mode, parameter });
        }
        modes.push(ModeCurve {
            mode,
            natural_freq_hz: natural[index] / std::f64::consts::TAU,
            is_lag_root: false,
            points,
        });
    }
    let outside: Vec<f64> = ks
        .iter()
        .copied()
        .filter(|&k| domain.locate(k) != crate::KRange::Inside)
        .collect();
    if !outside.is_empty() {
        for mode in 1..=modes.len() {
            warnings.push(Warning::OutOfRange {
                mode,
                points: outside.len(),
                k_minimum: outside.iter().copied().fold(f64::INFINITY, f64::min),
                k_maximum: outside.iter().copied().fold(0.0, f64::max),
            });
        }
    }
    crossings.sort_by(|a, b| a.speed_m_s.total_cmp(&b.speed_m_s));
    humps.sort_by(|a: &Hump, b: &Hump| a.speed_m_s.total_cmp(&b.speed_m_s));
    Ok(FlutterSolution {
        method,
        mach: problem.mach,
        modes,
        crossings,
        humps,
        warnings,
    })
}

/// Reduced frequencies for a K solution that covers a range of speeds: geometric, as far as data and modes reach.
pub(crate) fn default_reduced_frequencies(problem: &FlutterProblem<'_>, speeds_m_s: &[f64]) -> Vec<f64> {
    let omega = &problem.structure.natural.omega_rad_s;
    let fastest = omega.iter().copied().fold(0.0, f64::max);
    let slowest = omega
        .iter()
        .copied()
        .filter(|&w| w > 1e-6 * fastest)
        .fold(fastest, f64::min);
    let (first, last) = (speeds_m_s[0], speeds_m_s[speeds_m_s.len() - 1]);
    let domain = problem.forces.domain();
    let b = problem.semichord_m;
    let high = (1.3 * fastest * b / first).min(domain.maximum);
    let low = (0.3 * slowest * b / last).max(domain.minimum).max(1e-4 * high);
    if low >= high {
        return vec![high];
    }
    (0..DEFAULT_POINTS)
        .map(|j| high * (low / high).powf(j as f64 / (DEFAULT_POINTS - 1) as f64))
        .map(|k| k.clamp(low, high))
        .collect()
}

/// Roots at the first k in the order of the natural modes, by raising the density from zero.
fn start_tracks(
    equation: &mut KEquation<'_>,
    k: f64,
    density_kg_m3: f64,
    settings: &Settings,
) -> Result<Vec<Vec<KStation>>> {
    let structure = equation.problem.structure;
    let semichord_m = equation.problem.semichord_m;
    let mut tracks: Vec<Vec<KStation>> = structure
        .natural
        .omega_rad_s
        .iter()
        .enumerate()
        .map(|(mode, &omega)| {
            let shape = (0..equation.n)
                .map(|i| c64::new(structure.natural.shapes[(i, mode)], 0.0))
                .collect();
            let root = KRoot::new(k, c64::new(0.0, omega.max(1e-12)), semichord_m, shape);
            vec![KStation {
                root,
                confidence: 1.0,
                mac: 1.0,
                requested: true,
            }]
        })
        .collect();
    raise_density(equation, &mut tracks, k, density_kg_m3, (0.0, 1.0), settings, 0)?;
    Ok(tracks
        .into_iter()
        .map(|track| track.into_iter().next_back().into_iter().collect())
        .collect())
}

fn raise_density(
    equation: &mut KEquation<'_>,
    tracks: &mut [Vec<KStation>],
    k: f64,
    density_kg_m3: f64,
    (from, to): (f64, f64),
    settings: &Settings,
    depth: u32,
) -> Result<()> {
    let roots = equation.roots(k, to * density_kg_m3)?;
    if place(equation, tracks, &roots, settings, depth >= settings.halvings, true) {
        return Ok(());
    }
    let middle = 0.5 * (from + to);
    raise_density(equation, tracks, k, density_kg_m3, (from, middle), settings, depth + 1)?;
    raise_density(equation, tracks, k, density_kg_m3, (middle, to), settings, depth + 1)
}

fn extend_tracks(
    equation: &mut KEquation<'_>,
    tracks: &mut [Vec<KStation>],
    density_kg_m3: f64,
    (from, to): (f64, f64),
    settings: &Settings,
    depth: u32,
    requested: bool,
) -> Result<()> {
    let roots = equation.roots(to, density_kg_m3)?;
    let longest = tracks.iter().map(Vec::len).max().unwrap_or(0);
    let last_resort = depth >= settings.halvings || longest > MAX_STATIONS;
    if place(equation, tracks, &roots, settings, last_resort, requested) {
        return Ok(());
    }
    let middle = (from * to).sqrt();
    extend_tracks(
        equation,
        tracks,
        density_kg_m3,
        (from, middle),
        settings,
        depth + 1,
        false,
    )?;
    extend_tracks(
        equation,
        tracks,
        density_kg_m3,
        (middle, to),
        settings,
        depth + 1,
        requested,
    )
}

/// Gives the roots to the tracks by optimal assignment; `false` when the confidence asks for a smaller step.
///
/// Distance is measured in log p from a straight extrapolation in log k, shape by the modal assurance criterion.
fn place(
    equation: &KEquation<'_>,
    tracks: &mut [Vec<KStation>],
    roots: &[KRoot],
    settings: &Settings,
    last_resort: bool,
    requested: bool,
) -> bool {
    if roots.len() < tracks.len() {
        // A root at infinity (singular pencil) has left; with fewer roots than modes the tracks can't all go on.
        return last_resort;
    }
    let mut macs = Vec::with_capacity(tracks.len());
    let mut misses = Vec::with_capacity(tracks.len());
    let mut costs = Vec::with_capacity(tracks.len());
    for track in tracks.iter() {
        let last = &track[track.len() - 1].root;
        let expected = expected_log_p(equation, track, roots[0].k);
        let mac: Vec<f64> = roots.iter().map(|r| equation.mac(&last.shape, &r.shape)).collect();
        let miss: Vec<f64> = roots.iter().map(|r| (equation.log_p(r) - expected).norm()).collect();
        costs.push(
            mac.iter()
                .zip(&miss)
                .map(|(m, d)| 1.0 - m / (1.0 + (d / 0.2).powi(2)))
                .collect::<Vec<f64>>(),
        );
        macs.push(mac);
        misses.push(miss);
    }
    let order = assign(&costs);
    let confidence: Vec<f64> = (0..tracks.len())
        .map(|t| {
            let own = order[t];
            let gap = (0..roots.len())
                .filter(|&r| r != own)
                .map(|r| (equation.log_p(&roots[r]) - equation.log_p(&roots[own])).norm())
                .fold(f64::INFINITY, f64::min);
            let rival = (0..roots.len())
                .filter(|&r| r != own)
                .map(|r| macs[t][r])
                .fold(0.0, f64::max);
            let miss = misses[t][own] / gap.max(1e-12);
            let miss = if gap.is_finite() { miss } else { misses[t][own] };
            (macs[t][own] / (1.0 + miss * miss)).max(macs[t][own] - rival)
        })
        .collect();
    if !last_resort && confidence.iter().any(|&c| c < settings.confidence) {
        return false;
    }
    for (t, track) in tracks.iter_mut().enumerate() {
        let station = KStation {
            root: roots[order[t]].clone(),
            confidence: confidence[t],
            mac: macs[t][order[t]],
            requested,
        };
        track.push(station);
    }
    true
}

/// ln p expected at `k` from the last two stations.
fn expected_log_p(equation: &KEquation<'_>, track: &[KStation], k: f64) -> c64 {
    let last = &track[track.len() - 1].root;
    let here = equation.log_p(last);
    if track.len() < 2 {
        return here;
    }
    let before = &track[track.len() - 2].root;
    let (span, step) = (last.k.ln() - before.k.ln(), k.ln() - last.k.ln());
    if span == 0.0 || step / span < 0.0 || step / span > 2.0 {
        return here;
    }
    here + (here - equation.log_p(before)) * (step / span)
}

/// What lies between two stations.
enum KCrossing {
    /// No change of sign.
    None,
    /// A root at g = 0.
    Found(Box<Crossing>),
    /// A change of sign without a root.
    Unresolved,
}

/// g = 0 between two stations, solved in ln k by regula falsi (Illinois) on the root of the same shape.
fn k_crossing(
    equation: &mut KEquation<'_>,
    mode: usize,
    first: &KStation,
    second: &KStation,
    density_kg_m3: f64,
    settings: &Settings,
) -> Result<KCrossing> {
    let (Some(u_first), Some(u_second)) = (first.root.speed_m_s, second.root.speed_m_s) else {
        return Ok(KCrossing::None);
    };
    let (g_first, g_second) = (first.root.g, second.root.g);
    // Round-off about zero (no air forces, no damping) is no crossing.
    if g_first * g_second >= 0.0 || g_first.abs().max(g_second.abs()) < 1e-11 {
        return Ok(KCrossing::None);
    }
    let linear = g_first / (g_first - g_second);
    let (mut a, mut b) = (first.root.clone(), second.root.clone());
    let (mut fa, mut fb) = (g_first, g_second);
    let mut last_side = 0;
    let mut error = (a.k / b.k).ln().abs();
    let mut found = if fa.abs() < fb.abs() { a.clone() } else { b.clone() };
    for iteration in 0..80 {
        let s = if iteration % 8 == 7 {
            0.5
        } else {
            (fa / (fa - fb)).clamp(1e-6, 1.0 - 1e-6)
        };
        let k = (a.k.ln() * (1.0 - s) + b.k.ln() * s).exp();
        let near = if s < 0.5 { &a } else { &b };
        let expected = equation.log_p(&a) * (1.0 - s) + equation.log_p(&b) * s;
        let roots = equation.roots(k, density_kg_m3)?;
        let cost = |r: &KRoot| {
            1.0 - equation.mac(&near.shape, &r.shape) / (1.0 + ((equation.log_p(r) - expected).norm() / 0.2).powi(2))
        };
        let Some(middle) = roots.into_iter().min_by(|x, y| cost(x).total_cmp(&cost(y))) else {
            break;
        };
        error = (middle.k / found.k).ln().abs().min((a.k / b.k).ln().abs());
        found = middle.clone();
        if middle.g == 0.0 || error <= settings.tolerance && middle.g.abs() <= 1e-9 {
            break;
        }
        let side = if middle.g * fb > 0.0 { 1 } else { -1 };
        if side > 0 {
            fa *= if last_side == side { 0.5 } else { 1.0 };
            fb = middle.g;
            b = middle;
        } else {
            fb *= if last_side == side { 0.5 } else { 1.0 };
            fa = middle.g;
            a = middle;
        }
        last_side = side;
    }
    // A jump of the tracking is no crossing.
    let Some(speed_m_s) = found.speed_m_s.filter(|_| found.g.abs() <= 1e-6) else {
        return Ok(KCrossing::Unresolved);
    };
    let slope = speed_m_s * slope_of_free_motion(equation, &found, speed_m_s, density_kg_m3)?;
    Ok(KCrossing::Found(Box::new(Crossing {
        mode,
        kind: CrossingKind::Flutter,
        direction: if slope >= 0.0 {
            Direction::Onset
        } else {
            Direction::Recovery
        },
        parameter: found.k,
        speed_m_s,
        density_kg_m3,
        freq_hz: found.omega_rad_s / std::f64::consts::TAU,
        k: found.k,
        k_range: equation.problem.forces.domain().locate(found.k),
        slope,
        severity: severity(slope),
        residual_g: found.g,
        error,
        interpolated_speed_m_s: u_first + linear * (u_second - u_first),
        confidence: first.confidence.min(second.confidence),
        shape: found.shape,
    })))
}

/// Where g turns back just short of zero between the samples it may have crossed zero twice: the extremum next to such a
/// sample is sought by golden section in ln k and inserted when its sign differs.
fn insert_hidden_extrema(equation: &mut KEquation<'_>, track: &mut Vec<KStation>, density_kg_m3: f64) -> Result<()> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let mut found: Vec<KStation> = Vec::new();
    for w in track.windows(3) {
        let [g0, g1, g2] = [w[0].root.g, w[1].root.g, w[2].root.g];
        let turns = g0 * g1 > 0.0 && g1 * g2 > 0.0 && g1.abs() < g0.abs() && g1.abs() < g2.abs();
        if !turns || w.iter().any(|s| s.root.speed_m_s.is_none()) {
            continue;
        }
        let (mut low, mut high) = (w[0].root.k.ln(), w[2].root.k.ln());
        for _ in 0..30 {
            let probes = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
            let mut values = [0.0; 2];
            for (value, probe) in values.iter_mut().zip(probes) {
                let roots = equation.roots(probe.exp(), density_kg_m3)?;
                let Some(root) = nearest_root(equation, roots, &w[1].root) else {
                    return Ok(());
                };
                // |g| while the sign is that of the samples, negative beyond zero.
                *value = root.g * g1.signum();
                if *value < 0.0 {
                    let (mac, confidence) = (equation.mac(&w[1].root.shape, &root.shape), w[1].confidence);
                    found.push(KStation {
                        root,
                        confidence,
                        mac,
                        requested: false,
                    });
                    break;
                }
            }
            if values.iter().any(|v| *v < 0.0) {
                break;
            }
            if values[0] < values[1] {
                high = probes[1];
            } else {
                low = probes[0];
            }
        }
    }
    for station in found {
        let place = track.partition_point(|s| s.root.k > station.root.k);
        track.insert(place, station);
    }
    Ok(())
}

/// The root most like a given one in shape and place.
fn nearest_root(equation: &KEquation<'_>, roots: Vec<KRoot>, like: &KRoot) -> Option<KRoot> {
    let cost = |r: &KRoot| {
        let distance = (equation.log_p(r) - equation.log_p(like)).norm() / 0.2;
        1.0 - equation.mac(&like.shape, &r.shape) / (1.0 + distance * distance)
    };
    roots.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)))
}

/// dg/dU of free motion at a flutter point, 1/(m/s), with g = 2 sigma / omega from Chen's expansion, which is exact there.
fn slope_of_free_motion(equation: &KEquation<'_>, root: &KRoot, speed_m_s: f64, density_kg_m3: f64) -> Result<f64> {
    let mut free = Characteristic::new(&equation.problem, DampingExpansion::Chen);
    if equation.viscous.is_none() {
        free.leave_out_viscous_damping();
    }
    let at = |speed_m_s: f64| Condition {
        speed_m_s,
        density_kg_m3,
    };
    let Some(seed) = free.seed(c64::new(0.0, root.omega_rad_s), at(speed_m_s), false)? else {
        return Ok(0.0);
    };
    let step = 1e-5 * speed_m_s;
    let rate = free.rate(
        &seed,
        at(speed_m_s),
        at(speed_m_s - step),
        at(speed_m_s + step),
        2.0 * step,
    )?;
    Ok(2.0 * rate.re / root.omega_rad_s)
}

/// Local maxima of g over the tracked points (as sampled: K methods are a listing in k).
fn k_humps(mode: usize, track: &[KStation], density_kg_m3: f64) -> Vec<Hump> {
    track
        .windows(3)
        .filter(|w| w[1].root.g > w[0].root.g + 1e-7 && w[1].root.g > w[2].root.g + 1e-7)
        .filter_map(|w| {
            let root = &w[1].root;
            let speeds_rise = w[0].root.speed_m_s.is_some() && w[2].root.speed_m_s.is_some();
            root.speed_m_s.filter(|_| speeds_rise).map(|speed_m_s| Hump {
                mode,
                parameter: root.k,
                speed_m_s,
                density_kg_m3,
                freq_hz: root.omega_rad_s / std::f64::consts::TAU,
                g: root.g,
            })
        })
        .collect()
}
