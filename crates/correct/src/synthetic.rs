//! Recordings that the lattice makes itself: a thin wall round its boxes, with the lattice's own unsteady pressures on it.
//!
//! What such a recording gives is known exactly: weights of 1 (or the weights that were put in). The tests of this crate and of
//! the commands stand on it, and a user can try a chain with it before there is a flow solution.

use crate::sample::polygon::moments;
use dip_dlm::aic::{Aerodynamics, AicError};
use dip_dlm::c64;
use dip_dlm::lattice::PlaneSymmetry;
use dip_dlm::motion::BoxMotion;
use dip_record::{
    Convergence, CoordinateKind, Harmonic, Law, Loads, MotionCoordinate, Provenance, Recording, References, Setup,
    Step, StructuralMode, SurfaceGrid, SurfacePatch,
};

/// What is recorded.
#[derive(Clone, Debug)]
pub struct Synthetic<'a> {
    /// The lattice.
    pub aerodynamics: &'a Aerodynamics,
    /// Mach number.
    pub mach: f64,
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Name of the motion.
    pub name: String,
    /// What moves.
    pub kind: CoordinateKind,
    /// The structural mode, for kind `Mode`.
    pub mode: Option<StructuralMode>,
    /// Motion of the boxes per unit, one column.
    pub motion: BoxMotion,
    /// Circular frequency, rad/s.
    pub omega_rad_s: f64,
    /// Amplitude of the sine, in the unit of the motion.
    pub amplitude: f64,
    /// Phase of the sine at t = 0, rad.
    pub phase_rad: f64,
    /// Steps in a cycle.
    pub steps_per_cycle: u32,
    /// Cycles.
    pub cycles: u32,
    /// Weights W on the downwash that make the pressures other than linear, `[box]`; empty for none.
    pub weight: Vec<c64>,
    /// What else is in the pressures.
    pub disturbance: Disturbance,
}

/// What real histories hold besides a harmonic, in Cp per unit of the motion times the amplitude.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Disturbance {
    /// A steady lifting part on every box.
    pub offset: f64,
    /// The same, growing with every second.
    pub drift_per_s: f64,
    /// A transient that decays by 1/e in a quarter of a cycle.
    pub transient: f64,
    /// A second harmonic.
    pub second: f64,
    /// Noise, uniform between plus and minus this.
    pub noise: f64,
}

/// The wall and how a dCp on the boxes becomes a Cp on its faces.
struct Wall {
    patches: Vec<SurfacePatch>,
    /// Factor on the box's dCp for its front and its rear half: force and moment at the quarter chord.
    halves: Vec<[f64; 2]>,
}

