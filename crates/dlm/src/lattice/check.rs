//! What a lattice must obey (errors) and what good practice asks of it (warnings and advice), as data.

use super::{Lattice, LatticeBox, PlaneSymmetry, Strip};
use crate::kernel::{Kernel, LineFit};

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Published advice for converged results is not followed; results are still of engineering use.
    Advice,
    /// A published rule is broken: look at it.
    Warning,
    /// The equations are singular or meaningless.
    Error,
}

/// What a finding is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FindingKind {
    /// A box without area, or far smaller than the others.
    ZeroArea,
    /// Two boxes share a part of one plane.
    Overlap,
    /// A control point lies on, or nearly on, the extended side edge of another box (doublet line's end and wake).
    PointOnEdge,
    /// A control point hovers close above another box (relative to its width): unsteady coefficients lose accuracy.
    CloseAbove,
    /// A control point lies on the doublet line of another box (surfaces that cross).
    PointOnDoubletLine,
    /// A surface crosses the symmetry plane.
    CrossesSymmetryPlane,
    /// Mach number outside [0, 1).
    Mach,
    /// Width over chord of boxes against the line fit's limit.
    AspectRatio,
    /// Chord of boxes against the wave length.
    WaveLength,
    /// Fewer than four boxes along the chord.
    FewChordwise,
}

/// One finding about a lattice.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// What it is about.
    pub kind: FindingKind,
    /// Boxes concerned (indices; the worst one first).
    pub boxes: Vec<usize>,
    /// A sentence for the user: where, what is needed, what was got, what to do.
    pub message: String,
}

/// Box widths over chord up to which the parabolic fit is trusted (Rodden, Taylor and McIntosh 1998, as quoted in
/// Voss, DLR-IB-AE-GO-2020-137).
const ASPECT_LIMIT_PARABOLIC: f64 = 3.0;
/// The same for the quartic fit (Rodden, Taylor and McIntosh 1998: six to ten; the wider bound).
const ASPECT_LIMIT_QUARTIC: f64 = 10.0;
/// Box chord below 0.08 U/f, the older rule of MSC's guide: 12.5 boxes a wave.
const BOXES_PER_WAVE_RULE: f64 = 12.5;
/// Rodden, Taylor and McIntosh 1998: about fifty boxes a wave for converged results.
const BOXES_PER_WAVE_ADVICE: f64 = 50.0;
/// Heights over half width between which a control point above another box is too close: below the first it counts as in the
/// plane, above the second the fit's error (which grows as 1 / height) is small.
const CLOSE_ABOVE: std::ops::RangeInclusive<f64> = 1e-3..=0.05;
/// Fewest boxes along a chord (Rodden, Taylor and McIntosh 1998).
const CHORDWISE_MINIMUM: usize = 4;

/// Boxes per wave length of the worst box: lambda / chord with lambda = U/f = 2 pi b / k.
///
/// `semichord` is b of k = omega b / U. Infinite at k = 0.
pub fn boxes_per_wavelength(lattice: &Lattice, k: f64, semichord: f64) -> f64 {
    let longest = lattice.boxes().iter().map(|b| b.chord).fold(0.0, f64::max);
    2.0 * std::f64::consts::PI * semichord / (k.abs() * longest)
}

impl Lattice {
    /// Checks the lattice for one Mach number and the largest reduced frequency k = omega b / U of an analysis.
    ///
    /// Findings of [`Severity::Error`] make the influence matrix singular or meaningless.
    pub fn check(&self, kernel: Kernel, mach: f64, k_max: f64, semichord: f64) -> Vec<Finding> {
        let mut found = self.check_geometry();
        if !(0.0..1.0).contains(&mach) {
            found.push(Finding {
                severity: Severity::Error,
                kind: FindingKind::Mach,
                boxes: Vec::new(),
                message: format!(
                    "Mach number {mach}: the doublet lattice is for subsonic flow, 0 <= M < 1; use the flow solver above"
                ),
            });
        }
        self.check_aspect(kernel, &mut found);
        self.check_chordwise(&mut found);
        self.check_waves(k_max, semichord, &mut found);
        found
    }

    /// The part of [`Lattice::check`] that depends on geometry alone.
    pub fn check_geometry(&self) -> Vec<Finding> {
        let mut found = Vec::new();
        self.check_area(&mut found);
        self.check_symmetry_planes(&mut found);
        self.check_pairs(&mut found);
        found
    }

