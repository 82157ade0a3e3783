//! An aerofoil section as a smooth curve, from a table of ordinates or a NACA formula.

use super::naca::Naca4;
use super::spline::Spline;

/// What is wrong with a geometry.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
pub enum GeometryError {
    /// Ordinates that do not make a section.
    #[error("section {name}: {what}")]
    Section {
        /// Name of the section.
        name: String,
        /// What is wrong, what is needed.
        what: String,
    },
    /// Stations that do not make a wing.
    #[error("wing: {0}")]
    Wing(String),
    /// A line of an ordinate file that cannot be read.
    #[error("{file}:{line}: {what}")]
    Ordinates {
        /// The file.
        file: String,
        /// Line number, from 1.
        line: usize,
        /// What is wrong, what is needed.
        what: String,
    },
}

/// What to do with a trailing edge that is not closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TrailingEdge {
    /// Leave the gap: the base becomes a wall.
    #[default]
    Blunt,
    /// Turn each surface about the nose (take a share of the gap proportional to x) so that the edge closes at x = 1.
    Closed,
    /// Prolong both surfaces until they meet and scale the chord back to one.
    Sharp,
}

/// A section of unit chord, nose at x = 0, in the plane x aft, z up.
///
/// The parameter t runs from 1 (upper trailing edge) over 0 (nose) to -1 (lower trailing edge) with x close to t^2. In
/// it a round nose is smooth: z = sqrt(2 r x) becomes z = sqrt(2 r) t.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    name: String,
    shape: Shape,
    /// Added to x and z of the upper (+) and lower (-) surface: `gap_taper * x`, used to close a trailing edge.
    gap_taper: [f64; 2],
    /// Chord of `shape` that is the unit chord (above one where a formula is prolonged).
    stretch: f64,
}

#[derive(Clone, Debug, PartialEq)]
enum Shape {
    Spline(Spline),
    Naca4(Naca4),
}

impl Section {
    /// NACA four-digit section from its digits (`"0012"`, `"2412"`), with the blunt trailing edge of the formula.
    /// # Errors
    /// If the digits are not four digits with a thickness above zero.
    pub fn naca4(digits: &str) -> Result<Self, GeometryError> {
        let formula = Naca4::new(digits).ok_or_else(|| GeometryError::Section {
            name: format!("NACA {digits}"),
            what: "four digits with a thickness are needed, for example 0012".into(),
        })?;
        Ok(Self {
            name: format!("NACA {digits}"),
            shape: Shape::Naca4(formula),
            gap_taper: [0.0; 2],
            stretch: 1.0,
        })
    }

    /// A symmetric section from x and half thickness, both in chords, x rising from 0 to 1.
    /// `nose_radius` (in chords) is met exactly where given; else the table decides.
    /// # Errors
    /// If there are fewer than five points, or x does not rise from 0 to 1, or a value is not finite.
    pub fn symmetric(
        name: &str,
        x: &[f64],
        half_thickness: &[f64],
        nose_radius: Option<f64>,
    ) -> Result<Self, GeometryError> {
        let mut points: Vec<[f64; 2]> = x.iter().zip(half_thickness).rev().map(|(&x, &z)| [x, z]).collect();
        points.extend(x.iter().zip(half_thickness).skip(1).map(|(&x, &z)| [x, -z]));
        Self::build(name, &points, nose_radius, x.len() == half_thickness.len())
    }

    /// A section from points that run from the upper trailing edge round the nose to the lower trailing edge (or the
    /// other way). They are shifted and scaled to the nose at x = 0 and unit chord; z keeps its zero.
    /// # Errors
    /// If there are fewer than five points, or a side is not single-valued in x, or a value is not finite.
    pub fn from_points(name: &str, points: &[[f64; 2]], nose_radius: Option<f64>) -> Result<Self, GeometryError> {
        Self::build(name, points, nose_radius, true)
    }

