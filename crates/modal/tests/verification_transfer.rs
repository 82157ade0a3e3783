//! The transfer between structure and surface: rigid motion, work, balance, order, overhang.

#[path = "support/published.rs"]
mod published;
mod support;

use dip_modal::{Attachment, ConstantVolume, MovingWall, StructuralSurface, ThicknessRule, Transfer, TransferError};
use nalgebra::{Rotation3, Vector3};
use published::{agard_wing, yates};

const BOTH: [Attachment; 2] = [Attachment::Nearest, Attachment::Blended];

/// Nodes of the thesis's plate, 11 x 21.
fn plate_nodes() -> Vec<Vector3<f64>> {
    let model = agard_wing("R765", 11, 21, ThicknessRule::Nodal).model().unwrap();
    model.nodes.iter().map(|n| n.position).collect()
}

/// Points of a wing surface: both sides of a section of 4 % thickness, overhanging nose, tail and tip by 1 %.
fn wing_points(chordwise: usize, spanwise: usize) -> Vec<Vector3<f64>> {
    let mut points = Vec::new();
    for j in 0..=spanwise {
        for i in 0..=2 * chordwise {
            let around = std::f64::consts::PI * i as f64 / chordwise as f64;
            let (s, y) = (0.5 + 0.51 * around.cos(), 1.01 * j as f64 / spanwise as f64);
            let (leading, chord) = (0.8094 * y, 0.5587 + (0.3682 - 0.5587) * y);
            points.push(Vector3::new(
                leading + s * chord,
                0.762 * y,
                0.02 * chord * around.sin(),
            ));
        }
    }
    points
}

#[test]
fn one_tetrahedron_keeps_its_volume_and_follows_rigid_motion() {
    let triangle = [
        Vector3::new(0.1, 0.2, 0.0),
        Vector3::new(0.5, 0.1, 0.1),
        Vector3::new(0.2, 0.6, -0.1),
    ];
    let point = Vector3::new(0.9, 0.3, 0.2);
    let tied = ConstantVolume::new(triangle, point).unwrap();
    assert!((tied.position(&triangle) - point).norm() < 1e-15);
    let turn = Rotation3::from_euler_angles(0.4, -1.1, 2.0);
    let shift = Vector3::new(3.0, -1.0, 0.5);
    let rigid = triangle.map(|p| turn * p + shift);
    assert!((tied.position(&rigid) - (turn * point + shift)).norm() < 1e-14);
    let bent = [
        triangle[0] + Vector3::new(0.05, 0.0, 0.02),
        triangle[1] + Vector3::new(0.0, -0.1, 0.1),
        triangle[2] + Vector3::new(-0.05, 0.1, 0.0),
    ];
    let volume = |t: &[Vector3<f64>; 3], p: Vector3<f64>| (t[1] - t[0]).cross(&(t[2] - t[0])).dot(&(p - t[0])) / 6.0;
    assert!((volume(&bent, tied.position(&bent)) - volume(&triangle, point)).abs() < 1e-16);
}

#[test]
fn derivatives_are_those_of_the_tetrahedron() {
    let triangle = [
        Vector3::new(0.1, 0.2, 0.0),
        Vector3::new(0.5, 0.1, 0.1),
        Vector3::new(0.2, 0.6, -0.1),
    ];
    let tied = ConstantVolume::new(triangle, Vector3::new(0.9, 0.3, 0.2)).unwrap();
    let matrices = tied.derivatives();
    let h = 1e-5;
    for corner in 0..3 {
        for d in 0..3 {
            let at = |s: f64| {
                let mut moved = triangle;
                moved[corner][d] += s;
                tied.position(&moved)
            };
            let difference = (at(h) - at(-h)) / (2.0 * h);
            assert!((difference - matrices[corner].column(d)).norm() < 1e-8);
        }
    }
}

