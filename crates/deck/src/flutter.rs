//! The FLUTTER card's request: which conditions, which interpolation, and the rows of the summary.

use std::collections::BTreeMap;

use dip_dlm::c64;
use dip_flutter::{
    CrossingKind, Direction, Extension, FlutterProblem, FlutterSolution, Interpolation, Method, Settings, Structure,
    Sweep, TabulatedForces, k_roots, solve, solve_k,
};
use dip_nastran::{
    Note, Severity,
    bulk::Bulk,
    cards::control::{Factors, Flutter, FlutterMethod, KInterpolation},
};
use faer::Mat;

use crate::{
    aerodynamics::GeneralizedForces,
    error::{Result, SolveError, misfit, missing},
    interpolation::{RadialForces, Spline},
};

/// One line of a flutter summary, as Nastran prints it.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Mach number of the condition.
    pub mach: f64,
    /// Density over AERO's reference density.
    pub density_ratio: f64,
    /// KFREQ: reduced frequency omega c / (2 V).
    pub k: f64,
    /// VELOCITY: true speed over PARAM VREF, in the deck's unit.
    pub velocity: f64,
    /// DAMPING: g, positive unstable; artificial damping for K and KE; 2 sigma b / (V ln 2) for a real root.
    pub damping: f64,
    /// FREQUENCY in Hz.
    pub freq_hz: f64,
    /// COMPLEX EIGENVALUE: p in rad/s for PK and PKNL; for K and KE p b / k, whose imaginary part is a speed.
    pub eigenvalue: c64,
}

/// The rows of one root (POINT) of a summary.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Its number from one: for PK and PKNL the natural mode that it starts from, for K and KE its place by frequency.
    pub number: usize,
    /// Rows in the order of the FLFACT list.
    pub rows: Vec<Row>,
}

/// Where a root's damping vanishes.
#[derive(Debug, Clone, PartialEq)]
pub struct Crossing {
    /// Flutter or divergence.
    pub kind: CrossingKind,
    /// From stable to unstable, or back, as speed rises.
    pub direction: Direction,
    /// The mode's number.
    pub mode: usize,
    /// Mach number.
    pub mach: f64,
    /// Density over AERO's reference density.
    pub density_ratio: f64,
    /// True speed over PARAM VREF, in the deck's unit.
    pub velocity: f64,
    /// Frequency in Hz.
    pub freq_hz: f64,
    /// Reduced frequency.
    pub k: f64,
    /// Whether it lies on a straight line between two rows (PKNL) instead of being solved for.
    pub is_interpolated: bool,
}

/// The flutter summary of one method at one Mach number and density (PKNL: of all its points).
#[derive(Debug, Clone)]
pub struct Summary {
    /// Number of the FLUTTER card.
    pub request: u32,
    /// Method.
    pub method: FlutterMethod,
    /// Mach number; that of the first row for PKNL.
    pub mach: f64,
    /// Density ratio; that of the first row for PKNL.
    pub density_ratio: f64,
    /// Roots.
    pub points: Vec<Point>,
    /// Crossings in the order of speed.
    pub crossings: Vec<Crossing>,
    /// What the solver wants looked at.
    pub warnings: Vec<String>,
    /// Tracked curves, for figures; speeds and densities in the deck's units. None for PKNL, whose points are solved apart.
    pub solution: Option<FlutterSolution>,
}

/// What all conditions of a request share.
pub(crate) struct Problem<'a> {
    pub bulk: &'a Bulk,
    pub structure: &'a Structure,
    pub forces: &'a [GeneralizedForces],
    pub semichord: f64,
    pub reference_density: f64,
}

