//! A wing as a plate of solid material: mesh, thickness and root clamp of a quadrilateral planform.

use nalgebra::Vector3;

use crate::dof::DofSet;
use crate::element::{MaterialAxis, Node, Shell, ShellNodes, ShellThickness};
use crate::error::WingError;
use crate::material::Material;
use crate::model::Model;
use crate::ordinates::Ordinates;
use crate::section::ShellSection;
use crate::shell::quad_points;

/// Planform by its corners, metres (or any consistent unit).
#[derive(Debug, Clone, PartialEq)]
pub struct Planform {
    /// Leading edge at the root.
    pub root_leading: Vector3<f64>,
    /// Trailing edge at the root.
    pub root_trailing: Vector3<f64>,
    /// Leading edge at the tip.
    pub tip_leading: Vector3<f64>,
    /// Trailing edge at the tip.
    pub tip_trailing: Vector3<f64>,
}

impl Planform {
    /// Point at chord fraction `x` and span fraction `y`.
    pub fn point(&self, x: f64, y: f64) -> Vector3<f64> {
        let leading = self.root_leading.lerp(&self.tip_leading, y);
        let trailing = self.root_trailing.lerp(&self.tip_trailing, y);
        leading.lerp(&trailing, x)
    }

    /// Chord at span fraction `y`.
    pub fn chord(&self, y: f64) -> f64 {
        (self.point(1.0, y) - self.point(0.0, y)).norm()
    }
}

/// How the thickness of an element follows from the section.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ThicknessRule {
    /// The section at the nodes, bilinear inside the element.
    Nodal,
    /// One thickness for the element: the mean of the section at its four nodes.
    ElementMean,
    /// The section itself at the integration points.
    #[default]
    ExactSection,
}

/// Which nodes of the root are clamped (all six degrees of freedom).
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum RootClamp {
    /// All of them.
    #[default]
    All,
    /// Those listed, counted from 1 at the leading edge. Yates clamped 3 to 9 of 11.
    Nodes(Vec<usize>),
    /// None: a free wing.
    Free,
}

/// A plate wing. Nodes are numbered 1 + i + chordwise j, i from the leading edge, j from the root.
#[derive(Debug, Clone, PartialEq)]
pub struct PlateWing {
    /// Planform.
    pub planform: Planform,
    /// Nodes from leading to trailing edge.
    pub chordwise_nodes: usize,
    /// Nodes from root to tip.
    pub spanwise_nodes: usize,
    /// Section, the same in chords at every station.
    pub section: Ordinates,
    /// Thickness rule.
    pub rule: ThicknessRule,
    /// Material.
    pub material: Material,
    /// Direction of the material's 1 axis.
    pub axis: Vector3<f64>,
    /// Root clamp.
    pub root: RootClamp,
}

impl PlateWing {
    /// The finite element model: bending and shear stiffness, no membrane.
    ///
    /// # Errors
    /// [`WingError`] for a mesh without elements or a clamp that names no node of the root.
    pub fn model(&self) -> Result<Model, WingError> {
        let (ni, nj) = (self.chordwise_nodes, self.spanwise_nodes);
        if ni < 2 || nj < 2 {
            return Err(WingError::TooFewNodes {
                chordwise: ni,
                spanwise: nj,
            });
        }
        let station = |k: usize, n: usize| k as f64 / (n - 1) as f64;
        let id = |i: usize, j: usize| (1 + i + ni * j) as u32;
        let mut model = Model::default();
        for j in 0..nj {
            for i in 0..ni {
                let p = self.planform.point(station(i, ni), station(j, nj));
                model.nodes.push(Node::grid(id(i, j), p.x, p.y, p.z));
            }
        }
        model
            .shell_sections
            .push(ShellSection::plate(1, self.material.clone(), 0.0));
        for j in 0..nj - 1 {
            for i in 0..ni - 1 {
                // Leading edge inboard first; the normal points up for a starboard wing.
                let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                model.shells.push(Shell {
                    id: (1 + i + (ni - 1) * j) as u32,
                    nodes: ShellNodes::Quad(corners.map(|(a, b)| id(a, b))),
                    section: 0,
                    thickness: self.thickness(corners.map(|(a, b)| [station(a, ni), station(b, nj)])),
                    axis: MaterialAxis::Along(self.axis),
                    offset: 0.0,
                });
            }
        }
        let clamped: Vec<usize> = match &self.root {
            RootClamp::All => (1..=ni).collect(),
            RootClamp::Nodes(list) => list.clone(),
            RootClamp::Free => Vec::new(),
        };
        if let Some(&wrong) = clamped.iter().find(|&&n| n == 0 || n > ni) {
            return Err(WingError::RootNode { node: wrong, last: ni });
        }
        if clamped.is_empty() && self.root != RootClamp::Free {
            return Err(WingError::RootNode { node: 0, last: ni });
        }
        model.supports = clamped.into_iter().map(|n| (id(n - 1, 0), DofSet::ALL)).collect();
        Ok(model)
    }

    /// Thickness of the element whose corners lie at (chord fraction, span fraction).
    fn thickness(&self, corners: [[f64; 2]; 4]) -> ShellThickness {
        let at = |x: f64, y: f64| self.section.thickness(x) * self.planform.chord(y);
        let nodal = corners.map(|[x, y]| at(x, y));
        match self.rule {
            ThicknessRule::Nodal => ShellThickness::Corner(nodal),
            ThicknessRule::ElementMean => ShellThickness::Uniform(nodal.iter().sum::<f64>() / 4.0),
            ThicknessRule::ExactSection => ShellThickness::Integration(quad_points().map(|[xi, eta]| {
                let blend = |a: f64, b: f64, s: f64| a + 0.5 * (1.0 + s) * (b - a);
                at(
                    blend(corners[0][0], corners[1][0], xi),
                    blend(corners[0][1], corners[3][1], eta),
                )
            })),
        }
    }
}
