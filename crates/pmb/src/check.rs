//! Checks for developers, on any grid and flow: the assembled Jacobian against differences of the residual, and where
//! the residual is large.

use dip_krylov::{BlockMatrix, vector};
use serde::Serialize;

use crate::error::FlowError;
use crate::field::Field;
use crate::gas::{Diatomic, Perfect, State, VARIABLES};
use crate::jacobian::jacobian;
use crate::reconstruct::Reconstruction;
use crate::solver::Equations;

/// The worst difference between the Jacobian's product and the residual's derivative.
#[derive(Clone, Debug, PartialEq, Serialize)]
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

/// A cell whose residual is among the largest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorstCell {
    /// Name of its block.
    pub block: String,
    /// Cell in the block, from 0.
    pub ijk: [usize; 3],
    /// Equation with its largest residual: 0 mass, 1 to 3 momentum, 4 energy.
    pub equation: usize,
    /// That residual.
    pub residual: f64,
}

/// Size of the residual, non-dimensional (flux times area, by free-stream density and speed and the grid's unit).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResidualReport {
    /// Root of the sum of squares over all cells, by equation.
    pub norms: [f64; VARIABLES],
    /// Largest absolute value, by equation.
    pub largest: [f64; VARIABLES],
    /// The same sum over all equations, of the undisturbed stream on this grid: what orders are counted from.
    pub stream_norm: f64,
    /// Orders of magnitude of `norms` together below it.
    pub orders: f64,
    /// The cells with the largest residuals, largest first.
    pub worst: Vec<WorstCell>,
}

/// Evaluates the residual of the equations' flow into `residual` (`[cell][variable]` over all blocks) and says how large
/// it is, with the `count` worst cells. `stream` is the undisturbed stream.
///
/// # Errors
/// If the flow is not physical.
pub fn report_residual(
    equations: &mut Equations,
    stream: &State<f64>,
    count: usize,
    residual: &mut Vec<f64>,
) -> Result<ResidualReport, FlowError> {
    equations.check()?;
    residual.resize(equations.len(), 0.0);
    let level = equations.level.clone();
    let kept = std::mem::replace(&mut equations.field, Field::uniform(&level, stream));
    equations.residual(residual);
    let stream_norm = vector::norm(residual);
    equations.field = kept;
    equations.residual(residual);

    let mut squares = [0.0; VARIABLES];
    let mut largest = [0.0_f64; VARIABLES];
    let mut cells: Vec<(f64, usize, usize)> = Vec::with_capacity(level.cell_count);
    for (cell, r) in residual.chunks_exact(VARIABLES).enumerate() {
        let mut top = (0.0, 0);
        for (v, r) in r.iter().enumerate() {
            squares[v] += r * r;
            largest[v] = largest[v].max(r.abs());
            if r.abs() > top.0 {
                top = (r.abs(), v);
            }
        }
        cells.push((top.0, cell, top.1));
    }
    // Largest first; equal ones in the order of the cells.
    cells.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let worst = cells
        .into_iter()
        .take(count)
        .filter_map(|(_, cell, equation)| {
            let block = level.blocks.iter().rfind(|b| b.offset <= cell)?;
            let [ni, nj, _] = block.layout.cells;
            let inside = cell - block.offset;
            Some(WorstCell {
                block: block.name.clone(),
                ijk: [inside % ni, (inside / ni) % nj, inside / (ni * nj)],
                equation,
                residual: residual[cell * VARIABLES + equation],
            })
        })
        .collect();
    let norm = squares.iter().sum::<f64>().sqrt();
    Ok(ResidualReport {
        norms: squares.map(f64::sqrt),
        largest,
        stream_norm,
        orders: (stream_norm / norm.max(f64::MIN_POSITIVE)).log10(),
        worst,
    })
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