impl Problem<'_> {
    /// Solves one FLUTTER card.
    ///
    /// # Errors
    /// Missing lists, Mach numbers without aerodynamics, densities and speeds that cannot be.
    pub fn solve(&self, flutter: &Flutter, notes: &mut Vec<Note>) -> Result<Vec<Summary>> {
        let card = format!("FLUTTER {}", flutter.id);
        let list = |i: usize| -> Result<&Factors> {
            let id = flutter.lists[i];
            self.bulk
                .factors
                .get(&id)
                .ok_or_else(|| missing(&flutter.at, card.clone(), "FLFACT", id))
        };
        let (densities, machs, third) = (list(0)?, list(1)?, list(2)?);
        for (name, factors) in [("density ratios", densities), ("Mach numbers", machs)] {
            if let Some(bad) = factors
                .values
                .iter()
                .find(|x| **x < 0.0 || (name == "density ratios" && **x == 0.0))
            {
                return Err(misfit(
                    &factors.at,
                    format!("FLFACT {}", factors.id),
                    format!("{name} cannot be {bad}"),
                ));
            }
        }
        if third.values.contains(&0.0) {
            return Err(misfit(
                &third.at,
                format!("FLFACT {}", third.id),
                "a reduced frequency or velocity of zero has no solution",
            ));
        }
        let vref = match self.bulk.parameters.get("VREF") {
            Some(p) => p.real().map_err(|e| SolveError::Deck(e.into()))?,
            None => 1.0,
        };
        if vref <= 0.0 {
            return Err(SolveError::Missing {
                what: format!("has PARAM VREF {vref}; it must be positive"),
            });
        }
        if flutter.method == FlutterMethod::PkNl {
            return Ok(vec![self.matched(flutter, [densities, machs, third], vref, notes)?]);
        }
        let mut found = Vec::new();
        for &mach in &machs.values {
            if matches!(flutter.method, FlutterMethod::K | FlutterMethod::Ke) {
                let forces = self.radial(flutter, mach, notes)?;
                for &ratio in &densities.values {
                    found.push(self.over_k(flutter, (mach, ratio), &third.values, vref, &forces)?);
                }
            } else {
                let table = self.table(flutter, mach, notes)?;
                for &ratio in &densities.values {
                    found.push(self.over_speed(flutter, (mach, ratio), &third.values, vref, &table)?);
                }
            }
        }
        Ok(found)
    }

    /// Forces at the Mach number that is nearest to the one asked for, by rising reduced frequency.
    fn nearest(&self, flutter: &Flutter, mach: f64, notes: &mut Vec<Note>) -> Result<Vec<&GeneralizedForces>> {
        let nearest = self
            .forces
            .iter()
            .map(|f| f.mach)
            .min_by(|a, b| (a - mach).abs().total_cmp(&(b - mach).abs()))
            .ok_or_else(|| SolveError::Missing {
                what: "has no MKAERO1 or MKAERO2 card".to_owned(),
            })?;
        if (nearest - mach).abs() > 1e-6 {
            notes.push(Note {
                at: flutter.at.clone(),
                card: format!("FLUTTER {}", flutter.id),
                severity: Severity::Warning,
                text: format!("no MKAERO card has Mach {mach}; aerodynamics of Mach {nearest} are used"),
            });
        }
        let mut entries: Vec<&GeneralizedForces> = self.forces.iter().filter(|f| f.mach == nearest).collect();
        entries.sort_by(|a, b| a.k.total_cmp(&b.k));
        Ok(entries)
    }

    /// The PK methods' interpolation: Re Q and Im Q / k as even splines.
    fn table(&self, flutter: &Flutter, mach: f64, notes: &mut Vec<Note>) -> Result<TabulatedForces> {
        let entries = self.nearest(flutter, mach, notes)?;
        let ks: Vec<f64> = entries.iter().map(|e| e.k).collect();
        let q: Vec<Mat<c64>> = entries
            .iter()
            .map(|e| Mat::from_fn(e.q.rows(), e.q.columns(), |i, j| e.q[(i, j)]))
            .collect();
        // Nastran's spline goes on beyond the last k as a straight line.
        Ok(TabulatedForces::new(&ks, &q, Interpolation::EvenCubicSpline)?.with_extension(Extension::Linear))
    }

    /// The K methods' interpolation.
    fn radial(&self, flutter: &Flutter, mach: f64, notes: &mut Vec<Note>) -> Result<RadialForces> {
        let card = || format!("FLUTTER {}", flutter.id);
        if flutter.interpolation == KInterpolation::Surface {
            let all: Vec<&GeneralizedForces> = self.forces.iter().collect();
            if let Some(forces) = RadialForces::new(Spline::Plate, mach, &all) {
                return Ok(forces);
            }
            notes.push(Note {
                at: flutter.at.clone(),
                card: card(),
                severity: Severity::Warning,
                text: "IMETH S needs MKAERO pairs that do not lie on one line; L is used".to_owned(),
            });
        }
        let entries = self.nearest(flutter, mach, notes)?;
        RadialForces::new(Spline::Cubic, mach, &entries).ok_or_else(|| {
            misfit(
                &flutter.at,
                card(),
                "the reduced frequencies of the MKAERO cards are too close to each other to interpolate",
            )
        })
    }

    fn greatest_k(&self) -> f64 {
        self.forces.iter().map(|f| f.k).fold(0.0, f64::max)
    }

    fn problem<'t>(&'t self, mach: f64, forces: &'t dyn dip_flutter::GeneralizedForces) -> FlutterProblem<'t> {
        FlutterProblem {
            structure: self.structure,
            forces,
            semichord_m: self.semichord,
            mach,
        }
    }

    fn over_k(
        &self,
        flutter: &Flutter,
        (mach, ratio): (f64, f64),
        ks: &[f64],
        vref: f64,
        forces: &RadialForces,
    ) -> Result<Summary> {
        let method = if flutter.method == FlutterMethod::K {
            Method::K
        } else {
            Method::Ke
        };
        let density = ratio * self.reference_density;
        let ks: Vec<f64> = ks.iter().map(|k| k.abs()).collect();
        let problem = self.problem(mach, forces);
        let roots = k_roots(&problem, method, density, &ks)?;
        let count = flutter.roots.unwrap_or(usize::MAX).min(self.structure.size());
        let points = (0..count)
            .map(|number| Point {
                number: number + 1,
                rows: roots
                    .iter()
                    .filter_map(|at_k| at_k.get(number))
                    .map(|root| Row {
                        mach,
                        density_ratio: ratio,
                        k: root.k,
                        velocity: root.speed_m_s.unwrap_or(0.0) / vref,
                        damping: root.g,
                        freq_hz: root.omega_rad_s / std::f64::consts::TAU,
                        eigenvalue: root.p_rad_s * (self.semichord / root.k / vref),
                    })
                    .collect(),
            })
            .collect();
        let solution = solve_k(&problem, method, density, &ks, &Settings::default())?;
        Ok(self.summary(flutter, (mach, ratio), points, solution, vref))
    }

    fn over_speed(
        &self,
        flutter: &Flutter,
        (mach, ratio): (f64, f64),
        velocities: &[f64],
        vref: f64,
        table: &TabulatedForces,
    ) -> Result<Summary> {
        // A negative velocity only asks for eigenvectors.
        let listed: Vec<f64> = velocities.iter().map(|v| v.abs()).collect();
        let mut speeds = listed.clone();
        speeds.sort_by(f64::total_cmp);
        speeds.dedup();
        let sweep = Sweep::Speed {
            density_kg_m3: ratio * self.reference_density,
            speeds_m_s: &speeds,
        };
        let solution = solve(&self.problem(mach, table), Method::Pk, &sweep, &Settings::default())?;
        let points = solution
            .modes
            .iter()
            .filter(|curve| flutter.roots.is_none_or(|n| curve.mode <= n) || curve.is_lag_root)
            .map(|curve| Point {
                number: curve.mode,
                rows: listed
                    .iter()
                    .filter_map(|v| curve.points.iter().find(|p| p.requested && p.parameter == *v))
                    .map(|p| row(p, (mach, ratio), vref))
                    .collect(),
            })
            .filter(|point: &Point| !point.rows.is_empty())
            .collect();
        Ok(self.summary(flutter, (mach, ratio), points, solution, vref))
    }

    /// PKNL: the lists taken together, point by point; roots are numbered by the natural modes that they come from.
    fn matched(&self, flutter: &Flutter, lists: [&Factors; 3], vref: f64, notes: &mut Vec<Note>) -> Result<Summary> {
        let [densities, machs, speeds] = lists.map(|l| &l.values);
        if densities.len() != machs.len() || machs.len() != speeds.len() {
            return Err(misfit(
                &flutter.at,
                format!("FLUTTER {}", flutter.id),
                format!(
                    "PKNL needs lists of one length, got {} density ratios, {} Mach numbers and {} velocities",
                    densities.len(),
                    machs.len(),
                    speeds.len()
                ),
            ));
        }
        let mut points: Vec<Point> = Vec::new();
        let mut warnings = Vec::new();
        for ((&ratio, &mach), &speed) in densities.iter().zip(machs).zip(speeds) {
            let table = self.table(flutter, mach, notes)?;
            let speeds = [speed.abs()];
            let sweep = Sweep::Speed {
                density_kg_m3: ratio * self.reference_density,
                speeds_m_s: &speeds,
            };
            let solution = solve(&self.problem(mach, &table), Method::Pk, &sweep, &Settings::default())?;
            for curve in &solution.modes {
                let Some(found) = curve.points.iter().find(|p| p.requested) else {
                    continue;
                };
                let row = row(found, (mach, ratio), vref);
                match points.iter_mut().find(|p| p.number == curve.mode) {
                    Some(point) => point.rows.push(row),
                    None => points.push(Point {
                        number: curve.mode,
                        rows: vec![row],
                    }),
                }
            }
            warnings.extend(describe_all(&solution.warnings, vref, self.greatest_k()));
        }
        points.retain(|p| flutter.roots.is_none_or(|n| p.number <= n));
        points.sort_by_key(|p| p.number);
        warnings.sort();
        warnings.dedup();
        let mut crossings: Vec<Crossing> = points.iter().flat_map(between_rows).collect();
        crossings.sort_by(|a, b| a.velocity.total_cmp(&b.velocity));
        Ok(Summary {
            request: flutter.id,
            method: flutter.method,
            mach: machs[0],
            density_ratio: densities[0],
            points,
            crossings,
            warnings,
            solution: None,
        })
    }

    fn summary(
        &self,
        flutter: &Flutter,
        (mach, ratio): (f64, f64),
        points: Vec<Point>,
        solution: FlutterSolution,
        vref: f64,
    ) -> Summary {
        // The K methods make phantoms of rigid-body modes: no speed, no frequency, or damping that jumps past zero.
        let modes = &self.structure.natural_modes().omega_rad_s;
        let least_hz = 1e-6 * modes.iter().copied().fold(0.0, f64::max);
        let is_real = |c: &dip_flutter::Crossing| {
            solution.method.is_p_method() || (c.freq_hz > least_hz && c.speed_m_s > 0.0 && c.residual_g.abs() < 1e-4)
        };
        let phantoms = solution.crossings.iter().filter(|c| !is_real(c)).count();
        let mut warnings = describe_all(&solution.warnings, vref, self.greatest_k());
        if phantoms > 0 {
            warnings.push(format!(
                "{phantoms} changes of sign of the damping of rigid-body or overdamped roots are no crossings and are left out; see PK"
            ));
        }
        let crossings = solution
            .crossings
            .iter()
            .filter(|c| is_real(c))
            .map(|c| Crossing {
                kind: c.kind,
                direction: c.direction,
                mode: c.mode,
                mach,
                density_ratio: ratio,
                velocity: c.speed_m_s / vref,
                freq_hz: c.freq_hz,
                k: c.k,
                is_interpolated: false,
            })
            .collect();
        Summary {
            request: flutter.id,
            method: flutter.method,
            mach,
            density_ratio: ratio,
            points,
            crossings,
            warnings,
            solution: Some(solution),
        }
    }
}

