//! Smooths the inside of a plane of nodes by elliptic equations, with lines that leave the wall at a right angle.
//!
//! `g22 (r_ii + P r_i) - 2 g12 r_ij + g11 (r_jj + Q r_j) = 0`, `g11 = r_i . r_i`, `g12 = r_i . r_j`, `g22 = r_j . r_j`
//! (J. F. Thompson, F. C. Thames and C. W. Mastin, J. Comp. Phys. 15 (1974)), with
//! - P from the nodes on wall and far boundary (P. D. Thomas and J. F. Middlecoff, AIAA J. 18 (1980)): `-r_i . r_ii / g11`
//!   there, linear in j between;
//! - near the wall a further part `A(i) exp(-d / h)`, d the distance from the wall and h twice the step along it. A is
//!   found while the equations are solved, from the angle that is still missing at the wall (the idea of J. L. Steger and R. L.
//!   Sorenson, J. Comp. Phys. 33 (1979), with the reach in lengths instead of numbers of cells: at y+ = 1 a reach of a few
//!   cells is a thousandth of the step along the wall and bends nothing);
//! - Q from the wanted growth of the steps along j.
//!
//! In the end the nodes are spread along every line j by its arc length anew: the first step is what it was before, whatever
//! a curved wall did to it. (Q could hold the curvature `-r_j . r_ii / g11` instead, but then nothing smooths across the lines
//! j, and the iteration goes round in circles.)

use super::spacing::{geometric, geometric_rate};

/// What a smoothing needs to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Elliptic {
    /// At most so many sweeps, each once along all lines j and once along all lines i.
    pub(super) sweeps: usize,
}

/// What a smoothing did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Smoothed {
    /// Sweeps that were needed.
    pub(super) sweeps: usize,
    /// Largest move of a node in the last one, over the step along i there.
    pub(super) change: f64,
}

/// A sweep that moves no node by more than this share of the step along i is the last.
const ENOUGH: f64 = 1e-4;

/// How fast A follows the angle that is missing.
const FOLLOW: f64 = 0.1;

/// Beyond this, P and Q would make the equations of a line lose their maximum principle (2 is the limit).
const MOST: f64 = 1.6;

/// Nodes `[j][i]`; j = 0 is wall and wake, and the edges stay.
struct Plane<'a> {
    nodes: &'a mut [[f64; 2]],
    ni: usize,
    nj: usize,
}

impl Elliptic {
    /// Smooths the inside of `nodes`, (ni + 1) x (nj + 1) of them. `first` is the first step off the wall of every line i.
    pub(super) fn smooth(self, nodes: &mut [[f64; 2]], ni: usize, nj: usize, first: &[f64]) -> Smoothed {
        let mut plane = Plane { nodes, ni, nj };
        let [near, far] = [0, nj].map(|j| plane.along(j));
        let moving: Vec<usize> = (1..ni).filter(|&i| !plane.is_corner(i)).collect();
        let mut growth = vec![0.0; ni + 1];
        let mut lean = vec![0.0; ni + 1];
        let steps = || first.iter().enumerate().take(ni).skip(1);
        let mut done = Smoothed {
            sweeps: 0,
            change: f64::INFINITY,
        };
        while done.sweeps < self.sweeps && done.change > ENOUGH {
            for (i, &step) in steps() {
                if done.sweeps.is_multiple_of(10) {
                    // Q that makes steps grow by the ratio of a geometric series: (r_jj + Q r_j) is zero for it. Lines change
                    // their lengths slowly, and finding the ratio takes as long as a sweep.
                    let ratio = geometric_rate(nj, step, plane.length(i)).exp();
                    growth[i] = -2.0 * (ratio - 1.0) / (ratio + 1.0);
                }
                lean[i] = (lean[i] - FOLLOW * plane.missing(i)).clamp(-MOST, MOST);
            }
            let control = Control {
                near: &near,
                far: &far,
                lean: &lean,
                growth: &growth,
            };
            done.change = plane.sweep(&control, &moving);
            done.sweeps += 1;
        }
        if done.sweeps == 0 {
            return done;
        }
        // Twice: the first time brings nodes where the second measures.
        for _ in 0..2 {
            for (i, &step) in steps() {
                plane.respread(i, step);
            }
        }
        done
    }
}

