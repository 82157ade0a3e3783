//! A Nastran SOL 145 deck made into our structure, lattice and flutter solution.
//!
//! [`solve`] takes a deck that [`dip_nastran`] has read and gives, for every subcase, the normal modes, the generalized
//! aerodynamic forces and the flutter summaries. Nastran's conventions are followed: the box moves as a rigid plate with its
//! mid-chord, beam splines leave the gradient of the twist out, the kernel is parabolic with Laschka's sum, densities multiply
//! AERO's reference density, reduced frequencies rest on half of AERO's reference chord.
//!
//! # Units
//! A deck is in whatever consistent units its author chose, with time in seconds. Everything here is in those units;
//! frequencies are in Hz, velocities in the deck's unit over PARAM VREF. The crates below name SI units in their fields
//! (`speed_m_s`); in this crate they hold the deck's.

pub mod aerodynamics;
pub mod coordinate;
mod damping;
mod error;
pub mod flutter;
pub mod interpolation;
pub mod modes;
pub mod print;
mod residual;
mod splines;
mod strip;
pub mod structure;

use std::fmt::Write;

use dip_dlm::lattice::PlaneSymmetry;
use dip_modal::Modes;
use dip_nastran::{Deck, Note, Severity, case_control::Subcase, modes::ModeTable};

pub use error::{Result, SolveError};

use crate::{
    aerodynamics::{AeroModel, GeneralizedForces},
    coordinate::Geometry,
    flutter::{Problem, Summary},
};

/// Everything that was computed for one subcase.
#[derive(Debug, Clone)]
pub struct SubcaseResult {
    /// Its number; 0 if the deck has none.
    pub id: u32,
    /// TITLE, SUBTITLE and LABEL.
    pub titles: [String; 3],
    /// All modes that METHOD asked for.
    pub modes: Modes,
    /// Number of modes that flutter used, the lowest of them (or those from LFREQ on).
    pub used_modes: usize,
    /// Generalized forces of the used modes, in the order of the MKAERO cards.
    pub forces: Vec<GeneralizedForces>,
    /// Symmetry about the planes y = 0 and z = 0 of the aerodynamic coordinate system.
    pub symmetry: [PlaneSymmetry; 2],
    /// One summary for each Mach number and density.
    pub summaries: Vec<Summary>,
}

/// Everything that was computed from a deck.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Results of the subcases, in order.
    pub subcases: Vec<SubcaseResult>,
    /// The deck's notes and those of the solution.
    pub notes: Vec<Note>,
}

impl Solution {
    /// The first onset of flutter or divergence with the lowest velocity over all subcases, with its subcase.
    pub fn first_onset(&self) -> Option<(&SubcaseResult, &flutter::Crossing)> {
        self.subcases
            .iter()
            .flat_map(|s| {
                s.summaries
                    .iter()
                    .flat_map(move |m| m.crossings.iter().map(move |c| (s, c)))
            })
            .filter(|(_, c)| c.direction == dip_flutter::Direction::Onset)
            .min_by(|a, b| a.1.velocity.total_cmp(&b.1.velocity))
    }

    /// The whole solution as text in the layout of Nastran's print file.
    pub fn text(&self) -> String {
        let mut out = String::new();
        for subcase in &self.subcases {
            // Writing to a string cannot fail.
            let _ = write_subcase(&mut out, subcase);
        }
        out
    }
}

fn write_subcase(out: &mut String, subcase: &SubcaseResult) -> std::fmt::Result {
    for title in subcase.titles.iter().filter(|t| !t.is_empty()) {
        writeln!(out, " {title}")?;
    }
    if subcase.id > 0 {
        writeln!(out, " SUBCASE {}", subcase.id)?;
    }
    print::eigenvalues(out, &subcase.modes)?;
    for summary in &subcase.summaries {
        print::summary(out, summary, subcase.symmetry)?;
        print::crossings(out, &summary.crossings)?;
        for warning in &summary.warnings {
            writeln!(out, "warning: {warning}")?;
        }
    }
    Ok(())
}

/// Statements of a subcase that its modes depend on.
const STRUCTURE_SETTINGS: [&str; 8] = ["RESVEC", "METHOD", "SPC", "MPC", "SUPORT1", "K2GG", "M2GG", "B2GG"];
/// Statements that its aerodynamics depend on besides.
const AERO_SETTINGS: [&str; 2] = ["AESYMXZ", "AESYMXY"];

fn same(a: &Subcase, b: &Subcase, names: &[&str]) -> bool {
    names.iter().all(|n| a.text(n) == b.text(n))
}

/// What one subcase may take over from an earlier one.
struct Done {
    subcase: Subcase,
    modes: Modes,
    used: Modes,
    aero: AeroModel,
    forces: Vec<GeneralizedForces>,
}

/// Solves a deck.
///
/// # Errors
/// What is missing or does not fit, with file and line where it stands on one.
pub fn solve(deck: &Deck) -> Result<Solution> {
    solve_from(deck, None)
}

