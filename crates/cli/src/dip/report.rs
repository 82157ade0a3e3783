//! The report of a study: one self-contained HTML page, and its figures as SVG files beside it.

use super::compare::{Compared, curve_table};
use super::curve::{BoundaryRow, CurveResult, MethodRow};
use super::study::{Point, Study};
use crate::exit::Stop;
use crate::figures;
use crate::output::RunFolder;
use crate::progress::Seconds;
use crate::stamp::Stamp;
use dip_report::{
    Block, BoundaryCurve, BoundaryPoint, Column, Figure, NumberFormat, Page, ReportError, Table, boundary,
};

/// Draws all figures and writes them and the page.
///
/// # Errors
/// What the file system says.
pub fn write(
    folder: &RunFolder,
    study: &Study,
    results: &[CurveResult],
    points: &[Compared],
    stamp: &Stamp,
    total: Seconds,
) -> Result<(), Stop> {
    let r = &study.reference;
    let mut page = Page::new(study.file.title.clone())
        .stamp("program", format!("dip {} ({})", stamp.version, stamp.commit))
        .stamp("study", study.document.file().display().to_string())
        .stamp(
            "inputs",
            format!("SHA-256 {}", stamp.fingerprint.get(..16).unwrap_or(&stamp.fingerprint)),
        )
        .stamp(
            "time taken by this call",
            format!("{:.1} s (CPU {:.1} s)", total.wall_s, total.cpu_s),
        );

    let mut summary = Vec::new();
    if let Some(text) = &study.file.description {
        summary.push(Block::Paragraph(text.clone()));
    }
    for result in results {
        summary.push(Block::Table(curve_table(&result.name, points)?));
    }
    summary.push(Block::Paragraph(
        "\u{3c1} density, U flutter speed, f flutter frequency, FSI flutter speed index; exp. stands for experiment. The error is that of the speed index; the time is that of the point, recordings and marches included. In the frequency domain the speed is varied at the point's density, a march holds the speed and varies the density.".into(),
    ));
    summary.push(figure(
        folder,
        "boundary",
        &boundary_figure(study, results),
        (820, 760),
        "Flutter boundary: speed index and frequency ratio against Mach number.",
    )?);
    for result in results {
        summary.extend(
            result
                .warnings
                .iter()
                .map(|w| Block::Warning(format!("{}: {w}", result.name))),
        );
    }
    summary.push(Block::Table(cost_table(results)?));
    page = page.section("Boundary", summary);
    page = page.section(
        "Reference quantities",
        vec![
            Block::Pairs(vec![
                ("root semichord b".into(), format!("{} m", r.semichord_m)),
                ("torsion frequency \u{3c9}_\u{3b1}".into(), format!("{:.2} rad/s ({:.3} Hz)", r.omega_alpha_rad_s, r.omega_alpha_rad_s / std::f64::consts::TAU)),
                ("mass m".into(), format!("{} kg", r.mass_kg)),
                ("volume V".into(), format!("{} m\u{b3}", r.volume_m3)),
            ]),
            Block::Paragraph(
                "Flutter speed index FSI = U / (b \u{3c9}_\u{3b1} \u{221a}\u{b5}), mass ratio \u{b5} = m / (\u{3c1} V), reduced frequency k = \u{3c9} b / U. One set of reference quantities serves all curves, the experiment included.".into(),
            ),
        ],
    );
    for (result, curve) in results.iter().zip(&study.curves) {
        page = page.section(result.name.clone(), curve_section(folder, result, &curve.slug())?);
    }
    let beside = super::damping::figures(results);
    if !beside.is_empty() {
        let mut blocks = Vec::new();
        for (mach, chart) in &beside {
            let caption = format!(
                "V-g and V-f at Mach {mach}: runs of the march (markers) beside the frequency domain (dashed)."
            );
            blocks.push(figure(
                folder,
                &format!("damping_M{mach:.3}"),
                chart,
                (860, 760),
                &caption,
            )?);
        }
        page = page.section("Subcritical damping", blocks);
    }
    page = page.section("Sources and inputs", sources(study));
    folder.write("report.html", page.html().as_bytes())?;
    Ok(())
}

