//! What a steady run needs to know. Plain values with defaults; angles in degrees, lengths in the grid's unit.

use std::collections::BTreeMap;
use std::path::PathBuf;

use dip_grid::Condition;
use serde::{Deserialize, Serialize};

use crate::boundary::Boundary;
use crate::error::FlowError;
use crate::gas::State;
use crate::level::Level;
use crate::reconstruct::Reconstruction;
use crate::scheme::free_stream;

/// Free stream and gas.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlowSettings {
    /// Free-stream Mach number.
    pub mach: f64,
    /// Angle of attack, degrees: the stream turns from x towards z.
    pub alpha_deg: f64,
    /// Side-slip angle, degrees: the stream turns towards y.
    pub beta_deg: f64,
    /// Ratio of specific heats.
    pub gamma: f64,
}

impl Default for FlowSettings {
    fn default() -> Self {
        Self {
            mach: 0.5,
            alpha_deg: 0.0,
            beta_deg: 0.0,
            gamma: 1.4,
        }
    }
}

impl FlowSettings {
    /// Free-stream state, non-dimensional.
    #[must_use]
    pub fn state(&self) -> State<f64> {
        free_stream(
            self.gamma,
            self.mach,
            self.alpha_deg.to_radians(),
            self.beta_deg.to_radians(),
        )
    }

    /// Directions of drag, side force and lift.
    #[must_use]
    pub fn wind_axes(&self) -> [[f64; 3]; 3] {
        let (a, b) = (self.alpha_deg.to_radians(), self.beta_deg.to_radians());
        [
            [a.cos() * b.cos(), b.sin(), a.sin() * b.cos()],
            [-a.cos() * b.sin(), b.cos(), -a.sin() * b.sin()],
            [-a.sin(), 0.0, a.cos()],
        ]
    }
}

/// What coefficients are made with. Lengths in the grid's unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Area of force coefficients.
    pub area: f64,
    /// Length of moment coefficients.
    pub chord: f64,
    /// Point about which moments are taken.
    pub moment_point: [f64; 3],
}

impl Default for Reference {
    fn default() -> Self {
        Self {
            area: 1.0,
            chord: 1.0,
            moment_point: [0.0; 3],
        }
    }
}

/// How the far field is treated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FarField {
    /// Free stream in the ghost cells, Osher's flux.
    FreeStream,
    /// Riemann invariants.
    Characteristic,
    /// Free stream with the compressible point vortex of the lift (two dimensions), Osher's flux.
    Vortex,
}

/// Values of an in- or outflow patch, non-dimensional by free-stream density and speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PatchValues {
    /// Total pressure, total pressure over total density, and direction of a subsonic inflow.
    Total {
        /// Total pressure.
        pressure: f64,
        /// Total pressure over total density.
        temperature: f64,
        /// Direction; need not be a unit vector.
        direction: [f64; 3],
    },
    /// Static pressure of a subsonic outflow.
    Pressure(f64),
    /// State of a supersonic inflow.
    State(State<f64>),
}

/// Solution method. The defaults suit every case; they are settings for developers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolverSettings {
    /// Orders of magnitude by which the residual must fall.
    pub orders: f64,
    /// Steps after which to give up, on the finest level.
    pub max_steps: usize,
    /// Coarser levels to start on, at most.
    pub levels: usize,
    /// Explicit steps at the very start.
    pub explicit_steps: usize,
    /// CFL number of the first implicit step.
    pub cfl_start: f64,
    /// Largest growth of the CFL number in a step.
    pub cfl_growth: f64,
    /// Orders by which the residual falls on a coarser level before the next finer one is taken.
    pub coarse_orders: f64,
    /// Search directions kept by GCG.
    pub directions: usize,
    /// Products with the operator in a step, at most.
    pub max_products: usize,
}

impl Default for SolverSettings {
    fn default() -> Self {
        Self {
            orders: 10.0,
            max_steps: 300,
            levels: 3,
            explicit_steps: 5,
            cfl_start: 20.0,
            cfl_growth: 5.0,
            coarse_orders: 2.0,
            directions: 35,
            max_products: 45,
        }
    }
}

