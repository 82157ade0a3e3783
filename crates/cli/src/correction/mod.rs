//! The correction of one case: recordings, references on the boxes, corrected generalized forces, audit, flutter.
//!
//! `dlm correct` runs it for a case; the lattice, modes and flutter solution are those of `frequency`.

mod case;
pub mod figures;
mod notes;

pub use case::{CorrectionCase, method};

use crate::assemble::modes as make_modes;
use crate::exit::Stop;
use crate::frequency::FlutterRow;
use crate::progress::{Seconds, Timer, check_interrupt};
use dip_case::file::FlutterTable;
use dip_correct::apply::{self, Corrected};
use dip_correct::audit::{self, Audit, StripPhase};
use dip_correct::bridge::{self, Assembled, Mapped};
use dip_correct::reading::{Reading, ReadingSettings, read};
use dip_correct::weight::schedule::Place;
use dip_correct::{Correction, Method};
use dip_dlm::ComplexMatrix;
use dip_dlm::aic::Aerodynamics;
use dip_dlm::motion::BoxMotion;
use dip_flutter as fl;
use dip_record::Recording;
use faer::Mat;
use rayon::prelude::*;
use serde::Serialize;

/// One flutter point with the correction that its forces had.
#[derive(Debug, Clone, Serialize)]
pub struct CorrectedRow {
    /// Name of the correction; `none` for the lattice as it is.
    pub correction: &'static str,
    /// The flutter point.
    #[serde(flatten)]
    pub row: FlutterRow,
    /// What the correction rests on at the flutter point's reduced frequency.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rests_on: Option<Place>,
    /// Part of the correction that is left there: 1 up to the highest recorded reduced frequency, 0 where the lattice is linear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correction_strength: Option<f64>,
    /// Flutter speed over the uncorrected one of the same method, less 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_change: Option<f64>,
}

/// A solution with its row.
#[derive(Debug)]
pub struct CorrectedSolution {
    /// The row.
    pub row: CorrectedRow,
    /// The curves.
    pub solution: fl::FlutterSolution,
}

/// All at one Mach number.
#[derive(Debug)]
pub struct MachCorrection {
    /// Mach number.
    pub mach: f64,
    /// Readings on the boxes.
    pub mapped: Vec<Mapped>,
    /// Weights and corrected forces.
    pub correction: Correction,
    /// Checks.
    pub audit: Audit,
    /// Section lift along the span at every recorded k of the main motion.
    pub phases: Vec<(f64, Vec<StripPhase>)>,
    /// Flutter: uncorrected first, then by correction; for each by flutter method.
    pub solutions: Vec<CorrectedSolution>,
    /// What to know of the recordings.
    pub notes: Vec<String>,
}

/// All that a case gives.
#[derive(Debug)]
pub struct CorrectionResults {
    /// The lattice.
    pub aerodynamics: Aerodynamics,
    /// By Mach number, in the case's order; Mach numbers without recordings are left out.
    pub machs: Vec<MachCorrection>,
    /// What to know besides.
    pub notes: Vec<String>,
    /// Seconds for each stage.
    pub stages: Vec<(String, Seconds)>,
}

impl CorrectionCase {
    /// Runs the chain. `begin` is told what starts.
    ///
    /// # Errors
    /// What is wrong in files and recordings, what a solver refuses, an interrupt.
    pub fn solve(&self, mut begin: impl FnMut(&str)) -> Result<CorrectionResults, Stop> {
        let case = &self.flutter;
        let Some(flutter) = &case.file.flutter else {
            return Err(case
                .document
                .error(
                    "",
                    "missing table [flutter]",
                    "add [flutter] with methods and densities",
                )
                .into());
        };
        let groups = self.by_mach()?;
        let mut stages = Vec::new();
        begin("modes, lattice, splines");
        let timer = Timer::start();
        let structure = make_modes::modes(&case.document, &case.file)?;
        let aerodynamics = case.aerodynamics()?;
        case.findings(&aerodynamics)?;
        let (motion, generalized) = case.motion(&aerodynamics, &structure)?;
        let damped = case.structure(flutter, &generalized)?;
        stages.push(("modes, lattice, splines".to_owned(), timer.seconds()));
        let mut machs = Vec::new();
        for (index, list) in groups {
            check_interrupt("nothing yet: a correction is quick to do again")?;
            let mach = case.file.lattice.mach[index];
            machs.push(self.at_mach(
                index,
                &list,
                &aerodynamics,
                &motion,
                flutter,
                &damped,
                &mut begin,
                &mut stages,
            )?);
            tracing::debug!("Mach {mach} done");
        }
        let notes = notes::notes(&case.file.lattice.mach, first_method(flutter), &machs);
        Ok(CorrectionResults {
            aerodynamics,
            machs,
            notes,
            stages,
        })
    }

