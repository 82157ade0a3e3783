//! The case of a correction: what `[correct]` asks for, and the recordings that belong to it.

use crate::exit::Stop;
use crate::frequency::FlutterCase;
use crate::stamp::Fingerprint;
use dip_case::Document;
use dip_case::file::{CorrectMethod, CorrectTable, Sampling};
use dip_correct::sample::Rule;
use dip_correct::{Method, Settings};
use dip_record::{RecordError, Recording};
use std::path::{Path, PathBuf};

/// A flutter case with recordings.
#[derive(Debug)]
pub struct CorrectionCase {
    /// The case.
    pub flutter: FlutterCase,
    /// `[correct]`.
    pub table: CorrectTable,
    /// Recordings in the order given: path and content.
    pub recordings: Vec<(PathBuf, Recording)>,
    /// Everything that the results depend on.
    pub fingerprint: Fingerprint,
}

/// The crate's method of a case's.
pub fn method(method: CorrectMethod) -> Method {
    match method {
        CorrectMethod::Downwash => Method::Downwash,
        CorrectMethod::DownwashSteady => Method::DownwashSteady,
        CorrectMethod::PressureRatio => Method::PressureRatio,
        CorrectMethod::Force => Method::Force,
        CorrectMethod::ForceSteady => Method::ForceSteady,
        CorrectMethod::Additive => Method::Additive,
        CorrectMethod::Mode => Method::Mode,
        CorrectMethod::Full => Method::Full,
        CorrectMethod::DauGarner => Method::DauGarner,
    }
}

impl CorrectionCase {
    /// Reads a case and its recordings: those of `from`, and those that `[recordings]` names.
    ///
    /// # Errors
    /// What is wrong in the files, or no recording at all.
    pub fn read(document: Document, from: &[PathBuf]) -> Result<Self, Stop> {
        let flutter = FlutterCase::read(document)?;
        let table = flutter.file.correct.clone().unwrap_or_default();
        check(&flutter.document, &table)?;
        let mut paths: Vec<PathBuf> = from.to_vec();
        if let Some(recordings) = &flutter.file.recordings {
            paths.extend(recordings.files.iter().map(|p| flutter.document.path(p)));
        }
        if paths.is_empty() {
            return Err(Stop::input(
                "no recording to correct by",
                "give --from pitch.mcap (repeatable), or [recordings] files = [...] in the case",
            ));
        }
        let mut fingerprint = flutter.fingerprint.clone();
        let mut recordings = Vec::with_capacity(paths.len());
        for path in paths {
            let recording = Recording::read(&path).map_err(|e| unusable(&path, &e))?;
            fingerprint.file(path.clone());
            recordings.push((path, recording));
        }
        Ok(Self {
            flutter,
            table,
            recordings,
            fingerprint,
        })
    }

    /// How wall pressures come to the boxes.
    pub fn rule(&self) -> Rule {
        match self.table.sampling {
            Sampling::Conservative => Rule::Conservative,
            Sampling::Average => Rule::Average,
            Sampling::Point => Rule::Point(self.table.point),
        }
    }

    /// Limits of the weights.
    pub fn settings(&self) -> Settings {
        Settings {
            limits: dip_correct::weight::Limits {
                bound: self.table.bound,
                least: self.table.least,
            },
            blend: self.table.blend,
        }
    }

    /// The recordings of each Mach number of the case.
    ///
    /// # Errors
    /// A recording of another Mach number.
    pub fn by_mach(&self) -> Result<Vec<(usize, Vec<usize>)>, Stop> {
        let machs = &self.flutter.file.lattice.mach;
        let mut groups: Vec<(usize, Vec<usize>)> = Vec::new();
        for (i, (path, recording)) in self.recordings.iter().enumerate() {
            let mach = recording.setup.references.mach;
            let Some(at) = machs.iter().position(|m| (m - mach).abs() <= 1e-3) else {
                return Err(Stop::input(
                    format!(
                        "{}: Mach number of the recording is {mach}, of the lattice {machs:?}",
                        path.display()
                    ),
                    "add it to lattice.mach (with its density), or give another recording",
                ));
            };
            match groups.iter_mut().find(|(m, _)| *m == at) {
                Some((_, list)) => list.push(i),
                None => groups.push((at, vec![i])),
            }
        }
        groups.sort_by_key(|(m, _)| *m);
        Ok(groups)
    }
}

/// Last part of a path, for messages.
pub fn name(path: &Path) -> String {
    path.file_name()
        .map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned())
}

fn unusable(path: &Path, error: &RecordError) -> Stop {
    Stop::input(
        error.to_string(),
        format!(
            "`dip doctor {}` says what is wrong and what can be saved",
            path.display()
        ),
    )
}

/// Numbers of `[correct]` that no type can check.
fn check(document: &Document, table: &CorrectTable) -> Result<(), Stop> {
    let wrong = |key: &str, message: String, help: &str| -> Result<(), Stop> {
        Err(document.error(&format!("correct.{key}"), message, help).into())
    };
    if table.methods.is_empty() {
        return wrong("methods", "no method".into(), "give one or more, as in [\"downwash\"]");
    }
    for (i, m) in table.methods.iter().enumerate() {
        if table.methods[..i].contains(m) {
            return wrong(
                &format!("methods.{i}"),
                "this method stands twice".into(),
                "leave one of them out",
            );
        }
    }
    if !(0.0..=1.0).contains(&table.point) {
        return wrong(
            "point",
            format!("{}: needed 0 to 1", table.point),
            "0.75 is the thesis's point",
        );
    }
    if table.harmonics == 0 || table.harmonics > 20 {
        return wrong(
            "harmonics",
            format!("{}: needed 1 to 20", table.harmonics),
            "3 shows what is not linear",
        );
    }
    if !(table.bound.is_finite() && table.bound > 0.0) {
        return wrong("bound", format!("{}: needed above 0", table.bound), "10 is the default");
    }
    if !(0.0..1.0).contains(&table.least) {
        return wrong(
            "least",
            format!("{}: needed 0 or more and below 1", table.least),
            "0.02 is the default",
        );
    }
    if !(table.blend.is_finite() && table.blend > 1.0) {
        return wrong("blend", format!("{}: needed above 1", table.blend), "2 is the default");
    }
    Ok(())
}
