//! C and O grids round an aerofoil, one cell across.

use super::chord::{self, Kind, StationMaps};
use super::line::spread;
use super::plane_c::PlaneC;
use super::spacing::geometric;
use super::{GenerateError, Smoothing, check_count, check_growth, check_positive, check_step};
use crate::block::Block;
use crate::face::{Face, Window};
use crate::geometry::{Section, Station, TrailingEdge};
use crate::topology::{Condition, Interface, MultiBlock, Orientation, Patch, Side, Topology};

/// Shape of a grid round an aerofoil.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AerofoilKind {
    /// Round the nose and along both sides of a wake.
    C,
    /// Round the aerofoil.
    O,
}

/// An aerofoil grid. Lengths but `chord` are in chords. A blunt trailing edge gets a second block behind its base.
#[derive(Clone, Debug, PartialEq)]
pub struct AerofoilGrid {
    /// C or O.
    pub kind: AerofoilKind,
    /// The section.
    pub section: Section,
    /// Chord in the unit of the grid; the leading edge is at the origin.
    pub chord: f64,
    /// Cells along each surface.
    pub surface: usize,
    /// Cells along the wake (C).
    pub wake: usize,
    /// Cells from wall to far field.
    pub normal: usize,
    /// Cells across a blunt base.
    pub base: usize,
    /// First step off the wall.
    pub wall_spacing: f64,
    /// Step along the surface at the nose.
    pub nose_spacing: f64,
    /// Step along the surface at the trailing edge.
    pub tail_spacing: f64,
    /// Distance of the far field.
    pub far_field: f64,
    /// Growth of the first step along the wake, per chord.
    pub wake_growth: f64,
    /// Largest growth ratio allowed from wall to far field.
    pub growth_limit: f64,
}

impl AerofoilGrid {
    /// Makes the grid: i from upper to lower side, j from the wall out, k across (0 to one chord).
    /// Patches: `aerofoil`, `base`, `far`, `exit`, `left`, `right`.
    /// # Errors
    /// A size that is too small, a growth over the limit, a section that cannot be mapped.
    pub fn make(&self) -> Result<MultiBlock, GenerateError> {
        self.make_smoothed(None)
    }

    /// The same, smoothed.
    /// # Errors
    /// As [`Self::make`]; a smoothing that leaves folded cells.
    pub fn make_smoothed(&self, smoothing: Option<Smoothing>) -> Result<MultiBlock, GenerateError> {
        self.check()?;
        let open = self.section.edge();
        let blunt = open[1] > 1e-9;
        let section = self.section.clone().with_trailing_edge(TrailingEdge::Closed)?;
        let side = chord::side(&section, self.surface, self.nose_spacing, self.tail_spacing);
        let t = chord::around(&side);
        let station = Station {
            y: 0.0,
            x_le: 0.0,
            z_le: 0.0,
            chord: 1.0,
            twist_deg: 0.0,
            section,
        };
        let (mut nodes, ni, growth, share): (Vec<[f64; 2]>, usize, f64, Vec<f64>) = match self.kind {
            AerofoilKind::C => {
                let maps = StationMaps::new(Kind::C, &station, &t)?;
                let wake: Vec<f64> = geometric(self.wake, self.tail_spacing, self.far_field)
                    .iter()
                    .map(|x| 1.0 + x)
                    .collect();
                let plane = PlaneC {
                    mixture: vec![(&maps, 1.0)],
                    curved: 1.0,
                    wall: t.iter().map(|&t| station.turned(t)).collect(),
                    wake,
                    share: &|_| 1.0,
                    far: self.far_field,
                    normal: self.normal,
                    first: self.wall_spacing,
                    wake_growth: self.wake_growth,
                    stride: 1,
                }
                .make();
                let wake = || std::iter::repeat_n(1.0, self.wake);
                let share = wake().chain(t.iter().copied()).chain(wake().map(|w| -w)).collect();
                (plane.nodes, 2 * (self.surface + self.wake), plane.growth, share)
            }
            AerofoilKind::O => {
                let (nodes, growth) = self.plane_o(&station, &t)?;
                (nodes, 2 * self.surface, growth, t.clone())
            }
        };
        if growth > self.growth_limit {
            return Err(GenerateError::Growth {
                growth,
                limit: self.growth_limit,
                cells: self.normal,
                needed: cells_for(self.wall_spacing, self.far_field, self.growth_limit),
            });
        }
        if let Some(smoothing) = smoothing {
            smoothing.apply(&mut nodes, ni, self.normal)?;
        }
        if blunt {
            // Open the closed section again: each surface is turned about the nose by its share of the gap. Away from
            // the wall only lines ever closer to the trailing edge take part.
            let closed = nodes[..=ni].to_vec();
            for j in 0..=self.normal {
                for (i, share) in share.iter().enumerate() {
                    let n = i + (ni + 1) * j;
                    let wall = closed[i];
                    let d = (nodes[n][0] - wall[0]).hypot(nodes[n][1] - wall[1]);
                    let part = 0.5 * share.signum() * (share * share).powf(1.0 + 3.0 * d);
                    nodes[n][0] += open[0] * part;
                    nodes[n][1] += open[1] * part;
                }
            }
        }
        let block = self.block("aerofoil", ni, self.normal, |i, j| nodes[i + (ni + 1) * j]);
        let mut grid = MultiBlock {
            blocks: vec![block],
            topology: Topology::default(),
        };
        self.connect(&mut grid, blunt);
        for n in 0..grid.blocks.len() {
            for (face, name) in [(Face::KMin, "left"), (Face::KMax, "right")] {
                let window = Window::full(grid.blocks[n].face_cells(face));
                let condition = Condition::Symmetry;
                grid.topology.patches.push(Patch {
                    name: name.into(),
                    block: n,
                    face,
                    window,
                    condition,
                });
            }
        }
        Ok(grid)
    }

