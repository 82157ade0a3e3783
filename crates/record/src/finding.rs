//! What a reader found wrong with a file, in words.

use std::fmt;

use serde::Serialize;

/// One thing that is not as it should be.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Its kind.
    pub kind: FindingKind,
    /// Where and what, in words.
    pub what: String,
}

/// Kinds of findings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FindingKind {
    /// The file stops before its end: the run was killed, or still goes on.
    Unfinished,
    /// A checksum is wrong or a record cannot be read.
    Corrupt,
    /// A step lacks messages.
    Incomplete,
    /// Steps are missing between others.
    Gap,
    /// A value is not a finite number.
    NonFinite,
    /// Instants contradict each other.
    Timing,
    /// The recorded motion is not the one that the file says it is.
    Motion,
    /// Messages stand in the file twice and are alike.
    Twice,
    /// A channel that may be there carries something else.
    Foreign,
}

impl FindingKind {
    /// True if steps or bytes are lost; false if the file is whole and its content is in doubt.
    #[must_use]
    pub fn is_damage(self) -> bool {
        !matches!(self, Self::Motion | Self::Twice | Self::Foreign)
    }

    /// Name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Unfinished => "unfinished",
            Self::Corrupt => "corrupt",
            Self::Incomplete => "incomplete",
            Self::Gap => "gap",
            Self::NonFinite => "non-finite",
            Self::Timing => "timing",
            Self::Motion => "motion",
            Self::Twice => "twice",
            Self::Foreign => "foreign",
        }
    }
}

impl Finding {
    pub(crate) fn new(kind: FindingKind, what: impl Into<String>) -> Self {
        Self {
            kind,
            what: what.into(),
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.kind.name(), self.what)
    }
}
