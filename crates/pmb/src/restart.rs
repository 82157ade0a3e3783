//! Restart files: all that a steady run needs to go on as if it had never stopped.
//!
//! Layout: eight bytes of magic with the version, the length of a JSON header (u64, little-endian), the header, the
//! unknowns (f64, little-endian), and a checksum (FNV-1a, 64 bits) of everything before it. A file is written under
//! another name, forced to the disk, and renamed, so that the last good one is there whatever happens.

use std::fs::{self, File};
use std::io::{BufWriter, Read, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::FlowError;
use crate::observer::Progress;
use crate::settings::SteadySettings;

const MAGIC: &[u8; 8] = b"DIPPMB01";

/// A run at the end of a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Settings of the run; a resumed run must have the same flow and scheme.
    pub settings: SteadySettings,
    /// Cells of every block of the finest level.
    pub cells: Vec<[usize; 3]>,
    /// Level of the unknowns: 0 is the finest.
    pub level: usize,
    /// Steps on all levels.
    pub step: usize,
    /// Steps on this level.
    pub level_step: usize,
    /// Constant of the limiter.
    pub limiter_constant: f64,
    /// Most orders reached on this level so far.
    pub best: Option<f64>,
    /// Steps since then.
    pub since_best: usize,
    /// CFL number of the next step.
    pub cfl: f64,
    /// CFL number above which the linear systems were out of reach.
    pub ceiling: f64,
    /// Linear tolerance's memory: residual norm before the last step.
    pub last_norm: f64,
    /// What was reported so far.
    pub history: Vec<Progress>,
    /// Primitive variables `[cell][variable]` of that level.
    #[serde(skip)]
    pub unknowns: Vec<f64>,
}

struct Checked<W> {
    inner: W,
    sum: u64,
}

fn fnv(sum: u64, bytes: impl IntoIterator<Item = u8>) -> u64 {
    let step = |sum: u64, b: u8| (sum ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3);
    bytes.into_iter().fold(sum, step)
}

const FNV_START: u64 = 0xcbf2_9ce4_8422_2325;

/// The files' checksum of anything else.
pub(crate) fn checksum(bytes: impl IntoIterator<Item = u8>) -> u64 {
    fnv(FNV_START, bytes)
}

impl<W: Write> Write for Checked<W> {
    fn write(&mut self, buf: &[u8]) -> std::io::Result<usize> {
        let n = self.inner.write(buf)?;
        self.sum = fnv(self.sum, buf[..n].iter().copied());
        Ok(n)
    }
    fn flush(&mut self) -> std::io::Result<()> {
        self.inner.flush()
    }
}

/// Writes a checked file: magic, header, body, checksum. The old one, if any, is replaced only once the new one is safe.
///
/// # Errors
/// [`FlowError::Io`]: the old file is then untouched.
pub(crate) fn write_checked(
    path: &Path,
    magic: &[u8; 8],
    header: &[u8],
    body: &dyn Fn(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), FlowError> {
    let io = |source| FlowError::Io {
        path: path.display().to_string(),
        source,
    };
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let part = path.with_file_name(name);
    let result = write_part(&part, magic, header, body).and_then(|()| fs::rename(&part, path));
    if result.is_err() {
        // Half a file is of no use to anybody; failing to remove it changes nothing.
        drop(fs::remove_file(&part));
    }
    result.map_err(io)?;
    // The rename itself must reach the disk; directories can be synced on Unix only.
    #[cfg(unix)]
    {
        let folder = path
            .parent()
            .filter(|p| !p.as_os_str().is_empty())
            .unwrap_or(Path::new("."));
        File::open(folder).and_then(|f| f.sync_all()).map_err(io)?;
    }
    Ok(())
}

fn write_part(
    part: &Path,
    magic: &[u8; 8],
    header: &[u8],
    body: &dyn Fn(&mut dyn Write) -> std::io::Result<()>,
) -> std::io::Result<()> {
    let mut out = Checked {
        inner: BufWriter::new(File::create(part)?),
        sum: FNV_START,
    };
    out.write_all(magic)?;
    out.write_all(&(header.len() as u64).to_le_bytes())?;
    out.write_all(header)?;
    body(&mut out)?;
    let sum = out.sum;
    out.write_all(&sum.to_le_bytes())?;
    out.flush()?;
    out.inner
        .into_inner()
        .map_err(std::io::IntoInnerError::into_error)?
        .sync_all()
}

/// Reads a file of [`write_checked`]: header and body.
///
/// # Errors
/// [`FlowError::Io`] or [`FlowError::Restart`].
pub(crate) fn read_checked(path: &Path, magic: &[u8; 8]) -> Result<(Vec<u8>, Vec<u8>), FlowError> {
    let name = path.display().to_string();
    let wrong = |what: &str| FlowError::Restart {
        path: name.clone(),
        what: what.to_owned(),
    };
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|mut f| f.read_to_end(&mut bytes))
        .map_err(|source| FlowError::Io {
            path: name.clone(),
            source,
        })?;
    if bytes.len() < 24 || &bytes[..8] != magic {
        return Err(wrong("this is not a restart file of this version; start the run anew"));
    }
    let (body, sum) = bytes.split_at(bytes.len() - 8);
    let sum = <[u8; 8]>::try_from(sum).map(u64::from_le_bytes).unwrap_or_default();
    if checksum(body.iter().copied()) != sum {
        return Err(wrong(
            "the checksum is wrong: the file is damaged or was cut short; start the run anew",
        ));
    }
    let length = <[u8; 8]>::try_from(&body[8..16])
        .map(u64::from_le_bytes)
        .unwrap_or(u64::MAX) as usize;
    let header = body
        .get(16..16_usize.saturating_add(length))
        .ok_or_else(|| wrong("the header is longer than the file"))?
        .to_vec();
    let rest = body[16 + length..].to_vec();
    Ok((header, rest))
}

pub(crate) fn put_doubles(out: &mut dyn Write, values: &[f64]) -> std::io::Result<()> {
    values.iter().try_for_each(|v| out.write_all(&v.to_le_bytes()))
}

pub(crate) fn doubles(bytes: &[u8]) -> Vec<f64> {
    bytes
        .chunks_exact(8)
        .map(|b| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]))
        .collect()
}

impl Snapshot {
    /// Writes the file. The old one, if any, is replaced only once the new one is safe.
    ///
    /// # Errors
    /// [`FlowError::Io`]: the old file is then untouched.
    pub fn write(&self, path: &Path) -> Result<(), FlowError> {
        let header = serde_json::to_vec(self).map_err(|e| FlowError::Io {
            path: path.display().to_string(),
            source: e.into(),
        })?;
        write_checked(path, MAGIC, &header, &|out| put_doubles(out, &self.unknowns))
    }

    /// Reads a file and checks that it is whole.
    ///
    /// # Errors
    /// [`FlowError::Io`] or [`FlowError::Restart`].
    pub fn read(path: &Path) -> Result<Self, FlowError> {
        let (header, body) = read_checked(path, MAGIC)?;
        let mut snapshot: Self = serde_json::from_slice(&header).map_err(|e| FlowError::Restart {
            path: path.display().to_string(),
            what: format!("header: {e}"),
        })?;
        snapshot.unknowns = doubles(&body);
        Ok(snapshot)
    }
}
