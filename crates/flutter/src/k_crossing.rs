//! Zero artificial damping on the tracked curves of K and KE, and humps that hide between the samples.

use faer::c64;

use crate::characteristic::{Characteristic, DampingExpansion};
use crate::crossing::severity;
use crate::error::Result;
use crate::k_equation::{KEquation, KRoot};
use crate::k_method::KStation;
use crate::problem::{Condition, Settings};
use crate::solution::{Crossing, CrossingKind, Direction, Hump};

/// What lies between two stations.
pub(crate) enum KCrossing {
    /// No change of sign.
    None,
    /// A root at g = 0.
    Found(Box<Crossing>),
    /// A change of sign without a root.
    Unresolved,
}

/// g = 0 between two stations, solved in ln k by regula falsi (Illinois) on the root of the same shape.
pub(crate) fn k_crossing(
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
pub(crate) fn insert_hidden_extrema(
    equation: &mut KEquation<'_>,
    track: &mut Vec<KStation>,
    density_kg_m3: f64,
) -> Result<()> {
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
pub(crate) fn k_humps(mode: usize, track: &[KStation], density_kg_m3: f64) -> Vec<Hump> {
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
