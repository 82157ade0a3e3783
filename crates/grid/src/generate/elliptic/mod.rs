//! Smooths the inside of a plane or of a curved surface of nodes by elliptic equations, with lines that leave the wall at a
//! right angle.
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
//!
//! Nodes have two coordinates in a plane and three on a surface. There the equations hold for their tangential part (Z. U. A.
//! Warsi, J. Comp. Phys. 64 (1986)): no node moves across the surface by itself.

mod respread;
mod tridiagonal;

use self::respread::respread;
use self::tridiagonal::Line;
use super::spacing::geometric_rate;

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
struct Plane<'a, const D: usize> {
    nodes: &'a mut [[f64; D]],
    ni: usize,
    nj: usize,
}

impl Elliptic {
    /// Smooths the inside of `nodes`, (ni + 1) x (nj + 1) of them. `first` is the first step off the wall of every line i.
    pub(super) fn smooth<const D: usize>(
        self,
        nodes: &mut [[f64; D]],
        ni: usize,
        nj: usize,
        first: &[f64],
    ) -> Smoothed {
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

impl<const D: usize> Plane<'_, D> {
    fn at(&self, i: usize, j: usize) -> [f64; D] {
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
        dot(a, b) < 0.5 * norm(a) * norm(b)
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
        let tangent: [f64; D] =
            std::array::from_fn(|d| (foot[d] - a[d]) * behind / before + (c[d] - foot[d]) * before / behind);
        let step = 0.5 * (before + behind);
        let j = (1..self.nj)
            .find(|&j| distance(foot, self.at(i, j)) >= 0.05 * step)
            .unwrap_or(1);
        let line = sub(self.at(i, j), foot);
        dot(line, tangent) / (norm(line) * norm(tangent)).max(f64::MIN_POSITIVE)
    }

    /// Solves along all lines j, then along all lines i; the largest move over the step along i.
    fn sweep(&mut self, control: &Control, moving: &[usize]) -> f64 {
        let mut change = 0.0f64;
        let most = self.ni.max(self.nj);
        let mut line = Line::new(most + 1);
        for &i in moving {
            for j in 1..self.nj {
                let (weights, rest) = self.equation(control, i, j).along_j();
                line.set(j, weights, rest);
            }
            line.solve(1..self.nj, self.at(i, 0), self.at(i, self.nj));
            for j in 1..self.nj {
                change = change.max(self.put(i, j, line.out[j]));
            }
        }
        for j in 1..self.nj {
            for i in 1..self.ni {
                line.set(i, [0.0; 2], self.at(i, j));
            }
            for &i in moving {
                let (weights, rest) = self.equation(control, i, j).along_i();
                line.set(i, weights, rest);
            }
            line.solve(1..self.ni, self.at(0, j), self.at(self.ni, j));
            for i in 1..self.ni {
                change = change.max(self.put(i, j, line.out[i]));
            }
        }
        change
    }

    fn put(&mut self, i: usize, j: usize, p: [f64; D]) -> f64 {
        let step = 0.5 * distance(self.at(i - 1, j), self.at(i + 1, j));
        let moved = distance(p, self.at(i, j)) / step.max(f64::MIN_POSITIVE);
        self.nodes[i + (self.ni + 1) * j] = p;
        moved
    }

    fn equation(&self, control: &Control, i: usize, j: usize) -> Equation<D> {
        let (a, c) = (i - 1, i + 1);
        let half = |p: [f64; D], q: [f64; D]| -> [f64; D] { std::array::from_fn(|d| 0.5 * (q[d] - p[d])) };
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
        let mut equation = Equation {
            g: [g11, g12, g22],
            cross,
            p: p.clamp(-MOST, MOST),
            q: q.clamp(-MOST, MOST),
            beside_i: [self.at(a, j), self.at(c, j)],
            beside_j: [self.at(i, j - 1), self.at(i, j + 1)],
            kept: [0.0; D],
        };
        if D > 2 {
            // On a curved surface the equations hold for what lies in it; what is left across is the surface's own curvature.
            equation.kept = across(equation.left(self.at(i, j)), di, dj);
        }
        equation
    }

    /// Spreads the nodes of line i anew: first step `first`, one growth ratio.
    fn respread(&mut self, i: usize, first: f64) {
        let old: Vec<[f64; D]> = (0..=self.nj).map(|j| self.at(i, j)).collect();
        let width = self.ni + 1;
        for (j, p) in respread(&old, first).into_iter().enumerate() {
            self.nodes[i + width * j] = p;
        }
    }
}

/// The discrete equation at one node.
struct Equation<const D: usize> {
    g: [f64; 3],
    cross: [f64; D],
    p: f64,
    q: f64,
    beside_i: [[f64; D]; 2],
    beside_j: [[f64; D]; 2],
    /// What the node keeps across the surface, over the diagonal.
    kept: [f64; D],
}

impl<const D: usize> Equation<D> {
    /// Weights of the neighbours along i and along j, over the diagonal.
    fn weights(&self) -> [[f64; 2]; 2] {
        let [g11, _, g22] = self.g;
        let centre = 2.0 * (g11 + g22);
        let of = |g: f64, control: f64| [-0.5, 0.5].map(|side| g / centre * (1.0 + side * control));
        [of(g22, self.p), of(g11, self.q)]
    }

