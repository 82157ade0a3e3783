//! AGARD 445.6 weakened model 3 with Yates' modes or with those of the plate.

use std::f64::consts::TAU;

use dip_grid::MultiBlock;
use dip_modal::{
    Attachment, GridModes, MassForm, ModalEquations, Modes, ModesRequest, MovingWall, StructuralSurface, ThicknessRule,
    Transfer,
};
use dip_pmb::couple::{Coupling, Stream};
use dip_pmb::march::Wing;
use dip_pmb::settings::{Reference, SteadySettings};

use crate::driver::{Case, Outcome};
use crate::published;

/// A point of the experiment in air.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Mach number.
    pub mach: f64,
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Frequency, Hz.
    pub freq_hz: Option<f64>,
}

/// `cases/agard445/experiment.csv`, of the two readings of one row the usual one (0.960), and 0.990, which was not measured:
/// speed from the sound speed of its neighbours, density as the thesis has it.
pub fn experiment() -> Outcome<Vec<Point>> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases/agard445/experiment.csv");
    let text = std::fs::read_to_string(path)?;
    let mut points = Vec::new();
    for line in text.lines().filter(|l| !l.starts_with('#')).skip(1) {
        let row = line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
        if let [mach, density_kg_m3, speed_m_s, freq_hz] = row[..]
            && mach != 0.954
        {
            points.push(Point {
                mach,
                density_kg_m3,
                speed_m_s,
                freq_hz: Some(freq_hz),
            });
        }
    }
    points.push(Point {
        mach: 0.99,
        density_kg_m3: 0.0593,
        speed_m_s: 318.6,
        freq_hz: None,
    });
    points.sort_by(|a, b| a.mach.total_cmp(&b.mach));
    Ok(points)
}

/// The experiment's point at a Mach number.
pub fn point(mach: f64) -> Outcome<Point> {
    let points = experiment()?;
    let found = points.into_iter().find(|p| p.mach == mach);
    Ok(found.ok_or_else(|| format!("experiment.csv has no point at Mach {mach}"))?)
}

/// Frequency of the first torsion mode and mass in the speed index of the experiment.
const OMEGA_ALPHA_HZ: f64 = 38.1;
const MASS_KG: f64 = 1.862;
/// Volume of the frustum of R-765, m^3, and root semichord, m.
const VOLUME_M3: f64 = 0.1301;
const SEMICHORD_M: f64 = 0.27935;

/// Flutter speed index of a speed and a density: U / (b omega_alpha sqrt(m / (rho V))).
pub fn speed_index(speed_m_s: f64, density_kg_m3: f64) -> f64 {
    speed_m_s / (SEMICHORD_M * TAU * OMEGA_ALPHA_HZ * (MASS_KG / (density_kg_m3 * VOLUME_M3)).sqrt())
}

/// Frequency over that of the first torsion mode.
pub fn frequency_ratio(freq_hz: f64) -> f64 {
    freq_hz / OMEGA_ALPHA_HZ
}

/// Modes by name: `yates`, or `own`, those of the plate of `cases/agard445/structure.toml`.
pub fn modes(name: &str, count: usize) -> Outcome<Modes> {
    if name != "yates" {
        return plate("R765", ThicknessRule::ElementMean, MassForm::Consistent, count);
    }
    let mut modes = published::yates();
    modes.shapes.truncate(count);
    modes.omega_rad_s.truncate(count);
    modes.generalized_mass.truncate(count);
    Ok(modes)
}

/// Lowest modes of the thesis's plate, 11 x 21 nodes, by ordinates (`R765`, `TN3047`), thickness rule and mass matrix.
pub fn plate(ordinates: &str, rule: ThicknessRule, mass: MassForm, count: usize) -> Outcome<Modes> {
    let mut model = published::agard_wing(ordinates, 11, 21, rule).model()?;
    model.settings.mass = mass;
    Ok(model.assemble()?.modes(&ModesRequest::lowest(count))?)
}

/// The case at a Mach number; a step is 1/40 of a cycle of 14 Hz, the start gives the tip 0.1 % of the semispan in mode 1.
pub fn case(grid: &MultiBlock, modes: &Modes, mach: f64, alpha_deg: f64) -> Outcome<Case> {
    case_along(grid, modes, mach, alpha_deg, false)
}

/// The same, the wall displaced along z only where asked.
pub fn case_along(grid: &MultiBlock, modes: &Modes, mach: f64, alpha_deg: f64, along_z: bool) -> Outcome<Case> {
    let count = modes.count();
    let wall = MovingWall::new(grid, |p| p.condition.is_wall())?;
    let surface = StructuralSurface::of_modes(modes)?;
    let mut shapes = Transfer::new(&surface, &wall.points(), Attachment::default())?.modes(modes)?;
    if along_z {
        shapes.iter_mut().flatten().for_each(|u| (u.x, u.y) = (0.0, 0.0));
    }
    let fields = GridModes::new(grid, &wall, &shapes, None)?;
    let equations = ModalEquations::from_modes(modes, count, 0.0)?;
    let wing = Wing::new(equations, &fields, grid)?;
    let mut steady = SteadySettings::default();
    steady.flow.mach = mach;
    steady.flow.alpha_deg = alpha_deg;
    steady.solver.orders = 5.0;
    steady.reference = Reference {
        area: 0.35315,
        chord: 0.5587,
        moment_point: [0.0; 3],
    };
    let mut start = vec![0.0; count];
    start[0] = 1e-3 * 0.762;
    Ok(Case {
        grid: grid.clone(),
        wing,
        steady,
        freq_hz: 14.0,
        steps_per_cycle: 40.0,
        orders: 2.0,
        start,
        deflects: false,
        coupling: Coupling::Tight,
        cycles: 8.0,
        whole: false,
    })
}

/// The stream at the experiment's speed.
pub fn stream(speed_m_s: f64, density_kg_m3: f64) -> Stream {
    Stream {
        speed_m_s,
        density_kg_m3,
        length_m: 1.0,
    }
}
