//! From wall faces on both sides to lifting pressures on boxes.
//!
//! Every face is projected on the plane of the lattice's surface, (x along the stream, s along the span). Its normal force
//! over the dynamic pressure is -Cp times its signed projected area (upper faces positive area, lower ones negative), which
//! is exactly -Cp S.n for the recorded area vector S. The projection is cut by the lines of the boxes; a part's force
//! acts at the part's own centroid. Parts that overhang the planform belong to the nearest strip (round a tip) or to the
//! first or last box (ahead of the leading or aft of the trailing edge): nothing is lost.
//!
//! **Conservative** (default). A box gets the force F of its parts and their couple C = sum F_part (x_part - x_q) about its own
//! quarter chord x_q, where the lattice's force acts. The couple is carried by a pair of forces on the box and the one
//! behind it (on the last box: the one before it), so that
//!
//! ```text
//! sum of dCp area = sum of the parts' forces,   sum of dCp area x_q = sum of the parts' forces x_part
//! ```
//!
//! on every strip, to round-off. For a pressure that varies slowly over a box this is the pressure at its quarter chord by
//! linear interpolation, which is what the lattice's own box pressure stands for; a plain average belongs to the mid-chord,
//! and taking it for the other moves the lift forward by a quarter of a box.
//!
//! **Average**: F / area alone, lift kept, moment not. **Point**: the difference of the two faces over a point of the box at
//! mid-span, as in the thesis; keeps neither.

pub(crate) mod polygon;
pub mod shape;
mod sheet;

use crate::SampleError;
use dip_dlm::c64;
use dip_dlm::lattice::{Lattice, PlaneSymmetry};
use polygon::{Point, contains, moments, split};
use serde::{Deserialize, Serialize};
use sheet::{Sheet, sheets};

/// How pressures on faces become pressures on boxes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
    /// Area-weighted overlap that keeps lift and moment of every strip.
    #[default]
    Conservative,
    /// Area-weighted overlap: lift kept, moment not.
    Average,
    /// Values at one point of each box, at this fraction of its chord and mid-span.
    Point(f64),
}

/// A face of the wall.
#[derive(Clone, Debug, PartialEq)]
pub struct WallFace {
    /// Corners in order round the face, counter-clockwise seen from the fluid, m.
    pub corners_m: Vec<[f64; 3]>,
    /// Place of its pressure in the recorded list of all faces.
    pub source: usize,
}

impl WallFace {
    fn centroid(&self) -> [f64; 3] {
        let n = self.corners_m.len().max(1) as f64;
        std::array::from_fn(|d| self.corners_m.iter().map(|p| p[d]).sum::<f64>() / n)
    }
}

/// The wall, as far as it is recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// Faces of both sides.
    pub faces: Vec<WallFace>,
    /// True if only y >= 0 is there, y = 0 being a plane of symmetry.
    pub half_model: bool,
}

impl Wall {
    /// All faces of a recorded surface, in the order of its patches.
    #[must_use]
    pub fn recorded(surface: &dip_record::SurfaceGrid, half_model: bool) -> Self {
        let mut faces = Vec::with_capacity(surface.face_count());
        for patch in &surface.patches {
            for face in &patch.faces {
                let corners_m = face
                    .iter()
                    .map(|n| patch.nodes_m.get(*n as usize).copied().unwrap_or_default())
                    .collect();
                faces.push(WallFace {
                    corners_m,
                    source: faces.len(),
                });
            }
        }
        Self { faces, half_model }
    }

    /// Half a model beside its mirror image about y = 0, for a lattice of the whole wing. Images have the same pressures.
    #[must_use]
    pub fn with_image(&self) -> Self {
        let image = self.faces.iter().map(|f| WallFace {
            // The loop turns round in a mirror.
            corners_m: f.corners_m.iter().rev().map(|p| [p[0], -p[1], p[2]]).collect(),
            source: f.source,
        });
        Self {
            faces: self.faces.iter().cloned().chain(image).collect(),
            half_model: false,
        }
    }
}

/// Part of a face in one box.
#[derive(Clone, Copy, Debug)]
struct Part {
    face: usize,
    strip: usize,
    /// Signed projected area, m^2.
    area: f64,
    /// Its first moment along x, m^3.
    moment: f64,
}