    /// What the mixed derivative adds, over the diagonal, less what the node keeps.
    fn mixed(&self, d: usize) -> f64 {
        let [g11, g12, g22] = self.g;
        -2.0 * g12 * self.cross[d] / (2.0 * (g11 + g22)) - self.kept[d]
    }

    /// By how much the node at `p` misses the equation, over the diagonal.
    fn left(&self, p: [f64; D]) -> [f64; D] {
        let [along_i, along_j] = self.weights();
        std::array::from_fn(|d| {
            let [a, c] = self.beside_i.map(|q| q[d]);
            let [below, above] = self.beside_j.map(|q| q[d]);
            along_i[0] * a + along_i[1] * c + along_j[0] * below + along_j[1] * above + self.mixed(d) - p[d]
        })
    }

    /// Weights below and above, and right-hand side, for unknowns along j.
    fn along_j(&self) -> ([f64; 2], [f64; D]) {
        let [along_i, along_j] = self.weights();
        let rest = |d: usize| {
            let [a, c] = self.beside_i.map(|p| p[d]);
            along_i[0] * a + along_i[1] * c + self.mixed(d)
        };
        (along_j, std::array::from_fn(rest))
    }

    /// The same for unknowns along i.
    fn along_i(&self) -> ([f64; 2], [f64; D]) {
        let [along_i, along_j] = self.weights();
        let rest = |d: usize| {
            let [a, c] = self.beside_j.map(|p| p[d]);
            along_j[0] * a + along_j[1] * c + self.mixed(d)
        };
        (along_i, std::array::from_fn(rest))
    }
}

fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|d| a[d] * b[d]).sum()
}

fn norm<const D: usize>(a: [f64; D]) -> f64 {
    dot(a, a).sqrt()
}

fn sub<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|d| a[d] - b[d])
}

fn distance<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    norm(sub(a, b))
}

/// The part of `v` across both `a` and `b`.
fn across<const D: usize>(v: [f64; D], a: [f64; D], b: [f64; D]) -> [f64; D] {
    let without = |v: [f64; D], a: [f64; D]| {
        let share = dot(v, a) / dot(a, a).max(f64::MIN_POSITIVE);
        std::array::from_fn(|d| v[d] - share * a[d])
    };
    // Gram and Schmidt, once again for what round-off left.
    let b = without(b, a);
    without(without(without(without(v, a), b), a), b)
}

#[cfg(test)]
mod tests;
