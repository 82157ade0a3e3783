//! What can go wrong in the flow solver.

/// Errors of the flow solver. Each says where, what was needed, what was there, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum FlowError {
    /// The grid cannot be used.
    #[error("grid: {what}")]
    Grid {
        /// What is wrong.
        what: String,
    },
    /// A cell without a positive volume.
    #[error(
        "block `{block}`, cell {ijk:?}: volume {volume:e}; every cell needs a positive, finite one. Check the grid (`pmb mesh check`)"
    )]
    Volume {
        /// Block.
        block: String,
        /// Cell.
        ijk: [usize; 3],
        /// Its volume, in units of the grid.
        volume: f64,
    },
    /// A face cell without a boundary condition or interface, or with two.
    #[error(
        "block `{block}`, side {face}, face cell {cell:?}: {times} boundary conditions and interfaces hold there, exactly one is needed. Give the side a patch or an interface"
    )]
    Uncovered {
        /// Block.
        block: String,
        /// Side.
        face: &'static str,
        /// Face cell.
        cell: [usize; 2],
        /// How many cover it.
        times: usize,
    },
    /// A setting out of its range.
    #[error("setting `{key}` = {got}: {needed}")]
    Setting {
        /// Name of the setting.
        key: &'static str,
        /// Value given.
        got: String,
        /// What is needed.
        needed: &'static str,
    },
    /// A patch asks for a condition whose values are missing.
    #[error("patch `{patch}` is {condition}: {needed}")]
    Boundary {
        /// Patch.
        patch: String,
        /// Its condition.
        condition: String,
        /// What is needed.
        needed: String,
    },
    /// A value that is not a number, or a density or pressure that is not positive.
    #[error("block `{block}`, cell {ijk:?}: {what} = {value:e} is not physical")]
    State {
        /// Block.
        block: String,
        /// First such cell.
        ijk: [usize; 3],
        /// Which quantity.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A step was asked for before its preconditioner was built.
    #[error("the preconditioner is not built: call `Solver::build` before `Solver::solve`")]
    NotBuilt,
    /// The linear algebra failed.
    #[error(transparent)]
    Linear(#[from] dip_krylov::KrylovError),
    /// A restart file cannot be used.
    #[error("restart file {path}: {what}")]
    Restart {
        /// The file.
        path: String,
        /// What is wrong.
        what: String,
    },
    /// Whoever listens to the run cannot go on.
    #[error("{what}")]
    Observer {
        /// Why.
        what: String,
    },
    /// The system refused.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
}
