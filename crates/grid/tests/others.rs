//! Grids in the manner of other programs: tests/data/grids/write_plot3d.py writes the files, byte by byte.

use std::path::{Path, PathBuf};

use dip_grid::generate::box_grid;
use dip_grid::plot3d::{self, Encoding};
use dip_grid::{Condition, Face, Window, connect, file, nmf, quality};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/data/grids")
        .join(name)
}

#[test]
fn construct2d_grids_open_with_their_neutral_map() {
    let opened = file::open(&data("construct2d.p3d"), None).unwrap();
    assert!(opened.grid.is_two_dimensional());
    let report = quality::check(&opened.grid);
    assert!(report.is_good(), "{report}\n{:?}", opened.notes);
    // A ring of radii 1 and 5 of 16 corners.
    let area = 8.0 * (std::f64::consts::TAU / 16.0).sin() * 24.0;
    assert!((report.volume - area).abs() < 1e-6 * area, "{}", report.volume);
    let topology = &opened.grid.topology;
    assert_eq!(topology.interfaces.len(), 1);
    let on = |face: Face| {
        topology
            .patches
            .iter()
            .find(|p| p.face == face)
            .map(|p| (p.condition, p.window))
    };
    assert_eq!(on(Face::JMin), Some((Condition::WallNoSlip, Window::full([16, 1]))));
    assert_eq!(on(Face::JMax), Some((Condition::FarField, Window::full([16, 1]))));
}

#[test]
fn text_of_the_turbulence_modeling_resource_opens() {
    let mut opened = file::open(&data("tmr.p2dfmt"), None).unwrap();
    connect::fill_rest(&mut opened.grid, "rest", Condition::FarField);
    let report = quality::check(&opened.grid);
    assert!(report.is_good(), "{report}\n{:?}", opened.notes);
    assert!((report.volume - 9.0).abs() < 1e-12, "{}", report.volume);
    // The strip is closed here, as the wake is: both sides of it touch, the nose's point is where they part.
    let count: usize = opened.grid.topology.interfaces.iter().map(|i| i.a.window.count()).sum();
    assert_eq!(count, 4);
}

/// The Resource has one neutral map for both forms of a grid, in the plane and in two planes with i across.
#[test]
fn the_neutral_map_of_two_planes_serves_the_plane_too() {
    let folder = tempfile::tempdir().unwrap();
    let numbers = |planes: usize| {
        let mut text = String::new();
        for d in [0, 1, 2].into_iter().filter(|&d| planes == 2 || d != 1) {
            for j in 0..3 {
                for i in 0..4 {
                    for y in 0..planes {
                        text.push_str(&format!("{} ", [f64::from(i), -(y as f64), f64::from(j)][d]));
                    }
                }
            }
        }
        text
    };
    let map = "1\n1 2 4 3\n'symmetry_y' 1 3 1 4 1 3\n'symmetry_y' 1 4 1 4 1 3\n'tangency' 1 1 1 2 1 4\n\
               'farfield_riem' 1 2 1 2 1 4\n'back_pressure' 1 5 1 3 1 2\n'farfield_riem' 1 6 1 3 1 2\n";
    let mut patches = Vec::new();
    for (name, head, planes) in [("a.p2dfmt", "1\n4 3\n", 1), ("a.p3dfmt", "1\n2 4 3\n", 2)] {
        let path = folder.path().join(name);
        std::fs::write(&path, format!("{head}{}", numbers(planes))).unwrap();
        std::fs::write(path.with_extension("nmf"), map).unwrap();
        let opened = file::open(&path, None).unwrap();
        let report = quality::check(&opened.grid);
        assert!(report.is_good() && report.volume == 6.0, "{report}");
        assert_eq!(opened.grid.blocks[0].cells(), [3, 2, 1]);
        patches.push(opened.grid.topology.patches);
    }
    assert_eq!(patches[0], patches[1]);
    let on = |face: Face| patches[0].iter().find(|p| p.face == face).map(|p| p.condition);
    assert_eq!(on(Face::JMin), Some(Condition::WallSlip));
    assert_eq!(on(Face::IMin), Some(Condition::OutflowSubsonic));
}

