//! Zero damping on the curves of the p methods: flutter onsets and recoveries, damping peaks, divergence.
//!
//! Every crossing is solved again at its own condition until it is a root of the equation; interpolation of the sweep is
//! only the start.

use faer::c64;

use crate::characteristic::{Characteristic, Root};
use crate::error::Result;
use crate::follow::{Branch, Path, Station, hermite};
use crate::problem::{Condition, Settings};
use crate::solution::{Crossing, CrossingKind, Direction, Hump, Severity, Warning};

/// g = 2 sigma / omega; for a real root 2 sigma b / (U ln 2), the length to double or halve in semichords as Nastran prints
/// it (NASTRAN-95 FA1PKE; MSC Aeroelastic Analysis User's Guide, PK-method).
pub(crate) fn damping_g(root: &Root, semichord_m: f64, condition: Condition) -> f64 {
    if root.real {
        2.0 * root.p.re * semichord_m / (condition.speed_m_s * std::f64::consts::LN_2)
    } else {
        2.0 * root.p.re / root.p.im
    }
}

/// dg/dt of an oscillating root.
fn damping_rate(p: c64, rate: c64) -> f64 {
    2.0 * (rate.re * p.im - p.re * rate.im) / (p.im * p.im)
}

/// d(ln q)/dt / 2 along the path, by central differences over a part of `span`.
fn pressure_rate(path: &Path<'_>, t: f64, span: f64) -> f64 {
    let step = 1e-4 * span;
    let (before, after) = (path(t - step).dynamic_pressure(), path(t + step).dynamic_pressure());
    (after / before).ln() / (4.0 * step)
}

pub(crate) fn severity(slope: f64) -> Severity {
    match slope.abs() {
        s if s < 0.1 => Severity::Mild,
        s if s > 1.0 => Severity::Explosive,
        _ => Severity::Moderate,
    }
}

/// Solves the branch again at `t` between two stations, starting from the cubic between them.
fn solve_between(
    equation: &mut Characteristic<'_>,
    path: &Path<'_>,
    (a, b): (&Station, &Station),
    t: f64,
) -> Result<Option<Station>> {
    let s = (t - a.t) / (b.t - a.t);
    let near = if s < 0.5 { a } else { b };
    let mut start = near.root.clone();
    start.p = hermite(a, b, s);
    if start.p.im <= 0.0 && !start.real {
        start.p.im = near.root.p.im;
    }
    let condition = path(t);
    let corrected = match equation.correct(&start, condition)? {
        Some(root) => Some(root),
        None => equation.correct(&near.root, condition)?,
    };
    let Some(root) = corrected else { return Ok(None) };
    let mac = equation.mac(&near.root.x, &root.x);
    if mac < 0.3 {
        return Ok(None);
    }
    let step = 1e-4 * (b.t - a.t);
    let rate = equation.rate(&root, condition, path(t - step), path(t + step), 2.0 * step)?;
    let confidence = a.confidence.min(b.confidence);
    Ok(Some(Station {
        t,
        root,
        rate,
        confidence,
        mac,
        requested: false,
    }))
}

/// Finds the peaks and troughs of g inside the steps, inserts those that show a hidden crossing, and reports the peaks.
///
/// A local extremum is where dg/dt changes sign between two stations; it is bisected on dg/dt with the root solved again
/// each time. Changes of g below 1e-7 are round-off and no hump.
pub(crate) fn insert_extrema(
    equation: &mut Characteristic<'_>,
    path: &Path<'_>,
    branch: &mut Branch,
) -> Result<Vec<Hump>> {
    let mut humps = Vec::new();
    let mut result: Vec<Station> = Vec::with_capacity(branch.stations.len());
    let stations = std::mem::take(&mut branch.stations);
    for station in stations {
        if let Some(last) = result.last().cloned()
            && !last.root.real
            && !station.root.real
        {
            let g = |s: &Station| 2.0 * s.root.p.re / s.root.p.im;
            let forward = (station.t - last.t).signum();
            let slope = |s: &Station| damping_rate(s.root.p, s.rate) * forward;
            let (first, second) = (slope(&last), slope(&station));
            if first * second < 0.0
                && let Some(extreme) = bisect_slope(equation, path, &last, &station)?
            {
                let peak = first > 0.0;
                let rise = (g(&extreme) - g(&last)).abs().max((g(&extreme) - g(&station)).abs());
                if rise > 1e-7 {
                    if peak {
                        let condition = path(extreme.t);
                        humps.push(Hump {
                            mode: branch.mode,
                            parameter: extreme.t,
                            speed_m_s: condition.speed_m_s,
                            density_kg_m3: condition.density_kg_m3,
                            freq_hz: extreme.root.p.im / std::f64::consts::TAU,
                            g: g(&extreme),
                        });
                    }
                    result.push(extreme);
                }
            }
        }
        result.push(station);
    }
    branch.stations = result;
    Ok(humps)
}

