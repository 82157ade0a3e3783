//! Draws one picture of every kind, and a page with all of them, from made-up data, to look at:
//! `cargo run --release -p dip-report --example gallery -- FOLDER`.

use dip_report::{
    Block, BoundaryCurve, BoundaryPoint, Cell, Chart, ColorMap, Column, CpCut, CrossingKind, Figure, Marker, Mesh,
    NumberFormat, Page, ReportError, Series, Style, Table, VgCrossing, VgMode,
};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "gallery".to_owned());
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    let figures = [
        ("lines", Figure::new("").row(vec![lines()]), 640, 420),
        ("grid", grid(), 960, 720),
        ("vg", vg()?, 720, 760),
        ("boundary", boundary(), 640, 720),
        ("cp", cp()?, 960, 620),
        ("history", history()?, 640, 640),
        ("modes", modes()?, 960, 760),
        ("lattice", lattice()?, 900, 460),
    ];
    let mut blocks = vec![Block::Table(table()?)];
    for (name, figure, width_px, height_px) in &figures {
        std::fs::write(
            folder.join(name).with_extension("svg"),
            figure.svg(*width_px, *height_px)?,
        )?;
        blocks.push(Block::figure(
            figure,
            *width_px,
            *height_px,
            format!("The picture \"{name}\", from made-up data."),
        )?);
    }
    let page = Page::new("Gallery of pictures")
        .stamp("version", env!("CARGO_PKG_VERSION"))
        .stamp("data", "made up")
        .section(
            "Words",
            vec![
                Block::Paragraph("A paragraph with <angle brackets> & an ampersand.".to_owned()),
                Block::Warning("2 of 7 points did not reach the tolerance asked for.".to_owned()),
                Block::Pairs(vec![
                    ("Mach".to_owned(), "0.901".to_owned()),
                    ("density".to_owned(), "0.0995 kg/m³".to_owned()),
                ]),
                Block::Details {
                    summary: "Case file".to_owned(),
                    text: "[flow]\nmach = 0.901\n".to_owned(),
                },
            ],
        )
        .section("Pictures and tables", blocks);
    std::fs::write(folder.join("gallery.html"), page.html())?;
    print!("{}\n{}", table()?.plain(), table()?.markdown());
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
    let upper = (0..=50)
        .map(|i| f64::from(i) / 50.0)
        .map(|x| (x, -1.2 * (1.0 - x).sqrt() + 0.2))
        .collect();
    let tests = vec![(0.1, -0.9), (0.4, -0.7), (0.8, f64::NAN), (0.9, -0.2)];
    let cp = Chart::new("Pressure", "x / c", "C_{p}")
        .invert_y()
        .series(Series::line("upper", upper))
        .series(Series::experiment("test", tests, Marker::Square));
    let errors = |e: f64| vec![(0.1, e), (0.05, 0.26 * e), (0.025, 0.064 * e)];
    let loglog = Chart::new("Order", "Cell size h", "Error")
        .log_x()
        .log_y()
        .series(Series::line_markers("L_{2}", errors(0.01), Marker::Square))
        .series(Series::line_markers("L_{∞}", errors(0.04), Marker::Diamond));
    let crowded = (0..6).fold(
        Chart::new("Many curves", "Dynamic pressure, Pa", "Frequency, Hz"),
        |chart, m| {
            let level = 10.0 * m as f64;
            let points = (0..60)
                .map(|i| f64::from(i) * 4e3)
                .map(|v| (v, level + (v * 1e-4).sin() * 9.0))
                .collect();
            chart.series(Series::line_markers(format!("mode {}", m + 1), points, Marker::ALL[m]))
        },
    );
    Figure::new("Four charts in line")
        .row(vec![log, cp])
        .row(vec![loglog, crowded])
}

