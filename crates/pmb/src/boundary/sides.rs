//! Fluxes of all boundary faces of a level, kept by side of a block.

use dip_grid::Face;
use dip_krylov::{BLOCK, BlockMatrix, Storage};
use rayon::prelude::*;

use crate::boundary::kernel::{Boundary, flux_boundary, pressure_at_wall};
use crate::field::{Field, state_at};
use crate::gas::{Gas, State, VARIABLES};
use crate::level::{Level, LevelBlock, LevelPatch};
use crate::real::Dual;
use crate::reconstruct::{Koren, Mean, Reconstruction, VanAlbada, muscl};
use crate::scheme::Scheme;

/// Fluxes through the boundary faces of one side.
#[derive(Clone, Debug, Default)]
pub struct SideFlux {
    /// Face cells along the two directions of the side.
    pub size: [usize; 2],
    /// True where a face is on the boundary, false on an interface.
    pub physical: Vec<bool>,
    /// True if every face is on the boundary.
    pub whole: bool,
    /// Flux times area towards increasing index, `[variable][face cell]`.
    pub flux: Vec<f64>,
    /// Static pressure at the face where it is a wall or a mirror plane, else zero.
    pub pressure: Vec<f64>,
}

/// The six sides of every block; `None` where a side has no boundary face.
pub type Sides = Vec<[Option<SideFlux>; 6]>;

impl SideFlux {
    /// Room for the sides of a level.
    #[must_use]
    pub fn of(level: &Level) -> Sides {
        let mut sides: Sides = level.blocks.iter().map(|_| Default::default()).collect();
        for patch in &level.patches {
            let cells = level.blocks[patch.block].layout.cells;
            let [d0, d1] = patch.face.directions();
            let size = [cells[d0], cells[d1]];
            let n = size[0] * size[1];
            let side = sides[patch.block][patch.face as usize].get_or_insert_with(|| Self {
                size,
                physical: vec![false; n],
                whole: false,
                flux: vec![0.0; n * VARIABLES],
                pressure: vec![0.0; n],
            });
            for q in patch.window.lo[1]..patch.window.hi[1] {
                for p in patch.window.lo[0]..patch.window.hi[0] {
                    side.physical[p + size[0] * q] = true;
                }
            }
            side.whole = side.physical.iter().all(|b| *b);
        }
        sides
    }

    /// Flux times area of a face, towards increasing index.
    #[must_use]
    pub fn flux_at(&self, face: usize) -> State<f64> {
        let n = self.physical.len();
        [0, 1, 2, 3, 4].map(|v| self.flux[v * n + face])
    }
}

/// Computes the flux of every boundary face. Ghost cells must be filled.
pub fn fill_sides<G: Gas>(
    gas: &G,
    level: &Level,
    boundaries: &[Boundary],
    scheme: &Scheme,
    field: &Field,
    sides: &mut Sides,
) {
    // Side by side: blocks have boundaries of very different sizes.
    let mut work: Vec<(usize, usize, &mut SideFlux)> = Vec::new();
    for (b, sides) in sides.iter_mut().enumerate() {
        let of_block = sides.iter_mut().enumerate();
        work.extend(of_block.filter_map(|(face, side)| side.as_mut().map(|side| (b, face, side))));
    }
    work.into_par_iter().with_max_len(1).for_each(|(b, face, side)| {
        let block = &level.blocks[b];
        for (patch, boundary) in level.patches.iter().zip(boundaries) {
            if patch.block == b && patch.face as usize == face && block.layout.ghosts[patch.face.axis()] > 0 {
                fill_patch(gas, block, patch, boundary, scheme, &field.blocks[b], side);
            }
        }
    });
}

/// Normal and speed of the boundary face (p, q), both outward, and its area.
pub(crate) fn outward(block: &LevelBlock, face: Face, p: usize, q: usize) -> ([f64; 3], f64, f64) {
    let set = &block.faces[face.axis()];
    let [i, j, k] = face.ijk(set.count, p, q, 0);
    let f = set.at(i, j, k);
    let sign = if face.is_max() { 1.0 } else { -1.0 };
    (set.unit(f).map(|n| sign * n), sign * set.face_speed(f), set.area[f])
}

