//! O-O grids round a half wing: an O round every section and round the tip.
//!
//! In a plane y = const the section stands in its conformal O coordinates (a, b); b measured as a length is
//! `h = f sinh b` with f half the focal distance. In the plane of (y, h) the wing is the line h = 0, 0 < y < tip, and
//! the same confocal ellipses wrap round its end: `y = s cosh m cos p`, `h = s sinh m sin p`. So (a, p) number the
//! points of the wing, m counts outward, p = pi/2 is the symmetry plane, and p = 0 is the sheet outboard of the tip, on
//! which upper and lower side meet. Both steps keep volumes positive wherever the sections' maps do.

use rayon::prelude::*;

use super::aerofoil::cells_for;
use super::chord::{self, Kind, WingMaps, mixed};
use super::elliptic::Smoothed;
use super::line::spread;
use super::smoothing::{Start, folded};
use super::spacing::two_sided;
use super::wall_normal::Wall;
use super::{GenerateError, Smoothing, check_count, check_positive, check_step};
use crate::block::Block;
use crate::face::{Face, Window};
use crate::geometry::{Station, Wing};
use crate::topology::{Condition, Interface, MultiBlock, Orientation, Patch, Side, Topology};

/// An O-O grid in one block. Lengths are in the unit of the wing but where chords are named.
#[derive(Clone, Debug, PartialEq)]
pub struct WingOo {
    /// The wing.
    pub wing: Wing,
    /// Cells along each surface of a section.
    pub surface: usize,
    /// Cells from wall to far field.
    pub normal: usize,
    /// Cells along the span.
    pub span: usize,
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
    /// Radius of the far field.
    pub far_field: f64,
    /// Largest growth ratio allowed from wall to far field.
    pub growth_limit: f64,
    /// Keep every node (1), every second (2), every fourth (4): the exact coarser levels. Divides all numbers of cells.
    pub stride: usize,
}

impl WingOo {
    /// Makes the grid: i from the upper trailing edge round the nose to the lower, j from the wall out, k from root to
    /// tip. Patches: `wing`, `symmetry`, `far`. The cut behind the trailing edge and the sheet outboard of the tip are
    /// interfaces of the block with itself.
    /// # Errors
    /// A size that is too small, a growth over the limit, a wing or section that is wrong.
    pub fn make(&self) -> Result<MultiBlock, GenerateError> {
        self.make_smoothed(None)
    }

