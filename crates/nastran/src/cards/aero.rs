//! Aerodynamics: AERO, AEROS, CAERO1, CAERO2, CAERO4, PAERO1, PAERO4, AEFACT, AELIST, AESURF, SET1.

use crate::{
    error::{DeckError, Location, Severity},
    fields::Card,
};

type Result<T> = std::result::Result<T, DeckError>;

/// Reference quantities of unsteady aerodynamics (AERO).
#[derive(Debug, Clone)]
pub struct Aero {
    /// Aerodynamic coordinate system: its x axis is the flow's direction; 0 is basic.
    pub coordinate: u32,
    /// Velocity for data recovery; no use in flutter.
    pub velocity: f64,
    /// Reference chord: reduced frequencies are omega chord / (2 V).
    pub reference_chord: f64,
    /// Reference density.
    pub reference_density: f64,
    /// +1 symmetric, -1 antisymmetric, 0 none, about the plane y = 0.
    pub symmetry_xz: i64,
    /// +1 symmetric, -1 antisymmetric (ground effect), 0 none, about the plane z = 0.
    pub symmetry_xy: i64,
    /// Where it stands.
    pub at: Location,
}

impl Aero {
    /// `AERO ACSID VELOCITY REFC RHOREF SYMXZ SYMXY`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing, a chord that is not positive.
    pub fn read(card: &Card) -> Result<Self> {
        let reference_chord = card.real(2, "REFC")?;
        if reference_chord <= 0.0 {
            return Err(card.wrong(2, "REFC", "a positive length", ""));
        }
        let symmetry = |index: usize, name: &str| -> Result<i64> {
            match card.int_or(index, name, 0)? {
                s @ -1..=1 => Ok(s),
                _ => Err(card.wrong(index, name, "-1, 0 or 1", "")),
            }
        };
        Ok(Self {
            coordinate: card.id_or(0, "ACSID", 0)?,
            velocity: card.real_or(1, "VELOCITY", 0.0)?,
            reference_chord,
            reference_density: card.real_or(3, "RHOREF", 1.0)?,
            symmetry_xz: symmetry(4, "SYMXZ")?,
            symmetry_xy: symmetry(5, "SYMXY")?,
            at: card.at(),
        })
    }
}

/// Reference quantities of static aeroelasticity (AEROS); of use here only when no AERO card is given elsewhere.
#[derive(Debug, Clone)]
pub struct SteadyAero {
    /// Aerodynamic coordinate system.
    pub coordinate: u32,
    /// Reference coordinate system of the motions.
    pub reference_coordinate: u32,
    /// Reference chord.
    pub reference_chord: f64,
    /// Reference span.
    pub reference_span: f64,
    /// Reference area.
    pub reference_area: f64,
    /// Where it stands.
    pub at: Location,
}

impl SteadyAero {
    /// `AEROS ACSID RCSID REFC REFB REFS SYMXZ SYMXY`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        Ok(Self {
            coordinate: card.id_or(0, "ACSID", 0)?,
            reference_coordinate: card.id_or(1, "RCSID", 0)?,
            reference_chord: card.real(2, "REFC")?,
            reference_span: card.real(3, "REFB")?,
            reference_area: card.real(4, "REFS")?,
            at: card.at(),
        })
    }
}

/// How a panel's edge is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Division {
    /// Into this many equal parts.
    Equal(u32),
    /// At the fractions of this AEFACT list.
    List(u32),
}

/// A panel of the doublet lattice (CAERO1).
#[derive(Debug, Clone)]
pub struct Panel {
    /// Its number, which is also that of its first box.
    pub id: u32,
    /// Its PAERO1.
    pub property: u32,
    /// Coordinate system of the corner points; 0 is basic.
    pub coordinate: u32,
    /// Spanwise division.
    pub spanwise: Division,
    /// Chordwise division.
    pub chordwise: Division,
    /// Interference group: panels of different groups do not feel each other.
    pub group: u32,
    /// Leading edge of the first side, in `coordinate`.
    pub point_1: [f64; 3],
    /// Chord of the first side, along the flow.
    pub chord_12: f64,
    /// Leading edge of the second side.
    pub point_4: [f64; 3],
    /// Chord of the second side.
    pub chord_43: f64,
    /// Where it stands.
    pub at: Location,
}

