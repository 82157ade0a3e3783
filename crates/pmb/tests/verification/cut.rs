//! Cuts of walls at span stations.

use dip_pmb::cut::cut;
use dip_pmb::loads::WallPatch;

const CHORD: usize = 9;

/// Pressure that is linear in place, so that interpolation is exact.
fn pressure([x, y, _]: [f64; 3]) -> f64 {
    0.3 - 1.7 * x + 0.8 * y
}

/// Faces of a swept sheet between span stations `from` and `to`, `count` of them; its lattice runs along the chord first or,
/// `turned`, along the span from the tip inwards.
fn patch(from: f64, to: f64, count: usize, upper: bool, turned: bool) -> WallPatch {
    let size = if turned { [count, CHORD] } else { [CHORD, count] };
    let mut wall = WallPatch {
        name: "wing".into(),
        block: 0,
        size,
        centre: Vec::new(),
        area: Vec::new(),
        cp: Vec::new(),
    };
    for q in 0..size[1] {
        for p in 0..size[0] {
            let (c, s) = if turned { (q, count - 1 - p) } else { (p, q) };
            let y = from + (to - from) * (s as f64 + 0.5) / count as f64;
            // Cells a hundred times as wide at the nose as long.
            let chord = ((c as f64 + 0.5) / CHORD as f64).powi(3);
            let centre = [0.6 * y + chord * (1.0 - 0.3 * y), y, if upper { 0.02 } else { -0.02 }];
            wall.centre.push(centre);
            wall.area.push([0.0, 0.0, if upper { -1.0 } else { 1.0 }]);
            wall.cp.push(pressure(centre));
        }
    }
    wall
}

#[test]
fn a_station_between_two_patches_is_crossed_once() {
    let walls: Vec<WallPatch> = [true, false]
        .into_iter()
        .flat_map(|upper| {
            [
                patch(0.0, 0.9, 6, upper, false),
                patch(0.9, 1.0, 2, upper, true),
                patch(1.0, 1.3, 3, upper, false),
            ]
        })
        .collect();
    // Through centres, edges, gaps on either side of the edges at 0.9 and 1.0, and the half faces at root and tip.
    for y in [
        0.0, 0.01, 0.075, 0.4, 0.825, 0.84, 0.88, 0.9, 0.91, 0.95, 0.975, 0.99, 1.0, 1.03, 1.05, 1.26, 1.299,
    ] {
        let cut = cut(&walls, y, false);
        for (side, z) in [(&cut.upper, 0.02), (&cut.lower, -0.02)] {
            assert_eq!(side.len(), CHORD, "station {y}: {side:?}");
            for p in side {
                assert!((p[1] - z).abs() < 1e-12);
                let expected = pressure([p[0], y, p[1]]);
                assert!((p[2] - expected).abs() < 1e-12, "station {y}: {p:?}, {expected}");
            }
            for pair in side.windows(2) {
                assert!(pair[1][0] > pair[0][0], "station {y}: {pair:?}");
            }
        }
    }
    assert!(cut(&walls, 1.31, false).upper.is_empty());
}