/// A whole steady run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SteadySettings {
    /// Free stream and gas.
    pub flow: FlowSettings,
    /// Reference quantities.
    pub reference: Reference,
    /// Far field.
    pub far_field: FarField,
    /// Reconstruction.
    pub reconstruction: Reconstruction,
    /// Constant of the limiter (see [`crate::scheme::Scheme`]).
    pub limiter_constant: f64,
    /// Values of in- and outflow patches by name.
    pub patches: BTreeMap<String, PatchValues>,
    /// Solution method.
    pub solver: SolverSettings,
    /// Where to keep the restart file.
    pub restart: Option<PathBuf>,
    /// Go on from the restart file.
    pub resume: bool,
    /// Steps between restart files; 0 writes one at the end only.
    pub checkpoint_steps: usize,
}

impl Default for SteadySettings {
    fn default() -> Self {
        Self {
            flow: FlowSettings::default(),
            reference: Reference::default(),
            far_field: FarField::FreeStream,
            reconstruction: Reconstruction::VanAlbada,
            limiter_constant: 5.0,
            patches: BTreeMap::new(),
            solver: SolverSettings::default(),
            restart: None,
            resume: false,
            checkpoint_steps: 0,
        }
    }
}

fn within(key: &'static str, value: f64, good: bool, needed: &'static str) -> Result<(), FlowError> {
    if good && value.is_finite() {
        Ok(())
    } else {
        Err(FlowError::Setting {
            key,
            got: value.to_string(),
            needed,
        })
    }
}

/// A stream across the plane of a two-dimensional grid would be flow through its mirror planes.
fn check_plane(level: &Level, stream: &State<f64>) -> Result<(), FlowError> {
    const LARGEST: f64 = 1e-6;
    let Some(block) = level.blocks.first().filter(|_| level.planar) else {
        return Ok(());
    };
    let n = block.faces[2].unit(0);
    let across = stream[1] * n[0] + stream[2] * n[1] + stream[3] * n[2];
    if across.abs() <= LARGEST {
        return Ok(());
    }
    Err(FlowError::Grid {
        what: format!(
            "the grid is two-dimensional and lies across the direction ({:.3}, {:.3}, {:.3}), along which the stream has {:.4} of its \
             speed. The angle of attack turns the stream from x towards z, side-slip towards y: turn the grid into the x-z plane (y across), \
             as for an aerofoil in a 2D Plot3D file",
            n[0],
            n[1],
            n[2],
            across.abs()
        ),
    })
}

impl SteadySettings {
    /// True if both describe the same discrete flow, whatever the method of solution: what a restart file must agree in.
    #[must_use]
    pub fn is_same_flow(&self, other: &Self) -> bool {
        self.flow == other.flow
            && self.far_field == other.far_field
            && self.reconstruction == other.reconstruction
            && self.limiter_constant == other.limiter_constant
            && self.patches == other.patches
            && self.reference == other.reference
    }

    /// Checks every number.
    ///
    /// # Errors
    /// The first setting that is out of its range.
    pub fn check(&self) -> Result<(), FlowError> {
        let (f, r, s) = (&self.flow, &self.reference, &self.solver);
        within(
            "flow.mach",
            f.mach,
            f.mach > 1e-3 && f.mach < 50.0,
            "a Mach number above 0.001 and below 50 is needed",
        )?;
        within(
            "flow.gamma",
            f.gamma,
            f.gamma > 1.0 && f.gamma <= 3.0,
            "a ratio of specific heats above 1 and up to 3 is needed (air: 1.4)",
        )?;
        within(
            "flow.alpha",
            f.alpha_deg,
            f.alpha_deg.abs() <= 90.0,
            "an angle of attack between -90 and 90 degrees is needed",
        )?;
        within(
            "flow.beta",
            f.beta_deg,
            f.beta_deg.abs() < 90.0,
            "a side-slip angle between -90 and 90 degrees is needed",
        )?;
        within("reference.area", r.area, r.area > 0.0, "a positive area is needed")?;
        within("reference.chord", r.chord, r.chord > 0.0, "a positive length is needed")?;
        for x in r.moment_point {
            within("reference.moment_point", x, true, "finite coordinates are needed")?;
        }
        let c = self.limiter_constant;
        within(
            "limiter_constant",
            c,
            (0.0..=100.0).contains(&c),
            "a number from 0 to 100 is needed",
        )?;
        within(
            "solver.orders",
            s.orders,
            s.orders > 0.0 && s.orders <= 16.0,
            "a number above 0 and up to 16 is needed",
        )?;
        within(
            "solver.cfl_start",
            s.cfl_start,
            s.cfl_start > 0.0,
            "a positive number is needed",
        )?;
        within(
            "solver.cfl_growth",
            s.cfl_growth,
            s.cfl_growth > 1.0,
            "a number above 1 is needed",
        )?;
        if s.directions == 0 || s.max_products == 0 || s.max_steps == 0 {
            return Err(FlowError::Setting {
                key: "solver.directions, max_products, max_steps",
                got: "0".to_owned(),
                needed: "at least one of each is needed",
            });
        }
        Ok(())
    }

