//! Wrong input: exit code 2 with file, line and a hint; broken box rules: a warning and exit code 3.

use super::setup::CaseFolder;

/// Line on which `text` stands in a file of the case.
fn line(case: &CaseFolder, file: &str, text: &str) -> String {
    let content = std::fs::read_to_string(case.path(file)).unwrap();
    let line = content.lines().position(|l| l.contains(text)).unwrap() + 1;
    format!("{file}:{line}:")
}

#[test]
fn misspelt_key_names_the_nearest() {
    let case = CaseFolder::small();
    case.edit("flutter.toml", "chordwise =", "chordwize =");
    let at = line(&case, "flutter.toml", "chordwize");
    case.run("dlm", &["flutter", "flutter.toml"]).exits(2).says(&[
        &at,
        "unknown key `chordwize`",
        "did you mean `chordwise`",
    ]);
}

#[test]
fn missing_unit_shows_one() {
    let case = CaseFolder::small();
    case.edit("flutter.toml", "semichord = \"0.27935 m\"", "semichord = \"0.27935\"");
    let at = line(&case, "flutter.toml", "semichord");
    case.run("dlm", &["flutter", "flutter.toml"])
        .exits(2)
        .says(&[&at, "missing unit", "0.5587 m"]);
}

#[test]
fn wrong_kind_of_unit() {
    let case = CaseFolder::small();
    case.edit("flutter.toml", "\"0.20821 kg/m^3\"", "\"0.20821 kg/m\"");
    let at = line(&case, "flutter.toml", "kg/m\"");
    case.run("dlm", &["flutter", "flutter.toml"])
        .exits(2)
        .says(&[&at, "is not a density"]);
}

#[test]
fn wrong_unit_in_an_override_is_said_to_be_there() {
    let case = CaseFolder::small();
    case.run("dlm", &["flutter", "flutter.toml", "--set", "reference.mass=3 m"])
        .exits(2)
        .says(&["--set", "is not a mass"]);
}

#[test]
fn supersonic_mach_number_on_the_lattice() {
    let case = CaseFolder::small();
    case.edit("flutter.toml", "mach = [0.678]", "mach = [1.072]");
    let at = line(&case, "flutter.toml", "1.072");
    case.run("dlm", &["flutter", "flutter.toml"])
        .exits(2)
        .says(&[&at, "needed 0 <= M < 1", "pmb march"]);
}

#[test]
fn negative_reduced_frequency() {
    let case = CaseFolder::small();
    case.edit("flutter.toml", "[0.001, 0.05", "[-0.001, 0.05");
    let at = line(&case, "flutter.toml", "-0.001");
    case.run("dlm", &["flutter", "flutter.toml"])
        .exits(2)
        .says(&[&at, "needed zero or more"]);
}

#[test]
fn only_zero_reduced_frequency_cannot_give_flutter() {
    let case = CaseFolder::small();
    case.edit("flutter.toml", "[0.001, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0]", "[0.0]");
    let at = line(&case, "flutter.toml", "reduced_frequencies");
    case.run("dlm", &["flutter", "flutter.toml"])
        .exits(2)
        .says(&[&at, "above zero"]);
}

#[test]
fn zero_area_boxes() {
    let case = CaseFolder::small();
    case.edit("wing.toml", "chord = \"0.3682 m\"", "chord = \"0 m\"");
    case.run("dlm", &["flutter", "flutter.toml"])
        .exits(2)
        .says(&["wing.toml:", "chord 0 m", "positive"]);
}

#[test]
fn sections_at_one_station() {
    let case = CaseFolder::small();
    case.edit(
        "wing.toml",
        "[\"0.8094 m\", \"0.762 m\", \"0 m\"]",
        "[\"0.8094 m\", \"0 m\", \"0 m\"]",
    );
    let at = line(&case, "wing.toml", "0.8094");
    case.run("dlm", &["flutter", "flutter.toml"])
        .exits(2)
        .says(&[&at, "same span station"]);
}

#[test]
fn overlapping_surfaces() {
    let case = CaseFolder::small();
    case.edit(
        "flutter.toml",
        "[spline]",
        "[[lattice.surface]]\nwing = \"wing.toml\"\nchordwise = 4\nspanwise = 5\n\n[spline]",
    );
    case.run("dlm", &["flutter", "flutter.toml"])
        .exits(2)
        .says(&["flutter.toml:", "on top of each other"]);
}

