//! Bar element: axial force, torsion, bending in two planes, with offsets and pin flags.
//!
//! Przemieniecki, Theory of Matrix Structural Analysis, (5.116) with shear flexibility; product moment,
//! shear factors and pin flags as Nastran's CBAR has them (NASTRAN Theoretical Manual 5.2):
//! shear factors are ignored when I12 is not zero.

use nalgebra::{DMatrix, Matrix3, SMatrix, Vector3};

use crate::element::Bar;
use crate::error::ModelError;
use crate::model::{MassForm, Settings};
use crate::section::BarSection;
use crate::shell::{ElementMatrices, to_element};

type Matrix12 = SMatrix<f64, 12, 12>;

/// Stiffness and mass of `bar` between nodes at `points` over their displacements and rotations
/// in basic axes.
pub(crate) fn matrices(
    bar: &Bar,
    section: &BarSection,
    points: &[Vector3<f64>; 2],
    settings: &Settings,
) -> Result<ElementMatrices, ModelError> {
    let place = || format!("bar {}", bar.id);
    let along = points[1] + bar.offsets[1] - points[0] - bar.offsets[0];
    let length = along.norm();
    let scale = points[0].norm().max(points[1].norm()).max(length);
    if length.is_nan() || length <= 1e-12 * scale || length == 0.0 {
        return Err(ModelError::BadElement {
            place: place(),
            problem: "no length between its ends",
            measure: length,
            limit: 1e-12 * scale,
        });
    }
    let x = along / length;
    // A rod, or a bar that is alike in all directions, needs no orientation.
    let alike = section.i1 == section.i2 && section.i12 == 0.0 && section.k1 == section.k2;
    let orientation = if bar.orientation == Vector3::zeros() && alike {
        Vector3::ith(x.iamin(), 1.0)
    } else {
        bar.orientation
    };
    let normal = x.cross(&orientation);
    if normal.norm().is_nan() || normal.norm() <= 1e-6 * orientation.norm() {
        return Err(ModelError::BadValue {
            place: place(),
            name: "the orientation vector",
            needed: "a vector that is not along the bar",
            got: format!("{:?}", orientation.as_slice()),
        });
    }
    let z = normal.normalize();
    let axes = Matrix3::from_columns(&[x, z.cross(&x), z]);
    let mut k = stiffness(section, length);
    for (end, pins) in bar.pins.iter().enumerate() {
        for dof in pins.iter() {
            release(&mut k, 6 * end + dof.index());
        }
    }
    let m = match settings.mass {
        MassForm::Lumped => mass_lumped(section, length),
        MassForm::Consistent | MassForm::Mean => mass_consistent(section, length),
    };
    let turn = to_element(&axes, &bar.offsets);
    let dynamic = |m: &Matrix12| DMatrix::from_fn(12, 12, |i, j| m[(i, j)]);
    Ok(ElementMatrices {
        stiffness: turn.tr_mul(&dynamic(&k)) * &turn,
        mass: turn.tr_mul(&dynamic(&m)) * &turn,
    })
}

/// Places in the 12 degrees of freedom, and sign of the rotation, of bending in plane 1 (v, theta_z)
/// and plane 2 (w, theta_y): a positive rotation about y lowers the far end in z.
const PLANES: [([usize; 4], f64); 2] = [([1, 5, 7, 11], 1.0), ([2, 4, 8, 10], -1.0)];

fn stiffness(s: &BarSection, length: f64) -> Matrix12 {
    let mut k = Matrix12::zeros();
    for (at, value) in [(0, s.young * s.area / length), (3, s.shear * s.j / length)] {
        k[(at, at)] += value;
        k[(at + 6, at + 6)] += value;
        k[(at, at + 6)] -= value;
        k[(at + 6, at)] -= value;
    }
    let sheared = |k: Option<f64>| {
        if s.i12 == 0.0 {
            k.filter(|&k| k > 0.0 && s.area > 0.0)
        } else {
            None
        }
    };
    for (plane, inertia, factor) in [(0, s.i1, sheared(s.k1)), (1, s.i2, sheared(s.k2))] {
        let ei = s.young * inertia;
        let phi = factor.map_or(0.0, |f| 12.0 * ei / (f * s.shear * s.area * length * length));
        add_bending(&mut k, plane, plane, ei / (1.0 + phi), length, phi);
    }
    if s.i12 != 0.0 {
        add_bending(&mut k, 0, 1, s.young * s.i12, length, 0.0);
        add_bending(&mut k, 1, 0, s.young * s.i12, length, 0.0);
    }
    k
}

