//! `pmb pitch` on a small grid: what it writes, how it stops and goes on, how it refuses.

use super::setup::{CaseFolder, Run};
use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, SystemTime};

const MESH: &str = r#"name = "NACA 0012, coarse C grid"
kind = "aerofoil-c"

[section]
naca = "0012"
trailing_edge = "sharp"

[cells]
surface = 32
wake = 8
normal = 16

[spacing]
wall = "6 mm"
nose = 0.008
tail = 0.01

[extent]
far_field = "10 m"
"#;

const CASE: &str = r#"[flow]
model = "euler"
mach = 0.6
alpha = "1 deg"

[mesh]
recipe = "mesh.toml"

[reference]
chord = "1 m"
moment_point = ["0.25 m", "0 m", "0 m"]

[motion]
kind = "pitch"
axis = ["0.25 m", "0 m", "0 m"]
amplitude = "1 deg"
reduced_frequency = 0.08
steps_per_cycle = 20
cycles = 3
tolerance = 0

[time]
checkpoint = 10
"#;

/// NACA 0012 in pitch on 1,280 cells: some milliseconds a step.
fn small() -> CaseFolder {
    let case = CaseFolder::whole();
    fs::write(case.path("mesh.toml"), MESH).unwrap();
    fs::write(case.path("small.toml"), CASE).unwrap();
    case
}

fn pitch(case: &CaseFolder, out: &str, more: &[&str]) -> Run {
    case.run("pmb", &[&["pitch", "small.toml", "--out", out, "-q"], more].concat())
}

fn json(case: &CaseFolder, file: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(case.path(file)).unwrap()).unwrap()
}

/// The summary without its times.
fn summary(case: &CaseFolder, folder: &str) -> Value {
    let mut summary = json(case, &format!("{folder}/summary.json"));
    let table = summary.as_object_mut().unwrap();
    assert!(table.remove("stages").is_some() && table.remove("total").is_some());
    summary
}

/// All that a run says of the flow: the recording to the bit, the summary but for its times, the tables and figures.
#[track_caller]
fn assert_same(case: &CaseFolder, whole: &str, parts: &str, what: &str) {
    assert_eq!(summary(case, whole), summary(case, parts), "{what}");
    for file in [
        "pitch.mcap",
        "history.csv",
        "history.svg",
        "loops.svg",
        "cp_harmonic.csv",
        "cp_harmonic.svg",
    ] {
        let read = |folder: &str| fs::read(case.path(folder).join(file)).unwrap();
        assert!(read(whole) == read(parts), "{what}: {file} differs");
    }
}

/// Some milliseconds below `most`, other ones in every run.
fn some_time(most: u32) -> Duration {
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap();
    Duration::from_millis(u64::from(now.subsec_micros() % most))
}

