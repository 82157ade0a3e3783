//! NACA 0012 on three grids: drag of subsonic flow, lift and drag of transonic flow.

use std::fs;
use std::path::Path;

use dip_grid::generate::{AerofoilGrid, AerofoilKind};
use dip_grid::geometry::{Section, TrailingEdge};
use dip_grid::{MultiBlock, split};
use dip_pmb::settings::{FarField, Reference};
use dip_report::{CpCut, cp_cuts};

use crate::{HEADER, Outcome, curve, settings, steady, write_history};

/// The C grid with so many cells along each side, in two blocks.
pub fn naca0012(surface: usize) -> Outcome<MultiBlock> {
    let h = 128.0 / surface as f64;
    let mut grid = AerofoilGrid {
        kind: AerofoilKind::C,
        section: Section::naca4("0012")?.with_trailing_edge(TrailingEdge::Closed)?,
        chord: 1.0,
        surface,
        wake: surface / 2,
        normal: surface / 2,
        base: 4,
        wall_spacing: 0.003 * h,
        nose_spacing: 0.002 * h,
        tail_spacing: 0.002 * h,
        far_field: 50.0,
        wake_growth: 0.1,
        growth_limit: 2.0,
    }
    .make()?;
    // As the programs do.
    split::part_at_own_cuts(&mut grid);
    Ok(grid)
}

pub fn naca(folder: &Path) -> Outcome<String> {
    let mut text = String::from(HEADER);
    let reference = Reference {
        area: 1.0,
        chord: 1.0,
        moment_point: [0.25, 0.0, 0.0],
    };
    let mut cuts = Vec::new();
    for (mach, alpha) in [(0.5, 1.25), (0.8, 1.25)] {
        let mut computed = Vec::new();
        for surface in [80, 160, 320] {
            let grid = naca0012(surface)?;
            let mut s = settings(mach, alpha, reference);
            s.far_field = FarField::Vortex;
            let result = steady(&mut text, &format!("NACA 0012, {surface} cells a side"), &s, &grid)?;
            computed.push((format!("{} cells", grid.cell_count()), curve(&result, 0.0, 0.0, 1.0)));
            if surface == 160 {
                let name = format!("naca0012_m{:.0}_history.svg", 100.0 * mach);
                write_history(
                    folder,
                    &name,
                    &format!("NACA 0012, Mach {mach}, {alpha} degrees"),
                    &result,
                )?;
            }
        }
        cuts.push(CpCut {
            label: format!("Mach {mach}, {alpha} degrees"),
            computed,
            ..CpCut::default()
        });
    }
    fs::write(
        folder.join("naca0012_cp.svg"),
        cp_cuts("NACA 0012", &cuts, 2)?.svg(1100, 480)?,
    )?;
    Ok(text)
}
