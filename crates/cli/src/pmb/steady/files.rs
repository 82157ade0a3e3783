//! Files of a steady run: history, pressure cuts and surface as CSV, pictures as SVG.

use super::cuts::{Cut, Measured, of_cut};
use crate::exit::Stop;
use crate::figures::drawing;
use crate::output::RunFolder;
use dip_grid::MultiBlock;
use dip_grid::vtk::{self, Field, On};
use dip_pmb::observer::Progress;
use dip_pmb::settings::{FlowSettings, SteadySettings};
use dip_pmb::steady::SteadyResult;
use dip_report::{CpCut, cp_cuts, history};

/// Writes them all.
///
/// # Errors
/// What the file system says.
pub fn write(
    folder: &RunFolder,
    settings: &SteadySettings,
    result: &SteadyResult,
    cuts: &[Cut],
    measured: &[Measured],
) -> Result<(), Stop> {
    folder.write("history.csv", history_csv(&result.history).as_bytes())?;
    if !result.history.is_empty() {
        folder.write("history.svg", history_svg(settings, result)?.as_bytes())?;
    }
    if !result.walls.is_empty() {
        folder.write("surface.csv", surface_csv(result).as_bytes())?;
    }
    let drawn: Vec<&Cut> = cuts
        .iter()
        .filter(|c| !c.upper.is_empty() || !c.lower.is_empty())
        .collect();
    if !cuts.is_empty() {
        folder.write("cp.csv", cuts_csv(cuts).as_bytes())?;
    }
    if !drawn.is_empty() {
        folder.write("cp.svg", cuts_svg(&settings.flow, &drawn, measured)?.as_bytes())?;
    }
    Ok(())
}

/// Density, velocity and pressure (over the stream's density and speed), Mach number and Cp of every cell, for ParaView.
/// A run that ended on a coarser level has none.
///
/// # Errors
/// What the file system says.
pub fn write_flow(
    folder: &RunFolder,
    flow: &FlowSettings,
    grid: &MultiBlock,
    result: &SteadyResult,
) -> Result<(), Stop> {
    if result.snapshot.level != 0 {
        return Ok(());
    }
    let names = [("density", 1), ("velocity", 3), ("pressure", 1), ("mach", 1), ("cp", 1)];
    let mut fields: Vec<Field> = names
        .into_iter()
        .map(|(name, components)| Field {
            name: name.to_owned(),
            on: On::Cells,
            components,
            values: Vec::with_capacity(grid.blocks.len()),
        })
        .collect();
    let stream = flow.state()[4];
    let mut cells = result.snapshot.unknowns.chunks_exact(5);
    for block in &grid.blocks {
        let mut values: [Vec<f64>; 5] = Default::default();
        for w in cells.by_ref().take(block.cell_count()) {
            let [rho, u, v, w, p] = [w[0], w[1], w[2], w[3], w[4]];
            let speed = (u * u + v * v + w * w).sqrt();
            values[0].push(rho);
            values[1].extend([u, v, w]);
            values[2].push(p);
            values[3].push(speed / (flow.gamma * p / rho).sqrt());
            values[4].push(2.0 * (p - stream));
        }
        for (field, values) in fields.iter_mut().zip(values) {
            field.values.push(values);
        }
    }
    let path = folder.path().join("flow.vtm");
    vtk::write(&path, grid, &fields).map_err(|e| {
        Stop::failed(
            format!("{}: cannot write: {e}", path.display()),
            "check the disk's space, or leave the file out: --set steady.paraview=false",
        )
    })
}

fn history_csv(history: &[Progress]) -> String {
    let mut csv =
        String::from("step,level,cfl,residual_drop_orders,cl,cd,cm,linear_products,linear_reduction,part,wall_s\n");
    for p in history {
        csv.push_str(&format!(
            "{},{},{:e},{},{},{},{},{},{:e},{},{:.4}\n",
            p.step, p.level, p.cfl, p.orders, p.cl, p.cd, p.cm, p.products, p.linear_reduction, p.part, p.seconds
        ));
    }
    csv
}

