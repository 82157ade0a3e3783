//! From wing files and `[lattice]` to a doublet lattice.

use crate::exit::Stop;
use dip_case::file::{Approximation, ControlSurfaceTable, KernelKind, LatticeTable, Symmetry};
use dip_case::wing::{Section, Wing};
use dip_case::{CaseError, Document};
use dip_dlm::kernel::{IntegralSum, Kernel, LineFit};
use dip_dlm::lattice::{ControlSurface, Divisions, Lattice, PlaneSymmetry, Surface};

/// The kernel that the table names.
pub fn kernel(table: &LatticeTable) -> Kernel {
    Kernel {
        fit: match table.kernel {
            KernelKind::Parabolic => LineFit::Parabolic,
            KernelKind::Quartic => LineFit::Quartic,
        },
        integrals: match table.approximation {
            Approximation::Laschka => IntegralSum::Laschka11,
            Approximation::Desmarais => IntegralSum::Desmarais12,
        },
    }
}

/// Checks the numbers of `[lattice]` that no type can.
///
/// # Errors
/// No or too many boxes, Mach numbers outside of 0 to 1, reduced frequencies that are negative, repeated or missing.
pub fn check(document: &Document, table: &LatticeTable) -> Result<(), CaseError> {
    for (key, n) in [("chordwise", table.chordwise), ("spanwise", table.spanwise)] {
        if n == 0 || n > 1000 {
            let message = format!("{n} boxes: needed 1 to 1000");
            return Err(document.error(
                &format!("lattice.{key}"),
                message,
                "20 along chord and span suit most wings",
            ));
        }
    }
    if table.chordwise * table.spanwise > 20_000 {
        let message = format!("{} boxes: needed 20000 or fewer", table.chordwise * table.spanwise);
        return Err(document.error("lattice.spanwise", message, "the matrix would not fit into memory"));
    }
    if table.mach.is_empty() {
        return Err(document.error("lattice.mach", "no Mach number", "give one or more, each below 1"));
    }
    for (i, &m) in table.mach.iter().enumerate() {
        if !(0.0..1.0).contains(&m) {
            let help = "the doublet lattice is for subsonic flow: use `pmb march` from Mach 1 on";
            return Err(document.error(
                &format!("lattice.mach.{i}"),
                format!("Mach number {m}: needed 0 <= M < 1"),
                help,
            ));
        }
    }
    let ks = &table.reduced_frequencies;
    if ks.is_empty() {
        let help = "give some k = omega b / U around the expected flutter point, as in [0.05, 0.1, 0.2, 0.5]";
        return Err(document.error("lattice.reduced_frequencies", "no reduced frequency", help));
    }
    for (i, &k) in ks.iter().enumerate() {
        if !(k >= 0.0 && k.is_finite()) {
            let key = format!("lattice.reduced_frequencies.{i}");
            let message = format!("reduced frequency {k}: needed zero or more");
            return Err(document.error(
                &key,
                message,
                "k = omega b / U with b the root semichord; 0 is quasi-steady",
            ));
        }
        if ks[..i].contains(&k) {
            let key = format!("lattice.reduced_frequencies.{i}");
            return Err(document.error(
                &key,
                format!("reduced frequency {k} stands twice"),
                "leave one of them out",
            ));
        }
    }
    Ok(())
}

/// The lattice of the wing, further surfaces and control surfaces.
///
/// # Errors
/// What is wrong in the files that `[lattice]` names, and what the lattice refuses.
pub fn lattice(document: &Document, wing: &Wing, table: &LatticeTable) -> Result<Lattice, Stop> {
    let hinge = hinge_of(document, &table.control_surface)?;
    let mut surfaces = panels(wing, table.chordwise, table.spanwise, hinge, &table.control_surface);
    let own = surfaces.len();
    for (i, further) in table.surface.iter().enumerate() {
        let file = Document::read(&document.path(&further.wing), &[])?;
        if further.chordwise == 0 || further.spanwise == 0 {
            let message = format!("{} x {} boxes: needed one or more", further.chordwise, further.spanwise);
            return Err(document
                .error(&format!("lattice.surface.{i}"), message, "give chordwise and spanwise")
                .into());
        }
        surfaces.extend(panels(
            &Wing::read(&file)?,
            further.chordwise,
            further.spanwise,
            None,
            &[],
        ));
    }
    let mut first = 1;
    for surface in &mut surfaces {
        surface.first_box_id = first;
        first += u32::try_from(surface.chordwise.count() * surface.spanwise.count()).unwrap_or(0);
    }
    let symmetry = match table.symmetry {
        Symmetry::Symmetric => PlaneSymmetry::Symmetric,
        Symmetry::Antisymmetric => PlaneSymmetry::Antisymmetric,
        Symmetry::None => PlaneSymmetry::None,
    };
    let mut lattice = Lattice::new(surfaces, symmetry)
        .map_err(|e| document.error("lattice", e.to_string(), "check the wing file"))?;
    for (i, control) in table.control_surface.iter().enumerate() {
        let surface = control_surface(wing, &lattice, own, control);
        lattice.add_control(surface).map_err(|e| {
            document.error(
                &format!("lattice.control_surface.{i}"),
                e.to_string(),
                "check hinge and span",
            )
        })?;
    }
    Ok(lattice)
}

