//! CGNS: round trips are exact, files of other programs read, broken ones are errors.
#![cfg(feature = "cgns")]

use std::path::{Path, PathBuf};

use dip_grid::cgns;
use dip_grid::connect::{Options, find_interfaces};
use dip_grid::generate::BoxGrid;
use dip_grid::{Condition, Face, MultiBlock, Period, Window, file, quality, recipe, reorient, split};
use proptest::prelude::*;

fn wavy(cells: [usize; 3]) -> MultiBlock {
    BoxGrid::new([-1.0, 0.0, 0.3], [2.0, 1.0, 1.7], cells).wavy(0.04).make()
}

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

fn round_trip(grid: &MultiBlock) {
    let read = cgns::parse("test.cgns", cgns::encode(grid)).unwrap();
    assert_eq!(read.notes, [""; 0]);
    assert!(!read.single);
    // Patches and interfaces come zone by zone, in the order of their names.
    let patches = |g: &MultiBlock| {
        let mut all = g.topology.patches.clone();
        all.sort_by_key(|p| (p.block, p.face, p.window));
        all
    };
    assert_eq!(patches(&read.grid), patches(grid));
    let sorted = |g: &MultiBlock| {
        let mut all: Vec<_> = g.topology.interfaces.clone();
        for i in &mut all {
            if i.b < i.a {
                *i = i.reversed();
            }
        }
        all.sort_by_key(|i| (i.a, i.b));
        all
    };
    assert_eq!(sorted(&read.grid), sorted(grid));
    for (a, b) in grid.blocks.iter().zip(&read.grid.blocks) {
        assert_eq!((&a.x, &a.y, &a.z), (&b.x, &b.y, &b.z));
        assert_eq!(a.cells(), b.cells());
    }
}

#[test]
fn round_trips_are_exact() {
    let mut whole = wavy([8, 6, 4]);
    split::split_block(&mut whole, 0, 0, 3);
    split::split_block(&mut whole, 1, 1, 2);
    round_trip(&whole);
    for axes in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]] {
        for bits in 0..8 {
            let mut grid = whole.clone();
            reorient::reorient(&mut grid, 1, axes, [bits & 1 != 0, bits & 2 != 0, bits & 4 != 0]);
            round_trip(&grid);
        }
    }
    for shipped in ["agard445_oo_coarsest", "agard445_ch_coarsest", "box", "naca0012_blunt"] {
        round_trip(&recipe::make(&repository(&format!("meshes/{shipped}.toml"))).unwrap());
    }
}

#[test]
fn periodic_translations_survive_single_precision() {
    let (from, to) = ([0.1, 0.0, 0.0], [0.1 + 1.0 / 3.0, 1.0, 1.0]);
    let mut grid = BoxGrid::new(from, to, [4, 4, 4]).wavy(0.02).make();
    grid.topology.patches.clear();
    let periodic = vec![Period::Translation([1.0 / 3.0, 0.0, 0.0])];
    find_interfaces(
        &mut grid,
        &Options {
            tolerance: None,
            periodic,
        },
    );
    assert_eq!(grid.topology.interfaces.len(), 1);
    let read = cgns::parse("test.cgns", cgns::encode(&grid)).unwrap();
    let (old, new) = (grid.topology.interfaces[0], read.grid.topology.interfaces[0]);
    assert_eq!((old.a, old.b, old.orientation), (new.a, new.b, new.orientation));
    let (Some(Period::Translation(old)), Some(Period::Translation(new))) = (old.period, new.period) else {
        panic!("{old:?} {new:?}");
    };
    assert!((0..3).all(|d| (old[d] - new[d]).abs() < 1e-15), "{new:?}");
}

/// What the files hold is said in tests/data/grids/write_cgns.py. The CGNS library (4.4, by `cg_1to1_read` and
/// `cg_boco_info`) reads the same out of them.
#[test]
fn a_file_written_node_by_node_reads() {
    let read = cgns::read(&repository("tests/data/grids/by_hand.cgns")).unwrap();
    assert!(read.single);
    assert_eq!(read.notes, [""; 0]);
    let [first, second] = &read.grid.blocks[..] else {
        panic!("{} blocks", read.grid.blocks.len())
    };
    assert_eq!((first.name.as_str(), first.cells()), ("zone 2", [4, 3, 2]));
    assert_eq!((second.name.as_str(), second.cells()), ("zone 10", [3, 2, 2]));
    // The planes of ghost nodes are gone.
    assert_eq!(
        (first.point(0, 0, 0), first.point(4, 3, 2)),
        ([0.0; 3], [4.0, 3.0, 2.0])
    );
    assert_eq!(
        (second.point(0, 0, 0), second.point(3, 2, 2)),
        ([4.0, 3.0, 0.0], [6.0, 0.0, 2.0])
    );
    let [round, between] = read.grid.topology.interfaces[..] else {
        panic!("{:?}", read.grid.topology)
    };
    let on = |side: dip_grid::Side, node: [usize; 2]| {
        let block = &read.grid.blocks[side.block];
        block.point_at(block.node_behind(side.face, node[0], node[1], 0))
    };
    for interface in [between, round] {
        let moved = interface.period.map_or(0.0, |by| by.moved([0.0; 3])[1]);
        for q in interface.a.window.lo[1]..=interface.a.window.hi[1] {
            for p in interface.a.window.lo[0]..=interface.a.window.hi[0] {
                let [x, y, z] = on(interface.a, [p, q]);
                assert_eq!(on(interface.b, interface.node_on_b(p, q)), [x, y + moved, z]);
            }
        }
    }
    // "and back" is read before "round", which says the same.
    assert_eq!(
        (between.period, round.period),
        (None, Some(Period::Translation([0.0, -3.0, 0.0])))
    );
    let patch = |block: usize, face: Face| {
        let found: Vec<_> = read
            .grid
            .topology
            .patches
            .iter()
            .filter(|p| p.block == block && p.face == face)
            .collect();
        assert_eq!(found.len(), 1, "{block} {face}");
        (found[0].name.as_str(), found[0].condition, found[0].window)
    };
    let full = |a, b| Window::full([a, b]);
    assert_eq!(patch(0, Face::IMin), ("Inlet", Condition::InflowSubsonic, full(3, 2)));
    assert_eq!(patch(1, Face::JMax), ("Outlet", Condition::OutflowSubsonic, full(3, 2)));
    assert_eq!(patch(0, Face::KMin), ("Wing", Condition::WallSlip, full(4, 3)));
    assert_eq!(patch(0, Face::KMax), ("Wing", Condition::WallNoSlip, full(4, 3)));
    assert_eq!(patch(1, Face::KMin), ("bottom", Condition::Symmetry, full(3, 2)));
    assert_eq!(patch(1, Face::KMax), ("top", Condition::Symmetry, full(3, 2)));
}

