//! An independent code's flutter point at Mach 0.96, on grids that are like its own.
//!
//! Its grid is not at hand. Known are its kind and size, 97 x 21 x 29 points, and lift and drag of two codes on it in steady
//! flow at 1 degree. So grids of that size are drawn, ranked by how near our lift and drag come to those, and the nearest are
//! marched. Flutter takes no part in the choice.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use dip_grid::MultiBlock;
use dip_grid::recipe::{self, Length};
use dip_modal::{MassForm, Modes, ThicknessRule};
use dip_pmb::observer::Silent;
use dip_pmb::reconstruct::Reconstruction;
use dip_pmb::settings::SteadySettings;
use dip_pmb::steady;
use dip_report::{Chart, Marker, Series};

use crate::agard::{self, speed_index};
use crate::driver::Outcome;
use crate::{percent, root, search};

const MACH: f64 = 0.96;
/// Lift and drag coefficient at 1 degree on the code's grid: ADflow without limiter, with van Albada's, and CFL3D with its
/// smooth limiter.
const UNLIMITED: [f64; 2] = [0.07123, 0.00123];
const LIMITED: [f64; 2] = [0.07034, 0.00255];
const SMOOTH: [f64; 2] = [0.07204, 0.00183];
/// Its dynamic pressure at flutter over that of the experiment, from and to, and the frequencies of its plate, Hz.
const PRESSURE: [f64; 2] = [1.13, 1.14];
const FREQUENCY_HZ: f64 = 14.5;
const PLATE_HZ: [f64; 4] = [9.45, 39.67, 49.64, 95.5];
const DRAWN: usize = 96;
const NEAREST: usize = 6;
/// Ranks further down that are marched to show what lift says about flutter.
const OTHERS: [usize; 4] = [19, 38, 57, 76];

/// What differs between grids of 97 x 21 x 29 points.
#[derive(Clone, Copy, Debug)]
struct Shape {
    /// Cells along each surface (the rest of 48 along the wake) and along the span of the wing (the rest of 28 outboard).
    surface: usize,
    span: usize,
    /// Steps at nose and tail, in chords; off the wall, at root and tip, metres.
    nose: f64,
    tail: f64,
    wall_m: f64,
    root_m: f64,
    tip_m: f64,
    far_m: f64,
}

/// The `n`-th point of an additive recurrence that fills the unit cube of `D` dimensions evenly: multiples of the powers
/// of 1/g, where g^(D+1) = g + 1 (the golden ratio for D = 1; M. Roberts 2018), less whole numbers.
fn recurrence<const D: usize>(n: usize) -> [f64; D] {
    let mut g = 1.0_f64;
    for _ in 0..64 {
        g = (1.0 + g).powf(1.0 / (D + 1) as f64);
    }
    std::array::from_fn(|d| (0.5 + n as f64 * g.powi(-(d as i32) - 1)).fract())
}

impl Shape {
    /// The `n`-th grid, lengths spread by their logarithm.
    fn drawn(n: usize) -> Self {
        let u = recurrence::<8>(n);
        let even = |u: f64, from: usize, to: usize| from + 2 * (u * ((to - from) / 2 + 1) as f64) as usize;
        let length = |u: f64, from: f64, to: f64| from * (to / from).powf(u);
        Self {
            surface: even(u[0], 20, 40),
            span: even(u[1], 12, 22),
            nose: length(u[2], 0.0005, 0.004),
            tail: length(u[3], 0.001, 0.03),
            wall_m: length(u[4], 0.1e-3, 1.2e-3),
            root_m: length(u[5], 0.035, 0.09),
            tip_m: length(u[6], 0.002, 0.012),
            far_m: length(u[7], 5.0, 25.0),
        }
    }

