//! Against published values: each test names its table. Data and sources: tests/data/structural/README.md.

#[path = "support/mod.rs"]
mod support;

#[path = "support/published.rs"]
mod published;

use dip_modal::{DofSet, MassForm, Material, Modes, ModesRequest, ShellSection, ThicknessRule};
use nalgebra::Vector3;
use published::{YATES_MASS_KG, agard_frequencies, agard_wing, data, mahogany, rows, yates, yates_model};
use support::{Cells, nodes_where, rectangle, simply_support};

fn assert_within(found: &Modes, reference: &[f64], tolerance: f64, what: &str) {
    for (mode, &r) in reference.iter().enumerate() {
        let error = found.freq_hz(mode) / r - 1.0;
        assert!(
            error.abs() < tolerance,
            "{what}: mode {} {:.4} Hz, reference {r} Hz, {error:+.4}",
            mode + 1,
            found.freq_hz(mode)
        );
    }
}

/// Leissa, NASA SP-160, chapter 4 (CFFF), recomputed by the Ritz method: `leissa_cantilever.csv`.
#[test]
fn thin_cantilever_plates_of_all_tabulated_aspect_ratios() {
    let (e, nu, rho, t) = (7.0e10, 0.3, 2700.0, 1e-3_f64);
    let d = e * t.powi(3) / (12.0 * (1.0 - nu * nu));
    for row in rows(&data("leissa_cantilever.csv")) {
        let values: Vec<f64> = row.iter().map(|v| v.parse().unwrap()).collect();
        // a is the length from the clamped edge, b the width.
        let (a, b) = (1.0, 1.0 / values[0]);
        for form in [MassForm::Mean, MassForm::Consistent] {
            let section = ShellSection::thin_plate(1, Material::isotropic(e, nu, rho), t);
            let mut model = rectangle((a, b), (40, 40), Cells::Quads, section, |x, y| Vector3::new(x, y, 0.0));
            model.settings.mass = form;
            model.supports = nodes_where(&model, |p| p.x < 1e-9)
                .into_iter()
                .map(|n| (n, DofSet::ALL))
                .collect();
            let found = model.assemble().unwrap().modes(&ModesRequest::lowest(5)).unwrap();
            for mode in 0..5 {
                let lambda = found.omega_rad_s[mode] * a * a * (rho * t / d).sqrt();
                let error = lambda / values[mode + 1] - 1.0;
                assert!(
                    error.abs() < 3e-3,
                    "a/b {} {form:?} mode {}: {lambda} {error:+.5}",
                    values[0],
                    mode + 1
                );
            }
        }
    }
}

/// Navier's closed form: `orthotropic_ssss.csv`.
#[test]
fn simply_supported_orthotropic_plate() {
    let mut exact: Vec<f64> = rows(&data("orthotropic_ssss.csv"))
        .iter()
        .map(|r| r[2].parse().unwrap())
        .collect();
    exact.sort_by(f64::total_cmp);
    for form in [MassForm::Lumped, MassForm::Mean] {
        let section = ShellSection::thin_plate(1, mahogany(), 0.02);
        let mut model = rectangle((0.5, 0.5), (40, 40), Cells::Quads, section, |x, y| {
            Vector3::new(x, y, 0.0)
        });
        model.settings.mass = form;
        simply_support(&mut model, (0.5, 0.5));
        let found = model.assemble().unwrap().modes(&ModesRequest::lowest(5)).unwrap();
        assert_within(&found, &exact[..5], 3e-3, &format!("orthotropic plate, {form:?}"));
    }
}

/// Beaubien 2006, Table 5.4, and section 5: mass 1.693 kg, 11 x 21 nodes, root clamped. The thickness comes from the
/// nodes and the ordinates are the TN 3047 set: that gives his mass to the last digit.
#[test]
fn agard_wing_on_the_mesh_of_the_thesis() {
    let reference = agard_frequencies("thesis");
    for (rule, form) in [
        (ThicknessRule::Nodal, MassForm::Lumped),
        (ThicknessRule::ElementMean, MassForm::Consistent),
    ] {
        let mut model = agard_wing("TN3047", 11, 21, rule).model().unwrap();
        model.settings.mass = form;
        let system = model.assemble().unwrap();
        let mass = system.mass_properties().mass;
        assert!((mass / 1.693 - 1.0).abs() < 1e-3, "{mass}");
        let found = system.modes(&ModesRequest::lowest(4)).unwrap();
        assert_within(&found, &reference, 0.015, &format!("{rule:?} {form:?}"));
    }
}

/// The same wing refined with the exact section.
#[test]
fn agard_wing_refined() {
    let reference = agard_frequencies("refined");
    for (set, form) in [
        ("R765", MassForm::Lumped),
        ("R765", MassForm::Consistent),
        ("TN3047", MassForm::Consistent),
    ] {
        let mut model = agard_wing(set, 41, 81, ThicknessRule::ExactSection).model().unwrap();
        model.settings.mass = form;
        let found = model.assemble().unwrap().modes(&ModesRequest::lowest(4)).unwrap();
        assert_within(&found, &reference, 0.005, &format!("{set} {form:?}"));
    }
}

/// Yates, NASA TM-100492 / AGARD R-765: mode shapes on his 11 x 11 nodes with his root condition, one thickness
/// an element and consistent mass. Other choices: docs/validation/structure.
#[test]
fn agard_mode_shapes_match_those_of_yates() {
    let table = yates();
    assert_eq!((table.count(), table.nodes.len()), (6, 121));
    let found = yates_model("R765", ThicknessRule::ElementMean, MassForm::Consistent)
        .assemble()
        .unwrap()
        .modes(&ModesRequest::lowest(5))
        .unwrap();
    let mac = found.mac_heave(&table).unwrap();
    for (mode, row) in mac.iter().enumerate().take(4) {
        assert!(row[mode] > 0.98, "mode {}: MAC {:.4}", mode + 1, row[mode]);
        for other in (0..4).filter(|&o| o != mode) {
            assert!(
                row[other] < 0.3,
                "modes {} and {}: {:.3}",
                mode + 1,
                other + 1,
                row[other]
            );
        }
    }
    // His shapes are scaled to a generalized mass of 175.127 kg: with his deflections in our mass matrix.
    assert!((table.generalized_mass[0] - YATES_MASS_KG).abs() < 1e-9);
}
