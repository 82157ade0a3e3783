//! Files: round trips are exact, layouts are found, broken input is an error and never a panic.

use dip_grid::connect::{Options, find_interfaces};
use dip_grid::generate::{BoxGrid, box_grid};
use dip_grid::plot3d::{self, Encoding, Layout, Solution, SolutionBlock};
use dip_grid::{Condition, MultiBlock, Period, boundary_file, file, nmf, quality, recipe, reorient, split, vtk};

fn layouts() -> Vec<Layout> {
    let mut encodings = vec![Encoding::Ascii];
    for big_endian in [false, true] {
        encodings.push(Encoding::Stream { big_endian });
        encodings.push(Encoding::Records { big_endian, marker: 4 });
        encodings.push(Encoding::Records { big_endian, marker: 8 });
    }
    let mut out = Vec::new();
    for encoding in encodings {
        for bits in 0..16 {
            let (double, multi, three_d, iblank) = (bits & 1 != 0, bits & 2 != 0, bits & 4 != 0, bits & 8 != 0);
            if encoding == Encoding::Ascii && !double {
                continue;
            }
            out.push(Layout {
                encoding,
                double,
                multi,
                three_d,
                iblank,
            });
        }
    }
    out
}

fn wavy(cells: [usize; 3]) -> MultiBlock {
    BoxGrid::new([-1.0, 0.0, 0.3], [2.0, 1.0, 1.7], cells).wavy(0.04).make()
}

/// The same numbers as a file in single precision has.
fn rounded(grid: &MultiBlock) -> MultiBlock {
    let mut grid = grid.clone();
    for block in &mut grid.blocks {
        for v in block.x.iter_mut().chain(&mut block.y).chain(&mut block.z) {
            *v = f64::from(*v as f32);
        }
    }
    grid
}

#[test]
fn every_layout_of_a_grid_is_found_and_reads_back_exactly() {
    for layout in layouts() {
        let mut grid = wavy(if layout.three_d { [5, 4, 3] } else { [6, 5, 1] });
        if layout.multi {
            split::split_into(&mut grid, 3);
        }
        if !layout.double {
            grid = rounded(&grid);
        }
        let iblank: Vec<Option<Vec<i32>>> = grid
            .blocks
            .iter()
            .map(|b| Some((0..b.node_count()).map(|n| (n % 3) as i32 - 1).collect()))
            .collect();
        let bytes = plot3d::encode(&grid.blocks, &iblank, layout).unwrap();
        let read = plot3d::parse("test", &bytes).unwrap_or_else(|e| panic!("{layout:?}: {e}"));
        assert_eq!(read.layout, layout);
        assert_eq!(read.blocks.len(), grid.blocks.len());
        for (n, (a, b)) in grid.blocks.iter().zip(&read.blocks).enumerate() {
            let count = if layout.three_d {
                a.node_count()
            } else {
                a.nodes()[0] * a.nodes()[1]
            };
            assert_eq!(a.cells(), b.cells(), "{layout:?}");
            assert_eq!(a.x[..count], b.x[..count], "{layout:?}");
            assert_eq!(a.z[..count], b.z[..count], "{layout:?}");
            if layout.three_d {
                assert_eq!(a.y, b.y);
            }
            let expected = layout.iblank.then(|| iblank[n].as_ref().unwrap()[..count].to_vec());
            assert_eq!(read.iblank[n], expected);
        }
    }
}

#[test]
fn every_layout_of_a_solution_reads_back_exactly() {
    for layout in layouts().into_iter().filter(|l| !l.iblank) {
        let variables = if layout.three_d { 5 } else { 4 };
        let sizes: &[[usize; 3]] = if layout.three_d {
            &[[3, 4, 5], [2, 2, 3]]
        } else {
            &[[3, 4, 1], [2, 5, 1]]
        };
        let blocks = sizes[..if layout.multi { 2 } else { 1 }]
            .iter()
            .map(|&nodes| {
                let count: usize = nodes.iter().product();
                let q = (0..variables)
                    .map(|v| (0..count).map(|n| f64::from((v + n) as f32 * 0.3)).collect())
                    .collect();
                SolutionBlock {
                    nodes,
                    reference: [0.75, 2.5, 6.5e6, 0.0],
                    q,
                }
            })
            .collect();
        let solution = Solution { blocks, layout };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("q");
        plot3d::write_solution(&path, &solution).unwrap();
        let read = plot3d::read_solution(&path).unwrap_or_else(|e| panic!("{layout:?}: {e}"));
        assert_eq!(read, solution);
    }
}

