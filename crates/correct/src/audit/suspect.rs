//! The mistakes that a hand-over can hold, each with what it does to the pressures, and which of them fits.
//!
//! A mistake in units, sign, phase or time leaves a mark that no flow makes: the same complex factor on every box, or
//! pressures that belong to another frequency. The recorded pressures are compared with the linear lattice as they are and
//! under each hypothesis; one that explains them far better than none does is named.

use dip_dlm::c64;
use serde::Serialize;

/// A mistake.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Suspect {
    /// The motion was taken or recorded in degrees where radians belong.
    DegreesForRadians,
    /// Upper and lower side of the wall are exchanged.
    SidesSwapped,
    /// A sine was taken for a cosine.
    SineForCosine,
    /// Pressures and motion are a step apart.
    StepShift,
    /// Half or twice the reference length in the reduced frequency or in the time scale.
    HalfReferenceLength,
    /// The reduced frequency k was given where omega in rad/s belongs.
    ReducedForCircular,
    /// The first cycle, with its transient, is in the window.
    FirstCycle,
}

impl Suspect {
    /// The likely cause in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::DegreesForRadians => "degrees taken for radians: amplitudes differ by 180/pi",
            Self::SidesSwapped => "upper and lower side swapped: the pressures have the opposite sign",
            Self::SineForCosine => {
                "sine taken for cosine: a quarter of a cycle between motion and pressures everywhere"
            }
            Self::StepShift => "time shifted by one step: motion and pressures of different instants",
            Self::HalfReferenceLength => {
                "half instead of full reference length (or full instead of half): factor 2 in frequency"
            }
            Self::ReducedForCircular => "reduced frequency k given instead of omega in rad/s",
            Self::FirstCycle => "first cycle not discarded: the transient of the start is in the window",
        }
    }
}

/// Linear pressures of the same motion at another frequency, and what it would mean if they fitted.
pub struct Alternative {
    /// What it would mean.
    pub suspect: Suspect,
    /// dCp `[box]`.
    pub linear: Vec<c64>,
}

/// Gross mistakes are named where they explain the pressures to this part of what no mistake leaves...
const GROSS: (f64, f64) = (0.4, 0.6);
/// ... and subtle ones, which differences between flow models could imitate, where they leave (part, at most).
const SUBTLE: (f64, f64) = (0.25, 0.1);
/// Pressures as close as this to the linear ones need no explanation.
const CLOSE: f64 = 0.02;

/// The hypothesis that explains `recorded` dCp, if one does much better than none. `linear` are the lattice's pressures of the
/// same motion at the same k; `step_rad` is omega times the time step; all lists `[box]`, `area` in any unit.
#[must_use]
pub fn find(
    recorded: &[c64],
    linear: &[c64],
    alternatives: &[Alternative],
    step_rad: f64,
    area: &[f64],
) -> Option<(Suspect, f64, f64)> {
    // Difference over the size of the hypothesis, so that too small pressures do not look close to anything.
    let misfit = |against: &[c64], factor: c64| {
        let (mut away, mut size) = (0.0, 0.0);
        for ((r, l), a) in recorded.iter().zip(against).zip(area) {
            let h = l * factor;
            away += (r - h).norm_sqr() * a;
            size += h.norm_sqr() * a;
        }
        (away / size.max(f64::MIN_POSITIVE)).sqrt()
    };
    let none = misfit(linear, c64::new(1.0, 0.0));
    if none <= CLOSE {
        return None;
    }
    let degrees = 180.0 / std::f64::consts::PI;
    let quarter = std::f64::consts::FRAC_PI_2;
    let mut tried: Vec<(Suspect, f64, bool)> = Vec::new();
    for (suspect, factor) in [
        (Suspect::DegreesForRadians, c64::new(degrees, 0.0)),
        (Suspect::DegreesForRadians, c64::new(1.0 / degrees, 0.0)),
        (Suspect::SidesSwapped, c64::new(-1.0, 0.0)),
        (Suspect::SineForCosine, c64::from_polar(1.0, quarter)),
        (Suspect::SineForCosine, c64::from_polar(1.0, -quarter)),
    ] {
        tried.push((suspect, misfit(linear, factor), true));
    }
    if step_rad > 0.0 {
        for sign in [1.0, -1.0] {
            tried.push((
                Suspect::StepShift,
                misfit(linear, c64::from_polar(1.0, sign * step_rad)),
                false,
            ));
        }
    }
    for alternative in alternatives {
        tried.push((
            alternative.suspect,
            misfit(&alternative.linear, c64::new(1.0, 0.0)),
            false,
        ));
    }
    // Misfit relative to too small a hypothesis is large, relative to too large a one about 1: compare on the smaller of both.
    let size = |list: &[c64]| list.iter().zip(area).map(|(z, a)| z.norm_sqr() * a).sum::<f64>().sqrt();
    let own = size(recorded).max(f64::MIN_POSITIVE);
    let none = none.max(none * size(linear) / own);
    let best = tried.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (part, most) = if best.2 { GROSS } else { SUBTLE };
    (best.1 <= part * none && best.1 <= most).then_some((best.0, none, best.1))
}
