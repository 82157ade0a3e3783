//! From readings to reference pressures on the boxes, and whether the two belong together at all.

mod belongs;
mod coordinate;

pub use belongs::{check_axis, check_match};

use crate::SampleError;
use crate::apply::{RecordedPressures, References};
use crate::reading::{Reading, Source};
use crate::sample::{BoxMap, Rule, Wall, shape};
use coordinate::{CoordinateKey, push_motion};
use dip_dlm::aic::Aerodynamics;
use dip_dlm::c64;
use dip_dlm::gaf::PointRule;
use dip_dlm::motion::BoxMotion;
use dip_record::Recording;

/// One reading on the boxes.
#[derive(Clone, Debug)]
pub struct Mapped {
    /// The reading.
    pub reading: Reading,
    /// Its motion: a column of [`References::motion`].
    pub coordinate: usize,
    /// dCp `[box]` per unit of the motion.
    pub dcp: Vec<c64>,
    /// Higher harmonics of dCp `[harmonic - 2][box]`.
    pub higher: Vec<Vec<c64>>,
    /// Mean dCp `[box]`.
    pub mean: Vec<f64>,
    /// Largest difference of lift of a strip before and after mapping, over the largest lift of a strip.
    pub lift_error: f64,
    /// The same for the moment, over the largest lift times the semichord.
    pub moment_error: f64,
    /// Part of the projected wall that lies outside of the boxes.
    pub overhang: f64,
    /// Difference of the mean lifts of both half wings over their size, of a recording of the whole wing.
    pub asymmetry: Option<f64>,
    /// True where it is left out of the references because another reading stands for the same motion and frequency (a smaller
    /// amplitude, for the check of linearity).
    pub repeated: bool,
}

/// What recordings of one Mach number give on the boxes.
#[derive(Clone, Debug)]
pub struct Assembled {
    /// Motions and pressures that corrections go by.
    pub references: References,
    /// The readings.
    pub mapped: Vec<Mapped>,
    /// What to know, in words.
    pub notes: Vec<String>,
}

/// Reference motions and pressures of all readings (with the recordings that they are from) at one Mach number. `modes` are
/// the structure's modes on the boxes. A recording of a mode that has the shape of the case's mode of the same number stands
/// for it; any other shape is a reference motion of its own, taken from the recorded displacements of the wall.
///
/// # Errors
/// A wall that does not cover the boxes, a mode without shape that the case does not have.
pub fn assemble(
    aerodynamics: &Aerodynamics,
    point_rule: PointRule,
    modes: &BoxMotion,
    recordings: &[(&Recording, Vec<Reading>)],
    rule: Rule,
) -> Result<Assembled, BridgeError> {
    let lattice = aerodynamics.lattice();
    let n = lattice.n_boxes();
    let mut references = References {
        motion: BoxMotion::empty(n),
        mode_of: Vec::new(),
        main: 0,
        pressures: Vec::new(),
    };
    let mut kinds: Vec<CoordinateKey> = Vec::new();
    let mut mapped: Vec<Mapped> = Vec::new();
    let mut notes: Vec<String> = Vec::new();
    for (recording, readings) in recordings {
        let half = recording.setup.references.half_model;
        let map = BoxMap::new(&Wall::recorded(&recording.setup.surface, half), lattice, rule)?;
        for reading in readings {
            let shape = recording
                .setup
                .motion
                .iter()
                .find(|c| c.name == reading.name)
                .and_then(|c| shape::box_motion(&recording.setup.surface, &c.shape_m, half, lattice, point_rule));
            let key = CoordinateKey::of(reading, shape, modes)?;
            let coordinate = match kinds.iter().position(|k| k.same(&key)) {
                Some(at) => at,
                None => {
                    notes.extend(key.note(reading, modes));
                    push_motion(&mut references, lattice, point_rule, modes, &key, &reading.label)?;
                    kinds.push(key);
                    kinds.len() - 1
                }
            };
            mapped.push(map_reading(aerodynamics, &map, recording, reading, coordinate));
        }
    }
    // The largest amplitude stands for its motion and frequency; harmonic recordings before pulses.
    let better = |a: &Mapped, b: &Mapped| {
        let rank = |m: &Mapped| u8::from(m.reading.source != Source::Pulse);
        (rank(a), a.reading.amplitude) >= (rank(b), b.reading.amplitude)
    };
    for i in 0..mapped.len() {
        for j in 0..i {
            let same = mapped[i].coordinate == mapped[j].coordinate
                && (mapped[i].reading.k - mapped[j].reading.k).abs() <= 1e-3 * mapped[i].reading.k;
            if same && !mapped[j].repeated && !mapped[i].repeated {
                let worse = if better(&mapped[j], &mapped[i]) { i } else { j };
                mapped[worse].repeated = true;
            }
        }
    }
    for m in mapped.iter().filter(|m| !m.repeated) {
        references.pressures.push(RecordedPressures {
            coordinate: m.coordinate,
            k: m.reading.k,
            dcp: m.dcp.clone(),
        });
    }
    references.main = kinds
        .iter()
        .position(|k| matches!(k, CoordinateKey::Pitch { .. }))
        .unwrap_or(0);
    Ok(Assembled {
        references,
        mapped,
        notes,
    })
}

