//! Runs one after the other until the flutter point is known; finished ones are read from an earlier search.

use super::TRIALS;
use super::case::March;
use super::parameter::Parameter;
use super::summary::{FlutterPoint, TrialRow};
use crate::exit::Stop;
use crate::progress::Seconds;
use dip_flutter::SpeedIndexReference;
use dip_flutter::search::{Neutral, Search, SearchStep, Stability, Trial};

/// What a search has come to.
#[derive(Debug)]
pub struct Searched {
    /// Runs in order.
    pub trials: Vec<TrialRow>,
    /// The point, if there is one.
    pub found: Option<Neutral>,
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
        let (found, reason) = loop {
            let at = match search.next() {
                SearchStep::Run(at) => at,
                SearchStep::Found(point) => break (Some(point), "found".to_owned()),
                SearchStep::StableThroughout => {
                    break (
                        None,
                        format!("stable up to the end of the range, {}", words(self.search.range[1])),
                    );
                }
                SearchStep::UnstableThroughout => {
                    break (
                        None,
                        format!("unstable down to the end of the range, {}", words(self.search.range[0])),
                    );
                }
                SearchStep::Divergence([a, b]) => {
                    break (
                        None,
                        format!("divergence comes first, between {} and {}", words(a), words(b)),
                    );
                }
                SearchStep::OutOfRuns(best) => {
                    let end = "all runs were used, or the next would repeat one";
                    let rest = if best.is_some() {
                        "the best estimate is given"
                    } else {
                        "there is no estimate yet"
                    };
                    break (best, format!("{end}; {rest}"));
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
        Ok(Searched { trials, found, reason })
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

    /// The point as scripts read it.
    pub fn point(&self, found: &Neutral, index: Option<&SpeedIndexReference>, time_s: f64) -> FlutterPoint {
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
            flutter_speed_index: index.map(|r| r.speed_index(stream.speed_m_s, stream.density_kg_m3)),
            frequency_ratio: index.map(|r| r.frequency_ratio(found.freq_hz)),
            omega_alpha_rad_s: index.map(|r| r.omega_alpha_rad_s),
            mass_kg: index.map(|r| r.mass_kg),
            bracketed: found.bracketed,
            time_s,
        }
    }
}

/// What the search makes of a row.
fn stability(row: &TrialRow) -> Stability {
    match (row.diverges, row.g, row.g_error, row.frequency_hz) {
        (false, Some(g), Some(g_error), Some(freq_hz)) => Stability::Oscillation { g, g_error, freq_hz },
        (false, ..) => Stability::Subsidence,
        (true, ..) => Stability::Divergence,
    }
}
