//! Draws one picture of every kind from made-up data, to look at: `cargo run --release -p dip-report --example gallery
//! -- FOLDER`.

use dip_report::{Chart, Figure, Marker, Series, Style};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "gallery".to_owned());
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join("lines.svg"), lines().svg(640, 420)?)?;
    std::fs::write(folder.join("grid.svg"), grid().svg(960, 720)?)?;
    Ok(())
}

fn wave(phase: f64) -> Vec<(f64, f64)> {
    (0..=200)
        .map(|i| f64::from(i) * 0.05)
        .map(|x| (x, (x + phase).sin() * (-0.1 * x).exp()))
        .collect()
}

fn lines() -> Chart {
    let measured: Vec<(f64, f64)> = (0..9)
        .map(|i| f64::from(i) * 1.2)
        .map(|x| (x, x.sin() * (-0.1 * x).exp()))
        .collect();
    let errors = vec![(0.08, 0.12); measured.len()];
    Chart::new("Decay of a free oscillation", "Time, s", "Displacement q_{1}, mm")
        .series(Series::line("computed, fine mesh", wave(0.0)))
        .series(Series::dashed("computed, medium mesh", wave(0.1)))
        .series(Series::new("computed, coarse mesh", wave(0.25), Style::Dotted))
        .series(Series::experiment("experiment", measured, Marker::Circle).y_error(errors))
        .vline(std::f64::consts::TAU, "one period")
        .hline(0.0, "")
        .mark(1.47, 0.858, "first peak")
}

fn grid() -> Figure {
    let residual = |rate: f64| {
        (0..400)
            .map(|i| (f64::from(i), (-rate * f64::from(i)).exp()))
            .collect::<Vec<_>>()
    };
    let log = Chart::new("Residual", "Iteration", "Residual / first")
        .log_y()
        .series(Series::line("density", residual(0.05)))
        .series(Series::line("momentum", residual(0.04)))
        .series(Series::dashed("energy", residual(0.06)));
    let cp = Chart::new("Pressure", "x / c", "C_{p}")
        .invert_y()
        .series(Series::line(
            "upper",
            (0..=50)
                .map(|i| f64::from(i) / 50.0)
                .map(|x| (x, -1.2 * (1.0 - x).sqrt() + 0.2))
                .collect(),
        ))
        .series(Series::experiment(
            "test",
            vec![(0.1, -0.9), (0.4, -0.7), (0.8, f64::NAN), (0.9, -0.2)],
            Marker::Square,
        ));
    let loglog = Chart::new("Order", "Cell size h", "Error")
        .log_x()
        .log_y()
        .series(Series::line_markers(
            "L_{2}",
            vec![(0.1, 1e-2), (0.05, 2.6e-3), (0.025, 6.4e-4)],
            Marker::Square,
        ))
        .series(Series::line_markers(
            "L_{∞}",
            vec![(0.1, 4e-2), (0.05, 1.1e-2), (0.025, 2.7e-3)],
            Marker::Diamond,
        ));
    let crowded = (0..6).fold(
        Chart::new("Many curves", "Dynamic pressure, Pa", "Frequency, Hz"),
        |chart, m| {
            let points = (0..60)
                .map(|i| f64::from(i) * 4e3)
                .map(|v| (v, 10.0 * f64::from(m) + (v * 1e-4).sin() * 9.0))
                .collect();
            chart.series(Series::line_markers(
                format!("mode {}", m + 1),
                points,
                Marker::ALL[m as usize],
            ))
        },
    );
    Figure::new("Four charts in line")
        .row(vec![log, cp])
        .row(vec![loglog, crowded])
}
