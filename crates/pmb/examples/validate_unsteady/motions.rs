//! One run or several: single sines, several at once, and a pulse must give the same harmonics.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

use dip_pmb::motion::{Harmonic, Law};
use nalgebra::Complex;

use crate::wing::{Start, Wing};
use crate::{Outcome, complex, mesh};

/// Reduced frequencies: multiples of the first, which takes 120 steps a cycle.
const KS: [f64; 3] = [0.08, 0.16, 0.24];
const STEPS: usize = 120;
const ORDERS: f64 = 1.5;

/// AGARD 445.6 at Mach 0.678, rigid pitch.
pub fn motions(_: &Path) -> Outcome<String> {
    let grid = mesh("agard445_ch_euler_coarse")?;
    let wing = Wing {
        mach: 0.678,
        alpha_deg: 0.0,
        k: KS[0],
        amplitude_deg: 1.0,
        chord: 0.5588,
        area: 0.353,
        axis: 0.5,
    };
    let start = Start::new(wing, &grid)?;
    let omegas = KS.map(|k| 2.0 * k / wing.chord);
    let dt = TAU / omegas[0] / STEPS as f64;
    let term = |degrees: f64, omega: f64, phase_deg: f64| Harmonic {
        amplitude: degrees.to_radians(),
        omega,
        phase: phase_deg.to_radians(),
    };
    let sines = |terms: Vec<Harmonic>| Law::Harmonic { mean: 0.0, terms };

    let mut single = Vec::new();
    for (n, omega) in omegas.into_iter().enumerate() {
        let a_cycle = STEPS / (n + 1);
        let run = start.lift(&sines(vec![term(1.0, omega, 0.0)]), dt, 3 * a_cycle, ORDERS)?;
        single.push((run.per_radian(omega, a_cycle), run.cpu_s));
        eprintln!("motions, k {}: done", KS[n]);
    }
    let at_once = start.lift(
        &sines(vec![
            term(0.4, omegas[0], 0.0),
            term(0.4, omegas[1], 90.0),
            term(0.4, omegas[2], 45.0),
        ]),
        dt,
        3 * STEPS,
        ORDERS,
    )?;
    let period = STEPS / 3;
    let pulse = Law::Pulse {
        mean: 0.0,
        amplitude: 1.0_f64.to_radians(),
        duration: period as f64 * dt,
    };
    let pulse = start.lift(&pulse, dt, 4 * period, ORDERS)?;

    let mut text = format!(
        "AGARD 445.6 on {} cells (`meshes/agard445_ch_euler_coarse.toml`), Mach 0.678, rigid pitch about the root mid-chord, {ORDERS}\n\
         orders a step, all with the same time step: three single sines of 1 degree (120, 60, 40 steps a cycle, third cycle), three sines\n\
         of 0.4 degrees at once (phases 0, 90, 45 degrees, third cycle of the slowest), and a pulse of 1 degree that lasts a period of\n\
         k 0.24, transformed over four such periods. Harmonics of the lift per radian. `pmb pitch` does the same with\n\
         `[[motion.harmonic]]` and `law = \"pulse\"`, `dip export --harmonics --k 0.08 --k 0.16`.\n\n\
         | k | CL, single | CL, at once | differs, % | CL, pulse | differs, % | CPU s, single |\n|---|---|---|---|---|---|---|\n",
        grid.cell_count(),
    );
    for ((k, omega), (alone, cpu_s)) in KS.iter().zip(omegas).zip(&single) {
        let off = |other: Complex<f64>| 100.0 * (other - alone).norm() / alone.norm();
        let together = at_once.per_radian(omega, STEPS);
        let pulsed = pulse.per_radian(omega, pulse.history.len());
        writeln!(
            text,
            "| {k} | {} | {} | {:.2} | {} | {:.2} | {cpu_s:.1} |",
            complex(*alone),
            complex(together),
            off(together),
            complex(pulsed),
            off(pulsed),
        )?;
    }
    writeln!(
        text,
        "\nThe run with three sines took {:.1} s of CPU time, the pulse {:.1} s, the single ones {:.1} s.",
        at_once.cpu_s,
        pulse.cpu_s,
        single.iter().map(|s| s.1).sum::<f64>()
    )?;
    Ok(text)
}