    /// The same with every surface from the wall to the far field (k = const) smoothed, and lines near the wall turned into its
    /// normal. `stride` must be 1.
    /// # Errors
    /// As [`Self::make`]; a smoothing from transfinite interpolation, or one that leaves folded cells.
    pub fn make_smoothed(&self, smoothing: Option<Smoothing>) -> Result<MultiBlock, GenerateError> {
        if smoothing.is_some() && self.stride != 1 {
            return Err(GenerateError::setting("stride", "1 with smoothing", self.stride));
        }
        if smoothing.is_some_and(|s| s.start == Start::Transfinite) {
            // Interpolated between its edges alone, a surface that bends round the tip would leave the wall aslant.
            return Err(GenerateError::setting(
                "smoothing.start",
                "\"map\" in O-O grids",
                "\"transfinite\"",
            ));
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
        let maps = WingMaps::new(Kind::O, wing, &t, true)?;
        let (root, tip) = (wing.root_y(), wing.tip_y());
        let semispan = tip - root;
        let y: Vec<f64> = two_sided(self.span, self.root_spacing / semispan, self.tip_spacing / semispan)
            .into_iter()
            .map(|s| root + s * semispan)
            .collect();
        let kept = |n: usize| n / self.stride;
        let (surface, span) = (kept(self.surface), kept(self.span));
        let ni = 2 * surface;
        let cells = [ni, kept(self.normal), span];
        // Of a wing that is its own mirror image the upper half is enough.
        let mirrored = self.is_mirrored();
        let across = if mirrored { surface } else { ni };
        let lines: Vec<(Vec<[f64; 3]>, f64)> = (0..(across + 1) * (span + 1))
            .into_par_iter()
            .map(|n| {
                let (i, k) = (n % (across + 1) * self.stride, n / (across + 1) * self.stride);
                self.line(&maps, i, t[i], if k == self.span { tip } else { y[k] })
            })
            .collect();
        let growth = lines.iter().fold(1.0, |worst: f64, (_, ratio)| worst.max(*ratio));
        if growth > self.growth_limit {
            return Err(GenerateError::Growth {
                growth,
                limit: self.growth_limit,
                cells: self.normal,
                needed: cells_for(self.wall_spacing, self.far_field, self.growth_limit),
            });
        }
        let mut block = Block::from_fn("wing", cells, |i, j, k| {
            let above = i.min(ni - i);
            // The cut behind the trailing edge and the sheet outboard of the tip are one surface: to the last bit.
            let from = if mirrored || i == ni || k == span { above } else { i };
            let mut p = lines[from + (across + 1) * k].0[j];
            if k == 0 {
                p[1] = root;
            }
            if mirrored {
                if above == 0 || above == surface || k == span {
                    p[2] = 0.0;
                }
                if i > surface {
                    p[2] = -p[2];
                }
            }
            // No negative zero: the two sides of a cut are compared bit by bit.
            p.map(|v| v + 0.0)
        });
        if let Some(smoothing) = smoothing {
            self.smooth(&mut block, smoothing, mirrored)?;
        }
        Ok(MultiBlock {
            topology: topology(cells),
            blocks: vec![block],
        })
    }

    /// Smooths every surface k = const of the block by itself, then turns the lines at the wall.
    fn smooth(&self, block: &mut Block, smoothing: Smoothing, mirrored: bool) -> Result<(), GenerateError> {
        let [ni, nj, nk] = block.cells();
        let surface: Vec<(Vec<[f64; 3]>, Smoothed)> = (0..=nk)
            .into_par_iter()
            .map(|k| {
                let mut nodes: Vec<[f64; 3]> = (0..=nj)
                    .flat_map(|j| (0..=ni).map(move |i| [i, j]))
                    .map(|[i, j]| block.point(i, j, k))
                    .collect();
                let done = smoothing.smooth(&mut nodes, ni, nj);
                (nodes, done)
            })
            .collect();
        for (k, (nodes, _)) in surface.iter().enumerate() {
            for (n, &p) in nodes.iter().enumerate() {
                block.set_point([n % (ni + 1), n / (ni + 1), k], p);
            }
        }
        if smoothing.sweeps > 0 {
            Wall::of(&self.wing, 1..ni, 0..nk).straighten(block);
        }
        for k in 0..=nk {
            for j in 0..=nj {
                for i in 0..=ni {
                    // What is one surface, or its own mirror image, stays so to the last bit: above is done before below.
                    let above = i.min(ni - i);
                    let one = mirrored || k == nk;
                    let mut p = block.point(if one { above } else { i }, j, k);
                    if k == 0 {
                        p[1] = self.wing.root_y();
                    }
                    if mirrored && (2 * above == ni || k == nk) {
                        p[2] = 0.0;
                    } else if mirrored && i > above {
                        p[2] = -p[2];
                    }
                    block.set_point([i, j, k], p.map(|v| v + 0.0));
                }
            }
        }
        let folded = folded(block);
        let last = |(most, change): (usize, f64), done: &Smoothed| (most.max(done.sweeps), change.max(done.change));
        if folded > 0 {
            let (sweeps, change) = surface.iter().map(|(_, done)| done).fold((0, 0.0), last);
            return Err(GenerateError::Folded { folded, sweeps, change });
        }
        Ok(())
    }

    fn check(&self) -> Result<(), GenerateError> {
        self.wing.check()?;
        check_positive("wall_spacing", self.wall_spacing)?;
        check_step("nose_spacing", self.nose_spacing, 1.0)?;
        check_step("tail_spacing", self.tail_spacing, 1.0)?;
        let semispan = self.wing.tip_y() - self.wing.root_y();
        check_step("root_spacing", self.root_spacing, semispan)?;
        check_step("tip_spacing", self.tip_spacing, semispan)?;
        if !(self.far_field > 1.5 * semispan && self.far_field.is_finite()) {
            return Err(GenerateError::setting(
                "far_field",
                &format!("more than {:.4}", 1.5 * semispan),
                self.far_field,
            ));
        }
        for (name, value, least) in [
            ("surface", self.surface, 4),
            ("normal", self.normal, 2),
            ("span", self.span, 2),
        ] {
            check_count(name, value, least, self.stride)?;
        }
        Ok(())
    }

    /// True for symmetric sections without twist in the plane z = 0.
    fn is_mirrored(&self) -> bool {
        let flat = |s: &Station| s.twist_deg == 0.0 && s.z_le == 0.0 && s.section.is_symmetric();
        self.wing.stations.iter().all(flat)
    }

    /// Leading edge (x, z) and chord at y; beyond the tip the sheet opens like a fan, so that it does not stay a thin strip far
    /// out.
    fn planform(&self, y: f64) -> [f64; 3] {
        let [x_le, z_le, chord] = self.wing.planform(y);
        let beyond = (y - self.wing.tip_y()).max(0.0);
        let fan = (beyond * beyond + chord * chord).sqrt() - chord;
        [x_le - 0.5 * fan, z_le, chord + fan]
    }

    /// The line from the wall point at section parameter `t` and span `y0`, and its growth ratio.
    fn line(&self, maps: &WingMaps, i: usize, t: f64, y0: f64) -> (Vec<[f64; 3]>, f64) {
        let wing = &self.wing;
        let (root, tip) = (wing.root_y(), wing.tip_y());
        let semispan = tip - root;
        let p = ((y0 - root) / semispan).clamp(0.0, 1.0).acos();
        let end = (self.far_field / semispan).acosh();
        let on_tip = y0 >= tip;
        let mapped = |m: f64| -> [f64; 3] {
            let (y, height) = if on_tip {
                (root + semispan * m.cosh(), 0.0)
            } else {
                (root + semispan * m.cosh() * p.cos(), semispan * m.sinh() * p.sin())
            };
            let [x_le, z_le, chord] = self.planform(y);
            let b = (2.0 * height / chord).asinh();
            let share = tip_share(wing, y, height);
            let curved = chord::curved((y - tip) / chord);
            let mixture = maps.at(wing, y);
            let q = mixed(&mixture, |s| {
                let full = if share > 0.0 {
                    s.full.position(s.full_a[i], b)
                } else {
                    [0.0; 2]
                };
                let mut plate = if share < 1.0 {
                    s.plate.position(s.plate_a[i], b)
                } else {
                    [0.0; 2]
                };
                if let Some((flat, a)) = s.flat.as_ref().filter(|_| curved < 1.0) {
                    let flat = flat.position(a[i], b);
                    plate = [0, 1].map(|d| flat[d] + curved * (plate[d] - flat[d]));
                }
                [
                    plate[0] + share * (full[0] - plate[0]),
                    plate[1] + share * (full[1] - plate[1]),
                ]
            });
            let q = if share >= 1.0 {
                mixed(&mixture, |s| s.full.position(s.full_a[i], b))
            } else {
                q
            };
            [x_le + chord * q[0], y, z_le + chord * q[1]]
        };
        let exact = wing.point(y0, t);
        let foot = mapped(0.0);
        let miss = [exact[0] - foot[0], 0.0, exact[2] - foot[2]];
        let fade_length = 0.25 * wing.planform(y0)[2];
        let line = |m: f64| {
            let q = mapped(m);
            let fade = (-crate::vector::distance(q, foot) / fade_length).exp();
            [q[0] + miss[0] * fade, q[1], q[2] + miss[2] * fade]
        };
        let (m, ratio) = spread(line, end, self.normal, self.wall_spacing);
        let nodes = m
            .iter()
            .step_by(self.stride)
            .enumerate()
            .map(|(j, &m)| if j == 0 { exact } else { line(m) })
            .collect();
        (nodes, ratio)
    }
}

/// Share of the section's thickness that shapes the grid at `height` above the plane of the wing at y: on the wall the
/// closure of the tip, above it the same closure over a span that grows with height and ends smoothly. Lines here lean
/// outboard with height, so that the closure may widen at once (in a C-H grid it may not).
fn tip_share(wing: &Wing, y: f64, height: f64) -> f64 {
    let length = wing.tip_length + height;
    let start = wing.tip_y() - wing.tip_length - 0.5 * height;
    // A quarter ellipse ends with an infinite slope, its fourth power with slope zero.
    let power = 1.0 + 3.0 * height / length;
    crate::geometry::closure(wing.tip, (y - start) / length).powf(power)
}

fn topology(cells: [usize; 3]) -> Topology {
    let [ni, nj, nk] = cells;
    let side = |face: Face, lo: [usize; 2], hi: [usize; 2]| Side {
        block: 0,
        face,
        window: Window::new(lo, hi),
    };
    let patch = |name: &str, side: Side, condition: Condition| Patch {
        name: name.into(),
        block: 0,
        face: side.face,
        window: side.window,
        condition,
    };
    let interface = |a: Side, b: Side, reverse: bool| Interface {
        a,
        b,
        orientation: Orientation {
            swap: false,
            reverse: [reverse, false],
        },
        period: None,
    };
    Topology {
        interfaces: vec![
            interface(
                side(Face::IMin, [0, 0], [nj, nk]),
                side(Face::IMax, [0, 0], [nj, nk]),
                false,
            ),
            interface(
                side(Face::KMax, [0, 0], [ni / 2, nj]),
                side(Face::KMax, [ni / 2, 0], [ni, nj]),
                true,
            ),
        ],
        patches: vec![
            patch("wing", side(Face::JMin, [0, 0], [ni, nk]), Condition::Wall),
            patch("symmetry", side(Face::KMin, [0, 0], [ni, nj]), Condition::Symmetry),
            patch("far", side(Face::JMax, [0, 0], [ni, nk]), Condition::FarField),
        ],
    }
}
