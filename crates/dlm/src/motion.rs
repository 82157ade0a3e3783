//! What modes do to the boxes: displacement and streamwise slope at the points that the lattice uses.

use crate::c64;
use crate::gaf::PointRule;
use crate::lattice::{ControlSurface, Lattice};
use crate::matrix::ComplexMatrix;

/// Motion of every box in every mode. All arrays are `[mode][box]`, flat, `mode * n_boxes + box`.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxMotion {
    /// Number of boxes.
    pub n_boxes: usize,
    /// Number of modes.
    pub n_modes: usize,
    /// dh/dx at the control point (3/4 chord): slope along the stream of the displacement along the normal.
    pub slope: Vec<f64>,
    /// Displacement along the normal at the control point, length.
    pub at_control: Vec<f64>,
    /// Displacement along the normal at the force point (1/4 chord), length.
    pub at_force: Vec<f64>,
}

impl BoxMotion {
    /// No modes yet.
    pub fn empty(n_boxes: usize) -> Self {
        Self {
            n_boxes,
            n_modes: 0,
            slope: Vec::new(),
            at_control: Vec::new(),
            at_force: Vec::new(),
        }
    }

    /// Adds a mode given by displacement and slope as functions of a box and a point on it (a field known everywhere).
    ///
    /// `field(box, point)` returns (h along the box's normal, dh/dx). With [`PointRule::MidChord`] it is asked at the
    /// mid-chord and the box moves as a rigid plate.
    pub fn push_field(&mut self, lattice: &Lattice, rule: PointRule, field: impl Fn(usize, [f64; 3]) -> (f64, f64)) {
        for (i, b) in lattice.boxes().iter().enumerate() {
            let (slope, control, force) = match rule {
                PointRule::ControlPoint => {
                    let (h, slope) = field(i, b.control_point);
                    (slope, h, field(i, b.force_point).0)
                }
                PointRule::MidChord => {
                    let (h, slope) = field(i, b.mid_chord);
                    (slope, h + 0.25 * b.chord * slope, h - 0.25 * b.chord * slope)
                }
            };
            self.slope.push(slope);
            self.at_control.push(control);
            self.at_force.push(force);
        }
        self.n_modes += 1;
    }

    /// Adds a rigid-body mode: displacement `translation + rotation x (point - centre)`, small rotations in radians about
    /// x, y, z. A positive turn about +y lowers what lies aft: nose up.
    pub fn push_rigid(&mut self, lattice: &Lattice, rule: PointRule, rigid: &RigidMotion) {
        self.push_field(lattice, rule, |i, point| rigid.on(lattice.boxes()[i].normal, point));
    }

    /// Adds the mode of a control surface turned by one radian, trailing edge down (against the normal).
    pub fn push_control(&mut self, lattice: &Lattice, rule: PointRule, control: &ControlSurface) {
        let [a, b] = control.hinge;
        let length = crate::lattice::distance(a, b);
        // Both directions of the hinge line describe the same control: the one along which a turn lowers the trailing edge
        // is taken per box, from the box's own span direction.
        let axis = [(b[0] - a[0]) / length, (b[1] - a[1]) / length, (b[2] - a[2]) / length];
        let belongs: Vec<bool> = {
            let mut list = vec![false; lattice.n_boxes()];
            for &b in &control.boxes {
                list[b] = true;
            }
            list
        };
        self.push_field(lattice, rule, |i, point| {
            if !belongs[i] {
                return (0.0, 0.0);
            }
            let cell = &lattice.boxes()[i];
            let along = axis[1] * cell.cos_dihedral + axis[2] * cell.sin_dihedral;
            let sense = if along < 0.0 { -1.0 } else { 1.0 };
            let turn = RigidMotion {
                rotation: axis.map(|x| sense * x),
                centre: a,
                ..RigidMotion::default()
            };
            turn.on(cell.normal, point)
        });
    }

    /// Joins the modes of another motion of the same lattice.
    ///
    /// # Panics
    /// When the box counts differ (a programming error).
    pub fn append(&mut self, other: &Self) {
        assert_eq!(self.n_boxes, other.n_boxes, "modes of one lattice");
        self.n_modes += other.n_modes;
        self.slope.extend_from_slice(&other.slope);
        self.at_control.extend_from_slice(&other.at_control);
        self.at_force.extend_from_slice(&other.at_force);
    }

    /// Downwash w = dh/dx + i k h / b, [row = box][column = mode]; `wave_number` is k / b.
    pub fn downwash(&self, wave_number: f64) -> ComplexMatrix {
        ComplexMatrix::from_fn(self.n_boxes, self.n_modes, |i, j| {
            let at = j * self.n_boxes + i;
            c64::new(self.slope[at], wave_number * self.at_control[at])
        })
    }
}

/// A small rigid-body displacement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RigidMotion {
    /// Translation, length.
    pub translation: [f64; 3],
    /// Rotation vector, radians about x, y, z (right-handed; +y is nose up).
    pub rotation: [f64; 3],
    /// Point that only translates.
    pub centre: [f64; 3],
}

impl RigidMotion {
    /// Displacement along `normal` at `point`, and its slope along x.
    pub fn on(&self, normal: [f64; 3], point: [f64; 3]) -> (f64, f64) {
        let r = [
            point[0] - self.centre[0],
            point[1] - self.centre[1],
            point[2] - self.centre[2],
        ];
        let w = self.rotation;
        let u = [
            self.translation[0] + w[1] * r[2] - w[2] * r[1],
            self.translation[1] + w[2] * r[0] - w[0] * r[2],
            self.translation[2] + w[0] * r[1] - w[1] * r[0],
        ];
        let h = normal[0] * u[0] + normal[1] * u[1] + normal[2] * u[2];
        (h, normal[1] * w[2] - normal[2] * w[1])
    }
}
