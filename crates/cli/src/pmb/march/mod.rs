//! `pmb march`: flow and structure marched together, once or until the flutter point is found.

mod files;
mod listen;

use crate::assemble::references::{Unsteady, references};
use crate::assemble::{deformation, flow, grid, modes, surface};
use crate::exit::{Done, Stop};
use crate::options::Common;
use crate::output::{self, RunFolder};
use crate::pmb::logbook::{self, Logbook};
use crate::pmb::steady::watch::Watch;
use crate::progress::{Seconds, Timer, watch_interrupts};
use crate::stamp::{Fingerprint, Stamp};
use dip_case::Document;
use dip_case::file::{CouplingKind, MarchFile, SteadyFile, StructureScheme, TimeSchemeKind};
use dip_flutter::SpeedIndexReference;
use dip_flutter::decay::{self, WatchSettings};
use dip_flutter::search::{Neutral, Search, SearchSettings, SearchStep, Stability, Trial};
use dip_modal::{ModalEquations, StepScheme};
use dip_pmb::couple::{Coupling, Stream};
use dip_pmb::dual_time::{DualTimeSettings, TimeScheme};
use dip_pmb::march::mean::{self, DeflectionSettings, MeanFlow};
use dip_pmb::march::{MarchSettings, MarchStop, Wing};
use dip_record::{CoordinateKind, Law, MotionCoordinate, Provenance, Setup, StructuralMode};
use listen::Listener;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Fingerprint of what a run was begun from.
const INPUTS: &str = "inputs.sha256";
/// Finished densities of a search.
const TRIALS: &str = "trials.json";

/// Flow and structure marched together: one run, or with `[search]` the flutter point.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The case file (.toml)
    case: PathBuf,
    /// Go on with an interrupted or killed run or search; finished densities are kept
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    common: Common,
}

const EXAMPLES: &str = "Examples:
  pmb march cases/agard445/march.toml
  pmb march cases/agard445/march.toml --set flow.mach=0.96 --set 'flow.speed=\"309.01 m/s\"' --set 'flow.density=\"0.06339 kg/m^3\"' --out runs/m096
  pmb march cases/agard445/march.toml --resume

Exit codes: 0 done; 1 failed; 2 bad arguments or input; 3 done, but no flutter point was found or steps did not converge;
130 interrupted, --resume goes on.";

/// A run at one density.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrialRow {
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Damping of the least stable mode, positive growing; none where the wing diverges or nothing could be read.
    pub g: Option<f64>,
    /// Its standard error.
    pub g_error: Option<f64>,
    /// Its frequency, Hz.
    pub frequency_hz: Option<f64>,
    /// True if the wing moves away without oscillating.
    pub diverges: bool,
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
}

/// A flutter point as scripts read it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FlutterPoint {
    /// Mach number.
    pub mach: f64,
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Standard error of the density over it.
    pub density_error: f64,
    /// Always `march`.
    pub method: String,
    /// Speed, m/s.
    pub flutter_speed_m_s: f64,
    /// Frequency, Hz.
    pub flutter_frequency_hz: f64,
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

/// What `summary.json` holds.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Summary {
    command: String,
    /// Stamp.
    pub stamp: Stamp,
    settings: String,
    /// Why it ended.
    pub stop_reason: String,
    mach: f64,
    /// Speed of the stream, m/s.
    pub speed_m_s: f64,
    /// Number of cells.
    pub cells: usize,
    mesh_hash: String,
    /// Natural frequencies, Hz.
    pub natural_frequencies_hz: Vec<f64>,
    time_step_s: f64,
    /// The flutter point, where one was found; a list as `dlm flutter` has it.
    pub flutter: Vec<FlutterPoint>,
    /// Runs, in the order in which they were made.
    pub trials: Vec<TrialRow>,
    /// What to look at.
    pub warnings: Vec<String>,
    /// Seconds for each stage.
    pub stages: Vec<(String, Seconds)>,
    /// Seconds in all.
    pub total: Seconds,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    args.common.start()?;
    let document = args.common.document(&args.case)?;
    let folder = args.common.folder(&args.case);
    let summary = compute(&document, &folder, args.resume, &args.common)?;
    if args.common.json {
        output::print(&output::json(&summary)?);
    } else {
        output::print(&text(&summary));
        tracing::info!("results in {}", folder.display());
    }
    Ok(if summary.warnings.is_empty() {
        Done::Clean
    } else {
        Done::LookAt
    })
}

