//! Smooths a plane or surface of a C or O grid: from which start, how long, and whether it went well.

use super::GenerateError;
use super::elliptic::{Elliptic, Smoothed};
use super::transfinite::transfinite;
use crate::block::Block;
use crate::metrics::hexahedron_volume;

/// What the smoothing starts from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Start {
    /// The grid of the conformal map.
    #[default]
    Map,
    /// Transfinite interpolation between wall, wake, exit and far boundary.
    Transfinite,
}

/// Smoothing by elliptic equations, plane by plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Smoothing {
    /// What it starts from.
    pub start: Start,
    /// At most so many sweeps; none leaves the start as it is.
    pub sweeps: usize,
}

impl Smoothing {
    /// Smooths the plane `nodes` `[j][i]`, (ni + 1) x (nj + 1) of them, j = 0 the wall. Edges and first steps stay.
    pub(super) fn apply(self, nodes: &mut [[f64; 2]], ni: usize, nj: usize) -> Result<(), GenerateError> {
        let width = ni + 1;
        let sense = area(nodes, width, [ni / 2, nj / 2]).signum();
        let done = self.smooth(nodes, ni, nj);
        let cells = (0..nj).flat_map(|j| (0..ni).map(move |i| [i, j]));
        // Not a number is folded, too.
        let sound = |&cell: &[usize; 2]| area(nodes, width, cell) * sense > 0.0;
        let folded = cells.filter(|cell| !sound(cell)).count();
        if folded > 0 {
            let Smoothed { sweeps, change } = done;
            return Err(GenerateError::Folded { folded, sweeps, change });
        }
        Ok(())
    }

    /// The same for a plane or a curved surface, folded or not.
    pub(super) fn smooth<const D: usize>(self, nodes: &mut [[f64; D]], ni: usize, nj: usize) -> Smoothed {
        let width = ni + 1;
        let step = |i: usize| {
            let (p, q) = (nodes[i], nodes[i + width]);
            (0..D).map(|d| (q[d] - p[d]).powi(2)).sum::<f64>().sqrt()
        };
        let first: Vec<f64> = (0..width).map(step).collect();
        if self.start == Start::Transfinite {
            transfinite(nodes, ni, nj);
        }
        Elliptic { sweeps: self.sweeps }.smooth(nodes, ni, nj, &first)
    }
}

/// Cells of a block without a positive volume.
pub(super) fn folded(block: &Block) -> usize {
    let sound = |&cell: &usize| {
        let [i, j, k] = block.cell_ijk(cell);
        hexahedron_volume(&block.corners(i, j, k)) > 0.0
    };
    // Not a number is folded, too.
    (0..block.cell_count()).filter(|cell| !sound(cell)).count()
}

/// Area of a cell, with a sign: half the product of its diagonals.
fn area(nodes: &[[f64; 2]], width: usize, [i, j]: [usize; 2]) -> f64 {
    let at = |i: usize, j: usize| nodes[i + width * j];
    let across = |p: [f64; 2], q: [f64; 2]| [q[0] - p[0], q[1] - p[1]];
    let (u, v) = (across(at(i, j), at(i + 1, j + 1)), across(at(i + 1, j), at(i, j + 1)));
    0.5 * (u[0] * v[1] - u[1] * v[0])
}
