//! From all degrees of freedom to the free ones: supports, dependent motions, automatic support.

use nalgebra::DMatrix;
use sprs::{CsMat, TriMat};

use crate::constraint::{Dependence, dependences};
use crate::dof::{DOFS_PER_NODE, Dof};
use crate::error::ModelError;
use crate::model::{Model, NodeIndex};

/// A degree of freedom, or a direction of three at one node, that was supported because nothing
/// holds it.
#[derive(Debug, Clone, PartialEq)]
pub struct AutoSupport {
    /// Node number.
    pub node: u32,
    /// The degree of freedom that was removed.
    pub dof: Dof,
    /// Direction that has no stiffness, over the node's three displacements or three rotations.
    pub direction: [f64; 3],
    /// Its stiffness over the largest at the node.
    pub ratio: f64,
}

/// What becomes of each degree of freedom: u = T u_free, one row of T each.
#[derive(Debug, Clone)]
pub(crate) struct Reduction {
    /// [degree of freedom][(free degree of freedom, factor)].
    pub rows: Vec<Vec<(usize, f64)>>,
    /// Place (6 x node + degree of freedom) of each free one.
    pub free: Vec<usize>,
}

impl Reduction {
    /// T^T A T.
    pub fn apply(&self, a: &CsMat<f64>) -> CsMat<f64> {
        let n = self.free.len();
        let mut out = TriMat::with_capacity((n, n), a.nnz());
        for (i, row) in a.outer_iterator().enumerate() {
            for &(fi, ci) in &self.rows[i] {
                for (j, &value) in row.iter() {
                    for &(fj, cj) in &self.rows[j] {
                        out.add_triplet(fi, fj, ci * value * cj);
                    }
                }
            }
        }
        out.to_csr()
    }

    /// T u.
    pub fn expand(&self, u: &[f64]) -> Vec<f64> {
        self.rows
            .iter()
            .map(|r| r.iter().map(|&(f, c)| c * u[f]).sum())
            .collect()
    }

    /// T^T f.
    pub fn gather(&self, f: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.free.len()];
        for (row, &value) in self.rows.iter().zip(f) {
            for &(free, c) in row {
                out[free] += c * value;
            }
        }
        out
    }
}

/// What holds a degree of freedom.
enum State {
    Free,
    Fixed,
    Dependent(usize),
}

/// The model's constraints, which can be completed by automatic supports.
pub(crate) struct Constraints {
    state: Vec<State>,
    dependences: Vec<Dependence>,
}

fn node_dof(model: &Model, at: usize) -> (u32, Dof) {
    let dof = Dof::from_index(at % DOFS_PER_NODE).unwrap_or(Dof::T1);
    (model.nodes[at / DOFS_PER_NODE].id, dof)
}

impl Constraints {
    /// Supports, rigid elements, averages and equations of the model.
    pub fn new(model: &Model, index: &NodeIndex) -> Result<Self, ModelError> {
        let mut state: Vec<State> = (0..DOFS_PER_NODE * model.nodes.len()).map(|_| State::Free).collect();
        for (n, node) in model.nodes.iter().enumerate().filter(|(_, node)| node.scalar) {
            debug_assert!(node.scalar);
            for s in &mut state[DOFS_PER_NODE * n + 1..DOFS_PER_NODE * (n + 1)] {
                *s = State::Fixed;
            }
        }
        let mut out = Self {
            state,
            dependences: Vec::new(),
        };
        for d in dependences(model, index)? {
            out.depend(model, d)?;
        }
        for &(node, dofs) in &model.supports {
            let n = index.find(node, || "a support".to_owned())?;
            for dof in dofs.iter() {
                let at = DOFS_PER_NODE * n + dof.index();
                if let State::Dependent(d) = out.state[at] {
                    return Err(ModelError::FixedDependent {
                        node,
                        dof,
                        place: out.dependences[d].place.clone(),
                    });
                }
                out.state[at] = State::Fixed;
            }
        }
        Ok(out)
    }

    fn depend(&mut self, model: &Model, d: Dependence) -> Result<(), ModelError> {
        let (node, dof) = node_dof(model, d.at);
        match self.state[d.at] {
            State::Free => {
                self.state[d.at] = State::Dependent(self.dependences.len());
                self.dependences.push(d);
                Ok(())
            }
            State::Fixed => Err(ModelError::FixedDependent {
                node,
                dof,
                place: d.place,
            }),
            State::Dependent(other) => Err(ModelError::DependentTwice {
                node,
                dof,
                first: self.dependences[other].place.clone(),
                second: d.place,
            }),
        }
    }

