//! Properties: PBAR, PBARL, PBEAM, PROD, PSHELL, PCOMP, PELAS, PMASS, PDAMP.

use crate::{
    error::{DeckError, Location, Severity},
    fields::Card,
};

type Result<T> = std::result::Result<T, DeckError>;

/// Section of a bar or of a beam without taper.
#[derive(Debug, Clone)]
pub struct BarSection {
    /// Its number.
    pub id: u32,
    /// Its material.
    pub material: u32,
    /// Area.
    pub area: f64,
    /// Second moment for bending in plane 1 (about the element's z axis).
    pub i1: f64,
    /// Second moment for bending in plane 2 (about the element's y axis).
    pub i2: f64,
    /// Product of area.
    pub i12: f64,
    /// Torsion constant.
    pub torsion_constant: f64,
    /// Mass per length besides the material's.
    pub nonstructural_mass: f64,
    /// Shear area factors of planes 1 and 2; none means no shear deformation.
    pub shear_factors: [Option<f64>; 2],
    /// Where it stands.
    pub at: Location,
}

impl BarSection {
    /// `PBAR PID MID A I1 I2 J NSM / C1 ... F2 / K1 K2 I12`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read_bar(card: &Card) -> Result<Self> {
        Ok(Self {
            id: card.id(0, "PID")?,
            material: card.id(1, "MID")?,
            area: card.real_or(2, "A", 0.0)?,
            i1: card.real_or(3, "I1", 0.0)?,
            i2: card.real_or(4, "I2", 0.0)?,
            i12: card.real_or(18, "I12", 0.0)?,
            torsion_constant: card.real_or(5, "J", 0.0)?,
            nonstructural_mass: card.real_or(6, "NSM", 0.0)?,
            shear_factors: [shear(card, 16, "K1")?, shear(card, 17, "K2")?],
            at: card.at(),
        })
    }

    /// `PBARL PID MID GROUP TYPE / DIM1 DIM2 ...` for the types ROD, TUBE, BAR, BOX and I
    ///
    /// # Errors
    /// Fields of the wrong kind or missing, other types.
    pub fn read_library(card: &Card) -> Result<Self> {
        let kind = card.text(3);
        let (count, name) = match kind {
            "ROD" => (1, "DIM1 (radius)"),
            "TUBE" => (2, "DIM1, DIM2 (outer and inner radius)"),
            "BAR" => (2, "DIM1, DIM2 (width and height)"),
            "BOX" => (4, "DIM1 to DIM4 (width, height, wall of the flanges, wall of the webs)"),
            "I" => (
                6,
                "DIM1 to DIM6 (height, lower and upper flange, web, lower and upper flange thickness)",
            ),
            _ => {
                return Err(card.wrong(
                    3,
                    "TYPE",
                    "ROD, TUBE, BAR, BOX or I",
                    "give the section's area and moments on PBAR",
                ));
            }
        };
        let mut d = Vec::with_capacity(count);
        for i in 0..count {
            let x = card.real(8 + i, name)?;
            if x < 0.0 {
                return Err(card.wrong(8 + i, name, "a length that is not negative", ""));
            }
            d.push(x);
        }
        let pi = std::f64::consts::PI;
        // Timoshenko & Goodier, Theory of Elasticity, 3rd ed., section 109: torsion of a rectangle by its first terms;
        // section 116 (Bredt) for closed thin walls. The library's own shear factors are those of the usual tables.
        let (area, i1, i2, torsion, k) = match kind {
            "ROD" => {
                let r = d[0];
                let a = pi * r * r;
                (a, a * r * r / 4.0, a * r * r / 4.0, a * r * r / 2.0, [0.9, 0.9])
            }
            "TUBE" => {
                if d[1] >= d[0] {
                    return Err(card.wrong(9, "DIM2", "an inner radius below the outer", ""));
                }
                let a = pi * (d[0] * d[0] - d[1] * d[1]);
                let i = pi / 4.0 * (d[0].powi(4) - d[1].powi(4));
                (a, i, i, 2.0 * i, [0.5, 0.5])
            }
            "BAR" => {
                let (w, h) = (d[0], d[1]);
                (
                    w * h,
                    w * h.powi(3) / 12.0,
                    h * w.powi(3) / 12.0,
                    torsion_of_rectangle(w, h),
                    [5.0 / 6.0, 5.0 / 6.0],
                )
            }
            "BOX" => {
                let (w, h, tf, tw) = (d[0], d[1], d[2], d[3]);
                let (wi, hi) = (w - 2.0 * tw, h - 2.0 * tf);
                if wi <= 0.0 || hi <= 0.0 {
                    return Err(card.wrong(10, "DIM3, DIM4", "walls thinner than half the box", ""));
                }
                let (wm, hm) = (w - tw, h - tf);
                let j = 2.0 * tf * tw * (wm * hm).powi(2) / (w * tw + h * tf - tw * tw - tf * tf);
                let i1 = (w * h.powi(3) - wi * hi.powi(3)) / 12.0;
                let i2 = (h * w.powi(3) - hi * wi.powi(3)) / 12.0;
                let a = w * h - wi * hi;
                (a, i1, i2, j, [2.0 * tw * hi / a, 2.0 * tf * wi / a])
            }
            _ => {
                let (h, wb, wt, tw, tb, tt) = (d[0], d[1], d[2], d[3], d[4], d[5]);
                let hw = h - tb - tt;
                if hw <= 0.0 {
                    return Err(card.wrong(12, "DIM5, DIM6", "flanges thinner than the section is high", ""));
                }
                let parts = [(wb, tb, tb / 2.0), (tw, hw, tb + hw / 2.0), (wt, tt, h - tt / 2.0)];
                let a: f64 = parts.iter().map(|(w, t, _)| w * t).sum();
                let centroid = parts.iter().map(|(w, t, y)| w * t * y).sum::<f64>() / a;
                let i1 = parts
                    .iter()
                    .map(|(w, t, y)| w * t.powi(3) / 12.0 + w * t * (y - centroid).powi(2))
                    .sum();
                let i2 = parts.iter().map(|(w, t, _)| t * w.powi(3) / 12.0).sum();
                let j = parts.iter().map(|(w, t, _)| w.max(*t) * w.min(*t).powi(3) / 3.0).sum();
                (a, i1, i2, j, [tw * hw / a, (wb * tb + wt * tt) / (1.2 * a)])
            }
        };
        Ok(Self {
            id: card.id(0, "PID")?,
            material: card.id(1, "MID")?,
            area,
            i1,
            i2,
            i12: 0.0,
            torsion_constant: torsion,
            nonstructural_mass: card.real_or(8 + count, "NSM", 0.0)?,
            shear_factors: k.map(Some),
            at: card.at(),
        })
    }

    /// `PBEAM PID MID A I1 I2 I12 J NSM / C1 ... F2 / SO X/XB A ... / K1 K2 S1 S2 NSI ... / M1 M2 M1B M2B N1 N2 N1B N2B`
    /// as long as the section is the same at all stations and shear centre, mass axis and neutral axis coincide
    ///
    /// # Errors
    /// Fields of the wrong kind or missing; a taper; offsets between the axes.
    pub fn read_beam(card: &Card) -> Result<Self> {
        const NAMES: [&str; 6] = ["A", "I1", "I2", "I12", "J", "NSM"];
        let end_a: Vec<f64> = (0..6)
            .map(|i| card.real_or(2 + i, NAMES[i], 0.0))
            .collect::<Result<_>>()?;
        let mut index = 8;
        // The first continuation holds stress points unless it is a station already.
        if !matches!(card.text(index), "YES" | "YESA" | "NO") {
            index += 8;
        }
        while matches!(card.text(index), "YES" | "YESA" | "NO") {
            for i in 0..6 {
                let here = card.real_or(index + 2 + i, NAMES[i], end_a[i])?;
                if (here - end_a[i]).abs() > 1e-9 * end_a[i].abs() {
                    return Err(card.unsupported("a tapered beam; cut it into CBARs of constant section"));
                }
            }
            let stress = card.text(index) == "YES";
            index += 8;
            // The line of stress points may be left out after YESA and NO.
            if stress || (!matches!(card.text(index), "YES" | "YESA" | "NO") && Self::is_stress_line(card, index)) {
                index += 8;
            }
        }
        for i in index + 2..index + 16 {
            if card.real_or(i, "shear relief, warping or axis offset", 0.0)? != 0.0 {
                return Err(card.unsupported("beams with shear relief, warping, nonstructural inertia or offset axes"));
            }
        }
        Ok(Self {
            id: card.id(0, "PID")?,
            material: card.id(1, "MID")?,
            area: end_a[0],
            i1: end_a[1],
            i2: end_a[2],
            i12: end_a[3],
            torsion_constant: end_a[4],
            nonstructural_mass: end_a[5],
            // CBEAM deforms in shear with factor one unless told otherwise; zero switches it off.
            shear_factors: [
                Some(card.real_or(index, "K1", 1.0)?).filter(|k| *k != 0.0),
                Some(card.real_or(index + 1, "K2", 1.0)?).filter(|k| *k != 0.0),
            ],
            at: card.at(),
        })
    }

    /// After YESA or NO the next line is either stress points (two more lines may follow) or K1, K2 and so on.
    fn is_stress_line(card: &Card, index: usize) -> bool {
        card.len() > index + 16
    }
}

