//! One C-shaped plane of nodes round a unit section: a whole 2-D grid, or a span station of a C-H grid.

use super::chord::{Mixture, mixed};
use super::line::spread;

/// What makes a plane. Lengths are in local chords; x = 0 is the leading edge.
pub(super) struct PlaneC<'a> {
    /// Maps of the section with weights.
    pub(super) mixture: Mixture<'a>,
    /// Share of the camber line's curvature that the plate has; the rest is that of the straight line between its ends.
    pub(super) curved: f64,
    /// Wall nodes, upper trailing edge to lower.
    pub(super) wall: Vec<[f64; 2]>,
    /// x of the wake's nodes from the trailing edge to the exit.
    pub(super) wake: Vec<f64>,
    /// Share of the section's thickness (against its camber line) at a height above the wall.
    pub(super) share: &'a (dyn Fn(f64) -> f64 + Sync),
    /// Far field distance upstream, and up and down.
    pub(super) far: f64,
    /// Cells from wall to far field.
    pub(super) normal: usize,
    /// First step from the wall.
    pub(super) first: f64,
    /// Growth of the first step along the wake: its factor is `1 + wake_growth * (x - 1)`.
    pub(super) wake_growth: f64,
    /// Keep every node (1), every second (2), ...
    pub(super) stride: usize,
}

/// What a map is of.
#[derive(Clone, Copy)]
enum Line {
    Full,
    Plate,
    Flat,
}

/// Nodes of a plane.
pub(super) struct Plane {
    /// Positions `[j][i]`.
    pub(super) nodes: Vec<[f64; 2]>,
    /// Largest growth ratio of any line.
    pub(super) growth: f64,
}

