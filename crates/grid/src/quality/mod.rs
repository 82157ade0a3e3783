//! Is the grid good? Volumes, closure, skewness, stretching, wall spacing, interfaces, faces without a condition.

mod cells;
mod fit;
mod wall;

use std::fmt;

use rayon::prelude::*;

use crate::topology::MultiBlock;
use cells::{Tally, tally, volume_findings};
use fit::{cover_findings, interface_findings};
use wall::walls;

/// A cell that a message names.
#[derive(Clone, Debug, PartialEq)]
pub struct CellPlace {
    /// Index of the block.
    pub block: usize,
    /// Indices of the cell.
    pub ijk: [usize; 3],
    /// Mean of its corners.
    pub centre: [f64; 3],
    /// The figure that is worst there.
    pub value: f64,
}

/// One figure over all cells: its worst value and the cells that have the worst values.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What is measured, with its unit.
    pub name: &'static str,
    /// The cells with the worst values, worst first.
    pub worst: Vec<CellPlace>,
    /// Mean over all cells.
    pub mean: f64,
}

/// A finding a user must look at.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// True if the grid cannot be used so.
    pub fatal: bool,
    /// Where, what, what to do.
    pub text: String,
}

/// What a check found.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Blocks.
    pub blocks: usize,
    /// Cells.
    pub cells: usize,
    /// Nodes, those on interfaces once for each block.
    pub nodes: usize,
    /// Sum of all volumes.
    pub volume: f64,
    /// Figures with their worst cells.
    pub figures: Vec<Figure>,
    /// Smallest, mean and largest height of the cells on walls, if there are any.
    pub wall_spacing: Option<[f64; 3]>,
    /// Findings; empty for a good grid.
    pub findings: Vec<Finding>,
}

impl Report {
    /// True if nothing was found that a user must look at.
    #[must_use]
    pub fn is_good(&self) -> bool {
        self.findings.is_empty()
    }

    /// The figure called `name`.
    #[must_use]
    pub fn figure(&self, name: &str) -> Option<&Figure> {
        self.figures.iter().find(|f| f.name == name)
    }
}

/// Names of the figures, for [`Report::figure`].
pub mod names {
    /// Smallest volume.
    pub const VOLUME: &str = "volume";
    /// Smallest scaled corner Jacobian: 1 is a box, 0 flat, below 0 folded. Corners of collapsed edges do not count.
    pub const JACOBIAN: &str = "corner Jacobian";
    /// Largest departure of an angle between the lines through a cell from 90 degrees.
    pub const SKEWNESS: &str = "skewness (deg)";
    /// Largest ratio of the sizes of neighbouring cells along one direction.
    pub const STRETCHING: &str = "stretching";
    /// Largest sum of area vectors of a cell over the sum of the areas.
    pub const CLOSURE: &str = "closure";
    /// Largest angle between the line off a wall and the wall's normal; missing where there is no wall.
    pub const WALL_ANGLE: &str = "wall angle (deg)";
}
/// Checks the grid: every cell, every interface, every face.
#[must_use]
pub fn check(grid: &MultiBlock) -> Report {
    let parts: Vec<Vec<Tally>> = grid.blocks.par_iter().enumerate().map(|(n, b)| tally(n, b)).collect();
    let mut tallies = Tally::all();
    for part in parts {
        for (sum, one) in tallies.iter_mut().zip(part) {
            sum.merge(one);
        }
    }
    let cells = grid.cell_count();
    let volume = tallies[0].sum;
    let mut figures: Vec<Figure> = tallies.into_iter().map(|t| t.figure(cells)).collect();
    let walls = walls(grid);
    let wall_spacing = walls.as_ref().map(|w| w.spacing);
    figures.extend(walls.map(|w| w.angle));
    let mut findings = Vec::new();
    for (n, block) in grid.blocks.iter().enumerate() {
        if let Some(node) = (0..block.node_count())
            .find(|&m| !(block.x[m].is_finite() && block.y[m].is_finite() && block.z[m].is_finite()))
        {
            let [ni, nj, _] = block.nodes();
            let (i, j, k) = (node % ni, node / ni % nj, node / (ni * nj));
            findings.push(Finding {
                fatal: true,
                text: format!(
                    "block {} ({}): node ({i}, {j}, {k}) is not a finite number",
                    n, block.name
                ),
            });
        }
    }
    volume_findings(grid, &figures, &mut findings);
    interface_findings(grid, &mut findings);
    cover_findings(grid, &mut findings);
    Report {
        blocks: grid.blocks.len(),
        cells,
        nodes: grid.node_count(),
        volume,
        figures,
        wall_spacing,
        findings,
    }
}

/// What is wrong with a grid's interfaces and conditions alone: quick, for solvers that are given other people's files. Empty where
/// every face cell belongs to one condition or one interface, whose nodes are one.
#[must_use]
pub fn misfits(grid: &MultiBlock) -> Vec<Finding> {
    let mut findings = Vec::new();
    interface_findings(grid, &mut findings);
    cover_findings(grid, &mut findings);
    findings.retain(|f| f.fatal);
    findings
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} blocks, {} cells, {} nodes, volume {:.9e}",
            self.blocks, self.cells, self.nodes, self.volume
        )?;
        if let Some([least, mean, most]) = self.wall_spacing {
            writeln!(f, "height of wall cells: {least:.3e} to {most:.3e}, mean {mean:.3e}")?;
        }
        writeln!(
            f,
            "{:<18}{:>13}{:>13}  worst at (block; i, j, k; x, y, z)",
            "figure", "worst", "mean"
        )?;
        for figure in &self.figures {
            let Some(place) = figure.worst.first() else { continue };
            let ([i, j, k], [x, y, z]) = (place.ijk, place.centre);
            writeln!(
                f,
                "{:<18}{:>13.4e}{:>13.4e}  {}; {i}, {j}, {k}; {x:.5}, {y:.5}, {z:.5}",
                figure.name, place.value, figure.mean, place.block
            )?;
        }
        if self.findings.is_empty() {
            return writeln!(f, "nothing to complain about");
        }
        for finding in &self.findings {
            writeln!(f, "{}: {}", if finding.fatal { "ERROR" } else { "look" }, finding.text)?;
        }
        Ok(())
    }
}
