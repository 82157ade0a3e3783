//! What can go wrong with a recording.

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
    /// Something about the content does not fit.
    #[error("{path}: {what}")]
    Content {
        /// The file.
        path: String,
        /// What is wrong, what was needed, and what to do.
        what: String,
    },
}
