//! Signed moments of plane polygons and their parts on either side of a line.

/// A point (x, s): along the stream and along the span of a sheet.
pub(crate) type Point = [f64; 2];

/// Signed area and first moment along x of a polygon, counter-clockwise positive in the (x, s) plane.
///
/// Both are integrals of the winding number, so parts cut by lines add up to the whole for any polygon, also for one that
/// crosses itself, as a face seen edge-on at a leading edge may.
pub(crate) fn moments(polygon: &[Point]) -> (f64, f64) {
    let (mut area, mut moment) = (0.0, 0.0);
    let Some(&origin) = polygon.first() else {
        return (0.0, 0.0);
    };
    // About the first corner: no cancellation far from the origin.
    let local = |p: &Point| [p[0] - origin[0], p[1] - origin[1]];
    for (p, q) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let (p, q) = (local(p), local(q));
        let cross = p[0] * q[1] - q[0] * p[1];
        area += cross;
        moment += cross * (p[0] + q[0]);
    }
    (0.5 * area, moment / 6.0 + 0.5 * area * origin[0])
}

/// Parts of a polygon where `side` (linear in the point) is negative and where it is not (Sutherland and Hodgman 1974).
pub(super) fn split(polygon: &[Point], side: impl Fn(Point) -> f64) -> (Vec<Point>, Vec<Point>) {
    let mut below = Vec::with_capacity(polygon.len() + 2);
    let mut above = Vec::with_capacity(polygon.len() + 2);
    for (&p, &q) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let (dp, dq) = (side(p), side(q));
        if dp < 0.0 {
            below.push(p);
        } else {
            above.push(p);
        }
        if (dp < 0.0) != (dq < 0.0) {
            let t = dp / (dp - dq);
            let cut = [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])];
            below.push(cut);
            above.push(cut);
        }
    }
    (below, above)
}

/// Whether a point lies in a polygon (even-odd rule).
pub(super) fn contains(polygon: &[Point], point: Point) -> bool {
    let mut inside = false;
    for (p, q) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let crosses = (p[1] > point[1]) != (q[1] > point[1]);
        if crosses && point[0] < p[0] + (point[1] - p[1]) / (q[1] - p[1]) * (q[0] - p[0]) {
            inside = !inside;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_a_square_and_its_parts() {
        let square = [[1.0, 0.0], [3.0, 0.0], [3.0, 2.0], [1.0, 2.0]];
        assert_eq!(moments(&square), (4.0, 8.0));
        let (low, high) = split(&square, |p| p[0] - 1.5);
        assert_eq!((moments(&low).0, moments(&high).0), (1.0, 3.0));
        assert!((moments(&low).1 + moments(&high).1 - 8.0).abs() < 1e-14);
        assert!(contains(&square, [2.0, 1.0]) && !contains(&square, [0.5, 1.0]));
    }

    #[test]
    fn a_crossed_quadrilateral_keeps_its_moments_when_cut() {
        let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.2], [0.1, 1.3]];
        let whole = moments(&bow);
        for at in [0.05, 0.3, 0.5, 0.77] {
            let (low, high) = split(&bow, |p| p[0] + 0.3 * p[1] - at);
            let (a, b) = (moments(&low), moments(&high));
            assert!((a.0 + b.0 - whole.0).abs() < 1e-15 && (a.1 + b.1 - whole.1).abs() < 1e-15);
        }
    }
}