    fn check_area(&self, found: &mut Vec<Finding>) {
        let typical = self.area() / self.n_boxes() as f64;
        let small: Vec<usize> = (0..self.n_boxes())
            .filter(|&i| self.boxes()[i].area.is_nan() || self.boxes()[i].area <= 1e-9 * typical)
            .collect();
        if let Some(&worst) = small.first() {
            found.push(Finding {
                severity: Severity::Error,
                kind: FindingKind::ZeroArea,
                message: format!(
                    "{} box(es) have no area; the first is box {} of surface {}: move its corners apart or remove the division",
                    small.len(),
                    self.boxes()[worst].id,
                    self.surfaces()[self.boxes()[worst].surface].name
                ),
                boxes: small,
            });
        }
    }

    fn check_symmetry_planes(&self, found: &mut Vec<Finding>) {
        for (axis, symmetry, plane) in [(1, self.symmetry_y, "y = 0"), (2, self.symmetry_z, "z = 0")] {
            if symmetry == PlaneSymmetry::None {
                continue;
            }
            let tolerance = 1e-6 * self.strips().iter().map(|s| s.half_width).fold(0.0, f64::max);
            let above = |b: &LatticeBox| b.corners.iter().any(|c| c[axis] > tolerance);
            let below = |b: &LatticeBox| b.corners.iter().any(|c| c[axis] < -tolerance);
            if self.boxes().iter().any(above) && self.boxes().iter().any(below) {
                let side: Vec<usize> = (0..self.n_boxes()).filter(|&i| below(&self.boxes()[i])).collect();
                found.push(Finding {
                    severity: Severity::Error,
                    kind: FindingKind::CrossesSymmetryPlane,
                    message: format!(
                        "{plane} is a symmetry plane but boxes lie on both of its sides (box {} is on the negative one): \
                         describe one side only, or turn symmetry off",
                        self.boxes()[side[0]].id
                    ),
                    boxes: side,
                });
            }
        }
    }

    /// Overlaps, and control points on the edges of other strips. Works on pairs of strips: linear in practice.
    fn check_pairs(&self, found: &mut Vec<Finding>) {
        let mut overlapping = Vec::new();
        let mut on_edge = Vec::new();
        let mut near_edge = Vec::new();
        let mut on_line = Vec::new();
        let mut close = Vec::new();
        for (i, sender) in self.strips().iter().enumerate() {
            for (j, receiver) in self.strips().iter().enumerate() {
                if self.surfaces()[sender.surface].interference_group
                    != self.surfaces()[receiver.surface].interference_group
                {
                    continue;
                }
                if i < j {
                    self.overlap(sender, receiver, &mut overlapping);
                }
                if i != j {
                    self.point_on_edge(sender, receiver, &mut on_edge, &mut near_edge);
                    self.point_on_line(sender, receiver, &mut on_line);
                    self.point_close_above(sender, receiver, &mut close);
                }
            }
        }
        let label = |b: usize| {
            format!(
                "{} ({})",
                self.boxes()[b].id,
                self.surfaces()[self.boxes()[b].surface].name
            )
        };
        if let Some(&(a, b)) = overlapping.first() {
            found.push(Finding {
                severity: Severity::Error,
                kind: FindingKind::Overlap,
                message: format!(
                    "{} pair(s) of boxes lie on top of each other; the first pair is {} and {}: each part of the plane may be \
                     covered once; separate the surfaces or put them into different interference groups",
                    overlapping.len(),
                    label(a),
                    label(b)
                ),
                boxes: overlapping.iter().flat_map(|&(a, b)| [a, b]).collect(),
            });
        }
        if let Some(&(receiver, sender)) = close.first() {
            found.push(Finding {
                severity: Severity::Warning,
                kind: FindingKind::CloseAbove,
                message: format!(
                    "{} strip(s) of control points lie above or below other boxes by less than {} half widths; the first is that of box \
                     {} over box {}: their unsteady influence is inaccurate; use narrower boxes there, or one plane for both \
                     surfaces",
                    close.len(),
                    CLOSE_ABOVE.end(),
                    label(receiver),
                    label(sender)
                ),
                boxes: close.iter().flat_map(|&(r, s)| [r, s]).collect(),
            });
        }
        if let Some(&(receiver, sender)) = on_line.first() {
            found.push(Finding {
                severity: Severity::Error,
                kind: FindingKind::PointOnDoubletLine,
                message: format!(
                    "{} control point(s) lie on the doublet line of another box; the first is that of box {} on the line of box \
                     {}: shift the divisions of one of the two surfaces",
                    on_line.len(),
                    label(receiver),
                    label(sender)
                ),
                boxes: on_line.iter().flat_map(|&(r, s)| [r, s]).collect(),
            });
        }
        for (pairs, severity, word) in [
            (on_edge, Severity::Error, "on"),
            (near_edge, Severity::Warning, "close to"),
        ] {
            if let Some(&(receiver, sender)) = pairs.first() {
                found.push(Finding {
                    severity,
                    kind: FindingKind::PointOnEdge,
                    message: format!(
                        "{} control point(s) lie {word} the side edge, or its wake, of another box; the first is that of box \
                         {} on the edge of box {}: line the spanwise divisions of surfaces in one plane up with each other",
                        pairs.len(),
                        label(receiver),
                        label(sender)
                    ),
                    boxes: pairs.iter().flat_map(|&(r, s)| [r, s]).collect(),
                });
            }
        }
    }

