//! From faces to boxes: lift and moment of every strip kept, whatever the faces.

use super::wing::{largest, wing};
use dip_correct::SampleError;
use dip_correct::sample::{BoxMap, Rule, Wall, WallFace, strip_loads_of_boxes};
use dip_dlm::aic::Aerodynamics;
use dip_dlm::c64;
use dip_dlm::lattice::{Lattice, PlaneSymmetry, Surface};
use proptest::prelude::*;

/// A closed thick wall round the wing: faces that do not fit the boxes, overhang edges and tip, and are twisted.
fn thick_wall(chordwise: usize, spanwise: usize, overhang: f64, twist: f64) -> Wall {
    let mut faces = Vec::new();
    let station = |i: usize, j: usize, side: f64| {
        let xi = -overhang
            + (1.0 + 2.0 * overhang) * (0.5 - 0.5 * (std::f64::consts::PI * i as f64 / chordwise as f64).cos());
        let eta = (1.0 + overhang) * j as f64 / spanwise as f64;
        let (le, chord) = (0.8094 * eta, 0.5587 + eta * (0.3682 - 0.5587));
        let thickness = 0.06 * (4.0 * xi * (1.0 - xi)).max(0.0).sqrt() * (1.05 - eta).max(0.0).sqrt();
        let camber = 0.02 * (3.0 * xi).sin() - twist * eta * (xi - 0.3);
        [le + xi * chord, eta * 0.762, chord * (camber + side * thickness)]
    };
    for side in [1.0, -1.0] {
        for j in 0..spanwise {
            for i in 0..chordwise {
                let mut corners = vec![
                    station(i, j, side),
                    station(i + 1, j, side),
                    station(i + 1, j + 1, side),
                    station(i, j + 1, side),
                ];
                if side < 0.0 {
                    corners.reverse();
                }
                faces.push(WallFace {
                    corners_m: corners,
                    source: faces.len(),
                });
            }
        }
    }
    Wall {
        faces,
        half_model: true,
    }
}

fn total(wall: &Wall, cp: &[c64]) -> (c64, c64) {
    // -Cp S_z and its moment about x = 0 from triangles: independent of the mapping's polygons.
    let (mut lift, mut moment) = (c64::new(0.0, 0.0), c64::new(0.0, 0.0));
    for face in &wall.faces {
        let c = &face.corners_m;
        for [a, b, d] in [[c[0], c[1], c[2]], [c[0], c[2], c[3]]] {
            let area = 0.5 * ((b[0] - a[0]) * (d[1] - a[1]) - (d[0] - a[0]) * (b[1] - a[1]));
            lift -= cp[face.source] * area;
            moment -= cp[face.source] * (area * (a[0] + b[0] + d[0]) / 3.0);
        }
    }
    (lift, moment)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn lift_and_moment_of_every_strip_are_kept(
        chordwise in 7_usize..40, spanwise in 5_usize..30, overhang in 0.0..0.03_f64, twist in -0.1..0.1_f64, seed in 0_u64..1000,
    ) {
        let wing = wing();
        let wall = thick_wall(chordwise, spanwise, overhang, twist);
        let map = BoxMap::new(&wall, wing.lattice(), Rule::Conservative).unwrap();
        let cp: Vec<c64> = (0..wall.faces.len())
            .map(|i| {
                let phase = (i as f64 + 1.0) * (seed as f64 + 0.618);
                c64::new(phase.sin(), (1.7 * phase).cos())
            })
            .collect();
        let (faces, boxes) = (map.strip_loads_of_faces(&cp), strip_loads_of_boxes(wing.lattice(), &map.to_boxes(&cp)));
        let size = largest(faces.lift_m2.iter().map(|z| z.norm()));
        for s in 0..faces.lift_m2.len() {
            prop_assert!((faces.lift_m2[s] - boxes.lift_m2[s]).norm() < 1e-10 * size);
            prop_assert!((faces.moment_m3[s] - boxes.moment_m3[s]).norm() < 1e-10 * size);
        }
        let (lift, moment) = total(&wall, &cp);
        let area: f64 = 2.0 * wing.lattice().area();
        prop_assert!((boxes.lift_m2.iter().sum::<c64>() - lift).norm() < 1e-10 * area);
        prop_assert!((boxes.moment_m3.iter().sum::<c64>() - moment).norm() < 1e-10 * area);
        // The chord is linear along the span, and goes on so beyond the tip.
        let planform = |to: f64| 0.5587 * to + 0.5 * to * to * (0.3682 - 0.5587);
        let beyond = 1.0 - planform(1.0) / ((1.0 + 2.0 * overhang) * planform(1.0 + overhang));
        prop_assert!((map.overhang() - beyond).abs() < 1e-9, "{} {beyond}", map.overhang());
    }
}

