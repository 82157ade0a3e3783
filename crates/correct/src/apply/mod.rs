//! Corrected pressures and generalized forces by every method, from the same reference pressures.

mod evaluate;
mod weights;

use crate::CorrectError;
use crate::weight::schedule::{Place, Schedule};
use crate::weight::{Diagonal, Limits};
use dip_dlm::aic::Aerodynamics;
use dip_dlm::motion::BoxMotion;
use dip_dlm::{ComplexMatrix, c64};
use serde::{Deserialize, Serialize};
use weights::{Moved, Weights, at_recordings, deviations, series};

/// A way to correct the lattice. `w` is the downwash of any motion, AIC that of the lattice, subscript r the reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// AIC W w, W = (AIC^-1 p_r) / w_r per k: the default.
    Downwash,
    /// The same with W from the steady slopes at every k.
    DownwashSteady,
    /// R AIC w, R = p_r / (AIC w_r) per k.
    PressureRatio,
    /// (1 + eps) AIC w, eps the least change that gives every strip its lift and moment, per k.
    Force,
    /// The same with eps from the steady slopes.
    ForceSteady,
    /// AIC w + G w, G = (p_r - AIC w_r) / w_r per k.
    Additive,
    /// AIC w with the pressures of all recorded motions replaced: AIC w + (P_r - AIC W_r) W_r^+ w.
    Mode,
    /// Pressures of every mode from its own recordings; the lattice has no say where there are recordings.
    Full,
    /// Unsteady pressures from steady ones by Garner's and Dau's semi-empirical ratio.
    DauGarner,
}

impl Method {
    /// All of them, in the order of tables.
    pub const ALL: [Self; 9] = [
        Self::Downwash,
        Self::DownwashSteady,
        Self::PressureRatio,
        Self::Force,
        Self::ForceSteady,
        Self::Additive,
        Self::Mode,
        Self::Full,
        Self::DauGarner,
    ];

    /// Name in case files, tables and summaries.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Downwash => "downwash",
            Self::DownwashSteady => "downwash-steady",
            Self::PressureRatio => "pressure-ratio",
            Self::Force => "force",
            Self::ForceSteady => "force-steady",
            Self::Additive => "additive",
            Self::Mode => "mode",
            Self::Full => "full",
            Self::DauGarner => "dau-garner",
        }
    }

    /// Whether its weights come from the steady slopes alone.
    #[must_use]
    pub fn is_steady(self) -> bool {
        matches!(self, Self::DownwashSteady | Self::ForceSteady | Self::DauGarner)
    }
}

/// Lifting pressures of one reference motion at one reduced frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedPressures {
    /// Which reference motion, a column of [`References::motion`].
    pub coordinate: usize,
    /// k = omega b / U; 0 for steady slopes.
    pub k: f64,
    /// dCp `[box]` per unit of the motion, Re(A e^{i omega t}) in phase with it.
    pub dcp: Vec<c64>,
}

/// All that was recorded at one Mach number.
#[derive(Clone, Debug, PartialEq)]
pub struct References {
    /// The reference motions on the boxes, one column each.
    pub motion: BoxMotion,
    /// The structural mode (from 0) that a reference motion is, where it is one.
    pub mode_of: Vec<Option<usize>>,
    /// Which of them the weights on single boxes and strips go by: the pitch, as a rule.
    pub main: usize,
    /// Pressures, in any order.
    pub pressures: Vec<RecordedPressures>,
}

/// Settings of the correction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// When a plain ratio is not taken.
    pub limits: Limits,
    /// Multiple of the last recorded k from which on the lattice is linear.
    pub blend: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            limits: Limits::default(),
            blend: 2.0,
        }
    }
}

