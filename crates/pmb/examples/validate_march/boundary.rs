//! The flutter boundary of AGARD 445.6 on several grids, with Yates' modes and those of the plate.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use dip_flutter::search::SearchStep;
use dip_report::{Chart, Figure, Marker, Series};

use crate::agard::{self, frequency_ratio, speed_index};
use crate::driver::{Case, Outcome};
use crate::{mesh, percent, root, search};

/// A flutter point at one Mach number as a row of the table, and its point for the figure.
fn flutter_row(page: &mut String, label: &str, case: &Case, point: &agard::Point) -> Outcome<Option<(f64, f64, f64)>> {
    println!("{label}, Mach {}", point.mach);
    let (still, seconds) = case.still()?;
    let rho = point.density_kg_m3;
    let found = case.search(&still, search(rho, [0.2 * rho, 4.0 * rho], 0.01), |d| {
        agard::stream(point.speed_m_s, d)
    })?;
    let measured = speed_index(point.speed_m_s, rho);
    Ok(match found.neutral() {
        Some(n) => {
            let index = speed_index(point.speed_m_s, n.at);
            let ratio = frequency_ratio(n.freq_hz);
            let experiment = |value: String| if point.freq_hz.is_some() { value } else { "-".to_owned() };
            let _ = writeln!(
                page,
                "| {label} | {} | {:.4} +- {:.4} | {index:.4} | {} | {ratio:.4} | {} | {} | {:.1} + {:.1} |",
                point.mach,
                n.at,
                n.error,
                experiment(percent(index, measured)),
                point.freq_hz.map_or("-".to_owned(), |f| percent(n.freq_hz, f)),
                found.rows.len(),
                seconds,
                found.cpu_s
            );
            Some((point.mach, index, ratio))
        }
        None => {
            let end = match &found.end {
                SearchStep::StableThroughout => "stable throughout".to_owned(),
                SearchStep::UnstableThroughout => "unstable throughout".to_owned(),
                SearchStep::Divergence(at) => format!("diverges between {:.4} and {:.4}", at[0], at[1]),
                end => format!("{end:?}"),
            };
            let _ = writeln!(
                page,
                "| {label} | {} | {end} | | | | | {} | |",
                point.mach,
                found.rows.len()
            );
            None
        }
    })
}

const AGARD_TABLE: &str = "| grid and modes | Mach | density, kg/m^3 | speed index | to experiment | frequency ratio | to experiment | marches | CPU, s (steady + marches) |\n\
    |---|---|---|---|---|---|---|---|---|\n";

type Curve = (String, Vec<(f64, f64, f64)>);

fn boundary_figure(folder: &Path, name: &str, curves: &[Curve]) -> Outcome<()> {
    let points = agard::experiment()?;
    let measured = |value: &dyn Fn(&agard::Point) -> Option<f64>| -> Vec<(f64, f64)> {
        points.iter().filter_map(|p| Some((p.mach, value(p)?))).collect()
    };
    let mut speed =
        Chart::new("Flutter speed index", "Mach number", "U / (b omega_{alpha} mu^{1/2})").series(Series::experiment(
            "experiment",
            measured(&|p| p.freq_hz.map(|_| speed_index(p.speed_m_s, p.density_kg_m3))),
            Marker::Circle,
        ));
    let mut frequency =
        Chart::new("Frequency ratio", "Mach number", "omega / omega_{alpha}").series(Series::experiment(
            "experiment",
            measured(&|p| p.freq_hz.map(frequency_ratio)),
            Marker::Circle,
        ));
    for (n, (label, points)) in curves.iter().enumerate() {
        let marker = Marker::ALL[(1 + n) % Marker::ALL.len()];
        let curve = |value: &dyn Fn(&(f64, f64, f64)) -> f64| points.iter().map(|p| (p.0, value(p))).collect();
        speed = speed.series(Series::line_markers(label, curve(&|p| p.1), marker));
        frequency = frequency.series(Series::line_markers(label, curve(&|p| p.2), marker));
    }
    let dlm = dlm()?;
    speed = speed.series(Series::dashed(
        "doublet lattice (PanelAero)",
        dlm.iter().map(|p| (p.0, p.1)).collect(),
    ));
    frequency = frequency.series(Series::dashed(
        "doublet lattice (PanelAero)",
        dlm.iter().map(|p| (p.0, p.2)).collect(),
    ));
    let figure = Figure::new("AGARD 445.6").row(vec![speed, frequency]);
    fs::write(folder.join(name), figure.svg(1200, 480)?)?;
    Ok(())
}

/// `cases/agard445/published/panelaero_dlm.csv`: Mach number, speed index, frequency ratio.
fn dlm() -> Outcome<Vec<(f64, f64, f64)>> {
    let text = fs::read_to_string(root().join("cases/agard445/published/panelaero_dlm.csv"))?;
    let mut points = Vec::new();
    for line in text.lines().filter(|l| !l.starts_with('#')).skip(1) {
        let row = line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
        if let [mach, density, speed, freq] = row[..] {
            points.push((mach, speed_index(speed, density), frequency_ratio(freq)));
        }
    }
    Ok(points)
}

/// Which structure and which flow a curve is made with.
#[derive(Clone, Copy)]
struct Variant {
    label: &'static str,
    mesh: &'static str,
    /// `yates` or `own`.
    modes: &'static str,
    /// The wall is displaced along z only.
    along_z: bool,
    /// Limiter's constant, if not the default.
    limiter_constant: Option<f64>,
}