#[test]
fn a_structure_with_a_mechanism() {
    let case = CaseFolder::small();
    // One spring at the nose of the root leaves the wing free to turn about it.
    case.edit("structure.toml", "root = \"clamped\"", "root = \"free\"");
    let spring = "[[spring]]\nposition = [0, 0, 0]\nvertical = \"1e4 N/m\"\n\n[modes]";
    case.edit("structure.toml", "[modes]", spring);
    let at = line(&case, "structure.toml", "[support]");
    case.run("dlm", &["modes", "structure.toml"])
        .exits(2)
        .says(&[&at, "mechanism"]);
}

#[test]
fn a_root_without_nodes() {
    let case = CaseFolder::small();
    case.edit("structure.toml", "root = \"clamped\"", "root = []");
    let at = line(&case, "structure.toml", "root = []");
    case.run("dlm", &["modes", "structure.toml"])
        .exits(2)
        .says(&[&at, "root"]);
}

#[test]
fn modes_that_do_not_match_the_wing() {
    let case = CaseFolder::small();
    let text = std::fs::read_to_string(case.path("yates_modes.csv")).unwrap();
    std::fs::write(case.path("yates_modes.csv"), text.replace("x_in,y_in", "x_m,y_m")).unwrap();
    case.run("dlm", &["flutter", "flutter_yates.toml"])
        .exits(2)
        .says(&["yates_modes.csv", "span"]);
}

#[test]
fn too_few_frequencies_for_the_shapes() {
    let case = CaseFolder::small();
    case.edit("flutter_yates.toml", ", \"91.5448 Hz\"]", "]");
    let at = line(&case, "flutter_yates.toml", "frequencies = [");
    case.run("dlm", &["flutter", "flutter_yates.toml"])
        .exits(2)
        .says(&[&at, "3 frequencies"]);
}

#[test]
fn densities_that_do_not_fit_the_mach_numbers() {
    let case = CaseFolder::small();
    case.edit("flutter.toml", "mach = [0.678]", "mach = [0.678, 0.901]");
    let at = line(&case, "flutter.toml", "densities = [");
    case.run("dlm", &["flutter", "flutter.toml"])
        .exits(2)
        .says(&[&at, "1 densities for 2 Mach numbers"]);
}

#[test]
fn methods_that_cannot_be_matched() {
    let case = CaseFolder::small();
    case.edit(
        "flutter.toml",
        "densities = [\"0.20821 kg/m^3\"]",
        "search = \"matched-point\"",
    );
    let at = line(&case, "flutter.toml", "methods");
    case.run("dlm", &["flutter", "flutter.toml"])
        .exits(2)
        .says(&[&at, "matched point"]);
}

#[test]
fn missing_files_are_named() {
    let case = CaseFolder::small();
    case.run("dlm", &["flutter", "nothing.toml"])
        .exits(2)
        .says(&["nothing.toml", "cannot read"]);
    case.edit("flutter.toml", "wing = \"wing.toml\"", "wing = \"wings.toml\"");
    case.run("dlm", &["flutter", "flutter.toml"])
        .exits(2)
        .says(&["wings.toml", "cannot read", "relative to"]);
}

#[test]
fn broken_toml_names_the_line() {
    let case = CaseFolder::small();
    case.edit("flutter.toml", "chordwise = 8", "chordwise = = 8");
    let at = line(&case, "flutter.toml", "= = 8");
    case.run("dlm", &["flutter", "flutter.toml"]).exits(2).says(&[&at]);
}

#[test]
fn box_rules_broken_is_a_warning_and_exit_code_3() {
    let case = CaseFolder::small();
    let run = case.run(
        "dlm",
        &[
            "flutter",
            "flutter.toml",
            "--set",
            "lattice.chordwise=40",
            "--set",
            "lattice.spanwise=2",
        ],
    );
    let run = run.exits(3);
    assert!(run.stderr.contains("wider than 10 chords"), "{}", run.stderr);
    assert!(
        run.stdout.contains("0.678"),
        "the results are printed all the same: {}",
        run.stdout
    );
}

#[test]
fn unknown_arguments_are_exit_code_2() {
    let case = CaseFolder::small();
    case.run("dlm", &["fluter", "flutter.toml"]).exits(2).says(&["flutter"]);
    case.run("dip", &["compare"]).exits(2);
}
