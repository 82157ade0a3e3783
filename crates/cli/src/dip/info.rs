//! `dip info FILE`: what a recording holds.

use super::recording;
use crate::exit::{Done, Stop};
use crate::{options, output};
use dip_record::{CoordinateKind, Finding, Harmonic, Law, MotionCoordinate, Recording, References, Salvage};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Options of `dip info`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:
  dip info runs/agard445-pitch/pitch.mcap

Exit code 3: the file is not whole; what is said is about the part that can be read.")]
pub struct Args {
    /// The recording (.mcap)
    file: PathBuf,
    /// Print it as JSON on stdout
    #[arg(long)]
    json: bool,
    /// Say nothing on stderr but warnings (the reasons of exit code 3) and errors
    #[arg(short, long)]
    quiet: bool,
}

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Info<'a> {
    file: String,
    bytes: u64,
    format: &'static str,
    program: &'a str,
    version: &'a str,
    case_name: &'a str,
    mesh_sha256: &'a str,
    /// Why the run ended; null if it was killed or goes on.
    end: Option<&'a str>,
    references: &'a References,
    motion: Vec<Motion<'a>>,
    patches: Vec<Patch<'a>>,
    steps: Option<Steps>,
    findings: &'a [Finding],
}

/// One coordinate.
#[derive(Debug, Serialize)]
struct Motion<'a> {
    name: &'a str,
    #[serde(flatten)]
    kind: CoordinateKind,
    unit: &'static str,
    #[serde(flatten)]
    law: &'a Law,
    /// Reduced frequencies of the harmonics.
    reduced_frequencies: Vec<f64>,
    /// Smallest and largest value of the steps.
    recorded: Option<[f64; 2]>,
}

/// One patch of wall.
#[derive(Debug, Serialize)]
struct Patch<'a> {
    name: &'a str,
    faces: usize,
    nodes: usize,
    /// Sum of the faces' areas.
    area_m2: f64,
}

/// The steps as a whole.
#[derive(Debug, Serialize)]
struct Steps {
    count: usize,
    first: u32,
    last: u32,
    start_s: f64,
    end_s: f64,
    /// Cycles of the first harmonic; null if there is none.
    cycles: Option<f64>,
    unconverged: usize,
    least_orders: f64,
    mean_iterations: f64,
    cl: [f64; 2],
    cd: [f64; 2],
    cm: [f64; 2],
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    options::messages(args.quiet)?;
    let salvage = recording::read(&args.file)?;
    let info = Info::new(&args.file, &salvage);
    if args.json {
        output::print(&output::json(&info)?);
    } else {
        output::print(&info.text());
    }
    Ok(if salvage.findings.is_empty() {
        Done::Clean
    } else {
        Done::LookAt
    })
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
        [low.min(v), high.max(v)]
    })
}

impl<'a> Info<'a> {
    fn new(file: &Path, salvage: &'a Salvage) -> Self {
        let recording = &salvage.recording;
        let setup = &recording.setup;
        let motion = setup.motion.iter().enumerate().map(|(n, c)| {
            let k = |h: &Harmonic| setup.references.reduced_frequency(h.omega_rad_s);
            Motion {
                name: &c.name,
                kind: c.kind,
                unit: c.kind.unit(),
                law: &c.law,
                reduced_frequencies: match &c.law {
                    Law::Harmonic { harmonics, .. } => harmonics.iter().map(k).collect(),
                    _ => Vec::new(),
                },
                recorded: (!recording.steps.is_empty())
                    .then(|| range(recording.steps.iter().map(|s| s.motion[n].value))),
            }
        });
        let patches = setup.surface.patches.iter().map(|p| Patch {
            name: &p.name,
            faces: p.faces.len(),
            nodes: p.nodes_m.len(),
            area_m2: p
                .areas_m2
                .iter()
                .map(|a| a.map(|v| v * v).iter().sum::<f64>().sqrt())
                .sum(),
        });
        Self {
            file: file.display().to_string(),
            // The file was just read; should it have gone since, its size is of no interest.
            bytes: std::fs::metadata(file).map_or(0, |m| m.len()),
            format: dip_record::schema::FORMAT,
            program: &setup.provenance.program,
            version: &setup.provenance.version,
            case_name: &setup.provenance.case_name,
            mesh_sha256: &setup.provenance.mesh_sha256,
            end: recording.end.as_deref(),
            references: &setup.references,
            motion: motion.collect(),
            patches: patches.collect(),
            steps: Steps::new(recording),
            findings: &salvage.findings,
        }
    }

