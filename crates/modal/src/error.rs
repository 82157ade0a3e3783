//! What can be wrong with a structure, and what to do about it.

use crate::dof::Dof;

/// A finite element model that cannot be built or solved. Every message names the element or node.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// Two nodes have one number.
    #[error("node {node}: defined twice; give each node its own number")]
    DuplicateNode {
        /// The node's number.
        node: u32,
    },
    /// Something refers to a node that does not exist.
    #[error("{place}: refers to node {node}, which is not defined; add the node or correct the reference")]
    UnknownNode {
        /// The element, constraint or set that refers to it.
        place: String,
        /// The number that was not found.
        node: u32,
    },
    /// An element that needs a place in space hangs on a scalar point.
    #[error(
        "{place}: node {node} is a scalar point, which has one degree of freedom (T1) and no place; use a grid node, or T1"
    )]
    ScalarPoint {
        /// The element, constraint or load.
        place: String,
        /// The scalar point.
        node: u32,
    },
    /// An element refers to a section that does not exist.
    #[error("{place}: refers to section {index} of {count}; add the section or correct the reference")]
    UnknownSection {
        /// The element.
        place: String,
        /// The index it gives.
        index: usize,
        /// How many sections there are.
        count: usize,
    },
    /// A value that has no meaning: a negative thickness, a matrix that is not positive definite.
    #[error("{place}: {name} needs {needed}, got {got}")]
    BadValue {
        /// The element, section, material or setting.
        place: String,
        /// Name of the quantity.
        name: &'static str,
        /// The admissible range.
        needed: &'static str,
        /// What was given.
        got: String,
    },
    /// An element whose geometry cannot be integrated.
    #[error("{place}: {problem} (measure {measure:.4e}, limit {limit:.4e}); correct its nodes or their order")]
    BadElement {
        /// The element.
        place: String,
        /// What is wrong: zero area, re-entrant corner, warped out of its plane.
        problem: &'static str,
        /// The measured quantity.
        measure: f64,
        /// The limit it passes.
        limit: f64,
    },
    /// A degree of freedom depends on others through two constraints.
    #[error("node {node} {dof}: made dependent by both {first} and {second}; remove it from one of them")]
    DependentTwice {
        /// Node number.
        node: u32,
        /// Degree of freedom.
        dof: Dof,
        /// First constraint.
        first: String,
        /// Second constraint.
        second: String,
    },
    /// Constraints that depend on each other in a circle.
    #[error(
        "node {node} {dof}: its constraint {place} leads back to itself; break the circle of dependent degrees of freedom"
    )]
    ConstraintCycle {
        /// Node number.
        node: u32,
        /// Degree of freedom.
        dof: Dof,
        /// The constraint.
        place: String,
    },
    /// A degree of freedom is both dependent and fixed.
    #[error("node {node} {dof}: fixed by a support and dependent in {place}; remove it from one of them")]
    FixedDependent {
        /// Node number.
        node: u32,
        /// Degree of freedom.
        dof: Dof,
        /// The constraint.
        place: String,
    },
    /// A rigid or averaging element whose equations do not determine the dependent motion.
    #[error("{place}: {problem}")]
    BadConstraint {
        /// The constraint.
        place: String,
        /// What is wrong.
        problem: String,
    },
    /// A degree of freedom that moves without stiffness (and without mass, where mass would do).
    #[error(
        "node {node} {dof}: the stiffness matrix is singular there (pivot / diagonal = {ratio:.2e}); support it, connect it, or switch automatic support on"
    )]
    Mechanism {
        /// Node number.
        node: u32,
        /// Degree of freedom.
        dof: Dof,
        /// Pivot over the diagonal of the stiffness matrix before elimination.
        ratio: f64,
    },
    /// Everything is fixed, or nothing was defined.
    #[error(
        "the model has no free degree of freedom ({nodes} nodes); check its supports and that its elements have stiffness"
    )]
    Empty {
        /// Number of nodes.
        nodes: usize,
    },
    /// The sparse factorization could not be done for another reason (memory, index range).
    #[error("factorizing a stiffness matrix of {size} degrees of freedom: {cause}")]
    Factorization {
        /// Size of the matrix.
        size: usize,
        /// What the factorization reports.
        cause: String,
    },
    /// The analysis set of a static reduction leaves nothing.
    #[error(
        "static reduction: the analysis set has no free degree of freedom; list at least one that is not fixed or dependent"
    )]
    EmptyAnalysisSet,
}

