//! Elements without extent: concentrated masses and general elements, as small matrices.

use nalgebra::{DMatrix, Matrix3, Matrix6};

use crate::element::{GeneralElement, GeneralMatrix, NodeMass};
use crate::error::ModelError;

/// Node that carries the mass, and its matrix over displacement and rotation in basic axes.
///
/// A mass m at arm r with inertia I about its centre of gravity moves with u + theta x r, so
/// M = [[m 1, -m r~], [m r~, I - m r~ r~]] with r~ v = r x v.
pub(crate) fn node_mass(mass: &NodeMass) -> Result<(u32, Matrix6<f64>), ModelError> {
    let (node, matrix, place) = match mass {
        NodeMass::Point {
            id,
            node,
            mass,
            offset,
            inertia,
            axes,
        } => {
            let r = (axes * offset).cross_matrix();
            let inertia = axes * inertia * axes.transpose();
            let mut m = Matrix6::zeros();
            m.fixed_view_mut::<3, 3>(0, 0).copy_from(&(Matrix3::identity() * *mass));
            m.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-r * *mass));
            m.fixed_view_mut::<3, 3>(3, 0).copy_from(&(r * *mass));
            m.fixed_view_mut::<3, 3>(3, 3).copy_from(&(inertia - r * r * *mass));
            (*node, m, format!("concentrated mass {id}"))
        }
        NodeMass::Matrix { id, node, mass, axes } => {
            let mut turn = Matrix6::zeros();
            turn.fixed_view_mut::<3, 3>(0, 0).copy_from(axes);
            turn.fixed_view_mut::<3, 3>(3, 3).copy_from(axes);
            (*node, turn * mass * turn.transpose(), format!("concentrated mass {id}"))
        }
    };
    let skew = (matrix - matrix.transpose()).abs().max();
    if skew.is_nan() || skew > 1e-9 * matrix.abs().max() || matrix.iter().any(|v| !v.is_finite()) {
        return Err(ModelError::BadValue {
            place,
            name: "the mass matrix",
            needed: "finite and symmetric values",
            got: format!("{matrix}"),
        });
    }
    Ok((node, matrix))
}

/// Stiffness of a general element over `dofs` followed by `rigid_dofs`.
///
/// From u_i = Z f_i + S u_d and equilibrium f_d = -S^T f_i (NASTRAN Theoretical Manual 5.7):
/// K = [[Z^-1, -Z^-1 S], [-S^T Z^-1, S^T Z^-1 S]].
pub(crate) fn general_stiffness(g: &GeneralElement) -> Result<DMatrix<f64>, ModelError> {
    let n = g.dofs.len();
    let place = || format!("general element {}", g.id);
    let bad = |name, needed, got: String| {
        Err(ModelError::BadValue {
            place: place(),
            name,
            needed,
            got,
        })
    };
    let (GeneralMatrix::Flexibility(given) | GeneralMatrix::Stiffness(given)) = &g.matrix;
    if given.nrows() != n || given.ncols() != n {
        return bad(
            "the matrix",
            "one row and column per degree of freedom",
            format!("{:?}", given.shape()),
        );
    }
    if given.iter().any(|v| !v.is_finite()) {
        return bad("the matrix", "finite values", "a value that is not".to_owned());
    }
    let scale = given.abs().max();
    if (given - given.transpose()).abs().max() > 1e-6 * scale {
        return bad("the matrix", "symmetry", format!("{given}"));
    }
    let symmetric = (given + given.transpose()) * 0.5;
    let k = match &g.matrix {
        GeneralMatrix::Stiffness(_) => symmetric,
        // LU and not Cholesky: measured influence coefficients need not be positive definite.
        GeneralMatrix::Flexibility(_) => {
            // Displacements and rotations differ in size by orders: judge singularity on Z scaled by its diagonal.
            let d = symmetric
                .diagonal()
                .map(|v| if v > 0.0 { v.sqrt().recip() } else { 1.0 });
            let scaled = DMatrix::from_fn(n, n, |i, j| symmetric[(i, j)] * d[i] * d[j]);
            match scaled.try_inverse() {
                Some(inverse) if inverse.iter().all(|v| v.is_finite()) && inverse.abs().max() < 1e14 => {
                    DMatrix::from_fn(n, n, |i, j| 0.5 * (inverse[(i, j)] + inverse[(j, i)]) * d[i] * d[j])
                }
                _ => {
                    return bad(
                        "the flexibility matrix",
                        "a matrix that can be inverted",
                        format!("{given}"),
                    );
                }
            }
        }
    };
    let Some(s) = &g.s else {
        if g.rigid_dofs.is_empty() {
            return Ok(k);
        }
        return bad(
            "the matrix S",
            "one, because rigid degrees of freedom are listed",
            "none".to_owned(),
        );
    };
    let r = g.rigid_dofs.len();
    if s.nrows() != n || s.ncols() != r || s.iter().any(|v| !v.is_finite()) {
        return bad(
            "the matrix S",
            "finite values, rows as Z and columns as rigid degrees of freedom",
            format!("{:?}", s.shape()),
        );
    }
    let ks = &k * s;
    let mut full = DMatrix::zeros(n + r, n + r);
    full.view_mut((0, 0), (n, n)).copy_from(&k);
    full.view_mut((0, n), (n, r)).copy_from(&-&ks);
    full.view_mut((n, 0), (r, n)).copy_from(&-ks.transpose());
    full.view_mut((n, n), (r, r)).copy_from(&s.tr_mul(&ks));
    Ok(full)
}
