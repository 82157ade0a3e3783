//! What can be wrong with a deck, and where.

use std::{fmt, sync::Arc};

/// A line of a file of the deck. Lines count from one.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Location {
    /// The file, named as the deck or its INCLUDE statement named it.
    pub file: Arc<str>,
    /// The line, counted from one.
    pub line: usize,
}

impl Location {
    /// A line of a file.
    pub fn new(file: &Arc<str>, line: usize) -> Self {
        Self {
            file: Arc::clone(file),
            line,
        }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.file, self.line)
    }
}

/// A field that does not hold what its card needs.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "{at}: {card}, field {field} ({name}): needed {needed}, got {}{}",
    quoted(.got),
    hinted(.hint)
)]
pub struct FieldError {
    /// The line of the field.
    pub at: Location,
    /// The card's name.
    pub card: String,
    /// Number of the field on its line, from 2 (the first after the name) to 9.
    pub field: usize,
    /// The field's name in the card's description.
    pub name: String,
    /// What the card needs there.
    pub needed: String,
    /// What stands there.
    pub got: String,
    /// What to do; empty if that is plain.
    pub hint: String,
}

/// Everything that stops a deck from being read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DeckError {
    /// A file could not be read at all.
    #[error("{}cannot read {path}: {reason}", prefix(.at.as_ref()))]
    Read {
        /// The INCLUDE statement that asked for it; none for the deck itself.
        at: Option<Location>,
        /// The file that was asked for.
        path: String,
        /// What the system said, and what was tried.
        reason: String,
    },
    /// An INCLUDE statement that cannot be followed.
    #[error("{at}: INCLUDE: {what}")]
    Include {
        /// The statement.
        at: Location,
        /// What is wrong and what to do.
        what: String,
    },
    /// A field does not hold what its card needs.
    #[error("{0}")]
    Field(Box<FieldError>),
    /// A whole card is wrong.
    #[error("{at}: {card}: {what}")]
    Card {
        /// The card's first line.
        at: Location,
        /// The card's name.
        card: String,
        /// What is wrong and what to do.
        what: String,
    },
    /// A card that changes the model but that this program cannot use.
    #[error("{at}: {card} is not supported: {hint}")]
    Unsupported {
        /// The card's first line.
        at: Location,
        /// The card's name.
        card: String,
        /// What to do instead.
        hint: String,
    },
    /// Two cards of a kind with one number.
    #[error("{at}: {card} {id} is defined twice (first at {first}); remove or renumber one of them")]
    Duplicate {
        /// The second card.
        at: Location,
        /// The card's name.
        card: String,
        /// Their number.
        id: i64,
        /// The first card.
        first: Location,
    },
    /// A statement of the executive or case control section is wrong.
    #[error("{at}: {what}")]
    Control {
        /// The statement's line.
        at: Location,
        /// What is wrong and what to do.
        what: String,
    },
}

impl DeckError {
    /// Where the error stands, if it stands on a line of a file.
    pub fn location(&self) -> Option<&Location> {
        match self {
            Self::Read { at, .. } => at.as_ref(),
            Self::Field(field) => Some(&field.at),
            Self::Include { at, .. }
            | Self::Card { at, .. }
            | Self::Unsupported { at, .. }
            | Self::Duplicate { at, .. }
            | Self::Control { at, .. } => Some(at),
        }
    }
}

fn prefix(at: Option<&Location>) -> String {
    at.map(|at| format!("{at}: ")).unwrap_or_default()
}

fn quoted(got: &str) -> String {
    if got.is_empty() {
        "a blank field".to_owned()
    } else {
        format!("\"{got}\"")
    }
}

fn hinted(hint: &str) -> String {
    if hint.is_empty() {
        String::new()
    } else {
        format!("; {hint}")
    }
}

/// All errors of a deck, in the order of the deck, so that a user mends them in one go.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeckErrors {
    /// The errors; never empty.
    pub errors: Vec<DeckError>,
}

impl DeckErrors {
    /// How many errors a message lists before it only counts the rest.
    const LISTED: usize = 20;
}

impl From<DeckError> for DeckErrors {
    fn from(error: DeckError) -> Self {
        Self { errors: vec![error] }
    }
}

impl fmt::Display for DeckErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, error) in self.errors.iter().take(Self::LISTED).enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            write!(f, "{error}")?;
        }
        if self.errors.len() > Self::LISTED {
            write!(f, "\n... and {} more", self.errors.len() - Self::LISTED)?;
        }
        Ok(())
    }
}

impl std::error::Error for DeckErrors {}

/// How much a note should worry its reader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// The card or statement has no effect on a flutter solution.
    Ignored,
    /// The user should look at it.
    Warning,
}

/// Something in the deck that was read but not used, or read differently from what it says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// Where it stands.
    pub at: Location,
    /// The card's or statement's name.
    pub card: String,
    /// How much it matters.
    pub severity: Severity,
    /// What was done with it.
    pub text: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.severity {
            Severity::Ignored => "ignored",
            Severity::Warning => "warning",
        };
        write!(f, "{}: {kind}: {}: {}", self.at, self.card, self.text)
    }
}
