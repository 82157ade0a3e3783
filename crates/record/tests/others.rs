//! Recordings that other programs wrote or rewrote: what the format allows is read, what is missing or strange is said.
//!
//! `others/*.mcap` were made by `others/make.py` with the Python package `mcap` from the recording of [`base`].

mod synthetic;

use dip_record::{FindingKind, RecordError, Recording, Salvage, Step, Writer, WriterOptions};
use std::path::{Path, PathBuf};

/// Steps 0 to 22 in chunks of five.
const STEPS: u32 = 23;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/others")
}

fn salvage(name: &str) -> Result<Salvage, RecordError> {
    Recording::read_salvage(&folder().join(name))
}

/// What the solver gave, in the single precision of a recording.
fn exact(number: u32) -> Step {
    let mut step = synthetic::step(&synthetic::setup([2, 1]), number);
    for cp in step.pressures.iter_mut().flatten() {
        *cp = f64::from(*cp as f32);
    }
    step
}

#[track_caller]
fn assert_steps(name: &str, salvage: &Salvage, first: u32, last: u32) {
    assert_eq!(salvage.recording.setup, synthetic::setup([2, 1]), "{name}");
    assert_eq!(salvage.runs.first(), Some(&[first, last]), "{name}");
    for (step, number) in salvage.recording.steps.iter().zip(first..=last) {
        assert_eq!(*step, exact(number), "{name}");
    }
}

fn kinds(salvage: &Salvage) -> Vec<FindingKind> {
    salvage.findings.iter().map(|f| f.kind).collect()
}

/// Writes the recording that `make.py` starts from: `DIP_BASE=/tmp/base.mcap cargo test -p dip-record --test others --
/// --ignored`.
#[test]
#[ignore = "writes a file for tests/others/make.py"]
fn base() {
    let Some(path) = std::env::var_os("DIP_BASE") else {
        return;
    };
    let setup = synthetic::setup([2, 1]);
    let mut writer = Writer::create(Path::new(&path), setup.clone(), WriterOptions::default()).unwrap();
    for n in 0..STEPS {
        writer.step(&synthetic::step(&setup, n)).unwrap();
    }
    writer.finish("all steps").unwrap();
}

#[test]
fn what_the_format_allows_is_read_in_full() {
    for name in [
        // Chunks of other sizes, packed by lz4, by zstd, not at all.
        "lz4.mcap",
        "one_chunk.mcap",
        "not_packed.mcap",
        // Messages outside of chunks.
        "no_chunks.mcap",
        // Neither index nor statistics nor checksums.
        "no_summary.mcap",
        "no_checksums.mcap",
        // Steps from the last to the first and before the surface, no sequence numbers, no profile, no checksum of the metadata, log times cut off
        // to whole nanoseconds.
        "backwards.mcap",
        // Channels and metadata of somebody else beside ours, and an attachment.
        "more_channels.mcap",
    ] {
        let salvage = salvage(name).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(salvage.findings, [], "{name}");
        assert_steps(name, &salvage, 0, STEPS - 1);
        assert_eq!(salvage.recording.end.as_deref(), Some("all steps"), "{name}");
        Recording::read(&folder().join(name)).unwrap();
    }
}

#[test]
fn messages_that_stand_there_twice_are_taken_once() {
    let twice = salvage("twice.mcap").unwrap();
    assert_eq!(kinds(&twice), [FindingKind::Twice]);
    assert!(twice.findings[0].what.contains("step 3"), "{}", twice.findings[0]);
    assert_steps("twice.mcap", &twice, 0, STEPS - 1);
    // Nothing is lost.
    Recording::read(&folder().join("twice.mcap")).unwrap();
}

#[test]
fn messages_that_contradict_each_other_cost_their_step() {
    let salvage = salvage("contradiction.mcap").unwrap();
    assert_eq!(kinds(&salvage), [FindingKind::Incomplete, FindingKind::Gap]);
    assert!(salvage.findings[0].what.contains("step 7"), "{}", salvage.findings[0]);
    assert_eq!(salvage.runs, [[0, 6], [8, STEPS - 1]]);
}

#[test]
fn a_record_without_its_last_steps_is_read_up_to_there() {
    let short = salvage("short.mcap").unwrap();
    assert_eq!(short.findings, []);
    assert_steps("short.mcap", &short, 0, 15);
}

#[test]
fn a_channel_with_another_content_is_named() {
    let error = salvage("json_loads.mcap").unwrap_err();
    assert!(
        matches!(&error, RecordError::WrongChannel { topic, .. } if *topic == "/loads"),
        "{error}"
    );
    let text = error.to_string();
    assert!(text.contains("json") && text.contains("dip.Loads"), "{text}");

    // One that no recording needs is left out.
    let salvage = salvage("json_modal.mcap").unwrap();
    assert_eq!(kinds(&salvage), [FindingKind::Foreign]);
    assert!(salvage.findings[0].what.contains("/modal"), "{}", salvage.findings[0]);
    for (n, step) in salvage.recording.steps.iter().enumerate() {
        let mut without = exact(n as u32);
        without.modal = None;
        assert_eq!(*step, without);
    }
}

/// Log times are instants of the run; a clock's time there is of no use to anybody.
#[test]
fn a_log_by_the_clock_is_named() {
    let salvage = salvage("by_the_clock.mcap").unwrap();
    assert!(salvage.recording.steps.is_empty());
    assert!(kinds(&salvage).contains(&FindingKind::Timing));
}

/// Cut anywhere, packed by lz4 or outside of chunks: an answer, never more than was there.
#[test]
fn other_files_that_were_cut_are_read_up_to_the_cut() {
    for name in ["lz4.mcap", "no_chunks.mcap"] {
        let bytes = std::fs::read(folder().join(name)).unwrap();
        let mut most = 0;
        for cut in (0..bytes.len()).step_by(7) {
            if let Ok(salvage) = Recording::from_bytes(&bytes[..cut], name) {
                assert!(
                    salvage.findings.iter().any(|f| f.kind.is_damage()),
                    "{name} cut at {cut}"
                );
                for step in &salvage.recording.steps {
                    assert_eq!(*step, exact(step.number), "{name} cut at {cut}");
                }
                most = most.max(salvage.recording.steps.len());
            }
        }
        assert!(most >= 20, "{name}: at most {most} steps");
    }
}
