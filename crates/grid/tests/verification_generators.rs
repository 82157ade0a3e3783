//! Exact properties of what the generators make: walls, spacings, levels, areas, threads.

mod fits;

use fits::assert_fits;

use dip_grid::generate::{AerofoilGrid, AerofoilKind, WingCh, WingOo};
use dip_grid::geometry::{Section, Station, TipShape, TrailingEdge, Wing};
use dip_grid::vector::{dot, norm, sub};
use dip_grid::{Metrics, MultiBlock, coarsen, quality};

fn section(treatment: TrailingEdge) -> Section {
    Section::naca4("0012").unwrap().with_trailing_edge(treatment).unwrap()
}

fn aerofoil(kind: AerofoilKind, treatment: TrailingEdge, wall_spacing: f64) -> AerofoilGrid {
    AerofoilGrid {
        kind,
        section: section(treatment),
        chord: 1.0,
        surface: 48,
        wake: 24,
        normal: 40,
        base: 4,
        wall_spacing,
        nose_spacing: 0.003,
        tail_spacing: 0.005,
        far_field: 20.0,
        wake_growth: 1.0,
        growth_limit: 2.0,
    }
}

fn wing(tip: TipShape) -> Wing {
    let at = |y: f64, x_le: f64, chord: f64| Station {
        y,
        x_le,
        z_le: 0.0,
        chord,
        twist_deg: 0.0,
        section: section(TrailingEdge::Sharp),
    };
    Wing {
        stations: vec![at(0.0, 0.0, 1.0), at(1.5, 1.0, 0.6)],
        tip,
        tip_length: 0.04,
    }
}

fn wing_oo(stride: usize) -> WingOo {
    WingOo {
        wing: wing(TipShape::Rounded),
        surface: 24,
        normal: 24,
        span: 16,
        wall_spacing: 1e-3,
        nose_spacing: 0.006,
        tail_spacing: 0.01,
        root_spacing: 0.15,
        tip_spacing: 0.02,
        far_field: 12.0,
        growth_limit: 2.0,
        stride,
    }
}

fn wing_ch(stride: usize, tip: TipShape) -> WingCh {
    WingCh {
        wing: wing(tip),
        surface: 24,
        wake: 12,
        normal: 24,
        span: 16,
        outboard: 8,
        wall_spacing: 1e-3,
        nose_spacing: 0.006,
        tail_spacing: 0.01,
        root_spacing: 0.15,
        tip_spacing: 0.02,
        far_field: 10.0,
        exit: 12.0,
        wake_growth: 1.0,
        straight_sheet: true,
        growth_limit: 2.0,
        stride,
    }
}

fn assert_good(grid: &MultiBlock) {
    assert_fits(grid);
    let report = quality::check(grid);
    assert!(report.is_good(), "{report}");
    assert!(report.figure(quality::names::VOLUME).unwrap().worst[0].value > 0.0);
}