impl Panel {
    /// `CAERO1 EID PID CP NSPAN NCHORD LSPAN LCHORD IGID / X1 Y1 Z1 X12 X4 Y4 Z4 X43`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing; negative chords.
    pub fn read(card: &Card) -> Result<Self> {
        let division = |number: usize, list: usize, names: [&str; 2]| -> Result<Division> {
            match (card.id_or(number, names[0], 0)?, card.id_or(list, names[1], 0)?) {
                (0, 0) => Err(card.wrong(
                    number,
                    names[0],
                    &format!("a number of divisions here or a list in {}", names[1]),
                    "",
                )),
                (0, list) => Ok(Division::List(list)),
                (n, 0) => Ok(Division::Equal(n)),
                // Nastran takes NSPAN or NCHORD when both stand there.
                (n, _) => {
                    card.note(
                        Severity::Warning,
                        format!("gives both {} and {}; {} is used", names[0], names[1], names[0]),
                    );
                    Ok(Division::Equal(n))
                }
            }
        };
        let chord_12 = card.real_or(11, "X12", 0.0)?;
        let chord_43 = card.real_or(15, "X43", 0.0)?;
        if chord_12 < 0.0 || chord_43 < 0.0 || chord_12 + chord_43 == 0.0 {
            return Err(card.wrong(
                11,
                "X12, X43",
                "chords that are not negative, and one that is positive",
                "",
            ));
        }
        Ok(Self {
            id: card.id(0, "EID")?,
            property: card.id(1, "PID")?,
            coordinate: card.id_or(2, "CP", 0)?,
            spanwise: division(3, 5, ["NSPAN", "LSPAN"])?,
            chordwise: division(4, 6, ["NCHORD", "LCHORD"])?,
            group: card.id_or(7, "IGID", 1)?,
            point_1: card.vector(8, "X1")?,
            chord_12,
            point_4: card.vector(12, "X4")?,
            chord_43,
            at: card.at(),
        })
    }
}

/// The property of lifting-surface panels (PAERO1): the bodies associated with them.
#[derive(Debug, Clone)]
pub struct PanelProperty {
    /// Its number.
    pub id: u32,
    /// Bodies (CAERO2).
    pub bodies: Vec<u32>,
    /// Where it stands.
    pub at: Location,
}

impl PanelProperty {
    /// `PAERO1 PID B1 B2 ... B6`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        let mut bodies = Vec::new();
        for i in 1..card.len() {
            if card.int_or(i, "B", 0)? != 0 {
                bodies.push(card.id(i, "B")?);
            }
        }
        Ok(Self {
            id: card.id(0, "PID")?,
            bodies,
            at: card.at(),
        })
    }
}

/// A slender body (CAERO2): read so that an error can name it.
#[derive(Debug, Clone)]
pub struct Body {
    /// Its number.
    pub id: u32,
    /// Its PAERO2.
    pub property: u32,
    /// Where it stands.
    pub at: Location,
}

impl Body {
    /// `CAERO2 EID PID CP NSB NINT LSB LINT IGID / X1 Y1 Z1 X12`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        Ok(Self {
            id: card.id(0, "EID")?,
            property: card.id(1, "PID")?,
            at: card.at(),
        })
    }
}

/// A panel of strip theory (CAERO4).
#[derive(Debug, Clone)]
pub struct StripPanel {
    /// Its number, which is also that of its first strip.
    pub id: u32,
    /// Its PAERO4.
    pub property: u32,
    /// Coordinate system of the corner points.
    pub coordinate: u32,
    /// Division into strips.
    pub spanwise: Division,
    /// Leading edge of the first side, in `coordinate`.
    pub point_1: [f64; 3],
    /// Chord of the first side.
    pub chord_12: f64,
    /// Leading edge of the second side.
    pub point_4: [f64; 3],
    /// Chord of the second side.
    pub chord_43: f64,
    /// Where it stands.
    pub at: Location,
}

impl StripPanel {
    /// `CAERO4 EID PID CP NSPAN LSPAN / X1 Y1 Z1 X12 X4 Y4 Z4 X43`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        let spanwise = match (card.id_or(3, "NSPAN", 0)?, card.id_or(4, "LSPAN", 0)?) {
            (0, 0) => return Err(card.wrong(3, "NSPAN", "a number of strips here or a list in LSPAN", "")),
            (0, list) => Division::List(list),
            (n, _) => Division::Equal(n),
        };
        Ok(Self {
            id: card.id(0, "EID")?,
            property: card.id(1, "PID")?,
            coordinate: card.id_or(2, "CP", 0)?,
            spanwise,
            point_1: card.vector(8, "X1")?,
            chord_12: card.real(11, "X12")?,
            point_4: card.vector(12, "X4")?,
            chord_43: card.real(15, "X43")?,
            at: card.at(),
        })
    }
}

