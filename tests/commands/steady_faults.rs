//! What `pmb steady` keeps when something goes wrong: signals, a kill, a full disk, a case that does not converge, a grid that is
//! not whole, numbers that are none.

use super::setup::{CaseFolder, Run};
use super::steady::{history, small, summary};
use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

/// A run on a grid so fine that it cannot be over before a signal comes, with a restart file every so many steps; `steps` of it
/// are waited for.
fn started(
    case: &CaseFolder,
    out: &str,
    steps: usize,
    checkpoint: usize,
) -> (Child, impl Iterator<Item = String> + use<>) {
    for (from, to) in [
        ("surface = 48", "surface = 192"),
        ("wake = 16", "wake = 64"),
        ("normal = 24", "normal = 96"),
    ] {
        case.edit("mesh.toml", from, to);
    }
    let mut child = Command::new(env!("CARGO_BIN_EXE_pmb"))
        .args(["steady", "steady.toml", "--out", out, "-v"])
        .args([
            "--set",
            "steady.levels=1",
            "--set",
            &format!("steady.checkpoint={checkpoint}"),
        ])
        .current_dir(case.path(""))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    let last = format!("step {steps:>4}");
    assert!(lines.any(|l| l.contains(&last)), "no step {steps}");
    (child, lines)
}

/// The shell's own kill: there may be no program of that name.
fn send(signal: &str, child: &Child) {
    let command = format!("kill -{signal} {}", child.id());
    assert!(Command::new("sh").args(["-c", &command]).status().unwrap().success());
}

/// Goes on for some steps from what is there; the run is at least at `step` then.
fn goes_on(case: &CaseFolder, out: &str, steps: usize) -> u64 {
    let few = format!("steady.iterations={steps}");
    let run = case.run(
        "pmb",
        &[
            "steady",
            "steady.toml",
            "--out",
            out,
            "--resume",
            "-q",
            "--set",
            "steady.levels=1",
            "--set",
            &few,
        ],
    );
    run.exits(3);
    summary(case, out)["iterations"].as_u64().unwrap()
}

#[test]
fn a_terminated_run_writes_its_restart_file_and_goes_on() {
    let case = small();
    let (mut child, lines) = started(&case, "out", 1, 1000);
    assert!(!case.path("out/restart.pmb").exists());
    send("TERM", &child);
    let rest: Vec<String> = lines.collect();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{rest:?}");
    assert!(
        rest.iter().any(|l| l.contains("interrupted") && l.contains("--resume")),
        "{rest:?}"
    );
    let before = summary(&case, "out");
    assert_eq!(before["stop_reason"], "interrupted");
    let steps = before["iterations"].as_u64().unwrap();
    assert_eq!(goes_on(&case, "out", steps as usize + 1), steps + 1);
}

#[test]
fn a_killed_run_goes_on_from_its_last_checkpoint() {
    let case = small();
    let (mut child, lines) = started(&case, "out", 3, 1);
    send("KILL", &child);
    lines.for_each(drop);
    assert_eq!(child.wait().unwrap().code(), None);
    assert!(!case.path("out/summary.json").exists());
    // Step 3 is said after that of step 2 was written.
    assert!(goes_on(&case, "out", 4) >= 3);
}

/// Runs `pmb` with files limited to `blocks` of 512 bytes; a write beyond that fails, as on a full disk.
#[cfg(unix)]
fn on_a_full_disk(case: &CaseFolder, blocks: usize, arguments: &str) -> Run {
    let command = format!(
        "trap '' XFSZ; ulimit -f {blocks}; exec '{}' {arguments}",
        env!("CARGO_BIN_EXE_pmb")
    );
    let output = Command::new("sh")
        .args(["-c", &command])
        .current_dir(case.path(""))
        .output()
        .unwrap();
    Run::new(output)
}

