//! Whatever stands in a file: an answer or an error, never a panic, never a hang.

mod synthetic;

use dip_record::{Recording, Writer, WriterOptions};
use proptest::prelude::*;

/// A good file.
fn bytes() -> Vec<u8> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.mcap");
    let setup = synthetic::setup([2, 1]);
    let mut writer = Writer::create(&path, setup.clone(), WriterOptions::default()).unwrap();
    for n in 0..12 {
        writer.step(&synthetic::step(&setup, n)).unwrap();
    }
    writer.finish("done").unwrap();
    std::fs::read(path).unwrap()
}

/// A change of a file.
#[derive(Clone, Debug)]
enum Change {
    Set(usize, u8),
    Cut(usize),
    Insert(usize, Vec<u8>),
    Remove(usize, usize),
    Double(usize, usize),
}

fn change() -> impl Strategy<Value = Change> {
    let at = 0_usize..20_000;
    prop_oneof![
        4 => (at.clone(), any::<u8>()).prop_map(|(a, b)| Change::Set(a, b)),
        1 => at.clone().prop_map(Change::Cut),
        1 => (at.clone(), proptest::collection::vec(any::<u8>(), 1..40)).prop_map(|(a, b)| Change::Insert(a, b)),
        1 => (at.clone(), 1_usize..3000).prop_map(|(a, n)| Change::Remove(a, n)),
        1 => (at, 1_usize..3000).prop_map(|(a, n)| Change::Double(a, n)),
    ]
}

fn changed(mut bytes: Vec<u8>, changes: &[Change]) -> Vec<u8> {
    for change in changes {
        let length = bytes.len().max(1);
        match change {
            Change::Set(at, value) => {
                if let Some(byte) = bytes.get_mut(at % length) {
                    *byte = *value;
                }
            }
            Change::Cut(at) => bytes.truncate(at % length),
            Change::Insert(at, new) => {
                let at = (at % length).min(bytes.len());
                bytes.splice(at..at, new.iter().copied());
            }
            Change::Remove(at, count) => {
                let at = (at % length).min(bytes.len());
                let end = (at + count).min(bytes.len());
                bytes.drain(at..end);
            }
            Change::Double(at, count) => {
                let at = (at % length).min(bytes.len());
                let end = (at + count).min(bytes.len());
                let copy = bytes[at..end].to_vec();
                bytes.splice(at..at, copy);
            }
        }
    }
    bytes
}

proptest! {
    // `PROPTEST_CASES=1000000` looks for hours.
    #![proptest_config(ProptestConfig::with_cases(
        std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(2000)
    ))]

    #[test]
    fn changed_files_give_an_answer(changes in proptest::collection::vec(change(), 1..5)) {
        static GOOD: std::sync::OnceLock<Vec<u8>> = std::sync::OnceLock::new();
        let good = GOOD.get_or_init(bytes);
        let whole = Recording::from_bytes(good, "good").unwrap().recording;
        let bytes = changed(good.clone(), &changes);
        if let Ok(salvage) = Recording::from_bytes(&bytes, "changed") {
            // What is given is as it was written.
            for step in &salvage.recording.steps {
                prop_assert_eq!(step, &whole.steps[step.number as usize]);
            }
            prop_assert!(bytes == *good || !salvage.findings.is_empty());
        }
    }

    #[test]
    fn noise_gives_an_error(noise in proptest::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(Recording::from_bytes(&noise, "noise").is_err());
        let mut bytes = mcap::MAGIC.to_vec();
        bytes.extend_from_slice(&noise);
        prop_assert!(Recording::from_bytes(&bytes, "noise").is_err());
    }
}
