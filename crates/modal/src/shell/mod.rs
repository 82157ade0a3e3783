//! Shell elements: stiffness and mass of one triangle or quadrilateral.
//!
//! Bending and transverse shear by DKMT and DKMQ (`bending.rs`); membrane by the constant-strain triangle
//! and the quadrilateral with incompatible modes of Taylor, Beresford and Wilson, "A non-conforming element
//! for stress analysis", IJNME 10 (1976), p. 1211. A small stiffness ties the rotation about the
//! normal to that of the membrane: alpha integral (theta_z - (v,x - u,y)/2)^2, as Nastran's K6ROT.
//! Elements are flat: the corners of a warped one hang on its mean plane by rigid arms.

mod bending;
mod field;
mod geometry;

pub use geometry::{ShellPlane, quad_points, triangle_points};

use nalgebra::{DMatrix, Matrix3, SMatrix, Vector3};

use crate::element::{MaterialAxis, Shell, ShellThickness};
use crate::error::ModelError;
use crate::model::{MassForm, Settings};
use crate::section::{ShellSection, ShellStiffness};
use bending::{Side, quad_bubbles, quad_shear, triangle_bubbles, triangle_shear};
use field::SectionField;
use geometry::{Jacobian, quad_shape, quad_shape_derivatives};

/// Stiffness and mass of an element over the six degrees of freedom of each of its nodes, basic axes:
/// [row][column], 6 x node + degree of freedom.
#[derive(Debug, Clone)]
pub(crate) struct ElementMatrices {
    pub stiffness: DMatrix<f64>,
    pub mass: DMatrix<f64>,
}

/// Degrees of freedom of a quadrilateral with its four incompatible membrane modes, and of a triangle.
const QUAD: usize = 28;
const TRIANGLE: usize = 18;

/// Strains at a point as rows over the element's degrees of freedom (u, v, w, theta_x, theta_y,
/// theta_z of each corner, then incompatible modes), in element axes.
struct StrainRows<const N: usize> {
    /// e_x, e_y, gamma_xy of the middle surface.
    membrane: [[f64; N]; 3],
    /// beta_x,x; beta_y,y; beta_x,y + beta_y,x.
    curvature: [[f64; N]; 3],
    /// gamma_xz, gamma_yz.
    shear: [[f64; N]; 2],
    /// theta_z - (v,x - u,y) / 2.
    drilling: [f64; N],
}

impl<const N: usize> StrainRows<N> {
    fn zero() -> Self {
        Self {
            membrane: [[0.0; N]; 3],
            curvature: [[0.0; N]; 3],
            shear: [[0.0; N]; 2],
            drilling: [0.0; N],
        }
    }

    /// Membrane strain of a displacement field with gradient (`dx`, `dy`) whose degrees of freedom u, v
    /// are the columns `u`, `v`.
    fn add_membrane(&mut self, u: usize, v: usize, [dx, dy]: [f64; 2]) {
        self.membrane[0][u] += dx;
        self.membrane[1][v] += dy;
        self.membrane[2][u] += dy;
        self.membrane[2][v] += dx;
    }

    /// Curvature of rotations (beta_x, beta_y) = `weight` x degree of freedom `column` x a function
    /// with gradient (`dx`, `dy`).
    fn add_curvature(&mut self, column: usize, weight: [f64; 2], [dx, dy]: [f64; 2]) {
        self.curvature[0][column] += weight[0] * dx;
        self.curvature[1][column] += weight[1] * dy;
        self.curvature[2][column] += weight[0] * dy + weight[1] * dx;
    }

    /// Corner `i`: its bilinear (linear) parts.
    fn add_corner(&mut self, i: usize, shape: f64, gradient: [f64; 2]) {
        let at = 6 * i;
        self.add_membrane(at, at + 1, gradient);
        self.drilling[at] += 0.5 * gradient[1];
        self.drilling[at + 1] -= 0.5 * gradient[0];
        self.drilling[at + 5] += shape;
        // beta_x = theta_y, beta_y = -theta_x.
        self.add_curvature(at + 4, [1.0, 0.0], gradient);
        self.add_curvature(at + 3, [0.0, -1.0], gradient);
    }