#[cfg(unix)]
#[test]
fn a_full_disk_keeps_the_last_good_restart_file() {
    let case = small();
    let first = [
        "steady",
        "steady.toml",
        "--out",
        "out",
        "--set",
        "steady.iterations=2",
        "-q",
    ];
    case.run("pmb", &first).exits(3);
    let good = fs::read(case.path("out/restart.pmb")).unwrap();
    let run = on_a_full_disk(&case, 64, "steady steady.toml --out out --resume").exits(1);
    run.says(&["restart.pmb", "check the disk's space"]);
    assert!(
        fs::read(case.path("out/restart.pmb")).unwrap() == good,
        "the restart file has changed"
    );
    assert!(!case.path("out/restart.pmb.part").exists());

    // With space again it goes on as if nothing had been.
    case.run("pmb", &["steady", "steady.toml", "--out", "out", "--resume", "-q"])
        .exits(0);
    case.run("pmb", &["steady", "steady.toml", "--out", "whole", "-q"])
        .exits(0);
    assert_eq!(history(&case, "out"), history(&case, "whole"));
}

#[cfg(unix)]
#[test]
fn a_disk_too_full_for_pictures_keeps_the_restart_file_of_the_finished_run() {
    let case = small();
    // The restart file takes 129 kB, each of the two ParaView files of the flow 165 kB.
    let run = on_a_full_disk(&case, 290, "steady steady.toml --out out").exits(1);
    run.says(&["flow", "check the disk's space"]);
    // All steps are in it: nothing is left to do but to write.
    case.run("pmb", &["steady", "steady.toml", "--out", "out", "--resume", "-q"])
        .exits(0);
    case.run("pmb", &["steady", "steady.toml", "--out", "whole", "-q"])
        .exits(0);
    assert_eq!(history(&case, "out"), history(&case, "whole"));
}

#[test]
fn a_patch_without_a_condition_is_named() {
    let case = small();
    case.run("pmb", &["mesh", "mesh.toml", "-o", "grid.xyz"]).exits(0);
    case.edit("steady.toml", "recipe = \"mesh.toml\"", "file = \"grid.xyz\"");
    let conditions = fs::read_to_string(case.path("grid.bc.toml")).unwrap();
    let mut tables: Vec<&str> = conditions.split("[[patch]]").collect();
    let far = tables.iter().position(|t| t.contains("far-field")).unwrap();
    tables.remove(far);
    fs::write(case.path("grid.bc.toml"), tables.join("[[patch]]")).unwrap();
    case.run("pmb", &["steady", "steady.toml", "--out", "out"])
        .exits(2)
        .says(&[
            "imin: 24 of 24 face cells have no condition",
            "first (0, 0)",
            ".bc.toml",
        ]);
}

#[test]
fn a_case_that_does_not_converge_keeps_its_last_good_state() {
    let case = small();
    // More orders than double precision has, before round-off is reached.
    let run = [
        "steady",
        "steady.toml",
        "--out",
        "out",
        "--set",
        "steady.orders=15.9",
        "--set",
        "steady.iterations=12",
        "--set",
        "flow.mach=0.95",
    ];
    case.run("pmb", &run).exits(3).says(&["not converged"]);
    let end = summary(&case, "out");
    assert_eq!(end["converged"], false);
    assert!(end["cl"].as_f64().unwrap().is_finite());
    assert!(case.path("out/restart.pmb").exists() && case.path("out/flow.vtm").exists());
}

#[test]
fn a_node_that_is_no_number_is_named() {
    let case = small();
    case.run("pmb", &["mesh", "mesh.toml", "-o", "grid.xyz"]).exits(0);
    case.edit("steady.toml", "recipe = \"mesh.toml\"", "file = \"grid.xyz\"");
    // Plot3D as this program writes it: little-endian doubles, then the four bytes of a record's length.
    let mut bytes = fs::read(case.path("grid.xyz")).unwrap();
    let at = bytes.len() - 4 - 80;
    bytes[at..at + 8].copy_from_slice(&f64::NAN.to_le_bytes());
    fs::write(case.path("grid.xyz"), bytes).unwrap();
    case.run("pmb", &["steady", "steady.toml", "--out", "out"])
        .exits(2)
        .says(&["grid.xyz"]);
}
