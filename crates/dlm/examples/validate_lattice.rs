//! Writes `docs/validation/lattice/README.md` with its figures: the lattice against PanelAero, Theodorsen, Sears, the circular
//! wing, and its time and memory.
//!
//! `cargo run --release -p dip-dlm --example validate_lattice` (about a minute; one thread is used so that times are CPU times).

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use dip_dlm::aic::Aerodynamics;
use dip_dlm::gaf::PointRule;
use dip_dlm::kernel::{IntegralSum, Kernel, LineFit};
use dip_dlm::lattice::{Divisions, Lattice, PlaneSymmetry, Surface};
use dip_dlm::motion::{BoxMotion, RigidMotion};
use dip_dlm::{ComplexMatrix, c64};
use dip_report::{Chart, Marker, Series};
use serde_json::Value;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> Outcome<()> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build_global()?;
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let data = root.join("tests/data/dlm");
    let out = root.join("docs/validation/lattice");
    std::fs::create_dir_all(&out)?;
    let mut page = String::from(
        "# The doublet lattice\n\nMade by `cargo run --release -p dip-dlm --example validate_lattice`; the same figures are held by \
         `crates/dlm/tests/validation.rs`.\n",
    );
    panelaero(&mut page, &data)?;
    strip(&mut page, &data, &out)?;
    circular_wing(&mut page, &out)?;
    cost(&mut page, &data)?;
    std::fs::write(out.join("README.md"), page)?;
    Ok(())
}

fn kernel(name: &str) -> Kernel {
    if name == "parabolic" {
        Kernel {
            fit: LineFit::Parabolic,
            integrals: IntegralSum::Laschka11,
        }
    } else {
        Kernel {
            fit: LineFit::Quartic,
            integrals: IntegralSum::Desmarais12,
        }
    }
}

/// |ours - reference| / |reference| of a column of [re, im] pairs.
fn difference(ours: &[c64], reference: &Value) -> f64 {
    let (mut top, mut bottom) = (0.0, 0.0);
    for (a, b) in ours.iter().zip(reference.as_array().into_iter().flatten()) {
        let b = c64::new(b[0].as_f64().unwrap_or(f64::NAN), b[1].as_f64().unwrap_or(f64::NAN));
        top += (a - b).norm_sqr();
        bottom += b.norm_sqr();
    }
    (top / bottom).sqrt()
}

