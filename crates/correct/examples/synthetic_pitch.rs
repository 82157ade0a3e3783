//! Writes a recording that the lattice makes itself, of the AGARD 445.6 planform in pitch: something to try `dlm correct` on
//! without a flow solution.
//!
//! `cargo run --release -p dip-correct --example synthetic_pitch -- pitch.mcap [mach] [speed m/s] [frequency Hz]`

use dip_correct::synthetic::{Disturbance, Synthetic};
use dip_dlm::aic::Aerodynamics;
use dip_dlm::c64;
use dip_dlm::gaf::PointRule;
use dip_dlm::kernel::Kernel;
use dip_dlm::lattice::{Lattice, PlaneSymmetry, Surface};
use dip_dlm::motion::{BoxMotion, RigidMotion};
use dip_record::{CoordinateKind, Writer, WriterOptions};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("give the name of the file to write")?;
    let mut number = |default: f64| arguments.next().map_or(Ok(default), |a| a.parse());
    let (mach, speed_m_s, freq_hz) = (number(0.678)?, number(231.37)?, number(17.98)?);
    let surface = Surface::trapezoid("wing", ([0.0; 3], 0.5587), ([0.8094, 0.762, 0.0], 0.3682), 20, 20);
    let lattice = Lattice::new(vec![surface], PlaneSymmetry::Symmetric)?;
    let aerodynamics = Aerodynamics::new(lattice, Kernel::QUARTIC, 0.279_35)?;
    let axis_point_m = [0.279_35, 0.0, 0.0];
    let mut motion = BoxMotion::empty(aerodynamics.lattice().n_boxes());
    let turn = RigidMotion {
        rotation: [0.0, 1.0, 0.0],
        centre: axis_point_m,
        ..RigidMotion::default()
    };
    motion.push_rigid(aerodynamics.lattice(), PointRule::ControlPoint, &turn);
    // As if thickness raised the lift by a tenth and a little lag came with it.
    let weight = aerodynamics
        .lattice()
        .boxes()
        .iter()
        .map(|b| c64::new(1.1, -0.03 * b.mid_chord[1] / 0.762));
    let recording = Synthetic {
        aerodynamics: &aerodynamics,
        mach,
        speed_m_s,
        density_kg_m3: 0.2082,
        name: "pitch".into(),
        kind: CoordinateKind::Pitch {
            axis_point_m,
            axis_direction: [0.0, 1.0, 0.0],
        },
        mode: None,
        motion,
        omega_rad_s: freq_hz * std::f64::consts::TAU,
        amplitude: 1.0_f64.to_radians(),
        phase_rad: 0.0,
        steps_per_cycle: 40,
        cycles: 3,
        weight: weight.collect(),
        disturbance: Disturbance {
            transient: 0.3,
            second: 0.2,
            noise: 1e-3,
            ..Disturbance::default()
        },
    }
    .record()?;
    let mut writer = Writer::create(path.as_ref(), recording.setup.clone(), WriterOptions::default())?;
    for step in &recording.steps {
        writer.step(step)?;
    }
    writer.finish("done")?;
    Ok(())
}
