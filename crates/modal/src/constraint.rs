//! Linear constraints: rigid bodies, averages and equations, made into "this one follows those".
//!
//! A place in the model is the number 6 x node + degree of freedom, in node frames.

use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::dof::{DOFS_PER_NODE, Dof, DofSet};
use crate::element::{AverageElement, Node, RigidElement};
use crate::error::ModelError;
use crate::model::{Model, NodeIndex};

/// One degree of freedom as a combination of others.
#[derive(Debug, Clone)]
pub(crate) struct Dependence {
    /// The dependent one.
    pub at: usize,
    /// Those that it follows, with factors.
    pub on: Vec<(usize, f64)>,
    /// Constraint, for messages.
    pub place: String,
}

/// Factors below this times the largest of their row are round-off of the geometry.
const ROUND_OFF: f64 = 1e-12;

/// All dependences of the model.
pub(crate) fn dependences(model: &Model, index: &NodeIndex) -> Result<Vec<Dependence>, ModelError> {
    let mut out = Vec::new();
    for element in &model.rigid {
        rigid(element, model, index, &mut out)?;
    }
    for element in &model.averages {
        average(element, model, index, &mut out)?;
    }
    for equation in &model.equations {
        let place = || format!("equation {}", equation.id);
        let bad = |problem: &str| ModelError::BadConstraint {
            place: place(),
            problem: problem.to_owned(),
        };
        let ((first, factor), rest) = equation
            .terms
            .split_first()
            .ok_or_else(|| bad("it has no terms; give at least one"))?;
        if *factor == 0.0 || equation.terms.iter().any(|t| !t.1.is_finite()) {
            return Err(bad("the first coefficient must not be zero and all must be finite"));
        }
        let at = |t: &crate::NodeDof| index.find_dof(*t, place);
        let on = rest
            .iter()
            .filter(|(_, c)| *c != 0.0)
            .map(|(t, c)| Ok((at(t)?, -c / factor)))
            .collect::<Result<_, ModelError>>()?;
        out.push(Dependence {
            at: at(first)?,
            on,
            place: place(),
        });
    }
    Ok(out)
}

/// Lists the places of `sets` as (node index, degree of freedom).
fn expand(
    sets: &[(u32, DofSet)],
    index: &NodeIndex,
    place: &dyn Fn() -> String,
) -> Result<Vec<(usize, Dof)>, ModelError> {
    let mut out = Vec::new();
    for &(node, dofs) in sets {
        let node = index.find_grid(node, place)?;
        out.extend(dofs.iter().map(|d| (node, d)));
    }
    Ok(out)
}

/// Motion of one degree of freedom per rigid motion (translation and rotation at `origin`, basic axes).
fn rigid_row(node: &Node, dof: Dof, origin: &Vector3<f64>) -> [f64; 6] {
    let axis: Vector3<f64> = node.frame.column(dof.index() % 3).into_owned();
    if dof.index() < 3 {
        // a . (u + theta x r) = a . u + (r x a) . theta
        let moment = (node.position - origin).cross(&axis);
        [axis.x, axis.y, axis.z, moment.x, moment.y, moment.z]
    } else {
        [0.0, 0.0, 0.0, axis.x, axis.y, axis.z]
    }
}

