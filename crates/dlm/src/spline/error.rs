//! What can be wrong with a spline.

/// What makes a spline impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SplineError {
    /// A box or node index that does not exist.
    #[error("spline {spline}: {what} index {index} does not exist, there are {count}")]
    Index {
        /// Position in the list of splines.
        spline: usize,
        /// "box" or "node".
        what: &'static str,
        /// The index given.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// Not enough nodes.
    #[error("spline {spline}: {needed} nodes or more are needed, got {got}")]
    TooFewNodes {
        /// Position in the list of splines.
        spline: usize,
        /// Fewest nodes.
        needed: usize,
        /// Nodes given.
        got: usize,
    },
    /// Two nodes at one place.
    #[error("spline {spline}: nodes {a} and {b} lie at the same place of the spline's plane: remove one of them")]
    Coincident {
        /// Position in the list of splines.
        spline: usize,
        /// First node.
        a: usize,
        /// Second node.
        b: usize,
    },
    /// All nodes on one line.
    #[error(
        "spline {spline}: all nodes lie on one line, which leaves rotation about it free: add nodes off the line or use a beam spline"
    )]
    Collinear {
        /// Position in the list of splines.
        spline: usize,
    },
    /// The interpolation matrix is singular.
    #[error(
        "spline {spline}: the interpolation matrix is singular (reciprocal condition {reciprocal_condition:.1e}): {advice}"
    )]
    Singular {
        /// Position in the list of splines.
        spline: usize,
        /// Reciprocal condition number.
        reciprocal_condition: f64,
        /// What to do.
        advice: &'static str,
    },
    /// Boxes of one plane spline lie in different planes.
    #[error(
        "spline {spline}: boxes {a} and {b} have different normals: give each surface its own spline, or use the thin-plate spline"
    )]
    Normals {
        /// Position in the list of splines.
        spline: usize,
        /// A box.
        a: usize,
        /// Another box.
        b: usize,
    },
    /// A box is moved by two splines.
    #[error("box {box_index} is moved by two splines ({first} and {second}): each box belongs to one")]
    Twice {
        /// Index of the box.
        box_index: usize,
        /// One spline.
        first: usize,
        /// The other.
        second: usize,
    },
    /// A number that makes no sense.
    #[error("spline {spline}: {reason}")]
    Value {
        /// Position in the list of splines.
        spline: usize,
        /// What was needed and what was got.
        reason: String,
    },
    /// A rigid motion of the nodes does not move the boxes rigidly.
    #[error(
        "spline {spline}: a rigid {motion} of its nodes is not reproduced on box {box_index} (relative error {error:.1e}): the nodes do not determine the motion there"
    )]
    Rigid {
        /// Position in the list of splines.
        spline: usize,
        /// Which motion.
        motion: &'static str,
        /// Worst box.
        box_index: usize,
        /// Error over the motion's size.
        error: f64,
    },
}
