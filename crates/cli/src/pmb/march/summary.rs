//! What `summary.json` of a march holds, and the table on stdout.

use super::inspect::Inspection;
use super::motion::LimitCycleRow;
use super::parameter::Parameter;
use crate::progress::Seconds;
use crate::stamp::Stamp;
use dip_pmb::march::{MarchSeconds, MarchStop};
use serde::{Deserialize, Serialize};

/// A mode as one run shows it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModeRow {
    /// Structural mode that moves most in it, from 1; each has one mode of the flow and the structure at most.
    pub mode: usize,
    /// Damping, positive growing.
    pub g: f64,
    /// Its standard error; none where it was read only once.
    pub g_error: Option<f64>,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Part of the record's mean energy.
    pub energy: f64,
}

/// A run at one stream.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrialRow {
    /// Value that the search varies.
    pub at: f64,
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Altitude, m, where that is varied.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub altitude_m: Option<f64>,
    /// What the motion does, in words.
    pub motion: String,
    /// Damping of the least stable mode, positive growing; none where the wing diverges or nothing could be read.
    pub g: Option<f64>,
    /// Its standard error.
    pub g_error: Option<f64>,
    /// Its frequency, Hz.
    pub frequency_hz: Option<f64>,
    /// All modes that hold a part of the energy, least stable first.
    pub modes: Vec<ModeRow>,
    /// True if the wing moves away without oscillating.
    pub diverges: bool,
    /// Rate of a motion that does not oscillate, above zero where it goes away, 1/s, where that could be read.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub rate_1_s: Option<f64>,
    /// Its standard error, 1/s.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub rate_error_1_s: Option<f64>,
    /// False if the position in which the structure holds the steady load was not found: the motion is about another one.
    #[serde(default = "yes")]
    pub settled: bool,
    /// What moved beside the oscillations when the run ended, if it was seen neither to die out nor to grow.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub drift: Option<DriftRow>,
    /// The limit cycle that the motion has grown to, if it has.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub limit_cycle: Option<LimitCycleRow>,
    /// Why the run ended.
    pub stop: MarchStop,
    /// Time steps.
    pub steps: usize,
    /// Steps that did not converge.
    pub not_converged: usize,
    /// Pseudo steps.
    pub iterations: usize,
    /// Products with the flow's operator.
    pub products: usize,
    /// Work of the pressure, J.
    pub work_j: f64,
    /// Lift coefficient of the mean position.
    pub mean_cl: f64,
    /// Largest displacement of the mean position, m.
    pub mean_displacement_m: f64,
    /// Name of its files.
    pub name: String,
    /// Seconds.
    pub seconds: Seconds,
    /// Where its wall time went.
    pub cost: Cost,
}

/// Runs of before the key was there.
fn yes() -> bool {
    true
}

/// A motion without oscillation that may yet turn out to be divergence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DriftRow {
    /// Rate at which it grew in the second half of the run, 1/s.
    pub rate_1_s: f64,
    /// Its standard error, 1/s; none where the motion changed its sign.
    pub rate_error_1_s: Option<f64>,
    /// Its part of the elastic energy in the last quarter of the run.
    pub share: f64,
}

/// Where the wall time of runs went; the parts do not overlap.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// The mean position under load, before the run.
    pub mean_position_s: f64,
    /// Residuals of the flow, those in products with its operator included.
    pub residual_s: f64,
    /// First-order Jacobians.
    pub jacobian_s: f64,
    /// Their factorizations.
    pub factorization_s: f64,
    /// GCG without the residuals in its products.
    pub gcg_s: f64,
    /// Deformation of the grid, its metrics and swept volumes.
    pub deformation_s: f64,
    /// Pressure to forces on the modes, and the steps of the modal equations.
    pub transfer_s: f64,
    /// Forces on the walls and the recording.
    pub recording_s: f64,
    /// Reading the damping.
    pub identification_s: f64,
    /// Restart files.
    pub restart_s: f64,
    /// Time derivative, first guesses, norms, starting.
    pub rest_s: f64,
}

