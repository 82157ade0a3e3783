//! Pictures of grids as SVG: surfaces and sections, as in a paper.

mod overview;

use std::fmt::Write;

pub use overview::overview;

use crate::block::Block;
use crate::face::Face;
use crate::topology::{MultiBlock, Patch};
use crate::vector::{cross, dot, sub, unit};

/// A named picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Short name for a file: `surface`, `symmetry`, `nose`, ...
    pub name: String,
    /// The SVG text.
    pub svg: String,
}

/// An index surface of a block: all nodes with one index fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sheet {
    /// Index of the block.
    pub block: usize,
    /// The fixed direction, 0 = i.
    pub axis: usize,
    /// The node index.
    pub at: usize,
    /// Node ranges (from, to inclusive) of the other two directions, ascending.
    pub range: [[usize; 2]; 2],
}

impl Sheet {
    /// The whole sheet.
    #[must_use]
    pub fn whole(block: usize, of: &Block, axis: usize, at: usize) -> Self {
        let n = of.cells();
        let [a, b] = Face::new(axis, false).directions();
        Self {
            block,
            axis,
            at,
            range: [[0, n[a]], [0, n[b]]],
        }
    }

    fn patch(patch: &Patch, of: &Block) -> Self {
        let axis = patch.face.axis();
        let at = if patch.face.is_max() { of.cells()[axis] } else { 0 };
        let w = patch.window;
        Self {
            block: patch.block,
            axis,
            at,
            range: [[w.lo[0], w.hi[0]], [w.lo[1], w.hi[1]]],
        }
    }

    fn point(&self, of: &Block, p: usize, q: usize) -> [f64; 3] {
        match self.axis {
            0 => of.point(self.at, p, q),
            1 => of.point(p, self.at, q),
            _ => of.point(p, q, self.at),
        }
    }
}

/// How space is seen: the eye looks along `right x up` from the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Direction to the right of the picture.
    pub right: [f64; 3],
    /// Direction up in the picture.
    pub up: [f64; 3],
}

impl Camera {
    /// From starboard: x right, z up.
    pub const SIDE: Self = Self {
        right: [1.0, 0.0, 0.0],
        up: [0.0, 0.0, 1.0],
    };
    /// From above: y right, x down (the nose is at the top).
    pub const TOP: Self = Self {
        right: [0.0, 1.0, 0.0],
        up: [-1.0, 0.0, 0.0],
    };
    /// From the front: y right (seen from ahead, starboard drawn right), z up.
    pub const FRONT: Self = Self {
        right: [0.0, 1.0, 0.0],
        up: [0.0, 0.0, 1.0],
    };

    fn see(&self, p: [f64; 3]) -> [f64; 2] {
        [dot(p, self.right), dot(p, self.up)]
    }
}