    fn overlap(&self, a: &Strip, b: &Strip, pairs: &mut Vec<(usize, usize)>) {
        let (dy, dz) = (b.y - a.y, b.z - a.z);
        let along = dy * a.cos_dihedral + dz * a.sin_dihedral;
        let across = dz * a.cos_dihedral - dy * a.sin_dihedral;
        let twist = a.sin_dihedral * b.cos_dihedral - a.cos_dihedral * b.sin_dihedral;
        let small = 1e-6 * a.half_width.min(b.half_width);
        let common = (a.half_width.min(along + b.half_width) - (-a.half_width).max(along - b.half_width)).max(0.0);
        if twist.abs() > 1e-6 || across.abs() > small || common <= 1e3 * small {
            return;
        }
        // Chordwise overlap is looked at in the middle of the common width.
        let middle = 0.5 * (a.half_width.min(along + b.half_width) + (-a.half_width).max(along - b.half_width));
        let sense = a.cos_dihedral * b.cos_dihedral + a.sin_dihedral * b.sin_dihedral;
        let range = |box_index: usize, s: f64| {
            let b = &self.boxes()[box_index];
            let t = 0.5 * (1.0 + s);
            let at = |one: usize, two: usize| b.corners[one][0] + t * (b.corners[two][0] - b.corners[one][0]);
            (at(0, 1), at(3, 2))
        };
        for ia in a.first..a.first + a.count {
            let (a0, a1) = range(ia, middle / a.half_width);
            for ib in b.first..b.first + b.count {
                let (b0, b1) = range(ib, sense.signum() * (middle - along) / b.half_width);
                if a1.min(b1) - a0.max(b0) > 1e-3 * (a1 - a0).min(b1 - b0) {
                    pairs.push((ia, ib));
                }
            }
        }
    }

    fn point_on_edge(
        &self,
        sender: &Strip,
        receiver: &Strip,
        on: &mut Vec<(usize, usize)>,
        near: &mut Vec<(usize, usize)>,
    ) {
        let (dy, dz) = (receiver.y - sender.y, receiver.z - sender.z);
        let along = dy * sender.cos_dihedral + dz * sender.sin_dihedral;
        let across = dz * sender.cos_dihedral - dy * sender.sin_dihedral;
        let distance = (along.abs() - sender.half_width).hypot(across) / sender.half_width;
        if distance < 1e-6 {
            on.push((receiver.first, sender.first));
        } else if distance < 1e-2 {
            near.push((receiver.first, sender.first));
        }
    }

    /// Points over a sending strip's boxes, very close to their plane but not in it.
    fn point_close_above(&self, sender: &Strip, receiver: &Strip, close: &mut Vec<(usize, usize)>) {
        let (dy, dz) = (receiver.y - sender.y, receiver.z - sender.z);
        let along = dy * sender.cos_dihedral + dz * sender.sin_dihedral;
        let across = dz * sender.cos_dihedral - dy * sender.sin_dihedral;
        if along.abs() >= sender.half_width || !CLOSE_ABOVE.contains(&(across.abs() / sender.half_width)) {
            return;
        }
        let first = &self.boxes()[sender.first];
        let last = &self.boxes()[sender.first + sender.count - 1];
        let lead = first.corners[0][0].min(first.corners[1][0]);
        let trail = last.corners[2][0].max(last.corners[3][0]);
        let over = |r: &usize| (lead..=trail).contains(&self.boxes()[*r].control_point[0]);
        if let Some(r) = (receiver.first..receiver.first + receiver.count).find(over) {
            close.push((r, sender.first));
        }
    }

