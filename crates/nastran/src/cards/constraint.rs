//! Constraints and sets of degrees of freedom: SPC, SPC1, SPCADD, MPC, MPCADD, RBE2, RBAR, RBE3, ASET, OMIT, SUPORT.

use crate::{
    error::{DeckError, Location, Severity},
    fields::{Card, Components, Dof},
};

type Result<T> = std::result::Result<T, DeckError>;

/// Components of points, as on SPC1, ASET1 and their like.
#[derive(Debug, Clone)]
pub struct DofSet {
    /// The components; none on scalar points.
    pub components: Components,
    /// The points.
    pub points: Vec<u32>,
    /// Whether the points came from a THRU range, so that some need not exist.
    pub is_range: bool,
    /// Where it stands.
    pub at: Location,
}

impl DofSet {
    /// Components at `index`, points from there to the end: `SPC1 SID C G1 G2 ...`, `ASET1 C G1 G2 ...`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read_list(card: &Card, index: usize) -> Result<Self> {
        let points = card.ids(index + 1, "G")?;
        if points.is_empty() {
            return Err(card.wrong(index + 1, "G", "at least one point", ""));
        }
        Ok(Self {
            components: card.components(index, "C")?,
            points,
            is_range: (index + 1..card.len()).any(|i| card.text(i) == "THRU"),
            at: card.at(),
        })
    }

    /// Pairs of a point and components from `index` on: `ASET ID1 C1 ID2 C2 ...`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read_pairs(card: &Card, index: usize) -> Result<Vec<Self>> {
        let mut found = Vec::new();
        for i in (index..card.len().max(index + 1)).step_by(2) {
            if i == index || card.has(i) {
                found.push(Self {
                    points: vec![card.id(i, "ID")?],
                    components: card.components(i + 1, "C")?,
                    is_range: false,
                    at: card.at(),
                });
            }
        }
        Ok(found)
    }

    /// `SPC SID G1 C1 D1 G2 C2 D2`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read_spc(card: &Card) -> Result<Vec<Self>> {
        let mut found = Vec::new();
        for i in [1, 4] {
            if i > 1 && !card.has(i) {
                continue;
            }
            if card.real_or(i + 2, "D", 0.0)? != 0.0 {
                card.note(
                    Severity::Warning,
                    "an enforced displacement counts as zero in a flutter solution",
                );
            }
            found.push(Self {
                points: vec![card.id(i, "G")?],
                components: card.components(i + 1, "C")?,
                is_range: false,
                at: card.at(),
            });
        }
        Ok(found)
    }
}

/// A linear equation between degrees of freedom: the sum of coefficient times motion is zero. The first term's is the
/// dependent one.
#[derive(Debug, Clone)]
pub struct Equation {
    /// Its set.
    pub set: u32,
    /// Terms.
    pub terms: Vec<(Dof, f64)>,
    /// Where it stands.
    pub at: Location,
}

impl Equation {
    /// `MPC SID G1 C1 A1 G2 C2 A2 . / . G3 C3 A3 G4 C4 A4 . / ...`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        let mut terms = Vec::new();
        let mut line = 0;
        while line * 8 < card.len() {
            for i in [line * 8 + 1, line * 8 + 4] {
                if card.has(i) || i == 1 {
                    let dof = Dof {
                        point: card.id(i, "G")?,
                        component: card.component(i + 1, "C")?,
                    };
                    terms.push((dof, card.real(i + 2, "A")?));
                }
            }
            line += 1;
        }
        if terms.first().is_none_or(|(_, a)| *a == 0.0) {
            return Err(card.wrong(
                3,
                "A1",
                "a coefficient that is not zero",
                "the first term is the dependent one",
            ));
        }
        Ok(Self {
            set: card.id(0, "SID")?,
            terms,
            at: card.at(),
        })
    }
}

/// A rigid body: all `dependent` components of the points move with the independent point (RBE2).
#[derive(Debug, Clone)]
pub struct RigidBody {
    /// Its number.
    pub id: u32,
    /// The independent point.
    pub independent: u32,
    /// Dependent components.
    pub components: Components,
    /// Dependent points.
    pub dependent: Vec<u32>,
    /// Where it stands.
    pub at: Location,
}

