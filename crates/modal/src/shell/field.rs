//! Stiffness and mass of a section over the face of one element, in element axes.

use nalgebra::{Matrix2, Matrix3};

use crate::element::ShellThickness;
use crate::material::{rotate_plane_stress, rotate_transverse};
use crate::section::{ShellSection, ShellStiffness};

/// The section of one element with its thickness and material direction.
pub(crate) struct SectionField<'a> {
    section: &'a ShellSection,
    thickness: ShellThickness,
    angle_rad: f64,
    /// Kept when the thickness is one for the element.
    uniform: Option<ShellStiffness>,
}

impl<'a> SectionField<'a> {
    /// `angle_rad`: from the element's x axis to the material axis.
    pub fn new(section: &'a ShellSection, thickness: ShellThickness, angle_rad: f64) -> Self {
        let uniform = match thickness {
            ShellThickness::Section => Some(section.thickness),
            ShellThickness::Uniform(t) => Some(t),
            ShellThickness::Corner(_) | ShellThickness::Integration(_) => None,
        };
        let uniform = uniform.map(|t| turned(section.stiffness(t), angle_rad));
        Self {
            section,
            thickness,
            angle_rad,
            uniform,
        }
    }

    /// At an integration point: its number, and the shape functions of the corners there.
    pub fn at_point(&self, point: usize, shape: &[f64]) -> ShellStiffness {
        match self.thickness {
            ShellThickness::Integration(t) => self.with_thickness(t[point]),
            _ => self.at(shape),
        }
    }

    /// Anywhere, given the shape functions of the corners (for thicknesses at integration points:
    /// with their mean).
    pub fn at(&self, shape: &[f64]) -> ShellStiffness {
        if let Some(uniform) = &self.uniform {
            return uniform.clone();
        }
        let t = match self.thickness {
            ShellThickness::Corner(t) => shape.iter().zip(t).map(|(n, t)| n * t).sum(),
            ShellThickness::Integration(t) => t[..shape.len()].iter().sum::<f64>() / shape.len() as f64,
            ShellThickness::Section => self.section.thickness,
            ShellThickness::Uniform(t) => t,
        };
        self.with_thickness(t)
    }

    fn with_thickness(&self, thickness: f64) -> ShellStiffness {
        turned(self.section.stiffness(thickness), self.angle_rad)
    }
}

fn turned(mut s: ShellStiffness, angle_rad: f64) -> ShellStiffness {
    let turn = |m: &Matrix3<f64>| rotate_plane_stress(m, angle_rad);
    s.membrane = turn(&s.membrane);
    s.coupling = turn(&s.coupling);
    s.bending = turn(&s.bending);
    s.shear = s.shear.map(|g: Matrix2<f64>| rotate_transverse(&g, angle_rad));
    s
}
