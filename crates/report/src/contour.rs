//! Bands and lines of equal value over a mesh of triangles, linear within each.

use std::collections::BTreeMap;

/// A mesh of triangles in the plane with a value at every node.
pub(crate) struct Field {
    /// (u, v) [node].
    pub(crate) points: Vec<(f64, f64)>,
    /// [node]; triangles that touch a value that is not finite are left out.
    pub(crate) values: Vec<f64>,
    /// Nodes of each triangle.
    pub(crate) triangles: Vec<[usize; 3]>,
}

/// An edge by its two nodes, lower first.
type Edge = (usize, usize);

fn edge(a: usize, b: usize) -> Edge {
    (a.min(b), a.max(b))
}

/// The three edges of a polygon of nodes, or as many as it has.
pub(crate) fn edges(nodes: &[usize]) -> impl Iterator<Item = Edge> + '_ {
    nodes
        .iter()
        .zip(nodes.iter().cycle().skip(1))
        .map(|(&a, &b)| edge(a, b))
}

impl Field {
    /// Polygons of the part of each triangle where `lo <= value <= hi`.
    pub(crate) fn band(&self, lo: f64, hi: f64) -> Vec<Vec<(f64, f64)>> {
        self.corners()
            .map(|corners| cut(&cut(&corners, |v| v - lo), |v| hi - v))
            .filter(|polygon| polygon.len() >= 3)
            .map(|polygon| polygon.into_iter().map(|(p, _)| p).collect())
            .collect()
    }

    fn corners(&self) -> impl Iterator<Item = Vec<((f64, f64), f64)>> + '_ {
        self.triangles.iter().filter_map(|t| {
            t.iter()
                .map(|&n| Some((*self.points.get(n)?, *self.values.get(n).filter(|v| v.is_finite())?)))
                .collect::<Option<Vec<_>>>()
        })
    }

    /// Lines on which the value is zero, each a run of points. A rim that is held at zero (a clamped root) is no node
    /// line and is left out.
    pub(crate) fn zero_lines(&self) -> Vec<Vec<(f64, f64)>> {
        let mut shared: BTreeMap<Edge, usize> = BTreeMap::new();
        for t in &self.triangles {
            for e in edges(t) {
                *shared.entry(e).or_default() += 1;
            }
        }
        let largest = self
            .values
            .iter()
            .filter(|v| v.is_finite())
            .fold(0.0_f64, |m, v| m.max(v.abs()));
        let tiny = 1e-9 * largest;
        let value = |n: usize| self.values.get(n).copied().filter(|v| v.is_finite());
        // Positive, or zero to rounding.
        let above = |v: f64| v >= -tiny;
        let mut pieces: Vec<(Edge, Edge)> = Vec::new();
        let mut places: BTreeMap<Edge, (f64, f64)> = BTreeMap::new();
        for t in &self.triangles {
            if t.iter().any(|&n| value(n).is_none()) {
                continue;
            }
            let mut crossed = Vec::new();
            let mut zero_nodes = Vec::new();
            for (a, b) in edges(t) {
                let (Some(va), Some(vb), Some(&pa), Some(&pb)) =
                    (value(a), value(b), self.points.get(a), self.points.get(b))
                else {
                    continue;
                };
                if above(va) == above(vb) {
                    continue;
                }
                let part = (va / (va - vb)).clamp(0.0, 1.0);
                // A line through a node is one place, whichever edge it is reached by.
                let key = match (va.abs() <= tiny, vb.abs() <= tiny) {
                    (true, _) => (a, a),
                    (_, true) => (b, b),
                    _ => (a, b),
                };
                if key.0 == key.1 {
                    zero_nodes.push(key.0);
                }
                places.insert(key, (pa.0 + part * (pb.0 - pa.0), pa.1 + part * (pb.1 - pa.1)));
                crossed.push(key);
            }
            let &[from, to] = crossed.as_slice() else { continue };
            let on_rim = match zero_nodes.as_slice() {
                &[a, b] => a == b || shared.get(&edge(a, b)).is_none_or(|n| *n < 2),
                _ => false,
            };
            if !on_rim && from != to {
                pieces.push((from, to));
            }
        }
        chain(&pieces)
            .iter()
            .map(|line| line.iter().filter_map(|key| places.get(key).copied()).collect())
            .collect()
    }
}

