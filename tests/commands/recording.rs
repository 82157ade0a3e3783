//! `dip info`, `dip export` and `dip doctor` on recordings that are known in closed form.

use super::setup::Run;
use dip_record::{
    Convergence, CoordinateKind, Harmonic, Law, Loads, MotionCoordinate, Provenance, References, Setup, Step,
    SurfaceGrid, SurfacePatch, Writer, WriterOptions,
};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const OMEGA_RAD_S: f64 = 100.0;
const STEPS_PER_CYCLE: u32 = 40;

/// Pressure per radian of one face: in phase with the motion, and ahead of it by a quarter.
fn response(face: usize) -> [f64; 2] {
    [-2.0 + 0.1 * face as f64, 0.5 - 0.05 * face as f64]
}

fn setup() -> Setup {
    let plate = |z: f64| -> Vec<[f64; 3]> {
        (0..3)
            .flat_map(|j| (0..4).map(move |i| [f64::from(i) / 3.0, 0.5 * f64::from(j), z]))
            .collect()
    };
    Setup {
        references: References {
            model: "euler".to_owned(),
            mach: 0.7,
            speed_m_s: 200.0,
            density_kg_m3: 0.5,
            pressure_pa: 29_155.0,
            gamma: 1.4,
            reynolds: None,
            alpha_deg: 0.0,
            reference_semichord_m: 0.5,
            reference_chord_m: 1.0,
            reference_area_m2: 1.0,
            span_m: 2.0,
            moment_point_m: [0.5, 0.0, 0.0],
            grid_unit_m: 1.0,
            half_model: true,
            time_step_s: std::f64::consts::TAU / OMEGA_RAD_S / f64::from(STEPS_PER_CYCLE),
            steps_per_cycle: Some(STEPS_PER_CYCLE),
            cycles_asked: Some(2.0),
            orders_asked: 2.5,
        },
        motion: vec![MotionCoordinate {
            name: "pitch".to_owned(),
            kind: CoordinateKind::Pitch {
                axis_point_m: [0.5, 0.0, 0.0],
                axis_direction: [0.0, 1.0, 0.0],
            },
            law: Law::Harmonic {
                mean: 0.0,
                phase_origin_s: 0.0,
                harmonics: vec![Harmonic {
                    omega_rad_s: OMEGA_RAD_S,
                    amplitude: 1_f64.to_radians(),
                    phase_rad: 0.0,
                }],
            },
            shape_m: Vec::new(),
            mode: None,
        }],
        surface: SurfaceGrid {
            patches: vec![
                SurfacePatch::structured("upper", plate(0.01), [3, 2], false),
                SurfacePatch::structured("lower", plate(-0.01), [3, 2], true),
            ],
        },
        provenance: Provenance {
            program: "pmb pitch".to_owned(),
            version: "0.1.0 (test)".to_owned(),
            case_name: "plate".to_owned(),
            case_text: "[flow]\nmach = 0.7\n".to_owned(),
            mesh_sha256: "ab".repeat(32),
        },
    }
}

fn step(setup: &Setup, number: u32) -> Step {
    let time_s = f64::from(number) * setup.references.time_step_s;
    let pitch = setup.motion[0].law.at(time_s).unwrap();
    let cp = |face: usize| {
        let [real, imaginary] = response(face);
        0.1 + real * pitch.value + imaginary * pitch.rate / OMEGA_RAD_S
    };
    Step {
        number,
        time_s,
        motion: vec![pitch],
        pressures: vec![(0..6).map(cp).collect(), (6..12).map(cp).collect()],
        loads: Loads {
            cl: 3.0 * pitch.value + 1.0 * pitch.rate / OMEGA_RAD_S,
            cm: -1.2 * pitch.value,
            ..Loads::default()
        },
        modal: None,
        convergence: Convergence {
            orders: if number == 7 { 1.9 } else { 2.6 },
            iterations: 4,
            converged: number != 7,
        },
        shape_m: None,
    }
}