fn vg() -> Result<Figure, ReportError> {
    let speed: Vec<f64> = (0..=40).map(|i| f64::from(i) * 10.0).collect();
    let mode = |n: usize, f: &dyn Fn(f64) -> (f64, f64)| {
        let (damping_g, freq_hz) = speed.iter().map(|v| f(v / 400.0)).unzip();
        VgMode {
            label: format!("mode {n}"),
            speed_m_s: speed.clone(),
            damping_g,
            freq_hz,
        }
    };
    let modes = [
        mode(1, &|v| (-0.9 * v + 1.55 * v * v, 9.6 + 8.0 * v * v)),
        mode(2, &|v| (-0.25 * v - 0.3 * v * v, 38.2 - 14.0 * v * v)),
        mode(3, &|v| (-0.11 * v, 48.4 + 2.0 * v)),
        mode(4, &|v| (-0.05 * v - 0.1 * v * v, 91.5 - 3.0 * v)),
    ];
    let flutter = 0.9 / 1.55;
    let crossing = VgCrossing {
        kind: CrossingKind::Flutter,
        speed_m_s: 400.0 * flutter,
        freq_hz: 9.6 + 8.0 * flutter * flutter,
        damping_g: 0.0,
    };
    dip_report::vg("Damping and frequency against speed", &modes, &[crossing])
}

fn boundary() -> Figure {
    let machs = [0.499, 0.678, 0.901, 0.954, 1.072, 1.141];
    let curve = |label: &str, factors: [f64; 6], experiment: bool| {
        let dip = [0.446, 0.417, 0.370, 0.306, 0.320, 0.403];
        let points = machs
            .iter()
            .zip(dip)
            .zip(factors)
            .map(|((&mach, index), factor)| BoundaryPoint {
                mach,
                speed_index: index * factor,
                speed_index_error: if experiment { (0.01, 0.01) } else { (0.0, 0.0) },
                frequency_ratio: (index * 1.2 * factor).min(0.6),
            })
            .collect();
        BoundaryCurve {
            label: label.to_owned(),
            points,
            experiment,
        }
    };
    let curves = [
        curve("doublet lattice", [1.01, 1.03, 1.0, 1.09, f64::NAN, f64::NAN], false),
        curve("time marching, Euler", [1.0, 0.99, 0.97, 0.95, 1.25, 1.3], false),
        curve("corrected lattice", [1.0, 1.01, 0.98, 1.0, 1.1, 1.05], false),
        curve("experiment", [1.0; 6], true),
    ];
    dip_report::boundary("Flutter boundary (made-up curves)", &curves)
}

fn cp() -> Result<Figure, ReportError> {
    let cuts: Vec<CpCut> = [0.2, 0.44, 0.65, 0.9]
        .iter()
        .map(|eta| {
            let surface = |sign: f64, shock: f64| {
                (0..=80)
                    .map(|i| f64::from(i) / 80.0)
                    .map(|x| {
                        let jump = if x > shock { 0.55 } else { 0.0 };
                        (
                            x,
                            sign * (0.9 * (x * (1.0 - x)).sqrt() + 0.25) + jump * 0.5 * (1.0 - sign),
                        )
                    })
                    .collect::<Vec<_>>()
            };
            let mut round: Vec<(f64, f64)> = surface(0.35, 2.0).into_iter().rev().collect();
            round.extend(surface(-1.3, 0.6 - 0.2 * eta));
            let tests = round.iter().step_by(9).map(|(x, cp)| (*x, cp + 0.04)).collect();
            CpCut {
                label: format!("2y/b = {eta}"),
                computed: vec![("Euler".to_owned(), round)],
                measured: vec![("experiment".to_owned(), tests)],
                critical: Some(-0.32),
            }
        })
        .collect();
    dip_report::cp_cuts("Pressure along four cuts (made up)", &cuts, 2)
}

fn history() -> Result<Figure, ReportError> {
    let run = |f: &dyn Fn(f64) -> f64| (0..=120).map(f64::from).map(|i| (i, f(i))).collect::<Vec<_>>();
    let residuals = [
        (
            "density".to_owned(),
            run(&|i| (-0.13 * i).exp() * (1.3 + (0.9 * i).sin())),
        ),
        (
            "energy".to_owned(),
            run(&|i| 3.0 * (-0.125 * i).exp() * (1.3 + (0.7 * i).cos())),
        ),
    ];
    let loads = [
        ("C_{L}".to_owned(), run(&|i| 0.27 * (1.0 - (-0.09 * i).exp()))),
        ("C_{D}".to_owned(), run(&|i| 0.012 + 0.2 * (-0.2 * i).exp())),
    ];
    dip_report::history("Convergence", "Iteration", &residuals, &loads, Some(1e-6))
}