#[test]
fn a_two_dimensional_file_opens_one_cell_across() {
    let opened = file::open(&repository("tests/data/grids/plane.cgns"), None).unwrap();
    assert!(
        opened.notes.iter().any(|n| n.contains("Millimeter")),
        "{:?}",
        opened.notes
    );
    assert!(opened.grid.is_two_dimensional());
    let report = quality::check(&opened.grid);
    assert!(report.is_good(), "{report}");
    // Ahead of the strip half an ellipse, behind it two rectangles: 8 + 8 cells of 1/2 and what the nose adds.
    assert!((report.volume - 9.0).abs() < 1e-12, "{}", report.volume);
    let wake = opened.grid.topology.interfaces[0];
    assert_eq!((wake.a.window.count(), wake.b.window.count()), (2, 2));
}

/// gmsh writes with the CGNS library itself; its donors are named otherwise than its zones, and its conditions have no type.
#[test]
fn a_file_of_gmsh_opens() {
    let opened = file::open(&repository("tests/data/grids/gmsh.cgns"), None).unwrap();
    let report = quality::check(&opened.grid);
    assert!(report.is_good(), "{report}");
    assert_eq!((report.cells, opened.grid.topology.interfaces.len()), (192, 1));
    assert!((report.volume - 3.0).abs() < 1e-12);
    let faces = |wanted: Condition| {
        let of = opened.grid.topology.patches.iter().filter(|p| p.condition == wanted);
        of.map(|p| p.window.count()).sum::<usize>()
    };
    assert_eq!(faces(Condition::Wall), 4 * 16 + 4 * 32);
    assert_eq!(
        (faces(Condition::InflowSubsonic), faces(Condition::OutflowSubsonic)),
        (16, 16)
    );
}

#[test]
fn saving_and_opening_keeps_grid_and_topology() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grid.cgns");
    let mut grid = wavy([8, 6, 4]);
    split::split_into(&mut grid, 4);
    file::save(&path, &grid, dip_grid::plot3d::Layout::default()).unwrap();
    let opened = file::open(&path, None).unwrap();
    assert_eq!(opened.grid.blocks, grid.blocks);
    assert!(quality::check(&opened.grid).is_good());
}

#[test]
fn broken_files_say_what_is_wrong() {
    let error = |bytes: Vec<u8>| cgns::parse("broken.cgns", bytes).unwrap_err().to_string();
    assert!(error(Vec::new()).contains("broken.cgns: the file is empty"));
    assert!(error(b"2 2 2 0 0 0".to_vec()).contains("not a CGNS file"));
    assert!(error(b"@(#)ADF Database Version A02011>".to_vec()).contains("adf2hdf"));
    let grid = wavy([4, 3, 2]);
    let whole = cgns::encode(&grid);
    error(whole[..whole.len() / 2].to_vec());
    let by_hand = std::fs::read(repository("tests/data/grids/by_hand.cgns")).unwrap();
    assert!(error(by_hand).contains("links to the file parts.cgns"));
    let mut nan = grid;
    nan.blocks[0].y[7] = f64::NAN;
    assert!(error(cgns::encode(&nan)).contains("CoordinateY of node 7"));
}

proptest! {
    // More cases for a long search: DIP_FUZZ_CASES=10000000.
    #![proptest_config(ProptestConfig {
        cases: std::env::var("DIP_FUZZ_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(300),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn damaged_cgns_files_never_panic(
        which in 0usize..4,
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        end in proptest::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = match which {
            0 => std::fs::read(repository("tests/data/grids/gmsh.cgns")).unwrap(),
            1 => std::fs::read(repository("tests/data/grids/plane.cgns")).unwrap(),
            2 => std::fs::read(repository("tests/data/grids/parts.cgns")).unwrap(),
            _ => cgns::encode(&wavy([3, 2, 2])),
        };
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if let Some(end) = end {
            bytes.truncate(end.index(bytes.len() + 1));
        }
        if let Ok(read) = cgns::parse("damaged", bytes) {
            for block in &read.grid.blocks {
                prop_assert_eq!(block.x.len(), block.node_count());
            }
        }
    }
}
