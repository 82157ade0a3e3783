//! Lifting surfaces: trapezoids whose edges lie along the stream, and how they are cut into boxes.

use super::LatticeError;

/// How an edge is divided: into equal parts, or at given fractions of its length.
#[derive(Clone, Debug, PartialEq)]
pub enum Divisions {
    /// This many equal parts.
    Equal(usize),
    /// The dividing stations as fractions of the edge, rising, from 0 to 1 (both included).
    Fractions(Vec<f64>),
}

impl Divisions {
    /// Number of intervals.
    pub fn count(&self) -> usize {
        match self {
            Self::Equal(n) => *n,
            Self::Fractions(f) => f.len().saturating_sub(1),
        }
    }

    /// Stations, `count() + 1` of them, from 0 to 1.
    pub(super) fn stations(&self, surface: &str, direction: &'static str) -> Result<Vec<f64>, LatticeError> {
        let wrong = |reason: String| LatticeError::Divisions {
            surface: surface.to_string(),
            direction,
            reason,
        };
        match self {
            Self::Equal(0) => Err(wrong("at least one box is needed, got 0".into())),
            Self::Equal(n) => Ok((0..=*n).map(|i| i as f64 / *n as f64).collect()),
            Self::Fractions(f) => {
                let (Some(&first), Some(&last)) = (f.first(), f.last()) else {
                    return Err(wrong("the list of fractions is empty".into()));
                };
                if f.len() < 2 || f.iter().any(|x| !x.is_finite()) {
                    return Err(wrong(format!("two or more finite fractions are needed, got {f:?}")));
                }
                if first.abs() > 1e-9 || (last - 1.0).abs() > 1e-9 {
                    return Err(wrong(format!("fractions must run from 0 to 1, got {first} to {last}")));
                }
                if let Some(w) = f.windows(2).find(|w| w[1] <= w[0]) {
                    return Err(wrong(format!("fractions must rise, got {} then {}", w[0], w[1])));
                }
                Ok(f.clone())
            }
        }
    }
}

/// A flat lifting surface: a trapezoid whose two side edges are parallel to the stream (x).
///
/// Edge 1 is the left one when one looks along +x with the surface's normal up: the normal is `x` cross the direction
/// from edge 1 to edge 2, so a wing described from the root out to starboard (or from the port tip to the starboard
/// tip) has its normal up, and a fin described from its foot upwards has its normal to port (-y).
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Name, used in messages.
    pub name: String,
    /// Label of the first box; the others count on, chordwise fastest.
    pub first_box_id: u32,
    /// Leading edge of edge 1, in the lattice's length unit.
    pub leading_edge_1: [f64; 3],
    /// Chord of edge 1 (may be zero for a delta's tip).
    pub chord_1: f64,
    /// Leading edge of edge 2.
    pub leading_edge_2: [f64; 3],
    /// Chord of edge 2.
    pub chord_2: f64,
    /// Division along the chord.
    pub chordwise: Divisions,
    /// Division along the span, from edge 1 to edge 2.
    pub spanwise: Divisions,
    /// Boxes influence each other only within the same group (Nastran's IGID).
    pub interference_group: u32,
}

impl Surface {
    /// A surface with equal divisions in interference group 1.
    pub fn trapezoid(
        name: &str,
        (leading_edge_1, chord_1): ([f64; 3], f64),
        (leading_edge_2, chord_2): ([f64; 3], f64),
        chordwise: usize,
        spanwise: usize,
    ) -> Self {
        Self {
            name: name.to_string(),
            first_box_id: 1,
            leading_edge_1,
            chord_1,
            leading_edge_2,
            chord_2,
            chordwise: Divisions::Equal(chordwise),
            spanwise: Divisions::Equal(spanwise),
            interference_group: 1,
        }
    }
}

/// Boxes that turn together about a hinge line.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlSurface {
    /// Name, used in messages.
    pub name: String,
    /// Indices of its boxes in the lattice.
    pub boxes: Vec<usize>,
    /// Two points of the hinge line. Positive deflection is trailing edge down (against the boxes' normal), whatever
    /// the order of the points.
    pub hinge: [[f64; 3]; 2],
}