impl PlaneC<'_> {
    /// Makes the nodes: i from the exit above the wake round the nose to the exit below, j from wall to far field.
    pub(super) fn make(&self) -> Plane {
        let tail = self.wake.len() - 1;
        let last = self.wall.len() - 1 + 2 * tail;
        // In each map: a of node i, on the section, its camber line, or the straight line that stands for that.
        let parameters = |line: Line| -> Vec<Vec<f64>> {
            self.mixture
                .iter()
                .map(|(maps, _)| {
                    let (map, wall) = match (line, &maps.flat) {
                        (Line::Full, _) => (&maps.full, &maps.full_a),
                        (Line::Flat, Some((map, a))) => (map, a),
                        _ => (&maps.plate, &maps.plate_a),
                    };
                    let wake: Vec<f64> = self.wake.iter().skip(1).map(|&x| map.wake_parameter(x)[0]).collect();
                    let below: Vec<f64> = self.wake.iter().skip(1).map(|&x| map.wake_parameter(x)[1]).collect();
                    wake.into_iter()
                        .rev()
                        .chain(wall.iter().copied())
                        .chain(below)
                        .collect()
                })
                .collect()
        };
        let (full_a, plate_a) = (parameters(Line::Full), parameters(Line::Plate));
        let flat_a = if self.curved < 1.0 {
            parameters(Line::Flat)
        } else {
            Vec::new()
        };
        let even = |all: &[Vec<f64>]| -> Vec<Vec<f64>> { all.iter().map(|a| evened(a)).collect() };
        let (full_far, plate_far, flat_far) = (even(&full_a), even(&plate_a), even(&flat_a));
        let wall = |i: usize| -> [f64; 2] {
            if i < tail || i > last - tail {
                let m = if i < tail { tail - i } else { i - (last - tail) };
                mixed(&self.mixture, |maps| maps.plate.wake_point(self.wake[m]))
            } else {
                self.wall[i - tail]
            }
        };
        let exit = self.wake[tail];
        // Lines must not move sideways faster than they rise.
        let shift = plate_a[0]
            .iter()
            .zip(&plate_far[0])
            .fold(0.0f64, |m, (near, far)| m.max((near - far).abs()));
        let even = EVEN.max(1.5 * shift);
        let kept = last / self.stride;
        let rows = self.normal / self.stride;
        let mut nodes = vec![[0.0; 2]; (kept + 1) * (rows + 1)];
        let mut growth = 1.0f64;
        for i in (0..=last).step_by(self.stride) {
            // Lines lean so that the last one, a = A sqrt(1 + (b/A)^2), is x = const in the plane of the parabola.
            // Away from the wall they spread evenly, so that the fine steps at the trailing edge stay there.
            let lean = |near: &[f64], far: &[f64], b: f64| {
                let a = near[i] + (far[i] - near[i]) * b * b / (b * b + even * even);
                a * (1.0 + (b / near[0]).powi(2)).sqrt()
            };
            let mapped = |b: f64| -> [f64; 2] {
                let a0 = plate_a[0][i];
                let share = (self.share)(b * b + 2.0 * a0.abs() * b);
                let mut p = [0.0; 2];
                for (m, (maps, weight)) in self.mixture.iter().enumerate() {
                    let mut add = |q: [f64; 2], w: f64| {
                        p[0] += w * q[0];
                        p[1] += w * q[1];
                    };
                    if share > 0.0 {
                        let a = lean(&full_a[m], &full_far[m], b);
                        add(maps.full.position(a, b), weight * share);
                    }
                    if share < 1.0 {
                        let a = lean(&plate_a[m], &plate_far[m], b);
                        let weight = weight * (1.0 - share);
                        let flat = maps.flat.as_ref().zip(flat_a.get(m)).zip(flat_far.get(m));
                        if let Some((((flat, _), near), far)) = flat {
                            add(maps.plate.position(a, b), weight * self.curved);
                            let a = lean(near, far, b);
                            add(flat.position(a, b), weight * (1.0 - self.curved));
                        } else {
                            add(maps.plate.position(a, b), weight);
                        }
                    }
                }
                p
            };
            let exact = wall(i);
            let foot = mapped(0.0);
            // What the map misses of the wall (1e-5 chords) moves the line's near part along.
            let miss = [exact[0] - foot[0], exact[1] - foot[1]];
            let line = |b: f64| -> [f64; 2] {
                let p = mapped(b);
                let fade = (-4.0 * ((p[0] - foot[0]).powi(2) + (p[1] - foot[1]).powi(2)).sqrt()).exp();
                [p[0] + miss[0] * fade, p[1] + miss[1] * fade]
            };
            let end = self.end(&|b| lean(&plate_a[0], &plate_far[0], b));
            let beyond = (exact[0] - 1.0).max(0.0);
            let on_wake = i < tail || i > last - tail;
            let first = self.first * if on_wake { 1.0 + self.wake_growth * beyond } else { 1.0 };
            let (b, ratio) = spread(line, end, self.normal, first);
            growth = growth.max(ratio);
            for (j, &b) in b.iter().step_by(self.stride).enumerate() {
                nodes[i / self.stride + (kept + 1) * j] = if j == 0 { exact } else { line(b) };
            }
        }
        // The exit is the plane x = const to the last digit: what is missing fades upstream along the wake.
        for j in 1..=rows {
            for side in [0, kept] {
                let row = (kept + 1) * j;
                let miss = exit - nodes[row + side][0];
                for m in (0..=tail).step_by(self.stride) {
                    let fade = ((self.wake[m] - 1.0) / (exit - 1.0)).powi(2);
                    let i = if side == 0 { tail - m } else { last - tail + m } / self.stride;
                    nodes[row + i][0] += miss * fade;
                }
            }
        }
        Plane { nodes, growth }
    }

    /// b where the line `a(b)` meets the outer boundary: half an ellipse upstream of x = 0, straight lines behind.
    fn end(&self, a: &dyn Fn(f64) -> f64) -> f64 {
        let outside = |b: f64| {
            let a = a(b);
            let (x, z) = (a * a - b * b, 2.0 * a * b);
            (x.min(0.0) / self.far).powi(2) + (z / self.far).powi(2) > 1.0
        };
        let (mut lo, mut hi) = (0.0, 1.0);
        while !outside(hi) && hi < 1e6 {
            hi *= 2.0;
        }
        for _ in 0..60 {
            let mid = 0.5 * (lo + hi);
            if outside(mid) {
                hi = mid;
            } else {
                lo = mid;
            }
        }
        hi
    }
}

/// Least height (as b: the root of a distance in chords) at which lines are half way to being spread evenly.
const EVEN: f64 = 1.2;

/// The same monotone values with their steps evened out over an eighth of the line: a diffusion in the node number.
fn evened(a: &[f64]) -> Vec<f64> {
    let n = a.len();
    let reach = n as f64 / 8.0;
    // (1 - r^2 d2/di2) a' = a, twice: two implicit steps keep order and end values.
    let mut out = a.to_vec();
    for _ in 0..2 {
        let r = 0.5 * reach * reach;
        let mut upper = vec![0.0; n];
        for i in 1..n - 1 {
            let pivot = 1.0 + 2.0 * r - r * upper[i - 1];
            upper[i] = r / pivot;
            out[i] = (out[i] + r * out[i - 1]) / pivot;
        }
        for i in (1..n - 1).rev() {
            out[i] += upper[i] * out[i + 1];
        }
    }
    out
}
