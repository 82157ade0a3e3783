//! From a structure file to a finite element model and its modes.

use super::modes::Structure;
use crate::exit::Stop;
use crate::stamp::Fingerprint;
use dip_case::file::{Clamp, ClampSpec, MassModel, Normalization, StructureFile, ThicknessRule};
use dip_case::wing::{Section, Wing};
use dip_case::{CaseError, Document};
use dip_modal::{
    Dof, Elasticity, MassForm, Material, Model, ModesRequest, NodeDof, NodeMass, Ordinates, Planform, PlateWing,
    RootClamp, ScalarElement, Shell, ShellThickness,
};
use nalgebra::{Matrix3, Vector3};
use std::collections::HashMap;

/// Adds what the modes of a structure depend on.
pub fn fingerprint(document: &Document, fingerprint: &mut Fingerprint) {
    fingerprint.document(document);
    if let Ok(file) = document.load::<StructureFile>() {
        let wing = document.path(&file.wing);
        if let Ok(wing) = Document::read(&wing, &[])
            && let Ok(file) = wing.load::<dip_case::file::WingFile>()
        {
            for airfoil in file.section.iter().filter_map(|s| s.airfoil.as_ref()) {
                fingerprint.file(wing.path(airfoil));
            }
        }
        fingerprint.file(wing);
    }
}

/// Modes of a structure.
///
/// # Errors
/// What is wrong in the file, what the finite elements refuse, a mechanism.
pub fn modes(document: &Document) -> Result<Structure, Stop> {
    let file: StructureFile = document.load()?;
    if file.modes.count == 0 {
        return Err(document.error("modes.count", "no modes", "needed one or more").into());
    }
    let wing = Wing::read(&Document::read(&document.path(&file.wing), &[])?)?;
    let model = model(document, &file, &wing)?;
    let refused =
        |e: &dyn std::fmt::Display| document.error("plate", e.to_string(), "check plate, material and support");
    let system = model.assemble().map_err(|e| refused(&e))?;
    let mass_kg = system.mass_properties().mass;
    let modes = system
        .modes(&ModesRequest::lowest(file.modes.count))
        .map_err(|e| refused(&e))?;
    let free = file.support.root == Clamp::Spec(ClampSpec::Free) && file.spring.is_empty();
    let stiffest = modes.omega_rad_s.iter().copied().fold(0.0, f64::max);
    if let Some(m) = modes
        .omega_rad_s
        .iter()
        .position(|w| *w <= 1e-6 * stiffest)
        .filter(|_| !free)
    {
        let message = format!("the structure is a mechanism: mode {} has no stiffness (0 Hz)", m + 1);
        let help = "hold more root nodes, add springs, or say root = \"free\" without springs for a free wing";
        return Err(document.error("support", message, help).into());
    }
    if modes.count() < file.modes.count {
        let message = format!("{} modes asked for, the model has {}", file.modes.count, modes.count());
        return Err(document
            .error("modes.count", message, "ask for fewer, or refine the mesh")
            .into());
    }
    let place: HashMap<u32, usize> = modes.nodes.iter().enumerate().map(|(i, n)| (n.id, i)).collect();
    let elements = model.shells.iter().map(|s| {
        s.nodes
            .as_slice()
            .iter()
            .filter_map(|n| place.get(n).copied())
            .collect()
    });
    let elements: Vec<Vec<usize>> = elements.collect();
    let max_scale = file.modes.normalization == Normalization::Max;
    Ok(Structure {
        modes,
        mass_kg: Some(mass_kg),
        elements,
        max_scale,
    })
}

