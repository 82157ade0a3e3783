//! A solver without a flow: pressures that are known in closed form on a wing of a few faces.

use dip_record::{
    Convergence, CoordinateKind, Harmonic, Law, Loads, Modal, MotionCoordinate, MotionValue, Provenance, References,
    Setup, Step, StructuralMode, SurfaceGrid, SurfacePatch,
};

/// Circular frequency of the pitching motion, rad/s.
pub const OMEGA_RAD_S: f64 = 112.97;
/// Steps in a cycle.
pub const STEPS_PER_CYCLE: u32 = 40;

/// Reference quantities of the AGARD wing at Mach 0.678, with a step that divides the cycle.
pub fn references() -> References {
    References {
        model: "euler".to_owned(),
        mach: 0.678,
        speed_m_s: 231.37,
        density_kg_m3: 0.2082,
        pressure_pa: 17_318.4,
        gamma: 1.4,
        reynolds: None,
        alpha_deg: 0.0,
        reference_semichord_m: 0.27935,
        reference_chord_m: 0.5587,
        reference_area_m2: 0.3532,
        span_m: 1.524,
        moment_point_m: [0.27935, 0.0, 0.0],
        grid_unit_m: 1.0,
        half_model: true,
        time_step_s: std::f64::consts::TAU / OMEGA_RAD_S / f64::from(STEPS_PER_CYCLE),
        steps_per_cycle: Some(STEPS_PER_CYCLE),
        cycles_asked: Some(3.0),
        orders_asked: 2.5,
    }
}

/// Upper and lower side of a rectangular plate with `size` faces each, and one flat patch more for the tip.
pub fn surface(size: [usize; 2]) -> SurfaceGrid {
    let node = |i: usize, j: usize, z: f64| {
        let (x, y) = (i as f64 / size[0] as f64, j as f64 / size[1] as f64);
        [0.5587 * x, 0.762 * y, z * (x * (1.0 - x) + 1e-3)]
    };
    let side = |z: f64| -> Vec<[f64; 3]> {
        (0..=size[1])
            .flat_map(|j| (0..=size[0]).map(move |i| (i, j)))
            .map(|(i, j)| node(i, j, z))
            .collect()
    };
    let tip = (0..=size[0])
        .flat_map(|i| [node(i, size[1], -0.02), node(i, size[1], 0.02)])
        .collect();
    SurfaceGrid {
        patches: vec![
            SurfacePatch::structured("upper", side(0.02), size, false),
            SurfacePatch::structured("lower", side(-0.02), size, true),
            SurfacePatch::structured("tip", tip, [1, size[0]], false),
        ],
    }
}

/// A setup with pitch of two harmonics and one structural mode that moves freely.
pub fn setup(size: [usize; 2]) -> Setup {
    let surface = surface(size);
    let bend = surface
        .patches
        .iter()
        .map(|p| p.nodes_m.iter().map(|n| [0.0, 0.0, n[1] * n[1]]).collect())
        .collect();
    Setup {
        references: references(),
        motion: vec![
            MotionCoordinate {
                name: "pitch".to_owned(),
                kind: CoordinateKind::Pitch {
                    axis_point_m: [0.27935, 0.0, 0.0],
                    axis_direction: [0.0, 1.0, 0.0],
                },
                law: Law::Harmonic {
                    mean: 0.003,
                    phase_origin_s: 0.0,
                    harmonics: vec![
                        Harmonic {
                            omega_rad_s: OMEGA_RAD_S,
                            amplitude: 1_f64.to_radians(),
                            phase_rad: 0.2,
                        },
                        Harmonic {
                            omega_rad_s: 2.0 * OMEGA_RAD_S,
                            amplitude: 1e-3,
                            phase_rad: -1.0,
                        },
                    ],
                },
                shape_m: Vec::new(),
                mode: None,
            },
            MotionCoordinate {
                name: "mode 1".to_owned(),
                kind: CoordinateKind::Mode,
                law: Law::Free,
                shape_m: bend,
                mode: Some(StructuralMode {
                    number: 1,
                    omega_rad_s: 60.3,
                    generalized_mass_kg: 1.0 / 3.0,
                    damping_ratio: 0.0,
                }),
            },
        ],
        surface,
        provenance: Provenance {
            program: "synthetic".to_owned(),
            version: "0.1.0 (test)".to_owned(),
            case_name: "plate".to_owned(),
            case_text: "[flow]\nmach = 0.678 # über 0.6\n".to_owned(),
            mesh_sha256: "00ff".repeat(16),
        },
    }
}

/// Pressure per radian in phase with the motion and with its rate, by face: any numbers that differ from face to face.
pub fn response(face: usize) -> [f64; 2] {
    let x = face as f64;
    [-3.0 + (0.37 * x).sin(), 0.8 * (0.11 * x).cos()]
}

/// The state at a step: linear in angle and rate of the pitch, so every harmonic is known exactly.
pub fn step(setup: &Setup, number: u32) -> Step {
    let r = &setup.references;
    let time_s = f64::from(number) * r.time_step_s;
    let pitch = setup.motion[0].law.at(time_s).unwrap();
    let q = MotionValue {
        value: 0.01 * (60.3 * time_s).sin(),
        rate: 0.603 * (60.3 * time_s).cos(),
    };
    let mut first = 0;
    let pressures = setup
        .surface
        .patches
        .iter()
        .map(|p| {
            let cp = (first..first + p.faces.len())
                .map(|face| {
                    let [inphase, rate] = response(face);
                    -0.2 + inphase * pitch.value + rate * pitch.rate / OMEGA_RAD_S
                })
                .collect();
            first += p.faces.len();
            cp
        })
        .collect();
    Step {
        number,
        time_s,
        motion: vec![pitch, q],
        pressures,
        loads: Loads {
            cl: 3.2 * pitch.value,
            cd: 0.01,
            cm: -1.2 * pitch.value,
            force_n: [0.1, 0.0, 30.0 * pitch.value],
            moment_n_m: [1.0, -2.0 * pitch.value, 0.5],
        },
        modal: Some(Modal {
            q: vec![q.value],
            q_dot: vec![q.rate],
            force_j: vec![-5.0 * q.value],
        }),
        convergence: Convergence {
            orders: 2.6,
            iterations: 7 + number % 3,
            converged: !number.is_multiple_of(11),
        },
        shape_m: number.is_multiple_of(10).then(|| setup.nodes_at(&[pitch, q])),
    }
}
