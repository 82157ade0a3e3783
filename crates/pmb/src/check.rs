//! Checks for developers: the assembled Jacobian against differences of the residual, on any grid and flow.

use dip_krylov::BlockMatrix;

use crate::error::FlowError;
use crate::gas::{Diatomic, Perfect, VARIABLES};
use crate::jacobian::jacobian;
use crate::reconstruct::Reconstruction;
use crate::solver::Equations;

/// The worst difference between the Jacobian's product and the residual's derivative.
#[derive(Clone, Debug, PartialEq)]
pub struct JacobianCheck {
    /// Largest difference, over the largest entry of the derivative.
    pub relative: f64,
    /// Block where it is.
    pub block: String,
    /// Cell where it is.
    pub ijk: [usize; 3],
    /// Equation: 0 mass, 1 to 3 momentum, 4 energy.
    pub equation: usize,
}

/// Multiplies the first-order Jacobian (in double precision) with a repeatable direction that changes every variable of
/// every cell, and compares with a central difference of the first-order residual along it. Rows of cells that touch
/// another block are left out, since their couplings are kept elsewhere.
///
/// # Errors
/// If the flow is not physical.
pub fn check_jacobian(equations: &mut Equations) -> Result<JacobianCheck, FlowError> {
    equations.check()?;
    let scheme = equations.scheme.with(Reconstruction::Constant);
    let n = equations.len();
    let mut base = vec![0.0; n];
    let level = equations.level.clone();
    equations.field.store(&level, &mut base);
    let mut scratch = vec![0.0; n];
    equations.residual_with(&scheme, &mut scratch);
    let mut matrices: Vec<BlockMatrix<f64>> = level
        .blocks
        .iter()
        .map(|b| BlockMatrix::zeros(b.layout.cells))
        .collect();
    let (boundaries, sides, field) = (&equations.boundaries, &equations.sides, &equations.field);
    if scheme.gamma == 1.4 {
        jacobian(&Diatomic, &level, boundaries, sides, field, &mut matrices);
    } else {
        jacobian(
            &Perfect { gamma: scheme.gamma },
            &level,
            boundaries,
            sides,
            field,
            &mut matrices,
        );
    }
    let direction: Vec<f64> = base
        .iter()
        .enumerate()
        .map(|(m, w)| (1.0 + w.abs()) * (m as f64 * 0.7391).sin())
        .collect();
    let step = 2e-6;
    let mut forward = vec![0.0; n];
    equations.field.combine(&level, &base, step, &direction);
    equations.residual_with(&scheme, &mut forward);
    equations.field.combine(&level, &base, -step, &direction);
    equations.residual_with(&scheme, &mut scratch);
    for (f, b) in forward.iter_mut().zip(&scratch) {
        *f = (*f - b) / (2.0 * step);
    }
    equations.field.load(&level, &base);

    let mut touching = vec![false; level.cell_count];
    for c in level.couplings() {
        touching[level.blocks[c.block as usize].offset + c.cell as usize] = true;
    }
    let largest = forward
        .iter()
        .fold(0.0_f64, |m, v| m.max(v.abs()))
        .max(f64::MIN_POSITIVE);
    let mut worst = JacobianCheck {
        relative: 0.0,
        block: String::new(),
        ijk: [0; 3],
        equation: 0,
    };
    for (block, matrix) in level.blocks.iter().zip(&matrices) {
        let cells = block.layout.cells;
        let range = block.offset * VARIABLES..(block.offset + matrix.cell_count()) * VARIABLES;
        let mut product = vec![0.0; range.len()];
        matrix.apply(&direction[range.clone()], &mut product);
        for (m, (p, d)) in product.iter().zip(&forward[range]).enumerate() {
            let cell = m / VARIABLES;
            let relative = (p - d).abs() / largest;
            if !touching[block.offset + cell] && (relative.is_nan() || relative > worst.relative) {
                worst = JacobianCheck {
                    relative,
                    block: block.name.clone(),
                    ijk: [
                        cell % cells[0],
                        (cell / cells[0]) % cells[1],
                        cell / (cells[0] * cells[1]),
                    ],
                    equation: m % VARIABLES,
                };
            }
        }
    }
    Ok(worst)
}