    #[expect(clippy::too_many_arguments, reason = "one Mach number of the chain, described once")]
    fn at_mach(
        &self,
        index: usize,
        list: &[usize],
        aerodynamics: &Aerodynamics,
        motion: &BoxMotion,
        flutter: &FlutterTable,
        damped: &fl::Structure,
        begin: &mut impl FnMut(&str),
        stages: &mut Vec<(String, Seconds)>,
    ) -> Result<MachCorrection, Stop> {
        let case = &self.flutter;
        let mach = case.file.lattice.mach[index];
        begin(&format!("harmonics and boxes, Mach {mach}"));
        let timer = Timer::start();
        let k = case.reduced_frequencies();
        let settings = ReadingSettings {
            harmonics: self.table.harmonics,
            cycles: self.table.cycles,
            pulse_k: k.clone(),
        };
        let mut readings: Vec<(&Recording, Vec<Reading>)> = Vec::new();
        for &i in list {
            let (path, recording) = &self.recordings[i];
            let label = case::name(path);
            bridge::check_match(recording, &label, aerodynamics, mach).map_err(|e| {
                Stop::input(
                    e.to_string(),
                    "correct the case, or give a recording that belongs to it",
                )
            })?;
            let of = read(recording, &label, &settings)
                .map_err(|e| Stop::input(e.to_string(), "look at the recording with `dip info` and `dip doctor`"))?;
            if let Some(axis) = &self.table.axis {
                for reading in &of {
                    bridge::check_axis(reading, axis.map(|l| l.0), aerodynamics.semichord())
                        .map_err(|e| Stop::input(e.to_string(), "correct.axis and the recording must agree"))?;
                }
            }
            readings.push((recording, of));
        }
        let Assembled {
            references,
            mapped,
            notes,
        } = bridge::assemble(aerodynamics, case.point_rule(), motion, &readings, self.rule())
            .map_err(|e| Stop::input(e.to_string(), "give recordings of this wing and its modes"))?;
        stages.push((format!("harmonics and boxes, Mach {mach}"), timer.seconds()));

        begin(&format!("corrected forces, Mach {mach}"));
        let timer = Timer::start();
        let methods: Vec<Method> = self.table.methods.iter().map(|m| method(*m)).collect();
        let correction = apply::correct(aerodynamics, motion, mach, &k, &references, &methods, self.settings())
            .map_err(|e| {
                Stop::input(
                    format!("Mach {mach}: {e}"),
                    "change correct.methods, or record what is missing",
                )
            })?;
        let limits = audit::Limits::default();
        let audit = audit::audit(
            aerodynamics,
            mach,
            &references,
            &mapped,
            &correction,
            self.rule(),
            &limits,
        )
        .map_err(|e| Stop::failed(format!("audit at Mach {mach}: {e}"), "check the lattice"))?;
        let phases = correction.recordings.iter().map(|at| {
            let strips = audit::strip_phases(aerodynamics, &at.recorded, &at.linear);
            (at.k, strips)
        });
        let phases = phases.collect();
        let aero = timer.seconds();
        stages.push((format!("corrected forces and audit, Mach {mach}"), aero));

        begin(&format!("flutter, Mach {mach}"));
        let timer = Timer::start();
        let solutions = self.flutter(index, flutter, damped, &correction)?;
        stages.push((format!("flutter, Mach {mach}"), timer.seconds()));
        Ok(MachCorrection {
            mach,
            notes,
            mapped,
            correction,
            audit,
            phases,
            solutions,
        })
    }

