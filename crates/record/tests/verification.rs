//! Exact properties: what goes in comes out to the bit, the same run makes the same file, every change is found.

mod synthetic;

use std::fs;
use std::path::{Path, PathBuf};

use dip_record::{
    FindingKind, Law, MotionValue, Precision, RecordError, Recording, Setup, Step, Writer, WriterOptions,
};

const DOUBLE: WriterOptions = WriterOptions {
    steps_per_chunk: 5,
    viewer_every: 4,
    precision: Precision::Double,
};

/// Writes steps `0..count` and ends the file.
fn record(path: &Path, setup: &Setup, options: WriterOptions, count: u32) {
    let mut writer = Writer::create(path, setup.clone(), options).unwrap();
    for n in 0..count {
        writer.step(&synthetic::step(setup, n)).unwrap();
    }
    writer.finish("two cycles agree").unwrap();
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

#[test]
fn a_recording_comes_back_to_the_bit() {
    let dir = folder();
    let path = dir.path().join("a.mcap");
    let setup = synthetic::setup([6, 4]);
    record(&path, &setup, DOUBLE, 83);
    let back = Recording::read(&path).unwrap();
    assert_eq!(back.setup, setup);
    assert_eq!(back.end.as_deref(), Some("two cycles agree"));
    assert_eq!(back.steps.len(), 83);
    for (n, step) in back.steps.iter().enumerate() {
        let asked = synthetic::step(&setup, n as u32);
        assert_eq!(*step, asked);
        assert_eq!(step.time_s.to_bits(), asked.time_s.to_bits());
    }
}

#[test]
fn single_precision_rounds_pressures_and_nothing_else() {
    let dir = folder();
    let path = dir.path().join("a.mcap");
    let setup = synthetic::setup([6, 4]);
    record(&path, &setup, WriterOptions::default(), 12);
    let back = Recording::read(&path).unwrap();
    for (n, step) in back.steps.iter().enumerate() {
        let mut asked = synthetic::step(&setup, n as u32);
        for cp in asked.pressures.iter_mut().flatten() {
            *cp = f64::from(*cp as f32);
        }
        assert_eq!(*step, asked);
    }
}

/// Complex amplitude of samples at the instants, by least squares with a mean and two harmonics of exp(i omega t).
fn first_harmonic(samples: impl Iterator<Item = (f64, f64)>) -> [f64; 2] {
    // Whole cycles of equal steps: the columns are orthogonal and the fit is a sum.
    let (mut re, mut im, mut count) = (0.0, 0.0, 0.0);
    for (time_s, value) in samples {
        let (sin, cos) = (synthetic::OMEGA_RAD_S * time_s).sin_cos();
        re += 2.0 * value * cos;
        im -= 2.0 * value * sin;
        count += 1.0;
    }
    [re / count, im / count]
}

/// Every step belongs to its instant: a history that is stamped one step off would turn the phase by 9 degrees.
#[test]
fn harmonics_of_a_synthetic_solver_come_back_to_round_off() {
    let dir = folder();
    let path = dir.path().join("a.mcap");
    let setup = synthetic::setup([6, 4]);
    record(&path, &setup, DOUBLE, 2 * synthetic::STEPS_PER_CYCLE);
    let back = Recording::read(&path).unwrap();
    let last = &back.steps[synthetic::STEPS_PER_CYCLE as usize..];
    let a = first_harmonic(last.iter().map(|s| (s.time_s, s.motion[0].value)));
    let mut face = 0;
    for patch in 0..back.setup.surface.patches.len() {
        for f in 0..back.setup.surface.patches[patch].faces.len() {
            let p = first_harmonic(last.iter().map(|s| (s.time_s, s.pressures[patch][f])));
            // p / a as complex numbers; the exact answer is inphase + i rate.
            let norm = a[0] * a[0] + a[1] * a[1];
            let ratio = [(p[0] * a[0] + p[1] * a[1]) / norm, (p[1] * a[0] - p[0] * a[1]) / norm];
            let exact = synthetic::response(face);
            for d in 0..2 {
                assert!(
                    (ratio[d] - exact[d]).abs() < 1e-12,
                    "face {face}: {ratio:?}, exact {exact:?}"
                );
            }
            face += 1;
        }
    }
}

#[test]
fn the_same_run_makes_the_same_file() {
    let dir = folder();
    let setup = synthetic::setup([6, 4]);
    let [a, b] = ["a", "b"].map(|n| dir.path().join(n));
    record(&a, &setup, WriterOptions::default(), 33);
    record(&b, &setup, WriterOptions::default(), 33);
    assert!(fs::read(a).unwrap() == fs::read(b).unwrap());
}

/// Stopped anywhere, in order or not, and gone on with from any step: the same file to the bit.
#[test]
fn a_resumed_recording_is_the_one_that_was_never_stopped() {
    let dir = folder();
    let setup = synthetic::setup([6, 4]);
    let whole = dir.path().join("whole.mcap");
    record(&whole, &setup, WriterOptions::default(), 33);
    let whole = fs::read(whole).unwrap();
    for (stop, restart, in_order) in [
        (17, 16, true),
        (17, 13, true),
        (21, 20, false),
        (20, 15, false),
        (23, 12, false),
        (1, 0, false),
        (33, 32, true),
    ] {
        let path = dir.path().join("stopped.mcap");
        let mut writer = Writer::create(&path, setup.clone(), WriterOptions::default()).unwrap();
        for n in 0..stop {
            writer.step(&synthetic::step(&setup, n)).unwrap();
        }
        if in_order {
            writer.finish("interrupted").unwrap();
        } else {
            assert!(writer.safe_step() >= Some(restart));
            drop(writer);
        }
        let mut writer = Writer::resume(&path, setup.clone(), WriterOptions::default(), restart).unwrap();
        for n in restart + 1..33 {
            writer.step(&synthetic::step(&setup, n)).unwrap();
        }
        writer.finish("two cycles agree").unwrap();
        assert!(
            fs::read(&path).unwrap() == whole,
            "stopped after {stop} steps, gone on after step {restart}"
        );
    }
}

/// Stopped in order between two chunks, gone on with, and killed before the next chunk: the steps up to the restart are
/// still there, and so is the way on.
#[test]
fn a_kill_just_after_resuming_loses_nothing() {
    let dir = folder();
    let setup = synthetic::setup([6, 4]);
    let whole = dir.path().join("whole.mcap");
    record(&whole, &setup, WriterOptions::default(), 33);
    let path = dir.path().join("stopped.mcap");
    record(&path, &setup, WriterOptions::default(), 18);
    let resume = |cycles: f64| {
        let mut setup = setup.clone();
        setup.references.cycles_asked = Some(cycles);
        Writer::resume(&path, setup, WriterOptions::default(), 17).unwrap()
    };
    let mut writer = resume(9.0);
    writer.step(&synthetic::step(&setup, 18)).unwrap();
    drop(writer);
    let reaches = Recording::read_salvage(&path)
        .unwrap()
        .recording
        .steps
        .last()
        .unwrap()
        .number;
    assert!(reaches >= 17, "{reaches}");
    let mut writer = resume(setup.references.cycles_asked.unwrap());
    for n in 18..33 {
        writer.step(&synthetic::step(&setup, n)).unwrap();
    }
    writer.finish("two cycles agree").unwrap();
    assert!(fs::read(&path).unwrap() == fs::read(whole).unwrap());
}

#[test]
fn resuming_what_does_not_fit_is_refused_and_keeps_the_file() {
    let dir = folder();
    let path = dir.path().join("a.mcap");
    let setup = synthetic::setup([6, 4]);
    record(&path, &setup, WriterOptions::default(), 10);
    let before = fs::read(&path).unwrap();
    let mut other = setup.clone();
    other.references.mach = 0.7;
    for (setup, step, word) in [(other, 5, "reference quantities"), (setup, 10, "step 9")] {
        let error = Writer::resume(&path, setup, WriterOptions::default(), step).unwrap_err();
        assert!(matches!(error, RecordError::Resume { .. }));
        assert!(error.to_string().contains(word), "{error}");
    }
    assert_eq!(fs::read(&path).unwrap(), before);
}

/// Cut anywhere, a file gives what was in its whole chunks, and says that it is not finished.
#[test]
fn a_file_cut_at_any_byte_gives_its_whole_chunks() {
    let dir = folder();
    let path = dir.path().join("a.mcap");
    let setup = synthetic::setup([3, 2]);
    // Length of the file after each step.
    let mut writer = Writer::create(&path, setup.clone(), WriterOptions::default()).unwrap();
    let mut lengths = vec![(fs::metadata(&path).unwrap().len(), 0)];
    for n in 0..23 {
        writer.step(&synthetic::step(&setup, n)).unwrap();
        let steps = writer.safe_step().map_or(0, |n| n + 1) as usize;
        lengths.push((fs::metadata(&path).unwrap().len(), steps));
    }
    writer.finish("done").unwrap();
    let bytes = fs::read(&path).unwrap();
    let whole = Recording::read(&path).unwrap();
    for cut in 0..bytes.len() {
        // What is flushed is there; a chunk counts from its last byte on, a little before its index is written.
        let sure = lengths.iter().rev().find(|(length, _)| *length <= cut as u64);
        let next = lengths
            .iter()
            .find(|(length, _)| *length > cut as u64)
            .map_or(23, |(_, steps)| *steps);
        match (Recording::from_bytes(&bytes[..cut], "cut"), sure) {
            (Err(_), None) => {}
            (Ok(salvage), sure) => {
                assert!(
                    salvage.findings.iter().any(|f| f.kind == FindingKind::Unfinished),
                    "cut at {cut}: {:?}",
                    salvage.findings
                );
                let sure = sure.map_or(0, |(_, steps)| *steps);
                let got = salvage.recording.steps.len();
                assert!(
                    got == sure || got == next,
                    "cut at {cut}: {got} steps, {sure} were safe"
                );
                assert_eq!(salvage.recording.steps[..], whole.steps[..got]);
            }
            (Err(error), Some(_)) => panic!("cut at {cut}: {error}"),
        }
    }
}

/// In a finished file no bit can change without an error or a finding.
#[test]
fn every_flipped_bit_is_found() {
    let dir = folder();
    let path = dir.path().join("a.mcap");
    let setup = synthetic::setup([2, 1]);
    record(&path, &setup, WriterOptions::default(), 7);
    let mut bytes = fs::read(&path).unwrap();
    let whole = Recording::from_bytes(&bytes, "whole").unwrap();
    assert_eq!(whole.findings, []);
    for at in 0..bytes.len() {
        let bit = 1 << (at % 8);
        bytes[at] ^= bit;
        if let Ok(salvage) = Recording::from_bytes(&bytes, "flipped") {
            assert!(
                salvage.findings.iter().any(|f| f.kind.is_damage()),
                "byte {at} of {}, bit {bit:#x}",
                bytes.len()
            );
            for step in &salvage.recording.steps {
                assert_eq!(*step, whole.recording.steps[step.number as usize], "byte {at}");
            }
            assert_eq!(salvage.recording.setup, setup, "byte {at}");
        }
        bytes[at] ^= bit;
    }
}

/// A chunk that is damaged in the middle costs its own steps only.
#[test]
fn damage_in_the_middle_costs_one_chunk() {
    let dir = folder();
    let path = dir.path().join("a.mcap");
    let setup = synthetic::setup([6, 4]);
    record(&path, &setup, WriterOptions::default(), 40);
    let mut bytes = fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    for byte in &mut bytes[middle..middle + 16] {
        *byte ^= 0xa5;
    }
    let salvage = Recording::from_bytes(&bytes, "damaged").unwrap();
    let kinds: Vec<FindingKind> = salvage.findings.iter().map(|f| f.kind).collect();
    assert!(
        kinds.contains(&FindingKind::Corrupt) && kinds.contains(&FindingKind::Gap),
        "{kinds:?}"
    );
    let [first, second] = salvage.runs[..] else {
        panic!("{:?}", salvage.runs)
    };
    assert_eq!((first[0], second[1]), (0, 39));
    assert_eq!(second[0] - first[1], 6, "one chunk of five steps: {:?}", salvage.runs);
    let longest = salvage.recording.steps.len() as u32;
    assert_eq!(longest, (first[1] + 1).max(40 - second[0]));
    fs::write(&path, &bytes).unwrap();
    let error = Recording::read(&path).unwrap_err().to_string();
    assert!(error.contains("checksum") && error.contains("missing"), "{error}");
}

#[test]
fn files_of_others_are_named_as_such() {
    let dir = folder();
    let path = dir.path().join("x");
    let read = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        Recording::read(&path).unwrap_err()
    };
    assert!(matches!(read(b""), RecordError::NotMcap { .. }));
    assert!(matches!(read(b"x,y\n1,2\n"), RecordError::NotMcap { .. }));
    let mut foreign = Vec::new();
    let mut writer = mcap::Writer::new(std::io::Cursor::new(&mut foreign)).unwrap();
    writer.finish().unwrap();
    drop(writer);
    assert!(matches!(read(&foreign), RecordError::Foreign { .. }));
    let error = Recording::read(&dir.path().join("none.mcap")).unwrap_err();
    assert!(matches!(error, RecordError::Io { .. }) && error.to_string().contains("none.mcap"));
}

