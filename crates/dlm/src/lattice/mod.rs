//! Where the lattice is: surfaces cut into boxes, strips of boxes along the stream, symmetry planes.
//!
//! Lengths are in any one unit (SI in Dip's own cases, the deck's own in a deck); nothing here depends on which.

mod check;
mod surface;

pub use check::{Finding, FindingKind, Severity, boxes_per_wavelength};
pub use surface::{ControlSurface, Divisions, Surface};

use crate::hash::Fnv128;

/// Most boxes of a lattice: a matrix of 20 GB. Beyond it a typing error is likelier than a wish.
const MAX_BOXES: usize = 35_000;

/// What is wrong with the description of a lattice.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LatticeError {
    /// No surface was given.
    #[error("the lattice has no surface: at least one is needed")]
    Empty,
    /// A division list is not usable.
    #[error("surface {surface}, {direction} division: {reason}")]
    Divisions {
        /// Surface's name.
        surface: String,
        /// "chordwise" or "spanwise".
        direction: &'static str,
        /// What was needed and what was got.
        reason: String,
    },
    /// The surface has no area, a negative chord or a coordinate that is not finite.
    #[error("surface {surface}: {reason}")]
    Shape {
        /// Surface's name.
        surface: String,
        /// What was needed and what was got.
        reason: String,
    },
    /// More boxes than a matrix can be held for.
    #[error(
        "the lattice has {boxes} boxes, more than {limit}: its matrix alone would take {gigabytes:.0} GB; use fewer divisions"
    )]
    TooMany {
        /// Boxes asked for.
        boxes: usize,
        /// Most boxes.
        limit: usize,
        /// Memory of one matrix.
        gigabytes: f64,
    },
    /// A control surface names a box that does not exist, or its hinge line is a point.
    #[error("control surface {name}: {reason}")]
    Control {
        /// Control surface's name.
        name: String,
        /// What was needed and what was got.
        reason: String,
    },
}

/// How the flow and the loads repeat across a plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PlaneSymmetry {
    /// The plane is not there: only the given surfaces exist.
    #[default]
    None,
    /// The mirror image moves and is loaded as a mirror shows it: the plane acts as a wall (a half model of a symmetric
    /// motion in y = 0; ground effect in z = 0).
    Symmetric,
    /// The mirror image moves and is loaded opposite to what a mirror shows.
    Antisymmetric,
}

impl PlaneSymmetry {
    /// Weight of the image: 0, +1 or -1.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Symmetric => 1.0,
            Self::Antisymmetric => -1.0,
        }
    }
}

/// One box of the lattice. The doublet line lies at its quarter chord, the normal wash is met at its three-quarter
/// chord, mid-span (the DLM's point of Albano and Rodden 1969).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeBox {
    /// Index of its surface.
    pub surface: usize,
    /// Label: the surface's first label plus the position in the surface.
    pub id: u32,
    /// Position along the chord, 0 at the leading edge.
    pub chord_index: usize,
    /// Position along the span, 0 at edge 1.
    pub span_index: usize,
    /// Corners: leading edge 1, leading edge 2, trailing edge 2, trailing edge 1.
    pub corners: [[f64; 3]; 4],
    /// Doublet line's end on edge 1 (quarter chord).
    pub doublet_1: [f64; 3],
    /// Doublet line's end on edge 2.
    pub doublet_2: [f64; 3],
    /// Point where the lift acts: quarter chord, mid-span.
    pub force_point: [f64; 3],
    /// Mid-chord, mid-span.
    pub mid_chord: [f64; 3],
    /// Control point: three-quarter chord, mid-span.
    pub control_point: [f64; 3],
    /// Unit normal (0, -sin dihedral, cos dihedral).
    pub normal: [f64; 3],
    /// Chord at mid-span.
    pub chord: f64,
    /// Width across the stream.
    pub width: f64,
    /// Area, chord times width.
    pub area: f64,
    /// Cosine of the dihedral angle.
    pub cos_dihedral: f64,
    /// Sine of the dihedral angle.
    pub sin_dihedral: f64,
}

