//! The motion of the boxes in a shape that is known on the wall only: displacements of the wall's nodes, as recorded for every
//! motion that is not rigid.
//!
//! Displacements along the sheet's normal are linear on triangles of the projected faces; the two sides of a wing are
//! averaged. The slope along the stream is the difference over two fifths of the box's chord about the point, inside of the
//! box: exact for a displacement that is linear in x, second order otherwise.

use super::sheet::{Sheet, sheets};
use dip_dlm::gaf::PointRule;
use dip_dlm::lattice::{Lattice, PlaneSymmetry};
use dip_dlm::motion::BoxMotion;
use dip_record::SurfaceGrid;

/// Half of the length over which the slope is taken, as a part of the box's chord.
const REACH: f64 = 0.2;

/// A triangle of the projected wall: corners (x, s), and the displacement along the sheet's normal there, m per unit.
struct Triangle {
    corners: [[f64; 2]; 3],
    normal_m: [f64; 3],
    upper: bool,
    /// Least and largest x and s.
    bounds: [f64; 4],
}

impl Triangle {
    fn new(corners: [[f64; 2]; 3], normal_m: [f64; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let doubled = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        let longest = [[a, b], [b, c], [c, a]]
            .iter()
            .map(|[p, q]| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2))
            .fold(0.0, f64::max);
        // A face seen edge-on says nothing of the slope.
        (doubled.abs() > 1e-9 * longest).then(|| Self {
            corners,
            normal_m,
            upper: doubled > 0.0,
            bounds: [
                a[0].min(b[0]).min(c[0]),
                a[0].max(b[0]).max(c[0]),
                a[1].min(b[1]).min(c[1]),
                a[1].max(b[1]).max(c[1]),
            ],
        })
    }

    /// Barycentric coordinates of a point.
    fn weights(&self, p: [f64; 2]) -> [f64; 3] {
        let [a, b, c] = self.corners;
        let cross = |u: [f64; 2], v: [f64; 2]| u[0] * v[1] - u[1] * v[0];
        let to = |q: [f64; 2], r: [f64; 2]| [r[0] - q[0], r[1] - q[1]];
        let all = cross(to(a, b), to(a, c));
        let second = cross(to(a, p), to(a, c)) / all;
        let third = cross(to(a, b), to(a, p)) / all;
        [1.0 - second - third, second, third]
    }

    /// How far outside a point lies, in barycentric units; 0 inside.
    fn outside(&self, p: [f64; 2]) -> f64 {
        self.weights(p).iter().fold(0.0, |m, w| f64::max(m, -w))
    }

    fn value(&self, p: [f64; 2]) -> f64 {
        self.weights(p).iter().zip(self.normal_m).map(|(w, h)| w * h).sum()
    }

    fn distance2(&self, p: [f64; 2]) -> f64 {
        let [x0, x1, s0, s1] = self.bounds;
        let dx = (x0 - p[0]).max(p[0] - x1).max(0.0);
        let ds = (s0 - p[1]).max(p[1] - s1).max(0.0);
        dx * dx + ds * ds
    }
}

/// The motion of the boxes for a unit of a recorded coordinate, whose wall nodes move by `shape_m` `[patch][node][x, y, z]`, m.
///
/// None if the shape does not belong to the surface's nodes, or one side of the wall is nowhere near the boxes.
#[must_use]
pub fn box_motion(
    surface: &SurfaceGrid,
    shape_m: &[Vec<[f64; 3]>],
    half_model: bool,
    lattice: &Lattice,
    rule: PointRule,
) -> Option<BoxMotion> {
    let fits = shape_m.len() == surface.patches.len()
        && surface
            .patches
            .iter()
            .zip(shape_m)
            .all(|(patch, nodes)| patch.nodes_m.len() == nodes.len());
    if !fits {
        return None;
    }
    let sheets = sheets(lattice);
    let half_lattice = lattice.symmetry_y != PlaneSymmetry::None;
    let mut triangles: Vec<Vec<Triangle>> = sheets.iter().map(|_| Vec::new()).collect();
    for (patch, nodes) in surface.patches.iter().zip(shape_m) {
        for face in &patch.faces {
            let corner = |n: &u32| {
                let n = *n as usize;
                Some((*patch.nodes_m.get(n)?, *nodes.get(n)?))
            };
            let own: Option<Vec<_>> = face.iter().map(corner).collect();
            let own = own?;
            let mirror = |([x, y, z], [u, v, w]): ([f64; 3], [f64; 3])| ([x, -y, z], [u, -v, w]);
            let image: Vec<_> = own.iter().rev().map(|c| mirror(*c)).collect();
            push(&mut triangles, &sheets, &own);
            // Boxes on the other side of a half model see its image.
            if half_model && !half_lattice {
                push(&mut triangles, &sheets, &image);
            }
        }
    }
    let sheet_of: Vec<usize> = (0..lattice.n_boxes())
        .map(|index| {
            let has = |s: &Sheet| s.strips.iter().any(|strip| strip.boxes.contains(&index));
            sheets.iter().position(has).unwrap_or(0)
        })
        .collect();
    if sheet_of.iter().any(|s| {
        [false, true]
            .iter()
            .any(|upper| !triangles[*s].iter().any(|t| t.upper == *upper))
    }) {
        return None;
    }
    let mut motion = BoxMotion::empty(lattice.n_boxes());
    motion.push_field(lattice, rule, |index, point| {
        let sheet = sheet_of[index];
        let ([x, s], _) = sheets[sheet].project(point);
        let step = REACH * lattice.boxes()[index].chord;
        let at = |x: f64| displacement(&triangles[sheet], [x, s]);
        (at(x), (at(x + step) - at(x - step)) / (2.0 * step))
    });
    Some(motion)
}

/// Adds a face, as a fan about its first corner, to the sheet that it lies nearest to.
fn push(triangles: &mut [Vec<Triangle>], sheets: &[Sheet], corners: &[([f64; 3], [f64; 3])]) {
    let n = corners.len().max(1) as f64;
    let centre: [f64; 3] = std::array::from_fn(|d| corners.iter().map(|c| c.0[d]).sum::<f64>() / n);
    let nearest =
        (0..sheets.len()).min_by(|a, b| sheets[*a].distance2(centre).total_cmp(&sheets[*b].distance2(centre)));
    let Some(sheet) = nearest else { return };
    let normal = sheets[sheet].normal;
    let flat: Vec<([f64; 2], f64)> = corners
        .iter()
        .map(|(p, u)| (sheets[sheet].project(*p).0, (0..3).map(|d| normal[d] * u[d]).sum()))
        .collect();
    for pair in flat.get(1..).unwrap_or_default().windows(2) {
        let all = [flat[0], pair[0], pair[1]];
        triangles[sheet].extend(Triangle::new(all.map(|c| c.0), all.map(|c| c.1)));
    }
}

/// Mean over the two sides at a point; of the nearest triangle where none covers it.
fn displacement(triangles: &[Triangle], p: [f64; 2]) -> f64 {
    let side = |upper: bool| {
        let mut best: Option<(f64, f64, &Triangle)> = None;
        for t in triangles.iter().filter(|t| t.upper == upper) {
            let far = t.distance2(p);
            if best.is_some_and(|(d, _, _)| far > d) {
                continue;
            }
            let rank = (far, t.outside(p));
            if best.is_none_or(|(d, o, _)| rank < (d, o)) {
                best = Some((rank.0, rank.1, t));
            }
        }
        best.map_or(0.0, |(_, _, t)| t.value(p))
    };
    0.5 * (side(false) + side(true))
}
