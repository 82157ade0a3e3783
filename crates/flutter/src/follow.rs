//! Following the roots of the p methods through a sweep, one root per mode, with a confidence.
//!
//! Each root is predicted from its rate of change and corrected by Newton's method; the new roots are given to the modes
//! by an optimal assignment on shape (modal assurance criterion with mass weighting) and on the distance from the
//! prediction. A step whose confidence is low is halved.

use faer::c64;

use crate::assignment::assign;
use crate::characteristic::{Characteristic, Root};
use crate::error::Result;
use crate::problem::{Condition, Settings};

/// Stations of one branch after which steps are halved no more: bounds the work of hopeless problems.
pub(crate) const MAX_STATIONS: usize = 2000;

/// A path of conditions with the parameter of the sweep.
pub(crate) type Path<'p> = dyn Fn(f64) -> Condition + 'p;

/// One accepted point of one branch.
#[derive(Debug, Clone)]
pub(crate) struct Station {
    pub t: f64,
    pub root: Root,
    /// dp/dt, rad/s per unit of the parameter.
    pub rate: c64,
    pub confidence: f64,
    pub mac: f64,
    pub requested: bool,
}

/// One root through the sweep.
#[derive(Debug, Clone)]
pub(crate) struct Branch {
    /// Mode number from 1.
    pub mode: usize,
    pub is_lag_root: bool,
    pub stations: Vec<Station>,
    /// Whether the root could not be followed to the end.
    pub lost: bool,
}

/// Outcome for one branch of a trial step.
struct Trial {
    root: Option<Root>,
    predicted: c64,
}

/// Advances all branches from their last station (all at `from`) to `to`, halving where needed.
pub(crate) fn advance(
    equation: &mut Characteristic<'_>,
    path: &Path<'_>,
    branches: &mut [Branch],
    (from, to): (f64, f64),
    settings: &Settings,
    depth: u32,
    requested: bool,
) -> Result<()> {
    let longest = branches.iter().map(|b| b.stations.len()).max().unwrap_or(0);
    let last_resort = depth >= settings.halvings || longest > MAX_STATIONS;
    let accepted = try_step(equation, path, branches, (from, to), settings, last_resort, depth >= 3)?;
    if let Some(stations) = accepted {
        for (branch, station) in branches.iter_mut().zip(stations) {
            match station {
                Some(mut station) => {
                    station.requested = requested;
                    branch.stations.push(station);
                }
                None => branch.lost = true,
            }
        }
        return Ok(());
    }
    let middle = 0.5 * (from + to);
    advance(equation, path, branches, (from, middle), settings, depth + 1, false)?;
    advance(equation, path, branches, (middle, to), settings, depth + 1, requested)
}

/// The new stations (`None` inside for a lost or already lost branch), or `None` when the step should be halved.
fn try_step(
    equation: &mut Characteristic<'_>,
    path: &Path<'_>,
    branches: &[Branch],
    (from, to): (f64, f64),
    settings: &Settings,
    last_resort: bool,
    may_turn_real: bool,
) -> Result<Option<Vec<Option<Station>>>> {
    let condition = path(to);
    let active: Vec<usize> = (0..branches.len())
        .filter(|&b| !branches[b].lost && !branches[b].stations.is_empty())
        .collect();
    let mut trials = Vec::with_capacity(active.len());
    for &b in &active {
        let stations = &branches[b].stations;
        let last = &stations[stations.len() - 1];
        let predicted = predict(stations, to);
        let mut start = last.root.clone();
        start.p = predicted;
        let mut root = if start.real || start.p.im > 0.0 {
            equation.correct(&start, condition)?
        } else {
            None
        };
        if root.is_none() {
            root = equation.correct(&last.root, condition)?;
        }
        trials.push(Trial { root, predicted });
    }
    drop_duplicates(equation, branches, &active, &mut trials);

    // Roots that Newton did not reach: the real axis for slow ones, the search for all roots as a last resort.
    for a in 0..trials.len() {
        if trials[a].root.is_some() {
            continue;
        }
        let stations = &branches[active[a]].stations;
        let last = &stations[stations.len() - 1];
        let slow = last.root.real || trials[a].predicted.im < 0.3 * last.root.p.im;
        if !(last_resort || may_turn_real && slow) {
            return Ok(None);
        }
        let mut candidates = real_roots(equation, condition)?;
        if last_resort || last.root.real {
            candidates.extend(oscillating_roots(equation, condition)?);
        }
        let reach = 0.3 * last.root.p.norm().max(0.05 * equation.scale_rad_s);
        trials[a].root = choose(equation, candidates, &trials, last, trials[a].predicted, reach);
        if trials[a].root.is_none() && !last_resort {
            return Ok(None);
        }
    }

    let found: Vec<usize> = (0..trials.len()).filter(|&a| trials[a].root.is_some()).collect();
    let (order, overlaps) = match_roots(equation, branches, &active, &trials, &found);
    let mut answer: Vec<Option<Station>> = (0..branches.len()).map(|_| None).collect();
    for (row, &a) in found.iter().enumerate() {
        let Some(root) = trials[found[order[row]]].root.clone() else {
            continue;
        };
        let stations = &branches[active[a]].stations;
        let last = &stations[stations.len() - 1];
        let mac = overlaps[row][order[row]];
        let rival = (0..found.len())
            .filter(|&c| c != order[row])
            .map(|c| overlaps[row][c])
            .fold(0.0, f64::max);
        let gap = nearest_other(&trials, &found, order[row], &root).unwrap_or(root.p.norm());
        let miss = (root.p - trials[a].predicted).norm() / gap.max(1e-12 * equation.scale_rad_s);
        // Either the root lies where it was expected, or its shape tells it from all others.
        let confidence = (mac / (1.0 + miss * miss)).max(mac - rival);
        if confidence < settings.confidence && !last_resort {
            return Ok(None);
        }
        let span = to - from;
        let step = 1e-4 * span;
        let rate = equation.rate(&root, condition, path(to - step), path(to + step), 2.0 * step)?;
        let jump = last.root.real != root.real;
        // Damping that turns inside the step by more than the prediction can know: a hump may hide there.
        if !last_resort && !jump && turns_unseen(last, &root, rate, span) {
            return Ok(None);
        }
        answer[active[a]] = Some(Station {
            t: to,
            root,
            rate,
            confidence,
            mac,
            requested: false,
        });
    }
    Ok(Some(answer))
}

