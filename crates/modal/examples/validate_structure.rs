//! Writes docs/validation/structure/README.md and its figures: `cargo run --release -p dip-modal --example validate_structure`.

#[path = "../tests/support/published.rs"]
mod published;
#[path = "../tests/support/mod.rs"]
mod support;

use std::error::Error;
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::PathBuf;

use dip_modal::{DofSet, MassForm, Material, Model, Modes, ModesRequest, ShellSection, ThicknessRule};
use dip_report::{Chart, Marker, Series};
use nalgebra::Vector3;
use published::{agard_frequencies, agard_wing, data, mahogany, rows, yates, yates_model};
use support::{Cells, nodes_where, rectangle, simply_support};

type Outcome<T> = Result<T, Box<dyn Error>>;

fn solve(model: &Model, count: usize) -> Outcome<Modes> {
    Ok(model.assemble()?.modes(&ModesRequest::lowest(count))?)
}

fn percent(found: f64, reference: f64) -> String {
    format!("{:+.2} %", 100.0 * (found / reference - 1.0))
}

fn form_name(form: MassForm) -> &'static str {
    match form {
        MassForm::Lumped => "lumped",
        MassForm::Consistent => "consistent",
        MassForm::Mean => "mean of both",
    }
}

fn rule_name(rule: ThicknessRule) -> &'static str {
    match rule {
        ThicknessRule::Nodal => "nodal",
        ThicknessRule::ElementMean => "element mean",
        ThicknessRule::ExactSection => "exact section",
    }
}

const FORMS: [MassForm; 3] = [MassForm::Lumped, MassForm::Consistent, MassForm::Mean];
const RULES: [ThicknessRule; 3] = [
    ThicknessRule::Nodal,
    ThicknessRule::ElementMean,
    ThicknessRule::ExactSection,
];