/// Why readings can't be put on the boxes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BridgeError {
    /// The wall.
    #[error(transparent)]
    Sample(#[from] SampleError),
    /// A motion that the lattice does not know.
    #[error("{label}: {what}")]
    Motion {
        /// Which recording.
        label: String,
        /// What is wrong and what to do.
        what: String,
    },
}

fn map_reading(
    aerodynamics: &Aerodynamics,
    map: &BoxMap,
    recording: &Recording,
    reading: &Reading,
    coordinate: usize,
) -> Mapped {
    let lattice = aerodynamics.lattice();
    let dcp = map.to_boxes(&reading.cp);
    let faces = map.strip_loads_of_faces(&reading.cp);
    let boxes = crate::sample::strip_loads_of_boxes(lattice, &dcp);
    let largest = |list: &[c64]| list.iter().fold(0.0_f64, |m, z| m.max(z.norm()));
    let away = |a: &[c64], b: &[c64]| a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).norm()));
    let lift = largest(&faces.lift_m2).max(f64::MIN_POSITIVE);
    let mean: Vec<c64> = reading.mean.iter().map(|p| c64::new(*p, 0.0)).collect();
    Mapped {
        coordinate,
        higher: reading.higher.iter().map(|h| map.to_boxes(h)).collect(),
        mean: map.to_boxes(&mean).iter().map(|z| z.re).collect(),
        lift_error: away(&faces.lift_m2, &boxes.lift_m2) / lift,
        moment_error: away(&faces.moment_m3, &boxes.moment_m3) / (lift * aerodynamics.semichord()),
        overhang: map.overhang(),
        asymmetry: asymmetry(recording, &reading.cp),
        dcp,
        reading: reading.clone(),
        repeated: false,
    }
}

/// |lift of y > 0 minus lift of y < 0| over the sum of their sizes; none for half a model.
fn asymmetry(recording: &Recording, cp: &[c64]) -> Option<f64> {
    if recording.setup.references.half_model {
        return None;
    }
    let mut lift = [c64::new(0.0, 0.0); 2];
    let faces = recording
        .setup
        .surface
        .patches
        .iter()
        .flat_map(|p| p.centroids_m.iter().zip(&p.areas_m2));
    for ((centroid, area), cp) in faces.zip(cp) {
        lift[usize::from(centroid[1] > 0.0)] -= cp * area[2];
    }
    let size = lift[0].norm() + lift[1].norm();
    (lift[0].norm() > 0.0 && lift[1].norm() > 0.0).then(|| (lift[0] - lift[1]).norm() / size)
}
