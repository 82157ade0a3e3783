//! The parameter (density, speed, altitude) at which a mode's damping vanishes, from as few costly runs as possible.
//!
//! Each run gives the damping of the least stable mode at one value. [`Search::next`] says which value to run next, or that
//! the point is known to the accuracy asked for. It depends on the list of finished runs alone, so a search that was
//! interrupted goes on where it stopped when it is given the same list.

use crate::error::{FlutterError, Result, check_value};

/// Rate of a motion that does not oscillate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// Rate, 1/s; above zero it grows.
    pub rate_1_s: f64,
    /// Its standard error, 1/s.
    pub rate_error_1_s: f64,
}

/// What a run has shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stability {
    /// The least stable mode oscillates.
    Oscillation {
        /// g = 2 sigma / omega, positive growing.
        g: f64,
        /// Standard error of g.
        g_error: f64,
        /// Frequency, Hz.
        freq_hz: f64,
    },
    /// The structure moves away without oscillating; at which rate, where that could be read.
    Divergence(Option<Rate>),
    /// It comes to rest without oscillating, at which rate, where that could be read: stable, but with no damping of a mode to
    /// follow.
    Subsidence(Option<Rate>),
}

impl Stability {
    fn is_stable(&self) -> bool {
        match self {
            Self::Oscillation { g, .. } => *g < 0.0,
            Self::Divergence(_) => false,
            Self::Subsidence(_) => true,
        }
    }

    /// The rate of a motion that does not oscillate, where it could be read.
    #[must_use]
    pub fn rate(&self) -> Option<Rate> {
        match self {
            Self::Oscillation { .. } => None,
            Self::Divergence(rate) | Self::Subsidence(rate) => *rate,
        }
    }
}

/// A finished run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// Value of the parameter.
    pub at: f64,
    /// What it showed.
    pub stability: Stability,
}

/// How to search.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchSettings {
    /// Smallest and largest value allowed, both above zero.
    pub range: [f64; 2],
    /// First value.
    pub first: f64,
    /// Relative standard error of the point at which the search ends.
    pub tolerance: f64,
    /// Runs at most.
    pub most_runs: usize,
}

/// The point that was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neutral {
    /// Value of the parameter where g = 0, or the rate of divergence.
    pub at: f64,
    /// Standard error: what the errors of the dampings make of it, and what the interpolation itself may be off by.
    pub error: f64,
    /// Frequency there, Hz; 0 at divergence.
    pub freq_hz: f64,
    /// Slope dg/d(parameter), or that of the rate, 1/s.
    pub slope: f64,
    /// True if runs on both sides hold it; false if it was extrapolated: by less than half of the tolerance where it ends a search.
    pub bracketed: bool,
}

/// Where a structure diverges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticLimit {
    /// The runs next to it: stable at the first value, divergent at the second.
    pub between: [f64; 2],
    /// Where the rate vanishes, from the rates of motion that does not oscillate on both sides; none where too few could be read.
    pub point: Option<Neutral>,
}

/// What to do next.
#[derive(Debug, Clone, PartialEq)]
pub enum SearchStep {
    /// Run this value.
    Run(f64),
    /// Done.
    Found(Neutral),
    /// Stable up to the end of the range.
    StableThroughout,
    /// Unstable down to the end of the range.
    UnstableThroughout,
    /// The static limit is met first.
    Divergence(StaticLimit),
    /// All runs allowed were made, or the next one would repeat one that was made; the best estimate, if there is one.
    OutOfRuns(Option<Neutral>),
}

/// Largest change of the parameter's logarithm from one run to the next outside known values.
const STRIDE: f64 = 0.35;
/// Tolerances from the first run to the second at least: two runs closer to each other tell little of the slope.
const SECOND_STRIDE: f64 = 4.0;
/// Part of the tolerance within which a value has been run already.
const REPEATED: f64 = 0.05;
/// Part of the tolerance by which a point may lie outside the runs. Trends extrapolated from farther away were off by more
/// than their errors said: damping curves bend near the neutral point.
const EXTRAPOLATED: f64 = 0.5;
/// Change of g for a change of the parameter's logarithm by one, where nothing better is known: wings at constant Mach
/// number show 0.2 to 1.
const USUAL_SLOPE: f64 = 0.5;

/// Difference of the parameter's logarithm over which the slope changes by half at most.
const CLOSE: f64 = 0.07;
/// Difference of the frequencies' logarithms up to which two runs show the same mode.
const SAME_MODE: f64 = 0.4;