/// Whether the cubic through both ends (values and rates) departs from the straight line by more than a tenth of |p|.
fn turns_unseen(last: &Station, root: &Root, rate: c64, span: f64) -> bool {
    let chord = (root.p - last.root.p) / span;
    let bulge = (last.rate - chord).norm().max((rate - chord).norm()) * span.abs() * 4.0 / 27.0;
    bulge > 0.1 * root.p.norm().max(last.root.p.norm())
}

/// Cubic Hermite extrapolation from the last two stations, or Euler's from the last.
fn predict(stations: &[Station], t: f64) -> c64 {
    let last = &stations[stations.len() - 1];
    let step = t - last.t;
    let euler = last.root.p + last.rate * step;
    if stations.len() < 2 {
        return euler;
    }
    let before = &stations[stations.len() - 2];
    let span = last.t - before.t;
    if before.root.real != last.root.real || span == 0.0 || (step / span).abs() > 2.0 || step / span < 0.0 {
        return euler;
    }
    let s = 1.0 + step / span;
    hermite(before, last, s)
}

/// Cubic through values and rates of two stations at s, 0 at `a` and 1 at `b`.
pub(crate) fn hermite(a: &Station, b: &Station, s: f64) -> c64 {
    let span = b.t - a.t;
    let (s2, s3) = (s * s, s * s * s);
    a.root.p * (2.0 * s3 - 3.0 * s2 + 1.0)
        + b.root.p * (3.0 * s2 - 2.0 * s3)
        + (a.rate * (s3 - 2.0 * s2 + s) + b.rate * (s3 - s2)) * span
}

/// Two modes on one root: the one whose shape fits less loses it.
fn drop_duplicates(equation: &Characteristic<'_>, branches: &[Branch], active: &[usize], trials: &mut [Trial]) {
    for a in 0..trials.len() {
        for b in 0..a {
            let (Some(ra), Some(rb)) = (&trials[a].root, &trials[b].root) else {
                continue;
            };
            if !same_root(equation, ra, rb) {
                continue;
            }
            let fit = |t: usize, root: &Root| {
                branches[active[t]]
                    .stations
                    .last()
                    .map_or(0.0, |s| equation.mac(&s.root.x, &root.x))
            };
            let loser = if fit(a, ra) < fit(b, rb) { a } else { b };
            trials[loser].root = None;
        }
    }
}

pub(crate) fn same_root(equation: &Characteristic<'_>, a: &Root, b: &Root) -> bool {
    let near = (a.p - b.p).norm() < 1e-7 * (a.p.norm() + 1e-6 * equation.scale_rad_s);
    near && equation.mac(&a.x, &b.x) > 0.999
}

/// The candidate next to the prediction that no other mode holds; the less stable one of a fresh real pair.
fn choose(
    equation: &Characteristic<'_>,
    candidates: Vec<Root>,
    trials: &[Trial],
    last: &Station,
    predicted: c64,
    reach: f64,
) -> Option<Root> {
    let aim = if last.root.real {
        predicted
    } else {
        c64::new(last.root.p.re, predicted.im.max(0.0))
    };
    let mut free: Vec<(f64, Root)> = candidates
        .into_iter()
        .filter(|c| {
            !trials
                .iter()
                .filter_map(|t| t.root.as_ref())
                .any(|taken| same_root(equation, taken, c))
        })
        .map(|c| ((c.p - aim).norm(), c))
        .filter(|(distance, c)| *distance < reach && equation.mac(&last.root.x, &c.x) > 0.2)
        .collect();
    free.sort_by(|a, b| a.0.total_cmp(&b.0));
    let nearest = free.first()?.0;
    let fresh_pair = !last.root.real;
    free.into_iter()
        .filter(|(distance, c)| *distance <= nearest || fresh_pair && c.real && *distance <= 2.0 * nearest)
        .max_by(|a, b| a.1.p.re.total_cmp(&b.1.p.re))
        .map(|(_, root)| root)
}

