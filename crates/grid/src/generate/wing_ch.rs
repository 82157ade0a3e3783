//! C-H grids round a half wing: a C round every section, planes y = const from the symmetry plane past the tip.

use rayon::prelude::*;

use super::aerofoil::cells_for;
use super::chord::{self, Kind, WingMaps};
use super::plane_c::{Plane, PlaneC};
use super::smoothing::folded;
use super::spacing::{geometric, two_sided};
use super::wall_normal::Wall;
use super::{GenerateError, Smoothing, check_count, check_growth, check_positive, check_step};
use crate::block::Block;
use crate::face::{Face, Window};
use crate::geometry::Wing;
use crate::topology::{Condition, Interface, MultiBlock, Orientation, Patch, Side, Topology};

/// A C-H grid in one block. Lengths are in the unit of the wing but where chords are named.
#[derive(Clone, Debug, PartialEq)]
pub struct WingCh {
    /// The wing.
    pub wing: Wing,
    /// Cells along each surface of a section.
    pub surface: usize,
    /// Cells along the wake.
    pub wake: usize,
    /// Cells from wall to far field.
    pub normal: usize,
    /// Cells along the span of the wing.
    pub span: usize,
    /// Cells from tip to far field.
    pub outboard: usize,
    /// First step off the wall.
    pub wall_spacing: f64,
    /// Step along the surface at the nose, in chords.
    pub nose_spacing: f64,
    /// Step along the surface at the trailing edge, in chords.
    pub tail_spacing: f64,
    /// Step along the span at the symmetry plane.
    pub root_spacing: f64,
    /// Step along the span at the tip.
    pub tip_spacing: f64,
    /// Distance of the far field upstream, up, down and outboard.
    pub far_field: f64,
    /// Distance from the root's leading edge to the exit.
    pub exit: f64,
    /// Growth of the first step behind and outboard of the wing, per chord.
    pub wake_growth: f64,
    /// The sheet outboard of the tip becomes straight within a quarter of a chord; else it keeps the tip's camber line.
    pub straight_sheet: bool,
    /// Largest growth ratio allowed from wall to far field.
    pub growth_limit: f64,
    /// Keep every node (1), every second (2), every fourth (4): the exact coarser levels. Divides all numbers of cells.
    pub stride: usize,
}

impl WingCh {
    /// Makes the grid: i from the exit above the wake round the nose to the exit below, j from the wall out, k from the
    /// root outboard. Patches: `wing`, `symmetry`, `far`, `exit`. The wake and the sheet outboard of the tip are
    /// interfaces of the block with itself.
    /// # Errors
    /// A size that is too small, a growth over the limit, a wing or section that is wrong.
    pub fn make(&self) -> Result<MultiBlock, GenerateError> {
        self.make_smoothed(None)
    }

