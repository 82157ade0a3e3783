//! The p methods (PK after Nastran and Hassig, g): from natural modes through the sweep to crossings.

use faer::c64;

use crate::characteristic::{Characteristic, DampingExpansion, Root};
use crate::crossing::{damping_g, find_crossings, find_divergence, insert_extrema};
use crate::error::{FlutterError, Result};
use crate::follow::{Branch, Path, Station, advance, oscillating_roots, real_roots, same_root};
use crate::forces::KRange;
use crate::problem::{Condition, FlutterProblem, OutOfRange, Settings, Sweep};
use crate::solution::{Crossing, FlutterSolution, Method, ModeCurve, ModePoint, Warning};

/// Growth rate over the greatest natural frequency above which a root of the audit counts as unstable.
const UNSTABLE: f64 = 1e-7;

pub(crate) fn solve(
    problem: &FlutterProblem<'_>,
    method: Method,
    sweep: &Sweep<'_>,
    settings: &Settings,
) -> Result<FlutterSolution> {
    let mut equation = Characteristic::new(problem, DampingExpansion::of(method));
    let mach = problem.mach;
    let path = |t: f64| sweep.condition(mach, t);
    let parameters = sweep.parameters();
    let mut warnings = Vec::new();

    let mut branches = first_condition(&mut equation, path(parameters[0]), parameters[0], settings)?;
    // Rates at the first condition are those of the homotopy: replace them by those of the sweep.
    for branch in &mut branches {
        if let Some(station) = branch.stations.last_mut() {
            let step = 1e-5 * parameters[0].abs().max(1e-3);
            let (before, after) = (path(station.t - step), path(station.t + step));
            station.rate = equation.rate(&station.root, path(station.t), before, after, 2.0 * step)?;
        }
    }
    for pair in parameters.windows(2) {
        advance(
            &mut equation,
            &path,
            &mut branches,
            (pair[0], pair[1]),
            settings,
            0,
            true,
        )?;
    }
    if settings.audit {
        audit(&mut equation, &path, parameters, &mut branches, settings, &mut warnings)?;
    }

    let falling = parameters.len() > 1 && parameters[1] < parameters[0];
    let mut crossings = Vec::new();
    let mut humps = Vec::new();
    for branch in &mut branches {
        humps.extend(insert_extrema(&mut equation, &path, branch)?);
        crossings.extend(find_crossings(&mut equation, &path, branch, settings, &mut warnings)?);
    }
    crossings.extend(find_divergence(&mut equation, &path, parameters, &branches, settings)?);
    let order = |a: f64, b: f64| if falling { b.total_cmp(&a) } else { a.total_cmp(&b) };
    crossings.sort_by(|a, b| order(a.parameter, b.parameter));
    drop_repeated(&mut crossings);
    humps.sort_by(|a, b| order(a.parameter, b.parameter));

    let modes: Vec<ModeCurve> = branches.iter().map(|b| curve(&equation, problem, &path, b)).collect();
    collect_warnings(problem, &branches, &modes, settings, &mut warnings)?;
    for crossing in &crossings {
        refuse_outside(problem, settings, crossing.k, "a crossing")?;
    }
    Ok(FlutterSolution {
        method,
        mach,
        modes,
        crossings,
        humps,
        warnings,
    })
}

/// Roots at the first condition: from the natural modes by raising the density from zero at constant speed, so that every
/// root bears the number of the natural mode it comes from.
fn first_condition(
    equation: &mut Characteristic<'_>,
    condition: Condition,
    parameter: f64,
    settings: &Settings,
) -> Result<Vec<Branch>> {
    let raise = |s: f64| Condition {
        density_kg_m3: s * condition.density_kg_m3,
        ..condition
    };
    let natural = equation.natural_modes();
    let mut branches: Vec<Branch> = (1..=natural.len())
        .map(|mode| Branch {
            mode,
            is_lag_root: false,
            stations: Vec::new(),
            lost: false,
        })
        .collect();
    for (branch, (omega, shape)) in branches.iter_mut().zip(&natural) {
        if *omega < 1e-6 * equation.scale_rad_s {
            continue;
        }
        let start = Root {
            p: c64::new(0.0, *omega),
            x: shape.clone(),
            y: shape.clone(),
            real: false,
        };
        let still = raise(0.0);
        // Without air the root is p = i omega up to damping; repeated frequencies keep their given shapes.
        let root = equation
            .correct(&start, still)?
            .filter(|r| equation.mac(&r.x, shape) > 0.5)
            .unwrap_or(start);
        let rate = equation.rate(&root, still, raise(-1e-4), raise(1e-4), 2e-4)?;
        branch.stations.push(Station {
            t: 0.0,
            root,
            rate,
            confidence: 1.0,
            mac: 1.0,
            requested: true,
        });
    }
    advance(equation, &raise, &mut branches, (0.0, 1.0), settings, 0, true)?;
    fill_from_search(equation, condition, &mut branches)?;
    for branch in &mut branches {
        branch.lost = branch.stations.is_empty();
        branch.stations = branch.stations.pop().into_iter().collect();
        for station in &mut branch.stations {
            station.t = parameter;
            station.requested = true;
        }
    }
    Ok(branches)
}