    fn text(&self) -> String {
        let r = self.references;
        let mut out = String::new();
        let mut line = |name: &str, value: String| {
            let _ = writeln!(out, "{name:<12}{value}");
        };
        line(
            "file",
            format!(
                "{}, {:.2} MB, format {}",
                self.file,
                self.bytes as f64 / 1e6,
                self.format
            ),
        );
        line("made by", format!("{} {}", self.program, self.version));
        line(
            "case",
            format!("{}, mesh {}", self.case_name, self.mesh_sha256.get(..12).unwrap_or("?")),
        );
        line(
            "ended",
            self.end
                .unwrap_or("not: the run was killed or still goes on")
                .to_owned(),
        );
        let reynolds = r.reynolds.map_or(String::new(), |re| format!(", Re {re}"));
        line(
            "stream",
            format!(
                "{}, Mach {}, {} m/s, {} kg/m^3, {} Pa, alpha {} deg{reynolds}",
                r.model,
                r.mach,
                short(r.speed_m_s),
                short(r.density_kg_m3),
                short(r.pressure_pa),
                short(r.alpha_deg)
            ),
        );
        let [x, y, z] = r.moment_point_m.map(short);
        line(
            "reference",
            format!(
                "b {} m, chord {} m, area {} m^2, span {} m, moments about ({x}, {y}, {z}) m{}",
                short(r.reference_semichord_m),
                short(r.reference_chord_m),
                short(r.reference_area_m2),
                short(r.span_m),
                if r.half_model { ", half model" } else { "" }
            ),
        );
        for motion in &self.motion {
            line("motion", motion.text());
        }
        for patch in &self.patches {
            line(
                "surface",
                format!(
                    "{}: {} faces, {} nodes, {:.6} m^2",
                    patch.name, patch.faces, patch.nodes, patch.area_m2
                ),
            );
        }
        let Some(s) = &self.steps else {
            line("steps", "none".to_owned());
            return out;
        };
        let cycles = s.cycles.map_or(String::new(), |c| format!(", {c:.3} cycles"));
        line(
            "steps",
            format!(
                "{} ({} to {}), {} to {} s, one each {} s{cycles}",
                s.count,
                s.first,
                s.last,
                short(s.start_s),
                short(s.end_s),
                short(r.time_step_s)
            ),
        );
        line(
            "convergence",
            format!(
                "{} of {} steps below the {} orders asked, least {:.2}, {:.1} iterations a step",
                s.unconverged, s.count, r.orders_asked, s.least_orders, s.mean_iterations
            ),
        );
        for (name, [low, high]) in [("CL", s.cl), ("CD", s.cd), ("CM", s.cm)] {
            line(name, format!("{low:.6} to {high:.6}"));
        }
        out
    }
}

/// Six digits, for reading; the JSON has all.
fn short(value: f64) -> String {
    let rounded = format!("{value:.5e}");
    rounded.parse::<f64>().map_or(rounded, |v| v.to_string())
}

impl Motion<'_> {
    fn text(&self) -> String {
        let unit = self.unit;
        let mut text = format!("{}: {}", self.name, self.kind.name());
        match self.kind {
            CoordinateKind::Pitch {
                axis_point_m: [x, y, z],
                axis_direction: [a, b, c],
            }
            | CoordinateKind::Control {
                axis_point_m: [x, y, z],
                axis_direction: [a, b, c],
            } => {
                let _ = write!(text, " about ({x}, {y}, {z}) m along ({a}, {b}, {c})");
            }
            CoordinateKind::Plunge { direction: [a, b, c] } => {
                let _ = write!(text, " along ({a}, {b}, {c})");
            }
            CoordinateKind::Mode => {}
        }
        let amount = |value: f64| match unit {
            "rad" => format!("{:.6} deg", value.to_degrees()),
            unit => format!("{} {unit}", short(value)),
        };
        match self.law {
            Law::Harmonic { mean, harmonics, .. } => {
                let _ = write!(text, "; {}", amount(*mean));
                for (h, k) in harmonics.iter().zip(&self.reduced_frequencies) {
                    let hz = h.omega_rad_s / std::f64::consts::TAU;
                    let _ = write!(text, " + {} sin at {hz:.4} Hz (k = {k:.5})", amount(h.amplitude));
                }
            }
            Law::Pulse {
                amplitude, duration_s, ..
            } => {
                let _ = write!(text, "; pulse of {} in {} s", amount(*amplitude), short(*duration_s));
            }
            Law::Ramp {
                amplitude, duration_s, ..
            } => {
                let _ = write!(text, "; ramp of {} in {} s", amount(*amplitude), short(*duration_s));
            }
            Law::Free => text.push_str("; free"),
        }
        if let Some([low, high]) = self.recorded {
            let _ = write!(text, "; recorded {} to {}", amount(low), amount(high));
        }
        text
    }
}

impl Steps {
    fn new(recording: &Recording) -> Option<Self> {
        let steps = &recording.steps;
        let (first, last) = (steps.first()?, steps.last()?);
        let omega = recording
            .setup
            .motion
            .iter()
            .find_map(|c: &MotionCoordinate| c.law.fundamental_rad_s());
        // The start is an instant, not a step that was solved.
        let solved = || steps.iter().filter(|s| s.number > 0);
        let iterations: u32 = solved().map(|s| s.convergence.iterations).sum();
        let [least_orders, _] = range(solved().map(|s| s.convergence.orders));
        Some(Self {
            count: steps.len(),
            first: first.number,
            last: last.number,
            start_s: first.time_s,
            end_s: last.time_s,
            cycles: omega.map(|w| (last.time_s - first.time_s) * w / std::f64::consts::TAU),
            unconverged: solved().filter(|s| !s.convergence.converged).count(),
            least_orders: if least_orders.is_finite() { least_orders } else { 0.0 },
            mean_iterations: f64::from(iterations) / solved().count().max(1) as f64,
            cl: range(steps.iter().map(|s| s.loads.cl)),
            cd: range(steps.iter().map(|s| s.loads.cd)),
            cm: range(steps.iter().map(|s| s.loads.cm)),
        })
    }
}
