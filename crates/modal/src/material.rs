//! Elastic materials of shells in plane stress, and of bars.
//!
//! Any consistent set of units (Pa and kg/m^3 in our own cases; psi and lbf s^2/in^4 in many decks).

use nalgebra::{Matrix2, Matrix3};

use crate::error::ModelError;

/// A linear elastic material in plane stress: stress = Q strain, with strain (e1, e2, gamma12).
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Elastic constants.
    pub elasticity: Elasticity,
    /// Mass per volume.
    pub density: f64,
}

/// Elastic constants in the material's own axes 1, 2.
#[derive(Debug, Clone, PartialEq)]
pub enum Elasticity {
    /// Young's modulus and Poisson's ratio, and a shear modulus that may differ from
    /// E / (2 (1 + nu)) as Nastran's MAT1 allows.
    Isotropic {
        /// Young's modulus.
        young: f64,
        /// Poisson's ratio.
        poisson: f64,
        /// Shear modulus.
        shear: f64,
    },
    /// Nastran's MAT8.
    Orthotropic {
        /// Young's modulus along axis 1.
        young_1: f64,
        /// Young's modulus along axis 2.
        young_2: f64,
        /// Strain along 2 per strain along 1 under stress along 1.
        poisson_12: f64,
        /// In-plane shear modulus.
        shear_12: f64,
        /// Transverse shear modulus in the plane 1-z; `None`: rigid in transverse shear.
        shear_1z: Option<f64>,
        /// Transverse shear modulus in the plane 2-z; `None`: rigid in transverse shear.
        shear_2z: Option<f64>,
    },
    /// Nastran's MAT2: the full symmetric plane-stress matrix.
    Anisotropic {
        /// Stress per strain, [row = s1, s2, t12][column = e1, e2, gamma12].
        stiffness: Matrix3<f64>,
        /// Transverse shear, [row = t1z, t2z][column = gamma1z, gamma2z]; `None`: rigid.
        transverse: Option<Matrix2<f64>>,
    },
}

impl Material {
    /// An isotropic material with G = E / (2 (1 + nu)).
    pub fn isotropic(young: f64, poisson: f64, density: f64) -> Self {
        let shear = young / (2.0 * (1.0 + poisson));
        Self {
            elasticity: Elasticity::Isotropic { young, poisson, shear },
            density,
        }
    }

    /// An orthotropic material that is rigid in transverse shear (thin plates).
    pub fn orthotropic(young_1: f64, young_2: f64, poisson_12: f64, shear_12: f64, density: f64) -> Self {
        let elasticity = Elasticity::Orthotropic {
            young_1,
            young_2,
            poisson_12,
            shear_12,
            shear_1z: None,
            shear_2z: None,
        };
        Self { elasticity, density }
    }

    /// Plane-stress matrix [row = s1, s2, t12][column = e1, e2, gamma12] in material axes.
    /// Jones, Mechanics of Composite Materials, (2.70); isotropic as its special case, with the
    /// shear modulus as given.
    pub fn plane_stress(&self) -> Matrix3<f64> {
        match self.elasticity {
            Elasticity::Isotropic { young, poisson, shear } => {
                let q = young / (1.0 - poisson * poisson);
                Matrix3::new(q, poisson * q, 0.0, poisson * q, q, 0.0, 0.0, 0.0, shear)
            }
            Elasticity::Orthotropic {
                young_1,
                young_2,
                poisson_12,
                shear_12,
                ..
            } => {
                let poisson_21 = poisson_12 * young_2 / young_1;
                let scale = 1.0 / (1.0 - poisson_12 * poisson_21);
                let q12 = poisson_12 * young_2 * scale;
                Matrix3::new(young_1 * scale, q12, 0.0, q12, young_2 * scale, 0.0, 0.0, 0.0, shear_12)
            }
            Elasticity::Anisotropic { stiffness, .. } => stiffness,
        }
    }

    /// Transverse shear matrix [row = t1z, t2z][column = gamma1z, gamma2z] in material axes without
    /// a shear factor; `None` when the material is rigid in transverse shear.
    pub fn transverse_shear(&self) -> Option<Matrix2<f64>> {
        match self.elasticity {
            Elasticity::Isotropic { shear, .. } => Some(Matrix2::identity() * shear),
            Elasticity::Orthotropic { shear_1z, shear_2z, .. } => Some(Matrix2::new(shear_1z?, 0.0, 0.0, shear_2z?)),
            Elasticity::Anisotropic { transverse, .. } => transverse,
        }
    }

