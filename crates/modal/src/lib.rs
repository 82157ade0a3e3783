//! The structure: finite elements, normal modes, modal tables.
//!
//! A [`Model`] holds nodes, shells, bars, masses, springs and constraints; [`Model::assemble`] makes
//! the sparse [`System`] of stiffness and mass, and [`System::modes`] its normal [`Modes`].
//!
//! Any consistent set of units with time in seconds. Displacements and rotations are right-handed.

mod dof;
mod element;
mod error;
mod material;
mod model;
mod modes;
mod section;

pub use dof::{DOFS_PER_NODE, Dof, DofSet};
pub use element::{
    AverageElement, Bar, DirectTerm, Equation, GeneralElement, GeneralMatrix, MaterialAxis, Node, NodeDof, NodeMass,
    RigidElement, ScalarElement, Shell, ShellNodes, ShellThickness,
};
pub use error::{EigenError, ModelError, TableError};
pub use material::{Elasticity, Material, rotate_plane_stress, rotate_transverse};
pub use model::{MassForm, Model, NodeIndex, Settings};
pub use modes::{ModeNode, Modes};
pub use section::{BarSection, Layup, Ply, SHEAR_FACTOR, ShellSection, ShellStiffness};
