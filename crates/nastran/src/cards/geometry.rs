//! Points and coordinate systems: GRID, GRDSET, SPOINT, CORD1x, CORD2x.

use crate::{
    error::{DeckError, Location},
    fields::{Card, Components},
};

type Result<T> = std::result::Result<T, DeckError>;

/// A grid point.
#[derive(Debug, Clone)]
pub struct Grid {
    /// Its number.
    pub id: u32,
    /// Coordinate system of its position; 0 is basic.
    pub cp: u32,
    /// Position in that system: x, y, z, or r, theta in degrees, z, or rho, theta, phi.
    pub position: [f64; 3],
    /// Coordinate system of its displacements; 0 is basic.
    pub cd: u32,
    /// Permanent single-point constraints.
    pub ps: Components,
    /// Where it stands.
    pub at: Location,
}

/// Defaults of the GRID cards.
#[derive(Debug, Clone, Default)]
pub struct GridDefaults {
    /// CP.
    pub cp: u32,
    /// CD.
    pub cd: u32,
    /// PS.
    pub ps: Components,
}

impl GridDefaults {
    /// `GRDSET . CP . . . CD PS SEID`
    ///
    /// # Errors
    /// Fields of the wrong kind.
    pub fn read(card: &Card) -> Result<Self> {
        Ok(Self {
            cp: card.id_or(1, "CP", 0)?,
            cd: card.id_or(5, "CD", 0)?,
            ps: card.components(6, "PS")?,
        })
    }
}

impl Grid {
    /// `GRID ID CP X1 X2 X3 CD PS SEID`
    ///
    /// # Errors
    /// Fields of the wrong kind; a superelement number.
    pub fn read(card: &Card, default: &GridDefaults) -> Result<Self> {
        if card.int_or(7, "SEID", 0)? != 0 {
            return Err(card.unsupported("superelements; clear field 9 (SEID)"));
        }
        Ok(Self {
            id: card.id(0, "ID")?,
            cp: card.id_or(1, "CP", default.cp)?,
            position: card.vector(2, "X")?,
            // CD = -1 makes the point a fluid point.
            cd: card.id_or(5, "CD", default.cd)?,
            ps: if card.has(6) {
                card.components(6, "PS")?
            } else {
                default.ps
            },
            at: card.at(),
        })
    }
}

/// How the axes of a coordinate system measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CoordinateKind {
    /// x, y, z.
    Rectangular,
    /// r, theta in degrees, z.
    Cylindrical,
    /// rho, theta (from the z axis) and phi in degrees.
    Spherical,
}

/// The three points that define a coordinate system: origin, a point on the z axis, a point in the x-z plane.
#[derive(Debug, Clone)]
pub enum CoordinatePoints {
    /// CORD2x: coordinates in another system.
    Coordinates {
        /// The system of the points; 0 is basic.
        reference: u32,
        /// Origin, point on z, point in the x-z plane.
        points: [[f64; 3]; 3],
    },
    /// CORD1x: grid points.
    Grids([u32; 3]),
}

/// A coordinate system.
#[derive(Debug, Clone)]
pub struct Coordinate {
    /// Its number.
    pub id: u32,
    /// Its kind.
    pub kind: CoordinateKind,
    /// What defines it.
    pub points: CoordinatePoints,
    /// Where it stands.
    pub at: Location,
}

impl Coordinate {
    /// `CORD2x CID RID A1 A2 A3 B1 B2 B3 / C1 C2 C3`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read_by_points(card: &Card, kind: CoordinateKind) -> Result<Self> {
        Ok(Self {
            id: card.id(0, "CID")?,
            kind,
            points: CoordinatePoints::Coordinates {
                reference: card.id_or(1, "RID", 0)?,
                points: [card.vector(2, "A")?, card.vector(5, "B")?, card.vector(8, "C")?],
            },
            at: card.at(),
        })
    }

    /// `CORD1x CIDA G1A G2A G3A CIDB G1B G2B G3B`: one or two systems.
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read_by_grids(card: &Card, kind: CoordinateKind) -> Result<Vec<Self>> {
        let mut found = Vec::new();
        for start in [0, 4] {
            if start > 0 && (start..start + 4).all(|i| !card.has(i)) {
                continue;
            }
            found.push(Self {
                id: card.id(start, "CID")?,
                kind,
                points: CoordinatePoints::Grids([
                    card.id(start + 1, "G1")?,
                    card.id(start + 2, "G2")?,
                    card.id(start + 3, "G3")?,
                ]),
                at: card.at(),
            });
        }
        Ok(found)
    }
}
