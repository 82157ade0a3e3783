//! `dip export FILE`: a recording as tables, JSON, ParaView files, or first harmonics.

use super::recording;
use crate::exit::{Done, Stop};
use crate::load_harmonics;
use crate::output::RunFolder;
use crate::{options, output};
use dip_correct::reading::{self, Reading, ReadingSettings};
use dip_record::{Recording, csv, paraview};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Options of `dip export`.
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("kinds").required(true).multiple(true).args(["csv", "as_json", "paraview", "harmonics"]))]
#[command(after_help = "Examples:
  dip export runs/agard445-pitch/pitch.mcap --harmonics
  dip export pitch.mcap --csv --paraview --out tables

--csv        history.csv (motion, loads, convergence), surface.csv, pressure.csv
--json       recording.json: everything
--paraview   wing.pvd: the moving wall with Cp, one file a step
--harmonics  harmonics.csv: complex Cp of every face per unit of the motion, Re(A e^{i omega t}), real part in
             phase with the motion; harmonics.json: frequencies, CL and CM, how well they are known

Exit code 3: the file is not whole; what is written is the part that can be read.")]
pub struct Args {
    /// The recording (.mcap)
    file: PathBuf,
    /// Tables of comma-separated values
    #[arg(long)]
    csv: bool,
    /// One JSON file
    #[arg(long = "json")]
    as_json: bool,
    /// ParaView files
    #[arg(long)]
    paraview: bool,
    /// Harmonics of the pressures per unit of the motion
    #[arg(long)]
    harmonics: bool,
    /// Whole cycles that the harmonics are taken from, counted from the end; 0 takes all
    #[arg(long, value_name = "N", default_value_t = 1)]
    cycles: usize,
    /// Reduced frequency at which a pulse is transformed (repeatable)
    #[arg(long = "k", value_name = "K")]
    pulse_k: Vec<f64>,
    /// Folder for the files (default: beside the recording, with its name)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write over older files
    #[arg(long)]
    force: bool,
    /// Say nothing on stderr but warnings (the reasons of exit code 3) and errors
    #[arg(short, long)]
    quiet: bool,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    options::messages(args.quiet)?;
    let salvage = recording::read(&args.file)?;
    let recorded = &salvage.recording;
    if recorded.steps.is_empty() {
        return Err(Stop::input(
            format!("{}: there is no step in it", args.file.display()),
            "go on with the run, or make it again",
        ));
    }
    let folder = args.out.clone().unwrap_or_else(|| args.file.with_extension("export"));
    // What the harmonics say is known before the first file is written: a wrong question leaves none behind.
    let harmonics = args.harmonics.then(|| Harmonics::new(args, recorded)).transpose()?;
    let mut names = Vec::new();
    if args.csv {
        names.extend(["history.csv", "surface.csv", "pressure.csv"]);
    }
    if args.as_json {
        names.push("recording.json");
    }
    if args.paraview {
        names.push("wing.pvd");
    }
    if harmonics.is_some() {
        names.extend(["harmonics.csv", "harmonics.json"]);
    }
    if let Some(name) = names.iter().find(|n| !args.force && folder.join(n).exists()) {
        return Err(Stop::input(
            format!("{} is there already", folder.join(name).display()),
            "give another folder with --out DIR, or write over it with --force",
        ));
    }
    let out = RunFolder::plain(&folder)?;
    if args.csv {
        out.write("history.csv", csv::history(recorded).as_bytes())?;
        out.write("surface.csv", csv::surface(recorded).as_bytes())?;
        out.write("pressure.csv", csv::pressure(recorded).as_bytes())?;
    }
    if args.as_json {
        // Not indented: a line for every number would be half the file.
        let text = serde_json::to_vec(recorded)
            .map_err(|e| Stop::failed(format!("cannot write JSON: {e}"), "please report this as a defect"))?;
        out.write("recording.json", &text)?;
    }
    if args.paraview {
        paraview::write(&folder.join("wing.pvd"), recorded).map_err(|e| recording::unwritable(&e))?;
    }
    if let Some(harmonics) = &harmonics {
        out.write("harmonics.csv", harmonics.table(recorded).as_bytes())?;
        out.write_json("harmonics.json", &harmonics.summaries)?;
        output::print(&harmonics.text());
    }
    tracing::info!("written: {} in {}", names.join(", "), folder.display());
    Ok(if salvage.findings.is_empty() {
        Done::Clean
    } else {
        Done::LookAt
    })
}

/// First harmonics of pressures and loads.
struct Harmonics {
    readings: Vec<Reading>,
    summaries: Vec<Summary>,
}

