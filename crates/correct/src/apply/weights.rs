//! What every method needs at any reduced frequency, found once from the recordings.

use super::{AtRecording, RecordedPressures, References};
use crate::CorrectError;
use crate::weight::schedule::Schedule;
use crate::weight::{Diagonal, Limits, force};
use dip_dlm::aic::Aerodynamics;
use dip_dlm::{ComplexMatrix, c64};

/// Recordings of one reference motion in rising k.
pub(super) struct Series<'a> {
    pub(super) schedule: Schedule,
    pub(super) records: Vec<&'a RecordedPressures>,
}

/// Recordings of one reference motion, if there are any.
pub(super) fn series(references: &References, coordinate: usize, blend: f64) -> Option<Series<'_>> {
    let mut records: Vec<&RecordedPressures> = references
        .pressures
        .iter()
        .filter(|p| p.coordinate == coordinate)
        .collect();
    records.sort_by(|a, b| a.k.total_cmp(&b.k));
    // Steady slopes alone say nothing about any k > 0 but through the steady methods.
    (!records.is_empty()).then(|| Series {
        schedule: Schedule::new(records.iter().map(|r| r.k).collect(), blend),
        records,
    })
}

/// One recorded motion with what its pressures have beyond the linear lattice.
pub(super) struct Moved<'a> {
    pub(super) coordinate: usize,
    pub(super) series: Series<'a>,
    /// P_r - AIC w_r `[record][box]`.
    pub(super) away: Vec<Vec<c64>>,
}

/// Everything a method needs at any k.
pub(super) struct Weights<'a> {
    pub(super) aerodynamics: &'a Aerodynamics,
    pub(super) references: &'a References,
    pub(super) area: Vec<f64>,
    pub(super) main: Series<'a>,
    pub(super) recordings: Vec<AtRecording>,
    /// Recording that steady weights come from, real parts only unless it is at k = 0.
    pub(super) steady: usize,
    /// Steady ratios of pressures.
    pub(super) steady_pressure: Diagonal,
    pub(super) steady_weight: Diagonal,
    pub(super) steady_force: Diagonal,
    /// Every recorded motion.
    pub(super) all: Vec<Moved<'a>>,
}

/// Weights at every recording of the main motion.
pub(super) fn at_recordings(
    aerodynamics: &Aerodynamics,
    mach: f64,
    references: &References,
    main: &Series<'_>,
    area: &[f64],
    limits: Limits,
) -> Result<Vec<AtRecording>, CorrectError> {
    let lattice = aerodynamics.lattice();
    let n = lattice.n_boxes();
    let ks = main.schedule.recorded();
    let matrices = aerodynamics.downwash(mach, ks)?;
    let inverses = aerodynamics.for_each_k(mach, ks, |factored| factored.influence())?;
    let mut result = Vec::with_capacity(ks.len());
    for ((record, matrix), inverse) in main.records.iter().zip(&matrices).zip(&inverses) {
        let wash = references.motion.downwash(record.k / aerodynamics.semichord());
        let downwash = wash.column(references.main).to_vec();
        let column = |v: &[c64]| ComplexMatrix::from_fn(n, 1, |i, _| v[i]);
        let linear = inverse.times(&column(&downwash)).into_data();
        let needed = matrix.times(&column(&record.dcp)).into_data();
        let difference: Vec<c64> = record.dcp.iter().zip(&linear).map(|(a, b)| a - b).collect();
        result.push(AtRecording {
            k: record.k,
            weight: Diagonal::new(&needed, &downwash, 1.0, area, limits),
            pressure: Diagonal::new(&record.dcp, &linear, 1.0, area, limits),
            force: force::match_strips(lattice, &record.dcp, &linear, limits),
            gain: Diagonal::new(&difference, &downwash, 0.0, area, limits),
            recorded: record.dcp.clone(),
            linear,
            downwash,
            condition: norm_1(matrix) * norm_1(inverse),
        });
    }
    Ok(result)
}

fn norm_1(matrix: &ComplexMatrix) -> f64 {
    (0..matrix.columns()).fold(0.0_f64, |m, j| m.max(matrix.column(j).iter().map(|z| z.norm()).sum()))
}

/// What every recorded motion's pressures have beyond the linear lattice.
pub(super) fn deviations<'a>(
    aerodynamics: &Aerodynamics,
    mach: f64,
    references: &'a References,
    blend: f64,
) -> Result<Vec<Moved<'a>>, CorrectError> {
    let mut all = Vec::new();
    for coordinate in 0..references.motion.n_modes {
        let Some(series) = series(references, coordinate, blend) else {
            continue;
        };
        let linear = aerodynamics.pressures(mach, series.schedule.recorded(), &references.motion)?;
        let away = series.records.iter().zip(&linear).map(|(record, linear)| {
            record
                .dcp
                .iter()
                .zip(linear.column(coordinate))
                .map(|(a, b)| a - b)
                .collect()
        });
        let away = away.collect();
        all.push(Moved {
            coordinate,
            series,
            away,
        });
    }
    Ok(all)
}
