//! Decks and mode files with known contents: every format, every way to go wrong that users meet, and nonsense.

mod mode_files;

use std::{fs, path::Path};

use dip_nastran::{
    Components, Deck, DeckErrors, Dof, Severity,
    cards::{
        aero::Division,
        control::{FlutterMethod, MachK, Normalization},
        element::{MaterialDirection, Orientation, ScalarValue},
        material::ElasticLaw,
        spline::SplineBoxes,
    },
};
use proptest::prelude::*;

fn bulk(text: &str) -> Result<Deck, DeckErrors> {
    Deck::parse(text, "deck.bdf", ".")
}

fn good(text: &str) -> Deck {
    bulk(text).unwrap_or_else(|e| panic!("{e}"))
}

fn bad(text: &str) -> String {
    match bulk(text) {
        Err(errors) => errors.to_string(),
        Ok(_) => panic!("accepted: {text}"),
    }
}

#[test]
fn structural_cards_are_read_as_their_manuals_say() {
    let deck = good(
        "GRDSET          3                               4       26\n\
         GRID    7               1.      2.      3.-1\n\
         GRID*   8                               1.5D+1          -2.5+1\n\
         *       0.              0               1\n\
         CBAR    1       9       7       8       0.      0.      1.0     1\n\
         BAROR                                   1.      0.      0.\n\
         CBAR,2,,7,8,8\n\
         CBAR,3,9,7,8,,,,BGG,,,4,,,,.1,.2,.3\n\
         PBAR    9       5       2.      3.      4.      5.      6.\n\
         \n\
         +       .1\n\
         +       .8      .9      .05\n\
         MAT1    5       7.+10           .3      2700.\n\
         MAT8,6,1.+11,1.+10,.3,5.+9\n\
         CQUAD4  11      12      1       2       3       4       30.     .01\n\
         +                       .1      .2      .3\n\
         CTRIA3,13,12,1,2,3,9\n\
         CELAS2  103     134.47  100     3       102     3\n\
         CELAS1  104     55      100     5\n\
         PELAS   55      10.                     56      20.\n\
         CONM2   1       7               10.     .1      .2      .3\n\
         +       1.      .1      2.      .2      .3      3.\n\
         CONM1   110     100                                                     +A\n\
         +A      1.3447                                                  0.24205 +B\n\
         +B              3.0256\n",
    );
    let b = &deck.bulk;
    assert_eq!(
        (b.grids[&7].cp, b.grids[&7].cd, b.grids[&7].ps),
        (3, 4, Components(0b10_0010))
    );
    assert_eq!(b.grids[&7].position, [1.0, 2.0, 0.3]);
    assert_eq!(b.grids[&8].position, [15.0, -25.0, 0.0]);
    assert_eq!((b.grids[&8].cd, b.grids[&8].ps), (0, Components(1)));
    assert_eq!(b.bars[&1].orientation, Orientation::Vector([0.0, 0.0, 1.0]));
    assert_eq!((b.bars[&2].property, b.bars[&2].orientation), (2, Orientation::Grid(8)));
    assert_eq!(
        (b.bars[&3].pins[1], b.bars[&3].offsets[1]),
        (Components(0b1000), [0.1, 0.2, 0.3])
    );
    let section = &b.bar_sections[&9];
    assert_eq!((section.i2, section.torsion_constant, section.i12), (4.0, 5.0, 0.05));
    assert_eq!(section.shear_factors, [Some(0.8), Some(0.9)]);
    match b.materials[&5].law {
        ElasticLaw::Isotropic { g, .. } => assert!((g - 7.0e10 / 2.6).abs() < 1.0),
        other => panic!("{other:?}"),
    }
    assert_eq!(b.shells[&11].thickness, [Some(0.1), Some(0.2), Some(0.3), None]);
    assert_eq!(b.shells[&11].material_direction, MaterialDirection::Angle(30.0));
    assert_eq!(b.shells[&13].material_direction, MaterialDirection::Coordinate(9));
    assert_eq!(
        b.springs[&103].ends[1],
        Some(Dof {
            point: 102,
            component: 2
        })
    );
    assert_eq!(b.springs[&104].value, ScalarValue::Property(55));
    assert_eq!(b.spring_values[&56].value, 20.0);
    assert_eq!(b.point_masses[&1].inertia, [1.0, 0.1, 2.0, 0.2, 0.3, 3.0]);
    let matrix = b.mass_matrices[&110].matrix;
    assert_eq!(
        (matrix[2][2], matrix[4][2], matrix[2][4], matrix[4][4]),
        (1.3447, 0.24205, 0.24205, 3.0256)
    );
}