#[test]
fn cfl3d_grids_open_with_the_size_before_each_block() {
    let read = plot3d::read(&data("cfl3d.grd")).unwrap();
    assert_eq!(
        read.blocks.iter().map(dip_grid::Block::cells).collect::<Vec<_>>(),
        [[4, 2, 1], [3, 2, 1]]
    );
    let layout = read.layout;
    assert_eq!(
        (layout.encoding, layout.double),
        (
            Encoding::Records {
                big_endian: true,
                marker: 4
            },
            false
        )
    );
    let mut opened = file::open(&data("cfl3d.grd"), None).unwrap();
    assert_eq!(opened.grid.topology.interfaces.len(), 1, "{:?}", opened.notes);
    connect::fill_rest(&mut opened.grid, "rest", Condition::FarField);
    let report = quality::check(&opened.grid);
    assert!(report.is_good() && opened.grid.is_two_dimensional(), "{report}");
    assert_eq!(report.volume, 14.0);
    assert!(
        !opened.notes.iter().any(|n| n.contains("left-handed")),
        "{:?}",
        opened.notes
    );
}

#[test]
fn overflow_grids_open_with_iblank() {
    let read = plot3d::read(&data("overflow.in")).unwrap();
    assert!(read.layout.iblank && read.layout.multi && read.layout.double);
    assert_eq!(
        read.blocks.iter().map(dip_grid::Block::nodes).collect::<Vec<_>>(),
        [[3, 4, 5], [4, 3, 4]]
    );
    assert_eq!(read.blocks[1].point(3, 2, 3), [13.0, 2.0, 3.0]);
    assert!(read.iblank.iter().flatten().flatten().all(|&v| v == 1));
}

#[test]
fn files_plane_by_plane_read() {
    let read = plot3d::read(&data("planes.x")).unwrap();
    assert!(read.layout.iblank && !read.layout.multi && !read.layout.double);
    let block = &read.blocks[0];
    for (i, j, k) in [(0, 0, 0), (3, 0, 1), (1, 2, 2)] {
        assert_eq!(block.point(i, j, k), [i as f64, j as f64, k as f64]);
        assert_eq!(
            read.iblank[0].as_ref().unwrap()[block.node(i, j, k)],
            (i + 4 * j) as i32
        );
    }
}

/// The neutral map of a C grid of 5 x 257 x 129 points printed in the FUN3D Manual (13.x, section 4.3.1, PLOT3D grids).
#[test]
fn the_neutral_map_of_the_fun3d_manual_reads() {
    let text = "# ===== Neutral Map File generated by the V2k software of NASA Langley's GEOLAB =====\n\
        # Block#    IDIM    JDIM    KDIM\n 1\n\n 1 5 257 129\n\n# Type B1 F1 S1 E1 S2 E2 B2 F2 S1 E1 S2 E2 Swap\n\
        'tangency '      1 3 1 257  1 129\n'tangency '      1 4 1 257  1 129\n\
        'farfield_extr ' 1 5 1 129  1   5\n'farfield_extr ' 1 6 1 129  1   5\n\
        'one-to-one '    1 1 1   5  1  41   1 1   1 5   257 217   false\n\
        'viscous_solid ' 1 1 1   5 41 217\n'farfield_riem ' 1 2 1   5  1 257\n";
    let mut grid = box_grid([0.0; 3], [1.0; 3], [4, 256, 128]);
    grid.topology = nmf::parse("c.nmf", text, &grid).unwrap();
    let wake = grid.topology.interfaces[0];
    assert_eq!((wake.a.face, wake.a.window), (Face::KMin, Window::new([0, 0], [4, 40])));
    assert_eq!((wake.node_on_b(0, 0), wake.node_on_b(4, 40)), ([0, 256], [4, 216]));
    // Every face cell has one owner.
    let report = quality::check(&grid);
    let says = |what: &str| report.findings.iter().any(|f| f.text.contains(what));
    assert!(!says("no condition") && !says("overlap"), "{report}");
}

