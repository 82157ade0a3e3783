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
    // Between the two, with more bending in it at these coupled frequencies or more torsion; no other mode.
    assert!([1, 2].contains(&point["mode"].as_u64().unwrap()), "{point}");
    for file in [
        "damping.svg",
        "march_1.svg",
        "march_1.csv",
        "trials.json",
        "vg.csv",
        "vg.svg",
        "transfer.svg",
    ] {
        assert!(case.path("whole").join(file).exists(), "{file}");
    }
    case.run("dip", &["info", "whole/march_1.mcap"]).exits(0);
    case.run("dip", &["doctor", "whole/march_1.mcap"]).exits(0);

    // The transfer was inspected, and where the time went adds up to it.
    let transfer = |key: &str| whole["transfer"][key].as_f64().unwrap();
    assert!(transfer("virtual_work_error") < 1e-12 && transfer("rotation_error") < 1e-12);
    let cost: f64 = whole["cost"]
        .as_object()
        .unwrap()
        .values()
        .map(|v| v.as_f64().unwrap())
        .sum();
    let stages = whole["stages"].as_array().unwrap().iter();
    let marches: f64 = stages
        .filter(|s| s[0].as_str().unwrap().starts_with("march"))
        .map(|s| s[1]["wall_s"].as_f64().unwrap())
        .sum();
    assert!(cost > 0.7 * marches && cost < 1.02 * marches, "{cost} s of {marches} s");

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
fn a_run_whose_files_are_damaged_is_done_anew_and_the_finished_ones_are_kept() {
    let case = CaseFolder::flow();
    case.run("pmb", &["march", "march.toml", "--out", "whole", "-q"]);
    let bytes = |folder: &str, file: &str| std::fs::read(case.path(folder).join(file)).unwrap();
    for damaged in ["march_2.pmb", "march_2.mcap"] {
        case.run("pmb", &["march", "march.toml", "--out", "broken", "-q", "--force"]);
        let mut trials = json(&case, "broken/trials.json");
        trials[1].as_array_mut().unwrap().truncate(1);
        std::fs::write(case.path("broken/trials.json"), trials.to_string()).unwrap();
        let whole = bytes("broken", damaged);
        std::fs::write(case.path("broken").join(damaged), &whole[..whole.len() / 2]).unwrap();
        let resumed = case.run("pmb", &["march", "march.toml", "--out", "broken", "--resume"]);
        assert!(resumed.code == 0 || resumed.code == 3, "{}", resumed.stderr);
        assert!(
            resumed.stderr.contains("kept") && resumed.stderr.contains("this run is done anew"),
            "{damaged}: {}",
            resumed.stderr
        );
        for file in ["march_2.csv", "march_2.mcap"] {
            assert!(
                bytes("whole", file) == bytes("broken", file),
                "{damaged}: {file} differs"
            );
        }
    }
}

#[test]
fn a_search_of_speed_or_altitude_gives_the_same_boundary() {
    let case = CaseFolder::flow();
    let search = |name: &str, set: &[&str]| -> Value {
        let mut arguments = vec![
            "march",
            "march.toml",
            "--out",
            name,
            "--set",
            "march.start_mode=\"all\"",
        ];
        set.iter().for_each(|s| arguments.extend(["--set", s]));
        let run = case.run("pmb", &arguments);
        assert!(run.code == 0 || run.code == 3, "{}", run.stderr);
        assert!(
            run.stderr.contains("virtual work to") && run.stderr.contains("s went: "),
            "{}",
            run.stderr
        );
        json(&case, &format!("{name}/summary.json"))["flutter"][0].clone()
    };
    let of = |point: &Value, key: &str| point[key].as_f64().unwrap();
    let density = search("density", &[]);
    let at = format!("flow.density=\"{} kg/m^3\"", of(&density, "density_kg_m3"));
    let speed = search(
        "speed",
        &["search.parameter=\"speed\"", "search.first=\"210 m/s\"", &at],
    );
    assert_eq!(speed["parameter"], "speed");
    assert_eq!(speed["density_kg_m3"], density["density_kg_m3"]);
    // Each is known to half a per cent of speed or so.
    let found = of(&speed, "flutter_speed_m_s");
    assert!((found / 231.37 - 1.0).abs() < 0.015, "{found}");
    let [f1, f2] = [&density, &speed].map(|p| of(p, "flutter_frequency_hz"));
    assert!((f1 / f2 - 1.0).abs() < 0.02, "{f1} {f2}");

    // A matched point: density and sound speed are those of the standard atmosphere (constant temperature here, 295.07 m/s).
    case.edit(
        "march.toml",
        "speed = \"231.37 m/s\"\ndensity = \"0.20821 kg/m^3\"\n",
        "",
    );
    let matched = search("altitude", &["search.parameter=\"altitude\"", "search.first=\"13 km\""]);
    let altitude = of(&matched, "altitude_m");
    assert!((11_000.0..20_000.0).contains(&altitude), "{altitude}");
    assert!((of(&matched, "flutter_speed_m_s") / (0.678 * 295.07) - 1.0).abs() < 1e-4);
    // 0.36480 kg/m^3 at 11 km, scale height 6.34 km of geopotential altitude.
    let air = 0.364_80 * f64::exp(-(altitude - 11_000.0) / 6_365.0);
    assert!((of(&matched, "density_kg_m3") / air - 1.0).abs() < 0.01, "{matched}");
    // The speed index depends little on the mass ratio.
    let [i1, i2] = [&density, &matched].map(|p| of(p, "flutter_speed_index"));
    assert!((i1 / i2 - 1.0).abs() < 0.05, "{i1} {i2}");
}