/// A case, read and checked, with all that does not depend on density.
struct March<'a> {
    document: &'a Document,
    file: MarchFile,
    folder: RunFolder,
    common: &'a Common,
    grid: dip_grid::MultiBlock,
    mesh_hash: String,
    stamp: Stamp,
    wing: Wing,
    settings: MarchSettings,
    speed_m_s: f64,
    mean: MeanFlow,
    resume: bool,
}

/// The steady part of a case.
fn steady_file(file: &MarchFile) -> SteadyFile {
    SteadyFile {
        flow: file.flow.clone(),
        mesh: file.mesh.clone(),
        reference: Some(file.reference.clone()),
        steady: file.steady.clone(),
        patch: file.patch.clone(),
        cuts: dip_case::file::CutsTable::default(),
    }
}

fn stamp(document: &Document, file: &MarchFile, mesh_hash: &str) -> Stamp {
    let mut fingerprint = Fingerprint::new();
    fingerprint.document(document).text(mesh_hash);
    modes::fingerprint(document, &file.modes, &mut fingerprint);
    fingerprint.stamp()
}

/// A finished march of the same inputs in `path`, if there is one.
///
/// # Errors
/// What is wrong in the case.
pub fn kept(document: &Document, path: &Path) -> Result<Option<Summary>, Stop> {
    let Ok(text) = std::fs::read_to_string(path.join(output::SUMMARY)) else {
        return Ok(None);
    };
    let file: MarchFile = document.load()?;
    let mesh = grid::from_case(document, &file.mesh)?;
    let stamp = stamp(document, &file, &mesh.hash);
    let summary: Option<Summary> = serde_json::from_str(&text).ok();
    Ok(summary.filter(|s| s.stamp.fingerprint == stamp.fingerprint))
}

/// Runs a case and writes its results to `path`.
///
/// # Errors
/// What is wrong in the case, or what a solver fails with; finished densities and restart files stay.
pub fn compute(document: &Document, path: &Path, resume: bool, common: &Common) -> Result<Summary, Stop> {
    watch_interrupts();
    let total = Timer::start();
    let mut stages = Vec::new();
    let march = March::read(document, path, resume, common, &mut stages)?;
    let index = match &march.file.speed_index {
        Some(table) => Some(crate::frequency::reference(document, table, None)?),
        None => None,
    };
    let (trials, found, stop_reason) = if march.file.search.is_some() {
        march.search(&mut stages)?
    } else {
        let density = march.density()?;
        let trial = march.trial(density, 1, None)?;
        stages.push((format!("march, {density:.5} kg/m^3"), trial.seconds));
        (vec![trial], None, "single run".to_owned())
    };
    let (document, file) = (march.document, &march.file);
    let mut warnings = Vec::new();
    if march.file.search.is_some() && found.is_none() {
        warnings.push(format!("no flutter point: {stop_reason}"));
    }
    for t in &trials {
        if t.not_converged > 0 {
            warnings.push(format!(
                "density {:.5} kg/m^3: {} of {} time steps did not converge",
                t.density_kg_m3, t.not_converged, t.steps
            ));
        }
        if let MarchStop::RanAway(words) = &t.stop {
            tracing::info!("density {:.5} kg/m^3: {words}", t.density_kg_m3);
        }
    }
    for warning in &warnings {
        tracing::warn!("{warning}");
    }
    let title = format!("Mach {}, {} m/s", file.flow.mach, march.speed_m_s);
    files::damping(&march.folder, &title, &trials, found.map(|f| (f.at, f.freq_hz)))?;
    let point = found.map(|f| march.point(&f, index.as_ref(), total.seconds().wall_s));
    let summary = Summary {
        command: "pmb march".to_owned(),
        stamp: march.stamp.clone(),
        settings: document.text().to_owned(),
        stop_reason,
        mach: file.flow.mach,
        speed_m_s: march.speed_m_s,
        cells: march.grid.cell_count(),
        mesh_hash: march.mesh_hash.clone(),
        natural_frequencies_hz: march
            .wing
            .equations
            .omega_rad_s
            .iter()
            .map(|w| w / std::f64::consts::TAU)
            .collect(),
        time_step_s: march.settings.step_s,
        flutter: point.into_iter().collect(),
        trials,
        warnings,
        stages,
        total: total.seconds(),
    };
    march.folder.write_json(output::SUMMARY, &summary)?;
    Ok(summary)
}

