//! Sections: what a shell or a bar is made of, integrated over its thickness or cross section.

use nalgebra::{Matrix2, Matrix3};

use crate::error::ModelError;
use crate::material::{Material, rotate_plane_stress, rotate_transverse};

/// Shear factor of a homogeneous plate (Reissner), Nastran's default TS/T.
pub const SHEAR_FACTOR: f64 = 5.0 / 6.0;

/// What shell elements are made of. Angles are measured from the material axis of the element.
#[derive(Debug, Clone, PartialEq)]
pub struct ShellSection {
    /// Number, for messages.
    pub id: u32,
    /// Thickness of elements that do not give their own.
    pub thickness: f64,
    /// Mass per area besides the material's.
    pub nonstructural_mass: f64,
    /// Stiffness.
    pub layup: Layup,
}

/// How thickness and materials make the stiffness of a shell.
#[derive(Debug, Clone, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "a model has few sections, and boxes would burden whoever writes one"
)]
pub enum Layup {
    /// Nastran's PSHELL: one thickness, and a material for each kind of stiffness. The mass is that
    /// of the membrane material, or of the bending material when there is none.
    Homogeneous {
        /// Membrane material (MID1); `None`: no membrane stiffness.
        membrane: Option<Material>,
        /// Bending material (MID2); `None`: no bending stiffness.
        bending: Option<Material>,
        /// 12 I / t^3 (1.0 for a solid plate).
        bending_ratio: f64,
        /// Transverse shear material (MID3); `None`: rigid in transverse shear (Kirchhoff).
        shear: Option<Material>,
        /// Shear thickness over thickness, [`SHEAR_FACTOR`] for a solid plate.
        shear_ratio: f64,
    },
    /// Nastran's PCOMP: plies from the bottom face up, by classical lamination theory. Corner and
    /// element thicknesses do not apply.
    Plies {
        /// Bottom to top.
        plies: Vec<Ply>,
        /// Height of the bottom face over the nodes' plane; `None`: minus half the thickness.
        bottom: Option<f64>,
    },
}

/// One ply of a laminate.
#[derive(Debug, Clone, PartialEq)]
pub struct Ply {
    /// Material.
    pub material: Material,
    /// Thickness.
    pub thickness: f64,
    /// Angle from the element's material axis to the ply's 1 axis, radians.
    pub angle_rad: f64,
}

/// Stiffness of a shell per unit width in its material axes, as integrated over the thickness.
#[derive(Debug, Clone, PartialEq)]
pub struct ShellStiffness {
    /// Membrane: force per width = A strain. Zero when the section has none.
    pub membrane: Matrix3<f64>,
    /// Coupling: force per width = B curvature.
    pub coupling: Matrix3<f64>,
    /// Bending: moment per width = D curvature. Zero when the section has none.
    pub bending: Matrix3<f64>,
    /// Transverse shear: force per width = S gamma; `None`: rigid.
    pub shear: Option<Matrix2<f64>>,
    /// Mass per area, nonstructural mass included.
    pub mass_per_area: f64,
    /// Rotary inertia per area about the middle plane (of the material).
    pub rotary_per_area: f64,
}

impl ShellSection {
    /// A solid plate of one material that bends and shears but has no membrane stiffness.
    pub fn plate(id: u32, material: Material, thickness: f64) -> Self {
        Self {
            id,
            thickness,
            nonstructural_mass: 0.0,
            layup: Layup::Homogeneous {
                membrane: None,
                bending: Some(material.clone()),
                bending_ratio: 1.0,
                shear: material.transverse_shear().is_some().then_some(material),
                shear_ratio: SHEAR_FACTOR,
            },
        }
    }

    /// A solid plate rigid in transverse shear (Kirchhoff) without membrane stiffness.
    pub fn thin_plate(id: u32, material: Material, thickness: f64) -> Self {
        let mut section = Self::plate(id, material, thickness);
        if let Layup::Homogeneous { shear, .. } = &mut section.layup {
            *shear = None;
        }
        section
    }