    fn build(
        name: &str,
        points: &[[f64; 2]],
        nose_radius: Option<f64>,
        equal_lengths: bool,
    ) -> Result<Self, GeometryError> {
        let fail = |what: String| GeometryError::Section {
            name: name.to_owned(),
            what,
        };
        if !equal_lengths {
            return Err(fail("as many half thicknesses as x values are needed".into()));
        }
        if points.len() < 5 {
            return Err(fail(format!("at least 5 points are needed, got {}", points.len())));
        }
        if points.iter().flatten().any(|v| !v.is_finite()) {
            return Err(fail("an ordinate is not a finite number".into()));
        }
        let mut points = points.to_vec();
        let nose = (0..points.len())
            .min_by(|&a, &b| points[a][0].total_cmp(&points[b][0]))
            .unwrap_or(0);
        let mean = |half: &[[f64; 2]]| half.iter().map(|p| p[1]).sum::<f64>() / half.len().max(1) as f64;
        let mut nose = nose;
        if mean(&points[..nose]) < mean(&points[nose + 1..]) {
            points.reverse();
            nose = points.len() - 1 - nose;
        }
        let x0 = points[nose][0];
        let chord = points[0][0].max(points[points.len() - 1][0]) - x0;
        if chord <= 0.0 || nose < 2 || nose + 2 >= points.len() {
            return Err(fail(
                "the points must run from one trailing edge round the nose to the other, with at least two points a side"
                    .into(),
            ));
        }
        let mut t = Vec::with_capacity(points.len());
        let mut z = Vec::with_capacity(points.len());
        for (n, p) in points.iter().enumerate() {
            let root = ((p[0] - x0) / chord).max(0.0).sqrt();
            t.push(if n < nose { root } else { -root });
            z.push(p[1] / chord);
        }
        if let Some(n) = (1..t.len()).find(|&n| t[n] >= t[n - 1]) {
            return Err(fail(format!(
                "x must fall steadily from the trailing edge to the nose and rise again; points {n} and {} ({}, {} and {}, {}) do not",
                n + 1,
                points[n - 1][0],
                points[n - 1][1],
                points[n][0],
                points[n][1]
            )));
        }
        // One side may end short of the other: both are taken to x = 1 along their last step.
        t.reverse();
        z.reverse();
        let slope = nose_radius.map(|r| (2.0 * r.max(0.0)).sqrt());
        let spline = Spline::new(t, z, slope);
        Ok(Self {
            name: name.to_owned(),
            shape: Shape::Spline(spline),
            gap_taper: [0.0; 2],
            stretch: 1.0,
        })
    }

    /// Name for messages.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Point `[x, z]` at parameter t, 1 (upper trailing edge) to -1 (lower).
    #[must_use]
    pub fn point(&self, t: f64) -> [f64; 2] {
        let root = self.stretch.sqrt();
        let [x, z] = match &self.shape {
            Shape::Spline(spline) => [t * t * self.stretch, spline.value(t * root)],
            Shape::Naca4(formula) => formula.point(t * root),
        };
        let (x, z) = (x / self.stretch, z / self.stretch);
        let share = x * t.signum();
        [x + self.gap_taper[0] * share, z + self.gap_taper[1] * share]
    }

    /// Thickness of the trailing edge in chords.
    #[must_use]
    pub fn gap(&self) -> f64 {
        self.point(1.0)[1] - self.point(-1.0)[1]
    }

    /// From the lower end of the trailing edge to the upper, `[x, z]` in chords. A thickness laid off normal to a mean
    /// line that falls ends further aft above than below.
    #[must_use]
    pub fn edge(&self) -> [f64; 2] {
        let (upper, lower) = (self.point(1.0), self.point(-1.0));
        [upper[0] - lower[0], upper[1] - lower[1]]
    }

    /// Takes what is open at the trailing edge from both surfaces, each in proportion to x.
    fn close(&mut self) {
        let sum = self.point(1.0)[0] + self.point(-1.0)[0];
        let open = self.edge();
        for (taper, open) in self.gap_taper.iter_mut().zip(open) {
            *taper -= open / sum;
        }
    }

    /// Mean line and half thickness `[z_mean, z_half]` at |t|.
    #[must_use]
    pub fn mean_and_half(&self, t: f64) -> [f64; 2] {
        let (u, l) = (self.point(t.abs())[1], self.point(-t.abs())[1]);
        [0.5 * (u + l), 0.5 * (u - l)]
    }

    /// Camber line at |t|: the mean of upper and lower surface, but without the part proportional to t at the nose.
    ///
    /// Where the foremost point is not the middle of the nose, the mean line starts like sqrt(x), at a right angle to the
    /// chord; a thin sheet along it could not be wrapped.
    #[must_use]
    pub fn camber(&self, t: f64) -> f64 {
        const REACH: f64 = 0.35;
        // One-sided, second order: what is left of the slope must be small against t at the nodes next to the nose.
        let h = 1e-4;
        let mean = |t: f64| self.mean_and_half(t)[0];
        let slope = (4.0 * mean(h) - mean(2.0 * h) - 3.0 * mean(0.0)) / (2.0 * h);
        mean(t) - slope * t.abs() * (-(t / REACH).powi(2)).exp()
    }