fn history_svg(settings: &SteadySettings, result: &SteadyResult) -> Result<String, Stop> {
    let coarsest = result.history.iter().map(|p| p.level).max().unwrap_or(0);
    let curve = |level: usize, value: fn(&Progress) -> f64| -> Vec<(f64, f64)> {
        result
            .history
            .iter()
            .filter(|p| p.level == level)
            .map(|p| (p.step as f64, value(p)))
            .collect()
    };
    let residuals: Vec<_> = (0..=coarsest)
        .rev()
        .map(|level| {
            let name = match level {
                0 => "finest level".to_owned(),
                1 => "1 level coarser".to_owned(),
                n => format!("{n} levels coarser"),
            };
            (name, curve(level, |p| 10.0_f64.powf(-p.orders)))
        })
        .filter(|(_, points)| !points.is_empty())
        .collect();
    let loads = if result.walls.is_empty() {
        Vec::new()
    } else {
        let all = |value: fn(&Progress) -> f64| -> Vec<(f64, f64)> {
            result.history.iter().map(|p| (p.step as f64, value(p))).collect()
        };
        vec![
            ("C_{L}".to_owned(), all(|p| p.cl)),
            ("C_{D}".to_owned(), all(|p| p.cd)),
            ("C_{M}".to_owned(), all(|p| p.cm)),
        ]
    };
    let title = format!("Mach {}, α = {}°", settings.flow.mach, settings.flow.alpha_deg);
    let target = 10.0_f64.powf(-settings.solver.orders);
    history(title, "Step", &residuals, &loads, Some(target))
        .and_then(|figure| figure.svg(760, 640))
        .map_err(|e| drawing(&e))
}

fn surface_csv(result: &SteadyResult) -> String {
    let mut csv = String::from("patch,block,x_m,y_m,z_m,area_x_m2,area_y_m2,area_z_m2,cp\n");
    for wall in &result.walls {
        for ((c, a), cp) in wall.centre.iter().zip(&wall.area).zip(&wall.cp) {
            csv.push_str(&format!(
                "{},{},{},{},{},{},{},{},{}\n",
                wall.name, wall.block, c[0], c[1], c[2], a[0], a[1], a[2], cp
            ));
        }
    }
    csv
}

fn cuts_csv(cuts: &[Cut]) -> String {
    let mut csv = String::from("eta,y_m,side,x_m,z_m,x_over_c,cp\n");
    let cell = |v: Option<f64>| v.map_or_else(String::new, |v| v.to_string());
    for cut in cuts {
        let y = cell(cut.station.as_ref().map(|s| s.y_m));
        let eta = cell(cut.station.as_ref().and_then(|s| s.eta));
        for (side, points) in [("upper", &cut.upper), ("lower", &cut.lower)] {
            for [x, z, x_over_c, cp] in points {
                csv.push_str(&format!("{eta},{y},{side},{x},{z},{x_over_c},{cp}\n"));
            }
        }
    }
    csv
}

fn cuts_svg(flow: &FlowSettings, cuts: &[&Cut], measured: &[Measured]) -> Result<String, Stop> {
    let charts: Vec<CpCut> = cuts
        .iter()
        .map(|cut| {
            let side = |points: &[[f64; 4]]| points.iter().map(|p| (p[2], p[3])).collect();
            let points: Vec<(f64, f64)> = of_cut(measured, cut).map(|m| (m.x_over_c, m.cp)).collect();
            CpCut {
                label: cut.label.clone(),
                computed: vec![
                    ("upper side".to_owned(), side(&cut.upper)),
                    ("lower side".to_owned(), side(&cut.lower)),
                ],
                measured: if points.is_empty() {
                    Vec::new()
                } else {
                    vec![("measured".to_owned(), points)]
                },
                critical: critical_cp(flow),
            }
        })
        .collect();
    let columns = charts.len().min(2);
    let rows = u32::try_from(charts.len().div_ceil(columns)).unwrap_or(1);
    let title = format!("Mach {}, α = {}°", flow.mach, flow.alpha_deg);
    let width = if columns == 1 { 640 } else { 1000 };
    cp_cuts(title, &charts, columns)
        .and_then(|figure| figure.svg(width, 60 + 400 * rows))
        .map_err(|e| drawing(&e))
}

/// Pressure coefficient at which the flow is sonic: isentropic expansion to Mach 1. None in supersonic flow.
fn critical_cp(flow: &FlowSettings) -> Option<f64> {
    let (g, m2) = (flow.gamma, flow.mach * flow.mach);
    (m2 < 1.0).then(|| {
        let ratio = ((2.0 + (g - 1.0) * m2) / (g + 1.0)).powf(g / (g - 1.0));
        2.0 / (g * m2) * (ratio - 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::critical_cp;
    use dip_pmb::settings::FlowSettings;

    #[test]
    fn critical_pressure_against_tables() {
        // NACA Report 1135: M = 0.8 gives p*/p = 0.52828 / 0.65602.
        let flow = FlowSettings {
            mach: 0.8,
            ..FlowSettings::default()
        };
        let table = 2.0 / (1.4 * 0.64) * (0.52828 / 0.65602 - 1.0);
        assert!((critical_cp(&flow).unwrap() - table).abs() < 2e-5);
        assert_eq!(critical_cp(&FlowSettings { mach: 1.2, ..flow }), None);
    }
}