#[test]
fn rigid_motion_work_force_and_moment_are_kept_to_rounding() {
    for nodes in [plate_nodes(), yates().nodes.iter().map(|n| n.position).collect()] {
        let surface = StructuralSurface::triangulate(&nodes).unwrap();
        assert!(surface.left_out().is_empty());
        for attachment in BOTH {
            let transfer = Transfer::new(&surface, &wing_points(24, 40), attachment).unwrap();
            let check = transfer.check();
            assert!(check.translation_error_m < 1e-12, "{check:?}");
            assert!(check.rotation_error < 1e-12, "{check:?}");
            assert!(check.balance_error < 1e-12, "{check:?}");
            assert!(check.virtual_work_error < 1e-12, "{check:?}");
            // Points off the plate by 2 % of the chord and beyond it by 1 % are no lever of any size.
            assert!(check.amplification < 4.0, "{check:?}");
        }
    }
}

#[test]
fn forces_and_displacements_do_the_same_work() {
    let nodes = plate_nodes();
    let points = wing_points(16, 20);
    let surface = StructuralSurface::triangulate(&nodes).unwrap();
    for attachment in BOTH {
        let transfer = Transfer::new(&surface, &points, attachment).unwrap();
        let force: Vec<Vector3<f64>> = points
            .iter()
            .map(|p| Vector3::new(p.z, 0.3 * p.x, (7.0 * p.y).cos()))
            .collect();
        let motion: Vec<Vector3<f64>> = nodes
            .iter()
            .map(|p| Vector3::new(0.1 * p.y, p.x * p.x, p.y * p.y))
            .collect();
        let outside: f64 = transfer
            .displacements(&motion)
            .unwrap()
            .iter()
            .zip(&force)
            .map(|(u, f)| u.dot(f))
            .sum();
        let inside: f64 = transfer
            .forces(&force)
            .unwrap()
            .iter()
            .zip(&motion)
            .map(|(f, u)| f.dot(u))
            .sum();
        assert!(((inside - outside) / outside).abs() < 1e-12);
        let total: Vector3<f64> = transfer.forces(&force).unwrap().iter().sum();
        let given: Vector3<f64> = force.iter().sum();
        assert!((total - given).norm() < 1e-11 * given.norm());
    }
}

#[test]
fn the_hull_of_nodes_in_line_but_for_rounding_has_no_slivers() {
    // Coordinates as in a printed table: the edges of the planform are straight to 1e-4 only.
    let nodes: Vec<Vector3<f64>> = plate_nodes()
        .iter()
        .map(|p| p.map(|v| (1e4 * v).round() / 1e4))
        .collect();
    let surface = StructuralSurface::triangulate(&nodes).unwrap();
    // 10 x 20 quadrilaterals, two triangles each.
    assert_eq!(surface.triangles().len(), 400);
    for t in surface.triangles() {
        let [a, b, c] = t.map(|n| nodes[n]);
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let height = (b - a).cross(&(c - a)).norm() / longest;
        assert!(height > 0.2 * longest, "{t:?}");
    }
}

/// Largest error of a transferred bending and twisting shape on a plate of `n` x `n` cells, at points in its plane.
fn shape_error(n: usize, attachment: Attachment, inside_only: bool) -> f64 {
    let at = |i: usize| i as f64 / n as f64;
    let nodes: Vec<Vector3<f64>> = (0..=n)
        .flat_map(|j| (0..=n).map(move |i| Vector3::new(at(i) + 0.3 * at(j), at(j), 0.0)))
        .collect();
    let shape = |p: &Vector3<f64>| Vector3::new(0.0, 0.0, (1.3 * p.y).powi(2) * (1.0 + (p.x - p.y).sin()));
    let motion: Vec<Vector3<f64>> = nodes.iter().map(shape).collect();
    let (from, to) = if inside_only { (0.25, 0.75) } else { (0.0, 1.0) };
    let points: Vec<Vector3<f64>> = (0..=60)
        .flat_map(|j| {
            (0..=60).map(move |i| {
                let (x, y) = (
                    from + (to - from) * f64::from(i) / 60.0,
                    from + (to - from) * f64::from(j) / 60.0,
                );
                Vector3::new(x + 0.3 * y, y, 0.0)
            })
        })
        .collect();
    let surface = StructuralSurface::triangulate(&nodes).unwrap();
    let moved = Transfer::new(&surface, &points, attachment)
        .unwrap()
        .displacements(&motion)
        .unwrap();
    moved
        .iter()
        .zip(&points)
        .map(|(u, p)| (u - shape(p)).norm())
        .fold(0.0, f64::max)
}

