//! What the motion of a run does: decays, grows, keeps a limit cycle, comes to rest, or diverges.

use super::summary::ModeRow;
use dip_flutter::decay::{DecaySettings, LimitCycle, Reading, WatchedMode, limit_cycle};
use dip_flutter::search::{Rate, Stability};
use dip_modal::ModalEquations;
use serde::{Deserialize, Serialize};

/// A limit cycle as scripts read it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LimitCycleRow {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Amplitude of each generalized coordinate.
    pub amplitude: Vec<f64>,
    /// A bound on the amplitude of the wall, m.
    pub wall_amplitude_m: f64,
    /// Damping while it was small (positive: it grew).
    pub g_early: f64,
    /// Damping at the end.
    pub g_late: f64,
}

/// What the motion does.
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    /// What is least stable oscillates, goes away or comes to rest.
    Is(Stability),
    /// It has grown, and keeps its size now.
    LimitCycle(LimitCycle),
}

/// What a run has shown: `record` are the generalized coordinates about their mean, `[mode][step]`, `reading` the last look at
/// them; `settled` says whether the steady load could be held at all.
pub fn motion(reading: Option<&Reading>, record: &[Vec<f64>], step_s: f64, settled: bool) -> Motion {
    let read = reading
        .and_then(Reading::stability)
        .unwrap_or(Stability::Divergence(None));
    // A position that was not found in time may be held all the same: what moves about it decides, where it could be read.
    if !settled && reading.is_none_or(|r| !r.known) {
        let rate = match read {
            Stability::Divergence(rate) => rate,
            _ => None,
        };
        return Motion::Is(Stability::Divergence(rate));
    }
    // A record too short or too even for the question has no limit cycle to show.
    if let Stability::Oscillation { .. } = read
        && let Ok(Some(cycle)) = limit_cycle(record, step_s, &DecaySettings::default())
    {
        return Motion::LimitCycle(cycle);
    }
    Motion::Is(read)
}

/// The value, where it is a number that files can hold.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

impl Motion {
    /// What the search makes of it: small motion decides, so that a limit cycle counts by the growth that led to it.
    pub fn stability(&self) -> Stability {
        match self {
            Self::Is(stability) => *stability,
            Self::LimitCycle(c) => Stability::Oscillation {
                g: c.g_early,
                // The growth slows down on the way: what is left of it at the end bounds the error.
                g_error: 0.5 * (c.g_early - c.g_late).abs(),
                freq_hz: c.freq_hz,
            },
        }
    }

    /// In words.
    pub fn words(&self) -> String {
        let at = |rate: &Option<Rate>| rate.map_or_else(String::new, |r| format!(" at {:.3} 1/s", r.rate_1_s));
        match self {
            Self::LimitCycle(c) => format!("limit cycle at {:.2} Hz", c.freq_hz),
            Self::Is(Stability::Oscillation { g, g_error, .. }) if g.abs() <= *g_error => {
                "neutral within its error".to_owned()
            }
            Self::Is(Stability::Oscillation { g, .. }) if *g > 0.0 => "grows".to_owned(),
            Self::Is(Stability::Oscillation { .. }) => "decays".to_owned(),
            Self::Is(Stability::Divergence(rate)) => format!("diverges{}", at(rate)),
            Self::Is(Stability::Subsidence(rate)) => format!("comes to rest without oscillating{}", at(rate)),
        }
    }
}