    /// Points inside a sending strip's width and in its plane, at the x of one of its doublet lines.
    fn point_on_line(&self, sender: &Strip, receiver: &Strip, on: &mut Vec<(usize, usize)>) {
        let (dy, dz) = (receiver.y - sender.y, receiver.z - sender.z);
        let along = dy * sender.cos_dihedral + dz * sender.sin_dihedral;
        let across = dz * sender.cos_dihedral - dy * sender.sin_dihedral;
        if along.abs() >= sender.half_width || across.abs() > 1e-6 * sender.half_width {
            return;
        }
        let part = 0.5 * (1.0 + along / sender.half_width);
        for s in sender.first..sender.first + sender.count {
            let b = &self.boxes()[s];
            let line = b.doublet_1[0] + part * (b.doublet_2[0] - b.doublet_1[0]);
            for r in receiver.first..receiver.first + receiver.count {
                if (self.boxes()[r].control_point[0] - line).abs() < 1e-6 * b.chord {
                    on.push((r, s));
                }
            }
        }
    }

    fn check_aspect(&self, kernel: Kernel, found: &mut Vec<Finding>) {
        let (limit, name) = match kernel.fit {
            LineFit::Parabolic => (ASPECT_LIMIT_PARABOLIC, "parabolic"),
            LineFit::Quartic => (ASPECT_LIMIT_QUARTIC, "quartic"),
        };
        let aspect = |i: usize| self.boxes()[i].width / self.boxes()[i].chord;
        let mut wide: Vec<usize> = (0..self.n_boxes()).filter(|&i| aspect(i) > limit).collect();
        wide.sort_by(|&a, &b| aspect(b).total_cmp(&aspect(a)));
        if let Some(&worst) = wide.first() {
            let cure = if kernel.fit == LineFit::Parabolic {
                " or take the quartic fit"
            } else {
                ""
            };
            found.push(Finding {
                severity: Severity::Warning,
                kind: FindingKind::AspectRatio,
                message: format!(
                    "{} box(es) are wider than {limit} chords, the limit of the {name} fit; box {} of surface {} has {:.2}: \
                     use more strips{cure}",
                    wide.len(),
                    self.boxes()[worst].id,
                    self.surfaces()[self.boxes()[worst].surface].name,
                    aspect(worst)
                ),
                boxes: wide,
            });
        }
    }

    fn check_chordwise(&self, found: &mut Vec<Finding>) {
        // Control surfaces often are surfaces of their own behind another one, so a single short strip proves nothing:
        // only lattices in which no strip has enough boxes are told.
        if let Some(most) = self.strips().iter().map(|s| s.count).max()
            && most < CHORDWISE_MINIMUM
        {
            found.push(Finding {
                severity: Severity::Warning,
                kind: FindingKind::FewChordwise,
                boxes: Vec::new(),
                message: format!("{most} boxes along the chord: at least {CHORDWISE_MINIMUM} are asked for"),
            });
        }
    }

    fn check_waves(&self, k_max: f64, semichord: f64, found: &mut Vec<Finding>) {
        let worst = boxes_per_wavelength(self, k_max, semichord);
        if worst >= BOXES_PER_WAVE_ADVICE {
            return;
        }
        let chord_of = |per_wave: f64| 2.0 * std::f64::consts::PI * semichord / (k_max.abs() * per_wave);
        let severity = if worst < BOXES_PER_WAVE_RULE {
            Severity::Warning
        } else {
            Severity::Advice
        };
        let wanted = if worst < BOXES_PER_WAVE_RULE {
            BOXES_PER_WAVE_RULE
        } else {
            BOXES_PER_WAVE_ADVICE
        };
        let long: Vec<usize> = (0..self.n_boxes())
            .filter(|&i| self.boxes()[i].chord > chord_of(wanted))
            .collect();
        found.push(Finding {
            severity,
            kind: FindingKind::WaveLength,
            message: format!(
                "{worst:.1} boxes per wave length 2 pi b / k at k = {k_max}: {wanted} are {} (box chord at most {:.4}); use \
                 more boxes along the chord or a smaller k",
                if severity == Severity::Warning { "needed" } else { "advised" },
                chord_of(wanted)
            ),
            boxes: long,
        });
    }
}
