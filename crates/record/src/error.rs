//! What can go wrong with a recording.

use crate::finding::Finding;

/// Errors of recordings. Each says which file, what was needed, what was there, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The system refused.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// Not an MCAP file at all.
    #[error("{path}: not an MCAP file ({got}); a recording of `pmb pitch` or `pmb march` is needed")]
    NotMcap {
        /// The file.
        path: String,
        /// What it begins with.
        got: String,
    },
    /// An MCAP file of somebody else.
    #[error(
        "{path}: an MCAP file with profile `{got}`, not a recording of ours (profile `{needed}`, or a metadata record \
         `dip.file`)"
    )]
    Foreign {
        /// The file.
        path: String,
        /// Profile needed.
        needed: &'static str,
        /// Its profile.
        got: String,
    },
    /// Written in another version of the format.
    #[error(
        "{path}: format {got}, this program reads format {needed}; read it with the version that wrote it ({version})"
    )]
    Format {
        /// The file.
        path: String,
        /// Format needed.
        needed: &'static str,
        /// Format of the file.
        got: String,
        /// Program that wrote it, with its version.
        version: String,
    },
    /// The reference quantities, the motion or the surface are missing or unusable: no number in the file means anything.
    #[error("{path}: {what}; nothing in this file can be used without it, make the recording again")]
    Setup {
        /// The file.
        path: String,
        /// What is missing or wrong.
        what: String,
    },
    /// A channel that every recording has is not there.
    #[error("{path}: channel `{topic}` ({schema}) is missing; every recording needs it, make the recording again")]
    MissingChannel {
        /// The file.
        path: String,
        /// Topic.
        topic: &'static str,
        /// Schema.
        schema: &'static str,
    },
    /// A channel that every recording has carries something else.
    #[error(
        "{path}: channel `{topic}` carries {got}, needed `{schema}` in protobuf (docs/schema.md); make the recording again"
    )]
    WrongChannel {
        /// The file.
        path: String,
        /// Topic.
        topic: &'static str,
        /// Schema needed.
        schema: &'static str,
        /// What it carries.
        got: String,
    },
    /// Not whole.
    #[error("{path}: {}; `dip doctor` says what can be saved", list(.findings))]
    Damaged {
        /// The file.
        path: String,
        /// Everything that is wrong.
        findings: Vec<Finding>,
    },
    /// Something that was to be written does not fit.
    #[error("{path}: cannot record {what}")]
    Input {
        /// The file.
        path: String,
        /// What does not fit, what was needed, what was given.
        what: String,
    },
    /// A recording cannot be gone on with.
    #[error("{path}: cannot go on with this recording: {what}")]
    Resume {
        /// The file.
        path: String,
        /// Why not, and what to do.
        what: String,
    },
    /// The container library refused.
    #[error("{path}: writing failed: {what}")]
    Container {
        /// The file.
        path: String,
        /// What it said.
        what: String,
    },
}

/// The first findings, and how many more there are.
fn list(findings: &[Finding]) -> String {
    const SHOWN: usize = 3;
    let mut text = findings
        .iter()
        .take(SHOWN)
        .map(ToString::to_string)
        .collect::<Vec<_>>()
        .join("; ");
    if findings.len() > SHOWN {
        text.push_str(&format!("; and {} more", findings.len() - SHOWN));
    }
    text
}
