//! `dlm correct`: the lattice corrected by recorded pressures, its flutter, and the audit of the hand-over.

use crate::correction::{CorrectedRow, CorrectionCase, CorrectionResults, MachCorrection, figures};
use crate::exit::{Done, Stop};
use crate::figures::drawing;
use crate::options::Common;
use crate::output::{self, RunFolder};
use crate::progress::{Seconds, Timer, bar, watch_interrupts};
use crate::stamp::Stamp;
use dip_correct::audit::{Audit, StripPhase, Verdict};
use dip_correct::weight::{Diagonal, Treatment};
use dip_report::{Align, Block, Cell, Column, NumberFormat, Page, ReportError, Table};
use serde::Serialize;
use std::path::PathBuf;

/// The lattice corrected by recorded pressures, its flutter, and the audit of the hand-over.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  dlm correct cases/agard445/flutter.toml --from runs/agard445-pitch/pitch.mcap
  dlm correct flutter.toml --from a.mcap --from b.mcap --set 'correct.methods=[\"downwash\", \"force\", \"mode\"]'

Exit code 3: done, but the audit fails or a flutter point rests on no recording; both say why.")]
pub struct Args {
    /// The flutter case, with [correct] for methods and [recordings] for files
    case: PathBuf,
    /// A recording of forced motion (.mcap), besides those that the case names
    #[arg(long, value_name = "FILE")]
    from: Vec<PathBuf>,
    #[command(flatten)]
    common: Common,
}

/// What `summary.json` holds.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    command: &'static str,
    stamp: Stamp,
    settings: &'a str,
    stop_reason: &'static str,
    boxes: usize,
    flutter: Vec<&'a CorrectedRow>,
    machs: Vec<MachSummary<'a>>,
    audit_failed: bool,
    warnings: Vec<String>,
    notes: &'a [String],
    stages: &'a [(String, Seconds)],
    total: Seconds,
}

/// Recordings, weights and audit at one Mach number.
#[derive(Debug, Serialize)]
struct MachSummary<'a> {
    mach: f64,
    recordings: Vec<RecordingSummary<'a>>,
    weights: Vec<WeightSummary>,
    audit: &'a Audit,
    generalized_forces: Vec<ForcesSummary>,
}

/// What a recording gave.
#[derive(Debug, Serialize)]
struct RecordingSummary<'a> {
    file: &'a str,
    coordinate: &'a str,
    unit: &'static str,
    omega_rad_s: f64,
    reduced_frequency: f64,
    amplitude: f64,
    cycles: usize,
    cycles_used: usize,
    cycle_change: Option<f64>,
    residual: f64,
    higher_harmonics: &'a [f64],
    /// Normal force over dynamic pressure per unit of the motion, m^2: real and imaginary part.
    lift_m2: [f64; 2],
    /// Its moment about x = 0, nose up, m^3.
    pitching_moment_m3: [f64; 2],
}

/// Weights on the downwash at one recorded reduced frequency.
#[derive(Debug, Serialize)]
struct WeightSummary {
    reduced_frequency: f64,
    /// Real and imaginary part of W for each box, by strips from the root, leading edge first.
    downwash: Vec<[f64; 2]>,
    /// Boxes without the plain ratio.
    not_ratio: Vec<BoxTreatment>,
    section_lift: Vec<StripPhase>,
    condition: f64,
}

#[derive(Debug, Serialize)]
struct BoxTreatment {
    #[serde(rename = "box")]
    index: usize,
    weight: &'static str,
    treatment: Treatment,
}