fn row(p: &dip_flutter::ModePoint, (mach, density_ratio): (f64, f64), vref: f64) -> Row {
    Row {
        mach,
        density_ratio,
        k: p.k,
        velocity: p.speed_m_s / vref,
        damping: p.g,
        freq_hz: p.freq_hz,
        eigenvalue: p.p_rad_s,
    }
}

/// Changes of sign of the damping between the rows of a point, on straight lines.
fn between_rows(point: &Point) -> Vec<Crossing> {
    point
        .rows
        .windows(2)
        .filter(|pair| (pair[0].damping < 0.0) != (pair[1].damping < 0.0))
        .map(|pair| {
            let (a, b) = (&pair[0], &pair[1]);
            let part = a.damping / (a.damping - b.damping);
            let at = |value: fn(&Row) -> f64| value(a) + part * (value(b) - value(a));
            let oscillates = a.freq_hz > 0.0 && b.freq_hz > 0.0;
            Crossing {
                kind: if oscillates {
                    CrossingKind::Flutter
                } else {
                    CrossingKind::Divergence
                },
                direction: if a.damping < 0.0 {
                    Direction::Onset
                } else {
                    Direction::Recovery
                },
                mode: point.number,
                mach: at(|r| r.mach),
                density_ratio: at(|r| r.density_ratio),
                velocity: at(|r| r.velocity),
                freq_hz: at(|r| r.freq_hz),
                k: at(|r| r.k),
                is_interpolated: true,
            }
        })
        .collect()
}