#[test]
fn a_thickness_field_is_not_shifted_by_its_flag() {
    let deck = good("CQUAD4,1,1,1,2,3,4\n,,,0.,0.,.041,.041\n");
    assert_eq!(
        deck.bulk.shells[&1].thickness,
        [Some(0.0), Some(0.0), Some(0.041), Some(0.041)]
    );
}

#[test]
fn a_general_element_is_read_column_by_column() {
    let deck = good(
        "GENEL   432             1       3       2       3\n\
         +       UD              11      3       11      4\n\
         +       Z       1.      2.      4.\n\
         +       S       1.      90.     1.      45.\n",
    );
    let genel = &deck.bulk.genels[&432];
    assert_eq!(genel.matrix, [1.0, 2.0, 2.0, 4.0]);
    assert_eq!(genel.rigid, [1.0, 90.0, 1.0, 45.0]);
    assert_eq!(
        genel.support[1],
        Dof {
            point: 11,
            component: 3
        }
    );
    assert!(
        bad("GENEL   432             1       3       2       3\n+       Z       1.      2.\n")
            .contains("needs 3 values, got 2")
    );
}

#[test]
fn aerodynamic_and_flutter_cards_are_read() {
    let deck = good(
        "AERO    0               2.0706  1.145-7 1\n\
         CAERO1  101     1       1               4       77              1       +CA101\n\
         +CA101  -1.0    -.26795 .0      2.0706  -1.     5.45205 0.0     2.0706\n\
         AEFACT,77,0.,.3,1.\n\
         SPLINE2 100     101     101     124     100     .0      1.0     1       +SP\n\
         +SP     -1.     .5\n\
         SET1    100     1       THRU    11      BY      5       20\n\
         MKAERO1 .45     .6                                                      +MK\n\
         +MK     .001    0.1\n\
         MKAERO2,.45,.1,.45,.3\n\
         FLUTTER 30      PK      1       2       3       L       3       1.-4\n\
         FLFACT  3       30.     THRU    450.    8\n\
         FLFACT  4       10.     THRU    20.     3       12.\n\
         TABDMP1 7       CRIT\n\
         +       0.      .01     10.     .02     10.     .04     20.     .04\n\
         +       ENDT\n\
         EIGR    10      MGIV                            10\n\
         +       POINT   7       3\n",
    );
    let b = &deck.bulk;
    let panel = &b.panels[&101];
    assert_eq!(
        (panel.spanwise, panel.chordwise),
        (Division::List(77), Division::Equal(4))
    );
    let spline = &b.beam_splines[&100];
    assert_eq!(
        (spline.dthx, spline.dthy, spline.boxes),
        (-1.0, 0.5, SplineBoxes::Range(101, 124))
    );
    assert_eq!(b.point_sets[&100].ids, [1, 6, 11, 20]);
    let pairs: Vec<(f64, f64)> = b.mach_k.iter().map(|MachK { mach, k }| (*mach, *k)).collect();
    assert_eq!(
        pairs,
        [(0.45, 0.001), (0.45, 0.1), (0.6, 0.001), (0.6, 0.1), (0.45, 0.3)]
    );
    let flutter = &b.flutters[&30];
    assert_eq!(
        (flutter.method, flutter.roots, flutter.epsilon),
        (FlutterMethod::Pk, Some(3), 1e-4)
    );
    assert_eq!(
        b.factors[&3].values,
        [30.0, 90.0, 150.0, 210.0, 270.0, 330.0, 390.0, 450.0]
    );
    // Three values with the middle one given.
    assert_eq!(b.factors[&4].values, [10.0, 12.0, 20.0]);
    let table = &b.damping_tables[&7];
    for (freq_hz, g) in [(5.0, 0.03), (10.0, 0.06), (15.0, 0.08), (30.0, 0.08), (-10.0, 0.0)] {
        assert!((table.structural_damping(freq_hz) - g).abs() < 1e-14, "{freq_hz}");
    }
    assert_eq!(
        b.modes_requests[&10].normalization,
        Normalization::Point(Dof { point: 7, component: 2 })
    );
}

