//! Writes docs/validation/deck: decks against printed and exact results. `cargo run --release -p dip-deck --example validate_deck`

use std::{error::Error, fmt::Write as _, path::Path};

use dip_deck::{Solution, flutter::Crossing, run};
use dip_flutter::{CrossingKind, Direction};
use dip_report::{Chart, Figure, Series};

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let out = root.join("docs/validation/deck");
    std::fs::create_dir_all(&out)?;
    let decks = root.join("tests/data/nastran");
    let mut page = String::from(
        "# Nastran decks\n\nMade by `cargo run --release -p dip-deck --example validate_deck`. The decks are described in \
         `tests/data/nastran/README.md`; what of a deck is understood stands in `docs/nastran.md`.\n\n",
    );
    page += &printed(&root)?;
    page += &section(&run(decks.join("section_strip.bdf"))?)?;
    page += &two_wings(
        &run(decks.join("jet_wing_genel.bdf"))?,
        &run(decks.join("jet_wing_bars.bdf"))?,
    )?;
    page += &plate(&run(decks.join("swept_plate.bdf"))?, &out)?;
    std::fs::write(out.join("README.md"), page)?;
    Ok(())
}

fn onset(solution: &Solution, subcase: usize, kind: CrossingKind) -> Result<&Crossing, Box<dyn Error>> {
    let mut all = solution
        .subcases
        .get(subcase)
        .ok_or("no subcase")?
        .summaries
        .iter()
        .flat_map(|s| &s.crossings);
    Ok(all
        .find(|c| c.kind == kind && c.direction == Direction::Onset)
        .ok_or("no onset")?)
}

fn percent(got: f64, needed: f64) -> f64 {
    100.0 * (got / needed - 1.0)
}

/// MSC's printed rows, if the reference data lie beside the project.
fn printed(root: &Path) -> Result<String, Box<dyn Error>> {
    let folder = root.join("../shared/refdata/decks");
    let mut text = String::from("## MSC Nastran's printed KE summary, 15-degree swept wing (test problem PT145)\n\n");
    if !folder.is_dir() {
        text += "The reference deck was not beside the project when this page was made.\n\n";
        return Ok(text);
    }
    let solution = run(folder.join("swept15_ke.bdf"))?;
    let summary = &solution.subcases[0].summaries[0];
    let mut worst = [0.0_f64; 5];
    let mut rows = 0;
    text += "| mode | k | velocity, in/s | printed | damping g | printed | frequency, Hz | printed |\n|--:|--:|--:|--:|--:|--:|--:|--:|\n";
    for line in std::fs::read_to_string(folder.join("swept15_ke_msc.csv"))?.lines() {
        if !line.starts_with(|c: char| c.is_ascii_digit()) {
            continue;
        }
        let v: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>()?;
        let point = summary
            .points
            .iter()
            .find(|p| p.number as f64 == v[0])
            .ok_or("no such mode")?;
        let row = point
            .rows
            .iter()
            .find(|r| (r.k - v[1]).abs() < 1e-4)
            .ok_or("no such k")?;
        let pairs = [
            (row.velocity, v[2]),
            (row.damping, v[3]),
            (row.freq_hz, v[4]),
            (row.eigenvalue.re, v[5]),
            (row.eigenvalue.im, v[6]),
        ];
        for (worst, (got, needed)) in worst.iter_mut().zip(pairs) {
            *worst = worst.max((got / needed - 1.0).abs());
        }
        rows += 1;
        // The mode that flutters stands for the table; the line below it for all rows.
        if v[0] != 2.0 {
            continue;
        }
        writeln!(
            text,
            "| {} | {} | {:.4} | {:.4} | {:.8} | {:.8} | {:.6} | {:.6} |",
            v[0], v[1], row.velocity, v[2], row.damping, v[3], row.freq_hz, v[4]
        )?;
    }
    writeln!(
        text,
        "\nLargest relative difference over the {rows} rows: velocity {:.1e}, damping {:.1e}, frequency {:.1e}, real part {:.1e}, \
         imaginary part {:.1e}. The rows between the hard points k = 0.001, 0.1 and 0.2 and beyond them rest on the natural cubic \
         spline of Q over k (IMETH L).\n",
        worst[0], worst[1], worst[2], worst[3], worst[4]
    )?;
    let flutter = onset(&solution, 0, CrossingKind::Flutter)?;
    writeln!(
        text,
        "Flutter point (g = 0, solved for): {:.2} in/s, {:.3} Hz, k {:.5}.\n",
        flutter.velocity, flutter.freq_hz, flutter.k
    )?;
    Ok(text)
}