/// The finite element model.
fn model(document: &Document, file: &StructureFile, wing: &Wing) -> Result<Model, CaseError> {
    let plate = &file.plate;
    for (key, n) in [
        ("nodes_chordwise", plate.nodes_chordwise),
        ("nodes_spanwise", plate.nodes_spanwise),
    ] {
        if !(2..=2000).contains(&n) {
            let message = format!("{n} nodes: needed 2 to 2000");
            return Err(document.error(
                &format!("plate.{key}"),
                message,
                "11 along the chord and 21 along the span suit a wing",
            ));
        }
    }
    let rule = match (plate.thickness, plate.constant_thickness) {
        (Some(ThicknessRule::Nodal), _) => dip_modal::ThicknessRule::Nodal,
        // A slab is the same by all rules.
        (Some(ThicknessRule::ElementMean), _) | (None, Some(_)) => dip_modal::ThicknessRule::ElementMean,
        (Some(ThicknessRule::ExactSection), _) => dip_modal::ThicknessRule::ExactSection,
        (None, None) => {
            let help = "add thickness = \"element-mean\" (that of the section), or constant_thickness = \"2 mm\"";
            return Err(document.error("plate", "neither `thickness` nor `constant_thickness`", help));
        }
    };
    let material = material(document, file)?;
    let span = |a: &Section, b: &Section| {
        (b.leading_edge_m[1] - a.leading_edge_m[1]).hypot(b.leading_edge_m[2] - a.leading_edge_m[2])
    };
    let total: f64 = wing.sections.windows(2).map(|w| span(&w[0], &w[1])).sum();
    let mut all = Model::default();
    // Nodes are numbered along the chord first: a panel's first row of nodes is the last row of the panel before.
    let mut rows = 0;
    for (i, pair) in wing.sections.windows(2).enumerate() {
        let (a, b) = (&pair[0], &pair[1]);
        let rows_here = (((plate.nodes_spanwise - 1) as f64 * span(a, b) / total).round() as usize).max(1);
        let panel = PlateWing {
            planform: Planform {
                root_leading: a.point(0.0).into(),
                root_trailing: a.point(1.0).into(),
                tip_leading: b.point(0.0).into(),
                tip_trailing: b.point(1.0).into(),
            },
            chordwise_nodes: plate.nodes_chordwise,
            spanwise_nodes: rows_here + 1,
            section: ordinates(document, file, i, a, b)?,
            rule,
            material: material.clone(),
            axis: axis(file, a, b),
            root: match &file.support.root {
                Clamp::Spec(ClampSpec::Clamped) => RootClamp::All,
                Clamp::Spec(ClampSpec::Free) => RootClamp::Free,
                Clamp::Nodes(list) => RootClamp::Nodes(list.clone()),
            },
        };
        let model = panel
            .model()
            .map_err(|e| document.error("support.root", e.to_string(), "check plate and support"))?;
        append(&mut all, model, i, rows, plate.nodes_chordwise);
        rows += rows_here;
    }
    thicknesses(file, &mut all.shells);
    attach(document, file, &mut all)?;
    all.settings.mass = match plate.mass {
        MassModel::Consistent => MassForm::Consistent,
        MassModel::Lumped => MassForm::Lumped,
        MassModel::Mean => MassForm::Mean,
    };
    Ok(all)
}

/// Joins a panel to the model; `rows` rows of elements are there already.
fn append(all: &mut Model, mut panel: Model, index: usize, rows: usize, chordwise: usize) {
    if index == 0 {
        *all = panel;
        return;
    }
    let offset = (rows * chordwise) as u32;
    let elements = (rows * (chordwise - 1)) as u32;
    let section = all.shell_sections.len();
    for mut node in panel.nodes.drain(..).skip(chordwise) {
        node.id += offset;
        all.nodes.push(node);
    }
    for mut shell in panel.shells.drain(..) {
        shell.id += elements;
        shell.section += section;
        match &mut shell.nodes {
            dip_modal::ShellNodes::Quad(n) => n.iter_mut().for_each(|n| *n += offset),
            dip_modal::ShellNodes::Triangle(n) => n.iter_mut().for_each(|n| *n += offset),
        }
        all.shells.push(shell);
    }
    all.shell_sections.append(&mut panel.shell_sections);
}

fn material(document: &Document, file: &StructureFile) -> Result<Material, CaseError> {
    let m = &file.material;
    let positive = [
        ("e1", Some(m.e1.0)),
        ("e2", m.e2.map(|v| v.0)),
        ("g12", m.g12.map(|v| v.0)),
        ("g_transverse", m.g_transverse.map(|v| v.0)),
        ("density", Some(m.density.0)),
    ];
    for (key, value) in positive {
        if value.is_some_and(|v| v <= 0.0) {
            let message = format!("{key} = {}: needed a positive value", value.unwrap_or_default());
            return Err(document.error(&format!("material.{key}"), message, "with its unit, as in \"3.15 GPa\""));
        }
    }
    let e2 = m.e2.map_or(m.e1.0, |v| v.0);
    // Positive definite: nu12^2 < E1 / E2.
    if !(m.nu12.is_finite() && m.nu12 * m.nu12 < m.e1.0 / e2 && m.nu12 > -1.0) {
        let message = format!("nu12 = {}: needed nu12^2 < e1 / e2", m.nu12);
        return Err(document.error(
            "material.nu12",
            message,
            "nu12 is the strain along 2 for stress along 1",
        ));
    }
    let g12 = m.g12.map_or(m.e1.0 / (2.0 * (1.0 + m.nu12)), |v| v.0);
    // Without a transverse shear modulus the plate is thin (Kirchhoff).
    let transverse = m.g_transverse.map(|v| v.0);
    Ok(Material {
        elasticity: Elasticity::Orthotropic {
            young_1: m.e1.0,
            young_2: e2,
            poisson_12: m.nu12,
            shear_12: g12,
            shear_1z: transverse,
            shear_2z: transverse,
        },
        density: m.density.0,
    })
}