/// As CFL3D's own cases print grids (nasa/CFL3D, testcase/Axibump/bumpgrd.fmt: commas between sizes and numbers, repeat counts for
/// the two planes of a wedge, no comma at some line ends, seventeen digits). First x of that file; the wedge of half a degree
/// to both sides is ours.
#[test]
fn text_as_cfl3d_prints_it_reads() {
    let x = " 2*-3.198855,  2*-2.996273,  2*-2.80402,  2*-2.6215700000000002,  2*-9.66374900000000064E-2,\n";
    let radius = [1.0, 1.2, 1.5];
    let mut text = String::from(" 1\n 2,  5,  3\n");
    text.push_str(&x.repeat(2));
    // The last line ends without a comma.
    text.push_str(x.trim_end().trim_end_matches(','));
    let angle = 0.5f64.to_radians();
    for value in [-angle.sin(), angle.cos()] {
        for r in radius {
            for _ in 0..5 {
                // The sines differ in sign between the planes, the cosines do not.
                if value < 0.0 {
                    text.push_str(&format!("\n {:.17E},  {:.17E},", r * value, -r * value));
                } else {
                    text.push_str(&format!("\n 2*{:.17},", r * value));
                }
            }
        }
    }
    let read = plot3d::parse("bumpgrd.fmt", text.as_bytes()).unwrap();
    let block = &read.blocks[0];
    assert_eq!(block.nodes(), [2, 5, 3]);
    assert_eq!(block.point(1, 4, 2)[0], -9.663_749e-2);
    assert!(block.point(0, 1, 2)[1] < 0.0 && block.point(1, 1, 2)[1] > 0.0);
    // With the turn of its CFL3D input (type 2005, one degree about x) its sides are each other's.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bumpgrd.fmt");
    std::fs::write(&path, &text).unwrap();
    let turn = "[[periodic]]\nrotation = { axis = [1, 0, 0], angle_deg = -1 }\n";
    std::fs::write(path.with_extension("bc.toml"), turn).unwrap();
    let opened = file::open(&path, None).unwrap();
    assert_eq!(opened.grid.topology.interfaces.len(), 1, "{:?}", opened.notes);
}

/// As CFL3D's flat plate stands there (testcase/Flatplate/grdflat5.fmt: one block without a count, sizes in columns of twelve,
/// five numbers a line with blanks behind them), and as pyHyp writes (mdolab/pyhyp, examples/sphere: sizes of two blocks a line).
#[test]
fn columns_of_fortran_programs_read() {
    let mut text = String::from("           3           2           2\n");
    for d in 0..3 {
        for n in 0..12 {
            let value = [n % 3, n / 3 % 2, n / 6][d] as f64 * -0.312_499_7;
            text.push_str(&format!("{value:15.7} "));
            if n % 5 == 4 {
                text.push_str("   \n");
            }
        }
    }
    let read = plot3d::parse("grdflat5.fmt", text.as_bytes()).unwrap();
    assert!(!read.layout.multi && !read.layout.iblank);
    assert_eq!(read.blocks[0].nodes(), [3, 2, 2]);
    assert_eq!(
        read.blocks[0].point(2, 1, 1),
        [-0.624_999_4, -0.312_499_7, -0.312_499_7]
    );
    let mut text =
        String::from("            3\n           2           2           2           2           2           2\n");
    text.push_str("           2           2           2\n");
    for block in 0..3 {
        for d in 0..3 {
            for n in 0..8 {
                let value = ((n >> d) & 1) as f64 + if d == 0 { block as f64 } else { 0.0 };
                text.push_str(&format!("{value:26.16E}{}", if n % 3 == 2 { "\n" } else { "" }));
            }
        }
        text.push('\n');
    }
    let read = plot3d::parse("blocks.fmt", text.as_bytes()).unwrap();
    assert_eq!(read.blocks.len(), 3);
    assert_eq!(read.blocks[2].point(1, 0, 1), [3.0, 0.0, 1.0]);
    // A surface (pyHyp, examples/2D/naca0012_euler.fmt: 257 x 2 x 1, one number a line) is no grid of cells, and that is said.
    let surface = format!("1\n3 2 1\n{}", "1\n0.5\n0\n".repeat(6));
    let error = plot3d::parse("naca0012_euler.fmt", surface.as_bytes())
        .unwrap_err()
        .to_string();
    assert!(error.contains("a surface, not a grid of cells"), "{error}");
}