#[test]
fn constraints_and_sets_are_read() {
    let deck = good(
        "SPC1,1,12345,9,THRU,11\nSPC,1,20,3,0.,21,3\nSPCADD,5,1,2\n\
         MPC     3       1       3       1.      2       3       -.5\n                3       3       -.5\n\
         RBE2,9,1,123456,2,3\nRBAR,10,1,2,123456\n\
         RBE3,11,,5,123,1.,123,1,2\n,3,2.,12,4\nASET1,3,1,THRU,8\nSUPORT,11,35\n\
         DMIG,KX,0,6,1,0\nDMIG,KX,1,3,,1,3,5.\n,2,3,-5.\n",
    );
    let b = &deck.bulk;
    assert_eq!(b.constraints[&1].len(), 3);
    assert_eq!(b.equations[&3][0].terms.len(), 3);
    assert_eq!(b.rigid_bodies[&9].dependent, [2, 3]);
    assert_eq!(b.rigid_bars[&10].dependent, [Components::NONE, Components::ALL]);
    assert_eq!(b.interpolations[&11].groups.len(), 2);
    assert_eq!(b.interpolations[&11].groups[0].2, [1, 2, 3]);
    assert_eq!(b.supports[0].components, Components(0b1_0100));
    assert_eq!(b.dof_matrices["KX"].terms.len(), 2);
}

#[test]
fn errors_name_file_line_card_field_needed_and_got() {
    for (deck, parts) in [
        (
            "GRID,1,,1.\nGRID,2,,1x.\n",
            vec!["deck.bdf:2", "GRID", "field 4", "X", "a real number", "\"1X.\""],
        ),
        (
            "GRID,1.5\n",
            vec![
                "deck.bdf:1",
                "field 2 (ID)",
                "an integer",
                "\"1.5\"",
                "without decimal point",
            ],
        ),
        (
            "PBAR,1\n",
            vec!["PBAR", "field 3 (MID)", "a positive integer", "a blank field"],
        ),
        ("CONM2,1,7,,10.\n,1.,x\n", vec!["deck.bdf:2", "CONM2", "field 3 (I21)"]),
        (
            "GRID,1\nGRID,2\nGRID,1\n",
            vec!["deck.bdf:3", "GRID 1", "twice", "deck.bdf:1"],
        ),
        ("SPC1,1,17,3\n", vec!["SPC1", "digits 1 to 6", "\"17\""]),
        (
            "FLUTTER,1,QK,1,2,3\n",
            vec!["FLUTTER", "METHOD", "K, KE, PK or PKNL", "\"QK\""],
        ),
        ("CBUSH,1,2,3,4\n", vec!["CBUSH", "not supported", "CELAS"]),
        ("CQAUD4,1,1,1,2,3,4\n", vec!["CQAUD4", "did you mean CQUAD4"]),
        ("XYZZY,1\n", vec!["deck.bdf:1", "XYZZY", "no such card"]),
        ("CAERO2,1,2\n", vec!["CAERO2", "not supported", "bodies"]),
        ("TABDMP1,1\n,0.,.1,1.,.1\n", vec!["TABDMP1", "ENDT"]),
        ("SET1,1,THRU,5\n", vec!["SET1", "before THRU"]),
        ("FLFACT,1,2.,THRU,4.,1\n", vec!["FLFACT", "NF"]),
        ("AERO,0,,-1.,1.\n", vec!["AERO", "REFC", "positive"]),
        ("RBAR,1,2,3,12345\n", vec!["RBAR", "six independent"]),
        ("DMIG,KX,1,3,,1,3,5.\n", vec!["DMIG", "no header"]),
    ] {
        let message = bad(deck);
        for part in parts {
            assert!(message.contains(part), "{deck:?}: {message} | {part}");
        }
    }
}

