//! Volumes of a deformed grid against those before.

use dip_grid::{MultiBlock, metrics};
use rayon::prelude::*;

use super::error::DeformError;

/// Volumes of a deformed grid against those before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeChange {
    /// Smallest volume over the one before.
    pub smallest: f64,
    /// Largest.
    pub largest: f64,
}

/// Compares the volumes of `moved` with those of `base` cell by cell.
///
/// # Errors
/// [`DeformError::Folded`] naming the first cell whose volume has not the sign it had.
pub fn volume_change(base: &MultiBlock, moved: &MultiBlock) -> Result<VolumeChange, DeformError> {
    let none = VolumeChange {
        smallest: f64::INFINITY,
        largest: f64::NEG_INFINITY,
    };
    let parts: Vec<Result<VolumeChange, DeformError>> = base
        .blocks
        .par_iter()
        .zip(&moved.blocks)
        .enumerate()
        .map(|(b, (before, after))| {
            let mut change = none;
            for cell in 0..before.cell_count() {
                let [i, j, k] = before.cell_ijk(cell);
                let old = metrics::hexahedron_volume(&before.corners(i, j, k));
                let new = metrics::hexahedron_volume(&after.corners(i, j, k));
                let ratio = new / old;
                if ratio.is_nan() || ratio <= 0.0 {
                    return Err(DeformError::Folded {
                        block: b,
                        name: before.name.clone(),
                        i,
                        j,
                        k,
                        before: old,
                        after: new,
                    });
                }
                change.smallest = change.smallest.min(ratio);
                change.largest = change.largest.max(ratio);
            }
            Ok(change)
        })
        .collect();
    parts.into_iter().try_fold(none, |sum, part| {
        part.map(|p| VolumeChange {
            smallest: sum.smallest.min(p.smallest),
            largest: sum.largest.max(p.largest),
        })
    })
}