/// Torsion constant of a rectangle, to 0.5 %.
fn torsion_of_rectangle(w: f64, h: f64) -> f64 {
    let (long, short) = (w.max(h), w.min(h));
    if long <= 0.0 {
        return 0.0;
    }
    let r = short / long;
    long * short.powi(3) * (1.0 / 3.0 - 0.21 * r * (1.0 - r.powi(4) / 12.0))
}

fn shear(card: &Card, index: usize, name: &str) -> Result<Option<f64>> {
    Ok(card.real_opt(index, name)?.filter(|k| *k != 0.0))
}

/// Section of a rod.
#[derive(Debug, Clone)]
pub struct RodSection {
    /// Its number.
    pub id: u32,
    /// Its material.
    pub material: u32,
    /// Area.
    pub area: f64,
    /// Torsion constant.
    pub torsion_constant: f64,
    /// Mass per length besides the material's.
    pub nonstructural_mass: f64,
    /// Where it stands.
    pub at: Location,
}

impl RodSection {
    /// `PROD PID MID A J C NSM`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        Ok(Self {
            id: card.id(0, "PID")?,
            material: card.id(1, "MID")?,
            area: card.real_or(2, "A", 0.0)?,
            torsion_constant: card.real_or(3, "J", 0.0)?,
            nonstructural_mass: card.real_or(5, "NSM", 0.0)?,
            at: card.at(),
        })
    }
}

