//! AGARD 445.6 on coarse and medium grids of both topologies at four Mach numbers and two angles.

use std::fs;
use std::path::Path;

use dip_grid::recipe;
use dip_pmb::settings::Reference;
use dip_report::{CpCut, cp_cuts};

use crate::{HEADER, Outcome, curve, root, settings, steady, write_history};

/// Stations at which pressures are compared, parts of the semispan.
const STATIONS: [f64; 4] = [0.26, 0.52, 0.76, 0.96];

/// Runs all and returns the table.
pub fn agard(folder: &Path) -> Outcome<String> {
    let mut text = String::from(HEADER);
    // Yates 1988 (NASA TM-100492): semispan 0.762 m, root chord 0.5587 m, tip chord 0.3682 m, quarter-chord sweep 45.
    let (span, root_chord, tip_chord) = (0.762, 0.5587, 0.3682);
    let leading = |eta: f64| {
        let sweep = (span + 0.25 * (root_chord - tip_chord)) / span;
        eta * span * sweep
    };
    let reference = Reference {
        area: 0.5 * (root_chord + tip_chord) * span,
        chord: root_chord,
        moment_point: [0.25 * root_chord, 0.0, 0.0],
    };
    let grids = [
        ("meshes/agard445_ch_euler.toml", "C-H coarse"),
        ("meshes/agard445_oo_coarse.toml", "O-O coarse"),
        ("tests/data/flow/agard445_ch_euler_medium.toml", "C-H medium"),
        ("meshes/agard445_oo_medium.toml", "O-O medium"),
    ]
    .map(|(path, name)| (recipe::make(&root().join(path)), name));
    for mach in [0.678, 0.901, 0.96, 1.072] {
        for alpha in [0.0, 1.0] {
            let mut cuts = STATIONS.map(|eta| CpCut {
                label: format!("eta {eta}"),
                ..CpCut::default()
            });
            for (grid, name) in &grids {
                let grid = grid.as_ref().map_err(ToString::to_string)?;
                let result = steady(&mut text, name, &settings(mach, alpha, reference), grid)?;
                for (cut, eta) in cuts.iter_mut().zip(STATIONS) {
                    let chord = root_chord + eta * (tip_chord - root_chord);
                    let points = curve(&result, eta * span, leading(eta), chord);
                    cut.computed.push(((*name).to_owned(), points));
                }
                if *name == grids[0].1 && alpha == 1.0 {
                    let file = format!("agard445_m{:.0}_history.svg", 1000.0 * mach);
                    write_history(folder, &file, &format!("AGARD 445.6, Mach {mach}, 1 degree"), &result)?;
                }
            }
            let file = format!("agard445_m{:.0}_a{alpha:.0}_cp.svg", 1000.0 * mach);
            let title = format!("AGARD 445.6, Mach {mach}, angle of attack {alpha} degrees");
            fs::write(folder.join(file), cp_cuts(title, &cuts, 2)?.svg(1100, 800)?)?;
        }
    }
    Ok(text)
}