/// Draws a figure into a file and a block of the page.
fn figure(
    folder: &RunFolder,
    name: &str,
    figure: &Figure,
    (width, height): (u32, u32),
    caption: &str,
) -> Result<Block, Stop> {
    let draw = || -> Result<(String, Block), ReportError> {
        Ok((
            figure.svg(width, height)?,
            Block::figure(figure, width, height, caption)?,
        ))
    };
    let (svg, block) = draw().map_err(|e| figures::drawing(&e))?;
    folder.write(&format!("{name}.svg"), svg.as_bytes())?;
    Ok(block)
}

fn boundary_figure(study: &Study, results: &[CurveResult]) -> Figure {
    let of = |label: &str, points: &[Point], experiment: bool| BoundaryCurve {
        label: label.to_owned(),
        points: points
            .iter()
            .filter(|p| p.mach <= study.file.mach.iter().copied().fold(0.0, f64::max) + 1e-6 || experiment)
            .map(|p| BoundaryPoint {
                mach: p.mach,
                speed_index: p.flutter_speed_index.unwrap_or(f64::NAN),
                speed_index_error: (0.0, 0.0),
                frequency_ratio: p.frequency_ratio.unwrap_or(f64::NAN),
            })
            .collect(),
        experiment,
    };
    let mut curves = Vec::new();
    if !study.experiment.is_empty() {
        curves.push(of("experiment", &study.experiment, true));
    }
    for result in results {
        let index = |row: &BoundaryRow| {
            row.flutter_speed_m_s
                .map_or(f64::NAN, |u| study.reference.speed_index(u, row.density_kg_m3))
        };
        let points = result.boundary.iter().map(|row| BoundaryPoint {
            mach: row.mach,
            speed_index: index(row),
            speed_index_error: row.uncertainty.map_or((0.0, 0.0), |u| (u * index(row), u * index(row))),
            frequency_ratio: row
                .flutter_frequency_hz
                .map_or(f64::NAN, |f| study.reference.frequency_ratio(f)),
        });
        curves.push(BoundaryCurve {
            label: result.name.clone(),
            points: points.collect(),
            experiment: false,
        });
    }
    curves.extend(study.published.iter().map(|p| of(&p.name, &p.points, false)));
    boundary(study.file.title.clone(), &curves)
}

/// One curve: structure, V-g and V-f, all methods, times.
fn curve_section(folder: &RunFolder, result: &CurveResult, slug: &str) -> Result<Vec<Block>, Stop> {
    let frequencies: Vec<String> = result
        .natural_frequencies_hz
        .iter()
        .map(|f| format!("{f:.3}"))
        .collect();
    let mut pairs = vec![(
        "natural frequencies".to_owned(),
        format!("{} Hz", frequencies.join(", ")),
    )];
    if let Some(boxes) = result.boxes {
        pairs.push(("boxes of the lattice".to_owned(), boxes.to_string()));
    }
    if let Some(cells) = result.cells {
        pairs.push(("cells of the grid".to_owned(), cells.to_string()));
    }
    if let Some(mass) = result.structure_mass_kg {
        pairs.push(("mass of the structural model".to_owned(), format!("{mass:.4} kg")));
    }
    let mut blocks = vec![Block::Pairs(pairs)];
    blocks.extend(result.notes.iter().map(|n| Block::Paragraph(n.clone())));
    if let Some(shapes) = result.shapes.as_ref().map_or(Ok(None), |s| figures::mode_maps(s, 4))? {
        let height = 380 * u32::try_from(shapes.rows.len()).unwrap_or(1) + 40;
        let caption = "Mode shapes: z displacement over the planform, node lines in black.";
        blocks.push(figure(
            folder,
            &format!("{slug}_modes"),
            &shapes,
            (900, height),
            caption,
        )?);
    }
    for curves in &result.curves {
        let name = format!("{slug}_vg_M{:.3}", curves.mach);
        let caption = format!("V-g and V-f at Mach {}, {} method.", curves.mach, curves.method);
        blocks.push(figure(
            folder,
            &name,
            &figures::vg(curves, figures::SPEED)?,
            (760, 700),
            &caption,
        )?);
    }
    let fixed = |name: &str, unit: &str, digits: usize| Column::number(name, unit, NumberFormat::Fixed(digits));
    let mut methods = Table::new(
        "All methods",
        vec![
            fixed("Mach", "", 3),
            Column::text("correction"),
            Column::text("method"),
            fixed("speed", "m/s", 3),
            fixed("frequency", "Hz", 3),
            fixed("k", "", 4),
            fixed("FSI", "", 4),
            fixed("mode", "", 0),
        ],
    );
    for MethodRow { correction, row } in &result.rows {
        let cells = vec![
            row.mach.into(),
            correction.as_str().into(),
            row.method.name().into(),
            row.flutter_speed_m_s.into(),
            row.flutter_frequency_hz.into(),
            row.reduced_frequency.into(),
            row.flutter_speed_index.into(),
            row.mode.map(|m| m as f64).into(),
        ];
        methods.push(cells).map_err(|e| figures::drawing(&e))?;
    }
    blocks.push(Block::Table(methods));
    let mut times = Table::new(
        "Time taken",
        vec![Column::text("stage"), fixed("wall", "s", 3), fixed("CPU", "s", 3)],
    );
    for (stage, seconds) in &result.stages {
        let cells = vec![stage.as_str().into(), seconds.wall_s.into(), seconds.cpu_s.into()];
        times.push(cells).map_err(|e| figures::drawing(&e))?;
    }
    blocks.push(Block::Table(times));
    if !result.audit.is_empty() {
        blocks.push(Block::Table(audit_table(result)?));
    }
    Ok(blocks)
}

