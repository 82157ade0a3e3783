//! What can go wrong, one type for each subject.

use std::ops::Range;

/// Harmonic analysis.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HarmonicError {
    /// A frequency that can't be used.
    #[error("circular frequency {omega_rad_s} rad/s: a finite, positive one is needed")]
    Frequency {
        /// The frequency.
        omega_rad_s: f64,
    },
    /// Too few instants for the unknowns.
    #[error("{got} instants: {needed} are needed; record more steps or ask for fewer harmonics")]
    TooFew {
        /// Needed.
        needed: usize,
        /// Got.
        got: usize,
    },
    /// Instants do not rise.
    #[error("instants must rise: step {step} is at {got_s} s, the one before it at {before_s} s")]
    Times {
        /// The step.
        step: usize,
        /// Instant of the step before.
        before_s: f64,
        /// Its own instant.
        got_s: f64,
    },
    /// Not one whole cycle.
    #[error("the record of {recorded_s} s holds no whole cycle of {period_s} s: record more, or correct the frequency")]
    NoWholeCycle {
        /// Length of a cycle.
        period_s: f64,
        /// Length of the record.
        recorded_s: f64,
    },
    /// Rows and instants do not match.
    #[error("{rows} rows of values for {instants} instants, window {window:?}: one row for each instant is needed")]
    Shape {
        /// Instants.
        instants: usize,
        /// Rows.
        rows: usize,
        /// Window asked for.
        window: Range<usize>,
    },
    /// Rows of different length.
    #[error("step {step} has {got} channels: {needed} are needed, as in the first step of the window")]
    Channels {
        /// The step.
        step: usize,
        /// Needed.
        needed: usize,
        /// Got.
        got: usize,
    },
    /// A value that is no number.
    #[error("step {step}, channel {channel}: the value is not finite; look at the recording with `dip doctor`")]
    NotFinite {
        /// The step.
        step: usize,
        /// The channel.
        channel: usize,
    },
    /// Functions that can't be told apart.
    #[error(
        "frequencies {omega_rad_s:?} rad/s with {harmonics} harmonics can't be told apart in a window of {window_s} s with {instants} instants: use a longer window, more steps a cycle, or fewer harmonics"
    )]
    Indistinct {
        /// Frequencies.
        omega_rad_s: Vec<f64>,
        /// Harmonics of each.
        harmonics: usize,
        /// Length of the window.
        window_s: f64,
        /// Instants in it.
        instants: usize,
    },
    /// The motion does not move.
    #[error("the motion has amplitude {amplitude}: pressures per unit of it do not exist")]
    NoMotion {
        /// Amplitude found.
        amplitude: f64,
    },
    /// A harmonic that was not fitted.
    #[error("harmonic {harmonic} of frequency {frequency} was not fitted")]
    NotFitted {
        /// Place of the frequency.
        frequency: usize,
        /// Number of the harmonic.
        harmonic: usize,
    },
}

/// From faces to boxes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SampleError {
    /// No faces.
    #[error("the recording has no wall faces: record dip.SurfaceGrid")]
    NoFaces,
    /// A coordinate that is no number.
    #[error("wall face {face} has a corner that is not finite")]
    NotFinite {
        /// The face.
        face: usize,
    },
    /// A box without pressures.
    #[error(
        "box {index} at ({:.4}, {:.4}, {:.4}) m is covered to {:.1} % only by faces of the {side} side: is the recording of this wing, in metres, and of both of its sides?",
        at_m[0], at_m[1], at_m[2], 100.0 * part
    )]
    Uncovered {
        /// The box.
        index: usize,
        /// Which side.
        side: &'static str,
        /// Covered part of its area.
        part: f64,
        /// Where it is.
        at_m: [f64; 3],
    },
    /// Fraction of point sampling.
    #[error("point sampling at {fraction} of the box chord: a fraction from 0 to 1 is needed")]
    Fraction {
        /// The fraction.
        fraction: f64,
    },
}

/// Weights and corrected forces.
#[derive(Debug, thiserror::Error)]
pub enum CorrectError {
    /// The lattice refuses.
    #[error(transparent)]
    Aerodynamics(#[from] dip_dlm::aic::AicError),
    /// A table of forces can't be interpolated.
    #[error(transparent)]
    Table(#[from] dip_dlm::gaf::TableError),
    /// No reference pressures.
    #[error("no recorded pressures of coordinate {coordinate}: give a harmonic recording of it")]
    NoReference {
        /// The coordinate, from 0.
        coordinate: usize,
    },
    /// A list of another size than the lattice.
    #[error("{what}: {needed} values are needed, one for each box, got {got}")]
    Size {
        /// What.
        what: &'static str,
        /// Needed.
        needed: usize,
        /// Got.
        got: usize,
    },
    /// Pressures that are no numbers.
    #[error("recorded pressures at k = {k} hold a value that is not finite")]
    NotFinite {
        /// The reduced frequency.
        k: f64,
    },
    /// Two recordings for the same place.
    #[error("coordinate {coordinate} was recorded twice at k = {k}: give one of the recordings only")]
    Twice {
        /// The coordinate, from 0.
        coordinate: usize,
        /// The reduced frequency.
        k: f64,
    },
    /// Reference pressures that say nothing about a method.
    #[error("method {method}: {reason}")]
    Method {
        /// Name of the method.
        method: &'static str,
        /// What is missing and what to do.
        reason: String,
    },
    /// A setting out of its range.
    #[error("setting {name} = {value}: {needed}")]
    Setting {
        /// Its name.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What is needed.
        needed: &'static str,
    },
}

/// Reading a recording.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReadingError {
    /// Something does not fit.
    #[error("{label}: {what}")]
    Content {
        /// Which recording.
        label: String,
        /// What is wrong and what was needed.
        what: String,
    },
    /// The harmonic analysis refuses.
    #[error("{label}: {source}")]
    Harmonic {
        /// Which recording.
        label: String,
        /// Why.
        source: HarmonicError,
    },
}

/// A recording and a lattice that do not belong together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{label}: {what} of the recording is {recorded}, of the lattice {lattice}{hint}")]
pub struct MismatchError {
    /// Which recording.
    pub label: String,
    /// Which quantity, with its unit.
    pub what: String,
    /// Value in the recording.
    pub recorded: String,
    /// Value in the case of the lattice.
    pub lattice: String,
    /// Likely cause, beginning with a colon; may be empty.
    pub hint: String,
}
