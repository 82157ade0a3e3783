//! `pmb pitch`: unsteady flow with prescribed motion, and its recording.

mod files;
mod recorder;
mod session;
mod summary;

use crate::assemble::motion;
use crate::assemble::references::{Unsteady, references};
use crate::assemble::{flow, grid, surface};
use crate::exit::{Done, Stop};
use crate::options::Common;
use crate::output::{self, RunFolder};
use crate::pmb::logbook;
use crate::pmb::steady::cuts;
use crate::progress::{Timer, watch_interrupts};
use crate::stamp::{Fingerprint, Stamp};
use dip_case::file::{MotionLaw, PitchFile, SteadyFile, TimeSchemeKind};
use dip_case::{Document, atmosphere};
use dip_pmb::dual_time::{DualTimeSettings, TimeScheme};
use dip_pmb::forced::{ForcedSettings, ForcedStop};
use dip_record::{MotionCoordinate, Provenance, Setup};
use session::Session;
use std::path::{Path, PathBuf};
use summary::Summary;

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
    if !resume {
        // That of another run must not be gone on with where this one stops before it has its own.
        let _ = std::fs::remove_file(&restart);
    }
    folder.write(CASE, document.text().as_bytes())?;
    // The steady flow only starts the motion: deep enough for the first steps, no more.
    settings.solver.orders = file.steady.orders.unwrap_or(6.0);
    // The run's own restart file holds all; the steady start is made anew if it was not reached.
    settings.restart = None;
    let orders = file.time.orders.unwrap_or(DualTimeSettings::default().orders);
    let every = file.time.checkpoint.unwrap_or(file.motion.steps_per_cycle);
    let forced = ForcedSettings {
        steady: settings.clone(),
        time: DualTimeSettings {
            scheme: match file.time.scheme {
                TimeSchemeKind::Bdf2 => TimeScheme::Bdf2,
                TimeSchemeKind::Bdf2Opt => TimeScheme::Bdf2Opt,
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
        checkpoint_steps: every.next_multiple_of(logbook::safe_steps()),
    };
    let setup = Setup {
        references: references(
            &file.reference,
            &mesh.grid,
            &settings,
            &Unsteady {
                speed_m_s: stream.speed_m_s,
                density_kg_m3: stream.density_kg_m3,
                step_s: clock.step_s,
                steps_per_cycle: (clock.steps_per_cycle > 0).then_some(clock.steps_per_cycle),
                cycles: Some(file.motion.cycles as f64),
                orders,
            },
        ),
        motion: vec![prescribed.recorded(&mesh.grid)],
        surface: surface::patches(&mesh.grid),
        provenance: Provenance {
            program: "pmb pitch".to_owned(),
            version: format!("{} ({})", stamp.version, stamp.commit),
            case_name: document.file().display().to_string(),
            case_text: document.text().to_owned(),
            mesh_sha256: mesh.hash.clone(),
        },
    };
    let largest_m = largest_displacement_m(&setup.motion, prescribed.amplitude);
    if let (Some(largest), Some(coordinate)) = (largest_m, setup.motion.first()) {
        tracing::info!("{}: the wall moves by up to {largest:.3e} m", coordinate.name);
    }
    let timer = Timer::start();
    let run = Session {
        document,
        folder: &folder,
        grid: &mesh.grid,
        common,
    };
    let (result, recording) = run.march(RECORDING, &forced, &prescribed, setup.clone())?;
    stages.push(("flow".to_owned(), timer.seconds()));
    if result.history.is_empty() {
        return Err(Stop::Interrupted(
            "the steady flow that the motion starts from was not reached; start anew, there is nothing to resume"
                .to_owned(),
        ));
    }
    if result.stop == ForcedStop::Interrupted {
        return Err(Stop::Interrupted(format!(
            "{} time steps are in {} and {}; --resume goes on",
            result.steps,
            folder.path().join(RECORDING).display(),
            folder.path().join(RESTART).display(),
        )));
    }
    let readings = session::readings(&recording, &file)?;
    let loads = session::first_loads(&recording, &readings)?;
    let linearity = if file.motion.linearity {
        let timer = Timer::start();
        let half = run.halved(&forced, &file, prescribed.clone(), setup)?;
        stages.push(("flow with half the amplitude".to_owned(), timer.seconds()));
        loads.as_ref().zip(half).map(|(whole, half)| {
            let change = |c: usize| (whole.first[c] - half.first[c]).norm() / whole.first[c].norm();
            change(0).max(change(2))
        })
    } else {
        None
    };

    let timer = Timer::start();
    let title = format!("Mach {}, k = {:.4}", settings.flow.mach, clock.reduced_frequency);
    let unit = files::Unit::of(file.motion.kind);
    files::loads(&folder, &title, &unit, &recording, clock.steps_per_cycle)?;
    if let (Some(reading), true) = (readings.first(), clock.steps_per_cycle > 0) {
        let cut = |part: fn(&num_complex::Complex64) -> f64| {
            let walls = surface::walls(&mesh.grid, &recording.setup.surface, reading.cp.iter().map(part));
            cuts::make(&stations, &mesh.grid, &walls)
        };
        let parts = [cut(|c| c.re), cut(|c| c.im)];
        files::pressures(&folder, &format!("{title}: first harmonic of Cp"), &unit, &parts)?;
    }
    stages.push(("write".to_owned(), timer.seconds()));

    let warnings = summary::warnings(&result, &file, &clock, linearity);
    for warning in &warnings {
        tracing::warn!("{warning}");
    }
    let (harmonic, further) = summary::harmonics(loads.as_ref(), &clock);
    let mut text = summary::text(&title, &result, harmonic.as_ref(), &further, linearity);
    if file.motion.law == MotionLaw::Pulse {
        text.push_str(&format!(
            "`dip export {} --harmonics --k K` transforms the pulse at any reduced frequency K\n",
            folder.path().join(RECORDING).display()
        ));
    }
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
        largest_displacement_m: largest_m,
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
        further,
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

/// How far the amplitude moves the wall, m, where the shape is not rigid: what a unit of a mode is differs from one source
/// of modes to the next.
fn largest_displacement_m(motion: &[MotionCoordinate], amplitude: f64) -> Option<f64> {
    let lengths = motion
        .iter()
        .flat_map(|c| c.shape_m.iter().flatten())
        .map(|d| d.iter().map(|x| x * x).sum::<f64>().sqrt());
    lengths.reduce(f64::max).map(|largest| (largest * amplitude).abs())
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
