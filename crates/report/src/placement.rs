//! Finding places for legend, notes and labels where they cover no data.

use crate::trace::Rect;

/// What is already drawn in a plot.
#[derive(Default)]
pub(crate) struct Taken {
    /// Points along lines and markers, px.
    pub(crate) points: Vec<(f64, f64)>,
    /// Boxes of labels placed before.
    pub(crate) boxes: Vec<Rect>,
}

impl Taken {
    /// How much of what is drawn a box would cover: 0 for none.
    fn covered(&self, candidate: &Rect) -> usize {
        let points = self.points.iter().filter(|p| candidate.holds(**p)).count();
        let boxes = self.boxes.iter().filter(|b| b.overlaps(candidate)).count();
        points + 60 * boxes
    }

    /// The first candidate that covers least, and how much that is. Candidates that leave `plot` come last.
    pub(crate) fn best(&self, candidates: &[Rect], plot: &Rect) -> Option<(Rect, usize)> {
        let mut best: Option<(Rect, usize)> = None;
        for candidate in candidates {
            let outside = if plot.contains(candidate) { 0 } else { 1000 };
            let score = self.covered(candidate) + outside;
            if best.is_none_or(|(_, least)| score < least) {
                best = Some((*candidate, score));
            }
            if score == 0 {
                break;
            }
        }
        best
    }
}

/// Places for a legend of the given size: along the rim of the plot, corners first.
pub(crate) fn along_rim(plot: &Rect, w: f64, h: f64) -> Vec<Rect> {
    const GAP: f64 = 8.0;
    let at = |fx: f64, fy: f64| Rect {
        x: plot.x + GAP + fx * (plot.w - w - 2.0 * GAP),
        y: plot.y + GAP + fy * (plot.h - h - 2.0 * GAP),
        w,
        h,
    };
    let mut out = vec![at(1.0, 0.0), at(0.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
    for f in [0.5, 0.25, 0.75, 0.125, 0.375, 0.625, 0.875] {
        out.extend([at(1.0, f), at(0.0, f), at(f, 0.0), at(f, 1.0)]);
    }
    out
}

/// Places for a note of the given size round a point: near ones first.
fn around(p: (f64, f64), w: f64, h: f64) -> Vec<(f64, Rect)> {
    let mut out = Vec::new();
    for gap in [8.0, 20.0, 36.0, 56.0, 80.0, 110.0] {
        // The corners, west and east, above and below, and what lies between.
        for (fx, fy) in [
            (1.0, -0.7),
            (-1.0, -0.7),
            (1.0, 0.7),
            (-1.0, 0.7),
            (1.0, 0.0),
            (-1.0, 0.0),
            (0.0, -1.0),
            (0.0, 1.0),
            (0.4, -1.0),
            (-0.4, -1.0),
            (0.4, 1.0),
            (-0.4, 1.0),
        ] {
            let (cx, cy) = (p.0 + fx * (gap + 0.5 * w), p.1 + fy * (gap + 0.5 * h));
            out.push((
                gap,
                Rect {
                    x: cx - 0.5 * w,
                    y: cy - 0.5 * h,
                    w,
                    h,
                },
            ));
        }
    }
    out
}

/// The point of a box that is nearest to `p`.
pub(crate) fn foot(p: (f64, f64), place: &Rect) -> (f64, f64) {
    (p.0.clamp(place.x, place.right()), p.1.clamp(place.y, place.bottom()))
}

impl Taken {
    /// Place for a note at `p`: one that covers little, is near, and whose leader crosses no other label.
    pub(crate) fn best_note(&self, p: (f64, f64), w: f64, h: f64, plot: &Rect) -> Option<Rect> {
        let score = |gap: f64, place: &Rect| {
            let outside = if plot.contains(place) { 0.0 } else { 1000.0 };
            let mut leader = Vec::new();
            crate::trace::sample(p, foot(p, place), &mut leader);
            let others = self.boxes.iter().filter(|b| !b.holds(p));
            let crossed = others.filter(|b| leader.iter().any(|q| b.holds(*q))).count();
            4.0 * self.covered(place) as f64 + outside + 0.1 * gap + 30.0 * crossed as f64
        };
        let mut best: Option<(Rect, f64)> = None;
        for (gap, place) in around(p, w, h) {
            let score = score(gap, &place);
            if best.is_none_or(|(_, least)| score < least) {
                best = Some((place, score));
            }
        }
        best.map(|(place, _)| place)
    }
}

/// Places for a label along a vertical line (text turned upwards): top and bottom, left and right of it.
pub(crate) fn along_vertical(x: f64, plot: &Rect, length: f64, thickness: f64) -> Vec<Rect> {
    let rows = [
        plot.y + 5.0,
        plot.bottom() - length - 5.0,
        plot.y + 0.5 * (plot.h - length),
    ];
    rows.iter()
        .flat_map(|&y| {
            [x - thickness - 3.0, x + 3.0].map(|left| Rect {
                x: left,
                y,
                w: thickness,
                h: length,
            })
        })
        .collect()
}

/// Places for a label along a horizontal line: right and left end, above and below it.
pub(crate) fn along_horizontal(y: f64, plot: &Rect, length: f64, thickness: f64) -> Vec<Rect> {
    let columns = [
        plot.right() - length - 6.0,
        plot.x + 6.0,
        plot.x + 0.5 * (plot.w - length),
    ];
    columns
        .iter()
        .flat_map(|&x| {
            [y - thickness - 2.0, y + 2.0].map(|top| Rect {
                x,
                y: top,
                w: length,
                h: thickness,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_free_corner_is_found_and_a_full_plot_is_reported() {
        let plot = Rect {
            x: 0.0,
            y: 0.0,
            w: 300.0,
            h: 200.0,
        };
        let mut taken = Taken::default();
        crate::trace::sample((0.0, 200.0), (300.0, 0.0), &mut taken.points);
        let (place, score) = taken.best(&along_rim(&plot, 80.0, 40.0), &plot).unwrap();
        assert_eq!(score, 0);
        assert!(place.x < 50.0 && place.y < 50.0, "{place:?}");
        for i in 0..30 {
            crate::trace::sample(
                (0.0, f64::from(i) * 7.0),
                (300.0, f64::from(i) * 7.0),
                &mut taken.points,
            );
        }
        assert!(taken.best(&along_rim(&plot, 80.0, 40.0), &plot).unwrap().1 > 0);
    }
}
