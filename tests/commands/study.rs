//! `dip compare` and `dip run`.

use super::setup::CaseFolder;

#[test]
fn compare_computes_reports_and_keeps() {
    let case = CaseFolder::small();
    let run = case.run("dip", &["compare", "boundary.toml", "--out", "out"]).exits(0);
    assert!(
        run.stdout.contains("0.678") && run.stdout.contains("experiment"),
        "{}",
        run.stdout
    );
    let html = std::fs::read_to_string(case.path("out/report.html")).unwrap();
    assert!(html.contains("<svg"), "figures are inside");
    assert!(
        !html.contains("http://") || !html.contains("<script src"),
        "nothing is loaded from elsewhere"
    );
    assert!(case.path("out/boundary.svg").exists());
    // The second time nothing is computed.
    let again = case.run("dip", &["compare", "boundary.toml", "--out", "out"]).exits(0);
    assert!(again.stderr.contains("kept from"), "{}", again.stderr);
    assert_eq!(again.stdout.lines().next(), run.stdout.lines().next());
}

#[test]
fn compare_prints_json() {
    let case = CaseFolder::small();
    let run = case
        .run("dip", &["compare", "boundary.toml", "--out", "out", "--json"])
        .exits(0);
    let summary: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let row = &summary["points"][0];
    assert_eq!(row["mach"], 0.678);
    let error = row["speed_error_percent"].as_f64().unwrap();
    assert!(error.abs() < 10.0, "{row}");
}

#[test]
fn a_study_with_a_missing_case_names_it() {
    let case = CaseFolder::small();
    case.edit("boundary.toml", "case = \"flutter.toml\"", "case = \"fluter.toml\"");
    case.run("dip", &["compare", "boundary.toml"])
        .exits(2)
        .says(&["fluter.toml", "cannot read"]);
}

#[test]
fn a_mach_number_that_the_case_lacks() {
    let case = CaseFolder::small();
    case.edit("boundary.toml", "mach = [0.678]", "mach = [0.678, 0.8]");
    case.run("dip", &["compare", "boundary.toml"])
        .exits(2)
        .says(&["boundary.toml:", "Mach 0.8"]);
}

#[test]
fn schemas_are_json() {
    let case = CaseFolder::small();
    for kind in ["wing", "structure", "flutter", "study"] {
        let run = case.run("dip", &["schema", kind]).exits(0);
        let schema: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
        assert!(schema["properties"].is_object(), "{kind}");
    }
    case.run("dip", &["schema", "wings"]).exits(2).says(&["wing"]);
}

/// PanelAero (quartic kernel, 10 x 20 boxes, Yates' modes, the experiment's densities, g = 0), computed for this project's
/// reference data: `cases/agard445/published/panelaero_dlm.csv`. The splines differ: within 1 %.
#[test]
fn the_shipped_study_meets_panelaero() {
    let case = CaseFolder::lattice();
    let run = case
        .run("dip", &["compare", "boundary.toml", "--out", "out", "--json"])
        .exits(0);
    let summary: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let points = summary["points"].as_array().unwrap();
    let published = [
        (0.499, 0.4508),
        (0.678, 0.4292),
        (0.901, 0.3705),
        (0.954, 0.3332),
        (0.960, 0.3287),
    ];
    for (mach, index) in published {
        let point = points
            .iter()
            .find(|p| p["curve"] == "DLM, Yates' modes" && p["mach"] == mach)
            .unwrap();
        let ours = point["flutter_speed_index"].as_f64().unwrap();
        assert!(
            (ours / index - 1.0).abs() < 0.01,
            "Mach {mach}: {ours}, PanelAero {index}"
        );
    }
}

/// Lattice, recordings, correction and march in one study, on a small grid at Mach 0.678, where all must agree within some per cent.
#[test]
fn a_whole_study_records_corrects_and_marches() {
    let case = CaseFolder::flow();
    let run = case.run("dip", &["compare", "boundary.toml", "--out", "out", "--json"]);
    assert!(run.code == 0 || run.code == 3, "{}", run.stderr);
    let summary: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let points = summary["points"].as_array().unwrap();
    let index = |curve: &str| -> f64 {
        let point = points.iter().find(|p| p["curve"] == curve).unwrap();
        point["flutter_speed_index"].as_f64().unwrap()
    };
    let lattice = index("DLM, Yates' modes");
    for curve in [
        "DLM corrected by pitch, Yates' modes",
        "DLM corrected by mode 1, Yates' modes",
        "Euler march, Yates' modes",
    ] {
        let ratio = index(curve) / lattice;
        assert!((ratio - 1.0).abs() < 0.06, "{curve}: {ratio}");
    }
    let page = std::fs::read_to_string(case.path("out/report.html")).unwrap();
    assert!(page.contains("Time per flutter point") && page.contains("Audit of the hand-over"));
    // Subcritical damping of the march beside that of the lattice, mode by mode.
    assert!(page.contains("Subcritical damping"));
    let beside = std::fs::read_to_string(case.path("out/damping_M0.678.svg")).unwrap();
    assert!(
        beside.contains("Euler march, Yates' modes, mode 1")
            || beside.contains("Euler march, Yates&#39; modes, mode 1")
    );
    assert!(beside.matches("mode 1").count() >= 4, "the lattice's curve is missing");
    // A curve that is lost is made again from the recordings, which are kept.
    std::fs::remove_file(case.path("out/dlm-corrected-by-pitch-yates-modes/summary.json")).unwrap();
    let again = case.run("dip", &["compare", "boundary.toml", "--out", "out", "--json"]);
    assert!(
        again.stderr.matches("pitch.mcap: kept").count() == 2,
        "{}",
        again.stderr
    );
    let second: serde_json::Value = serde_json::from_str(&again.stdout).unwrap();
    for (a, b) in points.iter().zip(second["points"].as_array().unwrap()) {
        assert_eq!(a["flutter_speed_index"], b["flutter_speed_index"]);
    }
}