/// A folder with a recording of two cycles.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        let setup = setup();
        let mut writer = Writer::create(&folder.path("pitch.mcap"), setup.clone(), WriterOptions::default()).unwrap();
        for n in 0..=2 * STEPS_PER_CYCLE {
            writer.step(&step(&setup, n)).unwrap();
        }
        writer.finish("all cycles asked for").unwrap();
        folder
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    /// Changes the bytes of the recording into another file.
    fn changed(&self, name: &str, change: impl FnOnce(&mut Vec<u8>)) {
        let mut bytes = fs::read(self.path("pitch.mcap")).unwrap();
        change(&mut bytes);
        fs::write(self.path(name), bytes).unwrap();
    }
    fn dip(&self, arguments: &[&str]) -> Run {
        let mut command = Command::new(env!("CARGO_BIN_EXE_dip"));
        Run::new(command.args(arguments).current_dir(self.0.path()).output().unwrap())
    }
    fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_str(&fs::read_to_string(self.path(name)).unwrap()).unwrap()
    }
}

fn parse(run: &Run) -> serde_json::Value {
    serde_json::from_str(&run.stdout).unwrap()
}

#[track_caller]
fn near(value: &serde_json::Value, exact: f64, tolerance: f64) {
    let value = value.as_f64().unwrap();
    assert!((value - exact).abs() <= tolerance, "{value}, exact {exact}");
}

#[test]
fn info_says_what_a_recording_holds() {
    let folder = Folder::new();
    let run = folder.dip(&["info", "pitch.mcap"]).exits(0);
    for words in [
        "pmb pitch 0.1.0 (test)",
        "Mach 0.7, 200 m/s",
        "all cycles asked for",
        "1.000000 deg sin at 15.9155 Hz (k = 0.25000)",
        "upper: 6 faces, 12 nodes, 1.000000 m^2",
        "81 (0 to 80)",
        "2.000 cycles",
        "1 of 81 steps below the 2.5 orders",
        "least 1.90",
    ] {
        assert!(run.stdout.contains(words), "`{words}` is not in\n{}", run.stdout);
    }
    let info = parse(&folder.dip(&["info", "pitch.mcap", "--json"]).exits(0));
    near(&info["references"]["reference_semichord_m"], 0.5, 0.0);
    near(&info["motion"][0]["reduced_frequencies"][0], 0.25, 1e-15);
    assert_eq!(info["motion"][0]["unit"], "rad");
    assert_eq!(info["steps"]["count"], 81);
    assert_eq!(info["steps"]["unconverged"], 1);
    assert_eq!(info["findings"], serde_json::json!([]));
}

/// Harmonics come out per radian in phase with the motion: the real part goes with the angle, the imaginary with its rate.
#[test]
fn harmonics_are_those_that_went_in() {
    let folder = Folder::new();
    let run = folder
        .dip(&["export", "pitch.mcap", "--harmonics", "--out", "h"])
        .exits(0);
    assert!(
        run.stdout.contains("CL = 3.00000 +1.00000 i, CM = -1.20000"),
        "{}",
        run.stdout
    );
    let summary = &folder.json("h/harmonics.json")[0];
    near(&summary["reduced_frequency"], 0.25, 1e-12);
    near(&summary["cl"][0], 3.0, 1e-9);
    near(&summary["cl"][1], 1.0, 1e-9);
    near(&summary["cm"][0], -1.2, 1e-9);
    near(&summary["cm"][1], 0.0, 1e-9);
    assert_eq!(summary["cycles_used"], 1);
    let table = fs::read_to_string(folder.path("h/harmonics.csv")).unwrap();
    let mut lines = table.lines().map(|l| l.split(',').collect::<Vec<_>>());
    let head = lines.next().unwrap();
    let column = |name: &str| head.iter().position(|c| *c == name).unwrap();
    let (re, im) = (column("cp_1_re_per_unit"), column("cp_1_im_per_unit"));
    let mut faces = 0;
    for row in lines {
        assert_eq!(row.len(), head.len());
        let exact = response(faces);
        for (at, exact) in [re, im].into_iter().zip(exact) {
            // Pressures are stored in single precision: 6e-8 of 0.1, over an amplitude of 0.017.
            let value: f64 = row[at].parse().unwrap();
            assert!((value - exact).abs() < 1e-6, "face {faces}: {value}, exact {exact}");
        }
        faces += 1;
    }
    assert_eq!(faces, 12);
}

