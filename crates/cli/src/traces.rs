//! What figures draw: modes through speed, and mode shapes. Kept with results, so that a report needs no new solution.

use dip_flutter::{CrossingKind, Direction, FlutterSolution};
use serde::{Deserialize, Serialize};

/// Curves of all modes at one Mach number by one method.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct MachCurves {
    /// Mach number.
    pub mach: f64,
    /// Name of the method.
    pub method: String,
    /// Density at which the speeds are, kg/m^3 (a march: to which its equivalent speeds refer); none where it varies.
    #[serde(default)]
    pub density_kg_m3: Option<f64>,
    /// One for each mode; lag roots are left out.
    pub modes: Vec<ModeTrace>,
    /// Onsets of instability.
    pub crossings: Vec<Onset>,
}

/// One mode through speed.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ModeTrace {
    /// Number, from 1.
    pub mode: usize,
    /// Natural frequency, Hz.
    pub natural_frequency_hz: f64,
    /// Speeds, m/s.
    pub speed_m_s: Vec<f64>,
    /// Damping g, positive unstable.
    pub g: Vec<f64>,
    /// Frequencies, Hz.
    pub frequency_hz: Vec<f64>,
}

/// Where a mode loses its damping.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Onset {
    /// True for divergence, false for flutter.
    pub divergence: bool,
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
}

impl MachCurves {
    /// The curves of a solution.
    pub fn new(solution: &FlutterSolution) -> Self {
        let modes = solution.modes.iter().filter(|m| !m.is_lag_root).map(|m| ModeTrace {
            mode: m.mode,
            natural_frequency_hz: m.natural_freq_hz,
            speed_m_s: m.points.iter().map(|p| p.speed_m_s).collect(),
            g: m.points.iter().map(|p| p.g).collect(),
            frequency_hz: m.points.iter().map(|p| p.freq_hz).collect(),
        });
        let onsets = solution
            .crossings
            .iter()
            .filter(|c| c.direction == Direction::Onset)
            .map(|c| Onset {
                divergence: c.kind == CrossingKind::Divergence,
                speed_m_s: c.speed_m_s,
                frequency_hz: c.freq_hz,
            });
        Self {
            mach: solution.mach,
            method: solution.method.name().to_owned(),
            density_kg_m3: the_one(solution.modes.iter().flat_map(|m| &m.points).map(|p| p.density_kg_m3)),
            modes: modes.collect(),
            crossings: onsets.collect(),
        }
    }
}

/// The value that all have, if they all have the same.
fn the_one(mut values: impl Iterator<Item = f64>) -> Option<f64> {
    let first = values.next()?;
    values.all(|v| v == first).then_some(first)
}

/// Mode shapes on the structure's nodes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ModeShapes {
    /// Positions `[node]` (x, y, z), m.
    pub nodes_m: Vec<[f64; 3]>,
    /// Nodes of each element in order round it; empty where a table of modes has none.
    pub elements: Vec<Vec<usize>>,
    /// z displacement `[mode][node]`, largest 1.
    pub heave: Vec<Vec<f64>>,
    /// Natural frequencies, Hz.
    pub frequencies_hz: Vec<f64>,
}

impl ModeShapes {
    /// The shapes of a table of modes.
    pub fn new(modes: &dip_modal::Modes, elements: &[Vec<usize>]) -> Self {
        let scaled = |mode: Vec<f64>| {
            let largest = mode.iter().fold(0.0_f64, |m, v| if v.abs() > m.abs() { *v } else { m });
            if largest == 0.0 {
                mode
            } else {
                mode.iter().map(|v| v / largest).collect()
            }
        };
        Self {
            nodes_m: modes.nodes.iter().map(|n| n.position.into()).collect(),
            elements: elements.to_vec(),
            heave: modes.heave().into_iter().map(scaled).collect(),
            frequencies_hz: (0..modes.count()).map(|m| modes.freq_hz(m)).collect(),
        }
    }
}