fn panelaero(page: &mut String, data: &Path) -> Outcome<()> {
    writeln!(
        page,
        "\n## Against PanelAero\n\nPanelAero 2025.8 (DLR), run by `crates/dlm/scripts/panelaero_reference.py`: relative difference \
         (Euclidean norm) of the downwash matrix times two vectors of random signs, which measures the Frobenius norm of the \
         difference, and of the pressures in pitch and in bending. Worst over k = omega b / U from 0 to 2. On the AGARD wing \
         PanelAero sets the bound vortex's part to nothing where |r1 x r2| < 1e-5 m^2, a limit in absolute lengths that some \
         pairs of this small wing fall below; that is what is left at 5e-7.\n\n| lattice | kernel | M | D | pressures |\n|---|---|---|---|---|"
    )?;
    let agard = Surface::trapezoid(
        "wing",
        ([0.0, 0.0, 0.0], 0.5587),
        ([0.8094, 0.762, 0.0], 0.3682),
        20,
        20,
    );
    let s = Surface::trapezoid;
    let aircraft = vec![
        s("port wing", ([0.6, -3.0, 0.42], 0.8), ([0.0, 0.0, 0.0], 1.4), 5, 8),
        s("starboard wing", ([0.0, 0.0, 0.0], 1.4), ([0.6, 3.0, 0.42], 0.8), 5, 8),
        s("fin", ([3.0, 0.0, 0.0], 1.2), ([3.6, 0.0, 1.2], 0.9), 5, 5),
        s("port tail", ([4.0, -1.2, 1.3], 0.5), ([3.6, 0.0, 1.2], 0.9), 4, 5),
        s("starboard tail", ([3.6, 0.0, 1.2], 0.9), ([4.0, 1.2, 1.3], 0.5), 4, 5),
    ];
    for (title, file, surfaces, symmetry) in [
        (
            "AGARD 445.6, 20 x 20, symmetric",
            "panelaero_agard_20x20.json",
            vec![agard],
            PlaneSymmetry::Symmetric,
        ),
        (
            "wing, fin and T-tail, 145 boxes",
            "panelaero_ttail.json",
            aircraft,
            PlaneSymmetry::None,
        ),
    ] {
        let reference: Value = serde_json::from_str(&std::fs::read_to_string(data.join(file))?)?;
        let lattice = Lattice::new(surfaces, symmetry)?;
        let semichord = reference["semichord"].as_f64().ok_or("semichord")?;
        let n = lattice.n_boxes();
        let boxes = lattice.boxes().to_vec();
        let mut motion = BoxMotion::empty(n);
        let rule = PointRule::ControlPoint;
        motion.push_field(&lattice, rule, |i, p| (-p[0] * boxes[i].normal[2], -boxes[i].normal[2]));
        motion.push_field(&lattice, rule, |_, p| {
            let s2 = p[1] * p[1] + p[2] * p[2];
            (s2 * (1.0 + 0.3 * p[0]), 0.3 * s2)
        });
        let mut rows: Vec<(String, f64, f64, f64)> = Vec::new();
        for case in reference["cases"].as_array().ok_or("cases")? {
            let name = case["kernel"].as_str().ok_or("kernel")?;
            let mach = case["mach"].as_f64().ok_or("mach")?;
            let k = case["k"].as_f64().ok_or("k")?;
            let model = Aerodynamics::new(lattice.clone(), kernel(name), semichord)?;
            let d = model.downwash(mach, &[k])?.remove(0);
            let mut of_d = 0.0_f64;
            for (seed, product) in (1_u64..).zip(case["d_times_signs"].as_array().ok_or("products")?) {
                let v = ComplexMatrix::from_columns(n, 1, signs(n, seed)).ok_or("size")?;
                of_d = of_d.max(difference(d.times(&v).data(), product));
            }
            let pressures = model.pressures(mach, &[k], &motion)?.remove(0);
            let mut of_p = 0.0_f64;
            for (mode, column) in case["pressures"].as_array().ok_or("pressures")?.iter().enumerate() {
                of_p = of_p.max(difference(pressures.column(mode), column));
            }
            match rows.last_mut() {
                Some(last) if last.0 == name && last.1 == mach => {
                    (last.2, last.3) = (last.2.max(of_d), last.3.max(of_p));
                }
                _ => rows.push((name.to_string(), mach, of_d, of_p)),
            }
        }
        for (name, mach, of_d, of_p) in rows {
            writeln!(page, "| {title} | {name} | {mach} | {of_d:.1e} | {of_p:.1e} |")?;
        }
    }
    Ok(())
}

/// The sign vectors of the script: Knuth's MMIX generator.
fn signs(n: usize, seed: u64) -> Vec<c64> {
    let mut state = seed;
    (0..n)
        .map(|_| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            c64::new(if state >> 63 == 1 { 1.0 } else { -1.0 }, 0.0)
        })
        .collect()
}

