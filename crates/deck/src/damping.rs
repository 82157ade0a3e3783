//! Structural and viscous damping of the modes: SDAMPING with TABDMP1, PARAM KDAMP, PARAM G and W3, CDAMP elements, B2GG.

use std::collections::BTreeMap;

use dip_flutter::{DampingForm, StructuralDamping, Structure};
use dip_modal::Modes;
use dip_nastran::{Dof, Location, Note, Severity, bulk::Bulk, case_control::Subcase};
use faer::Mat;

use crate::{
    error::{Result, SolveError, misfit, missing},
    structure::{scalar_value, selected},
};

/// Generalized mass, stiffness and damping of the modes that flutter uses.
///
/// # Errors
/// Tables and matrices that do not exist, parameters that are no numbers.
pub fn generalized_structure(
    bulk: &Bulk,
    modes: &Modes,
    subcase: &Subcase,
    notes: &mut Vec<Note>,
) -> Result<Structure> {
    let n = modes.count();
    let diagonal = |value: &dyn Fn(usize) -> f64| Mat::from_fn(n, n, |i, j| if i == j { value(i) } else { 0.0 });
    let structure = Structure::new(
        diagonal(&|i| modes.generalized_mass[i]),
        diagonal(&|i| modes.generalized_stiffness(i)),
    )?;
    let deck = |e: dip_nastran::DeckError| SolveError::Deck(e.into());
    let real = |name: &str| -> Result<f64> { bulk.parameters.get(name).map_or(Ok(0.0), |p| p.real().map_err(deck)) };
    let (g, w3) = (real("G")?, real("W3")?);
    let mut viscous = dampers(bulk, modes, subcase)?;
    let mut per_mode = vec![0.0; n];
    if let Some((id, at)) = selected(subcase, "SDAMPING")? {
        let table = bulk
            .damping_tables
            .get(&id)
            .ok_or_else(|| missing(&at, format!("SDAMPING = {id}"), "TABDMP1", id))?;
        for (mode, damping) in per_mode.iter_mut().enumerate() {
            *damping = table.structural_damping(modes.freq_hz(mode));
        }
    }
    let viscous_form = match bulk.parameters.get("KDAMP") {
        Some(p) => p.integer().map_err(deck)? != -1,
        None => true,
    };
    if g != 0.0 {
        if w3 > 0.0 {
            for mode in 0..n {
                viscous[(mode, mode)] += g / w3 * modes.generalized_stiffness(mode);
            }
        } else {
            per_mode.iter_mut().for_each(|d| *d += g);
            if let Some(p) = bulk.parameters.get("G") {
                notes.push(Note {
                    at: p.at.clone(),
                    card: "PARAM G".to_owned(),
                    severity: Severity::Warning,
                    text: "without W3 Nastran leaves this damping out of PK; here every method has it".to_owned(),
                });
            }
        }
    }
    let form = if viscous_form && g == 0.0 {
        DampingForm::ViscousAtNaturalFrequency
    } else {
        DampingForm::ComplexStiffness
    };
    let structure = structure.with_viscous_damping(viscous)?;
    if per_mode.iter().all(|d| *d == 0.0) {
        return Ok(structure);
    }
    Ok(structure.with_structural_damping(StructuralDamping::PerMode(per_mode), form)?)
}

/// Generalized viscous damping of the CDAMP elements and of the matrix that B2GG selects.
fn dampers(bulk: &Bulk, modes: &Modes, subcase: &Subcase) -> Result<Mat<f64>> {
    let n = modes.count();
    let places: BTreeMap<u32, usize> = modes.nodes.iter().enumerate().map(|(i, node)| (node.id, i)).collect();
    let motion = |dof: Dof, at: &Location, card: &str| -> Result<Vec<f64>> {
        let node = places
            .get(&dof.point)
            .ok_or_else(|| missing(at, card.to_owned(), "GRID or SPOINT", dof.point))?;
        Ok((0..n)
            .map(|mode| modes.shapes[mode][*node].get(dof.component).copied().unwrap_or(0.0))
            .collect())
    };
    let mut damping = Mat::<f64>::zeros(n, n);
    let mut add = |a: &[f64], b: &[f64], value: f64| {
        for (i, a) in a.iter().enumerate() {
            for (j, b) in b.iter().enumerate() {
                damping[(i, j)] += value * a * b;
            }
        }
    };
    for damper in bulk.dampers.values() {
        let card = format!("CDAMP {}", damper.id);
        let value = scalar_value(damper, &bulk.damper_values, &|| card.clone(), "PDAMP")?;
        let mut stretch = vec![0.0; n];
        for (end, sign) in damper.ends.iter().zip([1.0, -1.0]) {
            if let Some(dof) = end {
                for (s, u) in stretch.iter_mut().zip(motion(*dof, &damper.at, &card)?) {
                    *s += sign * u;
                }
            }
        }
        add(&stretch, &stretch, value);
    }
    if let Some(setting) = subcase.settings.get("B2GG") {
        let matrix = bulk
            .dof_matrices
            .get(&setting.value.trim().to_uppercase())
            .ok_or_else(|| misfit(&setting.at, "B2GG", "no DMIG matrix of this name is in the bulk data"))?;
        let card = format!("DMIG {}", matrix.name);
        for (row, column, value) in &matrix.terms {
            let (a, b) = (motion(*row, &matrix.at, &card)?, motion(*column, &matrix.at, &card)?);
            add(&a, &b, *value);
            if matrix.is_symmetric && row != column {
                add(&b, &a, *value);
            }
        }
    }
    Ok(damping)
}
