//! `pmb pitch`: unsteady flow with prescribed motion, and its recording.

mod files;
pub mod harmonics;
mod recorder;
mod surface;

use crate::assemble::motion::{self, Clock};
use crate::assemble::{flow, grid};
use crate::exit::{Done, Stop};
use crate::options::Common;
use crate::output::{self, RunFolder};
use crate::pmb::steady::{cuts, watch::Watch};
use crate::progress::{Seconds, Timer, watch_interrupts};
use crate::stamp::{Fingerprint, Stamp};
use dip_case::file::{MotionKind, PitchFile, SteadyFile, TimeSchemeKind};
use dip_case::{Document, atmosphere};
use dip_pmb::dual_time::{DualTimeSettings, TimeScheme};
use dip_pmb::forced::{self, ForcedResult, ForcedSettings, ForcedStop};
use dip_pmb::steady::StopReason;
use dip_record::{Provenance, References, Setup, SurfaceGrid, WriterOptions};
use harmonics::Harmonic;
use recorder::Recorder;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// The restart file.
const RESTART: &str = "restart.pmb";
/// The case as it was read, overrides included.
const CASE: &str = "case.toml";
/// The recording.
pub const RECORDING: &str = "pitch.mcap";

/// Unsteady flow with prescribed motion: pitch, plunge, a mode, a control surface; recording and first harmonics.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The case file (.toml)
    case: PathBuf,
    /// Go on from the restart file of an interrupted or killed run; the recording goes on where the restart is
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    common: Common,
}

const EXAMPLES: &str = "Examples:
  pmb pitch cases/agard445/pitch.toml
  pmb pitch cases/agard445/pitch.toml --set flow.mach=0.96 --set motion.reduced_frequency=0.1 --out runs/m096-k010
  pmb pitch cases/agard445/pitch.toml --resume
  dip info runs/agard445-pitch/pitch.mcap

Exit codes: 0 done; 1 failed; 2 bad arguments or input; 3 done, but steps did not converge or cycles do not agree;
130 interrupted, --resume goes on.";

/// What `summary.json` holds.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    command: &'static str,
    stamp: Stamp,
    settings: &'a str,
    stop_reason: ForcedStop,
    steady_stop_reason: Option<&'a StopReason>,
    mach: f64,
    alpha_deg: f64,
    speed_m_s: f64,
    density_kg_m3: f64,
    omega_rad_s: f64,
    frequency_hz: f64,
    reduced_frequency: f64,
    amplitude: f64,
    steps_per_cycle: usize,
    steps: usize,
    steps_not_converged: usize,
    iterations: usize,
    products: usize,
    preconditioners: usize,
    /// Change from the last cycle but one to the last, as a part of the amplitude.
    cycle_change: Option<f64>,
    /// First harmonics per radian, metre or 1, over the last whole cycle.
    cl: Option<Harmonic>,
    cd: Option<Harmonic>,
    cm: Option<Harmonic>,
    /// With half the amplitude, where asked for: the largest change of the harmonics of lift and moment, as a part.
    linearity: Option<f64>,
    cells: usize,
    mesh_hash: &'a str,
    recording: &'static str,
    warnings: Vec<String>,
    stages: &'a [(String, Seconds)],
    total: Seconds,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    args.common.start()?;
    let document = args.common.document(&args.case)?;
    let folder = args.common.folder(&args.case);
    let done = compute(&document, &folder, args.resume, &args.common)?;
    if args.common.json {
        output::print(&output::json(&done.summary)?);
    } else {
        output::print(&done.text);
        tracing::info!("results in {}", folder.display());
    }
    Ok(if done.warnings.is_empty() {
        Done::Clean
    } else {
        Done::LookAt
    })
}

/// A finished run.
#[derive(Debug)]
pub struct PitchDone {
    /// Where the recording is.
    pub recording: PathBuf,
    /// As in `summary.json`.
    pub summary: serde_json::Value,
    /// Results in words.
    pub text: String,
    /// What to look at.
    pub warnings: Vec<String>,
}