/// Middle strip of a rectangular wing of aspect ratio 120 against Theodorsen and Sears.
fn strip(page: &mut String, data: &Path, out: &Path) -> Outcome<()> {
    writeln!(
        page,
        "\n## A wing of aspect ratio 120 against Theodorsen and Sears\n\nMiddle strip, M = 0, quartic fit; exact values from \
         C(k) and S(k) (`tests/data/dlm/theodorsen.csv`). Plunge and pitch about mid-chord, moment about mid-chord, gust \
         phase at mid-chord. Error in per cent of the exact value.\n\n| k | boxes (chord x span) | plunge lift | pitch lift | \
         plunge moment | pitch moment | gust lift |\n|---|---|---|---|---|---|---|"
    )?;
    let mut table = Vec::new();
    for line in std::fs::read_to_string(data.join("theodorsen.csv"))?.lines() {
        if line.starts_with(|c: char| c.is_ascii_digit()) {
            let v: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>()?;
            table.push((v[0], c64::new(v[1], v[2]), c64::new(v[3], v[4])));
        }
    }
    let (half_span, b, pi) = (60.0, 0.5, std::f64::consts::PI);
    let mut lift_curve = Vec::new();
    let mut lines = Vec::new();
    for (n_chord, n_span, grow) in [(10, 24, 1.22_f64), (20, 32, 1.15), (40, 48, 1.1)] {
        let mut wing = Surface::trapezoid(
            "wing",
            ([-0.5, 0.0, 0.0], 1.0),
            ([-0.5, half_span, 0.0], 1.0),
            n_chord,
            n_span,
        );
        let total = grow.powi(n_span as i32) - 1.0;
        wing.spanwise = Divisions::Fractions(
            (0..=n_span)
                .map(|i| {
                    if i == n_span {
                        1.0
                    } else {
                        (grow.powi(i as i32) - 1.0) / total
                    }
                })
                .collect(),
        );
        let model = Aerodynamics::new(Lattice::new(vec![wing], PlaneSymmetry::Symmetric)?, Kernel::QUARTIC, b)?;
        let lattice = model.lattice();
        let mut motion = BoxMotion::empty(lattice.n_boxes());
        let rule = PointRule::ControlPoint;
        motion.push_rigid(
            lattice,
            rule,
            &RigidMotion {
                translation: [0.0, 0.0, 1.0],
                ..RigidMotion::default()
            },
        );
        motion.push_rigid(
            lattice,
            rule,
            &RigidMotion {
                rotation: [0.0, 1.0, 0.0],
                ..RigidMotion::default()
            },
        );
        for &(k, theodorsen, sears) in &table {
            let shown = [0.1, 0.5, 1.0].contains(&k);
            let drawn = n_chord == 20 && (0.05..=2.0).contains(&k);
            if !(shown || drawn) {
                continue;
            }
            let mut all = motion.downwash(k / b).data().to_vec();
            all.extend(
                lattice
                    .boxes()
                    .iter()
                    .map(|c| -c64::new(0.0, -k * c.control_point[0] / b).exp()),
            );
            let mut columns = ComplexMatrix::from_columns(lattice.n_boxes(), 3, all).ok_or("size")?;
            model.factor(0.0, k)?.solve_in_place(&mut columns)?;
            let section = |case: usize, arm: bool| -> c64 {
                lattice.boxes()[..n_chord]
                    .iter()
                    .zip(columns.column(case))
                    .map(|(c, p)| p * c.chord * if arm { -c.force_point[0] } else { 1.0 })
                    .sum()
            };
            let ik = c64::new(0.0, k);
            let exact = [
                (section(0, false), (ik * ik * -pi - ik * theodorsen * 2.0 * pi) / b),
                (section(1, false), ik * pi + theodorsen * 2.0 * pi * (ik * 0.5 + 1.0)),
                (section(0, true), 0.25 * pi * (-(theodorsen * 2.0) * ik / b)),
                (
                    section(1, true),
                    0.25 * pi * (-ik - ik * ik * 0.25 + theodorsen * 2.0 * (ik * 0.5 + 1.0)),
                ),
                (section(2, false), sears * 2.0 * pi),
            ];
            if shown {
                let errors: String = exact
                    .iter()
                    .map(|(a, e)| format!("{:.2} | ", 100.0 * (a - e).norm() / e.norm()))
                    .collect();
                lines.push((k, format!("| {k} | {n_chord} x {n_span} | {}", errors.trim_end())));
            }
            if drawn {
                lift_curve.push((k, exact[1].0, exact[1].1));
            }
        }
    }
    lines.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, line) in lines {
        writeln!(page, "{line}")?;
    }
    let pick = |f: &dyn Fn(&(f64, c64, c64)) -> f64| lift_curve.iter().map(|p| (p.0, f(p))).collect::<Vec<_>>();
    let chart = Chart::new(
        "Section lift due to pitch about mid-chord",
        "reduced frequency k = omega b / U",
        "lift coefficient per radian",
    )
    .series(Series::line("exact, real part", pick(&|p| p.2.re)))
    .series(Series::markers(
        "lattice 20 x 32, real part",
        pick(&|p| p.1.re),
        Marker::Circle,
    ))
    .series(Series::dashed("exact, imaginary part", pick(&|p| p.2.im)))
    .series(Series::markers(
        "lattice 20 x 32, imaginary part",
        pick(&|p| p.1.im),
        Marker::Square,
    ));
    std::fs::write(out.join("theodorsen.svg"), chart.svg(760, 480)?)?;
    writeln!(page, "\n![Section lift due to pitch](theodorsen.svg)")?;
    Ok(())
}

