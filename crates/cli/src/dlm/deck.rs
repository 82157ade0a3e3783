//! `dlm flutter DECK`: a Nastran SOL 145 deck as it is, in its own units.

use crate::exit::{Done, Stop};
use crate::figures;
use crate::options::Common;
use crate::output::{self, RunFolder};
use crate::progress::{Seconds, Timer};
use crate::stamp::{Fingerprint, Stamp};
use crate::traces::MachCurves;
use dip_deck::flutter::Summary as FlutterSummary;
use dip_deck::print::{generalized_forces, method_name};
use dip_deck::{Solution, SubcaseResult};
use dip_flutter::{KRange, Warning};
use dip_nastran::modes::read_modes;
use dip_nastran::{Deck, Severity};
use serde::Serialize;
use std::path::Path;

/// What `summary.json` holds.
#[derive(Debug, Serialize)]
struct Summary {
    command: &'static str,
    stamp: Stamp,
    stop_reason: &'static str,
    /// A deck has no units of its own: speeds are in its unit over PARAM VREF, frequencies in Hz.
    units: &'static str,
    subcases: Vec<SubcaseSummary>,
    warnings: Vec<String>,
    notes: Vec<String>,
    total: Seconds,
}

#[derive(Debug, Serialize)]
struct SubcaseSummary {
    subcase: u32,
    natural_frequencies_hz: Vec<f64>,
    modes_used: usize,
    generalized_forces: Vec<Forces>,
    flutter: Vec<Point>,
    crossings: Vec<Crossing>,
}

/// Q over one Mach number and reduced frequency, in the deck's unit of area.
#[derive(Debug, Serialize)]
struct Forces {
    mach: f64,
    reduced_frequency: f64,
    q: Vec<Vec<[f64; 2]>>,
}

/// One printed row of a flutter summary.
#[derive(Debug, Serialize)]
struct Point {
    method: String,
    mach: f64,
    density_ratio: f64,
    point: usize,
    kfreq: f64,
    velocity: f64,
    damping: f64,
    frequency_hz: f64,
    eigenvalue: [f64; 2],
}

#[derive(Debug, Serialize)]
struct Crossing {
    mach: f64,
    density_ratio: f64,
    kind: String,
    direction: String,
    velocity: f64,
    frequency_hz: f64,
}

/// Runs a deck.
pub fn run(path: &Path, modes: Option<&Path>, common: &Common) -> Result<Done, Stop> {
    let timer = Timer::start();
    if !common.set.is_empty() {
        return Err(Stop::input(
            "--set does not reach into a deck",
            "edit the deck, or use a case file",
        ));
    }
    let deck = Deck::read(path).map_err(|e| Stop::input(e.to_string(), "correct the deck at the lines named"))?;
    let mut fingerprint = Fingerprint::new();
    // The deck as understood stands for its INCLUDE files too.
    fingerprint
        .file(path.to_path_buf())
        .text(&format!("{:?}{:?}", deck.control, deck.bulk));
    if let Some(file) = modes {
        fingerprint.file(file.to_path_buf());
    }
    let stamp = fingerprint.stamp();
    let folder = RunFolder::open(&common.folder(path), &stamp, common.force)?;
    let solution = match modes {
        None => dip_deck::solve(&deck),
        Some(file) => {
            let table = read_modes(file).map_err(|e| {
                Stop::input(
                    format!("{}: {e}", file.display()),
                    "give an f06, punch or op2 with real eigenvectors",
                )
            })?;
            dip_deck::solve_with_modes(&deck, &table)
        }
    }
    .map_err(|e| Stop::input(e.to_string(), "correct the deck"))?;

    let said = |severity: Severity| {
        solution
            .notes
            .iter()
            .filter(move |n| n.severity == severity)
            .map(ToString::to_string)
    };
    let mut warnings: Vec<String> = said(Severity::Warning).collect();
    for s in solution.subcases.iter().flat_map(|s| &s.summaries) {
        warnings.extend(s.warnings.iter().map(ToString::to_string));
    }
    for warning in &warnings {
        tracing::warn!("{warning}");
    }
    let notes: Vec<String> = said(Severity::Ignored).collect();
    for note in &notes {
        tracing::debug!("{note}");
    }
    let summary = Summary {
        command: "dlm flutter",
        stamp,
        stop_reason: "done",
        units: "the deck's own; velocities over PARAM VREF; frequencies in Hz",
        subcases: solution.subcases.iter().map(subcase).collect(),
        warnings,
        notes,
        total: timer.seconds(),
    };
    let text = solution.text();
    folder.write("flutter.txt", text.as_bytes())?;
    for s in &solution.subcases {
        let mut qhh = String::new();
        // Writing to a string cannot fail.
        let _ = generalized_forces(&mut qhh, &s.forces);
        folder.write(&format!("qhh_subcase{}.txt", s.id), qhh.as_bytes())?;
        for (i, f) in s.summaries.iter().enumerate() {
            let Some(curves) = &f.solution else { continue };
            let figure = figures::vg(&MachCurves::new(curves), "Speed, the deck's unit")?;
            let svg = figure.svg(760, 760).map_err(|e| figures::drawing(&e))?;
            folder.write(&format!("vg_subcase{}_{}.svg", s.id, i + 1), svg.as_bytes())?;
        }
    }
    folder.write_json(output::SUMMARY, &summary)?;
    if common.json {
        output::print(&output::json(&summary)?);
    } else {
        output::print(&text);
        tracing::info!("results in {}", folder.path().display());
    }
    Ok(if look_at(&solution) { Done::LookAt } else { Done::Clean })
}