/// Solves a deck with modes from a file instead of its own structure; SPC, MPC and METHOD have no effect then.
///
/// # Errors
/// As [`solve`], and points of the modes that the deck does not have.
pub fn solve_with_modes(deck: &Deck, modes: &ModeTable) -> Result<Solution> {
    solve_from(deck, Some(modes))
}

fn solve_from(deck: &Deck, file: Option<&ModeTable>) -> Result<Solution> {
    let bulk = &deck.bulk;
    let mut notes = deck.notes.clone();
    if let Some((number, at)) = &deck.control.solution
        && *number != 145
    {
        notes.push(Note {
            at: at.clone(),
            card: "SOL".to_owned(),
            severity: Severity::Warning,
            text: format!("solution {number} is not flutter (145); the deck is solved as flutter"),
        });
    }
    for name in ["WKK", "FA2J", "W2GJ"] {
        if let Some(matrix) = bulk.plain_matrices.get(name) {
            if name == "WKK" {
                return Err(error::misfit(
                    &matrix.at,
                    "DMI WKK",
                    "correction factors on the aerodynamics are not applied; remove it",
                ));
            }
            notes.push(Note {
                at: matrix.at.clone(),
                card: format!("DMI {name}"),
                severity: Severity::Ignored,
                text: "belongs to static aeroelasticity and has no effect on flutter".to_owned(),
            });
        }
    }
    let geometry = Geometry::new(bulk)?;
    let mut done: Vec<Done> = Vec::new();
    let mut subcases = Vec::new();
    for subcase in &deck.control.subcases {
        let Some((set, at)) = structure::selected(subcase, "FMETHOD")? else {
            if deck.control.subcases.len() > 1 {
                continue;
            }
            return Err(SolveError::Missing {
                what: "selects no flutter solution; add FMETHOD = n to the case control section".to_owned(),
            });
        };
        let request = bulk
            .flutters
            .get(&set)
            .ok_or_else(|| error::missing(&at, format!("FMETHOD = {set}"), "FLUTTER", set))?;
        let all: Vec<&str> = STRUCTURE_SETTINGS.iter().chain(&AERO_SETTINGS).copied().collect();
        let place = match done.iter().position(|d| same(&d.subcase, subcase, &all)) {
            Some(place) => place,
            None => {
                done.push(prepare(deck, &geometry, subcase, file, &mut notes)?);
                done.len() - 1
            }
        };
        let known = &done[place];
        let structure = damping::generalized_structure(bulk, &known.used, subcase, &mut notes)?;
        let problem = Problem {
            bulk,
            structure: &structure,
            forces: &known.forces,
            semichord: known.aero.semichord,
            reference_density: known.aero.density,
        };
        let summaries = problem.solve(request, &mut notes)?;
        subcases.push(SubcaseResult {
            id: subcase.id,
            titles: ["TITLE", "SUBTITLE", "LABEL"].map(|n| subcase.text(n).unwrap_or("").to_owned()),
            modes: known.modes.clone(),
            used_modes: known.used.count(),
            forces: known.forces.clone(),
            symmetry: known.aero.symmetry,
            summaries,
        });
    }
    if subcases.is_empty() {
        return Err(SolveError::Missing {
            what: "selects no flutter solution (FMETHOD) in any subcase".to_owned(),
        });
    }
    Ok(Solution { subcases, notes })
}

/// Modes and generalized forces of a subcase.
fn prepare(
    deck: &Deck,
    geometry: &Geometry,
    subcase: &Subcase,
    file: Option<&ModeTable>,
    notes: &mut Vec<Note>,
) -> Result<Done> {
    let bulk = &deck.bulk;
    if bulk.mach_k.is_empty() {
        return Err(SolveError::Missing {
            what: "has no MKAERO1 or MKAERO2 card; aerodynamics need Mach numbers and reduced frequencies".to_owned(),
        });
    }
    if let Some((pair, at)) = bulk
        .mach_k
        .iter()
        .zip(&bulk.mach_k_at)
        .find(|(pair, _)| pair.mach >= 1.0)
        && !bulk.panels.is_empty()
    {
        let what = format!(
            "Mach number {}: the doublet lattice needs 0 <= M < 1; leave the supersonic ones out of the card",
            pair.mach
        );
        return Err(error::misfit(at, "MKAERO1 or MKAERO2", what));
    }
    let aero = AeroModel::new(bulk, geometry, subcase, notes)?;
    let modes = match file {
        Some(table) => modes::modes_of_file(bulk, geometry, table)?,
        None => {
            let model = structure::model(bulk, geometry, subcase, notes)?;
            modes::normal_modes(bulk, &model, subcase, notes)?
        }
    };
    let used = modes::used(bulk, &modes)?;
    let forces = aero.generalized_forces(&used, &bulk.mach_k)?;
    Ok(Done {
        subcase: subcase.clone(),
        modes,
        used,
        aero,
        forces,
    })
}

/// Reads and solves a deck.
///
/// # Errors
/// As [`Deck::read`] and [`solve`].
pub fn run(path: impl AsRef<std::path::Path>) -> Result<Solution> {
    solve(&Deck::read(path)?)
}
