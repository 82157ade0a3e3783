//! Splines: SPLINE1, SPLINE2, SPLINE4, SPLINE5.

use crate::{
    error::{DeckError, Location},
    fields::Card,
};

type Result<T> = std::result::Result<T, DeckError>;

/// The boxes that a spline moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SplineBoxes {
    /// The boxes of the rectangle of a panel whose first and last corner have these numbers.
    Range(u32, u32),
    /// The boxes of an AELIST.
    List(u32),
}

/// What a spline carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SplineUsage {
    /// Forces and displacements.
    Both,
    /// Forces only.
    Force,
    /// Displacements only.
    Displacement,
}

fn usage(card: &Card, index: usize) -> Result<SplineUsage> {
    match card.text(index) {
        "" | "BOTH" => Ok(SplineUsage::Both),
        "FORCE" => Ok(SplineUsage::Force),
        "DISP" => Ok(SplineUsage::Displacement),
        _ => Err(card.wrong(index, "USAGE", "BOTH, FORCE or DISP", "")),
    }
}

/// How a surface spline interpolates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SurfaceSplineMethod {
    /// Harder and Desmarais's infinite plate.
    InfinitePlate,
    /// Thin plate in three dimensions.
    ThinPlate,
    /// Finite plate elements.
    FinitePlate,
}

/// A surface spline (SPLINE1, SPLINE4).
#[derive(Debug, Clone)]
pub struct SurfaceSpline {
    /// Its number.
    pub id: u32,
    /// The panel it belongs to.
    pub panel: u32,
    /// Its boxes.
    pub boxes: SplineBoxes,
    /// The structure's points (SET1).
    pub set: u32,
    /// Linear attachment flexibility.
    pub dz: f64,
    /// Method.
    pub method: SurfaceSplineMethod,
    /// What it carries.
    pub usage: SplineUsage,
    /// Where it stands.
    pub at: Location,
}

impl SurfaceSpline {
    /// `SPLINE1 EID CAERO BOX1 BOX2 SETG DZ METH USAGE`, `SPLINE4 EID CAERO AELIST . SETG DZ METH USAGE`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        let boxes = if card.name() == "SPLINE4" {
            SplineBoxes::List(card.id(2, "AELIST")?)
        } else {
            SplineBoxes::Range(card.id(2, "BOX1")?, card.id(3, "BOX2")?)
        };
        Ok(Self {
            id: card.id(0, "EID")?,
            panel: card.id(1, "CAERO")?,
            boxes,
            set: card.id(4, "SETG")?,
            dz: card.real_or(5, "DZ", 0.0)?,
            method: match card.text(6) {
                "" | "IPS" => SurfaceSplineMethod::InfinitePlate,
                "TPS" => SurfaceSplineMethod::ThinPlate,
                "FPS" => SurfaceSplineMethod::FinitePlate,
                _ => return Err(card.wrong(6, "METH", "IPS, TPS or FPS", "")),
            },
            usage: usage(card, 7)?,
            at: card.at(),
        })
    }
}

/// A beam spline (SPLINE2, SPLINE5).
#[derive(Debug, Clone)]
pub struct BeamSpline {
    /// Its number.
    pub id: u32,
    /// The panel it belongs to.
    pub panel: u32,
    /// Its boxes.
    pub boxes: SplineBoxes,
    /// The structure's points (SET1).
    pub set: u32,
    /// Linear attachment flexibility.
    pub dz: f64,
    /// Torsional flexibility ratio EI / GJ.
    pub dtor: f64,
    /// Coordinate system whose y axis is the spline's axis; 0 is basic.
    pub coordinate: u32,
    /// Rotational attachment flexibility about the spline's x axis (slope of bending); negative means not attached.
    pub dthx: f64,
    /// Rotational attachment flexibility about the spline's y axis (twist); negative means not attached.
    pub dthy: f64,
    /// What it carries.
    pub usage: SplineUsage,
    /// Where it stands.
    pub at: Location,
}

impl BeamSpline {
    /// `SPLINE2 EID CAERO ID1 ID2 SETG DZ DTOR CID / DTHX DTHY . USAGE`, `SPLINE5 EID CAERO AELIST . SETG DZ DTOR CID / DTHX DTHY . USAGE`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        let boxes = if card.name() == "SPLINE5" {
            SplineBoxes::List(card.id(2, "AELIST")?)
        } else {
            SplineBoxes::Range(card.id(2, "ID1")?, card.id(3, "ID2")?)
        };
        Ok(Self {
            id: card.id(0, "EID")?,
            panel: card.id(1, "CAERO")?,
            boxes,
            set: card.id(4, "SETG")?,
            dz: card.real_or(5, "DZ", 0.0)?,
            dtor: card.real_or(6, "DTOR", 1.0)?,
            coordinate: card.id_or(7, "CID", 0)?,
            dthx: card.real_or(8, "DTHX", 0.0)?,
            dthy: card.real_or(9, "DTHY", 0.0)?,
            usage: usage(card, 11)?,
            at: card.at(),
        })
    }
}