/// Tolerances that the runs next to a point of divergence may be apart: a flow remembers what moved in it, and what it remembers decays
/// beside a structure that comes to rest, so that rates far from the point say little of it. In plane flow they were off by 1.3 %
/// from runs 6 % apart.
const CLOSED: f64 = 3.0;
/// Part of their distance by which the point may be off the straight line between rates whose slopes differ by half from one
/// side to the other: (1.5^(1/2) - 1) / (1.5^(1/2) + 1).
const KINK: f64 = 0.101;

/// A search, as its settings and finished runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Search {
    settings: SearchSettings,
    trials: Vec<Trial>,
}

impl Search {
    /// A search with the runs that are finished already, in the order in which they were made.
    ///
    /// # Errors
    /// [`FlutterError::Value`] for a range, a first value, a tolerance or a trial that has no meaning.
    pub fn new(settings: SearchSettings, trials: Vec<Trial>) -> Result<Self> {
        let [lo, hi] = settings.range;
        check_value("search range, lower end", lo, "above zero", lo > 0.0)?;
        check_value(
            "search range, upper end",
            hi,
            "above the lower end",
            hi > lo && hi.is_finite(),
        )?;
        let first = settings.first;
        check_value(
            "first value of the search",
            first,
            "inside the range",
            (lo..=hi).contains(&first),
        )?;
        let t = settings.tolerance;
        check_value("tolerance of the search", t, "between 0 and 0.5", t > 0.0 && t < 0.5)?;
        if settings.most_runs == 0 {
            return Err(FlutterError::Value {
                what: "runs of the search, at most".into(),
                needed: "one or more".into(),
                got: 0.0,
            });
        }
        let mut search = Self {
            settings,
            trials: Vec::new(),
        };
        for trial in trials {
            search.add(trial)?;
        }
        Ok(search)
    }

    /// Adds a finished run.
    ///
    /// # Errors
    /// [`FlutterError::Value`] for numbers that are not finite.
    pub fn add(&mut self, trial: Trial) -> Result<()> {
        check_value(
            "value of a run",
            trial.at,
            "above zero",
            trial.at > 0.0 && trial.at.is_finite(),
        )?;
        if let Stability::Oscillation { g, g_error, freq_hz } = trial.stability {
            check_value("damping of a run", g, "finite", g.is_finite())?;
            check_value(
                "standard error of a run's damping",
                g_error,
                "zero or more",
                g_error >= 0.0 && g_error.is_finite(),
            )?;
            check_value(
                "frequency of a run, Hz",
                freq_hz,
                "above zero",
                freq_hz > 0.0 && freq_hz.is_finite(),
            )?;
        }
        if let Some(rate) = trial.stability.rate() {
            check_value("rate of a run, 1/s", rate.rate_1_s, "finite", rate.rate_1_s.is_finite())?;
            check_value(
                "standard error of a run's rate, 1/s",
                rate.rate_error_1_s,
                "zero or more",
                rate.rate_error_1_s >= 0.0 && rate.rate_error_1_s.is_finite(),
            )?;
        }
        self.trials.push(trial);
        Ok(())
    }

    /// Finished runs, in order.
    #[must_use]
    pub fn trials(&self) -> &[Trial] {
        &self.trials
    }

    /// What to do next.
    #[must_use]
    pub fn next(&self) -> SearchStep {
        let [lo, hi] = self.settings.range;
        if self.trials.is_empty() {
            return SearchStep::Run(self.settings.first);
        }
        let estimate = self.estimate();
        if let Some(found) = estimate
            && found.error <= self.settings.tolerance * found.at
            && (lo..=hi).contains(&found.at)
            && (found.bracketed || self.is_next_to_a_run(found.at))
        {
            return SearchStep::Found(found);
        }
        // The nearest stable value below an unstable one; at constant Mach number more density is less stable.
        let below = self.extreme(true);
        let above = self.extreme(false);
        let limit = match (below, above) {
            (Some(b), Some(a)) if matches!(a.stability, Stability::Divergence(_)) => Some(self.static_limit(&b, &a)),
            _ => None,
        };
        if let Some(limit) = limit
            && limit.is_known_to(self.settings.tolerance)
        {
            return SearchStep::Divergence(limit);
        }
        if self.trials.len() >= self.settings.most_runs {
            return SearchStep::OutOfRuns(estimate);
        }
        let wanted = match (below, above, estimate) {
            (Some(b), Some(a), estimate) => match (limit, estimate) {
                (Some(limit), _) => limit.next(self.settings.tolerance),
                (None, Some(found)) => inside([b.at, a.at], found.at),
                (None, None) => (a.at * b.at).sqrt(),
            },
            (Some(b), None, estimate) => {
                if b.at >= hi {
                    return SearchStep::StableThroughout;
                }
                b.at * self.stride(&b, estimate, 1.0)
            }
            (None, Some(a), estimate) => {
                if a.at <= lo {
                    return SearchStep::UnstableThroughout;
                }
                a.at * self.stride(&a, estimate, -1.0)
            }
            (None, None, _) => self.settings.first,
        };
        let wanted = wanted.clamp(lo, hi);
        let near = REPEATED * self.settings.tolerance * wanted;
        if self.trials.iter().any(|t| (t.at - wanted).abs() <= near) {
            return SearchStep::OutOfRuns(estimate);
        }
        SearchStep::Run(wanted)
    }