fn fill_patch<G: Gas>(
    gas: &G,
    block: &LevelBlock,
    patch: &LevelPatch,
    boundary: &Boundary,
    scheme: &Scheme,
    w: &[f64],
    side: &mut SideFlux,
) {
    let layout = &block.layout;
    let deep = layout.cells[patch.face.axis()];
    let sign = if patch.face.is_max() { 1.0 } else { -1.0 };
    let faces = side.physical.len();
    let mut index = 0;
    for q in patch.window.lo[1]..patch.window.hi[1] {
        for p in patch.window.lo[0]..patch.window.hi[0] {
            let cell = |depth: isize| state_at(w, layout.size, layout.behind(patch.face, p, q, depth));
            let first = cell(0);
            let second = if deep > 1 { cell(1) } else { first };
            // The right state of the face between ghost and cell; the cell beyond the ghost does not enter it.
            let ghost = cell(-1);
            let e2 = &scheme.limiter_squared;
            let inside = match scheme.reconstruction {
                Reconstruction::Constant => first,
                Reconstruction::Unlimited => muscl::<f64, Mean>(&ghost, &ghost, &first, &second, e2)[1],
                Reconstruction::VanAlbada => muscl::<f64, VanAlbada>(&ghost, &ghost, &first, &second, e2)[1],
                Reconstruction::Koren => muscl::<f64, Koren>(&ghost, &ghost, &first, &second, e2)[1],
            };
            let (n, speed, area) = outward(block, patch.face, p, q);
            let flux = flux_boundary(gas, boundary, index, &inside, &n, speed);
            let f = p + side.size[0] * q;
            for (v, value) in flux.into_iter().enumerate() {
                side.flux[v * faces + f] = sign * area * value;
            }
            if matches!(boundary, Boundary::Wall | Boundary::Symmetry) {
                let un = inside[1] * n[0] + inside[2] * n[1] + inside[3] * n[2] - speed;
                side.pressure[f] = pressure_at_wall(gas, inside[0], un, inside[4]);
            }
            index += 1;
        }
    }
}

/// Adds the derivatives of the boundary fluxes (first order) to the diagonal of each block's matrix.
pub fn add_jacobian<G: Gas, S: Storage>(
    gas: &G,
    level: &Level,
    boundaries: &[Boundary],
    field: &Field,
    matrices: &mut [BlockMatrix<S>],
) {
    matrices
        .par_iter_mut()
        .enumerate()
        .with_max_len(1)
        .for_each(|(b, matrix)| {
            let block = &level.blocks[b];
            let layout = &block.layout;
            for (patch, boundary) in level.patches.iter().zip(boundaries) {
                if patch.block != b || layout.ghosts[patch.face.axis()] == 0 {
                    continue;
                }
                let mut index = 0;
                for q in patch.window.lo[1]..patch.window.hi[1] {
                    for p in patch.window.lo[0]..patch.window.hi[0] {
                        let state = state_at(&field.blocks[b], layout.size, layout.behind(patch.face, p, q, 0));
                        let mut dual = [Dual::<VARIABLES>::variable(0.0, 0); VARIABLES];
                        for v in 0..VARIABLES {
                            dual[v] = Dual::variable(state[v], v);
                        }
                        let (n, speed, area) = outward(block, patch.face, p, q);
                        let flux = flux_boundary(gas, boundary, index, &dual, &n, speed);
                        let [i, j, k] = patch.face.ijk(layout.cells, p, q, 0);
                        let cell = i + layout.cells[0] * (j + layout.cells[1] * k);
                        let diagonal = &mut matrix.diagonal_mut(cell)[..BLOCK];
                        for row in 0..VARIABLES {
                            for column in 0..VARIABLES {
                                let d = &mut diagonal[row + VARIABLES * column];
                                *d = S::from_f64(d.to_f64() + area * flux[row].derivative[column]);
                            }
                        }
                        index += 1;
                    }
                }
            }
        });
}