#[test]
fn curves_of_the_frequency_domain_are_drawn_beside_those_of_the_march() {
    let case = CaseFolder::flow();
    let vg = "mach,method,mode,speed_m_s,density_kg_m3,g,frequency_hz,k,confidence\n\
              0.678,pk,1,200,0.2,-0.05,15,0.2,1\n0.678,pk,1,240,0.2,0.01,20,0.2,1\n0.9,pk,1,240,0.2,0.01,20,0.2,1\n";
    std::fs::write(case.path("vg.csv"), vg).unwrap();
    let single = [
        "march",
        "march.toml",
        "--set",
        "search.runs=1",
        "--set",
        "march.cycles=2",
        "--beside",
    ];
    let run = case.run("pmb", &[&single[..], &["vg.csv", "--out", "run"]].concat());
    assert_eq!(run.code, 3, "{}", run.stderr);
    let svg = std::fs::read_to_string(case.path("run/vg.svg")).unwrap();
    assert!(svg.contains("mode 1, march") && svg.contains("mode 1, pk"));
    let curves = std::fs::read_to_string(case.path("run/vg.csv")).unwrap();
    assert!(curves.starts_with("mach,method,mode,speed_m_s,density_kg_m3,g,frequency_hz,k,"));
    assert!(curves.contains("\n0.678,march,1,231.37,0.20821,"), "{curves}");
    std::fs::write(case.path("vg.csv"), vg.replace("0.01", "much")).unwrap();
    case.run("pmb", &[&single[..], &["vg.csv", "--out", "other"]].concat())
        .exits(2)
        .says(&["vg.csv", "line 3", "much"]);
}

/// A wing section that turns about three quarters of its chord: divergence at a dynamic pressure of `K / (S e CL_alpha)`.
fn section() -> CaseFolder {
    let case = CaseFolder::whole();
    let mesh = "name = \"NACA 0012\"\nkind = \"aerofoil-o\"\n[section]\nnaca = \"0012\"\ntrailing_edge = \"sharp\"\n\
        [cells]\nsurface = 40\nnormal = 24\n[spacing]\nwall = \"5 mm\"\nnose = 0.01\ntail = 0.01\n[extent]\nfar_field = \"15 m\"\n";
    std::fs::write(case.path("section.toml"), mesh).unwrap();
    let mut modes = String::from("x_m,y_m,z_m,phi1\n");
    for x in [0.0, 0.5, 1.0] {
        for y in [0.0, 1.0] {
            modes.push_str(&format!("{x},{y},0,{}\n", 0.75 - x));
        }
    }
    std::fs::write(case.path("turn.csv"), modes).unwrap();
    std::fs::write(
        case.path("section_march.toml"),
        "[flow]\nmach = 0.5\nspeed = \"170 m/s\"\ndensity = \"1 kg/m^3\"\n[mesh]\nrecipe = \"section.toml\"\n\
         [reference]\nchord = \"1 m\"\n[modes]\nfile = \"turn.csv\"\nfrequencies = [\"10 Hz\"]\ngeneralized_masses = [\"10 kg\"]\n\
         [march]\nfrequency = \"10 Hz\"\nsteps_per_cycle = 32\ncycles = 4\nstart_displacement = \"0.1 mm\"\n",
    )
    .unwrap();
    case
}

