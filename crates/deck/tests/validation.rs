//! Decks against published figures.
//!
//! The deck and MSC's printed results are read in place from the reference data beside the project (they are not ours to
//! copy); without that folder the first test says so and returns.

use std::path::{Path, PathBuf};

use dip_deck::run;
use dip_flutter::{CrossingKind, Direction};

fn reference() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/refdata/decks");
    if folder.is_dir() {
        Some(folder)
    } else {
        eprintln!("skipped: the reference decks are not here ({})", folder.display());
        None
    }
}

/// MSC Nastran's print of test problem PT145 (KE): every row, to the digits that are printed.
#[test]
fn msc_prints_of_the_swept_wing_are_met_row_by_row() {
    let Some(folder) = reference() else { return };
    let solution = run(folder.join("swept15_ke.bdf")).unwrap();
    let subcase = &solution.subcases[0];
    // Six digits are printed.
    for (mode, freq_hz) in [39.9615, 236.414, 250.442, 701.401, 703.42, 1153.11]
        .into_iter()
        .enumerate()
    {
        assert!(
            (subcase.modes.freq_hz(mode) / freq_hz - 1.0).abs() < 5e-6,
            "mode {}",
            mode + 1
        );
    }
    let table = std::fs::read_to_string(folder.join("swept15_ke_msc.csv")).unwrap();
    let mut rows = 0;
    for line in table.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit())) {
        let v: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
        let row = subcase.summaries[0].points[v[0] as usize - 1]
            .rows
            .iter()
            .find(|r| (r.k - v[1]).abs() < 1e-4)
            .unwrap_or_else(|| panic!("no row at k {}", v[1]));
        // The task asks for 1e-4; both programs print eight digits, and MSC computes in them.
        let pairs = [
            (row.velocity, v[2]),
            (row.damping, v[3]),
            (row.freq_hz, v[4]),
            (row.eigenvalue.re, v[5]),
            (row.eigenvalue.im, v[6]),
        ];
        for (got, needed) in pairs {
            assert!((got / needed - 1.0).abs() < 2e-6, "{line}: {got} {needed}");
        }
        rows += 1;
    }
    assert_eq!(rows, 27);
}

/// The plate wing against MSC's modes and ZAERO's flutter point of HA145E (as kept with pyNastran's ZAERO examples): 34.344,
/// 210.00, 260.43, 634.76 Hz; 479.43 ft/s and 111.70 Hz by the g-method with ZONA6. The element is not MSC's and the two-point
/// root is a coarse mesh, so the first mode is the one that differs most.
#[test]
fn the_plate_wing_is_near_the_published_one() {
    let solution = run(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/nastran/swept_plate.bdf")).unwrap();
    let subcase = &solution.subcases[0];
    for (mode, (freq_hz, tolerance)) in [(34.344, 0.06), (210.00, 0.03), (260.43, 0.02), (634.76, 0.03)]
        .into_iter()
        .enumerate()
    {
        let got = subcase.modes.freq_hz(mode);
        assert!(
            (got / freq_hz - 1.0).abs() < tolerance,
            "mode {}: {got} {freq_hz}",
            mode + 1
        );
    }
    let flutter = subcase.summaries[0]
        .crossings
        .iter()
        .find(|c| c.kind == CrossingKind::Flutter && c.direction == Direction::Onset)
        .unwrap();
    assert!((flutter.velocity / 479.43 - 1.0).abs() < 0.02, "{}", flutter.velocity);
    assert!((flutter.freq_hz / 111.70 - 1.0).abs() < 0.04, "{}", flutter.freq_hz);
}

/// Simcenter Nastran 2412's print of the two-mode flutter model of pyNastran (`models/aero/2_mode_flutter`,
/// `0012_flutter2.f06`; modes from `0012_flutter.f06`), PKNL at Mach 0.5.
///
/// Nastran stops its iteration at |delta k| < 0.001 (EPS of FLUTTER). Where that leaves a step of the printed damping
/// from row to row (point 2 before row 16), the rows are up to 0.4 % off the root, so only later ones are compared.
#[test]
fn simcenter_prints_of_the_two_mode_wing_are_met() {
    let deck = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/nastran/rigid_wing.bdf");
    let solution = run(deck).unwrap();
    let subcase = &solution.subcases[0];
    for (mode, freq_hz) in [2.667090, 10.62820].into_iter().enumerate() {
        assert!(
            (subcase.modes.freq_hz(mode) / freq_hz - 1.0).abs() < 1e-6,
            "mode {}",
            mode + 1
        );
    }
    // Point, row of our deck, printed damping and frequency in Hz.
    let printed = [
        (1, 0, -1.14076e-2, 2.74021),
        (1, 1, -1.86004e-2, 2.78558),
        (1, 2, -2.45757e-2, 2.82381),
        (1, 3, -2.59386e-2, 2.83304),
        (1, 4, -3.21615e-2, 2.87598),
        (2, 3, -1.42606e-2, 10.3622),
        (2, 4, -1.79100e-2, 10.2938),
    ];
    for (point, row, damping, freq_hz) in printed {
        let got = &subcase.summaries[0].points[point - 1].rows[row];
        assert!(
            (got.damping / damping - 1.0).abs() < 1e-4,
            "point {point}, row {row}: {got:?}"
        );
        assert!(
            (got.freq_hz / freq_hz - 1.0).abs() < 1e-5,
            "point {point}, row {row}: {got:?}"
        );
    }
}