/// Rigid-body modes (no frequency to start from) and roots lost on the way take what the search for all roots finds.
fn fill_from_search(equation: &mut Characteristic<'_>, condition: Condition, branches: &mut [Branch]) -> Result<()> {
    if branches.iter().all(|b| !b.lost && !b.stations.is_empty()) {
        return Ok(());
    }
    let mut candidates = oscillating_roots(equation, condition)?;
    candidates.extend(real_roots(equation, condition)?);
    candidates.sort_by(|a, b| a.p.norm().total_cmp(&b.p.norm()));
    for b in 0..branches.len() {
        if !branches[b].lost && !branches[b].stations.is_empty() {
            continue;
        }
        let held = |root: &Root| {
            branches
                .iter()
                .any(|o| !o.lost && o.stations.last().is_some_and(|s| same_root(equation, &s.root, root)))
        };
        if let Some(index) = candidates.iter().position(|c| !held(c)) {
            let root = candidates.remove(index);
            branches[b].lost = false;
            branches[b].stations.push(Station {
                t: 1.0,
                root,
                rate: c64::new(0.0, 0.0),
                confidence: 0.0,
                mac: 0.0,
                requested: true,
            });
        }
    }
    Ok(())
}

/// Two curves that join at a crossing would report it twice: the mode with the lower number keeps it.
fn drop_repeated(crossings: &mut Vec<Crossing>) {
    let mut kept: Vec<Crossing> = Vec::with_capacity(crossings.len());
    for crossing in crossings.drain(..) {
        let same = |c: &Crossing| {
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * a.abs().max(b.abs());
            c.kind == crossing.kind
                && c.direction == crossing.direction
                && near(c.parameter, crossing.parameter)
                && near(c.freq_hz, crossing.freq_hz)
                && c.mode != crossing.mode
        };
        match kept.iter_mut().find(|c| same(c)) {
            Some(twin) if crossing.mode < twin.mode => *twin = crossing,
            Some(_) => {}
            None => kept.push(crossing),
        }
    }
    *crossings = kept;
}

/// Looks for unstable roots that no mode holds, at the end of the sweep and at the first condition where a mode is
/// unstable, and follows each through the sweep as a branch of its own.
///
/// An oscillating root that ends while it is unstable, without coming from zero damping, is a product of the expansion of Q
/// for strongly damped motion (of the g-method, mostly) and no motion of the wing: it is reported and left out.
fn audit(
    equation: &mut Characteristic<'_>,
    path: &Path<'_>,
    parameters: &[f64],
    branches: &mut Vec<Branch>,
    settings: &Settings,
    warnings: &mut Vec<Warning>,
) -> Result<()> {
    let last = parameters.len() - 1;
    let unstable_at = |t: f64| {
        branches.iter().any(|b| {
            b.stations
                .iter()
                .any(|s| s.t == t && s.root.p.re > UNSTABLE * equation.scale_rad_s)
        })
    };
    let mut places = vec![last];
    if let Some(first) = (0..last).find(|&j| unstable_at(parameters[j])) {
        places.push(first);
    }
    for place in places {
        let t = parameters[place];
        let condition = path(t);
        let mut roots = oscillating_roots(equation, condition)?;
        roots.extend(real_roots(equation, condition)?);
        let floor = UNSTABLE * equation.scale_rad_s;
        for root in roots.into_iter().filter(|r| r.p.re > floor) {
            let held = |b: &Branch| {
                b.stations
                    .iter()
                    .any(|s| s.t == t && same_root(equation, &s.root, &root))
            };
            if branches.iter().any(held) {
                continue;
            }
            let mode = branches.len() + 1;
            let (p, is_real) = (root.p, root.real);
            let step = 1e-5 * t.abs().max(1e-3);
            let rate = equation.rate(&root, condition, path(t - step), path(t + step), 2.0 * step)?;
            let station = Station {
                t,
                root,
                rate,
                confidence: 1.0,
                mac: 1.0,
                requested: true,
            };
            let follow = |equation: &mut Characteristic<'_>, targets: &[f64]| -> Result<Vec<Station>> {
                let mut one = [Branch {
                    mode,
                    is_lag_root: true,
                    stations: vec![station.clone()],
                    lost: false,
                }];
                let mut from = t;
                for &to in targets {
                    advance(
                        equation,
                        path,
                        &mut one,
                        (from, to),
                        settings,
                        settings.halvings.saturating_sub(4),
                        true,
                    )?;
                    if one[0].lost {
                        break;
                    }
                    from = to;
                }
                Ok(one[0].stations.split_off(1))
            };
            let backward: Vec<f64> = parameters[..place].iter().rev().copied().collect();
            let mut stations = follow(equation, &backward)?;
            // Where it runs into the root of a mode that mode goes on: the rest is not new.
            if let Some(joined) = stations.iter().position(|s| holds(equation, branches, s.t, &s.root)) {
                stations.truncate(joined + 1);
            }
            stations.reverse();
            stations.push(station.clone());
            stations.extend(follow(equation, &parameters[place + 1..])?);
            let complete = stations
                .first()
                .is_some_and(|s| s.t == parameters[0] || s.root.p.re <= floor);
            let joins = stations
                .first()
                .is_some_and(|s| holds(equation, branches, s.t, &s.root));
            if complete || joins || is_real {
                warnings.push(Warning::ExtraRoot { mode, parameter: t });
                branches.push(Branch {
                    mode,
                    is_lag_root: true,
                    stations,
                    lost: false,
                });
            } else {
                warnings.push(Warning::Artifact {
                    parameter: t,
                    p_rad_s: p,
                });
            }
        }
    }
    Ok(())
}