    /// The shipped recipe of the size with these numbers.
    fn grid(&self) -> Outcome<MultiBlock> {
        let mut r = recipe::read(&root().join("meshes/agard445_ch_euler.toml"))?;
        (r.cells.surface, r.cells.wake) = (Some(self.surface), Some(48 - self.surface));
        (r.cells.span, r.cells.outboard) = (Some(self.span), Some(28 - self.span));
        (r.spacing.nose, r.spacing.tail) = (Some(self.nose), Some(self.tail));
        r.spacing.wall = Some(Length(self.wall_m));
        (r.spacing.root, r.spacing.tip) = (Some(Length(self.root_m)), Some(Length(self.tip_m)));
        (r.extent.far_field, r.extent.exit) = (Some(Length(self.far_m)), Some(Length(1.2 * self.far_m)));
        Ok(r.make()?)
    }

    fn row(&self) -> String {
        format!(
            "{} | {} | {:.2} | {:.1} | {:.2} | {:.0} | {:.1} | {:.1}",
            self.surface,
            self.span,
            100.0 * self.nose,
            100.0 * self.tail,
            1e3 * self.wall_m,
            1e3 * self.root_m,
            1e3 * self.tip_m,
            self.far_m
        )
    }
}

/// Lift and drag coefficient at 1 degree.
fn forces(grid: &MultiBlock, change: impl Fn(&mut SteadySettings)) -> Outcome<[f64; 2]> {
    let mut s = SteadySettings::default();
    s.flow.mach = MACH;
    s.flow.alpha_deg = 1.0;
    s.reference.area = 0.35315;
    s.solver.orders = 5.0;
    change(&mut s);
    let total = steady::run(&s, grid, &mut Silent, &AtomicBool::new(false))?.loads.total;
    Ok([total.cl, total.cd])
}

/// A grid with its coefficients: without limiter, with the limiter that acts everywhere, with the default one.
struct Candidate {
    name: String,
    shape: String,
    grid: MultiBlock,
    coefficients: [[f64; 2]; 3],
}

impl Candidate {
    fn new(name: String, shape: String, grid: MultiBlock) -> Outcome<Self> {
        let coefficients = [
            forces(&grid, |s| s.reconstruction = Reconstruction::Unlimited)?,
            forces(&grid, |s| s.limiter_constant = 0.01)?,
            forces(&grid, |_| ())?,
        ];
        println!("{name}: {shape}: {coefficients:?}");
        Ok(Self {
            name,
            shape,
            grid,
            coefficients,
        })
    }

    /// Distance to the code's grid: root mean square over lift and drag by the three limiters, in units of the spread of the
    /// three pairs.
    fn distance(&self) -> f64 {
        let published = [UNLIMITED, LIMITED, SMOOTH];
        let mut sum = 0.0;
        for c in 0..2 {
            let value = |pair: &[f64; 2]| pair[c];
            let most = published.iter().map(value).fold(f64::MIN, f64::max);
            let least = published.iter().map(value).fold(f64::MAX, f64::min);
            for (ours, theirs) in self.coefficients.iter().zip(published) {
                sum += ((ours[c] - theirs[c]) / (most - least)).powi(2);
            }
        }
        (sum / 6.0).sqrt()
    }
}

/// A plate by what the thesis leaves open, with the code's frequencies in place of its own.
struct Plate {
    modes: Modes,
    words: String,
    own_hz: Vec<f64>,
    /// Root mean square by which its own frequencies miss the code's.
    miss: f64,
}

/// The plates, those first whose own frequencies are nearest to the code's.
fn plates() -> Outcome<Vec<Plate>> {
    let mut all = Vec::new();
    for ordinates in ["R765", "TN3047"] {
        for (rule, thickness) in [
            (ThicknessRule::Nodal, "thickness of the nodes"),
            (ThicknessRule::ElementMean, "mean thickness of the elements"),
            (ThicknessRule::ExactSection, "exact section"),
        ] {
            for (form, mass) in [
                (MassForm::Lumped, "lumped mass"),
                (MassForm::Consistent, "consistent mass"),
            ] {
                let mut modes = agard::plate(ordinates, rule, form, 4)?;
                let own_hz: Vec<f64> = (0..4).map(|m| modes.freq_hz(m)).collect();
                let off = |m: usize| own_hz[m] / PLATE_HZ[m] - 1.0;
                let miss = ((0..4).map(|m| off(m).powi(2)).sum::<f64>() / 4.0).sqrt();
                modes.omega_rad_s = PLATE_HZ.iter().map(|f| TAU * f).collect();
                let words = format!("{ordinates}, {thickness}, {mass}");
                all.push(Plate {
                    modes,
                    words,
                    own_hz,
                    miss,
                });
            }
        }
    }
    all.sort_by(|a, b| a.miss.total_cmp(&b.miss));
    Ok(all)
}

