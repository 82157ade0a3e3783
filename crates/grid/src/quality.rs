//! Is the grid good? Volumes, closure, skewness, stretching, wall spacing, interfaces, faces without a condition.

use std::fmt;

use rayon::prelude::*;

use crate::block::Block;
use crate::face::Face;
use crate::metrics::{Metrics, hexahedron_volume};
use crate::topology::{MultiBlock, Side};
use crate::vector::{cross, distance, dot, norm, scale, sub, unit};

/// A cell that a message names.
#[derive(Clone, Debug, PartialEq)]
pub struct CellPlace {
    /// Index of the block.
    pub block: usize,
    /// Indices of the cell.
    pub ijk: [usize; 3],
    /// Mean of its corners.
    pub centre: [f64; 3],
    /// The figure that is worst there.
    pub value: f64,
}

/// One figure over all cells: its worst value and the cells that have the worst values.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What is measured, with its unit.
    pub name: &'static str,
    /// The cells with the worst values, worst first.
    pub worst: Vec<CellPlace>,
    /// Mean over all cells.
    pub mean: f64,
}

/// A finding a user must look at.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// True if the grid cannot be used so.
    pub fatal: bool,
    /// Where, what, what to do.
    pub text: String,
}

/// What a check found.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Blocks.
    pub blocks: usize,
    /// Cells.
    pub cells: usize,
    /// Nodes, those on interfaces once for each block.
    pub nodes: usize,
    /// Sum of all volumes.
    pub volume: f64,
    /// Figures with their worst cells.
    pub figures: Vec<Figure>,
    /// Smallest, mean and largest height of the cells on walls, if there are any.
    pub wall_spacing: Option<[f64; 3]>,
    /// Findings; empty for a good grid.
    pub findings: Vec<Finding>,
}

impl Report {
    /// True if nothing was found that a user must look at.
    #[must_use]
    pub fn is_good(&self) -> bool {
        self.findings.is_empty()
    }

    /// The figure called `name`.
    #[must_use]
    pub fn figure(&self, name: &str) -> Option<&Figure> {
        self.figures.iter().find(|f| f.name == name)
    }
}

/// Names of the figures, for [`Report::figure`].
pub mod names {
    /// Smallest volume.
    pub const VOLUME: &str = "volume";
    /// Smallest scaled corner Jacobian: 1 is a box, 0 flat, below 0 folded. Corners of collapsed edges do not count.
    pub const JACOBIAN: &str = "corner Jacobian";
    /// Largest departure of an angle between the lines through a cell from 90 degrees.
    pub const SKEWNESS: &str = "skewness (deg)";
    /// Largest ratio of the sizes of neighbouring cells along one direction.
    pub const STRETCHING: &str = "stretching";
    /// Largest sum of area vectors of a cell over the sum of the areas.
    pub const CLOSURE: &str = "closure";
}

/// How many worst cells a figure keeps.
const KEPT: usize = 5;

/// Checks the grid: every cell, every interface, every face.
#[must_use]
pub fn check(grid: &MultiBlock) -> Report {
    let parts: Vec<Vec<Tally>> = grid.blocks.par_iter().enumerate().map(|(n, b)| tally(n, b)).collect();
    let mut tallies = Tally::all();
    for part in parts {
        for (sum, one) in tallies.iter_mut().zip(part) {
            sum.merge(one);
        }
    }
    let cells = grid.cell_count();
    let volume = tallies[0].sum;
    let figures: Vec<Figure> = tallies.into_iter().map(|t| t.figure(cells)).collect();
    let mut findings = Vec::new();
    for (n, block) in grid.blocks.iter().enumerate() {
        if let Some(node) = (0..block.node_count())
            .find(|&m| !(block.x[m].is_finite() && block.y[m].is_finite() && block.z[m].is_finite()))
        {
            let [ni, nj, _] = block.nodes();
            let (i, j, k) = (node % ni, node / ni % nj, node / (ni * nj));
            findings.push(Finding {
                fatal: true,
                text: format!(
                    "block {} ({}): node ({i}, {j}, {k}) is not a finite number",
                    n, block.name
                ),
            });
        }
    }
    volume_findings(grid, &figures, &mut findings);
    interface_findings(grid, &mut findings);
    cover_findings(grid, &mut findings);
    Report {
        blocks: grid.blocks.len(),
        cells,
        nodes: grid.node_count(),
        volume,
        figures,
        wall_spacing: wall_spacing(grid),
        findings,
    }
}