/// Q by one correction.
#[derive(Debug, Serialize)]
struct ForcesSummary {
    correction: &'static str,
    reduced_frequencies: Vec<f64>,
    /// Q `[k][row = force][column = mode]`, m^2: real and imaginary part.
    q_m2: Vec<Vec<Vec<[f64; 2]>>>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Done, Stop> {
    args.common.start()?;
    let timer = Timer::start();
    let case = CorrectionCase::read(args.common.document(&args.case)?, &args.from)?;
    let stamp = case.fingerprint.stamp();
    let folder = RunFolder::open(&args.common.folder(&args.case), &stamp, args.common.force)?;
    watch_interrupts();
    let bar = bar(1 + 3 * case.flutter.file.lattice.mach.len() as u64, args.common.quiet);
    let results = case.solve(|stage| {
        bar.inc(1);
        bar.set_message(stage.to_owned());
    });
    bar.finish_and_clear();
    let results = results?;
    let rows: Vec<&CorrectedRow> = results
        .machs
        .iter()
        .flat_map(|m| m.solutions.iter().map(|s| &s.row))
        .collect();
    let audit_failed = results.machs.iter().any(|m| m.audit.failed());
    let mut warnings = Vec::new();
    for m in &results.machs {
        for check in m.audit.checks.iter().filter(|c| c.verdict == Verdict::Fail) {
            let value = check.value.unwrap_or(f64::NAN);
            warnings.push(format!(
                "audit, Mach {}, {}: {} = {value:.3e} (limit {:.1e}): {}",
                m.mach, check.subject, check.name, check.limit, check.words
            ));
        }
    }
    for r in &rows {
        let place = format!("Mach {}, {} by {}", r.row.mach, r.correction, r.row.method.name());
        warnings.extend(r.row.warnings.iter().map(|w| format!("{place}: {w}")));
    }
    for warning in &warnings {
        tracing::warn!("{warning}");
    }
    for note in &results.notes {
        tracing::info!("{note}");
    }
    let flutter_table = flutter_table(&rows).map_err(|e| drawing(&e))?;
    let audits = results
        .machs
        .iter()
        .map(|m| audit_table(m).map_err(|e| drawing(&e)))
        .collect::<Result<Vec<_>, Stop>>()?;
    write_files(&folder, &results, &stamp, &flutter_table, &audits)?;
    let summary = Summary {
        command: "dlm correct",
        stamp,
        settings: case.flutter.document.text(),
        stop_reason: "done",
        boxes: results.aerodynamics.lattice().n_boxes(),
        flutter: rows,
        machs: results.machs.iter().map(|m| mach_summary(m, &results)).collect(),
        audit_failed,
        warnings,
        notes: &results.notes,
        stages: &results.stages,
        total: timer.seconds(),
    };
    folder.write_json(output::SUMMARY, &summary)?;
    if args.common.json {
        output::print(&output::json(&summary)?);
    } else {
        let mut text = flutter_table.plain();
        for table in &audits {
            text.push('\n');
            text.push_str(&table.plain());
        }
        output::print(&text);
        tracing::info!("results in {}", folder.path().display());
    }
    Ok(if summary.warnings.is_empty() {
        Done::Clean
    } else {
        Done::LookAt
    })
}

fn mach_summary<'a>(m: &'a MachCorrection, results: &CorrectionResults) -> MachSummary<'a> {
    let lattice = results.aerodynamics.lattice();
    let recordings = m.mapped.iter().map(|mapped| {
        let r = &mapped.reading;
        let loads = dip_correct::sample::strip_loads_of_boxes(lattice, &mapped.dcp);
        let (lift, moment): (dip_dlm::c64, dip_dlm::c64) = (loads.lift_m2.iter().sum(), loads.moment_m3.iter().sum());
        RecordingSummary {
            file: &r.label,
            coordinate: &r.name,
            unit: r.kind.unit(),
            omega_rad_s: r.omega_rad_s,
            reduced_frequency: r.k,
            amplitude: r.amplitude,
            cycles: r.quality.cycles,
            cycles_used: r.quality.cycles_used,
            cycle_change: r.quality.cycle_change,
            residual: r.quality.residual,
            higher_harmonics: &r.quality.higher,
            lift_m2: [lift.re, lift.im],
            pitching_moment_m3: [-moment.re, -moment.im],
        }
    });
    let weights = m
        .correction
        .recordings
        .iter()
        .zip(&m.phases)
        .map(|(at, (_, phases))| WeightSummary {
            reduced_frequency: at.k,
            downwash: at.weight.ratio.iter().map(|w| [w.re, w.im]).collect(),
            not_ratio: [
                ("downwash", &at.weight),
                ("pressure-ratio", &at.pressure),
                ("force", &at.force),
                ("additive", &at.gain),
            ]
            .into_iter()
            .flat_map(|(weight, diagonal)| treated(weight, diagonal))
            .collect(),
            section_lift: phases.clone(),
            condition: at.condition,
        });
    let forces = std::iter::once(("none", &m.correction.linear))
        .chain(m.correction.methods.iter().map(|c| (c.method.name(), &c.q)))
        .map(|(correction, q)| ForcesSummary {
            correction,
            reduced_frequencies: m.correction.k.clone(),
            q_m2: q
                .iter()
                .map(|q| {
                    let row = |i: usize| (0..q.columns()).map(|j| [q[(i, j)].re, q[(i, j)].im]).collect();
                    (0..q.rows()).map(row).collect()
                })
                .collect(),
        });
    MachSummary {
        mach: m.mach,
        recordings: recordings.collect(),
        weights: weights.collect(),
        audit: &m.audit,
        generalized_forces: forces.collect(),
    }
}

fn treated(weight: &'static str, diagonal: &Diagonal) -> Vec<BoxTreatment> {
    let boxes = diagonal.treatment.iter().enumerate();
    boxes
        .filter(|(_, t)| **t != Treatment::Ratio)
        .map(|(index, t)| BoxTreatment {
            index,
            weight,
            treatment: *t,
        })
        .collect()
}