/// The property of strip-theory panels (PAERO4).
#[derive(Debug, Clone)]
pub struct StripProperty {
    /// Its number.
    pub id: u32,
    /// Compressibility correction of the lift-curve slope: 0 none, -1 Prandtl-Glauert, 1 from the list.
    pub lift_slope_rule: i64,
    /// List of lift-curve slopes (AEFACT), 0 none.
    pub lift_slope_list: u32,
    /// Circulation function: 0 Theodorsen's own, 1 exponential approximation in k, 2 the same with reduced chord.
    pub circulation_rule: i64,
    /// List of the approximation's constants (AEFACT), 0 none.
    pub circulation_list: u32,
    /// For each strip: quarter chord to hinge, control surface chord and gap, over the chord.
    pub control: Vec<[f64; 3]>,
    /// Where it stands.
    pub at: Location,
}

impl StripProperty {
    /// `PAERO4 PID CLA LCLA CIRC LCIRC DOC1 CAOC1 GAPOC1 / DOC2 CAOC2 GAPOC2 ...`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        let mut control = Vec::new();
        let mut i = 5;
        while i < card.len().max(6) {
            control.push(card.vector(i, "DOC, CAOC, GAPOC")?);
            i += 3;
        }
        Ok(Self {
            id: card.id(0, "PID")?,
            lift_slope_rule: card.int_or(1, "CLA", 0)?,
            lift_slope_list: card.id_or(2, "LCLA", 0)?,
            circulation_rule: card.int_or(3, "CIRC", 0)?,
            circulation_list: card.id_or(4, "LCIRC", 0)?,
            control,
            at: card.at(),
        })
    }
}

/// A list of reals (AEFACT).
#[derive(Debug, Clone)]
pub struct RealList {
    /// Its number.
    pub id: u32,
    /// The values.
    pub values: Vec<f64>,
    /// Where it stands.
    pub at: Location,
}

impl RealList {
    /// `AEFACT SID D1 D2 ...`, also with `D1 THRU Dn NF DMID` as on FLFACT
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        Ok(Self {
            id: card.id(0, "SID")?,
            values: crate::cards::control::factors(card, 1)?,
            at: card.at(),
        })
    }
}

/// A list of numbers (AELIST, SET1).
#[derive(Debug, Clone)]
pub struct IdList {
    /// Its number.
    pub id: u32,
    /// The numbers in the card's order.
    pub ids: Vec<u32>,
    /// Whether some came from a THRU range, so that points in it need not exist.
    pub is_range: bool,
    /// Where it stands.
    pub at: Location,
}

impl IdList {
    /// `SET1 SID G1 G2 ...`, `AELIST SID E1 E2 ...`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        let start = if card.text(1) == "SKIN" { 2 } else { 1 };
        let ids = card.ids(start, "G")?;
        if ids.is_empty() {
            return Err(card.wrong(1, "G1", "at least one number", ""));
        }
        let is_range = (1..card.len()).any(|i| card.text(i) == "THRU");
        Ok(Self {
            id: card.id(0, "SID")?,
            ids,
            is_range,
            at: card.at(),
        })
    }
}

/// A control surface (AESURF): named so that an output or a warning can name it; flutter uses its boxes as any others.
#[derive(Debug, Clone)]
pub struct ControlSurface {
    /// Its number.
    pub id: u32,
    /// Its label.
    pub label: String,
    /// Hinge-line coordinate system (y along the hinge) and list of boxes (AELIST), one or two pairs.
    pub parts: Vec<(u32, u32)>,
    /// Where it stands.
    pub at: Location,
}

impl ControlSurface {
    /// `AESURF ID LABEL CID1 ALID1 CID2 ALID2 EFF LDW ...`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        let mut parts = vec![(card.id_or(2, "CID1", 0)?, card.id(3, "ALID1")?)];
        if card.has(5) {
            parts.push((card.id_or(4, "CID2", 0)?, card.id(5, "ALID2")?));
        }
        Ok(Self {
            id: card.id(0, "ID")?,
            label: card.text(1).to_owned(),
            parts,
            at: card.at(),
        })
    }
}