/// The one hinge fraction of all control surfaces, where the boxes are split.
fn hinge_of(document: &Document, controls: &[ControlSurfaceTable]) -> Result<Option<f64>, CaseError> {
    let mut hinge = None;
    for (i, control) in controls.iter().enumerate() {
        let at = |key: &str| format!("lattice.control_surface.{i}.{key}");
        if !(control.hinge > 0.0 && control.hinge < 1.0) {
            let message = format!("hinge at {} of the chord: needed between 0 and 1", control.hinge);
            return Err(document.error(&at("hinge"), message, "0.75 is a quarter-chord flap"));
        }
        let [inner, outer] = control.span;
        if !(0.0 <= inner && inner < outer && outer <= 1.0) {
            let message = format!("span from {inner} to {outer}: needed 0 <= inner < outer <= 1");
            return Err(document.error(&at("span"), message, "fractions of the wing's span from root to tip"));
        }
        if hinge.is_some_and(|h: f64| (h - control.hinge).abs() > 1e-12) {
            let help = "boxes are split along one line from root to tip: give all control surfaces the same hinge";
            return Err(document.error(&at("hinge"), "another hinge than the control surface before", help));
        }
        hinge = Some(control.hinge);
    }
    Ok(hinge)
}

/// Span of a panel across the stream.
fn span(a: &Section, b: &Section) -> f64 {
    let d = |i: usize| b.leading_edge_m[i] - a.leading_edge_m[i];
    d(1).hypot(d(2))
}

/// One flat surface for each panel of the wing; boxes along the span shared out by span, at least one each.
fn panels(
    wing: &Wing,
    chordwise: usize,
    spanwise: usize,
    hinge: Option<f64>,
    controls: &[ControlSurfaceTable],
) -> Vec<Surface> {
    let pairs: Vec<(&Section, &Section)> = wing.sections.windows(2).map(|w| (&w[0], &w[1])).collect();
    let total: f64 = pairs.iter().map(|(a, b)| span(a, b)).sum();
    let chord = match hinge {
        None => Divisions::Equal(chordwise),
        Some(h) => {
            let aft = ((chordwise as f64 * (1.0 - h)).round() as usize).clamp(1, chordwise.max(2) - 1);
            let ahead = chordwise.max(2) - aft;
            let front = (0..=ahead).map(|i| h * i as f64 / ahead as f64);
            let rear = (1..=aft).map(|i| h + (1.0 - h) * i as f64 / aft as f64);
            Divisions::Fractions(front.chain(rear).collect())
        }
    };
    let mut from = 0.0;
    let mut surfaces = Vec::new();
    for (i, (a, b)) in pairs.iter().enumerate() {
        let width = span(a, b);
        // Ends of control surfaces inside this panel, as fractions of it, are division lines.
        let mut cuts: Vec<f64> = vec![0.0, 1.0];
        cuts.extend(controls.iter().flat_map(|c| c.span).map(|s| (s * total - from) / width));
        cuts.retain(|s| (0.0..=1.0).contains(s));
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|x, y| (*x - *y).abs() < 1e-9);
        let count = ((spanwise as f64 * width / total).round() as usize).max(1);
        let divisions = if cuts.len() == 2 {
            Divisions::Equal(count)
        } else {
            let mut lines = vec![0.0];
            for pair in cuts.windows(2) {
                let n = ((count as f64 * (pair[1] - pair[0])).round() as usize).max(1);
                lines.extend((1..=n).map(|j| pair[0] + (pair[1] - pair[0]) * j as f64 / n as f64));
            }
            Divisions::Fractions(lines)
        };
        let name = if pairs.len() == 1 {
            wing.name.clone()
        } else {
            format!("{}, panel {}", wing.name, i + 1)
        };
        let mut surface = Surface::trapezoid(
            &name,
            (a.leading_edge_m, a.chord_m),
            (b.leading_edge_m, b.chord_m),
            chordwise,
            count,
        );
        surface.chordwise = chord.clone();
        surface.spanwise = divisions;
        surfaces.push(surface);
        from += width;
    }
    surfaces
}

/// Boxes aft of the hinge between the ends, and the hinge line.
fn control_surface(wing: &Wing, lattice: &Lattice, own: usize, table: &ControlSurfaceTable) -> ControlSurface {
    let stations: Vec<f64> = std::iter::once(0.0)
        .chain(wing.sections.windows(2).scan(0.0, |sum, w| {
            *sum += span(&w[0], &w[1]);
            Some(*sum)
        }))
        .collect();
    let total = stations.last().copied().unwrap_or(1.0);
    // Leading edge and chord at a distance s along the span.
    let section = |s: f64| -> ([f64; 3], f64) {
        let i = stations
            .windows(2)
            .position(|w| s <= w[1] * (1.0 + 1e-12))
            .unwrap_or(stations.len() - 2);
        let t = (s - stations[i]) / (stations[i + 1] - stations[i]);
        let (a, b) = (&wing.sections[i], &wing.sections[i + 1]);
        let le = std::array::from_fn(|d| a.leading_edge_m[d] + t * (b.leading_edge_m[d] - a.leading_edge_m[d]));
        (le, a.chord_m + t * (b.chord_m - a.chord_m))
    };
    let hinge_point = |fraction: f64| {
        let (le, chord) = section(fraction * total);
        [le[0] + table.hinge * chord, le[1], le[2]]
    };
    let boxes = lattice
        .boxes()
        .iter()
        .enumerate()
        .filter(|(_, b)| b.surface < own)
        .filter(|(_, b)| {
            let across = |p: [f64; 3], q: [f64; 3]| (p[1] - q[1]).hypot(p[2] - q[2]);
            let first = &wing.sections[b.surface].leading_edge_m;
            let s = (stations[b.surface] + across(b.mid_chord, *first)) / total;
            let (le, chord) = section(s * total);
            let x = (b.mid_chord[0] - le[0]) / chord;
            x > table.hinge && s > table.span[0] && s < table.span[1]
        });
    ControlSurface {
        name: table.name.clone(),
        boxes: boxes.map(|(i, _)| i).collect(),
        hinge: [hinge_point(table.span[0]), hinge_point(table.span[1])],
    }
}
