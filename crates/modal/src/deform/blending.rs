//! Displacement of a point off the wall: rigid with the wall beside it, the wall's mean far away, nothing at the far
//! boundary.

use nalgebra::Vector3;

/// A node of the wall that a displacement hangs on.
#[derive(Debug, Clone)]
pub(crate) struct Anchor {
    pub position: Vector3<f64>,
    /// The wall's area that belongs to it.
    pub area: f64,
    /// Walls that stay where they are only pull: the blending counts from those that move.
    pub moves: bool,
    /// Displacement and rotation `[mode]`.
    pub motion: Vec<[Vector3<f64>; 2]>,
}

/// The field `u(x) = psi(d) sum_i w_i [u_i + theta_i x (x - x_i)] / sum_i w_i`, `w_i = A_i (r_i^2 + R^2) / r_i^5`,
/// `r_i = |x - x_i|`, d the distance to the nearest node that moves.
///
/// Rigid motion about every node and inverse-distance weights of two powers are those of E. Luke, E. Collins and E. Blades,
/// J. Comput. Phys. 231 (2012) 586-601: the fifth power holds the layers near the wall to their own node (their spacing
/// and their angle to the wall are kept to the order of (r/h)^5 of the node spacing h), the third lets the far field
/// follow the mean. R, half the wall's size, parts the two. psi falls from one at the wall to zero at the reach D, as
/// `1 - t^3 (10 - 15 t + 6 t^2)`, t = d/D, flat at both ends.
///
/// Anchors far from x are summed in groups (J. Barnes, P. Hut, Nature 324, 1986): a group whose radius is less than
/// [`OPENING`] of its distance counts as one anchor with the mean of its motions. The work for a point grows with the
/// logarithm of the number of anchors.
#[derive(Debug)]
pub(crate) struct Blending {
    groups: Vec<Group>,
    /// Anchors in the order of the groups: position, area, whether it moves.
    anchors: Vec<(Vector3<f64>, f64, bool)>,
    /// `[anchor][mode][u - theta x x_i, theta]`: the rigid motion as a map of x, six numbers.
    maps: Vec<f64>,
    /// The same for groups: means over their area.
    means: Vec<f64>,
    width: usize,
    size_squared: f64,
    reach: f64,
}

/// Radius over distance below which a group counts as one anchor.
const OPENING: f64 = 0.2;
/// Anchors of a group that is not divided.
const LEAF: usize = 8;

#[derive(Debug)]
struct Group {
    centre: Vector3<f64>,
    radius: f64,
    area: f64,
    moves: bool,
    /// Anchors `first..end`.
    first: usize,
    end: usize,
    /// The two parts; none for a leaf.
    parts: Option<[usize; 2]>,
}

impl Blending {
    /// `size`: R; `reach`: D.
    pub fn new(anchors: &[Anchor], size: f64, reach: f64) -> Self {
        let modes = anchors.first().map_or(0, |a| a.motion.len());
        let mut order: Vec<usize> = (0..anchors.len()).collect();
        let mut blending = Self {
            groups: Vec::new(),
            anchors: Vec::new(),
            maps: Vec::new(),
            means: Vec::new(),
            width: 6 * modes,
            size_squared: size * size,
            reach,
        };
        blending.divide(anchors, &mut order, 0);
        for &n in &order {
            let a = &anchors[n];
            blending.anchors.push((a.position, a.area, a.moves));
            for [u, theta] in &a.motion {
                let origin = u - theta.cross(&a.position);
                blending
                    .maps
                    .extend([origin.x, origin.y, origin.z, theta.x, theta.y, theta.z]);
            }
        }
        for group in &blending.groups {
            let mut mean = vec![0.0; blending.width];
            for n in group.first..group.end {
                let share = blending.anchors[n].1 / group.area;
                for (sum, value) in mean.iter_mut().zip(&blending.maps[n * blending.width..]) {
                    *sum += share * value;
                }
            }
            blending.means.extend(mean);
        }
        blending
    }

