//! Coordinate systems: chains of CORD2x and CORD1x resolved to the basic system.

use std::collections::{BTreeMap, BTreeSet};

use dip_nastran::{
    bulk::Bulk,
    cards::geometry::{Coordinate, CoordinateKind, CoordinatePoints, Grid},
};
use nalgebra::{Matrix3, Vector3};

use crate::error::{Result, SolveError, misfit, missing};

/// A coordinate system in basic coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Origin.
    pub origin: Vector3<f64>,
    /// Columns are the unit vectors of the system's rectangular axes.
    pub axes: Matrix3<f64>,
    /// How its coordinates measure.
    pub kind: CoordinateKind,
}

impl Frame {
    /// The basic system itself.
    pub const BASIC: Self = Self {
        origin: Vector3::new(0.0, 0.0, 0.0),
        axes: Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        kind: CoordinateKind::Rectangular,
    };

    /// Basic position of a point given in this system (angles in degrees).
    pub fn position(&self, c: [f64; 3]) -> Vector3<f64> {
        let local = match self.kind {
            CoordinateKind::Rectangular => Vector3::from(c),
            CoordinateKind::Cylindrical => {
                let (sin, cos) = c[1].to_radians().sin_cos();
                Vector3::new(c[0] * cos, c[0] * sin, c[2])
            }
            CoordinateKind::Spherical => {
                let ((st, ct), (sp, cp)) = (c[1].to_radians().sin_cos(), c[2].to_radians().sin_cos());
                Vector3::new(c[0] * st * cp, c[0] * st * sp, c[0] * ct)
            }
        };
        self.origin + self.axes * local
    }

    /// Unit vectors of the coordinate directions at a point given in basic coordinates, as columns in basic axes. On the
    /// polar axis, where they are not defined, those of the rectangular axes.
    pub fn directions(&self, at: Vector3<f64>) -> Matrix3<f64> {
        let r = self.axes.transpose() * (at - self.origin);
        let radius = r.x.hypot(r.y);
        if self.kind == CoordinateKind::Rectangular || radius <= 1e-12 * r.norm() || radius == 0.0 {
            return self.axes;
        }
        let (cos, sin) = (r.x / radius, r.y / radius);
        let around = Vector3::new(-sin, cos, 0.0);
        let local = match self.kind {
            CoordinateKind::Cylindrical => {
                Matrix3::from_columns(&[Vector3::new(cos, sin, 0.0), around, Vector3::new(0.0, 0.0, 1.0)])
            }
            _ => {
                let out = r.normalize();
                Matrix3::from_columns(&[out, around.cross(&out), around])
            }
        };
        self.axes * local
    }
}

/// All coordinate systems and grid points of a deck in basic coordinates.
#[derive(Debug, Clone)]
pub struct Geometry {
    frames: BTreeMap<u32, Frame>,
    positions: BTreeMap<u32, Vector3<f64>>,
}

impl Geometry {
    /// Resolves every system and every grid point.
    ///
    /// # Errors
    /// Systems or points that do not exist, circles, points on one line.
    pub fn new(bulk: &Bulk) -> Result<Self> {
        let mut resolver = Resolver {
            bulk,
            frames: BTreeMap::new(),
            open: BTreeSet::new(),
        };
        resolver.frames.insert(0, Frame::BASIC);
        for system in bulk.coordinates.values() {
            resolver.frame_of(system)?;
        }
        let mut positions = BTreeMap::new();
        for grid in bulk.grids.values() {
            positions.insert(grid.id, resolver.position(grid)?);
        }
        Ok(Self {
            frames: resolver.frames,
            positions,
        })
    }

    /// A coordinate system by its number.
    pub fn frame(&self, id: u32) -> Option<&Frame> {
        self.frames.get(&id)
    }

    /// Basic position of a grid point.
    pub fn grid(&self, id: u32) -> Option<Vector3<f64>> {
        self.positions.get(&id).copied()
    }
}

struct Resolver<'a> {
    bulk: &'a Bulk,
    frames: BTreeMap<u32, Frame>,
    /// Systems on the way from the one that was asked for.
    open: BTreeSet<u32>,
}

impl Resolver<'_> {
    fn frame_of(&mut self, system: &Coordinate) -> Result<Frame> {
        if let Some(frame) = self.frames.get(&system.id) {
            return Ok(*frame);
        }
        let card = || format!("coordinate system {}", system.id);
        if !self.open.insert(system.id) {
            return Err(misfit(
                &system.at,
                card(),
                "is defined by itself, directly or through others; break the circle",
            ));
        }
        let [a, b, c] = match &system.points {
            CoordinatePoints::Coordinates { reference, points } => {
                let bulk = self.bulk;
                let base = match (self.frames.get(reference), bulk.coordinates.get(reference)) {
                    (Some(frame), _) => *frame,
                    (None, Some(other)) => self.frame_of(other)?,
                    (None, None) => return Err(missing(&system.at, card(), "coordinate system", *reference)),
                };
                points.map(|p| base.position(p))
            }
            CoordinatePoints::Grids(ids) => {
                let bulk = self.bulk;
                let mut points = [Vector3::zeros(); 3];
                for (point, id) in points.iter_mut().zip(ids) {
                    let grid = bulk
                        .grids
                        .get(id)
                        .ok_or_else(|| missing(&system.at, card(), "GRID", *id))?;
                    *point = self.position(grid)?;
                }
                points
            }
        };
        let (up, plane) = (b - a, c - a);
        let side = up.cross(&plane);
        let size = up.norm() * plane.norm();
        if side.norm() <= 1e-9 * size || !size.is_finite() {
            return Err(misfit(&system.at, card(), "its three points must not lie on one line"));
        }
        let z = up.normalize();
        let y = side.normalize();
        let axes = Matrix3::from_columns(&[y.cross(&z), y, z]);
        let frame = Frame {
            origin: a,
            axes,
            kind: system.kind,
        };
        self.open.remove(&system.id);
        self.frames.insert(system.id, frame);
        Ok(frame)
    }

    fn position(&mut self, grid: &Grid) -> Result<Vector3<f64>> {
        let bulk = self.bulk;
        let frame = match (self.frames.get(&grid.cp), bulk.coordinates.get(&grid.cp)) {
            (Some(frame), _) => *frame,
            (None, Some(system)) => self.frame_of(system)?,
            (None, None) => {
                return Err(missing(
                    &grid.at,
                    format!("GRID {}", grid.id),
                    "coordinate system",
                    grid.cp,
                ));
            }
        };
        let position = frame.position(grid.position);
        if position.iter().all(|x| x.is_finite()) {
            Ok(position)
        } else {
            Err(SolveError::Card {
                at: grid.at.clone(),
                card: format!("GRID {}", grid.id),
                what: "its position is not a finite number".to_owned(),
            })
        }
    }
}