/// Draws the grid lines of `sheets` inside `window` (`[right from, to, up from, to]` in the grid's unit). Sheets in
/// `solid` are filled and shaded, far ones first.
#[must_use]
pub fn draw(
    grid: &MultiBlock,
    title: &str,
    camera: Camera,
    window: [f64; 4],
    sheets: &[Sheet],
    solid: &[Sheet],
) -> String {
    let [x0, x1, y0, y1] = window;
    let width = 900.0;
    let size = width / (x1 - x0);
    let height = (y1 - y0) * size;
    let at = |p: [f64; 3]| {
        let [x, y] = camera.see(p);
        [(x - x0) * size, (y1 - y) * size]
    };
    let mut out = String::new();
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {:.0}\" width=\"{width}\" height=\"{:.0}\" font-family=\"sans-serif\">",
        height + 30.0,
        height + 30.0
    );
    let _ = writeln!(
        out,
        "<title>{}</title><rect width=\"100%\" height=\"100%\" fill=\"white\"/>",
        escape(title)
    );
    let _ = writeln!(
        out,
        "<clipPath id=\"c\"><rect width=\"{width}\" height=\"{height:.1}\"/></clipPath><g clip-path=\"url(#c)\">"
    );
    fill(&mut out, grid, camera, solid, &at, [width, height]);
    let _ = write!(out, "<path fill=\"none\" stroke=\"#1a3a6b\" stroke-width=\"0.5\" d=\"");
    for sheet in sheets {
        let Some(block) = grid.blocks.get(sheet.block) else {
            continue;
        };
        let [[p0, p1], [q0, q1]] = sheet.range;
        for q in q0..=q1 {
            let line = (p0..=p1).map(|p| at(sheet.point(block, p, q)));
            polyline(&mut out, line, [width, height]);
        }
        for p in p0..=p1 {
            let line = (q0..=q1).map(|q| at(sheet.point(block, p, q)));
            polyline(&mut out, line, [width, height]);
        }
    }
    let _ = writeln!(out, "\"/></g>");
    let _ = writeln!(
        out,
        "<text x=\"6\" y=\"{:.0}\" font-size=\"14\">{}  (width {:.4})</text></svg>",
        height + 20.0,
        escape(title),
        x1 - x0
    );
    out
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Appends the pieces of a line that touch the picture.
fn polyline(out: &mut String, line: impl Iterator<Item = [f64; 2]>, size: [f64; 2]) {
    let margin = 40.0;
    let mut last: Option<[f64; 2]> = None;
    let mut drawing = false;
    for p in line {
        if let Some(l) = last {
            let apart = (0..2).any(|d| l[d].max(p[d]) < -margin || l[d].min(p[d]) > size[d] + margin);
            if apart || !(p[0].is_finite() && p[1].is_finite()) {
                drawing = false;
            } else {
                if !drawing {
                    let _ = write!(out, "M{:.2} {:.2}", l[0], l[1]);
                    drawing = true;
                }
                let _ = write!(out, "L{:.2} {:.2}", p[0], p[1]);
            }
        }
        last = Some(p);
    }
}

fn fill(
    out: &mut String,
    grid: &MultiBlock,
    camera: Camera,
    solid: &[Sheet],
    at: &dyn Fn([f64; 3]) -> [f64; 2],
    size: [f64; 2],
) {
    let eye = cross(camera.right, camera.up);
    let mut quads: Vec<(f64, String)> = Vec::new();
    for sheet in solid {
        let Some(block) = grid.blocks.get(sheet.block) else {
            continue;
        };
        let [[p0, p1], [q0, q1]] = sheet.range;
        for q in q0..q1 {
            for p in p0..p1 {
                let corners = [(p, q), (p + 1, q), (p + 1, q + 1), (p, q + 1)].map(|(p, q)| sheet.point(block, p, q));
                let seen = corners.map(at);
                if (0..2).any(|d| seen.iter().all(|s| s[d] < 0.0) || seen.iter().all(|s| s[d] > size[d])) {
                    continue;
                }
                let normal = unit(cross(sub(corners[2], corners[0]), sub(corners[3], corners[1])));
                let light = unit([
                    eye[0] + 0.3 * camera.up[0],
                    eye[1] + 0.3 * camera.up[1],
                    eye[2] + 0.3 * camera.up[2],
                ]);
                let shade = (150.0 + 90.0 * dot(normal, light).abs()) as u32;
                let depth = corners.iter().map(|&c| dot(c, eye)).sum();
                let mut path = String::new();
                for (n, s) in seen.iter().enumerate() {
                    let _ = write!(path, "{}{:.2} {:.2}", if n == 0 { 'M' } else { 'L' }, s[0], s[1]);
                }
                quads.push((
                    depth,
                    format!(
                        "<path d=\"{path}Z\" fill=\"rgb({shade},{shade},{})\"/>",
                        shade.min(225) + 15
                    ),
                ));
            }
        }
    }
    quads.sort_by(|a, b| a.0.total_cmp(&b.0));
    let _ = writeln!(out, "<g stroke=\"#333\" stroke-width=\"0.35\">");
    for (_, quad) in quads {
        let _ = writeln!(out, "{quad}");
    }
    let _ = writeln!(out, "</g>");
}
