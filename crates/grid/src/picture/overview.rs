//! Which pictures show a grid: walls, symmetry plane, sections ever closer, the tip.

use super::{Camera, Picture, Sheet, draw};
use crate::face::Face;
use crate::topology::{Condition, MultiBlock, Patch};
use crate::vector::unit;

/// The pictures by which a grid is judged: in two dimensions the whole, the body, its nose and tail; in three the
/// surface from above and aslant, the symmetry plane, nose and tail at the root, the tip.
#[must_use]
pub fn overview(grid: &MultiBlock, title: &str) -> Vec<Picture> {
    let walls: Vec<&Patch> = grid.topology.patches.iter().filter(|p| p.condition.is_wall()).collect();
    let Some([lo, hi]) = bounds(grid, &walls) else {
        return whole(grid, title);
    };
    let mut pictures = Vec::new();
    let size = hi[0] - lo[0];
    let mut add = |name: &str, camera: Camera, window: [f64; 4], sheets: &[Sheet], solid: &[Sheet]| {
        let svg = draw(grid, &format!("{title}: {name}"), camera, window, sheets, solid);
        pictures.push(Picture { name: name.into(), svg });
    };
    let two_d = grid.is_two_dimensional();
    let plane: Vec<Sheet> = grid
        .topology
        .patches
        .iter()
        .filter(|p| p.condition == Condition::Symmetry && (!two_d || p.face == Face::KMin))
        .filter_map(|p| grid.blocks.get(p.block).map(|b| Sheet::patch(p, b)))
        .collect();
    let around = |centre: [f64; 2], half: f64| {
        [
            centre[0] - half,
            centre[0] + half,
            centre[1] - 0.7 * half,
            centre[1] + 0.7 * half,
        ]
    };
    let solid: Vec<Sheet> = walls
        .iter()
        .filter_map(|p| grid.blocks.get(p.block).map(|b| Sheet::patch(p, b)))
        .collect();
    if !two_d {
        let pad = 0.05 * (hi[1] - lo[1]);
        add(
            "surface",
            Camera::TOP,
            [lo[1] - pad, hi[1] + pad, -hi[0] - pad, -lo[0] + pad],
            &[],
            &solid,
        );
        let (right, up) = ([0.5, 0.85, 0.0], [0.42, -0.25, 0.87]);
        let camera = Camera {
            right: unit(right),
            up: unit(up),
        };
        let mut window = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        for sheet in &solid {
            let block = &grid.blocks[sheet.block];
            for q in sheet.range[1][0]..=sheet.range[1][1] {
                for p in sheet.range[0][0]..=sheet.range[0][1] {
                    let [x, y] = camera.see(sheet.point(block, p, q));
                    window = [window[0].min(x), window[1].max(x), window[2].min(y), window[3].max(y)];
                }
            }
        }
        let window = [window[0] - pad, window[1] + pad, window[2] - pad, window[3] + pad];
        add("aslant", camera, window, &[], &solid);
        let tip_nose = wall_point(grid, &walls, |p| p[1] - 1e-3 * p[0]);
        add(
            "tip-surface",
            Camera::TOP,
            around([tip_nose[1], -tip_nose[0]], 0.06 * size),
            &[],
            &solid,
        );
    }
    let root: Vec<Sheet> = plane.clone();
    let at_root = |p: [f64; 3]| if two_d { 0.0 } else { -1e3 * (p[1] - lo[1]).abs() };
    let nose = wall_point(grid, &walls, |p| at_root(p) - p[0]);
    let tail = wall_point(grid, &walls, |p| at_root(p) + p[0]);
    let chord = tail[0] - nose[0];
    let middle = [0.5 * (nose[0] + tail[0]), 0.5 * (nose[2] + tail[2])];
    let [glo, ghi] = grid.bounds();
    let far = 0.52 * (ghi[0] - glo[0]).max((ghi[2] - glo[2]) / 0.7);
    let label = if two_d { "whole" } else { "symmetry plane" };
    add(
        &label.replace(' ', "-"),
        Camera::SIDE,
        around([0.5 * (glo[0] + ghi[0]), 0.5 * (glo[2] + ghi[2])], far),
        &root,
        &[],
    );
    add("section", Camera::SIDE, around(middle, 0.8 * chord), &root, &[]);
    add(
        "nose",
        Camera::SIDE,
        around([nose[0] + 0.01 * chord, nose[2]], 0.03 * chord),
        &root,
        &[],
    );
    add(
        "tail",
        Camera::SIDE,
        around([tail[0], tail[2]], 0.06 * chord),
        &root,
        &[],
    );
    if !two_d {
        // A sheet of constant i through the wing near mid chord, seen from ahead: how lines wrap round the tip.
        let mut across = Vec::new();
        for patch in &walls {
            let (Some(block), Face::JMin) = (grid.blocks.get(patch.block), patch.face) else {
                continue;
            };
            for i in patch.window.lo[0]..=patch.window.hi[0] {
                let p = block.point(i, 0, patch.window.lo[1]);
                let next = block.point((i + 1).min(block.ni), 0, patch.window.lo[1]);
                let target = nose[0] + 0.5 * chord;
                let at_root = (p[1] - lo[1]).abs() <= 1e-9 * (hi[1] - lo[1]);
                if at_root && (p[0] - target) * (next[0] - target) <= 0.0 {
                    // The nearer of the two nodes, so that both sides of the wing take the same one.
                    let nearer = if (next[0] - target).abs() < (p[0] - target).abs() {
                        i + 1
                    } else {
                        i
                    };
                    across.push(Sheet::whole(patch.block, block, 0, nearer.min(block.ni)));
                }
            }
        }
        follow(grid, &mut across);
        let span = hi[1] - lo[1];
        add(
            "across",
            Camera::FRONT,
            [lo[1], hi[1] + span, -0.7 * span, 0.7 * span],
            &across,
            &[],
        );
        let window = around([hi[1], 0.0], 0.08 * span);
        add("tip", Camera::FRONT, window, &across, &[]);
    }
    pictures
}