    /// A solid shell of one material in membrane, bending and shear.
    pub fn shell(id: u32, material: Material, thickness: f64) -> Self {
        let mut section = Self::plate(id, material.clone(), thickness);
        if let Layup::Homogeneous { membrane, .. } = &mut section.layup {
            *membrane = Some(material);
        }
        section
    }

    /// Whether the section resists in-plane strain.
    pub fn has_membrane(&self) -> bool {
        match &self.layup {
            Layup::Homogeneous { membrane, .. } => membrane.is_some(),
            Layup::Plies { .. } => true,
        }
    }

    /// Whether the section resists bending.
    pub fn has_bending(&self) -> bool {
        match &self.layup {
            Layup::Homogeneous { bending, .. } => bending.is_some(),
            Layup::Plies { .. } => true,
        }
    }

    /// Stiffness and mass per area where the thickness is `thickness`.
    /// Classical lamination theory, Jones, Mechanics of Composite Materials, (4.22)-(4.24).
    pub fn stiffness(&self, thickness: f64) -> ShellStiffness {
        let mut out = ShellStiffness {
            membrane: Matrix3::zeros(),
            coupling: Matrix3::zeros(),
            bending: Matrix3::zeros(),
            shear: None,
            mass_per_area: self.nonstructural_mass,
            rotary_per_area: 0.0,
        };
        match &self.layup {
            Layup::Homogeneous {
                membrane,
                bending,
                bending_ratio,
                shear,
                shear_ratio,
            } => {
                if let Some(m) = membrane {
                    out.membrane = m.plane_stress() * thickness;
                }
                if let Some(m) = bending {
                    out.bending = m.plane_stress() * (bending_ratio * thickness.powi(3) / 12.0);
                }
                out.shear = shear
                    .as_ref()
                    .and_then(Material::transverse_shear)
                    .map(|g| g * (shear_ratio * thickness));
                let density = membrane.as_ref().or(bending.as_ref()).map_or(0.0, |m| m.density);
                out.mass_per_area += density * thickness;
                out.rotary_per_area = density * thickness.powi(3) / 12.0;
            }
            Layup::Plies { plies, bottom } => {
                let total: f64 = plies.iter().map(|p| p.thickness).sum();
                let mut z = bottom.unwrap_or(-0.5 * total);
                // A laminate is flexible in shear when every ply is; one factor for the whole stack.
                let mut shear = Some(Matrix2::zeros());
                for ply in plies {
                    let (z0, z1) = (z, z + ply.thickness);
                    let q = rotate_plane_stress(&ply.material.plane_stress(), ply.angle_rad);
                    out.membrane += q * (z1 - z0);
                    out.coupling += q * (0.5 * (z1 * z1 - z0 * z0));
                    out.bending += q * ((z1.powi(3) - z0.powi(3)) / 3.0);
                    shear = shear
                        .zip(ply.material.transverse_shear())
                        .map(|(sum, g)| sum + rotate_transverse(&g, ply.angle_rad) * (SHEAR_FACTOR * ply.thickness));
                    out.mass_per_area += ply.material.density * ply.thickness;
                    out.rotary_per_area += ply.material.density * (z1.powi(3) - z0.powi(3)) / 3.0;
                    z = z1;
                }
                out.shear = shear;
            }
        }
        out
    }

    /// Checks materials, thickness and ratios.
    ///
    /// # Errors
    /// [`ModelError::BadValue`] naming the section.
    pub fn check(&self) -> Result<(), ModelError> {
        let place = format!("shell section {}", self.id);
        let bad = |name, needed, got: f64| {
            Err(ModelError::BadValue {
                place: place.clone(),
                name,
                needed,
                got: format!("{got:e}"),
            })
        };
        if !(self.nonstructural_mass.is_finite()) {
            return bad("the nonstructural mass", "a finite value", self.nonstructural_mass);
        }
        match &self.layup {
            Layup::Homogeneous {
                membrane,
                bending,
                bending_ratio,
                shear,
                shear_ratio,
            } => {
                for material in [membrane, bending, shear].into_iter().flatten() {
                    material.check(&place)?;
                }
                if !(self.thickness.is_finite() && self.thickness >= 0.0) {
                    return bad("the thickness", "a finite value of at least zero", self.thickness);
                }
                if !(*bending_ratio > 0.0 && bending_ratio.is_finite()) {
                    return bad("12 I / t^3", "a positive value", *bending_ratio);
                }
                if !(*shear_ratio > 0.0 && shear_ratio.is_finite()) {
                    return bad("the shear thickness ratio", "a positive value", *shear_ratio);
                }
            }
            Layup::Plies { plies, .. } => {
                for ply in plies {
                    ply.material.check(&place)?;
                    if !(ply.thickness > 0.0 && ply.thickness.is_finite()) {
                        return bad("a ply's thickness", "a positive value", ply.thickness);
                    }
                }
                if plies.is_empty() {
                    return bad("the number of plies", "at least 1", 0.0);
                }
            }
        }
        Ok(())
    }
}