impl Cost {
    /// The cost of a run whose observer took `identification_s` to read the damping.
    pub fn new(run: &MarchSeconds, mean_position_s: f64, identification_s: f64) -> Self {
        Self {
            mean_position_s,
            residual_s: run.residual,
            jacobian_s: run.jacobian,
            factorization_s: run.factorization,
            gcg_s: run.gcg,
            deformation_s: run.deformation,
            transfer_s: run.transfer,
            recording_s: run.observer - identification_s,
            identification_s,
            restart_s: run.restart,
            rest_s: run.rest,
        }
    }

    fn parts(&self) -> [(&'static str, f64); 11] {
        [
            ("mean position", self.mean_position_s),
            ("residual", self.residual_s),
            ("Jacobian", self.jacobian_s),
            ("factorization", self.factorization_s),
            ("GCG", self.gcg_s),
            ("deformation", self.deformation_s),
            ("transfer and structure", self.transfer_s),
            ("recording", self.recording_s),
            ("identification", self.identification_s),
            ("restart files", self.restart_s),
            ("rest", self.rest_s),
        ]
    }

    /// The sum of many.
    pub fn sum<'a>(all: impl IntoIterator<Item = &'a Self>) -> Self {
        all.into_iter().fold(Self::default(), |a, b| Self {
            mean_position_s: a.mean_position_s + b.mean_position_s,
            residual_s: a.residual_s + b.residual_s,
            jacobian_s: a.jacobian_s + b.jacobian_s,
            factorization_s: a.factorization_s + b.factorization_s,
            gcg_s: a.gcg_s + b.gcg_s,
            deformation_s: a.deformation_s + b.deformation_s,
            transfer_s: a.transfer_s + b.transfer_s,
            recording_s: a.recording_s + b.recording_s,
            identification_s: a.identification_s + b.identification_s,
            restart_s: a.restart_s + b.restart_s,
            rest_s: a.rest_s + b.rest_s,
        })
    }

    /// One line: parts of the whole.
    pub fn words(&self) -> String {
        let parts = self.parts();
        let all: f64 = parts.iter().map(|p| p.1).sum();
        let words: Vec<String> = parts
            .iter()
            .filter(|p| p.1 > 0.0)
            .map(|(name, s)| format!("{name} {:.1} %", 100.0 * s / all.max(f64::MIN_POSITIVE)))
            .collect();
        format!("where {all:.1} s went: {}", words.join(", "))
    }
}

/// A flutter point as scripts read it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FlutterPoint {
    /// Mach number.
    pub mach: f64,
    /// What was varied: `density`, `speed` or `altitude`.
    pub parameter: String,
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Standard error of the varied quantity over it (of the density in a search of the altitude).
    pub parameter_error: f64,
    /// Standard error of the speed index over it.
    pub speed_index_error: f64,
    /// Always `march`.
    pub method: String,
    /// Speed, m/s.
    pub flutter_speed_m_s: f64,
    /// Altitude of the matched point, m.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub altitude_m: Option<f64>,
    /// Frequency, Hz.
    pub flutter_frequency_hz: f64,
    /// Structural mode that moves most in what flutters, from 1; none where no run was near enough to tell.
    #[serde(default)]
    pub mode: Option<usize>,
    /// Speed index; none without `[speed_index]`.
    pub flutter_speed_index: Option<f64>,
    /// Frequency over omega_alpha.
    pub frequency_ratio: Option<f64>,
    /// omega_alpha of the index, rad/s.
    pub omega_alpha_rad_s: Option<f64>,
    /// Mass of the index, kg.
    pub mass_kg: Option<f64>,
    /// True if runs on both sides hold the point.
    pub bracketed: bool,
    /// Wall seconds, the steady flow included.
    pub time_s: f64,
}

/// A point of divergence as scripts read it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DivergencePoint {
    /// Mach number.
    pub mach: f64,
    /// What was varied: `density`, `speed` or `altitude`.
    pub parameter: String,
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Altitude of the matched point, m.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub altitude_m: Option<f64>,
    /// Dynamic pressure, Pa.
    pub dynamic_pressure_pa: f64,
    /// Standard error of the varied quantity over it (of the density in a search of the altitude); half the distance of the runs
    /// next to the point where their rates say no more.
    pub parameter_error: f64,
    /// Dynamic pressure of the runs next to it, Pa: stable at the first, divergent at the second.
    pub between: [f64; 2],
    /// Always `march`.
    pub method: String,
    /// Wall seconds, the steady flow included.
    pub time_s: f64,
}

