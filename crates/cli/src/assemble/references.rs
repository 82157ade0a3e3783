//! The reference quantities that a recording names, from a case's tables and its grid.

use super::surface;
use dip_case::file::LoadReferenceTable;
use dip_grid::{Condition, MultiBlock};
use dip_pmb::settings::SteadySettings;
use dip_record::References;

/// What a run has besides its flow settings.
#[derive(Debug, Clone, Copy)]
pub struct Unsteady {
    /// Speed of the stream, m/s.
    pub speed_m_s: f64,
    /// Density of the stream, kg/m^3.
    pub density_kg_m3: f64,
    /// Time step, s.
    pub step_s: f64,
    /// Steps in a cycle; none where nothing is periodic.
    pub steps_per_cycle: Option<usize>,
    /// Cycles asked for.
    pub cycles: Option<f64>,
    /// Orders asked for in a step.
    pub orders: f64,
}

/// Reference quantities of a run on `grid`, which is in metres.
pub fn references(
    table: &LoadReferenceTable,
    grid: &MultiBlock,
    settings: &SteadySettings,
    run: &Unsteady,
) -> References {
    let flow = &settings.flow;
    let planar = grid.is_two_dimensional();
    let half = !planar && grid.topology.patches.iter().any(|p| p.condition == Condition::Symmetry);
    let wall = surface::patches(grid).extent_m();
    let span = table
        .semispan
        .map_or_else(|| wall.map_or(0.0, |[lo, hi]| hi[1] - lo[1]), |s| s.0);
    let [lo, hi] = grid.bounds();
    References {
        model: "euler".to_owned(),
        mach: flow.mach,
        speed_m_s: run.speed_m_s,
        density_kg_m3: run.density_kg_m3,
        pressure_pa: run.density_kg_m3 * run.speed_m_s.powi(2) / (flow.gamma * flow.mach.powi(2)),
        gamma: flow.gamma,
        reynolds: None,
        alpha_deg: flow.alpha_deg,
        reference_semichord_m: table.semichord.map_or(0.5 * table.chord.0, |b| b.0),
        reference_chord_m: settings.reference.chord,
        reference_area_m2: settings.reference.area,
        span_m: if planar {
            hi[1] - lo[1]
        } else if half {
            2.0 * span
        } else {
            span
        },
        moment_point_m: settings.reference.moment_point,
        grid_unit_m: 1.0,
        half_model: half,
        time_step_s: run.step_s,
        steps_per_cycle: run.steps_per_cycle.map(|n| u32::try_from(n).unwrap_or(u32::MAX)),
        cycles_asked: run.cycles,
        orders_asked: run.orders,
    }
}