/// The audit of the hand-over from recordings.
fn audit_table(result: &CurveResult) -> Result<Table, Stop> {
    let mut table = Table::new(
        "Audit of the hand-over from the recordings",
        vec![
            Column::number("Mach", "", NumberFormat::Fixed(3)),
            Column::text("check"),
            Column::text("of"),
            Column::number("value", "", NumberFormat::Scientific(2)),
            Column::number("limit", "", NumberFormat::Scientific(1)),
            Column::text("verdict"),
        ],
    );
    for line in &result.audit {
        let cells = vec![
            line.mach.into(),
            line.check.as_str().into(),
            line.subject.as_str().into(),
            line.value.into(),
            line.limit.into(),
            line.verdict.as_str().into(),
        ];
        table.push(cells).map_err(|e| figures::drawing(&e))?;
    }
    Ok(table)
}

/// Wall and CPU seconds a flutter point, by curve: what each way of finding the boundary costs.
fn cost_table(results: &[CurveResult]) -> Result<Table, Stop> {
    let fixed = |name: &str, unit: &str| Column::number(name, unit, NumberFormat::Fixed(2));
    let mut table = Table::new(
        "Time per flutter point",
        vec![
            Column::text("curve"),
            Column::number("points", "", NumberFormat::Fixed(0)),
            fixed("wall", "s"),
            fixed("CPU", "s"),
            fixed("slowest, wall", "s"),
        ],
    );
    for r in results {
        let n = r.boundary.len().max(1) as f64;
        let mean = |value: fn(&BoundaryRow) -> f64| r.boundary.iter().map(value).sum::<f64>() / n;
        let cells = vec![
            r.name.as_str().into(),
            (r.boundary.len() as f64).into(),
            mean(|b| b.time_s).into(),
            mean(|b| b.cpu_s).into(),
            r.boundary.iter().map(|b| b.time_s).fold(0.0, f64::max).into(),
        ];
        table.push(cells).map_err(|e| figures::drawing(&e))?;
    }
    Ok(table)
}

fn sources(study: &Study) -> Vec<Block> {
    let mut list = Vec::new();
    if let Some(path) = &study.file.experiment {
        list.push(format!("experiment: {}", path.display()));
    }
    list.extend(study.published.iter().map(|p| format!("{}: {}", p.name, p.source)));
    let mut blocks = vec![Block::List(list)];
    blocks.push(Block::Details {
        summary: study.document.file().display().to_string(),
        text: study.document.text().to_owned(),
    });
    for curve in &study.curves {
        blocks.push(Block::Details {
            summary: format!("{}: {}", curve.table.name, curve.table.case.display()),
            text: curve.case_text(),
        });
    }
    blocks
}