/// Section of a plate or shell.
#[derive(Debug, Clone)]
pub struct ShellSection {
    /// Its number.
    pub id: u32,
    /// Material of the membrane (MID1); none means no membrane stiffness.
    pub membrane: Option<u32>,
    /// Thickness, if the elements do not give it.
    pub thickness: Option<f64>,
    /// Material of bending (MID2); none means no bending stiffness.
    pub bending: Option<u32>,
    /// Bending stiffness over that of a homogeneous plate, 12 I / T^3.
    pub bending_ratio: f64,
    /// Material of transverse shear (MID3); none means no shear deformation.
    pub shear: Option<u32>,
    /// Shear thickness over thickness, TS / T.
    pub shear_ratio: f64,
    /// Mass per area besides the material's.
    pub nonstructural_mass: f64,
    /// Where it stands.
    pub at: Location,
}

impl ShellSection {
    /// `PSHELL PID MID1 T MID2 12I/T**3 MID3 TS/T NSM / Z1 Z2 MID4`
    ///
    /// # Errors
    /// Fields of the wrong kind, plane strain (MID2 = -1), membrane-bending coupling (MID4).
    pub fn read(card: &Card) -> Result<Self> {
        if card.int_or(3, "MID2", 0)? == -1 {
            return Err(card.unsupported("plane strain (MID2 = -1)"));
        }
        if card.has(10) {
            return Err(card.unsupported("coupling of membrane and bending (MID4)"));
        }
        Ok(Self {
            id: card.id(0, "PID")?,
            membrane: card.id_opt(1, "MID1")?,
            thickness: card.real_opt(2, "T")?,
            bending: card.id_opt(3, "MID2")?,
            bending_ratio: card.real_or(4, "12I/T**3", 1.0)?,
            shear: card.id_opt(5, "MID3")?,
            shear_ratio: card.real_or(6, "TS/T", 5.0 / 6.0)?,
            nonstructural_mass: card.real_or(7, "NSM", 0.0)?,
            at: card.at(),
        })
    }
}

