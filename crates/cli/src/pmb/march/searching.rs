//! Runs one after the other until the flutter point is known; finished ones are read from an earlier search.

use super::TRIALS;
use super::case::March;
use super::parameter::Parameter;
use super::summary::{DivergencePoint, FlutterPoint, TrialRow};
use crate::exit::Stop;
use crate::progress::Seconds;
use dip_flutter::SpeedIndexReference;
use dip_flutter::search::{Neutral, Rate, Search, SearchStep, Stability, StaticLimit, Trial};

/// What a search has come to.
#[derive(Debug)]
pub struct Searched {
    /// Runs in order.
    pub trials: Vec<TrialRow>,
    /// The flutter point, if there is one.
    pub found: Option<Neutral>,
    /// Where the wing diverges, if that comes first.
    pub limit: Option<StaticLimit>,
    /// Why it ended.
    pub reason: String,
}

impl March<'_> {
    /// Searches; what the runs took goes to `stages`.
    ///
    /// # Errors
    /// What a run fails with; finished runs are on disk.
    pub fn searched(&self, stages: &mut Vec<(String, Seconds)>) -> Result<Searched, Stop> {
        let refuse = |e: dip_flutter::FlutterError| -> Stop {
            self.document
                .error("search", e.to_string(), "leave the key out for its default")
                .into()
        };
        let mut search = Search::new(self.search.clone(), Vec::new()).map_err(refuse)?;
        let mut trials: Vec<TrialRow> = Vec::new();
        let older = self.older();
        let words = |at: f64| self.parameter.words(at);
        let (found, limit, reason) = loop {
            let at = match search.next() {
                SearchStep::Run(at) => at,
                SearchStep::Found(point) => break (Some(point), None, "found".to_owned()),
                SearchStep::StableThroughout => {
                    let end = words(self.search.range[1]);
                    break (None, None, format!("stable up to the end of the range, {end}"));
                }
                SearchStep::UnstableThroughout => {
                    let end = words(self.search.range[0]);
                    break (None, None, format!("unstable down to the end of the range, {end}"));
                }
                SearchStep::Divergence(limit) => {
                    let [stable, divergent] = limit.between.map(words);
                    let reason = format!("divergence comes first, between {stable} and {divergent}");
                    break (None, Some(limit), reason);
                }
                SearchStep::OutOfRuns(best) => {
                    let end = "all runs were used, or the next would repeat one";
                    let rest = if best.is_some() {
                        "the best estimate is given"
                    } else {
                        "there is no estimate yet"
                    };
                    break (best, None, format!("{end}; {rest}"));
                }
            };
            let number = trials.len() + 1;
            // The next value follows from the finished ones alone: an older search has asked for the same.
            let row = match older.get(trials.len()).filter(|r| r.at == at) {
                Some(row) => {
                    tracing::info!("{}: kept", words(at));
                    row.clone()
                }
                None => self.trial(at, number, search.damping_accuracy())?,
            };
            stages.push((format!("march {number}, {}", words(at)), row.seconds));
            let stability = stability(&row);
            trials.push(row);
            self.folder.write_json(TRIALS, &(&self.stamp.fingerprint, &trials))?;
            search.add(Trial { at, stability }).map_err(refuse)?;
        };
        let hidden = |t: &TrialRow| t.g.zip(t.g_error).is_some_and(|(g, error)| g.abs() <= error);
        let reason = if found.is_none() && trials.iter().all(hidden) {
            format!("{reason}; in every run the damping is smaller than its error: begin where there is more air")
        } else {
            reason
        };
        Ok(Searched {
            trials,
            found,
            limit,
            reason,
        })
    }

    /// Finished runs of an earlier search of the same inputs.
    fn older(&self) -> Vec<TrialRow> {
        if !self.resume {
            return Vec::new();
        }
        std::fs::read_to_string(self.folder.path().join(TRIALS))
            .ok()
            .and_then(|t| serde_json::from_str::<(String, Vec<TrialRow>)>(&t).ok())
            .filter(|(fingerprint, _)| *fingerprint == self.stamp.fingerprint)
            .map_or_else(Vec::new, |(_, rows)| rows)
    }

    /// Divergence as scripts read it.
    pub fn divergence(&self, searched: &Searched, time_s: f64) -> Option<DivergencePoint> {
        let (at, error) = searched.divergence()?;
        let parameter: Parameter = self.parameter;
        let stream = parameter.stream(at);
        Some(DivergencePoint {
            mach: self.file.flow.mach,
            parameter: parameter.name().to_owned(),
            density_kg_m3: stream.density_kg_m3,
            speed_m_s: stream.speed_m_s,
            altitude_m: parameter.altitude_m(at),
            dynamic_pressure_pa: stream.dynamic_pressure_pa(),
            parameter_error: error / at,
            between: searched
                .limit?
                .between
                .map(|v| parameter.stream(v).dynamic_pressure_pa()),
            method: "march".to_owned(),
            time_s,
        })
    }

    /// The point as scripts read it.
    pub fn point(
        &self,
        found: &Neutral,
        trials: &[TrialRow],
        index: Option<&SpeedIndexReference>,
        time_s: f64,
    ) -> FlutterPoint {
        let parameter: Parameter = self.parameter;
        let stream = parameter.stream(found.at);
        let error = found.error / found.at;
        FlutterPoint {
            mach: self.file.flow.mach,
            parameter: parameter.name().to_owned(),
            density_kg_m3: stream.density_kg_m3,
            parameter_error: error,
            speed_index_error: parameter.index_slope(found.at) * error,
            method: "march".to_owned(),
            flutter_speed_m_s: stream.speed_m_s,
            altitude_m: parameter.altitude_m(found.at),
            flutter_frequency_hz: found.freq_hz,
            mode: mode_at(found, trials),
            flutter_speed_index: index.map(|r| r.speed_index(stream.speed_m_s, stream.density_kg_m3)),
            frequency_ratio: index.map(|r| r.frequency_ratio(found.freq_hz)),
            omega_alpha_rad_s: index.map(|r| r.omega_alpha_rad_s),
            mass_kg: index.map(|r| r.mass_kg),
            bracketed: found.bracketed,
            time_s,
        }
    }
}

