//! Elastic elements: CBAR, CBEAM, CROD, CONROD, CQUAD4, CTRIA3, scalar springs, masses and dampers, GENEL.

use crate::{
    error::{DeckError, Location, Severity},
    fields::{Card, Dof},
};

type Result<T> = std::result::Result<T, DeckError>;

/// What points a bar's plane 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Orientation {
    /// A vector in the displacement system of end A.
    Vector([f64; 3]),
    /// A vector in the basic system (OFFT begins with B).
    BasicVector([f64; 3]),
    /// From end A to this grid point.
    Grid(u32),
}

/// A straight bar or beam of constant section.
#[derive(Debug, Clone)]
pub struct Bar {
    /// Its number.
    pub id: u32,
    /// Its property.
    pub property: u32,
    /// Ends A and B.
    pub grids: [u32; 2],
    /// Direction of plane 1.
    pub orientation: Orientation,
    /// Offsets of the ends from the grid points, in the points' displacement systems.
    pub offsets: [[f64; 3]; 2],
    /// Freed components (pin flags) at the ends, in the bar's own axes, as digits 1 to 6.
    pub pins: [crate::fields::Components; 2],
    /// Whether it stands on a CBEAM.
    pub is_beam: bool,
    /// Where it stands.
    pub at: Location,
}

/// Defaults of the CBAR cards.
#[derive(Debug, Clone, Default)]
pub struct BarDefaults {
    property: Option<u32>,
    orientation: Option<Orientation>,
}

impl BarDefaults {
    /// `BAROR . PID . . X1 X2 X3 OFFT` (also BEAMOR)
    ///
    /// # Errors
    /// Fields of the wrong kind.
    pub fn read(card: &Card) -> Result<Self> {
        Ok(Self {
            property: card.id_opt(1, "PID")?,
            orientation: orientation(card)?,
        })
    }
}

/// Fields 6 to 9 of CBAR, CBEAM, BAROR and BEAMOR: a vector or a point, and OFFT (an integer 1 or 2 in old decks).
fn orientation(card: &Card) -> Result<Option<Orientation>> {
    let flag = card.text(7);
    let basic = match flag {
        "" | "GGG" | "GGO" | "GOG" | "GOO" | "1" | "2" => false,
        "BGG" | "BGO" | "BOG" | "BOO" => true,
        _ if flag.parse::<f64>().is_ok() => {
            return Err(card.wrong(7, "OFFT", "GGG, BGG or an integer 1 or 2", ""));
        }
        _ => return Err(card.wrong(7, "OFFT", "GGG or BGG", "offsets along the element are not supported")),
    };
    if (4..7).all(|i| !card.has(i)) {
        return Ok(None);
    }
    let is_point = flag == "2" || (card.text(4).parse::<u32>().is_ok() && !card.has(5) && !card.has(6) && flag != "1");
    if is_point {
        return Ok(Some(Orientation::Grid(card.id(4, "G0")?)));
    }
    let vector = card.vector(4, "X")?;
    Ok(Some(if basic {
        Orientation::BasicVector(vector)
    } else {
        Orientation::Vector(vector)
    }))
}

impl Bar {
    /// `CBAR EID PID GA GB X1 X2 X3 OFFT / PA PB W1A W2A W3A W1B W2B W3B`, CBEAM likewise
    ///
    /// # Errors
    /// Fields of the wrong kind or missing; offset flags other than GGG and BGG.
    pub fn read(card: &Card, default: &BarDefaults) -> Result<Self> {
        let id = card.id(0, "EID")?;
        let is_beam = card.name() == "CBEAM";
        let offt = card.text(7);
        if matches!(offt, "GGO" | "GOG" | "GOO" | "BGO" | "BOG" | "BOO") && (10..16).any(|i| card.has(i)) {
            return Err(
                card.unsupported("offsets in element coordinates (OFFT with O); give them in the points' systems")
            );
        }
        if is_beam && (card.has(16) || card.has(17)) {
            return Err(card.unsupported("warping points SA and SB; clear them"));
        }
        Ok(Self {
            id,
            property: card.id_opt(1, "PID")?.or(default.property).unwrap_or(id),
            grids: [card.id(2, "GA")?, card.id(3, "GB")?],
            orientation: orientation(card)?.or(default.orientation).ok_or_else(|| {
                card.wrong(
                    4,
                    "X1 or G0",
                    "an orientation vector or point",
                    "give X1, X2, X3 or G0 here or on BAROR",
                )
            })?,
            offsets: [card.vector(10, "WA")?, card.vector(13, "WB")?],
            pins: [card.components(8, "PA")?, card.components(9, "PB")?],
            is_beam,
            at: card.at(),
        })
    }
}