/// Boxes one behind the other: one y, z, width and dihedral for all of them. The kernel's y-z geometry is shared by a
/// pair of strips, which is where the speed of the assembly comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strip {
    /// First box; the strip holds `first .. first + count`.
    pub first: usize,
    /// Number of boxes.
    pub count: usize,
    /// Index of the surface.
    pub surface: usize,
    /// Mid-span y.
    pub y: f64,
    /// Mid-span z.
    pub z: f64,
    /// Half width (the kernel's e).
    pub half_width: f64,
    /// Cosine of the dihedral angle.
    pub cos_dihedral: f64,
    /// Sine of the dihedral angle.
    pub sin_dihedral: f64,
}

/// The lattice: surfaces, boxes (chordwise fastest, then spanwise, then by surface), strips, controls and symmetry.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    surfaces: Vec<Surface>,
    boxes: Vec<LatticeBox>,
    strips: Vec<Strip>,
    /// Control surfaces.
    controls: Vec<ControlSurface>,
    /// Symmetry about the plane y = 0.
    pub symmetry_y: PlaneSymmetry,
    /// Symmetry about the plane z = 0.
    pub symmetry_z: PlaneSymmetry,
}

impl Lattice {
    /// Cuts the surfaces into boxes. `symmetry_y` is about the plane y = 0.
    ///
    /// # Errors
    /// A surface without area, with a negative chord or unusable divisions. Rules of good practice are not errors: ask
    /// [`Lattice::check`].
    pub fn new(surfaces: Vec<Surface>, symmetry_y: PlaneSymmetry) -> Result<Self, LatticeError> {
        if surfaces.is_empty() {
            return Err(LatticeError::Empty);
        }
        let count = surfaces
            .iter()
            .map(|s| s.chordwise.count().saturating_mul(s.spanwise.count()))
            .fold(0, usize::saturating_add);
        if count > MAX_BOXES {
            let gigabytes = 16e-9 * (count as f64).powi(2);
            return Err(LatticeError::TooMany {
                boxes: count,
                limit: MAX_BOXES,
                gigabytes,
            });
        }
        let mut boxes = Vec::new();
        let mut strips = Vec::new();
        for (index, surface) in surfaces.iter().enumerate() {
            cut(index, surface, &mut boxes, &mut strips)?;
        }
        Ok(Self {
            surfaces,
            boxes,
            strips,
            controls: Vec::new(),
            symmetry_y,
            symmetry_z: PlaneSymmetry::None,
        })
    }

    /// Adds symmetry about the plane z = 0 (symmetric: a wall such as the ground).
    #[must_use]
    pub fn with_symmetry_z(mut self, symmetry_z: PlaneSymmetry) -> Self {
        self.symmetry_z = symmetry_z;
        self
    }

    /// Adds a control surface and returns its index.
    ///
    /// # Errors
    /// A box index that does not exist, no boxes, or a hinge line of no length.
    pub fn add_control(&mut self, control: ControlSurface) -> Result<usize, LatticeError> {
        let fail = |reason: String| LatticeError::Control {
            name: control.name.clone(),
            reason,
        };
        if control.boxes.is_empty() {
            return Err(fail("it has no boxes".into()));
        }
        if let Some(b) = control.boxes.iter().find(|b| **b >= self.boxes.len()) {
            return Err(fail(format!(
                "box index {b} is not in the lattice of {} boxes",
                self.boxes.len()
            )));
        }
        let length = distance(control.hinge[0], control.hinge[1]);
        if !(length.is_finite() && length > 0.0) {
            return Err(fail(format!(
                "its hinge line needs two different points, got length {length}"
            )));
        }
        self.controls.push(control);
        Ok(self.controls.len() - 1)
    }

    /// Boxes in order.
    pub fn boxes(&self) -> &[LatticeBox] {
        &self.boxes
    }

    /// Number of boxes.
    pub fn n_boxes(&self) -> usize {
        self.boxes.len()
    }

    /// Strips in order.
    pub fn strips(&self) -> &[Strip] {
        &self.strips
    }

