//! `dlm flutter DECK`: Nastran decks at the process boundary.

use super::setup::CaseFolder;
use std::path::{Path, PathBuf};

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/nastran")
        .join(name)
}

/// A shipped deck in a folder of its own.
fn with_deck(name: &str) -> CaseFolder {
    let case = CaseFolder::small();
    std::fs::copy(shipped(name), case.path("wing.bdf")).unwrap();
    case
}

#[test]
fn a_deck_prints_its_flutter_summary() {
    let case = with_deck("swept_plate.bdf");
    let run = case.run("dlm", &["flutter", "wing.bdf", "--out", "out"]);
    assert!(run.code == 0 || run.code == 3, "{run:?}");
    assert!(
        run.stdout.contains("FLUTTER") && run.stdout.contains("KFREQ"),
        "{}",
        run.stdout
    );
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(case.path("out/summary.json")).unwrap()).unwrap();
    let subcase = &summary["subcases"][0];
    assert!(!subcase["flutter"].as_array().unwrap().is_empty());
    assert!(!subcase["generalized_forces"].as_array().unwrap().is_empty());
    let frequency = subcase["natural_frequencies_hz"][0].as_f64().unwrap();
    assert!(frequency > 1.0, "{frequency}");
}

#[test]
fn an_unknown_card_is_named_with_its_line() {
    let case = with_deck("swept_plate.bdf");
    let text = std::fs::read_to_string(case.path("wing.bdf")).unwrap();
    let marked = text.replacen("BEGIN BULK", "BEGIN BULK\nCQUADX,1,2,3,4", 1);
    assert_ne!(text, marked);
    let line = marked.lines().position(|l| l.starts_with("CQUADX")).unwrap() + 1;
    std::fs::write(case.path("wing.bdf"), marked).unwrap();
    case.run("dlm", &["flutter", "wing.bdf"])
        .exits(2)
        .says(&["CQUADX", &format!("wing.bdf:{line}")]);
}

#[test]
fn a_field_that_is_no_number_is_named() {
    let case = with_deck("swept_plate.bdf");
    let text = std::fs::read_to_string(case.path("wing.bdf")).unwrap();
    let marked = text.replacen("BEGIN BULK", "BEGIN BULK\nGRID,99999,,1.0,zwei,0.0", 1);
    let line = marked.lines().position(|l| l.starts_with("GRID,99999")).unwrap() + 1;
    std::fs::write(case.path("wing.bdf"), marked).unwrap();
    case.run("dlm", &["flutter", "wing.bdf"])
        .exits(2)
        .says(&["GRID", "ZWEI", &format!("wing.bdf:{line}")]);
}

#[test]
fn a_missing_include_is_named() {
    let case = with_deck("swept_plate.bdf");
    case.edit("wing.bdf", "BEGIN BULK", "BEGIN BULK\nINCLUDE 'nowhere.bdf'");
    case.run("dlm", &["flutter", "wing.bdf"])
        .exits(2)
        .says(&["nowhere.bdf"]);
}

#[test]
fn settings_do_not_reach_into_a_deck() {
    let case = with_deck("swept_plate.bdf");
    case.run("dlm", &["flutter", "wing.bdf", "--set", "flow.mach=0.5"])
        .exits(2)
        .says(&["--set"]);
}

/// A mode file without modes, and one beside a case file, are refused.
#[test]
fn mode_files_that_cannot_serve_are_refused() {
    let case = with_deck("swept_plate.bdf");
    std::fs::write(case.path("none.pch"), "$TITLE\n").unwrap();
    case.run("dlm", &["flutter", "wing.bdf", "--modes", "none.pch"])
        .exits(2)
        .says(&["none.pch"]);
    case.run("dlm", &["flutter", "flutter.toml", "--modes", "none.pch"])
        .exits(2)
        .says(&["--modes"]);
}

#[test]
fn a_supersonic_mach_number_of_a_deck_is_named() {
    let case = with_deck("swept_plate.bdf");
    let text = std::fs::read_to_string(case.path("wing.bdf")).unwrap();
    let marked = text.replacen("BEGIN BULK", "BEGIN BULK\nMKAERO1,1.3,,,,,,,,+MK\n+MK,0.1", 1);
    let line = marked.lines().position(|l| l.starts_with("MKAERO1,1.3")).unwrap() + 1;
    std::fs::write(case.path("wing.bdf"), marked).unwrap();
    case.run("dlm", &["flutter", "wing.bdf"])
        .exits(2)
        .says(&["MKAERO1", "M < 1", &format!("wing.bdf:{line}")]);
}