impl<'a> March<'a> {
    fn read(
        document: &'a Document,
        path: &Path,
        resume: bool,
        common: &'a Common,
        stages: &mut Vec<(String, Seconds)>,
    ) -> Result<Self, Stop> {
        let file: MarchFile = document.load()?;
        let steady = steady_file(&file);
        let mut flow_settings = flow::settings(document, &steady)?;
        let (Some(speed), Some(_)) = (file.flow.speed, file.flow.density) else {
            let help = "speed = \"231.37 m/s\" and density = \"0.208 kg/m^3\"";
            return Err(document
                .error("flow", "a march needs the stream's speed and density", help)
                .into());
        };
        let timer = Timer::start();
        let mesh = grid::from_case(document, &file.mesh)?;
        flow::on_grid(&mut flow_settings, document, &steady, &mesh.grid)?;
        flow_settings.solver.orders = file.steady.orders.unwrap_or(6.0);
        stages.push(("mesh".to_owned(), timer.seconds()));

        let timer = Timer::start();
        let structure = modes::from_table(document, &file.modes)?.modes;
        let count = structure.count();
        let damping = file.march.damping.unwrap_or(0.0);
        let refuse = |e: &dyn std::fmt::Display| -> Stop {
            document
                .error("modes", e.to_string(), "see docs/march.md for the keys")
                .into()
        };
        let equations = ModalEquations::from_modes(&structure, count, damping).map_err(|e| refuse(&e))?;
        let fields = deformation::grid_modes(&mesh.grid, &structure, count)?;
        let wing = Wing::new(equations, &fields, &mesh.grid).map_err(|e| flow::explain(document, e))?;
        stages.push(("structure on the grid".to_owned(), timer.seconds()));

        let stamp = stamp(document, &file, &mesh.hash);
        let folder = RunFolder::open(path, &stamp, common.force || resume)?;
        // What is there is gone on with only if it was made from the same inputs.
        let resume = resume && std::fs::read_to_string(path.join(INPUTS)).is_ok_and(|f| f == stamp.fingerprint);
        folder.write(INPUTS, stamp.fingerprint.as_bytes())?;
        let settings = settings(document, &file, flow_settings, &wing)?;
        let timer = Timer::start();
        let kept = folder.path().join("mean.pmb");
        let mean = match MeanFlow::read(&kept, &mesh.grid) {
            Ok(mean) if resume => mean,
            _ => {
                let mut watch = Watch::new(common.quiet, settings.steady.solver.orders);
                let cancel = watch.cancel();
                let mean = mean::rigid(&settings.steady, &mesh.grid, count, &mut watch, &cancel);
                watch.finish();
                let Some(mean) = mean.map_err(|e| flow::explain(document, e))? else {
                    return Err(Stop::Interrupted(
                        "the steady flow was not finished; --resume starts it anew".to_owned(),
                    ));
                };
                mean.write(&kept).map_err(|e| flow::explain(document, e))?;
                mean
            }
        };
        stages.push(("steady flow".to_owned(), timer.seconds()));
        if !mean.stop.is_converged() {
            tracing::warn!(
                "the steady start is not converged ({:?}): look at it by `pmb steady`",
                mean.stop
            );
        }
        Ok(Self {
            document,
            file,
            folder,
            common,
            grid: mesh.grid,
            mesh_hash: mesh.hash,
            stamp,
            wing,
            settings,
            speed_m_s: speed.0,
            mean,
            resume,
        })
    }