/// What the linear lattice says about the main reference motion where it was recorded, and the weights found there.
#[derive(Clone, Debug)]
pub struct AtRecording {
    /// Reduced frequency.
    pub k: f64,
    /// Recorded dCp `[box]`.
    pub recorded: Vec<c64>,
    /// Linear dCp `[box]`.
    pub linear: Vec<c64>,
    /// Downwash `[box]` of the reference motion.
    pub downwash: Vec<c64>,
    /// Weights W_T on the downwash.
    pub weight: Diagonal,
    /// Weights on the pressures.
    pub pressure: Diagonal,
    /// Weights on the pressures by strips.
    pub force: Diagonal,
    /// Gains from downwash to additional pressure.
    pub gain: Diagonal,
    /// Condition number of the downwash matrix in the 1-norm.
    pub condition: f64,
}

/// How well a method gives back what it was made from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Reproduction {
    /// Reduced frequency.
    pub k: f64,
    /// Norm of the difference over the norm of the recorded pressures (strip loads for `force`).
    pub error: f64,
}

/// Corrected generalized forces by one method.
#[derive(Clone, Debug)]
pub struct Corrected {
    /// The method.
    pub method: Method,
    /// Q `[k]`, each `[row = force mode][column = displacement mode]`.
    pub q: Vec<ComplexMatrix>,
    /// What each k rests on.
    pub place: Vec<Place>,
    /// The reference motion's recorded pressures given back, at every k that was recorded and that the method goes by.
    pub reproduction: Vec<Reproduction>,
    /// The k that steady weights were taken from: 0, or the lowest recorded one where no steady slope is.
    pub steady_from_k: Option<f64>,
}

/// What [`correct`] gives.
#[derive(Clone, Debug)]
pub struct Correction {
    /// Reduced frequencies, rising: those asked, the recorded ones, and some in the blending.
    pub k: Vec<f64>,
    /// Uncorrected Q `[k]`.
    pub linear: Vec<ComplexMatrix>,
    /// By method, in the order asked.
    pub methods: Vec<Corrected>,
    /// At every recorded k of the main reference motion, rising.
    pub recordings: Vec<AtRecording>,
    /// Recorded k and the rule beyond.
    pub schedule: Schedule,
}

impl References {
    fn check(&self, n: usize) -> Result<(), CorrectError> {
        if self.motion.n_boxes != n {
            return Err(CorrectError::Size {
                what: "boxes of the reference motions",
                needed: n,
                got: self.motion.n_boxes,
            });
        }
        if self.mode_of.len() != self.motion.n_modes {
            return Err(CorrectError::Size {
                what: "list of the modes behind the reference motions",
                needed: self.motion.n_modes,
                got: self.mode_of.len(),
            });
        }
        for (i, p) in self.pressures.iter().enumerate() {
            if p.dcp.len() != n {
                return Err(CorrectError::Size {
                    what: "recorded pressures",
                    needed: n,
                    got: p.dcp.len(),
                });
            }
            if p.dcp.iter().any(|z| !(z.re.is_finite() && z.im.is_finite())) || !(p.k.is_finite() && p.k >= 0.0) {
                return Err(CorrectError::NotFinite { k: p.k });
            }
            if p.coordinate >= self.motion.n_modes {
                return Err(CorrectError::NoReference {
                    coordinate: p.coordinate,
                });
            }
            let again = |o: &&RecordedPressures| o.coordinate == p.coordinate && (o.k - p.k).abs() <= 1e-9 * p.k;
            if self.pressures[..i].iter().any(|o| again(&o)) {
                return Err(CorrectError::Twice {
                    coordinate: p.coordinate,
                    k: p.k,
                });
            }
        }
        Ok(())
    }
}