#[test]
fn fortran_text_with_repeat_counts_and_d_exponents_reads() {
    let text = b"1\n 2 2 2\n 2*0.0D0, 1.0d+0 1 2*0 2*1.0E0\n 0 1 0 1 0 1 0 1 \n 0 0 1 1 0 0 1 1";
    let read = plot3d::parse("text", text).unwrap();
    assert_eq!(read.blocks[0].x, [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0]);
    assert_eq!(read.blocks[0].z, [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0]);
}

#[test]
fn broken_grids_say_what_is_wrong() {
    let grid = wavy([5, 4, 3]);
    let whole = plot3d::encode(&grid.blocks, &[], Layout::default()).unwrap();
    let error = |bytes: &[u8]| plot3d::parse("broken.xyz", bytes).unwrap_err().to_string();
    assert!(error(b"").contains("empty"));
    assert!(error(&whole[..whole.len() - 100]).contains("truncated"));
    // A header that claims 2e9 x 2e9 x 2e9 nodes: refused before anything is allocated.
    let mut absurd = whole.clone();
    for n in 0..3 {
        absurd[16 + 4 * n..20 + 4 * n].copy_from_slice(&2_000_000_000i32.to_le_bytes());
    }
    error(&absurd);
    let mut wrong = whole.clone();
    wrong[16] += 1;
    assert!(error(&wrong).contains("block 1 should have 7 x 5 x 4 nodes"));
    let mut nan = grid.clone();
    nan.blocks[0].y[7] = f64::NAN;
    let bytes = plot3d::encode(&nan.blocks, &[], Layout::default()).unwrap();
    assert!(error(&bytes).contains("y of node (1, 1, 0)"), "{}", error(&bytes));
    // Found by the search for panics below: a block one node thick along i.
    assert!(error(b"1 1 2 3 0 1 0 1 0 1 0 0 1 1 2 2 0 0 0 0 0 1").contains("one node thick"));
    assert!(error(b"1\n3 3 3\n1.0 2.0 3.0").contains("truncated"));
    let sizes = error(b"1\n99999999999 99999999999 99999999999\n1.0 2.0 3.0");
    assert!(
        sizes.contains("does not start with block sizes") && sizes.contains("1.0e33 nodes"),
        "{sizes}"
    );
}

#[test]
fn interfaces_are_found_in_all_orientations_and_written_back() {
    let mut whole = wavy([8, 6, 4]);
    split::split_block(&mut whole, 0, 0, 3);
    split::split_block(&mut whole, 1, 1, 2);
    for axes in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]] {
        for bits in 0..8 {
            let mut grid = whole.clone();
            reorient::reorient(&mut grid, 1, axes, [bits & 1 != 0, bits & 2 != 0, bits & 4 != 0]);
            let expected = grid
                .topology
                .interfaces
                .iter()
                .map(|i| i.a.window.count())
                .sum::<usize>();
            grid.topology.interfaces.clear();
            let found = find_interfaces(&mut grid, &Options::default());
            assert_eq!(found.free, 0);
            assert_eq!(
                grid.topology
                    .interfaces
                    .iter()
                    .map(|i| i.a.window.count())
                    .sum::<usize>(),
                expected
            );
            let report = quality::check(&grid);
            let bad: Vec<_> = report
                .findings
                .iter()
                .filter(|f| !f.text.contains("left-handed"))
                .collect();
            assert!(
                bad.iter()
                    .all(|f| !f.text.contains("interface") && !f.text.contains("no condition")),
                "{bad:?}"
            );
            // Both boundary files give the same topology back.
            let text = boundary_file::format(&grid.topology);
            assert_eq!(boundary_file::parse("x.bc.toml", &text, &grid).unwrap(), grid.topology);
            let (text, left_out) = nmf::format(&grid);
            assert_eq!(left_out, 0);
            let read = nmf::parse("x.nmf", &text, &grid).unwrap();
            assert_eq!(read.interfaces, grid.topology.interfaces, "{text}");
            let sides = |t: &dip_grid::Topology| t.patches.iter().map(|p| (p.side(), p.condition)).collect::<Vec<_>>();
            assert_eq!(sides(&read), sides(&grid.topology));
        }
    }
}

