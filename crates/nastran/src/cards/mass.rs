//! Concentrated masses: CONM1 and CONM2.

use crate::{
    error::{DeckError, Location},
    fields::Card,
};

type Result<T> = std::result::Result<T, DeckError>;

/// A 6 x 6 mass matrix at a grid point (CONM1).
#[derive(Debug, Clone)]
pub struct MassMatrix {
    /// Its number.
    pub id: u32,
    /// Its point.
    pub grid: u32,
    /// Coordinate system of the matrix; 0 is basic.
    pub coordinate: u32,
    /// `[row][column]`, symmetric.
    pub matrix: [[f64; 6]; 6],
    /// Where it stands.
    pub at: Location,
}

impl MassMatrix {
    /// `CONM1 EID G CID M11 M21 M22 M31 M32 / M33 M41 ... M66`: the lower triangle by rows
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        let mut matrix = [[0.0; 6]; 6];
        let places = (0..6).flat_map(|row| (0..=row).map(move |column| (row, column)));
        for (index, (row, column)) in places.enumerate() {
            let value = card.real_or(3 + index, "M", 0.0)?;
            matrix[row][column] = value;
            matrix[column][row] = value;
        }
        Ok(Self {
            id: card.id(0, "EID")?,
            grid: card.id(1, "G")?,
            coordinate: card.id_or(2, "CID", 0)?,
            matrix,
            at: card.at(),
        })
    }
}

/// Where the centre of a CONM2 is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MassSystem {
    /// Offset from the point in this coordinate system; 0 is basic.
    Coordinate(u32),
    /// The centre's own position in basic coordinates (CID = -1).
    BasicPosition,
}

/// A rigid body at a grid point (CONM2).
#[derive(Debug, Clone)]
pub struct PointMass {
    /// Its number.
    pub id: u32,
    /// Its point.
    pub grid: u32,
    /// How `centre` and `inertia` are to be read.
    pub system: MassSystem,
    /// The mass.
    pub mass: f64,
    /// Centre of mass: offset or position.
    pub centre: [f64; 3],
    /// Moments and products about the centre: I11, I21, I22, I31, I32, I33 with positive products (integral of x y dm).
    pub inertia: [f64; 6],
    /// Where it stands.
    pub at: Location,
}

impl PointMass {
    /// `CONM2 EID G CID M X1 X2 X3 . / I11 I21 I22 I31 I32 I33`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        let system = match card.int_or(2, "CID", 0)? {
            -1 => MassSystem::BasicPosition,
            _ => MassSystem::Coordinate(card.id_or(2, "CID", 0)?),
        };
        let mut inertia = [0.0; 6];
        for (i, (value, name)) in inertia
            .iter_mut()
            .zip(["I11", "I21", "I22", "I31", "I32", "I33"])
            .enumerate()
        {
            *value = card.real_or(8 + i, name, 0.0)?;
        }
        Ok(Self {
            id: card.id(0, "EID")?,
            grid: card.id(1, "G")?,
            system,
            mass: card.real_or(3, "M", 0.0)?,
            centre: card.vector(4, "X")?,
            inertia,
            at: card.at(),
        })
    }
}