    /// Makes the group of the anchors `order`, which begin at `first` in the final order; returns its number.
    fn divide(&mut self, anchors: &[Anchor], order: &mut [usize], first: usize) -> usize {
        let number = self.groups.len();
        let area: f64 = order
            .iter()
            .map(|&n| anchors[n].area)
            .sum::<f64>()
            .max(f64::MIN_POSITIVE);
        let centre = order
            .iter()
            .map(|&n| anchors[n].position * anchors[n].area)
            .sum::<Vector3<f64>>()
            / area;
        let distance = |n: &usize| (anchors[*n].position - centre).norm();
        self.groups.push(Group {
            centre,
            radius: order.iter().map(distance).fold(0.0, f64::max),
            area,
            moves: order.iter().any(|&n| anchors[n].moves),
            first,
            end: first + order.len(),
            parts: None,
        });
        if order.len() > LEAF {
            let spread = |d: usize| {
                let (lo, hi) = order.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), &n| {
                    (lo.min(anchors[n].position[d]), hi.max(anchors[n].position[d]))
                });
                hi - lo
            };
            let axis = (0..3).fold(0, |best, d| if spread(d) > spread(best) { d } else { best });
            // The number breaks ties, so that the groups are the same in every run.
            order.sort_by(|&a, &b| {
                let of = |n: usize| anchors[n].position[axis];
                of(a).total_cmp(&of(b)).then(a.cmp(&b))
            });
            let half = order.len() / 2;
            let (low, high) = order.split_at_mut(half);
            let low = self.divide(anchors, low, first);
            let high = self.divide(anchors, high, first + half);
            self.groups[number].parts = Some([low, high]);
        }
        number
    }

    /// Displacements `[mode]` of `x`, which is on no anchor.
    pub fn at(&self, x: &Vector3<f64>) -> Vec<Vector3<f64>> {
        let mut sums = vec![0.0; self.width];
        let mut total = 0.0;
        let mut add = |position: &Vector3<f64>, area: f64, map: &[f64]| {
            // Kept off zero, so that a point on an anchor takes the anchor's motion instead of a quotient of infinities.
            let r2 = (x - position).norm_squared().max(1e-24 * self.size_squared);
            let weight = area * (r2 + self.size_squared) / (r2 * r2 * r2.sqrt());
            total += weight;
            for (sum, value) in sums.iter_mut().zip(map) {
                *sum += weight * value;
            }
        };
        let mut open = vec![0];
        while let Some(number) = open.pop() {
            let group = &self.groups[number];
            if group.radius < OPENING * (x - group.centre).norm() {
                add(&group.centre, group.area, &self.means[number * self.width..]);
            } else if let Some(parts) = group.parts {
                open.extend(parts);
            } else {
                for n in group.first..group.end {
                    let (position, area, _) = &self.anchors[n];
                    add(position, *area, &self.maps[n * self.width..]);
                }
            }
        }
        let t = (self.distance(x) / self.reach).min(1.0);
        let psi = 1.0 - t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
        sums.chunks_exact(6)
            .map(|s| (Vector3::new(s[0], s[1], s[2]) + Vector3::new(s[3], s[4], s[5]).cross(x)) * (psi / total))
            .collect()
    }

    /// Distance of `x` to the nearest anchor that moves.
    fn distance(&self, x: &Vector3<f64>) -> f64 {
        let mut nearest = f64::INFINITY;
        let mut open = vec![0];
        while let Some(number) = open.pop() {
            let group = &self.groups[number];
            if !group.moves || (x - group.centre).norm() - group.radius >= nearest {
                continue;
            }
            if let Some([a, b]) = group.parts {
                let to = |n: usize| (x - self.groups[n].centre).norm();
                // The nearer part last: it is looked at first.
                open.extend(if to(a) < to(b) { [b, a] } else { [a, b] });
            } else {
                for (position, _, moves) in &self.anchors[group.first..group.end] {
                    if *moves {
                        nearest = nearest.min((x - position).norm());
                    }
                }
            }
        }
        nearest
    }
}
