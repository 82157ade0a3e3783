//! What a recording says: complex pressures of every face per unit of every motion, with how well they are known.

mod history;

use crate::ReadingError;
use dip_dlm::c64;
use dip_record::{CoordinateKind, Law, Recording, References, StructuralMode};

/// How recordings are read.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadingSettings {
    /// Harmonics fitted where one frequency moves; the fundamental alone where several do.
    pub harmonics: usize,
    /// Whole cycles used, counted from the end; 0 uses every whole cycle, the first one too.
    pub cycles: usize,
    /// Reduced frequencies at which pulses are transformed.
    pub pulse_k: Vec<f64>,
}

impl Default for ReadingSettings {
    fn default() -> Self {
        Self {
            harmonics: 3,
            cycles: 1,
            pulse_k: Vec::new(),
        }
    }
}

/// How pressures were found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// First harmonic of a harmonic motion.
    Harmonic,
    /// Ratio of transforms of a pulse.
    Pulse,
    /// Change from before to after a ramp: steady slopes.
    Ramp,
}

/// Pressures of one recording per unit of one motion coordinate at one frequency.
#[derive(Clone, Debug)]
pub struct Reading {
    /// Name of the recording, for messages.
    pub label: String,
    /// How they were found.
    pub source: Source,
    /// Reference quantities of the recording.
    pub references: References,
    /// Name of the coordinate.
    pub name: String,
    /// What it does.
    pub kind: CoordinateKind,
    /// The structural mode behind it.
    pub mode: Option<StructuralMode>,
    /// Circular frequency, rad/s; 0 for steady slopes.
    pub omega_rad_s: f64,
    /// k = omega b / U with the recording's own b and U.
    pub k: f64,
    /// Amplitude of the motion, in the unit of the coordinate.
    pub amplitude: f64,
    /// Cp per unit of the motion `[face]`, all patches in order; in phase with the motion.
    pub cp: Vec<c64>,
    /// Second and higher harmonics `[harmonic - 2][face]` per unit of the motion.
    pub higher: Vec<Vec<c64>>,
    /// Mean Cp `[face]`.
    pub mean: Vec<f64>,
    /// How well they are known.
    pub quality: Quality,
    /// The recorded motion against the law that it was asked to follow; none for pulses and ramps.
    pub motion: Option<MotionCheck>,
}

/// How well a reading is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// Whole cycles in the recording.
    pub cycles: usize,
    /// Whole cycles used.
    pub cycles_used: usize,
    /// Change of the fundamental from the last cycle but one to the last, relative; none with one cycle or a pulse.
    pub cycle_change: Option<f64>,
    /// Largest change of any cycle inside of the window against the last one, relative.
    pub window_change: Option<f64>,
    /// Root mean square of what the fit leaves over that of the fundamental; for pulses the standard error over the ratio.
    pub residual: f64,
    /// Root mean square of each higher harmonic over that of the fundamental.
    pub higher: Vec<f64>,
    /// Steps of the window that did not reach the orders asked for.
    pub unconverged: usize,
    /// Time between two steps, s.
    pub time_step_s: f64,
    /// For pulses: whether the frequency is excited and resolved.
    pub trusted: bool,
}

/// The motion that the steps hold against the law that the setup declares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionCheck {
    /// Declared circular frequency, rad/s.
    pub declared_omega_rad_s: f64,
    /// That of the steps, rad/s.
    pub sampled_omega_rad_s: f64,
    /// Declared complex amplitude A of Re(A e^{i omega t}), t from the law's phase origin.
    pub declared: c64,
    /// That of the steps.
    pub sampled: c64,
    /// Difference over the declared amplitude.
    pub error: f64,
}

/// Complex amplitude A of Re(A e^{i omega t}) of the sine a sin(omega t + phase): A = -i a e^{i phase}. The one place where
/// the recording's sine becomes the analysis' convention.
#[must_use]
pub fn amplitude_of_sine(amplitude: f64, phase_rad: f64) -> c64 {
    c64::from_polar(amplitude, phase_rad) * c64::new(0.0, -1.0)
}

