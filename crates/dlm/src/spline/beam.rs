//! A beam that bends and twists, with rigid arms across it: Nastran's SPLINE2.
//!
//! In the spline's own axes (y along the beam, x across it in the boxes' plane, z along the normal), w = w0(y) - x theta(y).
//! A force P_i at (x_i, y_i), a moment M_i about x and a torque T_i about y on a free uniform beam with EI = 1 and
//! GJ = EI / DTOR give, with d = y - y_i,
//!
//! w0 = sum |d|^3 / 12 P_i - d |d| / 4 M_i + a + b y,
//! theta = -DTOR/2 sum |d| (T_i - x_i P_i) + c,
//!
//! under equilibrium of the P, M, T (MSC Aeroelastic Analysis User's Guide, "Theory of linear splines"; NASTRAN-95, LSPLIN).
//! The streamwise slope on a swept beam is w0' sin(sweep) - theta cos(sweep); Nastran leaves the gradient of the twist
//! out of it.

use faer::Mat;

use super::{Field, Input, Plane, SplineError, SplineSpec, dense};
use crate::lattice::LatticeBox;

/// A beam spline's axis and attachments.
#[derive(Clone, Debug, PartialEq)]
pub struct BeamSpline {
    /// A point of the axis.
    pub origin: [f64; 3],
    /// Direction of the axis; its part in the boxes' plane is used. For a spline system of a deck: its y-axis.
    pub direction: [f64; 3],
    /// EI / GJ (DTOR).
    pub torsion_flexibility: f64,
    /// Attachment flexibility of displacements (DZ), 0 rigid.
    pub displacement_flexibility: f64,
    /// Attachment flexibility of rotations about the axis across the beam (DTHX: bending slope); `None`: the rotations are not
    /// attached (Nastran's -1).
    pub bending_rotation_flexibility: Option<f64>,
    /// Attachment flexibility of rotations about the beam (DTHY: twist); `None`: not attached.
    pub twist_rotation_flexibility: Option<f64>,
    /// Count the gradient of the twist in the streamwise slope of a swept beam (true derivative of w). Nastran does not.
    pub twist_gradient: bool,
}

/// What an input of the beam is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Load {
    Force,
    BendingMoment,
    Torque,
}

pub(super) struct Beam {
    inputs: Vec<Input>,
    /// Per input: what it is, x and y of its node over `length`.
    loads: Vec<(Load, f64, f64)>,
    origin: [f64; 3],
    across: [f64; 3],
    along: [f64; 3],
    length: f64,
    torsion: f64,
    twist_gradient: bool,
    /// Twist is not determined by the nodes.
    no_twist: bool,
    coefficients: Mat<f64>,
}

/// Displacement w0, its slope, twist and its gradient at `y` from a unit load.
fn response((load, x_load, y_load): (Load, f64, f64), torsion: f64, y: f64) -> [f64; 4] {
    let d = y - y_load;
    let a = d.abs();
    let sign = if d == 0.0 { 0.0 } else { d.signum() };
    match load {
        Load::Force => [
            a * a * a / 12.0,
            d * a / 4.0,
            0.5 * torsion * a * x_load,
            0.5 * torsion * sign * x_load,
        ],
        Load::BendingMoment => [-d * a / 4.0, -0.5 * a, 0.0, 0.0],
        Load::Torque => [0.0, 0.0, -0.5 * torsion * a, -0.5 * torsion * sign],
    }
}

/// The same for the free motions: displacement, slope, twist.
const FREE: usize = 3;

fn free_motion(kind: usize, y: f64) -> [f64; 4] {
    match kind {
        0 => [1.0, 0.0, 0.0, 0.0],
        1 => [y, 1.0, 0.0, 0.0],
        _ => [0.0, 0.0, 1.0, 0.0],
    }
}