/// A file with our profile and whatever metadata and channels; no steps.
fn forged(metadata: &[(&str, &[(&str, &str)])], topics: &[&str]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut writer = mcap::WriteOptions::new()
        .profile("dip")
        .create(std::io::Cursor::new(&mut bytes))
        .unwrap();
    for (name, entries) in metadata {
        let entries = entries
            .iter()
            .map(|(k, v)| ((*k).to_owned(), (*v).to_owned()))
            .collect();
        let record = mcap::records::Metadata {
            name: (*name).to_owned(),
            metadata: entries,
        };
        writer.write_metadata(&record).unwrap();
    }
    for topic in topics {
        writer.add_channel(0, topic, "protobuf", &Default::default()).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    bytes
}

#[test]
fn another_format_and_missing_metadata_are_named() {
    let newer = forged(&[("dip.file", &[("format", "2"), ("version", "9.0")])], &[]);
    let error = Recording::from_bytes(&newer, "newer").unwrap_err();
    assert!(
        matches!(error, RecordError::Format { .. }) && error.to_string().contains("9.0"),
        "{error}"
    );
    let error = Recording::from_bytes(&forged(&[], &[]), "bare").unwrap_err();
    assert!(
        matches!(error, RecordError::Setup { .. }) && error.to_string().contains("dip.file"),
        "{error}"
    );
}

/// Copies a good file without one channel.
#[test]
fn a_missing_channel_is_named() {
    let dir = folder();
    let path = dir.path().join("a.mcap");
    let setup = synthetic::setup([2, 1]);
    record(&path, &setup, WriterOptions::default(), 3);
    let bytes = fs::read(&path).unwrap();
    for lost in [
        "/motion",
        "/surface/pressure",
        "/surface/grid",
        "/loads",
        "/convergence",
    ] {
        let mut copy = Vec::new();
        let mut writer = mcap::WriteOptions::new()
            .profile("dip")
            .create(std::io::Cursor::new(&mut copy))
            .unwrap();
        for record in mcap::read::LinearReader::new(&bytes).unwrap() {
            if let mcap::records::Record::Metadata(m) = record.unwrap() {
                writer.write_metadata(&m).unwrap();
            }
        }
        for message in mcap::MessageStream::new(&bytes).unwrap() {
            let message = message.unwrap();
            if message.channel.topic != lost {
                writer.write(&message).unwrap();
            }
        }
        writer.finish().unwrap();
        drop(writer);
        let error = Recording::from_bytes(&copy, "copy").unwrap_err();
        assert!(
            matches!(&error, RecordError::MissingChannel { topic, .. } if *topic == lost),
            "{error}"
        );
    }
}

#[test]
fn what_does_not_fit_is_refused_with_words() {
    let dir = folder();
    let path = dir.path().join("a.mcap");
    let setup = synthetic::setup([2, 1]);
    let refused = |change: &dyn Fn(&mut Setup), word: &str| {
        let mut setup = setup.clone();
        change(&mut setup);
        let error = Writer::create(&path, setup, WriterOptions::default()).unwrap_err();
        assert!(matches!(error, RecordError::Input { .. }));
        assert!(error.to_string().contains(word), "{error}");
    };
    refused(&|s| s.references.speed_m_s = f64::NAN, "speed_m_s");
    refused(&|s| s.references.reference_semichord_m = 0.0, "reference_semichord_m");
    refused(&|s| s.surface.patches.clear(), "no patch");
    refused(&|s| s.surface.patches[1].name = "upper".to_owned(), "two patches");
    refused(&|s| s.surface.patches[0].faces[0][2] = 99, "node 99");
    refused(&|s| s.surface.patches[0].nodes_m[1][2] = f64::INFINITY, "node 1");
    refused(&|s| s.motion[1].shape_m[0].truncate(1), "1 nodes");
    refused(&|s| s.motion[1].shape_m.clear(), "needs a shape");
    refused(&|s| s.motion[1].name = "pitch".to_owned(), "two motion coordinates");

    let refused = |step: &Step, word: &str| {
        let mut writer = Writer::create(&path, setup.clone(), WriterOptions::default()).unwrap();
        writer.step(&synthetic::step(&setup, 6)).unwrap();
        let error = writer.step(step).unwrap_err();
        assert!(matches!(error, RecordError::Input { .. }));
        assert!(error.to_string().contains(word), "{error}");
        // Nothing of the refused step is in the file.
        writer.step(&synthetic::step(&setup, 7)).unwrap();
        writer.finish("done").unwrap();
        assert_eq!(Recording::read(&path).unwrap().steps.len(), 2);
    };
    let good = synthetic::step(&setup, 7);
    refused(&synthetic::step(&setup, 8), "the next is needed");
    refused(
        &Step {
            time_s: synthetic::step(&setup, 6).time_s,
            ..good.clone()
        },
        "later",
    );
    refused(
        &Step {
            time_s: f64::NAN,
            ..good.clone()
        },
        "NaN",
    );
    let with = |change: &dyn Fn(&mut Step)| {
        let mut step = good.clone();
        change(&mut step);
        step
    };
    refused(&with(&|s| s.pressures[1][0] = f64::NAN), "face 0 of patch `lower`");
    refused(&with(&|s| s.pressures[1][0] = 1e300), "single precision");
    refused(&with(&|s| s.pressures.truncate(1)), "needed 3");
    refused(&with(&|s| s.motion[0].rate = f64::INFINITY), "rate of `pitch`");
    refused(&with(&|s| s.loads.cm = f64::NAN), "CM");
    refused(&with(&|s| s.modal.as_mut().unwrap().q_dot.clear()), "modal rates");
}

/// A full disk is an error with the path, not a silent hole.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said_with_the_path() {
    let full = PathBuf::from("/dev/full");
    if !full.exists() {
        return;
    }
    let error = Writer::create(&full, synthetic::setup([2, 1]), WriterOptions::default()).unwrap_err();
    assert!(matches!(error, RecordError::Io { .. }), "{error:?}");
    assert!(error.to_string().contains("/dev/full"), "{error}");
}