/// Lift slope of the circular wing.
fn circular_wing(page: &mut String, out: &Path) -> Outcome<()> {
    // As commonly quoted for Jordan's series solution of 1971; the original has not been seen.
    const EXACT: f64 = 1.790_023;
    writeln!(
        page,
        "\n## Steady lift slope of the circular wing\n\nLinear lifting-surface theory gives 1.790023 per radian (the value commonly \
         quoted for Jordan's solution of 1971; quoted from memory, the original was not seen). The circle is cut into trapezoidal \
         strips, cosine spaced; the error is of first order, so the last column extrapolates from each pair of lattices.\n\n\
         | boxes (chord x half span) | lift slope | error % | extrapolated |\n|---|---|---|---|"
    )?;
    let mut last = f64::NAN;
    let mut errors = Vec::new();
    for n in [4, 8, 16, 32] {
        let lattice = circle(n)?;
        let model = Aerodynamics::new(lattice, Kernel::QUARTIC, 1.0)?;
        let mut w = ComplexMatrix::from_fn(model.lattice().n_boxes(), 1, |_, _| c64::new(-1.0, 0.0));
        model.factor(0.0, 0.0)?.solve_in_place(&mut w)?;
        let lift: f64 = w
            .column(0)
            .iter()
            .zip(model.lattice().boxes())
            .map(|(p, b)| p.re * b.area)
            .sum();
        let slope = lift / (0.5 * std::f64::consts::PI);
        let error = (slope - EXACT) / EXACT;
        let extrapolated = if last.is_nan() {
            "-".into()
        } else {
            format!("{:.5}", 2.0 * slope - last)
        };
        last = slope;
        writeln!(
            page,
            "| {n} x {n} | {slope:.5} | {:.3} | {extrapolated} |",
            100.0 * error
        )?;
        errors.push((n as f64, error.abs()));
    }
    let chart = Chart::new(
        "Circular wing: error of the steady lift slope",
        "boxes along chord and half span",
        "relative error",
    )
    .log_x()
    .log_y()
    .series(Series::line_markers("lattice", errors, Marker::Circle));
    std::fs::write(out.join("circular_wing.svg"), chart.svg(640, 420)?)?;
    writeln!(page, "\n![Error of the lift slope](circular_wing.svg)")?;
    Ok(())
}

/// Half a circle of radius 1, n strips of n boxes.
fn circle(n: usize) -> Outcome<Lattice> {
    let edge = |i: usize| {
        let t = 0.5 * std::f64::consts::PI * i as f64 / n as f64;
        (t.sin(), if i == n { 0.0 } else { t.cos() })
    };
    let surfaces = (0..n)
        .map(|i| {
            let ((y0, c0), (y1, c1)) = (edge(i), edge(i + 1));
            Surface::trapezoid(
                &format!("strip {i}"),
                ([-c0, y0, 0.0], 2.0 * c0),
                ([-c1, y1, 0.0], 2.0 * c1),
                n,
                1,
            )
        })
        .collect();
    Ok(Lattice::new(surfaces, PlaneSymmetry::Symmetric)?)
}

