//! What a search varies at fixed Mach number, and the stream that belongs to each value.
//!
//! The flow in its own units depends on the Mach number alone, so one steady flow serves all values. What changes is what the
//! structure feels: dynamic pressure and the time that the stream takes past it. With the density of standard air for an
//! altitude, every search runs upwards in a value from stable to unstable.

use crate::exit::Stop;
use dip_case::atmosphere::{self, Air};
use dip_case::file::{Amount, SearchParameter, SearchTable};
use dip_case::units::{Density, Kind, Length, Speed};
use dip_case::{Document, units};
use dip_flutter::search::SearchSettings;
use dip_pmb::couple::Stream;

/// Lowest and highest altitude of the search, m: those of the standard atmosphere.
const ALTITUDES_M: [f64; 2] = [-5_000.0, 86_000.0];

/// What is varied, with what stays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Parameter {
    /// The density, kg/m^3.
    Density {
        /// Speed of the stream.
        speed_m_s: f64,
    },
    /// The speed, m/s.
    Speed {
        /// Density of the stream.
        density_kg_m3: f64,
    },
    /// The density of standard air, kg/m^3, which stands for the altitude: it rises where the wing becomes less stable.
    Altitude {
        /// Mach number, which makes the speed from the sound speed.
        mach: f64,
    },
}

impl Parameter {
    /// The parameter of a case with the settings of its search. `speed` and `density` are those of the stream, where given.
    ///
    /// # Errors
    /// A value that is missing, of the wrong kind, or has no meaning.
    pub fn of_case(
        document: &Document,
        table: &SearchTable,
        mach: f64,
        (speed, density): (Option<f64>, Option<f64>),
    ) -> Result<(Self, SearchSettings), Stop> {
        let missing = || -> Stop {
            let help = "speed = \"231.37 m/s\" and density = \"0.208 kg/m^3\"; a search of the altitude may give [search] first instead";
            document
                .error("flow", "a march needs the stream's speed and density", help)
                .into()
        };
        let parameter = match (table.parameter, speed, density) {
            (SearchParameter::Altitude, ..) => Self::Altitude { mach },
            (SearchParameter::Density, Some(speed_m_s), Some(_)) => Self::Density { speed_m_s },
            (SearchParameter::Speed, Some(_), Some(density_kg_m3)) => Self::Speed { density_kg_m3 },
            _ => return Err(missing()),
        };
        let first = match (&table.first, parameter) {
            (Some(amount), _) => parameter.value(document, "search.first", amount)?,
            (None, Self::Speed { .. }) => speed.ok_or_else(missing)?,
            (None, _) => density.ok_or_else(missing)?,
        };
        // The same range of dynamic pressure for all, and for altitudes what the atmosphere has.
        let (mut from, mut to) = match parameter {
            Self::Speed { .. } => (first * 0.2_f64.sqrt(), first * 5.0_f64.sqrt()),
            _ => (0.2 * first, 5.0 * first),
        };
        if let Self::Altitude { .. } = parameter {
            let [low, high] = ALTITUDES_M.map(|h| atmosphere::standard(h).map_or(f64::NAN, |a| a.density_kg_m3));
            if !(high..=low).contains(&first) {
                let message = format!("no altitude of the standard atmosphere has the density {first:.5} kg/m^3");
                let help = "give first = \"5 km\" in [search]";
                return Err(document.error("search", message, help).into());
            }
            (from, to) = (from.max(high), to.min(low));
        }
        for (key, amount) in [("search.from", &table.from), ("search.to", &table.to)] {
            if let Some(amount) = amount {
                let value = parameter.value(document, key, amount)?;
                // More altitude is less density: the ends change places.
                if (key == "search.from") != matches!(parameter, Self::Altitude { .. }) {
                    from = value;
                } else {
                    to = value;
                }
            }
        }
        let settings = SearchSettings {
            range: [from, to],
            first,
            tolerance: table.tolerance.unwrap_or(0.01),
            most_runs: table.runs.unwrap_or(8),
        };
        if !(from > 0.0 && from <= first && first <= to && from < to) {
            let [a, f, b] = [from, first, to].map(|v| parameter.words(v));
            let (a, b) = if let Self::Altitude { .. } = parameter {
                (b, a)
            } else {
                (a, b)
            };
            let message = format!("the range from {a} to {b} does not hold the first value, {f}");
            let help =
                "change from, to or first; left out, the range is a fifth to five times the first dynamic pressure";
            return Err(document.error("search", message, help).into());
        }
        Ok((parameter, settings))
    }