/// Normal modes that cannot be found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EigenError {
    /// The model itself.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// No mass at all.
    #[error("modes: the mass matrix is zero on the free degrees of freedom; give densities or concentrated masses")]
    NoMass,
    /// None asked for.
    #[error("modes: at least 1 mode must be asked for, got 0")]
    NoneAsked,
    /// The iteration did not settle.
    #[error(
        "modes: mode {mode} has residual {residual:.2e} after {steps} Krylov blocks, needed {tolerance:.2e}; check the model for a mechanism, or loosen the tolerance"
    )]
    NotConverged {
        /// Mode number from 1.
        mode: usize,
        /// Bound on the relative error of the shifted eigenvalue.
        residual: f64,
        /// What was asked.
        tolerance: f64,
        /// Blocks used.
        steps: usize,
    },
    /// The Sturm count disagrees with the modes found.
    #[error(
        "modes: {found} modes found below {omega_rad_s:.6e} rad/s, but the factorization counts {counted}; ask for a few more modes, or give a shift nearer to the range"
    )]
    Missed {
        /// Modes found below the check point.
        found: usize,
        /// Negative pivots of K - omega^2 M.
        counted: usize,
        /// The check point.
        omega_rad_s: f64,
    },
    /// A normalization that cannot be done.
    #[error(
        "modes: mode {mode} cannot be normalized at node {node} {dof}: its displacement there is zero; choose another point"
    )]
    BadNormalization {
        /// Mode number from 1.
        mode: usize,
        /// Node number.
        node: u32,
        /// Degree of freedom.
        dof: Dof,
    },
    /// A dense eigenproblem that failed.
    #[error("modes: the dense eigenproblem of size {size} failed ({cause})")]
    Dense {
        /// Size.
        size: usize,
        /// Cause.
        cause: String,
    },
}

/// A table of modes that cannot be read or compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// A line that is not what it should be.
    #[error("mode table, line {line}: needed {needed}, got {got:?}")]
    Line {
        /// Line number from 1.
        line: usize,
        /// What was needed.
        needed: String,
        /// What stands there.
        got: String,
    },
    /// Nothing to read.
    #[error(
        "mode table: no header was found; the first line that is not a comment must name the columns (node,x,y,z,phi1,... or mode_zone,node,x_in,y_in,z_in,dx,dy,dz)"
    )]
    NoHeader,
    /// A column is missing.
    #[error("mode table, line {line}: the header has no column {column:?}; needed {needed}")]
    NoColumn {
        /// Line number of the header.
        line: usize,
        /// Missing column.
        column: String,
        /// All columns that are needed.
        needed: &'static str,
    },
    /// Modes that do not list the same nodes.
    #[error(
        "mode table: mode {mode} has {got} nodes, the first has {needed}; every mode must list the same nodes in the same order"
    )]
    Ragged {
        /// Mode number from 1.
        mode: usize,
        /// Nodes of this mode.
        got: usize,
        /// Nodes of the first.
        needed: usize,
    },
    /// A count that does not fit the table.
    #[error("mode table: {name} has {got} values, needed {needed}")]
    Count {
        /// What is counted.
        name: &'static str,
        /// Given.
        got: usize,
        /// Needed.
        needed: usize,
    },
}

/// A plate wing that cannot be meshed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WingError {
    /// No element would fit.
    #[error("plate wing: needs at least 2 x 2 nodes, got {chordwise} chordwise x {spanwise} spanwise")]
    TooFewNodes {
        /// Chordwise.
        chordwise: usize,
        /// Spanwise.
        spanwise: usize,
    },
    /// A clamped node that is not on the root.
    #[error("plate wing, root clamp: needed node numbers from 1 to {last} (at least one), got {node}")]
    RootNode {
        /// Given.
        node: usize,
        /// Nodes of the root.
        last: usize,
    },
    /// A table of ordinates that is no section.
    #[error("airfoil ordinates, point {point}: needed {needed}, got {got}")]
    Ordinates {
        /// Point from 1.
        point: usize,
        /// What was needed.
        needed: &'static str,
        /// What was given.
        got: f64,
    },
}
