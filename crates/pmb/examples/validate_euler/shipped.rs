//! Every Euler grid that is shipped, over the range of Mach numbers, by default settings: does the residual fall to round-off?

use std::fs;
use std::path::Path;

use dip_grid::{recipe, split};
use dip_pmb::settings::Reference;

use crate::{HEADER, Outcome, root, settings, steady};

/// The inviscid cases of AGARD AR-211 for the NACA 0012, and two slow ones.
const AEROFOIL: [(f64, f64); 7] = [
    (0.3, 0.0),
    (0.5, 3.0),
    (0.8, 1.25),
    (0.85, 1.0),
    (0.95, 0.0),
    (1.2, 0.0),
    (1.2, 7.0),
];
const WING: [(f64, f64); 5] = [(0.499, 1.0), (0.678, 1.0), (0.901, 0.0), (0.96, 0.0), (1.141, 1.0)];

/// Runs all and returns the table.
///
/// The table is written after every grid, so that nothing is lost if somebody stops it.
pub fn shipped(folder: &Path) -> Outcome<String> {
    let mut text = String::from(HEADER);
    for (recipe_name, flows) in [
        ("naca0012_o", &AEROFOIL[..]),
        ("naca0012_c", &AEROFOIL),
        ("naca0012_blunt", &[(0.5, 3.0), (0.8, 1.25)]),
        ("naca0012_unsteady", &[(0.755, 0.016)]),
        ("naca0012_unsteady_fine", &[(0.755, 0.016), (0.5, 2.0)]),
        ("naca64a010_c", &[(0.5, 1.0), (0.796, 0.0), (0.85, 1.0)]),
        ("naca64a010_unsteady_fine", &[(0.796, 0.0)]),
        ("thin_aerofoil_unsteady", &[(0.5, 0.5), (0.8, 0.0)]),
        ("thin_aerofoil_unsteady_fine", &[(0.5, 0.5)]),
        ("rae2822_c_euler", &[(0.5, 2.0), (0.75, 3.0)]),
        // For viscous flow: what such a grid does to the residual of inviscid flow.
        ("rae2822_c", &[(0.5, 2.0), (0.75, 3.0)]),
        ("ramp", &[(2.0, 0.0)]),
        ("agard445_ch_euler_coarse", &WING),
        ("agard445_oo_coarsest", &WING),
        ("agard445_oo_coarse", &WING),
        ("agard445_ch_euler", &WING),
        ("f5_like_ch_euler", &[(0.6, 1.0), (0.95, 0.0)]),
        ("f5_like_pitch", &[(0.6, 0.0), (0.95, 0.0)]),
        ("lann_ch_euler_coarse", &[(0.82, 0.6)]),
        ("lann_ch_euler", &[(0.62, 0.6), (0.82, 0.6)]),
    ] {
        let mut grid = recipe::make(&root().join(format!("meshes/{recipe_name}.toml")))?;
        // As the programs do.
        split::part_at_own_cuts(&mut grid);
        for &(mach, alpha) in flows {
            steady(
                &mut text,
                recipe_name,
                &settings(mach, alpha, Reference::default()),
                &grid,
            )?;
        }
        fs::write(folder.join("shipped.md"), &text)?;
    }
    Ok(text)
}