/// Modes of a reading, each named by the structural mode that moves most in it and has no other: those with more energy choose
/// first.
pub fn named(modes: &[WatchedMode], equations: &ModalEquations) -> Vec<ModeRow> {
    let mut order: Vec<usize> = (0..modes.len()).collect();
    order.sort_by(|a, b| modes[*b].energy.total_cmp(&modes[*a].energy));
    let mut names = vec![None; modes.len()];
    for m in order {
        let part = |c: usize| {
            let (w, mass) = (equations.omega_rad_s[c], equations.generalized_mass[c]);
            mass * (w * w + modes[m].p_rad_s.norm_sqr()) * modes[m].amplitude[c].norm_sqr()
        };
        let free = (0..equations.count().min(modes[m].amplitude.len())).filter(|c| !names.contains(&Some(*c)));
        names[m] = free.max_by(|a, b| part(*a).total_cmp(&part(*b)));
    }
    modes
        .iter()
        .zip(names)
        .filter_map(|(m, name)| {
            Some(ModeRow {
                mode: name? + 1,
                g: m.g,
                g_error: finite(m.g_error),
                frequency_hz: m.freq_hz,
                energy: m.energy,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use dip_flutter::decay::{Watch, WatchSettings};
    use std::f64::consts::TAU;

    const STEP_S: f64 = 1.0 / 14.0 / 40.0;

    /// The motion of two coordinates, 10 and 38 Hz by themselves, that move as `at` says for `cycles` of 14 Hz.
    fn of(cycles: f64, at: impl Fn(f64) -> [f64; 2]) -> (Motion, Vec<ModeRow>) {
        let equations =
            ModalEquations::new(vec![10.0 * TAU, 38.0 * TAU], vec![0.0; 2], vec![1.0; 2]).expect("equations");
        let settings = WatchSettings::new(
            STEP_S,
            equations.omega_rad_s.clone(),
            equations.generalized_mass.clone(),
        );
        let mut watch = Watch::new(settings).expect("a watch");
        let mut record = vec![Vec::new(); 2];
        for n in 0..(40.0 * cycles) as usize {
            let q = at(n as f64 * STEP_S);
            record.iter_mut().zip(q).for_each(|(r, q)| r.push(q));
            watch.push(&q);
        }
        let reading = watch.reading();
        let modes = named(&reading.map_or_else(Vec::new, |r| r.modes.clone()), &equations);
        (motion(reading, &record, STEP_S, true), modes)
    }

    fn wave(hz: f64, g: f64, t: f64) -> f64 {
        (0.5 * g * TAU * hz * t).exp() * (TAU * hz * t).sin()
    }

    #[test]
    fn modes_take_the_names_of_the_coordinates_that_move_most_in_them() {
        let (motion, modes) = of(2.0, |t| {
            let (low, high) = (wave(13.0, 0.02, t), 0.3 * wave(36.0, -0.08, t));
            [low + 0.1 * high, 0.4 * low + high]
        });
        assert!(
            matches!(motion, Motion::Is(Stability::Oscillation { g, .. }) if (g - 0.02).abs() < 1e-4),
            "{motion:?}"
        );
        assert_eq!(motion.words(), "grows");
        let names: Vec<(usize, f64)> = modes.iter().map(|m| (m.mode, m.frequency_hz.round())).collect();
        assert_eq!(names, [(1, 13.0), (2, 36.0)]);
    }

    #[test]
    fn growth_without_oscillation_is_divergence_where_it_outgrows_the_oscillation() {
        let with = |rate: f64| {
            of(3.0, move |t| {
                [
                    wave(14.0, -0.05, t) + 0.05 * (rate * t).exp(),
                    0.01 * wave(38.0, -0.05, t),
                ]
            })
        };
        let (motion, _) = with(15.0);
        let Motion::Is(Stability::Divergence(Some(rate))) = motion else {
            panic!("{motion:?}")
        };
        assert!((rate.rate_1_s - 15.0).abs() < 0.5, "{rate:?}");
        assert!(matches!(with(-15.0).0, Motion::Is(Stability::Oscillation { .. })));
    }

    #[test]
    fn a_limit_cycle_counts_as_unstable() {
        // Growth at g = 0.05 up to an amplitude of 1: the logistic amplitude of a van der Pol oscillator of small damping.
        let rate = 0.5 * 0.05 * TAU * 14.0;
        let amplitude = move |t: f64| 1.0 / (1.0 + (0.05_f64.powi(-2) - 1.0) * (-2.0 * rate * t).exp()).sqrt();
        let (motion, _) = of(40.0, move |t| [amplitude(t) * (TAU * 14.0 * t).sin(), 0.0]);
        let Motion::LimitCycle(cycle) = &motion else {
            panic!("{motion:?}")
        };
        assert!((cycle.amplitude[0] - 1.0).abs() < 0.02, "{cycle:?}");
        assert!(
            matches!(motion.stability(), Stability::Oscillation { g, .. } if g > 0.01),
            "{motion:?}"
        );
        assert!(motion.words().contains("limit cycle at 14.00 Hz"));
    }

    #[test]
    fn motion_that_comes_to_rest_without_oscillating_is_stable() {
        let rests = |rate: f64| {
            of(4.0, move |t| {
                let slow = (rate * t).exp() - (-90.0 * t).exp();
                [slow, 0.1 * slow + 0.01 * wave(38.0, -0.1, t)]
            })
            .0
        };
        let motion = rests(-4.0);
        let Motion::Is(Stability::Subsidence(Some(rate))) = motion else {
            panic!("{motion:?}")
        };
        assert!((rate.rate_1_s + 4.0).abs() < 0.2, "{rate:?}");
        assert!(motion.words().starts_with("comes to rest without oscillating at -"));
        assert!(matches!(rests(4.0), Motion::Is(Stability::Divergence(Some(_)))));
    }

    #[test]
    fn a_load_that_cannot_be_held_is_divergence() {
        assert_eq!(
            motion(None, &[vec![0.0; 20]], STEP_S, false),
            Motion::Is(Stability::Divergence(None))
        );
    }
}