/// Corrects the lattice at one Mach number. `modes` are the structure's modes on the boxes, `k` the reduced frequencies asked.
///
/// # Errors
/// References of another lattice, no recordings of the main motion, conditions that the lattice refuses, a method that
/// needs recordings that are not there.
pub fn correct(
    aerodynamics: &Aerodynamics,
    modes: &BoxMotion,
    mach: f64,
    k: &[f64],
    references: &References,
    methods: &[Method],
    settings: Settings,
) -> Result<Correction, CorrectError> {
    let n = aerodynamics.lattice().n_boxes();
    references.check(n)?;
    check_settings(settings)?;
    let Some(main) = series(references, references.main, settings.blend) else {
        return Err(CorrectError::NoReference {
            coordinate: references.main,
        });
    };
    let schedule = main.schedule.clone();
    let area: Vec<f64> = aerodynamics.lattice().boxes().iter().map(|b| b.area).collect();
    let recordings = at_recordings(aerodynamics, mach, references, &main, &area, settings.limits)?;
    let all = deviations(aerodynamics, mach, references, settings.blend)?;
    let steady = 0;
    let first = &recordings[steady];
    let weights = Weights {
        steady_pressure: first.pressure.real(),
        steady_weight: first.weight.real(),
        steady_force: first.force.real(),
        aerodynamics,
        references,
        area,
        main,
        recordings,
        steady,
        all,
    };
    for method in methods {
        weights.check(*method, modes)?;
    }
    let k = reduced_frequencies(k, &schedule, &weights.all);
    let mut motion = modes.clone();
    motion.append(&references.motion);
    let at_k = aerodynamics.for_each_k(mach, &k, |factored| {
        weights.evaluate(&factored, modes, &motion, methods)
    })?;
    let mut linear = Vec::with_capacity(k.len());
    let mut corrected: Vec<Corrected> = methods
        .iter()
        .map(|method| Corrected {
            method: *method,
            q: Vec::with_capacity(k.len()),
            place: k.iter().map(|k| weights.place(*method, *k)).collect(),
            reproduction: Vec::new(),
            steady_from_k: method.is_steady().then(|| schedule.recorded()[steady]),
        })
        .collect();
    for (result, &k) in at_k.into_iter().zip(&k) {
        linear.push(result.linear);
        for ((q, error), corrected) in result.methods.into_iter().zip(&mut corrected) {
            corrected.q.push(q);
            corrected
                .reproduction
                .extend(error.map(|error| Reproduction { k, error }));
        }
    }
    for corrected in &mut corrected {
        if corrected.method == Method::Full {
            weights.full(modes, &k, &linear, corrected)?;
        }
    }
    Ok(Correction {
        k,
        linear,
        methods: corrected,
        recordings: weights.recordings,
        schedule,
    })
}

fn check_settings(settings: Settings) -> Result<(), CorrectError> {
    for (name, value, good, needed) in [
        (
            "blend",
            settings.blend,
            settings.blend > 1.0,
            "above 1 is needed: a multiple of the last recorded k",
        ),
        (
            "bound",
            settings.limits.bound,
            settings.limits.bound > 0.0,
            "above 0 is needed: the largest |weight - 1|",
        ),
        (
            "least",
            settings.limits.least,
            (0.0..1.0).contains(&settings.limits.least),
            "0 or more and below 1 is needed: a part of the root mean square",
        ),
    ] {
        if !(good && value.is_finite()) {
            return Err(CorrectError::Setting { name, value, needed });
        }
    }
    Ok(())
}

/// Those asked, those recorded, and five in each blending, rising without repeats.
fn reduced_frequencies(asked: &[f64], schedule: &Schedule, all: &[Moved<'_>]) -> Vec<f64> {
    let mut recorded = Vec::new();
    let mut k: Vec<f64> = asked.to_vec();
    for schedule in std::iter::once(schedule).chain(all.iter().map(|m| &m.series.schedule)) {
        recorded.extend_from_slice(schedule.recorded());
        let last = schedule.recorded().last().copied().unwrap_or(0.0);
        k.extend((1..=5).map(|i| last + (schedule.end() - last) * f64::from(i) / 5.0));
    }
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs();
    // Recorded ones stand as they are: others next to them go.
    k.retain(|k| !recorded.iter().any(|r| near(*k, *r)));
    k.append(&mut recorded);
    k.sort_by(f64::total_cmp);
    k.dedup_by(|a, b| near(*a, *b));
    k
}