impl RigidBody {
    /// `RBE2 EID GN CM GM1 GM2 ... (ALPHA)`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read(card: &Card) -> Result<Self> {
        let mut dependent = Vec::new();
        for i in 3..card.len() {
            let text = card.text(i);
            if text.is_empty() {
                continue;
            }
            // A real at the end is the thermal expansion.
            if i + 1 == card.len() && matches!(crate::number::number(text), Some(crate::number::Number::Real(_))) {
                break;
            }
            dependent.push(i);
        }
        let dependent = if dependent.iter().any(|i| card.text(*i) == "THRU") {
            card.ids(3, "GM")?
        } else {
            dependent.into_iter().map(|i| card.id(i, "GM")).collect::<Result<_>>()?
        };
        let components = card.components(2, "CM")?;
        if components.is_empty() || dependent.is_empty() {
            return Err(card.error("needed dependent components (CM) and at least one dependent point (GM1)"));
        }
        Ok(Self {
            id: card.id(0, "EID")?,
            independent: card.id(1, "GN")?,
            components,
            dependent,
            at: card.at(),
        })
    }
}

/// A rigid bar: six independent components at its two ends, the others dependent (RBAR).
#[derive(Debug, Clone)]
pub struct RigidBar {
    /// Its number.
    pub id: u32,
    /// Ends A and B.
    pub grids: [u32; 2],
    /// Independent components at A and B, six in all.
    pub independent: [Components; 2],
    /// Dependent components at A and B.
    pub dependent: [Components; 2],
    /// Where it stands.
    pub at: Location,
}

impl RigidBar {
    /// `RBAR EID GA GB CNA CNB CMA CMB`
    ///
    /// # Errors
    /// Fields of the wrong kind, not six independent components, a component both dependent and independent.
    pub fn read(card: &Card) -> Result<Self> {
        let independent = [card.components(3, "CNA")?, card.components(4, "CNB")?];
        if independent[0].iter().count() + independent[1].iter().count() != 6 {
            return Err(card.wrong(3, "CNA, CNB", "six independent components in all", ""));
        }
        let mut dependent = [card.components(5, "CMA")?, card.components(6, "CMB")?];
        if dependent.iter().all(|c| c.is_empty()) {
            dependent = independent.map(|c| Components(Components::ALL.0 & !c.0));
        }
        for end in 0..2 {
            if independent[end].0 & dependent[end].0 != 0 {
                return Err(card.wrong(5 + end, "CMA, CMB", "components that are not independent too", ""));
            }
        }
        Ok(Self {
            id: card.id(0, "EID")?,
            grids: [card.id(1, "GA")?, card.id(2, "GB")?],
            independent,
            dependent,
            at: card.at(),
        })
    }
}

/// An interpolation element: the reference point moves as the weighted mean of others (RBE3).
#[derive(Debug, Clone)]
pub struct Interpolation {
    /// Its number.
    pub id: u32,
    /// The reference (dependent) point.
    pub reference: u32,
    /// Its dependent components.
    pub components: Components,
    /// Weight, components and points of each group.
    pub groups: Vec<(f64, Components, Vec<u32>)>,
    /// Where it stands.
    pub at: Location,
}

impl Interpolation {
    /// `RBE3 EID . REFGRID REFC WT1 C1 G1,1 G1,2 / ... WT2 C2 ... / UM ... / ALPHA x`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing; other dependent components (UM).
    pub fn read(card: &Card) -> Result<Self> {
        let mut groups: Vec<(f64, Components, Vec<u32>)> = Vec::new();
        let mut i = 4;
        while i < card.len() {
            match card.text(i) {
                "" => i += 1,
                "UM" => {
                    return Err(
                        card.unsupported("dependent components elsewhere (UM); leave the reference point dependent")
                    );
                }
                "ALPHA" => break,
                text if matches!(crate::number::number(text), Some(crate::number::Number::Real(_))) => {
                    groups.push((card.real(i, "WT")?, card.components(i + 1, "C")?, Vec::new()));
                    i += 2;
                }
                "THRU" => {
                    let to = card.id(i + 1, "G")?;
                    let Some((_, _, points)) = groups.last_mut() else {
                        return Err(card.wrong(i, "G", "a number before THRU", ""));
                    };
                    let from = points.last().map_or(to, |p| p.saturating_add(1));
                    if to.saturating_sub(from) > 1_000_000 {
                        return Err(card.wrong(i + 1, "G", "a range of at most 1000000", ""));
                    }
                    points.extend(from..=to);
                    i += 2;
                }
                _ => {
                    let point = card.id(i, "G")?;
                    match groups.last_mut() {
                        Some((_, _, points)) => points.push(point),
                        None => return Err(card.wrong(4, "WT1", "a real weight before the first point", "")),
                    }
                    i += 1;
                }
            }
        }
        if groups.iter().all(|(_, _, points)| points.is_empty()) {
            return Err(card.error("needed at least one weight, component set and point"));
        }
        Ok(Self {
            id: card.id(0, "EID")?,
            reference: card.id(2, "REFGRID")?,
            components: card.components(3, "REFC")?,
            groups,
            at: card.at(),
        })
    }
}
