//! Exact properties: closure, volumes, orientations, splitting.

mod fits;

use std::path::Path;

use fits::assert_fits;

use dip_grid::generate::{BoxGrid, box_grid};
use dip_grid::metrics::{face_area, hexahedron_volume};
use dip_grid::vector::{add, cross, dot, norm};
use dip_grid::{Face, Interface, Metrics, MultiBlock, Orientation, Side, Window, recipe, reorient, split};

/// A fixed sequence of numbers in -1..1 (64-bit congruential generator, Knuth's constants).
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

fn shaken(cells: [usize; 3], amplitude: f64) -> MultiBlock {
    let mut grid = box_grid([0.0; 3], [1.0, 1.0, 1.0], cells);
    let mut noise = Noise(7);
    let block = &mut grid.blocks[0];
    for k in 1..block.nk {
        for j in 1..block.nj {
            for i in 1..block.ni {
                let p = block.point(i, j, k);
                let h = |d: usize| amplitude / cells[d] as f64;
                let q = [
                    p[0] + h(0) * noise.next(),
                    p[1] + h(1) * noise.next(),
                    p[2] + h(2) * noise.next(),
                ];
                block.set_point([i, j, k], q);
            }
        }
    }
    grid
}

#[test]
fn area_vectors_close_every_cell() {
    let grid = shaken([6, 5, 7], 0.9);
    let m = Metrics::new(&grid.blocks[0]);
    let largest = m.si.iter().flatten().fold(0.0f64, |a, b| a.max(b.abs()));
    for k in 0..7 {
        for j in 0..5 {
            for i in 0..6 {
                assert!(norm(m.closure([6, 5, 7], i, j, k)) < 4e-16 * largest.max(1.0));
            }
        }
    }
}

#[test]
fn volumes_sum_to_the_box_whatever_the_nodes_inside() {
    for grid in [
        shaken([6, 5, 7], 0.3),
        BoxGrid::new([0.0; 3], [1.0; 3], [9, 8, 7]).wavy(0.05).make(),
    ] {
        let m = Metrics::new(&grid.blocks[0]);
        assert!(m.volume.iter().all(|&v| v > 0.0));
        assert!((m.volume.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }
}

/// The volume is the integral of x . dS / 3 over the six bilinear faces, here with 2 x 2 Gauss points, which are exact
/// for it (x . dS is of second degree in each parameter).
#[test]
fn volume_is_the_surface_integral_over_bilinear_faces() {
    let mut noise = Noise(3);
    let mut c = [[0.0; 3]; 8];
    for (n, corner) in c.iter_mut().enumerate() {
        for (d, value) in corner.iter_mut().enumerate() {
            *value = ((n >> d) & 1) as f64 + 0.4 * noise.next();
        }
    }
    let faces = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let mut volume = 0.0;
    let mut total = [0.0; 3];
    for face in faces {
        let [a, b, e, d] = face.map(|n| c[n]);
        total = add(total, face_area(a, b, e, d));
        let g = 0.5 / 3.0f64.sqrt();
        for u in [0.5 - g, 0.5 + g] {
            for v in [0.5 - g, 0.5 + g] {
                let at = |m: usize| {
                    a[m] * (1.0 - u) * (1.0 - v) + b[m] * u * (1.0 - v) + e[m] * u * v + d[m] * (1.0 - u) * v
                };
                let du = |m: usize| (b[m] - a[m]) * (1.0 - v) + (e[m] - d[m]) * v;
                let dv = |m: usize| (d[m] - a[m]) * (1.0 - u) + (e[m] - b[m]) * u;
                let x = [at(0), at(1), at(2)];
                volume += 0.25 / 3.0 * dot(x, cross([du(0), du(1), du(2)], [dv(0), dv(1), dv(2)]));
            }
        }
    }
    assert!(norm(total) < 1e-15);
    assert!(
        (hexahedron_volume(&c) - volume).abs() < 1e-14,
        "{} {volume}",
        hexahedron_volume(&c)
    );
}

#[test]
fn a_shared_face_has_the_same_bits_from_both_sides() {
    let mut grid = shaken([8, 6, 5], 0.4);
    split::split_block(&mut grid, 0, 0, 3);
    split::split_block(&mut grid, 1, 1, 2);
    // Every right-handed renumbering of block 1 (24 of the 48).
    for axes in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]] {
        for bits in 0..8 {
            let reverse = [bits & 1 != 0, bits & 2 != 0, bits & 4 != 0];
            let mut turned = grid.clone();
            reorient::reorient(&mut turned, 1, axes, reverse);
            assert_fits(&turned);
            for interface in &turned.topology.interfaces {
                let area = |side: Side, p: usize, q: usize| {
                    let block = &turned.blocks[side.block];
                    let node = |dp, dq| block.point_at(block.node_behind(side.face, p + dp, q + dq, 0));
                    face_area(node(0, 0), node(1, 0), node(1, 1), node(0, 1))
                };
                let w = interface.a.window;
                for q in w.lo[1]..w.hi[1] {
                    for p in w.lo[0]..w.hi[0] {
                        let sa = area(interface.a, p, q);
                        let [pb, qb] = interface.cell_on_b(p, q);
                        let sb = area(interface.b, pb, qb);
                        assert!(sa == sb || sa == sb.map(|v| -v));
                    }
                }
            }
        }
    }
}