/// Every box becomes two faces a side, front and rear half, on planes a little above and below the lattice.
fn wall(aerodynamics: &Aerodynamics) -> Wall {
    let lattice = aerodynamics.lattice();
    let mut patches = Vec::new();
    for (name, side) in [("upper", 1.0), ("lower", -1.0)] {
        let (mut nodes, mut faces) = (Vec::new(), Vec::new());
        for b in lattice.boxes() {
            let lift = |p: [f64; 3]| -> [f64; 3] {
                std::array::from_fn(|d| p[d] + side * 0.01 * aerodynamics.semichord() * b.normal[d])
            };
            let middle = |p: [f64; 3], q: [f64; 3]| -> [f64; 3] { std::array::from_fn(|d| 0.5 * (p[d] + q[d])) };
            let [l1, l2, t2, t1] = b.corners;
            for quad in [
                [l1, middle(l1, t1), middle(l2, t2), l2],
                [middle(l1, t1), t1, t2, middle(l2, t2)],
            ] {
                let first = u32::try_from(nodes.len()).unwrap_or(u32::MAX);
                let order: [usize; 4] = if side > 0.0 { [0, 1, 2, 3] } else { [3, 2, 1, 0] };
                nodes.extend(order.map(|i| lift(quad[i])));
                faces.push([first, first + 1, first + 2, first + 3]);
            }
        }
        patches.push(SurfacePatch::new(name, nodes, faces));
    }
    let halves = lattice.boxes().iter().map(|b| {
        let along = |p: [f64; 3]| p[1] * b.cos_dihedral + p[2] * b.sin_dihedral;
        let plane = |p: [f64; 3]| [p[0] - b.force_point[0], along(p)];
        let middle = |p: [f64; 2], q: [f64; 2]| [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
        let [l1, l2, t2, t1] = b.corners.map(plane);
        let (front, rear) = (
            moments(&[l1, middle(l1, t1), middle(l2, t2), l2]),
            moments(&[middle(l1, t1), t1, t2, middle(l2, t2)]),
        );
        let determinant = front.0 * rear.1 - rear.0 * front.1;
        [b.area * rear.1 / determinant, -b.area * front.1 / determinant]
    });
    Wall {
        patches,
        halves: halves.collect(),
    }
}

/// Numbers from 0 to 1 without order (a linear congruential generator after Knuth; the same on every machine).
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

impl Synthetic<'_> {
    /// dCp `[box]` per unit of the motion that the recording is made of.
    ///
    /// # Errors
    /// What the lattice refuses.
    pub fn pressures(&self) -> Result<Vec<c64>, AicError> {
        let semichord = self.aerodynamics.semichord();
        let k = self.omega_rad_s * semichord / self.speed_m_s;
        let mut wash = self.motion.downwash(k / semichord);
        for (w, weight) in wash.data_mut().iter_mut().zip(&self.weight) {
            *w *= *weight;
        }
        self.aerodynamics.factor(self.mach, k)?.solve_in_place(&mut wash)?;
        Ok(wash.column(0).to_vec())
    }

    /// The recording.
    ///
    /// # Errors
    /// What the lattice refuses.
    pub fn record(&self) -> Result<Recording, AicError> {
        let dcp = self.pressures()?;
        let wall = wall(self.aerodynamics);
        let semichord = self.aerodynamics.semichord();
        let period = std::f64::consts::TAU / self.omega_rad_s;
        let time_step_s = period / f64::from(self.steps_per_cycle);
        let law = Law::Harmonic {
            mean: 0.0,
            phase_origin_s: 0.0,
            harmonics: vec![Harmonic {
                omega_rad_s: self.omega_rad_s,
                amplitude: self.amplitude,
                phase_rad: self.phase_rad,
            }],
        };
        // a sin(omega t + phase) = Re(-i a e^{i phase} e^{i omega t}).
        let motion = crate::reading::amplitude_of_sine(self.amplitude, self.phase_rad);
        let d = self.disturbance;
        let mut noise = Noise(20_260_101);
        let steps = (0..=self.steps_per_cycle * self.cycles)
            .map(|number| {
                let time_s = f64::from(number) * time_step_s;
                let turn = c64::from_polar(1.0, self.omega_rad_s * time_s);
                let extra = self.amplitude
                    * (d.offset
                        + d.drift_per_s * time_s
                        + d.transient * (-4.0 * time_s / period).exp()
                        + d.second * (turn * turn).re);
                let mut pressures = Vec::new();
                for side in [-0.5, 0.5] {
                    let mut cp = Vec::with_capacity(2 * dcp.len());
                    for (p, halves) in dcp.iter().zip(&wall.halves) {
                        let lifting = (p * motion * turn).re + extra;
                        for half in halves {
                            // Thickness puts the same Cp on both sides.
                            cp.push(
                                -0.1 + side * half * lifting + self.amplitude * d.noise * (2.0 * noise.next() - 1.0),
                            );
                        }
                    }
                    pressures.push(cp);
                }
                Step {
                    number,
                    time_s,
                    motion: vec![law.at(time_s).unwrap_or_default()],
                    pressures,
                    loads: Loads::default(),
                    modal: None,
                    convergence: Convergence {
                        orders: 3.0,
                        iterations: 10,
                        converged: true,
                    },
                    shape_m: None,
                }
            })
            .collect();
        let lattice = self.aerodynamics.lattice();
        let half_model = lattice.symmetry_y != PlaneSymmetry::None;
        let span = lattice
            .boxes()
            .iter()
            .flat_map(|b| b.corners)
            .fold(0.0_f64, |m, c| m.max(c[1].abs()));
        Ok(Recording {
            setup: Setup {
                references: References {
                    model: "doublet lattice".into(),
                    mach: self.mach,
                    speed_m_s: self.speed_m_s,
                    density_kg_m3: self.density_kg_m3,
                    pressure_pa: self.density_kg_m3 * (self.speed_m_s / self.mach).powi(2) / 1.4,
                    gamma: 1.4,
                    reynolds: None,
                    alpha_deg: 0.0,
                    reference_semichord_m: semichord,
                    reference_chord_m: 2.0 * semichord,
                    reference_area_m2: lattice.area(),
                    span_m: 2.0 * span,
                    moment_point_m: [0.0; 3],
                    grid_unit_m: 1.0,
                    half_model,
                    time_step_s,
                    steps_per_cycle: Some(self.steps_per_cycle),
                    cycles_asked: Some(f64::from(self.cycles)),
                    orders_asked: 3.0,
                },
                motion: vec![MotionCoordinate {
                    name: self.name.clone(),
                    kind: self.kind,
                    law,
                    shape_m: Vec::new(),
                    mode: self.mode,
                }],
                surface: SurfaceGrid { patches: wall.patches },
                provenance: Provenance {
                    program: "dip-correct synthetic".into(),
                    version: env!("CARGO_PKG_VERSION").into(),
                    case_name: "synthetic".into(),
                    case_text: String::new(),
                    mesh_sha256: "0".repeat(64),
                },
            },
            steps,
            end: Some("done".into()),
        })
    }
}