struct Tally {
    name: &'static str,
    /// -1: small values are worst; 1: large ones.
    sense: f64,
    worst: Vec<CellPlace>,
    sum: f64,
}

impl Tally {
    fn all() -> Vec<Self> {
        [
            (names::VOLUME, -1.0),
            (names::JACOBIAN, -1.0),
            (names::SKEWNESS, 1.0),
            (names::STRETCHING, 1.0),
            (names::CLOSURE, 1.0),
        ]
        .into_iter()
        .map(|(name, sense)| Self {
            name,
            sense,
            worst: Vec::new(),
            sum: 0.0,
        })
        .collect()
    }

    fn badness(&self, value: f64) -> f64 {
        if value.is_nan() {
            f64::INFINITY
        } else {
            self.sense * value
        }
    }

    fn add(&mut self, value: f64, place: impl FnOnce() -> CellPlace) {
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

    fn merge(&mut self, other: Self) {
        let sum = self.sum + other.sum;
        for place in other.worst {
            self.add(place.value, || place);
        }
        self.sum = sum;
    }

    fn figure(self, cells: usize) -> Figure {
        Figure {
            name: self.name,
            worst: self.worst,
            mean: self.sum / cells.max(1) as f64,
        }
    }
}

fn tally(n: usize, block: &Block) -> Vec<Tally> {
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

fn volume_findings(grid: &MultiBlock, figures: &[Figure], findings: &mut Vec<Finding>) {
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
        (names::JACOBIAN, -0.1, "folded at a corner"),
        (names::SKEWNESS, 88.0, "very skewed"),
        (names::STRETCHING, 20.0, "much larger or smaller than their neighbours"),
        (names::CLOSURE, 1e-12, "not closed"),
    ];
    for (name, limit, what) in limits {
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
                "cells are {what}: {name} {:.4e} at {}",
                place.value,
                name_cell(grid, place)
            );
            findings.push(Finding { fatal: false, text });
        }
    }
}

/// Distance between nodes an interface says are one, relative to the cells there.
fn interface_findings(grid: &MultiBlock, findings: &mut Vec<Finding>) {
    for (n, interface) in grid.topology.interfaces.iter().enumerate() {
        let what = format!(
            "interface {} between {} and {}",
            n,
            name_side(grid, interface.a),
            name_side(grid, interface.b)
        );
        let valid = |s: Side| {
            grid.blocks.get(s.block).is_some_and(|b| {
                let c = b.face_cells(s.face);
                (0..2).all(|d| s.window.lo[d] < s.window.hi[d] && s.window.hi[d] <= c[d])
            })
        };
        if !valid(interface.a) || !valid(interface.b) {
            findings.push(Finding {
                fatal: true,
                text: format!("{what}: a window does not lie on its face"),
            });
            continue;
        }
        if interface.orientation.size(interface.a.window.size()) != interface.b.window.size() {
            findings.push(Finding {
                fatal: true,
                text: format!("{what}: the windows have different sizes"),
            });
            continue;
        }
        let (a, b) = (&grid.blocks[interface.a.block], &grid.blocks[interface.b.block]);
        let shift = interface.translation.unwrap_or_default();
        let mut worst = (0.0, [0.0; 3]);
        let w = interface.a.window;
        for q in w.lo[1]..=w.hi[1] {
            for p in w.lo[0]..=w.hi[0] {
                let pa = a.point_at(a.node_behind(interface.a.face, p, q, 0));
                let [r, s] = interface.node_on_b(p, q);
                let pb = sub(b.point_at(b.node_behind(interface.b.face, r, s, 0)), shift);
                let gap = distance(pa, pb);
                if gap > worst.0 || gap.is_nan() {
                    worst = (gap, pa);
                }
            }
        }
        let [lo, hi] = grid.bounds();
        if worst.0.is_nan() || worst.0 > 1e-9 * distance(lo, hi) {
            let [x, y, z] = worst.1;
            let text = format!("{what}: nodes are {:.3e} apart at ({x:.6}, {y:.6}, {z:.6})", worst.0);
            findings.push(Finding { fatal: true, text });
        }
    }
}

