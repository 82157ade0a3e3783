//! The assembled structure: free stiffness and mass, static solution, static reduction.

use std::fmt;

use faer::{Mat, Par};
use sprs::CsMat;

use crate::assemble::{NodeMatrices, assemble};
use crate::dof::{DOFS_PER_NODE, Dof};
use crate::element::NodeDof;
use crate::error::ModelError;
use crate::factor::Pencil;
use crate::model::{Model, NodeIndex};
use crate::modes::ModeNode;
use crate::reduce::{AutoSupport, Constraints, Reduction};

/// A pivot below this fraction of its diagonal means that something moves freely (Nastran's MAXRATIO,
/// 1e7, is a warning; a plate of 200 x 200 elements comes down to 1e-8 without being loose).
const PIVOT_LIMIT: f64 = 1e-12;

/// A structure ready to be solved.
#[derive(Clone)]
pub struct System {
    pub(crate) nodes: Vec<ModeNode>,
    pub(crate) scalar: Vec<bool>,
    pub(crate) index: NodeIndex,
    pub(crate) full: NodeMatrices,
    pub(crate) reduction: Reduction,
    /// Stiffness of the free degrees of freedom, symmetric, stored in full.
    pub stiffness: CsMat<f64>,
    /// Mass of the free degrees of freedom, symmetric, stored in full.
    pub mass: CsMat<f64>,
    /// What was supported automatically.
    pub auto_supports: Vec<AutoSupport>,
    /// Places in the free degrees of freedom of the analysis set, ascending; empty: no reduction.
    pub(crate) analysis: Vec<usize>,
}

impl fmt::Debug for System {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("System")
            .field("nodes", &self.nodes.len())
            .field("free", &self.size())
            .field("analysis", &self.analysis_size())
            .field("auto_supports", &self.auto_supports.len())
            .finish_non_exhaustive()
    }
}

/// A structure reduced to its analysis set.
pub(crate) struct Condensed {
    /// Stiffness over the analysis set.
    pub stiffness: Mat<f64>,
    /// Mass over the analysis set.
    pub mass: Mat<f64>,
    /// Free motion per motion of the analysis set, [free][analysis].
    pub motion: Mat<f64>,
}

impl Model {
    /// Assembles stiffness and mass and applies all constraints.
    ///
    /// # Errors
    /// [`ModelError`] naming the element, constraint or node that is wrong.
    pub fn assemble(&self) -> Result<System, ModelError> {
        let index = self.node_index()?;
        let full = assemble(self, &index)?;
        let mut constraints = Constraints::new(self, &index)?;
        let mut reduction = constraints.reduction(self)?;
        let mut stiffness = reduction.apply(&full.stiffness);
        let mut auto_supports = Vec::new();
        if let Some(limit) = self.settings.auto_support {
            auto_supports = constraints.support_automatically(self, &index, &reduction, &stiffness, limit)?;
            if !auto_supports.is_empty() {
                reduction = constraints.reduction(self)?;
                stiffness = reduction.apply(&full.stiffness);
            }
        }
        if reduction.free.is_empty() {
            return Err(ModelError::Empty {
                nodes: self.nodes.len(),
            });
        }
        let mass = reduction.apply(&full.mass);
        let mut analysis = Vec::new();
        for &(node, dofs) in &self.analysis_set {
            let n = index.find(node, || "the analysis set".to_owned())?;
            // Those that are fixed or dependent have no equation of their own.
            analysis.extend(
                dofs.iter()
                    .filter_map(|d| reduction.free.binary_search(&(DOFS_PER_NODE * n + d.index())).ok()),
            );
        }
        analysis.sort_unstable();
        analysis.dedup();
        if analysis.is_empty() && !self.analysis_set.is_empty() {
            return Err(ModelError::EmptyAnalysisSet);
        }
        let nodes = self
            .nodes
            .iter()
            .map(|n| ModeNode {
                id: n.id,
                position: n.position,
                frame: n.frame,
            })
            .collect();
        let scalar = self.nodes.iter().map(|n| n.scalar).collect();
        Ok(System {
            nodes,
            scalar,
            index,
            full,
            reduction,
            stiffness,
            mass,
            auto_supports,
            analysis,
        })
    }
}

impl System {
    /// Number of free degrees of freedom.
    pub fn size(&self) -> usize {
        self.reduction.free.len()
    }

    /// Number of degrees of freedom of the eigenproblem: the analysis set, or all free ones.
    pub fn analysis_size(&self) -> usize {
        if self.analysis.is_empty() {
            self.size()
        } else {
            self.analysis.len()
        }
    }

    /// Nodes in the order of results.
    pub fn nodes(&self) -> &[ModeNode] {
        &self.nodes
    }

    /// Node and degree of freedom of a free one.
    pub(crate) fn name(&self, free: usize) -> (u32, Dof) {
        let at = self.reduction.free[free];
        (
            self.nodes[at / DOFS_PER_NODE].id,
            Dof::from_index(at % DOFS_PER_NODE).unwrap_or(Dof::T1),
        )
    }