    /// Standard error of g that the next run should reach so that the point can be known to the tolerance, once there is a
    /// trend to tell it from.
    #[must_use]
    pub fn damping_accuracy(&self) -> Option<f64> {
        // Half for the damping, half for the interpolation.
        let found = self.estimate()?;
        Some(0.5 * self.settings.tolerance * found.at * found.slope)
    }

    /// Whether a value is so close to a run that even a wrong slope carries the run's damping there within the tolerance.
    fn is_next_to_a_run(&self, at: f64) -> bool {
        let near = EXTRAPOLATED * self.settings.tolerance * at;
        self.trials.iter().any(|t| (t.at - at).abs() <= near)
    }

    /// Factor from the outermost value `from` towards the neutral point, a little beyond it so that it comes to lie between.
    fn stride(&self, from: &Trial, estimate: Option<Neutral>, sign: f64) -> f64 {
        let way = match (estimate, from.stability) {
            (Some(found), _) => 1.2 * sign * (found.at / from.at).ln(),
            (None, Stability::Oscillation { g, .. }) if self.trials.len() == 1 => {
                (1.2 * g.abs() / USUAL_SLOPE).max(SECOND_STRIDE * self.settings.tolerance)
            }
            // Several runs without a trend, or nothing to go by.
            (None, _) => STRIDE,
        };
        let least = self.settings.tolerance;
        // A trend that points away from the neutral point says only that it is far.
        let way = if way > 0.0 { way.clamp(least, STRIDE) } else { STRIDE };
        (sign * way).exp()
    }

    /// The stable run with the largest value (or the unstable one with the smallest).
    fn extreme(&self, stable: bool) -> Option<Trial> {
        let side = self.trials.iter().filter(|t| t.stability.is_stable() == stable);
        let order = |a: &&Trial, b: &&Trial| a.at.total_cmp(&b.at);
        if stable { side.max_by(order) } else { side.min_by(order) }.copied()
    }

    /// The neutral point of the oscillation.
    fn estimate(&self) -> Option<Neutral> {
        let mut known: Vec<Sample> = self
            .trials
            .iter()
            .filter_map(|t| match t.stability {
                Stability::Oscillation { g, g_error, freq_hz } => Some(Sample {
                    at: t.at,
                    growth: g,
                    error: g_error,
                    freq_hz,
                }),
                Stability::Divergence(_) | Stability::Subsidence(_) => None,
            })
            .collect();
        // The least stable mode may be another far from the neutral point: only runs that show the mode of the first unstable run (of
        // the least stable one, if all are stable) make its trend.
        let unstable = known.iter().filter(|s| s.growth >= 0.0);
        let critical = unstable
            .min_by(|a, b| a.at.total_cmp(&b.at))
            .or_else(|| known.iter().max_by(|a, b| a.growth.total_cmp(&b.growth)))?
            .freq_hz;
        known.retain(|s| (s.freq_hz / critical).ln().abs() < SAME_MODE);
        neutral(known)
    }

    /// Where the structure diverges, between a stable run and a divergent one: the rate of the motion that does not oscillate goes
    /// smoothly through zero there.
    fn static_limit(&self, stable: &Trial, divergent: &Trial) -> StaticLimit {
        let sample = |t: &Trial| {
            let rate = t.stability.rate()?;
            Some(Sample {
                at: t.at,
                growth: rate.rate_1_s,
                error: rate.rate_error_1_s,
                freq_hz: 0.0,
            })
        };
        let between = [stable.at, divergent.at];
        let point = neutral(self.trials.iter().filter_map(sample).collect());
        StaticLimit {
            between,
            // A trend that contradicts the runs is none.
            point: point
                .filter(|p| between[0] < p.at && p.at < between[1])
                .map(|p| Neutral {
                    error: p.error.hypot(KINK * (between[1] - between[0])),
                    ..p
                }),
        }
    }
}

impl StaticLimit {
    fn is_known_to(&self, tolerance: f64) -> bool {
        let [stable, divergent] = self.between;
        let width = (divergent - stable) / divergent;
        let held = |p: Neutral| p.bracketed && p.error <= tolerance * p.at;
        width <= tolerance || width <= CLOSED * tolerance && self.point.is_some_and(held)
    }