/// A history that is stamped one step late does not fit the law that stands beside it.
#[test]
fn a_motion_that_is_not_its_law_is_found() {
    let dir = folder();
    let path = dir.path().join("a.mcap");
    let setup = synthetic::setup([2, 1]);
    let shifted = |n: u32| Step {
        motion: synthetic::step(&setup, n + 1).motion,
        ..synthetic::step(&setup, n)
    };
    let mut writer = Writer::create(&path, setup.clone(), WriterOptions::default()).unwrap();
    for n in 0..20 {
        writer.step(&shifted(n)).unwrap();
    }
    writer.finish("done").unwrap();
    let salvage = Recording::read_salvage(&path).unwrap();
    let [finding] = &salvage.findings[..] else {
        panic!("{:?}", salvage.findings)
    };
    assert_eq!(finding.kind, FindingKind::Motion);
    assert!(
        finding.what.contains("`pitch`") && finding.what.contains("rad"),
        "{finding}"
    );
    // Nothing is lost, so it can be read all the same.
    assert_eq!(Recording::read(&path).unwrap().steps.len(), 20);
}

#[test]
fn a_law_is_its_formula() {
    let setup = synthetic::setup([1, 1]);
    let Law::Harmonic { harmonics, .. } = &setup.motion[0].law else {
        panic!()
    };
    let t = 0.0123;
    let value: f64 = 0.003
        + harmonics
            .iter()
            .map(|h| h.amplitude * (h.omega_rad_s * t + h.phase_rad).sin())
            .sum::<f64>();
    let now = setup.motion[0].law.at(t).unwrap();
    assert!((now.value - value).abs() < 1e-16);
    // The rate against a central difference of fourth order.
    let f = |n: f64| setup.motion[0].law.at(t + 1e-4 * n).unwrap().value;
    let rate = (8.0 * (f(1.0) - f(-1.0)) - (f(2.0) - f(-2.0))) / (12.0 * 1e-4);
    assert!((now.rate - rate).abs() < 1e-7 * now.rate.abs());
    assert_eq!(Law::Free.at(t), None);
}