/// EI v1'' v2'' integrated over the length, for the rows of one plane and the columns of another.
fn add_bending(k: &mut Matrix12, row_plane: usize, column_plane: usize, ei: f64, l: f64, phi: f64) {
    let unit = [
        [12.0, 6.0 * l, -12.0, 6.0 * l],
        [6.0 * l, (4.0 + phi) * l * l, -6.0 * l, (2.0 - phi) * l * l],
        [-12.0, -6.0 * l, 12.0, -6.0 * l],
        [6.0 * l, (2.0 - phi) * l * l, -6.0 * l, (4.0 + phi) * l * l],
    ];
    add_planes(k, row_plane, column_plane, &unit, ei / l.powi(3));
}

fn add_planes(m: &mut Matrix12, row_plane: usize, column_plane: usize, unit: &[[f64; 4]; 4], factor: f64) {
    let ((rows, row_sign), (columns, column_sign)) = (PLANES[row_plane], PLANES[column_plane]);
    for i in 0..4 {
        for j in 0..4 {
            let sign = if i % 2 == 1 { row_sign } else { 1.0 } * if j % 2 == 1 { column_sign } else { 1.0 };
            m[(rows[i], columns[j])] += sign * factor * unit[i][j];
        }
    }
}

/// Frees one degree of freedom of the element: it carries no force and is eliminated.
fn release(k: &mut Matrix12, at: usize) {
    let pivot = k[(at, at)];
    if pivot > 0.0 {
        let row = k.row(at).into_owned();
        *k -= row.transpose() * row / pivot;
    }
    k.row_mut(at).fill(0.0);
    k.column_mut(at).fill(0.0);
}

/// Half of the mass at each end, no rotary inertia but the section's polar inertia.
fn mass_lumped(s: &BarSection, length: f64) -> Matrix12 {
    let half = 0.5 * (s.density * s.area + s.nonstructural_mass) * length;
    let polar = 0.5 * s.polar_inertia * length;
    let mut m = Matrix12::zeros();
    for end in [0, 6] {
        for axis in 0..3 {
            m[(end + axis, end + axis)] = half;
        }
        m[(end + 3, end + 3)] = polar;
    }
    m
}

/// Cubic bending; axial and polar terms are the mean of lumped and linear (5/12, 1/12), which is
/// more accurate than either. Nastran's CBAR: 175/420 and 35/420 axially, no polar inertia.
fn mass_consistent(s: &BarSection, length: f64) -> Matrix12 {
    let mass = (s.density * s.area + s.nonstructural_mass) * length;
    let l = length;
    let unit = [
        [156.0, 22.0 * l, 54.0, -13.0 * l],
        [22.0 * l, 4.0 * l * l, 13.0 * l, -3.0 * l * l],
        [54.0, 13.0 * l, 156.0, -22.0 * l],
        [-13.0 * l, -3.0 * l * l, -22.0 * l, 4.0 * l * l],
    ];
    let mut m = Matrix12::zeros();
    for (at, value) in [(0, mass), (3, s.polar_inertia * l)] {
        m[(at, at)] = 5.0 / 12.0 * value;
        m[(at + 6, at + 6)] = 5.0 / 12.0 * value;
        m[(at, at + 6)] = value / 12.0;
        m[(at + 6, at)] = value / 12.0;
    }
    for plane in 0..2 {
        add_planes(&mut m, plane, plane, &unit, mass / 420.0);
    }
    m
}
