//! Whether a recording and a lattice are of the same thing.

use crate::MismatchError;
use crate::reading::Reading;
use dip_dlm::aic::Aerodynamics;
use dip_record::{CoordinateKind, Recording};

/// Checks that a recording and a lattice are of the same thing.
///
/// # Errors
/// Mach number, semichord, extents of wall and planform, or side that differ; shows both values.
pub fn check_match(
    recording: &Recording,
    label: &str,
    aerodynamics: &Aerodynamics,
    mach: f64,
) -> Result<(), MismatchError> {
    let refs = &recording.setup.references;
    let wrong = |what: &str, recorded: String, lattice: String, hint: String| {
        Err(MismatchError {
            label: label.to_owned(),
            what: what.to_owned(),
            recorded,
            lattice,
            hint,
        })
    };
    if (refs.mach - mach).abs() > 1e-3 {
        return wrong("Mach number", refs.mach.to_string(), mach.to_string(), String::new());
    }
    let (own, b) = (refs.reference_semichord_m, aerodynamics.semichord());
    if (own - b).abs() > 1e-3 * b {
        let ratio = own / b;
        let hint = if (ratio - 0.5).abs() < 0.01 {
            ": half instead of full reference length? b is half of the root chord, not a quarter"
        } else if (ratio - 2.0).abs() < 0.02 {
            ": full instead of half reference length? b is half of the root chord, not all of it"
        } else {
            ": give both the same root semichord"
        };
        return wrong("reference semichord b, m,", own.to_string(), b.to_string(), hint.into());
    }
    let Some([low, high]) = recording.setup.surface.extent_m() else {
        return wrong(
            "number of wall nodes",
            "0".into(),
            "more".into(),
            ": record dip.SurfaceGrid".into(),
        );
    };
    let mut extent = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for corner in aerodynamics.lattice().boxes().iter().flat_map(|b| b.corners) {
        for d in 0..3 {
            extent[0][d] = extent[0][d].min(corner[d]);
            extent[1][d] = extent[1][d].max(corner[d]);
        }
    }
    // Half a lattice says nothing about the other side, half a model neither.
    let half = refs.half_model || aerodynamics.lattice().symmetry_y != dip_dlm::lattice::PlaneSymmetry::None;
    for (d, name) in [(0, "x"), (1, "y")] {
        let size = extent[1][d] - extent[0][d];
        let ends = if d == 1 && half { 1..2 } else { 0..2 };
        for end in ends {
            let (wall, plan) = ([low, high][end][d], extent[end][d]);
            // A rounded tip or a blunt edge is some percent.
            if (wall - plan).abs() > 0.05 * size {
                let which = ["least", "largest"][end];
                let factor = wall / plan;
                let hint = if plan != 0.0 && (factor - 0.0254).abs() < 1e-3 || (factor - 39.37).abs() < 2.0 {
                    ": inches for metres?"
                } else {
                    ": another wing, unit or origin?"
                };
                return wrong(
                    &format!("{which} {name} of the wing, m,"),
                    format!("{wall:.5}"),
                    format!("{plan:.5}"),
                    hint.into(),
                );
            }
        }
    }
    Ok(())
}

/// Checks the axis of a pitch recording against the one that a case asks for (a point, m; y does not matter).
///
/// # Errors
/// Another axis; shows both.
pub fn check_axis(reading: &Reading, axis_point_m: [f64; 3], semichord_m: f64) -> Result<(), MismatchError> {
    let CoordinateKind::Pitch {
        axis_point_m: own,
        axis_direction,
    } = reading.kind
    else {
        return Ok(());
    };
    let far = [0, 2]
        .iter()
        .any(|d: &usize| (own[*d] - axis_point_m[*d]).abs() > 1e-3 * semichord_m);
    let across = axis_direction[1].abs() < 1.0 - 1e-6;
    if far || across {
        return Err(MismatchError {
            label: reading.label.clone(),
            what: "pitch axis (point, m; direction)".into(),
            recorded: format!("{own:?}; {axis_direction:?}"),
            lattice: format!("{axis_point_m:?}; [0.0, 1.0, 0.0]"),
            hint: ": correct the axis in the case, or record anew".into(),
        });
    }
    Ok(())
}
