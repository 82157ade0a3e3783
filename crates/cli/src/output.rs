//! The folder that a command's results go to: never over an older finished run, never half a file.

use crate::exit::Stop;
use crate::stamp::Stamp;
use serde::Serialize;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The file that marks a finished run.
pub const SUMMARY: &str = "summary.json";

/// A folder for results.
#[derive(Debug, Clone)]
pub struct RunFolder {
    path: PathBuf,
}

impl RunFolder {
    /// Opens a folder for a run. A finished run of the same inputs may be made again; another one only with `force`.
    ///
    /// # Errors
    /// An older finished run of other inputs, or a folder that can't be made.
    pub fn open(path: &Path, stamp: &Stamp, force: bool) -> Result<Self, Stop> {
        let summary = path.join(SUMMARY);
        if !force && summary.exists() {
            let text = fs::read_to_string(&summary).unwrap_or_default();
            let older: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
            if older["stamp"]["fingerprint"] != stamp.fingerprint.as_str() {
                return Err(Stop::input(
                    format!(
                        "{} holds a finished run of other inputs (or of another version)",
                        path.display()
                    ),
                    "give another folder with --out DIR, or write over it with --force",
                ));
            }
        }
        Self::plain(path)
    }

    /// Opens a folder for files that are not those of a run; what is in it is left to the caller.
    ///
    /// # Errors
    /// A folder that can't be made.
    pub fn plain(path: &Path) -> Result<Self, Stop> {
        fs::create_dir_all(path).map_err(|e| {
            Stop::failed(
                format!("{}: cannot make the folder: {e}", path.display()),
                "give another folder with --out DIR",
            )
        })?;
        Ok(Self {
            path: path.to_path_buf(),
        })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a file whole or not at all: to a temporary name, synced, then renamed.
    ///
    /// # Errors
    /// What the file system says, such as a full disk; an older file of that name is kept then.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<PathBuf, Stop> {
        let path = self.path.join(name);
        let temporary = self.path.join(format!(".{name}.tmp"));
        let write = || -> std::io::Result<()> {
            if let Some(parent) = path.parent() {
                fs::create_dir_all(parent)?;
            }
            let mut file = fs::File::create(&temporary)?;
            file.write_all(content)?;
            file.sync_all()?;
            fs::rename(&temporary, &path)
        };
        write().map_err(|e| {
            let _ = fs::remove_file(&temporary);
            Stop::failed(
                format!("{}: cannot write: {e}", path.display()),
                "check the disk's space and the folder's rights",
            )
        })?;
        Ok(path)
    }

    /// Writes a value as JSON.
    ///
    /// # Errors
    /// As [`RunFolder::write`].
    pub fn write_json<T: Serialize>(&self, name: &str, value: &T) -> Result<PathBuf, Stop> {
        self.write(name, json(value)?.as_bytes())
    }
}

/// A value as indented JSON with a line end.
///
/// # Errors
/// A value that JSON can't hold; a defect of the program.
pub fn json<T: Serialize>(value: &T) -> Result<String, Stop> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Stop::failed(format!("cannot write JSON: {e}"), "please report this as a defect"))?;
    Ok(text + "\n")
}

/// Prints results on stdout; a reader that has gone away (`| head`) is no error.
pub fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    let _ = out.write_all(text.as_bytes());
    let _ = out.flush();
}