/// A linear map from the pressures on faces to dCp on boxes.
#[derive(Clone, Debug)]
pub struct BoxMap {
    rule: Rule,
    /// Rows `[box]` of (source of the pressure, coefficient).
    rows: Vec<Vec<(usize, f64)>>,
    parts: Vec<Part>,
    sources: Vec<usize>,
    strips: usize,
    overhang: f64,
}

/// Lift and moment of every strip over the dynamic pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct StripLoads {
    /// Normal force, m^2.
    pub lift_m2: Vec<c64>,
    /// Moment of the normal force about x = 0, positive where the force lies aft, m^3.
    pub moment_m3: Vec<c64>,
}

impl BoxMap {
    /// Maps a wall on a lattice.
    ///
    /// # Errors
    /// A wall without faces, faces that are not finite, a box that no face covers, a wall and a lattice of which one has no
    /// image of the other.
    pub fn new(wall: &Wall, lattice: &Lattice, rule: Rule) -> Result<Self, SampleError> {
        if wall.faces.is_empty() {
            return Err(SampleError::NoFaces);
        }
        if let Some(face) = wall
            .faces
            .iter()
            .find(|f| f.corners_m.iter().flatten().any(|x| !x.is_finite()))
        {
            return Err(SampleError::NotFinite { face: face.source });
        }
        let least_y = lattice
            .boxes()
            .iter()
            .flat_map(|b| b.corners)
            .fold(f64::INFINITY, |m, c| m.min(c[1]));
        let size = lattice.boxes().iter().map(|b| b.chord).fold(0.0, f64::max);
        let half_lattice = lattice.symmetry_y != PlaneSymmetry::None;
        let whole = wall.half_model && least_y < -1e-6 * size;
        let with_image;
        let wall = if whole {
            with_image = wall.with_image();
            &with_image
        } else {
            wall
        };
        let sheets = sheets(lattice);
        let mut parts: Vec<Part> = Vec::new();
        let mut box_of: Vec<usize> = Vec::new();
        let (mut projected, mut outside) = (0.0, 0.0);
        for (index, face) in wall.faces.iter().enumerate() {
            let at = face.centroid();
            // A whole wall on half a lattice: the other side belongs to the image.
            if half_lattice && !wall.half_model && at[1] < 0.0 {
                continue;
            }
            let nearest = sheets.iter().min_by(|a, b| a.distance2(at).total_cmp(&b.distance2(at)));
            let Some(sheet) = nearest else { continue };
            let polygon: Vec<Point> = face.corners_m.iter().map(|p| sheet.project(*p).0).collect();
            cut(sheet, index, polygon, |part, at_box, beyond| {
                projected += part.area.abs();
                outside += beyond;
                parts.push(part);
                box_of.push(at_box);
            });
        }
        let sources: Vec<usize> = wall.faces.iter().map(|f| f.source).collect();
        let rows = match rule {
            Rule::Point(fraction) => points(wall, lattice, &sheets, fraction)?,
            Rule::Average | Rule::Conservative => overlaps(lattice, &parts, &box_of, &sources, rule)?,
        };
        Ok(Self {
            rule,
            rows,
            parts,
            sources,
            strips: lattice.strips().len(),
            overhang: if projected > 0.0 { outside / projected } else { 0.0 },
        })
    }

    /// The rule.
    #[must_use]
    pub fn rule(&self) -> Rule {
        self.rule
    }

    /// Part of the projected area of all faces that lies outside of the planform of the boxes.
    #[must_use]
    pub fn overhang(&self) -> f64 {
        self.overhang
    }

    /// dCp of every box from the pressure coefficients of all recorded faces.
    #[must_use]
    pub fn to_boxes(&self, cp: &[c64]) -> Vec<c64> {
        let value = |source: usize| cp.get(source).copied().unwrap_or(c64::new(f64::NAN, f64::NAN));
        self.rows
            .iter()
            .map(|row| row.iter().map(|(source, a)| value(*source) * *a).sum())
            .collect()
    }

