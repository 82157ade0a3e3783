//! Mode shapes: displacement over the planform with node lines, and the bent mesh seen obliquely.

use crate::chart::{Chart, ColorBar, Patch, Series};
use crate::contour::{self, Field};
use crate::error::ReportError;
use crate::palette::ColorMap;
use std::collections::BTreeMap;

/// A surface mesh; x aft, y starboard, z up.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Coordinates [node][x, y, z], m.
    pub nodes: Vec<[f64; 3]>,
    /// Nodes of each element in order round it (three or more).
    pub elements: Vec<Vec<usize>>,
}

/// Bands of colour; even, so that zero is an edge between two.
const BANDS: usize = 16;

impl Mesh {
    fn check(&self, title: &str, values: usize) -> Result<(), ReportError> {
        let wrong = |what: &str, needed, got| ReportError::Shape {
            figure: title.to_owned(),
            what: what.to_owned(),
            needed,
            got,
        };
        if self.elements.is_empty() {
            return Err(ReportError::Empty {
                figure: title.to_owned(),
                what: "the list of elements",
            });
        }
        if values != self.nodes.len() {
            return Err(wrong("the displacement (one per node)", self.nodes.len(), values));
        }
        for (i, element) in self.elements.iter().enumerate() {
            if element.len() < 3 {
                return Err(wrong(&format!("element {i}"), 3, element.len()));
            }
            if let Some(&node) = element.iter().find(|n| **n >= self.nodes.len()) {
                return Err(wrong(
                    &format!("a mesh whose element {i} names node {node}"),
                    node + 1,
                    self.nodes.len(),
                ));
            }
        }
        Ok(())
    }

    /// The rim: edges that belong to one element only, joined.
    fn outline(&self) -> Vec<Vec<usize>> {
        let mut count: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        for element in &self.elements {
            for e in contour::edges(element) {
                *count.entry(e).or_default() += 1;
            }
        }
        let rim: Vec<(usize, usize)> = count.into_iter().filter(|(_, n)| *n == 1).map(|(e, _)| e).collect();
        contour::chain(&rim)
    }

    /// Triangles about the middle of each element (so that no diagonal is preferred), seen in the planform.
    fn field(&self, z: &[f64]) -> Field {
        let mut points: Vec<(f64, f64)> = self.nodes.iter().map(|n| (n[1], n[0])).collect();
        let mut values = z.to_vec();
        let mut triangles = Vec::new();
        for element in &self.elements {
            if let &[a, b, c] = element.as_slice() {
                triangles.push([a, b, c]);
                continue;
            }
            let (mut u, mut v, mut w) = (0.0, 0.0, 0.0);
            let part = 1.0 / element.len() as f64;
            for &n in element {
                u += part * points[n].0;
                v += part * points[n].1;
                w += part * values[n];
            }
            let middle = points.len();
            points.push((u, v));
            values.push(w);
            triangles.extend(
                element
                    .iter()
                    .zip(element.iter().cycle().skip(1))
                    .map(|(&a, &b)| [a, b, middle]),
            );
        }
        Field {
            points,
            values,
            triangles,
        }
    }
}

/// Colours from -largest to +largest, and that largest (1 where everything is zero).
fn symmetric_bar(values: impl Iterator<Item = f64>, label: &str) -> (ColorBar, f64) {
    let largest = values.filter(|v| v.is_finite()).fold(0.0_f64, |m, v| m.max(v.abs()));
    let largest = if largest > 1e-290 { largest } else { 1.0 };
    let bar = ColorBar {
        label: label.to_owned(),
        from: -largest,
        to: largest,
        map: ColorMap::Diverging,
        bands: BANDS,
    };
    (bar, largest)
}