    /// Resolves chains of dependence and numbers the free degrees of freedom in order.
    pub fn reduction(&self, model: &Model) -> Result<Reduction, ModelError> {
        let size = self.state.len();
        let mut number = vec![usize::MAX; size];
        let mut free = Vec::new();
        for (at, state) in self.state.iter().enumerate() {
            if matches!(state, State::Free) {
                number[at] = free.len();
                free.push(at);
            }
        }
        // 0: not looked at, 1: being resolved, 2: done.
        let mut mark = vec![0_u8; size];
        let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new(); size];
        let mut stack = Vec::new();
        for start in 0..size {
            stack.push(start);
            while let Some(&at) = stack.last() {
                let State::Dependent(d) = self.state[at] else {
                    if mark[at] != 2 && number[at] != usize::MAX {
                        rows[at] = vec![(number[at], 1.0)];
                    }
                    mark[at] = 2;
                    stack.pop();
                    continue;
                };
                let dependence = &self.dependences[d];
                if mark[at] == 2 {
                    stack.pop();
                    continue;
                }
                let waiting: Vec<usize> = dependence.on.iter().map(|o| o.0).filter(|&o| mark[o] != 2).collect();
                if waiting.is_empty() {
                    rows[at] = combine(&dependence.on, &rows);
                    mark[at] = 2;
                    stack.pop();
                    continue;
                }
                if mark[at] == 1 || waiting.iter().any(|&w| mark[w] == 1) {
                    let (node, dof) = node_dof(model, at);
                    return Err(ModelError::ConstraintCycle {
                        node,
                        dof,
                        place: dependence.place.clone(),
                    });
                }
                mark[at] = 1;
                stack.extend(waiting);
            }
        }
        Ok(Reduction { rows, free })
    }

    /// Supports every free direction at a node whose stiffness is below `limit` of the largest there,
    /// displacements and rotations apart. `stiffness` is that of the free degrees of freedom.
    ///
    /// Nastran's AUTOSPC removes the degree of freedom nearest to the direction; here the direction
    /// itself is removed, so an inclined plate loses no stiffness and no mass. Where the direction
    /// is an axis of the node's frame the two are the same.
    pub fn support_automatically(
        &mut self,
        model: &Model,
        index: &NodeIndex,
        reduction: &Reduction,
        stiffness: &CsMat<f64>,
        limit: f64,
    ) -> Result<Vec<AutoSupport>, ModelError> {
        let mut keep = vec![false; self.state.len()];
        for &(node, dofs) in &model.keep_free {
            let n = index.find(node, || "the list of degrees of freedom that stay free".to_owned())?;
            for dof in dofs.iter() {
                keep[DOFS_PER_NODE * n + dof.index()] = true;
            }
        }
        let mut number = vec![usize::MAX; self.state.len()];
        for (f, &at) in reduction.free.iter().enumerate() {
            number[at] = f;
        }
        let mut out = Vec::new();
        for base in (0..self.state.len()).step_by(3) {
            let open: Vec<usize> = (base..base + 3)
                .filter(|&a| number[a] != usize::MAX && !keep[a])
                .collect();
            let block = DMatrix::from_fn(open.len(), open.len(), |i, j| {
                stiffness.get(number[open[i]], number[open[j]]).copied().unwrap_or(0.0)
            });
            for Released {
                pivot,
                on,
                direction,
                ratio,
            } in without_stiffness(block, limit)
            {
                let (node, dof) = node_dof(model, open[pivot]);
                if on.is_empty() {
                    self.state[open[pivot]] = State::Fixed;
                } else {
                    let on = on.into_iter().map(|(o, c)| (open[o], c)).collect();
                    let place = format!("the automatic support of node {node} {dof}");
                    self.depend(
                        model,
                        Dependence {
                            at: open[pivot],
                            on,
                            place,
                        },
                    )?;
                }
                let mut axes = [0.0; 3];
                for (o, value) in open.iter().zip(direction) {
                    axes[o - base] = value;
                }
                out.push(AutoSupport {
                    node,
                    dof,
                    direction: axes,
                    ratio,
                });
            }
        }
        Ok(out)
    }
}

/// A direction of a node's block that has no stiffness, solved for one of its members.
struct Released {
    /// The member that goes.
    pivot: usize,
    /// How it follows the members that stay.
    on: Vec<(usize, f64)>,
    /// The direction.
    direction: Vec<f64>,
    /// Its stiffness over the largest of the block.
    ratio: f64,
}

/// Directions whose stiffness is below `limit` of the largest in the (symmetric) block.
fn without_stiffness(block: DMatrix<f64>, limit: f64) -> Vec<Released> {
    let n = block.nrows();
    if n == 0 {
        return Vec::new();
    }
    let scale = block.abs().max();
    let eigen = block.symmetric_eigen();
    let ratio = |i: usize| if scale > 0.0 { eigen.eigenvalues[i] / scale } else { 0.0 };
    // A negative stiffness (a spring of the user's) is no mechanism.
    let loose: Vec<usize> = (0..n).filter(|&i| ratio(i).abs() < limit).collect();
    // Each row says direction . u = 0; Gauss-Jordan with complete pivoting solves for one member each.
    let mut rows = DMatrix::from_fn(loose.len(), n, |i, j| eigen.eigenvectors[(j, loose[i])]);
    let mut pivots = Vec::with_capacity(loose.len());
    for step in 0..loose.len() {
        let (row, column) = rows.view((step, 0), (loose.len() - step, n)).iamax_full();
        rows.swap_rows(step, step + row);
        let pivot = rows[(step, column)];
        rows.row_mut(step).unscale_mut(pivot);
        for other in (0..loose.len()).filter(|&o| o != step) {
            let factor = rows[(other, column)];
            let change = rows.row(step) * factor;
            rows.row_mut(other).zip_apply(&change, |v, c| *v -= c);
        }
        pivots.push(column);
    }
    pivots
        .iter()
        .enumerate()
        .map(|(i, &pivot)| Released {
            pivot,
            // Factors of round-off size would only fill the matrices.
            on: (0..n)
                .filter(|j| !pivots.contains(j) && rows[(i, *j)].abs() > 1e-6)
                .map(|j| (j, -rows[(i, j)]))
                .collect(),
            direction: rows.row(i).normalize().iter().copied().collect(),
            ratio: ratio(loose[i]),
        })
        .collect()
}

fn combine(on: &[(usize, f64)], rows: &[Vec<(usize, f64)>]) -> Vec<(usize, f64)> {
    let mut sum: Vec<(usize, f64)> = on
        .iter()
        .flat_map(|&(o, c)| rows[o].iter().map(move |&(f, v)| (f, c * v)))
        .collect();
    sum.sort_by_key(|s| s.0);
    sum.dedup_by(|b, a| {
        let same = a.0 == b.0;
        if same {
            a.1 += b.1;
        }
        same
    });
    sum
}
