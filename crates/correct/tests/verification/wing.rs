//! A swept, tapered half wing and its recordings.

use dip_correct::References;
use dip_correct::bridge::{Assembled, Mapped, assemble};
use dip_correct::reading::{Reading, ReadingSettings, read};
use dip_correct::sample::Rule;
use dip_correct::synthetic::{Disturbance, Synthetic};
use dip_dlm::aic::Aerodynamics;
use dip_dlm::c64;
use dip_dlm::gaf::PointRule;
use dip_dlm::kernel::Kernel;
use dip_dlm::lattice::{Lattice, PlaneSymmetry, Surface};
use dip_dlm::motion::{BoxMotion, RigidMotion};
use dip_record::{CoordinateKind, Recording, StructuralMode};

pub const MACH: f64 = 0.678;
pub const SPEED_M_S: f64 = 231.37;
pub const SEMICHORD_M: f64 = 0.27935;
pub const OMEGA_RAD_S: f64 = 17.98 * std::f64::consts::TAU;
pub const AXIS_M: [f64; 3] = [0.27935, 0.0, 0.0];

/// The planform of AGARD 445.6 on 8 x 10 boxes.
pub fn wing() -> Aerodynamics {
    let surface = Surface::trapezoid("wing", ([0.0; 3], 0.5587), ([0.8094, 0.762, 0.0], 0.3682), 8, 10);
    let lattice = Lattice::new(vec![surface], PlaneSymmetry::Symmetric).unwrap();
    Aerodynamics::new(lattice, Kernel::QUARTIC, SEMICHORD_M).unwrap()
}

pub fn pitch(wing: &Aerodynamics) -> BoxMotion {
    let mut motion = BoxMotion::empty(wing.lattice().n_boxes());
    let turn = RigidMotion {
        rotation: [0.0, 1.0, 0.0],
        centre: AXIS_M,
        ..RigidMotion::default()
    };
    motion.push_rigid(wing.lattice(), PointRule::ControlPoint, &turn);
    motion
}

/// Three smooth shapes: bending, torsion, second bending.
pub fn modes(wing: &Aerodynamics) -> BoxMotion {
    let mut motion = BoxMotion::empty(wing.lattice().n_boxes());
    let lattice = wing.lattice();
    for shape in 0..3 {
        motion.push_field(lattice, PointRule::ControlPoint, |_, p| {
            let (eta, x) = (p[1] / 0.762, p[0] - 0.28 - p[1]);
            match shape {
                0 => (eta * eta, 0.0),
                1 => (-eta * x, -eta),
                _ => (eta * eta * (1.6 * eta - 1.0) - 0.3 * eta * eta * x, -0.3 * eta * eta),
            }
        });
    }
    motion
}

pub fn pitching(wing: &Aerodynamics) -> Synthetic<'_> {
    Synthetic {
        aerodynamics: wing,
        mach: MACH,
        speed_m_s: SPEED_M_S,
        density_kg_m3: 0.2082,
        name: "pitch".into(),
        kind: CoordinateKind::Pitch {
            axis_point_m: AXIS_M,
            axis_direction: [0.0, 1.0, 0.0],
        },
        mode: None,
        motion: pitch(wing),
        omega_rad_s: OMEGA_RAD_S,
        amplitude: 1.0_f64.to_radians(),
        phase_rad: 0.0,
        steps_per_cycle: 40,
        cycles: 3,
        weight: Vec::new(),
        disturbance: Disturbance::default(),
    }
}

/// A mode of [`modes`] as the motion.
pub fn moving_mode<'a>(wing: &'a Aerodynamics, mode: usize, omega_rad_s: f64) -> Synthetic<'a> {
    let all = modes(wing);
    let n = all.n_boxes;
    let of = |list: &[f64]| list[mode * n..(mode + 1) * n].to_vec();
    Synthetic {
        name: format!("mode {}", mode + 1),
        kind: CoordinateKind::Mode,
        mode: Some(StructuralMode {
            number: mode as u32 + 1,
            omega_rad_s: 60.0,
            generalized_mass_kg: 1.0,
            damping_ratio: 0.0,
        }),
        motion: BoxMotion {
            n_boxes: n,
            n_modes: 1,
            slope: of(&all.slope),
            at_control: of(&all.at_control),
            at_force: of(&all.at_force),
        },
        omega_rad_s,
        ..pitching(wing)
    }
}

pub fn bridge(wing: &Aerodynamics, recordings: &[Recording], settings: &ReadingSettings) -> (References, Vec<Mapped>) {
    let all = assembled(wing, recordings, settings);
    (all.references, all.mapped)
}

pub fn assembled(wing: &Aerodynamics, recordings: &[Recording], settings: &ReadingSettings) -> Assembled {
    let read: Vec<(&Recording, Vec<Reading>)> = recordings
        .iter()
        .map(|r| (r, read(r, "synthetic", settings).unwrap()))
        .collect();
    assemble(wing, PointRule::ControlPoint, &modes(wing), &read, Rule::Conservative).unwrap()
}

/// A smooth weight of order 1.
pub fn known_weight(wing: &Aerodynamics) -> Vec<c64> {
    wing.lattice()
        .boxes()
        .iter()
        .map(|b| {
            c64::new(
                1.0 + 0.3 * (5.0 * b.mid_chord[0]).sin(),
                0.2 * (4.0 * b.mid_chord[1]).cos(),
            )
        })
        .collect()
}

pub fn largest(list: impl Iterator<Item = f64>) -> f64 {
    list.fold(0.0, f64::max)
}