/// The part of a polygon where `inside` (linear in the value) is not negative: Sutherland and Hodgman 1974.
fn cut(polygon: &[((f64, f64), f64)], inside: impl Fn(f64) -> f64) -> Vec<((f64, f64), f64)> {
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for (&(p, vp), &(q, vq)) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let (dp, dq) = (inside(vp), inside(vq));
        if dp >= 0.0 {
            out.push((p, vp));
        }
        if (dp >= 0.0) != (dq >= 0.0) {
            let t = dp / (dp - dq);
            out.push(((p.0 + t * (q.0 - p.0), p.1 + t * (q.1 - p.1)), vp + t * (vq - vp)));
        }
    }
    out
}

/// Joins pieces (pairs of keys) into runs; a closed run ends on the key it began with.
pub(crate) fn chain<K: Ord + Copy>(pieces: &[(K, K)]) -> Vec<Vec<K>> {
    let mut at: BTreeMap<K, Vec<usize>> = BTreeMap::new();
    for (i, (a, b)) in pieces.iter().enumerate() {
        at.entry(*a).or_default().push(i);
        at.entry(*b).or_default().push(i);
    }
    let mut used = vec![false; pieces.len()];
    let mut runs = Vec::new();
    // Open runs begin at an end; what is left after them is closed.
    let ends = at.iter().filter(|(_, list)| list.len() != 2).map(|(k, _)| *k);
    let starts: Vec<K> = ends.chain(at.keys().copied()).collect();
    for start in starts {
        loop {
            let mut run = vec![start];
            let mut here = start;
            while let Some(next) = at.get(&here).and_then(|list| list.iter().copied().find(|&i| !used[i])) {
                used[next] = true;
                let (a, b) = pieces[next];
                here = if a == here { b } else { a };
                run.push(here);
                if here == start || at.get(&here).is_some_and(|list| list.len() != 2) {
                    break;
                }
            }
            if run.len() < 2 {
                break;
            }
            runs.push(run);
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(values: [f64; 4]) -> Field {
        Field {
            points: vec![(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)],
            values: values.to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }
    }

    fn area(polygon: &[(f64, f64)]) -> f64 {
        let next = polygon.iter().cycle().skip(1);
        0.5 * polygon
            .iter()
            .zip(next)
            .map(|(p, q)| p.0 * q.1 - q.0 * p.1)
            .sum::<f64>()
            .abs()
    }

    #[test]
    fn bands_of_a_plane_have_their_exact_areas_and_fill_the_square() {
        let field = square([0.0, 1.0, 1.0, 0.0]);
        let areas: Vec<f64> = [(0.0, 0.3), (0.3, 0.7), (0.7, 1.0)]
            .iter()
            .map(|(lo, hi)| field.band(*lo, *hi).iter().map(|p| area(p)).sum())
            .collect();
        for (got, want) in areas.iter().zip([0.3, 0.4, 0.3]) {
            assert!((got - want).abs() < 1e-14, "{areas:?}");
        }
    }

    #[test]
    fn the_zero_line_of_a_plane_is_straight_and_whole() {
        let lines = square([-1.0, 3.0, 3.0, -1.0]).zero_lines();
        assert_eq!(lines.len(), 1);
        assert!(lines[0].iter().all(|p| (p.0 - 0.25).abs() < 1e-14));
        let (lo, hi) = lines[0]
            .iter()
            .fold((1.0_f64, 0.0_f64), |(a, b), p| (a.min(p.1), b.max(p.1)));
        assert_eq!((lo, hi), (0.0, 1.0));
    }

    #[test]
    fn a_clamped_rim_is_no_node_line_but_a_line_along_nodes_is_one() {
        assert!(square([0.0, -1.0, -1.0, 0.0]).zero_lines().is_empty());
        assert!(square([0.0, 1.0, 1.0, 0.0]).zero_lines().is_empty());
        let lines = square([0.0, -1.0, 0.0, 1.0]).zero_lines();
        assert_eq!(lines, vec![vec![(0.0, 0.0), (1.0, 1.0)]]);
    }

    #[test]
    fn pieces_join_into_open_and_closed_runs() {
        let runs = chain(&[(3, 4), (1, 2), (2, 3), (7, 8), (8, 9), (9, 7)]);
        assert_eq!(runs, vec![vec![1, 2, 3, 4], vec![7, 8, 9, 7]]);
    }
}
