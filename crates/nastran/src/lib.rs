//! Nastran bulk data decks and mode files, read.
//!
//! [`Deck::read`] reads a deck as users have it: executive and case control, INCLUDE files, small, large and free field,
//! continuations with and without markers. Every entry ends in one of three ways: read into a type of [`cards`], noted as
//! without effect ([`Deck::notes`]), or refused with file, line, card, field, what was needed and what was got. Nothing is
//! dropped silently. [`modes`] reads normal modes that another program has computed.
//!
//! A deck has no units of its own: whatever it uses is kept.

pub mod bulk;
pub mod cards;
pub mod case_control;
mod deck;
mod entry;
mod error;
mod fields;
mod known;
pub mod modes;
pub mod number;
mod source;

pub use deck::Deck;
pub use error::{DeckError, DeckErrors, FieldError, Location, Note, Severity};
pub use fields::{Components, Dof};
