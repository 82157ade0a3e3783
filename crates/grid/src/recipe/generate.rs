//! From the keys of a recipe to a generator.

use super::file::{Kind, Recipe, SmoothingStart};
use super::{RecipeError, wall_height, wing_file};
use crate::generate::{
    AerofoilGrid, AerofoilKind, BoxGrid, ChannelGrid, ChannelShape, Smoothing, Start, WingCh, WingOo,
};
use crate::topology::MultiBlock;

/// Keys that only some kinds know.
const KEYS: [(&str, &[Kind]); 28] = {
    use Kind::{AerofoilC, AerofoilO, Box, Bump, FlatPlate, Ramp, WingCh, WingOo};
    [
        ("section", &[AerofoilC, AerofoilO]),
        ("wing", &[WingCh, WingOo]),
        ("wing.sheet", &[WingCh]),
        ("shape.length", &[FlatPlate, Bump, Ramp]),
        ("shape.height", &[Bump]),
        ("shape.angle", &[Ramp]),
        ("shape.from", &[Box]),
        ("shape.to", &[Box]),
        ("shape.waviness", &[Box]),
        ("shape.periodic", &[Box]),
        (
            "cells.surface",
            &[AerofoilC, AerofoilO, WingCh, WingOo, FlatPlate, Bump, Ramp],
        ),
        ("cells.wake", &[AerofoilC, WingCh]),
        (
            "cells.normal",
            &[AerofoilC, AerofoilO, WingCh, WingOo, FlatPlate, Bump, Ramp],
        ),
        ("cells.span", &[WingCh, WingOo]),
        ("cells.outboard", &[WingCh]),
        ("cells.base", &[AerofoilC, AerofoilO]),
        ("cells.upstream", &[FlatPlate, Bump, Ramp]),
        ("cells.downstream", &[Bump]),
        ("cells.box", &[Box]),
        ("spacing.nose", &[AerofoilC, AerofoilO, WingCh, WingOo]),
        ("spacing.tail", &[AerofoilC, AerofoilO, WingCh, WingOo]),
        ("spacing.root", &[WingCh, WingOo]),
        ("spacing.tip", &[WingCh, WingOo]),
        ("spacing.edge", &[FlatPlate, Bump, Ramp]),
        ("spacing.wake_growth", &[AerofoilC, WingCh]),
        ("extent.exit", &[WingCh]),
        ("extent.downstream", &[Bump]),
        ("smoothing", &[AerofoilC, AerofoilO, WingCh, WingOo]),
    ]
};

impl Recipe {
    fn key(&self, message: impl Into<String>) -> RecipeError {
        RecipeError::Key {
            path: self.path.clone(),
            message: message.into(),
        }
    }

    fn given(&self, key: &str) -> bool {
        let shape = self.shape.clone().unwrap_or_default();
        match key {
            "section" => self.section.is_some(),
            "wing" => self.wing.is_some(),
            "wing.sheet" => self.wing.as_ref().is_some_and(|w| w.sheet.is_some()),
            "shape.length" => shape.length.is_some(),
            "shape.height" => shape.height.is_some(),
            "shape.angle" => shape.angle.is_some(),
            "shape.from" => shape.from.is_some(),
            "shape.to" => shape.to.is_some(),
            "shape.waviness" => shape.waviness.is_some(),
            "shape.periodic" => shape.periodic.is_some(),
            "cells.surface" => self.cells.surface.is_some(),
            "cells.wake" => self.cells.wake.is_some(),
            "cells.normal" => self.cells.normal.is_some(),
            "cells.span" => self.cells.span.is_some(),
            "cells.outboard" => self.cells.outboard.is_some(),
            "cells.base" => self.cells.base.is_some(),
            "cells.upstream" => self.cells.upstream.is_some(),
            "cells.downstream" => self.cells.downstream.is_some(),
            "cells.box" => self.cells.r#box.is_some(),
            "spacing.nose" => self.spacing.nose.is_some(),
            "spacing.tail" => self.spacing.tail.is_some(),
            "spacing.root" => self.spacing.root.is_some(),
            "spacing.tip" => self.spacing.tip.is_some(),
            "spacing.edge" => self.spacing.edge.is_some(),
            "spacing.wake_growth" => self.spacing.wake_growth.is_some(),
            "extent.exit" => self.extent.exit.is_some(),
            "extent.downstream" => self.extent.downstream.is_some(),
            "smoothing" => self.smoothing.is_some(),
            _ => false,
        }
    }

