//! Writes docs/validation/transfer/README.md and its figures:
//! `cargo run --release -p dip-modal --example validate_transfer -- [full]`. With `full`, the finest levels of the AGARD
//! grids (millions of nodes) are deformed too.

#[path = "../tests/support/published.rs"]
mod published;

use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;

use dip_grid::{MultiBlock, recipe};
use dip_modal::{
    Attachment, ForceGuess, GridModes, Integrator, ModalEquations, ModalState, Modes, ModesRequest, MovingWall,
    StepScheme, StructuralSurface, ThicknessRule, Transfer, volume_change,
};
use dip_report::{Chart, Figure, Marker, Mesh, Series, mode_map};
use nalgebra::Vector3;
use published::{agard_wing, yates};

type Outcome<T> = Result<T, Box<dyn Error>>;

const SEMISPAN: f64 = 0.762;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn save(name: &str, svg: &str) -> Outcome<()> {
    std::fs::write(root().join("docs/validation/transfer").join(name), svg)?;
    Ok(())
}

/// Processor time of the process, seconds (fields 14 and 15 of /proc/self/stat, in ticks of 10 ms).
fn cpu_s() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = text.rsplit(')').next().unwrap_or_default();
    let ticks = after.split_whitespace().skip(11).take(2);
    ticks.filter_map(|t| t.parse::<f64>().ok()).sum::<f64>() / 100.0
}

const SCHEMES: [(&str, StepScheme, Marker); 4] = [
    ("state transition", StepScheme::StateTransition, Marker::Circle),
    (
        "two-stage Runge-Kutta, iterated",
        StepScheme::RungeKutta2,
        Marker::Square,
    ),
    ("Newmark", StepScheme::Newmark, Marker::Cross),
    (
        "generalized-alpha, 0.8",
        StepScheme::GeneralizedAlpha { rho_infinity: 0.8 },
        Marker::TriangleUp,
    ),
];

/// Error after one second of a mode (20 rad/s, 2 %) under a harmonic force (13 rad/s), from rest, against the exact
/// solution, over the largest displacement.
fn harmonic_error(scheme: StepScheme, steps: u32) -> Outcome<f64> {
    let (omega, zeta, drive): (f64, f64, f64) = (20.0, 0.02, 13.0);
    let (re, im) = (omega * omega - drive * drive, 2.0 * zeta * omega * drive);
    let size = re * re + im * im;
    let particular = |t: f64| {
        let (s, c) = (drive * t).sin_cos();
        [(re * c + im * s) / size, drive * (im * c - re * s) / size]
    };
    let damped = omega * (1.0 - zeta * zeta).sqrt();
    let [p0, v0] = particular(0.0);
    let (a, b) = (-p0, (-v0 - zeta * omega * p0) / damped);
    let exact = particular(1.0)[0] + (-zeta * omega).exp() * (a * damped.cos() + b * damped.sin());
    let dt = 1.0 / f64::from(steps);
    let mut start = ModalState::rest(1);
    start.f[0] = 1.0;
    let equations = ModalEquations::new(vec![omega], vec![zeta], vec![1.0])?;
    let mut march = Integrator::new(equations, scheme, dt, start)?;
    for n in 1..=steps {
        march.predict(ForceGuess::Linear);
        let force = [(drive * f64::from(n) * dt).cos()];
        while march.correct(&force)? > 1e-15 {}
        march.accept();
    }
    Ok((march.state().q[0] - exact).abs() * (omega * omega - drive * drive))
}

/// As the tests' coupled problem: a spring and a damper answer to the motion. Relative error after one second.
fn coupled_error(steps: u32, corrections: u32, guess: ForceGuess) -> Outcome<f64> {
    let (omega, spring, damper) = (20.0_f64, 150.0, 2.0);
    let answer = |s: &ModalState| -spring * s.q[0] - damper * s.q_dot[0];
    let mut start = ModalState::rest(1);
    start.q_dot[0] = 3.0;
    start.f[0] = answer(&start);
    let equations = ModalEquations::new(vec![omega], vec![0.0], vec![1.0])?;
    let mut march = Integrator::new(equations, StepScheme::default(), 1.0 / f64::from(steps), start)?;
    for _ in 0..steps {
        march.predict(guess);
        for _ in 0..corrections {
            let force = answer(march.next());
            march.correct(&[force])?;
        }
        if corrections == 0 {
            let force = answer(march.next());
            march.accept_loose(&[force])?;
        } else {
            march.accept();
        }
    }
    let together = (omega * omega + spring).sqrt();
    let damped = (together * together - 0.25 * damper * damper).sqrt();
    let exact = (-0.5 * damper).exp() * 3.0 / damped * damped.sin();
    Ok(((march.state().q[0] - exact) * together / 3.0).abs())
}

