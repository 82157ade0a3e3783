//! The published cases: AGARD 445.6 wing, cantilever plates, orthotropic plate; data under tests/data/structural.
#![allow(dead_code, reason = "every user takes a part of these")]

use std::path::PathBuf;

use dip_modal::{
    DofSet, MassForm, Material, MaterialAxis, Model, Modes, Node, Ordinates, Planform, PlateWing, RootClamp, Shell,
    ShellNodes, ShellSection, ShellThickness, TableOptions, ThicknessRule,
};
use nalgebra::Vector3;

/// Yates' generalized mass, 1 lbf s^2/in, kg.
pub const YATES_MASS_KG: f64 = 175.127;

pub fn data(name: &str) -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/data/structural")
        .join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Lines of a table without comments and header, split at commas.
pub fn rows(text: &str) -> Vec<Vec<String>> {
    text.lines()
        .filter(|l| !l.starts_with('#') && !l.trim().is_empty())
        .skip(1)
        .map(|l| l.split(',').map(|f| f.trim().to_owned()).collect())
        .collect()
}

/// Frequencies of one source in `agard_frequencies.csv`, Hz.
pub fn agard_frequencies(source: &str) -> Vec<f64> {
    let rows = rows(&data("agard_frequencies.csv"));
    let row = rows
        .iter()
        .find(|r| r[0] == source)
        .expect("the source is in the table");
    row[1..].iter().filter_map(|f| f.parse().ok()).collect()
}

/// NACA 65A004 from one of the sets `R765`, `TN3047`.
pub fn naca65a004(set: &str) -> Ordinates {
    let points: Vec<[f64; 2]> = rows(&data("naca65a004.csv"))
        .iter()
        .filter(|r| r[0] == set)
        .map(|r| [r[1].parse().unwrap(), r[2].parse().unwrap()])
        .collect();
    Ordinates::symmetric(&points).unwrap()
}

/// Laminated mahogany of the weakened model 3.
pub fn mahogany() -> Material {
    Material::orthotropic(3.1511e9, 0.4162e9, 0.31, 0.4392e9, 381.98)
}

/// Direction of the grain, along the 45 degree quarter-chord line.
pub fn grain() -> Vector3<f64> {
    Vector3::new(1.0, 1.0, 0.0).normalize()
}

/// The wing with all root nodes clamped.
pub fn agard_wing(set: &str, chordwise: usize, spanwise: usize, rule: ThicknessRule) -> PlateWing {
    PlateWing {
        planform: Planform {
            root_leading: Vector3::zeros(),
            root_trailing: Vector3::new(0.5587, 0.0, 0.0),
            tip_leading: Vector3::new(0.8094, 0.762, 0.0),
            tip_trailing: Vector3::new(0.8094 + 0.3682, 0.762, 0.0),
        },
        chordwise_nodes: chordwise,
        spanwise_nodes: spanwise,
        section: naca65a004(set),
        rule,
        material: mahogany(),
        axis: grain(),
        root: RootClamp::All,
    }
}

/// Yates' table of modes, metres.
pub fn yates() -> Modes {
    let mut omega: Vec<f64> = agard_frequencies("yates")
        .iter()
        .map(|f| f * std::f64::consts::TAU)
        .collect();
    // The table has a sixth shape whose frequency is not published with it.
    omega.push(0.0);
    let options = TableOptions {
        length_unit_m: None,
        omega_rad_s: omega,
        generalized_mass_kg: vec![YATES_MASS_KG; 6],
    };
    Modes::from_csv(&data("agard_yates_modes.csv"), &options).unwrap()
}

/// A plate on Yates' own 11 x 11 nodes with his root condition: nodes 3 to 9 of the root fixed. The thickness
/// is that of the nodes, inside the elements or as their mean.
pub fn yates_model(set: &str, rule: ThicknessRule, form: MassForm) -> Model {
    let table = yates();
    let section = naca65a004(set);
    let mut model = Model {
        shell_sections: vec![ShellSection::thin_plate(1, mahogany(), 0.0)],
        ..Model::default()
    };
    model.settings.mass = form;
    for n in &table.nodes {
        model.nodes.push(Node::grid(n.id, n.position.x, n.position.y, 0.0));
    }
    let thickness = |i: usize, j: usize| {
        let x = |i: usize| table.nodes[i + 11 * j].position.x;
        let chord = x(10) - x(0);
        section.thickness((x(i) - x(0)) / chord) * chord
    };
    for j in 0..10 {
        for i in 0..10 {
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            let nodal = corners.map(|(a, b)| thickness(a, b));
            model.shells.push(Shell {
                id: (1 + i + 10 * j) as u32,
                nodes: ShellNodes::Quad(corners.map(|(a, b)| (1 + a + 11 * b) as u32)),
                section: 0,
                thickness: match rule {
                    ThicknessRule::ElementMean => ShellThickness::Uniform(nodal.iter().sum::<f64>() / 4.0),
                    _ => ShellThickness::Corner(nodal),
                },
                axis: MaterialAxis::Along(grain()),
                offset: 0.0,
            });
        }
    }
    model.supports = (3..=9).map(|n| (n, DofSet::ALL)).collect();
    model
}
