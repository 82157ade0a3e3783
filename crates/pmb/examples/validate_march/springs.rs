//! Sections on springs: one whose flutter is known from Possio's equation, and Isogai's case A.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use dip_flutter::decay::{DecaySettings, limit_cycle};
use dip_flutter::search::{SearchStep, StaticLimit};
use dip_report::{Chart, Figure, Marker, Series};

use crate::driver::Outcome;
use crate::section::{self, Section};
use crate::{mesh, percent, search};

/// `theodorsen_2dof_flutter.csv`, its first case.
const HODGES: Section = Section {
    a: -0.2,
    x_alpha: 0.1,
    r2: 0.24,
    mu: 20.0,
    frequency_ratio: 0.4,
};

/// A section that diverges and does not flutter: elastic axis at 60 % of the chord, centre of gravity at 45 %.
const DIVERGING: Section = Section {
    a: 0.2,
    x_alpha: -0.3,
    r2: 0.24,
    mu: 20.0,
    frequency_ratio: 0.4,
};

/// Isogai's case A (`isogai_caseA.json`).
const ISOGAI: Section = Section {
    a: -2.0,
    x_alpha: 1.8,
    r2: 3.48,
    mu: 60.0,
    frequency_ratio: 1.0,
};

pub fn section(_: &Path) -> Outcome<String> {
    let mut page = String::from(
        "## A section on springs\n\n\
        a = -0.2, x_alpha = 0.1, r^2 = 0.24, mu = 20, omega_h / omega_alpha = 0.4; NACA 0002 on a C grid (161 x 33 points), marched at fixed \
        Mach number with the speed varied. Reference: Possio's equation (thin plate, compressible), which at Mach 0 is Theodorsen's: \
        2.184 and 0.6490 there (`theodorsen_2dof_flutter.csv`).\n\n\
        | Mach | U / (b omega_alpha), march | Possio | | omega / omega_alpha, march | Possio | | marches | CPU, s |\n|---|---|---|---|---|---|---|---|---|\n",
    );
    let [speed, frequency] = HODGES.flutter(0.0).ok_or("no flutter by Theodorsen's function")?;
    println!("Theodorsen: {speed:.4} {frequency:.4}");
    let grid = mesh("thin_aerofoil_unsteady")?;
    for mach in [0.2, 0.3, 0.5] {
        let [exact, ratio] = HODGES.flutter(mach).ok_or("no flutter by Possio's equation")?;
        let freq_hz = ratio * section::OMEGA_ALPHA / std::f64::consts::TAU;
        let case = HODGES.case(grid.clone(), mach, freq_hz)?;
        let (still, seconds) = case.still()?;
        println!("section at Mach {mach}: Possio {exact:.4} {ratio:.4}");
        let found = case.search(&still, search(0.85 * exact, [0.5, 6.0], 0.005), |v| HODGES.stream(v))?;
        let n = found.neutral().ok_or("no flutter point")?;
        let ours = n.freq_hz * std::f64::consts::TAU / section::OMEGA_ALPHA;
        let _ = writeln!(
            page,
            "| {mach} | {:.4} +- {:.4} | {exact:.4} | {} | {ours:.4} | {ratio:.4} | {} | {} | {:.1} |",
            n.at,
            n.error,
            percent(n.at, exact),
            percent(ours, ratio),
            found.rows.len(),
            found.cpu_s + seconds
        );
    }
    Ok(page)
}

