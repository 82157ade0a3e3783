//! A wing: sections at span stations, ruled in between, closed at the tip.

use super::section::{GeometryError, Section};

/// How the thickness goes to zero at the tip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TipShape {
    /// A quarter of an ellipse.
    #[default]
    Rounded,
    /// A straight taper: the tip ends in a sharp edge.
    Tapered,
}

/// A section of the wing where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// Span coordinate.
    pub y: f64,
    /// Leading edge, x.
    pub x_le: f64,
    /// Leading edge, z.
    pub z_le: f64,
    /// Chord.
    pub chord: f64,
    /// Nose-up twist about the leading edge.
    pub twist_deg: f64,
    /// Unit-chord section.
    pub section: Section,
}

impl Station {
    /// Point `[x, z]` of the unit section turned by the twist, in chords from the leading edge.
    #[must_use]
    pub fn turned(&self, t: f64) -> [f64; 2] {
        self.turn(self.section.point(t))
    }

    /// Point at |t| of the sheet the section shrinks to at the tip (its camber line, see [`Section::camber`]), turned by
    /// the twist, in chords.
    #[must_use]
    pub fn camber_line(&self, t: f64) -> [f64; 2] {
        let (upper, lower) = (self.section.point(t.abs()), self.section.point(-t.abs()));
        self.turn([0.5 * (upper[0] + lower[0]), self.section.camber(t)])
    }

    /// A point of the unit section turned by the twist.
    #[must_use]
    pub fn turn(&self, p: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.twist_deg.to_radians().sin_cos();
        [p[0] * cos + p[1] * sin, p[1] * cos - p[0] * sin]
    }
}

/// Half a wing with the symmetry plane at its first station; the length unit is the user's.
#[derive(Clone, Debug, PartialEq)]
pub struct Wing {
    /// Stations, y rising; the surface between two is ruled along equal section parameter.
    pub stations: Vec<Station>,
    /// How the tip closes.
    pub tip: TipShape,
    /// Span over which it closes, inside the last station's y.
    pub tip_length: f64,
}

/// Place between two stations: weights of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Between {
    /// Index of the inner station; the outer is the next.
    pub inner: usize,
    /// Share of the outer station, 0 to 1.
    pub share: f64,
}

impl Wing {
    /// Checks that the stations make a wing.
    /// # Errors
    /// Says which station is wrong and what is needed.
    pub fn check(&self) -> Result<(), GeometryError> {
        let fail = |what: String| Err(GeometryError::Wing(what));
        if self.stations.len() < 2 {
            return fail(format!("at least two stations are needed, got {}", self.stations.len()));
        }
        for (n, s) in self.stations.iter().enumerate() {
            let numbers = [s.y, s.x_le, s.z_le, s.chord, s.twist_deg];
            if numbers.iter().any(|v| !v.is_finite()) || s.chord <= 0.0 {
                return fail(format!(
                    "station {}: finite numbers and a chord above zero are needed",
                    n + 1
                ));
            }
            if n > 0 && s.y <= self.stations[n - 1].y {
                return fail(format!(
                    "station {}: y must rise from station to station, got {} after {}",
                    n + 1,
                    s.y,
                    self.stations[n - 1].y
                ));
            }
            if s.section.gap().abs() > 1e-12 {
                return fail(format!(
                    "station {} ({}): the trailing edge is open by {:.3e} chord; wings need it closed (trailing_edge = \"closed\" or \"sharp\")",
                    n + 1,
                    s.section.name(),
                    s.section.gap()
                ));
            }
        }
        if !(self.tip_length > 0.0 && self.tip_length < self.tip_y() - self.root_y()) {
            return fail(format!(
                "tip_length must be above zero and below the span, got {}",
                self.tip_length
            ));
        }
        Ok(())
    }

    /// y of the symmetry plane.
    #[must_use]
    pub fn root_y(&self) -> f64 {
        self.stations[0].y
    }

