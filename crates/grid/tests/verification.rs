//! Exact properties: closure, volumes, orientations, splitting.

use dip_grid::generate::{BoxGrid, box_grid};
use dip_grid::metrics::{face_area, hexahedron_volume};
use dip_grid::vector::{add, cross, dot, norm, sub};
use dip_grid::{Face, Metrics, MultiBlock, Orientation, reorient, split};

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

/// Interfaces join equal nodes (up to the translation), every face cell is on one patch or interface.
fn assert_fits(grid: &MultiBlock) {
    for interface in &grid.topology.interfaces {
        let (a, b) = (&grid.blocks[interface.a.block], &grid.blocks[interface.b.block]);
        assert_eq!(
            interface.orientation.size(interface.a.window.size()),
            interface.b.window.size()
        );
        for q in interface.a.window.lo[1]..=interface.a.window.hi[1] {
            for p in interface.a.window.lo[0]..=interface.a.window.hi[0] {
                let pa = a.point_at(a.node_behind(interface.a.face, p, q, 0));
                let [pb, qb] = interface.node_on_b(p, q);
                let pb = b.point_at(b.node_behind(interface.b.face, pb, qb, 0));
                match interface.period {
                    None => assert_eq!(pa, pb),
                    Some(by) => assert!(norm(sub(pb, by.moved(pa))) < 1e-14),
                }
            }
        }
    }
    for (n, block) in grid.blocks.iter().enumerate() {
        for face in Face::ALL {
            let [np, nq] = block.face_cells(face);
            let mut seen = vec![0; np * nq];
            let sides = grid.topology.patches.iter().map(dip_grid::Patch::side);
            let ends = grid.topology.interfaces.iter().flat_map(|i| [i.a, i.b]);
            for side in sides.chain(ends).filter(|s| s.block == n && s.face == face) {
                for q in side.window.lo[1]..side.window.hi[1] {
                    for p in side.window.lo[0]..side.window.hi[0] {
                        seen[p + np * q] += 1;
                    }
                }
            }
            assert!(seen.iter().all(|&s| s == 1), "block {n} {face}");
        }
    }
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
                let area = |side: dip_grid::Side, p: usize, q: usize| {
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

mod generated {
    use dip_grid::generate::{AerofoilGrid, AerofoilKind, WingCh, WingOo};
    use dip_grid::geometry::{Section, Station, TipShape, TrailingEdge, Wing};
    use dip_grid::{Face, Metrics, MultiBlock, coarsen, quality, wall_distance};

    fn section(treatment: TrailingEdge) -> Section {
        Section::naca4("0012").unwrap().with_trailing_edge(treatment).unwrap()
    }

    fn aerofoil(kind: AerofoilKind, treatment: TrailingEdge, wall_spacing: f64) -> AerofoilGrid {
        AerofoilGrid {
            kind,
            section: section(treatment),
            chord: 1.0,
            surface: 48,
            wake: 24,
            normal: 40,
            base: 4,
            wall_spacing,
            nose_spacing: 0.003,
            tail_spacing: 0.005,
            far_field: 20.0,
            wake_growth: 1.0,
            growth_limit: 2.0,
        }
    }

    fn wing(tip: TipShape) -> Wing {
        let at = |y: f64, x_le: f64, chord: f64| Station {
            y,
            x_le,
            z_le: 0.0,
            chord,
            twist_deg: 0.0,
            section: section(TrailingEdge::Sharp),
        };
        Wing {
            stations: vec![at(0.0, 0.0, 1.0), at(1.5, 1.0, 0.6)],
            tip,
            tip_length: 0.04,
        }
    }

    fn wing_oo(stride: usize) -> WingOo {
        WingOo {
            wing: wing(TipShape::Rounded),
            surface: 24,
            normal: 24,
            span: 16,
            wall_spacing: 1e-3,
            nose_spacing: 0.006,
            tail_spacing: 0.01,
            root_spacing: 0.15,
            tip_spacing: 0.02,
            far_field: 12.0,
            growth_limit: 2.0,
            stride,
        }
    }

    fn wing_ch(stride: usize, tip: TipShape) -> WingCh {
        WingCh {
            wing: wing(tip),
            surface: 24,
            wake: 12,
            normal: 24,
            span: 16,
            outboard: 8,
            wall_spacing: 1e-3,
            nose_spacing: 0.006,
            tail_spacing: 0.01,
            root_spacing: 0.15,
            tip_spacing: 0.02,
            far_field: 10.0,
            exit: 12.0,
            wake_growth: 1.0,
            growth_limit: 2.0,
            stride,
        }
    }

    fn assert_good(grid: &MultiBlock) {
        super::assert_fits(grid);
        let report = quality::check(grid);
        assert!(report.is_good(), "{report}");
        assert!(report.figure(quality::names::VOLUME).unwrap().worst[0].value > 0.0);
    }

    #[test]
    fn aerofoil_grids_fit_and_have_the_wall_spacing_asked_for() {
        for kind in [AerofoilKind::C, AerofoilKind::O] {
            for spacing in [1e-3, 2e-6] {
                for treatment in [TrailingEdge::Sharp, TrailingEdge::Blunt, TrailingEdge::Closed] {
                    let grid = aerofoil(kind, treatment, spacing).make().unwrap();
                    assert_good(&grid);
                    assert!(grid.is_two_dimensional());
                    let block = &grid.blocks[0];
                    for patch in grid.topology.patches.iter().filter(|p| p.name == "aerofoil") {
                        for i in patch.window.lo[0]..=patch.window.hi[0] {
                            let step = super::norm(super::sub(block.point(i, 1, 0), block.point(i, 0, 0)));
                            assert!(
                                (step / spacing - 1.0).abs() < 0.02,
                                "{kind:?} {i} {step:e} for {spacing:e}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn cambered_thick_and_thin_sections_make_good_grids() {
        for digits in ["4412", "6409", "2424", "0003"] {
            for kind in [AerofoilKind::C, AerofoilKind::O] {
                let section = Section::naca4(digits)
                    .unwrap()
                    .with_trailing_edge(TrailingEdge::Sharp)
                    .unwrap();
                let grid = AerofoilGrid {
                    section,
                    ..aerofoil(kind, TrailingEdge::Sharp, 1e-5)
                }
                .make()
                .unwrap();
                assert_good(&grid);
                // A line that starts at the wrong place of the map leaves the wall askew.
                let skewness = quality::check(&grid).figure(quality::names::SKEWNESS).unwrap().worst[0].value;
                assert!(skewness < 45.0, "{digits} {kind:?} {skewness}");
            }
        }
    }

    /// Wall nodes of a sharp section are on its formula; lines leave at a right angle (to the chord of two cells).
    #[test]
    fn aerofoil_walls_are_exact_and_lines_leave_them_at_right_angles() {
        let made = aerofoil(AerofoilKind::C, TrailingEdge::Sharp, 1e-4);
        let grid = made.make().unwrap();
        let block = &grid.blocks[0];
        let section = &made.section;
        for i in made.wake..=made.wake + 2 * made.surface {
            let [x, _, z] = block.point(i, 0, 0);
            let side = if i <= made.wake + made.surface { 1.0 } else { -1.0 };
            assert!((section.point(side * x.sqrt())[1] - z).abs() < 1e-12);
        }
        for i in made.wake + 2..made.wake + 2 * made.surface - 1 {
            let along = super::sub(block.point(i + 1, 0, 0), block.point(i - 1, 0, 0));
            let away = super::sub(block.point(i, 1, 0), block.point(i, 0, 0));
            let cosine = super::dot(along, away) / (super::norm(along) * super::norm(away));
            // The chord's direction differs from the tangent where steps or curvature change: a few degrees at the nose.
            assert!(cosine.abs() < 0.09, "{i} {cosine}");
        }
    }

    /// The area of the grid is that of the far boundary's polygon less the section's: by Green's theorem over the wall.
    #[test]
    fn volumes_sum_to_the_area_between_wall_and_far_field() {
        let grid = aerofoil(AerofoilKind::O, TrailingEdge::Sharp, 1e-3).make().unwrap();
        let block = &grid.blocks[0];
        let polygon = |j: usize| -> f64 {
            (0..block.ni)
                .map(|i| {
                    let (p, q) = (block.point(i, j, 0), block.point(i + 1, j, 0));
                    0.5 * (p[0] * q[2] - q[0] * p[2])
                })
                .sum()
        };
        let area: f64 = Metrics::new(block).volume.iter().sum();
        let expected = polygon(block.nj).abs() - polygon(0).abs();
        assert!((area / expected - 1.0).abs() < 1e-12);
        // The wall's polygon has the section's area, up to its own coarseness.
        let sharp = section(TrailingEdge::Sharp);
        let rule = |n: usize| -> f64 {
            let point = |m: usize| sharp.point(m as f64 / n as f64);
            (0..n)
                .map(|m| (point(m)[1] + point(m + 1)[1]) * (point(m + 1)[0] - point(m)[0]))
                .sum()
        };
        assert!(
            (polygon(0).abs() / rule(20_000) - 1.0).abs() < 3e-3,
            "{} {}",
            polygon(0),
            rule(20_000)
        );
    }

    #[test]
    fn wing_grids_fit_and_have_positive_volumes() {
        for tip in [TipShape::Rounded, TipShape::Tapered] {
            assert_good(&wing_ch(1, tip).make().unwrap());
        }
        assert_good(&wing_oo(1).make().unwrap());
        let mut twisted = wing_ch(1, TipShape::Rounded);
        for (station, (twist_deg, z_le)) in twisted.wing.stations.iter_mut().zip([(1.0, 0.0), (-4.0, 0.1)]) {
            station.twist_deg = twist_deg;
            station.z_le = z_le;
            station.section = Section::naca4("2412")
                .unwrap()
                .with_trailing_edge(TrailingEdge::Sharp)
                .unwrap();
        }
        assert_good(&twisted.make().unwrap());
        let wrapped = WingOo {
            wing: twisted.wing,
            ..wing_oo(1)
        };
        assert_good(&wrapped.make().unwrap());
    }

    #[test]
    fn coarser_levels_are_every_second_point_of_the_finer() {
        let pairs = [
            (
                wing_ch(1, TipShape::Rounded).make().unwrap(),
                wing_ch(2, TipShape::Rounded).make().unwrap(),
            ),
            (wing_oo(1).make().unwrap(), wing_oo(2).make().unwrap()),
        ];
        for (fine, coarse) in pairs {
            let kept = coarsen::coarsen(&fine).unwrap();
            assert_eq!(kept.topology, coarse.topology);
            let (a, b) = (&kept.blocks[0], &coarse.blocks[0]);
            assert_eq!((&a.x, &a.y, &a.z), (&b.x, &b.y, &b.z));
        }
    }

    #[test]
    fn grids_do_not_depend_on_the_number_of_threads() {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                (
                    wing_oo(2).make().unwrap(),
                    wing_ch(2, TipShape::Rounded).make().unwrap(),
                )
            })
        };
        assert_eq!(with(1), with(3));
    }

    #[test]
    fn too_few_cells_for_the_growth_limit_say_how_many_are_needed() {
        let mut made = aerofoil(AerofoilKind::C, TrailingEdge::Sharp, 1e-7);
        made.growth_limit = 1.2;
        let text = made.make().unwrap_err().to_string();
        assert!(text.contains("use at least"), "{text}");
        made.wall_spacing = f64::NAN;
        assert!(made.make().unwrap_err().to_string().contains("wall_spacing"));
        let mut far = wing_ch(1, TipShape::Rounded);
        far.exit = f64::NAN;
        assert!(far.make().unwrap_err().to_string().contains("exit"));
        let mut coarse = wing_oo(1);
        coarse.tip_spacing = 5.0;
        assert!(coarse.make().unwrap_err().to_string().contains("tip_spacing"));
        let mut odd = wing_oo(2);
        odd.span = 15;
        assert!(odd.make().unwrap_err().to_string().contains("multiple of 2"));
    }

    #[test]
    fn the_wall_of_a_wing_lies_on_its_surface() {
        let made = wing_oo(1);
        let grid = made.make().unwrap();
        let block = &grid.blocks[0];
        for k in 0..=block.nk {
            for i in 0..=block.ni {
                let [x, y, z] = block.point(i, 0, k);
                let [x_le, _, chord] = made.wing.planform(y);
                let t = ((x - x_le) / chord).max(0.0).sqrt() * if 2 * i <= block.ni { 1.0 } else { -1.0 };
                let exact = made.wing.point(y, t);
                assert!((z - exact[2]).abs() < 1e-9, "{i} {k}");
            }
        }
    }

    /// Between parallel plates, and across blocks, the distance is known; on the wing it is compared with all triangles.
    #[test]
    fn wall_distance_is_exact_and_equals_brute_force() {
        use dip_grid::Condition::{Symmetry, Wall};
        let conditions = [Symmetry, Symmetry, Symmetry, Symmetry, Wall, Wall];
        let mut plates = dip_grid::generate::BoxGrid::new([0.0; 3], [3.0, 2.0, 1.0], [12, 8, 10])
            .conditions(conditions)
            .make();
        dip_grid::split::split_into(&mut plates, 5);
        let distances = wall_distance::of_cells(&plates, dip_grid::Condition::is_wall);
        for (block, distances) in plates.blocks.iter().zip(&distances) {
            for (cell, d) in distances.iter().enumerate() {
                let [i, j, k] = block.cell_ijk(cell);
                let z = block.cell_centre(i, j, k)[2];
                assert!((d - z.min(1.0 - z)).abs() < 1e-15);
            }
        }
        let grid = wing_oo(2).make().unwrap();
        let block = &grid.blocks[0];
        let mut triangles = Vec::new();
        for k in 0..block.nk {
            for i in 0..block.ni {
                let node = |a, b| block.point_at(block.node_behind(Face::JMin, i + a, k + b, 0));
                let (a, b, c, d) = (node(0, 0), node(1, 0), node(1, 1), node(0, 1));
                if super::norm(super::sub(a, c)) <= super::norm(super::sub(b, d)) {
                    triangles.extend([[a, b, c], [a, c, d]]);
                } else {
                    triangles.extend([[a, b, d], [b, c, d]]);
                }
            }
        }
        let distances = &wall_distance::of_cells(&grid, dip_grid::Condition::is_wall)[0];
        for (cell, &found) in distances.iter().enumerate() {
            let [i, j, k] = block.cell_ijk(cell);
            let p = block.cell_centre(i, j, k);
            let brute = triangles
                .iter()
                .map(|t| super::norm(super::sub(p, wall_distance::nearest_on_triangle(p, t))))
                .fold(f64::INFINITY, f64::min);
            assert!((found - brute).abs() <= 1e-14 * brute, "{cell} {found} {brute}");
        }
    }

    /// Scan of a triangle: the nearest point is at least as near as every sample of the triangle, and is on it.
    #[test]
    fn nearest_point_of_a_triangle_beats_a_fine_sampling() {
        let mut noise = super::Noise(5);
        for _ in 0..200 {
            let mut point = || [noise.next(), noise.next(), noise.next()];
            let (t, p) = ([point(), point(), point()], super::add(point(), point()));
            let nearest = super::norm(super::sub(p, wall_distance::nearest_on_triangle(p, &t)));
            let mut sampled = f64::INFINITY;
            for a in 0..=60 {
                for b in 0..=60 - a {
                    let (u, v) = (f64::from(a) / 60.0, f64::from(b) / 60.0);
                    let q = [0, 1, 2].map(|d| t[0][d] + u * (t[1][d] - t[0][d]) + v * (t[2][d] - t[0][d]));
                    sampled = sampled.min(super::norm(super::sub(p, q)));
                }
            }
            assert!(nearest <= sampled + 1e-12 && nearest > sampled - 0.05);
        }
    }
}
