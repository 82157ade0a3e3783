//! AGARD 445.6 on coarse and medium grids of both topologies at four Mach numbers and two angles.

use std::fs;
use std::path::Path;

use dip_grid::recipe;
use dip_pmb::settings::Reference;
use dip_report::{CpCut, cp_cuts};

use crate::{HEADER, Outcome, curve, root, settings, steady, write_history};

/// Stations at which pressures are compared, parts of the semispan.
const STATIONS: [f64; 4] = [0.26, 0.52, 0.76, 0.96];

const MACH: [f64; 4] = [1.072, 0.96, 0.901, 0.678];
const ALPHA_DEG: [f64; 2] = [0.0, 1.0];

/// Semispan, root chord, tip chord in metres: Yates 1988 (NASA TM-100492).
const SPAN: f64 = 0.762;
const ROOT: f64 = 0.5587;
const TIP: f64 = 0.3682;

/// Leading edge and chord at a station; the quarter-chord line is swept by 45 degrees.
fn section(eta: f64) -> [f64; 2] {
    let sweep = (SPAN + 0.25 * (ROOT - TIP)) / SPAN;
    [eta * SPAN * sweep, ROOT + eta * (TIP - ROOT)]
}

/// Pressures of all grids so far at a Mach number and an angle.
struct Flow {
    mach: f64,
    alpha_deg: f64,
    cuts: [CpCut; STATIONS.len()],
}

impl Flow {
    fn write(&self, folder: &Path) -> Outcome<()> {
        let file = format!("agard445_m{:.0}_a{:.0}_cp.svg", 1000.0 * self.mach, self.alpha_deg);
        let title = format!(
            "AGARD 445.6, Mach {}, angle of attack {} degrees",
            self.mach, self.alpha_deg
        );
        fs::write(folder.join(file), cp_cuts(title, &self.cuts, 2)?.svg(1100, 800)?)?;
        Ok(())
    }
}

/// Runs all and returns the table. The grids that take longest come last; figures and table are written after every run, so
/// that nothing is lost if somebody stops it.
pub fn agard(folder: &Path) -> Outcome<String> {
    let mut text = String::from(HEADER);
    let reference = Reference {
        area: 0.5 * (ROOT + TIP) * SPAN,
        chord: ROOT,
        moment_point: [0.25 * ROOT, 0.0, 0.0],
    };
    let mut flows: Vec<Flow> = MACH
        .into_iter()
        .flat_map(|mach| ALPHA_DEG.map(|alpha_deg| (mach, alpha_deg)))
        .map(|(mach, alpha_deg)| Flow {
            mach,
            alpha_deg,
            cuts: STATIONS.map(|eta| CpCut {
                label: format!("eta {eta}"),
                ..CpCut::default()
            }),
        })
        .collect();
    for (path, name) in [
        ("meshes/agard445_ch_euler.toml", "C-H coarse"),
        ("meshes/agard445_oo_coarse.toml", "O-O coarse"),
        ("meshes/agard445_oo_medium.toml", "O-O medium"),
        ("tests/data/flow/agard445_ch_euler_medium.toml", "C-H medium"),
    ] {
        let grid = recipe::make(&root().join(path))?;
        for flow in &mut flows {
            let result = steady(&mut text, name, &settings(flow.mach, flow.alpha_deg, reference), &grid)?;
            for (cut, eta) in flow.cuts.iter_mut().zip(STATIONS) {
                let [leading, chord] = section(eta);
                let points = curve(&result, eta * SPAN, leading, chord);
                cut.computed.push((name.to_owned(), points));
            }
            if name == "C-H coarse" && flow.alpha_deg == 1.0 {
                let file = format!("agard445_m{:.0}_history.svg", 1000.0 * flow.mach);
                let title = format!("AGARD 445.6, Mach {}, 1 degree", flow.mach);
                write_history(folder, &file, &title, &result)?;
            }
            flow.write(folder)?;
            fs::write(folder.join("agard.md"), &text)?;
        }
    }
    Ok(text)
}