/// A rod: axial and torsional stiffness between two points.
#[derive(Debug, Clone)]
pub struct Rod {
    /// Its number.
    pub id: u32,
    /// Its property, or the section itself for CONROD.
    pub section: RodSectionRef,
    /// Its ends.
    pub grids: [u32; 2],
    /// Where it stands.
    pub at: Location,
}

/// Where a rod's section is defined.
#[derive(Debug, Clone)]
pub enum RodSectionRef {
    /// On a PROD card.
    Property(u32),
    /// On the CONROD card itself.
    Own(crate::cards::property::RodSection),
}

impl Rod {
    /// `CROD EID PID G1 G2`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        let id = card.id(0, "EID")?;
        Ok(Self {
            id,
            section: RodSectionRef::Property(card.id_opt(1, "PID")?.unwrap_or(id)),
            grids: [card.id(2, "G1")?, card.id(3, "G2")?],
            at: card.at(),
        })
    }

    /// `CONROD EID G1 G2 MID A J C NSM`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read_own(card: &Card) -> Result<Self> {
        Ok(Self {
            id: card.id(0, "EID")?,
            grids: [card.id(1, "G1")?, card.id(2, "G2")?],
            section: RodSectionRef::Own(crate::cards::property::RodSection {
                id: card.id(0, "EID")?,
                material: card.id(3, "MID")?,
                area: card.real_or(4, "A", 0.0)?,
                torsion_constant: card.real_or(5, "J", 0.0)?,
                nonstructural_mass: card.real_or(7, "NSM", 0.0)?,
                at: card.at(),
            }),
            at: card.at(),
        })
    }
}

/// Direction of a shell's material axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MaterialDirection {
    /// Degrees from side G1-G2.
    Angle(f64),
    /// Projection of this coordinate system's x axis.
    Coordinate(u32),
}

/// A plate or shell element with three or four corners.
#[derive(Debug, Clone)]
pub struct Shell {
    /// Its number.
    pub id: u32,
    /// Its property.
    pub property: u32,
    /// Its corners, three or four.
    pub grids: Vec<u32>,
    /// Direction of the material axis.
    pub material_direction: MaterialDirection,
    /// Offset of the reference plane.
    pub offset: f64,
    /// Thickness at the corners where given, the property's otherwise; as many as corners.
    pub thickness: Vec<Option<f64>>,
    /// Whether the corner thicknesses are fractions of the property's (TFLAG 1).
    pub relative_thickness: bool,
    /// Where it stands.
    pub at: Location,
}

