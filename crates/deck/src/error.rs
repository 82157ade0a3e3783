//! Why a deck that was read cannot be solved.

use dip_dlm::{aic::AicError, lattice::LatticeError};
use dip_flutter::FlutterError;
use dip_modal::{EigenError, ModelError};
use dip_nastran::{DeckErrors, Location};

/// What stops a deck between reading and the flutter summary.
#[derive(Debug, thiserror::Error)]
pub enum SolveError {
    /// The deck could not be read.
    #[error(transparent)]
    Deck(#[from] DeckErrors),
    /// A card names another that does not exist.
    #[error("{at}: {card} needs {kind} {id}, which is not in the deck")]
    Reference {
        /// The card's first line.
        at: Location,
        /// The card and its number.
        card: String,
        /// The kind of card that is missing.
        kind: &'static str,
        /// Its number.
        id: u32,
    },
    /// A card that is right by itself but not in this deck.
    #[error("{at}: {card}: {what}")]
    Card {
        /// The card's first line.
        at: Location,
        /// The card and its number.
        card: String,
        /// What is wrong and what to do.
        what: String,
    },
    /// Something that the deck does not say at all.
    #[error("the deck {what}")]
    Missing {
        /// What is missing and what to do.
        what: String,
    },
    /// The finite element model.
    #[error("structure: {0}")]
    Model(#[from] ModelError),
    /// The normal modes.
    #[error("modes: {0}")]
    Eigen(#[from] EigenError),
    /// The lattice.
    #[error("lattice: {0}")]
    Lattice(#[from] LatticeError),
    /// The aerodynamics.
    #[error("aerodynamics: {0}")]
    Aerodynamics(#[from] AicError),
    /// The flutter solution.
    #[error("flutter: {0}")]
    Flutter(#[from] FlutterError),
}

/// The result of a step of the solution.
pub type Result<T> = std::result::Result<T, SolveError>;

/// The error of a card that names a missing one.
pub(crate) fn missing(at: &Location, card: String, kind: &'static str, id: u32) -> SolveError {
    SolveError::Reference {
        at: at.clone(),
        card,
        kind,
        id,
    }
}

/// The error of a card that does not fit.
pub(crate) fn misfit(at: &Location, card: impl Into<String>, what: impl Into<String>) -> SolveError {
    SolveError::Card {
        at: at.clone(),
        card: card.into(),
        what: what.into(),
    }
}