    fn check(&self) -> Result<(), GenerateError> {
        for (name, value) in [
            ("chord", self.chord),
            ("wall_spacing", self.wall_spacing),
            ("far_field", self.far_field),
        ] {
            check_positive(name, value)?;
        }
        check_step("nose_spacing", self.nose_spacing, 1.0)?;
        check_step("tail_spacing", self.tail_spacing, 1.0)?;
        check_growth(self.wake_growth)?;
        let counts = [
            ("surface", self.surface, 4),
            ("normal", self.normal, 2),
            ("wake", self.wake, usize::from(self.kind == AerofoilKind::C) * 2),
            ("base", self.base, 1),
        ];
        for (name, value, least) in counts {
            check_count(name, value, least, 1)?;
        }
        Ok(())
    }

    fn plane_o(&self, station: &Station, t: &[f64]) -> Result<(Vec<[f64; 2]>, f64), GenerateError> {
        let maps = StationMaps::new(Kind::O, station, t)?;
        let ni = t.len() - 1;
        let mut nodes = vec![[0.0; 2]; (ni + 1) * (self.normal + 1)];
        let mut growth = 1.0f64;
        for (i, (&t, &a)) in t.iter().zip(&maps.full_a).enumerate() {
            let exact = station.turned(t);
            let foot = maps.full.position(a, 0.0);
            let miss = [exact[0] - foot[0], exact[1] - foot[1]];
            let line = |b: f64| {
                let p = maps.full.position(a, b);
                let fade = (-4.0 * (p[0] - foot[0]).hypot(p[1] - foot[1])).exp();
                [p[0] + miss[0] * fade, p[1] + miss[1] * fade]
            };
            // Half the focal distance times cosh b is the outer ellipse's half axis.
            let (b, ratio) = spread(line, (2.0 * self.far_field).asinh(), self.normal, self.wall_spacing);
            growth = growth.max(ratio);
            for (j, &b) in b.iter().enumerate() {
                nodes[i + (ni + 1) * j] = if j == 0 { exact } else { line(b) };
            }
        }
        for j in 0..=self.normal {
            // The cut is one line.
            nodes[ni + (ni + 1) * j] = nodes[(ni + 1) * j];
        }
        Ok((nodes, growth))
    }

