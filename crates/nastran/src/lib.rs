//! Nastran bulk data decks and mode files, read.
