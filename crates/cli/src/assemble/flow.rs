//! From `[flow]`, `[reference]`, `[steady]` and `[patch.*]` to the settings of the flow solver, and the solver's errors
//! back to lines of the case file.

use crate::exit::Stop;
use dip_case::Document;
use dip_case::file::{FarFieldKind, ReconstructionKind, SteadyFile};
use dip_grid::{Condition, MultiBlock};
use dip_pmb::FlowError;
use dip_pmb::reconstruct::Reconstruction;
use dip_pmb::settings::{FarField, FlowSettings, PatchValues, Reference, SteadySettings};

/// Steps between restart files where the case says nothing.
const CHECKPOINT: usize = 50;

/// The settings of a case; what depends on the grid is put in by [`on_grid`].
///
/// # Errors
/// The first value out of its range, with its line.
pub fn settings(document: &Document, file: &SteadyFile) -> Result<SteadySettings, Stop> {
    let mut s = SteadySettings::default();
    let degrees = |angle: Option<dip_case::units::Angle>| angle.map_or(0.0, |a| a.0.to_degrees());
    s.flow = FlowSettings {
        mach: file.flow.mach,
        alpha_deg: degrees(file.flow.alpha),
        beta_deg: degrees(file.flow.beta),
        gamma: file.flow.gamma.unwrap_or(s.flow.gamma),
    };
    if let Some(r) = &file.reference {
        s.reference = Reference {
            area: r.area.map_or(1.0, |a| a.0),
            chord: r.chord.0,
            moment_point: r.moment_point.map_or([0.0; 3], |p| p.map(|x| x.0)),
        };
    }
    let t = &file.steady;
    s.far_field = match t.far_field {
        FarFieldKind::FreeStream => FarField::FreeStream,
        FarFieldKind::Characteristic => FarField::Characteristic,
        FarFieldKind::Vortex => FarField::Vortex,
    };
    s.reconstruction = match t.reconstruction {
        ReconstructionKind::VanAlbada => Reconstruction::VanAlbada,
        ReconstructionKind::Koren => Reconstruction::Koren,
        ReconstructionKind::Unlimited => Reconstruction::Unlimited,
        ReconstructionKind::FirstOrder => Reconstruction::Constant,
    };
    s.limiter_constant = t.limiter_constant.unwrap_or(s.limiter_constant);
    s.solver.orders = t.orders.unwrap_or(s.solver.orders);
    s.solver.max_steps = t.iterations.unwrap_or(s.solver.max_steps);
    s.solver.levels = t.levels.unwrap_or(s.solver.levels);
    s.solver.cfl_start = t.cfl.unwrap_or(s.solver.cfl_start);
    s.solver.cfl_growth = t.cfl_growth.unwrap_or(s.solver.cfl_growth);
    s.checkpoint_steps = t.checkpoint.unwrap_or(CHECKPOINT);
    for (key, n) in [("iterations", s.solver.max_steps), ("levels", s.solver.levels)] {
        if n == 0 {
            let help = "leave it out for the default";
            return Err(document
                .error(&format!("steady.{key}"), "0: needed 1 or more", help)
                .into());
        }
    }
    if file.flow.speed.is_some() != file.flow.density.is_some() {
        let message = "only one of speed and density is given";
        let help = "give both for forces in newtons, or none: coefficients need neither";
        return Err(document.error("flow", message, help).into());
    }
    for (key, value) in [
        ("speed", file.flow.speed.map(|v| v.0)),
        ("density", file.flow.density.map(|v| v.0)),
    ] {
        if let Some(v) = value.filter(|v| *v <= 0.0) {
            let message = format!("{key} {v}: needed a positive value");
            return Err(document
                .error(&format!("flow.{key}"), message, "see docs/steady.md")
                .into());
        }
    }
    s.check().map_err(|e| explain(document, e))?;
    Ok(s)
}