fn wing() -> (Mesh, usize, usize) {
    let (nx, ny) = (10, 20);
    let mut mesh = Mesh::default();
    for j in 0..=ny {
        for i in 0..=nx {
            let (s, t) = (f64::from(j) / f64::from(ny), f64::from(i) / f64::from(nx));
            mesh.nodes.push([0.81 * s + t * (0.559 - 0.19 * s), 0.762 * s, 0.0]);
        }
    }
    for j in 0..ny {
        for i in 0..nx {
            let n = (j * (nx + 1) + i) as usize;
            let row = (nx + 1) as usize;
            mesh.elements.push(vec![n, n + 1, n + 1 + row, n + row]);
        }
    }
    (mesh, nx as usize, ny as usize)
}

fn modes() -> Result<Figure, ReportError> {
    let (mesh, ..) = wing();
    let shape = |f: &dyn Fn(f64, f64) -> f64| {
        mesh.nodes
            .iter()
            .map(|n| f(n[1] / 0.762, n[0] - 0.81 * n[1] / 0.762 - 0.25))
            .collect::<Vec<f64>>()
    };
    let bending = shape(&|s, _| s * s * (1.0 + 0.2 * s));
    let torsion = shape(&|s, x| s * (x * 4.0) - 0.3 * (3.0 * s).sin() * s);
    let lift = |z: &[f64]| z.iter().map(|z| [0.0, 0.0, *z]).collect::<Vec<_>>();
    let row = |name: &str, z: &[f64]| -> Result<Vec<Chart>, ReportError> {
        Ok(vec![
            dip_report::mode_map(name, &mesh, z, "z displacement (mass 1)")?,
            dip_report::mode_view("", &mesh, &lift(z), None)?,
        ])
    };
    Ok(Figure::new("Mode shapes (made up)")
        .row(row("Mode 1, 9.60 Hz", &bending)?)
        .row(row("Mode 2, 38.2 Hz", &torsion)?))
}

fn lattice() -> Result<Figure, ReportError> {
    let (mesh, ..) = wing();
    let corner = |n: usize| [mesh.nodes[n][0], mesh.nodes[n][1]];
    let boxes: Vec<_> = mesh
        .elements
        .iter()
        .map(|e| [corner(e[0]), corner(e[1]), corner(e[2]), corner(e[3])])
        .collect();
    let mut weights: Vec<f64> = boxes
        .iter()
        .map(|b| 1.0 + 0.4 * (9.0 * b[0][0]).sin() * b[0][1])
        .collect();
    weights[77] = 2.6;
    weights[133] = -0.4;
    let pressures: Vec<f64> = boxes
        .iter()
        .enumerate()
        .map(|(i, b)| (1.0 - b[0][1]) / (0.3 + (i % 10) as f64))
        .collect();
    let worst = dip_report::worst_boxes(&weights, 1.0, 2);
    Ok(Figure::new("").row(vec![
        dip_report::lattice("Weights", &boxes, &weights, "Re W_{T}", ColorMap::Diverging, &worst)?,
        dip_report::lattice(
            "Pressures",
            &boxes,
            &pressures,
            "|ΔC_{p}| per rad",
            ColorMap::Sequential,
            &[],
        )?,
    ]))
}

fn table() -> Result<Table, ReportError> {
    let mut table = Table::new(
        "Flutter of the wing, made-up figures",
        vec![
            Column::text("Method"),
            Column::number("Mach", "", NumberFormat::Fixed(3)),
            Column::number("Flutter speed", "m/s", NumberFormat::Fixed(1)),
            Column::number("Error", "", NumberFormat::Percent(1)),
        ],
    );
    table.push(vec![
        "doublet lattice".into(),
        0.901.into(),
        297.1.into(),
        Cell::from(0.0014).good(),
    ])?;
    table.push(vec![
        "time marching".into(),
        0.901.into(),
        271.0.into(),
        Cell::from(-0.087).warning(),
    ])?;
    table.push(vec!["experiment".into(), 0.901.into(), 296.7.into(), Cell::missing()])?;
    Ok(table)
}
