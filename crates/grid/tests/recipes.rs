//! Every shipped recipe makes a good grid (wings at a coarse level, which has the fine level's points).

use std::path::{Path, PathBuf};

use dip_grid::coarsen::coarsen;
use dip_grid::quality::{self, names};
use dip_grid::recipe::{self, Kind};
use proptest::prelude::*;

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
        // Grids for inviscid flow are small enough to be made whole.
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let small = ["_euler", "_pitch"].iter().any(|part| name.contains(part));
        if matches!(recipe.kind, Some(Kind::WingCh | Kind::WingOo)) && !small {
            recipe.coarsen = Some(recipe.coarsen.unwrap_or(0).max(2));
        }
        // Wings are smoothed whole whatever level is kept: a few sweeps are enough here.
        if let (Some(table), Some(Kind::WingCh | Kind::WingOo)) = (&mut recipe.smoothing, recipe.kind) {
            table.sweeps = Some(20);
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

/// The shipped families: each level is every second point of the next finer one, to the last bit. (Their finest levels too,
/// which take longer: examples/validate_grids.)
#[test]
fn shipped_levels_are_every_second_point_of_the_finer_to_the_last_bit() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes");
    let one_block = |name: &str| {
        let mut recipe = recipe::read(&folder.join(format!("agard445_{name}.toml"))).unwrap();
        recipe.blocks = None;
        recipe.make().unwrap()
    };
    for family in ["oo", "ch"] {
        let mut finer = one_block(&format!("{family}_medium"));
        for level in ["coarse", "coarsest"] {
            let coarse = one_block(&format!("{family}_{level}"));
            let mut kept = coarsen(&finer).unwrap();
            kept.blocks[0].name.clone_from(&coarse.blocks[0].name);
            assert!(kept == coarse, "{family} {level}");
            finer = coarse;
        }
    }
}

/// The camber line at the tip of the LANN wing rises by 20 degrees at the nose: outboard of the tip it would fold the corners of the
/// sheet's long cells, and a sheet that becomes straight does not.
#[test]
fn a_straight_sheet_folds_no_corner_of_a_steep_camber_line() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes/lann_ch_euler.toml");
    let worst = |sheet: &str| {
        let mut recipe = recipe::read(&path).unwrap();
        recipe.spacing.nose = Some(0.004);
        recipe.wing.as_mut().unwrap().sheet = Some(sheet.into());
        let report = quality::check(&recipe.make().unwrap());
        (report.figure(names::JACOBIAN).unwrap().worst[0].value, report.is_good())
    };
    let (camber, straight) = (worst("camber"), worst("straight"));
    assert!(camber.0 < -0.15 && !camber.1, "{camber:?}");
    assert!(straight.0 > -0.06 && straight.1, "{straight:?}");
}