/// A finished run of the same inputs in `path`, if there is one.
///
/// # Errors
/// What is wrong in the case.
pub fn kept(document: &Document, path: &Path) -> Result<Option<PitchDone>, Stop> {
    let Ok(text) = std::fs::read_to_string(path.join(output::SUMMARY)) else {
        return Ok(None);
    };
    let file: PitchFile = document.load()?;
    let mesh = grid::from_case(document, &file.mesh)?;
    let stamp = stamp(document, &file, &mesh.hash);
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    let recording = path.join(RECORDING);
    if summary["stamp"]["fingerprint"] != stamp.fingerprint.as_str() || !recording.exists() {
        return Ok(None);
    }
    let words = |v: &serde_json::Value| v.as_str().map(str::to_owned);
    let warnings = summary["warnings"]
        .as_array()
        .map(|w| w.iter().filter_map(words).collect());
    Ok(Some(PitchDone {
        recording,
        warnings: warnings.unwrap_or_default(),
        summary,
        text: String::new(),
    }))
}

/// True if `path` holds a restart file of the same case, whose run did not finish.
pub fn can_resume(document: &Document, path: &Path) -> bool {
    let same = std::fs::read_to_string(path.join(CASE)).is_ok_and(|text| text == document.text());
    same && path.join(RESTART).exists() && path.join(RECORDING).exists()
}

/// What a run depends on.
fn stamp(document: &Document, file: &PitchFile, mesh_hash: &str) -> Stamp {
    let mut fingerprint = Fingerprint::new();
    fingerprint.document(document).text(mesh_hash);
    if let Some(table) = &file.modes {
        crate::assemble::modes::fingerprint(document, table, &mut fingerprint);
    }
    fingerprint.stamp()
}