/// Nose up: the nose rises, lengths stay.
#[test]
fn the_wall_moves_as_the_coordinates_say() {
    let setup = synthetic::setup([4, 2]);
    let at = |pitch: f64, q: f64| {
        setup.nodes_at(&[
            MotionValue {
                value: pitch,
                rate: 0.0,
            },
            MotionValue { value: q, rate: 0.0 },
        ])
    };
    let rest: Vec<_> = setup.surface.patches.iter().map(|p| p.nodes_m.clone()).collect();
    assert_eq!(at(0.0, 0.0), rest);
    let up = at(0.1, 0.0);
    assert!(up[0][0][2] > rest[0][0][2], "the leading edge rises");
    assert!(up[0][4][2] < rest[0][4][2], "the trailing edge falls");
    let distance = |p: [f64; 3], q: [f64; 3]| (0..3).map(|d| (p[d] - q[d]).powi(2)).sum::<f64>().sqrt();
    for (n, m) in [(0, 4), (3, 11), (7, 14)] {
        let change = distance(up[0][n], up[0][m]) - distance(rest[0][n], rest[0][m]);
        assert!(change.abs() < 1e-15);
    }
    // A quarter turn about +y takes +x to -z.
    let quarter = at(std::f64::consts::FRAC_PI_2, 0.0);
    let (r, axis) = (rest[0][4], 0.27935);
    let exact = [axis + r[2], r[1], -(r[0] - axis)];
    assert!(distance(quarter[0][4], exact) < 1e-15);
    let bent = at(0.0, 2.0);
    for (b, r) in bent[2].iter().zip(&rest[2]) {
        assert!(distance(*b, [r[0], r[1], r[2] + 2.0 * r[1] * r[1]]) < 1e-15);
    }
}