fn structure(page: &mut String) -> Outcome<()> {
    let counts = [50, 100, 200, 400, 800, 1600];
    let mut forced = Chart::new(
        "One mode under a harmonic force",
        "Steps per second (20 rad/s)",
        "Relative error after 1 s",
    )
    .log_x()
    .log_y();
    let _ = writeln!(
        page,
        "## The structure alone\n\nOne mode (20 rad/s, 2 % of critical damping) under a harmonic force, against its exact solution.\n\n\
        | scheme | 200 steps | 400 steps | 800 steps | order |\n|---|---|---|---|---|"
    );
    for (name, scheme, marker) in SCHEMES {
        let errors = counts
            .iter()
            .map(|&n| harmonic_error(scheme, n))
            .collect::<Outcome<Vec<_>>>()?;
        let order = (errors[3] / errors[4]).log2();
        let _ = writeln!(
            page,
            "| {name} | {:.2e} | {:.2e} | {:.2e} | {order:.3} |",
            errors[2], errors[3], errors[4]
        );
        let points = counts.iter().zip(&errors).map(|(n, e)| (f64::from(*n), *e)).collect();
        forced = forced.series(Series::line_markers(name, points, marker));
    }
    let mut coupled = Chart::new(
        "Coupled to a spring and a damper",
        "Steps per second (23.5 rad/s)",
        "Relative error after 1 s",
    )
    .log_x()
    .log_y();
    let _ = writeln!(
        page,
        "\nThe same coupled to a force that answers to the motion (a spring and a damper), state transition:\n\n\
        | coupling | 200 steps | 400 steps | 800 steps | order |\n|---|---|---|---|---|"
    );
    for (name, corrections, guess, marker) in [
        ("iterated to convergence", 20, ForceGuess::Linear, Marker::Circle),
        ("corrected once", 1, ForceGuess::Linear, Marker::Diamond),
        ("loose, force extrapolated", 0, ForceGuess::Linear, Marker::TriangleUp),
        ("loose, force held", 0, ForceGuess::Hold, Marker::Square),
    ] {
        let errors = counts
            .iter()
            .map(|&n| coupled_error(n, corrections, guess))
            .collect::<Outcome<Vec<_>>>()?;
        let order = (errors[3] / errors[4]).log2();
        let _ = writeln!(
            page,
            "| {name} | {:.2e} | {:.2e} | {:.2e} | {order:.3} |",
            errors[2], errors[3], errors[4]
        );
        let points = counts.iter().zip(&errors).map(|(n, e)| (f64::from(*n), *e)).collect();
        coupled = coupled.series(Series::line_markers(name, points, marker));
    }
    let _ = writeln!(
        page,
        "\n![order of the step](order.svg)\n\n\
        State transition is exact for free motion and for forces linear in time at any step and damping (tests: 1e-12), Newmark \
        and the iterated two-stage scheme are the trapezoidal rule (period error (omega dt)^2 / 12, amplitude and \
        energy exact). State transition is the default: the highest of four modes of the AGARD wing makes 6.5 cycles in one of flutter, and \
        at 40 steps a cycle of flutter the trapezoidal rule would put its frequency off by 7 %.\n"
    );
    let figure = Figure::new("").row(vec![forced, coupled]);
    save("order.svg", &figure.svg(1100, 420)?)
}

fn own_modes() -> Outcome<Modes> {
    let model = agard_wing("R765", 11, 21, ThicknessRule::Nodal).model()?;
    Ok(model.assemble()?.modes(&ModesRequest::lowest(4))?)
}

fn grid(name: &str) -> Outcome<MultiBlock> {
    Ok(recipe::make(&root().join("meshes").join(format!("{name}.toml")))?)
}

