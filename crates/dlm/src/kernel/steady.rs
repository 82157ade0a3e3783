//! Steady part of the normal wash: the horseshoe vortex, exact at k = 0.
//!
//! A bound vortex along the box's quarter chord with legs trailing to infinity along +x (Katz and Plotkin, Low-Speed
//! Aerodynamics, 10.4.5 and 10.4.7), in Prandtl-Glauert coordinates x / beta. A box of unit dCp carries a circulation
//! Gamma / U = chord / 2. The bound part, (r1 x r2)(|r1| + |r2|) / (|r1| |r2| (|r1| |r2| + r1 . r2)), is regular everywhere but
//! on the vortex itself. Beside the vortex the last bracket is the small difference of large numbers (a high aspect ratio) and
//! is written as |r1 x r2|^2 / (|r1| |r2| - r1 . r2) instead.

/// A pair of strips seen by the horseshoe: all that does not depend on x.
#[derive(Clone, Copy, Debug)]
pub(super) struct Horseshoe {
    /// Receiving point relative to the doublet line's ends, y and z.
    y1: f64,
    z1: f64,
    y2: f64,
    z2: f64,
    /// x component of r1 x r2.
    cross_x: f64,
    /// Receiving normal.
    ny: f64,
    nz: f64,
    /// Trailing legs' wash without their x dependence.
    leg_1: f64,
    leg_2: f64,
}

impl Horseshoe {
    /// `ends` are y, z of the doublet line's ends; `point` and `normal` (y, z) the receiver's.
    pub(super) fn new(ends: [[f64; 2]; 2], point: [f64; 2], normal: [f64; 2]) -> Self {
        let [ny, nz] = normal;
        let (y1, z1) = (point[0] - ends[0][0], point[1] - ends[0][1]);
        let (y2, z2) = (point[0] - ends[1][0], point[1] - ends[1][1]);
        let width2 = (y1 - y2).powi(2) + (z1 - z2).powi(2);
        // On a leg itself its own wash is not counted (the lattice check reports such points).
        let leg = |y: f64, z: f64| {
            let d2 = y * y + z * z;
            if d2 > 1e-18 * width2 {
                (ny * z - nz * y) / d2
            } else {
                0.0
            }
        };
        Self {
            cross_x: y1 * z2 - z1 * y2,
            y1,
            z1,
            y2,
            z2,
            ny,
            nz,
            leg_1: leg(y1, z1),
            leg_2: -leg(y2, z2),
        }
    }

    /// Normal wash per unit dCp at points a distance `x1` and `x2` behind the line's ends (physical lengths), for a box of
    /// chord `chord`; `inverse_beta` is 1 / sqrt(1 - M^2).
    #[inline(always)]
    pub(super) fn wash(&self, x1: f64, x2: f64, inverse_beta: f64, chord: f64) -> f64 {
        let (x1, x2) = (x1 * inverse_beta, x2 * inverse_beta);
        let r1 = x1.mul_add(x1, self.y1.mul_add(self.y1, self.z1 * self.z1)).sqrt();
        let r2 = x2.mul_add(x2, self.y2.mul_add(self.y2, self.z2 * self.z2)).sqrt();
        let cross_y = self.z1 * x2 - x1 * self.z2;
        let cross_z = x1 * self.y2 - self.y1 * x2;
        let product = r1 * r2;
        let dot = x1 * x2 + self.y1 * self.y2 + self.z1 * self.z2;
        let cross2 = self
            .cross_x
            .mul_add(self.cross_x, cross_y.mul_add(cross_y, cross_z * cross_z));
        let beside = dot < 0.0;
        let top = if beside { product - dot } else { 1.0 };
        let bottom = if beside { cross2 } else { product + dot };
        let bound = (self.ny * cross_y + self.nz * cross_z) * (r1 + r2) * top / (product * bottom);
        let trailing = self.leg_1 * (1.0 + x1 / r1) + self.leg_2 * (1.0 + x2 / r2);
        chord * (bound + trailing) * (1.0 / (8.0 * std::f64::consts::PI))
    }
}
