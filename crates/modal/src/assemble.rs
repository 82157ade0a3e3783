//! From elements to the sparse stiffness and mass of all nodes, in node frames.
//!
//! Row and column 6 x node + degree of freedom. Elements are integrated in parallel, chunk by chunk,
//! and added in the order of the model, so the result does not depend on threads.

use nalgebra::{DMatrix, Matrix3, Vector3};
use rayon::prelude::*;
use sprs::{CsMat, TriMat};

use crate::bar;
use crate::dof::DOFS_PER_NODE;
use crate::element::{DirectTerm, ScalarElement};
use crate::error::ModelError;
use crate::lumped::{general_stiffness, node_mass};
use crate::model::{Model, NodeIndex};
use crate::shell;

/// Elements integrated before their matrices are added: bounds the memory of the element matrices.
const CHUNK: usize = 2048;

/// Matrices of all nodes, each symmetric and stored in full.
#[derive(Debug, Clone)]
pub(crate) struct NodeMatrices {
    pub stiffness: CsMat<f64>,
    pub mass: CsMat<f64>,
}

struct Triplets<'a> {
    model: &'a Model,
    stiffness: TriMat<f64>,
    mass: TriMat<f64>,
}

/// Assembles every element of the model.
pub(crate) fn assemble(model: &Model, index: &NodeIndex) -> Result<NodeMatrices, ModelError> {
    for section in &model.shell_sections {
        section.check()?;
    }
    for section in &model.bar_sections {
        section.check()?;
    }
    check_settings(model)?;
    let size = DOFS_PER_NODE * model.nodes.len();
    let mut out = Triplets {
        model,
        stiffness: TriMat::new((size, size)),
        mass: TriMat::new((size, size)),
    };
    let scale = model.settings.mass_scale;
    for chunk in model.shells.chunks(CHUNK) {
        let parts: Vec<_> = chunk.par_iter().map(|s| shell_matrices(model, index, s)).collect();
        // The first bad element in the order of the model is reported, whatever thread met one first.
        for part in parts {
            let (nodes, m) = &part?;
            out.add(nodes, &m.stiffness, 1.0, Kind::Stiffness);
            out.add(nodes, &m.mass, scale, Kind::Mass);
        }
    }
    for chunk in model.bars.chunks(CHUNK) {
        let parts: Vec<_> = chunk.par_iter().map(|b| bar_matrices(model, index, b)).collect();
        // The first bad element in the order of the model is reported, whatever thread met one first.
        for part in parts {
            let (nodes, m) = &part?;
            out.add(nodes, &m.stiffness, 1.0, Kind::Stiffness);
            out.add(nodes, &m.mass, scale, Kind::Mass);
        }
    }
    for mass in &model.masses {
        let (node, matrix) = node_mass(mass)?;
        let node = index.find_grid(node, || "a concentrated mass".to_owned())?;
        out.add(
            &[node],
            &DMatrix::from_fn(6, 6, |i, j| matrix[(i, j)]),
            scale,
            Kind::Mass,
        );
    }
    out.scalar(index, &model.springs, 1.0, Kind::Stiffness)?;
    out.scalar(index, &model.scalar_masses, scale, Kind::Mass)?;
    for element in &model.general {
        let k = general_stiffness(element)?;
        let places = element
            .dofs
            .iter()
            .chain(&element.rigid_dofs)
            .map(|d| index.find_dof(*d, || format!("general element {}", element.id)))
            .collect::<Result<Vec<_>, _>>()?;
        for (i, &row) in places.iter().enumerate() {
            for (j, &column) in places.iter().enumerate() {
                add_term(&mut out.stiffness, row, column, k[(i, j)]);
            }
        }
    }
    add_direct(
        &mut out.stiffness,
        index,
        &model.direct_stiffness,
        "a direct stiffness term",
    )?;
    add_direct(&mut out.mass, index, &model.direct_mass, "a direct mass term")?;
    Ok(NodeMatrices {
        stiffness: out.stiffness.to_csr(),
        mass: out.mass.to_csr(),
    })
}

fn check_settings(model: &Model) -> Result<(), ModelError> {
    let s = &model.settings;
    let values = [
        ("the drilling stiffness", s.drilling, s.drilling >= 0.0),
        ("the mass scale", s.mass_scale, s.mass_scale > 0.0),
        (
            "the limit of automatic support",
            s.auto_support.unwrap_or(0.0),
            s.auto_support.is_none_or(|e| (0.0..1.0).contains(&e)),
        ),
    ];
    for (name, value, good) in values {
        if !(good && value.is_finite()) {
            return Err(ModelError::BadValue {
                place: "settings".to_owned(),
                name,
                needed: "a finite value that is not negative (mass scale: positive; limit: below one)",
                got: format!("{value}"),
            });
        }
    }
    Ok(())
}

