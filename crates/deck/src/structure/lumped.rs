//! Concentrated masses, scalar elements, GENEL and matrices given directly.

use std::collections::BTreeMap;

use dip_modal::{DirectTerm, GeneralElement, GeneralMatrix, NodeDof, NodeMass, ScalarElement};
use dip_nastran::{
    Dof, Location,
    cards::{element::Scalar, mass::MassSystem, property::ScalarProperty},
    case_control::Subcase,
};
use nalgebra::{DMatrix, Matrix3, Matrix6, Vector3};

use super::{Builder, scalar_value};
use crate::error::{Result, misfit, missing};

impl Builder<'_> {
    pub(super) fn masses(&mut self) -> Result<()> {
        for mass in self.bulk.mass_matrices.values() {
            let card = || format!("CONM1 {}", mass.id);
            let (position, _) = self.grid(mass.grid, &mass.at, &card)?;
            let frame = self
                .geometry
                .frame(mass.coordinate)
                .ok_or_else(|| missing(&mass.at, card(), "coordinate system", mass.coordinate))?;
            self.model.masses.push(NodeMass::Matrix {
                id: mass.id,
                node: mass.grid,
                mass: Matrix6::from_fn(|i, j| mass.matrix[i][j]),
                axes: frame.directions(position),
            });
        }
        for mass in self.bulk.point_masses.values() {
            let card = || format!("CONM2 {}", mass.id);
            let (position, _) = self.grid(mass.grid, &mass.at, &card)?;
            let (axes, offset) = match mass.system {
                MassSystem::BasicPosition => (Matrix3::identity(), Vector3::from(mass.centre) - position),
                MassSystem::Coordinate(id) => {
                    let frame = self
                        .geometry
                        .frame(id)
                        .ok_or_else(|| missing(&mass.at, card(), "coordinate system", id))?;
                    (frame.directions(position), Vector3::from(mass.centre))
                }
            };
            let [i11, i21, i22, i31, i32, i33] = mass.inertia;
            self.model.masses.push(NodeMass::Point {
                id: mass.id,
                node: mass.grid,
                mass: mass.mass,
                offset,
                inertia: Matrix3::new(i11, -i21, -i31, -i21, i22, -i32, -i31, -i32, i33),
                axes,
            });
        }
        Ok(())
    }

    pub(super) fn scalars(&mut self) -> Result<()> {
        let bulk = self.bulk;
        for spring in bulk.springs.values() {
            let element = self.scalar(spring, &bulk.spring_values, "CELAS", "PELAS")?;
            self.model.springs.push(element);
        }
        for mass in bulk.scalar_masses.values() {
            let element = self.scalar(mass, &bulk.mass_values, "CMASS", "PMASS")?;
            self.model.scalar_masses.push(element);
        }
        Ok(())
    }

    fn scalar(
        &self,
        scalar: &Scalar,
        properties: &BTreeMap<u32, ScalarProperty>,
        name: &str,
        property: &'static str,
    ) -> Result<ScalarElement> {
        let card = || format!("{name} {}", scalar.id);
        let value = scalar_value(scalar, properties, &card, property)?;
        let [first, second] = scalar.ends;
        let end = |dof| self.dof(dof, &scalar.at, &card);
        // One end at least is no ground; which one does not matter.
        let (a, b) = match (first, second) {
            (Some(a), b) => (end(a)?, b.map(end).transpose()?),
            (None, Some(b)) => (end(b)?, None),
            (None, None) => return Err(misfit(&scalar.at, card(), "needs at least one point")),
        };
        Ok(ScalarElement {
            id: scalar.id,
            value,
            a,
            b,
        })
    }

    pub(super) fn general(&mut self) -> Result<()> {
        for genel in self.bulk.genels.values() {
            let card = || format!("GENEL {}", genel.id);
            let dofs = |list: &[Dof]| -> Result<Vec<NodeDof>> {
                list.iter().map(|d| self.dof(*d, &genel.at, &card)).collect()
            };
            let (elastic, support) = (dofs(&genel.elastic)?, dofs(&genel.support)?);
            let m = elastic.len();
            let matrix = DMatrix::from_row_slice(m, m, &genel.matrix);
            let s = match (support.is_empty(), genel.rigid.is_empty()) {
                (true, _) => None,
                (false, false) => Some(DMatrix::from_row_slice(m, support.len(), &genel.rigid)),
                (false, true) => Some(self.rigid_motion(&genel.elastic, &genel.support, &genel.at, &card)?),
            };
            self.model.general.push(GeneralElement {
                id: genel.id,
                dofs: elastic,
                rigid_dofs: support,
                matrix: if genel.is_stiffness {
                    GeneralMatrix::Stiffness(matrix)
                } else {
                    GeneralMatrix::Flexibility(matrix)
                },
                s,
            });
        }
        Ok(())
    }

    /// S of a GENEL that leaves it out: the rigid-body motion of the elastic degrees of freedom from six of the support.
    fn rigid_motion(
        &self,
        elastic: &[Dof],
        support: &[Dof],
        at: &Location,
        card: &dyn Fn() -> String,
    ) -> Result<DMatrix<f64>> {
        if support.len() != 6 {
            return Err(misfit(
                at,
                card(),
                "needs six UD degrees of freedom when it gives no S matrix",
            ));
        }
        let row = |dof: &Dof| -> Result<Vec<f64>> {
            let (position, axes) = self.grid(dof.point, at, card)?;
            let unit = axes.column(dof.component % 3).into_owned();
            let turn = if dof.component < 3 { position.cross(&unit) } else { unit };
            let shift = if dof.component < 3 { unit } else { Vector3::zeros() };
            // Motion of the point from a rigid motion (translation of the origin, rotation): u = t + w x r.
            Ok(shift.iter().chain(turn.iter()).copied().collect())
        };
        let rows = |list: &[Dof]| -> Result<DMatrix<f64>> {
            let data: Vec<f64> = list.iter().map(row).collect::<Result<Vec<_>>>()?.concat();
            Ok(DMatrix::from_row_slice(list.len(), 6, &data))
        };
        let base = rows(support)?
            .try_inverse()
            .ok_or_else(|| misfit(at, card(), "its UD degrees of freedom do not fix a rigid motion"))?;
        Ok(rows(elastic)? * base)
    }

    /// Matrices that the case control section selects by K2GG and M2GG.
    pub(super) fn direct(&mut self, subcase: &Subcase) -> Result<()> {
        for (name, is_mass) in [("K2GG", false), ("M2GG", true)] {
            let Some(setting) = subcase.settings.get(name) else {
                continue;
            };
            let terms = self.direct_terms(&setting.value, &setting.at)?;
            if is_mass {
                self.model.direct_mass = terms;
            } else {
                self.model.direct_stiffness = terms;
            }
        }
        Ok(())
    }

    fn direct_terms(&self, name: &str, at: &Location) -> Result<Vec<DirectTerm>> {
        let matrix = self
            .bulk
            .dof_matrices
            .get(&name.trim().to_uppercase())
            .ok_or_else(|| misfit(at, name, "no DMIG matrix of this name is in the bulk data"))?;
        let card = || format!("DMIG {}", matrix.name);
        let mut terms = Vec::new();
        for (row, column, value) in &matrix.terms {
            let (row, column) = (
                self.dof(*row, &matrix.at, &card)?,
                self.dof(*column, &matrix.at, &card)?,
            );
            terms.push(DirectTerm {
                row,
                column,
                value: *value,
            });
            if matrix.is_symmetric && row != column {
                terms.push(DirectTerm {
                    row: column,
                    column: row,
                    value: *value,
                });
            }
        }
        Ok(terms)
    }
}