#[test]
fn all_errors_come_at_once_in_order() {
    let message = bad("GRID,x\nGRID,2\nPBAR,y,1\n");
    let lines: Vec<&str> = message.lines().collect();
    assert!(
        lines.len() == 2 && lines[0].starts_with("deck.bdf:1") && lines[1].starts_with("deck.bdf:3"),
        "{message}"
    );
}

#[test]
fn nothing_is_dropped_without_a_word() {
    let deck = good(
        "SOL 145\nCEND\nFOOBAR = 3\nPARAM,GRDPNT,0\nBEGIN BULK\nGUST,1\nPARAM,POST,-1\nPARAM,VREF,12\nDAREA,1\nENDDATA\n",
    );
    let words: Vec<(usize, &str, Severity)> = deck
        .notes
        .iter()
        .map(|n| (n.at.line, n.card.as_str(), n.severity))
        .collect();
    assert_eq!(
        words,
        [
            (3, "FOOBAR", Severity::Warning),
            (6, "GUST", Severity::Ignored),
            (7, "PARAM", Severity::Ignored),
            (9, "DAREA", Severity::Ignored),
            (4, "PARAM", Severity::Ignored)
        ]
    );
    // An integer where Nastran wants a real is read, and said.
    let deck = good("GRID,1,,1\n");
    assert_eq!(deck.bulk.grids[&1].position[0], 1.0);
    assert_eq!(deck.notes[0].severity, Severity::Warning);
}

#[test]
fn fixed_fields_may_run_into_each_other() {
    let deck = good("PARAM   COUPMASS1\nMAT1    1       9.2418+63.4993+6        .097464\nPARAM   GUSTAERO-1\n");
    assert_eq!(deck.bulk.parameters["COUPMASS"].integer(), Ok(1));
    assert_eq!(deck.bulk.materials[&1].density, 0.097464);
}

#[test]
fn includes_nest_relative_to_their_file() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, text).unwrap();
        path
    };
    let deck = write(
        "top.bdf",
        "SOL 145\r\nCEND\r\nINCLUDE 'control.inc'\r\nBEGIN BULK\r\ninclude \"parts/\n   wing.inc\"\r\nINCLUDE 'TPLDIR:Mass.dat'\r\nENDDATA\r\n",
    );
    write("control.inc", "METHOD = 7\n");
    write(
        "parts/wing.inc",
        "GRID,1\nINCLUDE 'tail.inc' $ beside this file\nGRID,3\n",
    );
    write("parts/tail.inc", "GRID,2\n");
    write("mass.dat", "CONM2,1,1,,2.\n");
    let read = Deck::read(&deck).unwrap();
    assert_eq!(read.bulk.grids.keys().copied().collect::<Vec<_>>(), [1, 2, 3]);
    assert!(read.bulk.grids[&2].at.to_string().ends_with("tail.inc:1"));
    assert_eq!(read.bulk.point_masses.len(), 1);
    assert_eq!(read.control.subcases[0].set("METHOD"), Ok(Some(7)));

    let circle = write("circle.bdf", "INCLUDE 'a.inc'\n");
    write("a.inc", "$\nINCLUDE 'circle.bdf'\n");
    let message = Deck::read(&circle).unwrap_err().to_string();
    assert!(
        message.contains("a.inc:2") && message.contains("includes itself"),
        "{message}"
    );
    let gone = write("gone.bdf", "GRID,1\nINCLUDE 'nowhere.inc'\n");
    let message = Deck::read(&gone).unwrap_err().to_string();
    assert!(
        message.contains("gone.bdf:2") && message.contains("nowhere.inc"),
        "{message}"
    );
    let open = write("open.bdf", "INCLUDE 'never\n");
    assert!(Deck::read(&open).unwrap_err().to_string().contains("never closed"));
    assert!(
        Deck::read(folder.path().join("none.bdf"))
            .unwrap_err()
            .to_string()
            .contains("none.bdf")
    );
}

