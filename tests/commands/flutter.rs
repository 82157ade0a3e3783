//! `dlm modes`, `dlm aic`, `dlm flutter` on good input.

use super::setup::CaseFolder;

#[test]
fn flutter_writes_its_summary() {
    let case = CaseFolder::small();
    let run = case
        .run("dlm", &["flutter", "flutter.toml", "--out", "out", "--json"])
        .exits(0);
    let printed: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let kept: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(case.path("out/summary.json")).unwrap()).unwrap();
    assert_eq!(printed, kept);
    let rows = printed["flutter"].as_array().unwrap();
    assert_eq!(rows.len(), 4);
    for row in rows {
        for key in [
            "mach",
            "density_kg_m3",
            "method",
            "flutter_speed_m_s",
            "flutter_frequency_hz",
            "flutter_speed_index",
            "mode",
            "omega_alpha_rad_s",
            "mass_kg",
            "time_s",
        ] {
            assert!(!row[key].is_null(), "{key} in {row}");
        }
    }
    // K, KE, PK and g are one equation at g = 0.
    let speed = |i: usize| rows[i]["flutter_speed_m_s"].as_f64().unwrap();
    for i in 1..4 {
        assert!(
            (speed(i) / speed(0) - 1.0).abs() < 1e-3,
            "{} and {}",
            speed(i),
            speed(0)
        );
    }
    for file in ["vg.csv", "summary.json"] {
        assert!(case.path("out").join(file).exists(), "{file}");
    }
}

#[test]
fn results_do_not_depend_on_threads() {
    let case = CaseFolder::small();
    case.run("dlm", &["flutter", "flutter.toml", "--out", "one", "--threads", "1"])
        .exits(0);
    case.run("dlm", &["flutter", "flutter.toml", "--out", "two", "--threads", "2"])
        .exits(0);
    let read = |folder: &str| std::fs::read_to_string(case.path(folder).join("vg.csv")).unwrap();
    assert_eq!(read("one"), read("two"));
}

#[test]
fn a_finished_run_of_other_inputs_is_kept() {
    let case = CaseFolder::small();
    case.run("dlm", &["modes", "structure.toml", "--out", "out"]).exits(0);
    case.run("dlm", &["modes", "structure.toml", "--out", "out"]).exits(0);
    let other = ["modes", "structure.toml", "--out", "out", "--set", "modes.count=3"];
    case.run("dlm", &other).exits(2).says(&["--force"]);
    case.run("dlm", &[&other[..], &["--force"]].concat()).exits(0);
}

#[test]
fn modes_are_printed_and_read_back() {
    let case = CaseFolder::small();
    let run = case
        .run("dlm", &["modes", "structure.toml", "--out", "modes", "--json"])
        .exits(0);
    let summary: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let frequencies: Vec<String> = summary["frequencies_hz"]
        .as_array()
        .unwrap()
        .iter()
        .take(4)
        .map(|f| format!("\"{f} Hz\""))
        .collect();
    case.edit(
        "flutter.toml",
        "structure = \"structure.toml\"",
        &format!("file = \"modes/modes.csv\"\nfrequencies = [{}]", frequencies.join(", ")),
    );
    let read = case
        .run("dlm", &["flutter", "flutter.toml", "--out", "a", "--json"])
        .exits(0);
    let own = CaseFolder::small()
        .run("dlm", &["flutter", "flutter.toml", "--out", "b", "--json"])
        .exits(0);
    let speed = |text: &str| {
        let v: serde_json::Value = serde_json::from_str(text).unwrap();
        v["flutter"][0]["flutter_speed_m_s"].as_f64().unwrap()
    };
    assert!((speed(&read.stdout) / speed(&own.stdout) - 1.0).abs() < 1e-6);
}

#[test]
fn generalized_forces_are_listed() {
    let case = CaseFolder::small();
    let run = case
        .run("dlm", &["aic", "flutter.toml", "--out", "out", "--json"])
        .exits(0);
    let summary: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let list = summary["generalized_forces"].as_array().unwrap();
    assert_eq!(list.len(), 8);
    assert_eq!(list[0]["q_m2"].as_array().unwrap().len(), 4);
}

#[test]
fn a_matched_point_lies_on_the_atmosphere() {
    let case = CaseFolder::small();
    case.edit(
        "flutter.toml",
        "methods = [\"pk\", \"k\", \"ke\", \"g\"]",
        "methods = [\"pk\", \"g\"]",
    );
    case.edit(
        "flutter.toml",
        "densities = [\"0.20821 kg/m^3\"]",
        "search = \"matched-point\"",
    );
    let run = case
        .run("dlm", &["flutter", "flutter.toml", "--out", "out", "--json"])
        .exits(0);
    let summary: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let row = &summary["flutter"][0];
    let (h, u) = (
        row["altitude_m"].as_f64().unwrap(),
        row["flutter_speed_m_s"].as_f64().unwrap(),
    );
    let air = dip_case::atmosphere::standard(h).unwrap();
    assert!((u / (0.678 * air.speed_of_sound_m_s) - 1.0).abs() < 1e-6, "{row}");
    assert!(
        (row["density_kg_m3"].as_f64().unwrap() / air.density_kg_m3 - 1.0).abs() < 1e-6,
        "{row}"
    );
}

#[test]
fn measured_frequencies_take_the_place_of_computed_ones() {
    let case = CaseFolder::small();
    let run = case
        .run("dlm", &["flutter", "flutter.toml", "--out", "own", "--json"])
        .exits(0);
    let own: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    // All frequencies higher by a tenth: at the same density and reduced frequencies flutter is at a speed higher by a tenth.
    let raised: Vec<String> = own["natural_frequencies_hz"]
        .as_array()
        .unwrap()
        .iter()
        .map(|f| format!("\"{} Hz\"", 1.1 * f.as_f64().unwrap()))
        .collect();
    let list = format!("modes.frequencies=[{}]", raised.join(", "));
    let run = case
        .run(
            "dlm",
            &["flutter", "flutter.toml", "--out", "raised", "--json", "--set", &list],
        )
        .exits(0);
    let other: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    for key in ["flutter_speed_m_s", "flutter_frequency_hz"] {
        let of = |v: &serde_json::Value| v["flutter"][0][key].as_f64().unwrap();
        assert!(
            (of(&other) / of(&own) / 1.1 - 1.0).abs() < 1e-5,
            "{key}: {} {}",
            of(&own),
            of(&other)
        );
    }
    let few = format!("modes.frequencies=[{}]", raised[0]);
    case.run("dlm", &["flutter", "flutter.toml", "--out", "few", "--set", &few])
        .exits(2)
        .says(&["1 frequencies for the structure's"]);
}
