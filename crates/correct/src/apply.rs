//! Corrected pressures and generalized forces by every method, from the same reference pressures.

use crate::CorrectError;
use crate::weight::schedule::{Place, Schedule};
use crate::weight::{Diagonal, Limits, force, garner};
use dip_dlm::aic::{Aerodynamics, AicError, FactoredDownwash};
use dip_dlm::gaf::{Interpolation, KInterpolant, generalized_force};
use dip_dlm::motion::BoxMotion;
use dip_dlm::{ComplexMatrix, c64};
use serde::{Deserialize, Serialize};

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

/// Recordings of one reference motion in rising k.
struct Series<'a> {
    schedule: Schedule,
    records: Vec<&'a RecordedPressures>,
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

    fn series(&self, coordinate: usize, blend: f64) -> Option<Series<'_>> {
        let mut records: Vec<&RecordedPressures> =
            self.pressures.iter().filter(|p| p.coordinate == coordinate).collect();
        records.sort_by(|a, b| a.k.total_cmp(&b.k));
        // Steady slopes alone say nothing about any k > 0 but through the steady methods.
        (!records.is_empty()).then(|| Series {
            schedule: Schedule::new(records.iter().map(|r| r.k).collect(), blend),
            records,
        })
    }
}

/// One recorded motion with what its pressures have beyond the linear lattice.
struct Moved<'a> {
    coordinate: usize,
    series: Series<'a>,
    /// P_r - AIC w_r `[record][box]`.
    away: Vec<Vec<c64>>,
}

/// Everything a method needs at any k.
struct Weights<'a> {
    aerodynamics: &'a Aerodynamics,
    references: &'a References,
    area: Vec<f64>,
    main: Series<'a>,
    recordings: Vec<AtRecording>,
    /// Recording that steady weights come from, real parts only unless it is at k = 0.
    steady: usize,
    /// Steady ratios of pressures.
    steady_pressure: Diagonal,
    steady_weight: Diagonal,
    steady_force: Diagonal,
    /// Every recorded motion.
    all: Vec<Moved<'a>>,
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
    let Some(main) = references.series(references.main, settings.blend) else {
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
    let mut k: Vec<f64> = asked.to_vec();
    for schedule in std::iter::once(schedule).chain(all.iter().map(|m| &m.series.schedule)) {
        k.extend_from_slice(schedule.recorded());
        let last = schedule.recorded().last().copied().unwrap_or(0.0);
        k.extend((1..=5).map(|i| last + (schedule.end() - last) * f64::from(i) / 5.0));
    }
    k.sort_by(f64::total_cmp);
    // Recorded ones stand as they are: an asked one next to them goes.
    k.dedup_by(|a, b| (*a - *b).abs() <= 1e-9 * b.abs());
    k
}