type Placed = (Vec<usize>, shell::ElementMatrices);

fn shell_matrices(model: &Model, index: &NodeIndex, s: &crate::Shell) -> Result<Placed, ModelError> {
    let name = || format!("shell {}", s.id);
    let nodes = s
        .nodes
        .as_slice()
        .iter()
        .map(|&n| index.find_grid(n, name))
        .collect::<Result<Vec<_>, _>>()?;
    let section = model
        .shell_sections
        .get(s.section)
        .ok_or_else(|| ModelError::UnknownSection {
            place: name(),
            index: s.section,
            count: model.shell_sections.len(),
        })?;
    let points: Vec<Vector3<f64>> = nodes.iter().map(|&n| model.nodes[n].position).collect();
    let matrices = shell::matrices(s, section, &points, &model.settings)?;
    Ok((nodes, matrices))
}

fn bar_matrices(model: &Model, index: &NodeIndex, b: &crate::Bar) -> Result<Placed, ModelError> {
    let name = || format!("bar {}", b.id);
    let nodes = b
        .nodes
        .iter()
        .map(|&n| index.find_grid(n, name))
        .collect::<Result<Vec<_>, _>>()?;
    let section = model
        .bar_sections
        .get(b.section)
        .ok_or_else(|| ModelError::UnknownSection {
            place: name(),
            index: b.section,
            count: model.bar_sections.len(),
        })?;
    let points = [model.nodes[nodes[0]].position, model.nodes[nodes[1]].position];
    let matrices = bar::matrices(b, section, &points, &model.settings)?;
    Ok((nodes, matrices))
}

fn add_term(m: &mut TriMat<f64>, row: usize, column: usize, value: f64) {
    // Zeros are left out: a bending-only plate has three quarters of them.
    if value != 0.0 {
        m.add_triplet(row, column, value);
    }
}

fn add_direct(m: &mut TriMat<f64>, index: &NodeIndex, terms: &[DirectTerm], name: &str) -> Result<(), ModelError> {
    for t in terms {
        if !t.value.is_finite() {
            return Err(ModelError::BadValue {
                place: format!("{name} at nodes {} and {}", t.row.node, t.column.node),
                name: "the value",
                needed: "a finite value",
                got: format!("{}", t.value),
            });
        }
        let (row, column) = (
            index.find_dof(t.row, || name.to_owned())?,
            index.find_dof(t.column, || name.to_owned())?,
        );
        add_term(m, row, column, t.value);
    }
    Ok(())
}

#[derive(Clone, Copy)]
enum Kind {
    Stiffness,
    Mass,
}

impl Triplets<'_> {
    fn target(&mut self, kind: Kind) -> &mut TriMat<f64> {
        match kind {
            Kind::Stiffness => &mut self.stiffness,
            Kind::Mass => &mut self.mass,
        }
    }

    /// Adds a matrix over the six degrees of freedom of `nodes` in basic axes, turned into node frames.
    fn add(&mut self, nodes: &[usize], matrix: &DMatrix<f64>, factor: f64, kind: Kind) {
        let model = self.model;
        let identity = Matrix3::identity();
        let target = self.target(kind);
        for (i, &ni) in nodes.iter().enumerate() {
            for (j, &nj) in nodes.iter().enumerate() {
                let (fi, fj) = (&model.nodes[ni].frame, &model.nodes[nj].frame);
                for a in 0..2 {
                    for b in 0..2 {
                        let mut block: Matrix3<f64> =
                            matrix.fixed_view::<3, 3>(6 * i + 3 * a, 6 * j + 3 * b).into_owned();
                        if *fi != identity || *fj != identity {
                            block = fi.tr_mul(&block) * fj;
                        }
                        for (r, c) in (0..9).map(|k| (k / 3, k % 3)) {
                            let (row, column) = (6 * ni + 3 * a + r, 6 * nj + 3 * b + c);
                            add_term(target, row, column, factor * block[(r, c)]);
                        }
                    }
                }
            }
        }
    }

    fn scalar(
        &mut self,
        index: &NodeIndex,
        elements: &[ScalarElement],
        factor: f64,
        kind: Kind,
    ) -> Result<(), ModelError> {
        let target = self.target(kind);
        for e in elements {
            let name = || format!("scalar element {}", e.id);
            if !e.value.is_finite() {
                return Err(ModelError::BadValue {
                    place: name(),
                    name: "the value",
                    needed: "a finite value",
                    got: format!("{}", e.value),
                });
            }
            let (a, value) = (index.find_dof(e.a, name)?, e.value * factor);
            add_term(target, a, a, value);
            if let Some(b) = e.b {
                let b = index.find_dof(b, name)?;
                add_term(target, b, b, value);
                add_term(target, a, b, -value);
                add_term(target, b, a, -value);
            }
        }
        Ok(())
    }
}
