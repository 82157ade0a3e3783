//! Thin sections in small motion against Possio's equation: lift and moment, and what thickness and grid do to them.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use dip_grid::MultiBlock;
use dip_report::{Chart, Figure, Marker, Series};
use nalgebra::Complex;

use crate::pitching::Pitching;
use crate::possio::{self, PlateMotion};
use crate::{Outcome, complex, mesh};

const AXIS: f64 = 0.25;

/// Error of an amplitude in percent and of a phase in degrees.
fn errors(ours: Complex<f64>, reference: Complex<f64>) -> [f64; 2] {
    let ratio = ours / reference;
    [100.0 * (ratio.norm() - 1.0), ratio.arg().to_degrees()]
}

/// Lift, moment about the quarter chord, moment about the nose, from the first two.
fn with_nose([lift, moment]: [Complex<f64>; 2]) -> [Complex<f64>; 3] {
    [lift, moment, moment - lift * AXIS]
}

fn case(motion: PlateMotion, mach: f64, k: f64) -> Pitching {
    /// Degrees of pitch, or of downwash in plunge: small against the thickness too.
    const ANGLE: f64 = 0.1;
    let pitch = motion == PlateMotion::Pitch;
    Pitching {
        mach,
        k,
        mean_deg: 0.0,
        amplitude: if pitch { ANGLE } else { ANGLE.to_radians() / (2.0 * k) },
        axis: pitch.then_some(AXIS),
        steps: 60,
        orders: 2.5,
    }
}

/// Largest errors seen of one coefficient.
#[derive(Default)]
struct Worst([f64; 2]);

impl Worst {
    fn see(&mut self, errors: [f64; 2]) {
        for (worst, e) in self.0.iter_mut().zip(errors) {
            *worst = worst.max(e.abs());
        }
    }

    fn words(&self) -> String {
        format!("{:.1} % in amplitude, {:.1} degrees in phase", self.0[0], self.0[1])
    }
}