impl Variant {
    const fn new(label: &'static str, mesh: &'static str, modes: &'static str) -> Self {
        Self {
            label,
            mesh,
            modes,
            along_z: false,
            limiter_constant: None,
        }
    }
}

fn curve(page: &mut String, variant: Variant, machs: &[f64]) -> Outcome<Curve> {
    let grid = mesh(variant.mesh)?;
    let modes = agard::modes(variant.modes, 4)?;
    let mut points = Vec::new();
    for point in agard::experiment()?.iter().filter(|p| machs.contains(&p.mach)) {
        let mut case = agard::case_along(&grid, &modes, point.mach, 0.0, variant.along_z)?;
        if let Some(constant) = variant.limiter_constant {
            case.steady.limiter_constant = constant;
        }
        points.extend(flutter_row(page, variant.label, &case, point)?);
    }
    Ok((variant.label.to_owned(), points))
}

const ALL_MACHS: [f64; 7] = [0.499, 0.678, 0.901, 0.96, 0.99, 1.072, 1.141];

pub fn agard_boundary(folder: &Path) -> Outcome<String> {
    let mut page = format!(
        "## AGARD 445.6: the boundary with Yates' modes\n\n\
        Euler flow, four modes of Yates (generalized mass 175.127 kg, 9.60, 38.2, 48.3, 91.5 Hz), no structural damping, no incidence. At the \
        experiment's speed the density is searched; the first one tried is the experiment's. Index and ratio use omega_alpha = 2 pi 38.1 rad/s and m = \
        1.862 kg for all. O-O coarse: 23,040 cells; C-H: 53,760 cells.\n\n{AGARD_TABLE}"
    );
    let curves = [
        curve(
            &mut page,
            Variant::new("O-O coarse, Yates", "agard445_oo_coarse", "yates"),
            &ALL_MACHS,
        )?,
        curve(
            &mut page,
            Variant::new("C-H 53,760, Yates", "agard445_ch_euler", "yates"),
            &ALL_MACHS,
        )?,
    ];
    boundary_figure(folder, "agard.svg", &curves)?;
    page.push_str("\n![AGARD 445.6](agard.svg)\n");
    Ok(page)
}

pub fn agard_medium(_: &Path) -> Outcome<String> {
    let mut page = format!(
        "## AGARD 445.6: other grids\n\n\
        O-O medium: 184,320 cells. C-H coarse: 14,336 cells, C-H 202,752: one and a half times as many in each direction as 53,760. At Mach 0.678 grids hardly \
        matter. At 0.96 the shock of inviscid flow moves aft and grows with the number of cells, and the index falls without having settled, as in published \
        Euler marches (0.227, 0.192, 0.175 from coarse to fine: the thesis's reference 49; its own brackets of density make 0.24 - 0.27): there agreement with \
        experiment on a coarse grid is chance.\n\n{AGARD_TABLE}"
    );
    for variant in [
        Variant::new("C-H coarse, Yates", "agard445_ch_euler_coarse", "yates"),
        Variant::new("C-H coarse, plate", "agard445_ch_euler_coarse", "own"),
        Variant::new("C-H 202,752, Yates", "agard445_ch_euler_medium", "yates"),
        Variant::new("O-O medium, Yates", "agard445_oo_medium", "yates"),
        Variant::new("O-O medium, plate", "agard445_oo_medium", "own"),
    ] {
        curve(&mut page, variant, &[0.678, 0.96])?;
    }
    Ok(page)
}

pub fn agard_own(_: &Path) -> Outcome<String> {
    let mut page = format!(
        "## AGARD 445.6: modes of the plate\n\n\
        The thesis's plate (11 x 21 nodes, 1.69 kg; 9.47, 39.5, 48.9, 94.4 Hz). An independent code (Euler, a C-H grid of its own of 53,760 cells, modes of a \
        plate with 9.45, 39.67, 49.64, 95.5 Hz, displaced along z only, U = 309 m/s, Mach 0.96) found flutter at 1.13 - 1.14 times the experiment's \
        dynamic pressure (index 0.327 - 0.329) and 14.5 Hz. Ours on a grid of as many cells is there with a limiter that acts everywhere \
        (constant 1 or less), and below it with the default of 5, which hardly acts in smooth flow: the limiter counts as much as the grid at this Mach number. \
        Displacing along z only does not.\n\n{AGARD_TABLE}"
    );
    curve(
        &mut page,
        Variant::new("O-O coarse, plate", "agard445_oo_coarse", "own"),
        &ALL_MACHS,
    )?;
    curve(
        &mut page,
        Variant::new("C-H 53,760, plate", "agard445_ch_euler", "own"),
        &ALL_MACHS,
    )?;
    let like = Variant::new("C-H 53,760, plate, z only", "agard445_ch_euler", "own");
    curve(&mut page, Variant { along_z: true, ..like }, &[0.96])?;
    for (label, constant) in [
        ("C-H 53,760, plate, limiter constant 1", 1.0),
        ("C-H 53,760, plate, limiter constant 0.1", 0.1),
    ] {
        let limiter_constant = Some(constant);
        curve(
            &mut page,
            Variant {
                label,
                limiter_constant,
                ..like
            },
            &[0.96],
        )?;
    }
    Ok(page)
}