/// A closed box: area vectors point out and sum to zero, centroids lie on the faces.
#[test]
fn areas_point_into_the_fluid_and_close() {
    let node = |x: f64, y: f64| [x, y, 0.3 * x - 0.1 * y];
    // A warped and a flat face, and one with two nodes in one place.
    let nodes = vec![node(0.0, 0.0), node(2.0, 0.0), node(2.0, 1.0), node(0.0, 1.0)];
    let patch =
        dip_record::SurfacePatch::structured("flat", vec![nodes[0], nodes[1], nodes[3], nodes[2]], [1, 1], false);
    assert_eq!(patch.faces, [[0, 1, 3, 2]]);
    for (got, exact) in patch.areas_m2[0].iter().zip([-0.6, 0.2, 2.0]) {
        assert!((got - exact).abs() < 1e-15);
    }
    for (got, exact) in patch.centroids_m[0].iter().zip([1.0, 0.5, 0.25]) {
        assert!((got - exact).abs() < 1e-15);
    }
    assert_eq!(patch.upper, [true]);
    let flipped =
        dip_record::SurfacePatch::structured("flat", vec![nodes[0], nodes[1], nodes[3], nodes[2]], [1, 1], true);
    assert_eq!(flipped.upper, [false]);
    assert_eq!(flipped.areas_m2[0], patch.areas_m2[0].map(|a| -a));
    let triangle = dip_record::SurfacePatch::new("triangle", nodes.clone(), vec![[0, 1, 2, 2]]);
    assert!((triangle.areas_m2[0][2] - 1.0).abs() < 1e-15);
    for (got, exact) in triangle.centroids_m[0]
        .iter()
        .zip([4.0 / 3.0, 1.0 / 3.0, 0.4 - 1.0 / 30.0])
    {
        assert!((got - exact).abs() < 1e-15);
    }
    let sides = synthetic::surface([5, 3]);
    let [upper, lower] = [0, 1].map(|p| {
        sides.patches[p]
            .areas_m2
            .iter()
            .fold([0.0; 3], |s, a| [s[0] + a[0], s[1] + a[1], s[2] + a[2]])
    });
    assert!(upper[2] > 0.0 && (upper[2] + lower[2]).abs() < 1e-15);
    assert!((upper[2] - 0.5587 * 0.762).abs() < 1e-15);
}