/// Weights at every recording of the main motion.
fn at_recordings(
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
fn deviations<'a>(
    aerodynamics: &Aerodynamics,
    mach: f64,
    references: &'a References,
    blend: f64,
) -> Result<Vec<Moved<'a>>, CorrectError> {
    let mut all = Vec::new();
    for coordinate in 0..references.motion.n_modes {
        let Some(series) = references.series(coordinate, blend) else {
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

/// Results of all methods at one k.
struct AtK {
    linear: ComplexMatrix,
    /// Q, and the error of the main reference motion where it was recorded.
    methods: Vec<(ComplexMatrix, Option<f64>)>,
}

impl Weights<'_> {
    fn check(&self, method: Method, modes: &BoxMotion) -> Result<(), CorrectError> {
        if method == Method::Full {
            let missing: Vec<String> = (0..modes.n_modes)
                .filter(|mode| self.series_of_mode(*mode).is_none())
                .map(|mode| (mode + 1).to_string())
                .collect();
            if !missing.is_empty() {
                return Err(CorrectError::Method {
                    method: method.name(),
                    reason: format!(
                        "recordings of every mode are needed, and mode {} has none: record it (`pmb pitch` with a mode as motion), or leave this method out",
                        missing.join(", ")
                    ),
                });
            }
        }
        Ok(())
    }

    fn series_of_mode(&self, mode: usize) -> Option<&Moved<'_>> {
        self.all
            .iter()
            .find(|m| self.references.mode_of.get(m.coordinate).copied().flatten() == Some(mode))
    }

    fn place(&self, method: Method, k: f64) -> Place {
        match method {
            _ if method.is_steady() => Place::Recorded,
            Method::Mode | Method::Full => {
                // The least informed of the recorded motions.
                let rank = |p: Place| match p {
                    Place::Recorded => 0,
                    Place::Below => 1,
                    Place::Blended => 2,
                    Place::Linear => 3,
                };
                let places = self.all.iter().map(|m| m.series.schedule.place(k));
                places.max_by_key(|p| rank(*p)).unwrap_or(Place::Linear)
            }
            _ => self.main.schedule.place(k),
        }
    }

    /// Pressures by every method at one k; `motion` has the modes first and the reference motions behind them.
    fn evaluate(
        &self,
        factored: &FactoredDownwash,
        modes: &BoxMotion,
        motion: &BoxMotion,
        methods: &[Method],
    ) -> Result<AtK, AicError> {
        let k = factored.k();
        let wave_number = k / self.aerodynamics.semichord();
        let wash = motion.downwash(wave_number);
        let mut linear = wash.clone();
        factored.solve_in_place(&mut linear)?;
        let reference = wash.column(modes.n_modes + self.references.main).to_vec();
        let share: Vec<c64> = (0..wash.columns())
            .map(|j| self.share(&reference, wash.column(j)))
            .collect();
        let mut results = Vec::with_capacity(methods.len());
        for method in methods {
            let pressures = match method {
                Method::Downwash => self.by_downwash(factored, &wash, &share, |i| {
                    (
                        self.mix(k, 1.0, |r| r.weight.ratio[i]),
                        self.mix(k, 0.0, |r| r.weight.remainder[i]),
                    )
                })?,
                Method::DownwashSteady => self.by_downwash(factored, &wash, &share, |i| {
                    (self.steady_weight.ratio[i], self.steady_weight.remainder[i])
                })?,
                Method::PressureRatio => weighted(&linear, &share, |i| {
                    (
                        self.mix(k, 1.0, |r| r.pressure.ratio[i]),
                        self.mix(k, 0.0, |r| r.pressure.remainder[i]),
                    )
                }),
                Method::Force => weighted(&linear, &share, |i| {
                    (
                        self.mix(k, 1.0, |r| r.force.ratio[i]),
                        self.mix(k, 0.0, |r| r.force.remainder[i]),
                    )
                }),
                Method::ForceSteady => weighted(&linear, &share, |i| {
                    (self.steady_force.ratio[i], self.steady_force.remainder[i])
                }),
                Method::Additive => {
                    let extra = weighted(&wash, &share, |i| {
                        (
                            self.mix(k, 0.0, |r| r.gain.ratio[i]),
                            self.mix(k, 0.0, |r| r.gain.remainder[i]),
                        )
                    });
                    ComplexMatrix::from_fn(linear.rows(), linear.columns(), |i, j| linear[(i, j)] + extra[(i, j)])
                }
                Method::Mode | Method::Full => self.by_modes(k, &wash, &linear, modes.n_modes),
                Method::DauGarner => self.by_garner(wave_number, &linear, &share),
            };
            let q = generalized_force(self.aerodynamics, modes, &part(&pressures, modes.n_modes))?;
            results.push((
                q,
                self.reproduction(*method, k, pressures.column(modes.n_modes + self.references.main)),
            ));
        }
        Ok(AtK {
            linear: generalized_force(self.aerodynamics, modes, &part(&linear, modes.n_modes))?,
            methods: results,
        })
    }

    /// Share of the reference downwash in another one: least squares over the planform.
    fn share(&self, reference: &[c64], wash: &[c64]) -> c64 {
        let mut sums = (c64::new(0.0, 0.0), 0.0);
        for ((r, w), a) in reference.iter().zip(wash).zip(&self.area) {
            sums.0 += r.conj() * w * *a;
            sums.1 += r.norm_sqr() * a;
        }
        if sums.1 > 0.0 { sums.0 / sums.1 } else { sums.0 }
    }

    fn mix(&self, k: f64, base: f64, value: impl Fn(&AtRecording) -> c64) -> c64 {
        self.main
            .schedule
            .mix(k, c64::new(base, 0.0), |record| value(&self.recordings[record]))
    }

    fn by_downwash(
        &self,
        factored: &FactoredDownwash,
        wash: &ComplexMatrix,
        share: &[c64],
        weight: impl Fn(usize) -> (c64, c64),
    ) -> Result<ComplexMatrix, AicError> {
        let mut columns = weighted(wash, share, weight);
        factored.solve_in_place(&mut columns)?;
        Ok(columns)
    }

    /// AIC w + (P_r - AIC W_r) W_r^+ w over all recorded motions. A column that is a recorded motion is taken as that motion.
    fn by_modes(&self, k: f64, wash: &ComplexMatrix, linear: &ComplexMatrix, n_modes: usize) -> ComplexMatrix {
        let n = wash.rows();
        let columns: Vec<&[c64]> = self.all.iter().map(|m| wash.column(n_modes + m.coordinate)).collect();
        let zero = c64::new(0.0, 0.0);
        let away: Vec<Vec<c64>> = self
            .all
            .iter()
            .map(|m| (0..n).map(|i| m.series.schedule.mix(k, zero, |r| m.away[r][i])).collect())
            .collect();
        let mut result = linear.clone();
        for j in 0..wash.columns() {
            let own = self.all.iter().position(|m| {
                let c = m.coordinate;
                j == n_modes + c || (j < n_modes && self.references.mode_of.get(c).copied().flatten() == Some(j))
            });
            let parts = match own {
                Some(own) => (0..columns.len())
                    .map(|c| c64::new(f64::from(u8::from(c == own)), 0.0))
                    .collect(),
                None => project(&columns, wash.column(j), &self.area),
            };
            for (part, away) in parts.iter().zip(&away) {
                for (i, a) in away.iter().enumerate() {
                    result[(i, j)] += a * part;
                }
            }
        }
        result
    }

    fn by_garner(&self, wave_number: f64, linear: &ComplexMatrix, share: &[c64]) -> ComplexMatrix {
        let lattice = self.aerodynamics.lattice();
        let n = linear.rows();
        let mut result = linear.clone();
        for (j, share) in share.iter().enumerate() {
            let mut column: Vec<c64> = linear.column(j).to_vec();
            garner::velocity_of(lattice, wave_number, &mut column);
            for (i, u) in column.iter_mut().enumerate() {
                *u = *u * self.steady_pressure.ratio[i] + self.steady_pressure.remainder[i] * share * 0.5;
            }
            garner::pressure_of(lattice, wave_number, &mut column);
            result.data_mut()[j * n..(j + 1) * n].copy_from_slice(&column);
        }
        result
    }

    /// Error of the main reference motion at a recorded k, for methods that promise it.
    fn reproduction(&self, method: Method, k: f64, pressures: &[c64]) -> Option<f64> {
        let at = self
            .recordings
            .iter()
            .position(|r| (r.k - k).abs() <= 1e-12 * r.k.max(1e-300))?;
        let recorded = &self.recordings[at];
        if method.is_steady() && (at != self.steady || recorded.k != 0.0) {
            return None;
        }
        let difference: Vec<c64> = pressures.iter().zip(&recorded.recorded).map(|(a, b)| a - b).collect();
        let norm = |list: &[c64]| list.iter().map(c64::norm_sqr).sum::<f64>().sqrt();
        let loads = |list: &[c64]| {
            let loads = crate::sample::strip_loads_of_boxes(self.aerodynamics.lattice(), list);
            norm(&loads.lift_m2) + norm(&loads.moment_m3) / self.aerodynamics.semichord()
        };
        let size = norm(&recorded.recorded);
        if size == 0.0 {
            return Some(norm(&difference));
        }
        Some(match method {
            Method::Force | Method::ForceSteady => loads(&difference) / loads(&recorded.recorded),
            _ => norm(&difference) / size,
        })
    }

    /// Q from the recordings of every mode alone: splined over the recorded k, blended into the lattice beyond them.
    fn full(
        &self,
        modes: &BoxMotion,
        k: &[f64],
        linear: &[ComplexMatrix],
        corrected: &mut Corrected,
    ) -> Result<(), CorrectError> {
        for mode in 0..modes.n_modes {
            let Some(Moved { series, .. }) = self.series_of_mode(mode) else {
                continue;
            };
            let pressures = series
                .records
                .iter()
                .map(|r| ComplexMatrix::from_fn(r.dcp.len(), 1, |i, _| r.dcp[i]));
            let columns = pressures
                .map(|p| generalized_force(self.aerodynamics, modes, &p))
                .collect::<Result<Vec<_>, _>>()?;
            let spline = KInterpolant::new(series.schedule.recorded(), &columns, Interpolation::Spline)?;
            let last = series.schedule.recorded().last().copied().unwrap_or(0.0);
            let at_last = k.iter().position(|k| (k - last).abs() <= 1e-9 * last);
            for (i, &k) in k.iter().enumerate() {
                let strength = series.schedule.strength(k);
                let column = if k <= last * (1.0 + 1e-12) {
                    spline.at(k.min(last))?
                } else {
                    let end = &columns[columns.len() - 1];
                    ComplexMatrix::from_fn(modes.n_modes, 1, |row, _| {
                        let base = at_last.map_or(end[(row, 0)], |at| linear[at][(row, mode)]);
                        linear[i][(row, mode)] + (end[(row, 0)] - base) * strength
                    })
                };
                for row in 0..modes.n_modes {
                    corrected.q[i][(row, mode)] = column[(row, 0)];
                }
            }
        }
        Ok(())
    }
}

