//! The wall: patches of quadrilaterals.

use serde::Serialize;

/// The wetted surface.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SurfaceGrid {
    /// Patches of wall.
    pub patches: Vec<SurfacePatch>,
}

/// One patch of wall.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfacePatch {
    /// Name, unique in a recording.
    pub name: String,
    /// Nodes, m, where every motion coordinate is zero.
    pub nodes_m: Vec<[f64; 3]>,
    /// Nodes of every face, counted from 0; seen from the fluid they run counter-clockwise. A triangle repeats a node.
    pub faces: Vec<[u32; 4]>,
    /// Centroid of every face, m.
    pub centroids_m: Vec<[f64; 3]>,
    /// Area vector of every face, m^2, out of the body into the fluid.
    pub areas_m2: Vec<[f64; 3]>,
    /// True for faces of the upper side: their area vector has a positive z component.
    pub upper: Vec<bool>,
}

impl SurfacePatch {
    /// Makes a patch from nodes (m) and faces that run counter-clockwise as seen from the fluid. Area vectors are half
    /// the cross product of the diagonals, which is exact for the resultant of a uniform pressure whatever the warp of
    /// the face; centroids are those of the two triangles on either side of the first diagonal, weighted by their areas.
    ///
    /// Node numbers out of range give faces of no area at the origin; the writer refuses such a patch.
    #[must_use]
    pub fn new(name: impl Into<String>, nodes_m: Vec<[f64; 3]>, faces: Vec<[u32; 4]>) -> Self {
        let corners =
            |face: &[u32; 4]| -> [[f64; 3]; 4] { face.map(|n| nodes_m.get(n as usize).copied().unwrap_or_default()) };
        let areas_m2: Vec<[f64; 3]> = faces.iter().map(|f| area(&corners(f))).collect();
        Self {
            name: name.into(),
            centroids_m: faces.iter().map(|f| centroid(&corners(f))).collect(),
            upper: areas_m2.iter().map(|a| a[2] > 0.0).collect(),
            areas_m2,
            nodes_m,
            faces,
        }
    }

    /// Makes a patch from a rectangle of nodes, `node = i + (faces_i + 1) j`, with faces in the same order. Set `flip`
    /// where the cross product of the i and the j direction points into the body.
    #[must_use]
    pub fn structured(name: impl Into<String>, nodes_m: Vec<[f64; 3]>, size: [usize; 2], flip: bool) -> Self {
        let row = size[0] + 1;
        let mut faces = Vec::with_capacity(size[0] * size[1]);
        for j in 0..size[1] {
            for i in 0..size[0] {
                let at = |i: usize, j: usize| u32::try_from(i + row * j).unwrap_or(u32::MAX);
                let loop_ = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                faces.push(if flip {
                    [loop_[0], loop_[3], loop_[2], loop_[1]]
                } else {
                    loop_
                });
            }
        }
        Self::new(name, nodes_m, faces)
    }
}

impl SurfaceGrid {
    /// Number of faces of all patches.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.patches.iter().map(|p| p.faces.len()).sum()
    }

    /// Number of nodes of all patches.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.patches.iter().map(|p| p.nodes_m.len()).sum()
    }

    /// Smallest and largest coordinates of the nodes, m; none without nodes.
    #[must_use]
    pub fn extent_m(&self) -> Option<[[f64; 3]; 2]> {
        let mut nodes = self.patches.iter().flat_map(|p| &p.nodes_m);
        let first = *nodes.next()?;
        let mut extent = [first, first];
        for node in nodes {
            for d in 0..3 {
                extent[0][d] = extent[0][d].min(node[d]);
                extent[1][d] = extent[1][d].max(node[d]);
            }
        }
        Some(extent)
    }
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn area(c: &[[f64; 3]; 4]) -> [f64; 3] {
    cross(sub(c[2], c[0]), sub(c[3], c[1])).map(|v| 0.5 * v)
}

fn centroid(c: &[[f64; 3]; 4]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let mut weight = 0.0;
    for [a, b, d] in [[c[0], c[1], c[2]], [c[0], c[2], c[3]]] {
        let w = cross(sub(b, a), sub(d, a)).map(|v| v * v).iter().sum::<f64>().sqrt();
        weight += w;
        for k in 0..3 {
            sum[k] += w * (a[k] + b[k] + d[k]) / 3.0;
        }
    }
    if weight > 0.0 {
        sum.map(|v| v / weight)
    } else {
        // A face of no area is a line or a point: the mean of its corners is as good as any.
        std::array::from_fn(|k| 0.25 * (c[0][k] + c[1][k] + c[2][k] + c[3][k]))
    }
}
