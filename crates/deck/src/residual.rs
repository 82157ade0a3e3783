//! Residual vectors: what the structure does at rest under loads that its computed modes do not carry.
//!
//! Nastran's default (RESVEC with INRLOD) takes as loads the inertia of the six rigid motions about the basic origin. With M and K
//! of the structure, Phi its computed modes of unit mass and D the rigid motions, the loads are `P = M D - M Phi Phi^T M D`, the
//! vectors `K X = P` with X orthogonal to Phi, and the Ritz modes of X (K and M projected on it) follow the computed ones, which
//! stay as they are.

use dip_modal::{DirectTerm, Dof, DofSet, Model, Modes, NodeDof, System};
use nalgebra::{DMatrix, DVector, SymmetricEigen, Vector3};

use crate::error::Result;

/// Part of the highest computed eigenvalue by which the stiffness is shifted, so that rigid-body modes do not stop its
/// factorization.
const SHIFT: f64 = 1e-3;
/// Corrections for the shift; each leaves a thousandth of the error or less.
const CORRECTIONS: usize = 4;
/// A load whose strain energy is below this part of its inertia's scale is carried by the computed modes.
const CARRIED: f64 = 1e-12;
/// Combinations of residual vectors below this part of the largest strain energy depend on the others.
const DEPENDENT: f64 = 1e-9;

/// Appends the Ritz modes of the six inertia loads to the lowest modes of a structure, with unit generalized mass; returns how
/// many there are. `system` is the assembled `model`, which must have no analysis set (loads are on all free degrees of freedom).
///
/// # Errors
/// A model that cannot be assembled or factored.
pub(crate) fn append(model: &Model, system: &System, modes: &mut Modes) -> Result<usize> {
    let places = places(model);
    let grid = unconstrained(model).assemble()?;
    let top = modes.omega_rad_s.iter().copied().fold(0.0, f64::max).powi(2);
    // A structure of rigid-body modes alone has no scale for the shift.
    if top <= 0.0 || grid.size() != places.len() {
        return Ok(0);
    }
    let shift = SHIFT * top;
    let solver = shifted(model, system, &grid, &places, shift).assemble()?;
    let column = |motion: &[[f64; 6]]| DVector::from_iterator(places.len(), places.iter().map(|&(n, d)| motion[n][d]));
    let phi: Vec<DVector<f64>> = (modes.shapes.iter().zip(&modes.generalized_mass))
        .map(|(shape, mass)| column(shape) / mass.sqrt())
        .collect();
    let m_phi: Vec<DVector<f64>> = phi.iter().map(|p| times_mass(&grid, p)).collect();

    let mut responses = Vec::new();
    for motion in rigid_motions(model) {
        let motion = column(&motion);
        let inertia = times_mass(&grid, &motion);
        let load = without(inertia.clone(), &phi, &m_phi);
        // K x = P by (K + s M) x_new = P + s M x: every turn shrinks the error along a mode of eigenvalue l by s / (s + l).
        let mut x = DVector::zeros(places.len());
        for _ in 0..=CORRECTIONS {
            let right = &load + times_mass(&grid, &x) * shift;
            let terms: Vec<(NodeDof, f64)> = (places.iter().zip(right.iter()))
                .filter_map(|(&place, value)| Some((node_dof(model, place)?, *value)))
                .collect();
            x = without(column(&solver.displacements(&terms)?), &m_phi, &phi);
        }
        let energy = x.dot(&load);
        if energy > CARRIED * inertia.dot(&motion) / top {
            responses.push(x / energy.sqrt());
        }
    }
    let ritz = ritz(&grid, &responses);
    let found = ritz.len();
    for (omega_rad_s, vector) in ritz {
        let mut shape = vec![[0.0; 6]; model.nodes.len()];
        for (&(n, d), value) in places.iter().zip(vector.iter()) {
            shape[n][d] = *value;
        }
        modes.shapes.push(shape);
        modes.omega_rad_s.push(omega_rad_s);
        modes.generalized_mass.push(1.0);
    }
    // Ritz vectors are no modes: there is no bound on their error as such, so the list of bounds is left empty.
    if found > 0 {
        modes.residual.clear();
    }
    Ok(found)
}