/// Type names and numbers that are about: case, quotes, comments behind entries, numbers of CFL3D and FUN3D.
#[test]
fn types_of_neutral_maps_are_known_by_name_and_by_number() {
    for (name, condition) in [
        ("'VISCOUS'", Condition::WallNoSlip),
        ("\"Viscous_Solid\"", Condition::WallNoSlip),
        ("'tangency '", Condition::WallSlip),
        ("symmetry_y_strong", Condition::Symmetry),
        ("SYM", Condition::Symmetry),
        ("wall", Condition::Wall),
        ("'farfield_riem'", Condition::FarField),
        ("'farfield_extr'", Condition::FarField),
        ("'farfield_pbck'", Condition::OutflowSubsonic),
        ("'back_pressure'", Condition::OutflowSubsonic),
        ("'subsonic_inflow_pt'", Condition::InflowSubsonic),
        ("'subsonic_outflow_p0'", Condition::OutflowSubsonic),
        ("backpressure", Condition::OutflowSubsonic),
        ("'symmetry_x'", Condition::Symmetry),
        ("SYM_Y", Condition::Symmetry),
        ("'viscous_wall_function'", Condition::WallNoSlip),
        ("'fixed_outflow'", Condition::OutflowSupersonic),
        ("POLE_DIR1", Condition::Collapsed),
        ("2004", Condition::WallNoSlip),
        ("'1005'", Condition::WallSlip),
        ("1003", Condition::FarField),
        ("4000", Condition::WallNoSlip),
        ("6662", Condition::Symmetry),
    ] {
        let grid = box_grid([0.0; 3], [1.0; 3], [3, 2, 1]);
        let text = format!("1\n1 4 3 2\n{name}  1 5  1 2  1 4  ! as they come\n");
        let read = nmf::parse("x.nmf", &text, &grid).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(
            (read.patches[0].face, read.patches[0].condition),
            (Face::JMin, condition),
            "{name}"
        );
    }
    let grid = box_grid([0.0; 3], [1.0; 3], [3, 2, 1]);
    let error = |line: &str| {
        nmf::parse("x.nmf", &format!("1\n1 4 3 2\n{line}\n"), &grid)
            .unwrap_err()
            .to_string()
    };
    assert!(error("2005 1 5 1 2 1 4").contains("x.nmf:3: unknown type '2005'"));
    assert!(error("1 5 1 2 1 4").contains("a type name is needed"));
    assert!(error("'patched' 1 5 1 2 1 4").contains("only one_to_one"));
}

/// A plane with three coordinates may be x-y or x-z, its third coordinate constant to the digits of the file.
#[test]
fn planes_with_three_coordinates_read_either_way() {
    for flat in ["0.0 0.0 0.0 0.0", "1.0 1.0 1.0000001 1.0"] {
        for text in [
            format!("2 2 1\n0 1 0 1\n0 0 2 2\n{flat}\n"),
            format!("2 2 1\n0 1 0 1\n{flat}\n0 0 2 2\n"),
        ] {
            let read = plot3d::parse("plane", text.as_bytes()).unwrap();
            assert_eq!(read.blocks[0].point(1, 1, 0)[2], 2.0, "{text}");
        }
    }
}

/// A record of a Fortran program: its bytes between their number, twice.
fn record(content: &[u8]) -> Vec<u8> {
    let mark = (content.len() as u32).to_le_bytes();
    [&mark, content, &mark].concat()
}

fn bytes<const N: usize, T: Copy>(values: &[T], one: impl Fn(T) -> [u8; N]) -> Vec<u8> {
    values.iter().flat_map(|&v| one(v)).collect()
}

/// Solutions as OVERFLOW writes them (read in nasa/cape, cape/pyover/plot3d.py): NQ and NQC behind the sizes, an integer among the
/// reference values, the ratio of specific heats and a turbulence variable behind the five variables.
#[test]
fn solutions_of_overflow_read() {
    let sizes: [i32; 6] = [4, 3, 2, 2, 2, 2];
    for (species, newer) in [(0, true), (0, false), (3, true)] {
        let head = [&sizes[..], &[7, species]].concat();
        let mut file = [
            record(&bytes(&[2i32], i32::to_le_bytes)),
            record(&bytes(&head, i32::to_le_bytes)),
        ]
        .concat();
        for (block, count) in [24, 8].into_iter().enumerate() {
            let before = bytes(&[0.8, 2.5, 1e6, 0.25, 1.4, 0.0, 518.7f64], f64::to_le_bytes);
            let gases = 3 + (species as usize).max(2) + if newer { 3 } else { 0 };
            let behind = bytes(&vec![1.0; gases], f64::to_le_bytes);
            file.extend(record(&[before, 1i32.to_le_bytes().to_vec(), behind].concat()));
            let values: Vec<f64> = (0..7 * count).map(|n| (1000 * block + n) as f64).collect();
            file.extend(record(&bytes(&values, f64::to_le_bytes)));
        }
        let read = plot3d::parse_solution("q.save", &file).unwrap();
        assert_eq!(read.blocks.len(), 2);
        let block = &read.blocks[1];
        assert_eq!((block.nodes, block.reference), ([2, 2, 2], [0.8, 2.5, 1e6, 0.25]));
        assert_eq!((block.q.len(), block.q[4][3], block.q[6][7]), (7, 1035.0, 1055.0));
        // Written again it is Plot3D's own, which has five variables.
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("q");
        plot3d::write_solution(&path, &read).unwrap();
        let again = plot3d::read_solution(&path).unwrap();
        assert_eq!(again.blocks[0].q, read.blocks[0].q[..5]);
        // It is no grid, and that is said.
        let error = plot3d::parse("q.save", &file).unwrap_err().to_string();
        assert!(error.contains("a Plot3D solution, not a grid"), "{error}");
        // Cut short it is none.
        assert!(plot3d::parse_solution("q.save", &file[..file.len() - 9]).is_err());
    }
}