#[test]
fn tables_json_and_paraview_files_are_written_once() {
    let folder = Folder::new();
    folder
        .dip(&["export", "pitch.mcap", "--csv", "--json", "--paraview"])
        .exits(0)
        .says(&["history.csv", "pitch.export"]);
    let history = fs::read_to_string(folder.path("pitch.export/history.csv")).unwrap();
    assert_eq!(history.lines().count(), 82);
    let recording = folder.json("pitch.export/recording.json");
    assert_eq!(recording["steps"].as_array().unwrap().len(), 81);
    near(
        &recording["steps"][10]["motion"][0]["value"],
        step(&setup(), 10).motion[0].value,
        0.0,
    );
    let series = fs::read_to_string(folder.path("pitch.export/wing.pvd")).unwrap();
    assert_eq!(series.matches("<DataSet").count(), 81);
    assert!(folder.path("pitch.export/wing/000080.vtp").exists());
    folder
        .dip(&["export", "pitch.mcap", "--csv"])
        .exits(2)
        .says(&["history.csv is there already", "--force"]);
    folder.dip(&["export", "pitch.mcap", "--csv", "--force"]).exits(0);
    folder.dip(&["export", "pitch.mcap"]).exits(2).says(&["--csv"]);
}

#[test]
fn a_healthy_recording_has_no_findings() {
    let folder = Folder::new();
    let run = folder.dip(&["doctor", "pitch.mcap"]).exits(0);
    assert!(run.stdout.contains("nothing is wrong, steps 0 to 80"), "{}", run.stdout);
}

#[test]
fn a_cut_recording_is_read_and_saved() {
    let folder = Folder::new();
    folder.changed("cut.mcap", |bytes| bytes.truncate(bytes.len() * 6 / 10));
    folder.dip(&["info", "cut.mcap"]).exits(3).says(&["unfinished"]);
    let run = folder.dip(&["doctor", "cut.mcap"]).exits(3);
    assert!(
        run.stdout.contains("without an end") && run.stdout.contains("--save"),
        "{}",
        run.stdout
    );
    let run = folder
        .dip(&["doctor", "cut.mcap", "--save", "good.mcap", "--json"])
        .exits(3);
    let report = parse(&run);
    assert_eq!(report["findings"][0]["kind"], "unfinished");
    assert_eq!(report["saved_to"], "good.mcap");
    let saved = &report["saved_steps"];
    assert_eq!(saved[0], 0);
    assert!(saved[1].as_u64().unwrap() >= 30, "{saved}");
    folder.dip(&["doctor", "good.mcap"]).exits(0);
    let info = parse(&folder.dip(&["info", "good.mcap", "--json"]).exits(0));
    assert_eq!(info["steps"]["last"], saved[1]);
    assert!(info["end"].as_str().unwrap().contains("dip doctor"));
    folder
        .dip(&["doctor", "cut.mcap", "--save", "good.mcap"])
        .exits(2)
        .says(&["is there already"]);
    folder
        .dip(&["doctor", "cut.mcap", "--save", "cut.mcap", "--force"])
        .exits(2)
        .says(&["over itself"]);
    folder
        .dip(&["export", "cut.mcap", "--harmonics"])
        .exits(3)
        .says(&["unfinished"]);
}

#[test]
fn damage_in_the_middle_names_the_steps() {
    let folder = Folder::new();
    // A byte may belong to a chunk, whose steps are then lost, or to an index beside it; among some there are those of a chunk.
    let lost = (0..40).find_map(|n| {
        folder.changed("bad.mcap", |bytes| {
            let at = bytes.len() / 2 + 97 * n;
            bytes[at] ^= 0x10;
        });
        let report = parse(&folder.dip(&["doctor", "bad.mcap", "--json"]).exits(3));
        let findings = report["findings"].as_array().unwrap();
        let kinds: Vec<String> = findings
            .iter()
            .map(|f| f["kind"].as_str().unwrap().to_owned())
            .collect();
        assert!(!kinds.is_empty(), "byte {n}: nothing found");
        let gap = kinds.iter().any(|k| k == "gap");
        if gap {
            assert!(kinds.iter().any(|k| k == "corrupt"), "{kinds:?}");
        }
        gap.then_some(report)
    });
    let report = lost.expect("a byte of a chunk");
    assert_eq!(report["good_steps"].as_array().unwrap().len(), 2);
}

