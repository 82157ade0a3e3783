//! Checks for developers, on any grid and flow: the assembled Jacobian against differentiation of the residual, and where
//! the residual is large.

use dip_krylov::multilevel::LevelMatrix;
use dip_krylov::vector;
use serde::Serialize;

use crate::boundary::{flux_boundary, outward};
use crate::error::FlowError;
use crate::field::Field;
use crate::flux::flux_osher;
use crate::gas::{Diatomic, Gas, Perfect, State, VARIABLES};
use crate::jacobian::jacobian;
use crate::real::{Dual, Real};
use crate::reconstruct::Reconstruction;
use crate::solver::Equations;

/// The worst difference between the Jacobian's product and the residual's derivative.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JacobianCheck {
    /// Largest difference, over the largest entry of the derivative.
    pub relative: f64,
    /// Largest difference between the residual and the fluxes that were differentiated, over the largest of them.
    pub residual: f64,
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

/// Multiplies the first-order Jacobian (in double precision, couplings between blocks included) with a repeatable direction
/// that changes every variable of every cell, and compares with the derivative of the first-order residual along it.
///
/// The derivative is that of the fluxes by dual numbers, exact to round-off, and their sums must be the residual. (Differences
/// of residuals are not exact enough: Osher's flux has one continuous derivative where a normal velocity changes
/// its sign, so that a difference over a step h is wrong by a part h there, and in a uniform stream there is always such
/// a face.)
///
/// # Errors
/// If the flow is not physical.
pub fn check_jacobian(equations: &mut Equations) -> Result<JacobianCheck, FlowError> {
    equations.check()?;
    if equations.scheme.gamma == 1.4 {
        Ok(compare(&Diatomic, equations))
    } else {
        let gamma = equations.scheme.gamma;
        Ok(compare(&Perfect { gamma }, equations))
    }
}

fn compare<G: Gas>(gas: &G, equations: &mut Equations) -> JacobianCheck {
    let n = equations.len();
    let level = equations.level.clone();
    let mut base = vec![0.0; n];
    equations.field.store(&level, &mut base);
    let direction: Vec<f64> = base
        .iter()
        .enumerate()
        .map(|(m, w)| (1.0 + w.abs()) * (m as f64 * 0.7391).sin())
        .collect();
    let scheme = equations.scheme.with(Reconstruction::Constant);
    let mut residual = vec![0.0; n];
    equations.residual_with(&scheme, &mut residual);

    let cells: Vec<_> = level.blocks.iter().map(|b| b.layout.cells).collect();
    let mut matrix = LevelMatrix::<f64>::zeros(&cells, level.couplings());
    jacobian(
        gas,
        &level,
        &equations.boundaries,
        &equations.sides,
        &equations.field,
        &mut matrix.blocks,
    );
    // 0 - A d
    let mut product = vec![0.0; n];
    matrix.residual(&vec![0.0; n], &direction, &mut product);
    let exact = differentiate(gas, equations, &direction);

    let size = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::MIN_POSITIVE, |m, v| m.max(v.abs()));
    let largest = size(&mut exact.iter().map(|e| e.derivative[0]));
    let largest_flux = size(&mut exact.iter().map(|e| e.derivative[1]));
    let mut worst = JacobianCheck {
        relative: 0.0,
        residual: 0.0,
        block: String::new(),
        ijk: [0; 3],
        equation: 0,
    };
    for block in &level.blocks {
        let [ni, nj, _] = block.layout.cells;
        let range = block.offset * VARIABLES..(block.offset + block.layout.cell_count()) * VARIABLES;
        for (m, e) in exact[range.clone()].iter().enumerate() {
            let at = range.start + m;
            let relative = (-product[at] - e.derivative[0]).abs() / largest;
            let of_residual = (residual[at] - e.value).abs() / largest_flux;
            // A NaN is kept: nothing is larger than it.
            if of_residual.is_nan() || of_residual > worst.residual {
                worst.residual = of_residual;
            }
            if relative.is_nan() || relative > worst.relative {
                let cell = m / VARIABLES;
                worst.relative = relative;
                worst.block.clone_from(&block.name);
                worst.ijk = [cell % ni, cell / ni % nj, cell / (ni * nj)];
                worst.equation = m % VARIABLES;
            }
        }
    }
    worst
}

/// The first-order residual of every cell with its derivative along `direction`, face by face; the second derivative is the
/// sum of the sizes of the fluxes. Ghost cells must be filled.
fn differentiate<G: Gas>(gas: &G, equations: &Equations, direction: &[f64]) -> Vec<Dual<2>> {
    let level = &equations.level;
    let mut along = equations.field.clone();
    along.load(level, direction);
    along.exchange(level, |_, _| ());
    let mut out = vec![Dual::<2>::splat(0.0); equations.len()];
    let mut add = |cell: usize, flux: &State<Dual<1>>, factor: f64| {
        for (o, f) in out[cell * VARIABLES..].iter_mut().zip(flux) {
            o.value += factor * f.value;
            o.derivative[0] += factor * f.derivative[0];
            o.derivative[1] += (factor * f.value).abs();
        }
    };
    for (b, block) in level.blocks.iter().enumerate() {
        let layout = &block.layout;
        let dual = |at: usize| -> State<Dual<1>> {
            let (w, d) = (equations.field.state(level, b, at), along.state(level, b, at));
            [0, 1, 2, 3, 4].map(|v| Dual {
                value: w[v],
                derivative: [d[v]],
            })
        };
        let [ni, nj, _] = layout.cells;
        let cell = |[i, j, k]: [usize; 3]| block.offset + i + ni * (j + nj * k);
        for d in (0..3).filter(|d| layout.ghosts[*d] > 0) {
            let set = &block.faces[d];
            for f in 0..set.area.len() {
                let at = [
                    f % set.count[0],
                    f / set.count[0] % set.count[1],
                    f / (set.count[0] * set.count[1]),
                ];
                let (first, last) = (at[d] == 0, at[d] == layout.cells[d]);
                let side = equations.sides[b][2 * d + usize::from(last)].as_ref();
                let [p, q] = [[at[1], at[2]], [at[0], at[2]], [at[0], at[1]]][d];
                if (first || last) && side.is_some_and(|s| s.physical[p + s.size[0] * q]) {
                    continue;
                }
                let right = layout.at(at[0], at[1], at[2]);
                let flux = flux_osher(
                    gas,
                    &dual(right - layout.stride[d]),
                    &dual(right),
                    &set.unit(f).map(Dual::splat),
                    Dual::splat(set.face_speed(f)),
                );
                if !first {
                    let mut left = at;
                    left[d] -= 1;
                    add(cell(left), &flux, set.area[f]);
                }
                if !last {
                    add(cell(at), &flux, -set.area[f]);
                }
            }
        }
        for (patch, boundary) in level.patches.iter().zip(&equations.boundaries) {
            if patch.block != b || layout.ghosts[patch.face.axis()] == 0 {
                continue;
            }
            let mut index = 0;
            for q in patch.window.lo[1]..patch.window.hi[1] {
                for p in patch.window.lo[0]..patch.window.hi[0] {
                    let (normal, speed, area) = outward(block, patch.face, p, q);
                    let inside = dual(layout.behind(patch.face, p, q, 0));
                    let flux = flux_boundary(gas, boundary, index, &inside, &normal, speed);
                    add(cell(patch.face.ijk(layout.cells, p, q, 0)), &flux, area);
                    index += 1;
                }
            }
        }
    }
    out
}