/// A run that goes on while the test does; it says every step.
fn start(case: &CaseFolder, more: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_pmb"))
        .args(["pitch", "small.toml", "--out", "parts", "-v"])
        .args(more)
        .current_dir(case.path(""))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Reads what a run says up to its first time step.
fn to_first_step(child: &mut Child) -> impl Iterator<Item = String> + use<> {
    let mut lines = BufReader::new(child.stderr.take().unwrap())
        .lines()
        .map_while(Result::ok);
    assert!(lines.any(|l| l.contains("time step ")), "no time step");
    lines
}

#[test]
fn a_run_gives_a_recording_harmonics_and_figures() {
    let case = small();
    let run = case
        .run("pmb", &["pitch", "small.toml", "--out", "out", "--json"])
        .exits(0);
    let summary = json(&case, "out/summary.json");
    assert_eq!(serde_json::from_str::<Value>(&run.stdout).unwrap(), summary);
    assert_eq!(summary["stop_reason"], "all-steps");
    assert_eq!(
        (&summary["steps"], &summary["steps_not_converged"]),
        (&60.into(), &0.into())
    );
    for file in ["history.svg", "loops.svg", "cp_harmonic.svg", "restart.pmb"] {
        assert!(case.path("out").join(file).exists(), "{file}");
    }
    let number = |v: &Value| v.as_f64().unwrap();
    // Quasi-steady thin-aerofoil lift with Prandtl's and Glauert's factor is 2 pi / 0.8 = 7.85; Theodorsen's function at
    // k = 0.08 leaves some 0.86 of it, lagging.
    let (real, imaginary) = (number(&summary["cl"]["real"]), number(&summary["cl"]["imaginary"]));
    assert!(
        (5.5..7.5).contains(&real) && (-2.5..-0.3).contains(&imaginary),
        "{real} {imaginary}"
    );

    // The recording says the same, to whoever reads it.
    case.run("dip", &["doctor", "out/pitch.mcap"]).exits(0);
    let info = case.run("dip", &["info", "out/pitch.mcap", "--json"]).exits(0);
    let info: Value = serde_json::from_str(&info.stdout).unwrap();
    assert_eq!(info["steps"]["count"], 61);
    assert_eq!(info["end"], "all-steps");
    assert_eq!(info["references"]["reference_semichord_m"], 0.5);
    case.run(
        "dip",
        &["export", "out/pitch.mcap", "--harmonics", "--csv", "--out", "tables"],
    )
    .exits(0);
    let harmonics = &json(&case, "tables/harmonics.json")[0];
    for key in ["cl", "cd", "cm"] {
        assert_eq!(harmonics[key][0], summary[key]["real"], "{key}");
        assert_eq!(harmonics[key][1], summary[key]["imaginary"], "{key}");
    }
    assert_eq!(harmonics["omega_rad_s"], summary["omega_rad_s"]);
    let read = |file: &str| fs::read_to_string(case.path(file)).unwrap();
    assert_eq!(read("tables/history.csv"), read("out/history.csv"));

    // The figure's points are the exported faces.
    let column = |file: &str, name: &str| -> Vec<f64> {
        let text = read(file);
        let mut lines = text.lines();
        let at = lines.next().unwrap().split(',').position(|c| c == name).unwrap();
        let mut values: Vec<f64> = lines.map(|l| l.split(',').nth(at).unwrap().parse().unwrap()).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    assert_eq!(
        column("out/cp_harmonic.csv", "cp_imaginary"),
        column("tables/harmonics.csv", "cp_1_im_per_unit")
    );

    // More cycles are added to those that are there.
    pitch(&case, "out", &["--resume", "--set", "motion.cycles=4"]).exits(0);
    pitch(&case, "four", &["--set", "motion.cycles=4"]).exits(0);
    assert_same(&case, "four", "out", "a cycle more");
}

#[test]
fn an_interrupted_run_goes_on_as_if_it_had_not_been() {
    let case = small();
    case.edit("small.toml", "cycles = 3", "cycles = 20");
    pitch(&case, "whole", &[]).exits(0);
    let mut child = start(&case, &[]);
    let lines = to_first_step(&mut child);
    let wait = some_time(200);
    std::thread::sleep(wait);
    // The shell's own kill: there may be no program of that name.
    let kill = format!("kill -INT {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
    let rest: Vec<String> = lines.collect();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{rest:?}");
    assert!(
        rest.iter()
            .any(|l| l.contains("time steps are in parts/pitch.mcap and parts/restart.pmb") && l.contains("--resume")),
        "{rest:?}"
    );
    assert!(!case.path("parts/summary.json").exists());
    case.run("dip", &["doctor", "parts/pitch.mcap"]).exits(0);
    pitch(&case, "parts", &["--resume"]).exits(0);
    assert_same(&case, "whole", "parts", &format!("interrupted after {wait:?}"));
    // What is finished stays as it is.
    pitch(&case, "parts", &["--resume"]).exits(0);
    assert_same(&case, "whole", "parts", "finished and resumed");
}

#[test]
fn a_killed_run_goes_on_as_if_it_had_not_been() {
    let case = small();
    case.edit("small.toml", "cycles = 3", "cycles = 20");
    pitch(&case, "whole", &[]).exits(0);
    let mut waits = Vec::new();
    for kill in 0..3 {
        let mut child = start(&case, if kill == 0 { &[] } else { &["--resume"] });
        let lines = to_first_step(&mut child);
        // The first restart file follows step 0 at once; without one there is nothing to go on from.
        while !case.path("parts/restart.pmb").exists() {
            std::thread::sleep(Duration::from_millis(1));
        }
        waits.push(some_time(150));
        std::thread::sleep(waits[kill]);
        child.kill().unwrap();
        child.wait().unwrap();
        // No line says that a step was taken which the recording has lost, but for the chunk under way.
        let said = lines.filter(|l| l.contains("time step ")).count();
        let run = case.run("dip", &["doctor", "parts/pitch.mcap", "--json"]);
        let report: Value = serde_json::from_str(&run.stdout).unwrap();
        let last = report["good_steps"][0][1].as_u64().unwrap();
        assert!(last + 10 >= said as u64, "{waits:?}: {last} steps are left of {said}");
    }
    pitch(&case, "parts", &["--resume"]).exits(0);
    assert_same(&case, "whole", "parts", &format!("killed after {waits:?}"));
}

#[test]
fn a_full_disk_is_named_and_costs_nothing_but_time() {
    let case = small();
    pitch(&case, "whole", &[]).exits(0);
    pitch(&case, "parts", &["--set", "motion.cycles=1"]).exits(0);
    // No file may grow beyond 32 kB (64 kB in some shells): the restart file is larger.
    let command = format!(
        "trap '' XFSZ; ulimit -f 64; exec '{}' pitch small.toml --out parts --resume",
        env!("CARGO_BIN_EXE_pmb")
    );
    let output = Command::new("sh")
        .args(["-c", &command])
        .current_dir(case.path(""))
        .output()
        .unwrap();
    let run = Run::new(output).exits(1).says(&["disk's space"]);
    assert!(
        run.stderr.contains("parts/restart.pmb") || run.stderr.contains("parts/pitch.mcap"),
        "{}",
        run.stderr
    );
    pitch(&case, "parts", &["--resume"]).exits(0);
    assert_same(&case, "whole", "parts", "a full disk");
}

#[test]
fn resume_needs_a_restart_file_of_the_same_motion() {
    let case = small();
    pitch(&case, "out", &["--resume"])
        .exits(2)
        .says(&["out/restart.pmb", "no restart file", "leave --resume out"]);
    pitch(&case, "out", &["--set", "motion.cycles=1"]).exits(0);
    for other in [
        "flow.mach=0.5",
        "motion.amplitude=2 deg",
        "motion.axis=[\"0.5 m\", 0, 0]",
        "motion.steps_per_cycle=40",
        "motion.reduced_frequency=0.1",
        "time.scheme=bdf1",
        "time.orders=3",
    ] {
        pitch(&case, "out", &["--resume", "--set", other])
            .exits(2)
            .says(&["restart.pmb"]);
    }
    // The same number of nodes elsewhere.
    case.edit("mesh.toml", "far_field = \"10 m\"", "far_field = \"11 m\"");
    pitch(&case, "out", &["--resume"])
        .exits(2)
        .says(&["restart.pmb", "another grid"]);
    case.edit("mesh.toml", "far_field = \"11 m\"", "far_field = \"10 m\"");
    // A recording that does not reach the restart file.
    fs::remove_file(case.path("out/pitch.mcap")).unwrap();
    let run = pitch(&case, "out", &["--resume", "--set", "motion.cycles=2"]);
    assert_eq!(run.code, 1);
    run.says(&["pitch.mcap"]);
}

#[test]
fn wrong_motions_are_named_with_their_line() {
    let rows: [(&str, &str, &[&str]); 15] = [
        (
            "reduced_frequency = 0.08\n",
            "",
            &["[motion]", "neither frequency nor reduced_frequency", "17.98 Hz"],
        ),
        (
            "reduced_frequency = 0.08",
            "reduced_frequency = 0.08\nfrequency = \"5 Hz\"",
            &["both", "give one"],
        ),
        (
            "reduced_frequency = 0.08",
            "frequency = \"-5 Hz\"",
            &["frequency", "positive"],
        ),
        ("reduced_frequency = 0.08", "frequency = \"5 m\"", &["5 m", "frequency"]),
        ("amplitude =", "amplitud =", &["amplitud", "did you mean `amplitude`"]),
        (
            "axis = [\"0.25 m\", \"0 m\", \"0 m\"]\namp",
            "amp",
            &["no axis", "axis = ["],
        ),
        (
            "kind = \"pitch\"",
            "kind = \"pich\"",
            &["unknown value `pich`", "did you mean `pitch`"],
        ),
        ("amplitude = \"1 deg\"", "amplitude = \"1 m\"", &["1 m", "angle", "deg"]),
        ("kind = \"pitch\"", "kind = \"plunge\"", &["1 deg", "length"]),
        (
            "kind = \"pitch\"\n",
            "kind = \"control\"\n",
            &["needs its span", "span = ["],
        ),
        ("kind = \"pitch\"", "kind = \"mode\"", &["1 deg", "no unit"]),
        (
            "steps_per_cycle = 20",
            "steps_per_cycle = 2",
            &["2 steps per cycle", "needed 4"],
        ),
        ("cycles = 3", "cycles = 0", &["0 cycles"]),
        (
            "[time]",
            "[steady]\nfar_field = \"vortex\"\n\n[time]",
            &["vortex", "free-stream"],
        ),
        (
            "[time]",
            "[[motion.harmonic]]\nmultiple = 10\namplitude = \"1 deg\"\n\n[time]",
            &["multiple = 10", "20 steps"],
        ),
    ];
    let case = small();
    for (from, to, words) in rows {
        case.edit("small.toml", from, to);
        let run = pitch(&case, "out", &[]);
        assert_eq!(run.code, 2, "{to}: {}", run.stderr);
        let run = run.says(words).says(&["small.toml:", "help: "]);
        assert!(!run.stderr.contains("small.toml:0"), "{}", run.stderr);
        fs::write(case.path("small.toml"), CASE).unwrap();
    }
    assert!(!case.path("out/pitch.mcap").exists());

    // A mode that is not there, of the shipped wing.
    let modes = "kind = \"mode\"\nmode = 9";
    case.edit("small.toml", "kind = \"pitch\"", modes);
    case.edit("small.toml", "amplitude = \"1 deg\"", "amplitude = 0.001");
    pitch(&case, "out", &[])
        .exits(2)
        .says(&["small.toml", "no [modes]", "structure.toml"]);
    let text = fs::read_to_string(case.path("small.toml")).unwrap();
    let yates = fs::read_to_string(case.path("flutter_yates.toml")).unwrap();
    let from = yates.find("[modes]").unwrap();
    let table = &yates[from..from + yates[from..].find("\n\n").unwrap()];
    fs::write(case.path("small.toml"), text + "\n" + table).unwrap();
    pitch(&case, "out", &[]).exits(2).says(&["small.toml:", "mode 9"]);
}

/// The shipped case gives what its `expected.json` says, within the bounds that stand there.
#[test]
fn the_shipped_aerofoil_case_gives_what_it_promises() {
    let folder = tempfile::tempdir().unwrap();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/naca0012-pitch");
    let read = |path: &Path| -> Value { serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap() };
    let expected = read(&shipped.join("expected.json"));
    let output = Command::new(env!("CARGO_BIN_EXE_pmb"))
        .args(["pitch", "-q", "--out"])
        .args([folder.path().join("out"), shipped.join("pitch.toml")])
        .output()
        .unwrap();
    Run::new(output).exits(0);
    let got = read(&folder.path().join("out/summary.json"));
    assert_eq!(got["stop_reason"], "periodic");
    assert_eq!(got["steps"], expected["steps"]);
    let number = |v: &Value| v.as_f64().unwrap();
    for key in ["cl", "cm"] {
        for (part, bound) in [("mean", "mean"), ("real", key), ("imaginary", key)] {
            let (ours, asked) = (number(&got[key][part]), number(&expected[key][part]));
            let bound = number(&expected["bounds"][bound]);
            assert!(
                (ours - asked).abs() <= bound,
                "{key} {part}: {ours}, expected {asked} within {bound}"
            );
        }
    }
}