#[test]
fn transferred_shapes_converge_with_second_order_and_blending_is_better() {
    for attachment in BOTH {
        for inside_only in [true, false] {
            let (coarse, fine) = (
                shape_error(16, attachment, inside_only),
                shape_error(32, attachment, inside_only),
            );
            let order = (coarse / fine).log2();
            assert!(order > 1.7, "{attachment:?} {inside_only} {order}");
        }
    }
    // Inside, where triangles are regular, the second derivatives cancel.
    assert!(shape_error(32, Attachment::Blended, true) < 0.25 * shape_error(32, Attachment::Nearest, true));
}

/// Largest jump between the displacements of two points that are next to each other, over their distance, for a
/// displacement of slope 2 or so.
fn steepest(attachment: Attachment) -> f64 {
    let nodes = plate_nodes();
    let surface = StructuralSurface::triangulate(&nodes).unwrap();
    // A line ahead of the leading edge, off the plane, in steps of 1 um at places where triangles change.
    let points: Vec<Vector3<f64>> = (0..40_000)
        .map(|n| {
            let y = 0.1 + 1e-5 * f64::from(n);
            Vector3::new(0.8094 / 0.762 * y - 0.01, y, 0.008)
        })
        .collect();
    let motion: Vec<Vector3<f64>> = nodes
        .iter()
        .map(|p| Vector3::new(0.0, 0.0, p.y * p.y - p.x * p.y))
        .collect();
    let moved = Transfer::new(&surface, &points, attachment)
        .unwrap()
        .displacements(&motion)
        .unwrap();
    let steps = moved.windows(2).zip(points.windows(2));
    steps
        .map(|(u, p)| (u[1] - u[0]).norm() / (p[1] - p[0]).norm())
        .fold(0.0, f64::max)
}

#[test]
fn blending_is_continuous_where_the_overhang_passes_from_triangle_to_triangle() {
    assert!(steepest(Attachment::Blended) < 4.0, "{}", steepest(Attachment::Blended));
    // The nearest triangle alone jumps: this shows that the measure sees it.
    assert!(
        steepest(Attachment::Nearest) > 10.0,
        "{}",
        steepest(Attachment::Nearest)
    );
}

#[test]
fn facets_of_the_structure_on_the_wall_are_measured() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes/agard445_ch_euler.toml");
    let grid = dip_grid::recipe::make(&path).unwrap();
    let wall = MovingWall::new(&grid, |p| p.condition.is_wall()).unwrap();
    // Four nodes along the span: facets larger than the faces of the wall.
    let nodes: Vec<_> = (0..=4)
        .flat_map(|j| (0..=4).map(move |i| (0.25 * f64::from(i), 0.25 * f64::from(j))))
        .map(|(s, y)| Vector3::new(0.8094 * y + s * (0.5587 - 0.1905 * y), 0.762 * y, 0.0))
        .collect();
    let surface = StructuralSurface::triangulate(&nodes).unwrap();
    let kink = |attachment, motion: &dyn Fn(&Vector3<f64>) -> Vector3<f64>| {
        let transfer = Transfer::new(&surface, &wall.points(), attachment).unwrap();
        let shape = transfer
            .displacements(&nodes.iter().map(motion).collect::<Vec<_>>())
            .unwrap();
        wall.largest_kink(&shape, 1e-3)
    };
    // A translation has none, a bent plate has its own curvature, and single triangles add their edges to it.
    let shift = kink(Attachment::Blended, &|_| Vector3::new(0.0, 0.0, 1.0));
    assert!(shift < 1e-12, "{shift}");
    let bend = |p: &Vector3<f64>| Vector3::new(0.0, 0.0, p.y * p.y);
    let [nearest, blended] = BOTH.map(|a| kink(a, &bend));
    println!("largest kink: nearest {nearest:.2e}, blended {blended:.2e} rad");
    assert!(blended < 0.7 * nearest, "{blended} {nearest}");
}

