//! `pmb march` on a small grid: the flutter point, going on with a search, refusals.

use super::setup::CaseFolder;
use serde_json::Value;

fn json(case: &CaseFolder, file: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(case.path(file)).unwrap()).unwrap()
}

#[test]
fn a_search_finds_the_flutter_point_and_goes_on_to_the_same_one() {
    let case = CaseFolder::flow();
    let run = case.run("pmb", &["march", "march.toml", "--out", "whole", "-q"]);
    assert!(run.code == 0 || run.code == 3, "{}", run.stderr);
    let whole = json(&case, "whole/summary.json");
    let point = &whole["flutter"][0];
    // Mode 1 (9.6 Hz) meets mode 2 (38.2 Hz); the measured density is 0.208.
    let frequency = point["flutter_frequency_hz"].as_f64().unwrap();
    assert!((9.6..38.2).contains(&frequency), "{frequency}");
    let density = point["density_kg_m3"].as_f64().unwrap();
    assert!((density / 0.208 - 1.0).abs() < 0.3, "{density}");
    assert_eq!(point["method"], "march");
    for file in ["damping.svg", "march_1.svg", "march_1.csv", "trials.json"] {
        assert!(case.path("whole").join(file).exists(), "{file}");
    }
    case.run("dip", &["info", "whole/march_1.mcap"]).exits(0);
    case.run("dip", &["doctor", "whole/march_1.mcap"]).exits(0);

    // As a kill in the second run leaves it: the first density finished, the second one to be done again.
    case.run("pmb", &["march", "march.toml", "--out", "broken", "-q"]);
    std::fs::remove_file(case.path("broken/summary.json")).unwrap();
    std::fs::remove_file(case.path("broken/march_2.pmb")).unwrap();
    let mut trials = json(&case, "broken/trials.json");
    trials[1].as_array_mut().unwrap().truncate(1);
    std::fs::write(case.path("broken/trials.json"), trials.to_string()).unwrap();
    let resumed = case.run("pmb", &["march", "march.toml", "--out", "broken", "--resume"]);
    assert!(resumed.stderr.contains("kept"), "{}", resumed.stderr);
    let second = json(&case, "broken/summary.json");
    assert_eq!(point["density_kg_m3"], second["flutter"][0]["density_kg_m3"]);
    let bytes = |folder: &str| std::fs::read(case.path(folder).join("march_2.mcap")).unwrap();
    assert!(bytes("whole") == bytes("broken"), "the recordings differ");
}

#[test]
fn what_is_wrong_in_a_march_is_named() {
    let case = CaseFolder::flow();
    for (set, words) in [
        ("march.steps_per_cycle=2", "march"),
        ("march.start_mode=9", "mode 9: there are 4"),
        ("modes.count=12", "frequencies"),
        ("search.tolerance=2", "search"),
        ("march.start_displacement=0", "march.start_displacement"),
    ] {
        case.run("pmb", &["march", "march.toml", "--out", "no", "--set", set])
            .exits(2)
            .says(&["march.toml", words]);
    }
    case.edit("march.toml", "speed = \"231.37 m/s\"\n", "");
    case.run("pmb", &["march", "march.toml", "--out", "no"])
        .exits(2)
        .says(&["march.toml"]);
}