/// Static divergence, whose speed is known in closed form from the lift slope.
pub fn divergence(_: &Path) -> Outcome<String> {
    let mut page = String::from(
        "## A section that diverges\n\n\
        a = 0.2, x_alpha = -0.3, r^2 = 0.24, mu = 20, omega_h / omega_alpha = 0.4; NACA 0002 as above. A thin plate diverges where (U / (b omega_alpha))^2 = \
        mu r^2 (1 - M^2)^(1/2) / (1 + 2 a); the same with the lift slope of the steady flow on this grid about this axis. The search knows neither and says \
        that the section diverges, between which speeds, and by the rates of growth and decay at which.\n\n\
        | Mach | thin plate | with our lift slope | diverges between | at | to our lift slope | marches | CPU, s |\n|---|---|---|---|---|---|---|---|\n",
    );
    let grid = mesh("thin_aerofoil_unsteady")?;
    for mach in [0.3, 0.5] {
        let case = DIVERGING.case(grid.clone(), mach, 10.0)?;
        let (still, seconds) = case.still()?;
        let plate =
            DIVERGING.divergence(std::f64::consts::TAU / (1.0 - mach * mach).sqrt() * 0.5 * (0.5 + DIVERGING.a));
        // Moment about the elastic axis for a radian of incidence, per chord.
        let mut turned = case.clone();
        turned.steady.flow.alpha_deg = 0.1;
        let slope = turned.still()?.0.loads.total.cm / 0.1_f64.to_radians();
        let exact = DIVERGING.divergence(slope);
        println!("divergence at Mach {mach}: thin plate {plate:.4}, by our moment {exact:.4}");
        let found = case.search(&still, search(0.8 * plate, [0.5, 6.0], 0.01), |v| DIVERGING.stream(v))?;
        let said = match found.end {
            SearchStep::Divergence(StaticLimit {
                between: [below, above],
                point: Some(point),
            }) => format!(
                "{below:.4} and {above:.4} | {:.4} +- {:.4} | {}",
                point.at,
                point.error,
                percent(point.at, exact)
            ),
            end => format!("{end:?} | |"),
        };
        let _ = writeln!(
            page,
            "| {mach} | {plate:.4} | {exact:.4} | {said} | {} | {:.1} |",
            found.rows.len(),
            found.cpu_s + seconds
        );
    }
    Ok(page)
}

pub fn isogai(folder: &Path) -> Outcome<String> {
    let mut page = String::from(
        "## Isogai's case A\n\n\
        a = -2, x_alpha = 1.8, r^2 = 3.48, mu = 60, omega_h = omega_alpha; NACA 64A010, Euler flow, C grid. V_f = U / (b omega_alpha sqrt(mu)), the lowest \
        speed of flutter. Published Euler results dip from 1.1 - 1.3 at Mach 0.75 to 0.5 - 0.6 near 0.82 - 0.86 and rise beyond 0.9 (no table \
        of them is at hand).\n\n\
        | Mach | V_f | error | omega / omega_alpha | marches | CPU, s |\n|---|---|---|---|---|---|\n",
    );
    let grid = mesh("naca64a010_unsteady")?;
    let root_mu = ISOGAI.mu.sqrt();
    let mut curve = Vec::new();
    let mut frequencies = Vec::new();
    let mut last = 1.2;
    for step in 0..9 {
        let mach = 0.7 + 0.025 * f64::from(step);
        let mut case = ISOGAI.case(grid.clone(), mach, 13.0)?;
        case.start = vec![5e-4, 0.0];
        let (still, seconds) = case.still()?;
        println!("Isogai at Mach {mach:.3}");
        // From below, so that the lowest of several neutral points is found.
        let settings = search(0.75 * last * root_mu, [0.1 * root_mu, 4.0 * root_mu], 0.01);
        let found = case.search(&still, settings, |v| ISOGAI.stream(v))?;
        match found.neutral() {
            Some(n) => {
                let ratio = n.freq_hz * std::f64::consts::TAU / section::OMEGA_ALPHA;
                last = n.at / root_mu;
                curve.push((mach, last));
                frequencies.push((mach, ratio));
                let _ = writeln!(
                    page,
                    "| {mach:.3} | {last:.3} | {:.3} | {ratio:.3} | {} | {:.1} |",
                    n.error / root_mu,
                    found.rows.len(),
                    found.cpu_s + seconds
                );
            }
            None => {
                let _ = writeln!(
                    page,
                    "| {mach:.3} | {:?} | | | {} | {:.1} |",
                    found.end,
                    found.rows.len(),
                    found.cpu_s
                );
            }
        }
    }
    let speed = Chart::new("Flutter speed", "Mach number", "V_{f} = U / (b omega_{alpha} mu^{1/2})")
        .series(Series::line_markers("Euler march", curve, Marker::Circle))
        .y_range(0.0, 2.0);
    let frequency = Chart::new("Frequency", "Mach number", "omega / omega_{alpha}").series(Series::line_markers(
        "Euler march",
        frequencies,
        Marker::Circle,
    ));
    let figure = Figure::new("Isogai's case A").row(vec![speed, frequency]);
    fs::write(folder.join("isogai.svg"), figure.svg(1100, 440)?)?;
    page.push_str("\n![Isogai's case A](isogai.svg)\n");
    Ok(page)
}

