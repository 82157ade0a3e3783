//! Every shipped recipe makes a good grid (wings at a coarse level, which has the fine level's points).

use std::path::{Path, PathBuf};

use dip_grid::quality::{self, names};
use dip_grid::recipe::{self, Kind};

fn shipped() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes");
    let mut all: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "toml"))
        .collect();
    all.sort();
    all
}

#[test]
fn every_shipped_recipe_makes_a_grid_with_positive_volumes() {
    let all = shipped();
    assert!(all.len() >= 20, "{}", all.len());
    for path in all {
        let mut recipe = recipe::read(&path).unwrap();
        let small = path.file_name().is_some_and(|n| n.to_string_lossy().contains("_euler"));
        if matches!(recipe.kind, Some(Kind::WingCh | Kind::WingOo)) && !small {
            recipe.coarsen = Some(recipe.coarsen.unwrap_or(0).max(2));
        }
        let grid = recipe.make().unwrap_or_else(|e| panic!("{e}"));
        let report = quality::check(&grid);
        assert!(report.findings.iter().all(|f| !f.fatal), "{}: {report}", path.display());
        assert!(
            report.figure(names::VOLUME).unwrap().worst[0].value > 0.0,
            "{}: {report}",
            path.display()
        );
        assert!(
            report.figure(names::JACOBIAN).unwrap().worst[0].value > -0.1,
            "{}: {report}",
            path.display()
        );
        if let Some(blocks) = recipe.blocks {
            assert_eq!(grid.blocks.len(), blocks);
        }
    }
}

/// Sizes of the grids in Beaubien's thesis (2006): O-O 27,000 and 190,000 nodes, C-H 45,000 and 324,000.
#[test]
fn agard_grids_have_sizes_close_to_the_thesis() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes");
    for (name, nodes) in [
        ("oo_coarse", 27_000.0),
        ("oo_medium", 190_000.0),
        ("ch_coarse", 45_000.0),
    ] {
        let mut recipe = recipe::read(&folder.join(format!("agard445_{name}.toml"))).unwrap();
        recipe.blocks = None;
        let made = recipe.make().unwrap().node_count() as f64;
        assert!((made / nodes - 1.0).abs() < 0.06, "{name}: {made}");
    }
}