/// True where the user must look: a note that says so, a root that was lost or is uncertain, a crossing that rests on no data.
/// Rows beyond the reduced frequencies of the MKAERO cards are warned of, but they are how decks list their curves.
fn look_at(solution: &Solution) -> bool {
    let curves = |s: &FlutterSummary| match &s.solution {
        None => !s.warnings.is_empty(),
        Some(f) => {
            f.warnings.iter().any(|w| !matches!(w, Warning::OutOfRange { .. }))
                || f.crossings.iter().any(|c| c.k_range != KRange::Inside)
        }
    };
    solution.notes.iter().any(|n| n.severity == Severity::Warning)
        || solution.subcases.iter().flat_map(|s| &s.summaries).any(curves)
}

fn subcase(result: &SubcaseResult) -> SubcaseSummary {
    let forces = result.forces.iter().map(|f| {
        let row = |i: usize| {
            (0..f.q.columns())
                .map(|j| f.q.column(j)[i])
                .map(|q| [q.re, q.im])
                .collect()
        };
        Forces {
            mach: f.mach,
            reduced_frequency: f.k,
            q: (0..f.q.rows()).map(row).collect(),
        }
    });
    let mut flutter = Vec::new();
    let mut crossings = Vec::new();
    for s in &result.summaries {
        for p in &s.points {
            flutter.extend(p.rows.iter().map(|r| Point {
                method: method_name(s.method).to_owned(),
                mach: r.mach,
                density_ratio: r.density_ratio,
                point: p.number,
                kfreq: r.k,
                velocity: r.velocity,
                damping: r.damping,
                frequency_hz: r.freq_hz,
                eigenvalue: [r.eigenvalue.re, r.eigenvalue.im],
            }));
        }
        crossings.extend(s.crossings.iter().map(|c| Crossing {
            mach: c.mach,
            density_ratio: c.density_ratio,
            kind: format!("{:?}", c.kind).to_lowercase(),
            direction: format!("{:?}", c.direction).to_lowercase(),
            velocity: c.velocity,
            frequency_hz: c.freq_hz,
        }));
    }
    SubcaseSummary {
        subcase: result.id,
        natural_frequencies_hz: (0..result.modes.count()).map(|m| result.modes.freq_hz(m)).collect(),
        modes_used: result.used_modes,
        generalized_forces: forces.collect(),
        flutter,
        crossings,
    }
}