/// Reads every coordinate that moves.
///
/// # Errors
/// No motion, motions that can't be told apart, too short a record, numbers that are not finite.
pub fn read(recording: &Recording, label: &str, settings: &ReadingSettings) -> Result<Vec<Reading>, ReadingError> {
    let wrong = |what: String| ReadingError::Content {
        label: label.to_owned(),
        what,
    };
    let harmonic = |source| ReadingError::Harmonic {
        label: label.to_owned(),
        source,
    };
    let setup = &recording.setup;
    if recording.steps.len() < 2 {
        return Err(wrong(format!("{} steps: a motion needs more", recording.steps.len())));
    }
    let refs = &setup.references;
    for (name, value) in [
        ("reference semichord, m", refs.reference_semichord_m),
        ("speed, m/s", refs.speed_m_s),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return Err(wrong(format!("{name}: {value}; a positive value is needed")));
        }
    }
    let time_s: Vec<f64> = recording.steps.iter().map(|s| s.time_s).collect();
    let count = setup.motion.len();
    if let Some(step) = recording.steps.iter().find(|s| s.motion.len() != count) {
        return Err(wrong(format!(
            "step {}: {} motion values for {count} coordinates",
            step.number,
            step.motion.len()
        )));
    }
    let pressures: Vec<Vec<f64>> = recording.steps.iter().map(|s| s.pressures.concat()).collect();
    let faces = setup.surface.face_count();
    if let Some(i) = pressures.iter().position(|row| row.len() != faces) {
        return Err(wrong(format!(
            "step {}: {} pressures for {faces} faces",
            recording.steps[i].number,
            pressures[i].len()
        )));
    }
    let motion_of = |c: usize| -> Vec<f64> { recording.steps.iter().map(|s| s.motion[c].value).collect() };
    let area: Vec<f64> = setup
        .surface
        .patches
        .iter()
        .flat_map(|p| &p.areas_m2)
        .map(|a| a.iter().map(|v| v * v).sum::<f64>().sqrt())
        .collect();
    let moves = |c: usize| {
        let u = motion_of(c);
        u.iter().any(|v| (v - u[0]).abs() > 0.0)
    };
    let moving: Vec<usize> = (0..count).filter(|c| moves(*c)).collect();
    if moving.is_empty() {
        return Err(wrong(
            "no coordinate moves: pressures per unit of a motion do not exist".into(),
        ));
    }
    let history = history::History {
        recording,
        label,
        time_s: &time_s,
        pressures: &pressures,
        area: &area,
        settings,
    };
    let mut readings = Vec::new();
    let mut harmonics: Vec<(usize, f64)> = Vec::new();
    for &c in &moving {
        let coordinate = &setup.motion[c];
        match &coordinate.law {
            Law::Harmonic { harmonics: list, .. } => {
                let Some(first) = list.first() else {
                    return Err(wrong(format!(
                        "coordinate {}: a harmonic law without harmonics",
                        coordinate.name
                    )));
                };
                harmonics.push((c, first.omega_rad_s));
                for other in &list[1..] {
                    let times = other.omega_rad_s / first.omega_rad_s;
                    if (times - times.round()).abs() > 1e-6 {
                        harmonics.push((c, other.omega_rad_s));
                    }
                }
            }
            Law::Pulse { .. } | Law::Ramp { .. } if moving.len() > 1 => {
                return Err(wrong(format!(
                    "coordinate {} has a pulse or ramp while another one moves: give each a recording of its own",
                    coordinate.name
                )));
            }
            Law::Pulse { .. } => readings.extend(history.pulse(c, &motion_of(c)).map_err(harmonic)?),
            Law::Ramp { .. } => readings.push(history.ramp(c, &motion_of(c)).map_err(harmonic)?),
            Law::Free => {
                return Err(wrong(format!(
                    "coordinate {} moves freely: corrections need a forced motion",
                    coordinate.name
                )));
            }
        }
    }
    for (i, (c, omega)) in harmonics.iter().enumerate() {
        if let Some((d, _)) = harmonics[..i].iter().find(|(_, o)| (o - omega).abs() <= 1e-6 * omega) {
            return Err(wrong(format!(
                "coordinates {} and {} move at the same frequency {omega} rad/s: their pressures can't be told apart",
                setup.motion[*d].name, setup.motion[*c].name
            )));
        }
    }
    if !harmonics.is_empty() {
        readings.extend(history.harmonic(&harmonics, motion_of).map_err(harmonic)?);
    }
    Ok(readings)
}
