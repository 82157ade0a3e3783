//! Boxes, plane or wavy inside, bounded or periodic: the grids of exact tests.

use std::f64::consts::PI;

use crate::block::Block;
use crate::face::{Face, Window};
use crate::period::Period;
use crate::topology::{Condition, Interface, MultiBlock, Orientation, Patch, Side, Topology};

/// A box of one block with i along x, j along y, k along z.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxGrid {
    /// Lower corner.
    pub lo: [f64; 3],
    /// Upper corner.
    pub hi: [f64; 3],
    /// Cells along x, y, z.
    pub cells: [usize; 3],
    /// Amplitude of the waves inside, as a fraction of the box's edges. Cells stay positive below about 0.05.
    pub waviness: f64,
    /// Directions that are periodic; their two faces become one interface.
    pub periodic: [bool; 3],
    /// Conditions of the faces in the order of [`Face::ALL`]; those of periodic directions are not used.
    pub conditions: [Condition; 6],
}

impl BoxGrid {
    /// A plain box, far field all round.
    #[must_use]
    pub fn new(lo: [f64; 3], hi: [f64; 3], cells: [usize; 3]) -> Self {
        Self {
            lo,
            hi,
            cells,
            waviness: 0.0,
            periodic: [false; 3],
            conditions: [Condition::FarField; 6],
        }
    }

    /// With waves of amplitude `waviness` (a fraction of the edges).
    #[must_use]
    pub fn wavy(mut self, waviness: f64) -> Self {
        self.waviness = waviness;
        self
    }

    /// With periodic directions.
    #[must_use]
    pub fn periodic(mut self, periodic: [bool; 3]) -> Self {
        self.periodic = periodic;
        self
    }

    /// With conditions, in the order of [`Face::ALL`].
    #[must_use]
    pub fn conditions(mut self, conditions: [Condition; 6]) -> Self {
        self.conditions = conditions;
        self
    }

    /// Makes the grid. Patches are named `xmin`, `xmax`, `ymin`, ...
    #[must_use]
    pub fn make(&self) -> MultiBlock {
        let cells = self.cells.map(|n| n.max(1));
        let block = Block::from_fn("box", cells, |i, j, k| {
            let index = [i, j, k];
            let t = [0, 1, 2].map(|d| index[d] as f64 / cells[d] as f64);
            let mut p = [0.0; 3];
            for d in 0..3 {
                // The wave of direction d vanishes on the two faces normal to d, so that the box keeps its planes;
                // along the others it is a full period, so that periodic faces match node by node.
                let [a, b] = [(d + 1) % 3, (d + 2) % 3];
                let along = if cells[d] > 1 { (PI * t[d]).sin() } else { 0.0 };
                // Whole periods by index, so that t = 0 and t = 1 give the same bits.
                let whole = |d: usize| (2.0 * PI * ((index[d] % cells[d]) as f64 / cells[d] as f64)).sin();
                let wave = self.waviness * along * (1.0 + 0.5 * whole(a)) * (1.0 + 0.5 * whole(b)) / 2.25;
                let at = if index[d] == cells[d] { 1.0 } else { t[d] + wave };
                p[d] = if index[d] == cells[d] {
                    self.hi[d]
                } else {
                    self.lo[d] + at * (self.hi[d] - self.lo[d])
                };
            }
            p
        });
        let mut topology = Topology::default();
        for axis in 0..3 {
            let faces = [Face::new(axis, false), Face::new(axis, true)];
            let side = |face: Face| Side {
                block: 0,
                face,
                window: Window::full(block.face_cells(face)),
            };
            if self.periodic[axis] {
                let mut translation = [0.0; 3];
                translation[axis] = self.hi[axis] - self.lo[axis];
                topology.interfaces.push(Interface {
                    a: side(faces[0]),
                    b: side(faces[1]),
                    orientation: Orientation::default(),
                    period: Some(Period::Translation(translation)),
                });
                continue;
            }
            for (face, end) in faces.into_iter().zip(["min", "max"]) {
                topology.patches.push(Patch {
                    name: format!("{}{end}", ["x", "y", "z"][axis]),
                    block: 0,
                    face,
                    window: side(face).window,
                    condition: self.conditions[face as usize],
                });
            }
        }
        MultiBlock {
            blocks: vec![block],
            topology,
        }
    }
}

/// A plain box from `lo` to `hi` with `cells`, far field all round. See [`BoxGrid`] for more.
#[must_use]
pub fn box_grid(lo: [f64; 3], hi: [f64; 3], cells: [usize; 3]) -> MultiBlock {
    BoxGrid::new(lo, hi, cells).make()
}