fn transfer(page: &mut String) -> Outcome<()> {
    let _ = writeln!(
        page,
        "## The transfer\n\nConstant volume tetrahedra on the Delaunay triangles of the structural nodes in plan view, to the wall nodes of \
        a grid. `nearest`: one triangle a point, as published; `blended`: the triangles round the nearest one, weighted (the \
        default). Rigid motion: largest error of three translations of 1 m and three linearized rotations of 1 rad, over the \
        extent. Balance: total force and moment that come back. Amplification: largest sum of the norms of one point's matrices.\n\n\
        | structure | grid | attachment | rigid motion | balance | virtual work | amplification | farthest point, mm |\n\
        |---|---|---|---|---|---|---|---|"
    );
    let tables = [
        ("own plate, 11 x 21", own_modes()?),
        ("Yates' table, 11 x 11, heave only", yates()),
    ];
    for name in ["agard445_oo_coarse", "agard445_ch_euler"] {
        let grid = grid(name)?;
        let wall = MovingWall::new(&grid, |p| p.name == "wing")?;
        for (label, modes) in &tables {
            let surface = StructuralSurface::of_modes(modes)?;
            for (kind, attachment) in [("nearest", Attachment::Nearest), ("blended", Attachment::Blended)] {
                let check = Transfer::new(&surface, &wall.points(), attachment)?.check();
                let _ = writeln!(
                    page,
                    "| {label} | {name} | {kind} | {:.0e} | {:.0e} | {:.0e} | {:.2} | {:.1} |",
                    check.translation_error_m.max(check.rotation_error),
                    check.balance_error,
                    check.virtual_work_error,
                    check.amplification,
                    1e3 * check.largest_offset_m,
                );
            }
        }
    }
    smoothness(page)?;
    pictures(page)
}

/// Slope along the chord of the second mode's shape as the wall gets it, on a line of points finer than the structure.
fn smoothness(page: &mut String) -> Outcome<()> {
    let modes = own_modes()?;
    let points: Vec<Vector3<f64>> = (0..=400)
        .map(|n| {
            let s = -0.01 + 1.02 * f64::from(n) / 400.0;
            let (y, chord) = (0.9 * SEMISPAN, 0.5587 + 0.9 * (0.3682 - 0.5587));
            Vector3::new(0.9 * 0.8094 + s * chord, y, 0.0)
        })
        .collect();
    let fine = agard_wing("R765", 81, 161, ThicknessRule::Nodal).model()?;
    let fine = fine.assemble()?.modes(&ModesRequest::lowest(4))?;
    let slopes = |modes: &Modes, attachment| -> Outcome<Vec<(f64, f64)>> {
        let surface = StructuralSurface::of_modes(modes)?;
        let shape = &Transfer::new(&surface, &points, attachment)?.modes(modes)?[1];
        // The sign of a mode is free: nose up at the tip.
        let sign = if shape[0].z < shape[400].z { -1.0 } else { 1.0 };
        Ok(shape
            .windows(2)
            .zip(points.windows(2))
            .map(|(u, p)| {
                let middle = 0.5 * (p[0].x + p[1].x);
                (middle, sign * (u[1].z - u[0].z) / (p[1].x - p[0].x))
            })
            .collect())
    };
    let chart = Chart::new(
        "Mode 2: slope along the chord at 90 % of the semispan",
        "x, m",
        "dw/dx of the mass-normalized mode",
    )
    .series(Series::dashed(
        "plate of 81 x 161 nodes",
        slopes(&fine, Attachment::Blended)?,
    ))
    .series(Series::line(
        "11 x 21 nodes, nearest",
        slopes(&modes, Attachment::Nearest)?,
    ))
    .series(Series::line(
        "11 x 21 nodes, blended",
        slopes(&modes, Attachment::Blended)?,
    ));
    let _ = writeln!(
        page,
        "\n![slope of the transferred mode](slope.svg)\n\n\
        The slope of the wall is what the flow feels. With the nearest triangle alone it is a staircase; blended it follows \
        the plate's own curvature. (Towards the trailing edge the plate of 11 x 21 nodes itself is softer than the fine one.)\n"
    );
    save("slope.svg", &chart.svg(760, 420)?)
}