/// Optimal assignment of the found roots to their modes, and the overlaps [mode][root].
fn match_roots(
    equation: &Characteristic<'_>,
    branches: &[Branch],
    active: &[usize],
    trials: &[Trial],
    found: &[usize],
) -> (Vec<usize>, Vec<Vec<f64>>) {
    let mut overlaps = Vec::with_capacity(found.len());
    let mut costs = Vec::with_capacity(found.len());
    for &a in found {
        let Some(last) = branches[active[a]].stations.last() else {
            continue;
        };
        let mut row_mac = Vec::with_capacity(found.len());
        let mut row_cost = Vec::with_capacity(found.len());
        for &c in found {
            let (mac, distance) = trials[c].root.as_ref().map_or((0.0, f64::MAX), |root| {
                (
                    equation.mac(&last.root.x, &root.x),
                    (root.p - trials[a].predicted).norm(),
                )
            });
            let scale = 0.1 * last.root.p.norm().max(1e-3 * equation.scale_rad_s);
            row_mac.push(mac);
            row_cost.push(1.0 - mac / (1.0 + (distance / scale).powi(2)));
        }
        overlaps.push(row_mac);
        costs.push(row_cost);
    }
    (assign(&costs), overlaps)
}

fn nearest_other(trials: &[Trial], found: &[usize], own: usize, root: &Root) -> Option<f64> {
    (0..found.len())
        .filter(|&c| c != own)
        .filter_map(|c| trials[found[c]].root.as_ref().map(|other| (other.p - root.p).norm()))
        .min_by(f64::total_cmp)
}

/// Real roots at a condition, converged.
pub(crate) fn real_roots(equation: &mut Characteristic<'_>, condition: Condition) -> Result<Vec<Root>> {
    let gammas = equation.gammas(0.0, condition)?;
    let rate = 1.0 / equation.reduced_frequency(1.0, condition);
    let largest = gammas.iter().fold(0.0_f64, |m, g| m.max(g.norm()));
    let mut roots: Vec<Root> = Vec::new();
    for gamma in gammas.into_iter().filter(|g| g.im.abs() <= 1e-9 * largest) {
        let Some(seed) = equation.seed(c64::new(gamma.re * rate, 0.0), condition, true)? else {
            continue;
        };
        if let Some(root) = equation.correct(&seed, condition)?
            && !roots.iter().any(|r| same_root(equation, r, &root))
        {
            roots.push(root);
        }
    }
    Ok(roots)
}

/// All oscillating roots up to one and a half times the greatest natural frequency, by Chen's sweep of k: the eigenvalues
/// gamma(k) of the quadratic problem at fixed k are followed, and where one is real F has a root.
pub(crate) fn oscillating_roots(equation: &mut Characteristic<'_>, condition: Condition) -> Result<Vec<Root>> {
    const STEPS: usize = 60;
    let k_of_one = equation.reduced_frequency(1.0, condition);
    let k_end = 1.5 * equation.scale_rad_s * k_of_one;
    let mut roots: Vec<Root> = Vec::new();
    let mut before: Option<(f64, Vec<c64>)> = None;
    for step in 0..=STEPS {
        // Denser next to zero, where lag and rigid-body roots live; the start is off zero so that real roots stay out.
        let k = k_end * (1e-4 + (step as f64 / STEPS as f64).powi(2));
        let gammas = equation.gammas(k, condition)?;
        if let Some((k_before, old)) = &before {
            let dk = k - k_before;
            let size = 2 * equation.n;
            if old.len() == size && gammas.len() == size {
                // With p nearly fixed, gamma = p b / U - i k moves by -i dk.
                let cost: Vec<Vec<f64>> = old
                    .iter()
                    .map(|o| {
                        gammas
                            .iter()
                            .map(|g| (*g - (*o - c64::new(0.0, dk))).norm().min(1e6))
                            .collect()
                    })
                    .collect();
                for (index, &target) in assign(&cost).iter().enumerate() {
                    let (a, b) = (old[index], gammas[target]);
                    if a.im * b.im > 0.0 {
                        continue;
                    }
                    let s = if a.im == b.im { 0.5 } else { a.im / (a.im - b.im) };
                    let gamma = a.re + s * (b.re - a.re);
                    let p = c64::new(gamma, k_before + s * dk) / k_of_one;
                    let Some(seed) = equation.seed(p, condition, false)? else {
                        continue;
                    };
                    if let Some(root) = equation.correct(&seed, condition)?
                        && !roots.iter().any(|r| same_root(equation, r, &root))
                    {
                        roots.push(root);
                    }
                }
            }
        }
        before = Some((k, gammas));
    }
    Ok(roots)
}