/// Displacement `z[node]` over the planform (span to the right, aft down): bands of colour, node lines, outline.
/// `z_label` names the quantity with its unit. Elements with a node whose `z` is not finite stay white, and the colour
/// bar says so.
///
/// # Errors
/// [`ReportError::Shape`] and [`ReportError::Empty`] for arrays that do not fit the mesh.
pub fn mode_map(title: impl Into<String>, mesh: &Mesh, z: &[f64], z_label: &str) -> Result<Chart, ReportError> {
    let title = title.into();
    mesh.check(&title, z.len())?;
    let field = mesh.field(z);
    let missing = z.iter().filter(|v| !v.is_finite()).count();
    let label = if missing == 0 {
        z_label.to_owned()
    } else {
        format!("{z_label} (white: {missing} nodes without)")
    };
    let (bar, largest) = symmetric_bar(z.iter().copied(), &label);
    let mut chart = Chart::new(title, "y, m", "x, m").invert_y().equal_scale();
    for band in 0..BANDS {
        let at = |i: usize| largest * (2.0 * i as f64 / BANDS as f64 - 1.0);
        let polygons = field.band(at(band), at(band + 1));
        if !polygons.is_empty() {
            let fill = Some(bar.map.at((band as f64 + 0.5) / BANDS as f64));
            chart.patches.push(Patch {
                polygons,
                fill,
                rim: None,
            });
        }
    }
    for line in mesh.outline() {
        let points = line.iter().map(|&n| (mesh.nodes[n][1], mesh.nodes[n][0])).collect();
        chart = chart.series(Series::line("", points).color("#333333"));
    }
    for line in field.zero_lines() {
        chart = chart.series(Series::dashed("node line", line).color("#000000"));
    }
    chart.color_bar = Some(bar);
    Ok(chart)
}

/// The bent mesh seen obliquely from behind and above, coloured by z, over the unbent one in grey. `displacement`
/// [node][x, y, z] is drawn magnified so that its largest is a fifth of the mesh's size, or by `magnification`.
///
/// # Errors
/// As [`mode_map`].
pub fn mode_view(
    title: impl Into<String>,
    mesh: &Mesh,
    displacement: &[[f64; 3]],
    magnification: Option<f64>,
) -> Result<Chart, ReportError> {
    let title = title.into();
    mesh.check(&title, displacement.len())?;
    let length = |d: &[f64; 3]| d.iter().map(|c| c * c).sum::<f64>().sqrt();
    let largest = displacement
        .iter()
        .map(length)
        .filter(|l| l.is_finite())
        .fold(0.0_f64, f64::max);
    let mut size = [0.0; 3];
    for (i, size) in size.iter_mut().enumerate() {
        let (lo, hi) = mesh
            .nodes
            .iter()
            .fold((f64::MAX, f64::MIN), |(a, b), n| (a.min(n[i]), b.max(n[i])));
        *size = hi - lo;
    }
    let by = magnification.unwrap_or(if largest > 0.0 {
        0.2 * length(&size) / largest
    } else {
        0.0
    });
    let bent: Vec<[f64; 3]> = mesh
        .nodes
        .iter()
        .zip(displacement)
        .map(|(n, d)| [n[0] + by * d[0], n[1] + by * d[1], n[2] + by * d[2]])
        .collect();
    let (bar, bound) = symmetric_bar(displacement.iter().map(|d| d[2]), "");
    let corners = |nodes: &[[f64; 3]], element: &[usize]| element.iter().map(|&n| project(nodes[n]).0).collect();
    let flat = mesh.elements.iter().map(|e| corners(&mesh.nodes, e)).collect();
    let mut chart = Chart {
        title,
        equal_scale: true,
        bare: true,
        ..Chart::default()
    };
    chart.x.label = "view from behind, span to the right".to_owned();
    chart.y.label = "bent and unbent mesh".to_owned();
    chart.patches.push(Patch {
        polygons: flat,
        fill: None,
        rim: Some(("#b5b5b5".to_owned(), 0.7)),
    });
    // Far elements first, near ones over them.
    let mut order: Vec<(f64, usize)> = mesh
        .elements
        .iter()
        .enumerate()
        .map(|(i, e)| (e.iter().map(|&n| project(bent[n]).1).sum::<f64>() / e.len() as f64, i))
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for (_, i) in order {
        let element = &mesh.elements[i];
        let mean = element.iter().map(|&n| displacement[n][2]).sum::<f64>() / element.len() as f64;
        let fill = Some(bar.map.at(0.5 + 0.5 * mean / bound));
        let polygons = vec![corners(&bent, element)];
        chart.patches.push(Patch {
            polygons,
            fill,
            rim: Some(("#333333".to_owned(), 0.7)),
        });
    }
    Ok(chart)
}

/// Parallel projection: (right, up) on the paper, and nearness to the eye, which stands behind the trailing edge,
/// turned by 25 degrees and raised by 28.
fn project([x, y, z]: [f64; 3]) -> ((f64, f64), f64) {
    let (turn, raise) = (25f64.to_radians(), 28f64.to_radians());
    let near = x * turn.cos() - y * turn.sin();
    let right = y * turn.cos() + x * turn.sin();
    (
        (right, z * raise.cos() - near * raise.sin()),
        near * raise.cos() + z * raise.sin(),
    )
}
