//! What a model is made of: plain data, one type an element. Elements name nodes by number.
//!
//! Vectors are in the basic (global) axes unless a field says otherwise.

use nalgebra::{DMatrix, Matrix3, Matrix6, Vector3};

use crate::dof::{Dof, DofSet};

/// One degree of freedom of one node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct NodeDof {
    /// Node number.
    pub node: u32,
    /// Degree of freedom, in the node's displacement frame.
    pub dof: Dof,
}

impl NodeDof {
    /// A degree of freedom of a node.
    pub fn new(node: u32, dof: Dof) -> Self {
        Self { node, dof }
    }
}

/// A point of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Number, unique in the model.
    pub id: u32,
    /// Position in basic axes.
    pub position: Vector3<f64>,
    /// Displacement frame (Nastran's CD): the columns are the unit vectors of its axes in basic
    /// axes, so u_basic = frame * u_node.
    pub frame: Matrix3<f64>,
    /// A scalar point has one degree of freedom ([`Dof::T1`]) and no place.
    pub scalar: bool,
}

impl Node {
    /// A grid node whose displacement frame is the basic one.
    pub fn grid(id: u32, x: f64, y: f64, z: f64) -> Self {
        Self {
            id,
            position: Vector3::new(x, y, z),
            frame: Matrix3::identity(),
            scalar: false,
        }
    }

    /// A scalar point.
    pub fn scalar(id: u32) -> Self {
        Self {
            scalar: true,
            ..Self::grid(id, 0.0, 0.0, 0.0)
        }
    }

    /// The same node with another displacement frame.
    #[must_use]
    pub fn with_frame(mut self, frame: Matrix3<f64>) -> Self {
        self.frame = frame;
        self
    }
}

/// Corners of a shell element, counted round the element. The normal is side 1-2 x side 1-3.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShellNodes {
    /// Triangle (CTRIA3).
    Triangle([u32; 3]),
    /// Quadrilateral (CQUAD4).
    Quad([u32; 4]),
}

impl ShellNodes {
    /// Node numbers in order.
    pub fn as_slice(&self) -> &[u32] {
        match self {
            Self::Triangle(n) => n,
            Self::Quad(n) => n,
        }
    }
}

/// Where a shell element's material axis points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MaterialAxis {
    /// Angle from side 1-2 towards side 1-4 (1-3 of a triangle), radians (Nastran's THETA).
    Angle(f64),
    /// A vector that is projected on the element (the x axis of Nastran's MCID).
    Along(Vector3<f64>),
}

/// Thickness of a shell element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ShellThickness {
    /// That of the section.
    Section,
    /// One for the element.
    Uniform(f64),
    /// At the corners, in the order of the nodes (the fourth is ignored for a triangle);
    /// interpolated as the geometry is.
    Corner([f64; 4]),
    /// At the element's integration points (see [`crate::quad_points`] and
    /// [`crate::triangle_points`]; a triangle ignores the fourth): for a thickness known everywhere.
    Integration([f64; 4]),
}

/// A plate or shell element.
#[derive(Debug, Clone, PartialEq)]
pub struct Shell {
    /// Number, for messages.
    pub id: u32,
    /// Corners.
    pub nodes: ShellNodes,
    /// Index into [`crate::Model::shell_sections`].
    pub section: usize,
    /// Thickness.
    pub thickness: ShellThickness,
    /// Material axis.
    pub axis: MaterialAxis,
    /// Height of the middle surface over the nodes, along the element's normal (ZOFFS).
    pub offset: f64,
}

/// A bar element (CBAR, or CROD with only area and torsion constant).
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// Number, for messages.
    pub id: u32,
    /// End nodes A, B.
    pub nodes: [u32; 2],
    /// Index into [`crate::Model::bar_sections`].
    pub section: usize,
    /// A vector that lies in plane 1 (x y of the bar), not along the bar. Zero is allowed when the
    /// section is alike in both planes (a rod).
    pub orientation: Vector3<f64>,
    /// From node A to end A and from node B to end B of the elastic axis.
    pub offsets: [Vector3<f64>; 2],
    /// Degrees of freedom in element axes that carry no force, at end A and B (pin flags).
    pub pins: [DofSet; 2],
}

