//! Rigid elements, MPC, SPC and the sets of degrees of freedom.

use std::collections::{BTreeMap, BTreeSet};

use dip_modal::{AverageElement, DofSet, Equation, RigidElement};
use dip_nastran::{Components, Note, Severity, cards::constraint, case_control::Subcase};

use super::{Builder, dof_set, selected};
use crate::error::{Result, missing};

impl Builder<'_> {
    pub(super) fn rigid(&mut self) -> Result<()> {
        for body in self.bulk.rigid_bodies.values() {
            let card = || format!("RBE2 {}", body.id);
            for grid in body.dependent.iter().chain([&body.independent]) {
                self.grid(*grid, &body.at, &card)?;
            }
            let components = dof_set(body.components);
            self.model.rigid.push(RigidElement::rbe2(
                body.id,
                body.independent,
                components,
                &body.dependent,
            ));
        }
        for bar in self.bulk.rigid_bars.values() {
            let card = || format!("RBAR {}", bar.id);
            for grid in bar.grids {
                self.grid(grid, &bar.at, &card)?;
            }
            let ends = |sets: [Components; 2]| -> Vec<(u32, DofSet)> {
                (0..2)
                    .filter(|i| !sets[*i].is_empty())
                    .map(|i| (bar.grids[i], dof_set(sets[i])))
                    .collect()
            };
            self.model.rigid.push(RigidElement {
                id: bar.id,
                independent: ends(bar.independent),
                dependent: ends(bar.dependent),
            });
        }
        for mean in self.bulk.interpolations.values() {
            let card = || format!("RBE3 {}", mean.id);
            for grid in mean
                .groups
                .iter()
                .flat_map(|(_, _, grids)| grids)
                .chain([&mean.reference])
            {
                self.grid(*grid, &mean.at, &card)?;
            }
            self.model.averages.push(AverageElement {
                id: mean.id,
                reference: (mean.reference, dof_set(mean.components)),
                terms: mean
                    .groups
                    .iter()
                    .map(|(w, c, g)| (*w, dof_set(*c), g.clone()))
                    .collect(),
                dependent: Vec::new(),
            });
        }
        Ok(())
    }

    pub(super) fn constraints(&mut self, subcase: &Subcase) -> Result<()> {
        let bulk = self.bulk;
        if let Some((set, at)) = selected(subcase, "MPC")? {
            let members = union(set, bulk.equation_unions.get(&set).map(|u| u.ids.as_slice()));
            let mut found = false;
            for member in members {
                for equation in bulk.equations.get(&member).into_iter().flatten() {
                    found = true;
                    let card = || format!("MPC {member}");
                    let terms = equation
                        .terms
                        .iter()
                        .map(|(dof, a)| Ok((self.dof(*dof, &equation.at, &card)?, *a)))
                        .collect::<Result<_>>()?;
                    self.model.equations.push(Equation { id: member, terms });
                }
            }
            if !found {
                return Err(missing(&at, format!("MPC = {set}"), "MPC or MPCADD", set));
            }
        }
        if let Some((set, at)) = selected(subcase, "SPC")? {
            let members = union(set, bulk.constraint_unions.get(&set).map(|u| u.ids.as_slice()));
            let mut found = false;
            for member in members {
                for fixed in bulk.constraints.get(&member).into_iter().flatten() {
                    found = true;
                    let list = self.listed(fixed, &format!("SPC {member}"))?;
                    self.model.supports.extend(list);
                }
            }
            if !found {
                return Err(missing(&at, format!("SPC = {set}"), "SPC, SPC1 or SPCADD", set));
            }
        }
        Ok(())
    }

    /// Points and components of a list; points of a THRU range need not exist.
    fn listed(&self, set: &constraint::DofSet, card: &str) -> Result<Vec<(u32, DofSet)>> {
        let mut found = Vec::new();
        for point in &set.points {
            if !self.has_point(*point) {
                if set.is_range {
                    continue;
                }
                return Err(missing(&set.at, card.to_owned(), "GRID or SPOINT", *point));
            }
            let is_scalar = self.bulk.scalar_points.contains(point);
            let dofs = if is_scalar {
                DofSet::from(dip_modal::Dof::T1)
            } else {
                dof_set(set.components)
            };
            found.push((*point, dofs));
        }
        Ok(found)
    }

    /// Analysis set and rigid-body supports.
    pub(super) fn sets(&mut self, subcase: &Subcase) -> Result<()> {
        let bulk = self.bulk;
        let mut free = Vec::new();
        for support in &bulk.supports {
            free.extend(self.listed(support, "SUPORT")?);
        }
        if let Some((set, at)) = selected(subcase, "SUPORT1")? {
            let sets = bulk
                .support_sets
                .get(&set)
                .ok_or_else(|| missing(&at, "SUPORT1".to_owned(), "SUPORT1", set))?;
            for support in sets {
                free.extend(self.listed(support, "SUPORT1")?);
            }
        }
        let mut analysis = Vec::new();
        for set in &bulk.analysis_sets {
            analysis.extend(self.listed(set, "ASET")?);
        }
        if analysis.is_empty() && !bulk.omitted_sets.is_empty() {
            let mut omitted: BTreeMap<u32, BTreeSet<usize>> = BTreeMap::new();
            for set in &bulk.omitted_sets {
                for (point, dofs) in self.listed(set, "OMIT")? {
                    omitted
                        .entry(point)
                        .or_default()
                        .extend(dofs.iter().map(dip_modal::Dof::index));
                }
            }
            for node in &self.model.nodes {
                let gone = omitted.get(&node.id);
                let kept = DofSet::ALL
                    .iter()
                    .filter(|d| !gone.is_some_and(|g| g.contains(&d.index())))
                    .fold(DofSet::NONE, DofSet::with);
                if !kept.is_empty() {
                    analysis.push((node.id, kept));
                }
            }
        }
        if !analysis.is_empty() {
            analysis.extend(free.iter().copied());
        }
        self.model.analysis_set = analysis;
        self.model.keep_free = free;
        for material in bulk.materials.values().filter(|m| m.damping != 0.0) {
            self.notes.push(Note {
                at: material.at.clone(),
                card: format!("MAT {}", material.id),
                severity: Severity::Warning,
                text: "material damping GE is not used; give structural damping by SDAMPING or PARAM G".to_owned(),
            });
        }
        Ok(())
    }
}

fn union(set: u32, members: Option<&[u32]>) -> Vec<u32> {
    let mut list = vec![set];
    list.extend(members.unwrap_or(&[]));
    list
}
