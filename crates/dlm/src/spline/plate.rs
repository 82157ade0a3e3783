//! Splines with the plate's fundamental solution r^2 ln r^2.
//!
//! w(p) = a0 + a1 x + a2 y + sum of P_i r_i^2 ln r_i^2, with sum P = sum x P = sum y P = 0 (Harder and Desmarais, J. Aircraft
//! 9(2) 1972, eqs. 7 - 10; the constant 1 / (16 pi D) is taken into P). The thin-plate spline is the same per displacement
//! component in space: the kernel is conditionally positive definite of order two in any number of dimensions (Duchon 1977).

use faer::Mat;

use super::{Field, Input, Plane, SplineError, SplineSpec, dense};
use crate::lattice::LatticeBox;

/// r^2 ln r^2 from r^2, and its derivative by r^2 (ln r^2 + 1); both 0 at 0, where the product with r vanishes.
fn kernel(r2: f64) -> (f64, f64) {
    if r2 > 0.0 {
        (r2 * r2.ln(), r2.ln() + 1.0)
    } else {
        (0.0, 0.0)
    }
}

/// A scalar field over points with up to three coordinates.
struct Radial {
    /// Coordinates of nodes over `length`.
    nodes: Vec<[f64; 3]>,
    /// Directions of the linear part, in scaled coordinates.
    linear: Vec<[f64; 3]>,
    /// Point that the linear part counts from.
    origin: [f64; 3],
    length: f64,
    /// [coefficient: nodes, constant, linear][input: nodes].
    coefficients: Mat<f64>,
}

impl Radial {
    /// `directions` are the unit vectors along which the linear part acts.
    fn fit(spline: usize, points: &[[f64; 3]], directions: &[[f64; 3]], flexibility: f64) -> Result<Self, SplineError> {
        if !(flexibility.is_finite() && flexibility >= 0.0) {
            return Err(SplineError::Value {
                spline,
                reason: format!("attachment flexibility must not be negative, got {flexibility}"),
            });
        }
        let n = points.len();
        let origin = [0, 1, 2].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n as f64);
        // Lengths are scaled so that the pivots can be judged; the side conditions make the fit independent of it.
        let length = points
            .iter()
            .map(|p| crate::lattice::distance(*p, origin))
            .fold(0.0, f64::max);
        let nodes: Vec<[f64; 3]> = points
            .iter()
            .map(|p| [0, 1, 2].map(|i| (p[i] - origin[i]) / length))
            .collect();
        let size = n + 1 + directions.len();
        let polynomial = |row: usize, column: usize| {
            if column == n {
                1.0
            } else {
                dot(directions[column - n - 1], nodes[row])
            }
        };
        let a = Mat::from_fn(size, size, |i, j| match (i < n, j < n) {
            (true, true) if i == j => flexibility / (length * length),
            (true, true) => kernel(square(nodes[i], nodes[j])).0,
            (true, false) => polynomial(i, j),
            (false, true) => polynomial(j, i),
            (false, false) => 0.0,
        });
        // Constant and linear fields need no forces.
        let exact = (n..size)
            .map(|column| {
                let mut coefficients = vec![0.0; size];
                coefficients[column] = 1.0;
                ((0..n).map(|row| polynomial(row, column)).collect(), coefficients)
            })
            .collect();
        let advice = "nodes lie too close to one line or to each other; remove some or add nodes off the line";
        let coefficients = dense::coefficients(spline, &a, n, exact, advice)?;
        Ok(Self {
            nodes,
            linear: directions.to_vec(),
            origin,
            length,
            coefficients,
        })
    }

    /// Value and derivative along x at `point` per unit input.
    fn rows(&self, point: [f64; 3], value: &mut [f64], slope: &mut [f64]) {
        let n = self.nodes.len();
        let p = [0, 1, 2].map(|i| (point[i] - self.origin[i]) / self.length);
        let mut basis = Vec::with_capacity(n + 1 + self.linear.len());
        for node in &self.nodes {
            let (v, d) = kernel(square(p, *node));
            basis.push((v, 2.0 * (p[0] - node[0]) * d));
        }
        basis.push((1.0, 0.0));
        basis.extend(self.linear.iter().map(|d| (dot(*d, p), d[0])));
        for j in 0..n {
            let (mut v, mut s) = (0.0, 0.0);
            for (i, b) in basis.iter().enumerate() {
                v += b.0 * self.coefficients[(i, j)];
                s += b.1 * self.coefficients[(i, j)];
            }
            value[j] = v;
            slope[j] = s / self.length;
        }
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn square(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)
}

