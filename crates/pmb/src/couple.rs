//! Flow and modal structure marched together, both at the same time level.
//!
//! In a real time step the modal equations (formulation.md (4.31)) are done again after every pseudo step with the
//! generalized forces of the flow as it is by then, and the grid follows: at convergence neither lags (no sequencing
//! error). The grid is deformed linearly in the generalized coordinates, so that the force on a mode is the work of the
//! pressure on its own shape, face by face: what the flow loses the structure gains.
//!
//! Generalized coordinates, forces and time are in the units of the modal equations (SI); the flow's are made from them by
//! speed and density. This is the one file of the crate that knows the structure.

use std::time::Instant;

use dip_grid::MultiBlock;
use dip_modal::{ForceGuess, Integrator, MarchError, ModalState};

use crate::dual_time::{DualTime, DualTimeSettings, StepOutcome};
use crate::error::FlowError;
use crate::loads::{Loads, WallGeometry, WallPatch, integrate};
use crate::moving::Nodes;
use crate::settings::{FlowSettings, Reference};
use crate::solver::Solver;

/// How flow and structure exchange forces and motion within a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Coupling {
    /// Again after every pseudo step: second order in time.
    #[default]
    Tight,
    /// Once a step: the structure moves under the old forces, the flow follows. First order in time; to compare with.
    Loose,
}

/// Dimensions of the stream, which the structure needs and the flow does not.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Stream {
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Length of the grid's unit, m.
    pub length_m: f64,
}

impl Stream {
    /// Dynamic pressure, Pa.
    #[must_use]
    pub fn dynamic_pressure_pa(&self) -> f64 {
        0.5 * self.density_kg_m3 * self.speed_m_s * self.speed_m_s
    }

    /// Generalized forces of wall pressures, `[mode]`, N m for shapes in metres: sum over faces of pressure times area
    /// times displacement. `faces`: displacement of the face centres for a unit of each coordinate, in the grid's unit,
    /// `[mode][patch][face]`.
    #[must_use]
    pub fn generalized_forces(&self, walls: &[WallPatch], faces: &[Vec<Vec<[f64; 3]>>]) -> Vec<f64> {
        generalized_forces(walls, faces, self.dynamic_pressure_pa() * self.length_m.powi(3))
    }

    /// Non-dimensional time of a step of `seconds`.
    #[must_use]
    pub fn time(&self, seconds: f64) -> f64 {
        seconds * self.speed_m_s / self.length_m
    }
}

/// Wall-clock seconds that coupling has added to those of the flow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CouplingSeconds {
    /// Deformation of the grid, its metrics, swept volumes and what the old time levels contribute on them.
    pub grid: f64,
    /// Generalized forces and steps of the modal equations.
    pub structure: f64,
}

/// Structure as the flow sees it.
#[derive(Clone, Debug)]
pub struct Structure {
    /// Modal equations with their state.
    pub integrator: Integrator,
    /// Displacement of every node of the grid for a unit of each generalized coordinate, in the grid's unit, `[mode]`.
    pub shapes: Vec<Nodes>,
}

/// A step as an observer sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct CoupledStep {
    /// Structure at the new time.
    pub state: ModalState,
    /// Convergence of the flow.
    pub outcome: StepOutcome,
    /// Change of the structure's state in the last exchange: the root of its energy over that of the state.
    pub exchange: f64,
    /// Work of the pressure on the moving wall in this step, J (trapezoidal rule in time).
    pub work_j: f64,
}

/// Flow and structure.
#[derive(Debug)]
pub struct Coupled {
    /// Flow on the moving grid.
    pub flow: DualTime,
    /// Structure.
    pub structure: Structure,
    /// Free stream.
    pub stream: Stream,
    /// Nodes with every generalized coordinate at zero.
    pub rest: Nodes,
    /// How they are coupled.
    pub coupling: Coupling,
    /// Largest change of the structure's state in the last exchange of a step.
    pub exchange_tolerance: f64,
    /// What the coupling has cost so far.
    pub seconds: CouplingSeconds,
    /// Generalized forces that the structure's mean position balances already, `[mode]`, N m: they are taken off, so that the march is
    /// one about that position. Zero where the static deflection is part of the motion.
    pub balanced: Vec<f64>,
    conditions: FlowSettings,
    reference: Reference,
    walls: WallGeometry,
    /// Displacement of the face centres of every wall patch, `[mode][patch][face]`.
    faces: Vec<Vec<Vec<[f64; 3]>>>,
}