impl Shell {
    /// `CQUAD4 EID PID G1 G2 G3 G4 THETA ZOFFS / . TFLAG T1 T2 T3 T4`, `CTRIA3 EID PID G1 G2 G3 THETA ZOFFS . / . TFLAG T1 T2 T3`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing, a corner named twice.
    pub fn read(card: &Card) -> Result<Self> {
        let corners = if card.name() == "CTRIA3" { 3 } else { 4 };
        let id = card.id(0, "EID")?;
        let mut grids = Vec::with_capacity(corners);
        for i in 0..corners {
            let grid = card.id(2 + i, ["G1", "G2", "G3", "G4"][i])?;
            if grids.contains(&grid) {
                return Err(card.wrong(2 + i, "G", "corners that differ", "use CTRIA3 for three corners"));
            }
            grids.push(grid);
        }
        let direction = 2 + corners;
        let text = card.text(direction);
        let material_direction = match crate::number::number(text) {
            Some(crate::number::Number::Integer(i)) => {
                let cid = u32::try_from(i)
                    .map_err(|_| card.wrong(direction, "MCID", "an integer that is not negative", ""))?;
                MaterialDirection::Coordinate(cid)
            }
            _ => MaterialDirection::Angle(card.real_or(direction, "THETA", 0.0)?),
        };
        let mut thickness = Vec::with_capacity(corners);
        for i in 0..corners {
            thickness.push(card.real_opt(10 + i, "T")?);
        }
        Ok(Self {
            id,
            property: card.id_opt(1, "PID")?.unwrap_or(id),
            grids,
            material_direction,
            offset: card.real_or(direction + 1, "ZOFFS", 0.0)?,
            thickness,
            relative_thickness: card.int_or(9, "TFLAG", 0)? == 1,
            at: card.at(),
        })
    }
}

/// The value of a scalar element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ScalarValue {
    /// On the element's card.
    Direct(f64),
    /// On a PELAS, PMASS or PDAMP card.
    Property(u32),
}

/// A spring, mass or damper between two degrees of freedom, or between one and the ground.
#[derive(Debug, Clone)]
pub struct Scalar {
    /// Its number.
    pub id: u32,
    /// Stiffness, mass or damping.
    pub value: ScalarValue,
    /// Its ends; none is the ground.
    pub ends: [Option<Dof>; 2],
    /// Where it stands.
    pub at: Location,
}

impl Scalar {
    /// `CELAS1 EID PID G1 C1 G2 C2` (also CMASS1, CDAMP1)
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read_1(card: &Card) -> Result<Self> {
        let id = card.id(0, "EID")?;
        let value = ScalarValue::Property(card.id_opt(1, "PID")?.unwrap_or(id));
        Self::with_ends(card, id, value)
    }

    /// `CELAS2 EID K G1 C1 G2 C2 GE S` (also CMASS2, CDAMP2)
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read_2(card: &Card) -> Result<Self> {
        let value = ScalarValue::Direct(card.real(1, "value")?);
        let damping = card.real_or(6, "GE", 0.0)?;
        if damping != 0.0 {
            card.note(
                Severity::Warning,
                "element damping GE is not used; give structural damping by SDAMPING or PARAM G",
            );
        }
        Self::with_ends(card, card.id(0, "EID")?, value)
    }

    fn with_ends(card: &Card, id: u32, value: ScalarValue) -> Result<Self> {
        let mut ends = [None; 2];
        for (i, end) in ends.iter_mut().enumerate() {
            let index = 2 + 2 * i;
            // A blank or zero point is the ground.
            if card.int_or(index, "G", 0)? != 0 {
                *end = Some(Dof {
                    point: card.id(index, "G")?,
                    component: card.component(index + 1, "C")?,
                });
            }
        }
        Self::checked(card, id, value, ends)
    }

    /// `CELAS3 EID PID S1 S2`, `CELAS4 EID K S1 S2` (also CMASS, CDAMP): between scalar points
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read_scalar_points(card: &Card, direct: bool) -> Result<Self> {
        let id = card.id(0, "EID")?;
        let value = if direct {
            ScalarValue::Direct(card.real(1, "value")?)
        } else {
            ScalarValue::Property(card.id_opt(1, "PID")?.unwrap_or(id))
        };
        let mut ends = [None; 2];
        for (i, end) in ends.iter_mut().enumerate() {
            if card.int_or(2 + i, "S", 0)? != 0 {
                *end = Some(Dof {
                    point: card.id(2 + i, "S")?,
                    component: 0,
                });
            }
        }
        Self::checked(card, id, value, ends)
    }

    fn checked(card: &Card, id: u32, value: ScalarValue, ends: [Option<Dof>; 2]) -> Result<Self> {
        if ends == [None, None] {
            return Err(card.wrong(2, "G1", "the number of a point", "an element needs at least one end"));
        }
        Ok(Self {
            id,
            value,
            ends,
            at: card.at(),
        })
    }
}