    /// The bubble of a side, and the shear strain `shear` per mean shear strain of the side.
    fn add_side(&mut self, side: &Side, bubble: [f64; 2], shear: [f64; 2]) {
        let ratio = side.shear_per_delta();
        for (corner, [w, beta_x, beta_y]) in [side.i, side.j].into_iter().zip(side.delta()) {
            for (column, delta) in [(2, w), (3, -beta_y), (4, beta_x)] {
                let column = 6 * corner + column;
                self.add_curvature(column, [side.c * delta, side.s * delta], bubble);
                self.shear[0][column] += shear[0] * ratio * delta;
                self.shear[1][column] += shear[1] * ratio * delta;
            }
        }
    }

    /// Adds `weight` times twice the strain energy's matrix to `k`.
    fn add_energy(&self, k: &mut SMatrix<f64, N, N>, s: &ShellStiffness, drilling: f64, weight: f64) {
        let rows = |r: &[[f64; N]; 3]| SMatrix::<f64, 3, N>::from_fn(|i, j| r[i][j]);
        let (m, c) = (rows(&self.membrane), rows(&self.curvature));
        let a: Matrix3<f64> = s.membrane * weight;
        let b = s.coupling * weight;
        let d = s.bending * weight;
        *k += m.tr_mul(&(a * m + b * c)) + c.tr_mul(&(b * m + d * c));
        if let Some(g) = s.shear {
            let t = SMatrix::<f64, 2, N>::from_fn(|i, j| self.shear[i][j]);
            *k += t.tr_mul(&(g * weight * t));
        }
        let alpha = drilling * s.membrane[(2, 2)] * weight;
        if alpha > 0.0 {
            let r = SMatrix::<f64, 1, N>::from_fn(|_, j| self.drilling[j]);
            *k += r.tr_mul(&(r * alpha));
        }
    }
}

/// Mass of an element per pair of corners: translation, and rotation about in-plane axes.
struct CornerMass {
    translation: [[f64; 4]; 4],
    rotation: [[f64; 4]; 4],
}

impl CornerMass {
    fn add(&mut self, shape: &[f64], s: &ShellStiffness, weight: f64) {
        for (i, ni) in shape.iter().enumerate() {
            for (j, nj) in shape.iter().enumerate() {
                self.translation[i][j] += ni * nj * s.mass_per_area * weight;
                self.rotation[i][j] += ni * nj * s.rotary_per_area * weight;
            }
        }
    }

    /// Moves the part `share` of the mass to the diagonal, row by row: the shape functions sum to one,
    /// so the total stays.
    fn lump(&mut self, share: f64) {
        for m in [&mut self.translation, &mut self.rotation] {
            for (i, row) in m.iter_mut().enumerate() {
                let sum: f64 = row.iter().sum();
                row.iter_mut().for_each(|v| *v *= 1.0 - share);
                row[i] += share * sum;
            }
        }
    }
}

/// Angle from the element's x axis (side 1-2) to its material axis.
fn material_angle(shell: &Shell, plane: &ShellPlane, place: &dyn Fn() -> String) -> Result<f64, ModelError> {
    match shell.axis {
        MaterialAxis::Angle(angle) if angle.is_finite() => Ok(angle),
        MaterialAxis::Angle(angle) => Err(ModelError::BadValue {
            place: place(),
            name: "the material angle",
            needed: "a finite angle",
            got: format!("{angle}"),
        }),
        MaterialAxis::Along(v) => {
            let local = plane.axes.tr_mul(&v);
            let in_plane = local.x.hypot(local.y);
            if in_plane.is_nan() || in_plane <= 1e-6 * v.norm() || in_plane == 0.0 {
                return Err(ModelError::BadValue {
                    place: place(),
                    name: "the material direction",
                    needed: "a vector that is not along the element's normal",
                    got: format!("{:?}", v.as_slice()),
                });
            }
            Ok(local.y.atan2(local.x))
        }
    }
}