/// Small recipes of every kind; `@` stands for the folder of the shipped ones.
const SMALL: [&str; 9] = [
    "kind = \"aerofoil-c\"\n[section]\nnaca = \"2412\"\ntrailing_edge = \"blunt\"\n[cells]\nsurface = 12\nwake = 6\nnormal = 8\nbase = 2\n[spacing]\nwall = 0.01\nnose = 0.02\ntail = 0.03\nwake_growth = 1\ngrowth_limit = 9\n[extent]\nfar_field = 10\n",
    "kind = \"aerofoil-o\"\n[section]\nnaca = \"0012\"\nchord = 2\ntrailing_edge = \"sharp\"\n[cells]\nsurface = 12\nnormal = 8\n[spacing]\nwall = 0.01\nnose = 0.02\ntail = 0.03\ngrowth_limit = 9\n[extent]\nfar_field = 10\n",
    "kind = \"aerofoil-c\"\n[section]\nnaca = \"2412\"\n[cells]\nsurface = 12\nwake = 6\nnormal = 8\n[spacing]\nwall = 0.01\nnose = 0.02\ntail = 0.03\ngrowth_limit = 9\n[extent]\nfar_field = 10\n[smoothing]\nstart = \"transfinite\"\nsweeps = 7\n",
    "kind = \"wing-ch\"\ncoarsen = 1\nblocks = 3\n[wing]\nfile = \"@/geometry/oneram6.toml\"\ntip_length = 0.02\n[cells]\nsurface = 8\nwake = 4\nnormal = 8\nspan = 6\noutboard = 4\n[spacing]\nwall = 0.002\nnose = 0.02\ntail = 0.03\nroot = 0.2\ntip = 0.01\ngrowth_limit = 9\n[extent]\nfar_field = 8\nexit = 10\n",
    "kind = \"wing-oo\"\n[wing]\nfile = \"@/geometry/oneram6.toml\"\nnose_radius = 0.01\n[cells]\nsurface = 8\nnormal = 8\nspan = 6\n[spacing]\nwall = 0.002\nnose = 0.02\ntail = 0.03\nroot = 0.2\ntip = 0.01\ngrowth_limit = 9\n[extent]\nfar_field = 8\n",
    "kind = \"wing-oo\"\n[wing]\nfile = \"@/geometry/lann.toml\"\n[cells]\nsurface = 6\nnormal = 6\nspan = 4\n[spacing]\nwall = 0.001\nnose = 0.02\ntail = 0.03\nroot = 0.2\ntip = 0.02\ngrowth_limit = 9\n[extent]\nfar_field = 5\n[smoothing]\nsweeps = 3\n",
    "kind = \"bump\"\n[shape]\nlength = 1.5\nheight = 0.05\n[cells]\nupstream = 4\nsurface = 8\ndownstream = 4\nnormal = 6\n[spacing]\ny_plus = { value = 1, reynolds = 3e6, length = 1 }\nedge = 0.02\ngrowth_limit = 9\n[extent]\nupstream = 2\ndownstream = 2\nfar_field = 5\n",
    "kind = \"ramp\"\n[shape]\nlength = 1\nangle = \"15 deg\"\n[cells]\nupstream = 4\nsurface = 8\nnormal = 6\n[spacing]\nwall = 0.01\nedge = 0.02\n[extent]\nupstream = 1\nfar_field = 1\n",
    "kind = \"box\"\nblocks = 2\n[shape]\nfrom = [0, 0, 0]\nto = [1, 1, 1]\nwaviness = 0.05\nperiodic = [true, false, true]\n[cells]\nbox = [4, 4, 4]\n",
];

/// What may stand in the place of a number.
const ODD: [&str; 16] = [
    "0", "1", "2", "3", "7", "-1", "-0.5", "0.0", "1e-9", "1e-300", "1e300", "nan", "inf", "-inf", "99", "\"5 mm\"",
];

proptest! {
    // More cases for a long search: DIP_FUZZ_CASES=100000.
    #![proptest_config(ProptestConfig {
        cases: std::env::var("DIP_FUZZ_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(60),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn damaged_recipes_never_panic(
        which in 0..SMALL.len(),
        changes in proptest::collection::vec((any::<prop::sample::Index>(), 0..ODD.len()), 1..4),
        gone in proptest::option::of(any::<prop::sample::Index>()),
    ) {
        let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes");
        let mut lines: Vec<String> =
            SMALL[which].replace('@', &meshes.to_string_lossy()).lines().map(str::to_owned).collect();
        for (at, odd) in changes {
            let n = at.index(lines.len());
            if let Some((key, value)) = lines[n].split_once(" = ")
                && value.parse::<f64>().is_ok()
            {
                lines[n] = format!("{key} = {}", ODD[odd]);
            }
        }
        if let Some(at) = gone {
            lines.remove(at.index(lines.len()));
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.toml");
        std::fs::write(&path, lines.join("\n")).unwrap();
        // A grid or an error; a grid's numbers are numbers, or the check says so.
        if let Ok(grid) = recipe::make(&path) {
            let _ = quality::check(&grid);
        }
    }
}