/// Runs a case and writes its results to `path`.
///
/// # Errors
/// What is wrong in the case, or what the solver fails with; an interrupted run has its restart file.
pub fn compute(document: &Document, path: &Path, resume: bool, common: &Common) -> Result<PitchDone, Stop> {
    watch_interrupts();
    let total = Timer::start();
    let file: PitchFile = document.load()?;
    let steady = steady_file(&file);
    let mut settings = flow::settings(document, &steady)?;
    let stations = cuts::stations(document, &steady)?;
    let stream = Stream::of(&file);
    let clock = motion::clock(document, &file, stream.speed_m_s)?;

    let mut stages = Vec::new();
    let timer = Timer::start();
    let mesh = grid::from_case(document, &file.mesh)?;
    stages.push(("mesh".to_owned(), timer.seconds()));
    flow::on_grid(&mut settings, document, &steady, &mesh.grid)?;
    let timer = Timer::start();
    let prescribed = motion::prescribed(document, &file, &mesh.grid, &clock, stream.speed_m_s)?;
    stages.push(("motion".to_owned(), timer.seconds()));

    let stamp = stamp(document, &file, &mesh.hash);
    let restart = path.join(RESTART);
    if resume && !restart.exists() {
        return Err(Stop::input(
            format!("{}: there is no restart file to go on from", restart.display()),
            "leave --resume out to start anew, or name the folder of the run with --out DIR",
        ));
    }
    let folder = RunFolder::open(path, &stamp, common.force || resume)?;
    folder.write(CASE, document.text().as_bytes())?;
    // The steady flow only starts the motion: deep enough for the first steps, no more.
    settings.solver.orders = file.steady.orders.unwrap_or(6.0);
    // The run's own restart file holds all; the steady start is made anew if it was not reached.
    settings.restart = None;
    let orders = file.time.orders.unwrap_or(DualTimeSettings::default().orders);
    let every = file.time.checkpoint.unwrap_or(file.motion.steps_per_cycle);
    let chunk = WriterOptions::default().steps_per_chunk as usize;
    let forced = ForcedSettings {
        steady: settings.clone(),
        time: DualTimeSettings {
            scheme: match file.time.scheme {
                TimeSchemeKind::Bdf2 => TimeScheme::Bdf2,
                TimeSchemeKind::Bdf1 => TimeScheme::Bdf1,
            },
            dt: clock.step_s * stream.speed_m_s,
            orders,
            max_iterations: file
                .time
                .iterations
                .unwrap_or(DualTimeSettings::default().max_iterations),
            ..DualTimeSettings::default()
        },
        steps_per_cycle: clock.steps_per_cycle,
        steps: clock.steps,
        cycle_tolerance: file.motion.tolerance,
        restart: Some(restart),
        resume,
        // After a chunk of the recording is safe, so that a killed run's recording reaches its restart file.
        checkpoint_steps: every.div_ceil(chunk) * chunk,
    };
    let setup = Setup {
        references: references(document, &file, &mesh.grid, &settings, &stream, &clock, orders),
        motion: vec![prescribed.coordinate.clone()],
        surface: SurfaceGrid::default(),
        provenance: Provenance {
            program: "pmb pitch".to_owned(),
            version: format!("{} ({})", stamp.version, stamp.commit),
            case_name: document.file().display().to_string(),
            case_text: document.text().to_owned(),
            mesh_sha256: mesh.hash.clone(),
        },
    };
    let timer = Timer::start();
    let (result, recorder) = march(
        document,
        &folder,
        RECORDING,
        &forced,
        &mesh.grid,
        &prescribed,
        setup.clone(),
        &clock,
        common,
    )?;
    stages.push(("flow".to_owned(), timer.seconds()));
    if result.stop == ForcedStop::Interrupted {
        return Err(Stop::Interrupted(format!(
            "{} time steps are in {} and {}; --resume goes on",
            result.steps,
            folder.path().join(RECORDING).display(),
            folder.path().join(RESTART).display(),
        )));
    }
    let harmonic = harmonic_of(&result, &recorder, &clock);
    let linearity = if file.motion.linearity {
        let timer = Timer::start();
        let half = halved(
            document,
            &folder,
            &forced,
            &mesh.grid,
            &prescribed,
            setup,
            &clock,
            common,
        )?;
        stages.push(("flow with half the amplitude".to_owned(), timer.seconds()));
        harmonic.zip(half).map(|(a, b)| {
            [(a[0], b[0]), (a[2], b[2])]
                .iter()
                .map(|(a, b)| (a.real - b.real).hypot(a.imaginary - b.imaginary) / a.real.hypot(a.imaginary))
                .fold(0.0, f64::max)
        })
    } else {
        None
    };

    let timer = Timer::start();
    let title = format!("Mach {}, k = {:.4}", settings.flow.mach, clock.reduced_frequency);
    files::loads(
        &folder,
        &title,
        unit(file.motion.kind),
        &recorder.lines,
        clock.steps_per_cycle,
        &result,
    )?;
    if clock.steps_per_cycle > 0 && recorder.walls.len() == clock.steps_per_cycle {
        let values = last_values(&recorder, clock.steps_per_cycle);
        if let Some([real, imaginary]) = harmonics::walls(&recorder.walls, &values) {
            let parts = [
                cuts::make(&stations, &mesh.grid, &real),
                cuts::make(&stations, &mesh.grid, &imaginary),
            ];
            files::pressures(
                &folder,
                &format!("{title}: first harmonic of Cp per unit of motion"),
                &parts,
            )?;
        }
    }
    stages.push(("write".to_owned(), timer.seconds()));

    let warnings = warnings(&result, &file, &clock, linearity);
    for warning in &warnings {
        tracing::warn!("{warning}");
    }
    let text = text(&title, &result, harmonic.as_ref(), linearity);
    let summary = Summary {
        command: "pmb pitch",
        stamp,
        settings: document.text(),
        stop_reason: result.stop,
        steady_stop_reason: result.steady_stop.as_ref(),
        mach: settings.flow.mach,
        alpha_deg: settings.flow.alpha_deg,
        speed_m_s: stream.speed_m_s,
        density_kg_m3: stream.density_kg_m3,
        omega_rad_s: clock.omega_rad_s,
        frequency_hz: clock.omega_rad_s / std::f64::consts::TAU,
        reduced_frequency: clock.reduced_frequency,
        amplitude: prescribed.amplitude,
        steps_per_cycle: clock.steps_per_cycle,
        steps: result.steps,
        steps_not_converged: result.not_converged,
        iterations: result.iterations,
        products: result.products,
        preconditioners: result.builds,
        cycle_change: result.cycle_change.is_finite().then_some(result.cycle_change),
        cl: harmonic.map(|h| h[0]),
        cd: harmonic.map(|h| h[1]),
        cm: harmonic.map(|h| h[2]),
        linearity,
        cells: mesh.grid.cell_count(),
        mesh_hash: &mesh.hash,
        recording: RECORDING,
        warnings: warnings.clone(),
        stages: &stages,
        total: total.seconds(),
    };
    folder.write_json(output::SUMMARY, &summary)?;
    let summary = serde_json::to_value(&summary)
        .map_err(|e| Stop::failed(format!("cannot write JSON: {e}"), "please report this as a defect"))?;
    Ok(PitchDone {
        recording: folder.path().join(RECORDING),
        summary,
        text,
        warnings,
    })
}

