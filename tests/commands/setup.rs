//! Case folders to run in, and what a run printed.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Grid of the AGARD 445.6 wing of 10,752 cells, for runs of seconds.
const SMALL_MESH: &str = r#"name = "AGARD 445.6, C-H, for tests"
kind = "wing-ch"
blocks = 4

[wing]
file = "wing.toml"
nose_radius = 0.00102
trailing_edge = "closed"
tip = "rounded"

[cells]
surface = 16
wake = 8
normal = 14
span = 10
outboard = 6

[spacing]
wall = "1.2 mm"
nose = 0.008
tail = 0.016
root = "100 mm"
tip = "12 mm"

[extent]
far_field = "6 m"
exit = "8 m"
"#;

/// A copy of `cases/agard445` in a folder of its own.
pub struct CaseFolder {
    folder: tempfile::TempDir,
}

impl CaseFolder {
    /// The shipped case as it is.
    pub fn whole() -> Self {
        let folder = tempfile::tempdir().unwrap();
        copy(
            &Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/agard445"),
            folder.path(),
        );
        Self { folder }
    }

    /// The shipped case without the curves of its study that need the flow solver.
    pub fn lattice() -> Self {
        let case = Self::whole();
        let text = std::fs::read_to_string(case.path("boundary.toml")).unwrap();
        let (from, to) = (
            text.find("# Two Euler recordings").unwrap(),
            text.find("[[published]]").unwrap(),
        );
        std::fs::write(case.path("boundary.toml"), format!("{}{}", &text[..from], &text[to..])).unwrap();
        case
    }

    /// The shipped case with flow on a small grid and long time steps, at one Mach number.
    pub fn flow() -> Self {
        let case = Self::whole();
        std::fs::write(case.path("mesh.toml"), SMALL_MESH).unwrap();
        for (file, mesh) in [
            ("pitch.toml", "../../meshes/agard445_ch_euler.toml"),
            ("pitch_modes.toml", "../../meshes/agard445_ch_euler_coarse.toml"),
            ("march.toml", "../../meshes/agard445_ch_euler.toml"),
        ] {
            case.edit(file, mesh, "mesh.toml");
            case.edit(file, "steps_per_cycle = 40", "steps_per_cycle = 24");
        }
        case.edit(
            "boundary.toml",
            "../../meshes/agard445_ch_euler_coarse.toml",
            "mesh.toml",
        );
        case.edit(
            "boundary.toml",
            "mach = [0.499, 0.678, 0.901, 0.954, 0.960]",
            "mach = [0.678]",
        );
        case
    }

    /// The shipped case, on few boxes and at one Mach number so that a run takes a moment.
    pub fn small() -> Self {
        let case = Self::lattice();
        for file in ["flutter.toml", "flutter_yates.toml"] {
            case.edit(file, "mach = [0.499, 0.678, 0.901, 0.954, 0.960]", "mach = [0.678]");
            case.edit(
                file,
                "densities = [\"0.42776 kg/m^3\", \"0.20821 kg/m^3\", \"0.09947 kg/m^3\", \"0.06339 kg/m^3\", \"0.06339 kg/m^3\"]",
                "densities = [\"0.20821 kg/m^3\"]",
            );
            case.edit(file, "spanwise = 20", "spanwise = 10");
        }
        case.edit("flutter.toml", "chordwise = 20", "chordwise = 8");
        case.edit("flutter_yates.toml", "chordwise = 10", "chordwise = 8");
        case.edit(
            "boundary.toml",
            "mach = [0.499, 0.678, 0.901, 0.954, 0.960]",
            "mach = [0.678]",
        );
        case
    }

    /// Path of a file in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Replaces text that must stand in the file once or more.
    pub fn edit(&self, file: &str, from: &str, to: &str) {
        let text = std::fs::read_to_string(self.path(file)).unwrap();
        assert!(text.contains(from), "{file} has no `{from}`");
        std::fs::write(self.path(file), text.replace(from, to)).unwrap();
    }

    /// Runs a program in the folder.
    pub fn run(&self, program: &str, arguments: &[&str]) -> Run {
        let binary = match program {
            "dip" => env!("CARGO_BIN_EXE_dip"),
            "dlm" => env!("CARGO_BIN_EXE_dlm"),
            "pmb" => env!("CARGO_BIN_EXE_pmb"),
            other => panic!("no program {other}"),
        };
        let output = Command::new(binary)
            .args(arguments)
            .current_dir(self.folder.path())
            .output()
            .unwrap();
        Run::new(output)
    }
}

fn copy(from: &Path, to: &Path) {
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            std::fs::create_dir_all(&target).unwrap();
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// What a run printed, and its exit code.
#[derive(Debug)]
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    pub fn new(output: Output) -> Self {
        Self {
            code: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Asserts the exit code.
    #[track_caller]
    pub fn exits(self, code: i32) -> Self {
        assert_eq!(self.code, code, "stdout: {}\nstderr: {}", self.stdout, self.stderr);
        self
    }

    /// Asserts that every word stands in stderr.
    #[track_caller]
    pub fn says(self, words: &[&str]) -> Self {
        for word in words {
            assert!(self.stderr.contains(word), "`{word}` is not in stderr: {}", self.stderr);
        }
        self
    }
}