/// Refuses coincident points and points on one line.
fn check_points(spline: usize, spec: &SplineSpec, points: &[[f64; 3]]) -> Result<[f64; 3], SplineError> {
    if points.len() < 3 {
        return Err(SplineError::TooFewNodes {
            spline,
            needed: 3,
            got: points.len(),
        });
    }
    let spread = dense::spread(points);
    for i in 0..points.len() {
        for j in 0..i {
            if square(points[i], points[j]).sqrt() <= 1e-9 * spread[0] {
                return Err(SplineError::Coincident {
                    spline,
                    a: spec.nodes[j],
                    b: spec.nodes[i],
                });
            }
        }
    }
    if spread[1] <= 1e-6 * spread[0] {
        return Err(SplineError::Collinear { spline });
    }
    Ok(spread)
}

/// Displacement along the normal over the boxes' plane.
pub(super) struct InfinitePlate {
    inputs: Vec<Input>,
    plane: Plane,
    radial: Radial,
}

impl InfinitePlate {
    pub(super) fn fit(
        spline: usize,
        spec: &SplineSpec,
        plane: Plane,
        nodes: &[[f64; 3]],
        flexibility: f64,
    ) -> Result<Self, SplineError> {
        let points: Vec<[f64; 3]> = spec.nodes.iter().map(|&n| on_plane(&plane, nodes[n])).collect();
        check_points(spline, spec, &points)?;
        let inputs = spec
            .nodes
            .iter()
            .map(|&n| Input::translation(n, plane.normal))
            .collect();
        let radial = Radial::fit(spline, &points, &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], flexibility)?;
        Ok(Self { inputs, plane, radial })
    }
}

/// (x, distance across the stream, 0) of a point projected onto the plane.
fn on_plane(plane: &Plane, p: [f64; 3]) -> [f64; 3] {
    [p[0], dot(plane.across(), p), 0.0]
}

impl Field for InfinitePlate {
    fn inputs(&self) -> &[Input] {
        &self.inputs
    }

    fn rows(&self, _cell: &LatticeBox, point: [f64; 3], h: &mut [f64], slope: &mut [f64]) {
        self.radial.rows(on_plane(&self.plane, point), h, slope);
    }
}

/// Three displacements over space.
pub(super) struct ThinPlate {
    /// Node by node: x, y, z displacements.
    inputs: Vec<Input>,
    radial: Radial,
}

impl ThinPlate {
    pub(super) fn fit(
        spline: usize,
        spec: &SplineSpec,
        nodes: &[[f64; 3]],
        flexibility: f64,
    ) -> Result<Self, SplineError> {
        let points: Vec<[f64; 3]> = spec.nodes.iter().map(|&n| nodes[n]).collect();
        let spread = check_points(spline, spec, &points)?;
        // Nodes in one plane do not determine a slope across it; the linear part then stays in the plane. Boxes off that
        // plane are caught by the rigid check.
        let directions = if spread[2] > 1e-6 * spread[0] {
            vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
        } else {
            in_plane_directions(&points)
        };
        let inputs = spec
            .nodes
            .iter()
            .flat_map(|&n| [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| Input::translation(n, axis)))
            .collect();
        Ok(Self {
            inputs,
            radial: Radial::fit(spline, &points, &directions, flexibility)?,
        })
    }
}

/// Two orthonormal directions of the plane that holds all points (which are not on one line).
fn in_plane_directions(points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let minus = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let longest = |list: Vec<[f64; 3]>| {
        list.into_iter()
            .fold([0.0; 3], |best, v| if dot(v, v) > dot(best, best) { v } else { best })
    };
    let unit = |v: [f64; 3]| {
        let n = dot(v, v).sqrt();
        v.map(|x| x / n)
    };
    let first = unit(longest(points.iter().map(|p| minus(*p, points[0])).collect()));
    let second = unit(longest(
        points
            .iter()
            .map(|p| {
                let v = minus(*p, points[0]);
                let along = dot(v, first);
                minus(v, first.map(|x| along * x))
            })
            .collect(),
    ));
    vec![first, second]
}

impl Field for ThinPlate {
    fn inputs(&self) -> &[Input] {
        &self.inputs
    }

    fn rows(&self, cell: &LatticeBox, point: [f64; 3], h: &mut [f64], slope: &mut [f64]) {
        let n = self.inputs.len() / 3;
        let (mut value, mut derivative) = (vec![0.0; n], vec![0.0; n]);
        self.radial.rows(point, &mut value, &mut derivative);
        for j in 0..n {
            for axis in 0..3 {
                h[3 * j + axis] = cell.normal[axis] * value[j];
                slope[3 * j + axis] = cell.normal[axis] * derivative[j];
            }
        }
    }
}