fn bisect_slope(
    equation: &mut Characteristic<'_>,
    path: &Path<'_>,
    first: &Station,
    second: &Station,
) -> Result<Option<Station>> {
    let (mut a, mut b) = (first.clone(), second.clone());
    let rising = damping_rate(a.root.p, a.rate) > 0.0;
    let mut best = None;
    for _ in 0..40 {
        let (ra, rb) = (damping_rate(a.root.p, a.rate), damping_rate(b.root.p, b.rate));
        let secant = a.t + (b.t - a.t) * (ra / (ra - rb)).clamp(0.1, 0.9);
        let Some(middle) = solve_between(equation, path, (&a, &b), secant)? else {
            break;
        };
        let up = damping_rate(middle.root.p, middle.rate) > 0.0;
        if up == rising {
            a = middle.clone();
        } else {
            b = middle.clone();
        }
        best = Some(middle);
        if (b.t - a.t).abs() < 1e-7 * (second.t - first.t).abs() {
            break;
        }
    }
    Ok(best)
}

/// Flutter crossings of one branch: sign changes of sigma between oscillating stations, solved by regula falsi (Illinois).
pub(crate) fn find_crossings(
    equation: &mut Characteristic<'_>,
    path: &Path<'_>,
    branch: &Branch,
    settings: &Settings,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Crossing>> {
    let mut crossings = Vec::new();
    // Damping of exactly zero (no air forces, no damping) is no crossing: the last station clearly off zero counts.
    let floor = 1e-12 * equation.scale_rad_s;
    let mut last: Option<&Station> = None;
    for station in &branch.stations {
        if station.root.real || station.root.p.re.abs() <= floor {
            if station.root.real {
                last = None;
            }
            continue;
        }
        if let Some(before) = last
            && before.root.p.re * station.root.p.re < 0.0
        {
            match solve_crossing(equation, path, branch.mode, before, station, settings)? {
                Some(crossing) => crossings.push(crossing),
                None => warnings.push(Warning::LowConfidence {
                    mode: branch.mode,
                    parameter: station.t,
                    confidence: 0.0,
                }),
            }
        }
        last = Some(station);
    }
    Ok(crossings)
}

fn solve_crossing(
    equation: &mut Characteristic<'_>,
    path: &Path<'_>,
    mode: usize,
    first: &Station,
    second: &Station,
    settings: &Settings,
) -> Result<Option<Crossing>> {
    let linear = first.root.p.re / (first.root.p.re - second.root.p.re);
    let interpolated = path(first.t + linear * (second.t - first.t)).speed_m_s;
    let (mut a, mut b) = (first.clone(), second.clone());
    let (mut fa, mut fb) = (a.root.p.re, b.root.p.re);
    let mut error = f64::INFINITY;
    let mut found: Option<Station> = None;
    let mut last_side = 0;
    for iteration in 0..80 {
        // Every eighth step halves the bracket, in case regula falsi creeps.
        let s = if iteration % 8 == 7 {
            0.5
        } else {
            (fa / (fa - fb)).clamp(1e-6, 1.0 - 1e-6)
        };
        let t = a.t + s * (b.t - a.t);
        let Some(middle) = solve_between(equation, path, (&a, &b), t)? else {
            break;
        };
        let scale = t.abs().max(1e-12);
        if let Some(previous) = &found {
            error = ((middle.t - previous.t).abs() / scale).min((b.t - a.t).abs() / scale);
        }
        let sigma = middle.root.p.re;
        // Illinois: the value at an end that stays twice is halved.
        let side = if sigma * fb > 0.0 { 1 } else { -1 };
        if side > 0 {
            fa *= if last_side == side { 0.5 } else { 1.0 };
            b = middle.clone();
            fb = sigma;
        } else {
            fb *= if last_side == side { 0.5 } else { 1.0 };
            a = middle.clone();
            fa = sigma;
        }
        last_side = side;
        let done = sigma == 0.0 || error <= settings.tolerance && sigma.abs() <= 1e-9 * middle.root.p.im;
        found = Some(middle);
        if done {
            break;
        }
    }
    // Without a root at zero damping there is no crossing: the tracking jumped, which its confidence says.
    let near_zero = |s: &Station| s.root.p.re.abs() <= 1e-6 * s.root.p.im;
    let Some(root) = found.filter(near_zero) else {
        return Ok(None);
    };
    let condition = path(root.t);
    let onset = first.root.p.re < 0.0;
    let k = equation.reduced_frequency(root.root.p.im, condition);
    let slope = damping_rate(root.root.p, root.rate) / pressure_rate(path, root.t, second.t - first.t);
    Ok(Some(Crossing {
        mode,
        kind: CrossingKind::Flutter,
        direction: if onset { Direction::Onset } else { Direction::Recovery },
        parameter: root.t,
        speed_m_s: condition.speed_m_s,
        density_kg_m3: condition.density_kg_m3,
        freq_hz: root.root.p.im / std::f64::consts::TAU,
        k,
        k_range: equation.k_range(k),
        slope,
        severity: severity(slope),
        residual_g: 2.0 * root.root.p.re / root.root.p.im,
        error: if error.is_finite() {
            error
        } else {
            (second.t - first.t).abs() / root.t.abs().max(1e-12)
        },
        interpolated_speed_m_s: interpolated,
        confidence: first.confidence.min(second.confidence),
        shape: root.root.x,
    }))
}

/// Divergence inside the sweep, from the singular dynamic pressures of K - q Re Q(0): exact, whatever the real roots do.
pub(crate) fn find_divergence(
    equation: &mut Characteristic<'_>,
    path: &Path<'_>,
    parameters: &[f64],
    branches: &[Branch],
    settings: &Settings,
) -> Result<Vec<Crossing>> {
    let mut crossings = Vec::new();
    for (pressure, shape) in equation.divergence()? {
        for pair in parameters.windows(2) {
            let excess = |t: f64| path(t).dynamic_pressure() - pressure;
            let (mut low, mut high) = (pair[0], pair[1]);
            if excess(low) * excess(high) > 0.0 || excess(low) == 0.0 {
                continue;
            }
            let interpolated = low + (high - low) * excess(low) / (excess(low) - excess(high));
            for _ in 0..100 {
                let middle = 0.5 * (low + high);
                if middle == low || middle == high {
                    break;
                }
                if excess(middle) * excess(low) > 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let t = 0.5 * (low + high);
            let condition = path(t);
            let y = equation.left_static(&shape, condition)?;
            let root = Root {
                p: c64::new(0.0, 0.0),
                x: shape.clone(),
                y,
                real: true,
            };
            let step = 1e-4 * (pair[1] - pair[0]);
            let rate = equation.rate(&root, condition, path(t - step), path(t + step), 2.0 * step)?;
            let g_rate = 2.0 * rate.re * equation.semichord_m() / (condition.speed_m_s * std::f64::consts::LN_2);
            let forward = (pair[1] - pair[0]).signum();
            // Where the forces know no damping at all (Hassig's form, no B) the real root leaves as a square root: its rate
            // at zero is infinite, and pressure takes stiffness away.
            let slope = if g_rate == 0.0 {
                f64::INFINITY * forward
            } else {
                t * g_rate
            };
            let owner = owner(equation, branches, t, &shape);
            crossings.push(Crossing {
                mode: owner.map_or(1, |b| b.mode),
                kind: CrossingKind::Divergence,
                direction: if slope * pressure_rate(path, t, pair[1] - pair[0]) * forward >= 0.0 {
                    Direction::Onset
                } else {
                    Direction::Recovery
                },
                parameter: t,
                speed_m_s: condition.speed_m_s,
                density_kg_m3: condition.density_kg_m3,
                freq_hz: 0.0,
                k: 0.0,
                k_range: equation.k_range(0.0),
                slope,
                severity: severity(slope),
                residual_g: 0.0,
                error: ((high - low).abs() / t.abs().max(1e-12)).min(settings.tolerance),
                interpolated_speed_m_s: path(interpolated).speed_m_s,
                confidence: owner.map_or(0.0, |b| nearest(b, t).map_or(0.0, |s| s.confidence)),
                shape: shape.clone(),
            });
        }
    }
    Ok(crossings)
}

fn nearest(branch: &Branch, t: f64) -> Option<&Station> {
    branch
        .stations
        .iter()
        .min_by(|a, b| (a.t - t).abs().total_cmp(&(b.t - t).abs()))
}

/// The branch that diverges: one whose real root changes sign there, else the one most like the shape.
fn owner<'b>(equation: &Characteristic<'_>, branches: &'b [Branch], t: f64, shape: &[c64]) -> Option<&'b Branch> {
    let crosses = |b: &&Branch| {
        b.stations.windows(2).any(|w| {
            let inside = (w[0].t - t) * (w[1].t - t) <= 0.0;
            inside && w[0].root.real && w[1].root.real && w[0].root.p.re * w[1].root.p.re <= 0.0
        })
    };
    let fit = |b: &Branch| nearest(b, t).map_or(0.0, |s| equation.mac(&s.root.x, shape));
    branches.iter().find(crosses).or_else(|| {
        branches
            .iter()
            .max_by(|a, b| fit(a).total_cmp(&fit(b)).then(b.mode.cmp(&a.mode)))
    })
}