    /// The value to run next.
    fn next(&self, tolerance: f64) -> f64 {
        let [stable, divergent] = self.between;
        let Some(point) = self.point else {
            return 0.5 * (stable + divergent);
        };
        // Of two runs one of which is far from the point, the far one is to be replaced: beside the point, on its side.
        let step = tolerance * point.at;
        let wanted = match (point.at - stable > 2.0 * step, divergent - point.at > 2.0 * step) {
            (true, false) => point.at - step,
            (false, true) => point.at + step,
            _ => point.at,
        };
        inside(self.between, wanted)
    }
}

/// The value `at`, moved off the ends of what the runs enclose, where a run would say nothing new.
fn inside(between: [f64; 2], at: f64) -> f64 {
    let margin = 0.05 * (between[1] - between[0]).abs();
    let (from, to) = (between[0].min(between[1]), between[0].max(between[1]));
    at.clamp(from + margin, to - margin)
}

/// The neutral point from the two samples next to it, and the third for the curvature.
fn neutral(mut known: Vec<Sample>) -> Option<Neutral> {
    // Later runs at a value replace earlier ones.
    known.reverse();
    known.sort_by(|a, b| a.at.total_cmp(&b.at));
    known.dedup_by(|a, b| a.at == b.at);
    // From the neutral point outward: the ends of the bracket, or of the side that is known, first.
    let stable = |s: &Sample| s.growth < 0.0;
    let last = known.iter().rposition(stable);
    let centre = match (
        last.map(|n| known[n].at),
        known.iter().find(|s| !stable(s)).map(|s| s.at),
    ) {
        (Some(below), Some(above)) => 0.5 * (below + above),
        (Some(below), None) => below,
        (None, Some(above)) => above,
        (None, None) => return None,
    };
    known.sort_by(|a, b| (a.at - centre).abs().total_cmp(&(b.at - centre).abs()));
    let [mut a, mut b] = [*known.first()?, *known.get(1)?];
    if b.growth.abs() < a.growth.abs() {
        std::mem::swap(&mut a, &mut b);
    }
    let slope = (b.growth - a.growth) / (b.at - a.at);
    if !(slope > 0.0 && slope.is_finite()) {
        return None;
    }
    let line = a.at - a.growth / slope;
    let share = (line - a.at) / (b.at - a.at);
    let data = ((1.0 - share) * a.error).hypot(share * b.error) / slope;
    let (at, model) = match known.get(2).and_then(|c| parabola_root(&[a, b, *c], line)) {
        // The parabola is the better estimate; what it changes bounds what is still missing.
        Some(root) => (root, (root - line).abs()),
        // A slope that changes by half over a small distance of the runs, and by more where they are far apart: that of the AGARD wing
        // at Mach 0.678 doubles from 15 % of density to the next.
        None => {
            let apart = ((b.at / a.at).ln().abs() / CLOSE).max(1.0).powf(1.25);
            (line, 0.25 * apart * (share * (1.0 - share) * (b.at - a.at)).abs())
        }
    };
    (at > 0.0 && at.is_finite()).then(|| Neutral {
        at,
        error: data.hypot(model),
        freq_hz: a.freq_hz + share * (b.freq_hz - a.freq_hz),
        slope,
        bracketed: a.growth.signum() != b.growth.signum(),
    })
}

/// What a trend is made of: damping of an oscillation, or the rate of a motion that does not oscillate.
#[derive(Debug, Clone, Copy)]
struct Sample {
    at: f64,
    growth: f64,
    error: f64,
    freq_hz: f64,
}

/// The root nearest to `near` of the parabola through three samples.
fn parabola_root([a, b, c]: &[Sample; 3], near: f64) -> Option<f64> {
    // Newton's form: g = g_a + s (x - x_a) + k (x - x_a)(x - x_b).
    let s = (b.growth - a.growth) / (b.at - a.at);
    let k = ((c.growth - b.growth) / (c.at - b.at) - s) / (c.at - a.at);
    let (q2, q1, q0) = (k, s - k * (a.at + b.at), a.growth - s * a.at + k * a.at * b.at);
    let discriminant = q1 * q1 - 4.0 * q2 * q0;
    if discriminant.is_nan() || discriminant < 0.0 {
        return None;
    }
    // Stable for small curvature: the root that stays finite as k goes to zero, and the other.
    let half = -0.5 * (q1 + q1.signum() * discriminant.sqrt());
    [q0 / half, half / q2]
        .into_iter()
        .filter(|r| r.is_finite())
        .min_by(|x, y| (x - near).abs().total_cmp(&(y - near).abs()))
}
