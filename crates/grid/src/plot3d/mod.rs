//! Plot3D grids and solutions: ASCII, Fortran unformatted, stream binary.
//!
//! Nothing is allocated for a size that the file cannot hold. The layout (encoding, byte order, record markers,
//! precision, 2-D or 3-D, one block or many, iblank) is found from the file itself: every layout is tried against the
//! file's length, and where two fit, against sane coordinates.

mod bytes;
mod detect;
mod overflow;
mod records;
mod solution;
mod write;

use std::path::{Path, PathBuf};

pub use solution::{Solution, SolutionBlock, parse_solution, read_solution, write_solution};
pub use write::{encode, write};

use crate::block::Block;

/// How numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Text.
    Ascii,
    /// Bytes without structure.
    Stream {
        /// Most significant byte first.
        big_endian: bool,
    },
    /// Fortran records between length markers.
    Records {
        /// Most significant byte first.
        big_endian: bool,
        /// Bytes of a marker: 4 or 8.
        marker: usize,
    },
}

/// Layout of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// How numbers are stored.
    pub encoding: Encoding,
    /// 64-bit reals (else 32-bit); text counts as 64-bit.
    pub double: bool,
    /// The file starts with the number of blocks.
    pub multi: bool,
    /// Three coordinates (else two).
    pub three_d: bool,
    /// Integers after the coordinates of each block.
    pub iblank: bool,
}

impl Default for Layout {
    /// Little-endian double-precision Fortran records of many 3-D blocks without iblank: what most solvers read.
    fn default() -> Self {
        let encoding = Encoding::Records {
            big_endian: false,
            marker: 4,
        };
        Self {
            encoding,
            double: true,
            multi: true,
            three_d: true,
            iblank: false,
        }
    }
}

/// A grid file's contents.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Blocks, named `1`, `2`, ... A 2-D block stands in the plane (x, z), one cell across.
    pub blocks: Vec<Block>,
    /// For each block its iblank values, node by node, if the file has them.
    pub iblank: Vec<Option<Vec<i32>>>,
    /// How the file was written.
    pub layout: Layout,
    /// The first block one node thick that is curved: a surface, which no cells lie on.
    surface: Option<usize>,
}

/// What is wrong with a Plot3D file.
#[derive(Debug, thiserror::Error)]
pub enum Plot3dError {
    /// It cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Its bytes do not make a grid or solution.
    #[error("{file}: {what}")]
    Content {
        /// The file.
        file: String,
        /// What is wrong, what is needed, what to do.
        what: String,
    },
}

/// Reads a grid of any layout.
/// # Errors
/// Says what does not fit: truncated, wrong counts, a coordinate that is not a number.
pub fn read(path: &Path) -> Result<Grid, Plot3dError> {
    let bytes = std::fs::read(path).map_err(|source| Plot3dError::Io {
        path: path.to_owned(),
        source,
    })?;
    parse(&path.to_string_lossy(), &bytes)
}

/// Reads a grid from the bytes of a file; `file` names it in messages.
/// # Errors
/// As [`read`].
pub fn parse(file: &str, bytes: &[u8]) -> Result<Grid, Plot3dError> {
    detect::grid(bytes).map_err(|what| Plot3dError::Content {
        file: file.to_owned(),
        what: if parse_solution(file, bytes).is_ok() {
            "a Plot3D solution, not a grid".into()
        } else {
            what
        },
    })
}
