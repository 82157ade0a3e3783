//! Files: what is written is read back to the bit; what is damaged is refused.

use dip_dlm::ComplexMatrix;
use dip_dlm::aic::Aerodynamics;
use dip_dlm::gaf::{GeneralizedForceTable, Interpolation, PointRule, TableError, generalized_forces};
use dip_dlm::kernel::Kernel;
use dip_dlm::lattice::{Lattice, PlaneSymmetry, Surface};
use dip_dlm::motion::BoxMotion;
use dip_dlm::store::{StoreError, StoredAic};

fn model(chord: f64, kernel: Kernel) -> Aerodynamics {
    let wing = Surface::trapezoid("wing", ([0.0, 0.0, 0.0], chord), ([0.5, 2.0, 0.3], 0.7), 3, 4);
    Aerodynamics::new(Lattice::new(vec![wing], PlaneSymmetry::Symmetric).unwrap(), kernel, 0.5).unwrap()
}

fn motion(model: &Aerodynamics) -> BoxMotion {
    let mut motion = BoxMotion::empty(model.lattice().n_boxes());
    motion.push_field(model.lattice(), PointRule::ControlPoint, |_, p| (p[1] * p[0], p[1]));
    motion.push_field(model.lattice(), PointRule::ControlPoint, |_, p| (p[1], 0.0));
    motion
}

#[test]
fn aic_round_trip_and_use() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wing.aic");
    let model = model(1.0, Kernel::QUARTIC);
    let stored = StoredAic::compute(&model, &[0.3, 0.6], &[0.0, 0.2]).unwrap();
    stored.save(&path).unwrap();
    let read = StoredAic::load(&path).unwrap();
    assert_eq!(stored, read);
    read.check(&model).unwrap();
    // Pressures from the stored coefficients are those of the solution.
    let motion = motion(&model);
    let direct = &model.pressures(0.6, &[0.2], &motion).unwrap()[0];
    let again = read.get(0.6, 0.2).unwrap().times(&motion.downwash(0.2 / 0.5));
    let difference: f64 = direct
        .data()
        .iter()
        .zip(again.data())
        .map(|(a, b)| (a - b).norm())
        .sum();
    assert!(difference < 1e-11 * direct.norm());
    assert!(matches!(read.get(0.6, 0.21), Err(StoreError::Condition { .. })));
}

#[test]
fn aic_of_another_model_is_refused() {
    let base = model(1.0, Kernel::QUARTIC);
    let stored = StoredAic::compute(&base, &[0.3], &[0.2]).unwrap();
    for other in [model(1.1, Kernel::QUARTIC), model(1.0, Kernel::NASTRAN)] {
        assert!(matches!(stored.check(&other), Err(StoreError::Stamp { .. })));
    }
    let other_b = Aerodynamics::new(base.lattice().clone(), base.kernel(), 0.6).unwrap();
    assert!(matches!(stored.check(&other_b), Err(StoreError::Stamp { .. })));
}

/// Any byte changed, cut short at any length, or lengthened: an error, never a panic or a wrong answer.
#[test]
fn damaged_aic_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wing.aic");
    StoredAic::compute(&model(1.0, Kernel::QUARTIC), &[0.3], &[0.2])
        .unwrap()
        .save(&path)
        .unwrap();
    let good = std::fs::read(&path).unwrap();
    for at in (0..80).chain((80..good.len()).step_by(61)) {
        let mut bytes = good.clone();
        bytes[at] ^= 0x41;
        std::fs::write(&path, &bytes).unwrap();
        assert!(StoredAic::load(&path).is_err(), "byte {at}");
    }
    for length in (0..100).chain((100..good.len()).step_by(97)) {
        std::fs::write(&path, &good[..length]).unwrap();
        assert!(StoredAic::load(&path).is_err(), "length {length}");
    }
    let mut longer = good.clone();
    longer.push(0);
    std::fs::write(&path, &longer).unwrap();
    assert!(StoredAic::load(&path).is_err());
    assert!(matches!(
        StoredAic::load(&folder.path().join("none.aic")),
        Err(StoreError::File { .. })
    ));
}

#[test]
fn table_round_trip() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("q.json");
    let model = model(1.0, Kernel::NASTRAN);
    let table = generalized_forces(&model, &motion(&model), &[0.3, 0.6], &[0.0, 0.1, 0.2]).unwrap();
    table.save(&path).unwrap();
    assert_eq!(GeneralizedForceTable::load(&path).unwrap(), table);
    let at = table.at_mach(0.6, Interpolation::Spline).unwrap();
    assert_eq!(at.at(0.1).unwrap()[(1, 0)], table.q[1][1][(1, 0)]);
    assert!(matches!(
        table.at_mach(0.5, Interpolation::Spline),
        Err(TableError::Mach { .. })
    ));
    let text = table.to_json().unwrap();
    for bad in [
        text.replacen("\"version\":1", "\"version\":2", 1),
        text.replacen("\"n_modes\":2", "\"n_modes\":3", 1),
        text.replacen("parabolic", "cubic", 1),
        text.replacen("\"mach\":[0.3", "\"mach\":[0.1,0.3", 1),
        text[..text.len() / 2].to_string(),
        String::new(),
        "{}".into(),
    ] {
        assert_ne!(bad, text);
        assert!(matches!(
            GeneralizedForceTable::from_json(&bad),
            Err(TableError::Data { .. })
        ));
    }
    let mut nan = table;
    nan.q[0][0] = ComplexMatrix::from_fn(2, 2, |_, _| dip_dlm::c64::new(f64::NAN, 0.0));
    assert!(nan.to_json().is_err());
}