    /// The grid before it is split, and how often it is still to be coarsened.
    pub(super) fn generate(&self) -> Result<(MultiBlock, u32), RecipeError> {
        let Some(kind) = self.kind else {
            return Err(
                self.key("kind is needed: aerofoil-c, aerofoil-o, wing-ch, wing-oo, flat-plate, bump, ramp or box")
            );
        };
        for (key, kinds) in KEYS {
            if self.given(key) && !kinds.contains(&kind) {
                let who: Vec<&str> = kinds.iter().map(|k| k.name()).collect();
                return Err(self.key(format!(
                    "{key} does not go with kind \"{}\", only with {}",
                    kind.name(),
                    who.join(", ")
                )));
            }
        }
        self.check_size()?;
        let smoothing = self.smoothing()?;
        let made = match kind {
            Kind::AerofoilC => self.aerofoil(AerofoilKind::C)?.make_smoothed(smoothing),
            Kind::AerofoilO => self.aerofoil(AerofoilKind::O)?.make_smoothed(smoothing),
            Kind::WingCh => self.wing_ch()?.make_smoothed(smoothing),
            Kind::WingOo => self.wing_oo()?.make_smoothed(smoothing),
            Kind::FlatPlate | Kind::Bump | Kind::Ramp => self.channel(kind)?.make(),
            Kind::Box => return Ok((self.plain_box()?, self.coarsen.unwrap_or(0))),
        };
        let left = match kind {
            // What was smoothed as a whole keeps its points; else wings make the coarser level at once.
            Kind::WingCh | Kind::WingOo if self.smoothing.is_none() => 0,
            _ => self.coarsen.unwrap_or(0),
        };
        made.map(|grid| (grid, left)).map_err(|source| RecipeError::Generate {
            path: self.path.clone(),
            source,
        })
    }

    /// A slip of the finger must not ask for all memory: before anything is allocated.
    fn check_size(&self) -> Result<(), RecipeError> {
        const MOST: f64 = 1e9;
        let count = |n: Option<usize>| n.map_or(0.0, |n| n as f64);
        let c = &self.cells;
        let around = 2.0 * count(c.surface) + 2.0 * count(c.wake) + count(c.upstream) + count(c.downstream);
        let along = (count(c.span) + count(c.outboard)).max(1.0);
        let nodes = around.max(1.0) * (count(c.normal) + count(c.base)).max(1.0) * along;
        let boxed = c.r#box.map_or(0.0, |n| n.iter().map(|&n| n as f64).product());
        let most = nodes.max(boxed);
        if most > MOST {
            return Err(self.key(format!(
                "cells: about {most:.1e} cells are asked for; at most {MOST:.0e} can be made"
            )));
        }
        if self.blocks.is_some_and(|n| n == 0 || n > 100_000) {
            return Err(self.key("blocks: 1 to 100000 are possible"));
        }
        Ok(())
    }

    fn need<T: Copy>(&self, value: Option<T>, key: &str) -> Result<T, RecipeError> {
        value.ok_or_else(|| {
            let kind = self.kind.map_or("", Kind::name);
            self.key(format!("{key} is needed for kind \"{kind}\""))
        })
    }

    fn wall(&self) -> Result<f64, RecipeError> {
        match (self.spacing.wall, self.spacing.y_plus) {
            (Some(length), None) => Ok(length.0),
            (None, Some(y)) => Ok(wall_height(y.value, y.reynolds, y.length.0)),
            _ => Err(self.key("either spacing.wall or spacing.y_plus is needed")),
        }
    }

    /// Wings make the coarser level at once, of the same nodes.
    fn stride(&self) -> Result<usize, RecipeError> {
        let times = self.coarsen.unwrap_or(0);
        if times > 6 {
            return Err(self.key(format!("coarsen: at most 6 times, got {times}")));
        }
        Ok(1 << times)
    }

    fn smoothing(&self) -> Result<Option<Smoothing>, RecipeError> {
        const MOST: usize = 100_000;
        let Some(table) = self.smoothing else { return Ok(None) };
        let sweeps = table.sweeps.unwrap_or(200);
        if sweeps > MOST {
            return Err(self.key(format!("smoothing.sweeps: at most {MOST} are possible, got {sweeps}")));
        }
        let start = match table.start {
            SmoothingStart::Map => Start::Map,
            SmoothingStart::Transfinite => Start::Transfinite,
        };
        Ok(Some(Smoothing { start, sweeps }))
    }

    fn growth_limit(&self) -> f64 {
        self.spacing.growth_limit.unwrap_or(2.0)
    }

    fn aerofoil(&self, kind: AerofoilKind) -> Result<AerofoilGrid, RecipeError> {
        let source = self.section.clone().ok_or_else(|| self.key("a [section] is needed"))?;
        let chord = source.chord.map_or(1.0, |c| c.0);
        if chord <= 0.0 {
            return Err(self.key(format!("section.chord: a length above zero is needed, got {chord} m")));
        }
        Ok(AerofoilGrid {
            kind,
            section: wing_file::section(&self.path, &source)?,
            chord,
            surface: self.need(self.cells.surface, "cells.surface")?,
            wake: if kind == AerofoilKind::C {
                self.need(self.cells.wake, "cells.wake")?
            } else {
                0
            },
            normal: self.need(self.cells.normal, "cells.normal")?,
            base: self.cells.base.unwrap_or(8),
            wall_spacing: self.wall()? / chord,
            nose_spacing: self.need(self.spacing.nose, "spacing.nose")?,
            tail_spacing: self.need(self.spacing.tail, "spacing.tail")?,
            far_field: self.need(self.extent.far_field, "extent.far_field")?.0 / chord,
            wake_growth: self.spacing.wake_growth.unwrap_or(1.0),
            growth_limit: self.growth_limit(),
        })
    }

