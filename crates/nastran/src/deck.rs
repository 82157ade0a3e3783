//! A whole deck: control sections and bulk data.

use std::path::Path;

use crate::{
    bulk::Bulk,
    case_control::{self, Control},
    entry,
    error::{DeckErrors, Note},
    source::{self, Line},
};

/// A deck as read, before anything is computed from it.
#[derive(Debug, Clone)]
pub struct Deck {
    /// Solution and subcases.
    pub control: Control,
    /// Bulk data.
    pub bulk: Bulk,
    /// What was ignored, and what the user should look at.
    pub notes: Vec<Note>,
}

impl Deck {
    /// Reads a deck and all that it includes.
    ///
    /// # Errors
    /// Everything that is wrong with it, each with file and line.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, DeckErrors> {
        Self::from_lines(&source::lines_of_file(path.as_ref())?)
    }

    /// Reads a deck from memory; messages call it `name`, and INCLUDE statements are followed relative to `folder`.
    ///
    /// # Errors
    /// As [`Deck::read`].
    pub fn parse(text: &str, name: &str, folder: impl AsRef<Path>) -> Result<Self, DeckErrors> {
        Self::from_lines(&source::lines_of_text(text, name, folder.as_ref())?)
    }

    fn from_lines(lines: &[Line]) -> Result<Self, DeckErrors> {
        let mut notes = Vec::new();
        let (control, bulk) = case_control::split(lines, &mut notes).map_err(|errors| DeckErrors { errors })?;
        let entries = entry::entries(&bulk).map_err(|errors| DeckErrors { errors })?;
        let bulk = Bulk::read(&entries, &mut notes).map_err(|errors| DeckErrors { errors })?;
        Ok(Self { control, bulk, notes })
    }
}