/// Kappa = 1/3 and the limiter of CFL3D's `iflim` 4, whose constant is 10 over the cube root of the number of cells (xlim.F and
/// gfluxr.F of nasa/CFL3D). Which of its limiters made the figure is not known.
pub fn with_koren(s: &mut SteadySettings) {
    s.reconstruction = Reconstruction::Koren;
    s.limiter_constant = 10.0;
}

/// Speed index with its standard error, and frequency, by default settings with a `change`; the wall displaced along z only.
fn flutter(grid: &MultiBlock, modes: &Modes, change: impl Fn(&mut SteadySettings)) -> Outcome<[f64; 3]> {
    let point = agard::point(MACH)?;
    let mut case = agard::case_along(grid, modes, MACH, 0.0, true)?;
    change(&mut case.steady);
    let (still, _) = case.still()?;
    let rho = point.density_kg_m3;
    let found = case.search(&still, search(1.1 * rho, [0.2 * rho, 4.0 * rho], 0.005), |d| {
        agard::stream(point.speed_m_s, d)
    })?;
    let n = found.neutral().ok_or("no flutter point")?;
    let index = speed_index(point.speed_m_s, n.at);
    Ok([index, 0.5 * index * n.error / n.at, n.freq_hz])
}

pub fn like(folder: &Path) -> Outcome<String> {
    let point = agard::point(MACH)?;
    let measured = speed_index(point.speed_m_s, point.density_kg_m3);
    let [from, to] = PRESSURE.map(|q| measured * q.sqrt());
    let theirs = 0.5 * (from + to);
    let plates = plates()?;
    let (modes, plate) = (&plates[0].modes, &plates[0].words);
    let mut drawn = Vec::new();
    for n in 0..DRAWN {
        let shape = Shape::drawn(n);
        match shape.grid() {
            Ok(grid) => drawn.push(Candidate::new(format!("{}", n + 1), shape.row(), grid)?),
            // Too large a growth or a step that does not fit: no grid.
            Err(error) => println!("{}: {error}", n + 1),
        }
    }
    drawn.sort_by(|a, b| a.distance().total_cmp(&b.distance()));
    let count = drawn.len();
    let shipped = Shape {
        surface: 32,
        span: 18,
        nose: 0.004,
        tail: 0.008,
        wall_m: 0.6e-3,
        root_m: 0.055,
        tip_m: 0.006,
        far_m: 6.0,
    };
    let shipped_grid = crate::mesh("agard445_ch_euler")?;
    let shipped = Candidate::new("shipped".to_owned(), shipped.row(), shipped_grid)?;

    let mut page = format!(
        "## AGARD 445.6: an independent code at Mach 0.96\n\n\
        Euler flow, C-H grid of 97 x 21 x 29 points (53,760 cells), plate of {PLATE_HZ:?} Hz displaced along z only, U = 309 m/s: flutter at \
        {} to {} times the experiment's dynamic pressure, index {from:.4} to {to:.4}, {FREQUENCY_HZ} Hz. Neither grid nor plate are at hand. \
        The plate is ours whose frequencies come nearest to those, of all that the thesis leaves open ({plate}: {:.2} % off in the mean), with those frequencies in place of its own. The grid is looked for by \
        what else is known of it: steady lift and drag at 1 degree, CL {} and CD {} without limiter, {} and {} with van Albada's (ADflow), {} and {} \
        with CFL3D's smooth limiter. {count} grids of its size are drawn (evenly over steps, extents, cells along chord and span) and ranked by \
        the distance of ours (without limiter, with a limiter that acts everywhere, with the default) from these, root mean square in units of the spread of the \
        three pairs; flutter takes no part in the choice. The {NEAREST} nearest and some others are marched by default settings.\n\n\
        | rank | cells on a surface | on the span | nose, % c | tail, % c | wall, mm | root, mm | tip, mm | far, m | CL, CD without limiter | limiter everywhere | default | distance | speed index | to {theirs:.4} | Hz |\n\
        |---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
        PRESSURE[0],
        PRESSURE[1],
        100.0 * plates[0].miss,
        UNLIMITED[0],
        UNLIMITED[1],
        LIMITED[0],
        LIMITED[1],
        SMOOTH[0],
        SMOOTH[1],
    );
    let mut scheme = String::from(
        "| rank | CL, CD with that limiter | speed index with it | to THEIRS | Hz | ours by default over it |\n|---|---|---|---|---|---|\n",
    )
    .replace("THEIRS", &format!("{theirs:.4}"));
    let mut ratios = Vec::new();
    let mut near = Vec::new();
    let mut series: [Vec<(f64, f64)>; 4] = Default::default();
    let ranks = (0..NEAREST).chain(OTHERS).filter(|&rank| rank < count);
    let marched = ranks.map(|rank| (rank, &drawn[rank])).chain([(usize::MAX, &shipped)]);
    for (rank, grid) in marched {
        let [index, error, hz] = flutter(&grid.grid, modes, |_| ())?;
        let pairs = grid.coefficients.map(|[cl, cd]| format!("{cl:.5}, {cd:.5}"));
        let name = if rank == usize::MAX {
            grid.name.clone()
        } else {
            format!("{}", rank + 1)
        };
        let _ = writeln!(
            page,
            "| {name} | {} | {} | {:.2} | {index:.4} +- {error:.4} | {} | {hz:.2} |",
            grid.shape,
            pairs.join(" | "),
            grid.distance(),
            percent(index, theirs)
        );
        let [as_index, as_error, as_hz] = flutter(&grid.grid, modes, with_koren)?;
        let [cl, cd] = forces(&grid.grid, with_koren)?;
        let _ = writeln!(
            scheme,
            "| {name} | {cl:.5}, {cd:.5} | {as_index:.4} +- {as_error:.4} | {} | {as_hz:.2} | {} |",
            percent(as_index, theirs),
            percent(index, as_index)
        );
        println!("{name}: {index:.4}, with Koren's limiter {as_index:.4}");
        ratios.push(index / as_index - 1.0);
        let lift = grid.coefficients[0][0];
        let group = match rank {
            usize::MAX => 2,
            r if r < NEAREST => 0,
            _ => 1,
        };
        series[group].push((lift, index));
        series[3].push((lift, as_index));
        if group == 0 {
            near.push((index, hz));
        }
    }
    let mean = |value: fn(&(f64, f64)) -> f64| near.iter().map(value).sum::<f64>() / near.len() as f64;
    let (index, hz) = (mean(|n| n.0), mean(|n| n.1));
    let spread = (near.iter().map(|n| (n.0 - index).powi(2)).sum::<f64>() / (near.len() - 1) as f64).sqrt();
    let within = near.iter().filter(|n| (n.0 / theirs - 1.0).abs() <= 0.03).count();
    let _ = writeln!(
        page,
        "\nThe {NEAREST} nearest: {index:.4}, {} of the independent code's, with a standard deviation of {spread:.4} between them, {within} of {NEAREST} within \
        3 %; {hz:.2} Hz. The nearest alone: {}. At this Mach number the index follows what the grid makes of the lift; the shipped grid of the same size has more lift, and finer \
        grids more again.\n",
        percent(index, theirs),
        percent(near[0].0, theirs)
    );
    let [least, most] =
        [f64::min as fn(f64, f64) -> f64, f64::max].map(|f| ratios.iter().copied().reduce(f).unwrap_or(f64::NAN));
    let _ = writeln!(
        page,
        "**The same grids, another limiter.** `reconstruction = \"koren\"`, `limiter_constant = 10` has kappa = 1/3 and the limiter and constant of CFL3D's \
        `iflim = 4` (xlim.F and gfluxr.F of nasa/CFL3D); flux, walls and the scales of the limiter are ours. The code's figure is published for a \"smooth limiter\". Of those it \
        has it is not van Albada's (`iflim = 1`): its steady pair would be near ADflow's with van Albada's on the same grid, and is far from it. With any limiter, \
        as with any grid, the index moves: ours by default is {:+.1} to {:+.1} % above this one.\n\n{scheme}",
        100.0 * least,
        100.0 * most
    );
    let _ = writeln!(
        page,
        "**The plate.** On the nearest grid, all plates that the thesis leaves open, with the code's frequencies in place of their own: what is left are the shapes and \
        how the mass lies.\n\n\
        | plate | own frequencies, Hz | speed index by default | to {theirs:.4} | with koren | to {theirs:.4} | Hz |\n|---|---|---|---|---|---|---|"
    );
    let mut all = Vec::new();
    for plate in &plates {
        let [index, error, _] = flutter(&drawn[0].grid, &plate.modes, |_| ())?;
        let [koren, koren_error, hz] = flutter(&drawn[0].grid, &plate.modes, with_koren)?;
        let own: Vec<String> = plate.own_hz.iter().map(|f| format!("{f:.2}")).collect();
        let _ = writeln!(
            page,
            "| {} | {} | {index:.4} +- {error:.4} | {} | {koren:.4} +- {koren_error:.4} | {} | {hz:.2} |",
            plate.words,
            own.join(", "),
            percent(index, theirs),
            percent(koren, theirs)
        );
        println!("{}: {index:.4}, with Koren's limiter {koren:.4}", plate.words);
        all.push([index, koren]);
    }
    let span = |k: usize| {
        let values = all.iter().map(|v| v[k]);
        let [low, high] =
            [f64::min as fn(f64, f64) -> f64, f64::max].map(|f| values.clone().reduce(f).unwrap_or(f64::NAN));
        let mean = values.sum::<f64>() / all.len() as f64;
        format!(
            "{} to {}, {} in the mean",
            percent(low, theirs),
            percent(high, theirs),
            percent(mean, theirs)
        )
    };
    let _ = writeln!(page, "\nBy default {}; with koren {}.\n", span(0), span(1));
    let _ = writeln!(
        page,
        "**The limiter's constant**, with our limiter:\n\n\
        | grid | limiter constant | speed index | to {theirs:.4} | Hz |\n|---|---|---|---|---|"
    );
    for (name, grid) in [("rank 1", &drawn[0].grid), ("shipped", &shipped.grid)] {
        for constant in [1.0, 0.1] {
            let [index, error, hz] = flutter(grid, modes, |s| s.limiter_constant = constant)?;
            let _ = writeln!(
                page,
                "| {name} | {constant} | {index:.4} +- {error:.4} | {} | {hz:.2} |",
                percent(index, theirs)
            );
        }
    }
    let [nearest, others, shipped, scheme_of_code] = series;
    let chart = Chart::new(
        "Mach 0.96, C-H grids of 53,760 cells",
        "CL at 1 degree without limiter",
        "Flutter speed index",
    )
    .series(Series::markers("nearest in lift and drag", nearest, Marker::Circle))
    .series(Series::markers("others", others, Marker::Square))
    .series(Series::markers("shipped", shipped, Marker::Diamond))
    .series(Series::markers("the same grids, Koren's limiter", scheme_of_code, Marker::Circle).hollow())
    .vline(UNLIMITED[0], "ADflow on the code's grid")
    .hline(theirs, "independent code")
    .hline(0.97 * theirs, "3 % below")
    .hline(1.03 * theirs, "3 % above");
    fs::write(folder.join("like.svg"), chart.svg(760, 480)?)?;
    page.push_str("\n![Flutter against lift](like.svg)\n");
    Ok(page)
}
