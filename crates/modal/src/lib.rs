//! The structure: finite elements, normal modes, modal tables.
//!
//! A [`Model`] holds nodes, shells, bars, masses, springs and constraints; [`Model::assemble`] makes
//! the sparse [`System`] of stiffness and mass, and [`System::modes`] its normal [`Modes`].
//!
//! Any consistent set of units with time in seconds. Displacements and rotations are right-handed.

mod assemble;
mod bar;
mod check;
mod constraint;
mod dof;
mod eigen;
mod element;
mod error;
mod factor;
mod lumped;
mod mac;
mod material;
mod model;
mod modes;
mod modes_csv;
mod ordinates;
mod plate_wing;
mod reduce;
mod section;
mod shell;
mod system;

pub use check::{MassProperties, RigidCheck, ShellQuality};
pub use dof::{DOFS_PER_NODE, Dof, DofSet};
pub use eigen::{ModesRequest, Normalization};
pub use element::{
    AverageElement, Bar, DirectTerm, Equation, GeneralElement, GeneralMatrix, MaterialAxis, Node, NodeDof, NodeMass,
    RigidElement, ScalarElement, Shell, ShellNodes, ShellThickness,
};
pub use error::{EigenError, ModelError, TableError, WingError};
pub use mac::mac;
pub use material::{Elasticity, Material, rotate_plane_stress, rotate_transverse};
pub use model::{MassForm, Model, NodeIndex, Settings};
pub use modes::{ModeNode, Modes};
pub use modes_csv::TableOptions;
pub use ordinates::Ordinates;
pub use plate_wing::{Planform, PlateWing, RootClamp, ThicknessRule};
pub use reduce::AutoSupport;
pub use section::{BarSection, Layup, Ply, SHEAR_FACTOR, ShellSection, ShellStiffness};
pub use shell::{ShellPlane, quad_points, triangle_points};
pub use system::System;
