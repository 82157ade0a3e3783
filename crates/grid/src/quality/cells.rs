//! Figures of single cells: volume, folding, skewness, stretching, closure, height on walls.

use super::{CellPlace, Figure, Finding, names};
use crate::block::Block;
use crate::metrics::{Metrics, hexahedron_volume};
use crate::topology::MultiBlock;
use crate::vector::{cross, distance, dot, norm, scale, sub, unit};

/// How many worst cells a figure keeps.
const KEPT: usize = 5;
pub(super) struct Tally {
    name: &'static str,
    /// -1: small values are worst; 1: large ones.
    sense: f64,
    worst: Vec<CellPlace>,
    pub(super) sum: f64,
}

impl Tally {
    pub(super) fn new(name: &'static str, sense: f64) -> Self {
        Self {
            name,
            sense,
            worst: Vec::new(),
            sum: 0.0,
        }
    }

    pub(super) fn all() -> Vec<Self> {
        [
            (names::VOLUME, -1.0),
            (names::JACOBIAN, -1.0),
            (names::SKEWNESS, 1.0),
            (names::STRETCHING, 1.0),
            (names::CLOSURE, 1.0),
        ]
        .into_iter()
        .map(|(name, sense)| Self::new(name, sense))
        .collect()
    }

    fn badness(&self, value: f64) -> f64 {
        if value.is_nan() {
            f64::INFINITY
        } else {
            self.sense * value
        }
    }

    pub(super) fn add(&mut self, value: f64, place: impl FnOnce() -> CellPlace) {
        self.sum += value;
        let full = self.worst.len() == KEPT;
        if full && self.badness(value) <= self.badness(self.worst[KEPT - 1].value) {
            return;
        }
        let at = self
            .worst
            .partition_point(|w| self.badness(w.value) >= self.badness(value));
        self.worst.insert(at, CellPlace { value, ..place() });
        self.worst.truncate(KEPT);
    }

    pub(super) fn merge(&mut self, other: Self) {
        let sum = self.sum + other.sum;
        for place in other.worst {
            self.add(place.value, || place);
        }
        self.sum = sum;
    }

    pub(super) fn figure(self, cells: usize) -> Figure {
        Figure {
            name: self.name,
            worst: self.worst,
            mean: self.sum / cells.max(1) as f64,
        }
    }
}

pub(super) fn tally(n: usize, block: &Block) -> Vec<Tally> {
    let mut tallies = Tally::all();
    let metrics = Metrics::new(block);
    let cells = block.cells();
    let [ni, nj, nk] = cells;
    for k in 0..nk {
        for j in 0..nj {
            for i in 0..ni {
                let place = || CellPlace {
                    block: n,
                    ijk: [i, j, k],
                    centre: block.cell_centre(i, j, k),
                    value: 0.0,
                };
                let corners = block.corners(i, j, k);
                let volume = metrics.volume[block.cell(i, j, k)];
                let f = [
                    i + (ni + 1) * (j + nj * k),
                    i + ni * (j + (nj + 1) * k),
                    i + ni * (j + nj * k),
                ];
                let next = [1, ni, ni * nj];
                let mut area = 0.0;
                for (s, (f, next)) in [&metrics.si, &metrics.sj, &metrics.sk]
                    .into_iter()
                    .zip(f.into_iter().zip(next))
                {
                    for m in [f, f + next] {
                        area += norm([s[0][m], s[1][m], s[2][m]]);
                    }
                }
                let open = norm(metrics.closure(cells, i, j, k));
                let values = [
                    volume,
                    corner_jacobian(&corners),
                    skewness_deg(&corners),
                    stretching(block, i, j, k, volume.abs(), &metrics),
                    if area > 0.0 { open / area } else { 0.0 },
                ];
                for (tally, value) in tallies.iter_mut().zip(values) {
                    tally.add(value, place);
                }
            }
        }
    }
    tallies
}

/// Smallest of the eight corners' Jacobians over the product of the three edges there. Corners with an edge of no
/// length (a collapsed edge) do not count.
fn corner_jacobian(c: &[[f64; 3]; 8]) -> f64 {
    let mut worst = f64::INFINITY;
    for (n, &corner) in c.iter().enumerate() {
        let edge = |bit: usize| {
            let e = sub(c[n ^ bit], corner);
            if n & bit == 0 { e } else { scale(-1.0, e) }
        };
        let (a, b, d) = (edge(1), edge(2), edge(4));
        let product = norm(a) * norm(b) * norm(d);
        if product > 0.0 {
            worst = worst.min(dot(a, cross(b, d)) / product);
        }
    }
    if worst.is_finite() { worst } else { 0.0 }
}

/// Largest departure from 90 degrees between the lines that join opposite face centres.
fn skewness_deg(c: &[[f64; 3]; 8]) -> f64 {
    let line = |bit: usize| {
        let mut sum = [0.0; 3];
        for (n, corner) in c.iter().enumerate() {
            for d in 0..3 {
                sum[d] += if n & bit == 0 { -corner[d] } else { corner[d] };
            }
        }
        unit(sum)
    };
    let (a, b, d) = (line(1), line(2), line(4));
    let worst = [dot(a, b), dot(b, d), dot(a, d)]
        .into_iter()
        .fold(0.0, |w: f64, v| w.max(v.abs()));
    worst.min(1.0).asin().to_degrees()
}