    /// The same with every plane smoothed, and lines near the wall turned into its normal. `stride` must be 1.
    /// # Errors
    /// As [`Self::make`]; a smoothing that leaves folded cells.
    pub fn make_smoothed(&self, smoothing: Option<Smoothing>) -> Result<MultiBlock, GenerateError> {
        if smoothing.is_some() && self.stride != 1 {
            return Err(GenerateError::setting("stride", "1 with smoothing", self.stride));
        }
        self.check()?;
        let wing = &self.wing;
        let side = chord::side(
            &wing.stations[0].section,
            self.surface,
            self.nose_spacing,
            self.tail_spacing,
        );
        let t = chord::around(&side);
        let maps = WingMaps::new(Kind::C, wing, &t, self.straight_sheet)?;
        let y: Vec<f64> = self.span_stations().into_iter().step_by(self.stride).collect();
        let planes: Result<Vec<(Plane, [f64; 3])>, GenerateError> =
            y.par_iter().map(|&y| self.plane(&maps, &t, y, smoothing)).collect();
        let planes = planes?;
        let growth = planes
            .iter()
            .fold(1.0, |worst: f64, (plane, _)| worst.max(plane.growth));
        if growth > self.growth_limit {
            return Err(GenerateError::Growth {
                growth,
                limit: self.growth_limit,
                cells: self.normal,
                needed: cells_for(self.wall_spacing, self.far_field, self.growth_limit),
            });
        }
        let kept = |n: usize| n / self.stride;
        let (wake, span) = (kept(self.wake), kept(self.span));
        let ni = kept(2 * (self.surface + self.wake));
        let cells = [ni, kept(self.normal), span + kept(self.outboard)];
        let mut block = Block::from_fn("wing", cells, |i, j, k| {
            let (plane, [x_le, z_le, chord]) = &planes[k];
            let p = plane.nodes[i + (ni + 1) * j];
            [x_le + chord * p[0], y[k], z_le + chord * p[1]]
        });
        if let Some(Smoothing { sweeps, .. }) = smoothing.filter(|s| s.sweeps > 0) {
            Wall::of(wing, wake + 1..ni - wake, 0..span).straighten(&mut block);
            let folded = folded(&block);
            if folded > 0 {
                let change = 0.0;
                return Err(GenerateError::Folded { folded, sweeps, change });
            }
        }
        for k in 0..=cells[2] {
            for i in 0..=ni {
                // Both sides of the wake, and of the sheet outboard of the tip, are one surface: to the last bit.
                if i < wake || k >= span {
                    let p = block.point(i.min(ni - i), 0, k);
                    block.set_point([ni - i.min(ni - i), 0, k], p);
                }
            }
        }
        Ok(MultiBlock {
            topology: topology(cells, wake, span),
            blocks: vec![block],
        })
    }

    fn check(&self) -> Result<(), GenerateError> {
        self.wing.check()?;
        let span = self.wing.tip_y() - self.wing.root_y();
        for (name, value) in [
            ("wall_spacing", self.wall_spacing),
            ("far_field", self.far_field),
            ("exit", self.exit),
        ] {
            check_positive(name, value)?;
        }
        check_step("nose_spacing", self.nose_spacing, 1.0)?;
        check_step("tail_spacing", self.tail_spacing, 1.0)?;
        check_step("root_spacing", self.root_spacing, span)?;
        check_step("tip_spacing", self.tip_spacing, span)?;
        check_growth(self.wake_growth)?;
        let counts = [
            ("surface", self.surface, 4),
            ("normal", self.normal, 2),
            ("wake", self.wake, 2),
            ("span", self.span, 2),
            ("outboard", self.outboard, 2),
        ];
        for (name, value, least) in counts {
            check_count(name, value, least, self.stride)?;
        }
        let last = self.wing.planform(self.wing.tip_y() + self.far_field);
        let first = self.wing.planform(self.wing.root_y());
        let tail = (last[0] + last[2]).max(first[0] + first[2]);
        if self.exit + first[0] <= tail + first[2] {
            let least = tail + first[2] - first[0];
            return Err(GenerateError::setting(
                "exit",
                &format!("more than {least:.4}"),
                self.exit,
            ));
        }
        Ok(())
    }

    /// y of every plane.
    fn span_stations(&self) -> Vec<f64> {
        let (root, tip) = (self.wing.root_y(), self.wing.tip_y());
        let span = tip - root;
        let mut y: Vec<f64> = two_sided(self.span, self.root_spacing / span, self.tip_spacing / span)
            .into_iter()
            .map(|s| root + s * span)
            .collect();
        y[self.span] = tip;
        y.extend(
            geometric(self.outboard, self.tip_spacing, self.far_field)
                .into_iter()
                .skip(1)
                .map(|d| tip + d),
        );
        y
    }