#[test]
fn aerofoil_grids_fit_and_have_the_wall_spacing_asked_for() {
    for kind in [AerofoilKind::C, AerofoilKind::O] {
        for spacing in [1e-3, 2e-6] {
            for treatment in [TrailingEdge::Sharp, TrailingEdge::Blunt, TrailingEdge::Closed] {
                let grid = aerofoil(kind, treatment, spacing).make().unwrap();
                assert_good(&grid);
                assert!(grid.is_two_dimensional());
                let block = &grid.blocks[0];
                for patch in grid.topology.patches.iter().filter(|p| p.name == "aerofoil") {
                    for i in patch.window.lo[0]..=patch.window.hi[0] {
                        let step = norm(sub(block.point(i, 1, 0), block.point(i, 0, 0)));
                        assert!(
                            (step / spacing - 1.0).abs() < 0.02,
                            "{kind:?} {i} {step:e} for {spacing:e}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn cambered_thick_and_thin_sections_make_good_grids() {
    for digits in ["4412", "6409", "2424", "0003"] {
        for kind in [AerofoilKind::C, AerofoilKind::O] {
            let section = Section::naca4(digits)
                .unwrap()
                .with_trailing_edge(TrailingEdge::Sharp)
                .unwrap();
            let grid = AerofoilGrid {
                section,
                ..aerofoil(kind, TrailingEdge::Sharp, 1e-5)
            }
            .make()
            .unwrap();
            assert_good(&grid);
            // A line that starts at the wrong place of the map leaves the wall askew.
            let skewness = quality::check(&grid).figure(quality::names::SKEWNESS).unwrap().worst[0].value;
            assert!(skewness < 45.0, "{digits} {kind:?} {skewness}");
        }
    }
}

/// Wall nodes of a sharp section are on its formula; lines leave at a right angle (to the chord of two cells).
#[test]
fn aerofoil_walls_are_exact_and_lines_leave_them_at_right_angles() {
    let made = aerofoil(AerofoilKind::C, TrailingEdge::Sharp, 1e-4);
    let grid = made.make().unwrap();
    let block = &grid.blocks[0];
    let section = &made.section;
    for i in made.wake..=made.wake + 2 * made.surface {
        let [x, _, z] = block.point(i, 0, 0);
        let side = if i <= made.wake + made.surface { 1.0 } else { -1.0 };
        assert!((section.point(side * x.sqrt())[1] - z).abs() < 1e-12);
    }
    for i in made.wake + 2..made.wake + 2 * made.surface - 1 {
        let along = sub(block.point(i + 1, 0, 0), block.point(i - 1, 0, 0));
        let away = sub(block.point(i, 1, 0), block.point(i, 0, 0));
        let cosine = dot(along, away) / (norm(along) * norm(away));
        // The chord's direction differs from the tangent where steps or curvature change: a few degrees at the nose.
        assert!(cosine.abs() < 0.09, "{i} {cosine}");
    }
}

/// The area of the grid is that of the far boundary's polygon less the section's: by Green's theorem over the wall.
#[test]
fn volumes_sum_to_the_area_between_wall_and_far_field() {
    let grid = aerofoil(AerofoilKind::O, TrailingEdge::Sharp, 1e-3).make().unwrap();
    let block = &grid.blocks[0];
    let polygon = |j: usize| -> f64 {
        (0..block.ni)
            .map(|i| {
                let (p, q) = (block.point(i, j, 0), block.point(i + 1, j, 0));
                0.5 * (p[0] * q[2] - q[0] * p[2])
            })
            .sum()
    };
    let area: f64 = Metrics::new(block).volume.iter().sum();
    let expected = polygon(block.nj).abs() - polygon(0).abs();
    assert!((area / expected - 1.0).abs() < 1e-12);
    // The wall's polygon has the section's area, up to its own coarseness.
    let sharp = section(TrailingEdge::Sharp);
    let rule = |n: usize| -> f64 {
        let point = |m: usize| sharp.point(m as f64 / n as f64);
        (0..n)
            .map(|m| (point(m)[1] + point(m + 1)[1]) * (point(m + 1)[0] - point(m)[0]))
            .sum()
    };
    assert!(
        (polygon(0).abs() / rule(20_000) - 1.0).abs() < 3e-3,
        "{} {}",
        polygon(0),
        rule(20_000)
    );
}

#[test]
fn wing_grids_fit_and_have_positive_volumes() {
    for tip in [TipShape::Rounded, TipShape::Tapered] {
        assert_good(&wing_ch(1, tip).make().unwrap());
    }
    assert_good(&wing_oo(1).make().unwrap());
    let mut twisted = wing_ch(1, TipShape::Rounded);
    for (station, (twist_deg, z_le)) in twisted.wing.stations.iter_mut().zip([(1.0, 0.0), (-4.0, 0.1)]) {
        station.twist_deg = twist_deg;
        station.z_le = z_le;
        station.section = Section::naca4("2412")
            .unwrap()
            .with_trailing_edge(TrailingEdge::Sharp)
            .unwrap();
    }
    assert_good(&twisted.make().unwrap());
    let wrapped = WingOo {
        wing: twisted.wing,
        ..wing_oo(1)
    };
    assert_good(&wrapped.make().unwrap());
}

#[test]
fn coarser_levels_are_every_second_point_of_the_finer() {
    let pairs = [
        (
            wing_ch(1, TipShape::Rounded).make().unwrap(),
            wing_ch(2, TipShape::Rounded).make().unwrap(),
        ),
        (wing_oo(1).make().unwrap(), wing_oo(2).make().unwrap()),
    ];
    for (fine, coarse) in pairs {
        let kept = coarsen::coarsen(&fine).unwrap();
        assert_eq!(kept.topology, coarse.topology);
        let (a, b) = (&kept.blocks[0], &coarse.blocks[0]);
        assert_eq!((&a.x, &a.y, &a.z), (&b.x, &b.y, &b.z));
    }
}

#[test]
fn grids_do_not_depend_on_the_number_of_threads() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            (
                wing_oo(2).make().unwrap(),
                wing_ch(2, TipShape::Rounded).make().unwrap(),
            )
        })
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn too_few_cells_for_the_growth_limit_say_how_many_are_needed() {
    let mut made = aerofoil(AerofoilKind::C, TrailingEdge::Sharp, 1e-7);
    made.growth_limit = 1.2;
    let text = made.make().unwrap_err().to_string();
    assert!(text.contains("use at least"), "{text}");
    made.wall_spacing = f64::NAN;
    assert!(made.make().unwrap_err().to_string().contains("wall_spacing"));
    let mut far = wing_ch(1, TipShape::Rounded);
    far.exit = f64::NAN;
    assert!(far.make().unwrap_err().to_string().contains("exit"));
    let mut coarse = wing_oo(1);
    coarse.tip_spacing = 5.0;
    assert!(coarse.make().unwrap_err().to_string().contains("tip_spacing"));
    let mut odd = wing_oo(2);
    odd.span = 15;
    assert!(odd.make().unwrap_err().to_string().contains("multiple of 2"));
}

#[test]
fn the_wall_of_a_wing_lies_on_its_surface() {
    let made = wing_oo(1);
    let grid = made.make().unwrap();
    let block = &grid.blocks[0];
    for k in 0..=block.nk {
        for i in 0..=block.ni {
            let [x, y, z] = block.point(i, 0, k);
            let [x_le, _, chord] = made.wing.planform(y);
            let t = ((x - x_le) / chord).max(0.0).sqrt() * if 2 * i <= block.ni { 1.0 } else { -1.0 };
            let exact = made.wing.point(y, t);
            assert!((z - exact[2]).abs() < 1e-9, "{i} {k}");
        }
    }
}