/// One ply of a laminate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ply {
    /// Its material.
    pub material: u32,
    /// Its thickness.
    pub thickness: f64,
    /// Degrees from the element's material axis to the ply's axis 1.
    pub angle_deg: f64,
}

/// A laminated shell.
#[derive(Debug, Clone)]
pub struct Laminate {
    /// Its number.
    pub id: u32,
    /// Height of the bottom face over the points' plane; none is minus half the thickness.
    pub bottom: Option<f64>,
    /// Mass per area besides the plies'.
    pub nonstructural_mass: f64,
    /// Plies from the bottom face up, the mirrored half of a symmetric laminate included.
    pub plies: Vec<Ply>,
    /// Where it stands.
    pub at: Location,
}

impl Laminate {
    /// `PCOMP PID Z0 NSM SB FT TREF GE LAM / MID1 T1 THETA1 SOUT1 MID2 T2 THETA2 SOUT2 / ...`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing, no plies, options LAM other than SYM.
    pub fn read(card: &Card) -> Result<Self> {
        let symmetric = match card.text(7) {
            "" => false,
            "SYM" => true,
            _ => return Err(card.wrong(7, "LAM", "blank or SYM", "")),
        };
        let mut plies: Vec<Ply> = Vec::new();
        for i in (8..card.len()).step_by(4) {
            if (i..i + 3).all(|j| !card.has(j)) {
                continue;
            }
            // Material and thickness of a ply default to those of the one below.
            let below = plies.last().copied();
            let material = match (card.id_opt(i, "MID")?, below) {
                (Some(id), _) => id,
                (None, Some(ply)) => ply.material,
                (None, None) => return Err(card.wrong(i, "MID1", "the number of a material", "")),
            };
            let thickness = match (card.real_opt(i + 1, "T")?, below) {
                (Some(t), _) if t > 0.0 => t,
                (None, Some(ply)) => ply.thickness,
                _ => return Err(card.wrong(i + 1, "T", "a positive thickness", "")),
            };
            plies.push(Ply {
                material,
                thickness,
                angle_deg: card.real_or(i + 2, "THETA", 0.0)?,
            });
        }
        if plies.is_empty() {
            return Err(card.error("needed at least one ply behind the first line"));
        }
        if symmetric {
            let upper: Vec<Ply> = plies.iter().rev().copied().collect();
            plies.extend(upper);
        }
        Ok(Self {
            id: card.id(0, "PID")?,
            bottom: card.real_opt(1, "Z0")?,
            nonstructural_mass: card.real_or(2, "NSM", 0.0)?,
            plies,
            at: card.at(),
        })
    }
}

/// A value for scalar elements: spring, mass or damper.
#[derive(Debug, Clone)]
pub struct ScalarProperty {
    /// Its number.
    pub id: u32,
    /// Stiffness, mass or damping.
    pub value: f64,
    /// Where it stands.
    pub at: Location,
}

impl ScalarProperty {
    /// `PELAS PID1 K1 GE1 S1 PID2 K2 GE2 S2`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read_springs(card: &Card) -> Result<Vec<Self>> {
        for i in [2, 6] {
            if card.real_or(i, "GE", 0.0)? != 0.0 {
                card.note(
                    Severity::Warning,
                    "element damping GE is not used; give structural damping by SDAMPING or PARAM G",
                );
            }
        }
        Self::read_several(card, 4)
    }

    /// `PMASS PID1 M1 PID2 M2 ...`, `PDAMP PID1 B1 ...`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read_pairs(card: &Card) -> Result<Vec<Self>> {
        Self::read_several(card, 2)
    }

    fn read_several(card: &Card, step: usize) -> Result<Vec<Self>> {
        let mut found = Vec::new();
        for i in (0..card.len().max(1)).step_by(step) {
            if i == 0 || card.has(i) {
                found.push(Self {
                    id: card.id(i, "PID")?,
                    value: card.real(i + 1, "value")?,
                    at: card.at(),
                });
            }
        }
        Ok(found)
    }
}