fn agard(page: &mut String) -> Outcome<()> {
    let thesis = agard_frequencies("thesis");
    let _ = writeln!(
        page,
        "## AGARD 445.6 weakened wing, all root nodes clamped\n\n\
        Mesh of the thesis (R. J. Beaubien 2006, Table 5.4): 11 chordwise x 21 spanwise nodes, 200 quadrilaterals; his mass is 1.693 kg and his \
        frequencies are {thesis:?} Hz. Deviations are from these. The thickness rule and the set of ordinates are the \
        modelling that he does not state.\n\n\
        | ordinates | thickness | mass matrix | mass, kg | f1, Hz | f2 | f3 | f4 | deviations |\n|---|---|---|---|---|---|---|---|---|"
    );
    for set in ["TN3047", "R765"] {
        for rule in RULES {
            for form in FORMS {
                let mut model = agard_wing(set, 11, 21, rule).model()?;
                model.settings.mass = form;
                let system = model.assemble()?;
                let modes = system.modes(&ModesRequest::lowest(4))?;
                let errors: Vec<String> = (0..4).map(|m| percent(modes.freq_hz(m), thesis[m])).collect();
                let _ = writeln!(
                    page,
                    "| {set} | {} | {} | {:.4} | {:.3} | {:.3} | {:.3} | {:.3} | {} |",
                    rule_name(rule),
                    form_name(form),
                    system.mass_properties().mass,
                    modes.freq_hz(0),
                    modes.freq_hz(1),
                    modes.freq_hz(2),
                    modes.freq_hz(3),
                    errors.join(", ")
                );
            }
        }
    }
    let refined = agard_frequencies("refined");
    let _ = writeln!(
        page,
        "\nHis mass of 1.693 kg is that of thicknesses taken at the nodes from the TN 3047 ordinates (1.6936 kg); the AGARD R-765 \
        ordinates give 1.687 kg, and the section itself 1.724 to 1.731 kg. With nodal thickness and lumped mass, or element mean and \
        consistent mass, all four frequencies are within 1.3 % of his; the exact section on this mesh keeps 2 % more mass and is within 1.7 %.\n\n\
        Refined, exact section, R-765 ordinates; reference {refined:?} Hz (an independent plate solution on a fine mesh):\n\n\
        | nodes | mass matrix | mass, kg | f1, Hz | f2 | f3 | f4 | deviations |\n|---|---|---|---|---|---|---|---|"
    );
    let mut series: Vec<Vec<(f64, f64)>> = vec![Vec::new(); RULES.len()];
    for (ni, nj) in [(11, 21), (21, 41), (41, 81), (61, 121)] {
        for form in FORMS {
            let mut model = agard_wing("R765", ni, nj, ThicknessRule::ExactSection).model()?;
            model.settings.mass = form;
            let system = model.assemble()?;
            let modes = system.modes(&ModesRequest::lowest(4))?;
            let errors: Vec<String> = (0..4).map(|m| percent(modes.freq_hz(m), refined[m])).collect();
            let f: Vec<String> = (0..4).map(|m| format!("{:.3}", modes.freq_hz(m))).collect();
            let mass = system.mass_properties().mass;
            let _ = writeln!(
                page,
                "| {ni} x {nj} | {} | {mass:.4} | {} | {} |",
                form_name(form),
                f.join(" | "),
                errors.join(", ")
            );
        }
        for (curve, rule) in series.iter_mut().zip(RULES) {
            let mut model = agard_wing("R765", ni, nj, rule).model()?;
            model.settings.mass = MassForm::Mean;
            curve.push(((nj - 1) as f64, solve(&model, 2)?.freq_hz(1)));
        }
    }
    let mut chart = Chart::new(
        "AGARD 445.6: first torsion by thickness rule",
        "elements along the span",
        "frequency, Hz",
    );
    for (curve, rule) in series.into_iter().zip(RULES) {
        chart = chart.series(Series::line_markers(rule_name(rule), curve, Marker::Circle));
    }
    figure("agard_torsion.svg", &chart.hline(refined[1], "refined reference"))?;
    page.push_str("\n![First torsion by thickness rule](agard_torsion.svg)\n\n");
    let published = agard_frequencies("yates");
    let table = yates();
    let _ = writeln!(
        page,
        "## Mode shapes of Yates\n\n\
        On his 11 x 11 nodes with nodes 3 to 9 of the root fixed (NASA TM-100492 / AGARD R-765; his frequencies {published:?} Hz). MAC of the \
        deflections of all 121 nodes, not weighted. His element and thickness rule are not published; element mean with \
        consistent mass is above 0.98 in the first four modes.\n\n\
        | ordinates | thickness | mass matrix | f1 to f5, Hz | MAC of modes 1 to 5 |\n|---|---|---|---|---|"
    );
    for rule in [ThicknessRule::Nodal, ThicknessRule::ElementMean] {
        for form in FORMS {
            let modes = solve(&yates_model("R765", rule, form), 5)?;
            let mac = modes.mac_heave(&table)?;
            let f: Vec<String> = (0..5).map(|m| format!("{:.2}", modes.freq_hz(m))).collect();
            let m: Vec<String> = (0..5).map(|m| format!("{:.4}", mac[m][m])).collect();
            let _ = writeln!(
                page,
                "| R765 | {} | {} | {} | {} |",
                rule_name(rule),
                form_name(form),
                f.join(", "),
                m.join(", ")
            );
        }
    }
    let mut clamped = yates_model("R765", ThicknessRule::ElementMean, MassForm::Consistent);
    clamped.supports = (1..=11).map(|n| (n, DofSet::ALL)).collect();
    let modes = solve(&clamped, 5)?;
    let mac = modes.mac_heave(&table)?;
    let m: Vec<String> = (0..5).map(|m| format!("{:.4}", mac[m][m])).collect();
    let _ = writeln!(
        page,
        "\nWith the whole root clamped instead (element mean, consistent): {}: the root condition shows in mode 3.\n",
        m.join(", ")
    );
    Ok(())
}

fn plates(page: &mut String) -> Outcome<()> {
    let (e, nu, rho, t) = (7.0e10, 0.3, 2700.0, 1e-3_f64);
    let d = e * t.powi(3) / (12.0 * (1.0 - nu * nu));
    page.push_str(
        "## Thin cantilever plates, 40 x 40 quadrilaterals\n\n\
        lambda = omega a^2 sqrt(rho h / D) against the Ritz values of `tests/data/structural/leissa_cantilever.csv`; deviations of modes 1 to 5.\n\n\
        | a/b | lumped | consistent | mean of both |\n|---|---|---|---|\n",
    );
    for row in rows(&data("leissa_cantilever.csv")) {
        let v = row.iter().map(|v| v.parse::<f64>()).collect::<Result<Vec<_>, _>>()?;
        let _ = write!(page, "| {} |", v[0]);
        for form in FORMS {
            let section = ShellSection::thin_plate(1, Material::isotropic(e, nu, rho), t);
            let mut model = rectangle((1.0, 1.0 / v[0]), (40, 40), Cells::Quads, section, |x, y| {
                Vector3::new(x, y, 0.0)
            });
            model.settings.mass = form;
            model.supports = nodes_where(&model, |p| p.x < 1e-9)
                .into_iter()
                .map(|n| (n, DofSet::ALL))
                .collect();
            let modes = solve(&model, 5)?;
            let errors: Vec<String> = (0..5)
                .map(|m| percent(modes.omega_rad_s[m] * (rho * t / d).sqrt(), v[m + 1]))
                .collect();
            let _ = write!(page, " {} |", errors.join(", "));
        }
        page.push('\n');
    }
    let mut exact = rows(&data("orthotropic_ssss.csv"))
        .iter()
        .map(|r| r[2].parse::<f64>())
        .collect::<Result<Vec<_>, _>>()?;
    exact.sort_by(f64::total_cmp);
    page.push_str(
        "\n## Simply supported orthotropic plate, 40 x 40\n\n\
        Against Navier's closed form, modes 1 to 5.\n\n| element | lumped | consistent | mean of both |\n|---|---|---|---|\n",
    );
    for (cells, name) in [(Cells::Quads, "quadrilateral"), (Cells::Triangles, "triangle")] {
        let _ = write!(page, "| {name} |");
        for form in FORMS {
            let section = ShellSection::thin_plate(1, mahogany(), 0.02);
            let mut model = rectangle((0.5, 0.5), (40, 40), cells, section, |x, y| Vector3::new(x, y, 0.0));
            model.settings.mass = form;
            simply_support(&mut model, (0.5, 0.5));
            let modes = solve(&model, 5)?;
            let errors: Vec<String> = (0..5).map(|m| percent(modes.freq_hz(m), exact[m])).collect();
            let _ = write!(page, " {} |", errors.join(", "));
        }
        page.push('\n');
    }
    Ok(())
}

