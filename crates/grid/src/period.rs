//! What lies between the two sides of a periodic interface: a shift, or a turn about an axis.

use crate::vector::{add, cross, dot, scale, sub, unit};

/// How a periodic interface's first side comes to lie on its second one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Period {
    /// By this way.
    Translation([f64; 3]),
    /// About the line through `centre` along `axis` (of any length but zero), right-handed.
    Rotation {
        /// A point of the axis.
        centre: [f64; 3],
        /// Its direction.
        axis: [f64; 3],
        /// The angle in degrees.
        angle_deg: f64,
    },
}

impl Period {
    /// Where `p` of the first side lies on the second one.
    #[must_use]
    pub fn moved(&self, p: [f64; 3]) -> [f64; 3] {
        match *self {
            Self::Translation(way) => add(p, way),
            Self::Rotation {
                centre,
                axis,
                angle_deg,
            } => {
                // O. Rodrigues, J. Math. Pures Appl. 5 (1840).
                let (sin, cos) = angle_deg.to_radians().sin_cos();
                let (k, r) = (unit(axis), sub(p, centre));
                let along = scale(dot(k, r) * (1.0 - cos), k);
                add(centre, add(add(scale(cos, r), scale(sin, cross(k, r))), along))
            }
        }
    }

    /// The way back.
    #[must_use]
    pub fn inverse(self) -> Self {
        match self {
            Self::Translation(way) => Self::Translation(way.map(|v| -v)),
            Self::Rotation {
                centre,
                axis,
                angle_deg,
            } => Self::Rotation {
                centre,
                axis,
                angle_deg: -angle_deg,
            },
        }
    }

    /// The same in a grid whose coordinates are `factor` times as large.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        match self {
            Self::Translation(way) => Self::Translation(scale(factor, way)),
            Self::Rotation {
                centre,
                axis,
                angle_deg,
            } => Self::Rotation {
                centre: scale(factor, centre),
                axis,
                angle_deg,
            },
        }
    }

    /// Why this can be no period, if it cannot.
    #[must_use]
    pub fn fault(&self) -> Option<&'static str> {
        match self {
            Self::Translation(way) if !way.iter().all(|v| v.is_finite()) || *way == [0.0; 3] => {
                Some("a translation of finite numbers, not all zero, is needed")
            }
            Self::Rotation {
                centre,
                axis,
                angle_deg,
            } if !centre.iter().chain(axis).all(|v| v.is_finite())
                || unit(*axis) == [0.0; 3]
                || !angle_deg.is_finite()
                || *angle_deg == 0.0 =>
            {
                Some("a rotation needs a centre, an axis that is not zero and an angle that is not zero")
            }
            _ => None,
        }
    }
}
