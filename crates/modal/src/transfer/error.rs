//! What can be wrong with a transfer between structure and surface.

/// A transfer that cannot be built or used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TransferError {
    /// Too few structural nodes for a triangle.
    #[error("transfer: {got} structural nodes, needed at least 3 that do not lie on one line")]
    TooFewNodes {
        /// Nodes given.
        got: usize,
    },
    /// All nodes on one line.
    #[error(
        "transfer: the {nodes} structural nodes lie on one line (width over length {ratio:.1e}); a beam needs nodes beside its axis, rigidly connected to it, so that its twist can be seen"
    )]
    OnOneLine {
        /// Nodes given.
        nodes: usize,
        /// Width over length.
        ratio: f64,
    },
    /// A coordinate that is not a number.
    #[error("transfer: {what} {index} has a coordinate that is not a finite number")]
    NotFinite {
        /// Node or point.
        what: &'static str,
        /// Place in its list, from 0.
        index: usize,
    },
    /// A triangle that cannot be used.
    #[error("transfer: triangle {triangle} (nodes {nodes:?} of {count}, counted from 0) {problem}")]
    Triangle {
        /// Place in the list, from 0.
        triangle: usize,
        /// Its nodes.
        nodes: [usize; 3],
        /// Number of nodes.
        count: usize,
        /// What is wrong.
        problem: &'static str,
    },
    /// A list of the wrong length.
    #[error("transfer: {name} has {got} entries, needed {needed}")]
    Count {
        /// What is listed.
        name: &'static str,
        /// Given.
        got: usize,
        /// Needed.
        needed: usize,
    },
}
