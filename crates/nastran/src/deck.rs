//! A whole deck: control sections and bulk data.

use std::path::Path;

use crate::{
    bulk::Bulk,
    case_control::{self, Control},
    entry,
    error::{DeckErrors, Note, Severity},
    known,
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
        Self::from_lines(&source::lines_of_file(path.as_ref())?, false)
    }

    /// Reads a deck whose modes come from a file ([`crate::modes`]): elements that are not supported are noted, not refused.
    ///
    /// # Errors
    /// As [`Deck::read`].
    pub fn read_without_structure(path: impl AsRef<Path>) -> Result<Self, DeckErrors> {
        Self::from_lines(&source::lines_of_file(path.as_ref())?, true)
    }

    /// Reads a deck from memory; messages call it `name`, and INCLUDE statements are followed relative to `folder`.
    ///
    /// # Errors
    /// As [`Deck::read`].
    pub fn parse(text: &str, name: &str, folder: impl AsRef<Path>) -> Result<Self, DeckErrors> {
        Self::from_lines(&source::lines_of_text(text, name, folder.as_ref())?, false)
    }

    fn from_lines(lines: &[Line], structure_elsewhere: bool) -> Result<Self, DeckErrors> {
        let mut notes = Vec::new();
        let (control, bulk) = case_control::split(lines, &mut notes).map_err(|errors| DeckErrors { errors })?;
        let entries = entry::entries(&bulk).map_err(|errors| DeckErrors { errors })?;
        let mut bulk = Bulk::read(&entries, structure_elsewhere, &mut notes).map_err(|errors| DeckErrors { errors })?;
        // The case control section's word goes over the bulk data's.
        for parameter in &control.parameters {
            if !known::is_used_parameter(&parameter.name) {
                notes.push(Note {
                    at: parameter.at.clone(),
                    card: "PARAM".to_owned(),
                    severity: Severity::Ignored,
                    text: format!("{} has no effect on modes or flutter", parameter.name),
                });
            }
            bulk.parameters.insert(parameter.name.clone(), parameter.clone());
        }
        Ok(Self { control, bulk, notes })
    }
}