impl Coupled {
    /// Couples a flow on `grid`, where it has been brought to rest with the generalized coordinates of
    /// `structure.integrator`, with the structure. `rest` are the nodes with all coordinates at zero.
    ///
    /// # Errors
    /// [`FlowError::Setting`] if the time steps differ or a shape does not fit the grid.
    #[expect(clippy::too_many_arguments, reason = "each is a different thing")]
    pub fn new(
        solver: Solver,
        grid: &MultiBlock,
        rest: Nodes,
        structure: Structure,
        stream: Stream,
        coupling: Coupling,
        settings: DualTimeSettings,
        conditions: FlowSettings,
        reference: Reference,
    ) -> Result<Self, FlowError> {
        let wrong = |key, got: String, needed| Err(FlowError::Setting { key, got, needed });
        let asked = stream.time(structure.integrator.step_s());
        if (asked - settings.dt).abs() > 1e-12 * asked {
            return wrong(
                "time.dt",
                format!("{} for the flow, {asked} for the structure", settings.dt),
                "flow and structure need the same time step",
            );
        }
        let size = |nodes: &Nodes| -> Vec<usize> { nodes.blocks.iter().map(|b| b[0].len()).collect() };
        let modes = structure.integrator.equations().count();
        if structure.shapes.len() != modes || structure.shapes.iter().any(|s| size(s) != size(&rest)) {
            return wrong(
                "structure.shapes",
                format!("{} shapes", structure.shapes.len()),
                "one displacement of every grid node for each mode is needed",
            );
        }
        let equations = &solver.equations;
        let walls = WallGeometry::merged(grid, &equations.level, &equations.boundaries, &equations.level);
        let faces = structure
            .shapes
            .iter()
            .map(|shape| walls.at_faces(&equations.level, shape))
            .collect();
        Ok(Self {
            flow: DualTime::new(solver, grid, settings),
            seconds: CouplingSeconds::default(),
            balanced: vec![0.0; modes],
            structure,
            stream,
            rest,
            coupling,
            exchange_tolerance: 1e-6,
            conditions,
            reference,
            walls,
            faces,
        })
    }

    /// Nodes for generalized coordinates: rest plus the sum of shapes.
    pub fn deform(rest: &Nodes, shapes: &[Nodes], q: &[f64], nodes: &mut Nodes) {
        use rayon::prelude::*;
        const PIECE: usize = 4096;
        // Blocks side by side, and pieces of them: a grid may have one block only.
        let blocks = nodes.blocks.par_iter_mut().zip(&rest.blocks).enumerate();
        blocks.with_max_len(1).for_each(|(b, (to, rest))| {
            for (d, (to, rest)) in to.iter_mut().zip(rest).enumerate() {
                to.par_chunks_mut(PIECE)
                    .zip(rest.par_chunks(PIECE))
                    .enumerate()
                    .for_each(|(piece, (to, rest))| {
                        to.copy_from_slice(rest);
                        for (shape, q) in shapes.iter().zip(q) {
                            let shape = &shape.blocks[b][d][piece * PIECE..];
                            for (to, s) in to.iter_mut().zip(shape) {
                                *to += q * s;
                            }
                        }
                    });
            }
        });
    }

    /// Generalized forces of the flow as it is, `[mode]`, N m for shapes that are in metres: sum over the wall's faces of pressure times area
    /// times displacement.
    #[must_use]
    pub fn forces(&self) -> Vec<f64> {
        self.stream.generalized_forces(&self.walls(), &self.faces)
    }

    /// Walls where they are now, with their pressure.
    #[must_use]
    pub fn walls(&self) -> Vec<WallPatch> {
        let equations = &self.flow.solver.equations;
        self.walls
            .pressures(&equations.level, &equations.sides, &self.conditions)
    }

    /// Force and moment coefficients of the flow as it is.
    #[must_use]
    pub fn loads(&mut self) -> (Loads, Vec<WallPatch>) {
        self.walls
            .follow(&self.flow.solver.equations.level, &self.flow.grid.now);
        let walls = self.walls();
        (integrate(&walls, &self.conditions, &self.reference), walls)
    }

    fn place(&mut self) -> Result<(), FlowError> {
        let begin = Instant::now();
        let q = &self.structure.integrator.next().q;
        let (rest, shapes) = (&self.rest, &self.structure.shapes);
        let placed = self.flow.place(|nodes| Self::deform(rest, shapes, q, nodes));
        self.seconds.grid += begin.elapsed().as_secs_f64();
        placed
    }

