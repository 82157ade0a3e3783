//! Grids over a floor: flat plate, bump, ramp; one cell across.

use super::GenerateError;
use super::aerofoil::cells_for;
use super::spacing::{geometric, geometric_ratio, two_sided};
use crate::block::Block;
use crate::face::{Face, Window};
use crate::topology::{Condition, MultiBlock, Patch, Topology};

/// The floor between x = 0 and x = length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChannelShape {
    /// z = 0.
    Plate,
    /// The middle three fifths of the wall rise as `z = height sin^4(pi s)`, s from 0 to 1 over them. With length 1.5
    /// and height 0.05 this is the bump of the NASA Turbulence Modeling Resource (2DB).
    Bump {
        /// Height of the bump.
        height: f64,
    },
    /// The floor turns up at x = 0.
    Ramp {
        /// By this angle.
        angle_rad: f64,
    },
}

/// A grid over a floor with a symmetry line before (and behind) it. All lengths in one unit.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelGrid {
    /// Shape of the wall.
    pub shape: ChannelShape,
    /// Length of the wall, from x = 0.
    pub length: f64,
    /// Distance before the wall.
    pub upstream: f64,
    /// Distance behind the wall; none for 0.
    pub downstream: f64,
    /// Height of the grid above z = 0.
    pub height: f64,
    /// Cells along the wall.
    pub surface: usize,
    /// Cells before the wall.
    pub before: usize,
    /// Cells behind the wall.
    pub behind: usize,
    /// Cells from floor to top.
    pub normal: usize,
    /// First step off the floor.
    pub wall_spacing: f64,
    /// Step along the wall at its ends.
    pub edge_spacing: f64,
    /// Largest growth ratio allowed from floor to top.
    pub growth_limit: f64,
}

impl ChannelGrid {
    /// Makes the grid: i along x, j up, k across (towards port, over one `length`). Patches: `wall`, `symmetry` (the
    /// floor before and behind), `inflow`, `outflow`, `top`, `left`, `right`. A ramp's wall has its floor before it too.
    /// # Errors
    /// A setting out of range, a growth over the limit.
    pub fn make(&self) -> Result<MultiBlock, GenerateError> {
        self.check()?;
        let growth = geometric_ratio(self.normal, self.wall_spacing, self.height);
        if growth > self.growth_limit {
            return Err(GenerateError::Growth {
                growth,
                limit: self.growth_limit,
                cells: self.normal,
                needed: cells_for(self.wall_spacing, self.height, self.growth_limit),
            });
        }
        let mut x: Vec<f64> = geometric(self.before, self.edge_spacing, self.upstream)
            .into_iter()
            .rev()
            .map(|d| -d)
            .collect();
        let last = match self.shape {
            ChannelShape::Bump { .. } => self.edge_spacing,
            // Plate and ramp end at the outflow, where nothing asks for fine steps.
            _ => self.length / self.surface as f64,
        };
        let wall = two_sided(self.surface, self.edge_spacing / self.length, last / self.length);
        x.extend(wall.into_iter().skip(1).map(|s| s * self.length));
        if self.behind > 0 {
            let tail = geometric(self.behind, self.edge_spacing, self.downstream);
            x.extend(tail.into_iter().skip(1).map(|d| self.length + d));
        }
        let ni = x.len() - 1;
        let columns: Vec<Vec<f64>> = x
            .iter()
            .map(|&x| {
                let floor = self.floor(x);
                let z = geometric(self.normal, self.wall_spacing, self.height - floor);
                z.into_iter().map(|z| floor + z).collect()
            })
            .collect();
        let block = Block::from_fn("floor", [ni, self.normal, 1], |i, j, k| {
            [x[i], self.length * (1.0 - k as f64), columns[i][j]]
        });
        let patch = |name: &str, face: Face, lo: usize, hi: usize, condition: Condition| Patch {
            name: name.into(),
            block: 0,
            face,
            window: if face.axis() == 1 {
                Window::new([lo, 0], [hi, 1])
            } else {
                Window::full(block.face_cells(face))
            },
            condition,
        };
        let (start, end) = (self.before, self.before + self.surface);
        let ramp = matches!(self.shape, ChannelShape::Ramp { .. });
        let floor = if ramp { Condition::Wall } else { Condition::Symmetry };
        let mut patches = vec![
            patch(if ramp { "wall" } else { "symmetry" }, Face::JMin, 0, start, floor),
            patch("wall", Face::JMin, start, end, Condition::Wall),
        ];
        if end < ni {
            patches.push(patch("symmetry", Face::JMin, end, ni, Condition::Symmetry));
        }
        patches.extend([
            patch("top", Face::JMax, 0, ni, Condition::FarField),
            patch("inflow", Face::IMin, 0, 0, Condition::FarField),
            patch("outflow", Face::IMax, 0, 0, Condition::FarField),
            patch("left", Face::KMin, 0, 0, Condition::Symmetry),
            patch("right", Face::KMax, 0, 0, Condition::Symmetry),
        ]);
        Ok(MultiBlock {
            blocks: vec![block],
            topology: Topology {
                interfaces: Vec::new(),
                patches,
            },
        })
    }

    fn floor(&self, x: f64) -> f64 {
        match self.shape {
            ChannelShape::Plate => 0.0,
            ChannelShape::Bump { height } => {
                let s = (x / self.length - 0.2) / 0.6;
                if (0.0..=1.0).contains(&s) {
                    height * (std::f64::consts::PI * s).sin().powi(4)
                } else {
                    0.0
                }
            }
            ChannelShape::Ramp { angle_rad } => x.max(0.0) * angle_rad.tan(),
        }
    }

    fn check(&self) -> Result<(), GenerateError> {
        let mut positive = vec![
            ("length", self.length),
            ("upstream", self.upstream),
            ("far_field", self.height),
            ("wall", self.wall_spacing),
            ("edge", self.edge_spacing),
        ];
        if self.behind > 0 {
            positive.push(("downstream", self.downstream));
        }
        for (name, value) in positive {
            if value.is_nan() || value <= 0.0 || value.is_infinite() {
                return Err(GenerateError::setting(name, "a number above zero", value));
            }
        }
        for (name, value) in [
            ("surface", self.surface),
            ("upstream", self.before),
            ("normal", self.normal),
        ] {
            if value < 2 {
                return Err(GenerateError::setting(name, "at least 2 cells", value));
            }
        }
        let highest = (0..=200)
            .map(|n| self.floor(self.length * f64::from(n) / 200.0))
            .fold(0.0, f64::max);
        if highest.is_nan() || highest > 0.9 * self.height {
            return Err(GenerateError::setting(
                "far_field",
                &format!("more than {:.4}", highest / 0.9),
                self.height,
            ));
        }
        Ok(())
    }
}
