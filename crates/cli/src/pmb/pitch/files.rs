//! Files of a run with prescribed motion: history and loops of the loads, first harmonics of the pressures.

use crate::exit::Stop;
use crate::figures::drawing;
use crate::output::RunFolder;
use crate::pmb::steady::cuts::Cut;
use dip_case::file::MotionKind;
use dip_record::{Recording, Step, csv};
use dip_report::{Chart, Figure, Series};

/// How a motion is drawn: label of its axis, factor from SI to the axis, and what a harmonic is given per.
#[derive(Debug, Clone, Copy)]
pub struct Unit {
    label: &'static str,
    factor: f64,
    per: &'static str,
}

impl Unit {
    /// Of a kind of motion.
    pub fn of(kind: MotionKind) -> Self {
        let degrees = 1_f64.to_degrees();
        let (label, factor, per) = match kind {
            MotionKind::Pitch => ("Pitch, degrees", degrees, "per radian"),
            MotionKind::Control => ("Deflection, degrees", degrees, "per radian"),
            MotionKind::Plunge => ("Plunge, m", 1.0, "per metre"),
            MotionKind::Mode => ("Generalized coordinate", 1.0, "per unit of the mode"),
        };
        Self { label, factor, per }
    }

    fn value(&self, step: &Step) -> f64 {
        step.motion.first().map_or(0.0, |m| m.value * self.factor)
    }
}

/// Writes `history.csv` and the pictures of the loads. `steps_per_cycle` is 0 where the motion is not periodic.
///
/// # Errors
/// What the file system says.
pub fn loads(
    folder: &RunFolder,
    title: &str,
    unit: &Unit,
    recording: &Recording,
    steps_per_cycle: usize,
) -> Result<(), Stop> {
    folder.write("history.csv", csv::history(recording).as_bytes())?;
    let steps = &recording.steps;
    if steps.len() < 2 {
        return Ok(());
    }
    let row = |label: &str, value: &dyn Fn(&Step) -> f64| {
        let points = steps.iter().map(|s| (s.time_s, value(s))).collect();
        vec![Chart::new("", "Time, s", label).series(Series::line("", points))]
    };
    let svg = Figure::new(title)
        .share_x()
        .row(row(unit.label, &|s| unit.value(s)))
        .row(row("C_{L}", &|s| s.loads.cl))
        .row(row("C_{D}", &|s| s.loads.cd))
        .row(row("C_{M}", &|s| s.loads.cm))
        .svg(800, 960)
        .map_err(|e| drawing(&e))?;
    folder.write("history.svg", svg.as_bytes())?;
    // Step 0 is the steady start and belongs to no cycle.
    let n = steps_per_cycle;
    let cycles = (steps.len() - 1).checked_div(n).unwrap_or(0);
    if cycles == 0 {
        return Ok(());
    }
    let loop_of = |label: &str, value: &dyn Fn(&Step) -> f64| {
        // The last two whole cycles, the very last one drawn over the other.
        (cycles.saturating_sub(2)..cycles).fold(Chart::new("", unit.label, label), |chart, cycle| {
            let points = steps[cycle * n..=(cycle + 1) * n]
                .iter()
                .map(|s| (unit.value(s), value(s)))
                .collect();
            let name = format!("cycle {}", cycle + 1);
            chart.series(if cycle + 1 == cycles {
                Series::line(name, points)
            } else {
                Series::dashed(name, points)
            })
        })
    };
    let svg = Figure::new(title)
        .row(vec![
            loop_of("C_{L}", &|s| s.loads.cl),
            loop_of("C_{M}", &|s| s.loads.cm),
        ])
        .svg(1000, 460)
        .map_err(|e| drawing(&e))?;
    folder.write("loops.svg", svg.as_bytes())?;
    Ok(())
}

/// Writes the first harmonics of Cp at the stations: `parts` are the cuts of the real and of the imaginary part.
///
/// # Errors
/// What the file system says.
pub fn pressures(folder: &RunFolder, title: &str, unit: &Unit, parts: &[Vec<Cut>; 2]) -> Result<(), Stop> {
    if parts[0].is_empty() {
        return Ok(());
    }
    let mut csv = String::from("eta,y_m,side,x_m,z_m,x_over_c,cp_real,cp_imaginary\n");
    let cell = |v: Option<f64>| v.map_or_else(String::new, |v| v.to_string());
    for (real, imaginary) in parts[0].iter().zip(&parts[1]) {
        let y = cell(real.station.as_ref().map(|s| s.y_m));
        let eta = cell(real.station.as_ref().and_then(|s| s.eta));
        for (side, re, im) in [
            ("upper", &real.upper, &imaginary.upper),
            ("lower", &real.lower, &imaginary.lower),
        ] {
            for (r, i) in re.iter().zip(im) {
                csv.push_str(&format!(
                    "{eta},{y},{side},{},{},{},{},{}\n",
                    r[0], r[1], r[2], r[3], i[3]
                ));
            }
        }
    }
    folder.write("cp_harmonic.csv", csv.as_bytes())?;
    let mut figure = Figure::new(title);
    let mut rows = 0;
    for (real, imaginary) in parts[0].iter().zip(&parts[1]) {
        if real.upper.is_empty() && real.lower.is_empty() {
            continue;
        }
        let chart = |cut: &Cut, what: &str| {
            let points = |side: &[[f64; 4]]| side.iter().map(|p| (p[2], p[3])).collect::<Vec<_>>();
            let title = if cut.station.is_some() {
                format!("{}: {what}", cut.label)
            } else {
                what.to_owned()
            };
            Chart::new(title, "x / c", format!("C_{{p}} {}", unit.per))
                .series(Series::line("upper side", points(&cut.upper)))
                .series(Series::dashed("lower side", points(&cut.lower)))
        };
        figure = figure.row(vec![
            chart(real, "in phase with the motion"),
            chart(imaginary, "a quarter of a cycle ahead"),
        ]);
        rows += 1;
    }
    if rows > 0 {
        let svg = figure.svg(1000, 60 + 400 * rows).map_err(|e| drawing(&e))?;
        folder.write("cp_harmonic.svg", svg.as_bytes())?;
    }
    Ok(())
}