/// What P and Q are made of, for every i.
struct Control<'a> {
    near: &'a [f64],
    far: &'a [f64],
    lean: &'a [f64],
    growth: &'a [f64],
}

impl Plane<'_> {
    fn at(&self, i: usize, j: usize) -> [f64; 2] {
        self.nodes[i + (self.ni + 1) * j]
    }

    /// P of Thomas and Middlecoff on a line j.
    fn along(&self, j: usize) -> Vec<f64> {
        let inner = (1..self.ni).map(|i| {
            let [before, behind] = self.steps(i, j);
            (2.0 * (before - behind) / (before + behind)).clamp(-MOST, MOST)
        });
        std::iter::once(0.0).chain(inner).chain([0.0]).collect()
    }

    /// Lengths of the edges before and behind node i on a line j.
    fn steps(&self, i: usize, j: usize) -> [f64; 2] {
        [i - 1, i + 1].map(|n| distance(self.at(n, j), self.at(i, j)))
    }

    /// True where the wall turns by more than 60 degrees at node i, as at the nose of a sheet or a sharp trailing edge: lines
    /// from there stay, for the nodes beside them lie behind the corner, and a mean of them may, too.
    fn is_corner(&self, i: usize) -> bool {
        let (a, b) = (
            sub(self.at(i, 0), self.at(i - 1, 0)),
            sub(self.at(i + 1, 0), self.at(i, 0)),
        );
        dot(a, b) < 0.5 * a[0].hypot(a[1]) * b[0].hypot(b[1])
    }

    fn length(&self, i: usize) -> f64 {
        (0..self.nj).map(|j| distance(self.at(i, j), self.at(i, j + 1))).sum()
    }

    /// Sine of the angle by which line i leans towards larger i, over the first twentieth of a step.
    fn missing(&self, i: usize) -> f64 {
        let foot = self.at(i, 0);
        let (a, c) = (self.at(i - 1, 0), self.at(i + 1, 0));
        let [before, behind] = self.steps(i, 0);
        // That of the parabola through three nodes; at a corner between equal steps, of the line that halves the angle.
        let tangent: [f64; 2] =
            std::array::from_fn(|d| (foot[d] - a[d]) * behind / before + (c[d] - foot[d]) * before / behind);
        let step = 0.5 * (before + behind);
        let j = (1..self.nj)
            .find(|&j| distance(foot, self.at(i, j)) >= 0.05 * step)
            .unwrap_or(1);
        let line = sub(self.at(i, j), foot);
        dot(line, tangent) / (line[0].hypot(line[1]) * tangent[0].hypot(tangent[1])).max(f64::MIN_POSITIVE)
    }

    /// Solves along all lines j, then along all lines i; the largest move over the step along i.
    fn sweep(&mut self, control: &Control, moving: &[usize]) -> f64 {
        let mut change = 0.0f64;
        let most = self.ni.max(self.nj);
        let mut line = Line::new(most + 1);
        for &i in moving {
            for j in 1..self.nj {
                let e = self.equation(control, i, j);
                line.set(j, e.along_j());
            }
            line.solve(1..self.nj, self.at(i, 0), self.at(i, self.nj));
            for j in 1..self.nj {
                change = change.max(self.put(i, j, line.out[j]));
            }
        }
        for j in 1..self.nj {
            for i in 1..self.ni {
                line.set(i, [[0.0; 2], self.at(i, j)]);
            }
            for &i in moving {
                line.set(i, self.equation(control, i, j).along_i());
            }
            line.solve(1..self.ni, self.at(0, j), self.at(self.ni, j));
            for i in 1..self.ni {
                change = change.max(self.put(i, j, line.out[i]));
            }
        }
        change
    }

    fn put(&mut self, i: usize, j: usize, p: [f64; 2]) -> f64 {
        let step = 0.5 * distance(self.at(i - 1, j), self.at(i + 1, j));
        let moved = distance(p, self.at(i, j)) / step.max(f64::MIN_POSITIVE);
        self.nodes[i + (self.ni + 1) * j] = p;
        moved
    }

    fn equation(&self, control: &Control, i: usize, j: usize) -> Equation {
        let (a, c) = (i - 1, i + 1);
        let half = |p: [f64; 2], q: [f64; 2]| [0.5 * (q[0] - p[0]), 0.5 * (q[1] - p[1])];
        let di = half(self.at(a, j), self.at(c, j));
        let dj = half(self.at(i, j - 1), self.at(i, j + 1));
        let above = half(self.at(a, j + 1), self.at(c, j + 1));
        let cross = half(half(self.at(a, j - 1), self.at(c, j - 1)), above);
        let (g11, g12, g22) = (dot(di, di), dot(di, dj), dot(dj, dj));
        let foot = self.at(i, 0);
        let [before, behind] = self.steps(i, 0);
        let step = 0.5 * (before + behind);
        let share = j as f64 / self.nj as f64;
        let near = (-distance(foot, self.at(i, j)) / (2.0 * step)).exp();
        let p = (1.0 - share) * control.near[i] + share * control.far[i] + control.lean[i] * near;
        let q = control.growth[i];
        Equation {
            g: [g11, g12, g22],
            cross,
            p: p.clamp(-MOST, MOST),
            q: q.clamp(-MOST, MOST),
            beside_i: [self.at(a, j), self.at(c, j)],
            beside_j: [self.at(i, j - 1), self.at(i, j + 1)],
        }
    }

    /// Spreads the nodes of line i anew: first step `first`, one growth ratio.
    fn respread(&mut self, i: usize, first: f64) {
        let old: Vec<[f64; 2]> = (0..=self.nj).map(|j| self.at(i, j)).collect();
        let mut arc = vec![0.0; self.nj + 1];
        for j in 1..=self.nj {
            arc[j] = arc[j - 1] + distance(old[j - 1], old[j]);
        }
        let wanted = geometric(self.nj, first, arc[self.nj]);
        let width = self.ni + 1;
        for (j, &wanted) in wanted.iter().enumerate().take(self.nj).skip(1) {
            let m = arc.partition_point(|&s| s <= wanted).clamp(1, self.nj) - 1;
            self.nodes[i + width * j] = cubic(&old, &arc, m, wanted);
        }
    }
}

