//! `pmb mesh`, `pmb mesh check`, `pmb mesh convert`.

use super::setup::CaseFolder;
use std::fs;

/// A recipe small enough to be made in a moment, in a folder of its own.
fn recipe() -> CaseFolder {
    let case = CaseFolder::small();
    fs::write(
        case.path("grid.toml"),
        "kind = \"aerofoil-c\"\n\
         [section]\nnaca = \"0012\"\ntrailing_edge = \"sharp\"\n\
         [cells]\nsurface = 24\nwake = 8\nnormal = 16\n\
         [spacing]\nwall = \"6 mm\"\nnose = 0.01\ntail = 0.015\n\
         [extent]\nfar_field = \"20 m\"\n",
    )
    .unwrap();
    case
}

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn a_recipe_becomes_a_grid_with_its_report_and_pictures() {
    let case = recipe();
    let run = case.run("pmb", &["mesh", "grid.toml", "-o", "out", "--json"]).exits(0);
    let summary = json(&run.stdout);
    assert_eq!(summary["cells"], 64 * 16);
    assert_eq!(summary["two_dimensional"], true);
    assert_eq!(summary["findings"].as_array().unwrap().len(), 0);
    let least = &summary["figures"][0]["worst"][0];
    assert!(least["value"].as_f64().unwrap() > 0.0, "{least}");
    for file in [
        "grid.xyz",
        "grid.bc.toml",
        "grid.nmf",
        "grid-quality.txt",
        "grid-section.svg",
        "grid-worst.vtu",
        "summary.json",
    ] {
        assert!(case.path("out").join(file).exists(), "{file}");
    }
    // The same again is welcome, another grid in its place is not.
    case.run("pmb", &["mesh", "grid.toml", "-o", "out"]).exits(0);
    case.edit("grid.toml", "normal = 16", "normal = 20");
    case.run("pmb", &["mesh", "grid.toml", "-o", "out"])
        .exits(2)
        .says(&["--force"]);
    case.run("pmb", &["mesh", "grid.toml", "-o", "out", "--force"]).exits(0);
}

#[test]
fn a_grid_file_may_be_named_and_is_kept() {
    let case = recipe();
    case.run("pmb", &["mesh", "grid.toml", "-o", "a/wing.xyz"]).exits(0);
    assert!(case.path("a/wing.bc.toml").exists());
    case.run("pmb", &["mesh", "grid.toml", "-o", "a/wing.xyz"])
        .exits(2)
        .says(&["is there already", "--force"]);
    case.run("pmb", &["mesh", "grid.toml", "-o", "wing.su2"])
        .exits(2)
        .says(&["cannot be written as .su2"]);
}

#[test]
fn check_tells_good_from_bad() {
    let case = recipe();
    case.run("pmb", &["mesh", "grid.toml", "-o", "grid.xyz"]).exits(0);
    let good = case.run("pmb", &["mesh", "check", "grid.xyz"]).exits(0);
    assert!(good.stdout.contains("nothing to complain about"), "{}", good.stdout);

    // Without conditions the wall and the far field are nobody's.
    fs::remove_file(case.path("grid.bc.toml")).unwrap();
    fs::remove_file(case.path("grid.nmf")).unwrap();
    let bad = case
        .run("pmb", &["mesh", "check", "grid.xyz", "--worst", "worst.vtu"])
        .exits(3);
    assert!(bad.stdout.contains("no condition"), "{}", bad.stdout);
    assert!(case.path("worst.vtu").exists());
}

#[test]
fn conversion_keeps_every_bit() {
    let case = recipe();
    case.run("pmb", &["mesh", "grid.toml", "-o", "a.xyz"]).exits(0);
    for options in [
        &["--encoding", "text"][..],
        &["--encoding", "stream", "--big-endian"],
        &["--encoding", "records", "--long-markers"],
    ] {
        case.run(
            "pmb",
            &[&["mesh", "convert", "a.xyz", "b.p3d", "--force"], options].concat(),
        )
        .exits(0);
        case.run("pmb", &["mesh", "convert", "b.p3d", "c.xyz", "--force"])
            .exits(0);
        let read = |file: &str| fs::read(case.path(file)).unwrap();
        assert_eq!(read("a.xyz"), read("c.xyz"), "{options:?}");
        assert_eq!(read("a.bc.toml"), read("c.bc.toml"), "{options:?}");
    }
    case.run("pmb", &["mesh", "convert", "a.xyz", "a.vtm"]).exits(0);
    assert!(case.path("a/0.vts").exists());
}

/// With and without the feature `cgns`: files that stay the same through it, or a word on how to get it.
#[test]
fn cgns_is_read_and_written_or_says_how_to_get_it() {
    let case = recipe();
    case.run("pmb", &["mesh", "grid.toml", "-o", "a.xyz"]).exits(0);
    if !case.run("pmb", &["mesh", "--help"]).stdout.contains("CGNS is built in") {
        for args in [
            &["mesh", "grid.toml", "-o", "wing.cgns"][..],
            &["mesh", "check", "wing.cgns"],
        ] {
            case.run("pmb", args).exits(2).says(&["--features cgns"]);
        }
        return;
    }
    case.run("pmb", &["mesh", "convert", "a.xyz", "b.cgns"]).exits(0);
    case.run("pmb", &["mesh", "check", "b.cgns"]).exits(0);
    case.run("pmb", &["mesh", "convert", "b.cgns", "c.xyz"]).exits(0);
    let read = |file: &str| fs::read(case.path(file)).unwrap();
    assert_eq!(read("a.xyz"), read("c.xyz"));
}

#[test]
fn bad_input_is_exit_code_2() {
    let case = recipe();
    case.run("pmb", &["mesh", "nothing.toml"])
        .exits(2)
        .says(&["nothing.toml"]);
    case.run("pmb", &["mesh", "check", "nothing.xyz"])
        .exits(2)
        .says(&["nothing.xyz"]);
    case.run("pmb", &["mesh"]).exits(2).says(&["RECIPE"]);
    case.run("pmb", &["mesh", "grid.toml", "--set", "cells.normal=4"])
        .exits(2)
        .says(&["extends"]);
    case.run("pmb", &["mesh", "grid.xyz"]).exits(2).says(&["is no recipe"]);

    case.run("pmb", &["mesh", "grid.toml", "-o", "cut.xyz"]).exits(0);
    let bytes = fs::read(case.path("cut.xyz")).unwrap();
    fs::write(case.path("cut.xyz"), &bytes[..bytes.len() / 2]).unwrap();
    case.run("pmb", &["mesh", "check", "cut.xyz"])
        .exits(2)
        .says(&["cut.xyz"]);

    case.edit("grid.toml", "normal = 16", "norml = 16");
    case.run("pmb", &["mesh", "grid.toml"])
        .exits(2)
        .says(&["grid.toml:8:", "did you mean `normal`"]);
}