    /// Flutter of the lattice as it is and by every correction, by every flutter method.
    fn flutter(
        &self,
        index: usize,
        flutter: &FlutterTable,
        damped: &fl::Structure,
        correction: &Correction,
    ) -> Result<Vec<CorrectedSolution>, Stop> {
        let case = &self.flutter;
        let tables = std::iter::once((None, &correction.linear))
            .chain(correction.methods.iter().map(|c| (Some(c), &c.q)))
            .map(|(corrected, q)| Ok((corrected, self.tabulated(&correction.k, q)?)))
            .collect::<Result<Vec<_>, Stop>>()?;
        let jobs: Vec<(Option<&Corrected>, &fl::TabulatedForces, usize)> = tables
            .iter()
            .flat_map(|(corrected, forces)| (0..flutter.methods.len()).map(move |m| (*corrected, forces, m)))
            .collect();
        let solved: Vec<Result<CorrectedSolution, Stop>> = jobs
            .par_iter()
            .map(|(corrected, forces, m)| {
                let timer = Timer::start();
                let by = flutter.methods[*m];
                let solution = case.flutter(flutter, by, index, damped, forces)?;
                let mut row = case.row(flutter, by, index, &solution);
                row.time_s = timer.seconds().wall_s;
                row.cpu_s = row.time_s;
                let k = row.reduced_frequency;
                let rests_on = corrected.and_then(|c| k.map(|k| resting(c, correction, k)));
                let strength = rests_on.zip(k).map(|(place, k)| match place {
                    Place::Blended | Place::Linear => correction.schedule.strength(k),
                    Place::Recorded | Place::Below => 1.0,
                });
                if let (Some(strength), Some(k)) = (strength.filter(|s| *s < FADED), k) {
                    row.warnings.push(format!(
                        "the flutter point's reduced frequency {k:.4} lies far beyond the recordings: {:.0} % of the correction is left there; record one at or above it",
                        100.0 * strength
                    ));
                }
                Ok(CorrectedSolution {
                    row: CorrectedRow {
                        correction: corrected.map_or("none", |c| c.method.name()),
                        row,
                        rests_on,
                        correction_strength: strength,
                        speed_change: None,
                    },
                    solution,
                })
            })
            .collect();
        // The first error in the order of the jobs, whatever thread met one first.
        let mut solved = solved.into_iter().collect::<Result<Vec<_>, Stop>>()?;
        let n = flutter.methods.len();
        let linear: Vec<Option<f64>> = solved.iter().take(n).map(|s| s.row.row.flutter_speed_m_s).collect();
        for (i, s) in solved.iter_mut().enumerate().skip(n) {
            s.row.speed_change = s
                .row
                .row
                .flutter_speed_m_s
                .zip(linear[i % n])
                .map(|(own, linear)| own / linear - 1.0);
        }
        Ok(solved)
    }

    fn tabulated(&self, k: &[f64], q: &[ComplexMatrix]) -> Result<fl::TabulatedForces, Stop> {
        let q: Vec<Mat<faer::c64>> = q.iter().map(|m| m.view().to_owned()).collect();
        fl::TabulatedForces::new(k, &q, fl::Interpolation::EvenCubicSpline).map_err(|e| {
            self.flutter
                .document
                .error("lattice.reduced_frequencies", e.to_string(), "give more of them")
                .into()
        })
    }
}

/// Part of the correction below which a flutter point is a warning and no longer a note.
const FADED: f64 = 0.75;

/// What a correction rests on at `k`: the least informed of the tabulated frequencies on both sides.
fn resting(corrected: &Corrected, correction: &Correction, k: f64) -> Place {
    let above = correction
        .k
        .partition_point(|x| *x < k)
        .min(corrected.place.len().saturating_sub(1));
    if corrected.method.is_steady() {
        return Place::Recorded;
    }
    let schedule = correction.schedule.place(k);
    match corrected.method {
        Method::Mode | Method::Full => corrected.place.get(above).copied().unwrap_or(schedule),
        _ => schedule,
    }
}

/// The flutter method that notes and pictures go by.
fn first_method(flutter: &FlutterTable) -> fl::Method {
    flutter
        .methods
        .first()
        .map_or(fl::Method::Pk, |m| crate::frequency::solver(*m))
}