    /// Lift and moment of every strip from the faces themselves.
    #[must_use]
    pub fn strip_loads_of_faces(&self, cp: &[c64]) -> StripLoads {
        let zero = c64::new(0.0, 0.0);
        let mut loads = StripLoads {
            lift_m2: vec![zero; self.strips],
            moment_m3: vec![zero; self.strips],
        };
        for part in &self.parts {
            let value = self
                .sources
                .get(part.face)
                .and_then(|s| cp.get(*s))
                .copied()
                .unwrap_or(zero);
            loads.lift_m2[part.strip] -= value * part.area;
            loads.moment_m3[part.strip] -= value * part.moment;
        }
        loads
    }
}

/// Lift and moment of every strip of dCp on boxes, each box's force at its quarter chord.
#[must_use]
pub fn strip_loads_of_boxes(lattice: &Lattice, dcp: &[c64]) -> StripLoads {
    let sum = |arm: bool| {
        let of_strip = |s: &dip_dlm::lattice::Strip| {
            let range = s.first..s.first + s.count;
            let boxes = lattice.boxes()[range.clone()].iter().zip(dcp.iter().skip(s.first));
            boxes
                .map(|(b, p)| p * (b.area * if arm { b.force_point[0] } else { 1.0 }))
                .sum()
        };
        lattice.strips().iter().map(of_strip).collect()
    };
    StripLoads {
        lift_m2: sum(false),
        moment_m3: sum(true),
    }
}

/// Cuts a face by the lines of a sheet; `take` gets each part, its box, and how much of its area lies outside of the planform.
fn cut(sheet: &Sheet, face: usize, polygon: Vec<Point>, mut take: impl FnMut(Part, usize, f64)) {
    let mut rest = polygon;
    let last_strip = sheet.strips.len().saturating_sub(1);
    for (index, strip) in sheet.strips.iter().enumerate() {
        if rest.len() < 3 {
            return;
        }
        let outer = strip.ends[1];
        let mut column = if index == last_strip || rest.iter().all(|p| p[1] < outer) {
            std::mem::take(&mut rest)
        } else if rest.iter().all(|p| p[1] >= outer) {
            continue;
        } else {
            let (inner, beyond) = split(&rest, |p| p[1] - outer);
            rest = beyond;
            inner
        };
        let width = strip.ends[1] - strip.ends[0];
        let line_at = |line: &[f64; 2], s: f64| line[0] + (s - strip.ends[0]) / width * (line[1] - line[0]);
        let (front, rear) = (strip.lines[0], strip.lines[strip.lines.len() - 1]);
        let mut give = |part: &[Point], at: usize| {
            let (area, moment) = moments(part);
            if area != 0.0 || moment != 0.0 {
                let edges: [&dyn Fn(Point) -> f64; 4] = [
                    &|p| p[1] - outer,
                    &|p| strip.ends[0] - p[1],
                    &|p| line_at(&front, p[1]) - p[0],
                    &|p| p[0] - line_at(&rear, p[1]),
                ];
                let slack = 1e-9 * width.abs();
                let crossed = edges.iter().filter(|edge| part.iter().any(|p| edge(*p) > slack));
                let within = crossed.fold(None, |kept: Option<Vec<Point>>, edge| {
                    Some(split(kept.as_deref().unwrap_or(part), edge).0)
                });
                let beyond = within.map_or(0.0, |within| area.abs() - moments(&within).0.abs());
                let part = Part {
                    face,
                    strip: strip.number,
                    area,
                    moment,
                };
                take(part, at, beyond.max(0.0));
            }
        };
        let inner_lines = &strip.lines[1..strip.lines.len() - 1];
        let mut at = strip.boxes.start;
        for line in inner_lines {
            if column.iter().all(|p| p[0] < line_at(line, p[1])) {
                break;
            }
            if column.iter().any(|p| p[0] < line_at(line, p[1])) {
                let (ahead, behind) = split(&column, |p| p[0] - line_at(line, p[1]));
                give(&ahead, at);
                column = behind;
            }
            at += 1;
        }
        give(&column, at);
    }
}

