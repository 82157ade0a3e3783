//! The static position of the wing under lift.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use dip_report::{Chart, Marker, Series};

use crate::driver::Outcome;
use crate::{agard, mesh};

pub fn static_position(folder: &Path) -> Outcome<String> {
    let mut page = String::from(
        "## Static position\n\nMach 0.8, 1 degree, C-H grid of 53,760 cells, plate of 11 x 21 nodes, 6 modes. The published coupled result has tip \
        deflections of 11.6 mm (leading edge) and 13.2 mm (trailing edge) at a dynamic pressure that is not at hand; ours by dynamic pressure:\n\n\
        | dynamic pressure, kPa | leading edge, mm | trailing edge, mm | ratio | CL | CL rigid | exchanges | last change |\n|---|---|---|---|---|---|---|---|\n",
    );
    let grid = mesh("agard445_ch_euler")?;
    let modes = agard::modes("own", 6)?;
    let mut case = agard::case(&grid, &modes, 0.8, 1.0)?;
    case.steady.solver.orders = 6.0;
    let (still, _) = case.still()?;
    // Tip corners of the plate: nodes 11 and 1 counted back from the last.
    let corners = [modes.nodes.len() - 11, modes.nodes.len() - 1];
    let mut curves = [Vec::new(), Vec::new()];
    let mut lifts = Vec::new();
    for density in [0.03, 0.06, 0.1, 0.15, 0.2, 0.25, 0.3] {
        let stream = agard::stream(262.0, density);
        let mean = case.position(&still, &stream)?;
        let pressure = 1e-3 * stream.dynamic_pressure_pa();
        let tip = corners.map(|n| 1e3 * (0..6).map(|m| mean.q[m] * modes.motion(m, n).0.z).sum::<f64>());
        let _ = writeln!(
            page,
            "| {pressure:.3} | {:.2} | {:.2} | {:.3} | {:.5} | {:.5} | {} | {:.0e} |",
            tip[0],
            tip[1],
            tip[1] / tip[0],
            mean.loads.total.cl,
            still.loads.total.cl,
            mean.exchanges,
            mean.change
        );
        for (curve, z) in curves.iter_mut().zip(tip) {
            curve.push((pressure, z));
        }
        lifts.push((pressure, mean.loads.total.cl));
    }
    // Where our leading edge is where the published one is, the other two numbers can be compared.
    let between = |x: &[(f64, f64)], y: &[(f64, f64)], at: f64| {
        let n = x.windows(2).position(|w| w[0].1 <= at && at < w[1].1)?;
        let s = (at - x[n].1) / (x[n + 1].1 - x[n].1);
        Some(y[n].1 + s * (y[n + 1].1 - y[n].1))
    };
    let pressures: Vec<(f64, f64)> = lifts.iter().map(|l| (l.0, l.0)).collect();
    let at = |y: &[(f64, f64)]| between(&curves[0], y, 11.6).ok_or("the leading edge does not come to 11.6 mm");
    let _ = writeln!(
        page,
        "\nWhere our leading edge is at 11.6 mm ({:.2} kPa), our trailing edge is at {:.2} mm (published 13.2) and our lift coefficient is {:.4} (published \
        0.0539, on a reference area of its own).",
        at(&pressures)?,
        at(&curves[1])?,
        at(&lifts)?
    );
    let [leading, trailing] = curves;
    let chart = Chart::new("Tip deflection at Mach 0.8, 1 degree", "Dynamic pressure, kPa", "z, mm")
        .series(Series::line_markers("leading edge", leading, Marker::Circle))
        .series(Series::line_markers("trailing edge", trailing, Marker::Square))
        .hline(11.6, "published, leading edge")
        .hline(13.2, "published, trailing edge");
    fs::write(folder.join("static.svg"), chart.svg(760, 460)?)?;
    page.push_str("\n![static deflection](static.svg)\n");
    Ok(page)
}