/// Speed and density of the stream.
struct Stream {
    speed_m_s: f64,
    density_kg_m3: f64,
}

impl Stream {
    fn of(file: &PitchFile) -> Self {
        match (file.flow.speed, file.flow.density) {
            (Some(speed), Some(density)) => Self {
                speed_m_s: speed.0,
                density_kg_m3: density.0,
            },
            // flow::settings refuses one without the other.
            _ => {
                let air = atmosphere::standard(0.0).ok();
                let sound = air.as_ref().map_or(340.294, |a| a.speed_of_sound_m_s);
                tracing::info!(
                    "no speed and density in [flow]: those of the standard atmosphere at sea level are taken"
                );
                Self {
                    speed_m_s: file.flow.mach * sound,
                    density_kg_m3: air.map_or(1.225, |a| a.density_kg_m3),
                }
            }
        }
    }
}

/// The steady part of a case.
pub fn steady_file(file: &PitchFile) -> SteadyFile {
    SteadyFile {
        flow: file.flow.clone(),
        mesh: file.mesh.clone(),
        reference: Some(file.reference.clone()),
        steady: file.steady.clone(),
        patch: file.patch.clone(),
        cuts: file.cuts.clone(),
    }
}

fn references(
    document: &Document,
    file: &PitchFile,
    grid: &dip_grid::MultiBlock,
    settings: &dip_pmb::settings::SteadySettings,
    stream: &Stream,
    clock: &Clock,
    orders: f64,
) -> References {
    let _ = document;
    let planar = grid.is_two_dimensional();
    let [lo, hi] = grid.bounds();
    let half = !planar
        && grid
            .topology
            .patches
            .iter()
            .any(|p| p.condition == dip_grid::Condition::Symmetry);
    let wall = grid
        .topology
        .patches
        .iter()
        .filter(|p| p.condition.is_wall())
        .flat_map(|p| {
            let block = &grid.blocks[p.block];
            let hi = p.window.hi;
            let lo = p.window.lo;
            (lo[1]..=hi[1])
                .flat_map(move |q| (lo[0]..=hi[0]).map(move |i| block.point_at(block.node_behind(p.face, i, q, 0))[1]))
        })
        .fold([f64::INFINITY, f64::NEG_INFINITY], |r, y| [r[0].min(y), r[1].max(y)]);
    let width = file.reference.semispan.map_or(wall[1] - wall[0], |s| s.0);
    let pressure = stream.density_kg_m3 * stream.speed_m_s.powi(2) / (settings.flow.gamma * settings.flow.mach.powi(2));
    References {
        model: "euler".to_owned(),
        mach: settings.flow.mach,
        speed_m_s: stream.speed_m_s,
        density_kg_m3: stream.density_kg_m3,
        pressure_pa: pressure,
        gamma: settings.flow.gamma,
        reynolds: None,
        alpha_deg: settings.flow.alpha_deg,
        reference_semichord_m: file.reference.semichord.map_or(0.5 * file.reference.chord.0, |b| b.0),
        reference_chord_m: settings.reference.chord,
        reference_area_m2: settings.reference.area,
        span_m: if planar {
            hi[1] - lo[1]
        } else if half {
            2.0 * width
        } else {
            width
        },
        moment_point_m: settings.reference.moment_point,
        grid_unit_m: 1.0,
        half_model: half,
        time_step_s: clock.step_s,
        steps_per_cycle: (clock.steps_per_cycle > 0).then(|| u32::try_from(clock.steps_per_cycle).unwrap_or(u32::MAX)),
        cycles_asked: Some(file.motion.cycles as f64),
        orders_asked: orders,
    }
}