    fn density(&self) -> Result<f64, Stop> {
        self.file.flow.density.map(|d| d.0).ok_or_else(|| {
            self.document
                .error("flow", "no density", "density = \"0.208 kg/m^3\"")
                .into()
        })
    }

    /// Runs densities until the point is known; finished ones are read from an earlier search.
    fn search(&self, stages: &mut Vec<(String, Seconds)>) -> Result<(Vec<TrialRow>, Option<Neutral>, String), Stop> {
        let table = self.file.search.clone().unwrap_or_default();
        let first = self.density()?;
        let settings = SearchSettings {
            range: [
                table.from.map_or(0.2 * first, |d| d.0),
                table.to.map_or(5.0 * first, |d| d.0),
            ],
            first,
            tolerance: table.tolerance.unwrap_or(0.01),
            most_runs: table.runs.unwrap_or(8),
        };
        let refuse = |e: dip_flutter::FlutterError| -> Stop {
            self.document
                .error("search", e.to_string(), "leave the key out for its default")
                .into()
        };
        let mut search = Search::new(settings, Vec::new()).map_err(refuse)?;
        let mut rows: Vec<TrialRow> = Vec::new();
        let older: Vec<TrialRow> = if self.resume {
            std::fs::read_to_string(self.folder.path().join(TRIALS))
                .ok()
                .and_then(|t| serde_json::from_str::<(String, Vec<TrialRow>)>(&t).ok())
                .filter(|(fingerprint, _)| *fingerprint == self.stamp.fingerprint)
                .map_or_else(Vec::new, |(_, rows)| rows)
        } else {
            Vec::new()
        };
        let (found, reason) = loop {
            let density = match search.next() {
                SearchStep::Run(density) => density,
                SearchStep::Found(point) => break (Some(point), "found".to_owned()),
                SearchStep::StableThroughout => break (None, "stable up to the end of the range".to_owned()),
                SearchStep::UnstableThroughout => break (None, "unstable down to the end of the range".to_owned()),
                SearchStep::Divergence([a, b]) => {
                    break (None, format!("divergence between {a:.5} and {b:.5} kg/m^3 comes first"));
                }
                SearchStep::OutOfRuns(best) => {
                    break (
                        best,
                        "all runs were used, or the next would repeat one; the best estimate is given".to_owned(),
                    );
                }
            };
            let number = rows.len() + 1;
            // The next density follows from the finished ones alone: an older search has asked for the same.
            let row = match older.get(rows.len()).filter(|r| r.density_kg_m3 == density) {
                Some(row) => {
                    tracing::info!("density {density:.5} kg/m^3: kept");
                    row.clone()
                }
                None => self.trial(density, number, search.damping_accuracy())?,
            };
            stages.push((format!("march {number}, {density:.5} kg/m^3"), row.seconds));
            let stability = match (row.diverges, row.g, row.g_error, row.frequency_hz) {
                (false, Some(g), Some(g_error), Some(freq_hz)) => Stability::Oscillation { g, g_error, freq_hz },
                _ => Stability::Divergence,
            };
            rows.push(row);
            let kept = (self.stamp.fingerprint.clone(), rows.clone());
            self.folder.write_json(TRIALS, &kept)?;
            search.add(Trial { at: density, stability }).map_err(refuse)?;
        };
        Ok((rows, found, reason))
    }