/// The discrete equation at one node.
struct Equation {
    g: [f64; 3],
    cross: [f64; 2],
    p: f64,
    q: f64,
    beside_i: [[f64; 2]; 2],
    beside_j: [[f64; 2]; 2],
}

impl Equation {
    /// Below, above (both over the diagonal) and right-hand side for unknowns along j.
    fn along_j(&self) -> [[f64; 2]; 2] {
        let [g11, g12, g22] = self.g;
        let centre = 2.0 * (g11 + g22);
        let rest = |d: usize| {
            let [a, c] = self.beside_i.map(|p| p[d]);
            (g22 * ((1.0 - 0.5 * self.p) * a + (1.0 + 0.5 * self.p) * c) - 2.0 * g12 * self.cross[d]) / centre
        };
        let weight = g11 / centre;
        [
            [weight * (1.0 - 0.5 * self.q), weight * (1.0 + 0.5 * self.q)],
            [rest(0), rest(1)],
        ]
    }

    /// The same for unknowns along i.
    fn along_i(&self) -> [[f64; 2]; 2] {
        let [g11, g12, g22] = self.g;
        let centre = 2.0 * (g11 + g22);
        let rest = |d: usize| {
            let [a, c] = self.beside_j.map(|p| p[d]);
            (g11 * ((1.0 - 0.5 * self.q) * a + (1.0 + 0.5 * self.q) * c) - 2.0 * g12 * self.cross[d]) / centre
        };
        let weight = g22 / centre;
        [
            [weight * (1.0 - 0.5 * self.p), weight * (1.0 + 0.5 * self.p)],
            [rest(0), rest(1)],
        ]
    }
}

