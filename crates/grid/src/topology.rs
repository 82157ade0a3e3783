//! How blocks touch each other and the world: interfaces, patches, and the whole grid.

use std::fmt;

use crate::block::Block;
use crate::face::{Face, Window};
use crate::period::Period;

/// What holds on a boundary patch. A periodic boundary is an [`Interface`] with a translation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Condition {
    /// A solid wall, slip or no-slip as the flow model asks.
    Wall,
    /// A wall the flow slides along in every flow model.
    WallSlip,
    /// A wall the flow sticks to in every viscous flow model.
    WallNoSlip,
    /// Mirror plane.
    Symmetry,
    /// Far field (free stream, characteristic).
    FarField,
    /// Subsonic inflow.
    InflowSubsonic,
    /// Supersonic inflow.
    InflowSupersonic,
    /// Subsonic outflow.
    OutflowSubsonic,
    /// Supersonic outflow: all is extrapolated.
    OutflowSupersonic,
    /// A face collapsed to a line or a point: it has no area and passes no flux.
    Collapsed,
}

impl Condition {
    /// All kinds.
    pub const ALL: [Self; 10] = [
        Self::Wall,
        Self::WallSlip,
        Self::WallNoSlip,
        Self::Symmetry,
        Self::FarField,
        Self::InflowSubsonic,
        Self::InflowSupersonic,
        Self::OutflowSubsonic,
        Self::OutflowSupersonic,
        Self::Collapsed,
    ];

    /// Name as in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Wall => "wall",
            Self::WallSlip => "wall-slip",
            Self::WallNoSlip => "wall-no-slip",
            Self::Symmetry => "symmetry",
            Self::FarField => "far-field",
            Self::InflowSubsonic => "inflow-subsonic",
            Self::InflowSupersonic => "inflow-supersonic",
            Self::OutflowSubsonic => "outflow-subsonic",
            Self::OutflowSupersonic => "outflow-supersonic",
            Self::Collapsed => "collapsed",
        }
    }

    /// The condition called `name`.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// True for the three kinds of solid wall.
    #[must_use]
    pub fn is_wall(self) -> bool {
        matches!(self, Self::Wall | Self::WallSlip | Self::WallNoSlip)
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A window of a face of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Side {
    /// Index of the block in [`MultiBlock::blocks`].
    pub block: usize,
    /// The face.
    pub face: Face,
    /// The cells of the face.
    pub window: Window,
}

/// Cells of a face with a boundary condition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Patch {
    /// Name, e.g. `wing`. Patches of one surface share it.
    pub name: String,
    /// Index of the block in [`MultiBlock::blocks`].
    pub block: usize,
    /// The face.
    pub face: Face,
    /// The cells of the face.
    pub window: Window,
    /// What holds there.
    pub condition: Condition,
}

impl Patch {
    /// Where the patch is.
    #[must_use]
    pub fn side(&self) -> Side {
        Side {
            block: self.block,
            face: self.face,
            window: self.window,
        }
    }
}

/// How the two directions of window `a` lie on window `b`: one of eight.
///
/// Entry `(p, q)` of `a`, counted from its `lo`, is entry `(p', q')` of `b`: first `(p', q') = (q, p)` if `swap`,
/// else `(p, q)`; then direction `d` of `b` is counted from its end where `reverse[d]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Orientation {
    /// The first direction of `a` is the second of `b`.
    pub swap: bool,
    /// Directions of `b` that run backwards.
    pub reverse: [bool; 2],
}

impl Orientation {
    /// The eight orientations.
    pub const ALL: [Self; 8] = {
        let mut all = [Self {
            swap: false,
            reverse: [false, false],
        }; 8];
        let mut n = 0;
        while n < 8 {
            all[n] = Self {
                swap: n & 4 != 0,
                reverse: [n & 1 != 0, n & 2 != 0],
            };
            n += 1;
        }
        all
    };

    /// Entry of `b` (from its `lo`) for entry `pq` of `a`; `size_b` is the number of entries of `b` (cells of the
    /// window, or cells + 1 for nodes).
    #[inline]
    #[must_use]
    pub fn map(self, pq: [usize; 2], size_b: [usize; 2]) -> [usize; 2] {
        let mut out = if self.swap { [pq[1], pq[0]] } else { pq };
        for d in 0..2 {
            if self.reverse[d] {
                out[d] = size_b[d] - 1 - out[d];
            }
        }
        out
    }