#[test]
fn periodic_faces_and_collapsed_faces_are_found() {
    let made = wavy([4, 4, 4]);
    let mut grid = BoxGrid::new([0.0; 3], [1.0; 3], [4, 4, 4]).wavy(0.04).make();
    grid.topology.patches.clear();
    let options = Options {
        tolerance: None,
        periodic: vec![
            Period::Translation([1.0, 0.0, 0.0]),
            Period::Translation([0.0, 0.0, 1.0]),
        ],
    };
    let found = find_interfaces(&mut grid, &options);
    assert_eq!((found.periodic, found.free), (2, 2 * 16));
    assert!(quality::check(&grid).findings.iter().all(|f| !f.text.contains("apart")));
    // A wedge: i = 0 collapses to an edge.
    let mut wedge = made;
    wedge.topology.patches.clear();
    let block = &mut wedge.blocks[0];
    for k in 0..=block.nk {
        for j in 0..=block.nj {
            block.set_point([0, j, k], [0.0, k as f64, 0.0]);
        }
    }
    let found = find_interfaces(&mut wedge, &Options::default());
    assert_eq!(found.collapsed, 1);
    assert_eq!(wedge.topology.patches[0].condition, Condition::Collapsed);
}

#[test]
fn a_neutral_map_file_of_the_resource_reads() {
    // The layout of the C grids of the Turbulence Modeling Resource: wake cut on jmin, written with a falling range.
    let text = "# ===== Neutral Map File\n# Block# IDIM JDIM KDIM\n1\n\n1 9 3 2\n\n# Type B1 F1 S1 E1 S2 E2 B2 F2 S1 E1 S2 E2 Swap\n\
        'ONE_TO_ONE' 1 5 1 2 1 3 1 5 1 2 9 7 FALSE\n'viscous_solid' 1 5 1 2 3 7\n'farfield_riem' 1 6 1 2 1 9\n\
        'farfield_extr' 1 3 1 3 1 2\n'farfield_extr' 1 4 1 3 1 2\n'symmetry_y' 1 1 1 9 1 3\n'symmetry_y' 1 2 1 9 1 3\n";
    let grid = box_grid([0.0; 3], [1.0; 3], [8, 2, 1]);
    let topology = nmf::parse("c.nmf", text, &grid).unwrap();
    let wake = topology.interfaces[0];
    assert_eq!(wake.node_on_b(0, 0), [8, 0]);
    assert_eq!(wake.node_on_b(2, 1), [6, 1]);
    assert_eq!(topology.patches[0].condition, Condition::WallNoSlip);
    assert_eq!(topology.patches[0].window, dip_grid::Window::new([2, 0], [6, 1]));
    let error = nmf::parse("c.nmf", &text.replace("farfield_riem", "nonsense"), &grid).unwrap_err();
    assert_eq!(error.line, 10);
    assert!(nmf::parse("c.nmf", &text.replace("3 7\n", "3 17\n"), &grid).is_err());
}

#[test]
fn a_condition_on_an_interface_and_overlapping_patches_are_errors() {
    let mut grid = wavy([6, 4, 2]);
    split::split_block(&mut grid, 0, 0, 3);
    let mut patch = grid.topology.patches[0].clone();
    patch.face = dip_grid::Face::IMax;
    grid.topology.patches.push(patch);
    let report = quality::check(&grid);
    assert!(
        report
            .findings
            .iter()
            .any(|f| f.fatal && f.text.contains("patch xmin and interface 0 overlap")),
        "{report}"
    );
    let mut grid = wavy([6, 4, 2]);
    grid.topology.patches.push(grid.topology.patches[0].clone());
    assert!(
        quality::check(&grid)
            .findings
            .iter()
            .any(|f| f.fatal && f.text.contains("overlap"))
    );
    grid.topology.patches.clear();
    assert!(
        quality::check(&grid)
            .findings
            .iter()
            .any(|f| f.fatal && f.text.contains("no condition"))
    );
}