/// A rigid mass at a node.
#[derive(Debug, Clone, PartialEq)]
pub enum NodeMass {
    /// Mass with offset and inertia (CONM2).
    Point {
        /// Number, for messages.
        id: u32,
        /// Node that carries it.
        node: u32,
        /// Mass.
        mass: f64,
        /// From the node to the centre of gravity.
        offset: Vector3<f64>,
        /// Inertia tensor about the centre of gravity, with negated products off the diagonal
        /// (I_xy element = - integral of x y dm), as CONM2 arranges I11, -I21, I22, ...
        inertia: Matrix3<f64>,
        /// Axes in which `offset` and `inertia` are given: columns in basic axes.
        axes: Matrix3<f64>,
    },
    /// A full symmetric 6 x 6 matrix at the node (CONM1).
    Matrix {
        /// Number, for messages.
        id: u32,
        /// Node that carries it.
        node: u32,
        /// Mass matrix [row][column] over the six degrees of freedom in `axes`.
        mass: Matrix6<f64>,
        /// Axes of the matrix: columns in basic axes.
        axes: Matrix3<f64>,
    },
}

/// A scalar spring (CELAS1/2) or mass (CMASS1/2) between two degrees of freedom, or one and ground.
#[derive(Debug, Clone, PartialEq)]
pub struct ScalarElement {
    /// Number, for messages.
    pub id: u32,
    /// Stiffness or mass.
    pub value: f64,
    /// First end.
    pub a: NodeDof,
    /// Second end; `None`: ground.
    pub b: Option<NodeDof>,
}

/// A general element (GENEL) over listed degrees of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralElement {
    /// Number, for messages.
    pub id: u32,
    /// The degrees of freedom u_i.
    pub dofs: Vec<NodeDof>,
    /// The degrees of freedom u_d whose rigid motion u_i follows; empty without a matrix S.
    pub rigid_dofs: Vec<NodeDof>,
    /// Flexibility or stiffness of u_i, symmetric, [row][column] over `dofs`.
    pub matrix: GeneralMatrix,
    /// S of u_i = Z f_i + S u_d, [row over `dofs`][column over `rigid_dofs`].
    pub s: Option<DMatrix<f64>>,
}

/// The matrix of a general element.
#[derive(Debug, Clone, PartialEq)]
pub enum GeneralMatrix {
    /// Displacement per force, Z.
    Flexibility(DMatrix<f64>),
    /// Force per displacement, K.
    Stiffness(DMatrix<f64>),
}

/// One term of a matrix given directly (DMIG); give both (a, b) and (b, a), or use `symmetric`.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectTerm {
    /// Row.
    pub row: NodeDof,
    /// Column.
    pub column: NodeDof,
    /// Value.
    pub value: f64,
}

/// A rigid body that ties degrees of freedom together (RBE1, RBE2, RBAR, RTRPLT).
#[derive(Debug, Clone, PartialEq)]
pub struct RigidElement {
    /// Number, for messages.
    pub id: u32,
    /// Six degrees of freedom, of one or more nodes, that fix the rigid motion between them.
    pub independent: Vec<(u32, DofSet)>,
    /// Those that follow.
    pub dependent: Vec<(u32, DofSet)>,
}

impl RigidElement {
    /// RBE2: all six of `independent` lead `components` of the others.
    pub fn rbe2(id: u32, independent: u32, components: DofSet, dependent: &[u32]) -> Self {
        Self {
            id,
            independent: vec![(independent, DofSet::ALL)],
            dependent: dependent.iter().map(|&n| (n, components)).collect(),
        }
    }
}

/// A node whose motion is the weighted mean of others (RBE3).
#[derive(Debug, Clone, PartialEq)]
pub struct AverageElement {
    /// Number, for messages.
    pub id: u32,
    /// The node and the components of it that are defined.
    pub reference: (u32, DofSet),
    /// Weight, components, nodes.
    pub terms: Vec<(f64, DofSet, Vec<u32>)>,
    /// Degrees of freedom to be made dependent instead of the reference's (UM); as many as the
    /// reference has. Empty: the reference itself.
    pub dependent: Vec<(u32, DofSet)>,
}

/// A linear equation between degrees of freedom: the sum of coefficient times motion is zero (MPC).
/// The first term becomes dependent.
#[derive(Debug, Clone, PartialEq)]
pub struct Equation {
    /// Number of its set, for messages.
    pub id: u32,
    /// Degrees of freedom with their coefficients.
    pub terms: Vec<(NodeDof, f64)>,
}