/// Direction of the material's 1-axis: from the panel's span direction turned aft by the angle asked for.
fn axis(file: &StructureFile, a: &Section, b: &Section) -> Vector3<f64> {
    let sweep = file.material.axis_sweep.map_or(0.0, |s| s.0);
    let d = |i: usize| b.leading_edge_m[i] - a.leading_edge_m[i];
    let width = d(1).hypot(d(2));
    Vector3::new(sweep.sin(), sweep.cos() * d(1) / width, sweep.cos() * d(2) / width)
}

/// Thickness over the chord of one panel.
fn ordinates(
    document: &Document,
    file: &StructureFile,
    i: usize,
    a: &Section,
    b: &Section,
) -> Result<Ordinates, CaseError> {
    if file.plate.constant_thickness.is_some() {
        return Ok(Ordinates::slab(1.0));
    }
    let Some(airfoil) = &a.airfoil else {
        let message = format!(
            "section {} of the wing has no airfoil to take the thickness from",
            i + 1
        );
        return Err(document.error(
            "plate.thickness",
            message,
            "add airfoil to it, or give plate.constant_thickness",
        ));
    };
    if b.airfoil.as_ref().is_some_and(|other| other != airfoil) {
        let message = format!("sections {} and {} of the wing have different airfoils", i + 1, i + 2);
        return Err(document.error(
            "plate.thickness",
            message,
            "give both ends of a panel the same airfoil for the plate model",
        ));
    }
    let half: Vec<[f64; 2]> = airfoil
        .x
        .iter()
        .zip(airfoil.upper.iter().zip(&airfoil.lower))
        .map(|(x, (u, l))| [*x, 0.5 * (u - l)])
        .collect();
    Ordinates::symmetric(&half)
        .map_err(|e| document.error("plate.thickness", e.to_string(), "check the airfoil's file"))
}

/// A constant or a least thickness, where the file asks for it.
fn thicknesses(file: &StructureFile, shells: &mut [Shell]) {
    if let Some(t) = file.plate.constant_thickness {
        shells
            .iter_mut()
            .for_each(|s| s.thickness = ShellThickness::Uniform(t.0));
    }
    let Some(least) = file.plate.minimum_thickness else {
        return;
    };
    for shell in shells {
        match &mut shell.thickness {
            ShellThickness::Section => {}
            ShellThickness::Uniform(t) => *t = t.max(least.0),
            ShellThickness::Corner(t) | ShellThickness::Integration(t) => {
                t.iter_mut().for_each(|t| *t = t.max(least.0));
            }
        }
    }
}

/// Concentrated masses and springs, at the nearest node.
fn attach(document: &Document, file: &StructureFile, model: &mut Model) -> Result<(), CaseError> {
    let nearest = |p: &Vector3<f64>| {
        let node = model.nodes.iter().min_by(|a, b| {
            let distance = |n: &dip_modal::Node| (n.position - p).norm_squared();
            distance(a).total_cmp(&distance(b))
        });
        node.map_or((1, Vector3::zeros()), |n| (n.id, n.position))
    };
    let mut masses = Vec::new();
    for (i, m) in file.mass.iter().enumerate() {
        if m.mass.0 <= 0.0 {
            let message = format!("mass {} kg: needed a positive value", m.mass.0);
            return Err(document.error(&format!("mass.{i}.mass"), message, "with its unit, as in \"0.1 kg\""));
        }
        let position = Vector3::from(m.position.map(|v| v.0));
        let (node, at) = nearest(&position);
        let inertia = m.inertia.map_or(Matrix3::zeros(), |j| {
            Matrix3::from_diagonal(&Vector3::from(j.map(|v| v.0)))
        });
        masses.push(NodeMass::Point {
            id: i as u32 + 1,
            node,
            mass: m.mass.0,
            offset: position - at,
            inertia,
            axes: Matrix3::identity(),
        });
    }
    let mut springs = Vec::new();
    for (i, s) in file.spring.iter().enumerate() {
        let (node, _) = nearest(&Vector3::from(s.position.map(|v| v.0)));
        let parts = [
            (s.vertical.map(|k| k.0), Dof::T3, "vertical"),
            (s.roll.map(|k| k.0), Dof::R1, "roll"),
            (s.pitch.map(|k| k.0), Dof::R2, "pitch"),
        ];
        if parts.iter().all(|p| p.0.is_none()) {
            let help = "give one or more of vertical, roll, pitch";
            return Err(document.error(&format!("spring.{i}"), "a spring without a stiffness", help));
        }
        for (stiffness, dof, key) in parts {
            let Some(k) = stiffness else { continue };
            if k <= 0.0 {
                let message = format!("stiffness {k}: needed a positive value");
                return Err(document.error(&format!("spring.{i}.{key}"), message, "leave the key out for no spring"));
            }
            springs.push(ScalarElement {
                id: i as u32 + 1,
                value: k,
                a: NodeDof::new(node, dof),
                b: None,
            });
        }
    }
    model.masses.extend(masses);
    model.springs.extend(springs);
    Ok(())
}