#[test]
fn saving_and_opening_keeps_grid_and_topology() {
    let folder = tempfile::tempdir().unwrap();
    let mut grid = wavy([8, 6, 4]);
    split::split_into(&mut grid, 4);
    let path = folder.path().join("grid.xyz");
    file::save(&path, &grid, Layout::default()).unwrap();
    let opened = file::open(&path, None).unwrap();
    assert_eq!(opened.grid.topology, grid.topology);
    for (a, b) in grid.blocks.iter().zip(&opened.grid.blocks) {
        assert_eq!((&a.x, &a.y, &a.z), (&b.x, &b.y, &b.z));
    }
    // A left-handed file is turned, and says so.
    let mirrored: Vec<_> = grid
        .blocks
        .iter()
        .map(|b| b.reoriented([0, 1, 2], [true, false, false]))
        .collect();
    let path = folder.path().join("left.xyz");
    plot3d::write(&path, &mirrored, &[], Layout::default()).unwrap();
    let opened = file::open(&path, None).unwrap();
    assert_eq!(opened.notes.iter().filter(|n| n.contains("left-handed")).count(), 4);
    assert!(quality::check(&opened.grid).figures[0].worst[0].value > 0.0);
    assert_eq!(opened.grid.topology.interfaces.len(), grid.topology.interfaces.len());
}

/// CFL3D's two-dimensional grids have i across, those of the Turbulence Modeling Resource come as text with two planes.
#[test]
fn two_dimensional_grids_of_other_programs_open_with_k_across() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cfl3d.xyz");
    let made = recipe::make(std::path::Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../meshes/naca0012_c.toml"
    )))
    .unwrap();
    let turned: Vec<_> = made
        .blocks
        .iter()
        .map(|b| b.reoriented([2, 0, 1], [false; 3]))
        .collect();
    for encoding in [
        Encoding::Ascii,
        Encoding::Records {
            big_endian: true,
            marker: 4,
        },
    ] {
        plot3d::write(
            &path,
            &turned,
            &[],
            Layout {
                encoding,
                ..Layout::default()
            },
        )
        .unwrap();
        let mut opened = file::open(&path, None).unwrap();
        dip_grid::connect::fill_rest(&mut opened.grid, "rest", Condition::Wall);
        assert!(opened.grid.is_two_dimensional());
        assert_eq!(opened.grid.blocks[0].x, made.blocks[0].x);
        // The wake is found, and only the wake.
        assert_eq!(opened.grid.topology.interfaces, made.topology.interfaces);
        assert!(quality::check(&opened.grid).is_good());
    }
}

/// Steps of 2e-6 chords at the wall, a far field at 500: the wake alone is an interface, also after rounding to single
/// precision and with its sides a little apart.
#[test]
fn fine_steps_in_a_large_grid_stay_apart() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/naca0012_viscous.toml");
    let made = recipe::make(std::path::Path::new(path)).unwrap();
    let mut apart = made.clone();
    let block = &mut apart.blocks[0];
    for i in 0..block.ni / 4 {
        let n = block.node(i, 0, 0);
        block.z[n] += 1e-10;
    }
    for (mut grid, tolerance) in [(made.clone(), None), (apart, None), (rounded(&made), Some(2e-4))] {
        grid.topology.interfaces.clear();
        find_interfaces(
            &mut grid,
            &Options {
                tolerance,
                periodic: Vec::new(),
            },
        );
        assert_eq!(grid.topology.interfaces, made.topology.interfaces);
    }
}

#[test]
fn pictures_are_drawings_of_the_grid() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/agard445_oo_coarsest.toml");
    let grid = recipe::make(std::path::Path::new(path)).unwrap();
    let pictures = dip_grid::picture::overview(&grid, "a < b");
    let names: Vec<&str> = pictures.iter().map(|p| p.name.as_str()).collect();
    for name in [
        "surface",
        "aslant",
        "symmetry-plane",
        "section",
        "nose",
        "tail",
        "across",
        "tip",
    ] {
        assert!(names.contains(&name), "{names:?}");
    }
    for picture in &pictures {
        assert!(picture.svg.starts_with("<svg") && picture.svg.trim_end().ends_with("</svg>"));
        assert!(
            !picture.svg.contains("NaN") && !picture.svg.contains("inf"),
            "{}",
            picture.name
        );
        assert!(
            picture.svg.contains("a &lt; b") && picture.svg.matches('L').count() > 8,
            "{}",
            picture.name
        );
    }
}