/// The table of a recording holds its numbers to the bit.
#[test]
fn tables_hold_the_numbers() {
    let setup = synthetic::setup([2, 1]);
    let recording = Recording {
        steps: (0..3).map(|n| synthetic::step(&setup, n)).collect(),
        setup,
        end: None,
    };
    let rows = |table: &str| -> Vec<Vec<String>> {
        table
            .lines()
            .map(|l| l.split(',').map(str::to_owned).collect())
            .collect()
    };
    let history = rows(&dip_record::csv::history(&recording));
    assert_eq!(history[0][..4], ["step", "time_s", "pitch_rad", "pitch_rate_rad_per_s"]);
    assert!(history.iter().all(|r| r.len() == history[0].len()));
    let at = |name: &str| history[0].iter().position(|c| c == name).unwrap();
    for (row, step) in history[1..].iter().zip(&recording.steps) {
        let number = |name: &str| row[at(name)].parse::<f64>().unwrap();
        assert_eq!(number("time_s"), step.time_s);
        assert_eq!(number("pitch_rad"), step.motion[0].value);
        assert_eq!(number("moment_y_n_m"), step.loads.moment_n_m[1]);
        assert_eq!(number("generalized_force_1_j"), step.modal.as_ref().unwrap().force_j[0]);
        assert_eq!(row.last().unwrap(), &step.convergence.converged.to_string());
    }
    let pressure = rows(&dip_record::csv::pressure(&recording));
    let surface = rows(&dip_record::csv::surface(&recording));
    assert_eq!(pressure[0].len(), 2 + surface.len() - 1);
    assert_eq!(pressure[0][2], "cp upper 0");
    assert_eq!(
        pressure[2][3].parse::<f64>().unwrap(),
        recording.steps[1].pressures[0][1]
    );
    assert_eq!(surface[3][..2], ["lower", "0"]);
    assert_eq!(dip_record::csv::quoted("a,\"b\""), "\"a,\"\"b\"\"\"");
}

