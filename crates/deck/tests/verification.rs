//! Decks with known answers: exact aerodynamics, one structure described in two ways, methods that must agree at zero damping.

use std::path::{Path, PathBuf};

use dip_deck::{Solution, SolveError, flutter::Crossing, run, solve, solve_with_modes};
use dip_flutter::{CrossingKind, Direction};
use dip_nastran::{
    Deck,
    cards::control::FlutterMethod,
    modes::{Eigenvalue, ModeTable},
};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/data/nastran")
        .join(name)
}

fn onset(solution: &Solution, subcase: usize, kind: CrossingKind) -> &Crossing {
    solution.subcases[subcase]
        .summaries
        .iter()
        .flat_map(|s| &s.crossings)
        .find(|c| c.kind == kind && c.direction == Direction::Onset)
        .unwrap_or_else(|| panic!("no {kind:?} in subcase {subcase}"))
}

fn close(a: f64, b: f64, relative: f64) -> bool {
    (a - b).abs() <= relative * b.abs()
}

/// Deck text with one line replaced.
fn edited(name: &str, from: &str, to: &str) -> Deck {
    let text = std::fs::read_to_string(data(name)).unwrap();
    assert!(text.contains(from), "{from}");
    Deck::parse(&text.replacen(from, to, 1), name, data("")).unwrap()
}

#[test]
fn strip_theory_gives_the_exact_flutter_point_of_the_section() {
    // Reference data of the project: U-g solution of the section with Theodorsen's function, 5 digits.
    let (b, omega) = (0.5, 20.0);
    let solution = run(data("section_strip.bdf")).unwrap();
    for subcase in 0..2 {
        let c = onset(&solution, subcase, CrossingKind::Flutter);
        assert!(close(c.velocity / (b * omega), 2.18391, 2e-4), "{c:?}");
        assert!(close(c.freq_hz * std::f64::consts::TAU / omega, 0.64898, 2e-4), "{c:?}");
        assert!(close(c.k, 0.29717, 4e-4), "{c:?}");
    }
    // Uncoupled frequencies 8 and 20 rad/s, coupled by x^2 / r^2: the exact roots of the quadratic.
    let (x2, r) = (0.01 / 0.24, 0.4_f64 * 0.4);
    let root =
        |sign: f64| ((1.0 + r + sign * ((1.0 + r).powi(2) - 4.0 * r * (1.0 - x2)).sqrt()) / (2.0 * (1.0 - x2))).sqrt();
    let modes = &solution.subcases[0].modes;
    assert!(close(modes.omega_rad_s[0] / omega, root(-1.0), 1e-9));
    assert!(close(modes.omega_rad_s[1] / omega, root(1.0), 1e-9));
}

#[test]
fn dampers_stay_in_k_and_leave_ke() {
    let damper = "CDAMP2* 31              20.             1               3\nENDDATA";
    let with = |method: &str| {
        let text = std::fs::read_to_string(data("section_strip.bdf")).unwrap();
        let text = text.replacen("ENDDATA", damper, 1).replacen(
            "FLUTTER 20      K ",
            &format!("FLUTTER 20      {method:<2}"),
            1,
        );
        let solution = solve(&Deck::parse(&text, "deck", data("")).unwrap()).unwrap();
        onset(&solution, 1, CrossingKind::Flutter).velocity
    };
    let without = onset(&run(data("section_strip.bdf")).unwrap(), 1, CrossingKind::Flutter).velocity;
    assert!(close(with("KE"), without, 1e-9));
    assert!(with("K ") > 1.01 * without, "{} {without}", with("K "));
}

#[test]
fn a_wing_of_bars_and_its_flexibility_matrix_are_one_wing() {
    let (genel, bars) = (
        run(data("jet_wing_genel.bdf")).unwrap(),
        run(data("jet_wing_bars.bdf")).unwrap(),
    );
    let (a, b) = (&genel.subcases[0].modes, &bars.subcases[0].modes);
    assert_eq!(a.count(), 8);
    for mode in 0..8 {
        assert!(close(a.omega_rad_s[mode], b.omega_rad_s[mode], 2e-7), "mode {mode}");
    }
    for kind in [CrossingKind::Flutter, CrossingKind::Divergence] {
        let (a, b) = (onset(&genel, 0, kind), onset(&bars, 0, kind));
        assert!(
            close(a.velocity, b.velocity, 1e-6),
            "{kind:?}: {} {}",
            a.velocity,
            b.velocity
        );
    }
}

