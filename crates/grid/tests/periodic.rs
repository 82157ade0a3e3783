//! Interfaces that are periodic by rotation: found by points when declared, written and read back, refused where wrong.

use dip_grid::connect::{Options, find_interfaces};
use dip_grid::generate::box_grid;
use dip_grid::plot3d::Layout;
use dip_grid::{Condition, Face, MultiBlock, Period, boundary_file, file, quality, split};

/// A wedge of `angle_deg` about the x axis through y = 1, z = 2, radii 1 to 3, i along x, j out, k round.
fn wedge(angle_deg: f64, nk: usize) -> MultiBlock {
    let mut grid = box_grid([0.0; 3], [1.0; 3], [4, 3, nk]);
    grid.topology.patches.clear();
    let block = &mut grid.blocks[0];
    for k in 0..=nk {
        for j in 0..=3 {
            for i in 0..=4 {
                let (radius, angle) = (
                    1.0 + 2.0 * (j as f64 / 3.0).powi(2),
                    (angle_deg * k as f64 / nk as f64).to_radians(),
                );
                let x = 0.5 * i as f64;
                block.set_point([i, j, k], [x, 1.0 + radius * angle.cos(), 2.0 + radius * angle.sin()]);
            }
        }
    }
    grid
}

fn turn(angle_deg: f64) -> Period {
    Period::Rotation {
        centre: [7.0, 1.0, 2.0],
        axis: [3.0, 0.0, 0.0],
        angle_deg,
    }
}

#[test]
fn a_turn_about_an_axis_is_a_turn() {
    let by = Period::Rotation {
        centre: [1.0, 0.0, 0.0],
        axis: [0.0, 0.0, 2.0],
        angle_deg: 90.0,
    };
    let close = |p: [f64; 3], q: [f64; 3]| p.iter().zip(q).all(|(a, b)| (a - b).abs() < 1e-15);
    assert!(close(by.moved([2.0, 0.0, 5.0]), [1.0, 1.0, 5.0]));
    assert!(close(by.inverse().moved([1.0, 1.0, 5.0]), [2.0, 0.0, 5.0]));
    assert!(close(by.scaled(2.0).moved([4.0, 0.0, 5.0]), [2.0, 2.0, 5.0]));
}

#[test]
fn sides_of_a_wedge_are_found_and_written_back() {
    for (angle, blocks) in [(30.0, 1), (30.0, 4), (-72.0, 2)] {
        let mut grid = wedge(angle, 4);
        split::split_into(&mut grid, blocks);
        grid.topology.interfaces.clear();
        let none = find_interfaces(&mut grid.clone(), &Options::default());
        assert_eq!(none.periodic, 0);
        let options = Options {
            tolerance: None,
            periodic: vec![turn(angle)],
        };
        let found = find_interfaces(&mut grid, &options);
        let turned: Vec<_> = grid.topology.interfaces.iter().filter(|i| i.period.is_some()).collect();
        assert_eq!(turned.iter().map(|i| i.a.window.count()).sum::<usize>(), 12);
        assert!(turned.iter().all(|i| i.a.face == Face::KMin && i.b.face == Face::KMax));
        assert_eq!((found.periodic, found.free), (turned.len(), 2 * (12 + 16)));
        let report = quality::check(&grid);
        assert!(report.findings.iter().all(|f| !f.text.contains("apart")), "{report}");
        let text = boundary_file::format(&grid.topology);
        assert_eq!(boundary_file::parse("x.bc.toml", &text, &grid).unwrap(), grid.topology);
        // The wrong angle: the check says that the nodes are apart.
        let mut wrong = grid.clone();
        for interface in &mut wrong.topology.interfaces {
            interface.period = interface.period.map(|_| turn(angle + 1.0));
        }
        let report = quality::check(&wrong);
        assert!(
            report.findings.iter().any(|f| f.fatal && f.text.contains("apart")),
            "{report}"
        );
    }
}

/// CFL3D's axisymmetric cases are one cell across and periodic by rotation (type 2005 with an angle).
#[test]
fn a_declared_turn_joins_the_sides_of_a_grid_one_cell_across() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wedge.xyz");
    let grid = wedge(1.0, 1);
    file::save(&path, &grid, Layout::default()).unwrap();
    let beside = path.with_extension("bc.toml");
    let periodic = "[[periodic]]\nrotation = { centre = [0, 1, 2], axis = [1, 0, 0], angle_deg = 1 }\n";
    std::fs::write(&beside, periodic).unwrap();
    let opened = file::open(&path, None).unwrap();
    assert_eq!(opened.grid.topology.interfaces.len(), 1, "{:?}", opened.notes);
    assert!(opened.grid.topology.interfaces[0].period.is_some());
    assert!(
        !opened
            .grid
            .topology
            .patches
            .iter()
            .any(|p| p.condition == Condition::Symmetry)
    );
    // Without the word, the sides are symmetry planes.
    std::fs::remove_file(&beside).unwrap();
    std::fs::remove_file(path.with_extension("nmf")).unwrap();
    let opened = file::open(&path, None).unwrap();
    assert!(opened.grid.is_two_dimensional());
    for (text, what) in [
        ("[[periodic]]\n", "a translation or a rotation is needed"),
        ("[[periodic]]\ntranslation = [0, 0, 0]\n", "not all zero"),
        (
            "[[periodic]]\nrotation = { axis = [0, 0, 0], angle_deg = 3 }\n",
            "axis that is not zero",
        ),
        (
            "[[periodic]]\nrotation = { axis = [0, 0, 1], angle_deg = nan }\n",
            "angle that is not zero",
        ),
        ("[[periodic]]\nturn = 3\n", "unknown field"),
    ] {
        std::fs::write(&beside, text).unwrap();
        let error = file::open(&path, None).unwrap_err().to_string();
        assert!(error.contains(what) && error.contains("wedge.bc.toml"), "{error}");
    }
}

#[cfg(feature = "cgns")]
#[test]
fn turns_about_axes_of_coordinates_survive_cgns() {
    let mut grid = wedge(30.0, 4);
    let options = Options {
        tolerance: None,
        periodic: vec![turn(30.0)],
    };
    find_interfaces(&mut grid, &options);
    let read = dip_grid::cgns::parse("x.cgns", dip_grid::cgns::encode(&grid)).unwrap();
    assert_eq!(read.grid.topology.interfaces.len(), 1);
    let Some(Period::Rotation { angle_deg, axis, .. }) = read.grid.topology.interfaces[0].period else {
        panic!("{:?}", read.grid.topology);
    };
    // The file has radians in single precision; 30 degrees is a twelfth of a circle.
    assert_eq!((angle_deg, axis), (30.0, [1.0, 0.0, 0.0]));
    let report = quality::check(&read.grid);
    assert!(report.findings.iter().all(|f| !f.text.contains("apart")), "{report}");
}
