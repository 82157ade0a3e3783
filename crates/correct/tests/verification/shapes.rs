//! Recordings of deforming motion: the recorded displacements of the wall say what the boxes did.

use super::wing::{AXIS_M, MACH, OMEGA_RAD_S, assembled, largest, modes, moving_mode, pitch, pitching, wing};
use dip_correct::apply::correct;
use dip_correct::bridge::Assembled;
use dip_correct::reading::ReadingSettings;
use dip_correct::synthetic::Synthetic;
use dip_correct::{Method, Settings};
use dip_dlm::aic::Aerodynamics;
use dip_dlm::c64;
use dip_dlm::kernel::Kernel;
use dip_dlm::lattice::{Lattice, PlaneSymmetry, Surface};
use dip_dlm::motion::BoxMotion;
use dip_record::{CoordinateKind, Recording, StructuralMode};

/// The recording with a displacement of every node of its wall.
fn with_shape(made: &Synthetic<'_>, shape: impl Fn([f64; 3]) -> [f64; 3]) -> Recording {
    let mut recording = made.record().unwrap();
    let patches = &recording.setup.surface.patches;
    recording.setup.motion[0].shape_m = patches
        .iter()
        .map(|patch| patch.nodes_m.iter().map(|p| shape(*p)).collect())
        .collect();
    recording
}

fn numbered(made: Synthetic<'_>, number: u32) -> Synthetic<'_> {
    Synthetic {
        name: format!("mode {number}"),
        kind: CoordinateKind::Mode,
        mode: Some(StructuralMode {
            number,
            omega_rad_s: 60.0,
            generalized_mass_kg: 1.0,
            damping_ratio: 0.0,
        }),
        ..made
    }
}

/// A pitching wing as a deforming one would be recorded: no axis, but the displacements.
fn pitching_shape(p: [f64; 3]) -> [f64; 3] {
    [p[2], 0.0, AXIS_M[0] - p[0]]
}

/// Bending as in mode 1 of [`modes`].
fn bending(p: [f64; 3]) -> [f64; 3] {
    [0.0, 0.0, (p[1] / 0.762).powi(2)]
}

fn take(wing: &Aerodynamics, recordings: &[Recording]) -> Assembled {
    assembled(wing, recordings, &ReadingSettings::default())
}

fn apart(a: &BoxMotion, b: &BoxMotion) -> f64 {
    let list = |m: &BoxMotion| [m.slope.clone(), m.at_control.clone(), m.at_force.clone()].concat();
    largest(list(a).iter().zip(list(b)).map(|(x, y)| (x - y).abs()))
}

#[test]
fn a_linear_shape_is_exact() {
    let wing = wing();
    let recording = with_shape(&numbered(pitching(&wing), 7), pitching_shape);
    let all = take(&wing, &[recording]);
    let away = apart(&all.references.motion, &pitch(&wing));
    assert!(away < 1e-12, "{away:.1e}");
    assert_eq!(all.references.mode_of, [None]);
    assert!(
        all.notes.len() == 1 && all.notes[0].contains("mode 7"),
        "{:?}",
        all.notes
    );
    // The lattice's own pressures: nothing to correct.
    let k = [0.0, 0.1, 0.3];
    let methods = [Method::Downwash, Method::Force, Method::Additive, Method::Mode];
    let correction = correct(
        &wing,
        &modes(&wing),
        MACH,
        &k,
        &all.references,
        &methods,
        Settings::default(),
    )
    .unwrap();
    for at in &correction.recordings {
        let away = largest(at.weight.ratio.iter().map(|w| (w - c64::new(1.0, 0.0)).norm()));
        assert!(away < 1e-9, "W_T = 1: {away:.1e}");
    }
    for corrected in &correction.methods {
        for (q, linear) in corrected.q.iter().zip(&correction.linear) {
            let scale = linear.norm();
            let away = largest(q.data().iter().zip(linear.data()).map(|(a, b)| (a - b).norm())) / scale;
            assert!(away < 1e-9, "{:?}: {away:.1e}", corrected.method);
        }
    }
}

/// Along the span the displacement is linear on a face: second order.
#[test]
fn a_curved_shape_is_second_order() {
    let error = |boxes: usize| {
        let surface = Surface::trapezoid("wing", ([0.0; 3], 0.5587), ([0.8094, 0.762, 0.0], 0.3682), boxes, boxes);
        let lattice = Lattice::new(vec![surface], PlaneSymmetry::Symmetric).unwrap();
        let wing = Aerodynamics::new(lattice, Kernel::QUARTIC, super::wing::SEMICHORD_M).unwrap();
        let recording = with_shape(&numbered(pitching(&wing), 7), |p| {
            let (eta, x) = (p[1] / 0.762, p[0] - 0.3);
            [0.0, 0.0, eta * eta + x * x + 0.5 * eta * x]
        });
        let found = take(&wing, &[recording]).references.motion;
        let mut exact = BoxMotion::empty(wing.lattice().n_boxes());
        exact.push_field(wing.lattice(), Default::default(), |_, p| {
            let (eta, x) = (p[1] / 0.762, p[0] - 0.3);
            (eta * eta + x * x + 0.5 * eta * x, 2.0 * x + 0.5 * eta)
        });
        apart(&found, &exact)
    };
    let (coarse, fine) = (error(8), error(16));
    assert!(fine < 0.02 && coarse / fine > 3.0, "{coarse:.2e} {fine:.2e}");
}

#[test]
fn a_recorded_mode_is_the_case_s_if_its_shape_is() {
    let wing = wing();
    let own = moving_mode(&wing, 0, OMEGA_RAD_S);
    let all = take(&wing, &[with_shape(&own, bending)]);
    assert_eq!(all.references.mode_of, [Some(0)]);
    assert!(all.notes.is_empty(), "{:?}", all.notes);
    let without = take(&wing, &[own.record().unwrap()]);
    assert_eq!(all.references.motion, without.references.motion);

    // The same number, another normalization: taken for the mode itself it would be wrong by that factor.
    let twice = with_shape(&moving_mode(&wing, 0, OMEGA_RAD_S), |p| bending(p).map(|u| 2.0 * u));
    let all = take(&wing, &[twice]);
    assert_eq!(all.references.mode_of, [None]);
    assert!(all.notes[0].contains("times the case's mode 1"), "{:?}", all.notes);
    let scale = all.references.motion.at_control.iter().zip(&own.motion.at_control);
    assert!(largest(scale.map(|(a, b)| (a - 2.0 * b).abs())) < 0.02);
}

/// Modes of the same number from two structures are two motions.
#[test]
fn shapes_are_not_mixed_up() {
    let wing = wing();
    let one = with_shape(&numbered(pitching(&wing), 1), pitching_shape);
    let other = with_shape(&moving_mode(&wing, 0, OMEGA_RAD_S), bending);
    let all = take(&wing, &[one.clone(), other, one]);
    assert_eq!(all.references.mode_of, [None, Some(0)]);
    assert_eq!(all.mapped.iter().map(|m| m.coordinate).collect::<Vec<_>>(), [0, 1, 0]);
}