    /// True if the section is symmetric about z = 0 to `1e-9` chords.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        (0..=64).all(|n| self.mean_and_half(n as f64 / 64.0)[0].abs() < 1e-9)
    }

    /// Nose radius in chords: `z = sqrt(2 r) t` there.
    #[must_use]
    pub fn nose_radius(&self) -> f64 {
        let h = 1e-4;
        let slope = (self.point(h)[1] - self.point(-h)[1]) / (2.0 * h);
        0.5 * slope * slope
    }

    /// The section with its trailing edge treated. See [`TrailingEdge`].
    /// # Errors
    /// [`TrailingEdge::Sharp`] where the surfaces do not meet within a fifth of the chord.
    pub fn with_trailing_edge(mut self, treatment: TrailingEdge) -> Result<Self, GeometryError> {
        match treatment {
            TrailingEdge::Blunt => {}
            TrailingEdge::Closed => self.close(),
            TrailingEdge::Sharp => {
                let gap = |stretch: f64| {
                    let mut other = self.clone();
                    other.stretch = stretch;
                    other.gap()
                };
                if gap(1.0) > 0.0 {
                    let (mut lo, mut hi) = (1.0, 1.2);
                    if gap(hi) > 0.0 {
                        return Err(GeometryError::Section {
                            name: self.name,
                            what: "upper and lower surface do not meet within 0.2 chord behind the trailing edge; use \"closed\"".into(),
                        });
                    }
                    for _ in 0..60 {
                        let mid = 0.5 * (lo + hi);
                        if gap(mid) > 0.0 { lo = mid } else { hi = mid }
                    }
                    self.stretch = 0.5 * (lo + hi);
                }
                // What is left after bisection is round-off; take it away so that the edge is one point.
                self.close();
            }
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sharp NACA 0012 of the NASA Turbulence Modeling Resource (2DN00 page).
    #[test]
    fn sharp_naca0012_is_the_one_of_the_turbulence_modeling_resource() {
        let section = Section::naca4("0012")
            .unwrap()
            .with_trailing_edge(TrailingEdge::Sharp)
            .unwrap();
        assert!((section.stretch - 1.008930411365).abs() < 1e-9);
        for n in 0..=20 {
            let x = n as f64 / 20.0;
            let z = 0.594689181
                * (0.298222773 * x.sqrt() - 0.127125232 * x - 0.357907906 * x * x + 0.291984971 * x.powi(3)
                    - 0.105174606 * x.powi(4));
            assert!((section.point(x.sqrt())[1] - z).abs() < 2e-9, "{x}");
        }
    }

    #[test]
    fn a_table_of_an_analytic_section_gives_it_back() {
        let exact = Section::naca4("0012").unwrap();
        let x: Vec<f64> = (0..=60).map(|n| (n as f64 / 60.0).powi(2)).collect();
        let z: Vec<f64> = x.iter().map(|&x| exact.point(x.sqrt())[1]).collect();
        for radius in [None, Some(1.1019 * 0.0144)] {
            let section = Section::symmetric("table", &x, &z, radius).unwrap();
            // The formula's x term makes the curvature over t jump at the nose; a spline rounds that within a few points.
            for n in 0..=500 {
                let t = n as f64 / 500.0;
                let error = (section.point(t)[1] - exact.point(t)[1]).abs();
                assert!(error < 5e-6, "{t} {error:e}");
            }
            assert!((section.nose_radius() - exact.nose_radius()).abs() < 2e-4);
        }
    }

    /// Thickness laid off normal to a mean line that falls: the upper end lies further aft.
    #[test]
    fn closing_a_cambered_section_makes_its_edge_one_point() {
        for treatment in [TrailingEdge::Closed, TrailingEdge::Sharp] {
            let blunt = Section::naca4("4412").unwrap();
            assert!(blunt.edge()[0] > 1e-4, "{:?}", blunt.edge());
            let closed = blunt.with_trailing_edge(treatment).unwrap();
            assert!(closed.edge().iter().all(|v| v.abs() < 1e-15), "{:?}", closed.edge());
        }
    }

    #[test]
    fn closing_takes_the_gap_away_in_proportion_to_x() {
        let blunt = Section::naca4("0012").unwrap();
        let closed = blunt.clone().with_trailing_edge(TrailingEdge::Closed).unwrap();
        assert!((blunt.gap() - 0.00252).abs() < 1e-12);
        assert!(closed.gap().abs() < 1e-15);
        let taken = blunt.point(0.5f64.sqrt())[1] - closed.point(0.5f64.sqrt())[1];
        assert!((taken - 0.00063).abs() < 1e-12);
    }
}
