//! The restart file of a march.

use std::path::Path;

use dip_modal::ModalState;
use serde::{Deserialize, Serialize};

use super::{MarchSettings, Wing};
use crate::couple::Stream;
use crate::error::FlowError;
use crate::restart::{doubles, put_doubles, read_checked, write_checked};
use crate::settings::SteadySettings;

const MAGIC: &[u8; 8] = b"DIPMAR01";

/// What the restart file holds besides the flow.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Kept {
    pub settings: MarchSettings,
    pub stream: Stream,
    pub states: Vec<ModalState>,
    pub not_converged: usize,
    pub iterations: usize,
    pub products: usize,
    pub builds: usize,
    pub work_j: f64,
    /// Header of the coupled state.
    pub state: serde_json::Value,
}

impl Kept {
    /// Writes the file of a march's `settings`, if it has one, with the doubles of the coupled state.
    pub fn write(&self, values: &[f64]) -> Result<(), FlowError> {
        let Some(path) = &self.settings.restart else {
            return Ok(());
        };
        let header = serde_json::to_vec(self).map_err(|e| cannot_write(path, e))?;
        write_checked(path, MAGIC, &header, &|out| put_doubles(out, values))
    }
}

/// A header that cannot be made.
pub(super) fn cannot_write(path: &Path, error: serde_json::Error) -> FlowError {
    FlowError::Io {
        path: path.display().to_string(),
        source: error.into(),
    }
}

/// What the restart file holds with the doubles of the coupled state, if the march is to go on from one that is there.
pub(super) fn read_kept(
    settings: &MarchSettings,
    stream: &Stream,
    wing: &Wing,
) -> Result<Option<(Kept, Vec<f64>)>, FlowError> {
    let Some(path) = settings.restart.as_ref().filter(|p| settings.resume && p.exists()) else {
        return Ok(None);
    };
    let wrong = |what: String| FlowError::Restart {
        path: path.display().to_string(),
        what,
    };
    let (header, body) = read_checked(path, MAGIC)?;
    let kept: Kept = serde_json::from_slice(&header).map_err(|e| wrong(format!("header: {e}")))?;
    let plain = |s: &MarchSettings| MarchSettings {
        // How long to go on and where to keep things may change.
        steps: 0,
        restart: None,
        resume: false,
        checkpoint_steps: 0,
        largest_displacement: 0.0,
        steady: SteadySettings {
            restart: None,
            resume: false,
            checkpoint_steps: 0,
            ..s.steady.clone()
        },
        ..s.clone()
    };
    if plain(&kept.settings) != plain(settings) || kept.stream != *stream {
        return Err(wrong(
            "flow, stream, scheme, start or time step differ from those of the case; start anew or give the old ones"
                .to_owned(),
        ));
    }
    if kept.states.first().is_none_or(|s| s.q.len() != wing.equations.count()) {
        return Err(wrong("it has another number of modes".to_owned()));
    }
    Ok(Some((kept, doubles(&body))))
}