/// Largest ratio of thickness (volume over mean area) to the next cell's along i, j or k.
fn stretching(block: &Block, i: usize, j: usize, k: usize, volume: f64, m: &Metrics) -> f64 {
    let [ni, nj, nk] = block.cells();
    let mut worst = 1.0f64;
    let area = |s: &[Vec<f64>; 3], n: usize| norm([s[0][n], s[1][n], s[2][n]]);
    let mut compare = |more: bool, thickness: f64, other: &dyn Fn() -> f64| {
        if more {
            let other = other();
            worst = worst.max(thickness / other).max(other / thickness);
        }
    };
    let fi = |i: usize| i + (ni + 1) * (j + nj * k);
    let thick_i = |i: usize, v: f64| 2.0 * v / (area(&m.si, fi(i)) + area(&m.si, fi(i + 1)));
    compare(i + 1 < ni, thick_i(i, volume), &|| {
        thick_i(i + 1, m.volume[block.cell(i + 1, j, k)].abs())
    });
    let fj = |j: usize| i + ni * (j + (nj + 1) * k);
    let thick_j = |j: usize, v: f64| 2.0 * v / (area(&m.sj, fj(j)) + area(&m.sj, fj(j + 1)));
    compare(j + 1 < nj, thick_j(j, volume), &|| {
        thick_j(j + 1, m.volume[block.cell(i, j + 1, k)].abs())
    });
    let fk = |k: usize| i + ni * (j + nj * k);
    let thick_k = |k: usize, v: f64| 2.0 * v / (area(&m.sk, fk(k)) + area(&m.sk, fk(k + 1)));
    compare(k + 1 < nk, thick_k(k, volume), &|| {
        thick_k(k + 1, m.volume[block.cell(i, j, k + 1)].abs())
    });
    worst
}
fn name_cell(grid: &MultiBlock, place: &CellPlace) -> String {
    let [i, j, k] = place.ijk;
    let [x, y, z] = place.centre;
    let name = grid.blocks.get(place.block).map_or("?", |b| b.name.as_str());
    format!(
        "block {} ({name}) cell ({i}, {j}, {k}) at ({x:.6}, {y:.6}, {z:.6})",
        place.block
    )
}
pub(super) fn volume_findings(grid: &MultiBlock, figures: &[Figure], findings: &mut Vec<Finding>) {
    for (n, block) in grid.blocks.iter().enumerate() {
        let mut negative = 0usize;
        let mut tiny = 0usize;
        let mut first = None;
        for cell in 0..block.cell_count() {
            let [i, j, k] = block.cell_ijk(cell);
            let corners = block.corners(i, j, k);
            let volume = hexahedron_volume(&corners);
            let size = (1..8).map(|m| distance(corners[0], corners[m])).fold(0.0, f64::max);
            if volume <= 0.0 {
                negative += 1;
                first.get_or_insert([i, j, k]);
            } else if volume < 1e-14 * size * size * size {
                tiny += 1;
                first.get_or_insert([i, j, k]);
            }
        }
        if negative + tiny == 0 {
            continue;
        }
        let ijk = first.unwrap_or_default();
        let centre = block.cell_centre(ijk[0], ijk[1], ijk[2]);
        let place = name_cell(
            grid,
            &CellPlace {
                block: n,
                ijk,
                centre,
                value: 0.0,
            },
        );
        if negative == block.cell_count() {
            let text = format!(
                "block {n} ({}) is left-handed: all volumes are negative; turn it (reverse k)",
                block.name
            );
            findings.push(Finding { fatal: true, text });
        } else if negative > 0 {
            findings.push(Finding {
                fatal: true,
                text: format!("{negative} cells without positive volume, first {place}"),
            });
        } else {
            findings.push(Finding {
                fatal: false,
                text: format!("{tiny} cells of nearly no volume, first {place}"),
            });
        }
    }
    let limits = [
        // At the edge of a sheet a corner of 180 degrees is right: zero, give or take the sheet's curvature.
        (
            names::JACOBIAN,
            -0.1,
            "folded at a corner",
            "; smooth the lines there (in C-H recipes, at the nose of the sheet outboard of a tip: take wing.sheet = \
             \"straight\", a larger spacing.nose, or spacing.wake_growth = 0)",
        ),
        (names::SKEWNESS, 88.0, "very skewed", ""),
        (
            names::STRETCHING,
            20.0,
            "much larger or smaller than their neighbours",
            "; more cells there, or larger first steps, even the growth out",
        ),
        (names::CLOSURE, 1e-12, "not closed", ""),
    ];
    for (name, limit, what, advice) in limits {
        let Some(place) = figures.iter().find(|f| f.name == name).and_then(|f| f.worst.first()) else {
            continue;
        };
        let bad = if name == names::JACOBIAN {
            place.value < limit
        } else {
            place.value > limit
        };
        if bad || place.value.is_nan() {
            let text = format!(
                "cells are {what}: {name} {:.4e} at {}{advice}",
                place.value,
                name_cell(grid, place)
            );
            findings.push(Finding { fatal: false, text });
        }
    }
}