    /// One run at one density, until its damping is known to `accuracy` where the usual one would not do.
    fn trial(&self, density: f64, number: usize, accuracy: Option<f64>) -> Result<TrialRow, Stop> {
        let timer = Timer::start();
        let name = format!("march_{number}");
        let stream = Stream {
            speed_m_s: self.speed_m_s,
            density_kg_m3: density,
            length_m: 1.0,
        };
        let explain = |e| flow::explain(self.document, e);
        let watch = Watch::new(self.common.quiet, self.settings.time.orders);
        let cancel = watch.cancel();
        let stopped = |what: &str| {
            Stop::Interrupted(format!(
                "{what}; finished densities are in {}, --resume goes on",
                self.folder.path().display()
            ))
        };
        let deflection = DeflectionSettings::default();
        let mean = mean::deflected(
            &self.settings.steady,
            &deflection,
            &self.grid,
            &self.wing,
            &stream,
            &self.mean,
            &cancel,
        )
        .map_err(explain)?
        .ok_or_else(|| stopped("the mean position was not finished"))?;
        if mean.exchanges > 0 {
            tracing::info!(
                "density {density:.5} kg/m^3: static deflection {:.3} mm after {} exchanges, CL {:.5}",
                1e3 * self.wing.displacement(&mean.q),
                mean.exchanges,
                mean.loads.total.cl
            );
        }
        let restart = self.folder.path().join(format!("{name}.pmb"));
        let going_on = self.resume && restart.exists();
        let settings = MarchSettings {
            restart: Some(restart),
            resume: going_on,
            ..self.settings.clone()
        };
        let equations = &self.wing.equations;
        let mut reading = WatchSettings::new(
            settings.step_s,
            equations.omega_rad_s.clone(),
            equations.generalized_mass.clone(),
        );
        reading.accuracy = accuracy.map_or(reading.accuracy, |a| a.min(reading.accuracy));
        let damping =
            decay::Watch::new(reading).map_err(|e| Stop::failed(e.to_string(), "change march.steps_per_cycle"))?;
        let recording = self.folder.path().join(format!("{name}.mcap"));
        let mut listener = Listener {
            watch,
            damping,
            mean: mean.q.clone(),
            all_cycles: self.file.march.all_cycles,
            steps: settings.steps,
            label: format!("density {density:.5} kg/m^3"),
            log: Logbook::new(recording, self.setup(density), settings.checkpoint_steps),
        };
        let result = dip_pmb::march::run(&settings, &self.grid, &self.wing, stream, &mean, &mut listener, &cancel);
        listener.watch.finish();
        let reason = match &result {
            Ok(r) => format!("{:?}", r.stop),
            Err(e) => format!("failed: {e}"),
        };
        let closed = listener.log.finish(&reason);
        let result = result.map_err(explain)?;
        closed.map_err(|e| Stop::failed(e, "check the disk's space; `dip doctor` says what can be saved"))?;
        let title = format!("Mach {}, density {density:.5} kg/m³", self.file.flow.mach);
        files::modes(&self.folder, &name, &title, &result.states)?;
        if result.stop == MarchStop::Interrupted {
            return Err(stopped(&format!(
                "{} time steps were taken at {density:.5} kg/m^3",
                result.states.len() - 1
            )));
        }
        let reading = listener.damping.reading();
        let mode = reading.and_then(|r| r.modes.first());
        Ok(TrialRow {
            density_kg_m3: density,
            g: mode.map(|m| m.g),
            g_error: mode.map(|m| m.g_error),
            frequency_hz: mode.map(|m| m.freq_hz),
            diverges: mode.is_none() || !mean.settled,
            stop: result.stop,
            steps: result.states.len() - 1,
            not_converged: result.not_converged,
            iterations: result.iterations,
            products: result.products,
            work_j: result.work_j,
            mean_cl: mean.loads.total.cl,
            mean_displacement_m: self.wing.displacement(&mean.q),
            name,
            seconds: timer.seconds(),
        })
    }