#[test]
fn paraview_files_hold_every_value() {
    let folder = tempfile::tempdir().unwrap();
    let grid = wavy([3, 2, 2]);
    let values = vec![(0..12).map(f64::from).collect::<Vec<_>>()];
    let field = vtk::Field {
        name: "p".into(),
        on: vtk::On::Cells,
        components: 1,
        values,
    };
    let path = folder.path().join("g.vtm");
    vtk::write(&path, &grid, std::slice::from_ref(&field)).unwrap();
    let bytes = std::fs::read(folder.path().join("g/0.vts")).unwrap();
    let start = bytes.windows(2).position(|w| w == b"\n_").unwrap() + 2;
    let word = |at: usize| u64::from_le_bytes(bytes[start + at..start + at + 8].try_into().unwrap());
    let points = grid.blocks[0].node_count() * 24;
    assert_eq!(word(0), points as u64);
    assert_eq!(f64::from_bits(word(8)), grid.blocks[0].x[0]);
    assert_eq!(word(8 + points), 96);
    assert_eq!(f64::from_bits(word(8 + points + 8 + 5 * 8)), 5.0);
    let short = vtk::Field {
        values: vec![vec![1.0]],
        ..field
    };
    assert!(vtk::write(&path, &grid, &[short]).is_err());
    vtk::write_worst(&folder.path().join("w.vtu"), &grid, &quality::check(&grid)).unwrap();
}

#[test]
fn recipes_name_line_and_nearest_key() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.toml");
    let error = |text: &str| {
        std::fs::write(&path, text).unwrap();
        recipe::make(&path).unwrap_err().to_string()
    };
    let text = error("kind = \"box\"\n[shape]\nfrom = [0, 0, 0]\nwavyness = 0.1\n");
    assert!(
        text.contains("r.toml:4:1") && text.contains("did you mean `waviness`"),
        "{text}"
    );
    assert!(error("kind = \"bocks\"\n").contains("did you mean `box`"));
    assert!(error("kind = \"box\"\n").contains("shape.from is needed"));
    assert!(error("kind = \"box\"\n[cells]\nspan = 3\n").contains("cells.span does not go with kind \"box\""));
    assert!(error("kind = \"box\"\n[shape]\nfrom = [0, 0, \"1 mile\"]\n").contains("unknown unit"));
    let huge = "kind = \"box\"\n[shape]\nfrom = [0, 0, 0]\nto = [1, 1, 1]\n[cells]\nbox = [100000, 100000, 100000]\n";
    assert!(error(huge).contains("cells are asked for"));
    assert!(error("extends = \"r.toml\"\n").contains("in a circle"));
}

/// Interfaces whose nodes are not one: apart by less than the round-off of single precision they are fine, by more a user must
/// look, and by a share of the steps there the grid cannot be used.
#[test]
fn gaps_of_interfaces_are_judged_by_precision_and_by_the_steps_there() {
    let whole = {
        let mut grid = wavy([8, 4, 4]);
        split::split_into(&mut grid, 2);
        rounded(&grid)
    };
    assert!(quality::misfits(&whole).is_empty());
    // In single precision, by one unit of the last place; in double precision, by a thousandth and by half of a step.
    for (gap, single, findings, misfits) in [
        (6e-8, true, 0, 0),
        (6e-8, false, 1, 0),
        (1e-4, false, 1, 0),
        (0.1, false, 1, 1),
    ] {
        let mut grid = whole.clone();
        for block in &mut grid.blocks[1..] {
            for x in &mut block.x {
                *x = if single {
                    f64::from((*x + gap) as f32)
                } else {
                    *x + gap * (1.0 + 1e-9)
                };
            }
        }
        let apart = |all: &[quality::Finding]| all.iter().filter(|f| f.text.contains("apart")).count();
        let report = quality::check(&grid);
        assert_eq!(apart(&report.findings), findings, "{gap} {single}: {report}");
        assert_eq!(apart(&quality::misfits(&grid)), misfits, "{gap} {single}");
    }
}