fn pictures(page: &mut String) -> Outcome<()> {
    let grid = grid("agard445_ch_euler")?;
    let wall = MovingWall::new(&grid, |p| p.name == "wing")?;
    let modes = own_modes()?;
    let surface = StructuralSurface::of_modes(&modes)?;
    let shapes = Transfer::new(&surface, &wall.points(), Attachment::Blended)?.modes(&modes)?;
    let upper = Mesh {
        nodes: wall.positions.clone(),
        elements: wall
            .faces
            .iter()
            .filter(|f| f.iter().map(|&n| wall.positions[n][2]).sum::<f64>() >= 0.0)
            .map(|f| f.to_vec())
            .collect(),
    };
    let charts = (0..4)
        .map(|m| {
            let z: Vec<f64> = shapes[m].iter().map(|u| u.z).collect();
            mode_map(
                format!("Mode {}, {:.2} Hz", m + 1, modes.freq_hz(m)),
                &upper,
                &z,
                "w, 1/kg^{1/2}",
            )
        })
        .collect::<Result<Vec<_>, _>>()?;
    let mut charts = charts.into_iter();
    let mut figure = Figure::new("Modes of the plate on the wall of the C-H grid, upper side");
    while let Some(first) = charts.next() {
        figure = figure.row(std::iter::once(first).chain(charts.next()).collect());
    }
    let _ = writeln!(page, "![modes on the wall](modes.svg)\n");
    save("modes.svg", &figure.svg(1100, 900)?)
}

/// The tests' displacement: 10 % of the semispan at the tip, 5 degrees of twist about the mid-chord line.
fn bend_and_twist(p: Vector3<f64>) -> Vector3<f64> {
    let aft = 0.8094 + 0.5 * (0.3682 - 0.5587);
    let s = p.y / SEMISPAN;
    let (twist, axis) = (5.0_f64.to_radians() * s, 0.5 * 0.5587 + aft * s);
    let w = 0.1 * SEMISPAN * s * s - twist * (p.x - axis);
    let dw_ds = 0.2 * SEMISPAN * s - 5.0_f64.to_radians() * (p.x - axis) + twist * aft;
    Vector3::new(p.z * twist, -p.z * dw_ds / SEMISPAN, w)
}

/// Largest relative change of the first step off the wall.
fn first_step_change(base: &MultiBlock, moved: &MultiBlock) -> f64 {
    let mut worst = 0.0_f64;
    for patch in base.topology.patches.iter().filter(|p| p.condition.is_wall()) {
        for q in patch.window.lo[1]..=patch.window.hi[1] {
            for p in patch.window.lo[0]..=patch.window.hi[0] {
                let step = |grid: &MultiBlock| {
                    let block = &grid.blocks[patch.block];
                    let at = |d: usize| Vector3::from(block.point_at(block.node_behind(patch.face, p, q, d)));
                    (at(1) - at(0)).norm()
                };
                worst = worst.max((step(moved) / step(base) - 1.0).abs());
            }
        }
    }
    worst
}

fn deformation(page: &mut String, full: bool) -> Outcome<()> {
    let _ = writeln!(
        page,
        "## The deformation\n\nTip up by 10 % of the semispan with 5 degrees of twist about the mid-chord line, quadratic and linear along the span. \
        Volume: smallest and largest over the one before; none may be negative. First step: its largest change at the wall. A \
        displacement that is linear in the angle lengthens what it turns by half the angle's square (4.5 % at the tip here, whatever the \
        method); the next column is the rest, from a displacement a thousand times smaller, scaled up. Times: processor seconds of \
        the displacement fields of four modes (once in a march), and milliseconds to displace the grid by them (every step).\n\n\
        | grid | nodes | wall nodes | volume, smallest | largest | first step | beyond the turn | fields, s | step, ms |\n\
        |---|---|---|---|---|---|---|---|---|"
    );
    for name in agard_recipes()? {
        // Two million nodes take a while.
        if !full && ["agard445_oo", "agard445_ch"].contains(&name.as_str()) {
            continue;
        }
        let name = name.as_str();
        let base = grid(name)?;
        let wall = MovingWall::new(&base, |p| p.name == "wing")?;
        let shape: Vec<Vector3<f64>> = wall.points().into_iter().map(bend_and_twist).collect();
        // Four equal shapes: the work of a march with four modes.
        let before = cpu_s();
        let modes = GridModes::new(&base, &wall, &vec![shape; 4], None)?;
        let fields = cpu_s() - before;
        let mut moved = base.clone();
        modes.displace(&base, &[1e-3, 0.0, 0.0, 0.0], &mut moved)?;
        let little = first_step_change(&base, &moved) / 1e-3;
        let before = cpu_s();
        let times = (20_000_000 / base.node_count()).max(1);
        for _ in 0..times {
            modes.displace(&base, &[0.25; 4], &mut moved)?;
        }
        let step = 1e3 * (cpu_s() - before) / times as f64;
        let change = volume_change(&base, &moved)?;
        let _ = writeln!(
            page,
            "| {name} | {} | {} | {:.3} | {:.3} | {:.2} % | {:.3} % | {fields:.2} | {step:.2} |",
            base.node_count(),
            wall.positions.len(),
            change.smallest,
            change.largest,
            100.0 * first_step_change(&base, &moved),
            100.0 * little,
        );
        println!("{name}");
        if name == "agard445_ch_euler" {
            tip_picture(&base, &moved)?;
        }
    }
    Ok(())
}

