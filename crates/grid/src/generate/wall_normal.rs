//! Turns the lines of a wing's grid into the wall's normal, near the wall.
//!
//! Planes y = const, and surfaces that leave the wall along them, meet a swept wing at the angle of its sweep at the nose, however
//! they are smoothed inside themselves: the normal there points outboard. So each line is turned about its foot towards the
//! normal, in full at the wall and by the share `exp(-(d / h)^2)` at the distance d from it, which stays. With h a third of the
//! step along the wall no node moves further than a seventh of that step, and no line comes near the next one. In the
//! closure of the tip, where the normal turns by a right angle within a few steps, lines stay as they are.

use std::ops::Range;

use rayon::prelude::*;

use crate::block::Block;
use crate::geometry::Wing;
use crate::vector::{add, cross, distance, dot, mix, scale, sub, unit};

/// Lines of the block that start at the wall j = 0, nodes `i` by `k`: those on the edges of the wall stay, but for k = 0, the
/// symmetry plane y = const, whose lines are turned inside it.
pub(super) struct Wall {
    i: Range<usize>,
    k: Range<usize>,
    /// y where the closure of the tip begins, and its length: the turning fades over three such lengths inboard of it.
    closure: [f64; 2],
}

impl Wall {
    /// That of a wing.
    pub(super) fn of(wing: &Wing, i: Range<usize>, k: Range<usize>) -> Self {
        let closure = [wing.tip_y() - wing.tip_length, wing.tip_length];
        Self { i, k, closure }
    }

    /// Turns the lines.
    pub(super) fn straighten(&self, block: &mut Block) {
        let lines: Vec<[usize; 2]> = self
            .k
            .clone()
            .flat_map(|k| self.i.clone().map(move |i| [i, k]))
            .collect();
        let from = &*block;
        let moved: Vec<Vec<[f64; 3]>> = lines.par_iter().map(|&[i, k]| self.line(from, i, k)).collect();
        for ([i, k], line) in lines.into_iter().zip(moved) {
            for (j, p) in line.into_iter().enumerate() {
                block.set_point([i, j, k], p);
            }
        }
    }

    /// The line at (i, k), turned.
    fn line(&self, block: &Block, i: usize, k: usize) -> Vec<[f64; 3]> {
        let at = |j: usize| block.point(i, j, k);
        let foot = at(0);
        let (before, behind) = (block.point(i - 1, 0, k), block.point(i + 1, 0, k));
        let (inner, outer) = (block.point(i, 0, k.max(1) - 1), block.point(i, 0, k + 1));
        let across = if k == 0 {
            sub(outer, foot)
        } else {
            tangent(inner, foot, outer)
        };
        let mut normal = unit(cross(tangent(before, foot, behind), across));
        if k == 0 {
            normal = unit([normal[0], 0.0, normal[2]]);
        }
        if dot(normal, sub(at(1), foot)) < 0.0 {
            normal = scale(-1.0, normal);
        }
        let reach = [before, behind, inner, outer]
            .into_iter()
            .map(|p| distance(p, foot))
            .filter(|&d| d > 0.0)
            .fold(f64::INFINITY, f64::min)
            / 3.0;
        let [from, length] = self.closure;
        let most = ((from - foot[1]) / (3.0 * length)).clamp(0.0, 1.0);
        (0..=block.nj)
            .map(|j| {
                let p = at(j);
                let d = distance(p, foot);
                let share = most * (-(d / reach).powi(2)).exp();
                // Far out nothing is to move, not even by round-off; else the distance from the wall stays.
                if share < 1e-9 {
                    return p;
                }
                add(foot, scale(d, unit(mix(unit(sub(p, foot)), normal, share))))
            })
            .collect()
    }
}

/// The tangent at `b` of the parabola through three points.
fn tangent(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> [f64; 3] {
    let (before, behind) = (distance(a, b), distance(b, c));
    add(scale(behind / before, sub(b, a)), scale(before / behind, sub(c, b)))
}
