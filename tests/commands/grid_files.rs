//! Other people's grids: `pmb mesh check`, `pmb mesh convert` and `pmb steady` on files as they come, right and wrong.

use super::setup::CaseFolder;
use std::fmt::Write;
use std::fs;

const WAKE: usize = 6;
const SIDE: usize = 12;
const NORMAL: usize = 10;
const LAST: usize = 2 * (WAKE + SIDE);

/// A C round a section of 12 %, node (i, j) as [x, z]: from the exit below the wake round the nose to the exit above it.
fn c_grid(i: usize, j: usize) -> [f64; 2] {
    let behind = |n: usize| 1.0 + 9.0 * (n as f64 / WAKE as f64).powi(2);
    let on_wake = i <= WAKE || i >= LAST - WAKE;
    let below = i < LAST / 2;
    let (wall, far) = if on_wake {
        let x = behind(if below { WAKE - i } else { i + WAKE - LAST });
        ([x, 0.0], [x, if below { -10.0 } else { 10.0 }])
    } else {
        let s = (i as f64 - (WAKE + SIDE) as f64) / SIDE as f64;
        let x = s * s;
        let half = 0.6 * (0.2969 * s.abs() - 0.1260 * x - 0.3516 * x.powi(2) + 0.2843 * x.powi(3) - 0.1036 * x.powi(4));
        let angle = std::f64::consts::PI * (i - WAKE) as f64 / (2 * SIDE) as f64;
        ([x, half * s.signum()], [1.0 - 11.0 * angle.sin(), -10.0 * angle.cos()])
    };
    let share = (3.0 * j as f64 / NORMAL as f64).exp_m1() / 3f64.exp_m1();
    [0, 1].map(|d| wall[d] + share * (far[d] - wall[d]))
}

/// The grid in two planes, the short direction first, four numbers a line, with its neutral map: as the NASA Turbulence Modeling
/// Resource gives its grids to read.
fn resource() -> CaseFolder {
    let case = CaseFolder::small();
    let mut numbers = Vec::new();
    for d in 0..3 {
        for j in 0..=NORMAL {
            for i in 0..=LAST {
                let [x, z] = c_grid(i, j);
                numbers.extend([0.0, -1.0].map(|y| [x, y, z][d]));
            }
        }
    }
    let (ni, nj) = (LAST + 1, NORMAL + 1);
    let mut text = format!("           1\n           2          {ni}          {nj}\n");
    for line in numbers.chunks(4) {
        let words: Vec<String> = line.iter().map(|v| format!("{v:22.14E}")).collect();
        writeln!(text, "{}", words.join("  ")).unwrap();
    }
    fs::write(case.path("c.p3dfmt"), text).unwrap();
    let (tail, head) = (WAKE + 1, ni - WAKE);
    let map = format!(
        "# ===== Neutral Map File =====\n# Block#   IDIM   JDIM   KDIM\n       1\n\n       1     2   {ni}   {nj}\n\n\
         # Type   B1 F1  S1 E1  S2 E2  B2 F2  S1 E1  S2 E2  Swap\n\
         'symmetry_y_strong'   1 3   1 {ni}   1 {nj}\n'symmetry_y_strong'   1 4   1 {ni}   1 {nj}\n\
         'farfield_riem'   1 5   1 {nj}   1 2\n'farfield_riem'   1 6   1 {nj}   1 2\n'farfield_riem'   1 2   1 2   1 {ni}\n\
         'tangency'   1 1   1 2   {tail} {head}\n\
         'one-to-one'   1 1   1 2   1 {tail}   1 1   1 2   {ni} {head}   FALSE\n"
    );
    fs::write(case.path("c.nmf"), map).unwrap();
    fs::write(
        case.path("flow.toml"),
        "[flow]\nmodel = \"euler\"\nmach = 0.5\nalpha = \"1 deg\"\n[mesh]\nfile = \"c.p3dfmt\"\n\
         [reference]\nchord = \"1 m\"\nmoment_point = [\"0.25 m\", \"0 m\", \"0 m\"]\n",
    )
    .unwrap();
    case
}

#[test]
fn a_grid_of_the_resource_is_checked_converted_and_flown() {
    let case = resource();
    let check = case
        .run("pmb", &["mesh", "check", "c.p3dfmt"])
        .exits(0)
        .says(&["conditions from c.nmf", "renumbered so that k is across"]);
    assert!(check.stdout.contains("nothing to complain about"), "{}", check.stdout);
    let options = ["--encoding", "stream", "--big-endian"];
    case.run(
        "pmb",
        &[&["mesh", "convert", "c.p3dfmt", "d.xyz"], &options[..]].concat(),
    )
    .exits(0);
    let again = case.run("pmb", &["mesh", "check", "d.xyz"]).exits(0);
    assert_eq!(check.stdout, again.stdout);
    let flow = |file: &str, out: &str| {
        case.run("pmb", &["steady", "flow.toml", "--set", file, "--out", out, "--json"])
            .exits(0)
            .stdout
    };
    let lift = |text: String| {
        let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
        summary["cl"].as_f64().unwrap()
    };
    let a = lift(flow("mesh.file=\"c.p3dfmt\"", "a"));
    let b = lift(flow("mesh.file=\"d.xyz\"", "b"));
    assert!(a > 0.05 && a == b, "{a} {b}");
}

