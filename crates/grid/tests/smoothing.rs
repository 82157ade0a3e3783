//! Recipes with a `[smoothing]` table: lines leave the wall at a right angle, first steps stay, no cell is folded.

use std::path::Path;

use dip_grid::quality::{self, names};
use dip_grid::recipe::{self, RecipeError};
use dip_grid::{MultiBlock, metrics, vector};

const AEROFOIL: &str = "
[section]
naca = \"0012\"
trailing_edge = \"sharp\"
[cells]
surface = 48
normal = 48
[spacing]
y_plus = { value = 1, reynolds = 1e6, length = \"1 m\" }
nose = 0.004
tail = 0.004
[extent]
far_field = \"20 m\"
";

const WING: &str = "
kind = \"wing-ch\"
[wing]
file = \"@/../cases/agard445/wing.toml\"
nose_radius = 0.00102
[cells]
surface = 32
wake = 16
normal = 40
span = 12
outboard = 8
[spacing]
y_plus = { value = 1, reynolds = 1e6, length = \"0.5587 m\" }
nose = 0.004
tail = 0.008
root = \"70 mm\"
tip = \"6 mm\"
[extent]
far_field = \"6 m\"
exit = \"8 m\"
";

fn make(text: &str) -> Result<MultiBlock, RecipeError> {
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.toml");
    std::fs::write(&path, text.replace('@', &meshes.to_string_lossy())).unwrap();
    recipe::make(&path)
}

/// Worst and mean angle at the wall, and largest skewness.
fn angles(grid: &MultiBlock) -> [f64; 3] {
    let report = quality::check(grid);
    assert!(report.findings.iter().all(|f| !f.fatal), "{report}");
    let wall = report.figure(names::WALL_ANGLE).unwrap();
    [
        wall.worst[0].value,
        wall.mean,
        report.figure(names::SKEWNESS).unwrap().worst[0].value,
    ]
}

/// Largest relative difference of the first steps.
fn step_off(a: &MultiBlock, b: &MultiBlock) -> f64 {
    let (a, b) = (&a.blocks[0], &b.blocks[0]);
    let mut worst = 0.0f64;
    for k in 0..=a.nk {
        for i in 0..=a.ni {
            let step = |g: &dip_grid::Block| vector::distance(g.point(i, 0, k), g.point(i, 1, k));
            worst = worst.max((step(b) / step(a) - 1.0).abs());
        }
    }
    worst
}

#[test]
fn transfinite_lines_become_normal_to_an_aerofoil() {
    for kind in ["kind = \"aerofoil-c\"", "kind = \"aerofoil-o\""] {
        let wake = if kind.contains("-c") {
            "surface = 48\nwake = 24"
        } else {
            "surface = 48"
        };
        let base = format!("{kind}{}", AEROFOIL.replace("surface = 48", wake));
        let map = make(&base).unwrap();
        let start = make(&format!("{base}[smoothing]\nstart = \"transfinite\"\nsweeps = 0\n")).unwrap();
        let smooth = make(&format!("{base}[smoothing]\nstart = \"transfinite\"\nsweeps = 400\n")).unwrap();
        let (before, after) = (angles(&start), angles(&smooth));
        // The worst stands at the trailing edge of an O, where the wall itself has a corner: as in the map's grid.
        assert!(
            before[1] > 20.0 && after[1] < 1.5 && after[0] < angles(&map)[0] + 6.0,
            "{before:?} {after:?}"
        );
        assert!(after[2] < before[2] - 10.0, "{before:?} {after:?}");
        assert!(step_off(&map, &smooth) < 1e-3, "{}", step_off(&map, &smooth));
    }
}

#[test]
fn every_plane_of_a_wing_is_smoothed() {
    let map = make(WING).unwrap();
    let start = make(&format!("{WING}[smoothing]\nstart = \"transfinite\"\nsweeps = 0\n")).unwrap();
    let text = format!("{WING}[smoothing]\nstart = \"transfinite\"\nsweeps = 150\n");
    let smooth = make(&text).unwrap();
    let (before, after) = (angles(&start), angles(&smooth));
    assert!(quality::check(&smooth).is_good());
    // What is left is the planform's: planes y = const lean at the swept nose.
    let left = angles(&map);
    assert!(
        before[1] > 50.0 && after[1] < left[1] + 3.0,
        "{before:?} {after:?} {left:?}"
    );
    assert!(step_off(&map, &smooth) < 1e-3, "{}", step_off(&map, &smooth));
    // The coarser level keeps every second point of what was smoothed, to the last bit.
    let coarse = make(&format!("coarsen = 1\n{text}")).unwrap();
    let (fine, coarse) = (&smooth.blocks[0], &coarse.blocks[0]);
    for k in 0..=coarse.nk {
        for j in 0..=coarse.nj {
            for i in 0..=coarse.ni {
                assert_eq!(coarse.point(i, j, k), fine.point(2 * i, 2 * j, 2 * k));
            }
        }
    }
}

/// The O-O grid of the same wing.
fn wing_oo() -> String {
    let mut text = WING.replace("wing-ch", "wing-oo");
    for line in ["wake = 16\n", "outboard = 8\n", "exit = \"8 m\"\n"] {
        text = text.replace(line, "");
    }
    text
}

/// Mean and largest angle between first steps and the normal of the four faces about their feet, where the wing is a wing: off
/// symmetry plane, trailing edge and tip.
fn lean(grid: &MultiBlock, [tail, span]: [usize; 2]) -> [f64; 2] {
    let block = &grid.blocks[0];
    let mut angles = Vec::new();
    for k in 1..span {
        for i in tail + 2..block.ni - tail - 1 {
            let node = |di: usize, dk: usize| block.point(i + di - 1, 0, k + dk - 1);
            let mut normal = [0.0; 3];
            for (a, c) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let face = metrics::face_area(node(a, c), node(a + 1, c), node(a + 1, c + 1), node(a, c + 1));
                normal = vector::add(normal, face);
            }
            let step = vector::sub(block.point(i, 1, k), block.point(i, 0, k));
            let cos = vector::dot(vector::unit(step), vector::unit(normal)).abs();
            angles.push(cos.min(1.0).acos().to_degrees());
        }
    }
    let sum: f64 = angles.iter().sum();
    [sum / angles.len() as f64, angles.iter().copied().fold(0.0, f64::max)]
}

/// Planes y = const meet a swept nose at the angle of its sweep; smoothing turns the lines into the wall's normal there too.
#[test]
fn lines_leave_a_swept_wing_at_a_right_angle() {
    for (text, inside) in [(WING.to_owned(), [16, 9]), (wing_oo(), [0, 9])] {
        let map = make(&text).unwrap();
        let smooth = make(&format!("{text}[smoothing]\n")).unwrap();
        let (before, after) = (lean(&map, inside), lean(&smooth, inside));
        assert!(before[0] > 3.0 && before[1] > 40.0, "{before:?}");
        assert!(after[0] < 0.5 && after[1] < 4.0, "{before:?} {after:?}");
        let step_off = step_off(&map, &smooth);
        assert!(step_off < 1e-3, "{step_off}");
        let [before, after] = [&map, &smooth].map(angles);
        assert!(
            after[1] < 0.6 * before[1] && after[2] < before[2] + 3.0,
            "{before:?} {after:?}"
        );
        // Both sides of cuts and sheets are one surface still, every volume is positive.
        let report = quality::check(&smooth);
        assert!(report.is_good(), "{report}");
    }
}

/// Interpolation between the edges of a surface that bends round the tip would leave the wall aslant: it is refused.
#[test]
fn o_o_grids_are_smoothed_from_the_map_alone() {
    let error = make(&format!("{}[smoothing]\nstart = \"transfinite\"\n", wing_oo())).unwrap_err();
    assert!(
        error.to_string().contains("smoothing.start: \"map\" in O-O grids"),
        "{error}"
    );
}

#[test]
fn wrong_smoothing_is_an_error() {
    let base = format!("kind = \"aerofoil-o\"{AEROFOIL}[smoothing]\n");
    let error = |text: &str| make(&format!("{base}{text}")).unwrap_err().to_string();
    assert!(error("start = \"spline\"\n").contains("transfinite"));
    assert!(error("sweeps = 10000000\n").contains("smoothing.sweeps"));
    let elsewhere =
        "kind = \"box\"\n[smoothing]\n[shape]\nfrom = [0, 0, 0]\nto = [1, 1, 1]\n[cells]\nbox = [2, 2, 2]\n";
    let text = make(elsewhere).unwrap_err().to_string();
    assert!(text.contains("smoothing does not go with kind \"box\""), "{text}");
}
