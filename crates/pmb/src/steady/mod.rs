//! A steady run: from free stream to convergence over a sequence of levels.
//!
//! [`run`] does it; `march` goes from level to level and says when to stop, `step` takes one step.

mod march;
mod step;

use std::sync::atomic::AtomicBool;

use dip_grid::MultiBlock;
use dip_krylov::vector;
use serde::{Deserialize, Serialize};

use crate::error::FlowError;
use crate::level::Level;
use crate::loads::{Loads, WallGeometry, WallPatch};
use crate::observer::{Observer, Progress};
use crate::restart::Snapshot;
use crate::scheme::Scheme;
use crate::sequence::Sequence;
use crate::settings::{FarField, SteadySettings};
use crate::solver::{Equations, Solver};
use crate::vortex::FarFieldVortex;
use march::Run;

/// Why a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StopReason {
    /// The residual fell by the orders asked for.
    Converged,
    /// The residual is at the round-off of the fluxes it is the sum of, before the orders asked for.
    RoundOff,
    /// The number of steps allowed is used up; the flow is the last one.
    MaxSteps,
    /// Steps were rejected down to the least CFL number; the flow is the last good one.
    Stalled,
    /// Somebody asked to stop; the flow is the last one and the restart file goes on from it.
    Interrupted,
}

impl StopReason {
    /// True if the flow may be used without looking twice.
    #[must_use]
    pub fn is_converged(&self) -> bool {
        matches!(self, Self::Converged | Self::RoundOff)
    }
}

/// A finished run.
#[derive(Debug)]
pub struct SteadyResult {
    /// Why it ended.
    pub stop: StopReason,
    /// Forces and moments.
    pub loads: Loads,
    /// Pressure on the walls.
    pub walls: Vec<WallPatch>,
    /// Every step.
    pub history: Vec<Progress>,
    /// Orders by which the residual fell.
    pub orders: f64,
    /// The flow, its equations and residual on the finest level.
    pub solver: Solver,
    /// Constant of the limiter at the end: that of the settings unless it was raised.
    pub limiter_constant: f64,
    /// State to go on from.
    pub snapshot: Snapshot,
    /// Bytes of the large arrays a cell.
    pub bytes_per_cell: f64,
    /// True if the grid is two-dimensional.
    pub planar: bool,
}

/// Runs to convergence.
///
/// `cancel` may be set by another thread or a signal handler at any time: the run ends after the current step, having
/// written its restart file.
///
/// # Errors
/// Settings, grid, boundary conditions and files; a run that does not converge is not an error but a
/// [`StopReason`].
pub fn run(
    settings: &SteadySettings,
    grid: &MultiBlock,
    observer: &mut dyn Observer,
    cancel: &AtomicBool,
) -> Result<SteadyResult, FlowError> {
    settings.check()?;
    let finest = Level::new(grid)?;
    settings.boundaries(&finest)?;
    let sequence = Sequence::new(finest, settings.solver.levels);
    let resumed = if settings.resume {
        read_snapshot(settings, &sequence)?
    } else {
        None
    };
    let mut run = Run::new(settings, grid, sequence, resumed)?;
    let stop = run.march(observer, cancel)?;
    run.finish(stop)
}

/// The discrete equations that a run starts from, or goes on from where the settings say so, and their level (0 is the
/// finest): for the checks of [`crate::check`].
///
/// # Errors
/// Settings, grid, boundary conditions, and a restart file that does not fit them.
pub fn equations(settings: &SteadySettings, grid: &MultiBlock) -> Result<(Equations, usize), FlowError> {
    settings.check()?;
    let finest = Level::new(grid)?;
    settings.boundaries(&finest)?;
    let sequence = Sequence::new(finest, settings.solver.levels);
    let resumed = if settings.resume {
        read_snapshot(settings, &sequence)?
    } else {
        None
    };
    let level = resumed.as_ref().map_or(0, |s| s.level);
    let constant = resumed
        .as_ref()
        .map_or(settings.limiter_constant, |s| s.limiter_constant);
    let (mut solver, ..) = open_level(settings, grid, &sequence, level, constant)?;
    if let Some(s) = resumed {
        solver.set(&s.unknowns);
    }
    Ok((solver.equations, level))
}

fn read_snapshot(settings: &SteadySettings, sequence: &Sequence) -> Result<Option<Snapshot>, FlowError> {
    let Some(path) = &settings.restart else { return Ok(None) };
    if !path.exists() {
        return Ok(None);
    }
    let snapshot = Snapshot::read(path)?;
    let wrong = |what: String| {
        Err(FlowError::Restart {
            path: path.display().to_string(),
            what,
        })
    };
    let cells: Vec<_> = sequence.levels[0].blocks.iter().map(|b| b.layout.cells).collect();
    if snapshot.cells != cells {
        return wrong(format!(
            "it is of another grid: blocks of {:?} cells, this grid has {cells:?}",
            snapshot.cells
        ));
    }
    if !snapshot.settings.is_same_flow(settings) {
        return wrong("flow, reference, scheme or boundary settings differ from those of the case".to_owned());
    }
    let level = sequence.levels.get(snapshot.level);
    match level {
        Some(level) if level.cell_count * 5 == snapshot.unknowns.len() => Ok(Some(snapshot)),
        _ => wrong(format!(
            "level {} with {} unknowns does not fit this grid",
            snapshot.level,
            snapshot.unknowns.len()
        )),
    }
}

/// Undisturbed stream on the finest level of a grid, with the wall faces: what an unsteady run that goes on from its own
/// restart file needs of a steady one.
///
/// # Errors
/// Settings, grid and boundary conditions.
pub fn open(
    settings: &SteadySettings,
    grid: &MultiBlock,
    limiter_constant: f64,
) -> Result<(Solver, WallGeometry), FlowError> {
    settings.check()?;
    let sequence = Sequence::new(Level::new(grid)?, 1);
    let (solver, _, walls, _) = open_level(settings, grid, &sequence, 0, limiter_constant)?;
    Ok((solver, walls))
}

type Opened = (Solver, f64, WallGeometry, Option<FarFieldVortex>);

/// Solver, residual norm of the undisturbed stream and wall faces of a level.
fn open_level(
    settings: &SteadySettings,
    grid: &MultiBlock,
    sequence: &Sequence,
    n: usize,
    limiter_constant: f64,
) -> Result<Opened, FlowError> {
    let level = sequence.levels[n].clone();
    let boundaries = settings.boundaries(&level)?;
    // Face centres are needed on the finest level only; the moment of coarser ones is taken about the same faces.
    let walls = WallGeometry::merged(grid, &level, &boundaries, &sequence.levels[0]);
    let vortex = (settings.far_field == FarField::Vortex && level.planar)
        .then(|| FarFieldVortex::new(grid, &level, &sequence.levels[0], &boundaries));
    let scheme = Scheme::new(
        settings.flow.gamma,
        settings.reconstruction,
        limiter_constant,
        level.cell_count,
        level.planar,
        settings.flow.mach,
    );
    let solver = Solver::new(Equations::new(level, scheme, boundaries, &settings.flow.state())?);
    let reference = vector::norm(&solver.residual);
    Ok((solver, reference, walls, vortex))
}