fn rigid(
    element: &RigidElement,
    model: &Model,
    index: &NodeIndex,
    out: &mut Vec<Dependence>,
) -> Result<(), ModelError> {
    let place = || format!("rigid element {}", element.id);
    let lead = expand(&element.independent, index, &place)?;
    let follow = expand(&element.dependent, index, &place)?;
    if lead.len() != 6 {
        return Err(ModelError::BadConstraint {
            place: place(),
            problem: format!("needs 6 independent degrees of freedom, got {}", lead.len()),
        });
    }
    let origin = model.nodes[lead[0].0].position;
    // Lengths are scaled so that rotations and displacements weigh alike when judging singularity.
    let size = lead
        .iter()
        .chain(&follow)
        .map(|&(n, _)| (model.nodes[n].position - origin).norm())
        .fold(0.0, f64::max);
    let size = if size > 0.0 { size } else { 1.0 };
    let row = |&(n, d): &(usize, Dof)| {
        let mut r = rigid_row(&model.nodes[n], d, &origin);
        let translation = d.index() < 3;
        for v in &mut r[3..] {
            *v /= size;
        }
        if !translation {
            r = r.map(|v| v * size);
        }
        r
    };
    let unit = |&(_, d): &(usize, Dof)| if d.index() < 3 { 1.0 } else { size };
    let lead_rows = DMatrix::from_fn(6, 6, |i, j| row(&lead[i])[j]);
    let svd = lead_rows.clone().svd(false, false).singular_values;
    if svd.min() < 1e-8 * svd.max() {
        return Err(ModelError::BadConstraint {
            place: place(),
            problem: "its independent degrees of freedom do not fix a rigid motion; choose six that do".to_owned(),
        });
    }
    let inverse = lead_rows.try_inverse().ok_or_else(|| ModelError::BadConstraint {
        place: place(),
        problem: "its independent degrees of freedom do not fix a rigid motion".to_owned(),
    })?;
    for f in &follow {
        let r = DMatrix::from_row_slice(1, 6, &row(f)) * &inverse;
        let on = lead
            .iter()
            .enumerate()
            .filter(|&(j, _)| r[(0, j)].abs() > ROUND_OFF * r.abs().max())
            .map(|(j, l)| (at(l), r[(0, j)] * unit(l) / unit(f)))
            .collect();
        out.push(Dependence {
            at: at(f),
            on,
            place: place(),
        });
    }
    Ok(())
}

fn at(&(node, dof): &(usize, Dof)) -> usize {
    DOFS_PER_NODE * node + dof.index()
}

/// The reference moves as the rigid motion that fits the others best: minimize the weighted sum of
/// (u_i - R_i x)^2 over x, so x = (R^T W R)^-1 R^T W u; rotations weigh with the square of the
/// mean distance of the nodes (MSC Nastran, RBE3).
fn average(
    element: &AverageElement,
    model: &Model,
    index: &NodeIndex,
    out: &mut Vec<Dependence>,
) -> Result<(), ModelError> {
    let place = || format!("averaging element {}", element.id);
    let bad = |problem: String| ModelError::BadConstraint {
        place: place(),
        problem,
    };
    let reference = index.find_grid(element.reference.0, place)?;
    let origin = model.nodes[reference].position;
    let mut lead: Vec<((usize, Dof), f64)> = Vec::new();
    for (weight, dofs, nodes) in &element.terms {
        if !(weight.is_finite() && *weight > 0.0) {
            return Err(bad(format!("a weight must be positive, got {weight:e}")));
        }
        for &n in nodes {
            let n = index.find_grid(n, place)?;
            lead.extend(dofs.iter().map(|d| ((n, d), *weight)));
        }
    }
    let distances: Vec<f64> = {
        let mut nodes: Vec<usize> = lead.iter().map(|l| l.0.0).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
            .iter()
            .map(|&n| (model.nodes[n].position - origin).norm())
            .collect()
    };
    let size = match distances.iter().sum::<f64>() / distances.len().max(1) as f64 {
        mean if mean > 0.0 => mean,
        _ => 1.0,
    };
    // Rows and unknowns in displacements: rotations times the mean distance.
    let row = |&(n, d): &(usize, Dof)| {
        let mut r = rigid_row(&model.nodes[n], d, &origin);
        for v in &mut r[3..] {
            *v /= size;
        }
        if d.index() < 3 { r } else { r.map(|v| v * size) }
    };
    let unit = |d: Dof| if d.index() < 3 { 1.0 } else { size };
    let rows = DMatrix::from_fn(lead.len(), 6, |i, j| row(&lead[i].0)[j]);
    let weighted = DMatrix::from_fn(lead.len(), 6, |i, j| rows[(i, j)] * lead[i].1);
    let normal = rows.tr_mul(&weighted);
    let components: Vec<Dof> = element.reference.1.iter().collect();
    // Only the motions that the nodes can tell are fitted (a row of nodes cannot tell a turn about itself).
    let svd = normal.clone().svd(true, true);
    let inverse = svd
        .pseudo_inverse(1e-10 * normal.abs().max())
        .map_err(|cause| bad(format!("its least-squares fit failed ({cause})")))?;
    let fit = &inverse * weighted.transpose();
    let frame = &model.nodes[reference].frame;
    let to_node = |d: Dof, j: usize| {
        let base = if d.index() < 3 { 0 } else { 3 };
        let axis: Vector3<f64> = frame.column(d.index() % 3).into_owned();
        (0..3).map(|k| axis[k] * fit[(base + k, j)]).sum::<f64>()
    };
    // The projector on motions that are told must keep every component that is asked for.
    let told: DMatrix<f64> = &inverse * &normal;
    for &d in &components {
        let base = if d.index() < 3 { 0 } else { 3 };
        let axis = Vector3::from(frame.column(d.index() % 3));
        let mut v = DMatrix::zeros(6, 1);
        for k in 0..3 {
            v[(base + k, 0)] = axis[k];
        }
        if (told.transpose() * &v - &v).abs().max() > 1e-6 {
            return Err(bad(format!(
                "component {d} of node {} is not determined by the nodes that are averaged; add nodes or components, or leave {d} out",
                element.reference.0
            )));
        }
    }
    let mut equations: Vec<Dependence> = components
        .iter()
        .map(|&d| {
            let factors: Vec<f64> = (0..lead.len()).map(|j| to_node(d, j)).collect();
            let largest = factors.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
            let on = lead
                .iter()
                .zip(&factors)
                .filter(|(_, f)| f.abs() > ROUND_OFF * largest)
                .map(|((l, _), f)| (at(l), f * unit(l.1) / unit(d)))
                .collect();
            Dependence {
                at: at(&(reference, d)),
                on,
                place: place(),
            }
        })
        .collect();
    if !element.dependent.is_empty() {
        let chosen: Vec<usize> = expand(&element.dependent, index, &place)?.iter().map(at).collect();
        equations = resolve_for(&equations, &chosen, &place)?;
    }
    out.extend(equations);
    Ok(())
}

