//! Distance from points to the wall: to the surface itself, not to its nodes or face centres.

use rayon::prelude::*;

use crate::topology::{Condition, MultiBlock};
use crate::vector::{add, cross, distance, dot, norm, scale, sub};

/// Triangles of the walls of all blocks in a tree of boxes.
#[derive(Clone, Debug)]
pub struct WallTree {
    triangles: Vec<[[f64; 3]; 3]>,
    nodes: Vec<Node>,
}

#[derive(Clone, Debug)]
struct Node {
    lo: [f64; 3],
    hi: [f64; 3],
    /// A leaf's triangles `first..first + count`; an inner node (count 0) has its children at `first` and `first + 1`.
    first: usize,
    count: usize,
}

/// Triangles in a leaf.
const LEAF: usize = 4;

impl WallTree {
    /// The walls of `grid` whose condition `is_wall` accepts (e.g. [`Condition::is_wall`]). `None` without any.
    ///
    /// A wall face is two triangles along its shorter diagonal.
    #[must_use]
    pub fn new(grid: &MultiBlock, is_wall: impl Fn(Condition) -> bool) -> Option<Self> {
        let mut triangles = Vec::new();
        for patch in grid.topology.patches.iter().filter(|p| is_wall(p.condition)) {
            let Some(block) = grid.blocks.get(patch.block) else {
                continue;
            };
            let [np, nq] = block.face_cells(patch.face);
            for q in patch.window.lo[1]..patch.window.hi[1].min(nq) {
                for p in patch.window.lo[0]..patch.window.hi[0].min(np) {
                    let node = |dp, dq| block.point_at(block.node_behind(patch.face, p + dp, q + dq, 0));
                    let (a, b, c, d) = (node(0, 0), node(1, 0), node(1, 1), node(0, 1));
                    if distance(a, c) <= distance(b, d) {
                        triangles.extend([[a, b, c], [a, c, d]]);
                    } else {
                        triangles.extend([[a, b, d], [b, c, d]]);
                    }
                }
            }
        }
        if triangles.is_empty() {
            return None;
        }
        let mut tree = Self {
            nodes: vec![Node {
                lo: [0.0; 3],
                hi: [0.0; 3],
                first: 0,
                count: 0,
            }],
            triangles,
        };
        let count = tree.triangles.len();
        tree.build(0, 0, count);
        Some(tree)
    }

    fn build(&mut self, node: usize, first: usize, count: usize) {
        let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for corner in self.triangles[first..first + count].iter().flatten() {
            for d in 0..3 {
                lo[d] = lo[d].min(corner[d]);
                hi[d] = hi[d].max(corner[d]);
            }
        }
        self.nodes[node] = Node { lo, hi, first, count };
        if count <= LEAF {
            return;
        }
        let axis = (0..3)
            .max_by(|&a, &b| (hi[a] - lo[a]).total_cmp(&(hi[b] - lo[b])))
            .unwrap_or(0);
        let middle = |t: &[[f64; 3]; 3]| t[0][axis] + t[1][axis] + t[2][axis];
        let half = count / 2;
        self.triangles[first..first + count].select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)));
        let children = self.nodes.len();
        self.nodes[node].first = children;
        self.nodes[node].count = 0;
        for _ in 0..2 {
            self.nodes.push(Node {
                lo,
                hi,
                first: 0,
                count: 0,
            });
        }
        self.build(children, first, half);
        self.build(children + 1, first + half, count - half);
    }

    /// Distance from `p` to the nearest wall.
    #[must_use]
    pub fn distance(&self, p: [f64; 3]) -> f64 {
        self.distance_below(p, f64::INFINITY)
    }

    /// Distance from `p` to the nearest wall if that is below `bound`, else `bound`.
    #[must_use]
    pub fn distance_below(&self, p: [f64; 3], bound: f64) -> f64 {
        let mut best = bound * bound;
        let mut stack = [(0usize, 0.0f64); 96];
        let mut depth = 1;
        stack[0] = (0, self.nodes[0].box_distance2(p));
        while depth > 0 {
            depth -= 1;
            let (n, near) = stack[depth];
            if near >= best {
                continue;
            }
            let node = &self.nodes[n];
            if node.count > 0 {
                for t in &self.triangles[node.first..node.first + node.count] {
                    let d = sub(p, nearest_on_triangle(p, t));
                    best = best.min(dot(d, d));
                }
                continue;
            }
            let (a, b) = (node.first, node.first + 1);
            let (da, db) = (self.nodes[a].box_distance2(p), self.nodes[b].box_distance2(p));
            // The nearer child last, to be looked at first. Halving keeps the tree's depth below 64.
            let order = if da < db {
                [(b, db), (a, da)]
            } else {
                [(a, da), (b, db)]
            };
            for entry in order {
                if entry.1 < best && depth < stack.len() {
                    stack[depth] = entry;
                    depth += 1;
                }
            }
        }
        best.sqrt()
    }
}