/// Whether a branch has this root at this condition.
fn holds(equation: &Characteristic<'_>, branches: &[Branch], t: f64, root: &Root) -> bool {
    branches.iter().any(|b| {
        b.stations
            .iter()
            .any(|s| s.t == t && same_root(equation, &s.root, root))
    })
}

fn curve(equation: &Characteristic<'_>, problem: &FlutterProblem<'_>, path: &Path<'_>, branch: &Branch) -> ModeCurve {
    let points = branch
        .stations
        .iter()
        .map(|s| {
            let condition = path(s.t);
            let k = equation.reduced_frequency(s.root.p.im, condition);
            ModePoint {
                parameter: s.t,
                speed_m_s: condition.speed_m_s,
                density_kg_m3: condition.density_kg_m3,
                p_rad_s: s.root.p,
                freq_hz: s.root.p.im / std::f64::consts::TAU,
                g: damping_g(&s.root, problem.semichord_m, condition),
                k,
                k_range: equation.k_range(k),
                confidence: s.confidence,
                mac: s.mac,
                shape: s.root.x.clone(),
                requested: s.requested,
            }
        })
        .collect();
    let natural = &problem.structure.natural.omega_rad_s;
    let natural_freq_hz = if branch.is_lag_root {
        0.0
    } else {
        natural[branch.mode - 1] / std::f64::consts::TAU
    };
    ModeCurve {
        mode: branch.mode,
        natural_freq_hz,
        is_lag_root: branch.is_lag_root,
        points,
    }
}

fn collect_warnings(
    problem: &FlutterProblem<'_>,
    branches: &[Branch],
    modes: &[ModeCurve],
    settings: &Settings,
    warnings: &mut Vec<Warning>,
) -> Result<()> {
    for (branch, curve) in branches.iter().zip(modes) {
        let mode = branch.mode;
        let outside: Vec<f64> = curve
            .points
            .iter()
            .filter(|p| p.k_range != KRange::Inside)
            .map(|p| p.k)
            .collect();
        if let Some(&first) = outside.first() {
            refuse_outside(problem, settings, first, &format!("mode {mode}"))?;
            warnings.push(Warning::OutOfRange {
                mode,
                points: outside.len(),
                k_minimum: outside.iter().copied().fold(f64::INFINITY, f64::min),
                k_maximum: outside.iter().copied().fold(0.0, f64::max),
            });
        }
        for point in curve.points.iter().filter(|p| p.confidence < settings.confidence) {
            warnings.push(Warning::LowConfidence {
                mode,
                parameter: point.parameter,
                confidence: point.confidence,
            });
        }
        if branch.lost
            && let Some(point) = curve.points.last()
        {
            warnings.push(Warning::Lost {
                mode,
                parameter: point.parameter,
            });
        }
        if curve.points.first().is_some_and(|p| p.g > 1e-6) {
            warnings.push(Warning::UnstableAtStart { mode });
        }
    }
    Ok(())
}

pub(crate) fn refuse_outside(problem: &FlutterProblem<'_>, settings: &Settings, k: f64, at: &str) -> Result<()> {
    let domain = problem.forces.domain();
    if settings.out_of_range == OutOfRange::Refuse && domain.locate(k) != KRange::Inside {
        return Err(FlutterError::OutOfRange {
            k,
            minimum: domain.minimum,
            maximum: domain.maximum,
            at: at.to_string(),
        });
    }
    Ok(())
}