/// The deck of others that the project keeps beside it; read in place.
#[test]
fn a_deck_of_others_is_read_whole() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/refdata/decks/swept15_ke.bdf");
    if !path.is_file() {
        eprintln!("skipped: {} is not here", path.display());
        return;
    }
    let deck = Deck::read(&path).unwrap();
    let b = &deck.bulk;
    assert_eq!(
        (b.grids.len(), b.bars.len(), b.scalar_masses.len(), b.panels.len()),
        (11, 10, 10, 1)
    );
    assert_eq!(b.factors[&3].values.len(), 9);
    assert_eq!(deck.control.subcases[0].set("FMETHOD"), Ok(Some(30)));
    assert!(deck.notes.iter().all(|n| n.severity == Severity::Ignored));
}

const CARDS: &[&str] = &[
    "GRID", "CORD2R", "CBAR", "PBAR", "PBARL", "PBEAM", "CQUAD4", "CTRIA3", "PSHELL", "MAT1", "MAT2", "MAT8", "CONM1",
    "CONM2", "GENEL", "DMI", "DMIG", "RBE2", "RBE3", "RBAR", "MPC", "SPC", "SPC1", "ASET1", "SUPORT", "EIGR", "EIGRL",
    "AERO", "CAERO1", "CAERO4", "PAERO4", "AEFACT", "SET1", "SPLINE1", "SPLINE2", "MKAERO1", "MKAERO2", "FLUTTER",
    "FLFACT", "TABDMP1", "PARAM", "CELAS1", "CELAS2", "PELAS", "CMASS2", "CDAMP2", "AESURF", "CROD", "CONROD",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn text_of_any_kind_is_read_or_refused(text in "\\PC{0,400}") {
        let _ = bulk(&text);
    }

    #[test]
    fn lines_of_nonsense_fields_are_read_or_refused(
        lines in prop::collection::vec(
            (0..CARDS.len(), prop::collection::vec("[-+0-9.eED*=THRU$ ]{0,9}", 0..20), prop::bool::ANY, "[+* ]?[A-Z0-9]{0,3}"), 1..12)
    ) {
        let mut text = String::new();
        for (card, fields, free, marker) in &lines {
            if *free {
                text += &format!("{},{}\n{marker},{}\n", CARDS[*card], fields.join(","), fields.join(","));
            } else {
                let fixed: String = fields.iter().take(8).map(|f| format!("{f:<8.8}")).collect();
                text += &format!("{:<8}{fixed:<64}{marker}\n{marker:<8}{fixed}\n", CARDS[*card]);
            }
        }
        let _ = bulk(&text);
    }

    #[test]
    fn reals_survive_every_format(value in prop::num::f64::NORMAL.prop_filter("a size that sixteen columns hold", |x| (1e-99..1e99).contains(&x.abs()))) {
        let text = format!("{value:.7e}");
        let expected: f64 = text.parse().unwrap();
        let nastran = text.replace('e', if text.contains("e-") { "" } else { "+" });
        let deck = good(&format!("GRID*   1                               {nastran}\nGRID,2,,{nastran}\n"));
        prop_assert_eq!(deck.bulk.grids[&1].position[0], expected);
        prop_assert_eq!(deck.bulk.grids[&2].position[0], expected);
    }
}