/// The metadata can be read by eye, and changed by hand: that is found.
#[test]
fn files_that_cannot_be_used_are_explained() {
    let folder = Folder::new();
    let replace = |bytes: &mut Vec<u8>, from: &[u8], to: &[u8]| {
        let at = bytes.windows(from.len()).position(|w| w == from).unwrap();
        bytes[at..at + to.len()].copy_from_slice(to);
    };
    folder.changed("changed.mcap", |b| replace(b, b"200.0", b"300.0"));
    folder.changed("newer.mcap", |b| {
        replace(b, b"format\x01\0\0\x001", b"format\x01\0\0\x009");
    });
    fs::write(folder.path("text.mcap"), "step,time_s\n").unwrap();
    fs::write(folder.path("empty.mcap"), "").unwrap();
    for (file, words) in [
        ("changed.mcap", "checksum"),
        ("newer.mcap", "format 9"),
        ("text.mcap", "not an MCAP file"),
        ("empty.mcap", "it is empty"),
    ] {
        let run = folder.dip(&["doctor", file]).exits(3);
        assert!(
            run.stdout.contains(words) && run.stdout.contains("nothing can be saved"),
            "{file}: {}",
            run.stdout
        );
        folder.dip(&["info", file]).exits(2).says(&[words, file]);
        folder.dip(&["export", file, "--csv"]).exits(2).says(&[words]);
    }
    folder.dip(&["doctor", "none.mcap"]).exits(2).says(&["none.mcap"]);
    assert!(!Path::new("none.mcap").exists());
}

/// Less than a cycle has no harmonics, and no file is left behind.
#[test]
fn too_short_a_record_has_no_harmonics() {
    let folder = Folder::new();
    let setup = setup();
    let mut writer = Writer::create(&folder.path("short.mcap"), setup.clone(), WriterOptions::default()).unwrap();
    for n in 0..20 {
        writer.step(&step(&setup, n)).unwrap();
    }
    writer.finish("interrupted").unwrap();
    folder
        .dip(&["export", "short.mcap", "--harmonics", "--csv"])
        .exits(2)
        .says(&["cycle"]);
    assert!(!folder.path("short.export").exists());
}

/// A pulse gives loads at any reduced frequency: CL = 3 alpha + 0.002 s alpha' has the ratio 3 + 0.002 s i omega.
#[test]
fn a_pulse_has_loads_at_every_frequency_asked() {
    const STEP_S: f64 = 2e-4;
    const DURATION_S: f64 = 0.04;
    let folder = Folder::new();
    let mut setup = setup();
    let at_rest = step(&setup, 0);
    setup.references.steps_per_cycle = None;
    setup.references.time_step_s = STEP_S;
    setup.motion[0].law = Law::Pulse {
        mean: 0.0,
        amplitude: 0.01,
        start_s: 0.0,
        duration_s: DURATION_S,
        formula: "sin^2(pi t/T)".to_owned(),
    };
    let mut writer = Writer::create(&folder.path("pulse.mcap"), setup.clone(), WriterOptions::default()).unwrap();
    for n in 0..=400 {
        let time_s = f64::from(n) * STEP_S;
        let turn = std::f64::consts::PI / DURATION_S;
        let (value, rate) = if time_s < DURATION_S {
            let (sin, cos) = (turn * time_s).sin_cos();
            (0.01 * sin * sin, 0.02 * turn * sin * cos)
        } else {
            (0.0, 0.0)
        };
        let mut now = at_rest.clone();
        now.number = n;
        now.time_s = time_s;
        now.motion[0].value = value;
        now.motion[0].rate = rate;
        now.loads.cl = 0.2 + 3.0 * value + 0.002 * rate;
        now.loads.cm = -1.2 * value;
        writer.step(&now).unwrap();
    }
    writer.finish("all steps").unwrap();
    folder
        .dip(&[
            "export",
            "pulse.mcap",
            "--harmonics",
            "--k",
            "0.1",
            "--k",
            "0.25",
            "--out",
            "h",
        ])
        .exits(0);
    let summary = folder.json("h/harmonics.json");
    for (n, omega) in [(1, 40.0), (2, 100.0)] {
        let row = &summary[n];
        near(&row["omega_rad_s"], omega, 1e-9);
        near(&row["cl"][0], 3.0, 2e-3);
        near(&row["cl"][1], 0.002 * omega, 2e-3);
        near(&row["cm"][0], -1.2, 1e-3);
        near(&row["cm"][1], 0.0, 1e-3);
    }
}
