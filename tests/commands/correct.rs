//! `dlm correct` on recordings that the lattice makes itself.

use super::setup::CaseFolder;
use dip_correct::synthetic::{Disturbance, Synthetic};
use dip_dlm::aic::Aerodynamics;
use dip_dlm::c64;
use dip_dlm::gaf::PointRule;
use dip_dlm::kernel::Kernel;
use dip_dlm::lattice::{Lattice, PlaneSymmetry, Surface};
use dip_dlm::motion::{BoxMotion, RigidMotion};
use dip_record::{CoordinateKind, Recording, Writer, WriterOptions};
use std::path::Path;

const METHODS: &str = "correct.methods=[\"downwash\",\"downwash-steady\",\"pressure-ratio\",\"force\",\"force-steady\",\"additive\",\"mode\",\"dau-garner\"]";

/// The lattice of [`CaseFolder::small`].
fn lattice() -> Aerodynamics {
    let surface = Surface::trapezoid("wing", ([0.0; 3], 0.5587), ([0.8094, 0.762, 0.0], 0.3682), 8, 10);
    let lattice = Lattice::new(vec![surface], PlaneSymmetry::Symmetric).unwrap();
    Aerodynamics::new(lattice, Kernel::QUARTIC, 0.27935).unwrap()
}

fn pitching(aerodynamics: &Aerodynamics) -> Synthetic<'_> {
    let axis = [0.27935, 0.0, 0.0];
    let mut motion = BoxMotion::empty(aerodynamics.lattice().n_boxes());
    let turn = RigidMotion {
        rotation: [0.0, 1.0, 0.0],
        centre: axis,
        ..RigidMotion::default()
    };
    motion.push_rigid(aerodynamics.lattice(), PointRule::ControlPoint, &turn);
    Synthetic {
        aerodynamics,
        mach: 0.678,
        speed_m_s: 231.37,
        density_kg_m3: 0.2082,
        name: "pitch".into(),
        kind: CoordinateKind::Pitch {
            axis_point_m: axis,
            axis_direction: [0.0, 1.0, 0.0],
        },
        mode: None,
        motion,
        omega_rad_s: 17.98 * std::f64::consts::TAU,
        amplitude: 1.0_f64.to_radians(),
        phase_rad: 0.0,
        steps_per_cycle: 40,
        cycles: 3,
        weight: Vec::new(),
        disturbance: Disturbance::default(),
    }
}

fn write(path: &Path, recording: &Recording) {
    let mut writer = Writer::create(path, recording.setup.clone(), WriterOptions::default()).unwrap();
    for step in &recording.steps {
        writer.step(step).unwrap();
    }
    writer.finish("done").unwrap();
}

fn case(change: impl FnOnce(&mut Synthetic<'_>), tamper: impl FnOnce(&mut Recording)) -> CaseFolder {
    let case = CaseFolder::small();
    let aerodynamics = lattice();
    let mut synthetic = pitching(&aerodynamics);
    change(&mut synthetic);
    let mut recording = synthetic.record().unwrap();
    tamper(&mut recording);
    write(&case.path("pitch.mcap"), &recording);
    case
}

const RUN: [&str; 6] = ["correct", "flutter.toml", "--from", "pitch.mcap", "--out", "out"];

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn the_lattice_s_own_pressures_change_nothing() {
    let case = case(|_| (), |_| ());
    let run = case
        .run("dlm", &[&RUN[..], &["--json", "--set", METHODS]].concat())
        .exits(0);
    let summary = json(&run.stdout);
    assert_eq!(summary["audit_failed"], false);
    let rows = summary["flutter"].as_array().unwrap();
    assert_eq!(rows.len(), 9 * 4, "lattice and eight corrections, by K, KE, PK and g");
    for row in rows {
        for key in [
            "mach",
            "method",
            "correction",
            "flutter_speed_m_s",
            "flutter_speed_index",
            "time_s",
        ] {
            assert!(!row[key].is_null(), "{key} in {row}");
        }
        if row["correction"] != "none" {
            assert!(row["speed_change"].as_f64().unwrap().abs() < 1e-6, "{row}");
        }
    }
    let plain = json(
        &case
            .run("dlm", &["flutter", "flutter.toml", "--out", "plain", "--json"])
            .exits(0)
            .stdout,
    );
    let speed = |v: &serde_json::Value| v["flutter"][0]["flutter_speed_m_s"].as_f64().unwrap();
    assert!((speed(&summary) / speed(&plain) - 1.0).abs() < 1e-3);
    for w in summary["machs"][0]["weights"][0]["downwash"].as_array().unwrap() {
        assert!(
            (w[0].as_f64().unwrap() - 1.0).abs() < 1e-5 && w[1].as_f64().unwrap().abs() < 1e-5,
            "{w}"
        );
    }
    for file in [
        "summary.json",
        "vg.csv",
        "weights.csv",
        "report.html",
        "weights_M0.678_k0.1364.svg",
        "phases_M0.678_k0.1364.svg",
        "sections_M0.678_k0.1364.svg",
        "vg_M0.678_downwash.svg",
        "vg_M0.678_dau-garner.svg",
    ] {
        assert!(case.path("out").join(file).exists(), "{file}");
    }
}

#[test]
fn weights_change_the_boundary_and_the_table_says_by_how_much() {
    let above = |s: &mut Synthetic<'_>| {
        s.weight = vec![c64::new(1.1, 0.0); 80];
        s.omega_rad_s = 30.0 * std::f64::consts::TAU;
    };
    let case = case(above, |_| ());
    case.edit(
        "flutter.toml",
        "[flutter]",
        "[recordings]\nfiles = [\"pitch.mcap\"]\n\n[flutter]",
    );
    let run = case.run("dlm", &["correct", "flutter.toml", "--out", "out"]).exits(0);
    for word in [
        "downwash",
        "none",
        "Audit, Mach 0.678",
        "cycle-to-cycle change",
        "not recorded",
    ] {
        assert!(run.stdout.contains(word), "{word}: {}", run.stdout);
    }
    let summary = json(&std::fs::read_to_string(case.path("out/summary.json")).unwrap());
    let changed = summary["flutter"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|r| r["correction"] == "downwash");
    for row in changed {
        // A tenth more force everywhere: a lower speed, by about half of that.
        let change = row["speed_change"].as_f64().unwrap();
        assert!(change < -0.03 && change > -0.07, "{row}");
        assert_eq!(row["rests_on"], "below");
    }
}