    /// What a recording at a density says before the first step.
    fn setup(&self, density: f64) -> Setup {
        let s = &self.settings;
        let motion = self
            .wing
            .shapes
            .iter()
            .enumerate()
            .map(|(m, shape)| MotionCoordinate {
                name: format!("mode {}", m + 1),
                kind: CoordinateKind::Mode,
                law: Law::Free,
                shape_m: surface::at_walls(&self.grid, shape),
                mode: Some(StructuralMode {
                    number: u32::try_from(m + 1).unwrap_or(u32::MAX),
                    omega_rad_s: self.wing.equations.omega_rad_s[m],
                    generalized_mass_kg: self.wing.equations.generalized_mass[m],
                    damping_ratio: self.wing.equations.damping_ratio[m],
                }),
            })
            .collect();
        Setup {
            references: references(
                &self.file.reference,
                &self.grid,
                &s.steady,
                &Unsteady {
                    speed_m_s: self.speed_m_s,
                    density_kg_m3: density,
                    step_s: s.step_s,
                    steps_per_cycle: None,
                    cycles: None,
                    orders: s.time.orders,
                },
            ),
            motion,
            surface: surface::patches(&self.grid),
            provenance: Provenance {
                program: "pmb march".to_owned(),
                version: format!("{} ({})", self.stamp.version, self.stamp.commit),
                case_name: self.document.file().display().to_string(),
                case_text: self.document.text().to_owned(),
                mesh_sha256: self.mesh_hash.clone(),
            },
        }
    }

    fn point(&self, found: &Neutral, index: Option<&SpeedIndexReference>, time_s: f64) -> FlutterPoint {
        FlutterPoint {
            mach: self.file.flow.mach,
            density_kg_m3: found.at,
            density_error: found.error / found.at,
            method: "march".to_owned(),
            flutter_speed_m_s: self.speed_m_s,
            flutter_frequency_hz: found.freq_hz,
            flutter_speed_index: index.map(|r| r.speed_index(self.speed_m_s, found.at)),
            frequency_ratio: index.map(|r| r.frequency_ratio(found.freq_hz)),
            omega_alpha_rad_s: index.map(|r| r.omega_alpha_rad_s),
            mass_kg: index.map(|r| r.mass_kg),
            bracketed: found.bracketed,
            time_s,
        }
    }
}