    /// Surfaces in order.
    pub fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }

    /// Control surfaces in order of their addition.
    pub fn controls(&self) -> &[ControlSurface] {
        &self.controls
    }

    /// Indices of the boxes of a surface.
    pub fn surface_boxes(&self, surface: usize) -> std::ops::Range<usize> {
        let mut range = 0..0;
        for strip in self.strips.iter().filter(|s| s.surface == surface) {
            if range.is_empty() {
                range = strip.first..strip.first;
            }
            range.end = strip.first + strip.count;
        }
        range
    }

    /// Total area of the boxes given (images not counted).
    pub fn area(&self) -> f64 {
        self.boxes.iter().map(|b| b.area).sum()
    }

    /// A 128-bit hash of all that the influence coefficients depend on: box geometry, interference groups, symmetry.
    /// Equal geometry gives equal bits on every machine.
    pub fn geometry_hash(&self) -> u128 {
        let mut hash = Fnv128::new();
        let mut add = |bytes: &[u8]| hash.add(bytes);
        add(&[self.symmetry_y.sign() as i8 as u8, self.symmetry_z.sign() as i8 as u8]);
        add(&(self.boxes.len() as u64).to_le_bytes());
        for b in &self.boxes {
            for point in [b.doublet_1, b.doublet_2, b.control_point] {
                for x in point {
                    // Both zeros are one place.
                    add(&(x + 0.0).to_le_bytes());
                }
            }
            add(&b.chord.to_le_bytes());
            add(&self.surfaces[b.surface].interference_group.to_le_bytes());
        }
        hash.value()
    }
}

/// Distance of two points.
pub(crate) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)).sqrt()
}

fn midpoint(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])]
}

fn cut(
    index: usize,
    surface: &Surface,
    boxes: &mut Vec<LatticeBox>,
    strips: &mut Vec<Strip>,
) -> Result<(), LatticeError> {
    let shape = |reason: String| LatticeError::Shape {
        surface: surface.name.clone(),
        reason,
    };
    let (a, b) = (surface.leading_edge_1, surface.leading_edge_2);
    let (c1, c2) = (surface.chord_1, surface.chord_2);
    if a.iter().chain(&b).chain([&c1, &c2]).any(|x| !x.is_finite()) {
        return Err(shape("a coordinate or chord is not a finite number".into()));
    }
    if c1 < 0.0 || c2 < 0.0 || c1 + c2 == 0.0 {
        return Err(shape(format!(
            "chords must be positive (one may be zero), got {c1} and {c2}"
        )));
    }
    let (dy, dz) = (b[1] - a[1], b[2] - a[2]);
    let span = dy.hypot(dz);
    if span <= 1e-9 * (c1 + c2) {
        return Err(shape(format!(
            "its width across the stream is {span}: boxes would have no area"
        )));
    }
    let (cos, sin) = (dy / span, dz / span);
    let chord_stations = surface.chordwise.stations(&surface.name, "chordwise")?;
    let span_stations = surface.spanwise.stations(&surface.name, "spanwise")?;
    let edge = |eta: f64| -> ([f64; 3], f64) {
        let at = |i: usize| a[i] + eta * (b[i] - a[i]);
        ([at(0), at(1), at(2)], c1 + eta * (c2 - c1))
    };
    let n_chord = chord_stations.len() - 1;
    for (j, eta) in span_stations.windows(2).enumerate() {
        let (lead_1, chord_1) = edge(eta[0]);
        let (lead_2, chord_2) = edge(eta[1]);
        let lead = midpoint(lead_1, lead_2);
        let chord = 0.5 * (chord_1 + chord_2);
        let half_width = 0.5 * span * (eta[1] - eta[0]);
        strips.push(Strip {
            first: boxes.len(),
            count: n_chord,
            surface: index,
            y: lead[1],
            z: lead[2],
            half_width,
            cos_dihedral: cos,
            sin_dihedral: sin,
        });
        for (i, xi) in chord_stations.windows(2).enumerate() {
            let on = |(lead, chord): ([f64; 3], f64), part: f64| {
                [lead[0] + chord * (xi[0] + part * (xi[1] - xi[0])), lead[1], lead[2]]
            };
            let (one, two, mid) = ((lead_1, chord_1), (lead_2, chord_2), (lead, chord));
            let box_chord = chord * (xi[1] - xi[0]);
            boxes.push(LatticeBox {
                surface: index,
                id: surface.first_box_id.saturating_add((j * n_chord + i) as u32),
                chord_index: i,
                span_index: j,
                corners: [on(one, 0.0), on(two, 0.0), on(two, 1.0), on(one, 1.0)],
                doublet_1: on(one, 0.25),
                doublet_2: on(two, 0.25),
                force_point: on(mid, 0.25),
                mid_chord: on(mid, 0.5),
                control_point: on(mid, 0.75),
                normal: [0.0, -sin, cos],
                chord: box_chord,
                width: 2.0 * half_width,
                area: box_chord * 2.0 * half_width,
                cos_dihedral: cos,
                sin_dihedral: sin,
            });
        }
    }
    Ok(())
}
