//! The two limiters side by side on coarser and finer grids.

use std::path::Path;

use dip_grid::recipe;
use dip_pmb::reconstruct::Reconstruction;
use dip_pmb::settings::{FarField, Reference};

use crate::naca::naca0012;
use crate::{HEADER, Outcome, root, settings, steady};

pub fn limiters(_: &Path) -> Outcome<String> {
    let mut text = String::from(HEADER);
    let both = [
        ("van Albada", Reconstruction::VanAlbada),
        ("Koren", Reconstruction::Koren),
    ];
    let mut s = settings(
        0.8,
        1.25,
        Reference {
            area: 1.0,
            chord: 1.0,
            moment_point: [0.25, 0.0, 0.0],
        },
    );
    s.far_field = FarField::Vortex;
    for surface in [80, 160, 320] {
        let grid = naca0012(surface)?;
        for (name, reconstruction) in both {
            s.reconstruction = reconstruction;
            steady(&mut text, &format!("NACA 0012, {surface} a side, {name}"), &s, &grid)?;
        }
    }
    let mut s = settings(
        0.96,
        1.0,
        Reference {
            area: 0.35315,
            chord: 0.5587,
            moment_point: [0.0; 3],
        },
    );
    for mesh in ["agard445_ch_euler_coarse", "agard445_ch_euler", "agard445_ch_medium"] {
        let grid = recipe::make(&root().join("meshes").join(mesh).with_extension("toml"))?;
        for (name, reconstruction) in both {
            s.reconstruction = reconstruction;
            steady(&mut text, &format!("`{mesh}`, {name}"), &s, &grid)?;
        }
    }
    Ok(text)
}
