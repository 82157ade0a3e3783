//! Pictures of results: V-g and V-f, mode shapes.

use crate::exit::Stop;
use crate::traces::{MachCurves, ModeShapes};
use dip_report::{CrossingKind, Figure, Mesh, ReportError, VgCrossing, VgMode};

/// Label of a speed axis of our own cases.
pub const SPEED: &str = "Speed, m/s";

/// A picture that could not be drawn; a defect of the program rather than of the input.
pub fn drawing(error: &ReportError) -> Stop {
    Stop::failed(
        format!("cannot draw a figure: {error}"),
        "please report this as a defect; the results are in summary.json",
    )
}

/// V-g over V-f of one Mach number; `speed_label` names the speed with its unit.
///
/// # Errors
/// What the chart refuses.
pub fn vg(curves: &MachCurves, speed_label: &str) -> Result<Figure, Stop> {
    let modes: Vec<VgMode> = curves
        .modes
        .iter()
        .map(|m| VgMode {
            label: format!("mode {} ({:.1} Hz)", m.mode, m.natural_frequency_hz),
            speed_m_s: m.speed_m_s.clone(),
            damping_g: m.g.clone(),
            freq_hz: m.frequency_hz.clone(),
        })
        .collect();
    let crossings: Vec<VgCrossing> = curves
        .crossings
        .iter()
        .map(|c| VgCrossing {
            kind: if c.divergence {
                CrossingKind::Divergence
            } else {
                CrossingKind::Flutter
            },
            speed_m_s: c.speed_m_s,
            freq_hz: c.frequency_hz,
            damping_g: 0.0,
        })
        .collect();
    let title = format!("Mach {}, {} method", curves.mach, curves.method);
    let mut figure = dip_report::vg(title, &modes, &crossings).map_err(|e| drawing(&e))?;
    for chart in figure.rows.iter_mut().flatten() {
        speed_label.clone_into(&mut chart.x.label);
        if speed_label != SPEED {
            for note in &mut chart.annotations {
                note.text = note.text.replace(" m/s", "");
            }
        }
    }
    Ok(figure)
}

/// Maps of the first `count` mode shapes, two in line: colour is the z displacement, black lines are node lines.
///
/// # Errors
/// What the chart refuses.
pub fn mode_maps(shapes: &ModeShapes, count: usize) -> Result<Option<Figure>, Stop> {
    let mesh = Mesh {
        nodes: shapes.nodes_m.clone(),
        elements: elements(shapes),
    };
    if mesh.elements.is_empty() {
        return Ok(None);
    }
    let mut figure = Figure::new("Mode shapes");
    let modes: Vec<(usize, &Vec<f64>)> = shapes.heave.iter().enumerate().take(count).collect();
    for pair in modes.chunks(2) {
        let mut row = Vec::new();
        for (m, heave) in pair {
            let title = format!(
                "mode {}, {:.2} Hz",
                m + 1,
                shapes.frequencies_hz.get(*m).copied().unwrap_or(f64::NAN)
            );
            row.push(dip_report::mode_map(title, &mesh, heave, "z displacement, largest 1").map_err(|e| drawing(&e))?);
        }
        figure = figure.row(row);
    }
    Ok(Some(figure))
}

/// The mesh's elements, or triangles between the nodes where a table of modes has none.
fn elements(shapes: &ModeShapes) -> Vec<Vec<usize>> {
    if !shapes.elements.is_empty() {
        return shapes.elements.clone();
    }
    let points: Vec<delaunator::Point> = shapes
        .nodes_m
        .iter()
        .map(|p| delaunator::Point { x: p[0], y: p[1] })
        .collect();
    delaunator::triangulate(&points)
        .triangles
        .chunks(3)
        .map(<[usize]>::to_vec)
        .collect()
}