/// Node and degree of freedom of each row of the unconstrained matrices.
fn places(model: &Model) -> Vec<(usize, usize)> {
    let count = |scalar: bool| if scalar { 1 } else { 6 };
    (model.nodes.iter().enumerate())
        .flat_map(|(n, node)| (0..count(node.scalar)).map(move |d| (n, d)))
        .collect()
}

fn node_dof(model: &Model, (n, d): (usize, usize)) -> Option<NodeDof> {
    Some(NodeDof::new(model.nodes[n].id, Dof::from_index(d)?))
}

/// The model with nothing held or tied, whose matrices are those of the grid points.
fn unconstrained(model: &Model) -> Model {
    let mut free = model.clone();
    free.rigid.clear();
    free.averages.clear();
    free.equations.clear();
    free.supports.clear();
    free.settings.auto_support = None;
    free
}

/// The model with `shift` times its mass added to the stiffness, held where `system` is.
fn shifted(model: &Model, system: &System, grid: &System, places: &[(usize, usize)], shift: f64) -> Model {
    let mut shifted = model.clone();
    shifted.settings.auto_support = None;
    for held in &system.auto_supports {
        shifted.supports.push((held.node, DofSet::NONE.with(held.dof)));
    }
    for (i, row) in grid.mass.outer_iterator().enumerate() {
        for (j, mass) in row.iter() {
            if let (Some(row), Some(column)) = (node_dof(model, places[i]), node_dof(model, places[j])) {
                shifted.direct_stiffness.push(DirectTerm {
                    row,
                    column,
                    value: shift * mass,
                });
            }
        }
    }
    shifted
}

/// Displacements and rotations of all nodes, in node frames, of unit translations along and rotations about the basic axes.
fn rigid_motions(model: &Model) -> Vec<Vec<[f64; 6]>> {
    (0..6)
        .map(|k| {
            let axis = Vector3::ith(k % 3, 1.0);
            (model.nodes.iter())
                .map(|node| {
                    if node.scalar {
                        return [0.0; 6];
                    }
                    let (shift, turn) = if k < 3 {
                        (axis, Vector3::zeros())
                    } else {
                        (axis.cross(&node.position), axis)
                    };
                    let (t, r) = (node.frame.transpose() * shift, node.frame.transpose() * turn);
                    [t.x, t.y, t.z, r.x, r.y, r.z]
                })
                .collect()
        })
        .collect()
}

fn times_mass(grid: &System, x: &DVector<f64>) -> DVector<f64> {
    let rows = grid.mass.outer_iterator();
    DVector::from_iterator(x.len(), rows.map(|row| row.iter().map(|(j, m)| m * x[j]).sum::<f64>()))
}

fn times_stiffness(grid: &System, x: &DVector<f64>) -> DVector<f64> {
    let rows = grid.stiffness.outer_iterator();
    DVector::from_iterator(x.len(), rows.map(|row| row.iter().map(|(j, k)| k * x[j]).sum::<f64>()))
}

/// `v - sum b (a . v)`, twice, so that rounding does not leave a part of it.
fn without(mut v: DVector<f64>, a: &[DVector<f64>], b: &[DVector<f64>]) -> DVector<f64> {
    for _ in 0..2 {
        for (a, b) in a.iter().zip(b) {
            let part = a.dot(&v);
            v.axpy(-part, b, 1.0);
        }
    }
    v
}