/// A limit cycle that the shock makes: Isogai's section above its flutter speed at Mach 0.9.
pub fn limit(folder: &Path) -> Outcome<String> {
    const MACH: f64 = 0.9;
    const V_F: f64 = 0.85;
    let mut page = format!(
        "## A limit cycle\n\n\
        Isogai's case A at Mach {MACH}, V_f = {V_F}, a fifth above its flutter speed; marched from a small and from a large start to the last cycle. What the small \
        one grows to and what the large one comes down to is a limit cycle: the shock does less work on a larger motion. Amplitudes of the wall in per \
        cent of the chord, largest in the first and in the last 10 cycles of 13 Hz.\n\n\
        | start | cycles | first | last | recognized | g early | g late | Hz | CPU, s |\n|---|---|---|---|---|---|---|---|---|\n"
    );
    let grid = mesh("naca64a010_unsteady")?;
    let mut chart = Chart::new(
        format!("Isogai's case A, Mach {MACH}, V_{{f}} = {V_F}"),
        "Time, s",
        "Amplitude of the wall in mode 1, % of the chord",
    );
    for (name, start, cycles) in [("small", 0.01, 150.0), ("large", 0.03, 100.0)] {
        let mut case = ISOGAI.case(grid.clone(), MACH, 13.0)?;
        (case.start, case.whole, case.cycles, case.orders) = (vec![start, 0.0], true, cycles, 1.5);
        let (still, _) = case.still()?;
        let row = case.march(&still, V_F, ISOGAI.stream(V_F * ISOGAI.mu.sqrt()), None)?;
        let per_cycle = case.steps_per_cycle as usize;
        let size = |n: usize| 100.0 * case.wing.largest[0] * row.states[n].q[0].abs();
        let envelope: Vec<(f64, f64)> = (0..row.states.len() / per_cycle)
            .map(|c| {
                let most = (c * per_cycle..(c + 1) * per_cycle).map(size).fold(0.0, f64::max);
                (row.states[c * per_cycle].time_s, most)
            })
            .collect();
        let most = |part: &[(f64, f64)]| part.iter().map(|p| p.1).fold(0.0, f64::max);
        let histories: Vec<Vec<f64>> = (0..2).map(|m| row.states.iter().map(|s| s.q[m]).collect()).collect();
        let step_s = row.states[1].time_s - row.states[0].time_s;
        let said = match limit_cycle(&histories, step_s, &DecaySettings::default())? {
            Some(c) => format!("yes | {:+.4} | {:+.4} | {:.2}", c.g_early, c.g_late, c.freq_hz),
            None => "no | | |".to_owned(),
        };
        let _ = writeln!(
            page,
            "| {name} | {cycles} | {:.2} | {:.2} | {said} | {:.0} |",
            most(&envelope[..10]),
            most(&envelope[envelope.len() - 10..]),
            row.cpu_s
        );
        chart = chart.series(Series::line(format!("{name} start"), envelope));
    }
    fs::write(folder.join("limit_cycle.svg"), chart.svg(760, 420)?)?;
    page.push_str(
        "\nA limit cycle is told from growth: the large start shows none.\n\n![Limit cycle](limit_cycle.svg)\n",
    );
    Ok(page)
}
