//! CQUAD4 and CTRIA3 with PSHELL and PCOMP.

use std::collections::HashMap;

use dip_modal::{Elasticity, Layup, Material, MaterialAxis, Ply, Shell, ShellNodes, ShellSection, ShellThickness};
use dip_nastran::cards::{
    element::MaterialDirection,
    material::ElasticLaw,
    property::{Laminate, ShellSection as DeckShellSection},
};
use nalgebra::{Matrix2, Matrix3, Vector3};

use super::Builder;
use crate::error::{Result, misfit, missing};

impl Builder<'_> {
    pub(super) fn shells(&mut self) -> Result<()> {
        let bulk = self.bulk;
        let mut places = HashMap::new();
        for section in bulk.shell_sections.values() {
            places.insert(section.id, self.model.shell_sections.len());
            let section = self.shell_section(section)?;
            self.model.shell_sections.push(section);
        }
        for laminate in bulk.laminates.values() {
            if places.insert(laminate.id, self.model.shell_sections.len()).is_some() {
                return Err(misfit(
                    &laminate.at,
                    format!("PCOMP {}", laminate.id),
                    "a PSHELL has the same number",
                ));
            }
            let section = self.laminate(laminate)?;
            self.model.shell_sections.push(section);
        }
        for shell in bulk.shells.values() {
            let name = if shell.grids.len() == 3 { "CTRIA3" } else { "CQUAD4" };
            let card = || format!("{name} {}", shell.id);
            let section = *places
                .get(&shell.property)
                .ok_or_else(|| missing(&shell.at, card(), "PSHELL or PCOMP", shell.property))?;
            let given = bulk.shell_sections.get(&shell.property).map(|p| p.thickness);
            let (has_plies, default_thickness) = (given.is_none(), given.flatten());
            for grid in &shell.grids {
                self.grid(*grid, &shell.at, &card)?;
            }
            let thickness = if has_plies || shell.thickness.iter().all(Option::is_none) {
                if default_thickness.is_none() && !has_plies {
                    return Err(misfit(
                        &shell.at,
                        card(),
                        format!("neither it nor PSHELL {} gives a thickness", shell.property),
                    ));
                }
                ShellThickness::Section
            } else {
                let mut corners = [0.0; 4];
                for (corner, given) in corners.iter_mut().zip(&shell.thickness) {
                    let scale = if shell.relative_thickness {
                        default_thickness.unwrap_or(0.0)
                    } else {
                        1.0
                    };
                    *corner = match (given, default_thickness) {
                        (Some(t), _) => t * scale,
                        (None, Some(t)) => t,
                        (None, None) => return Err(misfit(&shell.at, card(), "needs a thickness at every corner")),
                    };
                }
                ShellThickness::Corner(corners)
            };
            let axis = match shell.material_direction {
                MaterialDirection::Angle(degrees) => MaterialAxis::Angle(degrees.to_radians()),
                MaterialDirection::Coordinate(id) => {
                    let frame = self
                        .geometry
                        .frame(id)
                        .ok_or_else(|| missing(&shell.at, card(), "coordinate system", id))?;
                    let centre = shell
                        .grids
                        .iter()
                        .filter_map(|g| self.geometry.grid(*g))
                        .sum::<Vector3<f64>>()
                        / shell.grids.len() as f64;
                    MaterialAxis::Along(frame.directions(centre).column(0).into_owned())
                }
            };
            let g = &shell.grids;
            self.model.shells.push(Shell {
                id: shell.id,
                nodes: match g.as_slice() {
                    [a, b, c] => ShellNodes::Triangle([*a, *b, *c]),
                    _ => ShellNodes::Quad([g[0], g[1], g[2], g[3]]),
                },
                section,
                thickness,
                axis,
                offset: shell.offset,
            });
        }
        Ok(())
    }

    fn shell_section(&self, section: &DeckShellSection) -> Result<ShellSection> {
        let card = || format!("PSHELL {}", section.id);
        let material = |id: Option<u32>| -> Result<Option<Material>> {
            let Some(id) = id else { return Ok(None) };
            let m = self
                .bulk
                .materials
                .get(&id)
                .ok_or_else(|| missing(&section.at, card(), "MAT1, MAT2 or MAT8", id))?;
            Ok(Some(Material {
                elasticity: elasticity(m.law),
                density: m.density,
            }))
        };
        let shear = match section.shear.and_then(|id| self.bulk.materials.get(&id)) {
            // Under MID3 the terms of MAT2 are transverse shear moduli.
            Some(m) => match m.law {
                ElasticLaw::Anisotropic { g } => Some(Material {
                    elasticity: Elasticity::Anisotropic {
                        stiffness: Matrix3::identity() * g[0],
                        transverse: Some(Matrix2::new(g[0], g[1], g[1], g[3])),
                    },
                    density: m.density,
                }),
                // A vanishing shear modulus means no shear deformation.
                ElasticLaw::Isotropic { g: 0.0, .. } => None,
                ElasticLaw::Orthotropic { g_transverse, .. } if g_transverse.contains(&0.0) => None,
                _ => material(section.shear)?,
            },
            None => material(section.shear)?,
        };
        Ok(ShellSection {
            id: section.id,
            thickness: section.thickness.unwrap_or(0.0),
            nonstructural_mass: section.nonstructural_mass,
            layup: Layup::Homogeneous {
                membrane: material(section.membrane)?,
                bending: material(section.bending)?,
                bending_ratio: section.bending_ratio,
                shear,
                shear_ratio: section.shear_ratio,
            },
        })
    }

    fn laminate(&self, laminate: &Laminate) -> Result<ShellSection> {
        let card = || format!("PCOMP {}", laminate.id);
        let plies = laminate
            .plies
            .iter()
            .map(|ply| {
                let material = self
                    .bulk
                    .materials
                    .get(&ply.material)
                    .ok_or_else(|| missing(&laminate.at, card(), "MAT1, MAT2 or MAT8", ply.material))?;
                Ok(Ply {
                    material: Material {
                        elasticity: elasticity(material.law),
                        density: material.density,
                    },
                    thickness: ply.thickness,
                    angle_rad: ply.angle_deg.to_radians(),
                })
            })
            .collect::<Result<Vec<_>>>()?;
        Ok(ShellSection {
            id: laminate.id,
            thickness: plies.iter().map(|p| p.thickness).sum(),
            nonstructural_mass: laminate.nonstructural_mass,
            layup: Layup::Plies {
                plies,
                bottom: laminate.bottom,
            },
        })
    }
}

fn elasticity(law: ElasticLaw) -> Elasticity {
    match law {
        ElasticLaw::Isotropic { e, g, nu } => Elasticity::Isotropic {
            young: e,
            poisson: nu,
            shear: g,
        },
        ElasticLaw::Anisotropic {
            g: [g11, g12, g13, g22, g23, g33],
        } => Elasticity::Anisotropic {
            stiffness: Matrix3::new(g11, g12, g13, g12, g22, g23, g13, g23, g33),
            transverse: None,
        },
        ElasticLaw::Orthotropic {
            e1,
            e2,
            nu12,
            g12,
            g_transverse: [g1z, g2z],
        } => Elasticity::Orthotropic {
            young_1: e1,
            young_2: e2,
            poisson_12: nu12,
            shear_12: g12,
            // Nastran's blank G1Z or G2Z: infinite.
            shear_1z: (g1z != 0.0).then_some(g1z),
            shear_2z: (g2z != 0.0).then_some(g2z),
        },
    }
}