/// A general element: a flexibility or stiffness matrix between the degrees of freedom `ui`, with the motion of the rigid
/// support `ud` taken off by the matrix S: `[ui] = [Z] {fi} + [S] {ud}`.
#[derive(Debug, Clone)]
pub struct Genel {
    /// Its number.
    pub id: u32,
    /// Elastic degrees of freedom, m of them.
    pub elastic: Vec<Dof>,
    /// Degrees of freedom of the support, n of them; none when the element stands on the ground.
    pub support: Vec<Dof>,
    /// Whether `matrix` is a stiffness (K) and not a flexibility (Z).
    pub is_stiffness: bool,
    /// m x m, row by row, symmetric.
    pub matrix: Vec<f64>,
    /// m x n, row by row; empty if the card gives none and rigid-body motion of the support is to be used.
    pub rigid: Vec<f64>,
    /// Where it stands.
    pub at: Location,
}

impl Genel {
    /// `GENEL EID . UI1 CI1 ... / UD . UD1 CD1 ... / K|Z columns of the lower triangle / S rows`
    ///
    /// # Errors
    /// Fields of the wrong kind, values missing.
    pub fn read(card: &Card) -> Result<Self> {
        let id = card.id(0, "EID")?;
        let starts = |word: &str| (8..card.len()).step_by(8).find(|i| card.text(*i) == word);
        let ud = starts("UD");
        let k = starts("K");
        let z = starts("Z");
        let s = starts("S");
        let Some(values) = k.or(z) else {
            return Err(card.error("needed a continuation that begins with K or Z and the matrix behind it"));
        };
        if k.is_some() && z.is_some() {
            return Err(card.error("gives both K and Z; keep one"));
        }
        let dofs = |from: usize, to: usize| -> Result<Vec<Dof>> {
            let filled: Vec<usize> = (from..to).filter(|i| card.has(*i)).collect();
            if !filled.len().is_multiple_of(2) {
                return Err(card.wrong(filled[filled.len() - 1], "C", "pairs of a point and a component", ""));
            }
            filled
                .chunks_exact(2)
                .map(|pair| {
                    Ok(Dof {
                        point: card.id(pair[0], "U")?,
                        component: card.component(pair[1], "C")?,
                    })
                })
                .collect()
        };
        let elastic = dofs(2, ud.unwrap_or(values))?;
        let support = match ud {
            Some(ud) => dofs(ud + 1, values)?,
            None => Vec::new(),
        };
        let m = elastic.len();
        if m == 0 {
            return Err(card.wrong(2, "UI1", "at least one degree of freedom", ""));
        }
        let end = s.filter(|s| *s > values).unwrap_or(card.len());
        let needed = m * (m + 1) / 2;
        let triangle = Self::values(card, values + 1, end, needed, if k.is_some() { "K" } else { "Z" })?;
        let mut matrix = vec![0.0; m * m];
        let mut next = triangle.into_iter();
        for column in 0..m {
            for row in column..m {
                let value = next.next().unwrap_or(0.0);
                matrix[row * m + column] = value;
                matrix[column * m + row] = value;
            }
        }
        let rigid = match s {
            Some(s) => Self::values(card, s + 1, card.len(), m * support.len(), "S")?,
            None => Vec::new(),
        };
        Ok(Self {
            id,
            elastic,
            support,
            is_stiffness: k.is_some(),
            matrix,
            rigid,
            at: card.at(),
        })
    }

    fn values(card: &Card, from: usize, to: usize, needed: usize, name: &str) -> Result<Vec<f64>> {
        let mut values = Vec::new();
        for i in from..to {
            if let Some(x) = card.real_opt(i, name)? {
                values.push(x);
            }
        }
        if values.len() == needed {
            Ok(values)
        } else {
            Err(card.error(format!(
                "matrix {name} needs {needed} values, got {}; write zeros out",
                values.len()
            )))
        }
    }
}