    fn block(&self, name: &str, ni: usize, nj: usize, at: impl Fn(usize, usize) -> [f64; 2]) -> Block {
        Block::from_fn(name, [ni, nj, 1], |i, j, k| {
            let p = at(i, j);
            [self.chord * p[0], self.chord * k as f64, self.chord * p[1]]
        })
    }

    fn connect(&self, grid: &mut MultiBlock, blunt: bool) {
        let ni = grid.blocks[0].ni;
        let nj = self.normal;
        let side = |block: usize, face: Face, lo: usize, hi: usize| Side {
            block,
            face,
            window: Window::new([lo, 0], [hi, 1]),
        };
        let join = |a: Side, b: Side, reverse: bool| Interface {
            a,
            b,
            orientation: Orientation {
                swap: false,
                reverse: [reverse, false],
            },
            period: None,
        };
        let patch = |name: &str, side: Side, condition: Condition| Patch {
            name: name.into(),
            block: side.block,
            face: side.face,
            window: side.window,
            condition,
        };
        let mut interfaces = Vec::new();
        let mut patches = Vec::new();
        let body = grid.blocks[0].clone();
        match self.kind {
            AerofoilKind::C => {
                let (nw, wall_end) = (self.wake, ni - self.wake);
                patches.push(patch("aerofoil", side(0, Face::JMin, nw, wall_end), Condition::Wall));
                for face in [Face::IMin, Face::IMax] {
                    patches.push(patch("exit", side(0, face, 0, nj), Condition::FarField));
                }
                let (above, below) = (side(0, Face::JMin, 0, nw), side(0, Face::JMin, wall_end, ni));
                if blunt {
                    // i aft, j from the upper side of the wake to the lower.
                    let behind = Block::from_fn("base", [nw, self.base, 1], |i, j, k| {
                        let f = j as f64 / self.base as f64;
                        let (p, q) = (body.point(nw - i, 0, k), body.point(wall_end + i, 0, k));
                        if j == self.base { q } else { crate::vector::mix(p, q, f) }
                    });
                    grid.blocks.push(behind);
                    interfaces.push(join(above, side(1, Face::JMin, 0, nw), true));
                    interfaces.push(join(below, side(1, Face::JMax, 0, nw), false));
                    patches.push(patch("base", side(1, Face::IMin, 0, self.base), Condition::Wall));
                    patches.push(patch("exit", side(1, Face::IMax, 0, self.base), Condition::FarField));
                } else {
                    interfaces.push(join(above, below, true));
                }
            }
            AerofoilKind::O => {
                patches.push(patch("aerofoil", side(0, Face::JMin, 0, ni), Condition::Wall));
                let (first, last) = (side(0, Face::IMin, 0, nj), side(0, Face::IMax, 0, nj));
                if blunt {
                    // i from the lower edge of the base to the upper, j aft.
                    let behind = Block::from_fn("base", [self.base, nj, 1], |i, j, k| {
                        let f = i as f64 / self.base as f64;
                        let (p, q) = (body.point(ni, j, k), body.point(0, j, k));
                        if i == self.base { q } else { crate::vector::mix(p, q, f) }
                    });
                    grid.blocks.push(behind);
                    interfaces.push(join(last, side(1, Face::IMin, 0, nj), false));
                    interfaces.push(join(first, side(1, Face::IMax, 0, nj), false));
                    patches.push(patch("base", side(1, Face::JMin, 0, self.base), Condition::Wall));
                    patches.push(patch("far", side(1, Face::JMax, 0, self.base), Condition::FarField));
                } else {
                    interfaces.push(join(last, first, false));
                }
            }
        }
        patches.push(patch("far", side(0, Face::JMax, 0, ni), Condition::FarField));
        grid.topology = Topology { interfaces, patches };
    }
}

/// Cells that reach `length` from a first step with a growth ratio: `length = first (r^n - 1)/(r - 1)`.
pub(super) fn cells_for(first: f64, length: f64, ratio: f64) -> usize {
    ((length / first * (ratio - 1.0) + 1.0).ln() / ratio.ln()).ceil() as usize
}