/// Solves the equations `e.at - sum = 0` for other unknowns, as many as there are equations.
fn resolve_for(
    equations: &[Dependence],
    chosen: &[usize],
    place: &dyn Fn() -> String,
) -> Result<Vec<Dependence>, ModelError> {
    let bad = |problem: String| ModelError::BadConstraint {
        place: place(),
        problem,
    };
    if chosen.len() != equations.len() {
        return Err(bad(format!(
            "needs {} dependent degrees of freedom (UM), got {}",
            equations.len(),
            chosen.len()
        )));
    }
    let mut others: Vec<usize> = equations
        .iter()
        .flat_map(|e| std::iter::once(e.at).chain(e.on.iter().map(|o| o.0)))
        .filter(|a| !chosen.contains(a))
        .collect();
    others.sort_unstable();
    others.dedup();
    let coefficient = |e: &Dependence, a: usize| {
        let own = if e.at == a { 1.0 } else { 0.0 };
        own - e.on.iter().filter(|o| o.0 == a).map(|o| o.1).sum::<f64>()
    };
    let a = DMatrix::from_fn(equations.len(), chosen.len(), |i, j| {
        coefficient(&equations[i], chosen[j])
    });
    let b = DMatrix::from_fn(equations.len(), others.len(), |i, j| {
        -coefficient(&equations[i], others[j])
    });
    let solution = a
        .lu()
        .solve(&b)
        .filter(|x| x.iter().all(|v| v.is_finite()))
        .ok_or_else(|| bad("its equations cannot be solved for the chosen degrees of freedom (UM)".to_owned()))?;
    Ok(chosen
        .iter()
        .enumerate()
        .map(|(i, &at)| {
            let row = solution.row(i);
            let largest = row.abs().max();
            let on = others
                .iter()
                .enumerate()
                .filter(|&(j, _)| row[j].abs() > ROUND_OFF * largest)
                .map(|(j, &o)| (o, row[j]))
                .collect();
            Dependence { at, on, place: place() }
        })
        .collect())
}

/// Six rigid motions about `origin` at one node, in its frame: [motion][degree of freedom].
pub(crate) fn rigid_motions(position: &Vector3<f64>, frame: &Matrix3<f64>, origin: &Vector3<f64>) -> [[f64; 6]; 6] {
    let node = Node {
        id: 0,
        position: *position,
        frame: *frame,
        scalar: false,
    };
    let mut out = [[0.0; 6]; 6];
    for (d, row) in (0..6)
        .filter_map(Dof::from_index)
        .map(|d| (d.index(), rigid_row(&node, d, origin)))
    {
        for (motion, value) in row.into_iter().enumerate() {
            out[motion][d] = value;
        }
    }
    out
}
