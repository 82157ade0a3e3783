//! Points of the walls whose motion the grid follows.

use std::collections::BTreeMap;

use dip_grid::MultiBlock;
use nalgebra::Vector3;
use rayon::prelude::*;

use super::mirrors::Mirrors;
use super::wall::{MovingWall, face_area};
use crate::deform::{Anchor, local_rotation};

/// Anchors of all walls: nodes of the moving one, of those that stay, and the mirror images of both.
pub(super) fn anchors(
    grid: &MultiBlock,
    wall: &MovingWall,
    standing: &BTreeMap<usize, f64>,
    shapes: &[Vec<Vector3<f64>>],
    mirrors: &Mirrors,
) -> Vec<Anchor> {
    let positions = wall.points();
    let count = positions.len();
    let mut area = vec![0.0; count];
    let mut neighbours: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (face, whole) in wall.faces.iter().zip(&wall.areas) {
        let quarter = 0.25 * whole;
        for n in 0..4 {
            area[face[n]] += quarter;
            neighbours[face[n]].extend([face[(n + 1) % 4], face[(n + 3) % 4]]);
        }
    }
    for (n, list) in neighbours.iter_mut().enumerate() {
        list.sort_unstable();
        list.dedup();
        list.retain(|&m| m != n);
    }
    let mut all: Vec<Anchor> = (0..count)
        .into_par_iter()
        .map(|n| Anchor {
            position: positions[n],
            area: area[n],
            moves: true,
            motion: shapes
                .iter()
                .map(|u| {
                    let edges = neighbours[n]
                        .iter()
                        .map(|&m| (positions[m] - positions[n], u[m] - u[n]));
                    [u[n], local_rotation(edges)]
                })
                .collect(),
        })
        .collect();
    all.extend(standing.iter().map(|(&node, &area)| Anchor {
        position: Vector3::from(wall.merged.position(grid, node)),
        area,
        moves: false,
        motion: vec![[Vector3::zeros(); 2]; shapes.len()],
    }));
    if let Some([point, normal]) = mirrors.single {
        let reflect = |v: &Vector3<f64>| v - normal * (2.0 * normal.dot(v));
        let images: Vec<Anchor> = all
            .iter()
            .map(|a| Anchor {
                position: point + reflect(&(a.position - point)),
                motion: a
                    .motion
                    .iter()
                    // A rotation is an axial vector: it turns round where a displacement is reflected.
                    .map(|[u, theta]| [reflect(u), -reflect(theta)])
                    .collect(),
                ..*a
            })
            .collect();
        all.extend(images);
    }
    all
}

/// Nodes of the walls that stay where they are, each with the area that belongs to it.
pub(super) fn standing(grid: &MultiBlock, wall: &MovingWall) -> BTreeMap<usize, f64> {
    let mut area = BTreeMap::new();
    for (place, patch) in grid.topology.patches.iter().enumerate() {
        if !patch.condition.is_wall() || wall.patches.contains(&place) {
            continue;
        }
        for q in patch.window.lo[1]..patch.window.hi[1] {
            for p in patch.window.lo[0]..patch.window.hi[0] {
                let quarter = 0.25 * face_area(grid, patch, p, q).norm();
                for (p, q) in [(p, q), (p + 1, q), (p + 1, q + 1), (p, q + 1)] {
                    let node = wall.merged.of_face(grid, patch.block, patch.face, p, q);
                    if !wall.number.contains_key(&node) {
                        *area.entry(node).or_insert(0.0) += quarter;
                    }
                }
            }
        }
    }
    area
}