fn orders(page: &mut String) -> Outcome<()> {
    let (e, nu, rho, t) = (7.0e10, 0.3, 2700.0, 2e-3_f64);
    let d = e * t.powi(3) / (12.0 * (1.0 - nu * nu));
    let exact = 8.0 * PI * PI * (d / (rho * t)).sqrt();
    page.push_str(
        "\n## Measured order\n\n\
        Mode (2, 2) of a simply supported square plate against 8 pi^2 sqrt(D / (rho h)) / a^2; the order is between neighbouring meshes.\n\n\
        | element | mass matrix | 8 x 8 | 16 x 16 | 32 x 32 | 64 x 64 | orders |\n|---|---|---|---|---|---|---|\n",
    );
    let mut chart = Chart::new(
        "Mode (2, 2) of a simply supported plate",
        "elements along a side",
        "relative error",
    )
    .log_x()
    .log_y();
    for (cells, name) in [(Cells::Quads, "quadrilateral"), (Cells::Triangles, "triangle")] {
        for form in FORMS {
            let mut errors = Vec::new();
            for n in [8, 16, 32, 64] {
                let section = ShellSection::thin_plate(1, Material::isotropic(e, nu, rho), t);
                let mut model = rectangle((1.0, 1.0), (n, n), cells, section, |x, y| Vector3::new(x, y, 0.0));
                model.settings.mass = form;
                simply_support(&mut model, (1.0, 1.0));
                errors.push((n as f64, solve(&model, 4)?.omega_rad_s[3] / exact - 1.0));
            }
            let shown: Vec<String> = errors.iter().map(|e| format!("{:+.2e}", e.1)).collect();
            let orders: Vec<String> = errors
                .windows(2)
                .map(|w| format!("{:.2}", (w[0].1 / w[1].1).abs().log2()))
                .collect();
            let _ = writeln!(
                page,
                "| {name} | {} | {} | {} |",
                form_name(form),
                shown.join(" | "),
                orders.join(", ")
            );
            let points = errors.iter().map(|e| (e.0, e.1.abs())).collect();
            chart = chart.series(Series::line_markers(
                format!("{name}, {}", form_name(form)),
                points,
                Marker::Circle,
            ));
        }
    }
    figure("order.svg", &chart)?;
    page.push_str("\n![Error against mesh](order.svg)\n");
    Ok(())
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/validation/structure")
}

fn figure(name: &str, chart: &Chart) -> Outcome<()> {
    Ok(std::fs::write(folder().join(name), chart.svg(760, 460)?)?)
}

fn main() -> Outcome<()> {
    std::fs::create_dir_all(folder())?;
    let mut page = String::from(
        "# The structure against exact and published values\n\n\
        Made by `cargo run --release -p dip-modal --example validate_structure`. Quadrilaterals are DKMQ, triangles DKMT (in the thin limit DKQ and DKT); \
        data and sources in `tests/data/structural`. Exact checks (patch tests, Mindlin plate, beams, chains, constraints) are in \
        `crates/modal/tests/verification.rs`.\n\n",
    );
    agard(&mut page)?;
    plates(&mut page)?;
    orders(&mut page)?;
    std::fs::write(folder().join("README.md"), &page)?;
    println!("{page}");
    Ok(())
}