#[expect(clippy::too_many_arguments, reason = "each is a different thing")]
fn march(
    document: &Document,
    folder: &RunFolder,
    recording: &str,
    settings: &ForcedSettings,
    grid: &dip_grid::MultiBlock,
    prescribed: &motion::Prescribed,
    setup: Setup,
    clock: &Clock,
    common: &Common,
) -> Result<(ForcedResult, Recorder), Stop> {
    let watch = Watch::new(common.quiet, settings.steady.solver.orders);
    let cancel = watch.cancel();
    let (own, field) = (grid.clone(), prescribed.field.clone());
    let surface = move |walls: &[dip_pmb::loads::WallPatch]| {
        let shape = field.as_ref().map_or_else(Vec::new, |f| surface::at_walls(&own, f));
        (surface::patches(&own, walls), shape)
    };
    let path = folder.path().join(recording);
    let mut recorder = Recorder::new(watch, path, setup, surface, clock.steps_per_cycle, settings.steps);
    let result = forced::run(settings, grid, &prescribed.motion, &mut recorder, &cancel);
    recorder.watch.finish();
    let reason = match &result {
        Ok(r) => serde_json::to_value(r.stop)
            .ok()
            .and_then(|v| v.as_str().map(str::to_owned))
            .unwrap_or_default(),
        Err(e) => format!("failed: {e}"),
    };
    let closed = recorder.finish(&reason);
    let result = result.map_err(|e| flow::explain(document, e))?;
    closed.map_err(|e| Stop::failed(e, "check the disk's space; `dip doctor` says what can be saved"))?;
    Ok((result, recorder))
}

#[expect(clippy::too_many_arguments, reason = "each is a different thing")]
fn halved(
    document: &Document,
    folder: &RunFolder,
    settings: &ForcedSettings,
    grid: &dip_grid::MultiBlock,
    prescribed: &motion::Prescribed,
    mut setup: Setup,
    clock: &Clock,
    common: &Common,
) -> Result<Option<[Harmonic; 3]>, Stop> {
    let mut half = prescribed.clone();
    for coordinate in &mut half.motion.coordinates {
        if let dip_pmb::motion::Law::Harmonic { terms, .. } = &mut coordinate.law {
            terms.iter_mut().for_each(|t| t.amplitude *= 0.5);
        }
    }
    if let dip_record::Law::Harmonic { harmonics, .. } = &mut half.coordinate.law {
        harmonics.iter_mut().for_each(|h| h.amplitude *= 0.5);
    }
    setup.motion = vec![half.coordinate.clone()];
    let settings = ForcedSettings {
        restart: None,
        resume: false,
        ..settings.clone()
    };
    tracing::info!("once more with half the amplitude");
    let (result, recorder) = march(
        document,
        folder,
        "pitch_half.mcap",
        &settings,
        grid,
        &half,
        setup,
        clock,
        common,
    )?;
    if result.stop == ForcedStop::Interrupted {
        return Err(Stop::Interrupted(format!(
            "the run with the full amplitude is in {}",
            folder.path().join(RECORDING).display()
        )));
    }
    Ok(harmonic_of(&result, &recorder, clock))
}