    fn wing_ch(&self) -> Result<WingCh, RecipeError> {
        let source = self.wing.clone().ok_or_else(|| self.key("a [wing] is needed"))?;
        Ok(WingCh {
            wing: wing_file::wing(&self.path, &source)?,
            surface: self.need(self.cells.surface, "cells.surface")?,
            wake: self.need(self.cells.wake, "cells.wake")?,
            normal: self.need(self.cells.normal, "cells.normal")?,
            span: self.need(self.cells.span, "cells.span")?,
            outboard: self.need(self.cells.outboard, "cells.outboard")?,
            wall_spacing: self.wall()?,
            nose_spacing: self.need(self.spacing.nose, "spacing.nose")?,
            tail_spacing: self.need(self.spacing.tail, "spacing.tail")?,
            root_spacing: self.need(self.spacing.root, "spacing.root")?.0,
            tip_spacing: self.need(self.spacing.tip, "spacing.tip")?.0,
            far_field: self.need(self.extent.far_field, "extent.far_field")?.0,
            exit: self.need(self.extent.exit, "extent.exit")?.0,
            wake_growth: self.spacing.wake_growth.unwrap_or(1.0),
            straight_sheet: match source.sheet.as_deref() {
                None | Some("straight") => true,
                Some("camber") => false,
                Some(other) => {
                    return Err(self.key(format!("wing.sheet: straight or camber is needed, got \"{other}\"")));
                }
            },
            growth_limit: self.growth_limit(),
            stride: if self.smoothing.is_some() { 1 } else { self.stride()? },
        })
    }

    fn wing_oo(&self) -> Result<WingOo, RecipeError> {
        let source = self.wing.clone().ok_or_else(|| self.key("a [wing] is needed"))?;
        Ok(WingOo {
            wing: wing_file::wing(&self.path, &source)?,
            surface: self.need(self.cells.surface, "cells.surface")?,
            normal: self.need(self.cells.normal, "cells.normal")?,
            span: self.need(self.cells.span, "cells.span")?,
            wall_spacing: self.wall()?,
            nose_spacing: self.need(self.spacing.nose, "spacing.nose")?,
            tail_spacing: self.need(self.spacing.tail, "spacing.tail")?,
            root_spacing: self.need(self.spacing.root, "spacing.root")?.0,
            tip_spacing: self.need(self.spacing.tip, "spacing.tip")?.0,
            far_field: self.need(self.extent.far_field, "extent.far_field")?.0,
            growth_limit: self.growth_limit(),
            stride: if self.smoothing.is_some() { 1 } else { self.stride()? },
        })
    }

    fn channel(&self, kind: Kind) -> Result<ChannelGrid, RecipeError> {
        let shape = self.shape.clone().unwrap_or_default();
        let length = self.need(shape.length, "shape.length")?.0;
        let wall = match kind {
            Kind::Bump => ChannelShape::Bump {
                height: self.need(shape.height, "shape.height")?.0,
            },
            Kind::Ramp => ChannelShape::Ramp {
                angle_rad: self.need(shape.angle, "shape.angle")?.0,
            },
            _ => ChannelShape::Plate,
        };
        Ok(ChannelGrid {
            shape: wall,
            length,
            upstream: self.need(self.extent.upstream, "extent.upstream")?.0,
            downstream: if kind == Kind::Bump {
                self.need(self.extent.downstream, "extent.downstream")?.0
            } else {
                0.0
            },
            height: self.need(self.extent.far_field, "extent.far_field")?.0,
            surface: self.need(self.cells.surface, "cells.surface")?,
            before: self.need(self.cells.upstream, "cells.upstream")?,
            behind: if kind == Kind::Bump {
                self.need(self.cells.downstream, "cells.downstream")?
            } else {
                0
            },
            normal: self.need(self.cells.normal, "cells.normal")?,
            wall_spacing: self.wall()?,
            edge_spacing: self.need(self.spacing.edge, "spacing.edge")?.0,
            growth_limit: self.growth_limit(),
        })
    }

    fn plain_box(&self) -> Result<MultiBlock, RecipeError> {
        let shape = self.shape.clone().unwrap_or_default();
        let from = self.need(shape.from, "shape.from")?.map(|l| l.0);
        let to = self.need(shape.to, "shape.to")?.map(|l| l.0);
        let cells = self.need(self.cells.r#box, "cells.box")?;
        if (0..3).any(|d| !to[d].is_finite() || !from[d].is_finite() || to[d] <= from[d]) || cells.contains(&0) {
            return Err(self.key("a box needs shape.to above shape.from in x, y and z, and at least one cell each way"));
        }
        let waviness = shape.waviness.unwrap_or(0.0);
        if !(0.0..=0.1).contains(&waviness) {
            return Err(self.key(format!("shape.waviness: 0 to 0.1 is needed, got {waviness}")));
        }
        Ok(BoxGrid::new(from, to, cells)
            .wavy(waviness)
            .periodic(shape.periodic.unwrap_or_default())
            .make())
    }
}
