//! Materials: MAT1, MAT2, MAT8.

use crate::{
    error::{DeckError, Location},
    fields::Card,
};

type Result<T> = std::result::Result<T, DeckError>;

/// A material.
#[derive(Debug, Clone)]
pub struct Material {
    /// Its number.
    pub id: u32,
    /// Its elastic law.
    pub law: ElasticLaw,
    /// Mass (or weight, see PARAM WTMASS) per volume.
    pub density: f64,
    /// Structural damping of the element, GE.
    pub damping: f64,
    /// Where it stands.
    pub at: Location,
}

/// Elastic laws.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ElasticLaw {
    /// MAT1.
    Isotropic {
        /// Young's modulus.
        e: f64,
        /// Shear modulus.
        g: f64,
        /// Poisson's ratio.
        nu: f64,
    },
    /// MAT2: the plane-stress (or, under MID3, the shear) matrix itself.
    Anisotropic {
        /// G11, G12, G13, G22, G23, G33.
        g: [f64; 6],
    },
    /// MAT8.
    Orthotropic {
        /// Young's modulus along the material's axis 1.
        e1: f64,
        /// Young's modulus along axis 2.
        e2: f64,
        /// Poisson's ratio: strain along 2 from stress along 1.
        nu12: f64,
        /// In-plane shear modulus.
        g12: f64,
        /// Transverse shear modulus in planes 1-z and 2-z; zero means rigid.
        g_transverse: [f64; 2],
    },
}

impl Material {
    /// `MAT1 MID E G NU RHO A TREF GE`: of E, G and NU one may be blank.
    ///
    /// # Errors
    /// Fields of the wrong kind, neither E nor G, a Poisson's ratio that makes the law unstable.
    pub fn read_isotropic(card: &Card) -> Result<Self> {
        let e = card.real_opt(1, "E")?;
        let g = card.real_opt(2, "G")?;
        let nu = card.real_opt(3, "NU")?;
        let (e, g, nu) = match (e, g, nu) {
            (Some(e), Some(g), Some(nu)) => (e, g, nu),
            // Without NU a bar needs none; a plate gets what E and G imply.
            (Some(e), Some(g), None) => (e, g, if g == 0.0 { 0.0 } else { e / (2.0 * g) - 1.0 }),
            (Some(e), None, Some(nu)) => (e, e / (2.0 * (1.0 + nu)), nu),
            (None, Some(g), Some(nu)) => (2.0 * (1.0 + nu) * g, g, nu),
            (Some(e), None, None) => (e, 0.0, 0.0),
            (None, Some(g), None) => (0.0, g, 0.0),
            (None, None, _) => {
                return Err(card.wrong(
                    1,
                    "E",
                    "Young's modulus, or G in field 4",
                    "E and G may not both be blank",
                ));
            }
        };
        if e < 0.0 {
            return Err(card.wrong(1, "E", "a modulus that is not negative", ""));
        }
        Ok(Self {
            id: card.id(0, "MID")?,
            law: ElasticLaw::Isotropic { e, g, nu },
            density: card.real_or(4, "RHO", 0.0)?,
            damping: card.real_or(7, "GE", 0.0)?,
            at: card.at(),
        })
    }

    /// `MAT2 MID G11 G12 G13 G22 G23 G33 RHO / A1 A2 A3 TREF GE`
    ///
    /// # Errors
    /// Fields of the wrong kind.
    pub fn read_anisotropic(card: &Card) -> Result<Self> {
        let mut g = [0.0; 6];
        for (i, (g, name)) in g.iter_mut().zip(["G11", "G12", "G13", "G22", "G23", "G33"]).enumerate() {
            *g = card.real_or(1 + i, name, 0.0)?;
        }
        Ok(Self {
            id: card.id(0, "MID")?,
            law: ElasticLaw::Anisotropic { g },
            density: card.real_or(7, "RHO", 0.0)?,
            damping: card.real_or(12, "GE", 0.0)?,
            at: card.at(),
        })
    }

    /// `MAT8 MID E1 E2 NU12 G12 G1Z G2Z RHO / A1 A2 TREF Xt Xc Yt Yc S / GE`
    ///
    /// # Errors
    /// Fields of the wrong kind or missing.
    pub fn read_orthotropic(card: &Card) -> Result<Self> {
        Ok(Self {
            id: card.id(0, "MID")?,
            law: ElasticLaw::Orthotropic {
                e1: card.real(1, "E1")?,
                e2: card.real(2, "E2")?,
                nu12: card.real_or(3, "NU12", 0.0)?,
                g12: card.real_or(4, "G12", 0.0)?,
                g_transverse: [card.real_or(5, "G1Z", 0.0)?, card.real_or(6, "G2Z", 0.0)?],
            },
            density: card.real_or(7, "RHO", 0.0)?,
            damping: card.real_or(16, "GE", 0.0)?,
            at: card.at(),
        })
    }
}
