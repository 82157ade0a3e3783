//! Sheets: surfaces of the lattice that join edge to edge in one plane, with the strips across them.

use super::polygon::Point;
use dip_dlm::lattice::Lattice;

/// One plane part of the lattice.
pub(super) struct Sheet {
    /// A point of the plane.
    origin: [f64; 3],
    /// Unit vector along the span, (0, cos, sin) of the dihedral.
    along: [f64; 3],
    /// Unit normal (0, -sin, cos).
    pub(super) normal: [f64; 3],
    /// Strips in the order of the span.
    pub(super) strips: Vec<SheetStrip>,
}

/// A strip in the coordinates of its sheet.
pub(super) struct SheetStrip {
    /// Number of the strip in the lattice.
    pub(super) number: usize,
    /// Inner and outer end along the span.
    pub(super) ends: [f64; 2],
    /// Boxes, as in the lattice.
    pub(super) boxes: std::ops::Range<usize>,
    /// x of the chordwise lines at both ends, `[line][end]`, leading edge first: one more than boxes.
    pub(super) lines: Vec<[f64; 2]>,
}

impl Sheet {
    /// (x, s) of a point's projection, and its height over the plane.
    pub(super) fn project(&self, p: [f64; 3]) -> (Point, f64) {
        let d: [f64; 3] = std::array::from_fn(|i| p[i] - self.origin[i]);
        let dot = |v: &[f64; 3]| v.iter().zip(d).map(|(a, b)| a * b).sum::<f64>();
        ([p[0], dot(&self.along)], dot(&self.normal))
    }

    /// Square of the distance of a point from the sheet's strips.
    pub(super) fn distance2(&self, p: [f64; 3]) -> f64 {
        let ([x, s], height) = self.project(p);
        let outside = |v: f64, [a, b]: [f64; 2]| (a.min(b) - v).max(v - a.max(b)).max(0.0);
        let in_plane = self.strips.iter().map(|strip| {
            let at = ((s - strip.ends[0]) / (strip.ends[1] - strip.ends[0])).clamp(0.0, 1.0);
            let x_of = |line: &[f64; 2]| line[0] + at * (line[1] - line[0]);
            let chord = [x_of(&strip.lines[0]), x_of(&strip.lines[strip.lines.len() - 1])];
            outside(s, strip.ends).powi(2) + outside(x, chord).powi(2)
        });
        in_plane.fold(f64::INFINITY, f64::min) + height * height
    }
}

/// The sheets of a lattice.
pub(super) fn sheets(lattice: &Lattice) -> Vec<Sheet> {
    let surfaces = lattice.surfaces();
    let ends = |i: usize| [surfaces[i].leading_edge_1, surfaces[i].leading_edge_2];
    let direction = |i: usize| -> [f64; 3] {
        let [a, b] = ends(i);
        let (dy, dz) = (b[1] - a[1], b[2] - a[2]);
        let length = dy.hypot(dz);
        [0.0, dy / length, dz / length]
    };
    let near = |p: [f64; 3], q: [f64; 3], size: f64| (0..3).all(|d| (p[d] - q[d]).abs() <= 1e-9 * size);
    let joined = |i: usize, j: usize| {
        let size = surfaces[i].chord_1 + surfaces[i].chord_2 + surfaces[j].chord_1 + surfaces[j].chord_2;
        let parallel = near(direction(i), direction(j), 1.0);
        parallel && ends(i).iter().any(|p| ends(j).iter().any(|q| near(*p, *q, size)))
    };
    let mut sheet_of: Vec<usize> = (0..surfaces.len()).collect();
    for i in 0..surfaces.len() {
        for j in 0..i {
            if joined(i, j) {
                let (from, to) = (sheet_of[i], sheet_of[j]);
                sheet_of.iter_mut().filter(|s| **s == from).for_each(|s| *s = to);
            }
        }
    }
    let mut names = sheet_of.clone();
    names.sort_unstable();
    names.dedup();
    let make = |name: &usize| {
        let members: Vec<usize> = (0..surfaces.len()).filter(|s| sheet_of[*s] == *name).collect();
        let first = members.first().copied().unwrap_or(0);
        let along = direction(first);
        let mut sheet = Sheet {
            origin: surfaces[first].leading_edge_1,
            along,
            normal: [0.0, -along[2], along[1]],
            strips: Vec::new(),
        };
        for (number, strip) in lattice.strips().iter().enumerate() {
            if !members.contains(&strip.surface) {
                continue;
            }
            let boxes = &lattice.boxes()[strip.first..strip.first + strip.count];
            let mut lines: Vec<[f64; 2]> = boxes.iter().map(|b| [b.corners[0][0], b.corners[1][0]]).collect();
            let Some((front, rear)) = boxes.first().zip(boxes.last()) else {
                continue;
            };
            lines.push([rear.corners[3][0], rear.corners[2][0]]);
            let end = |corner: [f64; 3]| sheet.project(corner).0[1];
            let ends = [end(front.corners[0]), end(front.corners[1])];
            sheet.strips.push(SheetStrip {
                number,
                ends,
                boxes: strip.first..strip.first + strip.count,
                lines,
            });
        }
        sheet.strips.sort_by(|a, b| a.ends[0].total_cmp(&b.ends[0]));
        sheet
    };
    names.iter().map(make).collect()
}
