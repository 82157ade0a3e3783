//! The inside of a plane or surface from its four edges alone: transfinite interpolation.

/// Fills the inside of `nodes` `[j][i]`, (ni + 1) x (nj + 1) of them, from its edges.
///
/// W. J. Gordon and C. A. Hall, Construction of curvilinear co-ordinate systems and applications to mesh generation, Int. J.
/// Num. Meth. Eng. 7 (1973): the sum of the interpolations along both directions less that of the corners. The blending
/// functions are the arc lengths along the edges (B. K. Soni, AIAA 85-1526: those of opposite edges are blended so that
/// they agree in the inside), so that the edges' clustering is carried inside.
pub(super) fn transfinite<const D: usize>(nodes: &mut [[f64; D]], ni: usize, nj: usize) {
    let width = ni + 1;
    let (low, high) = (shares(nodes, 0, 1, ni), shares(nodes, width * nj, 1, ni));
    let (first, last) = (shares(nodes, 0, width, nj), shares(nodes, ni, width, nj));
    let corner = |i: usize, j: usize| nodes[i + width * j];
    let corners = [corner(0, 0), corner(ni, 0), corner(0, nj), corner(ni, nj)];
    for j in 1..nj {
        for i in 1..ni {
            // Where the lines s = low + v (high - low) and v = first + s (last - first) cross.
            let (ds, dv) = (high[i] - low[i], last[j] - first[j]);
            let s = (low[i] + first[j] * ds) / (1.0 - ds * dv);
            let v = first[j] + s * dv;
            for d in 0..D {
                let along = (1.0 - s) * nodes[width * j][d] + s * nodes[ni + width * j][d];
                let across = (1.0 - v) * nodes[i][d] + v * nodes[i + width * nj][d];
                let both = (1.0 - v) * ((1.0 - s) * corners[0][d] + s * corners[1][d])
                    + v * ((1.0 - s) * corners[2][d] + s * corners[3][d]);
                nodes[i + width * j][d] = along + across - both;
            }
        }
    }
}

/// Arc length from the start of an edge over its whole length; the number of the node over n where it has no length.
fn shares<const D: usize>(nodes: &[[f64; D]], from: usize, step: usize, n: usize) -> Vec<f64> {
    let mut out = vec![0.0; n + 1];
    for m in 1..=n {
        let (p, q) = (nodes[from + step * (m - 1)], nodes[from + step * m]);
        out[m] = out[m - 1] + (0..D).map(|d| (q[d] - p[d]).powi(2)).sum::<f64>().sqrt();
    }
    let total = out[n];
    for (m, share) in out.iter_mut().enumerate() {
        *share = if total > 0.0 {
            *share / total
        } else {
            m as f64 / n as f64
        };
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Products of one function of i and one of j are met exactly: a box with any spacing, and a sheared one.
    #[test]
    fn a_stretched_and_sheared_box_is_met_exactly() {
        let (ni, nj) = (7, 5);
        let exact = |i: usize, j: usize| {
            let (s, v) = ((i as f64 / 7.0).powi(2), (j as f64 / 5.0).powi(3));
            [3.0 * s + 0.5 * v, 2.0 * v + 0.1 * s]
        };
        let mut nodes: Vec<[f64; 2]> = (0..48).map(|n| exact(n % 8, n / 8)).collect();
        for j in 1..nj {
            for i in 1..ni {
                nodes[i + 8 * j] = [f64::NAN; 2];
            }
        }
        transfinite(&mut nodes, ni, nj);
        for j in 0..=nj {
            for i in 0..=ni {
                let (p, q) = (nodes[i + 8 * j], exact(i, j));
                assert!((p[0] - q[0]).abs() < 1e-14 && (p[1] - q[1]).abs() < 1e-14, "{i} {j}");
            }
        }
    }
}
