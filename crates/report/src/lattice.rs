//! A value on every box of a lattice, as colours over the planform.

use crate::chart::{Chart, ColorBar, Patch};
use crate::error::ReportError;
use crate::palette::{self, ColorMap};

/// Corners of a box [corner][x, y] in order round it, m.
pub type BoxCorners = [[f64; 2]; 4];

/// Boxes coloured by `values[box]` (span to the right, aft down), with a scale of colours; the boxes in `marked` get a
/// black rim and their number and value. A diverging map is symmetric about zero. Boxes whose value is not finite are
/// grey, and the scale says how many there are.
///
/// # Errors
/// [`ReportError::Shape`] unless there is one value for every box and every marked box exists.
pub fn lattice(
    title: impl Into<String>,
    boxes: &[BoxCorners],
    values: &[f64],
    value_label: &str,
    map: ColorMap,
    marked: &[usize],
) -> Result<Chart, ReportError> {
    let title = title.into();
    let wrong = |what: String, needed, got| {
        Err(ReportError::Shape {
            figure: title.clone(),
            what,
            needed,
            got,
        })
    };
    if values.len() != boxes.len() {
        return wrong("the list of values (one per box)".to_owned(), boxes.len(), values.len());
    }
    let polygon = |corners: &BoxCorners| corners.iter().map(|c| (c[1], c[0])).collect::<Vec<_>>();
    let (from, to) = bounds(values, map);
    let mut chart = Chart::new(title.clone(), "y, m", "x, m").invert_y().equal_scale();
    for (corners, value) in boxes.iter().zip(values) {
        let fill = Some(map.at((value - from) / (to - from)));
        let rim = Some(("#ffffff".to_owned(), 0.5));
        chart.patches.push(Patch {
            polygons: vec![polygon(corners)],
            fill,
            rim,
        });
    }
    for &i in marked {
        let (Some(corners), Some(value)) = (boxes.get(i), values.get(i)) else {
            return wrong(format!("a lattice in which box {i} is marked"), i + 1, boxes.len());
        };
        // Black on white is seen on every colour of the maps.
        for (color, width_px) in [("#ffffff", 4.5), (palette::EXPERIMENT, 1.8)] {
            let rim = Some((color.to_owned(), width_px));
            chart.patches.push(Patch {
                polygons: vec![polygon(corners)],
                fill: None,
                rim,
            });
        }
        let middle = |axis: usize| 0.25 * corners.iter().map(|c| c[axis]).sum::<f64>();
        let written = crate::number::write_number(*value, crate::number::NumberFormat::Significant(3));
        chart = chart.annotate(
            middle(1),
            middle(0),
            format!("box {i}: {}", written.replace('-', "\u{2212}")),
        );
    }
    let missing = values.iter().filter(|v| !v.is_finite()).count();
    let label = if missing == 0 {
        value_label.to_owned()
    } else {
        format!("{value_label} (grey: {missing} boxes without)")
    };
    chart.color_bar = Some(ColorBar {
        label,
        from,
        to,
        map,
        bands: 0,
    });
    Ok(chart)
}

/// The `count` boxes whose values are farthest from `reference`, worst first; values that are not finite come first of
/// all.
#[must_use]
pub fn worst_boxes(values: &[f64], reference: f64, count: usize) -> Vec<usize> {
    let distance = |i: &usize| {
        let d = values.get(*i).map_or(f64::NAN, |v| (v - reference).abs());
        if d.is_nan() { f64::INFINITY } else { d }
    };
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| distance(b).total_cmp(&distance(a)).then(a.cmp(b)));
    order.truncate(count);
    order
}

/// Ends of the scale; never equal.
fn bounds(values: &[f64], map: ColorMap) -> (f64, f64) {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let (lo, hi) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    if lo > hi {
        return if map == ColorMap::Diverging {
            (-1.0, 1.0)
        } else {
            (0.0, 1.0)
        };
    }
    let size = lo.abs().max(hi.abs());
    let (lo, hi) = if map == ColorMap::Diverging {
        (-size, size)
    } else {
        (lo, hi)
    };
    if hi - lo > 1e-9 * size && hi - lo > 1e-290 {
        return (lo, hi);
    }
    let half = if size > 1e-280 { 0.5 * size } else { 0.5 };
    (lo - half, hi + half)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_are_found_and_what_is_no_number_is_worse() {
        assert_eq!(worst_boxes(&[1.0, 4.0, f64::NAN, -1.0, 1.5], 1.0, 3), vec![2, 1, 3]);
    }

    #[test]
    fn the_scale_never_collapses() {
        for values in [&[][..], &[0.0], &[3.0, 3.0], &[f64::NAN], &[1e-300]] {
            for map in [ColorMap::Sequential, ColorMap::Diverging] {
                let (from, to) = bounds(values, map);
                assert!(from < to, "{values:?}");
            }
        }
    }
}