    /// The size of `b` that fits a window of `size_a`.
    #[must_use]
    pub fn size(self, size_a: [usize; 2]) -> [usize; 2] {
        if self.swap { [size_a[1], size_a[0]] } else { size_a }
    }

    /// This orientation (from `a` to `b`) followed by `next` (from `b` to `c`).
    #[must_use]
    pub fn then(self, next: Self) -> Self {
        let [r0, r1] = if next.swap {
            [self.reverse[1], self.reverse[0]]
        } else {
            self.reverse
        };
        Self {
            swap: self.swap != next.swap,
            reverse: [r0 != next.reverse[0], r1 != next.reverse[1]],
        }
    }

    /// The orientation from `b` to `a`.
    #[must_use]
    pub fn inverse(self) -> Self {
        let reverse = if self.swap {
            [self.reverse[1], self.reverse[0]]
        } else {
            self.reverse
        };
        Self {
            swap: self.swap,
            reverse,
        }
    }
}

/// Two windows whose cells touch one to one: block to block, a block to itself (a C-grid's wake) or, with a
/// period, after a shift or a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    /// One side.
    pub a: Side,
    /// The other side.
    pub b: Side,
    /// How `a` lies on `b`.
    pub orientation: Orientation,
    /// Periodic: what brings the nodes of `a` to those of `b`. `None` where the nodes coincide.
    pub period: Option<Period>,
}

impl Interface {
    /// The same interface seen from `b`.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self {
            a: self.b,
            b: self.a,
            orientation: self.orientation.inverse(),
            period: self.period.map(Period::inverse),
        }
    }

    /// Face cell `(p, q)` of `b`'s face that lies on face cell `(p, q)` of `a`'s face (absolute face indices).
    #[inline]
    #[must_use]
    pub fn cell_on_b(&self, p: usize, q: usize) -> [usize; 2] {
        let local = [p - self.a.window.lo[0], q - self.a.window.lo[1]];
        let out = self.orientation.map(local, self.b.window.size());
        [out[0] + self.b.window.lo[0], out[1] + self.b.window.lo[1]]
    }

    /// Face node `(p, q)` of `b`'s face that lies on face node `(p, q)` of `a`'s face (absolute face indices).
    #[inline]
    #[must_use]
    pub fn node_on_b(&self, p: usize, q: usize) -> [usize; 2] {
        let local = [p - self.a.window.lo[0], q - self.a.window.lo[1]];
        let size = self.b.window.size();
        let out = self.orientation.map(local, [size[0] + 1, size[1] + 1]);
        [out[0] + self.b.window.lo[0], out[1] + self.b.window.lo[1]]
    }
}

/// What every face cell of every block is: on an interface (listed once) or on a patch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Topology {
    /// Pairs of windows that touch.
    pub interfaces: Vec<Interface>,
    /// Windows with a boundary condition.
    pub patches: Vec<Patch>,
}

/// A grid: blocks and how they fit together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MultiBlock {
    /// The blocks.
    pub blocks: Vec<Block>,
    /// Interfaces and patches; sides name blocks by their index in `blocks`.
    pub topology: Topology,
}

impl MultiBlock {
    /// Number of cells of all blocks.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.blocks.iter().map(Block::cell_count).sum()
    }

    /// Number of nodes of all blocks (those on interfaces count for each block).
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.blocks.iter().map(Block::node_count).sum()
    }

    /// True if every block is one cell across (along k) with symmetry on both sides: a two-dimensional grid.
    #[must_use]
    pub fn is_two_dimensional(&self) -> bool {
        !self.blocks.is_empty()
            && self.blocks.iter().enumerate().all(|(n, block)| {
                block.nk == 1
                    && [Face::KMin, Face::KMax].into_iter().all(|face| {
                        let covered: usize = self
                            .topology
                            .patches
                            .iter()
                            .filter(|p| p.block == n && p.face == face && p.condition == Condition::Symmetry)
                            .map(|p| p.window.count())
                            .sum();
                        covered == block.ni * block.nj
                    })
            })
    }

    /// Smallest box that holds every node: lower and upper corner.
    #[must_use]
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for block in &self.blocks {
            let [lo, hi] = block.bounds();
            for d in 0..3 {
                bounds[0][d] = bounds[0][d].min(lo[d]);
                bounds[1][d] = bounds[1][d].max(hi[d]);
            }
        }
        bounds
    }
}
