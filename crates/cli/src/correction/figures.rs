//! Pictures of a correction: weights over the planform, phases along the span, pressures at sections, V-g beside V-g.

use super::{CorrectionResults, MachCorrection};
use crate::exit::Stop;
use crate::figures::{SPEED, drawing, vg};
use crate::traces::MachCurves;
use dip_dlm::aic::Aerodynamics;
use dip_dlm::c64;
use dip_report::{BoxCorners, Chart, ColorMap, Figure, Marker, Series};

/// Sections at which pressures are shown, as parts of the span: those of the thesis's Figure 6.9.
pub const SECTIONS: [f64; 3] = [0.325, 0.525, 0.925];

/// A picture with its file name and caption.
#[derive(Debug)]
pub struct Drawn {
    /// File name.
    pub file: String,
    /// What it shows.
    pub caption: String,
    /// The picture.
    pub figure: Figure,
    /// Size in px.
    pub size: (u32, u32),
}

/// All pictures of a correction.
///
/// # Errors
/// What a chart refuses.
pub fn all(results: &CorrectionResults) -> Result<Vec<Drawn>, Stop> {
    let mut drawn = Vec::new();
    for m in &results.machs {
        for (at, (k, phases)) in m.correction.recordings.iter().zip(&m.phases) {
            let place = format!("M{:.3}_k{k:.4}", m.mach);
            let away: Vec<f64> = at
                .weight
                .ratio
                .iter()
                .map(|w| (w - c64::new(1.0, 0.0)).norm())
                .collect();
            let worst = dip_report::worst_boxes(&away, 0.0, 3);
            let title = format!("|W - 1|, Mach {}, k = {k:.4}", m.mach);
            let map = dip_report::lattice(
                title,
                &corners(&results.aerodynamics),
                &away,
                "|W_{T} \u{2212} 1|",
                ColorMap::Sequential,
                &worst,
            )
            .map_err(|e| drawing(&e))?;
            drawn.push(Drawn {
                file: format!("weights_{place}.svg"),
                caption: format!(
                    "Weights on the downwash, |W - 1|, at Mach {}, k = {k:.4}; the worst boxes are marked",
                    m.mach
                ),
                figure: Figure::new("").row(vec![map]),
                size: (760, 620),
            });
            let span = phases.iter().fold(f64::MIN_POSITIVE, |s, p| s.max(p.y_m.abs()));
            let line = |value: &dyn Fn(&dip_correct::audit::StripPhase) -> f64| {
                phases.iter().map(|p| (p.y_m / span, value(p))).collect::<Vec<_>>()
            };
            let phase = Chart::new("", "y / y of the last strip", "phase of section lift, deg")
                .series(Series::line_markers(
                    "recorded",
                    line(&|p| p.recorded_deg),
                    Marker::Circle,
                ))
                .series(Series::dashed("linear lattice", line(&|p| p.linear_deg)));
            let size = Chart::new("", "y / y of the last strip", "|section lift| per unit")
                .series(Series::line_markers(
                    "recorded",
                    line(&|p| p.recorded[0].hypot(p.recorded[1])),
                    Marker::Circle,
                ))
                .series(Series::dashed(
                    "linear lattice",
                    line(&|p| p.linear[0].hypot(p.linear[1])),
                ));
            drawn.push(Drawn {
                file: format!("phases_{place}.svg"),
                caption: format!(
                    "Section lift along the span at Mach {}, k = {k:.4}: phase and size",
                    m.mach
                ),
                figure: Figure::new(format!("Section lift, Mach {}, k = {k:.4}", m.mach)).row(vec![phase, size]),
                size: (900, 400),
            });
            let figure = sections(
                &results.aerodynamics,
                at,
                &format!("dCp per unit, Mach {}, k = {k:.4}", m.mach),
            );
            drawn.push(Drawn {
                file: format!("sections_{place}.svg"),
                caption: format!(
                    "Lifting pressure per unit of the motion at Mach {}, k = {k:.4}: recorded and linear, in phase and a quarter of a cycle ahead",
                    m.mach
                ),
                figure,
                size: (1000, 640),
            });
        }
        drawn.extend(beside(m)?);
    }
    Ok(drawn)
}

