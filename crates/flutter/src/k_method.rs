//! K and KE solutions: roots of `k_equation.rs` tracked one to one through the reduced frequencies.

use faer::c64;

use crate::assignment::assign;
use crate::error::Result;
use crate::follow::MAX_STATIONS;
use crate::k_crossing::{KCrossing, insert_hidden_extrema, k_crossing, k_humps};
use crate::k_equation::{KEquation, KRoot, check};
use crate::p_method::refuse_outside;
use crate::problem::{FlutterProblem, Settings};
use crate::solution::{FlutterSolution, Hump, Method, ModeCurve, ModePoint, Warning};

/// Number of reduced frequencies when the caller gives none.
const DEFAULT_POINTS: usize = 48;
/// A tracked root with what came before it.
#[derive(Debug, Clone)]
pub(crate) struct KStation {
    pub root: KRoot,
    pub confidence: f64,
    pub mac: f64,
    pub requested: bool,
}

/// K or KE solution over reduced frequencies: curves tracked one to one, crossings solved to `settings.tolerance` in k.
///
/// The curves run from the greatest k (low speed) to the least. Points without a speed (Re p^2 >= 0) are left out of the
/// curves. Mode numbers come from raising the density from zero at the greatest k.
///
/// # Errors
/// As [`crate::k_roots`], and reduced frequencies outside the domain when the settings refuse them.
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
                    warnings.push(Warning::LowConfidence {
                        mode,
                        parameter: pair[1].root.k,
                        confidence: 0.0,
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