    fn plane(
        &self,
        maps: &WingMaps,
        t: &[f64],
        y: f64,
        smoothing: Option<Smoothing>,
    ) -> Result<(Plane, [f64; 3]), GenerateError> {
        let wing = &self.wing;
        let place @ [x_le, z_le, chord] = wing.planform(y);
        let local = |p: [f64; 3]| [(p[0] - x_le) / chord, (p[2] - z_le) / chord];
        let share = |height: f64| tip_share(wing, y, height * chord);
        let beyond = (y - wing.tip_y()).max(0.0) / chord;
        let exit = (wing.planform(wing.root_y())[0] + self.exit - x_le) / chord;
        let mixture = maps.at(wing, y);
        let is_bent = mixture.iter().any(|(maps, _)| maps.flat.is_some());
        let curved = if is_bent { chord::curved(beyond) } else { 1.0 };
        let ends = [0.0, 1.0].map(|t| local(wing.point(y, t)));
        let wall = |&t: &f64| -> [f64; 2] {
            let p = local(wing.point(y, t));
            if curved == 1.0 {
                return p;
            }
            let straight = chord::straight(ends[0], ends[1], t);
            [0, 1].map(|d| straight[d] + curved * (p[d] - straight[d]))
        };
        let plane = PlaneC {
            mixture,
            curved,
            wall: t.iter().map(wall).collect(),
            wake: geometric(self.wake, self.tail_spacing, exit - 1.0)
                .iter()
                .map(|x| 1.0 + x)
                .collect(),
            share: &share,
            far: self.far_field / chord,
            normal: self.normal,
            first: self.wall_spacing / chord * (1.0 + self.wake_growth * beyond),
            wake_growth: self.wake_growth,
            stride: self.stride,
        };
        let mut plane = plane.make();
        if let Some(smoothing) = smoothing {
            smoothing.apply(&mut plane.nodes, 2 * (self.surface + self.wake), self.normal)?;
        }
        Ok((plane, place))
    }
}

fn topology(cells: [usize; 3], tail: usize, span: usize) -> Topology {
    let [ni, nj, nk] = cells;
    let nose = ni / 2;
    let side = |face: Face, lo: [usize; 2], hi: [usize; 2]| Side {
        block: 0,
        face,
        window: Window::new(lo, hi),
    };
    let fold = |a: Side, b: Side| Interface {
        a,
        b,
        orientation: Orientation {
            swap: false,
            reverse: [true, false],
        },
        period: None,
    };
    let patch = |name: &str, side: Side, condition: Condition| Patch {
        name: name.into(),
        block: 0,
        face: side.face,
        window: side.window,
        condition,
    };
    let below = |lo: [usize; 2], hi: [usize; 2]| side(Face::JMin, lo, hi);
    Topology {
        interfaces: vec![
            fold(below([0, 0], [tail, nk]), below([ni - tail, 0], [ni, nk])),
            fold(below([tail, span], [nose, nk]), below([nose, span], [ni - tail, nk])),
        ],
        patches: vec![
            patch("wing", below([tail, 0], [ni - tail, span]), Condition::Wall),
            patch("symmetry", side(Face::KMin, [0, 0], [ni, nj]), Condition::Symmetry),
            patch("far", side(Face::JMax, [0, 0], [ni, nk]), Condition::FarField),
            patch("far", side(Face::KMax, [0, 0], [ni, nj]), Condition::FarField),
            patch("exit", side(Face::IMin, [0, 0], [nj, nk]), Condition::FarField),
            patch("exit", side(Face::IMax, [0, 0], [nj, nk]), Condition::FarField),
        ],
    }
}

/// Share of the section's thickness that shapes the grid at `height` above the plane of the wing at y.
///
/// On the wall it is the closure of the tip; above, the closure is spread over a span that grows with height, and its end
/// is rounded off, so that the tip's short end does not print through to the far field.
fn tip_share(wing: &Wing, y: f64, height: f64) -> f64 {
    // Nothing changes within a few tip lengths of the wall: were the closure to widen at once, lines would be pushed down
    // faster than they rise.
    let spread = height * height / (height + 4.0 * wing.tip_length);
    let length = wing.tip_length + spread;
    // The closure's end moves outboard too, but slowly at first, so that lines that start on the tip do not feel the
    // thickness at once.
    let end = wing.tip_y() + 0.5 * spread * spread / length;
    let u = 1.0 + (y - end) / length;
    // A quarter ellipse ends with an infinite slope, its fourth power with slope zero.
    let power = 1.0 + 3.0 * spread / length;
    crate::geometry::closure(wing.tip, u).powf(power)
}