fn corners(aerodynamics: &Aerodynamics) -> Vec<BoxCorners> {
    // A fin is seen from its side.
    let across = |b: &dip_dlm::lattice::LatticeBox, p: [f64; 3]| if b.cos_dihedral.abs() > 0.5 { p[1] } else { p[2] };
    aerodynamics
        .lattice()
        .boxes()
        .iter()
        .map(|b| b.corners.map(|p| [p[0], across(b, p)]))
        .collect()
}

/// Real and imaginary part of dCp along the chord of the strips nearest to [`SECTIONS`].
fn sections(aerodynamics: &Aerodynamics, at: &dip_correct::apply::AtRecording, title: &str) -> Figure {
    let lattice = aerodynamics.lattice();
    let wing = lattice.boxes().first().map_or(0, |b| b.surface);
    let y_max = lattice
        .boxes()
        .iter()
        .flat_map(|b| b.corners)
        .fold(f64::MIN_POSITIVE, |m, c| m.max(c[1].abs()));
    let mut figure = Figure::new(title);
    let mut rows: [Vec<Chart>; 2] = [Vec::new(), Vec::new()];
    for section in SECTIONS {
        let strips = lattice
            .strips()
            .iter()
            .filter(|s| s.surface == wing || lattice.surfaces().len() > 1);
        let Some(strip) = strips.min_by(|a, b| {
            let far = |s: &dip_dlm::lattice::Strip| (s.y.abs() / y_max - section).abs();
            far(a).total_cmp(&far(b))
        }) else {
            continue;
        };
        let boxes = &lattice.boxes()[strip.first..strip.first + strip.count];
        let chord: f64 = boxes.iter().map(|b| b.chord).sum();
        let lead = boxes.first().map_or(0.0, |b| b.force_point[0] - 0.25 * b.chord);
        let line = |values: &[c64], part: fn(&c64) -> f64| -> Vec<(f64, f64)> {
            boxes
                .iter()
                .zip(&values[strip.first..])
                .map(|(b, v)| ((b.force_point[0] - lead) / chord, part(v)))
                .collect()
        };
        let heading = format!("{:.1} % span", 100.0 * strip.y.abs() / y_max);
        for (row, (name, part)) in rows.iter_mut().zip([
            ("Re dC_{p}", re as fn(&c64) -> f64),
            ("Im dC_{p}", im as fn(&c64) -> f64),
        ]) {
            row.push(
                Chart::new(&heading, "x / c", name)
                    .series(Series::line_markers(
                        "recorded",
                        line(&at.recorded, part),
                        Marker::Circle,
                    ))
                    .series(Series::dashed("linear lattice", line(&at.linear, part))),
            );
        }
    }
    for row in rows {
        figure = figure.row(row);
    }
    figure
}

fn re(z: &c64) -> f64 {
    z.re
}

fn im(z: &c64) -> f64 {
    z.im
}

/// V-g and V-f of the first flutter method: corrected beside uncorrected, one picture for each correction.
fn beside(m: &MachCorrection) -> Result<Vec<Drawn>, Stop> {
    let Some(first) = m.solutions.first() else {
        return Ok(Vec::new());
    };
    let method = first.solution.method;
    let mut drawn = Vec::new();
    for s in m
        .solutions
        .iter()
        .filter(|s| s.row.correction != "none" && s.solution.method == method)
    {
        let (left, right) = (
            vg(&MachCurves::new(&first.solution), SPEED)?,
            vg(&MachCurves::new(&s.solution), SPEED)?,
        );
        let mut figure = Figure::new(format!(
            "Mach {}, {}: lattice as it is, and {}",
            m.mach,
            method.name(),
            s.row.correction
        ));
        for (i, (mut a, mut b)) in left.rows.into_iter().zip(right.rows).enumerate() {
            if i == 0 {
                for (charts, title) in [(&mut a, "uncorrected"), (&mut b, s.row.correction)] {
                    if let Some(chart) = charts.first_mut() {
                        title.clone_into(&mut chart.title);
                    }
                }
            }
            a.append(&mut b);
            figure = figure.row(a);
        }
        drawn.push(Drawn {
            file: format!("vg_M{:.3}_{}.svg", m.mach, s.row.correction),
            caption: format!(
                "Damping and frequency against speed at Mach {}: uncorrected and {}",
                m.mach, s.row.correction
            ),
            figure,
            size: (1200, 760),
        });
    }
    Ok(drawn)
}
