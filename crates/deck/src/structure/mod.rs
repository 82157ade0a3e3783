//! The bulk data's grid points, elements and constraints as a finite element model.

mod bars;
mod constraints;
mod lumped;
mod shells;

use std::collections::BTreeMap;

use dip_modal::{DofSet, MassForm, Model, Node, NodeDof};
use dip_nastran::{
    Components, Dof, Location, Note,
    bulk::Bulk,
    cards::{
        element::{Scalar, ScalarValue},
        property::ScalarProperty,
    },
    case_control::Subcase,
};
use nalgebra::{Matrix3, Vector3};

use crate::{
    coordinate::{Frame, Geometry},
    error::{Result, SolveError, misfit, missing},
};

/// Builds the model that a subcase selects.
///
/// # Errors
/// Cards that name missing ones or do not fit each other.
pub fn model(bulk: &Bulk, geometry: &Geometry, subcase: &Subcase, notes: &mut Vec<Note>) -> Result<Model> {
    let mut builder = Builder {
        bulk,
        geometry,
        model: Model::default(),
        notes,
    };
    builder.settings()?;
    builder.nodes()?;
    builder.bars()?;
    builder.rods()?;
    builder.shells()?;
    builder.masses()?;
    builder.scalars()?;
    builder.general()?;
    builder.direct(subcase)?;
    builder.rigid()?;
    builder.constraints(subcase)?;
    builder.sets(subcase)?;
    Ok(builder.model)
}

struct Builder<'a> {
    bulk: &'a Bulk,
    geometry: &'a Geometry,
    model: Model,
    notes: &'a mut Vec<Note>,
}

/// A set of components as the model's set.
pub(crate) fn dof_set(components: Components) -> DofSet {
    components
        .iter()
        .filter_map(dip_modal::Dof::from_index)
        .fold(DofSet::NONE, DofSet::with)
}

impl Builder<'_> {
    /// Parameters that the model depends on.
    fn settings(&mut self) -> Result<()> {
        let settings = &mut self.model.settings;
        let parameter = |name: &str| self.bulk.parameters.get(name);
        let deck = |error: dip_nastran::DeckError| SolveError::Deck(error.into());
        if let Some(p) = parameter("COUPMASS") {
            settings.mass = if p.integer().map_err(deck)? > 0 {
                MassForm::Consistent
            } else {
                MassForm::Lumped
            };
        }
        if let Some(p) = parameter("WTMASS") {
            settings.mass_scale = p.real().map_err(deck)?;
        }
        if let Some(p) = parameter("K6ROT") {
            settings.drilling = p.real().map_err(deck)?;
        }
        if parameter("AUTOSPC").is_some_and(|p| p.value == "NO") {
            settings.auto_support = None;
        }
        Ok(())
    }

    fn nodes(&mut self) -> Result<()> {
        for grid in self.bulk.grids.values() {
            let position = self.geometry.grid(grid.id).unwrap_or_else(Vector3::zeros);
            let card = || format!("GRID {}", grid.id);
            let frame = self
                .geometry
                .frame(grid.cd)
                .ok_or_else(|| missing(&grid.at, card(), "coordinate system", grid.cd))?;
            let node = Node::grid(grid.id, position.x, position.y, position.z);
            self.model.nodes.push(node.with_frame(frame.directions(position)));
            if !grid.ps.is_empty() {
                self.model.supports.push((grid.id, dof_set(grid.ps)));
            }
        }
        for id in &self.bulk.scalar_points {
            if self.bulk.grids.contains_key(id) {
                return Err(SolveError::Missing {
                    what: format!("has {id} as a grid and as a scalar point; renumber one"),
                });
            }
            self.model.nodes.push(Node::scalar(*id));
        }
        Ok(())
    }

    /// Position and displacement directions of a grid point that a card names.
    fn grid(&self, id: u32, at: &Location, card: &dyn Fn() -> String) -> Result<(Vector3<f64>, Matrix3<f64>)> {
        let (Some(grid), Some(position)) = (self.bulk.grids.get(&id), self.geometry.grid(id)) else {
            return Err(missing(at, card(), "GRID", id));
        };
        let frame = self.geometry.frame(grid.cd).unwrap_or(&Frame::BASIC);
        Ok((position, frame.directions(position)))
    }

    fn has_point(&self, id: u32) -> bool {
        self.bulk.grids.contains_key(&id) || self.bulk.scalar_points.contains(&id)
    }

    /// A degree of freedom that a card names.
    fn dof(&self, dof: Dof, at: &Location, card: &dyn Fn() -> String) -> Result<NodeDof> {
        if !self.has_point(dof.point) {
            return Err(missing(at, card(), "GRID or SPOINT", dof.point));
        }
        match dip_modal::Dof::from_index(dof.component) {
            Some(d) => Ok(NodeDof::new(dof.point, d)),
            None => Err(misfit(at, card(), "a component must be 0 to 6")),
        }
    }
}

/// Stiffness, mass or damping of a scalar element.
pub(crate) fn scalar_value(
    scalar: &Scalar,
    properties: &BTreeMap<u32, ScalarProperty>,
    card: &dyn Fn() -> String,
    property: &'static str,
) -> Result<f64> {
    match scalar.value {
        ScalarValue::Direct(value) => Ok(value),
        ScalarValue::Property(id) => properties
            .get(&id)
            .map(|p| p.value)
            .ok_or_else(|| missing(&scalar.at, card(), property, id)),
    }
}

/// The set that a subcase selects by a statement, and where it does.
pub(crate) fn selected(subcase: &Subcase, name: &str) -> Result<Option<(u32, Location)>> {
    let Some(setting) = subcase.settings.get(name) else {
        return Ok(None);
    };
    let id = setting.id(name).map_err(|e| SolveError::Deck(e.into()))?;
    Ok(id.map(|id| (id, setting.at.clone())))
}