/// What an input measures of a motion at its node.
fn measure((load, x, _): (Load, f64, f64), motion: [f64; 4]) -> f64 {
    match load {
        Load::Force => motion[0] - x * motion[2],
        Load::BendingMoment => motion[1],
        Load::Torque => motion[2],
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

impl Beam {
    pub(super) fn fit(
        spline: usize,
        spec: &SplineSpec,
        plane: Plane,
        nodes: &[[f64; 3]],
        beam: &BeamSpline,
    ) -> Result<Self, SplineError> {
        let value = |reason: String| SplineError::Value { spline, reason };
        let n = plane.normal;
        let off = dot(beam.direction, n);
        let in_plane = [0, 1, 2].map(|i| beam.direction[i] - off * n[i]);
        let size = dot(in_plane, in_plane).sqrt();
        if size.is_nan() || size <= 1e-6 * dot(beam.direction, beam.direction).sqrt() {
            return Err(value(format!(
                "the beam's axis {:?} must not lie along the boxes' normal",
                beam.direction
            )));
        }
        let flexibilities = [
            Some(beam.displacement_flexibility),
            beam.bending_rotation_flexibility,
            beam.twist_rotation_flexibility,
        ];
        if flexibilities
            .iter()
            .flatten()
            .chain([&beam.torsion_flexibility])
            .any(|f| !(f.is_finite() && *f >= 0.0))
        {
            return Err(value("flexibilities must be finite and not negative".into()));
        }
        let along = in_plane.map(|x| x / size);
        let across = cross(along, n);
        let local = |p: [f64; 3]| {
            let r = [0, 1, 2].map(|i| p[i] - beam.origin[i]);
            (dot(r, across), dot(r, along))
        };
        let places: Vec<(f64, f64)> = spec.nodes.iter().map(|&i| local(nodes[i])).collect();
        let needed = if beam.bending_rotation_flexibility.is_some() {
            1
        } else {
            2
        };
        if places.len() < needed {
            return Err(SplineError::TooFewNodes {
                spline,
                needed,
                got: places.len(),
            });
        }
        // Lengths are scaled by the nodes' reach so that the pivots can be judged.
        let reach = |value: fn(&(f64, f64)) -> f64| {
            let (low, high) = places
                .iter()
                .map(value)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            high - low
        };
        let reached = reach(|p| p.0).max(reach(|p| p.1));
        let length = if reached > 0.0 { reached } else { 1.0 };
        for i in 0..places.len() {
            for j in 0..i {
                let (dx, dy) = (places[i].0 - places[j].0, places[i].1 - places[j].1);
                if dx.hypot(dy) <= 1e-9 * length && beam.displacement_flexibility == 0.0 {
                    return Err(SplineError::Coincident {
                        spline,
                        a: spec.nodes[j],
                        b: spec.nodes[i],
                    });
                }
            }
        }
        // Nodes in one line along the beam, rotations about it not attached: nothing says how the beam twists.
        let no_twist = beam.twist_rotation_flexibility.is_none()
            && places.iter().all(|p| (p.0 - places[0].0).abs() <= 1e-9 * length);
        let mut inputs = Vec::new();
        let mut loads = Vec::new();
        let mut springs = Vec::new();
        for (&node, &(x, y)) in spec.nodes.iter().zip(&places) {
            let (x, y) = (x / length, y / length);
            inputs.push(Input::translation(node, n));
            loads.push((Load::Force, x, y));
            springs.push(beam.displacement_flexibility / length.powi(3));
            if let Some(f) = beam.bending_rotation_flexibility {
                inputs.push(Input::rotation(node, across));
                loads.push((Load::BendingMoment, x, y));
                springs.push(f / length);
            }
            if let Some(f) = beam.twist_rotation_flexibility {
                inputs.push(Input::rotation(node, along));
                loads.push((Load::Torque, x, y));
                springs.push(f / length);
            }
        }
        let torsion = beam.torsion_flexibility;
        let m = loads.len();
        let free = if no_twist { FREE - 1 } else { FREE };
        let a = Mat::from_fn(m + free, m + free, |i, j| match (i < m, j < m) {
            (true, true) => {
                let spring = if i == j { springs[i] } else { 0.0 };
                measure(loads[i], response(loads[j], torsion, loads[i].2)) + spring
            }
            (true, false) => measure(loads[i], free_motion(j - m, loads[i].2)),
            (false, true) => measure(loads[j], free_motion(i - m, loads[j].2)),
            (false, false) => 0.0,
        });
        // The beam's free motions need no forces.
        let exact = (0..free)
            .map(|kind| {
                let mut coefficients = vec![0.0; m + free];
                coefficients[m + kind] = 1.0;
                (
                    loads
                        .iter()
                        .map(|&load| measure(load, free_motion(kind, load.2)))
                        .collect(),
                    coefficients,
                )
            })
            .collect();
        let advice = "too many rigidly attached freedoms at one station of the beam; give DZ, DTHX or DTHY a value, or \
                      remove nodes";
        let coefficients = dense::coefficients(spline, &a, m, exact, advice)?;
        Ok(Self {
            inputs,
            loads,
            origin: beam.origin,
            across,
            along,
            length,
            torsion,
            twist_gradient: beam.twist_gradient,
            no_twist,
            coefficients,
        })
    }
}

impl Field for Beam {
    fn inputs(&self) -> &[Input] {
        &self.inputs
    }

    fn free_rotation(&self) -> Option<[f64; 3]> {
        self.no_twist.then_some(self.along)
    }

    fn rows(&self, _cell: &LatticeBox, point: [f64; 3], h: &mut [f64], slope: &mut [f64]) {
        let r = [0, 1, 2].map(|i| (point[i] - self.origin[i]) / self.length);
        let (x, y) = (dot(r, self.across), dot(r, self.along));
        // Streamwise derivative: d/dX = across_x d/dx + along_x d/dy.
        let (cos, sin) = (self.across[0], self.along[0]);
        let m = self.loads.len();
        let n_free = if self.no_twist { FREE - 1 } else { FREE };
        let basis: Vec<(f64, f64)> = (0..m + n_free)
            .map(|i| {
                if i < m {
                    response(self.loads[i], self.torsion, y)
                } else {
                    free_motion(i - m, y)
                }
            })
            .map(|[w, bend, twist, gradient]| {
                let gradient = if self.twist_gradient { gradient } else { 0.0 };
                (w - x * twist, sin * (bend - x * gradient) - cos * twist)
            })
            .collect();
        for (j, (load, ..)) in self.loads.iter().enumerate() {
            let (mut value, mut derivative) = (0.0, 0.0);
            for (i, b) in basis.iter().enumerate() {
                value += b.0 * self.coefficients[(i, j)];
                derivative += b.1 * self.coefficients[(i, j)];
            }
            // Back from scaled lengths: displacements were over `length`, rotations are pure numbers.
            if *load == Load::Force {
                h[j] = value;
                slope[j] = derivative / self.length;
            } else {
                h[j] = value * self.length;
                slope[j] = derivative;
            }
        }
    }
}
