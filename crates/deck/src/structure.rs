//! The bulk data's grid points, elements and constraints as a finite element model.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use dip_modal::{
    AverageElement, Bar, BarSection, DirectTerm, DofSet, Elasticity, Equation, GeneralElement, GeneralMatrix, Layup,
    MassForm, Material, MaterialAxis, Model, Node, NodeDof, NodeMass, Ply, RigidElement, ScalarElement, Shell,
    ShellNodes, ShellSection, ShellThickness,
};
use dip_nastran::{
    Components, Dof, Location, Note, Severity,
    bulk::Bulk,
    cards::{
        constraint,
        element::{MaterialDirection, Orientation, RodSectionRef, Scalar, ScalarValue},
        mass::MassSystem,
        property::{ElasticLaw, Laminate, RodSection, ScalarProperty, ShellSection as DeckShellSection},
    },
    case_control::Subcase,
};
use nalgebra::{DMatrix, Matrix2, Matrix3, Matrix6, Vector3};

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

    fn bars(&mut self) -> Result<()> {
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

    fn rods(&mut self) -> Result<()> {
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

    fn shells(&mut self) -> Result<()> {
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

    fn masses(&mut self) -> Result<()> {
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

    fn scalars(&mut self) -> Result<()> {
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

    fn general(&mut self) -> Result<()> {
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
    fn direct(&mut self, subcase: &Subcase) -> Result<()> {
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

    fn rigid(&mut self) -> Result<()> {
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

    fn constraints(&mut self, subcase: &Subcase) -> Result<()> {
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
    fn sets(&mut self, subcase: &Subcase) -> Result<()> {
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

fn union(set: u32, members: Option<&[u32]>) -> Vec<u32> {
    let mut list = vec![set];
    list.extend(members.unwrap_or(&[]));
    list
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