impl Searched {
    /// Where the wing diverges: the middle between the runs next to it and half their distance where rates say no more.
    pub fn divergence(&self) -> Option<(f64, f64)> {
        let limit = self.limit?;
        let [stable, divergent] = limit.between;
        let middle = (0.5 * (stable + divergent), 0.5 * (divergent - stable));
        Some(limit.point.map_or(middle, |p| (p.at, p.error)))
    }
}

/// The structural mode of the oscillation that is neutral at a point: that of the least stable mode of the run next to it, if that has
/// nearly its frequency.
fn mode_at(found: &Neutral, trials: &[TrialRow]) -> Option<usize> {
    let far = |t: &&TrialRow| (t.at - found.at).abs();
    let nearest = trials.iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
    let apart = |hz: f64| (hz / found.freq_hz).ln().abs();
    let mode = nearest
        .modes
        .iter()
        .min_by(|a, b| apart(a.frequency_hz).total_cmp(&apart(b.frequency_hz)))?;
    (apart(mode.frequency_hz) < SAME_MODE).then_some(mode.mode)
}

/// Difference of the logarithms of two frequencies up to which they are of one mode.
const SAME_MODE: f64 = 0.1;

/// What the search makes of a row.
fn stability(row: &TrialRow) -> Stability {
    let rate = row
        .rate_1_s
        .zip(row.rate_error_1_s)
        .map(|(rate_1_s, rate_error_1_s)| Rate {
            rate_1_s,
            rate_error_1_s,
        });
    match (row.diverges, row.g, row.g_error, row.frequency_hz) {
        (false, Some(g), Some(g_error), Some(freq_hz)) => Stability::Oscillation { g, g_error, freq_hz },
        (false, ..) => Stability::Subsidence(rate),
        (true, ..) => Stability::Divergence(rate),
    }
}