/// A tridiagonal system for two coordinates: `x_m - below x_(m-1) - above x_(m+1) = rest`.
struct Line {
    below: Vec<f64>,
    above: Vec<f64>,
    rest: Vec<[f64; 2]>,
    out: Vec<[f64; 2]>,
}

impl Line {
    fn new(n: usize) -> Self {
        Self {
            below: vec![0.0; n],
            above: vec![0.0; n],
            rest: vec![[0.0; 2]; n],
            out: vec![[0.0; 2]; n],
        }
    }

    fn set(&mut self, m: usize, [weights, rest]: [[f64; 2]; 2]) {
        [self.below[m], self.above[m]] = weights;
        self.rest[m] = rest;
    }

    /// Solves for `range` with known values before and behind it (Thomas' algorithm; |below| + |above| < 1).
    fn solve(&mut self, range: std::ops::Range<usize>, before: [f64; 2], behind: [f64; 2]) {
        let last = range.end - 1;
        // What is known before the first unknown and behind the last one goes to the right.
        for d in 0..2 {
            self.rest[range.start][d] += self.below[range.start] * before[d];
            self.rest[last][d] += self.above[last] * behind[d];
        }
        for m in range.clone().skip(1) {
            let below = self.below[m];
            let pivot = 1.0 - below * self.above[m - 1];
            let previous = self.rest[m - 1];
            for (value, previous) in self.rest[m].iter_mut().zip(previous) {
                *value = (*value + below * previous) / pivot;
            }
            self.above[m] /= pivot;
        }
        self.out[last] = self.rest[last];
        for m in range.rev().skip(1) {
            for d in 0..2 {
                self.out[m][d] = self.rest[m][d] + self.above[m] * self.out[m + 1][d];
            }
        }
    }
}