/// Programs compiled with eight-byte integers (`-i8`): sizes are such, with the number of blocks and without.
#[test]
fn sizes_in_integers_of_eight_bytes_read() {
    let nodes: Vec<f64> = (0..3 * 12).map(f64::from).collect();
    for multi in [true, false] {
        let mut file = Vec::new();
        if multi {
            file.extend(record(&bytes(&[1i64], i64::to_le_bytes)));
        }
        file.extend(record(&bytes(&[3i64, 2, 2], i64::to_le_bytes)));
        file.extend(record(&bytes(&nodes, f64::to_le_bytes)));
        let read = plot3d::parse("grid", &file).unwrap();
        assert_eq!((read.blocks[0].nodes(), read.layout.multi), ([3, 2, 2], multi));
        assert_eq!(read.blocks[0].point(2, 1, 1), [11.0, 23.0, 35.0]);
    }
}

/// A record for every array, as scripts write that know records of one array only: two blocks, with and without iblank.
#[test]
fn a_record_for_every_array_reads() {
    for (iblank, three_d) in [(false, true), (true, true), (false, false), (true, false)] {
        let sizes: &[i32] = if three_d { &[3, 2, 4, 2, 2, 2] } else { &[3, 2, 2, 2] };
        let mut file = [
            record(&bytes(&[2i32], i32::to_le_bytes)),
            record(&bytes(sizes, i32::to_le_bytes)),
        ]
        .concat();
        for size in sizes.chunks(sizes.len() / 2) {
            let count = size.iter().product::<i32>();
            for d in 0..size.len() {
                let values: Vec<f64> = (0..count).map(|n| f64::from(n + 100 * d as i32)).collect();
                file.extend(record(&bytes(&values, f64::to_le_bytes)));
            }
            if iblank {
                file.extend(record(&bytes(&vec![1; count as usize], i32::to_le_bytes)));
            }
        }
        let read = plot3d::parse("grid", &file).unwrap();
        assert_eq!((read.layout.iblank, read.layout.three_d), (iblank, three_d));
        let last = read.blocks[0].nodes().map(|n| n - 1);
        let wanted = if three_d {
            [23.0, 123.0, 223.0]
        } else {
            [5.0, 0.0, 105.0]
        };
        assert_eq!(read.blocks[0].point_at(last), wanted);
        assert_eq!(read.iblank[1].is_some(), iblank);
    }
}

/// Files that are no grids at all say what they are.
#[test]
fn files_of_another_kind_are_named() {
    let error = |content: &[u8]| plot3d::parse("file", content).unwrap_err().to_string();
    assert!(error(b"\x1f\x8b\x08\x00rest").contains("gunzip"));
    assert!(error(b"\x89HDF\r\n\x1a\n").contains(".cgns"));
    let text = error(b"1\n2 2 2\n0.0 1.0 0.0\n1.0 ******** 1.0\n");
    assert!(text.contains("line 4: \"********\" is no number"), "{text}");
    assert!(error(b"1\n2 2 2\n0.0 1.0 -1.5E").contains("it ends in line 3 within a number"));
    assert!(error(b"NDIME= 2\n").contains("line 1: \"NDIME=\""));
    let text = plot3d::parse_solution("q", b"1\n2 2 2 rho\n").unwrap_err().to_string();
    assert!(text.contains("line 2: \"rho\""), "{text}");
}

/// Holes and fringes of overset grids are told, for nothing here knows them.
#[test]
fn holes_of_an_overset_grid_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grid.in");
    let block = box_grid([0.0; 3], [1.0; 3], [2, 2, 2]).blocks.remove(0);
    let layout = plot3d::Layout {
        iblank: true,
        ..plot3d::Layout::default()
    };
    let mut blank = vec![1; 27];
    let told = |blank: &[i32]| {
        plot3d::write(&path, std::slice::from_ref(&block), &[Some(blank.to_vec())], layout).unwrap();
        let opened = file::open(&path, None).unwrap();
        opened.notes.iter().any(|n| n.contains("iblank marks 2 nodes"))
    };
    assert!(!told(&blank));
    // A wall (2) is none, a hole (0) and a node interpolated from block 3 (-3) are.
    [blank[4], blank[7], blank[9]] = [2, 0, -3];
    assert!(told(&blank));
}