/// Values of the motion over the last whole cycle.
fn last_values(recorder: &Recorder, n: usize) -> Vec<f64> {
    let lines = &recorder.lines;
    lines[lines.len().saturating_sub(n)..].iter().map(|l| l.value).collect()
}

/// First harmonics of lift, drag and moment over the last cycle of a periodic motion.
fn harmonic_of(result: &ForcedResult, recorder: &Recorder, clock: &Clock) -> Option<[Harmonic; 3]> {
    let n = clock.steps_per_cycle;
    // Step 0 is the steady start and belongs to no cycle.
    if n == 0 || result.history.len() <= n || recorder.lines.len() < n {
        return None;
    }
    let values = last_values(recorder, n);
    let last = &result.history[result.history.len() - n..];
    Some([0, 1, 2].map(|c| {
        let samples: Vec<f64> = last.iter().map(|h| h[c]).collect();
        harmonics::of(&samples, &values)
    }))
}

/// Label of the motion's axis and the factor to its unit.
fn unit(kind: MotionKind) -> (&'static str, f64) {
    match kind {
        MotionKind::Pitch => ("Pitch, degrees", 180.0 / std::f64::consts::PI),
        MotionKind::Control => ("Deflection, degrees", 180.0 / std::f64::consts::PI),
        MotionKind::Plunge => ("Plunge, m", 1.0),
        MotionKind::Mode => ("Generalized coordinate", 1.0),
    }
}

fn warnings(result: &ForcedResult, file: &PitchFile, clock: &Clock, linearity: Option<f64>) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some(stop) = result.steady_stop.as_ref().filter(|s| !s.is_converged()) {
        warnings.push(format!(
            "the steady start is not converged ({stop:?}): look at it by `pmb steady`"
        ));
    }
    if result.not_converged > 0 {
        warnings.push(format!(
            "{} of {} time steps did not converge to the orders asked for; more steps per cycle or time.iterations help",
            result.not_converged, result.steps
        ));
    }
    if clock.steps_per_cycle > 0 && file.motion.tolerance > 0.0 && result.stop == ForcedStop::AllSteps {
        warnings.push(format!(
            "the last two cycles differ by {:.2} % of the amplitude, {:.2} % were asked for; more motion.cycles help",
            100.0 * result.cycle_change,
            100.0 * file.motion.tolerance
        ));
    }
    if let Some(change) = linearity.filter(|c| *c > 0.05) {
        warnings.push(format!(
            "with half the amplitude the harmonics change by {:.1} %: the response is not linear",
            100.0 * change
        ));
    }
    warnings
}

fn text(title: &str, result: &ForcedResult, harmonic: Option<&[Harmonic; 3]>, linearity: Option<f64>) -> String {
    let reason = match result.stop {
        ForcedStop::Periodic => "two successive cycles agree",
        ForcedStop::AllSteps => "all steps taken",
        ForcedStop::Interrupted => "interrupted",
    };
    let mut text = format!(
        "{title}: {reason} after {} time steps, {} pseudo steps, {} products\n",
        result.steps, result.iterations, result.products
    );
    if let Some(h) = harmonic {
        text.push_str(&format!(
            "{:<4}{:>13}{:>13}{:>13}\n",
            "", "mean", "in phase", "1/4 ahead"
        ));
        for (name, h) in ["CL", "CD", "CM"].into_iter().zip(h) {
            text.push_str(&format!(
                "{name:<4}{:>13.7}{:>13.6}{:>13.6}\n",
                h.mean, h.real, h.imaginary
            ));
        }
        text.push_str("harmonics per radian, metre or 1 of the motion\n");
    }
    if let Some(change) = linearity {
        text.push_str(&format!(
            "with half the amplitude: harmonics change by {:.2} %\n",
            100.0 * change
        ));
    }
    text
}
