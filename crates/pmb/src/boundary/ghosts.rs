//! Ghost cells at boundaries.

use crate::boundary::Boundary;
use crate::field::{set_state, state_at};
use crate::gas::State;
use crate::level::{Level, LevelBlock, LevelPatch};
use crate::reconstruct::{Reconstruction, guarded, slope_koren, slope_van_albada};
use crate::scheme::Scheme;

/// Fills the ghost cells behind every boundary patch of block `b`, whose array is `w`, from the block's own cells.
///
/// A mirror plane mirrors; a far field holds the free stream; elsewhere the cells are extrapolated along the grid line
/// with the limited slope of the second cell, so that the reconstruction in the first cell is one-sided and second
/// order on a curved wall too.
pub fn fill_ghosts(level: &Level, boundaries: &[Boundary], scheme: &Scheme, b: usize, w: &mut [f64]) {
    let block = &level.blocks[b];
    for (patch, boundary) in level.patches.iter().zip(boundaries) {
        if patch.block == b && block.layout.ghosts[patch.face.axis()] > 0 {
            fill_patch(block, patch, boundary, scheme, w);
        }
    }
}

fn fill_patch(block: &LevelBlock, patch: &LevelPatch, boundary: &Boundary, scheme: &Scheme, w: &mut [f64]) {
    let layout = &block.layout;
    let size = layout.size;
    let axis = patch.face.axis();
    let deep = layout.cells[axis];
    for q in patch.window.lo[1]..patch.window.hi[1] {
        for p in patch.window.lo[0]..patch.window.hi[0] {
            let at = |depth: isize| layout.behind(patch.face, p, q, depth);
            let inside = |depth: usize| state_at(w, size, at(depth.min(deep - 1) as isize));
            let first = inside(0);
            let (near, far) = match boundary {
                Boundary::Symmetry => {
                    let [i, j, k] = patch.face.ijk(block.faces[axis].count, p, q, 0);
                    let f = block.faces[axis].at(i, j, k);
                    let (n, speed) = (block.faces[axis].unit(f), block.faces[axis].face_speed(f));
                    (mirrored(&first, &n, speed), mirrored(&inside(1), &n, speed))
                }
                Boundary::FarField(stream) | Boundary::FarFieldCharacteristic(stream) => (*stream, *stream),
                Boundary::InflowSupersonic(state) => (*state, *state),
                Boundary::Collapsed => (first, first),
                _ => extrapolated(&first, &inside(1), &inside(2), scheme),
            };
            set_state(w, size, at(-1), &near);
            set_state(w, size, at(-2), &far);
        }
    }
}

/// The image of a state in a plane with normal `n` that moves along it at `speed`.
fn mirrored(w: &State<f64>, n: &[f64; 3], speed: f64) -> State<f64> {
    let twice = 2.0 * (w[1] * n[0] + w[2] * n[1] + w[3] * n[2] - speed);
    [
        w[0],
        w[1] - twice * n[0],
        w[2] - twice * n[1],
        w[3] - twice * n[2],
        w[4],
    ]
}

fn extrapolated(c1: &State<f64>, c2: &State<f64>, c3: &State<f64>, scheme: &Scheme) -> (State<f64>, State<f64>) {
    if scheme.reconstruction == Reconstruction::Constant {
        return (*c1, *c1);
    }
    let mut near = *c1;
    let mut far = *c1;
    for v in 0..5 {
        let e2 = scheme.limiter_squared[match v {
            0 => 0,
            4 => 2,
            _ => 1,
        }];
        let (d1, d2) = (c1[v] - c2[v], c2[v] - c3[v]);
        let slope = match scheme.reconstruction {
            Reconstruction::VanAlbada => slope_van_albada(d1, d2, e2),
            Reconstruction::Koren => slope_koren(d1, d2, e2),
            Reconstruction::Constant | Reconstruction::Unlimited => d1,
        };
        near[v] = c1[v] + slope;
        far[v] = near[v] + slope;
    }
    (guarded(c1, &near), guarded(c1, &far))
}