/// Flutter points of all corrections.
fn flutter_table(rows: &[&CorrectedRow]) -> Result<Table, ReportError> {
    let mut table = Table::new(
        "Flutter",
        vec![
            Column::number("Mach", "", NumberFormat::Fixed(3)),
            Column::text("correction"),
            Column::text("method"),
            Column::number("density", "kg/m^3", NumberFormat::Fixed(5)),
            Column::number("speed", "m/s", NumberFormat::Fixed(2)),
            Column::number("change", "%", NumberFormat::Fixed(2)),
            Column::number("frequency", "Hz", NumberFormat::Fixed(3)),
            Column::number("FSI", "", NumberFormat::Fixed(4)),
            Column::number("k", "", NumberFormat::Fixed(4)),
            Column::text("rests on"),
        ],
    );
    for r in rows {
        let rests = r.rests_on.and_then(|p| serde_json::to_value(p).ok());
        table.push(vec![
            r.row.mach.into(),
            r.correction.into(),
            r.row.method.name().into(),
            r.row.density_kg_m3.into(),
            r.row.flutter_speed_m_s.into(),
            r.speed_change.map(|c| 100.0 * c).into(),
            r.row.flutter_frequency_hz.into(),
            r.row.flutter_speed_index.into(),
            r.row.reduced_frequency.into(),
            rests.as_ref().and_then(|v| v.as_str()).unwrap_or("").into(),
        ])?;
    }
    Ok(table)
}

/// All checks at one Mach number.
fn audit_table(m: &MachCorrection) -> Result<Table, ReportError> {
    let mut verdict = Column::text("verdict");
    verdict.align = Align::Left;
    let mut table = Table::new(
        format!("Audit, Mach {}", m.mach),
        vec![
            Column::text("check"),
            Column::text("of"),
            Column::number("value", "", NumberFormat::Significant(3)),
            Column::number("limit", "", NumberFormat::Significant(2)),
            Column::text("unit"),
            verdict,
            Column::text("what it says"),
        ],
    );
    for c in &m.audit.checks {
        let verdict = match c.verdict {
            Verdict::Pass => Cell::from("pass").good(),
            Verdict::Fail => Cell::from("FAIL").warning(),
            Verdict::NotRecorded => Cell::from("not recorded"),
        };
        table.push(vec![
            c.name.into(),
            c.subject.clone().into(),
            c.value.into(),
            c.limit.is_finite().then_some(c.limit).into(),
            c.unit.into(),
            verdict,
            c.words.clone().into(),
        ])?;
    }
    Ok(table)
}

/// Pictures, curves, and a page with all of it.
fn write_files(
    folder: &RunFolder,
    results: &CorrectionResults,
    stamp: &Stamp,
    flutter: &Table,
    audits: &[Table],
) -> Result<(), Stop> {
    let mut csv = String::from("mach,correction,method,mode,speed_m_s,density_kg_m3,g,frequency_hz,k,confidence\n");
    for s in results.machs.iter().flat_map(|m| &m.solutions) {
        for mode in &s.solution.modes {
            for p in &mode.points {
                csv.push_str(&format!(
                    "{},{},{},{},{},{},{},{},{},{}\n",
                    s.row.row.mach,
                    s.row.correction,
                    s.solution.method.name(),
                    mode.mode,
                    p.speed_m_s,
                    p.density_kg_m3,
                    p.g,
                    p.freq_hz,
                    p.k,
                    p.confidence
                ));
            }
        }
    }
    folder.write("vg.csv", csv.as_bytes())?;
    folder.write("weights.csv", weights_csv(results).as_bytes())?;
    let mut pictures = Vec::new();
    for drawn in figures::all(results)? {
        let svg = drawn.figure.svg(drawn.size.0, drawn.size.1).map_err(|e| drawing(&e))?;
        folder.write(&drawn.file, svg.as_bytes())?;
        pictures
            .push(Block::figure(&drawn.figure, drawn.size.0, drawn.size.1, drawn.caption).map_err(|e| drawing(&e))?);
    }
    let page = Page::new("Correction of the doublet lattice")
        .stamp("version", &stamp.version)
        .stamp("commit", &stamp.commit)
        .stamp("fingerprint", &stamp.fingerprint)
        .section("Flutter", vec![Block::Table(flutter.clone())])
        .section("Audit", audits.iter().cloned().map(Block::Table).collect())
        .section("Pictures", pictures);
    folder.write("report.html", page.html().as_bytes())?;
    Ok(())
}

/// dCp and weights of every box.
fn weights_csv(results: &CorrectionResults) -> String {
    let mut csv = String::from(
        "mach,k,box,x_m,y_m,z_m,dcp_recorded_re,dcp_recorded_im,dcp_linear_re,dcp_linear_im,w_re,w_im,treatment\n",
    );
    for m in &results.machs {
        for at in &m.correction.recordings {
            for (i, b) in results.aerodynamics.lattice().boxes().iter().enumerate() {
                let (r, l, w) = (at.recorded[i], at.linear[i], at.weight.ratio[i]);
                let treatment = match at.weight.treatment[i] {
                    Treatment::Ratio => "ratio",
                    Treatment::Additive => "additive",
                    Treatment::Bounded => "bounded",
                };
                let [x, y, z] = b.force_point;
                csv.push_str(&format!(
                    "{},{},{i},{x},{y},{z},{},{},{},{},{},{},{treatment}\n",
                    m.mach, at.k, r.re, r.im, l.re, l.im, w.re, w.im
                ));
            }
        }
    }
    csv
}
