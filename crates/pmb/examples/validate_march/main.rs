//! Validation of the aeroelastic march: a section on springs against Possio's equation, Isogai's case A, AGARD 445.6. Writes
//! `docs/validation/march/`.
//!
//! `cargo run --release -p dip-pmb --example validate_march [-- section divergence isogai limit agard medium own reconstruction like static sensitivity confidence responses cost]`
//! (all by default; about an hour on one core). With no part that it knows, it only puts the page together.

mod agard;
mod boundary;
mod driver;
mod like;
mod position;
#[path = "../validate_unsteady/possio.rs"]
mod possio;
#[path = "../../../modal/tests/support/published.rs"]
mod published;
mod section;
mod springs;
mod trust;

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use dip_flutter::search::SearchSettings;
use dip_grid::{MultiBlock, recipe};
use driver::{Outcome, cpu_s};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A shipped recipe by name, or one of the tests'.
fn mesh(name: &str) -> Outcome<MultiBlock> {
    let file = format!("{name}.toml");
    let shipped = root().join("meshes").join(&file);
    let path = if shipped.is_file() {
        shipped
    } else {
        root().join("tests/data/flow").join(file)
    };
    Ok(recipe::make(&path)?)
}

fn search(first: f64, range: [f64; 2], tolerance: f64) -> SearchSettings {
    SearchSettings {
        range,
        first,
        tolerance,
        most_runs: 12,
    }
}

fn percent(found: f64, reference: f64) -> String {
    format!("{:+.2} %", 100.0 * (found / reference - 1.0))
}

type Part = (&'static str, fn(&Path) -> Outcome<String>);

const PARTS: [Part; 14] = [
    ("section", springs::section),
    ("divergence", springs::divergence),
    ("isogai", springs::isogai),
    ("limit", springs::limit),
    // What a point's error is made of: before the points.
    ("sensitivity", trust::sensitivity),
    ("confidence", trust::confidence),
    ("agard", boundary::agard_boundary),
    ("medium", boundary::agard_medium),
    ("own", boundary::agard_own),
    ("reconstruction", boundary::agard_reconstruction),
    ("like", like::like),
    ("static", position::static_position),
    ("responses", trust::responses),
    ("cost", trust::cost),
];

fn main() -> Outcome<()> {
    let folder = root().join("docs/validation/march");
    let parts = folder.join("parts");
    fs::create_dir_all(&parts)?;
    let asked: Vec<String> = std::env::args().skip(1).collect();
    for (name, work) in PARTS {
        if asked.is_empty() || asked.iter().any(|a| a == name) {
            let begin = cpu_s();
            let text = work(&folder)?;
            fs::write(parts.join(format!("{name}.md")), text)?;
            println!("{name}: {:.0} s of processor time", cpu_s() - begin);
        }
    }
    let mut page = String::from(
        "# The aeroelastic march\n\nWritten by `cargo run --release -p dip-pmb --example validate_march`. Exact checks (energy, order in time, static \
        position, restart) are in `crates/pmb/tests/verification/march.rs`, those of integrator, transfer and deformation on \
        `docs/validation/transfer`. Damping is read from all generalized coordinates while a march runs, which ends when it is known; the \
        next density follows from the trend; `+-` is the standard error of the point. CPU: processor seconds on one thread.\n\n",
    );
    for (name, _) in PARTS {
        if let Ok(text) = fs::read_to_string(parts.join(format!("{name}.md"))) {
            let _ = writeln!(page, "{text}");
        }
    }
    fs::write(folder.join("README.md"), page)?;
    Ok(())
}