    /// Does the structure's step again with the flow's forces; returns how far it moved.
    fn exchange(&mut self) -> Result<f64, FlowError> {
        let begin = Instant::now();
        let forces = self.net_forces();
        let moved = self.structure.integrator.correct(&forces).map_err(structural);
        self.seconds.structure += begin.elapsed().as_secs_f64();
        moved
    }

    /// Forces of the flow less what the mean position balances.
    fn net_forces(&self) -> Vec<f64> {
        self.forces().iter().zip(&self.balanced).map(|(f, b)| f - b).collect()
    }

    /// Everything that the next steps follow from (see [`DualTime::save`]), the structure's state included.
    ///
    /// # Errors
    /// If the header cannot be made.
    pub fn save(&self) -> Result<(serde_json::Value, Vec<f64>), serde_json::Error> {
        let (flow, values) = self.flow.save()?;
        let header = serde_json::json!({
            "flow": flow,
            "structure": serde_json::to_value(&self.structure.integrator)?,
            "balanced": self.balanced,
        });
        Ok((header, values))
    }

    /// Goes back to what was saved.
    ///
    /// # Errors
    /// If it does not fit this run.
    pub fn restore(&mut self, header: &serde_json::Value, values: &[f64]) -> Result<(), FlowError> {
        let wrong = |e: serde_json::Error| FlowError::Restart {
            path: "coupled state".to_owned(),
            what: e.to_string(),
        };
        self.structure.integrator = serde_json::from_value(header["structure"].clone()).map_err(wrong)?;
        self.balanced = serde_json::from_value(header["balanced"].clone()).map_err(wrong)?;
        self.flow.restore(&header["flow"], values)
    }

    /// One real time step.
    ///
    /// # Errors
    /// A folded cell, an impossible flow or force.
    pub fn advance(&mut self) -> Result<CoupledStep, FlowError> {
        dip_krylov::team::awake(|| self.advance_here())
    }

    fn advance_here(&mut self) -> Result<CoupledStep, FlowError> {
        let before = self.structure.integrator.state().clone();
        self.flow.begin_step();
        let guess = match self.coupling {
            Coupling::Tight => ForceGuess::Linear,
            Coupling::Loose => ForceGuess::Hold,
        };
        self.structure.integrator.predict(guess);
        self.place()?;
        self.flow.guess();
        let mut exchange = f64::INFINITY;
        let most = self.flow.settings.max_iterations;
        let mut iterations = 0;
        loop {
            // The first exchange comes after the flow's first answer to the predicted position: before it there is nothing new.
            if self.coupling == Coupling::Tight && (iterations > 0 || self.flow.is_converged()) {
                exchange = self.exchange()?;
                if exchange > self.exchange_tolerance {
                    self.place()?;
                    self.flow.evaluate();
                }
            }
            let settled = self.coupling == Coupling::Loose || exchange <= self.exchange_tolerance || iterations > 0;
            if (self.flow.is_converged() && settled) || iterations >= most {
                break;
            }
            if !self.flow.iterate()? {
                break;
            }
            iterations += 1;
        }
        let outcome = self.flow.finish_step()?;
        if self.coupling == Coupling::Loose {
            let forces = self.net_forces();
            self.structure.integrator.accept_loose(&forces).map_err(structural)?;
        } else {
            self.structure.integrator.accept();
        }
        let state = self.structure.integrator.state().clone();
        let work_j = (0..state.q.len())
            .map(|m| 0.5 * (state.f[m] + before.f[m]) * (state.q[m] - before.q[m]))
            .sum();
        Ok(CoupledStep {
            state,
            outcome,
            exchange,
            work_j,
        })
    }
}

fn structural(error: MarchError) -> FlowError {
    FlowError::Observer {
        what: error.to_string(),
    }
}

/// Sum over faces of `scale cp area . shape`, `[mode]`.
fn generalized_forces(walls: &[WallPatch], faces: &[Vec<Vec<[f64; 3]>>], scale: f64) -> Vec<f64> {
    faces
        .iter()
        .map(|patches| {
            let mut sum = 0.0;
            for (wall, shape) in walls.iter().zip(patches) {
                for ((cp, area), phi) in wall.cp.iter().zip(&wall.area).zip(shape) {
                    sum += cp * (area[0] * phi[0] + area[1] * phi[1] + area[2] * phi[2]);
                }
            }
            scale * sum
        })
        .collect()
}