    /// Motion of all nodes [node][degree of freedom], node frames, from that of the free ones.
    pub(crate) fn expand(&self, free: &[f64]) -> Vec<[f64; DOFS_PER_NODE]> {
        let all = self.reduction.expand(free);
        all.chunks_exact(DOFS_PER_NODE)
            .map(|c| std::array::from_fn(|i| c[i]))
            .collect()
    }

    pub(crate) fn mechanism(&self, free: usize, ratio: f64) -> ModelError {
        let (node, dof) = self.name(free);
        ModelError::Mechanism { node, dof, ratio }
    }

    /// Motion of all nodes, [node][degree of freedom] in node frames, under forces and moments given
    /// in node frames.
    ///
    /// # Errors
    /// [`ModelError::Mechanism`] when the structure can move without strain.
    pub fn displacements(&self, loads: &[(NodeDof, f64)]) -> Result<Vec<[f64; DOFS_PER_NODE]>, ModelError> {
        let mut all = vec![0.0; DOFS_PER_NODE * self.nodes.len()];
        for &(at, value) in loads {
            all[self.index.find_dof(at, || "a load".to_owned())?] += value;
        }
        let mut x = self.reduction.gather(&all);
        let none = CsMat::zero((self.size(), self.size()));
        let pencil = Pencil::new(&self.stiffness, &none)?;
        let factor = pencil.factor(0.0)?;
        if let Some((free, ratio)) = factor.loose(&pencil.diagonals().0, PIVOT_LIMIT) {
            return Err(self.mechanism(free, ratio));
        }
        factor.solve(&mut x, 1)?;
        Ok(self.expand(&x))
    }

    /// Strain energy of a motion of all nodes, 1/2 u^T K u, [node][degree of freedom] in node frames.
    pub fn strain_energy(&self, motion: &[[f64; DOFS_PER_NODE]]) -> f64 {
        let u: Vec<f64> = motion.iter().flatten().copied().collect();
        self.full
            .stiffness
            .outer_iterator()
            .zip(&u)
            .map(|(row, ui)| 0.5 * ui * row.iter().map(|(j, k)| k * u[j]).sum::<f64>())
            .sum()
    }

    /// Guyan's static reduction to the analysis set: u_o = -K_oo^-1 K_oa u_a
    /// (Guyan, AIAA J. 3 (1965), p. 380).
    pub(crate) fn condense(&self) -> Result<Condensed, ModelError> {
        let (n, na) = (self.size(), self.analysis.len());
        let mut place_a = vec![usize::MAX; n];
        for (i, &f) in self.analysis.iter().enumerate() {
            place_a[f] = i;
        }
        let omitted: Vec<usize> = (0..n).filter(|&f| place_a[f] == usize::MAX).collect();
        let mut place_o = vec![usize::MAX; n];
        for (i, &f) in omitted.iter().enumerate() {
            place_o[f] = i;
        }
        let mut motion = Mat::<f64>::zeros(n, na);
        for (i, &f) in self.analysis.iter().enumerate() {
            motion[(f, i)] = 1.0;
        }
        if !omitted.is_empty() {
            let no = omitted.len();
            let mut oo = sprs::TriMat::new((no, no));
            let mut x = vec![0.0; no * na];
            for (i, &f) in omitted.iter().enumerate() {
                if let Some(row) = self.stiffness.outer_view(f) {
                    for (j, &k) in row.iter() {
                        match place_a[j] {
                            usize::MAX => oo.add_triplet(i, place_o[j], k),
                            a => x[a * no + i] = -k,
                        }
                    }
                }
            }
            let none = CsMat::zero((no, no));
            let pencil = Pencil::new(&oo.to_csr(), &none)?;
            let factor = pencil.factor(0.0)?;
            if let Some((o, ratio)) = factor.loose(&pencil.diagonals().0, PIVOT_LIMIT) {
                return Err(self.mechanism(omitted[o], ratio));
            }
            factor.solve(&mut x, na)?;
            for a in 0..na {
                for (i, &f) in omitted.iter().enumerate() {
                    motion[(f, a)] = x[a * no + i];
                }
            }
        }
        let reduce = |m: &CsMat<f64>| {
            let mut product = Mat::<f64>::zeros(n, na);
            for (i, row) in m.outer_iterator().enumerate() {
                for (j, &v) in row.iter() {
                    for a in 0..na {
                        product[(i, a)] += v * motion[(j, a)];
                    }
                }
            }
            let mut out = Mat::<f64>::zeros(na, na);
            faer::linalg::matmul::matmul(
                out.as_mut(),
                faer::Accum::Replace,
                motion.transpose(),
                product.as_ref(),
                1.0,
                Par::Seq,
            );
            Mat::from_fn(na, na, |i, j| 0.5 * (out[(i, j)] + out[(j, i)]))
        };
        Ok(Condensed {
            stiffness: reduce(&self.stiffness),
            mass: reduce(&self.mass),
            motion,
        })
    }
}