    /// A quantity of the case as a value of the search.
    fn value(self, document: &Document, key: &str, amount: &Amount) -> Result<f64, Stop> {
        let read = |value: Result<f64, units::UnitError>, example: &str| -> Result<f64, Stop> {
            value.map_err(|e| {
                document
                    .error(key, e.to_string(), format!("as in \"{example}\""))
                    .into()
            })
        };
        match self {
            Self::Density { .. } => read(amount.value::<Density>(), Density::EXAMPLE),
            Self::Speed { .. } => read(amount.value::<Speed>(), Speed::EXAMPLE),
            Self::Altitude { .. } => {
                let altitude = read(amount.value::<Length>(), "5 km")?;
                let air = atmosphere::standard(altitude)
                    .map_err(|e| document.error(key, e.to_string(), "give an altitude inside of it"))?;
                Ok(air.density_kg_m3)
            }
        }
    }

    /// The stream at a value.
    pub fn stream(self, at: f64) -> Stream {
        let (speed_m_s, density_kg_m3) = match self {
            Self::Density { speed_m_s } => (speed_m_s, at),
            Self::Speed { density_kg_m3 } => (at, density_kg_m3),
            Self::Altitude { mach } => (mach * air(at).1.speed_of_sound_m_s, at),
        };
        Stream {
            speed_m_s,
            density_kg_m3,
            length_m: 1.0,
        }
    }

    /// The altitude, m, where that is what is varied.
    pub fn altitude_m(self, at: f64) -> Option<f64> {
        matches!(self, Self::Altitude { .. }).then(|| air(at).0)
    }

    /// A value as the user knows it.
    pub fn words(self, at: f64) -> String {
        match self {
            Self::Density { .. } => format!("density {at:.5} kg/m^3"),
            Self::Speed { .. } => format!("speed {at:.3} m/s"),
            Self::Altitude { .. } => format!("altitude {:.0} m", air(at).0),
        }
    }

    /// Name as in the case file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Density { .. } => "density",
            Self::Speed { .. } => "speed",
            Self::Altitude { .. } => "altitude",
        }
    }

    /// Relative change of the speed index `U sqrt(rho)` for a relative change of the value.
    pub fn index_slope(self, at: f64) -> f64 {
        match self {
            Self::Density { .. } => 0.5,
            Self::Speed { .. } => 1.0,
            Self::Altitude { .. } => {
                let index = |at: f64| {
                    let stream = self.stream(at);
                    stream.dynamic_pressure_pa().sqrt().ln()
                };
                let step = 1e-3;
                (index(at * (1.0 + step)) - index(at * (1.0 - step))) / (2.0 * step)
            }
        }
    }
}

/// Altitude, m, and air where standard air has this density; the end of the atmosphere beyond it.
fn air(density_kg_m3: f64) -> (f64, Air) {
    let end = Air {
        temperature_k: f64::NAN,
        pressure_pa: f64::NAN,
        density_kg_m3,
        speed_of_sound_m_s: f64::NAN,
    };
    let at = |h: f64| atmosphere::standard(h).unwrap_or(end);
    let [mut low, mut high] = ALTITUDES_M;
    // Density falls all the way up; halved to the last bit.
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if at(middle).density_kg_m3 > density_kg_m3 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let altitude = 0.5 * (low + high);
    (altitude, at(altitude))
}

#[cfg(test)]
mod tests {
    use super::*;
    use dip_flutter::search::{Search, SearchStep, Stability, Trial};