/// Every face cell must be on one patch or one interface.
fn cover_findings(grid: &MultiBlock, findings: &mut Vec<Finding>) {
    let mut sides: Vec<(Side, String)> = Vec::new();
    for patch in &grid.topology.patches {
        sides.push((patch.side(), format!("patch {}", patch.name)));
    }
    for (n, interface) in grid.topology.interfaces.iter().enumerate() {
        sides.push((interface.a, format!("interface {n}")));
        sides.push((interface.b, format!("interface {n}")));
    }
    for (n, block) in grid.blocks.iter().enumerate() {
        for face in Face::ALL {
            let [np, nq] = block.face_cells(face);
            let mut owner = vec![usize::MAX; np * nq];
            let mut overlap = None;
            for (m, (side, _)) in sides
                .iter()
                .enumerate()
                .filter(|(_, (s, _))| s.block == n && s.face == face)
            {
                for q in side.window.lo[1]..side.window.hi[1].min(nq) {
                    for p in side.window.lo[0]..side.window.hi[0].min(np) {
                        let old = std::mem::replace(&mut owner[p + np * q], m);
                        if old != usize::MAX && overlap.is_none() {
                            overlap = Some((old, m, p, q));
                        }
                    }
                }
            }
            if let Some((old, new, p, q)) = overlap {
                let text = format!(
                    "block {n} ({}) {face}: {} and {} overlap, first at face cell ({p}, {q}); a face cell belongs to one",
                    block.name, sides[old].1, sides[new].1
                );
                findings.push(Finding { fatal: true, text });
            }
            let free = owner.iter().filter(|&&o| o == usize::MAX).count();
            if free > 0 {
                let first = owner.iter().position(|&o| o == usize::MAX).unwrap_or(0);
                let text = format!(
                    "block {n} ({}) {face}: {free} of {} face cells have no condition and no neighbour, first ({}, {})",
                    block.name,
                    np * nq,
                    first % np,
                    first / np
                );
                findings.push(Finding { fatal: true, text });
            }
        }
    }
}

fn name_side(grid: &MultiBlock, side: Side) -> String {
    let name = grid.blocks.get(side.block).map_or("?", |b| b.name.as_str());
    format!("block {} ({name}) {} {}", side.block, side.face, side.window)
}

/// Height of wall cells: volume over wall area.
fn wall_spacing(grid: &MultiBlock) -> Option<[f64; 3]> {
    let (mut least, mut sum, mut most, mut count) = (f64::INFINITY, 0.0, 0.0f64, 0usize);
    for patch in grid.topology.patches.iter().filter(|p| p.condition.is_wall()) {
        let block = grid.blocks.get(patch.block)?;
        let limit = block.face_cells(patch.face);
        for q in patch.window.lo[1]..patch.window.hi[1].min(limit[1]) {
            for p in patch.window.lo[0]..patch.window.hi[0].min(limit[0]) {
                let node = |dp: usize, dq: usize| block.point_at(block.node_behind(patch.face, p + dp, q + dq, 0));
                let area = norm(crate::metrics::face_area(
                    node(0, 0),
                    node(1, 0),
                    node(1, 1),
                    node(0, 1),
                ));
                let [i, j, k] = block.cell_behind(patch.face, p, q, 0);
                let height = hexahedron_volume(&block.corners(i, j, k)).abs() / area.max(f64::MIN_POSITIVE);
                least = least.min(height);
                most = most.max(height);
                sum += height;
                count += 1;
            }
        }
    }
    (count > 0).then(|| [least, sum / count as f64, most])
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} blocks, {} cells, {} nodes, volume {:.9e}",
            self.blocks, self.cells, self.nodes, self.volume
        )?;
        if let Some([least, mean, most]) = self.wall_spacing {
            writeln!(f, "height of wall cells: {least:.3e} to {most:.3e}, mean {mean:.3e}")?;
        }
        writeln!(
            f,
            "{:<18}{:>13}{:>13}  worst at (block; i, j, k; x, y, z)",
            "figure", "worst", "mean"
        )?;
        for figure in &self.figures {
            let Some(place) = figure.worst.first() else { continue };
            let ([i, j, k], [x, y, z]) = (place.ijk, place.centre);
            writeln!(
                f,
                "{:<18}{:>13.4e}{:>13.4e}  {}; {i}, {j}, {k}; {x:.5}, {y:.5}, {z:.5}",
                figure.name, place.value, figure.mean, place.block
            )?;
        }
        if self.findings.is_empty() {
            return writeln!(f, "nothing to complain about");
        }
        for finding in &self.findings {
            writeln!(f, "{}: {}", if finding.fatal { "ERROR" } else { "look" }, finding.text)?;
        }
        Ok(())
    }
}