fn check_thickness(shell: &Shell, corners: usize, place: &dyn Fn() -> String) -> Result<(), ModelError> {
    let values: &[f64] = match &shell.thickness {
        ShellThickness::Section => &[],
        ShellThickness::Uniform(t) => std::slice::from_ref(t),
        ShellThickness::Corner(t) | ShellThickness::Integration(t) => &t[..corners],
    };
    // A single corner may end in a knife edge; an element without any thickness has no stiffness.
    let bad = values.iter().any(|t| !(t.is_finite() && *t >= 0.0))
        || (!values.is_empty() && values.iter().sum::<f64>() <= 0.0);
    if bad || !shell.offset.is_finite() {
        return Err(ModelError::BadValue {
            place: place(),
            name: "thickness or offset",
            needed: "finite values, thickness at least zero and not zero everywhere",
            got: format!("{values:?}, offset {}", shell.offset),
        });
    }
    Ok(())
}

/// Stiffness and mass of `shell` with corners at `points` (basic axes), over displacements and
/// rotations of its nodes in basic axes.
pub(crate) fn matrices(
    shell: &Shell,
    section: &ShellSection,
    points: &[Vector3<f64>],
    settings: &Settings,
) -> Result<ElementMatrices, ModelError> {
    let place = || format!("shell {}", shell.id);
    let plane = ShellPlane::new(points, &place)?;
    check_thickness(shell, points.len(), &place)?;
    let field = SectionField::new(section, shell.thickness, material_angle(shell, &plane, &place)?);
    let drilling = 1e-6 * settings.drilling;
    let (stiffness, mut mass) = if points.len() == 4 {
        quad(&plane, &field, drilling)
    } else {
        triangle(&plane, &field, drilling)
    };
    mass.lump(match settings.mass {
        MassForm::Lumped => 1.0,
        MassForm::Consistent => 0.0,
        MassForm::Mean => 0.5,
    });
    let n = points.len();
    let mut local_mass = DMatrix::zeros(6 * n, 6 * n);
    for i in 0..n {
        for j in 0..n {
            for axis in 0..3 {
                local_mass[(6 * i + axis, 6 * j + axis)] = mass.translation[i][j];
            }
            if settings.rotary_inertia {
                for axis in 3..5 {
                    local_mass[(6 * i + axis, 6 * j + axis)] = mass.rotation[i][j];
                }
            }
        }
    }
    let offset = plane.axes.column(2) * shell.offset;
    let arms: Vec<Vector3<f64>> = plane.to_plane.iter().map(|p| p + offset).collect();
    let turn = to_element(&plane.axes, &arms);
    Ok(ElementMatrices {
        stiffness: turn.tr_mul(&stiffness) * &turn,
        mass: turn.tr_mul(&local_mass) * &turn,
    })
}

/// Matrix that takes displacements and rotations of nodes in basic axes to those of points at `arms`
/// from them in element axes: u_e = E^T (u + theta x r), theta_e = E^T theta.
pub(crate) fn to_element(axes: &Matrix3<f64>, arms: &[Vector3<f64>]) -> DMatrix<f64> {
    let n = arms.len();
    let mut t = DMatrix::zeros(6 * n, 6 * n);
    let et = axes.transpose();
    for (i, r) in arms.iter().enumerate() {
        t.fixed_view_mut::<3, 3>(6 * i, 6 * i).copy_from(&et);
        t.fixed_view_mut::<3, 3>(6 * i + 3, 6 * i + 3).copy_from(&et);
        t.fixed_view_mut::<3, 3>(6 * i, 6 * i + 3)
            .copy_from(&(-et * r.cross_matrix()));
    }
    t
}