/// Adds the sheets of constant i that go on from those given: two corners are shared.
fn follow(grid: &MultiBlock, sheets: &mut Vec<Sheet>) {
    let corners = |s: &Sheet| {
        let block = &grid.blocks[s.block];
        let [[p0, p1], [q0, q1]] = s.range;
        [(p0, q0), (p1, q0), (p1, q1), (p0, q1)].map(|(p, q)| s.point(block, p, q))
    };
    let mut known = 0;
    while known < sheets.len() {
        let here = corners(&sheets[known]);
        known += 1;
        for (n, block) in grid.blocks.iter().enumerate() {
            for i in 0..=block.ni {
                let sheet = Sheet::whole(n, block, 0, i);
                let shared = corners(&sheet).iter().filter(|c| here.contains(c)).count();
                if shared >= 2 && !sheets.iter().any(|s| s.block == n) {
                    sheets.push(sheet);
                }
            }
        }
    }
}

/// One picture of a grid without walls: its outside, aslant.
fn whole(grid: &MultiBlock, title: &str) -> Vec<Picture> {
    let mut sheets = Vec::new();
    for (n, block) in grid.blocks.iter().enumerate() {
        for (axis, at) in [(0, block.ni), (1, 0), (2, block.nk)] {
            sheets.push(Sheet::whole(n, block, axis, at));
        }
    }
    let camera = Camera {
        right: unit([0.5, 0.85, 0.0]),
        up: unit([0.42, -0.25, 0.87]),
    };
    let [lo, hi] = grid.bounds();
    let mut window = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
    for n in 0..8 {
        let corner = [0, 1, 2].map(|d| if n >> d & 1 == 0 { lo[d] } else { hi[d] });
        let [x, y] = camera.see(corner);
        window = [window[0].min(x), window[1].max(x), window[2].min(y), window[3].max(y)];
    }
    let svg = draw(grid, title, camera, window, &sheets, &sheets);
    vec![Picture {
        name: "whole".into(),
        svg,
    }]
}

fn bounds(grid: &MultiBlock, walls: &[&Patch]) -> Option<[[f64; 3]; 2]> {
    let mut out = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    each_point(grid, walls, |p| {
        for d in 0..3 {
            out[0][d] = out[0][d].min(p[d]);
            out[1][d] = out[1][d].max(p[d]);
        }
    });
    (out[0][0] < out[1][0]).then_some(out)
}

/// The wall node with the largest score.
fn wall_point(grid: &MultiBlock, walls: &[&Patch], score: impl Fn([f64; 3]) -> f64) -> [f64; 3] {
    let mut best = (f64::NEG_INFINITY, [0.0; 3]);
    each_point(grid, walls, |p| {
        if score(p) > best.0 {
            best = (score(p), p);
        }
    });
    best.1
}

fn each_point(grid: &MultiBlock, walls: &[&Patch], mut visit: impl FnMut([f64; 3])) {
    for patch in walls {
        let Some(block) = grid.blocks.get(patch.block) else {
            continue;
        };
        let n = block.face_cells(patch.face);
        for q in patch.window.lo[1]..=patch.window.hi[1].min(n[1]) {
            for p in patch.window.lo[0]..=patch.window.hi[0].min(n[0]) {
                visit(block.point_at(block.node_behind(patch.face, p, q, 0)));
            }
        }
    }
}