/// The solver's warnings in words. Doubts about a mode's identity, which may be many, make one line a mode.
fn describe_all(warnings: &[dip_flutter::Warning], vref: f64, greatest_k: f64) -> Vec<String> {
    let mut doubts: BTreeMap<usize, usize> = BTreeMap::new();
    let mut words = Vec::new();
    for warning in warnings {
        if let dip_flutter::Warning::LowConfidence { mode, .. } = warning {
            *doubts.entry(*mode).or_default() += 1;
        } else {
            words.extend(describe(warning, vref, greatest_k));
        }
    }
    words.extend(
        doubts
            .iter()
            .map(|(mode, count)| format!("mode {mode}: its identity is uncertain at {count} conditions")),
    );
    words
}

/// One warning in words; none for what is no matter of concern in a deck.
fn describe(warning: &dip_flutter::Warning, vref: f64, greatest_k: f64) -> Option<String> {
    use dip_flutter::Warning as W;
    let words = match warning {
        // Below the least k both interpolations go on to k = 0, which real roots need.
        W::OutOfRange { k_maximum, .. } if *k_maximum <= greatest_k => return None,
        W::OutOfRange {
            mode,
            points,
            k_minimum,
            k_maximum,
        } => format!(
            "mode {mode}: {points} points lie outside the reduced frequencies of the MKAERO cards (k {k_minimum:.4} to {k_maximum:.4})"
        ),
        W::LowConfidence { .. } => return None,
        W::Lost { mode, parameter } => format!("mode {mode}: no root beyond {:.6}", parameter / vref),
        W::ExtraRoot { mode, parameter } => {
            format!(
                "root {mode}: unstable and of no natural mode, found at velocity {:.6}",
                parameter / vref
            )
        }
        W::Artifact { parameter, p_rad_s } => format!(
            "a root {p_rad_s:.4} rad/s at velocity {:.6} is a product of the PK form and is left out",
            parameter / vref
        ),
        W::UnstableAtStart { mode } => format!("mode {mode}: unstable at the first velocity of the list"),
    };
    Some(words)
}