fn quad(plane: &ShellPlane, field: &SectionField, drilling: f64) -> (DMatrix<f64>, CornerMass) {
    let corners = &plane.corners;
    let sides: [Side; 4] = std::array::from_fn(|k| {
        let (i, j) = (k, (k + 1) % 4);
        let mut middle = [0.0; 4];
        middle[i] = 0.5;
        middle[j] = 0.5;
        let s = field.at(&middle);
        Side::new(i, j, corners, &s.bending, s.shear.as_ref())
    });
    let (centre_xi, centre_eta) = quad_shape_derivatives(0.0, 0.0);
    let centre = Jacobian::new(&centre_xi, &centre_eta, corners);
    let mut k = SMatrix::<f64, QUAD, QUAD>::zeros();
    let mut mass = CornerMass {
        translation: [[0.0; 4]; 4],
        rotation: [[0.0; 4]; 4],
    };
    for (point, [xi, eta]) in quad_points().into_iter().enumerate() {
        let shape = quad_shape(xi, eta);
        let (d_xi, d_eta) = quad_shape_derivatives(xi, eta);
        let jacobian = Jacobian::new(&d_xi, &d_eta, corners);
        let mut rows = StrainRows::<QUAD>::zero();
        for i in 0..4 {
            rows.add_corner(i, shape[i], jacobian.gradient(d_xi[i], d_eta[i]));
        }
        let bubbles = quad_bubbles(xi, eta, &jacobian);
        let shear = quad_shear(xi, eta, &sides, &jacobian);
        for (s, side) in sides.iter().enumerate() {
            rows.add_side(side, bubbles[s], [shear[0][s], shear[1][s]]);
        }
        // Incompatible modes 1 - xi^2 and 1 - eta^2 with the Jacobian of the centre, so that they do no
        // work on a constant stress (patch test).
        let ratio = centre.det / jacobian.det;
        for (mode, gradient) in [centre.gradient(-2.0 * xi, 0.0), centre.gradient(0.0, -2.0 * eta)]
            .into_iter()
            .enumerate()
        {
            let at = 24 + 2 * mode;
            rows.add_membrane(at, at + 1, gradient.map(|g| g * ratio));
        }
        let s = field.at_point(point, &shape);
        rows.add_energy(&mut k, &s, drilling, jacobian.det);
        mass.add(&shape, &s, jacobian.det);
    }
    (condense_modes(&k), mass)
}

/// Eliminates the four incompatible modes, which have no stiffness when the section has no membrane.
fn condense_modes(k: &SMatrix<f64, QUAD, QUAD>) -> DMatrix<f64> {
    let outer = k.fixed_view::<24, 24>(0, 0).into_owned();
    let inner = k.fixed_view::<4, 4>(24, 24).into_owned();
    let across = k.fixed_view::<4, 24>(24, 0).into_owned();
    let condensed = match inner.cholesky() {
        Some(factor) => outer - across.tr_mul(&factor.solve(&across)),
        None => outer,
    };
    DMatrix::from_fn(24, 24, |i, j| 0.5 * (condensed[(i, j)] + condensed[(j, i)]))
}

fn triangle(plane: &ShellPlane, field: &SectionField, drilling: f64) -> (DMatrix<f64>, CornerMass) {
    let c = &plane.corners;
    let twice_area = 2.0 * plane.area;
    let gradient: [[f64; 2]; 3] = std::array::from_fn(|i| {
        let (j, m) = ((i + 1) % 3, (i + 2) % 3);
        [(c[j][1] - c[m][1]) / twice_area, (c[m][0] - c[j][0]) / twice_area]
    });
    let sides: [Side; 3] = std::array::from_fn(|k| {
        let (i, j) = (k, (k + 1) % 3);
        let mut middle = [0.0; 3];
        middle[i] = 0.5;
        middle[j] = 0.5;
        let s = field.at(&middle);
        Side::new(i, j, c, &s.bending, s.shear.as_ref())
    });
    let mut k = SMatrix::<f64, TRIANGLE, TRIANGLE>::zeros();
    let mut mass = CornerMass {
        translation: [[0.0; 4]; 4],
        rotation: [[0.0; 4]; 4],
    };
    let weight = plane.area / 3.0;
    for (point, l) in triangle_points().into_iter().enumerate() {
        let mut rows = StrainRows::<TRIANGLE>::zero();
        for i in 0..3 {
            rows.add_corner(i, l[i], gradient[i]);
        }
        let bubbles = triangle_bubbles(&l, &gradient);
        let shear = triangle_shear(&l, &sides);
        for (s, side) in sides.iter().enumerate() {
            rows.add_side(side, bubbles[s], [shear[0][s], shear[1][s]]);
        }
        let s = field.at_point(point, &l);
        rows.add_energy(&mut k, &s, drilling, weight);
        mass.add(&l, &s, weight);
    }
    (
        DMatrix::from_fn(TRIANGLE, TRIANGLE, |i, j| 0.5 * (k[(i, j)] + k[(j, i)])),
        mass,
    )
}
