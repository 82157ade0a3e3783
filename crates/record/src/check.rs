//! What a setup and a step must be like, whether they are to be written or were just read.

use crate::finding::{Finding, FindingKind};
use crate::motion::{CoordinateKind, Law, MotionCoordinate};
use crate::setup::Setup;
use crate::step::Step;
use crate::surface::SurfacePatch;

/// Longest time that a recording can hold, s: nanoseconds in 64 bits.
pub(crate) const TIME_LIMIT_S: f64 = 1.8e10;

/// Checks reference quantities, motion and surface.
pub(crate) fn setup(setup: &Setup) -> Result<(), String> {
    let r = &setup.references;
    for (name, value) in [
        ("mach", r.mach),
        ("speed_m_s", r.speed_m_s),
        ("density_kg_m3", r.density_kg_m3),
        ("pressure_pa", r.pressure_pa),
        ("gamma", r.gamma),
        ("reference_semichord_m", r.reference_semichord_m),
        ("reference_chord_m", r.reference_chord_m),
        ("reference_area_m2", r.reference_area_m2),
        ("span_m", r.span_m),
        ("grid_unit_m", r.grid_unit_m),
        ("time_step_s", r.time_step_s),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return Err(format!("{name} = {value}: a positive, finite number is needed"));
        }
    }
    for (name, value) in [("alpha_deg", r.alpha_deg), ("orders_asked", r.orders_asked)]
        .into_iter()
        .chain(r.moment_point_m.map(|v| ("moment_point_m", v)))
        .chain(r.reynolds.map(|v| ("reynolds", v)))
        .chain(r.cycles_asked.map(|v| ("cycles_asked", v)))
    {
        if !value.is_finite() {
            return Err(format!("{name} = {value}: a finite number is needed"));
        }
    }
    if setup.surface.patches.is_empty() {
        return Err("no patch of wall: at least one is needed".to_owned());
    }
    for (n, patch) in setup.surface.patches.iter().enumerate() {
        self::patch(patch)?;
        if setup.surface.patches[..n].iter().any(|p| p.name == patch.name) {
            return Err(format!("two patches named `{}`: names must differ", patch.name));
        }
    }
    for (n, coordinate) in setup.motion.iter().enumerate() {
        self::coordinate(setup, coordinate)
            .map_err(|what| format!("motion coordinate `{}`: {what}", coordinate.name))?;
        if setup.motion[..n].iter().any(|c| c.name == coordinate.name) {
            return Err(format!(
                "two motion coordinates named `{}`: names must differ",
                coordinate.name
            ));
        }
    }
    Ok(())
}

fn patch(patch: &SurfacePatch) -> Result<(), String> {
    let name = &patch.name;
    let count = patch.faces.len();
    if name.is_empty() {
        return Err("a patch of wall has no name".to_owned());
    }
    for (what, got) in [
        ("centroids", patch.centroids_m.len()),
        ("area vectors", patch.areas_m2.len()),
        ("upper-side flags", patch.upper.len()),
    ] {
        if got != count {
            return Err(format!("patch `{name}`: {got} {what} for {count} faces"));
        }
    }
    let nodes = patch.nodes_m.len();
    if let Some((face, node)) = patch
        .faces
        .iter()
        .enumerate()
        .find_map(|(f, corners)| corners.iter().find(|n| **n as usize >= nodes).map(|n| (f, n)))
    {
        return Err(format!(
            "patch `{name}`: face {face} uses node {node}, the patch has {nodes} nodes counted from 0"
        ));
    }
    for (what, vectors) in [
        ("node", &patch.nodes_m),
        ("centroid", &patch.centroids_m),
        ("area vector", &patch.areas_m2),
    ] {
        if let Some(n) = vectors.iter().position(|v| !v.iter().all(|x| x.is_finite())) {
            return Err(format!("patch `{name}`: {what} {n} is {:?}, not finite", vectors[n]));
        }
    }
    Ok(())
}