/// Each file wrong in one way, with the exit code of the check and a word of what it says.
#[test]
fn a_wrong_file_is_an_error_that_says_what_is_wrong() {
    let grid = |from: &'static str, to: &'static str| ("c.p3dfmt", from, to);
    let map = |from: &'static str, to: &'static str| ("c.nmf", from, to);
    for ((file, from, to), code, words) in [
        (grid(" 37 ", " 38 "), 2, "it is truncated, or the sizes are wrong"),
        (
            grid("2          37          11", "2000000000 2000000000 2000000000"),
            2,
            "would have 8.0e27 nodes",
        ),
        (
            grid("1.00000000000000E1", "NaN"),
            2,
            "x of node (0, 0, 0) is NaN, not a coordinate",
        ),
        (
            grid("1.00000000000000E1", "**********"),
            2,
            "\"**********\" is no number",
        ),
        (map(" 37   11", " 36   11"), 2, "c.nmf:5:"),
        (map("'tangency'", "'wobbly'"), 2, "unknown type 'wobbly'"),
        (map("7 31\n", "7 99\n"), 2, "nodes 7 to 99 do not lie on kmin"),
        (map("7 31\n", "5 31\n"), 3, "patch tangency and interface 0 overlap"),
        (
            map("'farfield_riem'   1 2   1 2", "'unprocessed'   1 2   1 2"),
            3,
            "have no condition and no neighbour",
        ),
        (map("37 31   FALSE", "31 37   FALSE"), 3, "nodes are 9.000e0 apart"),
    ] {
        let case = resource();
        case.edit(file, from, to);
        let check = case.run("pmb", &["mesh", "check", "c.p3dfmt"]).exits(code);
        let said = format!("{}{}", check.stdout, check.stderr);
        assert!(said.contains(words), "`{words}` is not in {said}");
        // What a check finds wrong, the flow solver does not take.
        case.run("pmb", &["steady", "flow.toml"]).exits(2);
    }
    let case = resource();
    let text = fs::read_to_string(case.path("c.p3dfmt")).unwrap();
    fs::write(case.path("c.p3dfmt"), &text[..text.len() / 2]).unwrap();
    case.run("pmb", &["mesh", "check", "c.p3dfmt"])
        .exits(2)
        .says(&["truncated"]);
}

/// The worst cells are named, in the report and for ParaView.
#[test]
fn worst_cells_are_named_by_block_indices_and_place() {
    let case = resource();
    let run = case
        .run("pmb", &["mesh", "check", "c.p3dfmt", "--json", "--worst", "worst.vtu"])
        .exits(0);
    let report: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    for figure in report["figures"].as_array().unwrap() {
        let worst = figure["worst"].as_array().unwrap();
        assert_eq!(worst.len(), 5, "{figure}");
        for cell in worst {
            assert_eq!(cell["block"], 0);
            assert_eq!(cell["ijk"].as_array().unwrap().len(), 3);
            assert_eq!(cell["centre_m"].as_array().unwrap().len(), 3);
        }
    }
    assert!(fs::metadata(case.path("worst.vtu")).unwrap().len() > 500);
}

/// A wedge whose sides are each other's after a turn: the check takes it, the flow solver, which knows shifts only, says so.
#[test]
fn the_flow_solver_refuses_a_grid_periodic_by_rotation() {
    let case = resource();
    let mut text = String::from("1\n5 4 2\n");
    for d in 0..3 {
        for k in [-5.0f64, 5.0] {
            for j in 0..4 {
                for i in 0..5 {
                    let (sin, cos) = k.to_radians().sin_cos();
                    let r = f64::from(1 + j);
                    writeln!(text, "{}", [f64::from(i), r * sin, r * cos][d]).unwrap();
                }
            }
        }
    }
    fs::write(case.path("wedge.xyz"), text).unwrap();
    let mut conditions = String::from("[[periodic]]\nrotation = { axis = [1, 0, 0], angle_deg = -10 }\n");
    for (face, condition) in [
        ("imin", "far-field"),
        ("imax", "far-field"),
        ("jmin", "wall"),
        ("jmax", "far-field"),
    ] {
        writeln!(
            conditions,
            "[[patch]]\nname = \"{face}\"\nblock = 0\nface = \"{face}\"\ncondition = \"{condition}\""
        )
        .unwrap();
    }
    fs::write(case.path("wedge.bc.toml"), conditions).unwrap();
    case.run("pmb", &["mesh", "check", "wedge.xyz"])
        .exits(0)
        .says(&["1 periodic"]);
    case.edit("flow.toml", "c.p3dfmt", "wedge.xyz");
    case.run("pmb", &["steady", "flow.toml"]).exits(2).says(&[
        "flow.toml:6:",
        "periodic by rotation",
        "symmetry planes on the two sides of the wedge",
    ]);
}