/// Every recipe of the AGARD 445.6 wing that is shipped (not that of its section), by name.
fn agard_recipes() -> Outcome<Vec<String>> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes");
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if name.starts_with("agard445") && !name.ends_with("_section") && path.extension().is_some_and(|e| e == "toml")
        {
            names.push(name);
        }
    }
    names.sort();
    Ok(names)
}

/// The plane of the C-H grid nearest to 93 % of the semispan, before and after.
fn tip_picture(base: &MultiBlock, moved: &MultiBlock) -> Outcome<()> {
    // Planes k = const of the C-H grids are planes y = const.
    let planes: Vec<(usize, usize, f64)> = base
        .blocks
        .iter()
        .enumerate()
        .flat_map(|(b, block)| (0..=block.nk).map(move |k| (b, k, block.point(0, 0, k)[1])))
        .collect();
    let off = |y: f64| (y - 0.93 * SEMISPAN).abs();
    let nearest = planes.iter().map(|p| off(p.2)).fold(f64::INFINITY, f64::min);
    let lines = |grid: &MultiBlock| -> Vec<(f64, f64)> {
        let mut points = Vec::new();
        for &(b, k, _) in planes.iter().filter(|p| off(p.2) < nearest + 1e-9) {
            let block = &grid.blocks[b];
            let at = |i: usize, j: usize| {
                let p = block.point(i, j, k);
                (p[0], p[2])
            };
            for i in 0..=block.ni {
                points.extend((0..=block.nj).map(|j| at(i, j)));
                points.push((f64::NAN, f64::NAN));
            }
            for j in 0..=block.nj {
                points.extend((0..=block.ni).map(|i| at(i, j)));
                points.push((f64::NAN, f64::NAN));
            }
        }
        points
    };
    let chart = Chart::new("C-H, Euler: grid plane near 93 % of the semispan", "x, m", "z, m")
        .series(Series::line("undeformed", lines(base)).color("#b5b5b5"))
        .series(Series::line("deformed", lines(moved)).color("#1f4e9c"))
        .x_range(0.6, 1.3)
        .y_range(-0.15, 0.25)
        .equal_scale();
    save("deformed.svg", &chart.svg(1000, 640)?)
}

fn main() -> Outcome<()> {
    let full = std::env::args().any(|a| a == "full");
    let folder = root().join("docs/validation/transfer");
    std::fs::create_dir_all(&folder)?;
    let mut page = String::from(
        "# Structure, transfer and deformation of a march\n\n\
        Written by `cargo run --release -p dip-modal --example validate_transfer -- full`. Wing and material: AGARD 445.6 weakened model 3, \
        as in `docs/validation/structure`. Exact checks are in `crates/modal/tests/verification_{march,transfer,deformation}.rs`.\n\n",
    );
    structure(&mut page)?;
    transfer(&mut page)?;
    deformation(&mut page, full)?;
    page.push_str("\n![deformed grid](deformed.svg)\n");
    std::fs::write(folder.join("README.md"), page)?;
    Ok(())
}