#[test]
fn k_and_pk_agree_at_zero_damping() {
    // The two methods interpolate aerodynamics differently, so they agree as far as the table of k is fine.
    let solution = run(data("swept_plate.bdf")).unwrap();
    let (pk, k) = (
        onset(&solution, 0, CrossingKind::Flutter),
        onset(&solution, 1, CrossingKind::Flutter),
    );
    assert!(
        close(pk.velocity, k.velocity, 1e-4) && close(pk.freq_hz, k.freq_hz, 1e-4),
        "{pk:?} {k:?}"
    );
}

#[test]
fn matched_points_of_pknl_are_those_of_pk() {
    let text = std::fs::read_to_string(data("swept_plate.bdf")).unwrap();
    let matched = text
        .replacen("FLUTTER 30      PK ", "FLUTTER 30      PKNL", 1)
        .replacen("PKNL     ", "PKNL    ", 1)
        .replacen(
            "FLFACT  1       .967",
            "FLFACT  1       .967    .967    .967    .967    .967    .967    .967",
            1,
        )
        .replacen(
            "FLFACT  2       .45",
            "FLFACT  2       .45     .45     .45     .45     .45     .45     .45",
            1,
        );
    // The K subcase would take all combinations of the longer lists.
    let matched = matched.replacen("SUBCASE 2\n  FMETHOD = 40\n", "", 1);
    let matched = solve(&Deck::parse(&matched, "deck", data("")).unwrap()).unwrap();
    let pk = run(data("swept_plate.bdf")).unwrap();
    let (a, b) = (&matched.subcases[0].summaries[0], &pk.subcases[0].summaries[0]);
    assert_eq!(a.method, FlutterMethod::PkNl);
    for (a, b) in a.points.iter().zip(&b.points) {
        assert_eq!(a.number, b.number);
        assert_eq!(a.rows.len(), b.rows.len());
        for (a, b) in a.rows.iter().zip(&b.rows) {
            assert!(
                (a.eigenvalue - b.eigenvalue).norm() < 1e-6 * b.eigenvalue.norm(),
                "{a:?} {b:?}"
            );
        }
    }
    let crossing = a.crossings.iter().find(|c| c.direction == Direction::Onset).unwrap();
    assert!(crossing.is_interpolated);
    assert!(close(
        crossing.velocity,
        onset(&pk, 0, CrossingKind::Flutter).velocity,
        0.01
    ));
}

#[test]
fn density_and_vref_act_as_nastran_defines_them() {
    let base = run(data("swept_plate.bdf")).unwrap();
    let base = onset(&base, 0, CrossingKind::Flutter).velocity;
    // Half of the density ratio and twice the reference density are the same air.
    let text = std::fs::read_to_string(data("swept_plate.bdf")).unwrap();
    let same = text
        .replacen("FLFACT  1       .967", "FLFACT  1       .4835", 1)
        .replacen("1.1092-7", "2.2184-7", 1);
    let same = solve(&Deck::parse(&same, "deck", data("")).unwrap()).unwrap();
    assert!(close(onset(&same, 0, CrossingKind::Flutter).velocity, base, 1e-10));
    let inches = solve(&edited("swept_plate.bdf", "PARAM   VREF    12.", "PARAM   VREF    1.")).unwrap();
    assert!(close(
        onset(&inches, 0, CrossingKind::Flutter).velocity,
        12.0 * base,
        1e-12
    ));
}

#[test]
fn the_aerodynamic_system_may_lie_anywhere() {
    // The whole model turned by 180 degrees about z and moved: flow along basic -x, described by ACSID.
    let base = run(data("jet_wing_bars.bdf")).unwrap();
    let deck = std::fs::read_to_string(data("jet_wing_bars.bdf")).unwrap();
    let mut text = String::new();
    for line in deck.lines() {
        // Points and masses in system 9, which is turned; everything else as it was.
        if let Some(rest) = line.strip_prefix("GRID    ") {
            text += &format!("GRID    {}9       {}\n", &rest[..8], rest.get(16..).unwrap_or(""));
        } else if line.starts_with("CORD2R  5") {
            text += "CORD2R  5       9       -.4     0.      0.      -.4     0.      1.\n";
        } else if line.starts_with("SPLINE2") {
            text += &format!("{}\n", line.replace("1.0     0", "1.0     9"));
        } else if line.starts_with("CONM2") {
            text += &format!("CONM2   {}9{}\n", &line[8..24], line.get(25..).unwrap_or(""));
        } else if line == "ENDDATA" {
            text += "CORD2R  9               7.      -2.     3.      7.      -2.     4.\n        6.      -2.     3.\nENDDATA\n";
        } else {
            text += &format!("{line}\n");
        }
    }
    let turned = solve(&Deck::parse(&text, "turned", data("")).unwrap()).unwrap();
    for kind in [CrossingKind::Flutter, CrossingKind::Divergence] {
        let (a, b) = (onset(&turned, 0, kind).velocity, onset(&base, 0, kind).velocity);
        assert!(close(a, b, 1e-6), "{kind:?}: {a} {b}");
    }
}

