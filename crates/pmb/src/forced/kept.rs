//! The restart file of a run with prescribed motion.

use serde::{Deserialize, Serialize};

use super::{ForcedSettings, Run};
use crate::error::FlowError;
use crate::motion::{Motion, Shape};
use crate::moving::Nodes;
use crate::restart::{checksum, doubles, put_doubles, read_checked, write_checked};
use crate::steady::StopReason;

const MAGIC: &[u8; 8] = b"DIPUNS01";

/// What the restart file holds besides the flow.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Kept {
    pub settings: ForcedSettings,
    pub limiter_constant: f64,
    pub coordinates: Vec<String>,
    /// Checksum of the grid at rest.
    pub grid: u64,
    pub steady_stop: Option<StopReason>,
    pub history: Vec<[f64; 3]>,
    pub not_converged: usize,
    pub iterations: usize,
    pub products: usize,
    pub builds: usize,
    pub state: serde_json::Value,
}

/// Names the restart file in an error about it.
pub(super) fn named(error: FlowError, settings: &ForcedSettings) -> FlowError {
    match (error, &settings.restart) {
        (FlowError::Restart { what, .. }, Some(path)) => FlowError::Restart {
            path: path.display().to_string(),
            what,
        },
        (error, _) => error,
    }
}

/// The restart file and the state in it, where the run is to go on from one.
///
/// # Errors
/// [`FlowError::Restart`] if it is of another run.
pub(super) fn read(settings: &ForcedSettings, motion: &Motion) -> Result<Option<(Kept, Vec<f64>)>, FlowError> {
    let Some(path) = settings.restart.as_ref().filter(|p| settings.resume && p.exists()) else {
        return Ok(None);
    };
    let wrong = |what: String| FlowError::Restart {
        path: path.display().to_string(),
        what,
    };
    let (header, body) = read_checked(path, MAGIC)?;
    let kept: Kept = serde_json::from_slice(&header).map_err(|e| wrong(format!("header: {e}")))?;
    if !kept.settings.steady.is_same_flow(&settings.steady) || kept.settings.steps_per_cycle != settings.steps_per_cycle
    {
        return Err(wrong(
            "flow, reference, scheme or steps per cycle differ from those of the case".to_owned(),
        ));
    }
    if kept.coordinates != describe(motion) {
        return Err(wrong(format!(
            "the motion was {:?}, this case has {:?}",
            kept.coordinates,
            describe(motion)
        )));
    }
    if kept.grid != checksum_of(&motion.rest) {
        return Err(wrong("it is of another grid".to_owned()));
    }
    Ok(Some((kept, doubles(&body))))
}

/// Name, shape, and law of every coordinate.
fn describe(motion: &Motion) -> Vec<String> {
    motion
        .coordinates
        .iter()
        .map(|c| {
            let shape = match &c.shape {
                Shape::Field(nodes) => format!("field {:016x}", checksum_of(nodes)),
                rigid => format!("{rigid:?}"),
            };
            format!("{}: {shape}, {:?}", c.name, c.law)
        })
        .collect()
}

/// Tells one set of nodes from another.
fn checksum_of(nodes: &Nodes) -> u64 {
    checksum(nodes.blocks.iter().flatten().flatten().flat_map(|v| v.to_le_bytes()))
}

impl Run<'_> {
    /// Writes the restart file.
    ///
    /// # Errors
    /// What the file system says.
    pub(super) fn write(&self) -> Result<(), FlowError> {
        let Some(path) = &self.settings.restart else {
            return Ok(());
        };
        let json = |e: serde_json::Error| FlowError::Io {
            path: path.display().to_string(),
            source: e.into(),
        };
        let (state, values) = self.flow.save().map_err(json)?;
        let kept = Kept {
            settings: self.settings.clone(),
            limiter_constant: self.limiter_constant,
            coordinates: describe(self.motion),
            grid: checksum_of(&self.motion.rest),
            steady_stop: self.steady_stop.clone(),
            history: self.history.clone(),
            not_converged: self.not_converged,
            iterations: self.iterations,
            products: self.products,
            builds: self.builds,
            state,
        };
        let header = serde_json::to_vec(&kept).map_err(json)?;
        write_checked(path, MAGIC, &header, &|out| put_doubles(out, &values))
    }
}
