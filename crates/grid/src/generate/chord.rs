//! Where the nodes stand along a section, and its maps.

use super::conformal::{Conformal, MapError};
use super::spacing::two_sided;
use crate::geometry::{Section, Station, Wing};

/// Section parameters t of `n + 1` nodes from the nose (0) to the trailing edge (1), spaced by the arc length of the
/// upper surface: first step `nose`, last step `tail` (in chords).
pub(super) fn side(section: &Section, n: usize, nose: f64, tail: f64) -> Vec<f64> {
    const SAMPLES: usize = 4000;
    let mut arc = vec![0.0; SAMPLES + 1];
    for m in 1..=SAMPLES {
        let (p, q) = (
            section.point((m - 1) as f64 / SAMPLES as f64),
            section.point(m as f64 / SAMPLES as f64),
        );
        arc[m] = arc[m - 1] + (q[0] - p[0]).hypot(q[1] - p[1]);
    }
    let total = arc[SAMPLES];
    let mut t: Vec<f64> = two_sided(n, nose / total, tail / total)
        .into_iter()
        .map(|s| {
            let m = arc.partition_point(|&v| v <= s * total).clamp(1, SAMPLES);
            let f = (s * total - arc[m - 1]) / (arc[m] - arc[m - 1]);
            (m as f64 - 1.0 + f) / SAMPLES as f64
        })
        .collect();
    t[0] = 0.0;
    t[n] = 1.0;
    t
}

/// Section parameters of all wall nodes, upper trailing edge (1) to lower (-1), from those of one side.
pub(super) fn around(side: &[f64]) -> Vec<f64> {
    side.iter()
        .rev()
        .copied()
        .chain(side.iter().skip(1).map(|t| -t))
        .collect()
}

/// Which wrap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    C,
    O,
}

/// The maps of a station's unit section and of its camber line (a plate), with a of every wall node in both.
pub(super) struct StationMaps {
    pub(super) full: Conformal,
    pub(super) plate: Conformal,
    pub(super) full_a: Vec<f64>,
    pub(super) plate_a: Vec<f64>,
    /// At the tip, if its camber line is curved: the map of the straight line between its ends, with a of every node.
    pub(super) flat: Option<(Conformal, Vec<f64>)>,
    section: Section,
    twist_deg: f64,
}

impl StationMaps {
    /// `t` are the section parameters of the wall nodes. The trailing edge must be closed.
    pub(super) fn new(kind: Kind, station: &Station, t: &[f64]) -> Result<Self, MapError> {
        let section = &station.section;
        let full_curve = |t: f64| station.turned(t);
        let plate_curve = |t: f64| station.camber_line(t);
        let make = |curve: &dyn Fn(f64) -> [f64; 2], radius: f64| match kind {
            Kind::C => Conformal::c(section.name(), curve, radius),
            Kind::O => Conformal::o(section.name(), curve, radius),
        };
        let full = make(&full_curve, section.nose_radius())?;
        let plate = make(&plate_curve, 0.0)?;
        let full_a = t.iter().map(|&t| full.wall_parameter(full_curve(t), t)).collect();
        let plate_a = t.iter().map(|&t| plate.wall_parameter(plate_curve(t), t)).collect();
        Ok(Self {
            full,
            plate,
            full_a,
            plate_a,
            flat: None,
            section: section.clone(),
            twist_deg: station.twist_deg,
        })
    }

    /// Adds the map of the straight line between the ends of the camber line, if that is curved.
    fn add_flat(&mut self, kind: Kind, station: &Station, t: &[f64]) -> Result<(), MapError> {
        let flat = |t: f64| straight(station.camber_line(0.0), station.camber_line(1.0), t);
        let on_it = |&t: &f64| (0..2).all(|d| (station.camber_line(t)[d] - flat(t)[d]).abs() < 1e-9);
        if t.iter().all(on_it) {
            return Ok(());
        }
        let name = self.section.name();
        let map = match kind {
            Kind::C => Conformal::c(name, &flat, 0.0),
            Kind::O => Conformal::o(name, &flat, 0.0),
        }?;
        let a = t.iter().map(|&t| map.wall_parameter(flat(t), t)).collect();
        self.flat = Some((map, a));
        Ok(())
    }
}

/// The point at |t| of the straight line that stands for a camber line from `nose` to `tail`.
pub(super) fn straight(nose: [f64; 2], tail: [f64; 2], t: f64) -> [f64; 2] {
    [0, 1].map(|d| nose[d] + t * t * (tail[d] - nose[d]))
}

/// Share of the camber line's curvature that the sheet outboard of the tip has left, at a distance from it over the chord: a steep
/// camber line would fold the long cells at its nose.
pub(super) fn curved(beyond: f64) -> f64 {
    (-16.0 * beyond.max(0.0).powi(2)).exp()
}

/// The maps of all stations of a wing; stations with one section share one.
pub(super) struct WingMaps {
    maps: Vec<StationMaps>,
    of_station: Vec<usize>,
}

/// The maps that make the unit section at some y, with their weights.
pub(super) type Mixture<'a> = Vec<(&'a StationMaps, f64)>;

impl WingMaps {
    /// With `flat`, the sheet outboard of the tip may become straight.
    pub(super) fn new(kind: Kind, wing: &Wing, t: &[f64], flat: bool) -> Result<Self, MapError> {
        let mut maps: Vec<StationMaps> = Vec::new();
        let mut of_station = Vec::new();
        for station in &wing.stations {
            let same = |m: &StationMaps| m.twist_deg == station.twist_deg && m.section == station.section;
            if let Some(n) = maps.iter().position(same) {
                of_station.push(n);
                continue;
            }
            maps.push(StationMaps::new(kind, station, t)?);
            of_station.push(maps.len() - 1);
        }
        if let (true, Some(&n), Some(tip)) = (flat, of_station.last(), wing.stations.last()) {
            maps[n].add_flat(kind, tip, t)?;
        }
        Ok(Self { maps, of_station })
    }

    /// Maps and weights at y.
    pub(super) fn at(&self, wing: &Wing, y: f64) -> Mixture<'_> {
        let at = wing.between(y);
        let [wa, wb] = wing.weights(at);
        let (a, b) = (self.of_station[at.inner], self.of_station[at.inner + 1]);
        if a == b {
            return vec![(&self.maps[a], 1.0)];
        }
        let both = [(&self.maps[a], wa), (&self.maps[b], wb)];
        both.into_iter().filter(|(_, w)| *w > 0.0).collect()
    }
}

/// Weighted sum of points.
pub(super) fn mixed<'a>(mixture: &Mixture<'a>, point: impl Fn(&'a StationMaps) -> [f64; 2]) -> [f64; 2] {
    mixture.iter().fold([0.0; 2], |sum, (maps, weight)| {
        let p = point(maps);
        [sum[0] + weight * p[0], sum[1] + weight * p[1]]
    })
}
