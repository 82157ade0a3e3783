//! Finds which faces touch which, by their points.

mod finder;
mod points;

use std::fmt;

use self::finder::Finder;
pub(crate) use self::points::shortest_edge;
use crate::face::Face;
use crate::period::Period;
use crate::topology::{Condition, MultiBlock, Patch};
use crate::vector::distance;

/// How points are matched.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Two points nearer than this are one. `None`: 1e-9 of the grid's diagonal (2e-7 suits single precision files). It is
    /// never more than a tenth of the shortest edge at the point, so that the fine steps at a wall stay apart.
    pub tolerance: Option<f64>,
    /// Shifts and turns by which faces may match periodically.
    pub periodic: Vec<Period>,
}

/// What was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Found {
    /// Interfaces that were added.
    pub interfaces: usize,
    /// Those of a block with itself among them.
    pub of_itself: usize,
    /// Periodic ones among them.
    pub periodic: usize,
    /// Collapsed windows that were added as patches.
    pub collapsed: usize,
    /// Face cells that more than two faces share: left alone.
    pub ambiguous: usize,
    /// Face cells that are on no interface and no patch.
    pub free: usize,
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} interfaces found ({} of a block with itself, {} periodic), {} collapsed windows; {} face cells are free",
            self.interfaces, self.of_itself, self.periodic, self.collapsed, self.free
        )?;
        if self.ambiguous > 0 {
            write!(
                f,
                "; {} face cells coincide with more than one other and were left alone",
                self.ambiguous
            )?;
        }
        Ok(())
    }
}

/// One cell of a block's face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Cell {
    block: usize,
    face: Face,
    p: usize,
    q: usize,
}

/// Finds all interfaces among face cells that have none yet, and adds them to the topology: all eight orientations, blocks
/// that touch themselves, windows smaller than faces; then periodic ones. Face cells collapsed to an edge or a point get
/// the condition [`Condition::Collapsed`] unless a patch names them.
pub fn find_interfaces(grid: &mut MultiBlock, options: &Options) -> Found {
    let [lo, hi] = grid.bounds();
    let tolerance = options
        .tolerance
        .unwrap_or(1e-9 * distance(lo, hi))
        .max(f64::MIN_POSITIVE);
    let mut found = Found::default();
    let mut finder = Finder::new(grid);
    finder.number(grid, tolerance, None);
    found.collapsed = finder.collapsed(grid);
    let (interfaces, ambiguous) = finder.match_cells(grid, None);
    found.ambiguous = ambiguous;
    let mut all = interfaces;
    for &period in &options.periodic {
        finder.number(grid, tolerance, Some(period));
        let (interfaces, _) = finder.match_cells(grid, Some(period));
        found.periodic += interfaces.len();
        all.extend(interfaces);
    }
    found.interfaces = all.len();
    found.of_itself = all.iter().filter(|i| i.a.block == i.b.block).count();
    grid.topology.interfaces.extend(all);
    found.free = finder.free(grid);
    found
}

/// Gives every face cell that is on no interface and no patch to patches called `name`.
pub fn fill_rest(grid: &mut MultiBlock, name: &str, condition: Condition) {
    let finder = Finder::new(grid);
    for (block, face, window) in finder.windows(grid, |f, g, cell| !f.is_used(g, cell)) {
        grid.topology.patches.push(Patch {
            name: name.into(),
            block,
            face,
            window,
            condition,
        });
    }
}