/// Puts in what depends on the grid: the area of a two-dimensional case and the values of its patches.
///
/// # Errors
/// Walls without `[reference]`, `[reference]` without walls, patches that the grid has not.
pub fn on_grid(
    settings: &mut SteadySettings,
    document: &Document,
    file: &SteadyFile,
    grid: &MultiBlock,
) -> Result<(), Stop> {
    let planar = grid.is_two_dimensional();
    let walls = grid.topology.patches.iter().any(|p| p.condition.is_wall());
    match &file.reference {
        None if walls => {
            let help = "add [reference] with chord and, for a wing, area";
            return Err(document
                .error("", "no [reference], but the grid has walls", help)
                .into());
        }
        Some(_) if !walls => {
            let message = "forces are asked for, but the grid has no wall";
            let help = "leave [reference] out, or give the body's patch the condition `wall`";
            return Err(document.error("reference", message, help).into());
        }
        Some(r) if r.area.is_none() => {
            if !planar {
                let message = "no area: the grid is three-dimensional";
                let help = "add area = \"... m^2\", for a half model that of the half wing";
                return Err(document.error("reference", message, help).into());
            }
            let [lo, hi] = grid.bounds();
            settings.reference.area = r.chord.0 * (hi[1] - lo[1]);
        }
        _ => {}
    }
    if settings.far_field == FarField::Vortex && !planar {
        let message = "the vortex far field is for two-dimensional grids";
        return Err(document
            .error("steady.far_field", message, "use \"free-stream\"")
            .into());
    }
    let stream = settings.flow.state();
    for (name, table) in &file.patch {
        let key = format!("patch.{name}");
        let known: Vec<&str> = grid.topology.patches.iter().map(|p| p.name.as_str()).collect();
        let Some(patch) = grid.topology.patches.iter().find(|p| p.name == *name) else {
            let mut names = known.clone();
            names.sort_unstable();
            names.dedup();
            let help = format!("its patches are {}", names.join(", "));
            return Err(document
                .error(&key, format!("the grid has no patch `{name}`"), help)
                .into());
        };
        let inflow = table.total_pressure.is_some() || table.total_temperature.is_some() || table.direction.is_some();
        let values = match (patch.condition, table.pressure) {
            (Condition::OutflowSubsonic, Some(p)) if !inflow => PatchValues::Pressure(p * stream[4]),
            (Condition::InflowSubsonic, None) => {
                let need = |value: Option<f64>, what: &str| {
                    value.filter(|v| v.is_finite() && *v > 0.0).ok_or_else(|| {
                        let message = format!("{what} is missing or not positive");
                        document.error(
                            &key,
                            message,
                            format!("add {what} = ratio to the stream's static value"),
                        )
                    })
                };
                PatchValues::Total {
                    pressure: need(table.total_pressure, "total_pressure")? * stream[4],
                    // p / rho of the free stream, whose density is 1.
                    temperature: need(table.total_temperature, "total_temperature")? * stream[4],
                    direction: table.direction.unwrap_or([stream[1], stream[2], stream[3]]),
                }
            }
            (condition, _) => {
                let message = format!("these values do not go with patch `{name}`, which is {condition}");
                let help = "outflow-subsonic takes pressure; inflow-subsonic takes total_pressure, total_temperature, direction";
                return Err(document.error(&key, message, help).into());
            }
        };
        settings.patches.insert(name.clone(), values);
    }
    Ok(())
}

/// The solver's error at the line that it is about, where there is one.
pub fn explain(document: &Document, error: FlowError) -> Stop {
    match &error {
        FlowError::Setting { key, got, needed } => {
            let place = match *key {
                "far_field" => "steady.far_field",
                "limiter_constant" => "steady.limiter_constant",
                "solver.orders" => "steady.orders",
                "solver.cfl_start" => "steady.cfl",
                "solver.cfl_growth" => "steady.cfl_growth",
                other => other,
            };
            document.error(place, format!("{place} = {got}"), *needed).into()
        }
        FlowError::Boundary {
            patch,
            condition,
            needed,
        } => {
            let message = format!("patch `{patch}` is {condition}: {needed}");
            let help =
                format!("add [patch.{patch}], or change the patch's condition in the grid's boundary conditions");
            document.error(&format!("patch.{patch}"), message, help).into()
        }
        FlowError::Grid { .. } | FlowError::Volume { .. } | FlowError::Uncovered { .. } => {
            Stop::input(error.to_string(), "look at the grid by `pmb mesh check`")
        }
        FlowError::Restart { .. } => Stop::input(error.to_string(), "leave --resume out to start anew"),
        FlowError::State { .. } => Stop::failed(
            error.to_string(),
            "start with a smaller CFL number (--set steady.cfl=1), and look at the grid by `pmb mesh check`",
        ),
        FlowError::Observer { .. } => Stop::failed(
            error.to_string(),
            "check the disk's space and the folder's rights; --resume goes on from the restart file",
        ),
        FlowError::Io { .. } => Stop::failed(error.to_string(), "check the disk's space and the folder's rights"),
        _ => Stop::failed(
            error.to_string(),
            "start with a smaller CFL number (--set steady.cfl=1)",
        ),
    }
}
