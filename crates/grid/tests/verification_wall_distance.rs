//! Wall distances are those to the surface itself: known ones, and a search over all triangles.

use std::path::Path;

use dip_grid::Condition::{self, Symmetry, Wall};
use dip_grid::generate::BoxGrid;
use dip_grid::vector::distance;
use dip_grid::{Face, recipe, split, wall_distance};
use proptest::prelude::*;

/// Between parallel plates, and across blocks, the distance is known.
#[test]
fn distances_between_plates_are_exact_across_blocks() {
    let conditions = [Symmetry, Symmetry, Symmetry, Symmetry, Wall, Wall];
    let mut plates = BoxGrid::new([0.0; 3], [3.0, 2.0, 1.0], [12, 8, 10])
        .conditions(conditions)
        .make();
    split::split_into(&mut plates, 5);
    let distances = wall_distance::of_cells(&plates, Condition::is_wall);
    for (block, distances) in plates.blocks.iter().zip(&distances) {
        for (cell, d) in distances.iter().enumerate() {
            let [i, j, k] = block.cell_ijk(cell);
            let z = block.cell_centre(i, j, k)[2];
            assert!((d - z.min(1.0 - z)).abs() < 1e-15);
        }
    }
}

/// On a wing of eight blocks the tree finds what a search over all triangles of all blocks finds.
#[test]
fn wall_distance_is_exact_and_equals_brute_force() {
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes");
    let grid = recipe::make(&meshes.join("agard445_oo_coarsest.toml")).unwrap();
    let mut triangles = Vec::new();
    for patch in grid.topology.patches.iter().filter(|p| p.condition.is_wall()) {
        assert_eq!(patch.face, Face::JMin);
        let block = &grid.blocks[patch.block];
        for k in patch.window.lo[1]..patch.window.hi[1] {
            for i in patch.window.lo[0]..patch.window.hi[0] {
                let node = |a, b| block.point(i + a, 0, k + b);
                let (a, b, c, d) = (node(0, 0), node(1, 0), node(1, 1), node(0, 1));
                if distance(a, c) <= distance(b, d) {
                    triangles.extend([[a, b, c], [a, c, d]]);
                } else {
                    triangles.extend([[a, b, d], [b, c, d]]);
                }
            }
        }
    }
    assert_eq!(triangles.len(), 2 * 30 * 8);
    let distances = wall_distance::of_cells(&grid, Condition::is_wall);
    for (block, distances) in grid.blocks.iter().zip(&distances) {
        for (cell, &found) in distances.iter().enumerate() {
            let [i, j, k] = block.cell_ijk(cell);
            let p = block.cell_centre(i, j, k);
            let brute = triangles
                .iter()
                .map(|t| distance(p, wall_distance::nearest_on_triangle(p, t)))
                .fold(f64::INFINITY, f64::min);
            assert!((found - brute).abs() <= 1e-14 * brute, "{cell} {found} {brute}");
        }
    }
}

proptest! {
    /// Scan of a triangle: the nearest point is at least as near as every sample of the triangle, and is on it.
    #[test]
    fn nearest_point_of_a_triangle_beats_a_fine_sampling(
        t in proptest::array::uniform3(proptest::array::uniform3(-1.0..1.0f64)),
        p in proptest::array::uniform3(-2.0..2.0f64),
    ) {
        let nearest = distance(p, wall_distance::nearest_on_triangle(p, &t));
        let mut sampled = f64::INFINITY;
        for a in 0..=60 {
            for b in 0..=60 - a {
                let (u, v) = (f64::from(a) / 60.0, f64::from(b) / 60.0);
                let q = [0, 1, 2].map(|d| t[0][d] + u * (t[1][d] - t[0][d]) + v * (t[2][d] - t[0][d]));
                sampled = sampled.min(distance(p, q));
            }
        }
        prop_assert!(nearest <= sampled + 1e-12 && nearest > sampled - 0.05);
    }
}