fn section(solution: &Solution) -> Result<String, Box<dyn Error>> {
    let mut text = String::from(
        "## Section by strip theory (CAERO4)\n\nReference: U-g solution with Theodorsen's exact function, first case of \
         `tests/data/flutter/theodorsen_2dof_flutter.csv`.\n\n| method | U / (b omega_a) | reference | omega / omega_a | reference | k | \
         reference |\n|---|--:|--:|--:|--:|--:|--:|\n",
    );
    for (subcase, method) in ["PK", "K"].into_iter().enumerate() {
        let c = onset(solution, subcase, CrossingKind::Flutter)?;
        writeln!(
            text,
            "| {method} | {:.5} | 2.18391 | {:.5} | 0.64898 | {:.5} | 0.29717 |",
            c.velocity / 10.0,
            c.freq_hz * std::f64::consts::TAU / 20.0,
            c.k
        )?;
    }
    text += "\n";
    Ok(text)
}

fn two_wings(genel: &Solution, bars: &Solution) -> Result<String, Box<dyn Error>> {
    let mut text = String::from(
        "## One wing as GENEL and as CBARs\n\n| figure | GENEL | CBAR | difference, % |\n|---|--:|--:|--:|\n",
    );
    let (a, b) = (&genel.subcases[0].modes, &bars.subcases[0].modes);
    for mode in 0..a.count().min(b.count()).min(6) {
        let (x, y) = (a.freq_hz(mode), b.freq_hz(mode));
        writeln!(
            text,
            "| mode {}, Hz | {x:.6} | {y:.6} | {:.1e} |",
            mode + 1,
            percent(x, y)
        )?;
    }
    for (kind, name) in [
        (CrossingKind::Flutter, "flutter speed, m/s"),
        (CrossingKind::Divergence, "divergence speed, m/s"),
    ] {
        let (x, y) = (onset(genel, 0, kind)?.velocity, onset(bars, 0, kind)?.velocity);
        writeln!(text, "| {name} | {x:.4} | {y:.4} | {:.1e} |", percent(x, y))?;
    }
    text += "\n";
    Ok(text)
}

fn plate(solution: &Solution, out: &Path) -> Result<String, Box<dyn Error>> {
    let mut text = String::from(
        "## Plate wing swept by 15 degrees\n\nReference: modes of MSC's HA145E and ZAERO's g-method (ZONA6) for it, as kept with \
         pyNastran's ZAERO examples. Geometry from the public example HA145Z, moduli from memory, so the comparison is a near one; \
         the root is held at two points (with their rotations), which is a singular support: with our element the first frequency \
         falls from 32.5 to 31.2 and 30.0 Hz when the mesh is halved twice, and with the whole middle of the root held it is 38.3, \
         38.5 and 38.5 Hz. So the printed frequencies belong to MSC's element on this mesh as much as to the plate.\n\n| figure | ours | reference | difference, % \
         |\n|---|--:|--:|--:|\n",
    );
    let subcase = &solution.subcases[0];
    for (mode, needed) in [34.344, 210.00, 260.43, 634.76].into_iter().enumerate() {
        let got = subcase.modes.freq_hz(mode);
        writeln!(
            text,
            "| mode {}, Hz | {got:.3} | {needed} | {:.2} |",
            mode + 1,
            percent(got, needed)
        )?;
    }
    for (index, method) in ["PK", "K"].into_iter().enumerate() {
        let c = onset(solution, index, CrossingKind::Flutter)?;
        writeln!(
            text,
            "| flutter speed by {method}, ft/s | {:.3} | 479.43 (g) | {:.2} |",
            c.velocity,
            percent(c.velocity, 479.43)
        )?;
        writeln!(
            text,
            "| flutter frequency by {method}, Hz | {:.3} | 111.70 (g) | {:.2} |",
            c.freq_hz,
            percent(c.freq_hz, 111.70)
        )?;
    }
    let mut damping = Chart::new("", "Velocity, ft/s", "Damping g").hline(0.0, "");
    let mut frequency = Chart::new("", "Velocity, ft/s", "Frequency, Hz");
    for point in &subcase.summaries[0].points {
        let line =
            |value: fn(&dip_deck::flutter::Row) -> f64| point.rows.iter().map(|r| (r.velocity, value(r))).collect();
        let label = format!("mode {}", point.number);
        damping = damping.series(Series::line(label.clone(), line(|r| r.damping)));
        frequency = frequency.series(Series::line(label, line(|r| r.freq_hz)));
    }
    let figure = Figure::new("Swept plate wing, PK, Mach 0.45")
        .row(vec![damping])
        .row(vec![frequency])
        .share_x();
    std::fs::write(out.join("swept_plate.svg"), figure.svg(760, 620)?)?;
    text += "\n![V-g and V-f of the plate wing](swept_plate.svg)\n";
    Ok(text)
}