#[test]
fn modes_of_a_file_give_the_same_flutter_point() {
    let own = run(data("swept_plate.bdf")).unwrap();
    let modes = &own.subcases[0].modes;
    let table = ModeTable {
        eigenvalues: (0..modes.count())
            .map(|m| Eigenvalue {
                mode: m + 1,
                eigenvalue: modes.omega_rad_s[m].powi(2),
                freq_hz: modes.freq_hz(m),
                generalized_mass: Some(modes.generalized_mass[m]),
            })
            .collect(),
        points: modes.nodes.iter().map(|n| n.id).collect(),
        shapes: modes.shapes.clone(),
    };
    // A deck with solid elements, which only its modes stand for.
    let text = std::fs::read_to_string(data("swept_plate.bdf")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("solid.bdf");
    std::fs::write(
        &path,
        text.replacen("ENDDATA", "CHEXA,900,1,1,2,3,4,5,6\n,7,8\nENDDATA", 1),
    )
    .unwrap();
    assert!(Deck::read(&path).is_err());
    let deck = Deck::read_without_structure(&path).unwrap();
    let read = solve_with_modes(&deck, &table).unwrap();
    let (a, b) = (
        onset(&read, 0, CrossingKind::Flutter),
        onset(&own, 0, CrossingKind::Flutter),
    );
    assert!(close(a.velocity, b.velocity, 1e-9) && close(a.freq_hz, b.freq_hz, 1e-9));
}

#[test]
fn a_laminate_of_one_material_is_a_plate() {
    let own = run(data("swept_plate.bdf")).unwrap();
    let text = std::fs::read_to_string(data("swept_plate.bdf")).unwrap();
    // The middle elements as four plies of the same aluminium, 0.041 thick in all, turned at random: isotropic all the same.
    let mut laminated = String::new();
    for line in text.lines() {
        let number = line.get(8..16).and_then(|n| n.trim().parse::<u32>().ok()).unwrap_or(0);
        if line.starts_with("CQUAD4") && (8..=21).contains(&number) {
            laminated += &format!("{}2       {}\n", &line[..16], &line[24..]);
        } else if line == "ENDDATA" {
            laminated += "PCOMP,2,,,,,,,SYM\n,1,.01,0.,,1,.0105,30.\nENDDATA\n";
        } else {
            laminated += &format!("{line}\n");
        }
    }
    let laminated = solve(&Deck::parse(&laminated, "deck", data("")).unwrap()).unwrap();
    for mode in 0..4 {
        let (a, b) = (
            laminated.subcases[0].modes.omega_rad_s[mode],
            own.subcases[0].modes.omega_rad_s[mode],
        );
        // The shear stiffness of laminate and plate is defined differently, and G is not E / (2 (1 + nu)) to all digits.
        assert!(close(a, b, 2e-3), "{mode}: {a} {b}");
    }
}

#[test]
fn structural_damping_delays_flutter_in_both_forms() {
    let speed = |kdamp: &str, g: &str| {
        let text = std::fs::read_to_string(data("swept_plate.bdf")).unwrap();
        let text = text
            .replacen("PARAM   KDAMP   1", &format!("PARAM   KDAMP   {kdamp}"), 1)
            .replacen(
                "0.      0.      1000.0  0.      ENDT",
                &format!("0.      {g}     1000.0  {g}     ENDT"),
                1,
            );
        let solution = solve(&Deck::parse(&text, "deck", data("")).unwrap()).unwrap();
        (0..2)
            .map(|s| onset(&solution, s, CrossingKind::Flutter).velocity)
            .collect::<Vec<_>>()
    };
    let none = speed("1", "0. ");
    for kdamp in ["1", "-1"] {
        let damped = speed(kdamp, ".03");
        for (d, n) in damped.iter().zip(&none) {
            assert!(*d > 1.002 * n && *d < 1.05 * n, "{kdamp}: {damped:?} {none:?}");
        }
    }
}

#[test]
fn the_summary_has_the_columns_of_a_print_file() {
    let text = run(data("swept_plate.bdf")).unwrap().text();
    let line = text.lines().find(|l| l.contains("POINT =    2")).unwrap();
    assert_eq!(
        line,
        "       POINT =    2     MACH NUMBER =  0.4500     DENSITY RATIO =  9.6700E-01     METHOD = PK"
    );
    let header = "       KFREQ            1./KFREQ         VELOCITY            DAMPING         FREQUENCY            COMPLEX   EIGENVALUE";
    let mut lines = text.lines().skip_while(|l| *l != header);
    let row = lines.nth(1).unwrap();
    assert_eq!(row.len(), 14 + 20 + 5 * 18);
    assert_eq!(row.split_whitespace().count(), 7);
}

#[test]
fn what_does_not_fit_is_said_with_its_place() {
    let fails = |from: &str, to: &str, parts: &[&str]| {
        let error = match solve(&edited("swept_plate.bdf", from, to)) {
            Err(error) => error.to_string(),
            Ok(_) => panic!("{to} was accepted"),
        };
        for part in parts {
            assert!(error.contains(part), "{error} | {part}");
        }
    };
    fails(
        "SET1    100     2 ",
        "SET1    100     99",
        &["swept_plate.bdf:", "SET1 100", "GRID 99"],
    );
    fails(
        "SPLINE1 100     101     101     124",
        "SPLINE1 100     101     101     125",
        &["SPLINE1 100", "box 125"],
    );
    fails("PSHELL  1       1 ", "PSHELL  1       8 ", &["PSHELL 1", "8"]);
    fails("SPC = 1", "SPC = 7", &["SPC = 7", "SPC1"]);
    fails("FLFACT  2       .45", "FLFACT  2       -.45", &["FLFACT 2", "-0.45"]);
    fails("METHOD = 10", "METHOD = 11", &["METHOD = 11", "EIGR"]);
    fails("FMETHOD = 30", "FMETHOD = 31", &["FMETHOD = 31", "FLUTTER"]);
    fails("MKAERO1 .45", "MKAERO1 1.45", &["1.45"]);
    fails(
        "CQUAD4  8       1       9       10",
        "CQUAD4  8       1       9       77",
        &["CQUAD4 8", "GRID 77"],
    );
    fails(
        "CAERO1  101     1       0",
        "CAERO1  101     1       3",
        &["CAERO1 101", "coordinate system 3"],
    );
    let text = std::fs::read_to_string(data("swept_plate.bdf")).unwrap();
    let text: String = text
        .lines()
        .filter(|l| !l.starts_with("AERO "))
        .map(|l| format!("{l}\n"))
        .collect();
    let missing = Deck::parse(&text, "deck", data("")).unwrap();
    assert!(matches!(solve(&missing), Err(SolveError::Missing { .. })));
}

#[test]
fn residual_vectors_follow_the_modes_where_the_deck_asks() {
    let name = "jet_wing_bars.bdf";
    let plain = run(data(name)).unwrap();
    let computed = plain.subcases[0].modes.count();
    let more = format!("LMODES  {}", computed + 1);
    let added = solve(&edited(name, "LMODES  6", &more)).unwrap();
    let modes = &added.subcases[0].modes;
    assert!(modes.count() > computed);
    assert_eq!(added.subcases[0].used_modes, computed + 1);
    for mode in 0..computed {
        assert!(close(modes.freq_hz(mode), plain.subcases[0].modes.freq_hz(mode), 1e-12));
    }
    assert!(added.notes.iter().any(|n| n.text.contains("residual vectors")));
    let text = std::fs::read_to_string(data(name))
        .unwrap()
        .replacen("LMODES  6", &more, 1);
    let without = text.replacen("CEND\n", "CEND\nRESVEC = NO\n", 1);
    assert_ne!(text, without);
    let without = solve(&Deck::parse(&without, name, data("")).unwrap()).unwrap();
    assert_eq!(without.subcases[0].modes.count(), computed);
}
