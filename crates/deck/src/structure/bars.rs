//! CBAR, CBEAM, CROD and CONROD with their sections.

use std::collections::HashMap;

use dip_modal::{Bar, BarSection, DofSet};
use dip_nastran::{
    Location,
    cards::{
        element::{Orientation, RodSectionRef},
        material::ElasticLaw,
        property::RodSection,
    },
};
use nalgebra::Vector3;

use super::{Builder, dof_set};
use crate::error::{Result, misfit, missing};

impl Builder<'_> {
    /// Moduli of a bar's or rod's material, and its density.
    fn bar_material(&mut self, id: u32, at: &Location, card: &dyn Fn() -> String) -> Result<(f64, f64, f64)> {
        let material = self
            .bulk
            .materials
            .get(&id)
            .ok_or_else(|| missing(at, card(), "MAT1", id))?;
        let ElasticLaw::Isotropic { e, g, .. } = material.law else {
            return Err(misfit(
                at,
                card(),
                format!("needs an isotropic material (MAT1), got {id}"),
            ));
        };
        Ok((e, g, material.density))
    }

    pub(super) fn bars(&mut self) -> Result<()> {
        let bulk = self.bulk;
        let mut places = HashMap::new();
        for section in bulk.bar_sections.values() {
            let card = || format!("PBAR {}", section.id);
            let (young, shear, density) = self.bar_material(section.material, &section.at, &card)?;
            places.insert(section.id, self.model.bar_sections.len());
            self.model.bar_sections.push(BarSection {
                i12: section.i12,
                k1: section.shear_factors[0],
                k2: section.shear_factors[1],
                nonstructural_mass: section.nonstructural_mass,
                ..BarSection::plain(
                    section.id,
                    young,
                    shear,
                    density,
                    section.area,
                    section.i1,
                    section.i2,
                    section.torsion_constant,
                )
            });
        }
        for bar in bulk.bars.values() {
            let name = if bar.is_beam { "CBEAM" } else { "CBAR" };
            let card = || format!("{name} {}", bar.id);
            let section = *places
                .get(&bar.property)
                .ok_or_else(|| missing(&bar.at, card(), "PBAR, PBARL or PBEAM", bar.property))?;
            let (position, axes) = self.grid(bar.grids[0], &bar.at, &card)?;
            let (_, axes_b) = self.grid(bar.grids[1], &bar.at, &card)?;
            let orientation = match bar.orientation {
                Orientation::Vector(v) => axes * Vector3::from(v),
                Orientation::BasicVector(v) => Vector3::from(v),
                Orientation::Grid(id) => self.grid(id, &bar.at, &card)?.0 - position,
            };
            self.model.bars.push(Bar {
                id: bar.id,
                nodes: bar.grids,
                section,
                orientation,
                offsets: [
                    axes * Vector3::from(bar.offsets[0]),
                    axes_b * Vector3::from(bar.offsets[1]),
                ],
                pins: bar.pins.map(dof_set),
            });
        }
        Ok(())
    }

    pub(super) fn rods(&mut self) -> Result<()> {
        let bulk = self.bulk;
        let mut places = HashMap::new();
        for section in bulk.rod_sections.values() {
            places.insert(section.id, self.rod_section(section, "PROD")?);
        }
        for rod in bulk.rods.values() {
            let card = || format!("CROD {}", rod.id);
            let section = match &rod.section {
                RodSectionRef::Property(id) => *places.get(id).ok_or_else(|| missing(&rod.at, card(), "PROD", *id))?,
                RodSectionRef::Own(section) => self.rod_section(section, "CONROD")?,
            };
            for grid in rod.grids {
                self.grid(grid, &rod.at, &card)?;
            }
            self.model.bars.push(Bar {
                id: rod.id,
                nodes: rod.grids,
                section,
                orientation: Vector3::zeros(),
                offsets: [Vector3::zeros(); 2],
                pins: [DofSet::NONE; 2],
            });
        }
        Ok(())
    }

    fn rod_section(&mut self, section: &RodSection, name: &str) -> Result<usize> {
        let card = || format!("{name} {}", section.id);
        let (young, shear, density) = self.bar_material(section.material, &section.at, &card)?;
        self.model.bar_sections.push(BarSection {
            nonstructural_mass: section.nonstructural_mass,
            ..BarSection::plain(
                section.id,
                young,
                shear,
                density,
                section.area,
                0.0,
                0.0,
                section.torsion_constant,
            )
        });
        Ok(self.model.bar_sections.len() - 1)
    }
}