    /// y of the tip.
    #[must_use]
    pub fn tip_y(&self) -> f64 {
        self.stations[self.stations.len() - 1].y
    }

    /// The stations y lies between; outside the wing, the end station.
    #[must_use]
    pub fn between(&self, y: f64) -> Between {
        let n = self.stations.len();
        let inner = self.stations.partition_point(|s| s.y <= y).clamp(1, n - 1) - 1;
        let (a, b) = (self.stations[inner].y, self.stations[inner + 1].y);
        Between {
            inner,
            share: ((y - a) / (b - a)).clamp(0.0, 1.0),
        }
    }

    /// Leading edge and chord `[x_le, z_le, chord]` at y. Beyond the tip the edges keep their direction at first and turn
    /// into the span direction within about a tip chord.
    #[must_use]
    pub fn planform(&self, y: f64) -> [f64; 3] {
        let at = self.between(y);
        let (a, b) = (&self.stations[at.inner], &self.stations[at.inner + 1]);
        let mix = |p: f64, q: f64| p + at.share * (q - p);
        let mut out = [mix(a.x_le, b.x_le), mix(a.z_le, b.z_le), mix(a.chord, b.chord)];
        let beyond = y - self.tip_y();
        if beyond > 0.0 {
            let slope = [b.x_le - a.x_le, b.z_le - a.z_le, b.chord - a.chord].map(|d| d / (b.y - a.y));
            // The chord may at most halve.
            let length = (b.chord * 0.5 / (-slope[2]).max(0.5)).min(b.chord);
            let gone = length * (1.0 - (-beyond / length).exp());
            for d in 0..3 {
                out[d] += slope[d] * gone;
            }
        }
        out
    }

    /// Share of the thickness left by the tip's closure at y: 1 inboard, 0 at the tip and beyond.
    #[must_use]
    pub fn closure(&self, y: f64) -> f64 {
        closure(self.tip, (y - (self.tip_y() - self.tip_length)) / self.tip_length)
    }

    /// Point `[x, y, z]` of the surface at y and section parameter t (1: upper trailing edge, -1: lower). In the tip's
    /// closure the section shrinks towards its camber line; beyond the tip only that is left.
    #[must_use]
    pub fn point(&self, y: f64, t: f64) -> [f64; 3] {
        let at = self.between(y);
        let [x_le, z_le, chord] = self.planform(y);
        let left = self.closure(y);
        let ruled = |station: &Station| {
            let (full, plate) = (station.turned(t), station.camber_line(t));
            if left == 1.0 {
                full
            } else {
                [0, 1].map(|d| plate[d] + left * (full[d] - plate[d]))
            }
        };
        let (a, b) = (&self.stations[at.inner], &self.stations[at.inner + 1]);
        let (pa, pb) = (ruled(a), ruled(b));
        let [wa, wb] = self.weights(at);
        [
            x_le + chord * (wa * pa[0] + wb * pb[0]),
            y,
            z_le + chord * (wa * pa[1] + wb * pb[1]),
        ]
    }

    /// Weights of the two stations' unit sections in the local unit section: a ruled surface mixes the true-size
    /// sections, so each counts with its chord.
    #[must_use]
    pub fn weights(&self, at: Between) -> [f64; 2] {
        let (a, b) = (
            self.stations[at.inner].chord * (1.0 - at.share),
            self.stations[at.inner + 1].chord * at.share,
        );
        [a / (a + b), b / (a + b)]
    }
}

/// Closure of a tip at `u`: 0 where the closure starts, 1 at the tip.
#[must_use]
pub(crate) fn closure(tip: TipShape, u: f64) -> f64 {
    if u <= 0.0 {
        return 1.0;
    }
    if u >= 1.0 {
        return 0.0;
    }
    match tip {
        TipShape::Rounded => (1.0 - u * u).sqrt(),
        TipShape::Tapered => 1.0 - u,
    }
}
