//! The pressure distribution on a wall along a span station.
//!
//! The centres of a patch's faces make a lattice; where a line of it crosses the station the pressure is interpolated between
//! two neighbours. Where two patches meet, their lattices end half a face before the edge they share: the last centre of one
//! is joined with the first of the other, so that the gap is crossed once, by the same rule. Where nothing is joined (root,
//! tip) the lattice goes on by half a face.

use dip_grid::vector::{dot, norm, sub};
use serde::{Deserialize, Serialize};

use crate::loads::WallPatch;

/// A pressure distribution along a cut of the walls at a span station.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CpCut {
    /// Station, in the grid's unit.
    pub y: f64,
    /// Upper side: x, z, Cp, sorted by x.
    pub upper: Vec<[f64; 3]>,
    /// Lower side: x, z, Cp, sorted by x.
    pub lower: Vec<[f64; 3]>,
}

/// A face centre with its pressure.
#[derive(Clone, Copy)]
struct Point {
    at: [f64; 3],
    cp: f64,
    up: bool,
}

impl Point {
    fn of(wall: &WallPatch, face: usize) -> Self {
        Self {
            at: wall.centre[face],
            cp: wall.cp[face],
            // A body's upper side has its area vector (into the body) pointing down.
            up: wall.area[face][2] < 0.0,
        }
    }

    /// On the line to `other`, `t` of the way.
    fn towards(&self, other: &Self, t: f64) -> Self {
        let mix = |a: f64, b: f64| a + t * (b - a);
        Self {
            at: [0, 1, 2].map(|d| mix(self.at[d], other.at[d])),
            cp: mix(self.cp, other.cp),
            up: self.up,
        }
    }
}

/// The end of a line of the lattice.
struct End {
    patch: usize,
    last: Point,
    /// The edge of the patch, half a face on.
    edge: Point,
    /// From the last centre but one to the last.
    outward: [f64; 3],
}

/// Cuts the walls at `y`. On a grid one cell across (`planar`) every face is taken.
#[must_use]
pub fn cut(walls: &[WallPatch], y: f64, planar: bool) -> CpCut {
    let mut points = Vec::new();
    if planar {
        for wall in walls {
            points.extend((0..wall.centre.len()).map(|f| Point::of(wall, f)));
        }
    } else {
        let mut ends = Vec::new();
        for (n, wall) in walls.iter().enumerate() {
            lattice(n, wall, y, &mut points, &mut ends);
        }
        join(&ends, y, &mut points);
    }
    let side = |up: bool| {
        let mut side: Vec<[f64; 3]> = points
            .iter()
            .filter(|p| p.up == up)
            .map(|p| [p.at[0], p.at[2], p.cp])
            .collect();
        side.sort_by(|a, b| a[0].total_cmp(&b[0]));
        side
    };
    CpCut {
        y,
        upper: side(true),
        lower: side(false),
    }
}

/// The point at the station between two others, if it lies there. The higher one does not count, so that a station through a
/// centre meets one of the two segments that end there.
fn crossing(a: &Point, b: &Point, y: f64) -> Option<Point> {
    let (ya, yb) = (a.at[1], b.at[1]);
    (ya.min(yb) <= y && y < ya.max(yb)).then(|| a.towards(b, (y - ya) / (yb - ya)))
}

/// Crossings of one patch's lattice, and the ends of its lines.
fn lattice(patch: usize, wall: &WallPatch, y: f64, points: &mut Vec<Point>, ends: &mut Vec<End>) {
    let [np, nq] = wall.size;
    for (lines, count, across, along) in [(nq, np, np, 1), (np, nq, 1, np)] {
        if count < 2 {
            continue;
        }
        for line in 0..lines {
            let at = |n: usize| Point::of(wall, line * across + n * along);
            for n in 0..count - 1 {
                points.extend(crossing(&at(n), &at(n + 1), y));
            }
            for (last, inner) in [(0, 1), (count - 1, count - 2)] {
                let (last, inner) = (at(last), at(inner));
                ends.push(End {
                    patch,
                    last,
                    edge: inner.towards(&last, 1.5),
                    outward: sub(last.at, inner.at),
                });
            }
        }
    }
}

/// Crossings between the lattices' ends: to the end of another patch whose edge is at the same place, or to the own edge.
fn join(ends: &[End], y: f64, points: &mut Vec<Point>) {
    for (n, end) in ends.iter().enumerate() {
        let gap = |other: &End| norm(sub(other.edge.at, end.edge.at));
        let near = ends
            .iter()
            .enumerate()
            .filter(|(_, e)| e.patch != end.patch && e.last.up == end.last.up)
            // The other lattice comes from the other side; one beside it goes the same way.
            .filter(|(_, e)| dot(e.outward, end.outward) < 0.0)
            .filter(|(_, e)| gap(e) < 0.5 * norm(e.outward).min(norm(end.outward)))
            .min_by(|(_, a), (_, b)| gap(a).total_cmp(&gap(b)));
        match near {
            // The same gap is seen from both sides.
            Some((m, other)) if n < m => points.extend(crossing(&end.last, &other.last, y)),
            Some(_) => {}
            None => {
                // A station at the very edge belongs to the patch.
                const SLACK: f64 = 1e-9;
                points.extend(crossing(&end.last, &end.last.towards(&end.edge, 1.0 + SLACK), y));
            }
        }
    }
}