/// One motion at one frequency, without its faces.
#[derive(Debug, Serialize)]
struct Summary {
    coordinate: String,
    unit: &'static str,
    omega_rad_s: f64,
    frequency_hz: f64,
    reduced_frequency: f64,
    amplitude: f64,
    /// Real and imaginary part per unit of the motion; null for pulses and ramps.
    cl: Option<[f64; 2]>,
    cd: Option<[f64; 2]>,
    cm: Option<[f64; 2]>,
    cycles: usize,
    cycles_used: usize,
    /// Relative change of the pressures from the last cycle but one to the last.
    cycle_change: Option<f64>,
    /// What the harmonics leave of the pressures, relative to the first.
    residual: f64,
    /// Size of the second and higher harmonics, relative to the first.
    higher: Vec<f64>,
    /// Steps in the window below the orders asked for.
    unconverged: usize,
}

impl Harmonics {
    fn new(args: &Args, recording: &Recording) -> Result<Self, Stop> {
        let label = args.file.display().to_string();
        let settings = ReadingSettings {
            cycles: args.cycles,
            pulse_k: args.pulse_k.clone(),
            ..ReadingSettings::default()
        };
        let wrong = |e: &dyn std::fmt::Display| {
            Stop::input(
                format!("{label}: {e}"),
                "harmonics need a forced motion and at least one whole cycle of it; --csv and --paraview need neither",
            )
        };
        let readings = reading::read(recording, &label, &settings).map_err(|e| wrong(&e))?;
        let summaries = readings
            .iter()
            .map(|r| Summary::new(recording, r, &readings).map_err(|e| wrong(&e)))
            .collect::<Result<_, _>>()?;
        Ok(Self { readings, summaries })
    }

    /// One row per motion, frequency and face.
    fn table(&self, recording: &Recording) -> String {
        let higher = self.readings.iter().map(|r| r.higher.len()).max().unwrap_or(0);
        let mut out = String::from(
            "coordinate,unit,omega_rad_s,reduced_frequency,patch,face,x_m,y_m,z_m,upper,cp_mean,\
             cp_1_re_per_unit,cp_1_im_per_unit",
        );
        for n in 2..higher + 2 {
            let _ = write!(out, ",cp_{n}_re_per_unit,cp_{n}_im_per_unit");
        }
        out.push('\n');
        for reading in &self.readings {
            let head = format!(
                "{},{},{:?},{:?}",
                csv::quoted(&reading.name),
                reading.kind.unit(),
                reading.omega_rad_s,
                reading.k
            );
            let mut face = 0;
            for patch in &recording.setup.surface.patches {
                for (n, (c, upper)) in patch.centroids_m.iter().zip(&patch.upper).enumerate() {
                    let _ = write!(
                        out,
                        "{head},{},{n},{:?},{:?},{:?},{upper}",
                        csv::quoted(&patch.name),
                        c[0],
                        c[1],
                        c[2]
                    );
                    let (mean, cp) = (reading.mean.get(face), reading.cp.get(face));
                    out.push(',');
                    if let Some(mean) = mean {
                        let _ = write!(out, "{mean:?}");
                    }
                    let amplitudes = std::iter::once(cp).chain((0..higher).map(|h| reading.higher.get(h)?.get(face)));
                    for a in amplitudes {
                        match a {
                            Some(a) => drop(write!(out, ",{:?},{:?}", a.re, a.im)),
                            None => out.push_str(",,"),
                        }
                    }
                    out.push('\n');
                    face += 1;
                }
            }
        }
        out
    }

    /// What is printed.
    fn text(&self) -> String {
        let mut out = String::new();
        let complex = |v: Option<[f64; 2]>| v.map_or("-".to_owned(), |[re, im]| format!("{re:.5} {im:+.5} i"));
        for s in &self.summaries {
            let change = s.cycle_change.map_or("unknown".to_owned(), |c| format!("{c:.1e}"));
            let _ = writeln!(
                out,
                "{}: {:.4} Hz, k = {:.5}, per {}: CL = {}, CM = {}; change from cycle to cycle {change}, residual {:.1e}",
                s.coordinate,
                s.frequency_hz,
                s.reduced_frequency,
                s.unit,
                complex(s.cl),
                complex(s.cm),
                s.residual
            );
        }
        out
    }
}

impl Summary {
    fn new(recording: &Recording, r: &Reading, all: &[Reading]) -> Result<Self, dip_correct::HarmonicError> {
        let loads = load_harmonics::of(recording, r, all)?;
        let load = |n: usize| loads.as_ref().map(|l| [l.first[n].re, l.first[n].im]);
        Ok(Self {
            coordinate: r.name.clone(),
            unit: r.kind.unit(),
            omega_rad_s: r.omega_rad_s,
            frequency_hz: r.omega_rad_s / std::f64::consts::TAU,
            reduced_frequency: r.k,
            amplitude: r.amplitude,
            cl: load(0),
            cd: load(1),
            cm: load(2),
            cycles: r.quality.cycles,
            cycles_used: r.quality.cycles_used,
            cycle_change: r.quality.cycle_change,
            residual: r.quality.residual,
            higher: r.quality.higher.clone(),
            unconverged: r.quality.unconverged,
        })
    }
}
