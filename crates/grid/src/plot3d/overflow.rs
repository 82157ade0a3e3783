//! Solutions as OVERFLOW writes them (q.save, q.restart): Plot3D's with more in every record.
//!
//! R. H. Nichols and P. G. Buning, User's Manual for OVERFLOW 2.x, "Q file": behind the sizes of all blocks stand NQ (variables a
//! node, the ratio of specific heats the sixth of them) and NQC (species); a block's reference values are REFMACH, ALPHA, REY,
//! TIME, GAMINF, BETA, TINF, the integer IGAM, HTINF, HT1, HT2, max(2, NQC) gas constants and, in newer versions, FSMACH, TVREF,
//! DTVREF.

use super::bytes::Order;
use super::detect::{nodes, sizes};
use super::records::record_header;
use super::solution::{Solution, SolutionBlock};
use super::{Encoding, Layout};

/// Most variables or species a file may claim to have.
const MOST: i64 = 1000;

/// The solution in the records of a file; `None` if they are not those of OVERFLOW.
pub(super) fn solution(all: &[Vec<&[u8]>], order: Order, marker: usize) -> Option<Solution> {
    let (head, multi, used) = record_header(all, order).ok()?;
    let (head, &[variables, species]) = head.split_last_chunk::<2>()?;
    let range = 5..=MOST;
    if !range.contains(&variables) || !(0..=MOST).contains(&species) {
        return None;
    }
    let (variables, species) = (usize::try_from(variables).ok()?, usize::try_from(species).ok()?);
    let sizes = sizes(head, true)?;
    if multi.unwrap_or(1) != sizes.len() || all.len() - used != 2 * sizes.len() {
        return None;
    }
    let pairs: Vec<[Vec<u8>; 2]> = all[used..]
        .chunks(2)
        .map(|pair| [0, 1].map(|n: usize| pair[n].concat()))
        .collect();
    // Reals of the reference record: before the gas constants, those, and three more in newer versions.
    let reals = [10, 13].map(|n| n + species.max(2));
    let double = [true, false].into_iter().find(|&double| {
        let width = if double { 8 } else { 4 };
        sizes.iter().zip(&pairs).all(|(&size, [reference, values])| {
            let wanted = nodes(size).checked_mul(variables).and_then(|n| n.checked_mul(width));
            reals.iter().any(|n| reference.len() == n * width + 4) && wanted == Some(values.len())
        })
    })?;
    let blocks = sizes
        .iter()
        .zip(&pairs)
        .map(|(&size, [reference, values])| {
            let width = if double { 8 } else { 4 };
            let first = order.reals(&reference[..4 * width], double);
            let numbers = order.reals(values, double);
            SolutionBlock {
                nodes: size,
                reference: [0, 1, 2, 3].map(|n: usize| first[n]),
                q: numbers.chunks(nodes(size)).map(<[f64]>::to_vec).collect(),
            }
        })
        .collect();
    let layout = Layout {
        encoding: Encoding::Records {
            big_endian: order.big_endian,
            marker,
        },
        double,
        multi: multi.is_some(),
        three_d: true,
        iblank: false,
    };
    Some(Solution { blocks, layout })
}