/// What `summary.json` holds.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Summary {
    pub(super) command: String,
    /// Stamp.
    pub stamp: Stamp,
    pub(super) settings: String,
    /// Why it ended.
    pub stop_reason: String,
    pub(super) mach: f64,
    /// Speed of the first run's stream, m/s.
    pub speed_m_s: f64,
    /// Number of cells.
    pub cells: usize,
    pub(super) mesh_hash: String,
    /// Natural frequencies, Hz.
    pub natural_frequencies_hz: Vec<f64>,
    pub(super) time_step_s: f64,
    /// What was found when the transfer to the wall was inspected.
    pub transfer: Inspection,
    /// The flutter point, where one was found; a list as `dlm flutter` has it.
    pub flutter: Vec<FlutterPoint>,
    /// Where the wing diverges, if that comes first.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub divergence: Option<DivergencePoint>,
    /// Runs, in the order in which they were made.
    pub trials: Vec<TrialRow>,
    /// What to look at.
    pub warnings: Vec<String>,
    /// Seconds for each stage.
    pub stages: Vec<(String, Seconds)>,
    /// Where the wall time of the runs went, all together.
    pub cost: Cost,
    /// Seconds in all.
    pub total: Seconds,
}

/// The runs and the point as a text table.
pub fn text(summary: &Summary, parameter: Parameter) -> String {
    let altitude = matches!(parameter, Parameter::Altitude { .. });
    let mut text = format!(
        "{:>14}  {:>9}{}  {:>9}  {:>9}  {:>9}  {:>6}  {:>9}  {}\n",
        "density kg/m^3",
        "speed m/s",
        if altitude { "  altitude m" } else { "" },
        "g",
        "+-",
        "freq. Hz",
        "steps",
        "CPU s",
        "motion; end"
    );
    let number = |v: Option<f64>, digits: usize| v.map_or_else(|| "-".to_owned(), |v| format!("{v:.digits$}"));
    for t in &summary.trials {
        let end = match &t.stop {
            MarchStop::Enough => "known".to_owned(),
            MarchStop::AllSteps => "all steps".to_owned(),
            MarchStop::Interrupted => "interrupted".to_owned(),
            MarchStop::RanAway(words) => words.clone(),
        };
        let height = t.altitude_m.map_or_else(String::new, |h| format!("  {h:>10.0}"));
        text.push_str(&format!(
            "{:>14.5}  {:>9.3}{height}  {:>9}  {:>9}  {:>9}  {:>6}  {:>9.2}  {}; {end}\n",
            t.density_kg_m3,
            t.speed_m_s,
            number(t.g, 5),
            number(t.g_error, 5),
            number(t.frequency_hz, 3),
            t.steps,
            t.seconds.cpu_s,
            t.motion,
        ));
    }
    if let Some(d) = &summary.divergence {
        text.push_str(&format!(
            "divergence at Mach {}: density {:.5} kg/m^3, {:.2} m/s{} ({} +- {:.2} %), dynamic pressure {:.1} Pa\n",
            d.mach,
            d.density_kg_m3,
            d.speed_m_s,
            d.altitude_m
                .map_or_else(String::new, |h| format!(", altitude {h:.0} m")),
            if altitude { "density" } else { parameter.name() },
            100.0 * d.parameter_error,
            d.dynamic_pressure_pa,
        ));
    }
    match summary.flutter.first() {
        Some(p) => text.push_str(&format!(
            "flutter at Mach {}: density {:.5} kg/m^3, {:.2} m/s{} ({} +- {:.1} %), {:.3} Hz{}\n",
            p.mach,
            p.density_kg_m3,
            p.flutter_speed_m_s,
            p.altitude_m
                .map_or_else(String::new, |h| format!(", altitude {h:.0} m")),
            if altitude { "density" } else { parameter.name() },
            100.0 * p.parameter_error,
            p.flutter_frequency_hz,
            p.flutter_speed_index
                .map_or_else(String::new, |i| format!(", speed index {i:.4}"))
        )),
        None => text.push_str(&format!("{}\n", summary.stop_reason)),
    }
    text
}
