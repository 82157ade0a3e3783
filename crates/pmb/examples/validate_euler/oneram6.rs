//! ONERA M6 against the experiment of AGARD AR-138.

use std::fs;
use std::path::Path;

use dip_grid::recipe;
use dip_pmb::settings::Reference;
use dip_report::{CpCut, cp_cuts};

use crate::{HEADER, Outcome, curve, root, settings, steady, write_history};

pub fn oneram6(folder: &Path) -> Outcome<String> {
    let mut text = String::from(HEADER);
    // AGARD AR-138: semispan 1.1963 m, root chord 0.8059 m, taper 0.562, leading-edge sweep 30 degrees.
    let (span, root_chord, taper) = (1.1963, 0.8059, 0.562);
    let reference = Reference {
        area: 0.5 * root_chord * (1.0 + taper) * span,
        chord: 0.64607,
        moment_point: [0.0; 3],
    };
    let data = root().join("tests/data/flow");
    let grid = recipe::make(&data.join("oneram6_ch_euler.toml"))?;
    let result = steady(&mut text, "ONERA M6", &settings(0.84, 3.06, reference), &grid)?;
    write_history(
        folder,
        "oneram6_history.svg",
        "ONERA M6, Mach 0.84, 3.06 degrees",
        &result,
    )?;
    let measured = fs::read_to_string(data.join("oneram6_exp_cp_M0.84_a3.06.csv"))?;
    let mut cuts = Vec::new();
    for eta in [0.2, 0.44, 0.65, 0.8, 0.9, 0.95, 0.99] {
        let (y, chord) = (eta * span, root_chord * (1.0 + eta * (taper - 1.0)));
        let leading = y * 30.0_f64.to_radians().tan();
        let mut points = Vec::new();
        for line in measured.lines().filter(|l| !l.starts_with('#')) {
            let fields: Vec<&str> = line.split(',').collect();
            if let [e, _, _, x, cp] = fields[..]
                && e.parse::<f64>().is_ok_and(|e| (e - eta).abs() < 1e-6)
            {
                points.push((x.parse()?, cp.parse()?));
            }
        }
        cuts.push(CpCut {
            label: format!("2y/b = {eta}"),
            computed: vec![("Euler".to_owned(), curve(&result, y, leading, chord))],
            measured: vec![("experiment".to_owned(), points)],
            critical: None,
        });
    }
    fs::write(
        folder.join("oneram6_cp.svg"),
        cp_cuts("ONERA M6, Mach 0.84, 3.06 degrees", &cuts, 3)?.svg(1200, 1100)?,
    )?;
    Ok(text)
}