/// The curve through `points` at arc length `s`, which lies in interval m: a cubic with slopes of the parabola through three
/// points, in arc length.
fn cubic(points: &[[f64; 2]], arc: &[f64], m: usize, s: f64) -> [f64; 2] {
    let last = points.len() - 1;
    let slope = |n: usize| -> [f64; 2] {
        let chord = |a: usize| {
            let h = (arc[a + 1] - arc[a]).max(f64::MIN_POSITIVE);
            [
                (points[a + 1][0] - points[a][0]) / h,
                (points[a + 1][1] - points[a][1]) / h,
            ]
        };
        if n == 0 {
            return chord(0);
        }
        if n == last {
            return chord(last - 1);
        }
        let (h0, h1) = (arc[n] - arc[n - 1], arc[n + 1] - arc[n]);
        let (c0, c1) = (chord(n - 1), chord(n));
        let w = h1 / (h0 + h1);
        [w * c0[0] + (1.0 - w) * c1[0], w * c0[1] + (1.0 - w) * c1[1]]
    };
    let h = (arc[m + 1] - arc[m]).max(f64::MIN_POSITIVE);
    let u = (s - arc[m]) / h;
    let (u2, u3) = (u * u, u * u * u);
    let (sa, sb) = (slope(m), slope(m + 1));
    let value = |d: usize| {
        (2.0 * u3 - 3.0 * u2 + 1.0) * points[m][d]
            + (u3 - 2.0 * u2 + u) * h * sa[d]
            + (3.0 * u2 - 2.0 * u3) * points[m + 1][d]
            + (u3 - u2) * h * sb[d]
    };
    [value(0), value(1)]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn sub(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::transfinite::transfinite;

    /// Half a ring: circles and rays, with steps that grow from 1e-4 by one ratio.
    fn ring(ni: usize, nj: usize) -> Vec<[f64; 2]> {
        let out = geometric(nj, 1e-4, 9.0);
        let at = |i: usize, j: usize| {
            let angle = std::f64::consts::PI * i as f64 / ni as f64;
            [(1.0 + out[j]) * angle.cos(), (1.0 + out[j]) * angle.sin()]
        };
        (0..=nj)
            .flat_map(|j| (0..=ni).map(move |i| at(i, j)))
            .collect::<Vec<_>>()
    }

    /// Circles and rays solve the equations, and the smoothing finds them from rays bent by 17 degrees and more.
    #[test]
    fn bent_rays_of_a_ring_become_straight() {
        let (ni, nj) = (32, 40);
        let exact = ring(ni, nj);
        for bend in [0.0, 0.3] {
            let mut nodes = exact.clone();
            for j in 1..nj {
                for i in 1..ni {
                    let p = exact[i + (ni + 1) * j];
                    let radius = p[0].hypot(p[1]);
                    let angle = p[1].atan2(p[0]);
                    let turned = angle + bend * (2.0 * angle).sin() * (radius - 1.0) * (10.0 - radius) / 20.25;
                    nodes[i + (ni + 1) * j] = [radius * turned.cos(), radius * turned.sin()];
                }
            }
            let first = vec![1e-4; ni + 1];
            let done = Elliptic { sweeps: 4000 }.smooth(&mut nodes, ni, nj, &first);
            assert!(done.change <= ENOUGH, "{done:?}");
            for (p, q) in nodes.iter().zip(&exact) {
                assert!(distance(*p, *q) < 2e-3 * q[0].hypot(q[1]), "{bend} {p:?} {q:?}");
            }
        }
    }

    /// Round a 4 % ellipse with a first step of 1e-6 of its chord: transfinite lines that lean by 40 degrees and more end up
    /// within two degrees of the normal; first steps stay, no cell is folded.
    #[test]
    fn lines_off_a_thin_ellipse_become_normal_to_it() {
        let (ni, nj) = (96, 64);
        let width = ni + 1;
        let mut nodes = vec![[0.0; 2]; width * (nj + 1)];
        for i in 0..=ni {
            let angle = std::f64::consts::PI * i as f64 / ni as f64;
            let leaning = angle + 0.4 * (2.0 * angle).sin();
            nodes[i] = [0.5 * angle.cos(), 0.02 * angle.sin()];
            nodes[i + width * nj] = [10.0 * leaning.cos(), 10.0 * leaning.sin()];
        }
        for i in [0, ni] {
            let (from, to) = (nodes[i], nodes[i + width * nj]);
            let length = distance(from, to);
            for (j, d) in geometric(nj, 1e-6, length).into_iter().enumerate().skip(1) {
                let share = d / length;
                nodes[i + width * j] = [from[0] + share * (to[0] - from[0]), 0.0];
            }
        }
        transfinite(&mut nodes, ni, nj);
        let worst = |nodes: &[[f64; 2]]| {
            (2..ni - 1)
                .map(|i| {
                    let angle = std::f64::consts::PI * i as f64 / ni as f64;
                    let normal = [0.02 * angle.cos(), 0.5 * angle.sin()];
                    let line = sub(nodes[i + width], nodes[i]);
                    let cos = dot(line, normal) / (line[0].hypot(line[1]) * normal[0].hypot(normal[1]));
                    cos.min(1.0).acos().to_degrees()
                })
                .fold(0.0, f64::max)
        };
        assert!(worst(&nodes) > 40.0, "{}", worst(&nodes));
        let first = vec![1e-6; ni + 1];
        Elliptic { sweeps: 1000 }.smooth(&mut nodes, ni, nj, &first);
        assert!(worst(&nodes) < 2.0, "{}", worst(&nodes));
        for i in 0..ni {
            assert!((distance(nodes[i], nodes[i + width]) / 1e-6 - 1.0).abs() < 1e-3);
            for j in 0..nj {
                let at = |di: usize, dj: usize| nodes[i + di + width * (j + dj)];
                let (u, v) = (sub(at(1, 1), at(0, 0)), sub(at(0, 1), at(1, 0)));
                // i runs against the clock, j outward.
                assert!(u[0] * v[1] - u[1] * v[0] < 0.0, "{i} {j}");
            }
        }
    }
}