/// Circular frequencies, ascending, and vectors of unit mass of the structure confined to some vectors.
fn ritz(grid: &System, vectors: &[DVector<f64>]) -> Vec<(f64, DVector<f64>)> {
    if vectors.is_empty() {
        return Vec::new();
    }
    let x = DMatrix::from_columns(vectors);
    let product = |times: fn(&System, &DVector<f64>) -> DVector<f64>| {
        let right: Vec<DVector<f64>> = vectors.iter().map(|v| times(grid, v)).collect();
        let full = x.transpose() * DMatrix::from_columns(&right);
        (&full + full.transpose()) * 0.5
    };
    let energy = SymmetricEigen::new(product(times_stiffness));
    let least = DEPENDENT * energy.eigenvalues.max();
    let kept: Vec<DVector<f64>> = (0..vectors.len())
        .filter(|&i| energy.eigenvalues[i] > least)
        .map(|i| energy.eigenvectors.column(i) / energy.eigenvalues[i].sqrt())
        .collect();
    if kept.is_empty() {
        return Vec::new();
    }
    let basis = DMatrix::from_columns(&kept);
    // In a basis of unit strain energy the eigenvalues of the mass are 1 / omega^2.
    let mass = SymmetricEigen::new(basis.transpose() * product(times_mass) * &basis);
    let mut found: Vec<(f64, DVector<f64>)> = (0..kept.len())
        .filter(|&i| mass.eigenvalues[i] > 0.0)
        .map(|i| {
            let omega = mass.eigenvalues[i].sqrt().recip();
            (omega, &x * (&basis * mass.eigenvectors.column(i)) * omega)
        })
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{coordinate::Geometry, structure};
    use dip_modal::ModesRequest;

    /// Two modes and the residual vectors give the whole static strain energy under every inertia load, and stay orthonormal.
    #[test]
    fn the_static_response_to_inertia_is_complete() {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../tests/data/nastran/jet_wing_bars.bdf"
        );
        let deck = dip_nastran::Deck::read(path).unwrap();
        let geometry = Geometry::new(&deck.bulk).unwrap();
        let model = structure::model(&deck.bulk, &geometry, &deck.control.subcases[0], &mut Vec::new()).unwrap();
        let system = model.assemble().unwrap();
        let mut modes = system.modes(&ModesRequest::lowest(2)).unwrap();
        let lowest = modes.omega_rad_s[1];
        let added = append(&model, &system, &mut modes).unwrap();
        assert!(added > 0 && modes.count() == 2 + added);
        assert!(modes.omega_rad_s[2..].iter().all(|w| *w > lowest));
        let (grid, places) = (unconstrained(&model).assemble().unwrap(), places(&model));
        let column =
            |motion: &[[f64; 6]]| DVector::from_iterator(places.len(), places.iter().map(|&(n, d)| motion[n][d]));
        let phi: Vec<DVector<f64>> = modes.shapes.iter().map(|s| column(s)).collect();
        for (i, a) in phi.iter().enumerate() {
            for (j, b) in phi.iter().enumerate() {
                let unit = if i == j { 1.0 } else { 0.0 };
                assert!((a.dot(&times_mass(&grid, b)) - unit).abs() < 1e-8);
                let scale = modes.omega_rad_s[i] * modes.omega_rad_s[j];
                assert!((a.dot(&times_stiffness(&grid, b)) / scale - unit).abs() < 1e-7);
            }
        }
        let mut loads = 0;
        for motion in rigid_motions(&model) {
            let load = times_mass(&grid, &column(&motion));
            let terms: Vec<(NodeDof, f64)> = (places.iter().zip(load.iter()))
                .map(|(&place, value)| (node_dof(&model, place).unwrap(), *value))
                .collect();
            let exact = column(&system.displacements(&terms).unwrap()).dot(&load);
            let modal = |count: usize| -> f64 {
                (phi.iter().zip(&modes.omega_rad_s).take(count))
                    .map(|(p, omega)| (p.dot(&load) / omega).powi(2))
                    .sum()
            };
            assert!(
                (modal(phi.len()) - exact).abs() <= 1e-9 * exact,
                "{} {exact}",
                modal(phi.len())
            );
            loads += usize::from(modal(2) < exact * (1.0 - 1e-6));
        }
        assert!(loads > 0, "the two modes alone must leave something out");
    }
}