/// CPU seconds of this thread (Linux), else elapsed seconds.
fn cpu_seconds() -> f64 {
    let nanoseconds = std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|s| s.split(' ').next().and_then(|n| n.parse::<f64>().ok()));
    match nanoseconds {
        Some(n) => n * 1e-9,
        None => std::time::SystemTime::now()
            .duration_since(std::time::UNIX_EPOCH)
            .map_or(0.0, |d| d.as_secs_f64()),
    }
}

/// Largest resident memory of this process so far, MB (Linux).
fn peak_megabytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM"))?;
    line.split_whitespace()
        .nth(1)?
        .parse::<f64>()
        .ok()
        .map(|kb| kb / 1024.0)
}

fn cost(page: &mut String, data: &Path) -> Outcome<()> {
    let mut peers = Vec::new();
    for line in std::fs::read_to_string(data.join("panelaero_time.csv"))?.lines() {
        if line.starts_with(|c: char| c.is_ascii_digit()) {
            let f: Vec<&str> = line.split(',').collect();
            peers.push((f[0].parse::<usize>()?, f[2].parse::<f64>()?, f[3].parse::<f64>()?));
        }
    }
    writeln!(
        page,
        "\n## Time and memory\n\nOne Mach number (0.8) and one reduced frequency (0.5) of a full-span swept wing, parabolic fit \
         with Laschka's sum: assembly, factorization, pressures of five modes; CPU seconds of one thread, mean of some runs, and the \
         process's peak memory after it. PanelAero: downwash matrix and its inverse, one thread, on the same kind of machine \
         (`tests/data/dlm/panelaero_time.csv`). The last column shares what does not depend on k among eight reduced \
         frequencies.\n\n| boxes | CPU s | peak MB | PanelAero CPU s | PanelAero peak MB | ratio of time | CPU s per k of eight |\n\
         |---|---|---|---|---|---|---|"
    )?;
    for (n_chord, n_span, repeats) in [(20, 20, 20), (40, 40, 3), (50, 80, 1)] {
        let half = |sign: f64| ([1.0, 3.0 * sign, 0.0], 0.7);
        let root = ([0.0, 0.0, 0.0], 1.0);
        let surfaces = vec![
            Surface::trapezoid("port", half(-1.0), root, n_chord, n_span / 2),
            Surface::trapezoid("starboard", root, half(1.0), n_chord, n_span / 2),
        ];
        let model = Aerodynamics::new(Lattice::new(surfaces, PlaneSymmetry::None)?, Kernel::NASTRAN, 0.5)?;
        let mut motion = BoxMotion::empty(model.lattice().n_boxes());
        for power in 1..=5 {
            motion.push_field(model.lattice(), PointRule::ControlPoint, |_, p| {
                (p[1].abs().powi(power) * p[0], p[1].abs().powi(power))
            });
        }
        let time = |k: &[f64]| -> Outcome<f64> {
            // One interval for all runs: the clock's step is some milliseconds.
            let start = cpu_seconds();
            for _ in 0..repeats {
                std::hint::black_box(model.pressures(0.8, k, &motion)?);
            }
            Ok((cpu_seconds() - start) / f64::from(repeats))
        };
        let one = time(&[0.5])?;
        let peak = peak_megabytes().map_or("-".into(), |m| format!("{m:.0}"));
        let eight = if n_chord * n_span <= 1600 {
            format!("{:.4}", time(&[0.05, 0.1, 0.2, 0.3, 0.5, 0.8, 1.0, 1.5])? / 8.0)
        } else {
            "-".into()
        };
        let n = n_chord * n_span;
        let (peer, memory) = peers
            .iter()
            .find(|p| p.0 == n)
            .map_or((f64::NAN, f64::NAN), |p| (p.1, p.2));
        writeln!(
            page,
            "| {n} | {one:.4} | {peak} | {peer:.2} | {memory:.0} | {:.0} | {eight} |",
            peer / one
        )?;
    }
    Ok(())
}
