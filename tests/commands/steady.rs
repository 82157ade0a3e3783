//! `pmb steady` on a small grid: what it writes, how it goes on, how it refuses.

use super::setup::CaseFolder;
use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

/// The shipped NACA 0012 case on a quarter of its cells.
pub fn small() -> CaseFolder {
    let case = CaseFolder::small();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/naca0012");
    for file in ["steady.toml", "mesh.toml"] {
        fs::copy(shipped.join(file), case.path(file)).unwrap();
    }
    for (from, to) in [
        ("surface = 96", "surface = 48"),
        ("wake = 32", "wake = 16"),
        ("normal = 48", "normal = 24"),
        ("wall = \"2 mm\"", "wall = \"4 mm\""),
        ("nose = 0.003", "nose = 0.006"),
        ("tail = 0.004", "tail = 0.008"),
    ] {
        case.edit("mesh.toml", from, to);
    }
    case
}

pub fn summary(case: &CaseFolder, folder: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(case.path(folder).join("summary.json")).unwrap()).unwrap()
}

/// The history without its last column, the seconds.
pub fn history(case: &CaseFolder, folder: &str) -> Vec<String> {
    let text = fs::read_to_string(case.path(folder).join("history.csv")).unwrap();
    text.lines().map(|l| l.rsplit_once(',').unwrap().0.to_owned()).collect()
}

/// Line on which `text` stands in a file of the case.
fn line(case: &CaseFolder, file: &str, text: &str) -> String {
    let content = fs::read_to_string(case.path(file)).unwrap();
    let line = content.lines().position(|l| l.contains(text)).unwrap() + 1;
    format!("{file}:{line}:")
}

#[test]
fn a_case_converges_and_says_so() {
    let case = small();
    let run = case
        .run("pmb", &["steady", "steady.toml", "--out", "out", "--json"])
        .exits(0);
    let printed: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(printed, summary(&case, "out"));
    assert!(["converged", "round-off"].contains(&printed["stop_reason"].as_str().unwrap()));
    assert!(printed["residual_drop_orders"].as_f64().unwrap() > 9.0, "{printed}");
    assert_eq!(printed["cells"], 128 * 24);
    assert_eq!(
        printed["iterations"].as_u64().unwrap() as usize + 1,
        history(&case, "out").len()
    );
    // A quarter of the cells, but the flow it is: on fine grids others have CL 0.347 to 0.356, CD 0.0220 to 0.0232.
    let (cl, cd) = (printed["cl"].as_f64().unwrap(), printed["cd"].as_f64().unwrap());
    assert!(
        (0.30..0.38).contains(&cl) && (0.018..0.030).contains(&cd),
        "CL {cl}, CD {cd}"
    );
    for file in [
        "history.svg",
        "cp.csv",
        "cp.svg",
        "surface.csv",
        "flow.vtm",
        "flow/0.vts",
        "restart.pmb",
    ] {
        assert!(case.path("out").join(file).exists(), "{file}");
    }
    assert!(
        run.stderr.contains("CFL") && run.stderr.contains("orders"),
        "{}",
        run.stderr
    );
}

#[test]
fn a_written_grid_gives_what_its_recipe_gives() {
    let case = small();
    case.run("pmb", &["mesh", "mesh.toml", "-o", "grid.xyz"]).exits(0);
    case.run("pmb", &["steady", "steady.toml", "--out", "recipe", "-q"])
        .exits(0);
    case.edit("steady.toml", "recipe = \"mesh.toml\"", "file = \"grid.xyz\"");
    case.run("pmb", &["steady", "steady.toml", "--out", "file", "-q"])
        .exits(0);
    assert_eq!(summary(&case, "recipe")["cl"], summary(&case, "file")["cl"]);
    assert_eq!(history(&case, "recipe"), history(&case, "file"));

    // The same body measured in inches.
    case.edit(
        "steady.toml",
        "file = \"grid.xyz\"",
        "file = \"grid.xyz\"\nlength_unit = \"1 in\"",
    );
    let inch = [
        "--set",
        "reference.chord=1 in",
        "--set",
        "reference.moment_point=[\"0.25 in\", 0, 0]",
    ];
    case.run(
        "pmb",
        &[&["steady", "steady.toml", "--out", "inch", "-q"][..], &inch].concat(),
    )
    .exits(0);
    for key in ["cl", "cd", "cm"] {
        let value = |folder: &str| summary(&case, folder)[key].as_f64().unwrap();
        let (metre, inch) = (value("file"), value("inch"));
        assert!((metre - inch).abs() < 1e-7, "{key}: {metre} and {inch}");
    }
}

#[test]
fn too_few_steps_are_exit_code_3_and_resume_goes_on_bit_for_bit() {
    let case = small();
    case.run("pmb", &["steady", "steady.toml", "--out", "whole", "-q"])
        .exits(0);
    let few = [
        "steady",
        "steady.toml",
        "--out",
        "parts",
        "--set",
        "steady.iterations=2",
    ];
    case.run("pmb", &few).exits(3).says(&["not converged", "--resume"]);
    assert_eq!(summary(&case, "parts")["stop_reason"], "max-steps");
    case.run("pmb", &["steady", "steady.toml", "--out", "parts", "--resume", "-q"])
        .exits(0);
    assert_eq!(history(&case, "whole"), history(&case, "parts"));
    for key in ["cl", "cd", "cm", "residual_drop_orders"] {
        assert_eq!(summary(&case, "whole")[key], summary(&case, "parts")[key], "{key}");
    }
}

