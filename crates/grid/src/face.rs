//! The six sides of a block, and rectangles of cells on them.

use std::fmt;

/// A side of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Face {
    /// i = 0.
    IMin,
    /// i = ni.
    IMax,
    /// j = 0.
    JMin,
    /// j = nj.
    JMax,
    /// k = 0.
    KMin,
    /// k = nk.
    KMax,
}

impl Face {
    /// All six, in the order of the enum.
    pub const ALL: [Self; 6] = [Self::IMin, Self::IMax, Self::JMin, Self::JMax, Self::KMin, Self::KMax];

    /// The index direction the face is normal to: 0 = i, 1 = j, 2 = k.
    #[inline]
    #[must_use]
    pub fn axis(self) -> usize {
        self as usize / 2
    }

    /// True at the upper end of its direction.
    #[inline]
    #[must_use]
    pub fn is_max(self) -> bool {
        self as usize % 2 == 1
    }

    /// The face normal to `axis` (0 = i, 1 = j, 2 = k) at its upper or lower end.
    #[must_use]
    pub fn new(axis: usize, max: bool) -> Self {
        Self::ALL[(2 * axis + usize::from(max)).min(5)]
    }

    /// The two index directions in the face, ascending: (j, k), (i, k) or (i, j).
    #[inline]
    #[must_use]
    pub fn directions(self) -> [usize; 2] {
        match self.axis() {
            0 => [1, 2],
            1 => [0, 2],
            _ => [0, 1],
        }
    }

    /// Index triple of the entry `(p, q)` of the face, `depth` entries inside, in an array of `count` entries a
    /// direction (cells or nodes).
    #[inline]
    #[must_use]
    pub fn ijk(self, count: [usize; 3], p: usize, q: usize, depth: usize) -> [usize; 3] {
        let normal = if self.is_max() {
            count[self.axis()] - 1 - depth
        } else {
            depth
        };
        match self.axis() {
            0 => [normal, p, q],
            1 => [p, normal, q],
            _ => [p, q, normal],
        }
    }

    /// Name as in files: `imin`, `imax`, ...
    #[must_use]
    pub fn name(self) -> &'static str {
        ["imin", "imax", "jmin", "jmax", "kmin", "kmax"][self as usize]
    }

    /// The face called `name` (`imin`, `IMin`, ...).
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|face| face.name().eq_ignore_ascii_case(name))
    }
}

impl fmt::Display for Face {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A rectangle of cells on a face: cells `lo[0]..hi[0]` by `lo[1]..hi[1]` along [`Face::directions`].
///
/// The same numbers are node indices: the rectangle's nodes are `lo..=hi`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Window {
    /// First cell (and node) of each direction.
    pub lo: [usize; 2],
    /// One past the last cell (the last node) of each direction.
    pub hi: [usize; 2],
}

impl Window {
    /// Cells `lo..hi`.
    #[must_use]
    pub fn new(lo: [usize; 2], hi: [usize; 2]) -> Self {
        Self { lo, hi }
    }

    /// A whole face of `cells` cells.
    #[must_use]
    pub fn full(cells: [usize; 2]) -> Self {
        Self { lo: [0, 0], hi: cells }
    }

    /// Cells along the two directions.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [
            self.hi[0].saturating_sub(self.lo[0]),
            self.hi[1].saturating_sub(self.lo[1]),
        ]
    }

    /// Number of cells.
    #[must_use]
    pub fn count(&self) -> usize {
        self.size()[0] * self.size()[1]
    }

    /// The cells in both, if any.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        let lo = [self.lo[0].max(other.lo[0]), self.lo[1].max(other.lo[1])];
        let hi = [self.hi[0].min(other.hi[0]), self.hi[1].min(other.hi[1])];
        (lo[0] < hi[0] && lo[1] < hi[1]).then_some(Self { lo, hi })
    }

    /// True if cell `(p, q)` of the face is inside.
    #[must_use]
    pub fn contains(&self, p: usize, q: usize) -> bool {
        self.lo[0] <= p && p < self.hi[0] && self.lo[1] <= q && q < self.hi[1]
    }
}

impl fmt::Display for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "cells {}..{} x {}..{}",
            self.lo[0], self.hi[0], self.lo[1], self.hi[1]
        )
    }
}