/// Steps, start and schemes of a case.
fn settings(
    document: &Document,
    file: &MarchFile,
    steady: dip_pmb::settings::SteadySettings,
    wing: &Wing,
) -> Result<MarchSettings, Stop> {
    let t = &file.march;
    let omega = &wing.equations.omega_rad_s;
    let wrong = |key: &str, message: String, help: &str| -> Result<MarchSettings, Stop> {
        Err(document.error(key, message, help).into())
    };
    let lowest = omega.iter().copied().filter(|w| *w > 0.0).fold(f64::INFINITY, f64::min);
    let frequency = t.frequency.map_or(1.5 * lowest, |f| f.0);
    if !frequency.is_finite() || frequency <= 0.0 {
        return wrong(
            "march.frequency",
            format!("{frequency} rad/s: needed a positive value"),
            "frequency = \"14 Hz\", about that of flutter",
        );
    }
    let (per_cycle, cycles) = (t.steps_per_cycle.unwrap_or(40), t.cycles.unwrap_or(8));
    if !(8..=100_000).contains(&per_cycle) || !(1..=100_000).contains(&cycles) {
        return wrong(
            "march",
            format!("{per_cycle} steps per cycle and {cycles} cycles: needed 8 to 100000 and 1 to 100000"),
            "leave them out for 40 and 8",
        );
    }
    let start = t.start_mode.unwrap_or(1);
    if start == 0 || start > omega.len() {
        let message = format!("mode {start}: there are {}", omega.len());
        return wrong("march.start_mode", message, "modes count from 1");
    }
    let semispan = file.reference.semispan.map_or(2.0 * file.reference.chord.0, |s| s.0);
    let displacement = t.start_displacement.map_or(1e-3 * semispan, |d| d.0);
    if displacement == 0.0 || !displacement.is_finite() {
        let message = format!("{displacement} m: needed a length other than zero");
        return wrong(
            "march.start_displacement",
            message,
            "leave it out for a thousandth of the semispan",
        );
    }
    // A free mode that starts with this rate reaches the displacement after a quarter of its period.
    let mut start_rate_1_s = vec![0.0; omega.len()];
    start_rate_1_s[start - 1] = displacement * omega[start - 1].max(0.1 * frequency) / wing.largest[start - 1];
    let defaults = DualTimeSettings::default();
    Ok(MarchSettings {
        steady,
        time: DualTimeSettings {
            scheme: match file.time.scheme {
                TimeSchemeKind::Bdf2 => TimeScheme::Bdf2,
                TimeSchemeKind::Bdf1 => TimeScheme::Bdf1,
            },
            // 1.5 orders move flutter points by less than the search's tolerance.
            orders: file.time.orders.unwrap_or(1.5),
            max_iterations: file.time.iterations.unwrap_or(defaults.max_iterations),
            ..defaults
        },
        step_s: std::f64::consts::TAU / frequency / per_cycle as f64,
        steps: per_cycle * cycles,
        scheme: match t.scheme {
            StructureScheme::StateTransition => StepScheme::StateTransition,
            StructureScheme::RungeKutta => StepScheme::RungeKutta2,
            StructureScheme::Newmark => StepScheme::Newmark,
        },
        coupling: match t.coupling {
            CouplingKind::Tight => Coupling::Tight,
            CouplingKind::Loose => Coupling::Loose,
        },
        exchange_tolerance: 1e-6,
        start_rate_1_s,
        largest_displacement: 0.2,
        restart: None,
        resume: false,
        checkpoint_steps: file
            .time
            .checkpoint
            .unwrap_or(20)
            .next_multiple_of(logbook::safe_steps()),
    })
}

fn text(summary: &Summary) -> String {
    let mut text = format!(
        "{:>14}  {:>9}  {:>9}  {:>9}  {:>6}  {:>9}  {}\n",
        "density kg/m^3", "g", "+-", "freq. Hz", "steps", "CPU s", "end"
    );
    let number = |v: Option<f64>, digits: usize| v.map_or_else(|| "-".to_owned(), |v| format!("{v:.digits$}"));
    for t in &summary.trials {
        let end = match &t.stop {
            MarchStop::Enough => "damping known".to_owned(),
            MarchStop::AllSteps => "all steps".to_owned(),
            MarchStop::Interrupted => "interrupted".to_owned(),
            MarchStop::RanAway(words) => words.clone(),
        };
        text.push_str(&format!(
            "{:>14.5}  {:>9}  {:>9}  {:>9}  {:>6}  {:>9.2}  {end}\n",
            t.density_kg_m3,
            number(t.g, 5),
            number(t.g_error, 5),
            number(t.frequency_hz, 3),
            t.steps,
            t.seconds.cpu_s
        ));
    }
    match summary.flutter.first() {
        Some(p) => text.push_str(&format!(
            "flutter at Mach {}: density {:.5} kg/m^3 (+- {:.1} %), {:.2} m/s, {:.3} Hz{}\n",
            p.mach,
            p.density_kg_m3,
            100.0 * p.density_error,
            p.flutter_speed_m_s,
            p.flutter_frequency_hz,
            p.flutter_speed_index
                .map_or_else(String::new, |i| format!(", speed index {i:.4}"))
        )),
        None => text.push_str(&format!("{}\n", summary.stop_reason)),
    }
    text
}
