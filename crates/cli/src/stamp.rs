//! What made a result: version, commit, and a fingerprint of everything that went in.

use dip_case::Document;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::PathBuf;

/// Identity of a result. Two results with the same fingerprint come from the same inputs and the same program version.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    /// Version of the program.
    pub version: String,
    /// Commit it was built from.
    pub commit: String,
    /// SHA-256 over version and inputs, hexadecimal.
    pub fingerprint: String,
    /// Files that went in.
    pub inputs: Vec<PathBuf>,
}

/// Collects inputs for a [`Stamp`].
#[derive(Debug, Clone)]
pub struct Fingerprint {
    hash: Sha256,
    inputs: Vec<PathBuf>,
}

impl Fingerprint {
    /// Starts with the program's version.
    pub fn new() -> Self {
        let mut hash = Sha256::new();
        hash.update(env!("CARGO_PKG_VERSION"));
        Self {
            hash,
            inputs: Vec::new(),
        }
    }

    /// Adds a case file with its overrides.
    pub fn document(&mut self, document: &Document) -> &mut Self {
        self.text(document.text());
        self.inputs.push(document.file().to_path_buf());
        self
    }

    /// Adds a file's content; a file that can't be read counts as empty (its reader says what is wrong).
    pub fn file(&mut self, path: PathBuf) -> &mut Self {
        self.bytes(&std::fs::read(&path).unwrap_or_default());
        self.inputs.push(path);
        self
    }

    /// Adds a value.
    pub fn text(&mut self, text: &str) -> &mut Self {
        self.bytes(text.as_bytes());
        self
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.hash.update((bytes.len() as u64).to_le_bytes());
        self.hash.update(bytes);
    }

    /// The stamp of all that was added.
    pub fn stamp(&self) -> Stamp {
        let fingerprint = self
            .hash
            .clone()
            .finalize()
            .iter()
            .map(|b| format!("{b:02x}"))
            .collect();
        Stamp {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: env!("DIP_COMMIT").to_owned(),
            fingerprint,
            inputs: self.inputs.clone(),
        }
    }
}