#[test]
fn an_interrupted_run_is_exit_code_130_and_goes_on() {
    let case = small();
    // Fine enough that it cannot be over before the signal comes.
    for (from, to) in [
        ("surface = 48", "surface = 192"),
        ("wake = 16", "wake = 64"),
        ("normal = 24", "normal = 96"),
    ] {
        case.edit("mesh.toml", from, to);
    }
    let arguments = [
        "steady",
        "steady.toml",
        "--out",
        "out",
        "-v",
        "--set",
        "steady.levels=1",
    ];
    let mut child = Command::new(env!("CARGO_BIN_EXE_pmb"))
        .args(arguments)
        .current_dir(case.path(""))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(lines.any(|l| l.contains("step    1")), "no first step");
    // The shell's own kill: there may be no program of that name.
    let signal = Command::new("sh")
        .args(["-c", &format!("kill -INT {}", child.id())])
        .status()
        .unwrap();
    assert!(signal.success());
    let rest: Vec<String> = lines.collect();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{rest:?}");
    assert!(
        rest.iter().any(|l| l.contains("interrupted") && l.contains("--resume")),
        "{rest:?}"
    );
    let before = summary(&case, "out");
    assert_eq!(before["stop_reason"], "interrupted");

    // Some steps more are enough to see that it goes on.
    let orders = before["residual_drop_orders"].as_f64().unwrap();
    let asked = format!("steady.orders={}", orders.max(0.0) + 0.3);
    case.run(
        "pmb",
        &[
            "steady",
            "steady.toml",
            "--out",
            "out",
            "--resume",
            "-q",
            "--set",
            "steady.levels=1",
            "--set",
            &asked,
        ],
    )
    .exits(0);
    assert!(summary(&case, "out")["iterations"].as_u64() > before["iterations"].as_u64());
}

#[test]
fn numbers_out_of_range_are_named_with_their_line() {
    let case = small();
    let at = line(&case, "steady.toml", "mach =");
    case.edit("steady.toml", "mach = 0.8", "mach = -0.8");
    case.run("pmb", &["steady", "steady.toml"])
        .exits(2)
        .says(&[&at, "flow.mach", "Mach number above"]);
    case.edit("steady.toml", "mach = -0.8", "mach = 0.8\ngamma = 0.9");
    case.run("pmb", &["steady", "steady.toml"])
        .exits(2)
        .says(&["flow.gamma", "above 1"]);
    case.edit(
        "steady.toml",
        "gamma = 0.9",
        "density = \"0 kg/m^3\"\nspeed = \"100 m/s\"",
    );
    case.run("pmb", &["steady", "steady.toml"])
        .exits(2)
        .says(&["density 0"]);
    case.edit("steady.toml", "speed = \"100 m/s\"", "speed = \"100 m\"");
    case.run("pmb", &["steady", "steady.toml"])
        .exits(2)
        .says(&["is not a speed"]);
}

#[test]
fn keys_and_models_that_are_not_known() {
    let case = small();
    case.edit("steady.toml", "model = \"euler\"", "model = \"eulr\"");
    case.run("pmb", &["steady", "steady.toml"])
        .exits(2)
        .says(&["unknown value `eulr`", "did you mean `euler`"]);
    let case = small();
    case.edit("steady.toml", "alpha =", "alfa =");
    let at = line(&case, "steady.toml", "alfa");
    case.run("pmb", &["steady", "steady.toml"])
        .exits(2)
        .says(&[&at, "did you mean `alpha`"]);
}

#[test]
fn the_grid_must_be_there_and_fit() {
    let case = small();
    let run = |set: &str| {
        case.run("pmb", &["steady", "steady.toml", "--out", "out", "--set", set])
            .exits(2)
    };
    run("mesh.recipe=none.toml").says(&["none.toml", "no file"]);
    run("mesh.file=grid.xyz").says(&["both recipe and file"]);
    run("mesh.boundary_conditions=grid.bc.toml").says(&["goes with file"]);
    run("mesh.blocks=0").says(&["needed 1 to 4096"]);
    run("patch.inlet.pressure=0.9").says(&["no patch `inlet`", "aerofoil"]);
    run("cuts.eta=[0.5]").says(&["semispan"]);
    run("cuts.measured=none.csv").says(&["none.csv"]);
    // A body that is not there, and a body of which nothing is asked.
    let text = "kind = \"box\"\n[shape]\nfrom = [0, 0, 0]\nto = [1, 1, 1]\n[cells]\nbox = [4, 4, 4]\n";
    fs::write(case.path("box.toml"), text).unwrap();
    run("mesh.recipe=box.toml").says(&["the grid has no wall"]);
    let text = fs::read_to_string(case.path("steady.toml")).unwrap();
    fs::write(case.path("steady.toml"), &text[..text.find("[reference]").unwrap()]).unwrap();
    run("flow.mach=0.8").says(&["no [reference]", "the grid has walls"]);
}

#[test]
fn resume_needs_a_restart_file_of_the_same_flow() {
    let case = small();
    case.run("pmb", &["steady", "steady.toml", "--out", "out", "--resume"])
        .exits(2)
        .says(&["no restart file"]);
    case.run("pmb", &["steady", "steady.toml", "--out", "out", "-q"])
        .exits(0);
    let other = ["steady", "steady.toml", "--out", "out", "--set", "flow.mach=0.7"];
    case.run("pmb", &other).exits(2).says(&["--force"]);
    case.run("pmb", &[&other[..], &["--resume"]].concat())
        .exits(2)
        .says(&["restart.pmb", "differ"]);
    // A file cut short is refused, not read.
    let restart = case.path("out/restart.pmb");
    let bytes = fs::read(&restart).unwrap();
    fs::write(&restart, &bytes[..bytes.len() - 100]).unwrap();
    case.run("pmb", &["steady", "steady.toml", "--out", "out", "--resume"])
        .exits(2)
        .says(&["restart.pmb", "checksum"]);
}