/// The first columns of a matrix.
fn part(matrix: &ComplexMatrix, columns: usize) -> ComplexMatrix {
    ComplexMatrix::from_fn(matrix.rows(), columns, |i, j| matrix[(i, j)])
}

/// ratio x value + remainder x share, `weight(box)` giving (ratio, remainder) and `share[column]`.
fn weighted(values: &ComplexMatrix, share: &[c64], weight: impl Fn(usize) -> (c64, c64)) -> ComplexMatrix {
    let weights: Vec<(c64, c64)> = (0..values.rows()).map(weight).collect();
    ComplexMatrix::from_fn(values.rows(), values.columns(), |i, j| {
        values[(i, j)] * weights[i].0 + weights[i].1 * share[j]
    })
}

/// Coordinates of `wash` in `columns` by least squares over the planform (modified Gram-Schmidt). A column that the ones before
/// it hold already gets none.
fn project(columns: &[&[c64]], wash: &[c64], area: &[f64]) -> Vec<c64> {
    let dot = |a: &[c64], b: &[c64]| -> c64 { a.iter().zip(b).zip(area).map(|((x, y), w)| x.conj() * y * *w).sum() };
    let zero = c64::new(0.0, 0.0);
    let mut basis: Vec<Vec<c64>> = Vec::new();
    // R [column][row] of columns = basis R.
    let mut triangle: Vec<Vec<c64>> = Vec::new();
    let mut left = wash.to_vec();
    let mut coordinates = Vec::new();
    for column in columns {
        let size = dot(column, column).re.sqrt();
        let mut v = column.to_vec();
        let mut above = vec![zero; basis.len()];
        for _ in 0..2 {
            for (e, sum) in basis.iter().zip(&mut above) {
                let c = dot(e, &v);
                *sum += c;
                v.iter_mut().zip(e).for_each(|(x, y)| *x -= c * y);
            }
        }
        let norm = dot(&v, &v).re.sqrt();
        if norm > 1e-8 * size {
            v.iter_mut().for_each(|x| *x /= norm);
            above.push(c64::new(norm, 0.0));
        } else {
            v.fill(zero);
            above.push(zero);
        }
        let c = dot(&v, &left);
        left.iter_mut().zip(&v).for_each(|(x, y)| *x -= c * y);
        coordinates.push(c);
        basis.push(v);
        triangle.push(above);
    }
    for j in (0..columns.len()).rev() {
        if triangle[j][j] == zero {
            coordinates[j] = zero;
            continue;
        }
        let x = coordinates[j] / triangle[j][j];
        coordinates[j] = x;
        for (i, r) in triangle[j][..j].iter().enumerate() {
            coordinates[i] -= r * x;
        }
    }
    coordinates
}
