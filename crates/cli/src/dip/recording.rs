//! What the commands on recordings share: reading with words about what is wrong.

use crate::exit::Stop;
use dip_record::{RecordError, Recording, Salvage};
use std::path::Path;

/// Reads what can be read of a recording; what is wrong goes to stderr as warnings.
///
/// # Errors
/// A file of which nothing can be used.
pub fn read(path: &Path) -> Result<Salvage, Stop> {
    let salvage = Recording::read_salvage(path).map_err(|e| unusable(&e))?;
    for finding in &salvage.findings {
        tracing::warn!("{}: {finding}", path.display());
    }
    if let ([_, ..], Some([first, last])) = (&salvage.findings[..], bounds(&salvage.recording)) {
        tracing::warn!("steps {first} to {last} are taken; `dip doctor` says more");
    }
    Ok(salvage)
}

/// Numbers of the first and the last step.
pub fn bounds(recording: &Recording) -> Option<[u32; 2]> {
    Some([recording.steps.first()?.number, recording.steps.last()?.number])
}

/// An error of a recording as the end of a command.
pub fn unusable(error: &RecordError) -> Stop {
    let help = match error {
        RecordError::Io { .. } => "check the name of the file and its rights",
        _ => "`dip doctor FILE` says what can be saved",
    };
    Stop::input(error.to_string(), help)
}

/// An error on writing.
pub fn unwritable(error: &RecordError) -> Stop {
    Stop::failed(
        error.to_string(),
        "check the disk's space and the folder's rights, or give another place",
    )
}