/// Small pitch about the quarter chord and plunge of a 1 % thick section.
pub fn thin(folder: &Path) -> Outcome<String> {
    let grid = mesh("thin_plate_1_unsteady")?;
    let mut table = String::from(
        "| motion | Mach | k | CL | Possio | %, deg | CM | Possio | %, deg | CM nose | Possio | %, deg | cycles | not converged |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let mut charts = Vec::new();
    let mut worst = <[Worst; 3]>::default();
    for (motion, mach) in [
        (PlateMotion::Pitch, 0.3),
        (PlateMotion::Pitch, 0.5),
        (PlateMotion::Plunge, 0.5),
    ] {
        let mut seen = Vec::new();
        for k in [0.05, 0.1, 0.2, 0.5] {
            let cycle = case(motion, mach, k).run(&grid)?;
            let ours = with_nose(cycle.harmonics);
            let exact = with_nose(possio::coefficients(mach, k, AXIS, motion));
            write!(table, "| {motion:?} | {mach} | {k} ")?;
            for (c, (ours, exact)) in ours.into_iter().zip(exact).enumerate() {
                let off = errors(ours, exact);
                // Plunge at low k has no moment about the quarter chord to be compared.
                if c != 1 || motion == PlateMotion::Pitch {
                    worst[c].see(off);
                }
                write!(
                    table,
                    "| {} | {} | {:+.2}, {:+.2} ",
                    complex(ours),
                    complex(exact),
                    off[0],
                    off[1]
                )?;
            }
            writeln!(table, "| {} | {} |", cycle.cycles, cycle.not_converged)?;
            eprintln!("{motion:?} M {mach} k {k}: done, {} cycles", cycle.cycles);
            seen.push((k, ours));
        }
        charts.extend(rows(motion, mach, &seen));
    }
    let figure = charts
        .into_iter()
        .fold(Figure::new("Thin section against Possio's equation"), Figure::row);
    fs::write(folder.join("thin.svg"), figure.svg(1000, 2200)?)?;
    let [theodorsen, slow] = [
        possio::incompressible(0.3, AXIS, PlateMotion::Pitch),
        possio::coefficients(1e-3, 0.3, AXIS, PlateMotion::Pitch),
    ];
    Ok(format!(
        "NACA 0001, {} cells, pitch of 0.1 degrees about the quarter chord and plunge of the same downwash, 60 steps a cycle, 2.5\n\
         orders a step. Reference: Possio's equation for a plate without thickness, solved in this example by collocation. `CM` is\n\
         the moment about the quarter chord, `CM nose` that about the leading edge; errors are those of amplitude and phase. Largest\n\
         of them: lift {}; moment about the leading edge {}; moment about the quarter chord, in pitch, {}. In plunge the last is\n\
         almost nothing (the quarter chord is the aerodynamic centre), so that its errors are those of a small difference.\n\n{table}\n\
         Check of the solver of Possio's equation: at Mach 0.001, k 0.3, pitch about the quarter chord it gives CL {}, CM {};\n\
         Theodorsen's function gives {}, {}.\n",
        grid.cell_count(),
        worst[0].words(),
        worst[2].words(),
        worst[1].words(),
        complex(slow[0]),
        complex(slow[1]),
        complex(theodorsen[0]),
        complex(theodorsen[1]),
    ))
}

/// Amplitude and phase over k of lift and of the moment about the nose.
fn rows(motion: PlateMotion, mach: f64, seen: &[(f64, [Complex<f64>; 3])]) -> Vec<Vec<Chart>> {
    let ks: Vec<f64> = (1..=28).map(|n| 0.02 * f64::from(n)).collect();
    let amplitude = |c: Complex<f64>| c.norm();
    // Without the jump at 180 degrees: the moment of a positive lift is behind the nose.
    let degrees = |c: Complex<f64>| c.arg().to_degrees();
    [(0, "CL", 1.0), (2, "-CM about the nose", -1.0)]
        .into_iter()
        .map(|(c, name, sign)| {
            let exact = ks
                .iter()
                .map(|k| sign * with_nose(possio::coefficients(mach, *k, AXIS, motion))[c]);
            let slow = ks
                .iter()
                .map(|k| sign * with_nose(possio::incompressible(*k, AXIS, motion))[c]);
            let (exact, slow): (Vec<_>, Vec<_>) = (exact.collect(), slow.collect());
            [
                ("Amplitude of", &amplitude as &dyn Fn(Complex<f64>) -> f64),
                ("Phase, degrees, of", &degrees),
            ]
            .into_iter()
            .map(|(what, f)| {
                let curve = |values: &[Complex<f64>]| ks.iter().copied().zip(values.iter().map(|v| f(*v))).collect();
                Chart::new(
                    format!("{motion:?}, Mach {mach}"),
                    "Reduced frequency k",
                    format!("{what} {name}"),
                )
                .series(Series::line("Possio", curve(&exact)))
                .series(Series::dashed("Theodorsen (Mach 0)", curve(&slow)))
                .series(Series::markers(
                    "Euler, 1 % thick",
                    seen.iter().map(|(k, ours)| (*k, f(sign * ours[c]))).collect(),
                    Marker::Circle,
                ))
            })
            .collect()
        })
        .collect()
}

/// What thickness, grid and step do: the 1 % section, the same on every second point and with half the step, a 2 % one on the same
/// grid, and the first and the last taken to no thickness.
pub fn limit(_: &Path) -> Outcome<String> {
    let [thin, coarse, thick] = [
        "thin_plate_1_unsteady",
        "thin_plate_1_unsteady_coarse",
        "thin_plate_2_unsteady",
    ]
    .map(mesh);
    let (thin, coarse, thick) = (thin?, coarse?, thick?);
    let mut text = format!(
        "What is left is the thickness. Pitch at Mach 0.5 on {} cells, `coarse` {}; `none` is the line through 2 % and 1 %\n\
         (lift and moment of a section differ from a plate's by a part that goes with its thickness).\n\n\
         | Mach | k | thickness | grid | steps | CL | %, deg | CM | %, deg |\n|---|---|---|---|---|---|---|---|---|\n",
        thin.cell_count(),
        coarse.cell_count()
    );
    for k in [0.1, 0.5] {
        let case = case(PlateMotion::Pitch, 0.5, k);
        let exact = possio::coefficients(case.mach, k, AXIS, PlateMotion::Pitch);
        let run = |steps: usize, grid: &MultiBlock| -> Outcome<[Complex<f64>; 2]> {
            Ok(Pitching { steps, ..case }.run(grid)?.harmonics)
        };
        let on_thick = run(case.steps, &thick)?;
        let on_thin = run(case.steps, &thin)?;
        let on_coarse = run(case.steps, &coarse)?;
        let slowly = run(2 * case.steps, &thin)?;
        let none = [0, 1].map(|c| 2.0 * on_thin[c] - on_thick[c]);
        for (name, grid, steps, ours) in [
            ("2 %", "same", case.steps, on_thick),
            ("1 %", "same", case.steps, on_thin),
            ("1 %", "coarse", case.steps, on_coarse),
            ("1 %", "same", 2 * case.steps, slowly),
            ("none", "same", case.steps, none),
        ] {
            let [[la, lp], [ma, mp]] = [0, 1].map(|c| errors(ours[c], exact[c]));
            writeln!(
                text,
                "| {} | {k} | {name} | {grid} | {steps} | {} | {la:+.2}, {lp:+.2} | {} | {ma:+.2}, {mp:+.2} |",
                case.mach,
                complex(ours[0]),
                complex(ours[1])
            )?;
        }
        eprintln!("limit, k {k}: done");
    }
    Ok(text)
}