#[test]
fn beyond_the_recordings_the_lattice_is_linear_and_that_is_a_warning() {
    let below = |s: &mut Synthetic<'_>| {
        s.weight = vec![c64::new(1.1, 0.0); 80];
        s.omega_rad_s = 6.0 * std::f64::consts::TAU;
    };
    let case = case(below, |_| ());
    let run = case
        .run("dlm", &[&RUN[..], &["--json"]].concat())
        .exits(3)
        .says(&["far beyond the recordings"]);
    let summary = json(&run.stdout);
    for row in summary["flutter"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|r| r["correction"] == "downwash")
    {
        assert_eq!(row["rests_on"], "linear");
        assert!(row["speed_change"].as_f64().unwrap().abs() < 1e-3, "{row}");
    }
}

#[test]
fn threads_do_not_matter() {
    let case = case(|s| s.weight = vec![c64::new(1.1, 0.1); 80], |_| ());
    let run = |out, threads| {
        let command = [
            "correct",
            "flutter.toml",
            "--from",
            "pitch.mcap",
            "--out",
            out,
            "--threads",
            threads,
        ];
        case.run("dlm", &command).exits(0);
        std::fs::read_to_string(case.path(out).join("vg.csv")).unwrap()
    };
    assert_eq!(run("one", "1"), run("two", "2"));
}

#[test]
fn a_recording_of_something_else_is_refused_with_both_values() {
    let case = case(|_| (), |_| ());
    case.run("dlm", &[&RUN[..], &["--set", "lattice.mach=[0.9]"]].concat())
        .exits(2)
        .says(&["Mach number", "0.678", "0.9", "pitch.mcap"]);
    case.run("dlm", &[&RUN[..], &["--set", "reference.semichord=0.5587 m"]].concat())
        .exits(2)
        .says(&[
            "semichord",
            "0.27935",
            "0.5587",
            "half instead of full reference length",
        ]);
    case.run(
        "dlm",
        &[&RUN[..], &["--set", "correct.axis=[\"0.1 m\", \"0 m\", \"0 m\"]"]].concat(),
    )
    .exits(2)
    .says(&["pitch axis", "0.27935", "0.1"]);
    case.edit("wing.toml", "0.762 m", "0.9 m");
    case.edit("structure.toml", "nodes_spanwise = 21", "nodes_spanwise = 11");
    case.run("dlm", &RUN)
        .exits(2)
        .says(&["largest y", "0.76200", "0.90000"]);
}

#[test]
fn a_failed_audit_is_exit_3_with_the_cause() {
    let case = case(|_| (), |r| r.steps.iter_mut().for_each(|s| s.pressures.swap(0, 1)));
    let run = case.run("dlm", &RUN).exits(3).says(&["upper and lower side swapped"]);
    assert!(run.stdout.contains("FAIL"), "{}", run.stdout);
    let summary = json(&std::fs::read_to_string(case.path("out/summary.json")).unwrap());
    assert_eq!(summary["audit_failed"], true);
}

#[test]
fn bad_input_is_named() {
    let case = case(|_| (), |_| ());
    case.run("dlm", &["correct", "flutter.toml"])
        .exits(2)
        .says(&["no recording", "--from"]);
    case.run("dlm", &["correct", "flutter.toml", "--from", "wing.toml"])
        .exits(2)
        .says(&["wing.toml"]);
    case.run("dlm", &["correct", "flutter.toml", "--from", "nowhere.mcap"])
        .exits(2)
        .says(&["nowhere.mcap"]);
    case.run("dlm", &[&RUN[..], &["--set", "correct.methods=[\"downwas\"]"]].concat())
        .exits(2)
        .says(&["downwas", "pressure-ratio"]);
    case.run("dlm", &[&RUN[..], &["--set", "correct.methods=[\"full\"]"]].concat())
        .exits(2)
        .says(&["method full", "mode 1, 2, 3, 4 has none"]);
    case.run("dlm", &[&RUN[..], &["--set", "correct.blend=0.5"]].concat())
        .exits(2)
        .says(&["correct.blend", "above 1"]);
}

#[test]
fn the_schema_knows_the_keys() {
    let run = CaseFolder::small().run("dip", &["schema", "flutter"]).exits(0);
    for key in ["\"correct\"", "\"recordings\"", "\"dau-garner\"", "\"blend\""] {
        assert!(run.stdout.contains(key), "{key}");
    }
}