fn coordinate(setup: &Setup, coordinate: &MotionCoordinate) -> Result<(), String> {
    if coordinate.name.is_empty() {
        return Err("it has no name".to_owned());
    }
    let (point, direction) = match coordinate.kind {
        CoordinateKind::Pitch {
            axis_point_m,
            axis_direction,
        }
        | CoordinateKind::Control {
            axis_point_m,
            axis_direction,
        } => (axis_point_m, Some(axis_direction)),
        CoordinateKind::Plunge { direction } => ([0.0; 3], Some(direction)),
        CoordinateKind::Mode => ([0.0; 3], None),
    };
    if !point.iter().all(|x| x.is_finite()) {
        return Err(format!("its axis goes through {point:?}, a finite point is needed"));
    }
    if let Some(direction) = direction {
        let length = direction.map(|v| v * v).iter().sum::<f64>().sqrt();
        // Not `length - 1 > limit`: that would let a length through that is not a number.
        let unit = (length - 1.0).abs() <= 1e-9;
        if !unit {
            return Err(format!("its direction {direction:?} has length {length}, 1 is needed"));
        }
    }
    let rigid = matches!(
        coordinate.kind,
        CoordinateKind::Pitch { .. } | CoordinateKind::Plunge { .. }
    );
    if rigid != coordinate.shape_m.is_empty() {
        return Err(format!(
            "a coordinate of kind {} {} a shape of the wall",
            coordinate.kind.name(),
            if rigid { "does not take" } else { "needs" }
        ));
    }
    if !rigid {
        nodes(setup, &coordinate.shape_m, "its shape")?;
    }
    let numbers: Vec<(&str, f64)> = match &coordinate.law {
        Law::Harmonic {
            mean,
            phase_origin_s,
            harmonics,
        } => {
            if harmonics.is_empty() {
                return Err("a harmonic law needs at least one harmonic".to_owned());
            }
            if let Some(h) = harmonics
                .iter()
                .find(|h| h.omega_rad_s.is_nan() || h.omega_rad_s <= 0.0)
            {
                return Err(format!("omega = {} rad/s, a positive one is needed", h.omega_rad_s));
            }
            [("mean", *mean), ("phase origin", *phase_origin_s)]
                .into_iter()
                .chain(harmonics.iter().flat_map(|h| {
                    [
                        ("omega", h.omega_rad_s),
                        ("amplitude", h.amplitude),
                        ("phase", h.phase_rad),
                    ]
                }))
                .collect()
        }
        Law::Pulse {
            mean,
            amplitude,
            start_s,
            duration_s,
            ..
        }
        | Law::Ramp {
            mean,
            amplitude,
            start_s,
            duration_s,
            ..
        } => vec![
            ("mean", *mean),
            ("amplitude", *amplitude),
            ("start", *start_s),
            ("duration", *duration_s),
        ],
        Law::Free => Vec::new(),
    };
    let mode = coordinate.mode.iter().flat_map(|m| {
        [
            ("natural frequency", m.omega_rad_s),
            ("generalized mass", m.generalized_mass_kg),
            ("damping ratio", m.damping_ratio),
        ]
    });
    match numbers.into_iter().chain(mode).find(|(_, v)| !v.is_finite()) {
        Some((name, value)) => Err(format!("its {name} is {value}, a finite number is needed")),
        None => Ok(()),
    }
}

/// One vector per node of every patch, all finite.
fn nodes(setup: &Setup, vectors: &[Vec<[f64; 3]>], what: &str) -> Result<(), String> {
    let patches = &setup.surface.patches;
    if vectors.len() != patches.len() {
        return Err(format!(
            "{what} has {} patches, needed {}",
            vectors.len(),
            patches.len()
        ));
    }
    for (given, patch) in vectors.iter().zip(patches) {
        if given.len() != patch.nodes_m.len() {
            return Err(format!(
                "{what} has {} nodes on patch `{}`, needed {}",
                given.len(),
                patch.name,
                patch.nodes_m.len()
            ));
        }
        if let Some(n) = given.iter().position(|v| !v.iter().all(|x| x.is_finite())) {
            return Err(format!(
                "{what} is {:?} at node {n} of patch `{}`, not finite",
                given[n], patch.name
            ));
        }
    }
    Ok(())
}

/// Checks a step against its setup: sizes first, then that every number is finite.
pub(crate) fn step(setup: &Setup, step: &Step) -> Result<(), Finding> {
    let wrong = |kind, what: String| Finding::new(kind, format!("step {}: {what}", step.number));
    let size = |what: &str, got: usize, needed: usize| {
        if got == needed {
            Ok(())
        } else {
            Err(wrong(FindingKind::Incomplete, format!("{got} {what}, needed {needed}")))
        }
    };
    if !(step.time_s >= 0.0 && step.time_s < TIME_LIMIT_S) {
        return Err(wrong(
            FindingKind::Timing,
            format!("its instant is {} s, needed 0 or later", step.time_s),
        ));
    }
    size("motion coordinates", step.motion.len(), setup.motion.len())?;
    size("patches of pressure", step.pressures.len(), setup.surface.patches.len())?;
    for (cp, patch) in step.pressures.iter().zip(&setup.surface.patches) {
        size(
            &format!("pressures on patch `{}`", patch.name),
            cp.len(),
            patch.faces.len(),
        )?;
    }
    if let Some(modal) = &step.modal {
        size("modal rates", modal.q_dot.len(), modal.q.len())?;
        size("generalized forces", modal.force_j.len(), modal.q.len())?;
    }
    if let Some(shape) = &step.shape_m {
        nodes(setup, shape, "the shape").map_err(|what| wrong(FindingKind::Incomplete, what))?;
    }

    let finite = |what: String, value: f64| {
        if value.is_finite() {
            Ok(())
        } else {
            Err(wrong(FindingKind::NonFinite, format!("{what} is {value}")))
        }
    };
    for (now, coordinate) in step.motion.iter().zip(&setup.motion) {
        finite(format!("value of `{}`", coordinate.name), now.value)?;
        finite(format!("rate of `{}`", coordinate.name), now.rate)?;
    }
    for (cp, patch) in step.pressures.iter().zip(&setup.surface.patches) {
        if let Some(face) = cp.iter().position(|v| !v.is_finite()) {
            finite(
                format!("pressure coefficient of face {face} of patch `{}`", patch.name),
                cp[face],
            )?;
        }
    }
    let l = &step.loads;
    for (name, value) in [
        ("CL", l.cl),
        ("CD", l.cd),
        ("CM", l.cm),
        ("residual's fall", step.convergence.orders),
    ]
    .into_iter()
    .chain(l.force_n.map(|v| ("force", v)))
    .chain(l.moment_n_m.map(|v| ("moment", v)))
    {
        finite(name.to_owned(), value)?;
    }
    if let Some(modal) = &step.modal {
        for (name, values) in [
            ("generalized coordinate", &modal.q),
            ("modal rate", &modal.q_dot),
            ("generalized force", &modal.force_j),
        ] {
            for (n, value) in values.iter().enumerate() {
                finite(format!("{name} {}", n + 1), *value)?;
            }
        }
    }
    Ok(())
}