#[test]
fn divergence_is_said_and_ends_a_search() {
    let case = section();
    // K = 10 kg (2 pi 10)^2 = 39.5 kN m/rad for a metre of span, CL_alpha about 7.2: divergence near 11 kPa, 0.76 kg/m^3.
    let run = case.run("pmb", &["march", "section_march.toml", "--out", "one"]);
    assert_eq!(run.code, 3, "{}", run.stderr);
    let one = json(&case, "one/summary.json");
    let trial = &one["trials"][0];
    assert_eq!(trial["diverges"], true, "{trial}");
    assert!(trial["rate_1_s"].as_f64().unwrap() > 1.0, "{trial}");
    assert!(
        run.stderr
            .contains("divergence: the wing moves away without oscillating"),
        "{}",
        run.stderr
    );
    let below = case.run(
        "pmb",
        &[
            "march",
            "section_march.toml",
            "--out",
            "below",
            "--set",
            "flow.density=0.4",
        ],
    );
    let summary = json(&case, "below/summary.json");
    assert_eq!(summary["trials"][0]["diverges"], false, "{}", below.stderr);
    let search = case.run(
        "pmb",
        &[
            "march",
            "section_march.toml",
            "--out",
            "search",
            "--set",
            "flow.density=0.6",
            "--set",
            "search.tolerance=0.05",
        ],
    );
    assert_eq!(search.code, 3, "{}", search.stderr);
    let summary = json(&case, "search/summary.json");
    let reason = summary["stop_reason"].as_str().unwrap();
    assert!(
        reason.starts_with("divergence comes first, between density 0."),
        "{reason}"
    );
    assert_eq!(summary["flutter"].as_array().unwrap().len(), 0);
    let number = |key: &str| summary["divergence"][key].as_f64().unwrap();
    assert!(
        (0.68..0.85).contains(&number("density_kg_m3")),
        "{}",
        summary["divergence"]
    );
    assert!(number("parameter_error") < 0.05, "{}", summary["divergence"]);
    let pressure = 0.5 * number("density_kg_m3") * 170.0 * 170.0;
    assert!((number("dynamic_pressure_pa") / pressure - 1.0).abs() < 1e-12);
    let end = |k: usize| summary["divergence"]["between"][k].as_f64().unwrap();
    assert!(end(0) < pressure && pressure < end(1), "{}", summary["divergence"]);
    assert!(
        search.stdout.contains("divergence at Mach 0.5: density 0."),
        "{}",
        search.stdout
    );
    let picture = std::fs::read_to_string(case.path("search/damping.svg")).unwrap();
    assert!(picture.contains("without oscillation") && picture.contains("divergence"));
}

#[test]
fn what_a_search_did_not_reach_is_said() {
    let case = CaseFolder::flow();
    let run = |set: &[&str]| {
        let mut arguments = vec!["march", "march.toml", "--out", "out", "-q", "--force"];
        set.iter().for_each(|s| arguments.extend(["--set", s]));
        case.run("pmb", &arguments)
    };
    // Three runs do not reach a thousandth of a per cent.
    let few = run(&["search.tolerance=0.00001", "search.runs=3"]);
    assert_eq!(few.code, 3, "{}", few.stderr);
    assert!(few.stderr.contains("not to the 0.001 % asked for"), "{}", few.stderr);
}

#[test]
fn what_is_wrong_in_a_march_is_named() {
    let case = CaseFolder::flow();
    for (set, words) in [
        ("march.steps_per_cycle=2", "march"),
        ("march.start_mode=9", "mode 9: there are 4"),
        ("march.damping=[0.01, 0.02]", "2 values for 4 modes"),
        ("march.damping=\"low\"", "a list with one for each mode"),
        ("march.start_mode=\"both\"", "the number of a mode"),
        ("search.first=\"12 km\"", "a density"),
        ("search.from=\"0.5 kg/m^3\"", "does not hold the first value"),
        ("search.to=\"12 m/s\"", "search.to"),
        ("search.parameter=\"temperature\"", "altitude"),
        ("search={parameter=\"speed\", from=\"300 m/s\"}", "speed 300.000 m/s"),
        (
            "search={parameter=\"altitude\", first=\"100 km\"}",
            "standard atmosphere",
        ),
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
