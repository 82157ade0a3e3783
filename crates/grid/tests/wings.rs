//! Wings that nobody tuned the generators for: swept, tapered, cranked, twisted, cambered, with dihedral.

use dip_grid::generate::{WingCh, WingOo};
use dip_grid::geometry::{Section, Station, TipShape, TrailingEdge, Wing};
use dip_grid::quality::{self, names};
use proptest::prelude::*;

#[derive(Clone, Debug)]
struct Panel {
    span: f64,
    sweep_deg: f64,
    taper: f64,
    twist_deg: f64,
    dihedral_deg: f64,
    digits: [u32; 3],
}

fn panel(flat: bool) -> impl Strategy<Value = Panel> {
    let (twist, dihedral, camber) = if flat { (0.0, 0.0, 0) } else { (4.0, 8.0, 4) };
    (
        0.8f64..4.0,
        -15.0f64..55.0,
        0.35f64..1.0,
        -twist..=twist,
        -dihedral..=dihedral,
        [0..=camber, 2u32..=5, 4u32..=16],
    )
        .prop_map(|(span, sweep_deg, taper, twist_deg, dihedral_deg, digits)| Panel {
            span,
            sweep_deg,
            taper,
            twist_deg,
            dihedral_deg,
            digits,
        })
}

fn section([camber, at, thickness]: [u32; 3]) -> Section {
    let at = if camber == 0 { 0 } else { at };
    Section::naca4(&format!("{camber}{at}{thickness:02}"))
        .unwrap()
        .with_trailing_edge(TrailingEdge::Closed)
        .unwrap()
}

fn wing(panels: &[Panel], tip: TipShape) -> Wing {
    let mut stations = vec![Station {
        y: 0.0,
        x_le: 0.0,
        z_le: 0.0,
        chord: 1.0,
        twist_deg: 0.0,
        section: section(panels[0].digits),
    }];
    for p in panels {
        let last = &stations[stations.len() - 1];
        let next = Station {
            y: last.y + p.span,
            x_le: last.x_le + p.span * p.sweep_deg.to_radians().tan(),
            z_le: last.z_le + p.span * p.dihedral_deg.to_radians().tan(),
            chord: last.chord * p.taper,
            twist_deg: p.twist_deg,
            section: section(p.digits),
        };
        stations.push(next);
    }
    let chord = stations[stations.len() - 1].chord;
    Wing {
        stations,
        tip,
        tip_length: 0.01 * f64::from(panels[panels.len() - 1].digits[2]) * chord,
    }
}

fn tip() -> impl Strategy<Value = TipShape> {
    prop_oneof![Just(TipShape::Rounded), Just(TipShape::Tapered)]
}

fn check(grid: &dip_grid::MultiBlock) -> Result<(), TestCaseError> {
    let report = quality::check(grid);
    let volume = report.figure(names::VOLUME).map(|f| f.worst[0].value);
    prop_assert!(volume > Some(0.0), "{report}");
    prop_assert!(report.findings.iter().all(|f| !f.fatal), "{report}");
    // Steep camber lines fold no corner of the sheet outboard of the tip.
    let jacobian = report.figure(names::JACOBIAN).map(|f| f.worst[0].value);
    prop_assert!(jacobian > Some(-0.1), "{report}");
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: std::env::var("DIP_WING_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(14),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn ch_grids_of_any_wing_have_positive_volumes(
        panels in proptest::collection::vec(panel(false), 1..3),
        tip in tip(),
        fine in any::<bool>(),
    ) {
        let wing = wing(&panels, tip);
        let (span, tip_length) = (wing.tip_y(), wing.tip_length);
        let last = &wing.stations[wing.stations.len() - 1];
        let tail = last.x_le.max(0.0) + 4.0;
        let grid = WingCh {
            surface: 24,
            wake: 12,
            normal: if fine { 32 } else { 20 },
            span: 16,
            outboard: 10,
            wall_spacing: if fine { 5e-5 } else { 3e-3 },
            nose_spacing: 0.006,
            tail_spacing: 0.012,
            root_spacing: 0.1 * span,
            tip_spacing: 0.3 * tip_length,
            far_field: 12.0,
            exit: 12.0 + tail,
            wake_growth: 1.0,
            straight_sheet: true,
            growth_limit: 3.0,
            stride: 1,
            wing,
        }
        .make();
        match grid {
            Ok(grid) => check(&grid)?,
            Err(e) => prop_assert!(false, "{e}"),
        }
    }

    #[test]
    fn oo_grids_of_any_wing_have_positive_volumes(
        flat in any::<bool>(),
        general in proptest::collection::vec(panel(false), 1..3),
        symmetric in proptest::collection::vec(panel(true), 1..3),
        tip in tip(),
    ) {
        let panels = if flat { symmetric } else { general };
        let wing = wing(&panels, tip);
        let (span, tip_length) = (wing.tip_y(), wing.tip_length);
        let grid = WingOo {
            surface: 24,
            normal: 24,
            span: 16,
            wall_spacing: 2e-3,
            nose_spacing: 0.006,
            tail_spacing: 0.012,
            root_spacing: 0.1 * span,
            tip_spacing: 0.3 * tip_length,
            far_field: 3.0 * span + 8.0,
            growth_limit: 3.0,
            stride: 1,
            wing,
        }
        .make();
        match grid {
            Ok(grid) => check(&grid)?,
            Err(e) => prop_assert!(false, "{e}"),
        }
    }
}
