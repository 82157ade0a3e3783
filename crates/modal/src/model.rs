//! A linear finite element model: nodes, elements, constraints, settings.

use std::collections::HashMap;

use crate::dof::{DOFS_PER_NODE, Dof, DofSet};
use crate::element::{
    AverageElement, Bar, DirectTerm, Equation, GeneralElement, Node, NodeDof, NodeMass, RigidElement, ScalarElement,
    Shell,
};
use crate::error::ModelError;
use crate::section::{BarSection, ShellSection};

/// A structure. Fill it, then [`Model::assemble`].
///
/// Any consistent set of units with time in seconds; our own cases are in SI.
#[derive(Debug, Clone, Default)]
pub struct Model {
    /// Nodes, in the order in which results list them.
    pub nodes: Vec<Node>,
    /// Sections of shells.
    pub shell_sections: Vec<ShellSection>,
    /// Plates and shells.
    pub shells: Vec<Shell>,
    /// Sections of bars.
    pub bar_sections: Vec<BarSection>,
    /// Bars.
    pub bars: Vec<Bar>,
    /// Concentrated masses.
    pub masses: Vec<NodeMass>,
    /// Scalar springs.
    pub springs: Vec<ScalarElement>,
    /// Scalar masses.
    pub scalar_masses: Vec<ScalarElement>,
    /// General elements.
    pub general: Vec<GeneralElement>,
    /// Terms added to the stiffness matrix (K2GG).
    pub direct_stiffness: Vec<DirectTerm>,
    /// Terms added to the mass matrix (M2GG); not multiplied by [`Settings::mass_scale`].
    pub direct_mass: Vec<DirectTerm>,
    /// Rigid elements.
    pub rigid: Vec<RigidElement>,
    /// Averaging elements.
    pub averages: Vec<AverageElement>,
    /// Linear equations.
    pub equations: Vec<Equation>,
    /// Fixed degrees of freedom.
    pub supports: Vec<(u32, DofSet)>,
    /// Analysis set of a static (Guyan) reduction; empty: no reduction.
    pub analysis_set: Vec<(u32, DofSet)>,
    /// Degrees of freedom that automatic support leaves alone (SUPORT, or a hinge that may be free).
    pub keep_free: Vec<(u32, DofSet)>,
    /// Settings.
    pub settings: Settings,
}

/// How mass is spread over the nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MassForm {
    /// On the diagonal of the displacements (Nastran's default). Frequencies of plates come out low.
    #[default]
    Lumped,
    /// From the shape functions (Nastran's PARAM,COUPMASS,1). Frequencies of plates come out high.
    Consistent,
    /// Half of each for shells, whose leading errors cancel (Hughes, The Finite Element Method, 1987, section
    /// 7.3.2, "higher-order mass"); the consistent mass for bars. The best choice for our own plates.
    Mean,
}

/// Settings of the assembly.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Lumped or consistent.
    pub mass: MassForm,
    /// Whether shells have rotary inertia; Nastran's do not.
    pub rotary_inertia: bool,
    /// Stiffness about the normal of shells that have membrane stiffness, in units of 1e-6 of the
    /// in-plane shear stiffness (Nastran's K6ROT, 100 by default).
    pub drilling: f64,
    /// Automatic support of degrees of freedom without stiffness: those whose stiffness is below this
    /// fraction of the largest at their node (Nastran's PARAM,EPZERO, 1e-8); `None`: switched off.
    pub auto_support: Option<f64>,
    /// Factor on the mass of all elements and concentrated masses (PARAM,WTMASS).
    pub mass_scale: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            mass: MassForm::Lumped,
            rotary_inertia: false,
            drilling: 100.0,
            auto_support: Some(1e-8),
            mass_scale: 1.0,
        }
    }
}

/// From node numbers to places in [`Model::nodes`].
#[derive(Debug, Clone)]
pub struct NodeIndex {
    /// Place, and whether it is a scalar point.
    place: HashMap<u32, (usize, bool)>,
}

impl NodeIndex {
    /// Index of the node numbered `id`; `place` says who asks.
    ///
    /// # Errors
    /// [`ModelError::UnknownNode`].
    pub fn find(&self, id: u32, place: impl FnOnce() -> String) -> Result<usize, ModelError> {
        match self.place.get(&id) {
            Some(&(index, _)) => Ok(index),
            None => Err(ModelError::UnknownNode {
                place: place(),
                node: id,
            }),
        }
    }

    /// As [`NodeIndex::find`] for an element that needs a place in space.
    ///
    /// # Errors
    /// [`ModelError::UnknownNode`], [`ModelError::ScalarPoint`].
    pub fn find_grid(&self, id: u32, place: impl Fn() -> String) -> Result<usize, ModelError> {
        match self.place.get(&id) {
            Some((_, true)) => Err(ModelError::ScalarPoint {
                place: place(),
                node: id,
            }),
            _ => self.find(id, place),
        }
    }

    /// Number of a degree of freedom: 6 x node + degree of freedom.
    ///
    /// # Errors
    /// [`ModelError::UnknownNode`]; [`ModelError::ScalarPoint`] for another than the first of a scalar point.
    pub(crate) fn find_dof(&self, at: NodeDof, place: impl Fn() -> String) -> Result<usize, ModelError> {
        let node = if at.dof == Dof::T1 {
            self.find(at.node, place)?
        } else {
            self.find_grid(at.node, place)?
        };
        Ok(DOFS_PER_NODE * node + at.dof.index())
    }
}

impl Model {
    /// The index of node numbers.
    ///
    /// # Errors
    /// [`ModelError::DuplicateNode`]; [`ModelError::BadValue`] for a position that is not finite or a
    /// displacement frame that is not orthonormal.
    pub fn node_index(&self) -> Result<NodeIndex, ModelError> {
        let mut place = HashMap::with_capacity(self.nodes.len());
        for (index, node) in self.nodes.iter().enumerate() {
            if place.insert(node.id, (index, node.scalar)).is_some() {
                return Err(ModelError::DuplicateNode { node: node.id });
            }
            if node.position.iter().any(|v| !v.is_finite()) {
                return Err(ModelError::BadValue {
                    place: format!("node {}", node.id),
                    name: "the position",
                    needed: "finite coordinates",
                    got: format!("{:?}", node.position.as_slice()),
                });
            }
            let error = (node.frame.transpose() * node.frame - nalgebra::Matrix3::identity())
                .abs()
                .max();
            if error.is_nan() || error > 1e-6 {
                return Err(ModelError::BadValue {
                    place: format!("node {}", node.id),
                    name: "the displacement frame",
                    needed: "orthonormal columns",
                    got: format!("{:?}", node.frame),
                });
            }
        }
        Ok(NodeIndex { place })
    }
}