    /// The boundary conditions of a level, in the order of its patches.
    ///
    /// # Errors
    /// If a patch needs values that are not given, a patch asks for a viscous wall, or the stream leaves the plane of a
    /// two-dimensional grid.
    pub fn boundaries(&self, level: &Level) -> Result<Vec<Boundary>, FlowError> {
        let stream = self.flow.state();
        check_plane(level, &stream)?;
        level
            .patches
            .iter()
            .map(|patch| {
                let values = self.patches.get(&patch.name);
                let missing = |needed: &str| FlowError::Boundary {
                    patch: patch.name.clone(),
                    condition: patch.condition.to_string(),
                    needed: needed.to_owned(),
                };
                Ok(match (patch.condition, values) {
                    (Condition::Wall | Condition::WallSlip, _) => Boundary::Wall,
                    (Condition::WallNoSlip, _) => {
                        return Err(missing(
                            "a no-slip wall needs a viscous flow model; use `wall` or `wall-slip` for Euler flow",
                        ));
                    }
                    (Condition::Symmetry, _) => Boundary::Symmetry,
                    (Condition::Collapsed, _) => Boundary::Collapsed,
                    (Condition::FarField, _) => match self.far_field {
                        FarField::FreeStream => Boundary::FarField(stream),
                        FarField::Characteristic => Boundary::FarFieldCharacteristic(stream),
                        FarField::Vortex => Boundary::Fixed(vec![stream; patch.window.count()]),
                    },
                    (
                        Condition::InflowSubsonic,
                        Some(PatchValues::Total {
                            pressure,
                            temperature,
                            direction,
                        }),
                    ) => {
                        let length = direction.iter().map(|d| d * d).sum::<f64>().sqrt();
                        if !(length > 0.0 && *pressure > 0.0 && *temperature > 0.0) {
                            return Err(missing(
                                "a positive total pressure and temperature and a direction are needed",
                            ));
                        }
                        Boundary::InflowSubsonic {
                            pressure: *pressure,
                            temperature: *temperature,
                            direction: direction.map(|d| d / length),
                        }
                    }
                    (Condition::InflowSubsonic, _) => {
                        return Err(missing(
                            "give total pressure, total temperature and direction of the inflow",
                        ));
                    }
                    (Condition::InflowSupersonic, Some(PatchValues::State(state))) => {
                        Boundary::InflowSupersonic(*state)
                    }
                    (Condition::InflowSupersonic, _) => Boundary::InflowSupersonic(stream),
                    (Condition::OutflowSubsonic, Some(PatchValues::Pressure(pressure))) if *pressure > 0.0 => {
                        Boundary::OutflowSubsonic { pressure: *pressure }
                    }
                    (Condition::OutflowSubsonic, Some(_)) => return Err(missing("give a positive static pressure")),
                    (Condition::OutflowSubsonic, None) => Boundary::OutflowSubsonic { pressure: stream[4] },
                    (Condition::OutflowSupersonic, _) => Boundary::OutflowSupersonic,
                })
            })
            .collect()
    }
}