#[test]
fn orientations_form_the_group_of_the_square() {
    let size = [4, 7];
    for first in Orientation::ALL {
        let mid = first.size(size);
        for second in Orientation::ALL {
            let end = second.size(mid);
            for p in 0..size[0] {
                for q in 0..size[1] {
                    let step = second.map(first.map([p, q], mid), end);
                    assert_eq!(first.then(second).map([p, q], end), step);
                }
            }
        }
        assert_eq!(first.then(first.inverse()), Orientation::default());
    }
}

#[test]
fn splitting_keeps_every_node_interface_and_patch() {
    let whole = BoxGrid::new([0.0; 3], [2.0, 1.0, 1.0], [12, 8, 6])
        .wavy(0.04)
        .periodic([true, false, true])
        .make();
    assert_fits(&whole);
    for count in [2, 3, 5, 8, 13] {
        let mut grid = whole.clone();
        split::split_into(&mut grid, count);
        assert_eq!(grid.blocks.len(), count);
        assert_eq!(grid.cell_count(), whole.cell_count());
        let largest = grid.blocks.iter().map(dip_grid::Block::cell_count).max().unwrap_or(0);
        assert!(
            (largest * count) as f64 <= 1.8 * whole.cell_count() as f64,
            "{count} {largest}"
        );
        assert_fits(&grid);
        let volume: f64 = grid.blocks.iter().flat_map(|b| Metrics::new(b).volume).sum();
        assert!((volume - 2.0).abs() < 1e-13);
        let mut names: Vec<_> = grid.blocks.iter().map(|b| b.name.clone()).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}

#[test]
fn a_c_grid_is_parted_at_its_wake_however_its_indices_run() {
    let meets_itself = |grid: &MultiBlock| {
        let same = |i: &&Interface| (i.a.block, i.a.face) == (i.b.block, i.b.face);
        grid.topology.interfaces.iter().filter(same).count()
    };
    let c = recipe::make(Path::new("../../meshes/naca0012_c.toml")).expect("a shipped recipe");
    let wing = BoxGrid::new([0.0; 3], [2.0, 1.0, 1.0], [12, 4, 6]).make();
    for order in [[0, 1, 2], [1, 0, 2], [2, 0, 1], [1, 2, 0]] {
        // A wing between wake and tip: joined to itself behind the trailing edge and, over all chords, beyond the tip.
        let mut folded = wing.clone();
        let side = |lo: [usize; 2], hi: [usize; 2]| Side {
            block: 0,
            face: Face::JMin,
            window: Window::new(lo, hi),
        };
        folded.topology.patches.retain(|p| p.face != Face::JMin);
        folded.topology.interfaces.clear();
        for (a, b) in [
            (side([0, 0], [4, 3]), side([8, 0], [12, 3])),
            (side([0, 3], [6, 6]), side([6, 3], [12, 6])),
        ] {
            folded.topology.interfaces.push(Interface {
                a,
                b,
                orientation: Orientation {
                    reverse: [true, false],
                    ..Orientation::default()
                },
                period: None,
            });
        }
        for (whole, joints) in [(&c, 1), (&folded, 2)] {
            let mut grid = whole.clone();
            reorient::reorient(&mut grid, 0, order, [false, true, false]);
            assert_eq!(meets_itself(&grid), joints);
            let cuts = split::part_at_own_cuts(&mut grid);
            assert_eq!(cuts.len(), 1, "{cuts:?}");
            assert_eq!(meets_itself(&grid), 0);
            assert_eq!(grid.cell_count(), whole.cell_count());
            let faces =
                |grid: &MultiBlock| -> usize { grid.topology.interfaces.iter().map(|i| i.a.window.count()).sum() };
            let (_, _, axis, at) = &cuts[0];
            let along = grid.blocks[0].cells()[*axis] + grid.blocks[1].cells()[*axis];
            assert_eq!(*at, along / 2);
            assert_eq!(faces(&grid), faces(whole) + whole.cell_count() / along);
            if joints == 1 {
                assert_fits(&grid);
            }
        }
    }
}

#[test]
fn the_volume_swept_by_the_faces_is_the_change_of_volume() {
    let mut noise = Noise(11);
    let corner = |n: usize, d: usize| ((n >> d) & 1) as f64;
    let mut old = [[0.0; 3]; 8];
    let mut new = [[0.0; 3]; 8];
    for n in 0..8 {
        for d in 0..3 {
            old[n][d] = corner(n, d) + 0.2 * noise.next();
            new[n][d] = corner(n, d) + 0.2 * noise.next();
        }
    }
    // Faces as corners (0,0), (1,0), (0,1), (1,1) with the outward normal along d(0) x d(1).
    let faces = [
        [0, 4, 2, 6],
        [1, 3, 5, 7],
        [0, 1, 4, 5],
        [2, 6, 3, 7],
        [0, 2, 1, 3],
        [4, 5, 6, 7],
    ];
    let swept: f64 = faces
        .iter()
        .map(|face| {
            let mut hexahedron = [[0.0; 3]; 8];
            for n in 0..4 {
                hexahedron[n] = old[face[n]];
                hexahedron[n + 4] = new[face[n]];
            }
            hexahedron_volume(&hexahedron)
        })
        .sum();
    let change = hexahedron_volume(&new) - hexahedron_volume(&old);
    assert!((swept - change).abs() < 1e-15, "{swept} {change}");
}
