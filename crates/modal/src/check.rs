//! Checks of a model: mass properties, rigid motions, element quality.

use nalgebra::{Matrix3, Matrix6, Vector3};

use crate::constraint::rigid_motions;
use crate::dof::DOFS_PER_NODE;
use crate::element::ShellNodes;
use crate::error::ModelError;
use crate::model::Model;
use crate::shell::ShellPlane;
use crate::system::System;

/// Mass properties of the whole structure, basic axes (Nastran's grid point weight generator).
#[derive(Debug, Clone, PartialEq)]
pub struct MassProperties {
    /// Rigid body mass matrix about the basic origin, [row][column] over displacement and rotation.
    pub rigid: Matrix6<f64>,
    /// Mass: the mean of the masses that move along x, y and z (they differ when scalar masses act
    /// along some axes only; then see `rigid`).
    pub mass: f64,
    /// Centre of gravity.
    pub centre: Vector3<f64>,
    /// Inertia tensor about the centre of gravity.
    pub inertia: Matrix3<f64>,
}

/// How a motion without strain is seen by the stiffness matrix before supports.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidCheck {
    /// For displacement along and rotation about x, y, z: the largest force over the largest sum of the
    /// magnitudes of the terms that it is made of. Round-off for a model without grounded springs.
    pub imbalance: [f64; 6],
}

/// Quality of one shell element.
#[derive(Debug, Clone, PartialEq)]
pub struct ShellQuality {
    /// Element number.
    pub id: u32,
    /// Area.
    pub area: f64,
    /// Longest over shortest side.
    pub aspect: f64,
    /// Height of a node over the mean plane over the root of the area.
    pub warp: f64,
    /// Largest deviation of an interior angle from that of the regular polygon, radians.
    pub skew_rad: f64,
    /// Whether a neighbour that shares a side has its normal on the other side.
    pub flipped: bool,
}

impl System {
    /// Motion of all degrees of freedom in the six rigid motions about the basic origin: [motion][place].
    fn rigid_vectors(&self) -> Vec<Vec<f64>> {
        let mut out = vec![vec![0.0; DOFS_PER_NODE * self.nodes.len()]; 6];
        for (n, node) in self.nodes.iter().enumerate().filter(|(n, _)| !self.scalar[*n]) {
            let motions = rigid_motions(&node.position, &node.frame, &Vector3::zeros());
            for (motion, values) in motions.iter().enumerate() {
                out[motion][DOFS_PER_NODE * n..DOFS_PER_NODE * (n + 1)].copy_from_slice(values);
            }
        }
        out
    }

    /// Mass, centre of gravity and inertia of everything, supported nodes included.
    pub fn mass_properties(&self) -> MassProperties {
        let vectors = self.rigid_vectors();
        let mut rigid = Matrix6::zeros();
        for (j, v) in vectors.iter().enumerate() {
            let mv: Vec<f64> = self
                .full
                .mass
                .outer_iterator()
                .map(|row| row.iter().map(|(c, m)| m * v[c]).sum())
                .collect();
            for (i, u) in vectors.iter().enumerate() {
                rigid[(i, j)] = u.iter().zip(&mv).map(|(a, b)| a * b).sum();
            }
        }
        let m = [rigid[(0, 0)], rigid[(1, 1)], rigid[(2, 2)]];
        let mass = m.iter().sum::<f64>() / 3.0;
        // First moments stand in the coupling -m r~ = m [[0, z, -y], [-z, 0, x], [y, -x, 0]], each twice.
        let arm = |a: usize, b: usize| {
            let total = m[a] + m[b];
            if total > 0.0 {
                (rigid[(a, 3 + b)] - rigid[(b, 3 + a)]) / total
            } else {
                0.0
            }
        };
        let centre = Vector3::new(arm(1, 2), arm(2, 0), arm(0, 1));
        let r = centre.cross_matrix();
        let inertia = rigid.fixed_view::<3, 3>(3, 3) + r * r * mass;
        MassProperties {
            rigid,
            mass,
            centre,
            inertia,
        }
    }

    /// Forces of the unsupported stiffness matrix under rigid motions.
    pub fn rigid_check(&self) -> RigidCheck {
        let mut imbalance = [0.0; 6];
        for (motion, v) in self.rigid_vectors().iter().enumerate() {
            let (mut force, mut size) = (0.0_f64, 0.0_f64);
            for row in self.full.stiffness.outer_iterator() {
                let (mut sum, mut magnitude) = (0.0, 0.0);
                for (j, k) in row.iter() {
                    sum += k * v[j];
                    magnitude += (k * v[j]).abs();
                }
                force = force.max(f64::abs(sum));
                size = size.max(magnitude);
            }
            imbalance[motion] = if size > 0.0 { force / size } else { 0.0 };
        }
        RigidCheck { imbalance }
    }
}

impl Model {
    /// Quality of every shell element, in the order of the model.
    ///
    /// # Errors
    /// [`ModelError::BadElement`] for one without area, with crossed corners, or warped too far;
    /// [`ModelError::UnknownNode`].
    pub fn shell_quality(&self) -> Result<Vec<ShellQuality>, ModelError> {
        let index = self.node_index()?;
        // Two neighbours with normals on one side run along their common side in opposite directions.
        let mut sides: Vec<(u32, u32)> = Vec::new();
        for shell in &self.shells {
            let n = shell.nodes.as_slice();
            sides.extend((0..n.len()).map(|i| (n[i], n[(i + 1) % n.len()])));
        }
        sides.sort_unstable();
        let twice = |s: (u32, u32)| sides.partition_point(|x| *x <= s) - sides.partition_point(|x| *x < s) > 1;
        self.shells
            .iter()
            .map(|shell| {
                let place = || format!("shell {}", shell.id);
                let ids = shell.nodes.as_slice();
                let points = ids
                    .iter()
                    .map(|&n| Ok(self.nodes[index.find(n, place)?].position))
                    .collect::<Result<Vec<_>, ModelError>>()?;
                let plane = ShellPlane::new(&points, &place)?;
                let n = points.len();
                let lengths: Vec<f64> = (0..n).map(|i| (points[(i + 1) % n] - points[i]).norm()).collect();
                let regular = match shell.nodes {
                    ShellNodes::Triangle(_) => std::f64::consts::FRAC_PI_3,
                    ShellNodes::Quad(_) => std::f64::consts::FRAC_PI_2,
                };
                let skew_rad = (0..n)
                    .map(|i| {
                        let (a, b) = (points[(i + 1) % n] - points[i], points[(i + n - 1) % n] - points[i]);
                        (a.angle(&b) - regular).abs()
                    })
                    .fold(0.0, f64::max);
                Ok(ShellQuality {
                    id: shell.id,
                    area: plane.area,
                    aspect: lengths.iter().copied().fold(0.0, f64::max)
                        / lengths.iter().copied().fold(f64::INFINITY, f64::min),
                    warp: plane.warp,
                    skew_rad,
                    flipped: (0..n).any(|i| twice((ids[i], ids[(i + 1) % n]))),
                })
            })
            .collect()
    }
}