    /// A wing in place of the flow, at one Mach number: damping goes with the dynamic pressure, neutral near 6 kPa, and a little with the
    /// mass ratio; as marches of AGARD 445.6 show it, nearly flat far below and ever steeper.
    fn stability(stream: &Stream) -> Stability {
        let x = stream.dynamic_pressure_pa() / 6e3 * (stream.density_kg_m3 / 0.3).powf(0.05);
        Stability::Oscillation {
            g: -0.3 * x * (1.0 - x.powi(3)),
            g_error: 1e-5,
            freq_hz: 14.0 + 6.0 * x,
        }
    }

    fn find(parameter: Parameter, first: f64, range: [f64; 2]) -> (Stream, f64, f64) {
        let settings = SearchSettings {
            range,
            first,
            tolerance: 2e-3,
            most_runs: 20,
        };
        let mut search = Search::new(settings, Vec::new()).expect("settings");
        loop {
            match search.next() {
                SearchStep::Run(at) => {
                    let stability = stability(&parameter.stream(at));
                    search.add(Trial { at, stability }).expect("a trial");
                }
                SearchStep::Found(point) => return (parameter.stream(point.at), point.freq_hz, point.at),
                end => panic!("{end:?}"),
            }
        }
    }

    #[test]
    fn a_search_of_the_speed_at_the_density_found_gives_the_same_point() {
        let (point, freq_hz, _) = find(Parameter::Density { speed_m_s: 200.0 }, 0.3, [0.01, 5.0]);
        for first in [0.7, 0.95, 1.4] {
            let density_kg_m3 = point.density_kg_m3;
            let speed = Parameter::Speed { density_kg_m3 };
            let (same, same_hz, _) = find(speed, first * 200.0, [50.0, 600.0]);
            // The tolerance of the speed, and half that of the density.
            assert!((same.speed_m_s / 200.0 - 1.0).abs() < 3e-3, "{first}: {same:?}");
            assert!((same_hz / freq_hz - 1.0).abs() < 5e-3, "{same_hz} {freq_hz}");
        }
    }

    #[test]
    fn an_altitude_is_a_matched_point_and_the_speed_there_gives_it_back() {
        let mach = 0.6;
        let altitude = Parameter::Altitude { mach };
        let [thin, thick] = [30_000.0, -5_000.0].map(|h| atmosphere::standard(h).expect("air").density_kg_m3);
        let (point, freq_hz, at) = find(altitude, 0.3, [thin, thick]);
        let height = altitude.altitude_m(at).expect("an altitude");
        let air = atmosphere::standard(height).expect("air");
        assert!((air.density_kg_m3 / point.density_kg_m3 - 1.0).abs() < 1e-12);
        assert!((point.speed_m_s / air.speed_of_sound_m_s / mach - 1.0).abs() < 1e-12);
        let density = Parameter::Density {
            speed_m_s: point.speed_m_s,
        };
        let (same, same_hz, _) = find(density, 0.5 * point.density_kg_m3, [0.01, 5.0]);
        assert!(
            (same.density_kg_m3 / point.density_kg_m3 - 1.0).abs() < 5e-3,
            "{same:?} {point:?}"
        );
        assert!((same_hz / freq_hz - 1.0).abs() < 5e-3, "{same_hz} {freq_hz}");
    }

    #[test]
    fn errors_of_the_value_are_errors_of_the_index() {
        assert_eq!(Parameter::Density { speed_m_s: 1.0 }.index_slope(0.2), 0.5);
        assert_eq!(Parameter::Speed { density_kg_m3: 1.0 }.index_slope(200.0), 1.0);
        // Constant temperature (11 to 20 km): the sound speed does not change, so the index goes with the root of the density.
        let slope = Parameter::Altitude { mach: 0.8 }.index_slope(0.2);
        assert!((slope - 0.5).abs() < 1e-6, "{slope}");
        // Below, T ~ rho^(1/4.2559): a further 1/2/4.2559.
        let slope = Parameter::Altitude { mach: 0.8 }.index_slope(0.8);
        assert!((slope - 0.5 - 0.5 / 4.2559).abs() < 1e-3, "{slope}");
    }
}
