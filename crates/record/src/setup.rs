//! What holds for a whole run: reference quantities, motion, surface, and where the numbers come from.

use serde::Serialize;

use crate::motion::MotionCoordinate;
use crate::surface::SurfaceGrid;

/// All that is known before the first step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Setup {
    /// Stream and reference quantities.
    pub references: References,
    /// What can move; the order is that of [`Step::motion`](crate::Step::motion).
    pub motion: Vec<MotionCoordinate>,
    /// The wall where every motion coordinate is zero; patches in the order of
    /// [`Step::pressures`](crate::Step::pressures).
    pub surface: SurfaceGrid,
    /// Where the numbers come from.
    pub provenance: Provenance,
}

/// Every reference quantity that a reader needs to make coefficients and reduced frequencies, in SI.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct References {
    /// Flow model, for example `euler`.
    pub model: String,
    /// Mach number of the stream.
    pub mach: f64,
    /// Speed of the stream U, m/s.
    pub speed_m_s: f64,
    /// Density of the stream rho, kg/m^3.
    pub density_kg_m3: f64,
    /// Static pressure of the stream, Pa.
    pub pressure_pa: f64,
    /// Ratio of specific heats.
    pub gamma: f64,
    /// Reynolds number on `reference_chord_m`; none in inviscid flow.
    pub reynolds: Option<f64>,
    /// Incidence of the stream to the grid's x axis, degrees, nose up; a mean of a pitch coordinate comes on top of it.
    pub alpha_deg: f64,
    /// Semichord b of the reduced frequency k = omega b / U, m.
    pub reference_semichord_m: f64,
    /// Chord that makes moment coefficients, m.
    pub reference_chord_m: f64,
    /// Area that makes force and moment coefficients, m^2: of what is modelled (one half in a half model).
    pub reference_area_m2: f64,
    /// Span of the whole wing from tip to tip, m, also in a half model; width of the grid in a section.
    pub span_m: f64,
    /// Point of the moment coefficients, m.
    pub moment_point_m: [f64; 3],
    /// Length of one unit of the flow solver's grid, m.
    pub grid_unit_m: f64,
    /// True if only y >= 0 is modelled and the plane y = 0 is one of symmetry.
    pub half_model: bool,
    /// Time between two steps, s.
    pub time_step_s: f64,
    /// Steps in one cycle of the first harmonic; none if the motion is not periodic.
    pub steps_per_cycle: Option<u32>,
    /// Cycles (or, where the motion is not periodic, parts of such) that the case asked for.
    pub cycles_asked: Option<f64>,
    /// Orders of magnitude by which each step's residual was asked to fall.
    pub orders_asked: f64,
}

impl References {
    /// Dynamic pressure rho U^2 / 2, Pa.
    #[must_use]
    pub fn dynamic_pressure_pa(&self) -> f64 {
        0.5 * self.density_kg_m3 * self.speed_m_s * self.speed_m_s
    }

    /// Reduced frequency k = omega b / U of a circular frequency in rad/s.
    #[must_use]
    pub fn reduced_frequency(&self, omega_rad_s: f64) -> f64 {
        omega_rad_s * self.reference_semichord_m / self.speed_m_s
    }
}

/// Where the numbers come from. No dates and no names of machines: the same run makes the same file.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Provenance {
    /// Program that ran, for example `pmb pitch`.
    pub program: String,
    /// Its version, with the commit.
    pub version: String,
    /// Name of the case.
    pub case_name: String,
    /// The case file as it was read, changes from the command line included.
    pub case_text: String,
    /// SHA-256 of the mesh file, hexadecimal.
    pub mesh_sha256: String,
}