#[test]
fn a_uniform_pressure_difference_is_itself_on_every_box_under_every_rule() {
    let wing = wing();
    let wall = thick_wall(23, 17, 0.0, 0.05);
    let half = wall.faces.len() / 2;
    let cp: Vec<c64> = (0..2 * half)
        .map(|i| c64::new(if i < half { -0.4 } else { 0.6 }, 0.0))
        .collect();
    for rule in [Rule::Average, Rule::Point(0.75)] {
        let map = BoxMap::new(&wall, wing.lattice(), rule).unwrap();
        for p in map.to_boxes(&cp) {
            assert!((p - 1.0).norm() < 1e-12, "{rule:?} {p}");
        }
    }
    // With the force at the quarter chord a uniform pressure can't stay uniform at both ends; between them it does, up to the
    // taper of the boxes.
    let map = BoxMap::new(&wall, wing.lattice(), Rule::Conservative).unwrap();
    let dcp = map.to_boxes(&cp);
    for strip in wing.lattice().strips() {
        for p in &dcp[strip.first + 1..strip.first + strip.count - 2] {
            assert!((p - 1.0).norm() < 1e-3, "{p}");
        }
    }
}

#[test]
fn a_pressure_linear_along_the_chord_is_met_at_the_quarter_chord_of_the_boxes() {
    let surface = Surface::trapezoid("wing", ([0.0; 3], 1.0), ([0.0, 2.0, 0.0], 1.0), 10, 4);
    let wing = Aerodynamics::new(
        Lattice::new(vec![surface], PlaneSymmetry::Symmetric).unwrap(),
        dip_dlm::kernel::Kernel::QUARTIC,
        0.5,
    )
    .unwrap();
    let (nx, ny) = (200, 8);
    let mut faces = Vec::new();
    let mut cp = Vec::new();
    for (side, sign) in [(1.0, -0.5), (-1.0, 0.5)] {
        for j in 0..ny {
            for i in 0..nx {
                let at = |i: usize, j: usize| [i as f64 / nx as f64, 2.0 * j as f64 / ny as f64, 0.01 * side];
                let mut corners = vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                if side < 0.0 {
                    corners.reverse();
                }
                faces.push(WallFace {
                    corners_m: corners,
                    source: faces.len(),
                });
                cp.push(c64::new(sign * (1.0 - 0.8 * (i as f64 + 0.5) / nx as f64), 0.0));
            }
        }
    }
    let map = BoxMap::new(
        &Wall {
            faces,
            half_model: true,
        },
        wing.lattice(),
        Rule::Conservative,
    )
    .unwrap();
    let dcp = map.to_boxes(&cp);
    for strip in wing.lattice().strips() {
        let inner = strip.first + 1..strip.first + strip.count - 2;
        for (b, p) in wing.lattice().boxes()[inner.clone()].iter().zip(&dcp[inner]) {
            let want = 1.0 - 0.8 * b.force_point[0];
            assert!((p - want).norm() < 1e-3, "{p} {want}");
        }
    }
}

#[test]
fn half_a_wall_serves_a_whole_lattice_and_the_other_way_round() {
    let half = thick_wall(16, 12, 0.0, 0.0);
    let right = Surface::trapezoid("right", ([0.0; 3], 0.5587), ([0.8094, 0.762, 0.0], 0.3682), 6, 5);
    let left = Surface::trapezoid("left", ([0.8094, -0.762, 0.0], 0.3682), ([0.0; 3], 0.5587), 6, 5);
    let whole = Lattice::new(vec![left, right.clone()], PlaneSymmetry::None).unwrap();
    let cp: Vec<c64> = (0..half.faces.len()).map(|i| c64::new((i as f64).sin(), 0.3)).collect();
    let both = BoxMap::new(&half, &whole, Rule::Conservative).unwrap().to_boxes(&cp);
    let right_only = Lattice::new(vec![right], PlaneSymmetry::Symmetric).unwrap();
    let one = BoxMap::new(&half, &right_only, Rule::Conservative)
        .unwrap()
        .to_boxes(&cp);
    for (i, b) in right_only.boxes().iter().enumerate() {
        let twin = whole.boxes().iter().position(|o| {
            (o.mid_chord[0] - b.mid_chord[0]).abs() < 1e-12 && (o.mid_chord[1] + b.mid_chord[1]).abs() < 1e-12
        });
        assert!((both[twin.unwrap()] - one[i]).norm() < 1e-12);
    }
    // All faces of a whole wall on half a lattice: the right half counts.
    let full = half.with_image();
    let again = BoxMap::new(&full, &right_only, Rule::Conservative)
        .unwrap()
        .to_boxes(&cp);
    for (a, b) in again.iter().zip(&one) {
        assert!((a - b).norm() < 1e-12);
    }
}

#[test]
fn a_wall_of_one_side_or_of_another_wing_is_refused() {
    let wing = wing();
    let mut wall = thick_wall(12, 9, 0.0, 0.0);
    wall.faces.truncate(12 * 9);
    assert!(matches!(
        BoxMap::new(&wall, wing.lattice(), Rule::Conservative),
        Err(SampleError::Uncovered { side: "lower", .. })
    ));
    wall.faces.clear();
    assert_eq!(
        BoxMap::new(&wall, wing.lattice(), Rule::Average).unwrap_err(),
        SampleError::NoFaces
    );
}