/// What bars are made of (Nastran's PBAR with its MAT1).
#[derive(Debug, Clone, PartialEq)]
pub struct BarSection {
    /// Number, for messages.
    pub id: u32,
    /// Young's modulus.
    pub young: f64,
    /// Shear modulus.
    pub shear: f64,
    /// Mass per volume.
    pub density: f64,
    /// Area of the cross section.
    pub area: f64,
    /// Second moment of area for bending in plane 1 (displacement along the bar's y axis).
    pub i1: f64,
    /// Second moment of area for bending in plane 2 (displacement along the bar's z axis).
    pub i2: f64,
    /// Product moment of area.
    pub i12: f64,
    /// Torsion constant.
    pub j: f64,
    /// Shear area factor of plane 1; `None`: rigid in shear (Euler-Bernoulli).
    pub k1: Option<f64>,
    /// Shear area factor of plane 2; `None`: rigid in shear.
    pub k2: Option<f64>,
    /// Mass per length besides the material's.
    pub nonstructural_mass: f64,
    /// Polar mass moment of inertia per length about the bar's axis. Nastran's CBAR has none.
    pub polar_inertia: f64,
}

impl BarSection {
    /// A section without product moment, shear flexibility, nonstructural mass and polar inertia.
    #[expect(clippy::too_many_arguments, reason = "the eight numbers that define a plain section")]
    pub fn plain(id: u32, young: f64, shear: f64, density: f64, area: f64, i1: f64, i2: f64, j: f64) -> Self {
        Self {
            id,
            young,
            shear,
            density,
            area,
            i1,
            i2,
            i12: 0.0,
            j,
            k1: None,
            k2: None,
            nonstructural_mass: 0.0,
            polar_inertia: 0.0,
        }
    }

    /// Checks that stiffnesses and masses are finite and not negative.
    ///
    /// # Errors
    /// [`ModelError::BadValue`] naming the section.
    pub fn check(&self) -> Result<(), ModelError> {
        let place = || format!("bar section {}", self.id);
        let values = [
            ("Young's modulus", self.young),
            ("the shear modulus", self.shear),
            ("the density", self.density),
            ("the area", self.area),
            ("I1", self.i1),
            ("I2", self.i2),
            ("J", self.j),
            ("the polar inertia", self.polar_inertia),
            ("the shear factor K1", self.k1.unwrap_or(0.0)),
            ("the shear factor K2", self.k2.unwrap_or(0.0)),
        ];
        for (name, value) in values {
            if !(value.is_finite() && value >= 0.0) {
                return Err(ModelError::BadValue {
                    place: place(),
                    name,
                    needed: "a finite value of at least zero",
                    got: format!("{value:e}"),
                });
            }
        }
        if !(self.nonstructural_mass.is_finite()) {
            return Err(ModelError::BadValue {
                place: place(),
                name: "the nonstructural mass",
                needed: "a finite value",
                got: format!("{:e}", self.nonstructural_mass),
            });
        }
        // Both zero is a rod; otherwise the principal moments may not be negative.
        if !(self.i12.is_finite() && self.i12 * self.i12 <= self.i1 * self.i2 * (1.0 + 1e-12)) {
            return Err(ModelError::BadValue {
                place: place(),
                name: "I12",
                needed: "I12^2 <= I1 I2",
                got: format!("{:e}", self.i12),
            });
        }
        Ok(())
    }
}
