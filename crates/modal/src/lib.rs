//! The structure: finite elements, normal modes, modal tables.
//!
//! A [`Model`] holds nodes, shells, bars, masses, springs and constraints; [`Model::assemble`] makes
//! the sparse [`System`] of stiffness and mass, and [`System::modes`] its normal [`Modes`].
//!
//! ```
//! use dip_modal::{Material, ModesRequest, Ordinates, PlateWing, Planform, RootClamp, ThicknessRule};
//! use nalgebra::Vector3;
//!
//! // A straight wing of aluminium, 1 m by 0.2 m, 2 mm thick, clamped at the root.
//! let wing = PlateWing {
//!     planform: Planform {
//!         root_leading: Vector3::new(0.0, 0.0, 0.0),
//!         root_trailing: Vector3::new(0.2, 0.0, 0.0),
//!         tip_leading: Vector3::new(0.0, 1.0, 0.0),
//!         tip_trailing: Vector3::new(0.2, 1.0, 0.0),
//!     },
//!     chordwise_nodes: 5,
//!     spanwise_nodes: 21,
//!     section: Ordinates::slab(0.01),
//!     rule: ThicknessRule::ExactSection,
//!     material: Material::isotropic(7.0e10, 0.3, 2700.0),
//!     axis: Vector3::y(),
//!     root: RootClamp::All,
//! };
//! let modes = wing.model()?.assemble()?.modes(&ModesRequest::lowest(3))?;
//! // Close to the beam's 3.516 / (2 pi) sqrt(E I / (rho A)) / L^2 = 1.65 Hz.
//! assert!((modes.freq_hz(0) - 1.7).abs() < 0.05);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Any consistent set of units with time in seconds; our own cases are in SI. Displacements and rotations are
//! right-handed. Results do not depend on the number of threads. What was compared with what stands in
//! `docs/validation/structure`.

mod assemble;
mod bar;
mod check;
mod constraint;
mod deform;
mod dof;
mod eigen;
mod element;
mod error;
mod factor;
mod grid_motion;
mod lumped;
mod mac;
mod march;
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
mod transfer;

pub use check::{MassProperties, RigidCheck, ShellQuality};
pub use dof::{DOFS_PER_NODE, Dof, DofSet};
pub use eigen::{ModesRequest, Normalization};
pub use element::{
    AverageElement, Bar, DirectTerm, Equation, GeneralElement, GeneralMatrix, MaterialAxis, Node, NodeDof, NodeMass,
    RigidElement, ScalarElement, Shell, ShellNodes, ShellThickness,
};
pub use error::{EigenError, ModelError, TableError, WingError};
pub use grid_motion::{DeformError, GridModes, MovingWall, VolumeChange, volume_change};
pub use mac::mac;
pub use march::{ForceGuess, Integrator, MarchError, ModalEquations, ModalState, StepScheme};
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
pub use transfer::{Attachment, ConstantVolume, StructuralSurface, Transfer, TransferCheck, TransferError};