    /// Checks that the energy is positive for every strain and the density not negative.
    ///
    /// # Errors
    /// [`ModelError::BadValue`] naming `place`.
    pub fn check(&self, place: &str) -> Result<(), ModelError> {
        let bad = |name, needed, got| {
            Err(ModelError::BadValue {
                place: place.to_owned(),
                name,
                needed,
                got,
            })
        };
        if !(self.density.is_finite() && self.density >= 0.0) {
            return bad(
                "density",
                "a finite value of at least zero",
                format!("{:e}", self.density),
            );
        }
        let q = self.plane_stress();
        if (q - q.transpose()).abs().max() > 1e-9 * q.abs().max() {
            return bad("the plane-stress matrix", "symmetry", format!("{q}"));
        }
        if q.iter().any(|v| !v.is_finite()) || q.cholesky().is_none() {
            return bad(
                "the elastic constants",
                "a positive definite plane-stress matrix (E > 0, G > 0, nu12^2 < E1/E2)",
                format!("{:?}", self.elasticity),
            );
        }
        if let Some(s) = self.transverse_shear()
            && (s.iter().any(|v| !v.is_finite()) || s.cholesky().is_none())
        {
            return bad(
                "the transverse shear moduli",
                "a positive definite matrix",
                format!("{s}"),
            );
        }
        Ok(())
    }
}

/// Plane-stress matrix turned from material axes to element axes; `angle_rad` is the angle from the
/// element's x axis to the material's 1 axis. With T the strain transformation
/// (e1, e2, g12) = T (ex, ey, gxy), the result is T^T Q T.
pub fn rotate_plane_stress(q: &Matrix3<f64>, angle_rad: f64) -> Matrix3<f64> {
    let (s, c) = angle_rad.sin_cos();
    let t = Matrix3::new(
        c * c,
        s * s,
        s * c, //
        s * s,
        c * c,
        -s * c, //
        -2.0 * s * c,
        2.0 * s * c,
        c * c - s * s,
    );
    t.transpose() * q * t
}

/// Transverse shear matrix turned from material axes to element axes, as [`rotate_plane_stress`].
pub fn rotate_transverse(g: &Matrix2<f64>, angle_rad: f64) -> Matrix2<f64> {
    let (s, c) = angle_rad.sin_cos();
    let t = Matrix2::new(c, s, -s, c);
    t.transpose() * g * t
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn turning_by_a_right_angle_swaps_the_axes() {
        let m = Material::orthotropic(3.0e9, 0.4e9, 0.31, 0.44e9, 380.0);
        let q = m.plane_stress();
        let r = rotate_plane_stress(&q, std::f64::consts::FRAC_PI_2);
        assert_relative_eq!(r[(0, 0)], q[(1, 1)], max_relative = 1e-12);
        assert_relative_eq!(r[(1, 1)], q[(0, 0)], max_relative = 1e-12);
        assert_relative_eq!(r[(0, 1)], q[(0, 1)], max_relative = 1e-12);
        assert_relative_eq!(r[(2, 2)], q[(2, 2)], max_relative = 1e-12);
    }

    #[test]
    fn stiffness_along_the_fibre_at_45_degrees_is_the_known_sum() {
        // Jones (2.85): Qbar11 at 45 deg = (Q11 + Q22 + 2 Q12 + 4 Q66) / 4.
        let q = Material::orthotropic(3.0e9, 0.4e9, 0.31, 0.44e9, 380.0).plane_stress();
        let r = rotate_plane_stress(&q, std::f64::consts::FRAC_PI_4);
        let expected = (q[(0, 0)] + q[(1, 1)] + 2.0 * q[(0, 1)] + 4.0 * q[(2, 2)]) / 4.0;
        assert_relative_eq!(r[(0, 0)], expected, max_relative = 1e-12);
    }

    #[test]
    fn impossible_constants_are_refused() {
        let m = Material::orthotropic(1.0, 1.0, 1.2, 0.4, 1.0);
        assert!(matches!(m.check("material 7"), Err(ModelError::BadValue { .. })));
        assert!(Material::isotropic(f64::NAN, 0.3, 1.0).check("material 8").is_err());
        assert!(Material::isotropic(70e9, 0.3, -1.0).check("material 9").is_err());
    }
}
