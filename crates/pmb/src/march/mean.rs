//! Flow and structure at rest: where a march begins.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use dip_grid::MultiBlock;
use serde::{Deserialize, Serialize};

use super::Wing;
use super::quasi_newton::Broyden;
use crate::couple::{Coupled, Stream};
use crate::dual_time::{DualTime, DualTimeSettings, TimeScheme};
use crate::error::FlowError;
use crate::gas::VARIABLES;
use crate::loads::{Loads, WallGeometry, WallPatch, integrate};
use crate::moving::Nodes;
use crate::observer::Observer;
use crate::restart::{doubles, put_doubles, read_checked, write_checked};
use crate::settings::SteadySettings;
use crate::steady::{self, StopReason};

/// A flow that does not change in time, about a structure that does not move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeanFlow {
    /// Primitive variables `[cell][variable]`.
    #[serde(skip)]
    pub unknowns: Vec<f64>,
    /// Constant of the limiter.
    pub limiter_constant: f64,
    /// Generalized coordinates `[mode]`; zero for the rigid flow.
    pub q: Vec<f64>,
    /// Forces and moments.
    pub loads: Loads,
    /// Why the steady flow about the rigid structure ended.
    pub stop: StopReason,
    /// Exchanges of load and position; 0 for the rigid flow and where the load is none.
    pub exchanges: usize,
    /// Change of position in the last exchange over the position.
    pub change: f64,
    /// True if the position settled, or never had to move.
    pub settled: bool,
}

const MAGIC: &[u8; 8] = b"DIPMEAN1";

impl MeanFlow {
    /// Writes a file; the old one, if any, is replaced only once the new one is safe.
    ///
    /// # Errors
    /// [`FlowError::Io`].
    pub fn write(&self, path: &Path) -> Result<(), FlowError> {
        let header = serde_json::to_vec(self).map_err(|e| FlowError::Io {
            path: path.display().to_string(),
            source: e.into(),
        })?;
        write_checked(path, MAGIC, &header, &|out| put_doubles(out, &self.unknowns))
    }

    /// Reads a file and checks that it is whole and of this grid.
    ///
    /// # Errors
    /// [`FlowError::Io`] or [`FlowError::Restart`].
    pub fn read(path: &Path, grid: &MultiBlock) -> Result<Self, FlowError> {
        let wrong = |what: String| FlowError::Restart {
            path: path.display().to_string(),
            what,
        };
        let (header, body) = read_checked(path, MAGIC)?;
        let mut mean: Self = serde_json::from_slice(&header).map_err(|e| wrong(format!("header: {e}")))?;
        mean.unknowns = doubles(&body);
        let needed = grid.cell_count() * VARIABLES;
        if mean.unknowns.len() != needed {
            return Err(wrong(format!(
                "it holds {} unknowns, this grid has {needed}; start anew",
                mean.unknowns.len()
            )));
        }
        Ok(mean)
    }
}

/// How the position under load is found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeflectionSettings {
    /// Change of position, over the position, at which it has settled.
    pub tolerance: f64,
    /// Part of the first change that is taken; those after follow from what it did (Broyden).
    pub relaxation: f64,
    /// Exchanges at most.
    pub most: usize,
    /// Orders by which the flow's residual falls between exchanges.
    pub orders: f64,
    /// A deflection smaller than this part of the reference chord is none: the wing stays where it is.
    pub negligible: f64,
}

impl Default for DeflectionSettings {
    fn default() -> Self {
        Self {
            tolerance: 1e-5,
            relaxation: 0.8,
            most: 40,
            orders: 3.0,
            negligible: 1e-6,
        }
    }
}

/// The steady flow about the structure as the grid has it. `None` if it was interrupted.
///
/// # Errors
/// Those of [`steady::run`].
pub fn rigid(
    settings: &SteadySettings,
    grid: &MultiBlock,
    modes: usize,
    observer: &mut dyn Observer,
    cancel: &AtomicBool,
) -> Result<Option<MeanFlow>, FlowError> {
    let result = steady::run(settings, grid, observer, cancel)?;
    if result.stop == StopReason::Interrupted {
        return Ok(None);
    }
    Ok(Some(MeanFlow {
        unknowns: result.solver.unknowns.clone(),
        limiter_constant: result.limiter_constant,
        q: vec![0.0; modes],
        loads: result.loads,
        stop: result.stop,
        exchanges: 0,
        change: 0.0,
        settled: true,
    }))
}

