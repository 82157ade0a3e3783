//! The page on the schemas says what stands in the files, and others' programs read them.

#[path = "../examples/schema_page.rs"]
#[expect(dead_code, reason = "the example's main is not called here")]
mod schema_page;
mod synthetic;

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use dip_record::{CoordinateKind, Law, MotionCoordinate, Writer, WriterOptions};

#[test]
fn the_page_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/schema.md");
    let page = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        page == schema_page::page().unwrap(),
        "docs/schema.md is out of date: cargo run --release -p dip-record --example schema_page"
    );
}

/// Writes a file with every kind of coordinate and law, and three cycles' worth of nothing.
fn full(path: &Path) {
    let mut setup = synthetic::setup([2, 1]);
    setup.references.reynolds = Some(1e6);
    let shape = setup.motion[1].shape_m.clone();
    let more = [
        (
            CoordinateKind::Plunge {
                direction: [0.0, 0.0, 1.0],
            },
            Law::Pulse {
                mean: 0.0,
                amplitude: 1.0,
                start_s: 0.0,
                duration_s: 1.0,
                formula: "sin^2".to_owned(),
            },
        ),
        (
            CoordinateKind::Control {
                axis_point_m: [0.4, 0.0, 0.0],
                axis_direction: [0.0, 1.0, 0.0],
            },
            Law::Ramp {
                mean: 0.0,
                amplitude: 1.0,
                start_s: 0.0,
                duration_s: 1.0,
                formula: "sin^2".to_owned(),
            },
        ),
    ];
    for (kind, law) in more {
        setup.motion.push(MotionCoordinate {
            name: kind.name().to_owned(),
            kind,
            law,
            shape_m: if matches!(kind, CoordinateKind::Control { .. }) {
                shape.clone()
            } else {
                Vec::new()
            },
            mode: None,
        });
    }
    let mut writer = Writer::create(path, setup.clone(), WriterOptions::default()).unwrap();
    for n in 0..9 {
        let mut step = synthetic::step(&setup, n);
        step.motion.extend([dip_record::MotionValue::default(); 2]);
        step.shape_m = None;
        writer.step(&step).unwrap();
    }
    writer.finish("done").unwrap();
}

/// Every key in a file stands on the page, and the page has no others.
#[test]
fn the_page_knows_every_metadata_key() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("full.mcap");
    full(&path);
    let bytes = std::fs::read(&path).unwrap();
    let mut keys = BTreeSet::new();
    for record in mcap::read::LinearReader::new(&bytes).unwrap() {
        if let mcap::records::Record::Metadata(m) = record.unwrap() {
            let name = if m.name.starts_with("dip.motion.") {
                "dip.motion.N".to_owned()
            } else {
                m.name
            };
            for key in m.metadata.keys() {
                let key = match key.rsplit_once('.') {
                    Some((stem, _)) => format!("{stem}.n"),
                    None => key.clone(),
                };
                keys.insert((name.clone(), key));
            }
        }
    }
    let page = schema_page::METADATA
        .iter()
        .map(|(name, key, _, _)| ((*name).to_owned(), (*key).to_owned()))
        .collect();
    assert_eq!(keys, page);
}

/// The three lines of the page, and a look at the channel for viewers, run by the Python package.
#[test]
fn python_reads_a_recording_in_three_lines() {
    let python = |code: &str, folder: &Path| Command::new("python3").args(["-c", code]).current_dir(folder).output();
    let dir = tempfile::tempdir().unwrap();
    let there = python("import mcap.reader, mcap_protobuf.decoder", dir.path());
    if !there.is_ok_and(|o| o.status.success()) {
        eprintln!(
            "SKIPPED: Python packages mcap and mcap-protobuf-support are missing (`scripts/install-extras mcap`)"
        );
        return;
    }
    full(&dir.path().join("pitch.mcap"));
    assert_eq!(schema_page::PYTHON.lines().count(), 3);
    let out = python(schema_page::PYTHON, dir.path()).unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let text = String::from_utf8(out.stdout).unwrap();
    let setup = synthetic::setup([2, 1]);
    let lines: Vec<[f64; 3]> = text
        .lines()
        .map(|l| {
            let numbers: Vec<f64> = l.split(' ').map(|n| n.parse().unwrap()).collect();
            numbers.try_into().unwrap()
        })
        .collect();
    assert_eq!(lines.len(), 9);
    for (n, line) in lines.iter().enumerate() {
        let step = synthetic::step(&setup, n as u32);
        // Python writes the digits that give the same double back.
        assert_eq!(*line, [step.time_s, step.loads.cl, step.loads.cm]);
    }

    let code = r#"
import struct
from mcap.reader import make_reader; from mcap_protobuf.decoder import DecoderFactory
reader = make_reader(open("pitch.mcap", "rb"), validate_crcs=True, decoder_factories=[DecoderFactory()])
print(sorted(m.name for m in reader.iter_metadata()))
for schema, channel, message, cloud in reader.iter_decoded_messages("/viewer/wing"):
    assert schema.name == "foxglove.PointCloud", schema.name
    assert [f.name for f in cloud.fields] == ["x", "y", "z", "cp"] and {f.type for f in cloud.fields} == {7}
    assert message.log_time == cloud.timestamp.seconds * 10**9 + cloud.timestamp.nanos
    print(len(cloud.data) // cloud.point_stride, *struct.unpack_from("<4f", cloud.data))
"#;
    let out = python(code, dir.path()).unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let text = String::from_utf8(out.stdout).unwrap();
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some(
            "['dip.case', 'dip.check', 'dip.end', 'dip.file', 'dip.motion.1', 'dip.motion.2', 'dip.motion.3', \
             'dip.motion.4', 'dip.references']"
        )
    );
    let clouds: Vec<Vec<f64>> = lines
        .map(|l| l.split(' ').map(|n| n.parse().unwrap()).collect())
        .collect();
    assert_eq!(clouds.len(), 3, "steps 0, 4 and 8");
    for (n, cloud) in clouds.iter().enumerate() {
        let step = synthetic::step(&setup, 4 * n as u32);
        assert_eq!(cloud[0], setup.surface.face_count() as f64);
        let nodes = setup.nodes_at(&step.motion);
        for d in 0..3 {
            let mean: f64 = setup.surface.patches[0].faces[0]
                .iter()
                .map(|n| 0.25 * nodes[0][*n as usize][d])
                .sum();
            assert!((cloud[1 + d] - mean).abs() < 1e-7);
        }
        assert!((cloud[4] - step.pressures[0][0]).abs() < 1e-7);
    }
}