#[test]
fn overhang_goes_on_in_a_straight_line() {
    // A displacement linear in the plan view is met exactly however far outside: heave, pitch and roll of the plate.
    let nodes = plate_nodes();
    let surface = StructuralSurface::triangulate(&nodes).unwrap();
    let linear = |p: &Vector3<f64>| Vector3::new(0.0, 0.0, 0.1 - 0.4 * p.x + 0.7 * p.y);
    let motion: Vec<Vector3<f64>> = nodes.iter().map(linear).collect();
    let points: Vec<Vector3<f64>> = (0..100)
        .map(|n| {
            let angle = 0.1 * f64::from(n);
            Vector3::new(0.6 + 0.9 * angle.cos(), 0.4 + 0.9 * angle.sin(), 0.0)
        })
        .collect();
    for attachment in BOTH {
        let moved = Transfer::new(&surface, &points, attachment)
            .unwrap()
            .displacements(&motion)
            .unwrap();
        for (u, p) in moved.iter().zip(&points) {
            assert!((u - linear(p)).norm() < 1e-12);
        }
    }
}

#[test]
fn tables_with_heave_only_give_modes_that_tilt_the_section() {
    let modes = yates();
    let surface = StructuralSurface::of_modes(&modes).unwrap();
    let points = wing_points(16, 20);
    let transfer = Transfer::new(&surface, &points, Attachment::Blended).unwrap();
    let shapes = transfer.modes(&modes).unwrap();
    assert_eq!((shapes.len(), shapes[0].len()), (modes.count(), points.len()));
    // Upper and lower side of a bent wing move alike in z, and in opposite directions along it by the slope.
    let last = points.len() - 33;
    let (upper, lower) = (shapes[0][last + 8], shapes[0][last + 24]);
    assert!((points[last + 8].z + points[last + 24].z).abs() < 1e-12);
    assert!((upper.z - lower.z).abs() < 1e-6 * upper.z.abs());
    let tip = shapes[0][last + 8].z;
    assert!(upper.y * lower.y < 0.0 && upper.y.abs() < 0.1 * tip.abs() && upper.y.abs() > 1e-3 * tip.abs());
}

#[test]
fn what_cannot_be_transferred_is_refused() {
    let line: Vec<Vector3<f64>> = (0..9)
        .map(|n| Vector3::new(f64::from(n), 2.0 * f64::from(n), 0.0))
        .collect();
    assert!(matches!(
        StructuralSurface::triangulate(&line),
        Err(TransferError::OnOneLine { nodes: 9, .. })
    ));
    // As a table with two decimals has it.
    let rounded: Vec<Vector3<f64>> = (0..9)
        .map(|n| Vector3::new((f64::from(n) * 0.3127 * 100.0).round() / 100.0, f64::from(n), 0.0))
        .collect();
    assert!(matches!(
        StructuralSurface::triangulate(&rounded),
        Err(TransferError::OnOneLine { nodes: 9, .. })
    ));
    assert!(matches!(
        StructuralSurface::triangulate(&line[..2]),
        Err(TransferError::TooFewNodes { got: 2 })
    ));
    let mut broken = plate_nodes();
    broken[7].y = f64::NAN;
    assert!(matches!(
        StructuralSurface::triangulate(&broken),
        Err(TransferError::NotFinite { index: 7, .. })
    ));
    let flat = StructuralSurface::new(line.clone(), vec![[0, 1, 2]]);
    assert!(matches!(flat, Err(TransferError::Triangle { triangle: 0, .. })));
    let unknown = StructuralSurface::new(plate_nodes(), vec![[0, 1, 12], [0, 1, 900]]);
    assert!(matches!(unknown, Err(TransferError::Triangle { triangle: 1, .. })));
    let surface = StructuralSurface::triangulate(&plate_nodes()).unwrap();
    let transfer = Transfer::new(&surface, &wing_points(4, 4), Attachment::Blended).unwrap();
    assert!(matches!(
        transfer.displacements(&line),
        Err(TransferError::Count { needed: 231, .. })
    ));
    assert!(matches!(
        transfer.modes(&yates()),
        Err(TransferError::Count {
            got: 121,
            needed: 231,
            ..
        })
    ));
}