/// Rows of the rules that go by overlap.
fn overlaps(
    lattice: &Lattice,
    parts: &[Part],
    box_of: &[usize],
    sources: &[usize],
    rule: Rule,
) -> Result<Vec<Vec<(usize, f64)>>, SampleError> {
    let boxes = lattice.boxes();
    let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new(); boxes.len()];
    let mut covered = vec![[0.0_f64; 2]; boxes.len()];
    for (part, &at) in parts.iter().zip(box_of) {
        covered[at][usize::from(part.area > 0.0)] += part.area.abs();
        let source = sources[part.face];
        rows[at].push((source, -part.area / boxes[at].area));
        if rule == Rule::Average {
            continue;
        }
        // The couple about the quarter chord goes to the neighbour behind, on the last box to the one before; a strip of
        // one box has no neighbour and keeps its lift only.
        let strip = &lattice.strips()[part.strip];
        let neighbour = if at + 1 < strip.first + strip.count {
            at + 1
        } else if strip.count > 1 {
            at - 1
        } else {
            continue;
        };
        let quarter = boxes[at].force_point[0];
        let couple = -(part.moment - quarter * part.area) / (boxes[neighbour].force_point[0] - quarter);
        rows[neighbour].push((source, couple / boxes[neighbour].area));
        rows[at].push((source, -couple / boxes[at].area));
    }
    // A box that one side does not cover has no lifting pressure of its own.
    for (index, [lower, upper]) in covered.iter().enumerate() {
        for (side, area) in [("lower", lower), ("upper", upper)] {
            if *area < 0.05 * boxes[index].area {
                return Err(SampleError::Uncovered {
                    index,
                    side,
                    part: area / boxes[index].area,
                    at_m: boxes[index].mid_chord,
                });
            }
        }
    }
    Ok(rows.into_iter().map(gather).collect())
}

/// Adds up coefficients of the same face.
fn gather(mut row: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
    row.sort_by_key(|(source, _)| *source);
    row.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1 += next.1;
        }
        same
    });
    row
}

/// Source of the pressure, whether it is of the upper side, outline, and least and largest x and s.
type ProjectedFace = (usize, bool, Vec<Point>, [f64; 4]);

/// Rows of point sampling: lower minus upper face over the point.
fn points(
    wall: &Wall,
    lattice: &Lattice,
    sheets: &[Sheet],
    fraction: f64,
) -> Result<Vec<Vec<(usize, f64)>>, SampleError> {
    if !(0.0..=1.0).contains(&fraction) {
        return Err(SampleError::Fraction { fraction });
    }
    let mut rows = Vec::with_capacity(lattice.n_boxes());
    let mut projected: Vec<Vec<ProjectedFace>> = Vec::new();
    for sheet in sheets {
        let list = wall.faces.iter().filter_map(|face| {
            let polygon: Vec<Point> = face.corners_m.iter().map(|p| sheet.project(*p).0).collect();
            let (area, _) = moments(&polygon);
            let bounds = polygon.iter().fold(
                [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY],
                |b, p| [b[0].min(p[0]), b[1].max(p[0]), b[2].min(p[1]), b[3].max(p[1])],
            );
            (area != 0.0).then_some((face.source, area > 0.0, polygon, bounds))
        });
        projected.push(list.collect());
    }
    for (index, b) in lattice.boxes().iter().enumerate() {
        let half = 0.5 * (b.corners[0][0] + b.corners[1][0]);
        let at = [half + fraction * b.chord, b.mid_chord[1], b.mid_chord[2]];
        let sheet = sheets
            .iter()
            .position(|s| s.strips.iter().any(|strip| strip.boxes.contains(&index)));
        let sheet = sheet.unwrap_or(0);
        let point = sheets[sheet].project(at).0;
        let find = |upper: bool| {
            let side = || projected[sheet].iter().filter(move |f| f.1 == upper);
            let inside = side().find(|(_, _, polygon, b)| {
                point[0] >= b[0] && point[0] <= b[1] && point[1] >= b[2] && point[1] <= b[3] && contains(polygon, point)
            });
            inside.map(|f| f.0)
        };
        let row = [(false, 1.0), (true, -1.0)].map(|(upper, sign)| {
            find(upper).map(|source| (source, sign)).ok_or(SampleError::Uncovered {
                index,
                side: if upper { "upper" } else { "lower" },
                part: 0.0,
                at_m: at,
            })
        });
        rows.push(row.into_iter().collect::<Result<Vec<_>, _>>()?);
    }
    Ok(rows)
}