/// The series has every step at its instant, and its arrays hold points and pressures.
#[test]
fn a_series_for_paraview_holds_every_step() {
    let dir = folder();
    let setup = synthetic::setup([3, 2]);
    let recording = Recording {
        steps: (4..7).map(|n| synthetic::step(&setup, n)).collect(),
        setup,
        end: None,
    };
    let files = dip_record::paraview::write(&dir.path().join("wing.pvd"), &recording).unwrap();
    assert_eq!(files.len(), 4);
    let index = fs::read_to_string(dir.path().join("wing.pvd")).unwrap();
    for step in &recording.steps {
        assert!(index.contains(&format!("timestep=\"{:?}\"", step.time_s)));
        let bytes = fs::read(dir.path().join(format!("wing/{:06}.vtp", step.number))).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        // What stands at the offset that the header gives, after its length.
        let start = bytes.windows(2).position(|w| w == b"\n_").unwrap() + 2;
        let array = |name: &str| -> Vec<f32> {
            let head = text.find(&format!("Name=\"{name}\"")).unwrap();
            let offset = text[head..].split("offset=\"").nth(1).unwrap();
            let at = start + offset[..offset.find('"').unwrap()].parse::<usize>().unwrap();
            let length = u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize;
            bytes[at + 8..at + 8 + length]
                .chunks_exact(4)
                .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
                .collect()
        };
        let cp: Vec<f32> = step.pressures.iter().flatten().map(|v| *v as f32).collect();
        assert_eq!(array("Cp"), cp);
        let points: Vec<f32> = recording
            .setup
            .nodes_at(&step.motion)
            .iter()
            .flatten()
            .flatten()
            .map(|v| *v as f32)
            .collect();
        assert_eq!(array("points"), points);
    }
}