/// The position in which the structure holds the steady load at a stream: exchanges of load and position, the changes by
/// Broyden's method, from the flow `from`. `None` if it was interrupted.
///
/// A position that does not settle says so ([`MeanFlow::settled`]), as does one so far away that cells fold or the flow breaks
/// down: the structure diverges, or nearly so.
///
/// # Errors
/// A rigid body mode under load, what the linear algebra says.
pub fn deflected(
    settings: &SteadySettings,
    deflection: &DeflectionSettings,
    grid: &MultiBlock,
    wing: &Wing,
    stream: &Stream,
    from: &MeanFlow,
    cancel: &AtomicBool,
) -> Result<Option<MeanFlow>, FlowError> {
    let mut still = Still::new(settings, deflection, grid, wing, stream, from)?;
    let mut mean = from.clone();
    let mut q = from.q.clone();
    let held = still.held()?;
    if from.exchanges == 0 && wing.displacement(&held) < deflection.negligible * settings.reference.chord {
        return Ok(Some(mean));
    }
    let size = |q: &[f64]| -> f64 {
        let squares = q.iter().zip(&wing.largest).map(|(q, l)| (q * l).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let mut broyden = Broyden::new(q.len(), deflection.relaxation);
    // Displacements of the wall, so that modes of any scale count alike; a mode that does not move it counts by itself.
    let scale: Vec<f64> = wing.largest.iter().map(|l| if *l > 0.0 { *l } else { 1.0 }).collect();
    mean.settled = false;
    for exchange in 1..=deflection.most {
        if cancel.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let held = still.held()?;
        let change: Vec<f64> = held.iter().zip(&q).map(|(h, q)| h - q).collect();
        mean.change = size(&change) / size(&held).max(f64::MIN_POSITIVE);
        mean.exchanges = exchange;
        if mean.change <= deflection.tolerance {
            mean.settled = true;
            break;
        }
        let good = (q.clone(), still.flow.solver.unknowns.clone(), still.loads());
        let moved: Vec<f64> = change.iter().zip(&scale).map(|(c, l)| c * l).collect();
        for ((q, step), l) in q.iter_mut().zip(broyden.step(&moved)).zip(&scale) {
            *q += step / l;
        }
        match still.solve(&q) {
            Ok(()) => (),
            // Farther than the grid or the flow follows: the march tells what the structure does from the last position before.
            Err(FlowError::Volume { .. } | FlowError::State { .. }) => {
                (mean.q, mean.unknowns, mean.loads) = good;
                return Ok(Some(mean));
            }
            Err(error) => return Err(error),
        }
    }
    mean.loads = still.loads();
    mean.unknowns.clone_from(&still.flow.solver.unknowns);
    mean.q = q;
    Ok(Some(mean))
}

/// A flow without time: steps so long that nothing is left of their inertia.
struct Still<'a> {
    settings: &'a SteadySettings,
    wing: &'a Wing,
    stream: &'a Stream,
    flow: DualTime,
    rest: Nodes,
    walls: WallGeometry,
    faces: Vec<Vec<Vec<[f64; 3]>>>,
}

/// Length of a step in which a disturbance has left the grid many times over.
const FOREVER: f64 = 1e8;

impl<'a> Still<'a> {
    fn new(
        settings: &'a SteadySettings,
        deflection: &DeflectionSettings,
        grid: &MultiBlock,
        wing: &'a Wing,
        stream: &'a Stream,
        from: &MeanFlow,
    ) -> Result<Self, FlowError> {
        let placed = wing.placed(grid, &from.q);
        let (mut solver, walls) = steady::open(settings, &placed, from.limiter_constant)?;
        solver.set(&from.unknowns);
        solver.evaluate();
        let level = &solver.equations.level;
        let faces = wing.shapes.iter().map(|s| walls.at_faces(level, s)).collect();
        let time = DualTimeSettings {
            scheme: TimeScheme::Bdf1,
            dt: FOREVER,
            orders: deflection.orders,
            max_iterations: 40,
            ..DualTimeSettings::default()
        };
        Ok(Self {
            settings,
            wing,
            stream,
            flow: DualTime::new(solver, &placed, time),
            rest: Nodes::of(grid),
            walls,
            faces,
        })
    }

    fn pressures(&self) -> Vec<WallPatch> {
        let equations = &self.flow.solver.equations;
        self.walls
            .pressures(&equations.level, &equations.sides, &self.settings.flow)
    }

    /// Position in which the structure holds the load of the flow as it is.
    fn held(&self) -> Result<Vec<f64>, FlowError> {
        let forces = self.stream.generalized_forces(&self.pressures(), &self.faces);
        self.wing
            .equations
            .static_displacement(&forces)
            .map_err(|e| FlowError::Observer { what: e.to_string() })
    }

    fn solve(&mut self, q: &[f64]) -> Result<(), FlowError> {
        let (rest, shapes) = (&self.rest, &self.wing.shapes);
        self.flow.advance(|nodes| Coupled::deform(rest, shapes, q, nodes))?;
        Ok(())
    }

    fn loads(&mut self) -> Loads {
        self.walls
            .follow(&self.flow.solver.equations.level, &self.flow.grid.now);
        integrate(&self.pressures(), &self.settings.flow, &self.settings.reference)
    }
}