impl Node {
    fn box_distance2(&self, p: [f64; 3]) -> f64 {
        let out = [0, 1, 2].map(|d| (self.lo[d] - p[d]).max(p[d] - self.hi[d]).max(0.0));
        dot(out, out)
    }
}

/// The point of a triangle nearest to `p`. C. Ericson, Real-Time Collision Detection (2005), section 5.1.5: by Voronoi
/// regions of corners, edges and the inside.
#[must_use]
pub fn nearest_on_triangle(p: [f64; 3], [a, b, c]: &[[f64; 3]; 3]) -> [f64; 3] {
    let (ab, ac, ap) = (sub(*b, *a), sub(*c, *a), sub(p, *a));
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return *a;
    }
    let bp = sub(p, *b);
    let (d3, d4) = (dot(ab, bp), dot(ac, bp));
    if d3 >= 0.0 && d4 <= d3 {
        return *b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3 {
        return add(*a, scale(d1 / (d1 - d3), ab));
    }
    let cp = sub(p, *c);
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    if d6 >= 0.0 && d5 <= d6 {
        return *c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6 {
        return add(*a, scale(d2 / (d2 - d6), ac));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 && (d4 - d3) + (d5 - d6) > 0.0 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return add(*b, scale(w, sub(*c, *b)));
    }
    let n = cross(ab, ac);
    let size2 = dot(n, n);
    if size2 <= 0.0 {
        // A triangle without area whose edges were all passed by round-off: its corners are all there is.
        let near = |q: &[f64; 3]| norm(sub(p, *q));
        return [*a, *b, *c]
            .into_iter()
            .min_by(|q, r| near(q).total_cmp(&near(r)))
            .unwrap_or(*a);
    }
    sub(p, scale(dot(ap, n) / size2, n))
}

/// Distance of every cell centre (mean of the corners) to the nearest wall that `is_wall` accepts, `[block][cell]`;
/// infinite without walls.
#[must_use]
pub fn of_cells(grid: &MultiBlock, is_wall: impl Fn(Condition) -> bool) -> Vec<Vec<f64>> {
    let Some(tree) = WallTree::new(grid, is_wall) else {
        return grid
            .blocks
            .iter()
            .map(|b| vec![f64::INFINITY; b.cell_count()])
            .collect();
    };
    grid.blocks
        .iter()
        .map(|block| {
            let mut out = vec![0.0; block.cell_count()];
            out.par_chunks_mut(block.ni.max(1)).enumerate().for_each(|(row, line)| {
                let (j, k) = (row % block.nj, row / block.nj);
                // What is known of the last cell bounds the next: triangle inequality.
                let mut last: Option<([f64; 3], f64)> = None;
                for (i, out) in line.iter_mut().enumerate() {
                    let p = block.cell_centre(i, j, k);
                    let bound = last.map_or(f64::INFINITY, |(q, d)| (d + distance(p, q)) * (1.0 + 1e-12));
                    *out = tree.distance_below(p, bound);
                    last = Some((p, *out));
                }
            });
            out
        })
        .collect()
}
