//! CGNS files (HDF5) of structured zones, with the feature `cgns`.
//!
//! What is in a node is the CGNS Standard Interface Data Structures (AIAA R-101A-2005, and the SIDS pages of the CGNS
//! project): one `Zone_t` a block, `GridConnectivity1to1_t` for interfaces, `BC_t` with families for patches. How a node
//! lies in HDF5 is the project's SIDS-to-HDF file mapping: a group with the attributes `name`, `label`, `type`, `flags` and a
//! dataset `" data"`, whose dimensions run the other way round than Fortran's.
//!
//! Zones are read in the order of their names (numbers in names count as numbers), as the CGNS library does.

#[cfg(feature = "cgns")]
mod conditions;
#[cfg(feature = "cgns")]
mod hdf5_write;
#[cfg(feature = "cgns")]
mod node;
#[cfg(feature = "cgns")]
mod periodic;
#[cfg(feature = "cgns")]
mod read;
#[cfg(feature = "cgns")]
mod terms;
#[cfg(feature = "cgns")]
mod write;

#[cfg(feature = "cgns")]
pub use read::{Read, parse, read};
#[cfg(feature = "cgns")]
pub use write::{encode, write};

use std::path::PathBuf;

use crate::period::Period;
use crate::topology::MultiBlock;

/// What is wrong with a CGNS file.
#[derive(Debug, thiserror::Error)]
pub enum CgnsError {
    /// It cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Its content does not make a grid.
    #[error("{file}: {what}")]
    Content {
        /// The file.
        file: String,
        /// Which node, what is wrong, what is needed.
        what: String,
    },
    /// This program was built without CGNS.
    #[error("{}: this program was built without CGNS; build it with `--features cgns` (docs/grids.md), or convert the file to Plot3D", path.display())]
    NotBuilt {
        /// The file.
        path: PathBuf,
    },
}

/// True if this program was built with the feature `cgns`.
pub const IS_BUILT: bool = cfg!(feature = "cgns");

/// True for names of CGNS files: `.cgns`, `.hdf`, `.hdf5`, `.h5`.
#[must_use]
pub fn is_named_so(path: &std::path::Path) -> bool {
    path.extension().is_some_and(|e| {
        ["cgns", "hdf", "hdf5", "h5"]
            .iter()
            .any(|known| e.eq_ignore_ascii_case(known))
    })
}

/// The axis of coordinates along which `axis` points, if it is one: CGNS knows turns about these.
fn coordinate_axis(axis: [f64; 3]) -> Option<usize> {
    (0..3).find(|&d| axis[d] != 0.0 && (0..3).all(|e| e == d || axis[e] == 0.0))
}

/// How many interfaces a CGNS file cannot hold: those periodic about an axis that is none of the coordinates'.
pub(crate) fn left_out(grid: &MultiBlock) -> Option<usize> {
    let askew = |period: Option<Period>| match period {
        Some(Period::Rotation { axis, .. }) => coordinate_axis(axis).is_none(),
        _ => false,
    };
    let count = grid.topology.interfaces.iter().filter(|i| askew(i.period)).count();
    (count > 0).then_some(count)
}
